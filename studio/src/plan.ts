// What the actuator is to do: the plan on the page, and how it is edited and displayed.

import type { Design } from "./design";
import { type Plan, studio } from "./state.svelte";
import type { View } from "./wire";

/** The program that stands in a design; null where none does. */
export function written(design: Design | null): Plan | null {
  const table = design?.program as Record<string, unknown> | undefined;
  const key = Object.keys(table ?? {}).find((one) => one.startsWith("turning_points"));
  const points = key && table?.[key];
  if (!Array.isArray(points) || points.length < 1) return null;
  const start = typeof table?.start === "string" ? table.start : "0".repeat(design!.chain!.cell!.length);
  const ends = typeof table?.ends === "string" ? { ends: table.ends } : {};
  return { start, points: points.map(Number), ...ends };
}

let last: Plan | null = null;

/** The plan on the page: drawn by hand, else the design's own, else out and back; the same object while it stays. */
export function planned(): Plan | null {
  const { plan, design, views } = studio;
  const now = plan ?? written(design) ?? (views.evaluate ? cycled(views.evaluate) : null);
  if (JSON.stringify(now) !== JSON.stringify(last)) last = now;
  return last;
}

function cycled(view: View): Plan {
  const drive: Float64Array = view.blocks.drive;
  const most = drive.reduce((a, b) => Math.max(a, b));
  const last = drive[drive.length - 1];
  return { start: view.sequence.split(">")[0], points: [drive[0], most, last].map(tidy) };
}

/** What the server is asked for a plan. */
export const askOf = ({ start, points, ends }: Plan): object => ({
  start,
  turning_points_mm: points,
  ...(ends ? { target: ends } : {}),
});

/** Without the last digits of a computation, which nobody set. */
export const tidy = (value: number): number => Number(value.toPrecision(12)) + 0;

/** A step that is fine for a hand: a two-hundredth of the range, as a round number. */
export function stepOf(range: number): number {
  const raw = range / 200;
  const power = 10 ** Math.floor(Math.log10(raw));
  return Number((power * (raw >= 5 * power ? 5 : raw >= 2 * power ? 2 : 1)).toPrecision(1));
}

/** The sample at which the drive comes to each turning point in turn. */
export function samplesOf(view: View, points: number[]): number[] {
  const drive: Float64Array = view.blocks.drive;
  const near = 1e-9 * Math.max(...points.map(Math.abs), 1e-9);
  let k = 0;
  return points.map((point) => {
    const before = k;
    while (k < drive.length && Math.abs(drive[k] - point) > near) k += 1;
    if (k === drive.length) k = before;
    return k;
  });
}
