// What the page holds: the design with its undo, what the server answered, and the cursor.

import {
  type CellTable,
  type ChainTable,
  type Design,
  cellsOf,
  chainKey,
  chainOf,
  fromHash,
  isRobot,
  toHash,
  withCells,
  withChain,
} from "./design";
import { History, type Kept, type Step, keep, keptDesigns } from "./history";
import { completed, likest } from "./motion";
import { store, stored } from "./storage";
import { type Problem, type View, Wire } from "./wire";

const THEME = "stepwell.theme";
// Quick questions follow a short rest of the hand; what takes long, and a hand that drags, waits for a longer one.
const FOLLOW_MS = 120;
const REST_MS = 400;
// After the answer to a move, when the hand counts as still: panels wait for it.
const STILL_MS = 300;
// Under a hand that does not pause, the time from one request for margins to the next.
const BOUND_MS = 100;
// So long a move waits to be drawn together with its answer, which most often is there before.
const TOGETHER_MS = 50;

/** What is asked of a design whenever it has changed. */
export interface Follower {
  type: string;
  /** Whether the server answers in a process of its own, with words on progress of the study. */
  long?: boolean;
  /** What is asked beside the design; null where nothing is. */
  ask?: () => object | null;
}

/** A design beside which another is looked at. */
export interface Pinned {
  design: Design;
  leg: number;
  view: View;
  /** Its margins, where they were known. */
  limits: View | null;
}

/** A stroke program: where it begins, turns and ends, in the unit of the drive. */
export interface Plan {
  start: string;
  points: number[];
  /** The state in which it is to end, where that was said. */
  ends?: string;
}

/** A stroke of the actuator, in the unit of the drive, on the way there, 1, or back, -1; as messages name it. */
interface Place {
  drive: number;
  direction: number;
}

/** The shared state of all panels. */
class Studio {
  design = $state.raw<Design | null>(null);
  /** Of a robot, the leg whose chain is shown. */
  leg = $state(0);
  // Set with the design and not derived from it: all that reads them would be looked through on each move of a hand.
  robot = $state(false);
  /** The key of the shown chain as messages name it. */
  chainKey = $state("chain");
  /** The number of cells of the shown chain. */
  count = $state(0);
  cells = $derived(cellsOf(this.design, this.leg));
  /** The table that holds the cells. */
  chain = $derived(chainOf(this.design, this.leg));
  /** The last good answer of each type. */
  views = $state.raw<Record<string, View>>({});
  /** The types whose answer is of the present design. */
  fresh = $state.raw<ReadonlySet<string>>(new Set());
  /** How much of what takes long is done, 0 to 1, by type. */
  progress = $state.raw<Record<string, number>>({});
  /** A way by a stroke program; null while the full cycle is shown. */
  way = $state.raw<View | null>(null);
  /** What the actuator is to do as it was drawn by hand; null where nothing was. */
  plan = $state.raw<Plan | null>(null);
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
  /** The margins of a design that moves under a hand, which come after its motion. */
  private reach = $state.raw<View | null>(null);
  /** The margins of the present design; null while they are searched. */
  limits = $derived.by<View | null>(() => {
    if (this.fresh.has("margin") && this.views.margin.ok) return this.views.margin;
    const known = this.reach ?? this.views.evaluate;
    return known?.margins && known.method !== "search" ? known : null;
  });
  /** The design that was put beside the present one. */
  pinned = $state.raw<Pinned | null>(null);
  /** What follows the design: that of the panels in view. */
  followers: () => Follower[] = () => [];
  problems = $state.raw<Problem[]>([]);
  /** null until the first connection stands or fails. */
  alive = $state<boolean | null>(null);
  private sample = $state(0);
  /** Where the cursor was put; answers to changes of the design show the sample nearest to it. */
  private place: Place | null = null;
  playing = $state(false);
  dragging = $state<string | null>(null);
  /** Whether a drag moves the design at this moment; panels ask and paint once the hand is still. */
  moving = $state(false);
  locked = $state.raw<ReadonlySet<string>>(new Set());
  /** Pitch of the holes that anchors snap to [mm]; 0 is none. */
  pitch = $state(0);
  gallery = $state(false);
  /** Name of the panel behind the chosen tab; "" for the first. */
  tab = $state("");
  /** Why the last file or link was not opened. */
  unread = $state("");
  /** Designs kept in this browser, the newest first. */
  kept = $state.raw<Kept[]>([]);
  /** The last design of an earlier page, offered while another one is shown. */
  earlier = $state.raw<Kept | null>(null);
  theme = $state<"light" | "dark">("light");
  /** Whether something is still to be answered or kept of what was changed last. */
  busy = $state(false);
  /** The types of requests that have waited for an answer for some time. */
  slow = $state.raw<ReadonlySet<string>>(new Set());
  undos = $state(0);
  redos = $state(0);

