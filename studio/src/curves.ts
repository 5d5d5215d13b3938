// Curves of a plot: lines that stop where a segment ends, dots, one cursor, and what is read there.

import { type Point, formatted } from "./design";
import { type Frame, type Look, type Pen, type Reading, rangeOf } from "./plot";

/** One line; where `segment` changes, nothing is drawn. */
export interface Line {
  x: ArrayLike<number>;
  y: ArrayLike<number>;
  segment?: ArrayLike<number>;
  /** +1 loading, -1 unloading, which is drawn thinner. */
  direction?: ArrayLike<number>;
  colour: string;
  /** What the reading calls it, if there are several. */
  name?: string;
  /** A curve for comparison: faint and dashed. */
  ghost?: boolean;
}

/** A marked point: hollow where a snap begins, full where it ends, or an event without a mark. */
export interface Dot {
  x: number;
  y: number;
  colour: string;
  kind: "from" | "to" | "event";
  /** The event in words, and its sample. */
  text?: () => string;
  index?: number;
}

/** An axis without its range, which follows from the lines. */
export interface Quantity {
  name: string;
  unit: string;
}

export interface Curves {
  x: Quantity;
  y: Quantity;
  lines: Line[];
  dots: Dot[];
}

/** The present sample: a line at its x, if it has one, and a ball on each curve. */
export interface Cursor {
  x?: number;
  balls: { x: number; y: number; colour: string }[];
}

// From an event so near the pointer the reading is of the event [px].
const NEAR = 8;
// Radius of a dot [px].
const DOT = 3.2;

export const rangesOf = ({ lines }: Curves): [Point, Point] => [
  rangeOf(lines.map((line) => line.x)),
  rangeOf(lines.map((line) => line.y), 0.06),
];

/** Whether a line leads from the sample before to this one. */
const joined = ({ segment, direction }: Line, k: number): boolean =>
  k > 0 && (!segment || segment[k] === segment[k - 1]) && (!direction || direction[k] === direction[k - 1]);

export function paintCurves(pen: Pen, { lines, dots }: Curves, frame: Frame, { paper }: Look): void {
  pen.lineJoin = "round";
  // All of unloading lies under all of loading, so that no thin line cuts a thick one.
  for (const way of [-1, 1]) {
    for (const line of lines) {
      const { x, y, direction, colour, ghost } = line;
      pen.strokeStyle = colour;
      pen.lineWidth = way < 0 ? 1.3 : 2.4;
      pen.globalAlpha = ghost ? 0.45 : 1;
      pen.setLineDash(ghost ? [5, 4] : []);
      pen.beginPath();
      for (let k = 0; k < x.length; k += 1) {
        if ((direction?.[k] ?? 1) !== way) continue;
        if (joined(line, k)) pen.lineTo(frame.across(x[k]), frame.up(y[k]));
        else pen.moveTo(frame.across(x[k]), frame.up(y[k]));
      }
      pen.stroke();
    }
  }
  pen.globalAlpha = 1;
  pen.setLineDash([]);
  // All dots of a look are one path, which takes a browser much less time than one path each.
  const marked = dots.filter((dot) => dot.kind !== "event");
  pen.lineWidth = 1.5;
  for (const look of new Set(marked.map((dot) => `${dot.kind} ${dot.colour}`))) {
    const [kind, colour] = look.split(" ");
    [pen.fillStyle, pen.strokeStyle] = [kind === "from" ? paper : colour, colour];
    pen.beginPath();
    for (const dot of marked) {
      if (dot.kind !== kind || dot.colour !== colour) continue;
      const [x, y] = [frame.across(dot.x), frame.up(dot.y)];
      pen.moveTo(x + DOT, y);
      pen.arc(x, y, DOT, 0, 2 * Math.PI);
    }
    pen.fill();
    pen.stroke();
  }
}

/** Paints the cursor, which on the page is drawn over the curves: they stay while it moves. */
export function paintCursor(pen: Pen, { x, balls }: Cursor, frame: Frame, look: Look): void {
  const [, top, , tall] = frame.inner;
  if (x !== undefined) {
    pen.strokeStyle = look.quiet;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(frame.across(x), top);
    pen.lineTo(frame.across(x), top + tall);
    pen.stroke();
  }
  for (const ball of balls.filter((one) => frame.holds(one))) {
    pen.beginPath();
    pen.arc(frame.across(ball.x), frame.up(ball.y), 5.5, 0, 2 * Math.PI);
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [ball.colour, look.paper, 2];
    pen.fill();
    pen.stroke();
  }
}

/** The values and the event at the place of a line nearest to a pointer. */
export function readCurves(curves: Curves, [px, py]: Point, frame: Frame): Reading | null {
  let best: Reading | null = null;
  let least = Infinity;
  for (const [l, line] of curves.lines.entries()) {
    if (line.ghost) continue;
    let [ax, ay] = [NaN, NaN];
    for (let k = 0; k < line.x.length; k += 1) {
      const [bx, by] = [frame.across(line.x[k]), frame.up(line.y[k])];
      const [dx, dy] = joined(line, k) ? [ax - bx, ay - by] : [0, 0];
      const length = dx * dx + dy * dy;
      const part = length ? Math.max(0, Math.min(1, ((px - bx) * dx + (py - by) * dy) / length)) : 0;
      const far = Math.hypot(bx + part * dx - px, by + part * dy - py);
      if (far < least) {
        const [x, y] = frame.at([bx + part * dx, by + part * dy]);
        [least, best] = [far, { x, y, text: "", line: l, index: k }];
      }
      [ax, ay] = [bx, by];
    }
  }
  const event = curves.dots.find(
    (dot) => dot.text && Math.hypot(frame.across(dot.x) - px, frame.up(dot.y) - py) < NEAR,
  );
  if (event && best) best = { ...best, x: event.x, y: event.y };
  return best && worded(curves, best, event ? [event] : []);
}

/** The next sample of the same line, or the sample of another line at the same x, by an arrow key. */
export function stepCurves(curves: Curves, from: Reading | null, [dx, dy]: Point, far: boolean): Reading | null {
  const own = curves.lines.map((_, l) => l).filter((l) => !curves.lines[l].ghost);
  if (!own.length) return null;
  const l = from?.line ?? own[0];
  if (dy) {
    const next = own[(own.indexOf(l) - Math.sign(dy) + own.length) % own.length];
    return sampled(curves, next, Math.min(from?.index ?? 0, curves.lines[next].x.length - 1));
  }
  const last = curves.lines[l].x.length - 1;
  const step = dx * (far ? Math.max(1, Math.round(last / 20)) : 1);
  return sampled(curves, l, from ? Math.max(0, Math.min(last, (from.index ?? 0) + step)) : 0);
}

function sampled(curves: Curves, line: number, index: number): Reading {
  const [x, y] = [curves.lines[line].x[index], curves.lines[line].y[index]];
  return worded(curves, { x, y, text: "", line, index }, curves.dots.filter((dot) => dot.index === index && dot.y === y));
}

function worded({ x, y, lines }: Curves, reading: Reading, events: Dot[]): Reading {
  const { name, direction } = lines[reading.line!];
  const values = [[x, reading.x], [y, reading.y]] as const;
  const parts = values.map(([of, value]) => `${of.name} ${formatted(value)} ${of.unit}`.trim());
  const half = direction && (direction[reading.index!] > 0 ? "loading" : "unloading");
  const about = [name, half].filter(Boolean).join(", ");
  const text = [parts.join(", "), about, ...new Set(events.map((dot) => dot.text?.()))].filter(Boolean).join("\n");
  return { ...reading, text };
}
