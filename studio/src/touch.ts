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
