// Reads the samples of a cycle: where everything is at the cursor, and how play passes through it.

import type { Point } from "./design";
import type { View } from "./wire";

/** How long a snap is shown, though it takes next to no time [ms]. */
export const SNAP_MS = 700;
/** How long the cycle takes without its snaps [ms]. */
export const CYCLE_MS = 7000;

/** True where the next sample is the landing of a snap. */
export const snaps = (view: View, k: number): boolean =>
  k + 1 < view.blocks.segment.length &&
  view.blocks.segment[k] !== view.blocks.segment[k + 1] &&
  view.events.some(
    (event: { kind: string; sample: number }) => event.kind === "snap" && event.sample === k,
  );

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

/** The midpoints of all blocks, the fixed one first [mm]. */
export function midpoints(view: View, at: number): Point[] {
  const angle = row(view, "angle", at);
  const travel = row(view, "travel", at);
  const points: Point[] = [[0, 0]];
  let [x, y] = [0, 0];
  for (const [i, cell] of view.cells.entries()) {
    if (cell.kind === "lever") {
      const theta = (angle[i] * Math.PI) / 180;
      x += cell.lever_mm * Math.cos(theta);
      y += cell.lever_mm * Math.sin(theta);
    } else {
      x += width(view);
      y += travel[i] * scale(view);
    }
    points.push([x, y]);
  }
  return points;
}

/** What a whole motion takes up: x and y of its upper left corner, width, height [mm, y down]. */
export function boxOf(view: View): number[] {
  let [left, right, low, high] = [-0.35 * width(view), 0, 0, 0];
  const n = view.blocks.drive.length;
  const hold = (x: number, y: number, room: number): void => {
    [left, right] = [Math.min(left, x - room), Math.max(right, x + room)];
    [low, high] = [Math.min(low, y - room), Math.max(high, y + room)];
  };
  for (let k = 0; k < n; k += Math.max(1, Math.floor(n / 40))) {
    const middles = midpoints(view, k);
    for (const [i, [x, y]] of middles.entries()) {
      hold(x, y, width(view) / 2);
      for (const { p_mm: p } of view.cells[i]?.bands ?? []) hold(x + p[0], y + p[1], 0);
      for (const { q_mm: q } of view.cells[i - 1]?.bands ?? []) hold(x + q[0], y + q[1], 0);
    }
  }
  const room = 5;
  return [left - room, -high - room, right - left + 2 * room, high - low + 2 * room];
}

/** How wide an element is drawn [mm]. */
export const width = (view: View): number =>
  Math.max(0, ...view.cells.map((cell: { lever_mm: number | null }) => cell.lever_mm ?? 0)) || 15;

// Chains without levers have no size of their own: their longest travel is drawn as 20 mm.
export const scale = (view: View): number =>
  view.cells.some((cell: { kind: string }) => cell.kind === "lever")
    ? 1
    : 20 / Math.max(...view.cells.map((cell: { full_travel_mm: number }) => cell.full_travel_mm));

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
