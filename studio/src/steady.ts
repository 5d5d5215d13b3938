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
