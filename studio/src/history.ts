// Undo and redo over everything that changes or replaces the design, and the designs kept in the browser.

import { type Design, designIn } from "./design";
import { store, stored } from "./storage";

/** A design as it stood, with the leg that was shown. */
export interface Step {
  design: Design;
  leg: number;
  /** Number of the opened design: edits keep it, another design has another one. */
  opened: number;
}

const STEPS = 100;
// Steps of one key or field that follow each other within this time are one step of undo.
const RUN_MS = 1000;

/** The steps before and after the present design. */
export class History {
  past: Step[] = [];
  future: Step[] = [];
  private run = "";
  private last = 0;

  /** Remember a step before a change; changes with the same name in quick succession are one step. */
  mark(step: Step, run = ""): void {
    const now = performance.now();
    const same = run !== "" && run === this.run && now - this.last < RUN_MS;
    [this.run, this.last] = [run, now];
    if (same || this.past.at(-1)?.design === step.design) return;
    this.past = [...this.past, step].slice(-STEPS);
    this.future = [];
  }

  /** The step before; the present one can be redone. */
  undo(present: Step): Step | undefined {
    const before = this.past.pop();
    if (before) this.future.push(present);
    this.run = "";
    return before;
  }

  /** The step after; the present one can be undone. */
  redo(present: Step): Step | undefined {
    const after = this.future.pop();
    if (after) this.past.push(present);
    this.run = "";
    return after;
  }

  /** The step before, without a way forward: a cancelled drag leaves no trace. */
  cancel(): Step | undefined {
    this.run = "";
    return this.past.pop();
  }
}

/** A design kept in the browser. */
export interface Kept {
  id: string;
  /** When it was changed last [ms since 1970]. */
  time: number;
  design: Design;
}

const KEPT = "stepwell.designs";
const MOST = 10;

/** The designs kept in the browser, the newest first. */
export function keptDesigns(): Kept[] {
  try {
    const all: unknown = JSON.parse(stored(KEPT) ?? "[]");
    if (!Array.isArray(all)) return [];
    return all.filter(
      (one: Kept | null) =>
        typeof one?.id === "string" &&
        Number.isFinite(one.time) &&
        designIn(JSON.stringify(one.design ?? null)),
    );
  } catch {
    return [];
  }
}

/** Keep a design under its identifier, in place of an older state of it; other tabs keep theirs. */
export function keep(id: string, design: Design): Kept[] {
  const text = JSON.stringify(design);
  const others = keptDesigns().filter(
    (one) => one.id !== id && JSON.stringify(one.design) !== text,
  );
  const all = [{ id, time: Date.now(), design }, ...others].slice(0, MOST);
  // A browser's storage is limited: the oldest designs make room.
  while (!store(KEPT, JSON.stringify(all)) && all.length > 1) all.pop();
  return all;
}

/** How long ago something was, in words. */
export function since(time: number): string {
  const minutes = Math.max(0, Math.round((Date.now() - time) / 60_000));
  if (minutes < 1) return "just now";
  if (minutes < 120) return `${minutes} min ago`;
  if (minutes < 48 * 60) return `${Math.round(minutes / 60)} hours ago`;
  return `${Math.round(minutes / 60 / 24)} days ago`;
}
