// The studies in the server's folder: which there are, the one that is open, and progress of the study.

import { refusal, studio } from "../state.svelte";
import type { View } from "../wire";

/** A study as the folder's list has it. */
export interface Listed {
  name: string;
  what: string;
  count: number | null;
  chunks: number | null;
  /** Whether this server computes it. */
  running: boolean;
  problem: string;
}

// So often it is looked how far things are while something goes on, and while nothing does [ms].
const SOON = 1000;
const LATER = 4000;

class Studies {
  /** null until the folder was looked into. */
  list = $state.raw<Listed[] | null>(null);
  folder = $state("");
  /** How to get what studies need, where it is not installed. */
  missing = $state("");
  /** The one that is open, by its name. */
  name = $state("");
  /** What is known of it. */
  view = $state.raw<View | null>(null);
  problem = $state("");
  /** Whether it was asked to stop by somebody who computes it elsewhere. */
  stopping = $state(false);

  listed = $derived(this.list?.find((one) => one.name === this.name));
  studies = $derived(this.list?.filter((one) => one.what !== "atlas") ?? []);
  atlases = $derived(this.list?.filter((one) => one.what === "atlas") ?? []);
  /** Whether somebody computes what is open. */
  going = $derived(!this.view?.finished && (this.listed?.running || this.view?.at_work) === true);

  private watching = 0;
  private timer = 0;

  /** Looks now and then for as long as something on the page shows it; returns what ends that. */
  watch(): () => void {
    this.watching += 1;
    if (this.watching === 1) this.look();
    return () => {
      this.watching -= 1;
      if (!this.watching) window.clearTimeout(this.timer);
    };
  }

  open(name: string): void {
    if (this.name !== name) this.view = null;
    this.name = name;
    this.problem = "";
    this.stopping = false;
    this.look();
  }

  /** Begins one, or goes on with one that is there. */
  begin(ask: object): void {
    this.problem = "";
    studio.once("study_begin", ask, (view) => {
      if (view.ok) this.open(view.name);
      else this.problem = refusal(view);
    });
  }

  stop(): void {
    this.stopping = true;
    studio.once("study_stop", { name: this.name }, (view) => {
      this.stopping = view.ok && !view.at_once;
      if (!view.ok) this.problem = refusal(view);
      this.look();
    });
  }

  /** Looks into the folder, and at what is open. */
  look(): void {
    window.clearTimeout(this.timer);
    studio.once("studies", {}, (view) => {
      if (!view.ok) {
        this.problem = refusal(view);
        return;
      }
      this.missing = view.missing;
      this.folder = view.folder;
      this.list = view.studies;
      if (this.name && this.listed?.what !== "atlas") this.read();
      else this.again(LATER);
    });
  }

  private read(): void {
    const name = this.name;
    // What is finished does not change.
    if (this.view?.name === name && this.view.finished) return this.again(LATER);
    studio.once("study", { name }, (view) => {
      if (name !== this.name) return;
      if (view.ok) this.view = view;
      else if (!view.ended) this.problem = refusal(view);
      if (view.ok && !view.at_work) this.stopping = false;
      this.again(this.going ? SOON : LATER);
    });
  }

  private again(after: number): void {
    window.clearTimeout(this.timer);
    // A hand that moves the design comes first.
    const next = (): void => (studio.moving ? this.again(SOON) : this.look());
    if (this.watching) this.timer = window.setTimeout(next, after);
  }
}

export const studies = new Studies();

/** A stretch of time for a reader. */
export function lasting(seconds: number): string {
  if (seconds < 1) return "less than a second";
  if (seconds < 120) return `${Math.round(seconds)} s`;
  if (seconds < 7200) return `${Math.round(seconds / 60)} min`;
  return seconds < 172_800 ? `${Math.round(seconds / 3600)} h` : `${Math.round(seconds / 86_400)} days`;
}
