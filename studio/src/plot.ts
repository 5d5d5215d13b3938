// Axes, ticks and places of a plot: each plot of the page is painted inside one frame.

import type { Point } from "./design";

/** One axis: its name, its unit if it has one, and the values between which it lies. */
export interface Axis {
  name: string;
  unit: string;
  range: Point;
  /** Values with words beside them; round numbers by default. */
  marks?: [number, string][];
}

/** A value and event at a place of the axes, in words. */
export interface Reading {
  x: number;
  y: number;
  text: string;
  /** Index of a line or point, where the reading belongs to one. */
  line?: number;
  index?: number;
}

/** What a plot is painted with: a canvas, or the recorder of an SVG file. */
export type Pen = Pick<
  CanvasRenderingContext2D,
  | "strokeStyle" | "fillStyle" | "lineWidth" | "lineJoin" | "globalAlpha" | "font" | "textAlign" | "textBaseline"
  | "beginPath" | "moveTo" | "lineTo" | "arc" | "rect" | "stroke" | "fill" | "fillRect" | "strokeRect"
  | "fillText" | "strokeText" | "setLineDash" | "save" | "restore" | "clip"
> & { drawImage(image: HTMLCanvasElement, x: number, y: number, w: number, h: number): void };

export interface Look {
  ink: string;
  quiet: string;
  grid: string;
  paper: string;
}

export const LOOKS: Record<"light" | "dark", Look> = {
  light: { ink: "#1f2328", quiet: "#5c636b", grid: "#e9e7e1", paper: "#ffffff" },
  dark: { ink: "#e8e6e1", quiet: "#a5a8ad", grid: "#2c3238", paper: "#1b2025" },
};

export const FONT = "12px system-ui, sans-serif";
const [LEFT, RIGHT, TOP, BOTTOM] = [50, 12, 22, 34];

/** Name and unit of an axis. */
export const worded = ({ name, unit }: Axis): string => (unit ? `${name} [${unit}]` : name);

/** Where values lie on the screen. */
export class Frame {
  /** Left, top, width and height of the space inside the axes [px]. */
  readonly inner: [number, number, number, number];
  // Values at the lower left corner, its place, and pixels per unit: each sample of a curve needs them.
  private readonly x0: number;
  private readonly y0: number;
  private readonly bottom: number;
  private readonly perX: number;
  private readonly perY: number;

  constructor(
    readonly x: Axis,
    readonly y: Axis,
    readonly wide: number,
    readonly tall: number,
    /** Free space above the plot, where a file has its title. */
    readonly above = 0,
  ) {
    const top = above + TOP;
    this.inner = [LEFT, top, Math.max(1, wide - LEFT - RIGHT), Math.max(1, tall - top - BOTTOM)];
    [this.x0, this.y0, this.bottom] = [x.range[0], y.range[0], top + this.inner[3]];
    this.perX = this.inner[2] / (x.range[1] - this.x0);
    this.perY = this.inner[3] / (y.range[1] - this.y0);
  }

  across(x: number): number {
    return LEFT + (x - this.x0) * this.perX;
  }

  up(y: number): number {
    return this.bottom - (y - this.y0) * this.perY;
  }

  /** The values at a place of the screen. */
  at([px, py]: Point): Point {
    return [this.x0 + (px - LEFT) / this.perX, this.y0 + (this.bottom - py) / this.perY];
  }

  holds({ x, y }: { x: number; y: number }): boolean {
    const within = (value: number, [low, high]: Point): boolean =>
      value >= low - 1e-9 * (high - low) && value <= high + 1e-9 * (high - low);
    return within(x, this.x.range) && within(y, this.y.range);
  }
}

/** Where a pointer is in the plot [px]. */
export function pixelOf(event: MouseEvent): Point {
  const { left, top } = (event.currentTarget as Element).closest(".surface")!.getBoundingClientRect();
  return [event.clientX - left, event.clientY - top];
}

/** Round numbers between two, about so many and at least three. */
export function ticks(low: number, high: number, about: number): number[] {
  const raw = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const steps = [10, 5, 2.5, 2, 1, 0.5].map((one) => one * power);
  const least = steps.findLast((one) => one >= raw * 0.999)!;
  const ends = (step: number): number[] => [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  const step = steps.find((one) => one <= least && ends(one)[1] - ends(one)[0] >= 2) ?? steps.at(-1)!;
  const [first, last] = ends(step);
  return Array.from({ length: last - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
}

function marksOf({ marks, range: [low, high] }: Axis, about: number): [number, string][] {
  const all = marks ?? ticks(low, high, Math.max(2, about)).map((one): [number, string] => [one, written(one)]);
  return all.filter(([value]) => value >= low - 1e-9 * (high - low) && value <= high + 1e-9 * (high - low));
}

/** Paints the axes with their names and marks. */
export function paintAxes(pen: Pen, frame: Frame, look: Look): void {
  const [left, top, wide, tall] = frame.inner;
  pen.font = FONT;
  pen.lineWidth = 1;
  pen.fillStyle = look.quiet;
  pen.strokeStyle = look.grid;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [y, text] of marksOf(frame.y, frame.tall / 55)) {
    pen.beginPath();
    pen.moveTo(left, Math.round(frame.up(y)) + 0.5);
    pen.lineTo(left + wide, Math.round(frame.up(y)) + 0.5);
    pen.stroke();
    pen.fillText(text, left - 6, frame.up(y));
  }
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const [x, text] of marksOf(frame.x, frame.wide / 80)) pen.fillText(text, frame.across(x), top + tall + 5);
  pen.textAlign = "right";
  pen.textBaseline = "bottom";
  pen.fillText(worded(frame.x), left + wide, top + tall + BOTTOM - 1);
  pen.textAlign = "left";
  pen.textBaseline = "top";
  pen.font = `600 ${FONT.replace("12", "13")}`;
  pen.fillStyle = look.ink;
  pen.fillText(worded(frame.y), 4, frame.above + 2);
}

/** The least and the greatest of all values, with a part of their distance beside each. */
export function rangeOf(values: ArrayLike<number>[], beside = 0): Point {
  let [low, high] = [Infinity, -Infinity];
  for (const all of values) {
    for (let k = 0; k < all.length; k += 1) {
      if (all[k] < low) low = all[k];
      if (all[k] > high) high = all[k];
    }
  }
  const half = Math.abs(low) || 1;
  if (!(high > low)) return Number.isFinite(low) ? [low - half, low + half] : [0, 1];
  return [low - beside * (high - low), high + beside * (high - low)];
}

const written = (value: number): string => String(value).replace("-", "−");
