// Records what is painted as SVG, so that one way of painting serves the screen and files.

import type { Pen } from "./plot";

const ANCHORS: Record<string, string> = { left: "start", center: "middle", right: "end" };
// Height of the baseline below the given place, by size of the font.
const BASELINES: Record<string, number> = { top: 0.82, middle: 0.35, bottom: -0.22 };

/** A pen whose strokes are the elements of an SVG file. */
export class Vector implements Pen {
  strokeStyle = "#000";
  fillStyle = "#000";
  lineWidth = 1;
  lineJoin: CanvasLineJoin = "miter";
  globalAlpha = 1;
  font = "";
  textAlign: CanvasTextAlign = "left";
  textBaseline: CanvasTextBaseline = "alphabetic";
  private readonly parts: string[] = [];
  private path = "";
  private dash = "";
  private clips = 0;
  /** Groups to be closed by each `restore`. */
  private readonly groups: number[] = [];

  constructor(
    readonly wide: number,
    readonly tall: number,
    readonly title: string,
  ) {}

  beginPath(): void {
    this.path = "";
  }
  moveTo(x: number, y: number): void {
    this.path += `M${short(x)} ${short(y)}`;
  }
  lineTo(x: number, y: number): void {
    this.path += `${this.path ? "L" : "M"}${short(x)} ${short(y)}`;
  }
  /** A whole circle. */
  arc(x: number, y: number, r: number): void {
    this.path += `M${short(x + r)} ${short(y)}A${r} ${r} 0 1 1 ${short(x - r)} ${short(y)}A${r} ${r} 0 1 1 ${short(x + r)} ${short(y)}Z`;
  }
  rect(x: number, y: number, w: number, h: number): void {
    this.path += `M${short(x)} ${short(y)}h${short(w)}v${short(h)}h${short(-w)}Z`;
  }
  stroke(): void {
    if (this.path) this.add(`<path d="${this.path}" fill="none" ${this.lines()}/>`);
  }
  fill(): void {
    if (this.path) this.add(`<path d="${this.path}" fill="${this.fillStyle}" ${this.alpha()}/>`);
  }
  fillRect(x: number, y: number, w: number, h: number): void {
    this.add(`<rect ${box(x, y, w, h)} fill="${this.fillStyle}" ${this.alpha()}/>`);
  }
  strokeRect(x: number, y: number, w: number, h: number): void {
    this.add(`<rect ${box(x, y, w, h)} fill="none" ${this.lines()}/>`);
  }
  fillText(text: string, x: number, y: number): void {
    this.write(text, x, y, `fill="${this.fillStyle}"`);
  }
  strokeText(text: string, x: number, y: number): void {
    this.write(text, x, y, `fill="none" ${this.lines()}`);
  }
  setLineDash(dash: number[]): void {
    this.dash = dash.join(" ");
  }
  save(): void {
    this.groups.push(0);
  }
  clip(): void {
    this.clips += 1;
    this.add(`<clipPath id="clip${this.clips}"><path d="${this.path}"/></clipPath>`);
    this.add(`<g clip-path="url(#clip${this.clips})">`);
    this.groups[this.groups.length - 1] += 1;
  }
  restore(): void {
    this.add("</g>".repeat(this.groups.pop() ?? 0));
  }
  drawImage(image: HTMLCanvasElement, x: number, y: number, w: number, h: number): void {
    this.add(`<image ${box(x, y, w, h)} preserveAspectRatio="none" href="${image.toDataURL()}"/>`);
  }

  /** The text of the file. */
  get text(): string {
    const size = `width="${this.wide}" height="${this.tall}" viewBox="0 0 ${this.wide} ${this.tall}"`;
    return `<svg xmlns="http://www.w3.org/2000/svg" ${size}>\n<title>${escaped(this.title)}</title>\n${this.parts.join("\n")}\n</svg>\n`;
  }

  private add(part: string): void {
    this.parts.push(part);
  }
  private alpha(): string {
    return this.globalAlpha < 1 ? `opacity="${this.globalAlpha}"` : "";
  }
  private lines(): string {
    const dash = this.dash ? ` stroke-dasharray="${this.dash}"` : "";
    return `stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" stroke-linejoin="${this.lineJoin}"${dash} ${this.alpha()}`;
  }
  private write(text: string, x: number, y: number, how: string): void {
    const size = Number(/([\d.]+)px/.exec(this.font)?.[1] ?? 12);
    const at = y + size * (BASELINES[this.textBaseline] ?? 0);
    const bold = this.font.startsWith("600") ? ' font-weight="600"' : "";
    const style = `font-family="sans-serif" font-size="${size}"${bold} text-anchor="${ANCHORS[this.textAlign] ?? "start"}"`;
    this.add(`<text x="${short(x)}" y="${short(at)}" ${style} ${how}>${escaped(text)}</text>`);
  }
}

const short = (value: number): string => String(Math.round(100 * value) / 100);
const box = (x: number, y: number, w: number, h: number): string =>
  `x="${short(x)}" y="${short(y)}" width="${short(w)}" height="${short(h)}"`;
const escaped = (text: string): string => text.replace(/[&<>"]/g, (one) => `&#${one.charCodeAt(0)};`);
