// A robot in its parts, drawn by WebGL2 in one call: the graphics card moves the bodies.

import type { View } from "../wire";

// The colours of the figures, which a test compares; dark pages show ink in white.
const ROLES: Record<string, string> = {
  body: "#a8a8a8",
  carriage: "#d55e00",
  "middle block": "#0072b2",
  "outer block": "#009e73",
  lever: "#222222",
  link: "#cc79a7",
  foot: "#222222",
  antenna: "#e69f00",
  crank: "#e69f00",
  pin: "#8a8a8a",
  actuator: "#8a8a8a",
  battery: "#8a8a8a",
  support: "#a8a8a8",
};
const [INK, WHITE] = ["#222222", "#e8e6e1"];
// Tension of a band from slack to the greatest: the shades of the videos, and grey for a slack one.
const SHADES = ["#00244d", "#7d7a78", "#ffe838"];
const SLACK = "#bfbfbf";
// The darkest shade would not be seen on a dark page.
const shades = (dark: boolean): string[] => (dark ? ["#2a5a94", ...SHADES.slice(1)] : SHADES);
/** The shades as a gradient of CSS. */
export const gradient = (dark: boolean): string => `linear-gradient(90deg, ${shades(dark).join(", ")})`;

type Vec3 = [number, number, number];

const rgb = (hex: string): number[] => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);

export const roleColour = (role: string, dark: boolean): string =>
  dark && ROLES[role] === INK ? WHITE : (ROLES[role] ?? ROLES.body);

/** The roles of the parts of a view, in the order of their colours. */
export const rolesOf = (view: View): string[] => {
  const used = new Set(view.parts.map((one: { role: string }) => one.role));
  return Object.keys(ROLES).filter((role) => used.has(role));
};

function shade(tension: number, dark: boolean): number[] {
  if (tension <= 0) return rgb(SLACK);
  const at = Math.min(tension, 1) * (SHADES.length - 1);
  const k = Math.min(Math.floor(at), SHADES.length - 2);
  const [a, b] = shades(dark).slice(k, k + 2).map(rgb);
  return a.map((one, i) => one + (b[i] - one) * (at - k));
}

// Of a corner: its body, its colour and its part. A body turns about its hinge and is shifted; a
// band is a bar of unit length. In the exploded view the middles of parts move apart.
const corner = (bodies: number, colours: number): string => `#version 300 es
precision highp float;
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 middle;
layout(location = 2) in uvec4 of;
uniform mat4 camera;
uniform vec3 apart;
uniform vec4 moved[${bodies}];
uniform vec4 hinge[${bodies}];
uniform float length_[${bodies}];
uniform vec4 colours[${colours}];
uniform uint chosen;
out vec3 place;
flat out vec4 colour;
flat out uint part;
void main() {
  vec4 m = moved[of.x], h = hinge[of.x];
  vec3 p = at - h.xyz;
  p.x *= length_[of.x];
  float c = cos(m.w), s = sin(m.w);
  p = h.w > 0.5 ? vec3(c * p.x - s * p.z, p.y, s * p.x + c * p.z) : vec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
  place = p + h.xyz + m.xyz + apart * middle;
  colour = colours[of.y];
  if (of.z + 1u == chosen) colour.rgb = mix(colour.rgb, vec3(1.0, 0.95, 0.55), 0.6);
  part = of.z;
  gl_Position = colour.a > 0.0 ? camera * vec4(place, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}`;
// Faces are flat: their normal is that of the pixels around, so that faces share their corners.
const PIXEL = `#version 300 es
precision highp float;
in vec3 place;
flat in vec4 colour;
flat in uint part;
uniform bool names;
out vec4 shown;
void main() {
  if (names) {
    shown = vec4(float(part & 255u) / 255.0, float(part >> 8) / 255.0, 1.0, 1.0);
    return;
  }
  vec3 n = normalize(cross(dFdx(place), dFdy(place)));
  float sun = max(dot(n, normalize(vec3(-0.35, -0.6, 0.9))), 0.0);
  shown = vec4(colour.rgb * (0.55 + 0.1 * n.z + 0.42 * sun), 1.0);
}`;

// How far the middles of parts move apart in the exploded view, as a multiple of their distance.
const FAR: Vec3 = [0.5, 0.9, 4];
const FIELD = (35 * Math.PI) / 180;
// The sphere around all parts is larger than what is seen.
const CLOSE = 1.12;
const [NEAREST, FARTHEST] = [0.25, 4];
const BOX = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3];

