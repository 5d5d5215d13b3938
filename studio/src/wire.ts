// The one connection to the server: frames in and out, latest wins, and back after a cut.

import type { Design } from "./design";

export type Block = Float64Array | Float32Array | Int32Array | Uint8Array;

/** What is wrong with a design, and with which of its keys. */
export interface Problem {
  at: string;
  text: string;
}

/** An answer: its header, and its arrays by name. */
export interface View {
  type: string;
  seq: number;
  ok: boolean;
  problems?: Problem[];
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  blocks: Record<string, any>;
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  [key: string]: any;
}

interface Request {
  type: string;
  seq: number;
  text: string;
  settle: (view: View) => void;
  partly: (view: View) => void;
  /** Whether it has waited for an answer for some time. */
  late?: boolean;
}

// Before the first answer the second request is on its way already, so the server never waits for
// the page; more would only pile up.
const IN_FLIGHT = 2;
const RETRY_MS = 700;
// What takes longer shows that it works.
const SLOW_MS = 300;
/** Longest message that the server takes [bytes]. */
export const LONGEST = 1 << 20;

/** The refusal of a file or message beyond that limit. */
export const tooLarge = (name: string, bytes: number): string =>
  `${name}: has ${(bytes / 1e6).toFixed(1)} MB; the studio takes at most ${(LONGEST / 1e6).toFixed(1)} MB. ` +
  "The command line takes larger files.";

const KINDS = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array };

/** The header and the arrays of a binary message. */
export function unpack(message: ArrayBuffer): View {
  const length = new DataView(message).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(message, 4, length)));
  const blocks: Record<string, Block> = {};
  let at = padded(4 + length);
  for (const { name, dtype, shape } of header.blocks) {
    const size = shape.reduce((all: number, one: number) => all * one, 1);
    const kind = KINDS[dtype as keyof typeof KINDS];
    const block = new kind(message, at, size);
    blocks[name] = block instanceof Uint16Array ? stepped(block, header.steps[name]) : block;
    at = padded(at + size * kind.BYTES_PER_ELEMENT);
  }
  return { ...header, blocks };
}

/** A table whose numbers came as steps: the number that 0 stands for, and the step, of each column. */
function stepped(steps: Uint16Array, [first, step]: [number[], number[]]): Float32Array {
  const values = new Float32Array(steps.length);
  for (let k = 0; k < values.length; ) {
    for (let i = 0; i < first.length; i += 1, k += 1) values[k] = first[i] + step[i] * steps[k];
  }
  return values;
}

function padded(length: number): number {
  return Math.ceil(length / 8) * 8;
}

const UNITS: Record<string, string> = { mm: "mm", percent: "%", s: "s", deg: "°", N: "N", mJ: "mJ" };

/** A problem of a request names its field in words: "ask.anchor_mm" is "Anchor [mm]". */
export const named = (text: string): string =>
  text.replace(/^ask\.(\w+)/, (_, key: string) => {
    const words = key.split("_");
    const unit = UNITS[words.at(-1)!];
    if (unit) words.pop();
    const name = words.join(" ");
    return `${name.charAt(0).toUpperCase()}${name.slice(1)}${unit ? ` [${unit}]` : ""}`;
  });

/** Asks the server and hands each newer answer on; older ones are dropped. */
export class Wire {
  private socket: WebSocket | null = null;
  private seq = 0;
  private readonly sent = new Map<string, Request[]>();
  private readonly waiting = new Map<string, Request>();
  private slow: ReadonlySet<string> = new Set();

  /**
   * @param linked called when the connection stands or is lost.
   * @param slowed called with the types that have waited for an answer for some time.
   */
  constructor(
    private readonly token: string,
    private readonly linked: (alive: boolean) => void,
    private readonly slowed: (types: ReadonlySet<string>) => void,
  ) {}

  /** Connects, and again whenever the connection is lost. */
  connect(): void {
    const socket = new WebSocket(
      `ws://${location.host}/socket?token=${encodeURIComponent(this.token)}`,
    );
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.socket = socket;
      this.linked(true);
      this.again();
    };
    socket.onmessage = (event) => this.receive(unpack(event.data as ArrayBuffer));
    socket.onclose = () => {
      this.socket = null;
      this.linked(false);
      setTimeout(() => this.connect(), RETRY_MS);
    };
  }

  /**
   * Asks; of each type only the newest request counts.
   *
   * @param leg of a robot, whose chain is meant.
   * @param settle is given the answer, unless a newer one overtakes it.
   * @param partly is given every word on the way to it: progress of the study, or what is known already.
   */
  ask(
    type: string,
    design: Design | null,
    leg: number,
    ask: object,
    settle: (view: View) => void,
    partly: (view: View) => void = () => {},
  ): number {
    const seq = ++this.seq;
    const text = JSON.stringify({ v: 1, type, seq, design, leg, ask });
    const request: Request = { type, seq, text, settle, partly };
    // Up to three bytes a character: most texts need no count.
    const bytes = 3 * text.length > LONGEST ? new Blob([text]).size : 0;
    if (bytes > LONGEST) {
      const problems = [{ at: "", text: tooLarge("The design", bytes) }];
      queueMicrotask(() => settle({ type, seq, ok: false, problems, blocks: {} }));
    } else if (this.socket && (this.sent.get(type)?.length ?? 0) < IN_FLIGHT) this.send(request);
    else this.waiting.set(type, request);
    setTimeout(() => this.look(type, seq), SLOW_MS);
    return seq;
  }

  /** Whether a request waits for an answer that is late; those up to a number are now. */
  private look(type: string, seq = 0): void {
    const open = [...(this.sent.get(type) ?? []), this.waiting.get(type)];
    for (const one of open) if (one && one.seq <= seq) one.late = true;
    const waits = open.some((one) => one?.late);
    if (waits === this.slow.has(type)) return;
    this.slow = new Set(waits ? [...this.slow, type] : [...this.slow].filter((one) => one !== type));
    this.slowed(this.slow);
  }

  /** Ends what is under way of a type that takes long. */
  cancel(type: string): void {
    this.waiting.delete(type);
    for (const { seq } of this.sent.get(type) ?? []) {
      this.socket?.send(JSON.stringify({ v: 1, type: "cancel", seq }));
    }
  }

  private send(request: Request): void {
    const sent = this.sent.get(request.type) ?? [];
    sent.push(request);
    this.sent.set(request.type, sent);
    this.socket!.send(request.text);
  }

  private receive(view: View): void {
    const sent = this.sent.get(view.type) ?? [];
    const own = sent.find((request) => request.seq === view.seq);
    if (!own) return;
    if (view.progress || view.part) return own.partly(view);
    // Requests older than an answer were passed over by the server.
    this.sent.set(
      view.type,
      sent.filter((request) => request.seq > view.seq),
    );
    const next = this.waiting.get(view.type);
    if (next && this.socket) {
      this.waiting.delete(view.type);
      this.send(next);
    }
    if (this.slow.has(view.type)) this.look(view.type);
    const problems = view.problems?.map(({ at, text }) => ({ at, text: named(text) }));
    own.settle({ ...view, problems });
  }

  // What had no answer when the connection was lost is asked once more, the newest of each type.
  private again(): void {
    const newest = new Map([...this.sent].map(([type, all]) => [type, all.at(-1)]));
    for (const [type, request] of this.waiting) newest.set(type, request);
    this.sent.clear();
    this.waiting.clear();
    for (const request of newest.values()) if (request) this.send(request);
  }
}
