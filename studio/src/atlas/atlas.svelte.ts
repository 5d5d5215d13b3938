// The atlas that is open: its graph classes, the selected class on the map, and the matches of a search.

import type { Design, Point } from "../design";
import { refusal, studio } from "../state.svelte";
import type { View } from "../wire";

export interface Way {
  from: string;
  to: string;
  direction: number;
  snaps: boolean;
}

/** A graph class of the record, with its position on the map. */
export interface GraphClass {
  name: string;
  cycle: string;
  designs: number;
  fraction_percent: number;
  fraction_low_percent: number;
  fraction_high_percent: number;
  yield_percent: number;
  yield_low_percent: number;
  yield_high_percent: number;
  values: number[];
  agrees: boolean;
  states: number;
  reached: number;
  snaps: number;
  sub_loops: number;
  remembers: boolean;
  scrambled: number;
  counts: number;
  counts_by_hand: number;
  gardens: number;
  latches: number;
  design_tables: Design;
  x: number;
  y: number;
  radius: number;
  ways: Way[];
}

/** Boundary of a graph class along one parameter of its most robust design. */
export interface ClassBoundary {
  graph_class: string;
  parameter: string;
  unit: string;
  at: number;
  step: number;
  beyond: string;
}

class Charted {
  /** "" is the one that comes with Stepwell. */
  name = $state("");
  view = $state.raw<View | null>(null);
  /** How much of it is charted, 0 to 1. */
  done = $state(0);
  problem = $state("");
  /** Where one stands. */
  at = $state("");
  query = $state("");
  least = $state<number | null>(null);
  /** The names that do what was asked; null where nothing was. */
  matches = $state.raw<string[] | null>(null);
  refused = $state("");

  graphClasses = $derived<GraphClass[]>(this.view?.graph_classes ?? []);
  classBoundaries = $derived<ClassBoundary[]>(this.view?.class_boundaries ?? []);
  here = $derived(this.graphClasses.find((one) => one.name === this.at));
  /** Neighbours of each graph class, by the smallest change of a parameter. */
  near = $derived.by(() => {
    const all = new Map<string, Map<string, ClassBoundary>>();
    for (const one of this.classBoundaries) {
      const own = all.get(one.graph_class) ?? new Map<string, ClassBoundary>();
      const known = own.get(one.beyond);
      if (!known || this.part(one) < this.part(known)) own.set(one.beyond, one);
      all.set(one.graph_class, own);
    }
    return all;
  });
  /** Pairs between which a change leads, either way. */
  pairs = $derived(
    [...new Set(this.classBoundaries.map((one) => [one.graph_class, one.beyond].sort().join(" ")))].map((one) => one.split(" ")),
  );

  private asked = 0;

  /** A change as a part of what its number has in the space. */
  part({ parameter, step }: ClassBoundary): number {
    const span = this.view?.space.find((one: { parameter: string }) => one.parameter === parameter);
    return Math.abs(step) / (span.to - span.from);
  }

  open(name: string): void {
    this.name = name;
    this.view = null;
    this.problem = "";
    this.at = "";
    this.matches = null;
    this.done = 0;
    // One that is still being charted is not wanted any more.
    this.leave();
    const { asked } = this;
    studio.once(
      "atlas",
      { name },
      (view) => {
        if (asked !== this.asked) return;
        if (!view.ok) {
          this.problem = refusal(view);
          return;
        }
        this.view = view;
        this.at = this.graphClasses[0]?.name ?? "";
      },
      (view) => {
        if (asked === this.asked && view.progress) this.done = view.progress[0] / view.progress[1];
      },
    );
  }

  /** Ends what is being charted; it can be opened again. */
  leave(): void {
    this.asked += 1;
    studio.cancel("atlas");
  }

  find(): void {
    this.refused = "";
    if (!this.query.trim() && !this.least) {
      this.matches = null;
      return;
    }
    const asked = this.asked;
    const ask = { name: this.name, query: this.query, yield_percent: this.least ?? 0 };
    if (!this.query.trim()) {
      const least = this.least ?? 0;
      this.matches = this.graphClasses.filter((one) => one.yield_low_percent >= least).map((one) => one.name);
      return;
    }
    studio.once("atlas", ask, (view) => {
      if (asked !== this.asked) return;
      if (!view.ok) {
        this.refused = refusal(view);
        return;
      }
      this.matches = view.matches;
      if (view.matches.length && !view.matches.includes(this.at)) this.at = view.matches[0];
    });
  }

  /** The neighbour that lies most in a direction; where one stands if there is none. */
  towards([dx, dy]: Point): string {
    const { here } = this;
    if (!here) return this.at;
    let [best, least] = [this.at, Infinity];
    for (const one of this.graphClasses) {
      if (one === here || !this.joined(here.name, one.name)) continue;
      const [x, y] = [one.x - here.x, one.y - here.y];
      const [along, beside] = [x * dx + y * dy, Math.abs(x * dy - y * dx)];
      if (along <= 0 || beside > 1.8 * along) continue;
      const cost = Math.hypot(x, y) + beside;
      if (cost < least) [best, least] = [one.name, cost];
    }
    return best;
  }

  joined(a: string, b: string): boolean {
    return Boolean(this.near.get(a)?.has(b) || this.near.get(b)?.has(a));
  }
}

export const atlas = new Charted();

/** The cells in the order in which they come back, numbered as they load. */
export function backOf(cycle: string): string {
  const states = cycle.split(">");
  const down = states.slice(states.length >> 1);
  return down
    .slice(1)
    .map((state, k) => [...state].findIndex((digit, i) => digit !== down[k][i]) + 1)
    .join(" ");
}

/** Memory of a graph class, in the words of `stepwell atlas show`. */
export function memoryOf(one: GraphClass): string {
  const counts = Math.max(one.counts, one.counts_by_hand);
  return [
    one.remembers ? "remembers" : "forgets",
    one.scrambled ? "scrambles" : "",
    counts ? `counts to ${counts}${one.counts === counts ? "" : " by hand"}` : "",
    one.latches ? "latches" : "",
    one.gardens ? "has a garden" : "",
  ]
    .filter(Boolean)
    .join(", ");
}
