// Positions of the parts of a chain in its drawing [mm, y up], as stepwell.mechanism.layout computes them.

import type { BandTable, Point } from "./design";
import { row } from "./motion";
import type { View } from "./wire";

export type Line = [Point, Point];

/** The curve of an element in a square of side 1: the value of its corner, and its size, as travel and force. */
interface Symbol {
  origin: Point;
  size: Point;
  /** Height of zero force. */
  zero: number | null;
  curves: Point[][];
}

/** The sizes of a drawing, which Python computes [mm]. */
export interface Layout {
  reach: number;
  half_pair: number;
  half_block: number;
  box: number;
  rod: number;
  spans: number[];
  wall: Line[];
  /** Millimetres per unit of travel. */
  scale: number;
  edge: number;
  sides: number[];
  symbols: (Symbol | null)[];
}

/** Joint midpoints of a cell's inner and outer block, and the direction of its x across the stroke. */
export interface Frame {
  inner: Point;
  outer: Point;
  side: number;
}

export interface Pose {
  /** Left, bottom, right, top; the fixed one first. */
  blocks: number[][];
  frames: Frame[];
  levers: Line[];
  boxes: { cell: number; left: number; bottom: number; dot: Point }[];
  rods: Line[];
}

export const layoutOf = (view: View): Layout => view.layout;

/** An anchor of a cell as an offset in the drawing: y of the cell is along the stroke, x across it. */
export const turned = ([x, y]: Point, side: number): Point => [y, side * x];

/** The inverse of `turned`. */
export const inCell = ([x, y]: Point, side: number): Point => [side * y, x];

const plus = ([x, y]: Point, [dx, dy]: Point): Point => [x + dx, y + dy];

/** Ends of a band, p then q. */
export const bandEnds = ({ inner, outer, side }: Frame, { p_mm, q_mm }: BandTable): Line | null =>
  p_mm && q_mm ? [plus(inner, turned(p_mm, side)), plus(outer, turned(q_mm, side))] : null;

/** The lever of a cell as a vector [mm], by its travel from the stop 0: s = r (sin θ + sin θc). */
function leverAt({ lever_mm: r, limit_deg }: { lever_mm: number; limit_deg: number }, travel: number): Point {
  const along = Math.max(-r, Math.min(r, travel - r * Math.sin((limit_deg * Math.PI) / 180)));
  return [Math.sqrt(r * r - along * along), along];
}

/** Angle of every lever [°], by its travel. */
export const anglesAt = (view: View, at: number): number[] =>
  row(view, "travel", at).map((travel, i) => {
    const [x, y] = leverAt(view.cells[i], travel);
    return (Math.atan2(y, x) * 180) / Math.PI;
  });

const poses = new WeakMap<View, { at: number; pose: Pose }>();

/** All parts but the bands at a sample, or between two samples; the last of a view is kept. */
export function poseOf(view: View, at: number): Pose {
  const last = poses.get(view);
  if (last?.at === at) return last.pose;
  const pose = posed(view, at);
  poses.set(view, { at, pose });
  return pose;
}

function posed(view: View, at: number): Pose {
  const layout = layoutOf(view);
  const { reach, half_pair: pair, half_block: half, box, rod } = layout;
  const [travel, pull] = ["travel", "pull"].map((name) => row(view, name, at));
  const pose: Pose = { blocks: [], frames: [], levers: [], boxes: [], rods: [] };
  let inner: Point = [0, 0];
  let left = -reach;
  for (const [i, cell] of view.cells.entries()) {
    const side = layout.sides[i];
    const [right, y] = [inner[0] + reach, inner[1]];
    pose.blocks.push([left, y - half, right, y + half]);
    const symbol = layout.symbols[i];
    let outer: Point;
    if (symbol) {
      const [begin, end] = [right + rod, right + rod + box];
      left = end + rod + layout.scale * (travel[i] - symbol.origin[0]);
      outer = [left + reach, y];
      pose.rods.push([[right, y], [begin, y]], [[end, y], [left, y]]);
      const on = inSymbol(symbol, layout.edge, [travel[i], pull[pose.boxes.length]]);
      const bottom = y - box / 2;
      pose.boxes.push({ cell: i, left: begin, bottom, dot: [begin + box * on[0], bottom + box * on[1]] });
    } else {
      outer = plus(inner, turned(leverAt(cell, travel[i]), side));
      left = outer[0] - reach;
      for (const along of [-pair, pair]) pose.levers.push([plus(inner, [along, 0]), plus(outer, [along, 0])]);
    }
    pose.frames.push({ inner, outer, side });
    inner = plus(outer, [layout.spans[i], 0]);
  }
  pose.blocks.push([left, inner[1] - half, inner[0] + reach, inner[1] + half]);
  return pose;
}

function inSymbol({ origin, size }: Symbol, edge: number, place: Point): Point {
  return place.map((value, k) => {
    const share = Math.max(-edge, Math.min(1 + edge, (value - origin[k]) / size[k]));
    return edge + (1 - 2 * edge) * share;
  }) as Point;
}

/** Left, bottom, right, top of a whole motion [mm, y up]. */
function boundsOf(view: View): number[] {
  const { wall, box } = layoutOf(view);
  const xs = wall.flat().map(([x]) => x);
  const ys = wall.flat().map(([, y]) => y);
  const n = view.blocks.drive.length;
  for (let k = 0; k < n; k += Math.max(1, Math.floor(n / 40))) {
    const { blocks, boxes, frames } = poseOf(view, k);
    const bands = frames.flatMap((frame, i) =>
      view.cells[i].bands.flatMap((band: BandTable) => bandEnds(frame, band) ?? []),
    );
    for (const [x, y] of bands) [xs, ys].forEach((all, j) => all.push(j ? y : x));
    for (const [left, bottom, right, top] of blocks) {
      xs.push(left, right);
      ys.push(bottom, top);
    }
    for (const one of boxes) ys.push(one.bottom, one.bottom + box);
  }
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/** The same with room for the stroke arrow below and for anchors: upper left corner, width, height [mm, y down]. */
export function boxOf(view: View): number[] {
  const room = 0.5 * layoutOf(view).reach;
  const [left, bottom, right, top] = boundsOf(view);
  return [left - room, -top - room, right - left + 2 * room, top - bottom + 4.5 * room];
}
