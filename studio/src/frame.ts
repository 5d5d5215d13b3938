// A replay inside another page: what it can tell of its surroundings, and how it plays there.

/** Whether another page is around this one, which has a title and a bar of its own. */
export const framed = window.self !== window.top;

/**
 * Plays while it is in view, where whoever put it there wants that, until the reader takes over;
 * never for a reader who minds motion, who may say so at any time.
 */
export function whileInView(play: (on: boolean) => void): () => void {
  if (!framed || window.name !== "plays") return () => {};
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const look = ([seen]: IntersectionObserverEntry[]): void => play(seen.isIntersecting && !calm.matches);
  const watch = new IntersectionObserver(look, { threshold: 0.5 });
  const hold = (): void => {
    if (calm.matches) play(false);
  };
  const stop = (): void => {
    watch.disconnect();
    calm.removeEventListener("change", hold);
  };
  watch.observe(document.documentElement);
  calm.addEventListener("change", hold);
  for (const hand of ["pointerdown", "keydown"]) addEventListener(hand, stop, { once: true });
  return stop;
}
