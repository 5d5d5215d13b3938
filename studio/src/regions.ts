// Paints a map: regions distinguished by colour, hatching and letter, and the curves between them.

import { colour } from "./colours";
import type { Point } from "./design";
import { ticks } from "./plot";

/** How one region looks. */
export interface Style {
  letter: string;
  colour: string;
  /** 0 plain, 1 and more ever denser; -1 where there is no sequence. */
  hatch: number;
}

/** A line between regions; dashed where the sequence is the same on both sides. */
export interface Curve {
  points: ArrayLike<number>;
  dashed: boolean;
}

/** What is to be painted. */
export interface Picture {
  image: ArrayLike<number>;
  /** Pixels across and up. */
  size: Point;
  x: [number, number];
  y: [number, number];
  styles: Style[];
  curves: Curve[];
}

/** The space of the axes round the picture. */
export const ROOM = { left: 46, right: 10, top: 8, bottom: 24 };

const COLOURS = 6;
const SHARE = { light: 0.5, dark: 0.42 };
const INK = { light: "#1f2328", dark: "#e8e6e1" };
const PAPER = { light: "#ffffff", dark: "#1b2025" };
// A letter needs a square of so many pixels of the screen.
const ROOM_OF_LETTER = 16;

/** How the k-th sequence looks: six colours, then the same ones hatched. */
export const styleOf = (k: number, theme: "light" | "dark"): Style => ({
  letter: k < 26 ? String.fromCharCode(65 + k) : String(k + 1),
  colour: colour(k, theme),
  hatch: Math.floor(k / COLOURS),
});

export function paintMap(canvas: HTMLCanvasElement, picture: Picture, theme: "light" | "dark"): void {
  const [wide, tall] = [canvas.clientWidth, canvas.clientHeight];
  const ratio = devicePixelRatio || 1;
  canvas.width = Math.round(wide * ratio);
  canvas.height = Math.round(tall * ratio);
  const pen = canvas.getContext("2d")!;
  const [across, up] = [wide - ROOM.left - ROOM.right, tall - ROOM.top - ROOM.bottom];
  fill(pen, picture, theme, ratio, across, up);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);

  const [[x0, x1], [y0, y1]] = [picture.x, picture.y];
  const at = (x: number, y: number): Point => [
    ROOM.left + ((x - x0) / (x1 - x0)) * across,
    ROOM.top + (1 - (y - y0) / (y1 - y0)) * up,
  ];
  pen.strokeStyle = INK[theme];
  pen.lineJoin = "round";
  for (const { points, dashed } of picture.curves) {
    pen.setLineDash(dashed ? [5, 4] : []);
    pen.lineWidth = dashed ? 1 : 1.8;
    pen.beginPath();
    for (let k = 0; k < points.length; k += 2) pen.lineTo(...at(points[k], points[k + 1]));
    pen.stroke();
  }
  pen.setLineDash([]);
  pen.lineWidth = 1;
  pen.strokeRect(ROOM.left + 0.5, ROOM.top + 0.5, across - 1, up - 1);

  pen.font = "12px system-ui, sans-serif";
  pen.fillStyle = INK[theme];
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const x of ticks(x0, x1, Math.max(2, across / 80))) pen.fillText(written(x), at(x, y0)[0], tall - ROOM.bottom + 5);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const y of ticks(y0, y1, Math.max(2, up / 55))) pen.fillText(written(y), ROOM.left - 6, at(x0, y)[1]);

  pen.textAlign = "center";
  pen.font = "600 14px system-ui, sans-serif";
  pen.lineWidth = 3;
  pen.strokeStyle = PAPER[theme];
  const [w, h] = picture.size;
  for (const { code, column, row, side } of roomiest(picture)) {
    if (Math.min((side * across) / w, (side * up) / h) < ROOM_OF_LETTER) continue;
    const [x, y] = [ROOM.left + (column * across) / w, ROOM.top + (1 - row / h) * up];
    pen.strokeText(picture.styles[code].letter, x, y);
    pen.fillText(picture.styles[code].letter, x, y);
  }
}

// Pixel by pixel of the screen: an enlarged image would be hatched in steps.
function fill(
  pen: CanvasRenderingContext2D,
  { image, size: [w, h], styles }: Picture,
  theme: "light" | "dark",
  ratio: number,
  across: number,
  up: number,
): void {
  const [wide, tall] = [Math.round(across * ratio), Math.round(up * ratio)];
  if (wide < 1 || tall < 1) return;
  const plain = styles.map((style) => mixed(style.colour, SHARE[theme], theme));
  const lines = styles.map((style) => mixed(style.colour, 1, theme));
  const data = pen.createImageData(wide, tall);
  const pixels = new Uint32Array(data.data.buffer);
  for (let j = 0; j < tall; j += 1) {
    const row = (h - 1 - Math.floor((j * h) / tall)) * w;
    for (let i = 0; i < wide; i += 1) {
      const code = image[row + Math.floor((i * w) / wide)];
      pixels[j * wide + i] = hatched(styles[code].hatch, i / ratio, j / ratio) ? lines[code] : plain[code];
    }
  }
  pen.putImageData(data, Math.round(ROOM.left * ratio), Math.round(ROOM.top * ratio));
}

function hatched(hatch: number, x: number, y: number): boolean {
  if (hatch === 0) return false;
  if (hatch < 0) return (x + y) % 8 < 1 || (x - y + 8000) % 8 < 1;
  const step = 16 / hatch;
  return (hatch % 2 ? x + y : x - y + 16000) % step < 2;
}

// As four bytes, red first, on machines that store the last byte first, as all browsers' do.
function mixed(hex: string, share: number, theme: "light" | "dark"): number {
  const part = (text: string, k: number): number => parseInt(text.slice(1 + 2 * k, 3 + 2 * k), 16);
  const byte = (k: number): number =>
    Math.round(share * part(hex, k) + (1 - share) * part(PAPER[theme], k));
  return ((255 << 24) | (byte(2) << 16) | (byte(1) << 8) | byte(0)) >>> 0;
}

// The middle of the largest square of each region.
function roomiest({ image, size: [w, h], styles }: Picture) {
  const sides = new Int32Array(w * h);
  const best = styles.map((_, code) => ({ code, column: 0, row: 0, side: 0 }));
  for (let row = 0; row < h; row += 1) {
    for (let column = 0; column < w; column += 1) {
      const k = row * w + column;
      const code = image[k];
      const inside =
        row > 0 && column > 0 && image[k - 1] === code && image[k - w] === code && image[k - w - 1] === code;
      const side = inside ? 1 + Math.min(sides[k - 1], sides[k - w], sides[k - w - 1]) : 1;
      sides[k] = side;
      if (side > best[code].side) {
        best[code] = { code, column: column + 1 - side / 2, row: row + 1 - side / 2, side };
      }
    }
  }
  return best.filter((one) => one.side > 0);
}

const written = (value: number): string => String(value).replace("-", "−");
