// Paints a map: regions distinguished by colour, hatching and letter, and the curves between them.

import { colour } from "./colours";
import type { Point } from "./design";
import { FONT, type Frame, type Look, type Pen } from "./plot";

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
  x: Point;
  y: Point;
  styles: Style[];
  curves: Curve[];
}

const COLOURS = 6;
const SHARE = { light: 0.5, dark: 0.42 };
// A letter needs a square of so many pixels of the screen.
const ROOM_OF_LETTER = 16;

/** How the k-th sequence looks: six colours, then the same ones hatched. */
export const styleOf = (k: number, theme: "light" | "dark"): Style => ({
  letter: k < 26 ? String.fromCharCode(65 + k) : String(k + 1),
  colour: colour(k, theme),
  hatch: Math.floor(k / COLOURS),
});

export function paintMap(pen: Pen, picture: Picture, frame: Frame, look: Look, theme: "light" | "dark"): void {
  const [left, top, wide, tall] = frame.inner;
  pen.drawImage(filled(picture, frame, look, SHARE[theme]), left, top, wide, tall);
  pen.save();
  pen.beginPath();
  pen.rect(left, top, wide, tall);
  pen.clip();
  pen.strokeStyle = look.ink;
  pen.lineJoin = "round";
  for (const { points, dashed } of picture.curves) {
    pen.setLineDash(dashed ? [5, 4] : []);
    pen.lineWidth = dashed ? 1 : 1.8;
    pen.beginPath();
    for (let k = 0; k < points.length; k += 2) pen.lineTo(frame.across(points[k]), frame.up(points[k + 1]));
    pen.stroke();
  }
  pen.restore();
  pen.setLineDash([]);
  pen.lineWidth = 1;
  pen.strokeRect(left + 0.5, top + 0.5, wide - 1, tall - 1);

  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.font = `600 ${FONT.replace("12", "14")}`;
  pen.fillStyle = look.ink;
  pen.lineWidth = 3;
  pen.strokeStyle = look.paper;
  const [w, h] = picture.size;
  const value = ([low, high]: Point, part: number): number => low + part * (high - low);
  for (const { code, column, row, side } of roomiest(picture)) {
    const [x, y] = [value(picture.x, column / w), value(picture.y, row / h)];
    const across = frame.across(value(picture.x, (column + side) / w)) - frame.across(x);
    const up = frame.up(y) - frame.up(value(picture.y, (row + side) / h));
    if (Math.min(across, up) < ROOM_OF_LETTER || !frame.holds({ x, y })) continue;
    pen.strokeText(picture.styles[code].letter, frame.across(x), frame.up(y));
    pen.fillText(picture.styles[code].letter, frame.across(x), frame.up(y));
  }
}

// Pixel by pixel of the screen: an enlarged image would be hatched in steps.
function filled({ image, size: [w, h], x, y, styles }: Picture, frame: Frame, look: Look, share: number): HTMLCanvasElement {
  const ratio = devicePixelRatio || 1;
  const [left, top, ...inner] = frame.inner;
  const [wide, tall] = inner.map((one) => Math.max(1, Math.round(one * ratio)));
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [wide, tall];
  const pen = canvas.getContext("2d")!;
  const plain = styles.map((style) => mixed(style.colour, share, look.paper));
  const lines = styles.map((style) => mixed(style.colour, 1, look.paper));
  const data = pen.createImageData(wide, tall);
  const pixels = new Uint32Array(data.data.buffer);
  const index = (value: number, [low, high]: Point, n: number): number =>
    Math.max(0, Math.min(n - 1, Math.floor(((value - low) / (high - low)) * n)));
  const columns = Array.from({ length: wide }, (_, i) => index(frame.at([left + (i + 0.5) / ratio, top])[0], x, w));
  for (let j = 0; j < tall; j += 1) {
    const row = index(frame.at([left, top + (j + 0.5) / ratio])[1], y, h) * w;
    for (let i = 0; i < wide; i += 1) {
      const code = image[row + columns[i]];
      pixels[j * wide + i] = hatched(styles[code].hatch, i / ratio, j / ratio) ? lines[code] : plain[code];
    }
  }
  pen.putImageData(data, 0, 0);
  return canvas;
}

function hatched(hatch: number, x: number, y: number): boolean {
  if (hatch === 0) return false;
  if (hatch < 0) return (x + y) % 8 < 1 || (x - y + 8000) % 8 < 1;
  const step = 16 / hatch;
  return (hatch % 2 ? x + y : x - y + 16000) % step < 2;
}

// As four bytes, red first, on machines that store the last byte first, as all browsers' do.
function mixed(hex: string, share: number, paper: string): number {
  const part = (text: string, k: number): number => parseInt(text.slice(1 + 2 * k, 3 + 2 * k), 16);
  const byte = (k: number): number => Math.round(share * part(hex, k) + (1 - share) * part(paper, k));
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
