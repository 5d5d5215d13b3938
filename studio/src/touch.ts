/** What is dragged by a finger holds still below it: the page does not scroll along. */
export function still(node: Element): () => void {
  // The style touch-action does not reach parts of a drawing in every browser.
  const stop = (event: Event): void => event.preventDefault();
  node.addEventListener("touchstart", stop, { passive: false });
  return () => node.removeEventListener("touchstart", stop);
}
