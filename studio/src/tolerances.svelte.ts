// How far what is built may be from the drawing; where nothing is said, the server's usual ones.

class Tolerances {
  /** Of every anchor [mm]. */
  anchor = $state<number | null>(null);
  /** Standard deviation of every stiffness [%]. */
  stiffness = $state<number | null>(null);

  /** As messages name them. */
  get asked(): { anchor_mm?: number; stiffness_percent?: number } {
    return {
      ...(this.anchor === null ? {} : { anchor_mm: this.anchor }),
      ...(this.stiffness === null ? {} : { stiffness_percent: this.stiffness }),
    };
  }
}

export const tolerances = new Tolerances();

/** A number that was typed; null where the field is empty or holds none. */
export const typed = (text: string): number | null =>
  text.trim() !== "" && Number.isFinite(Number(text)) ? Number(text) : null;
