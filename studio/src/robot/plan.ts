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
  const [a, b] = part.size_mm;
  return [
    [a, b],
    [-a, b],
    [-a, -b],
    [a, -b],
  ]
    .map(([x, y]) => corner(pose, part, [x, y, 0]).join(","))
    .join(" ");
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
