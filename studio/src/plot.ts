// Draws curves on a canvas: axes with units, lines that stop where a segment ends, one cursor.

/** One line; where `segment` changes, nothing is drawn. */
export interface Line {
  x: ArrayLike<number>;
  y: ArrayLike<number>;
  segment?: ArrayLike<number>;
  /** +1 loading, -1 unloading, which is drawn thinner. */
  direction?: ArrayLike<number>;
  colour: string;
  /** Of what is only looked at beside the rest: faint and dashed. */
  ghost?: boolean;
}

/** A point to be marked: hollow where a snap begins, full where it lands, or the cursor. */
export interface Dot {
  x: number;
  y: number;
  colour: string;
  kind: "from" | "to" | "cursor";
}

export interface Plot {
  x: string;
  y: string;
  lines: Line[];
  dots: Dot[];
  cursor?: number;
}

interface Colours {
  ink: string;
  quiet: string;
  grid: string;
  paper: string;
}

const LEFT = 50;
const RIGHT = 12;
const TOP = 22;
const BOTTOM = 34;

/** Round numbers between two, about so many and at least three. */
export function ticks(low: number, high: number, about: number): number[] {
  const raw = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const steps = [10, 5, 2.5, 2, 1, 0.5].map((one) => one * power);
  const least = steps.findLast((one) => one >= raw * 0.999)!;
  const ends = (step: number): number[] => [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  const step = steps.find((one) => one <= least && ends(one)[1] - ends(one)[0] >= 2)!;
  const [first, last] = ends(step);
  return Array.from({ length: last - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
}

function range(values: ArrayLike<number>[]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const all of values) {
    for (let k = 0; k < all.length; k += 1) {
      if (all[k] < low) low = all[k];
      if (all[k] > high) high = all[k];
    }
  }
  if (!(high > low)) return Number.isFinite(low) ? [low - 1, low + 1] : [0, 1];
  return [low, high];
}

/** Paints one plot; returns where its x axis lies, for the pointer. */
export function paint(canvas: HTMLCanvasElement, plot: Plot, colours: Colours): (x: number) => number {
  const [wide, tall] = [canvas.clientWidth, canvas.clientHeight];
  const ratio = devicePixelRatio || 1;
  if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(tall * ratio)) {
    canvas.width = Math.round(wide * ratio);
    canvas.height = Math.round(tall * ratio);
  }
  const pen = canvas.getContext("2d")!;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, wide, tall);

  const [x0, x1] = range(plot.lines.map((line) => line.x));
  let [y0, y1] = range(plot.lines.map((line) => line.y));
  const room = (y1 - y0) * 0.06;
  [y0, y1] = [y0 - room, y1 + room];
  const across = (x: number): number => LEFT + ((x - x0) / (x1 - x0)) * (wide - LEFT - RIGHT);
  const up = (y: number): number => tall - BOTTOM - ((y - y0) / (y1 - y0)) * (tall - TOP - BOTTOM);

  pen.font = "12px system-ui, sans-serif";
  pen.lineWidth = 1;
  pen.fillStyle = colours.quiet;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const y of ticks(y0, y1, Math.max(2, tall / 55))) {
    pen.strokeStyle = colours.grid;
    pen.beginPath();
    pen.moveTo(LEFT, Math.round(up(y)) + 0.5);
    pen.lineTo(wide - RIGHT, Math.round(up(y)) + 0.5);
    pen.stroke();
    pen.fillText(written(y), LEFT - 6, up(y));
  }
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const x of ticks(x0, x1, Math.max(2, wide / 80))) {
    pen.fillText(written(x), across(x), tall - BOTTOM + 5);
  }
  pen.textAlign = "right";
  pen.textBaseline = "bottom";
  pen.fillText(plot.x, wide - RIGHT, tall - 1);
  pen.textAlign = "left";
  pen.textBaseline = "top";
  pen.font = "600 13px system-ui, sans-serif";
  pen.fillStyle = colours.ink;
  pen.fillText(plot.y, 4, 2);

  if (plot.cursor !== undefined) {
    pen.strokeStyle = colours.quiet;
    pen.beginPath();
    pen.moveTo(across(plot.cursor), TOP);
    pen.lineTo(across(plot.cursor), tall - BOTTOM);
    pen.stroke();
  }
  pen.lineJoin = "round";
  // All of unloading lies under all of loading, so that no thin line cuts a thick one.
  for (const way of [-1, 1]) {
    for (const { x, y, segment, direction, colour, ghost } of plot.lines) {
      pen.strokeStyle = colour;
      pen.lineWidth = way < 0 ? 1.3 : 2.4;
      pen.globalAlpha = ghost ? 0.45 : 1;
      pen.setLineDash(ghost ? [5, 4] : []);
      pen.beginPath();
      for (let k = 0; k < x.length; k += 1) {
        if ((direction?.[k] ?? 1) !== way) continue;
        const joined =
          k > 0 &&
          (!segment || segment[k] === segment[k - 1]) &&
          (!direction || direction[k - 1] === way);
        if (joined) pen.lineTo(across(x[k]), up(y[k]));
        else pen.moveTo(across(x[k]), up(y[k]));
      }
      pen.stroke();
    }
  }
  pen.globalAlpha = 1;
  pen.setLineDash([]);
  for (const { x, y, colour, kind } of plot.dots) {
    pen.beginPath();
    pen.arc(across(x), up(y), kind === "cursor" ? 5.5 : 3.2, 0, 2 * Math.PI);
    pen.fillStyle = kind === "from" ? colours.paper : colour;
    pen.strokeStyle = kind === "cursor" ? colours.paper : colour;
    pen.lineWidth = kind === "cursor" ? 2 : 1.5;
    pen.fill();
    pen.stroke();
  }
  return (pixel) => x0 + ((pixel - LEFT) / (wide - LEFT - RIGHT)) * (x1 - x0);
}

const written = (value: number): string => String(value).replace("-", "−");
