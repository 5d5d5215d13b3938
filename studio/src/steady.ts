/**
 * Keeps what stays: of each list the elements that are as at this place of the list before are the old ones,
 * so that nothing of them is drawn again.
 */
export function steady<T extends object>(): (now: T[]) => T[] {
  let before: T[] = [];
  const same = (a: T | undefined, b: T): a is T =>
    a !== undefined && (Object.keys(b) as (keyof T)[]).every((key) => a[key] === b[key]);
  return (now) => (before = now.map((one, k) => (same(before[k], one) ? before[k] : one)));
}

/** A path of all pieces of one fill and one opacity. */
export interface Joined {
  look: string;
  fill: string;
  opacity: number;
  d: string;
}

export type Piece = [fill: string, opacity: number, d: string];

/** Joins pieces of one look to one path, since each element takes as long as a long path; what stays is the old object. */
export function joining(): (pieces: Piece[]) => Joined[] {
  const kept = steady<Joined>();
  return (pieces) => {
    const paths = new Map<string, Joined>();
    for (const [fill, opacity, d] of pieces) {
      const look = `${fill} ${opacity}`;
      paths.set(look, { look, fill, opacity, d: (paths.get(look)?.d ?? "") + d });
    }
    return kept([...paths.values()]);
  };
}
