// What the page holds: the design with its undo, what the server answered, and the cursor.

import { type Design, designIn, fromHash, toHash } from "./design";
import { type Problem, type View, Wire } from "./wire";

const STEPS = 100;
const KEPT = "stepwell.design";
const THEME = "stepwell.theme";
// A search for the margin takes long, so it waits until the hand rests.
const REST_MS = 400;
const FOLLOW_MS = 120;

/** The shared state of all panels. */
class Studio {
  design = $state.raw<Design | null>(null);
  /** The last good answer of each type. */
  views = $state.raw<Record<string, View>>({});
  /** A way to a state by its shortest program; null while the full cycle is shown. */
  way = $state.raw<View | null>(null);
  /** What the drawing and the curves show: the way, or the full cycle. */
  shown = $derived<View | undefined>(
    this.way && this.views.evaluate
      ? {
          ...this.views.evaluate,
          events: this.way.events,
          blocks: { ...this.views.evaluate.blocks, ...this.way.blocks },
        }
      : this.views.evaluate,
  );
  /** What else is asked when the hand rests: the types of the panels. */
  types: string[] = [];
  /** Whether those answers are of an older design. */
  stale = $state(false);
  problems = $state.raw<Problem[]>([]);
  /** null until the first connection stands or fails. */
  alive = $state<boolean | null>(null);
  /** Where the cursor is in the cycle: a sample, and between two of them while playing. */
  at = $state(0);
  playing = $state(false);
  dragging = $state<string | null>(null);
  locked = $state.raw<ReadonlySet<string>>(new Set());
  /** Pitch of the holes that anchors snap to [mm]; 0 is none. */
  pitch = $state(0);
  gallery = $state(false);
  kept = $state.raw<Design | null>(null);
  theme = $state<"light" | "dark">("light");
  /** How much of the search for the margin is done, 0 to 1. */
  searched = $state(1);
  /** Whether something is still to be answered or kept of what was changed last. */
  busy = $state(false);
  undos = $state(0);
  redos = $state(0);

  private past: Design[] = [];
  private future: Design[] = [];
  private asked = 0;
  private known = 0;
  private unsaved = false;
  private saving = 0;
  private resting = 0;
  private following = 0;
  private readonly wire: Wire;

  constructor() {
    const token = new URLSearchParams(location.search).get("token") ?? "";
    this.wire = new Wire(
      token,
      (view) => this.answered(view),
      (alive) => {
        this.alive = alive;
      },
    );
  }

  /** Reads what was kept, connects, and asks what to begin with. */
  begin(): void {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    this.setTheme((stored(THEME) as "light" | "dark" | null) ?? (dark ? "dark" : "light"), false);
    this.kept = designIn(stored(KEPT));
    this.wire.connect();
    const held = fromHash(location.hash);
    if (held) this.replace(held);
    else
      this.wire.ask("start", null, {}, (view) => {
        if (this.design) return;
        if (view.ok && view.design) this.replace(view.design);
        else this.gallery = true;
      });
  }

  /** Asks for one thing, apart from what follows the design. */
  once(type: string, ask: object, then: (view: View) => void): void {
    this.wire.ask(type, this.design, ask, then);
  }

  /** A new design altogether, without a way back to the one before. */
  replace(design: Design): void {
    this.past = [];
    this.future = [];
    this.locked = new Set();
    this.at = 0;
    this.show(design);
  }

  /** Remembers the present design, so that undo comes back to it. */
  mark(): void {
    if (!this.design || this.past.at(-1) === this.design) return;
    this.past = [...this.past, this.design].slice(-STEPS);
    this.future = [];
    this.counted();
  }

  /** One edit that can be undone. */
  edit(design: Design): void {
    this.mark();
    this.show(design);
  }

  /** The design while it is dragged; what was marked before is what undo comes back to. */
  show(design: Design): void {
    this.design = design;
    if (this.way) this.leave();
    this.stale = true;
    this.counted();
    window.clearTimeout(this.resting);
    this.wire.cancel("margin");
    this.asked = this.wire.ask("evaluate", design);
    this.busy = this.unsaved = true;
    window.clearTimeout(this.saving);
    this.saving = window.setTimeout(() => this.save(), 250);
  }

