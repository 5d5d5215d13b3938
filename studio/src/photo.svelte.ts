// A photo under the mechanism, to be traced. It stays in the page, and nothing of it is sent.

import type { Point } from "./design";

const TYPES = ["image/png", "image/jpeg", "image/webp"];
const MOST_BYTES = 50e6;
const MOST_PIXELS = 60e6;

/** Where the photo lies: mm from the fixed block's midpoint, y up. */
class Photo {
  url = $state<string | null>(null);
  name = $state("");
  /** Its size [px]. */
  wide = $state(1);
  tall = $state(1);
  /** Its middle [mm], its turn [degrees, anticlockwise], and its scale [mm/px]. */
  x = $state(0);
  y = $state(0);
  turn = $state(0);
  scale = $state(1);
  opacity = $state(0.6);
  hidden = $state(false);
  /** What a pointer does on the drawing. */
  mode = $state<"" | "move" | "measure">("");
  /** Two points of a known distance, from the photo's middle [px, y up]. */
  marks = $state.raw<Point[]>([]);
  problem = $state("");

  private asked = 0;

  /** Shows a file, fitted into a box of the drawing [mm, y down]. */
  async choose(file: File, box: number[]): Promise<void> {
    const asked = ++this.asked;
    this.problem = "";
    if (!TYPES.includes(file.type)) {
      this.problem = `${file.name}: must be a photo in PNG, JPEG or WebP.`;
      return;
    }
    if (file.size > MOST_BYTES) {
      this.problem = `${file.name}: ${(file.size / 1e6).toFixed(0)} MB: must be at most ${MOST_BYTES / 1e6} MB; save it smaller.`;
      return;
    }
    const url = URL.createObjectURL(file);
    const [wide, tall] = await sizeOf(url);
    const few = wide * tall <= MOST_PIXELS;
    if (asked !== this.asked || !wide || !few) {
      URL.revokeObjectURL(url);
      if (asked === this.asked)
        this.problem = wide
          ? `${file.name}: ${wide} x ${tall} pixels: must be at most ${MOST_PIXELS / 1e6} million; save it smaller.`
          : `${file.name}: cannot be read as a picture; save it as PNG or JPEG.`;
      return;
    }
    this.remove();
    Object.assign(this, { url, wide, tall, name: file.name, turn: 0, opacity: 0.6, hidden: false });
    this.scale = Math.min(box[2] / wide, box[3] / tall);
    [this.x, this.y] = [box[0] + box[2] / 2, -(box[1] + box[3] / 2)];
  }

  remove(): void {
    if (this.url) URL.revokeObjectURL(this.url);
    this.url = null;
    this.mode = "";
    this.marks = [];
  }

  /** Scales and turns it about a place that stays [mm]. */
  change(scale: number, turn: number, [x, y]: Point): void {
    const [dx, dy] = turned([this.x - x, this.y - y], turn);
    [this.x, this.y] = [x + scale * dx, y + scale * dy];
    this.scale *= scale;
    this.turn = ((((this.turn + turn + 180) % 360) + 360) % 360) - 180;
  }

  /** A place of the drawing [mm] as one of the photo [px]. */
  inside([x, y]: Point): Point {
    const [dx, dy] = turned([x - this.x, y - this.y], -this.turn);
    return [dx / this.scale, dy / this.scale];
  }

  /** A place of the photo [px] as one of the drawing [mm]. */
  outside([x, y]: Point): Point {
    const [dx, dy] = turned([x * this.scale, y * this.scale], this.turn);
    return [this.x + dx, this.y + dy];
  }

  /** Marks a place [mm]; the third begins anew. */
  mark(place: Point): void {
    this.marks = [...(this.marks.length < 2 ? this.marks : []), this.inside(place)];
  }

  /** Sets the scale by what lies between the two marks [mm]; the first stays where it is. */
  measure(mm: number): void {
    const [a, b] = this.marks;
    const apart = Math.hypot(a[0] - b[0], a[1] - b[1]) * this.scale;
    if (!(apart > 0 && mm > 0)) return;
    this.change(mm / apart, 0, this.outside(a));
    this.marks = [];
    this.mode = "";
  }
}

function turned([x, y]: Point, degrees: number): Point {
  const angle = (degrees * Math.PI) / 180;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [x * cos - y * sin, x * sin + y * cos];
}

// Its header says how large it is: a picture of too many pixels is never unpacked.
function sizeOf(url: string): Promise<[number, number]> {
  return new Promise((settle) => {
    const image = new Image();
    image.onload = () => settle([image.naturalWidth, image.naturalHeight]);
    image.onerror = () => settle([0, 0]);
    image.src = url;
  });
}

export const photo = new Photo();