  private readonly history = new History();
  /** Number of opened designs. */
  private opened = 0;
  /** Where the present design is kept, by number of the opened design; "" if it is not kept yet. */
  private readonly places: string[] = [];
  private pushed = 0;
  private marked = false;
  private asked = 0;
  private known = 0;
  /** Number of the request for what fields show; 0 if it is answered. */
  private described = 0;
  private readonly underWay = new Set<string>();
  private unsaved = false;
  private saving = 0;
  private resting = 0;
  private following = 0;
  private stopping = 0;
  /** The design of a move that is asked and not drawn yet, and when it is drawn at the latest. */
  private ahead: Design | null = null;
  private drawing = 0;
  /** Number of the last request whose design is drawn. */
  private drawn = 0;
  private boundAt = 0;
  /** Whether the last request was of a move, whose answer leaves out what a hand at rest may ask. */
  private brief = false;
  /** The cells of a drag before it, of which the view was then; null where it was not. */
  private before: CellTable[] | null = null;
  private readonly wire: Wire;

  constructor() {
    const token = new URLSearchParams(location.search).get("token") ?? "";
    this.wire = new Wire(
      token,
      (alive) => {
        this.alive = alive;
      },
      (types) => {
        this.slow = types;
      },
    );
  }

  /** Connects, and opens the design of the address, or the one given to the command. */
  begin(): void {
    this.dress();
    this.kept = keptDesigns();
    this.wire.connect();
    window.addEventListener("popstate", () => this.followAddress());
    if (fromHash(location.hash)) this.followAddress();
    else
      this.once("start", {}, (view) => {
        if (this.design) return;
        if (view.ok && view.design) this.open(view.design);
        else this.gallery = true;
      });
  }

  /** Opens the design of the address, if it holds another one than the page. */
  private followAddress(): void {
    const held = fromHash(location.hash);
    if (!held || JSON.stringify(held) === JSON.stringify(this.design)) return;
    this.read({ tables: held }, held, true);
  }

  /**
   * Opens the design in a text or in tables, once the server has read it.
   *
   * @param design opened if the server is gone.
   * @param there whether the address has the design already.
   */
  read(ask: { toml: string } | { tables: Design }, design: Design | null = null, there = false): void {
    if (this.alive === false && design) {
      this.take(design, there);
      return;
    }
    this.once("open", ask, (view) => {
      this.unread = view.ok ? "" : refusal(view);
      if (view.ok) this.take(view.design, there);
      else if (!this.design) this.gallery = true;
    });
  }

  /** Shows a motion that is there already, without anybody to be asked. */
  replay(view: View): void {
    this.dress();
    this.views = { evaluate: view };
    // A program ends where it leads; a cycle goes round.
    if (view.program) this.way = view;
  }

  /** Asks for one thing, apart from what follows the design. */
  once(type: string, ask: object, then: (view: View) => void, partly?: (view: View) => void): void {
    this.wire.ask(type, this.design, this.leg, ask, then, partly);
  }

  /** Asks for what fields show of the present design; the page is busy until it is known. */
  describe(type: string, then: (view: View) => void): void {
    this.busy = true;
    this.described = this.wire.ask(type, this.design, this.leg, {}, (view) => {
      if (view.seq >= this.described) this.described = 0;
      then(view);
      this.calm();
    });
  }

  /** Ends what is under way of a type that takes long. */
  cancel(type: string): void {
    this.wire.cancel(type);
  }

  /** A design from the gallery or the command: it is kept in the browser once it is changed. */
  open(design: Design): void {
    this.replace(design, "");
  }

  /** A design from elsewhere, which is kept in the browser. */
  take(design: Design, there = false): void {
    const known = keptDesigns().find((one) => JSON.stringify(one.design) === JSON.stringify(design));
    this.replace(design, known?.id ?? crypto.randomUUID());
    if (there) this.pushed = this.opened;
  }

