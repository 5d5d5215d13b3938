// What the gallery holds: the motions of its designs, and of those kept in the browser.

import { studio } from "./state.svelte";
import type { Block, View } from "./wire";

/** The motions of all designs of the gallery, kept while the page is open. */
class Thumbnails {
  views = $state.raw<Record<string, View>>({});
  /** Whether all stand still, at the user's request. */
  still = $state(false);
  /** The designs kept in the browser whose motions were asked for, as text, by identifier. */
  private readonly own: Record<string, string> = {};

  /** The motions of the gallery's designs, which come with their list. */
  take(gallery: View): void {
    const blocks: Record<string, Record<string, Block>> = {};
    for (const [key, block] of Object.entries<Block>(gallery.blocks)) {
      const [name, own] = key.split("/");
      (blocks[name] ??= {})[own] = block;
    }
    const moving = gallery.designs.filter((one: { motion: object | null }) => one.motion);
    const views = moving.map((one: { name: string; motion: object }) => [one.name, { ...one.motion, blocks: blocks[one.name] }]);
    this.views = { ...this.views, ...Object.fromEntries(views) };
  }

  /** Asks for the motions of the designs kept in the browser, which come one after another. */
  ask(): void {
    const kept = studio.kept.filter(({ id, design }) => this.own[id] !== JSON.stringify(design));
    if (!kept.length) return;
    for (const { id, design } of kept) this.own[id] = JSON.stringify(design);
    const designs = kept.map(({ id, design }) => ({ name: id, design }));
    studio.once(
      "thumbnails",
      { designs },
      () => {},
      (view) => {
        if (view.part) this.views = { ...this.views, [view.name]: view };
      },
    );
  }
}

export const thumbnails = new Thumbnails();
