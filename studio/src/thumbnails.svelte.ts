// What the gallery holds: the motions of its designs, as far as they have come.

import { studio } from "./state.svelte";
import type { View } from "./wire";

/** The motions of all designs of the gallery, kept while the page is open. */
class Thumbnails {
  views = $state.raw<Record<string, View>>({});
  /** Whether all stand still, as somebody wished. */
  still = $state(false);
  private whole = false;

  /** Asks for the motions, which come one after another. */
  ask(): void {
    if (this.whole) return;
    studio.once(
      "thumbnails",
      {},
      (view) => {
        this.whole = view.ok;
      },
      (view) => {
        if (view.part) this.views = { ...this.views, [view.name]: view };
      },
    );
  }

  /** Asks for no more: what is on the page now goes first. */
  leave(): void {
    if (!this.whole) studio.cancel("thumbnails");
  }
}

export const thumbnails = new Thumbnails();
