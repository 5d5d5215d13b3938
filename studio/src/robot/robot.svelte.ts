// What the page holds of a robot beside its design: the arena, the run, and the time in it.

import { type View } from "../wire";
import { refusal, studio } from "../state.svelte";
import { store, stored } from "../storage";
import type { Arena } from "./arena";
import type { Line, Part, Pose } from "./plan";
import { Track, inFull } from "./track";

const KEPT = "stepwell.arena";
// While a run goes on the picture catches up with what is known of it in about this time [ms].
const CATCH_UP_MS = 200;

/** The robot's part of the page. */
class RobotState {
  /** null is a bare floor. */
  arena = $state.raw<Arena | null>(arenaIn(stored(KEPT)));
  /** The robot at its start, as last answered; null before, or where it cannot be simulated. */
  rest = $state.raw<View | null>(null);
  /** Why there is no newer one. */
  problem = $state("");
  /** The type of the run that goes on. */
  running = $state<"" | "walk" | "maze">("");
  /** How much of it is done, 0 to 1. */
  done = $state(0);
  /** What came out of the last run; null while there is none. */
  result = $state.raw<View | null>(null);
  /** What it was asked with; null while there is none. */
  asked: object | null = null;
  /** Why the last run did not come to an end. */
  failed = $state("");
  /** How many samples of a run there are; 0 shows the robot at its start. */
  count = $state(0);
  /** Where the cursor is: a sample, and between two of them while playing. */
  at = $state(0);
  playing = $state(false);
  speed = $state(1);

  readonly track = new Track();
  private run = 0;
  /** Whether the cursor follows the newest sample by itself. */
  private follows = false;

  parts = $derived<Part[]>(this.rest?.parts ?? []);
  lines = $derived<Line[]>(this.rest?.lines ?? []);
  /** Where everything is. */
  pose = $derived.by((): Pose | null => {
    if (this.count) {
      const at = Math.min(this.at, this.count - 1);
      return { place: this.track.between("place", at), turn: this.track.between("turn", at) };
    }
    return this.rest ? { place: this.rest.blocks.place, turn: this.rest.blocks.turn } : null;
  });

  /** The last sample that the cursor has come to. */
  sample = $derived(Math.min(Math.floor(this.at), this.count - 1));

  /** Shows a run that is there already, without anybody to be asked. */
  replay(view: View): void {
    this.arena = view.arena;
    this.rest = this.result = view;
    this.take(inFull(view));
  }

  /** Asks where the robot stands, since design or arena have changed; what it did is over. */
  ask(): void {
    this.leave();
    studio.once("robot", this.withArena({}), (view) => {
      this.problem = view.ok ? "" : refusal(view);
      if (view.ok) this.rest = view;
    });
  }

  setArena(arena: Arena | null): void {
    this.arena = arena;
    store(KEPT, JSON.stringify(arena));
  }

  /** When it is at the cursor [s]. */
  time(at: number): number {
    return this.track.between("time", Math.min(at, this.count - 1))[0];
  }

  /** Where the cursor is at a time [s]: a sample, or between two. */
  sampleAt(time: number): number {
    let [low, high] = [0, this.count - 1];
    if (time <= this.time(low)) return low;
    if (time >= this.time(high)) return high;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time(middle) <= time) low = middle;
      else high = middle;
    }
    return low + (time - this.time(low)) / (this.time(high) - this.time(low));
  }

  /** Lets it walk, or go through the arena. */
  start(type: "walk" | "maze", ask: object): void {
    this.leave();
    const run = this.run;
    const asked = this.withArena(ask);
    this.running = type;
    this.done = 0;
    studio.once(
      type,
      asked,
      (view) => {
        if (run !== this.run) return;
        this.running = "";
        if (!view.ok) {
          // What is known of a run that was ended can still be looked at.
          this.failed = refusal(view);
          return;
        }
        this.take(view);
        this.asked = asked;
        this.result = view;
      },
      (view) => {
        if (run !== this.run) return;
        if (view.progress) this.done = view.progress[0] / view.progress[1];
        else this.take(view);
      },
    );
    this.catchUp(run);
  }

  /** Puts the cursor where somebody wants it, and there it stays. */
  seek(at: number): void {
    this.follows = this.playing = false;
    this.at = at;
  }

  /** Plays from the cursor on, from the start again after the end; or pauses. */
  play(on = !this.playing): void {
    this.follows = false;
    if (on && this.at + 1 >= this.count) this.at = 0;
    this.playing = on;
  }

  cancel(): void {
    if (this.running) studio.cancel(this.running);
  }

  /** Forgets the run: the robot stands at its start. */
  leave(): void {
    this.cancel();
    this.run += 1;
    this.running = "";
    this.result = null;
    this.failed = "";
    this.count = 0;
    this.seek(0);
    this.track.count = 0;
  }

  private withArena(ask: object): object {
    return this.arena ? { ...ask, arena: this.arena } : ask;
  }

  private take(view: View): void {
    this.track.take(view);
    this.count = this.track.count;
  }

  // New samples come some times a second; the picture goes on between.
  private catchUp(run: number): void {
    let last: number | null = null;
    this.follows = true;
    const tick = (now: number): void => {
      if (run !== this.run || !this.follows) return;
      const newest = Math.max(0, this.count - 1);
      if (last !== null) {
        const share = Math.min(1, (now - last) / CATCH_UP_MS);
        this.at = Math.min(newest, this.at + Math.ceil((newest - this.at) * share));
      }
      last = now;
      if (this.running || this.at < newest) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}

function arenaIn(json: string | null): Arena | null {
  try {
    const value: unknown = JSON.parse(json ?? "null");
    return value && typeof value === "object" && !Array.isArray(value) ? (value as Arena) : null;
  } catch {
    return null;
  }
}

export const robot = new RobotState();
