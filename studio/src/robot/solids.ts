// A robot in its parts, all drawn at once.

import {
  BatchedMesh,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  Matrix4,
  MeshLambertMaterial,
  Quaternion,
  Raycaster,
  SRGBColorSpace,
  Vector2,
  Vector3,
} from "three";
import type { View } from "../wire";
import { marked, shownColour } from "./roles";
import { Space } from "./space";

// How far the middles of parts move apart in the exploded view, as a multiple of their distance.
const FAR = new Vector3(0.5, 0.9, 4);
// The sphere around all parts is larger than what is seen.
const CLOSE = 1.12;
const [NEAREST, FARTHEST] = [0.25, 4];
const BOX = new BoxGeometry(1, 1, 1);
const X = new Vector3(1, 0, 0);

type Point = [number, number, number];

interface Body {
  hinge_mm: number[];
  upright: boolean;
  antenna: string;
}

/** A band or a cord, between points of two bodies. */
interface Line {
  bodies: [number, number];
  at_mm: [Point, Point];
  width_mm: number;
  height_mm?: number;
}

/** Something drawn: its number in the batch, its name, its role, the middle that the exploded view moves. */
interface Item {
  id: number;
  name: string;
  role: string;
  middle: Vector3;
  body: number;
  line?: Line;
}

/** What is shown of the parts. */
export interface Look {
  dark: boolean;
  hidden: ReadonlySet<string>;
  /** The antennas that are pressed. */
  pressed: ReadonlySet<string>;
  /** Names of parts that overlap. */
  struck: ReadonlySet<string>;
  /** Places of all bodies [mm, rad] instead of those of a sample. */
  held: number[][] | null;
}

/** A robot in its parts on a canvas. */
export class Solids extends Space {
  private view: View | null = null;
  private batch: BatchedMesh | null = null;
  private items: Item[] = [];
  private readonly middle = new Vector3();
  private readonly half = new Vector3();
  private look: Look = { dark: false, hidden: new Set(), pressed: new Set(), struck: new Set(), held: null };
  private spread = 0;
  private at = 0;
  private chosen = -1;
  private far = 0;
  private readonly ray = new Raycaster();

  constructor(canvas: HTMLCanvasElement) {
    super(canvas);
    this.camera.position.set(-1, -1, 1).multiplyScalar(400);
  }

  /** Numbers of vertices and triangles. */
  get counts(): [number, number] {
    const { corners, triangles } = this.view?.blocks ?? { corners: [], triangles: [] };
    const lines = this.items.filter((one) => one.line).length;
    return [corners.length / 3 + lines * BOX.attributes.position.count, triangles.length / 3 + 12 * lines];
  }

  /** The parts of a design, sent to the graphics card once. */
  load(view: View): void {
    this.batch?.removeFromParent().dispose();
    this.view = view;
    this.items = [];
    const { corners, triangles } = view.blocks as Record<string, Float32Array>;
    const lines: [string, Line[]][] = [["bands", view.bands], ["cords", view.cords]];
    const count = view.parts.length + view.bands.length + view.cords.length;
    // Faces are flat: their normal is that of the pixels around, so that faces share their corners.
    const material = new MeshLambertMaterial({ flatShading: true });
    this.batch = new BatchedMesh(count, corners.length / 3 + 24, triangles.length + 36, material);
    this.batch.perObjectFrustumCulled = this.batch.sortObjects = this.batch.frustumCulled = false;
    const all = new BufferAttribute(corners, 3);
    const bounds = new BufferGeometry().setAttribute("position", all);
    bounds.computeBoundingBox();
    bounds.boundingBox!.getCenter(this.middle);
    bounds.boundingBox!.getSize(this.half).multiplyScalar(0.5);
    let [corner, triangle] = [0, 0];
    for (const part of view.parts) {
      const own = new BufferGeometry();
      const at = corners.subarray(3 * corner, 3 * (corner + part.corners));
      own.setAttribute("position", new BufferAttribute(at, 3));
      const faces = triangles.subarray(3 * triangle, 3 * (triangle + part.triangles));
      own.setIndex(new BufferAttribute(Uint32Array.from(faces, (one) => one - corner), 1));
      own.computeBoundingBox();
      const middle = own.boundingBox!.getCenter(new Vector3());
      const name = part.name === part.role ? part.name : `${part.name}: ${part.role}`;
      const id = this.batch.addInstance(this.batch.addGeometry(own));
      this.items.push({ id, name, role: part.role, middle, body: part.body });
      corner += part.corners;
      triangle += part.triangles;
    }
    const box = this.batch.addGeometry(BOX);
    for (const [role, every] of lines) {
      for (const line of every as (Line & { name: string })[]) {
        const middle = new Vector3(...line.at_mm[0]).add(new Vector3(...line.at_mm[1])).multiplyScalar(0.5);
        const id = this.batch.addInstance(box);
        this.items.push({ id, name: line.name, role, middle, body: line.bodies[1], line });
      }
    }
    this.scene.add(this.batch);
    this.controls.target.copy(this.middle);
    this.distance();
    this.place();
  }

  show(look: Look): void {
    this.look = look;
    this.dress(look.dark);
    this.place();
  }

  /** The robot at a sample, and between two of them. */
  pose(at: number): void {
    this.at = at;
    this.place();
  }

