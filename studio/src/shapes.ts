// How elements are drawn: what moves in each, not its sizes.

import type { CellTable, Point } from "./design";

/** Paths of what carries and of what gives. */
export interface Shape {
  frame: string;
  spring: string;
}

type Draw = (a: Point, b: Point, full: number, most: number) => Shape;

const at = (x: number, y: number): string => `${x.toFixed(3)} ${(-y).toFixed(3)}`;

// Two pivots on a frame of the inner block, and a middle that goes with the outer one.
function across(a: Point, b: Point, pivot: number): { frame: string; one: Point; mid: Point; two: Point } {
  const wide = b[0] - a[0];
  const one: Point = [a[0] + 0.12 * wide, pivot];
  const two: Point = [a[0] + 0.88 * wide, pivot];
  const mid: Point = [a[0] + 0.5 * wide, b[1]];
  const frame = `M${at(...a)} L${at(...one)} L${at(...two)} M${at(...mid)} L${at(...b)}`;
  return { frame, one, mid, two };
}

const truss: Draw = (a, b, full) => {
  const { frame, one, mid, two } = across(a, b, a[1] + full / 2);
  return { frame, spring: `M${at(...one)} L${at(...mid)} L${at(...two)}` };
};

const beam: Draw = (a, b, full) => {
  const { frame, one, mid, two } = across(a, b, a[1] + full / 2);
  const quarter = (mid[0] - one[0]) / 2;
  const left = `C${at(one[0] + quarter, one[1])} ${at(mid[0] - quarter, mid[1])} ${at(...mid)}`;
  const right = `C${at(mid[0] + quarter, mid[1])} ${at(two[0] - quarter, two[1])} ${at(...two)}`;
  return { frame, spring: `M${at(...one)} ${left} ${right}` };
};

const dome: Draw = (a, b, full) => {
  const { frame, one, mid, two } = across(a, b, a[1] + full);
  return { frame, spring: `M${at(...one)} Q${at(mid[0], 2 * mid[1] - one[1])} ${at(...two)}` };
};

// Its radius goes with the third root of its volume.
const balloon: Draw = (a, b, full, most) => {
  const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const share = Math.max(0, (b[1] - a[1]) / (full || 1));
  const r = (0.12 + 0.38 * Math.cbrt(share)) * (b[0] - a[0]) * Math.cbrt(full / (most || 1));
  const frame = `M${at(...a)} L${at(x - r, y)} M${at(x + r, y)} L${at(...b)}`;
  const arc = `A${r} ${r} 0 0 1`;
  return { frame, spring: `M${at(x - r, y)} ${arc} ${at(x + r, y)} ${arc} ${at(x - r, y)}` };
};

const kresling: Draw = (a, b) => {
  const wide = b[0] - a[0];
  const [low, high] = [a[1] - 0.12 * wide, b[1] + 0.12 * wide];
  const xs = [0.15, 0.38, 0.62, 0.85].map((part) => a[0] + part * wide);
  const creases = xs.slice(1).map((x, k) => `M${at(xs[k], low)} L${at(xs[k], high)} L${at(x, low)}`);
  const rung = (y: number): string => `M${at(xs[0], y)} L${at(xs[3], y)}`;
  const ends = `M${at(...a)} L${at(xs[0], low)} M${at(xs[3], high)} L${at(...b)}`;
  return { frame: ends, spring: `${rung(low)} ${rung(high)} ${creases.join(" ")} M${at(xs[3], low)} L${at(xs[3], high)}` };
};

// A zigzag with a straight end on either side.
const zigzag: Draw = (a, b) => {
  const bends = Array.from({ length: 7 }, (_, k) => {
    const share = (k + 1.5) / 9;
    const off = k === 0 || k === 6 ? 0 : k % 2 ? -2.2 : 2.2;
    return `L${at(a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share + off)}`;
  });
  return { frame: "", spring: `M${at(...a)} ${bends.join(" ")} L${at(...b)}` };
};

// Those with a picture of their own; all others are springs.
const DRAWN: Record<string, Draw> = {
  von_mises_truss: truss,
  curved_beam: beam,
  dome,
  balloon,
  kresling,
};

/**
 * An element between the midpoints of its blocks.
 *
 * @param full its full travel as it is drawn [mm].
 * @param most the longest of the chain as it is drawn [mm].
 */
export function shapeOf(cell: CellTable | undefined, a: Point, b: Point, full: number, most: number): Shape {
  const form = Object.keys(DRAWN).find((one) => cell?.[one]);
  return (form ? DRAWN[form] : zigzag)(a, b, full, most);
}
