// A replay inside another page: what it can tell of its surroundings, and how it plays there.

/** Whether another page is around this one, which has a title and a bar of its own. */
export const framed = window.self !== window.top;

/** Whether whoever put it there wants it to play by itself, and the reader minds no motion. */
const plays = (): boolean =>
  framed && window.name === "plays" && !matchMedia("(prefers-reduced-motion: reduce)").matches;

/** Plays while it is in view, where that is wanted, until the reader takes over. */
export function whileInView(play: (on: boolean) => void): () => void {
  if (!plays()) return () => {};
  const watch = new IntersectionObserver(([seen]) => play(seen.isIntersecting), { threshold: 0.5 });
  const stop = (): void => watch.disconnect();
  watch.observe(document.documentElement);
  for (const hand of ["pointerdown", "keydown"]) addEventListener(hand, stop, { once: true });
  return stop;
}