/** What is drawn of a view: corners and triangles, with the bars of its bands. */
interface Mesh {
  at: Float32Array;
  middle: Float32Array;
  of: Uint16Array;
  triangles: Uint32Array;
  names: string[];
  low: Vec3;
  high: Vec3;
}

function meshOf(view: View, roles: string[]): Mesh {
  const { corners, triangles, ends } = view.blocks as Record<string, Float32Array>;
  const bands = view.bands.length;
  const own = corners.length / 3;
  const at = new Float32Array(3 * (own + 8 * bands));
  const middle = new Float32Array(at.length);
  const of = new Uint16Array((4 * at.length) / 3);
  at.set(corners);
  const [low, high]: Vec3[] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let k = 0; k < corners.length; k += 1) {
    low[k % 3] = Math.min(low[k % 3], corners[k]);
    high[k % 3] = Math.max(high[k % 3], corners[k]);
  }
  const centre = low.map((one, axis) => (one + high[axis]) / 2);
  const names: string[] = [];
  /** Gives the corners of a part their owners, and the middle of the part from that of the robot. */
  const give = (first: number, count: number, owner: number[], name: string, mid: number[]): void => {
    for (let k = first; k < first + count; k += 1) {
      of.set([...owner, names.length, 0], 4 * k);
      for (let axis = 0; axis < 3; axis += 1) middle[3 * k + axis] = mid[axis] - centre[axis];
    }
    names.push(name);
  };
  let first = 0;
  for (const { name, body, role, corners: count } of view.parts) {
    const mid = [0, 1, 2].map((axis) => {
      let [least, most] = [Infinity, -Infinity];
      for (let k = 3 * first + axis; k < 3 * (first + count); k += 3) {
        least = Math.min(least, corners[k]);
        most = Math.max(most, corners[k]);
      }
      return (least + most) / 2;
    });
    give(first, count, [body, roles.indexOf(role)], name === role ? name : `${name}: ${role}`, mid);
    first += count;
  }
  const all = new Uint32Array(triangles.length + BOX.length * bands);
  all.set(triangles);
  for (const [k, { name, z_mm, width_mm, height_mm }] of view.bands.entries()) {
    for (let i = 0; i < 8; i += 1) {
      const sign = [i & 4, i & 2, i & 1].map((bit) => (bit ? 0.5 : -0.5));
      at.set([sign[0], sign[1] * width_mm, sign[2] * height_mm], 3 * (first + i));
    }
    const mid = [(ends[4 * k] + ends[4 * k + 2]) / 2, (ends[4 * k + 1] + ends[4 * k + 3]) / 2, z_mm];
    all.set(BOX.map((i) => first + i), triangles.length + BOX.length * k);
    give(first, 8, [view.bodies.length + k, roles.length + k], name, mid);
    first += 8;
  }
  return { at, middle, of, triangles: all, names, low, high };
}

/** How it is to look. */
export interface Look {
  dark: boolean;
  hidden: ReadonlySet<string>;
}

/** A robot in its parts on a canvas; sizes are in mm, z is up. */
export class Solids {
  private readonly gl: WebGL2RenderingContext;
  private program: WebGLProgram | null = null;
  private array: WebGLVertexArrayObject | null = null;
  private buffers: WebGLBuffer[] = [];
  private view: View | null = null;
  private mesh: Mesh | null = null;
  private look: Look = { dark: false, hidden: new Set() };
  private spread = 0;
  private at = 0;
  private chosen = 0;
  private turn = -2.36;
  private tilt = 0.6;
  private zoom = 1;
  private waits = 0;
  private roles: string[] = [];