  /** Brings the mechanism to a state from where the last way ended, or from the first state. */
  goTo(state: string, failed: (text: string) => void): void {
    const start = this.way ? { start: this.way.arrives } : {};
    const design = this.design;
    this.once("program", { to: state, ...start }, (view) => {
      if (this.design !== design) return;
      if (!view.ok) return failed(view.problems?.map((one) => one.text).join(" ") ?? "");
      this.way = view;
      this.at = 0;
      this.playing = view.blocks.drive.length > 1;
      failed("");
    });
  }

  /** Back to the full cycle. */
  leave(): void {
    this.way = null;
    this.at = 0;
    this.playing = false;
  }

  undo(): void {
    const before = this.past.pop();
    if (!before || !this.design) return;
    this.future.push(this.design);
    this.show(before);
  }

  redo(): void {
    const after = this.future.pop();
    if (!after || !this.design) return;
    this.past.push(this.design);
    this.show(after);
  }

  setTheme(theme: "light" | "dark", keep = true): void {
    this.theme = theme;
    document.documentElement.dataset.theme = theme;
    if (keep) store(THEME, theme);
  }

  lock(name: string): void {
    const locked = new Set(this.locked);
    if (!locked.delete(name)) locked.add(name);
    this.locked = locked;
  }

  /** The first message about a key or what lies in it. */
  problemAt(place: string): string {
    return this.problems.find((problem) => problem.at.startsWith(place))?.text ?? "";
  }

  private follow(): void {
    const design = this.design;
    for (const type of this.types) {
      this.once(type, {}, (view) => {
        if (this.design !== design) return;
        this.stale = false;
        this.views = { ...this.views, [type]: view };
      });
    }
  }

  private counted(): void {
    this.undos = this.past.length;
    this.redos = this.future.length;
  }

  private save(): void {
    if (!this.design) return;
    store(KEPT, JSON.stringify(this.design));
    const { pathname, search } = location;
    history.replaceState(null, "", `${pathname}${search}#design=${toHash(this.design)}`);
    this.unsaved = false;
    this.calm();
  }

  private calm(): void {
    if (!this.unsaved && this.known >= this.asked) this.busy = false;
  }

  private answered(view: View): void {
    if (view.type === "error") return;
    if (view.type === "evaluate") {
      this.known = view.seq;
      this.calm();
    }
    if (!view.ok) {
      if (view.type === "evaluate") this.problems = view.problems ?? [];
      if (view.type === "margin") this.searched = 1;
      return;
    }
    if (view.progress) {
      this.searched = view.progress[0] / view.progress[1];
      return;
    }
    if (view.type === "margin") {
      const { margin, margins, method } = view;
      this.searched = 1;
      this.views = { ...this.views, evaluate: { ...this.views.evaluate, margin, margins, method } };
      return;
    }
    if (view.type === "evaluate") {
      this.problems = [];
      this.at = this.way ? this.at : carried(this.views.evaluate, view, this.at);
      if (view.method === "search" && !view.margins.length) {
        this.searched = 0;
        window.clearTimeout(this.resting);
        this.resting = window.setTimeout(() => this.wire.ask("margin", this.design), REST_MS);
      } else this.searched = 1;
      window.clearTimeout(this.following);
      this.following = window.setTimeout(() => this.follow(), FOLLOW_MS);
    }
    this.views = { ...this.views, [view.type]: view };
  }
}

// The cursor stays at its stroke of the actuator and on its way, loading or unloading.
function carried(before: View | undefined, now: View, at: number): number {
  const drive = now.blocks.drive;
  if (!before) return Math.min(at, drive.length - 1);
  const k = Math.floor(at);
  const way = before.blocks.direction[k];
  const wanted = before.blocks.drive[k];
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < drive.length; i += 1) {
    if (now.blocks.direction[i] !== way) continue;
    const far = Math.abs(drive[i] - wanted);
    if (far < least) [best, least] = [i, far];
  }
  return best;
}

// A browser may refuse to keep anything; the page works all the same.
function stored(name: string): string | null {
  try {
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

function store(name: string, text: string): void {
  try {
    localStorage.setItem(name, text);
  } catch {
    // Nothing is lost but the autosave.
  }
}

export const studio = new Studio();
