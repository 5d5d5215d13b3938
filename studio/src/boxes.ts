// Boxes of the page: which of them keep their size, and which are in view.

import { studio } from "./state.svelte";

/** Holds the size of a box while something is dragged; measured before that changes anything. */
export function heldSize(node: HTMLElement): (() => void) | void {
  if (!studio.dragging) return;
  node.style.height = `${node.offsetHeight}px`;
  node.classList.add("held-size");
  return () => {
    node.style.height = "";
    node.classList.remove("held-size");
  };
}

/** Says whether any of an element is in view, now and whenever that changes. */
export const seen =
  (then: (inView: boolean) => void) =>
  (node: Element): (() => void) => {
    const watch = new IntersectionObserver((all) => then(all.at(-1)!.isIntersecting));
    watch.observe(node);
    return () => watch.disconnect();
  };
