// The samples of a run, which grow while it goes on.

import type { View } from "../wire";

/** A run in full again, of which each column was sent as whole steps from sample to sample. */
export function inFull(view: View): View {
  const blocks: Record<string, Float64Array> = {};
  const count = view.blocks.time.length;
  for (const [name, sent] of Object.entries<Int32Array>(view.blocks)) {
    const width = sent.length / count;
    const full = new Float64Array(sent.length);
    for (let column = 0; column < width; column += 1) {
      let steps = 0;
      for (let k = 0; k < count; k += 1) {
        steps += sent[column * count + k];
        full[k * width + column] = steps * view.steps[name];
      }
    }
    blocks[name] = full;
  }
  return { ...view, first: 0, blocks };
}

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

  /** A row that may lie between two samples. */
  between(name: string, at: number): ArrayLike<number> {
    const k = Math.floor(at);
    const from = this.row(name, k);
    if (at === k || k + 1 >= this.count) return from;
    const to = this.row(name, k + 1);
    return Array.from(from, (one, i) => one + (to[i] - one) * (at - k));
  }

  /** One number of a block with one number a sample. */
  at(name: string, k: number): number {
    return this.row(name, k)[0];
  }
}
