// The states of a few cells as the corners of a cube, drawn flat, and cycles along its edges.

import type { Point } from "./design";

/** So many cells can be drawn; cycles of more are typed. */
export const DRAWN = 4;

// Where a cell takes a corner when it goes from 0 to 1; y is downward.
const STEPS: Record<number, Point[]> = {
  1: [[150, 0]],
  2: [
    [130, 65],
    [130, -65],
  ],
  3: [
    [110, 75],
    [130, 0],
    [110, -75],
  ],
  4: [
    [85, 95],
    [112, 32],
    [112, -32],
    [85, -95],
  ],
};

/** All states of so many cells, fewer cells at 1 first. */
export function statesOf(cells: number): string[] {
  const all = Array.from({ length: 2 ** cells }, (_, k) => k.toString(2).padStart(cells, "0"));
  return all.sort((a, b) => ones(a) - ones(b) || (a < b ? 1 : -1));
}

export const ones = (state: string): number => [...state].filter((one) => one === "1").length;

/** Where a state is drawn, the first one in the origin. */
export const placeOf = (state: string): Point =>
  [...state].reduce<Point>(
    ([x, y], one, cell) => {
      const [dx, dy] = STEPS[state.length][cell];
      return one === "1" ? [x + dx, y + dy] : [x, y];
    },
    [0, 0],
  );

/** The states to which an edge leads. */
export const neighbours = (state: string): string[] =>
  [...state].map((one, cell) => state.slice(0, cell) + (one === "1" ? "0" : "1") + state.slice(cell + 1));

/** The states that may come next: up to all cells at 1, and from there down to the first. */
export function following(way: string[]): string[] {
  const last = way.at(-1)!;
  const down = way.some((state) => !state.includes("0"));
  if (down && way.length > 1 && !last.includes("1")) return [];
  return neighbours(last).filter((state) => ones(state) > ones(last) !== down);
}

/** The states of a typed cycle; those that are no state of so many cells end it. */
export function wayIn(text: string, cells: number): string[] {
  const first = "0".repeat(cells);
  const states = text.split(">").map((one) => one.trim());
  if (states[0] !== first) return [first];
  const way = [first];
  for (const state of states.slice(1)) {
    if (!following(way).includes(state)) break;
    way.push(state);
  }
  return way;
}
