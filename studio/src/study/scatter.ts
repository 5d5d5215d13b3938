// Paints designs of a study as points over two columns, or as bars over one, coloured by a third.

import { type Point } from "../design";
import { ticks } from "../plot";

/** A column of a study: its displayed values; for words, their indices in the list. */
export interface Column {
  name: string;
  unit: string;
  varied: boolean;
  words: string[] | null;
  values: ArrayLike<number>;
}

/** What is to be painted. */
export interface Cloud {
  x: Column;
  /** null shows how many designs there are of each x. */
  y: Column | null;
  /** The group of each design, by which it is coloured; -1 is shown by no colour. */
  group: ArrayLike<number>;
  colours: string[];
}

interface Look {
  ink: string;
  quiet: string;
  grid: string;
}

export const ROOM = { left: 54, right: 12, top: 10, bottom: 26 };
const BARS = 24;

/** Between which values a column is drawn, with so much room beside; words are at whole numbers. */
function range({ values, words }: Column, share: number): Point {
  if (words) return [-0.5, Math.max(0, words.length - 1) - 0.5];
  let [low, high] = [Infinity, -Infinity];
  for (let k = 0; k < values.length; k += 1) {
    if (values[k] < low) low = values[k];
    if (values[k] > high) high = values[k];
  }
  if (!Number.isFinite(low)) return [0, 1];
  const room = high > low ? share * (high - low) : Math.abs(low) || 1;
  return [low - room, high + room];
}

/** Where everything lies. */
export class Frame {
  readonly x: Point;
  readonly y: Point;
  /** By bar and group, how many designs. */
  readonly bars: number[][] = [];

  constructor(
    readonly cloud: Cloud,
    readonly wide: number,
    readonly tall: number,
  ) {
    // Points at the ends are whole; bars end where designs do.
    this.x = range(cloud.x, cloud.y ? 0.04 : 0);
    if (cloud.y) {
      this.y = range(cloud.y, 0.04);
      return;
    }
    const count = this.classes();
    this.bars = Array.from({ length: count }, () => cloud.colours.map(() => 0));
    for (let k = 0; k < cloud.x.values.length; k += 1) {
      const bar = this.barOf(cloud.x.values[k]);
      if (bar >= 0 && cloud.group[k] >= 0) this.bars[bar][cloud.group[k]] += 1;
    }
    this.y = [0, 1.05 * Math.max(1, ...this.bars.map((bar) => bar.reduce((a, b) => a + b, 0)))];
  }

  private classes(): number {
    const { words, values } = this.cloud.x;
    if (words) return Math.max(1, words.length - 1);
    const levels = new Set(Array.from(values));
    return Math.max(1, Math.min(BARS, levels.size));
  }

  private barOf(value: number): number {
    const share = (value - this.x[0]) / (this.x[1] - this.x[0]);
    const count = this.bars.length;
    return Number.isFinite(share) ? Math.min(count - 1, Math.max(0, Math.floor(share * count))) : -1;
  }

  /** Where a value lies on the screen. */
  across(value: number): number {
    const share = (value - this.x[0]) / (this.x[1] - this.x[0]);
    return ROOM.left + share * (this.wide - ROOM.left - ROOM.right);
  }

  up(value: number): number {
    const share = (value - this.y[0]) / (this.y[1] - this.y[0]);
    return this.tall - ROOM.bottom - share * (this.tall - ROOM.top - ROOM.bottom);
  }

  /** Where a design lies on the screen; null where it has no such values, or there are bars. */
  spot(k: number): Point | null {
    const { x, y } = this.cloud;
    if (!y) return null;
    const [a, b] = [this.across(jittered(x, k)), this.up(jittered(y, k))];
    return Number.isFinite(a) && Number.isFinite(b) ? [a, b] : null;
  }

  /** The design nearest to a place of the screen, within so many pixels; -1 where there is none. */
  nearest([px, py]: Point, within: number): number {
    let [best, least] = [-1, within];
    for (let k = 0; k < this.cloud.x.values.length; k += 1) {
      const spot = this.spot(k);
      const far = spot ? Math.hypot(spot[0] - px, spot[1] - py) : Infinity;
      if (far < least) [best, least] = [k, far];
    }
    return best;
  }

