/** What is dragged by a finger holds still below it: the page does not scroll along. */
export function still(node: Element): () => void {
  // The style touch-action does not reach parts of a drawing in every browser.
  const stop = (event: Event): void => event.preventDefault();
  node.addEventListener("touchstart", stop, { passive: false });
  return () => node.removeEventListener("touchstart", stop);
}

/**
 * Calls with each place of a pointer as soon as the system reports it; `pointermove` waits for the next
 * picture, which comes up to 16 ms later. Browsers without the event have only the other one.
 */
export const atOnce =
  (moved: (event: PointerEvent) => void) =>
  (node: Element): (() => void) => {
    const call = (event: Event): void => moved(event as PointerEvent);
    node.addEventListener("pointerrawupdate", call);
    return () => node.removeEventListener("pointerrawupdate", call);
  };

/**
 * Over what is dragged: Chromium reports the moves of a mouse pressed on a canvas of this kind without
 * a picture for each. That picture would take the time of the one that shows the answer. Nothing is drawn.
 */
export function unbuffered(canvas: HTMLCanvasElement): void {
  canvas.getContext("2d", { desynchronized: true });
}
