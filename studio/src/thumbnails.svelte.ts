// What the gallery holds: the motions of its designs, as far as they have come.

import { studio } from "./state.svelte";
import type { View } from "./wire";

/** The motions of all designs of the gallery, kept while the page is open. */
class Thumbnails {
  views = $state.raw<Record<string, View>>({});
  /** Whether all stand still, as somebody wished. */
  still = $state(false);
  private whole = false;
  /** The designs kept in the browser whose motions have come, as text, by identifier. */
  private readonly own: Record<string, string> = {};

  /** Asks for the motions, which come one after another. */
  ask(): void {
    const kept = studio.kept.filter(({ id, design }) => this.own[id] !== JSON.stringify(design));
    if (this.whole && !kept.length) return;
    const designs = kept.map(({ id, design }) => ({ name: id, design }));
    for (const { name, design } of designs) this.own[name] = JSON.stringify(design);
    studio.once(
      "thumbnails",
      { presets: !this.whole, ...(designs.length ? { designs } : {}) },
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
