// A view in 3D. Only robots load this, and three.js with it.

import {
  AmbientLight,
  BatchedMesh,
  Color,
  DirectionalLight,
  LineSegments,
  type Material,
  Mesh,
  type Object3D,
  PerspectiveCamera,
  Scene,
  TOUCH,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const [UP, LOWEST, HIGHEST] = [new Vector3(0, 0, 1), 0.05, 1.5];

/** A scene on a canvas, with light, and a camera that goes round it; sizes are in mm, z is up. */
export class Space {
  protected readonly scene = new Scene();
  protected readonly camera = new PerspectiveCamera(35, 1, 10, 20_000);
  protected readonly controls: OrbitControls;
  private readonly renderer: WebGLRenderer;
  private waits = 0;

  constructor(protected readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.camera.up.copy(UP);
    this.camera.position.set(-330, -330, 300);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.touches.TWO = TOUCH.DOLLY_ROTATE;
    this.controls.addEventListener("change", () => this.draw());
    canvas.addEventListener("webglcontextrestored", this.restored);
    const sun = new DirectionalLight("#ffffff", 2.65);
    sun.position.set(-300, -500, 900);
    this.scene.add(new AmbientLight("#ffffff", 0.8), sun);
  }

  private readonly restored = (): void => this.draw();

  /** Sets the colour of the ground behind everything. */
  protected dress(dark: boolean): void {
    this.scene.background = new Color(dark ? "#13171b" : "#f6f4ef");
  }

  /** Turns the view [rad], and comes closer by a factor. */
  orbit(round: number, up: number, closer = 1): void {
    const arm = this.camera.position.clone().sub(this.controls.target);
    const flat = Math.hypot(arm.x, arm.y);
    const [turn, tilt] = [Math.atan2(arm.y, arm.x) + round, Math.atan2(arm.z, flat) + up];
    const lowest = this.controls.maxPolarAngle < 3 ? LOWEST : -HIGHEST;
    const [far, high] = [arm.length() / closer, Math.min(HIGHEST, Math.max(lowest, tilt))];
    const across = far * Math.cos(high);
    arm.set(across * Math.cos(turn), across * Math.sin(turn), far * Math.sin(high));
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.draw();
  }

  /** Fits the picture to the canvas. */
  fit(): void {
    const { clientWidth: wide, clientHeight: high } = this.canvas;
    if (!wide || !high) return;
    this.renderer.setSize(wide, high, false);
    this.camera.aspect = wide / high;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Gives back what the graphics card holds. */
  end(): void {
    cancelAnimationFrame(this.waits);
    clear(this.scene);
    this.canvas.removeEventListener("webglcontextrestored", this.restored);
    this.controls.dispose();
    this.renderer.dispose();
    // A browser has a limited number of contexts.
    this.renderer.forceContextLoss();
  }

  /** Of all changes between two frames one picture is made. */
  protected draw(): void {
    this.waits ||= requestAnimationFrame(() => {
      this.waits = 0;
      this.renderer.render(this.scene, this.camera);
    });
  }
}

/** Empties a group, and gives back what the graphics card holds of it. */
export function clear(group: Object3D): void {
  group.traverse((one: Object3D) => {
    if (!(one instanceof Mesh || one instanceof LineSegments)) return;
    one.geometry.dispose();
    (one.material as Material).dispose();
    if (one instanceof BatchedMesh) one.dispose();
  });
  group.clear();
}