  constructor(private readonly canvas: HTMLCanvasElement) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: true });
    if (!gl) throw new Error("no WebGL2");
    this.gl = gl;
    canvas.addEventListener("webglcontextlost", this.lost);
    canvas.addEventListener("webglcontextrestored", this.restored);
  }

  private readonly lost = (event: Event): void => event.preventDefault();
  private readonly restored = (): void => {
    this.program = this.array = null;
    this.buffers = [];
    if (this.view) this.load(this.view);
  };

  /** Numbers of vertices and triangles. */
  get counts(): [number, number] {
    const { at, triangles } = this.mesh ?? { at: [], triangles: [] };
    return [at.length / 3, triangles.length / 3];
  }

  /** The parts of a design, sent to the graphics card once. */
  load(view: View): void {
    const { gl } = this;
    this.clear();
    this.view = view;
    this.roles = rolesOf(view);
    const mesh = (this.mesh = meshOf(view, this.roles));
    const bands = view.bands.length;
    const bodies = view.bodies.length + bands;
    this.program = linked(gl, corner(bodies, this.roles.length + bands));
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    const filled = (target: number, data: ArrayBufferView<ArrayBuffer>): void => {
      const buffer = gl.createBuffer()!;
      gl.bindBuffer(target, buffer);
      gl.bufferData(target, data, gl.STATIC_DRAW);
      this.buffers.push(buffer);
    };
    for (const [place, data] of [mesh.at, mesh.middle].entries()) {
      filled(gl.ARRAY_BUFFER, data as Float32Array<ArrayBuffer>);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    }
    filled(gl.ARRAY_BUFFER, mesh.of as Uint16Array<ArrayBuffer>);
    gl.enableVertexAttribArray(2);
    gl.vertexAttribIPointer(2, 4, gl.UNSIGNED_SHORT, 0, 0);
    filled(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles as Uint32Array<ArrayBuffer>);
    gl.useProgram(this.program);
    const hinges = view.bodies.flatMap((one: { hinge_mm: Vec3; upright: boolean }) => [...one.hinge_mm, Number(one.upright)]);
    gl.uniform4fv(this.place("hinge"), [...hinges, ...new Array(4 * bands).fill(0)]);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    this.draw();
  }

  show(look: Look): void {
    this.look = look;
    this.draw();
  }

  /** The robot at a sample, and between two of them. */
  pose(at: number): void {
    this.at = at;
    this.draw();
  }

  /** How far the parts are apart, 0 to 1. */
  explode(spread: number): void {
    this.spread = spread;
    this.draw();
  }

  /** Turns the view about the robot [rad], and comes closer by a factor. */
  orbit(round: number, up: number, closer = 1): void {
    this.turn += round;
    this.tilt = Math.min(1.5, Math.max(-1.5, this.tilt + up));
    this.zoom = Math.min(FARTHEST, Math.max(NEAREST, this.zoom * closer));
    this.draw();
  }

  /** Marks a part by its number; -1 for none. */
  choose(part: number): void {
    if (this.chosen === part + 1) return;
    this.chosen = part + 1;
    this.draw();
  }

  /** Number and name of the part at a place of the canvas [CSS px]. */
  partAt(x: number, y: number): [number, string] | null {
    const { gl, canvas, mesh } = this;
    if (!mesh) return null;
    const scale = canvas.width / canvas.clientWidth;
    const pixel = new Uint8Array(4);
    const [px, py] = [Math.floor(x * scale), canvas.height - 1 - Math.floor(y * scale)];
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(px, py, 1, 1);
    this.render(true);
    gl.readPixels(px, py, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.disable(gl.SCISSOR_TEST);
    this.draw();
    const part = pixel[0] + 256 * pixel[1];
    return pixel[2] === 255 && mesh.names[part] ? [part, mesh.names[part]] : null;
  }

  /** Fits the picture to the canvas. */
  fit(): void {
    const { clientWidth: wide, clientHeight: high } = this.canvas;
    if (!wide || !high) return;
    const scale = Math.min(2, devicePixelRatio);
    this.canvas.width = Math.round(wide * scale);
    this.canvas.height = Math.round(high * scale);
    this.render();
  }

  /** Gives back what the graphics card holds. */
  end(): void {
    cancelAnimationFrame(this.waits);
    this.canvas.removeEventListener("webglcontextlost", this.lost);
    this.canvas.removeEventListener("webglcontextrestored", this.restored);
    this.clear();
    // A browser has a limited number of contexts.
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  private clear(): void {
    for (const buffer of this.buffers) this.gl.deleteBuffer(buffer);
    this.gl.deleteVertexArray(this.array);
    this.gl.deleteProgram(this.program);
    this.buffers = [];
    this.program = this.array = this.mesh = null;
  }

  private place(name: string): WebGLUniformLocation | null {
    return this.gl.getUniformLocation(this.program!, name);
  }

  // Of all changes between two frames one picture is made.
  private draw(): void {
    if (this.waits) return;
    this.waits = requestAnimationFrame(() => {
      this.waits = 0;
      this.render();
    });
  }

  /** One picture; with `names` each pixel has the number of its part. */
  private render(names = false): void {
    const { gl, mesh, view, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    const [r, g, b] = names ? [0, 0, 0] : rgb(this.look.dark ? "#13171b" : "#f6f4ef");
    gl.clearColor(r, g, b, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!mesh || !view) return;
    gl.useProgram(this.program);
    const { moved, lengths, colours } = this.states(view);
    gl.uniform4fv(this.place("moved"), moved);
    gl.uniform1fv(this.place("length_"), lengths);
    gl.uniform4fv(this.place("colours"), colours);
    gl.uniform3fv(this.place("apart"), FAR.map((one) => one * this.spread));
    gl.uniformMatrix4fv(this.place("camera"), false, this.camera(mesh));
    gl.uniform1ui(this.place("chosen"), names ? 0 : this.chosen);
    gl.uniform1i(this.place("names"), Number(names));
    gl.bindVertexArray(this.array);
    gl.drawElements(gl.TRIANGLES, mesh.triangles.length, gl.UNSIGNED_INT, 0);
  }

  /** Where the bodies and the bands are, and all colours. */
  private states(view: View): Record<"moved" | "lengths" | "colours", number[]> {
    const { dark, hidden } = this.look;
    const moved = between(view, "moved", this.at);
    const ends = between(view, "ends", this.at);
    const tension = between(view, "tension", this.at);
    const lengths = view.bodies.map(() => 1);
    const colours = this.roles.flatMap((role) => [...rgb(roleColour(role, dark)), Number(!hidden.has(role))]);
    for (const [k, { z_mm, width_mm }] of view.bands.entries()) {
      const [px, py, qx, qy] = ends.slice(4 * k, 4 * k + 4);
      moved.push((px + qx) / 2, (py + qy) / 2, z_mm, Math.atan2(qy - py, qx - px));
      lengths.push(Math.hypot(qx - px, qy - py) + width_mm);
      colours.push(...shade(tension[k], dark), Number(!hidden.has("bands")));
    }
    return { moved, lengths, colours };
  }

  private camera({ low, high }: Mesh): Float32Array {
    const half = low.map((one, axis) => ((high[axis] - one) / 2) * (1 + FAR[axis] * this.spread));
    const radius = Math.hypot(...half);
    const aspect = this.canvas.width / this.canvas.height;
    const far = radius / Math.sin(FIELD / 2) / Math.min(1, aspect) / (CLOSE * this.zoom);
    const [ca, sa, ce, se] = [Math.cos(this.turn), Math.sin(this.turn), Math.cos(this.tilt), Math.sin(this.tilt)];
    const axes = [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
    const target = low.map((one, axis) => (one + high[axis]) / 2);
    const shift = axes.map((axis) => -axis.reduce((all, one, k) => all + one * target[k], 0));
    shift[2] -= far;
    const [near, end] = [Math.max(far - 2 * radius, radius / 50), far + 2 * radius];
    const f = 1 / Math.tan(FIELD / 2);
    const [a, b] = [(end + near) / (near - end), (2 * end * near) / (near - end)];
    const columns = [0, 1, 2].map((k) => axes.map((axis) => axis[k]));
    return new Float32Array(
      [...columns, shift].flatMap(([x, y, z], k) => [(f / aspect) * x, f * y, a * z + (k === 3 ? b : 0), -z]),
    );
  }
}

/** A row of an (n, ...) block, and between two rows. */
function between(view: View, name: string, at: number): number[] {
  const block: Float32Array = view.blocks[name];
  const n = view.blocks.drive.length;
  const width = block.length / n;
  const k = Math.min(Math.floor(at), n - 1);
  const next = Math.min(k + 1, n - 1);
  return Array.from({ length: width }, (_, i) => {
    const a = block[k * width + i];
    return a + (block[next * width + i] - a) * (at - k);
  });
}

function linked(gl: WebGL2RenderingContext, text: string): WebGLProgram {
  const program = gl.createProgram()!;
  for (const [kind, source] of [[gl.VERTEX_SHADER, text], [gl.FRAGMENT_SHADER, PIXEL]] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    gl.deleteShader(shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program) ?? "");
  return program;
}
