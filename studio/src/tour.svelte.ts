// The guided tour: a hand that does what a person would, and says why. It is the end-to-end test too.

import { STEPS } from "./tour-steps";

/** One thing that is shown. */
export interface Step {
  say: string;
  does?: (hand: Hand) => Promise<void>;
  /** What must have come of it before the tour goes on. */
  until?: () => boolean;
}

const PATIENCE_MS = 180_000;
const LOOK_MS = 30;
// So fast does a person read along [ms a word], beside a moment for the picture.
const WORD_MS = 270;
const MOMENT_MS = 1200;

class Ended extends Error {}

/** The pointer of the tour: it finds things by their names, as a screen reader does. */
export class Hand {
  constructor(private readonly tour: Tour) {}

  /** Waits until something with this name is there, and can be used. */
  async find(name: string): Promise<Element> {
    const usable = (element: Element | null): boolean =>
      element !== null && !(element as HTMLButtonElement).disabled;
    await this.tour.until(() => usable(named(name)), name);
    return named(name)!;
  }

  /** Presses a button, a tab, a state, a card. */
  async press(name: string): Promise<void> {
    const element = await this.over(await this.find(name));
    element.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true }));
  }

  /** Writes into a field, or chooses from a menu. */
  async write(name: string, text: string): Promise<void> {
    const field = (await this.over(await this.find(name))) as HTMLInputElement;
    // What a menu offers may have to come from the server first.
    await this.tour.until(() => {
      field.value = text;
      return field.value === text;
    }, name);
    field.dispatchEvent(new Event("input", { bubbles: true }));
    field.dispatchEvent(new Event("change", { bubbles: true }));
  }

  /** Takes a slider from where it is to a share of its way. */
  async slide(name: string, share: number, ms: number): Promise<void> {
    const slider = (await this.over(await this.find(name))) as HTMLInputElement;
    const [from, to] = [Number(slider.value), Number(slider.max) * share];
    await this.tour.over(ms, (part) => {
      slider.value = String(Math.round(from + (to - from) * part));
      slider.dispatchEvent(new Event("input", { bubbles: true }));
    });
  }

  /** Points at a part of a picture, counted from its upper left corner, and clicks there. */
  async point(name: string, across: number, down: number): Promise<void> {
    const element = await this.over(await this.find(name));
    const box = element.getBoundingClientRect();
    const [x, y] = [box.x + across * box.width, box.y + down * box.height];
    const [x0, y0] = [this.tour.x, this.tour.y];
    const all = { bubbles: true, cancelable: true, pointerId: 1, isPrimary: true };
    await this.tour.over(1200, (part) => {
      [this.tour.x, this.tour.y] = [x0 + (x - x0) * part, y0 + (y - y0) * part];
      const at = { clientX: this.tour.x, clientY: this.tour.y };
      element.dispatchEvent(new PointerEvent("pointermove", { ...all, ...at }));
    });
    const at = { clientX: x, clientY: y };
    element.dispatchEvent(new PointerEvent("pointerdown", { ...all, ...at, buttons: 1 }));
    element.dispatchEvent(new PointerEvent("pointerup", { ...all, ...at }));
    element.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true, ...at }));
  }

  /** Drags a handle of a drawing, in the drawing's own units. */
  async drag(name: string, x: number, y: number, ms: number): Promise<void> {
    const handle = await this.over(await this.find(name));
    const matrix = (handle as SVGGraphicsElement).getScreenCTM()!;
    const begin = middle(handle);
    const send = (type: string, part: number): void => {
      const clientX = begin.x + matrix.a * x * part;
      const clientY = begin.y + matrix.d * y * part;
      [this.tour.x, this.tour.y] = [clientX, clientY];
      const all = { bubbles: true, cancelable: true, pointerId: 1, isPrimary: true, button: 0 };
      const buttons = type === "pointerup" ? 0 : 1;
      // The element may have been made anew meanwhile.
      const to = named(name) ?? handle;
      to.dispatchEvent(new PointerEvent(type, { ...all, buttons, clientX, clientY }));
    };
    this.tour.pressed = true;
    send("pointerdown", 0);
    await this.tour.over(ms, (part) => send("pointermove", part));
    send("pointerup", 1);
    this.tour.pressed = false;
  }

  /** Looks on for a while. */
  async watch(ms: number): Promise<void> {
    await this.tour.rest(ms);
  }

  private async over(element: Element): Promise<Element> {
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    element.scrollIntoView({ block: "center", behavior: calm || this.tour.pace > 5 ? "auto" : "smooth" });
    await this.tour.rest(350);
    const [x0, y0] = [this.tour.x, this.tour.y];
    const to = middle(element);
    await this.tour.over(450, (part) => {
      const eased = part * part * (3 - 2 * part);
      [this.tour.x, this.tour.y] = [x0 + (to.x - x0) * eased, y0 + (to.y - y0) * eased];
    });
    return element;
  }
}