  /** Another design altogether; undo comes back to the present one. */
  private replace(design: Design, place: string): void {
    if (this.dragging) this.cancelDrag();
    this.mark();
    this.opened = this.places.push(place) - 1;
    this.gallery = false;
    this.another(0);
    this.show(design);
    const [last] = this.kept;
    const offered = this.history.past.length === 0 && last && last.id !== place;
    this.earlier = offered && JSON.stringify(last.design) !== JSON.stringify(design) ? last : null;
  }

  /** Nothing on the page is of the present chain any more. */
  private another(leg: number): void {
    this.leg = leg;
    this.locked = new Set();
    this.at = 0;
    this.way = null;
    this.playing = false;
    this.views = {};
    this.reach = null;
    this.before = null;
    this.plan = null;
    this.problems = [];
  }

  private get step(): Step {
    return { design: this.design!, leg: this.leg, opened: this.opened };
  }

  private put(design: Design | null, leg = this.leg): void {
    [this.design, this.leg] = [design, leg];
    [this.robot, this.chainKey] = [isRobot(design), chainKey(design, leg)];
    this.count = cellsOf(design, leg).length;
  }

  /** Draws the design of the last move, whether its answer is there or not. */
  private catchUp(): void {
    window.clearTimeout(this.drawing);
    if (this.ahead) this.put(this.ahead);
    this.ahead = null;
    this.drawn = this.asked;
  }

  /** Remembers the present design for undo; changes of one name in quick succession are one step. */
  mark(run = ""): void {
    this.catchUp();
    if (!this.design) return;
    this.history.mark(this.step, run);
    this.counted();
  }

  /** Begins a drag, which is one step of undo and can be cancelled. */
  beginDrag(name: string): void {
    this.dragging = name;
    this.marked = false;
    this.playing = false;
    this.before = this.views.evaluate && !this.awaits && !this.problems.length ? this.cells : null;
  }

  /** The design at the present place of the pointer; only cells have changed where `cells` are given. */
  drag(design: Design, cells?: CellTable[]): void {
    if (!this.marked) this.mark();
    this.marked = true;
    this.moving = true;
    if (!this.ahead) this.drawing = window.setTimeout(() => this.catchUp(), TOGETHER_MS);
    this.ahead = design;
    this.changed();
    this.evaluate(design, cells);
  }

  /** Ends a drag; the design stays as it is. */
  endDrag(): void {
    this.catchUp();
    this.dragging = null;
    this.rest();
  }

  /** The hand is still: asks for what was left out of the answer to its last move. */
  private rest(): void {
    this.moving = false;
    if (this.brief) this.evaluate(this.design);
  }

  /** Ends a drag; the design is the one before it. */
  cancelDrag(): void {
    this.catchUp();
    this.dragging = null;
    this.moving = false;
    const before = this.marked && this.history.cancel();
    this.marked = false;
    if (before) this.show(before.design);
  }

  /** One edit that can be undone. */
  edit(design: Design, run = ""): void {
    this.mark(run);
    this.show(design);
  }

  /** One edit of the shown chain that can be undone. */
  editCells(cells: CellTable[], run = ""): void {
    this.edit(withCells(this.design!, this.leg, cells), run);
  }

  /** One edit of the table that holds the cells. */
  editChain(chain: ChainTable): void {
    this.edit(withChain(this.design!, this.leg, chain));
  }

  /** The shown chain while it is dragged. */
  dragCells(cells: CellTable[]): void {
    this.drag(withCells(this.design!, this.leg, cells), cells);
  }

  /** The design while it is dragged; what was marked before is what undo comes back to. */
  show(design: Design): void {
    this.catchUp();
    this.put(design);
    this.counted();
    this.changed();
    this.evaluate(design);
  }

  /** The present design is kept after a rest. */
  private changed(): void {
    this.busy = this.unsaved = true;
    window.clearTimeout(this.saving);
    this.saving = window.setTimeout(() => this.save(), 250);
  }

  /** Of a robot, another leg. */
  showLeg(leg: number): void {
    this.put(this.design, leg);
    this.at = 0;
    this.views = {};
    this.reach = null;
    this.before = null;
    this.plan = null;
    this.evaluate(this.design);
  }

