// The solid parts of the chain: what is chosen of them, and where each is at the angles of all cells.

import type { Point } from "./design";
import type { View } from "./wire";

/** The body of a part: a block, a lever of a cell, the drive bar. */
export type Body = ["block", number] | ["lever", number, number] | ["bar"];

export interface Part {
  name: string;
  mark: string;
  layer: number;
  body: Body;
  width_mm: number;
  height_mm: number;
  mass_g: number;
  path: string;
}

export interface Fastener {
  name: string;
  use: string;
  size: string;
  block: number;
  at_mm: Point;
  diameter_mm: number;
}

export interface Band {
  name: string;
  cell: number;
  p_mm: Point;
  q_mm: Point;
  width_mm: number;
  holes: [string, string];
}

interface Joint {
  offset_mm: number;
  lever_mm: number;
  side: number;
}

/** Something drawn: its name, its path, its place; `holes` are round holes of a part. */
export interface Shape {
  name: string;
  path: string;
  holes: string;
  place: string;
  layer: number;
}

/** A set with one more, or one less. */
function turned(held: ReadonlySet<string>, one: string): ReadonlySet<string> {
  const now = new Set(held);
  if (!now.delete(one)) now.add(one);
  return now;
}

/** What was chosen last stays while another tab is open. */
class Parts {
  material = $state("acrylic-3mm");
  /** All materials, once they are known. */
  materials = $state.raw<{ name: string; title?: string }[]>([]);
  /** The hidden layers by role. */
  hidden = $state.raw<ReadonlySet<string>>(new Set());
  exploded = $state(false);
  /** How far the parts of a robot are apart, 0 to 1. */
  apart = $state(0);
  /** The antennas of a robot that are pressed, by name. */
  pressed = $state.raw<ReadonlySet<string>>(new Set());
  /** Whether a robot is shown as a whole, not the chain of one leg. */
  robot = $state(true);

  /** Shows or hides a layer. */
  turn(role: string): void {
    this.hidden = turned(this.hidden, role);
  }

  /** Presses an antenna, or lets it go. */
  press(antenna: string): void {
    this.pressed = turned(this.pressed, antenna);
  }
}

export const parts = new Parts();

/** The path of a circle [mm, y down]. */
export const circle = ([x, y]: Point, diameter: number): string => {
  const r = diameter / 2;
  return `M${x - r} ${-y}a${r} ${r} 0 1 0 ${diameter} 0a${r} ${r} 0 1 0 ${-diameter} 0Z`;
};

/** The round holes of each part as paths, from rows of part, x, y, diameter. */
export function holesOf(view: View): string[] {
  const rows: Float64Array = view.blocks.holes;
  const paths: string[] = view.parts.map(() => "");
  for (let k = 0; k < rows.length; k += 4) paths[rows[k]] += circle([rows[k + 1], rows[k + 2]], rows[k + 3]);
  return paths;
}

/** Places of all blocks [mm, y up] at angles of all cells [degrees], as `Layout.positions` of Python. */
function blocksAt(view: View, angles: number[]): Point[] {
  const places: Point[] = [[0, 0]];
  for (const [i, { offset_mm, lever_mm, side }] of (view.joints as Joint[]).entries()) {
    const theta = (angles[i] * Math.PI) / 180;
    const [x, y] = places[i];
    places.push([x + offset_mm + lever_mm * Math.sin(theta), y + side * lever_mm * Math.cos(theta)]);
  }
  return places;
}

/** All parts, fasteners and bands at angles of all cells [degrees]; the angles decide all places. */
export function shapesAt(view: View, holes: string[], angles: number[]): Shape[] {
  const at = blocksAt(view, angles);
  const moved = ([x, y]: Point): string => `translate(${x} ${-y})`;
  const place = ([kind, number, index]: Body): string => {
    if (kind === "bar") return moved([at.at(-1)![0] + view.bar_mm[0], view.bar_mm[1]]);
    if (kind === "block") return moved(at[number]);
    const { offset_mm, side } = view.joints[number];
    const theta = (angles[number] * Math.PI) / 180;
    const turn = (Math.atan2(side * Math.cos(theta), Math.sin(theta)) * 180) / Math.PI;
    const [x, y] = at[number];
    return `${moved([x + offset_mm + (index ? view.half_mm : -view.half_mm), y])} rotate(${-turn})`;
  };
  const above = view.layers.length;
  return [
    ...view.parts.map(({ name, layer, path, body }: Part, k: number) => ({
      ...{ name, path, layer },
      ...{ holes: holes[k], place: place(body) },
    })),
    ...view.fasteners.map(({ name, block, at_mm, diameter_mm }: Fastener) => ({
      ...{ name, holes: "", layer: above },
      ...{ path: circle(at_mm, diameter_mm), place: moved(at[block]) },
    })),
    ...view.bands.map(({ name, cell, p_mm, q_mm, width_mm }: Band) => {
      const [p, q] = [
        [at[cell][0] + p_mm[0], at[cell][1] + p_mm[1]],
        [at[cell + 1][0] + q_mm[0], at[cell + 1][1] + q_mm[1]],
      ];
      const length = Math.hypot(q[0] - p[0], q[1] - p[1]);
      const turn = (Math.atan2(q[1] - p[1], q[0] - p[0]) * 180) / Math.PI;
      return {
        ...{ name, holes: "", layer: above + 1 },
        ...{ path: loop(length, width_mm), place: `${moved(p as Point)} rotate(${-turn})` },
      };
    }),
  ];
}

/** A stretched band around two hooks along x. */
function loop(length: number, width: number): string {
  const r = width / 2;
  return `M0 ${-r}H${length}A${r} ${r} 0 0 1 ${length} ${r}H0A${r} ${r} 0 0 1 0 ${-r}Z`;
}