/** The tour's course. */
class Tour {
  running = $state(false);
  paused = $state(false);
  /** Which step is shown, counted from 0. */
  at = $state(-1);
  /** Whether the step has been done, and its words can still be read. */
  done = $state(false);
  failed = $state("");
  ended = $state(false);
  x = $state(0);
  y = $state(0);
  pressed = $state(false);
  pace = 1;
  readonly count = STEPS.length;
  readonly said = $derived(STEPS[this.at]?.say ?? "");
  private stepping = false;
  private hurried = false;
  private wanted = 0;

  /**
   * Begins.
   *
   * @param asked "1" at the pace of a reader, another number so much faster, "step" on demand.
   */
  async begin(asked: string): Promise<void> {
    this.stepping = asked === "step";
    this.pace = this.stepping ? 100 : Math.max(0.1, Number(asked) || 1);
    [this.x, this.y] = [innerWidth / 2, innerHeight / 2];
    this.running = true;
    try {
      const hand = new Hand(this);
      for (const [k, step] of STEPS.entries()) {
        if (this.stepping) await this.hold(() => this.wanted > k);
        [this.at, this.done, this.hurried] = [k, false, false];
        await this.rest(MOMENT_MS);
        await step.does?.(hand);
        if (step.until) await this.until(step.until, step.say);
        this.done = true;
        await this.rest(WORD_MS * step.say.split(" ").length);
      }
      if (this.stepping) await this.hold(() => this.wanted > STEPS.length);
      this.ended = true;
    } catch (error) {
      if (!(error instanceof Ended)) this.failed = String((error as Error).message);
    }
    this.running = false;
  }

  /** Goes on, or on to the next step. */
  next(): void {
    this.paused = false;
    this.hurried = true;
    this.wanted += 1;
  }

  /** Ends before the end. */
  end(): void {
    this.running = false;
  }

  /** Waits so long at the pace of the tour. */
  async rest(ms: number): Promise<void> {
    const end = performance.now() + ms / this.pace;
    while (performance.now() < end && !this.hurried) await later(LOOK_MS);
    await this.hold(() => !this.paused);
  }

  /** An action of this duration, called with the elapsed fraction. */
  async over(ms: number, show: (part: number) => void): Promise<void> {
    const frames = Math.max(2, Math.round(ms / this.pace / 16));
    for (let k = 1; k <= frames; k += 1) {
      await new Promise((done) => requestAnimationFrame(done));
      await this.hold(() => !this.paused);
      show(k / frames);
    }
  }

  /** Waits until something is so. */
  async until(so: () => boolean, what: string): Promise<void> {
    const begin = performance.now();
    while (!so()) {
      if (performance.now() - begin > PATIENCE_MS) throw new Error(what);
      await later(LOOK_MS);
      this.heed();
    }
  }

  private async hold(so: () => boolean): Promise<void> {
    this.heed();
    while (!so()) {
      await later(LOOK_MS);
      this.heed();
    }
  }

  private heed(): void {
    if (!this.running) throw new Ended();
  }
}

const later = (ms: number): Promise<void> => new Promise((done) => setTimeout(done, ms));

const middle = (element: Element): { x: number; y: number } => {
  // Of a handle its dot, for its name may stand beside it.
  const box = (element.querySelector(".dot") ?? element).getBoundingClientRect();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
};

function named(name: string): Element | null {
  const labelled = document.querySelector(`[aria-label=${JSON.stringify(name)}]`);
  if (labelled) return labelled;
  const pressed = document.querySelectorAll("button, [role=tab], [role=button], summary");
  const has = (one: Element): boolean => (one.querySelector("strong") ?? one).textContent?.trim() === name;
  const element = [...pressed].find(has);
  if (element) return element;
  const label = [...document.querySelectorAll("label")].find(
    (one) => one.textContent?.trim().startsWith(name),
  );
  // A name may go on with what its keys do.
  return label?.control ?? document.querySelector(`[aria-label^=${JSON.stringify(`${name}. `)}]`);
}

/** Whether something with this name is on the page. */
export const isThere = (name: string): boolean => named(name) !== null;

export const tour = new Tour();
