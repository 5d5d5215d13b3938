// Where the states of a graph stand, and the curves between them.

import type { Point } from "./design";

export interface Way {
  from: string;
  to: string;
  /** +1 loading, -1 unloading. */
  direction: number;
}

export interface Layout {
  places: Map<string, Point>;
  /** Of a state's pill. */
  wide: number;
  tall: number;
  width: number;
}

/**
 * A column for each number of cells that have moved, from none at the left to all at the right.
 *
 * @param labels of the states: 0, 1 and - a cell, and after a blank or the like what tells two
 * stretches of one state apart.
 */
export function layoutOf(nodes: { label: string; state: string }[]): Layout {
  const columns = new Map<number, string[]>();
  for (const { label, state } of nodes) {
    // A cell on its way counts half.
    const moved = [...state].reduce((sum, one) => sum + (one === "-" ? 0.5 : Number(one)), 0);
    columns.set(moved, [...(columns.get(moved) ?? []), label]);
  }
  const ordered = [...columns].sort(([a], [b]) => a - b).map(([, column]) => column);
  const wide = Math.max(2, ...nodes.map(({ label }) => label.length)) * 9 + 24;
  const tall = Math.max(1, ...ordered.map((column) => column.length)) * 50;
  const places = new Map<string, Point>();
  ordered.forEach((column, i) =>
    column.forEach((label, k) =>
      places.set(label, [wide / 2 + 4 + i * (wide + 66), (tall * (k + 0.5)) / column.length]),
    ),
  );
  return { places, wide, tall, width: ordered.length * (wide + 66) - 58 };
}

/** The curve of a way from the side of one pill to that of another. */
export function curveOf({ places, wide }: Layout, way: Way): string {
  const [from, to] = [places.get(way.from), places.get(way.to)];
  if (!from || !to) return "";
  const side = Math.sign(to[0] - from[0]) || way.direction;
  const half = wide / 2;
  const bend = way.direction > 0 ? -7 : 7;
  if (to[0] === from[0]) {
    const out = half + 34;
    return `M${from[0] + side * half} ${from[1]} C${from[0] + side * out} ${from[1]} ${to[0] + side * out} ${to[1]} ${to[0] + side * (half + 5)} ${to[1]}`;
  }
  const [x0, y0] = [from[0] + side * half, from[1] + bend];
  const [x1, y1] = [to[0] - side * (half + 6), to[1] + bend];
  const middle = (x0 + x1) / 2;
  return `M${x0} ${y0} C${middle} ${y0 + bend} ${middle} ${y1 + bend} ${x1} ${y1}`;
}