  /** Asks what follows the design and is not known of it yet. */
  follow(long: boolean): void {
    const { design, leg } = this;
    if (!this.views.evaluate) return;
    for (const { type, ask = () => ({}), long: own = false } of this.followers()) {
      const known = this.fresh.has(type) || this.underWay.has(type);
      const asked = own === long && !known ? ask() : null;
      if (!asked) continue;
      this.underWay.add(type);
      if (long) this.progress = { ...this.progress, [type]: 0 };
      this.once(
        type,
        asked,
        (view) => {
          if (this.design !== design || this.leg !== leg || view.ended) return;
          this.underWay.delete(type);
          this.progress = { ...this.progress, [type]: 1 };
          this.fresh = new Set([...this.fresh, type]);
          this.views = { ...this.views, [type]: view };
        },
        (view) => {
          if (this.design !== design || this.leg !== leg) return;
          if (view.part) this.views = { ...this.views, [type]: view };
          else this.progress = { ...this.progress, [type]: view.progress[0] / view.progress[1] };
        },
      );
    }
  }

  /** Asks once more what follows the design, since something else was asked of it. */
  again(type: string): void {
    this.fresh = new Set([...this.fresh].filter((one) => one !== type));
    this.underWay.delete(type);
    this.follow(this.followers().some((one) => one.type === type && one.long));
  }

  /** Brings the mechanism to a state from where the last way ended, or from the first state. */
  goTo(state: string, failed: (text: string) => void): void {
    const start = this.way ? { start: this.way.arrives } : {};
    this.drive({ target: state, ...start }, failed);
  }

  /** Shows the way of a stroke program. */
  drive(ask: object, failed: (text: string) => void, play = true): void {
    const design = this.design;
    // What follows the design would overtake it, for both are of one type.
    this.underWay.add("program");
    this.once("program", ask, (view) => {
      if (this.design !== design) return;
      this.underWay.delete("program");
      if (!view.ok) return failed(refusal(view));
      this.way = view;
      this.at = 0;
      this.playing = play && view.blocks.drive.length > 1;
      failed("");
    });
  }

  /** Back to the full cycle. */
  leave(): void {
    const { shown, at } = this;
    this.way = null;
    // The mechanism stays as it was drawn, as nearly as the full cycle comes to it.
    this.at = shown && this.views.evaluate ? likest(shown, at, this.views.evaluate) : 0;
    this.playing = false;
  }

  /** Puts the present design beside what comes after it. */
  pin(): void {
    const { design, leg, limits } = this;
    const view = this.views.evaluate;
    if (design && view) this.pinned = { design, leg, view, limits };
  }

  /** The present design and the one beside it change places. */
  swap(): void {
    const { pinned } = this;
    if (!pinned) return;
    this.pin();
    this.mark();
    this.leg = pinned.leg;
    this.show(pinned.design);
  }

  /** Nothing is beside the design any more. */
  unpin(): void {
    this.pinned = null;
  }

  undo(): void {
    if (this.dragging) this.cancelDrag();
    else if (this.design) this.goBack(this.history.undo(this.step));
  }

  redo(): void {
    if (!this.dragging && this.design) this.goBack(this.history.redo(this.step));
  }

