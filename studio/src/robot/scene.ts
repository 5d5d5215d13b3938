// A run of the robot in space.

import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Material,
  Mesh,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { type Arena, GOAL_RADIUS, RADIUS, THICKNESS } from "./arena";
import { type Line, type Part, type Pose, pointOf } from "./plan";
import { Space, clear } from "./space";

const UP = new Vector3(0, 1, 0);
// The floor has squares of this width, from the origin to this distance [mm].
const [SQUARE, REACH] = [100, 3000];
// Of what is a line in the simulation [mm].
const THICK = { band: 1.3, other: 0.9 };

/** How it is to look. */
export interface Look {
  dark: boolean;
  /** The colour of each cell's bands. */
  cell: (cell: number) => string;
}

/** A robot on the floor, at any sample of its run. */
export class RunScene extends Space {
  private bodies: Group[] = [];
  private lines: { line: Line; mesh: Mesh }[] = [];
  private readonly robot = new Group();
  private readonly floor = new Group();
  private readonly last = new Vector3();

  constructor(canvas: HTMLCanvasElement) {
    super(canvas);
    this.controls.maxPolarAngle = 0.49 * Math.PI;
    this.controls.minDistance = 100;
    this.controls.maxDistance = 6000;
    this.scene.add(this.robot, this.floor);
  }

  /** What the robot is made of. */
  build(parts: Part[], lines: Line[], look: Look): void {
    this.dress(look.dark);
    clear(this.robot);
    this.bodies = [];
    for (const part of parts) {
      while (this.bodies.length <= part.body) {
        this.bodies.push(new Group());
        this.robot.add(this.bodies.at(-1)!);
      }
      const mesh = new Mesh(shapeOf(part), paint(shade(part.colour, look), part.opacity));
      mesh.position.fromArray(part.at_mm);
      const [w, x, y, z] = part.turn;
      mesh.quaternion.set(x, y, z, w);
      this.bodies[part.body].add(mesh);
    }
    this.lines = lines.map((line) => {
      const band = line.cell !== null;
      const thick = band ? THICK.band : THICK.other;
      const colour = band ? look.cell(line.cell!) : shade(line.colour, look);
      const mesh = new Mesh(new CylinderGeometry(thick, thick, 1, 8), paint(colour, 1));
      this.robot.add(mesh);
      return { line, mesh };
    });
    this.draw();
  }

  /** What stands on the floor. */
  furnish(arena: Arena | null, high: number, look: Look): void {
    clear(this.floor);
    const wall = paint(look.dark ? "#737d87" : "#8d887c", 0.8);
    for (const { from_mm: a, to_mm: b, thickness_mm: thick = THICKNESS } of arena?.wall ?? []) {
      const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
      const mesh = new Mesh(new BoxGeometry(Math.hypot(dx, dy), thick, high), wall);
      mesh.position.set((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, high / 2);
      mesh.rotation.z = Math.atan2(dy, dx);
      this.floor.add(mesh);
    }
    const round = (at: number[], radius: number, tall: number, material: Material): void => {
      const mesh = new Mesh(new CylinderGeometry(radius, radius, tall, 40), material);
      mesh.rotation.x = Math.PI / 2;
      mesh.position.set(at[0], at[1], tall / 2);
      this.floor.add(mesh);
    };
    for (const { at_mm: at, radius_mm: radius = RADIUS } of arena?.cylinder ?? []) {
      round(at, radius, high, wall);
    }
    const goal = arena?.goal;
    if (goal) round(goal.at_mm, goal.radius_mm ?? GOAL_RADIUS, 1, paint("#009e73", 0.4));
    // One line for each side of a square: some drivers leave out lines that end behind the camera.
    const sides: number[] = [];
    for (let x = -REACH; x <= REACH; x += SQUARE) {
      for (let y = -REACH; y < REACH; y += SQUARE) sides.push(x, y, 0, x, y + SQUARE, 0, y, x, 0, y + SQUARE, x, 0);
    }
    const squares = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(sides, 3));
    const grid = new LineSegments(squares, new LineBasicMaterial({ color: look.dark ? "#2d343b" : "#dcd8ce" }));
    this.floor.add(grid);
    this.draw();
  }

  /** Puts every body in its place; the camera goes with the robot. */
  pose(pose: Pose): void {
    for (const [k, body] of this.bodies.entries()) {
      body.position.set(pose.place[3 * k], pose.place[3 * k + 1], pose.place[3 * k + 2]);
      const [w, x, y, z] = [0, 1, 2, 3].map((i) => pose.turn[4 * k + i]);
      body.quaternion.set(x, y, z, w);
    }
    for (const { line, mesh } of this.lines) {
      const [a, b] = line.bodies.map(
        (body, k) => new Vector3(...(pointOf(pose, body, line.at_mm[k]) as [number, number, number])),
      );
      const along = b.clone().sub(a);
      mesh.position.copy(a).add(b).divideScalar(2);
      mesh.scale.set(1, Math.max(along.length(), 1e-3), 1);
      mesh.quaternion.copy(new Quaternion().setFromUnitVectors(UP, along.normalize()));
    }
    const now = new Vector3(pose.place[0], pose.place[1], 15);
    const by = now.clone().sub(this.last);
    this.last.copy(now);
    this.camera.position.add(by);
    this.controls.target.copy(now);
    this.controls.update();
    this.draw();
  }
}

function shapeOf({ shape, size_mm: [a, b, c] }: Part) {
  if (shape === "box") return new BoxGeometry(2 * a, 2 * b, 2 * c);
  if (shape === "ball") return new SphereGeometry(a, 20, 14);
  // A rod lies along z, and three.js makes it along y.
  return new CapsuleGeometry(a, 2 * b, 6, 12).rotateX(Math.PI / 2);
}

function paint(colour: string, opacity: number): MeshLambertMaterial {
  return new MeshLambertMaterial({ color: colour, transparent: opacity < 1, opacity });
}

// Near black is for light paper only.
const shade = (hex: string, look: Look): string => (hex === "#333338" && look.dark ? "#c8c6c0" : hex);