  /** How far the parts are apart, 0 to 1. */
  explode(spread: number): void {
    this.spread = spread;
    this.distance();
    this.place();
  }

  /** Marks a part by its number; -1 for none. */
  choose(part: number): void {
    if (this.chosen === part) return;
    this.chosen = part;
    this.colour();
  }

  /** Number and name of the part at a place of the canvas [CSS px]. */
  partAt(x: number, y: number): [number, string] | null {
    if (!this.batch) return null;
    const { clientWidth: wide, clientHeight: high } = this.canvas;
    this.ray.setFromCamera(new Vector2((2 * x) / wide - 1, 1 - (2 * y) / high), this.camera);
    const id = this.ray.intersectObject(this.batch)[0]?.batchId;
    const number = this.items.findIndex((one) => one.id === id);
    return number < 0 ? null : [number, this.items[number].name];
  }

  override fit(): void {
    super.fit();
    this.distance();
  }

  /** The camera keeps its place relative to all parts, which move apart or have another picture. */
  private distance(): void {
    if (!this.view) return;
    const half = this.half.clone().multiply(FAR.clone().multiplyScalar(this.spread).addScalar(1));
    const field = (this.camera.fov * Math.PI) / 360;
    const far = half.length() / Math.sin(field) / Math.min(1, this.camera.aspect) / CLOSE;
    const arm = this.camera.position.clone().sub(this.controls.target);
    if (!this.far) arm.setLength(far);
    else arm.multiplyScalar(far / this.far);
    this.far = far;
    this.camera.position.copy(this.controls.target).add(arm);
    [this.controls.minDistance, this.controls.maxDistance] = [NEAREST * far, FARTHEST * far];
    [this.camera.near, this.camera.far] = [far / 100, (FARTHEST + 2) * far];
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** Puts every part in its place, and gives it its colour. */
  private place(): void {
    const { view, batch } = this;
    if (!view || !batch) return;
    const bodies = (view.bodies as Body[]).map((body, k) => placed(body, this.moved(k, body.antenna)));
    const [matrix, apart] = [new Matrix4(), new Vector3()];
    for (const { id, body, line, middle } of this.items) {
      matrix.copy(line ? between(line, bodies) : bodies[body]);
      apart.subVectors(middle, this.middle).multiply(FAR).multiplyScalar(this.spread);
      batch.setMatrixAt(id, matrix.premultiply(new Matrix4().makeTranslation(apart)));
    }
    this.colour();
  }

  private colour(): void {
    const { view, batch, look } = this;
    if (!view || !batch) return;
    const colour = new Color();
    for (const [k, { id, name, role, body }] of this.items.entries()) {
      const band = role === "bands" ? k - view.parts.length : null;
      const tension = band === null ? null : this.value("tension", view.bands.length, band, view.bodies[body].antenna);
      const own = shownColour(role, look.dark, tension);
      const [r, g, b] = marked(own, k === this.chosen, look.struck.has(name.split(": ")[0]));
      batch.setColorAt(id, colour.setRGB(r, g, b, SRGBColorSpace));
      batch.setVisibleAt(id, !look.hidden.has(role));
    }
    this.draw();
  }

  /** Shift x, y, z [mm] and turn [rad] of a body at the sample, or where it is held. */
  private moved(number: number, antenna: string): number[] {
    const width = 4 * this.view!.bodies.length;
    return this.look.held?.[number] ?? [0, 1, 2, 3].map((i) => this.value("moved", width, 4 * number + i, antenna));
  }

  /** A number of an (s, n, ...) block at the sample, or between two, with an antenna at rest or pressed. */
  private value(name: string, width: number, column: number, antenna: string): number {
    const { blocks } = this.view!;
    const n = blocks.drive.length;
    const first = this.look.pressed.has(antenna) ? n : 0;
    const k = Math.min(Math.floor(this.at), n - 1);
    const [a, b] = [k, Math.min(k + 1, n - 1)].map((row) => blocks[name][(first + row) * width + column]);
    return a + (b - a) * (this.at - k);
  }
}

/** Where a body is: turned about its hinge, and shifted. */
function placed({ hinge_mm: hinge, upright }: Body, [x, y, z, turn]: number[]): Matrix4 {
  const [a, b, c] = hinge;
  const matrix = upright ? new Matrix4().makeRotationY(-turn) : new Matrix4().makeRotationZ(turn);
  matrix.multiply(new Matrix4().makeTranslation(-a, -b, -c));
  return matrix.premultiply(new Matrix4().makeTranslation(a + x, b + y, c + z));
}

/** A bar of unit size as a band or a cord between its two bodies. */
function between({ bodies, at_mm, width_mm, height_mm }: Line, placed: Matrix4[]): Matrix4 {
  const [a, b] = bodies.map((body, k) => new Vector3(...at_mm[k]).applyMatrix4(placed[body]));
  const along = b.clone().sub(a);
  const length = along.length();
  // A band is a loop around its hooks; a cord is round.
  const size = new Vector3(length + (height_mm ? width_mm : 0), width_mm, height_mm ?? width_mm);
  const turn = new Quaternion().setFromUnitVectors(X, along.normalize());
  return new Matrix4().compose(a.add(b).multiplyScalar(0.5), turn, size);
}
