// What a robot looks like from above: its parts, turned and moved, without their heights.

import type { Point } from "../design";

type Vec3 = number[];

/** A part that keeps its shape, on a body that moves. */
export interface Part {
  shape: "box" | "ball" | "rod";
  body: number;
  size_mm: Vec3;
  at_mm: Vec3;
  turn: number[];
  colour: string;
  opacity: number;
}

/** A lever, a link or a band. */
export interface Line {
  bodies: [number, number];
  at_mm: [Vec3, Vec3];
  leg: number | null;
  cell: number | null;
  colour: string;
}

/** Where all bodies are at one sample. */
export interface Pose {
  place: ArrayLike<number>;
  turn: ArrayLike<number>;
}

/** A vector turned by a quaternion w, x, y, z. */
export function turned([w, x, y, z]: ArrayLike<number> & Iterable<number>, v: Vec3): Vec3 {
  const [a, b, c] = v;
  const [p, q, r] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p];
}

/** Where a point of a body is [mm]. */
export function pointOf(pose: Pose, body: number, at: Vec3): Vec3 {
  const turn = Array.from({ length: 4 }, (_, k) => pose.turn[4 * body + k]);
  const moved = turned(turn, at);
  return moved.map((part, k) => part + pose.place[3 * body + k]);
}

/** Where the body's frame is: its origin [mm] and its heading [rad]. */
export function frameOf(pose: Pose): { origin: Point; heading: number } {
  const origin = pointOf(pose, 0, [0, 0, 0]);
  const ahead = pointOf(pose, 0, [1, 0, 0]);
  return {
    origin: [origin[0], origin[1]],
    heading: Math.atan2(ahead[1] - origin[1], ahead[0] - origin[0]),
  };
}

/** The outline of a box from above, y down. */
export function outline(pose: Pose, part: Part): string {
  const signs = [-1, 1];
  const corners = signs.flatMap((i) =>
    signs.flatMap((j) =>
      signs.map((k) => corner(pose, part, [i, j, k].map((sign, axis) => sign * part.size_mm[axis]))),
    ),
  );
  return hull(corners)
    .map((point) => point.join(","))
    .join(" ");
}

// What a rubber band round the points would touch.
function hull(points: Point[]): Point[] {
  const sorted = points.toSorted(([a, b], [c, d]) => a - c || b - d);
  const half = (all: Point[]): Point[] => {
    const side: Point[] = [];
    for (const [x, y] of all) {
      while (side.length > 1) {
        const [[a, b], [c, d]] = side.slice(-2);
        if ((c - a) * (y - b) - (d - b) * (x - a) > 0) break;
        side.pop();
      }
      side.push([x, y]);
    }
    return side.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.toReversed())];
}

/** The same robot lain on its left side, ahead to the right: from above it is seen from its right. */
export function onItsSide(pose: Pose): Pose {
  const { origin, heading } = frameOf(pose);
  const half = Math.SQRT1_2;
  const [c, s] = [Math.cos(heading / 2), -Math.sin(heading / 2)];
  const turn = times([half, -half, 0, 0], [c, 0, 0, s]);
  const place: number[] = [];
  const turns: number[] = [];
  for (let body = 0; 3 * body < pose.place.length; body += 1) {
    const [x, y, z] = pointOf(pose, body, [0, 0, 0]);
    place.push(...turned(turn, [x - origin[0], y - origin[1], z]));
    turns.push(...times(turn, Array.from({ length: 4 }, (_, k) => pose.turn[4 * body + k])));
  }
  return { place, turn: turns };
}

// One quaternion after another.
function times([a, b, c, d]: number[], [e, f, g, h]: number[]): number[] {
  return [
    a * e - b * f - c * g - d * h,
    a * f + b * e + c * h - d * g,
    a * g - b * h + c * e + d * f,
    a * h + b * g - c * f + d * e,
  ];
}

/** The two ends of a rod from above, y down. */
export const ends = (pose: Pose, part: Part): [Point, Point] => [
  corner(pose, part, [0, 0, -part.size_mm[1]]),
  corner(pose, part, [0, 0, part.size_mm[1]]),
];

/** The middle of a ball from above, y down. */
export const middle = (pose: Pose, part: Part): Point => corner(pose, part, [0, 0, 0]);

/** The two ends of a line from above, y down. */
export const lineEnds = (pose: Pose, line: Line): [Point, Point] =>
  line.bodies.map((body, k) => down(pointOf(pose, body, line.at_mm[k]))) as [Point, Point];

function corner(pose: Pose, part: Part, at: Vec3): Point {
  const own = turned(part.turn, at).map((one, k) => one + part.at_mm[k]);
  return down(pointOf(pose, part.body, own));
}

const down = ([x, y]: Vec3): Point => [x, -y];
