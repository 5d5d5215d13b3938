// Reads the samples of a cycle: where everything is at the cursor, and how play passes through it.

import { formatted, nameOf } from "./design";
import type { View } from "./wire";

/** A snap, or a cell that reaches a stop or another phase. */
export interface Event {
  kind: "snap" | "switch";
  sample: number;
  stroke_mm: number;
  direction: number;
  cells: number[];
  before_mm: number[];
  after_mm: number[];
}

/** An event in words: where it is, and the travels of the cells that move. */
export function eventText(view: View, { kind, cells, before_mm, after_mm, stroke_mm, direction }: Event): string {
  const { travel, stroke } = view.units;
  const moves = cells.map((i, k) => {
    const [from, to] = [before_mm[k], after_mm[k]].map((one) => formatted(one));
    return `${nameOf(view.cells[i], i)} ${from === to ? `at ${to}` : `${from} → ${to}`}`;
  });
  const half = direction > 0 ? "loading" : "unloading";
  const name = kind === "snap" ? "Snap" : "Switch";
  return `${name} at ${formatted(stroke_mm)} ${stroke}, ${half}: ${moves.slice(0, 4).join(", ")} ${travel}`;
}

/** How long a snap is shown, though it takes next to no time [ms]. */
export const SNAP_MS = 700;
/** How long the cycle takes without its snaps [ms]. */
export const CYCLE_MS = 7000;

/** True where the next sample is the landing of a snap, which leads from one segment to the next. */
export const snaps = ({ blocks: { segment } }: View, k: number): boolean =>
  k + 1 < segment.length && segment[k] !== segment[k + 1];

// Smaller changes of a travel are rounding [mm].
const MOVES = 1e-9;

const read = new WeakMap<View, Event[]>();

/** Switches and snaps; while a hand moves the design the snaps alone, which are read off the samples. */
export function eventsOf(view: View): Event[] {
  const events = view.events ?? read.get(view) ?? snapsOf(view);
  read.set(view, events);
  return events;
}

function snapsOf(view: View): Event[] {
  const events: Event[] = [];
  for (let k = 0; k + 1 < view.blocks.drive.length; k += 1) if (snaps(view, k)) events.push(new Snap(view, k));
  return events;
}

/** A snap between two samples; which cells move, and how far, is read off them when it is asked for. */
class Snap implements Event {
  readonly kind = "snap";

  constructor(
    private readonly view: View,
    readonly sample: number,
  ) {}

  get stroke_mm(): number {
    return this.view.blocks.stroke[this.sample];
  }

  get direction(): number {
    return this.view.blocks.direction[this.sample];
  }

  get cells(): number[] {
    return [...this.view.cells.keys()].filter((i) => Math.abs(this.travel(i, 1) - this.travel(i, 0)) > MOVES);
  }

  get before_mm(): number[] {
    return this.cells.map((i) => this.travel(i, 0));
  }

  get after_mm(): number[] {
    return this.cells.map((i) => this.travel(i, 1));
  }

  private travel(cell: number, later: number): number {
    return this.view.blocks.travel[(this.sample + later) * this.view.cells.length + cell];
  }
}

/** The cell that a snap moves most; of equal ones the last, which it brings to its stop. */
export function moverOf({ cells, blocks: { travel } }: View, { sample }: Event): number {
  const [width, at] = [cells.length, sample * cells.length];
  let [mover, most] = [0, 0];
  for (let i = 0; i < width; i += 1) {
    const moved = Math.abs(travel[at + width + i] - travel[at + i]);
    if (moved < most - MOVES) continue;
    mover = i;
    most = Math.max(most, moved);
  }
  return mover;
}

/** The answer to a move of some cells; what it leaves out of the others is as in the view before. */
export function completed(before: View, now: View, moved: number[]): View {
  const cells = [...before.cells];
  moved.forEach((i, k) => (cells[i] = now.cells[k]));
  const blocks = { ...now.blocks };
  for (const name of ["landscape_travel", "landscape_energy"]) {
    const [all, own] = [before.blocks[name].slice(), now.blocks[name]];
    const rows = all.length / cells.length;
    for (let k = 0; k < rows; k += 1)
      moved.forEach((i, j) => (all[k * cells.length + i] = own[k * moved.length + j]));
    blocks[name] = all;
  }
  return { layout: before.layout, ...now, cells, blocks };
}

/** The tension of each band; in the answer to a move the server has those at the cursor alone. */
export const tensions = (view: View, at: number): ArrayLike<number> =>
  view.blocks.tension_now ?? row(view, "tension", at);

/** Row k of an (n, N) block, and between two rows while a motion is shown. */
export function row(view: View, name: string, at: number): number[] {
  const block = view.blocks[name];
  const n = view.blocks.drive.length;
  const width = block.length / n;
  const k = Math.min(Math.floor(at), n - 1);
  const next = Math.min(k + 1, n - 1);
  const share = at - k;
  return Array.from({ length: width }, (_, i) => {
    const a = block[k * width + i];
    return a + (block[next * width + i] - a) * share;
  });
}

/** Row `at` of an (n, N) block; of a snap the sample before it, since nothing lies between. */
export function along(view: View, name: string, at: number): number[] {
  const k = Math.floor(at);
  return row(view, name, snaps(view, k) ? k : at);
}

/** The place of a stroke in the half, loading or unloading, that is shown, between samples too. */
export function placeOf(view: View, at: number, stroke: number): number {
  const { stroke: all, direction, segment } = view.blocks;
  const k = nearest(view, at, stroke);
  for (const a of [k - 1, k]) {
    const b = a + 1;
    if (segment[a] !== segment[b] || direction[a] !== direction[k] || direction[b] !== direction[k]) continue;
    const part = (stroke - all[a]) / (all[b] - all[a]);
    if (part > 0 && part < 1) return a + part;
  }
  return k;
}

/** The sample nearest to a stroke, on the way, loading or unloading, that the cursor is on. */
export function nearest(view: View, at: number, stroke: number): number {
  const { stroke: all, direction } = view.blocks;
  const way = direction[Math.floor(at)];
  let best = 0;
  for (let k = 0; k < all.length; k += 1) {
    const better = Math.abs(all[k] - stroke) < Math.abs(all[best] - stroke);
    if (direction[k] === way && (better || direction[best] !== way)) best = k;
  }
  return best;
}

/** The sample of another view with the most similar travels of all cells. */
export function likest(before: View, at: number, now: View): number {
  const travels = row(before, "travel", Math.min(at, before.blocks.drive.length - 1));
  const all = now.blocks.travel;
  let [best, least] = [0, Infinity];
  for (let k = 0; k < now.blocks.drive.length; k += 1) {
    let far = 0;
    for (const [i, travel] of travels.entries()) far += (all[k * travels.length + i] - travel) ** 2;
    if (far < least) [best, least] = [k, far];
  }
  return best;
}

/** The sample after some time of play, in which a snap takes `snapMs`. */
export function played(view: View, at: number, ms: number, snapMs = SNAP_MS): number {
  const last = view.blocks.drive.length - 1;
  const k = Math.floor(at);
  const rate = snaps(view, k) ? 1 / snapMs : last / CYCLE_MS;
  const next = at + rate * ms;
  if (next >= last) return 0;
  // A step ends where the next interval begins, which may be passed at another speed.
  return Math.floor(next) > k && (snaps(view, k) || snaps(view, k + 1)) ? k + 1 : next;
}
