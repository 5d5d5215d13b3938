// One or two pointers on a drawing: how far they move it, scale it and turn it.

/** A movement on the screen: shift [px], scale about a place there, turn [degrees, anticlockwise]. */
export interface Moved {
  dx: number;
  dy: number;
  scale: number;
  turn: number;
  x: number;
  y: number;
}

/** Follows the pointers that are down. */
export class Gesture {
  private readonly down = new Map<number, { x: number; y: number }>();

  get held(): boolean {
    return this.down.size > 0;
  }

  begin(event: PointerEvent): void {
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
    if (this.down.size < 2) this.down.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  end(event: PointerEvent): void {
    this.down.delete(event.pointerId);
  }

  /** What the pointers have done since the last call; null where the pointer is none of them. */
  move(event: PointerEvent): Moved | null {
    const before = this.down.get(event.pointerId);
    if (!before) return null;
    const now = { x: event.clientX, y: event.clientY };
    this.down.set(event.pointerId, now);
    const other = [...this.down].find(([id]) => id !== event.pointerId)?.[1];
    const shift = { dx: now.x - before.x, dy: now.y - before.y };
    if (!other) return { ...shift, scale: 1, turn: 0, x: now.x, y: now.y };
    const [a, b] = [before, now].map((one) => [one.x - other.x, one.y - other.y]);
    const scale = Math.hypot(b[0], b[1]) / Math.max(1, Math.hypot(a[0], a[1]));
    const angle = Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    return { dx: 0, dy: 0, scale, turn: (-angle * 180) / Math.PI, x: other.x, y: other.y };
  }
}