  /** The nearest design in a direction from another one; itself where there is none. */
  towards(from: number, [dx, dy]: Point, least = 0): number {
    const here = this.spot(from);
    if (!here) return this.nearest([this.wide / 2, this.tall / 2], Infinity);
    let [best, cost] = [from, Infinity];
    for (let k = 0; k < this.cloud.x.values.length; k += 1) {
      const spot = k === from ? null : this.spot(k);
      if (!spot) continue;
      const [x, y] = [spot[0] - here[0], spot[1] - here[1]];
      const [along, beside] = [x * dx + y * dy, Math.abs(x * dy - y * dx)];
      // Within a right angle to either side, what is straight ahead first.
      if (along <= Math.max(1e-6, least) || beside > along) continue;
      if (along + 2 * beside < cost) [best, cost] = [k, along + 2 * beside];
    }
    return best;
  }
}

// Designs that say the same word would lie on one another, so they are spread a little, always alike.
function jittered({ words, values }: Column, k: number): number {
  if (!words) return values[k];
  const spread = ((k * 0.618034) % 1) - 0.5;
  return values[k] + 0.5 * spread;
}

export function paintCloud(canvas: HTMLCanvasElement, frame: Frame, look: Look): void {
  const { wide, tall, cloud } = frame;
  const ratio = devicePixelRatio || 1;
  canvas.width = Math.round(wide * ratio);
  canvas.height = Math.round(tall * ratio);
  const pen = canvas.getContext("2d")!;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, wide, tall);
  pen.font = "12px system-ui, sans-serif";
  pen.fillStyle = look.quiet;
  pen.strokeStyle = look.grid;
  pen.lineWidth = 1;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [y, text] of marks(cloud.y, frame.y, tall / 50)) {
    const at = Math.round(frame.up(y)) + 0.5;
    pen.beginPath();
    pen.moveTo(ROOM.left, at);
    pen.lineTo(wide - ROOM.right, at);
    pen.stroke();
    pen.fillText(text, ROOM.left - 6, at);
  }
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const [x, text] of marks(cloud.x, frame.x, wide / 90)) pen.fillText(text, frame.across(x), tall - ROOM.bottom + 6);

  if (!cloud.y) {
    frame.bars.forEach((bar, k) => {
      const ends = [k, k + 1].map((one) => frame.across(frame.x[0] + (one * (frame.x[1] - frame.x[0])) / frame.bars.length));
      let foot = 0;
      bar.forEach((many, group) => {
        pen.fillStyle = cloud.colours[group];
        pen.fillRect(ends[0] + 0.5, frame.up(foot + many), ends[1] - ends[0] - 1, frame.up(foot) - frame.up(foot + many));
        foot += many;
      });
    });
    return;
  }
  const many = cloud.x.values.length;
  const size = many > 1500 ? 2 : many > 300 ? 2.7 : 4;
  pen.globalAlpha = many > 1500 ? 0.75 : 0.9;
  for (let k = 0; k < many; k += 1) {
    const spot = frame.spot(k);
    if (!spot) continue;
    pen.fillStyle = cloud.group[k] < 0 ? look.quiet : cloud.colours[cloud.group[k]];
    pen.beginPath();
    pen.arc(spot[0], spot[1], size, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.globalAlpha = 1;
}

// Words are listed next to the picture; on an axis they have letters.
function marks(column: Column | null, [low, high]: Point, about: number): [number, string][] {
  if (column?.words) return column.words.slice(0, -1).map((_, k) => [k, letterOf(k)]);
  return ticks(low, high, Math.max(2, about))
    .filter((one) => one >= low && one <= high)
    .map((one) => [one, String(one).replace("-", "−")]);
}

export const letterOf = (k: number): string => (k < 26 ? String.fromCharCode(65 + k) : String(k + 1));
