// Paints designs of a study as points over two columns, or as bars over one, coloured by a third.

import { type Point, formatted } from "../design";
import { type Axis, type Frame, type Look, type Pen, type Reading, rangeOf } from "../plot";

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

const BARS = 24;

/** The name of a unit, as it is written. */
export const sign = (unit: string): string => ({ deg: "°", percent: "%" })[unit] ?? unit;

/** An axis with some space beside its values; words are at whole numbers and have letters. */
function axisOf({ name, unit, words, values }: Column, beside: number): Axis {
  if (!words) return { name, unit: sign(unit), range: rangeOf([finite(values)], beside) };
  const marks = words.slice(0, -1).map((_, k): [number, string] => [k, letterOf(k)]);
  return { name, unit: "", range: [-0.5, Math.max(0, words.length - 1) - 0.5], marks };
}

const finite = (values: ArrayLike<number>): number[] => Array.from(values).filter(Number.isFinite);

/** The designs of a cloud in the axes of its plot. */
export class Scatter {
  readonly x: Axis;
  readonly y: Axis;
  /** By bar and group, the number of designs. */
  readonly bars: number[][] = [];

  constructor(
    readonly cloud: Cloud,
    /** What the reading of a design says. */
    readonly text: (k: number) => string,
  ) {
    // Points at the ends are whole; bars end where designs do.
    this.x = axisOf(cloud.x, cloud.y ? 0.04 : 0);
    if (cloud.y) {
      this.y = axisOf(cloud.y, 0.04);
      return;
    }
    const { words, values } = cloud.x;
    const count = words ? words.length - 1 : Math.min(BARS, new Set(Array.from(values)).size);
    this.bars = Array.from({ length: Math.max(1, count) }, () => cloud.colours.map(() => 0));
    for (let k = 0; k < values.length; k += 1) {
      const bar = this.barOf(values[k]);
      if (bar >= 0 && cloud.group[k] >= 0) this.bars[bar][cloud.group[k]] += 1;
    }
    this.y = { name: "designs", unit: "", range: [0, 1.05 * Math.max(1, ...this.bars.map(total))] };
  }

  private barOf(value: number): number {
    const share = (value - this.x.range[0]) / (this.x.range[1] - this.x.range[0]);
    const count = this.bars.length;
    return Number.isFinite(share) ? Math.min(count - 1, Math.max(0, Math.floor(share * count))) : -1;
  }

  /** The lower and the upper value of a bar. */
  private ends(bar: number): Point {
    const [low, high] = this.x.range;
    return [0, 1].map((one) => low + ((bar + one) * (high - low)) / this.bars.length) as Point;
  }

  /** Where a design is; null where it has no such values, or there are bars. */
  place(k: number): Point | null {
    const { x, y } = this.cloud;
    if (!y) return null;
    const [a, b] = [jittered(x, k), jittered(y, k)];
    return Number.isFinite(a) && Number.isFinite(b) ? [a, b] : null;
  }

  private spot(k: number, frame: Frame): Point | null {
    const place = this.place(k);
    return place && [frame.across(place[0]), frame.up(place[1])];
  }

  /** The reading of a design. */
  of(k: number): Reading | null {
    const place = this.place(k);
    return place && { x: place[0], y: place[1], text: this.text(k), index: k };
  }

  /** The bar, or the design within 24 px, at a place of the screen. */
  read(at: Point, frame: Frame): Reading | null {
    if (!this.cloud.y) return this.ofBar(this.barOf(frame.at(at)[0]));
    let [best, least] = [-1, 24];
    for (let k = 0; k < this.cloud.x.values.length; k += 1) {
      const spot = this.spot(k, frame);
      const far = spot ? Math.hypot(spot[0] - at[0], spot[1] - at[1]) : Infinity;
      if (far < least) [best, least] = [k, far];
    }
    return best < 0 ? null : this.of(best);
  }

  private ofBar(bar: number): Reading | null {
    if (bar < 0) return null;
    const { words, name, unit } = this.cloud.x;
    const [low, high] = this.ends(bar);
    const of = words ? words[bar] || "none" : `${[low, high].map((one) => formatted(one)).join(" to ")} ${sign(unit)}`;
    const many = total(this.bars[bar]);
    return { x: (low + high) / 2, y: many, text: `${name} ${of}\n${many.toLocaleString("en")} designs`, index: bar };
  }

  /** The nearest design in a direction from another one, or the next bar. */
  towards(from: Reading | null, [dx, up]: Point, far: boolean, frame: Frame): Reading | null {
    if (!this.cloud.y) {
      return this.ofBar(Math.max(0, Math.min(this.bars.length - 1, from ? (from.index ?? 0) + dx : 0)));
    }
    const dy = -up;
    const here = from ? [frame.across(from.x), frame.up(from.y)] : [frame.wide / 2, frame.tall / 2];
    let [best, cost] = [-1, Infinity];
    for (let k = 0; k < this.cloud.x.values.length; k += 1) {
      const spot = k === from?.index ? null : this.spot(k, frame);
      if (!spot) continue;
      const [x, y] = [spot[0] - here[0], spot[1] - here[1]];
      const [along, beside] = from ? [x * dx + y * dy, Math.abs(x * dy - y * dx)] : [Math.hypot(x, y), 0];
      // Within a right angle to either side, what is straight ahead first.
      if (along <= (far ? 0.1 * frame.wide : 1e-6) || beside > along) continue;
      if (along + 2 * beside < cost) [best, cost] = [k, along + 2 * beside];
    }
    return best < 0 ? from : this.of(best);
  }

  paint(pen: Pen, frame: Frame, look: Look): void {
    const { cloud } = this;
    if (!cloud.y) return this.paintBars(pen, frame);
    const many = cloud.x.values.length;
    const size = many > 1500 ? 2 : many > 300 ? 2.7 : 4;
    pen.globalAlpha = many > 1500 ? 0.75 : 0.9;
    for (let k = 0; k < many; k += 1) {
      const spot = this.spot(k, frame);
      if (!spot) continue;
      pen.fillStyle = cloud.group[k] < 0 ? look.quiet : cloud.colours[cloud.group[k]];
      pen.beginPath();
      pen.arc(spot[0], spot[1], size, 0, 2 * Math.PI);
      pen.fill();
    }
    pen.globalAlpha = 1;
  }

  private paintBars(pen: Pen, frame: Frame): void {
    for (const [k, bar] of this.bars.entries()) {
      const [left, right] = this.ends(k).map((one) => frame.across(one));
      let foot = 0;
      for (const [group, many] of bar.entries()) {
        const [bottom, top] = [frame.up(foot), frame.up(foot + many)];
        pen.fillStyle = this.cloud.colours[group];
        pen.fillRect(left + 0.5, top, Math.max(1, right - left - 1), bottom - top);
        foot += many;
      }
    }
  }
}

const total = (bar: number[]): number => bar.reduce((a, b) => a + b, 0);

// Designs that say the same word would lie on one another, so they are spread a little, always alike.
function jittered({ words, values }: Column, k: number): number {
  if (!words) return values[k];
  const spread = ((k * 0.618034) % 1) - 0.5;
  return values[k] + 0.5 * spread;
}

export const letterOf = (k: number): string => (k < 26 ? String.fromCharCode(65 + k) : String(k + 1));
