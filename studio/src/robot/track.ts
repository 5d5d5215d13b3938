// The samples of a run, which grow while it goes on.

import type { View } from "../wire";

/** Blocks that grow, sample by sample. */
export class Track {
  count = 0;
  private readonly held = new Map<string, { data: Float64Array | Int32Array; width: number }>();

  /** Takes what is new of a run. */
  take(view: View): void {
    const added = view.blocks.time.length;
    if (view.first === 0) this.count = 0;
    if (view.first !== this.count) return;
    for (const [name, block] of Object.entries(view.blocks)) {
      if (!added) continue;
      const width = block.length / added;
      let own = this.held.get(name);
      const needed = (this.count + added) * width;
      if (!own || own.data.length < needed) {
        const kind = block.constructor as Float64ArrayConstructor;
        const data = new kind(Math.max(2 * needed, 1024));
        if (own) data.set(own.data.subarray(0, this.count * width));
        own = { data, width };
        this.held.set(name, own);
      }
      own.data.set(block, this.count * width);
    }
    this.count += added;
  }

  /** Row k of a block; empty where there is none. */
  row(name: string, k: number): ArrayLike<number> {
    const own = this.held.get(name);
    return own ? own.data.subarray(k * own.width, (k + 1) * own.width) : [];
  }

  /** One number of a block with one number a sample. */
  at(name: string, k: number): number {
    return this.row(name, k)[0];
  }
}
