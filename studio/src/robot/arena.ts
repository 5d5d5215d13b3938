// An arena as its file has it, and how it is edited: every edit makes a new one. All in mm.

import type { Point } from "../design";

export interface WallTable {
  from_mm: Point;
  to_mm: Point;
  thickness_mm?: number;
}

/** A cylinder, or the goal. */
export interface DiscTable {
  at_mm: Point;
  radius_mm?: number;
}

export interface Arena {
  title?: string;
  start_mm?: Point;
  heading_deg?: number;
  goal?: DiscTable;
  wall?: WallTable[];
  cylinder?: DiscTable[];
  [key: string]: unknown;
}

/** What is drawn on the floor by dragging. */
export type Tool = "wall" | "cylinder" | "goal";

// What an arena's file leaves out, as docs/design-files.md has it.
export const THICKNESS = 20;
export const RADIUS = 25;
export const GOAL_RADIUS = 150;

/** Something of an arena that is dragged as a whole or by one point of it. */
export interface Spot {
  kind: "wall" | "cylinder" | "goal" | "start";
  index: number;
  /** Of a wall an end; "all" moves the whole. */
  part: "from_mm" | "to_mm" | "all" | "rim";
}

export const keyOf = ({ kind, index }: Spot): string =>
  kind === "wall" || kind === "cylinder" ? `${kind}[${index}]` : kind;

export const nameOf = ({ kind, index, part }: Spot): string => {
  const what = kind === "wall" || kind === "cylinder" ? `${kind} ${index + 1}` : kind;
  return part === "from_mm"
    ? `first end of ${what}`
    : part === "to_mm"
      ? `second end of ${what}`
      : part === "rim"
        ? kind === "start"
          ? "heading at the start"
          : `rim of ${what}`
        : what;
};

const whole = (mm: number): number => Math.round(mm) + 0;
const plus = (a: Point, b: Point): Point => [whole(a[0] + b[0]), whole(a[1] + b[1])];

/** Where a spot is. */
export function placeOf(arena: Arena, { kind, index, part }: Spot): Point {
  if (kind === "start") {
    const [x, y] = arena.start_mm ?? [0, 0];
    const heading = ((arena.heading_deg ?? 0) * Math.PI) / 180;
    return part === "rim" ? [x + HEADING * Math.cos(heading), y + HEADING * Math.sin(heading)] : [x, y];
  }
  if (kind === "wall") {
    const wall = arena.wall![index];
    if (part === "from_mm" || part === "to_mm") return wall[part];
    return [(wall.from_mm[0] + wall.to_mm[0]) / 2, (wall.from_mm[1] + wall.to_mm[1]) / 2];
  }
  const disc = kind === "goal" ? arena.goal! : arena.cylinder![index];
  const radius = disc.radius_mm ?? (kind === "goal" ? GOAL_RADIUS : RADIUS);
  return part === "rim" ? [disc.at_mm[0] + radius, disc.at_mm[1]] : disc.at_mm;
}

/** How far from the start the heading is held [mm]. */
const HEADING = 170;

/** The arena with a spot elsewhere. */
export function moved(arena: Arena, spot: Spot, to: Point): Arena {
  const { kind, index, part } = spot;
  if (kind === "start") {
    if (part !== "rim") return { ...arena, start_mm: plus(to, [0, 0]) };
    const [x, y] = arena.start_mm ?? [0, 0];
    const heading = (Math.atan2(to[1] - y, to[0] - x) * 180) / Math.PI;
    return { ...arena, heading_deg: whole(heading) };
  }
  if (kind === "wall") {
    const wall = arena.wall![index];
    const middle = placeOf(arena, spot);
    const by: Point = [to[0] - middle[0], to[1] - middle[1]];
    const changed =
      part === "all"
        ? { ...wall, from_mm: plus(wall.from_mm, by), to_mm: plus(wall.to_mm, by) }
        : { ...wall, [part]: plus(to, [0, 0]) };
    return { ...arena, wall: arena.wall!.map((one, k) => (k === index ? changed : one)) };
  }
  const disc = kind === "goal" ? arena.goal! : arena.cylinder![index];
  const changed =
    part === "rim"
      ? { ...disc, radius_mm: Math.max(1, whole(distance(to, disc.at_mm))) }
      : { ...disc, at_mm: plus(to, [0, 0]) };
  if (kind === "goal") return { ...arena, goal: changed };
  return { ...arena, cylinder: arena.cylinder!.map((one, k) => (k === index ? changed : one)) };
}

/** The arena with one thing more, from where the hand went down to where it went up. */
export function added(arena: Arena, tool: Tool, from: Point, to: Point): Arena {
  const far = whole(distance(from, to));
  const [a, b] = [plus(from, [0, 0]), plus(to, [0, 0])];
  if (tool === "wall") {
    const wall = { from_mm: a, to_mm: b, thickness_mm: THICKNESS };
    return { ...arena, wall: [...(arena.wall ?? []), wall] };
  }
  const radius = far < 5 ? (tool === "goal" ? GOAL_RADIUS : RADIUS) : far;
  const disc = { at_mm: a, radius_mm: radius };
  if (tool === "goal") return { ...arena, goal: disc };
  return { ...arena, cylinder: [...(arena.cylinder ?? []), disc] };
}

/** The arena without one thing. */
export function without(arena: Arena, { kind, index }: Spot): Arena {
  if (kind === "goal") {
    const { goal: _, ...rest } = arena;
    return rest;
  }
  if (kind === "start") return arena;
  return { ...arena, [kind]: arena[kind]!.filter((_, k) => k !== index) };
}

/** Corners of a wall. */
export function corners({ from_mm: a, to_mm: b, thickness_mm: thick = THICKNESS }: WallTable): Point[] {
  const length = distance(a, b) || 1;
  const [x, y] = [((a[1] - b[1]) / length) * (thick / 2), ((b[0] - a[0]) / length) * (thick / 2)];
  return [
    [a[0] + x, a[1] + y],
    [b[0] + x, b[1] + y],
    [b[0] - x, b[1] - y],
    [a[0] - x, a[1] - y],
  ];
}

/** Everything that has to be in the picture. */
export function bounds(arena: Arena): Point[] {
  const discs = [...(arena.cylinder ?? []), ...(arena.goal ? [arena.goal] : [])];
  return [
    ...(arena.wall ?? []).flatMap(corners),
    ...discs.flatMap(({ at_mm: [x, y], radius_mm: r = RADIUS }): Point[] => [
      [x - r, y - r],
      [x + r, y + r],
    ]),
  ];
}

export const distance = (a: Point, b: Point): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