  private goBack(to: Step | undefined): void {
    if (!to) return;
    if (to.opened !== this.opened || to.leg !== this.leg) {
      this.opened = to.opened;
      this.another(to.leg);
    }
    this.gallery = false;
    this.show(to.design);
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

  /** Takes the colours that were chosen here, else the reader's, and follows those. */
  dress(): void {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const follow = (): void => {
      const chosen = stored(THEME) as "light" | "dark" | null;
      this.setTheme(chosen ?? (dark.matches ? "dark" : "light"), false);
    };
    dark.addEventListener("change", follow);
    follow();
  }

  private evaluate(design: Design | null, cells?: CellTable[]): void {
    if (this.way) this.leave();
    if (this.fresh.size) this.fresh = new Set();
    this.underWay.clear();
    window.clearTimeout(this.resting);
    window.clearTimeout(this.stopping);
    for (const { type } of this.followers()) this.wire.cancel(type);
    this.busy = true;
    this.brief = this.moving;
    const moved = this.brief ? this.movedOf(cells) : null;
    const ask = this.brief ? { moves: true, ...(moved && { cells: moved, ...this.cursor }) } : {};
    const before = this.before;
    this.asked = this.wire.ask("evaluate", design, this.leg, ask, (view) => {
      if (!moved || !view.ok) return this.answered(view, design);
      // Another chain may have come between.
      if (before === this.before && this.views.evaluate)
        this.answered(completed(this.views.evaluate, view, moved), design);
    });
  }

  /** Asks for the margins of a move once it has been painted, which they would delay, as they would the next move. */
  private bound(design: Design | null): void {
    const { before } = this;
    const late = (): boolean => !this.brief || before !== this.before;
    const ask = (): void => {
      if (late() || (this.awaits && performance.now() - this.boundAt < BOUND_MS)) return;
      this.boundAt = performance.now();
      this.wire.ask("limits", design, this.leg, {}, (view) => {
        if (view.ok && !late()) this.reach = view;
      });
    };
    requestAnimationFrame(() => setTimeout(ask));
  }

  /** The cells of a move that the view before the drag does not have; null if it is of no use. */
  private movedOf(cells?: CellTable[]): number[] | null {
    const { before } = this;
    if (before?.length !== cells?.length) return null;
    const moved = cells?.flatMap((one, i) => (one === before![i] ? [] : [i]));
    return moved?.length ? moved : null;
  }

  /** Where the cursor is in the cycle: a sample, and between two of them while playing. */
  get at(): number {
    return this.sample;
  }

  set at(at: number) {
    this.sample = at;
    this.place = null;
  }

  private get cursor(): Place {
    return (this.place ??= placeAt(this.views.evaluate, this.at));
  }

  private answered(view: View, design: Design | null): void {
    this.known = view.seq;
    // Each move is drawn with its own answer.
    if (view.seq === this.asked) this.catchUp();
    else if (this.ahead && view.seq > this.drawn) this.put(design);
    this.calm();
    window.clearTimeout(this.stopping);
    if (this.moving) this.stopping = window.setTimeout(() => this.rest(), STILL_MS);
    if (!view.ok) {
      this.problems = view.problems ?? [];
      return;
    }
    if (this.problems.length) this.problems = [];
    if (this.views.evaluate && !this.way) this.sample = nearestTo(view, this.cursor);
    // Under a hand the last known margins stay until those of the move come.
    this.reach = view.margins ? null : (this.reach ?? this.views.evaluate ?? null);
    this.views = { ...this.views, evaluate: view };
    if (!view.margins) this.bound(design);
    // A design that was put beside itself while it moved.
    if (this.pinned?.design === design) this.pinned = { ...this.pinned!, view };
    window.clearTimeout(this.following);
    const rest = this.dragging ? REST_MS : FOLLOW_MS;
    this.following = window.setTimeout(() => this.follow(false), rest);
    window.clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.follow(true), REST_MS);
  }

  private counted(): void {
    this.undos = this.history.past.length;
    this.redos = this.history.future.length;
  }

  private save(): void {
    this.catchUp();
    if (!this.design) return;
    this.keepDesign();
    const { pathname, search } = location;
    const address = `${pathname}${search}#design=${toHash(this.design)}`;
    // Back goes to the design that was open before, not through its changes.
    if (this.pushed !== this.opened) history.pushState(null, "", address);
    else history.replaceState(null, "", address);
    this.pushed = this.opened;
    this.unsaved = false;
    this.calm();
  }

  private keepDesign(): void {
    const changed = this.history.past.at(-1)?.opened === this.opened || this.redos > 0;
    if (!this.places[this.opened] && changed) this.places[this.opened] = crypto.randomUUID();
    const place = this.places[this.opened];
    if (place) this.kept = keep(place, this.design!);
  }

  /** Whether the cycle of the present design is not known yet. */
  get awaits(): boolean {
    return this.known < this.asked;
  }

  private calm(): void {
    if (!this.unsaved && !this.awaits && !this.described) this.busy = false;
  }
}

/** What a refusal says, in one line. */
export const refusal = (view: View): string => view.problems?.map((one) => one.text).join(" ") ?? "";

/** The sample of another view at the same stroke of the actuator and on the same way. */
export const carried = (before: View, now: View, at: number): number => nearestTo(now, placeAt(before, at));

function placeAt({ blocks: { drive, direction } }: View, at: number): Place {
  const k = Math.floor(at);
  return { drive: drive[k], direction: direction[k] };
}

function nearestTo({ blocks: { drive, direction } }: View, place: Place): number {
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < drive.length; i += 1) {
    if (direction[i] !== place.direction) continue;
    const far = Math.abs(drive[i] - place.drive);
    if (far < least) [best, least] = [i, far];
  }
  return best;
}

export const studio = new Studio();
