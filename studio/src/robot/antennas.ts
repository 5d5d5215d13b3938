// The antennas of a design as its file has them, and how they are edited.

import { type Design, type Point, round } from "../design";

export interface Antenna {
  name: string;
  pivot_mm: Point;
  length_mm: number;
  /** From straight ahead, to the left. */
  angle_deg: number;
  leg: string;
  cell?: string | number;
  moves_mm: Point;
  connected?: boolean;
  [key: string]: unknown;
}

const isPoint = (value: unknown): boolean => Array.isArray(value) && value.length === 2;

/** The antennas; none where one cannot be drawn, which is left to the messages about it. */
export function antennasOf(design: Design | null): Antenna[] {
  const all = design?.antenna;
  const drawable = Array.isArray(all) && all.every((one) => isPoint(one?.pivot_mm));
  return drawable ? (all as Antenna[]) : [];
}

/** Where the rod ends at rest, in the body's frame. */
export function tipOf({ pivot_mm: [x, y], length_mm: length, angle_deg: angle }: Antenna): Point {
  const turn = (angle * Math.PI) / 180;
  return [x + length * Math.cos(turn), y + length * Math.sin(turn)];
}

/** The antenna whose rod ends there at rest. */
export function withTip(antenna: Antenna, [x, y]: Point): Antenna {
  const [dx, dy] = [x - antenna.pivot_mm[0], y - antenna.pivot_mm[1]];
  return {
    ...antenna,
    length_mm: round(Math.hypot(dx, dy)),
    angle_deg: round((Math.atan2(dy, dx) * 180) / Math.PI),
  };
}

/** The same design with one antenna changed. */
export const withAntenna = (design: Design, index: number, changed: Antenna): Design => ({
  ...design,
  antenna: antennasOf(design).map((one, k) => (k === index ? changed : one)),
});
