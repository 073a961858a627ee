// The four cameras: orbit and chase in perspective, top and side parallel. One rig holds what the
// mouse, the fingers and the keys change.

import * as THREE from "three";
import type { Pose } from "./data";

export const MODES = ["orbit", "chase", "top", "side"] as const;
export type Mode = (typeof MODES)[number];

const FIELD_OF_VIEW = (40 * Math.PI) / 180;

export class CameraRig {
  mode: Mode = "orbit";
  /** Whether the target moves with the aircraft. */
  follow = true;
  readonly target = new THREE.Vector3();
  /** Direction from the target to the camera, course angle and height angle, radians. */
  azimuth = -2.2;
  elevation = 0.5;
  distance = 400;
  camera: THREE.PerspectiveCamera | THREE.OrthographicCamera;
  private readonly perspective = new THREE.PerspectiveCamera();
  private readonly parallel = new THREE.OrthographicCamera();
  private readonly pan = new THREE.Vector3();
  private saved: Partial<Record<Mode, [number, number, number]>> = {};
  private width = 1;
  private height = 1;

  constructor(
    element: HTMLElement,
    private readonly changed: () => void,
  ) {
    this.camera = this.perspective;
    this.listen(element);
  }

  resize(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
  }

  setMode(mode: Mode): void {
    this.saved[this.mode] = [this.azimuth, this.elevation, this.distance];
    const preset: Record<Mode, [number, number, number]> = {
      orbit: [this.azimuth, 0.5, this.distance],
      chase: [Math.PI, 0.28, 110],
      top: [-Math.PI / 2, Math.PI / 2, this.mode === "chase" ? 500 : this.distance],
      side: [-Math.PI / 2, 0, this.mode === "chase" ? 500 : this.distance],
    };
    this.mode = mode;
    [this.azimuth, this.elevation, this.distance] = this.saved[mode] ?? preset[mode];
    this.changed();
  }

  setFollow(follow: boolean): void {
    this.follow = follow;
    this.pan.set(0, 0, 0);
    this.changed();
  }

  /** Looks at a box so that all of it is in sight; the target then stays. */
  frame(box: THREE.Box3): void {
    box.getCenter(this.target);
    const radius = Math.max(30, box.getSize(new THREE.Vector3()).length() / 2);
    const narrow = Math.min(1, this.width / this.height);
    this.distance = (radius * 0.9) / Math.tan(FIELD_OF_VIEW / 2) / narrow;
    this.follow = false;
    this.pan.set(0, 0, 0);
    this.changed();
  }

  zoom(factor: number): void {
    this.distance = Math.min(2e5, Math.max(5, this.distance * factor));
    this.changed();
  }

  rotate(azimuth: number, elevation: number): void {
    if (this.mode === "top") return;
    this.azimuth += azimuth;
    if (this.mode === "side") elevation = 0;
    this.elevation = Math.min(1.55, Math.max(-0.3, this.elevation + elevation));
    this.changed();
  }

  /** Moves the target by pixels right and down. */
  move(dx: number, dy: number): void {
    const metres = this.metresPerPixel();
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    this.pan.addScaledVector(right, -dx * metres).addScaledVector(up, dy * metres);
    this.changed();
  }

  private metresPerPixel(): number {
    return (2 * this.distance * Math.tan(FIELD_OF_VIEW / 2)) / this.height;
  }

  /** Metres to the pixel at a place. */
  metresAt(x: number, y: number, z: number): number {
    if (this.camera === this.parallel) return this.metresPerPixel();
    const away = this.camera.position.distanceTo(SCRATCH.set(x, y, z));
    return (2 * away * Math.tan(FIELD_OF_VIEW / 2)) / this.height;
  }

  get isParallel(): boolean {
    return this.camera === this.parallel;
  }

  /** Nearest distance drawn; 0 for a parallel camera. */
  get near(): number {
    return this.isParallel ? 0 : this.perspective.near;
  }

  /** Turning of north on the screen against straight up, clockwise, radians. */
  get north(): number {
    const heading = this.heading;
    return heading - Math.PI / 2;
  }

  private heading = Math.PI / 2;

  update(pose: Pose | null): void {
    let azimuth = this.azimuth;
    if (pose && (this.follow || this.mode === "chase")) {
      this.target.set(pose.x, pose.y, pose.z);
    }
    if (pose && this.mode === "chase") azimuth += pose.course;
    const centre = SCRATCH.copy(this.target).add(this.pan);
    const level = Math.cos(this.elevation);
    const back = new THREE.Vector3(
      level * Math.cos(azimuth),
      level * Math.sin(azimuth),
      Math.sin(this.elevation),
    );
    const flat = this.mode === "top" || this.mode === "side";
    const aspect = this.width / this.height;
    this.camera = flat ? this.parallel : this.perspective;
    if (flat) {
      const half = this.distance * Math.tan(FIELD_OF_VIEW / 2);
      this.parallel.left = -half * aspect;
      this.parallel.right = half * aspect;
      this.parallel.top = half;
      this.parallel.bottom = -half;
      const away = 20_000 + 4 * this.distance;
      this.parallel.near = 1;
      this.parallel.far = 2 * away;
      this.parallel.position.copy(centre).addScaledVector(back, away);
    } else {
      this.perspective.fov = (FIELD_OF_VIEW * 180) / Math.PI;
      this.perspective.aspect = aspect;
      this.perspective.near = Math.max(0.5, this.distance * 0.01);
      this.perspective.far = this.distance * 40 + 20_000;
      this.perspective.position.copy(centre).addScaledVector(back, this.distance);
    }
    const camera = this.camera;
    if (this.mode === "top") camera.up.set(-Math.cos(azimuth), -Math.sin(azimuth), 0);
    else camera.up.set(0, 0, 1);
    camera.lookAt(centre);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.heading = azimuth + Math.PI;
  }

  private listen(element: HTMLElement): void {
    const fingers = new Map<number, { x: number; y: number }>();
    let spread = 0;
    const middle = () => {
      const all = [...fingers.values()];
      const x = all.reduce((sum, f) => sum + f.x, 0) / all.length;
      const y = all.reduce((sum, f) => sum + f.y, 0) / all.length;
      const size = all.length < 2 ? 0 : Math.hypot(all[0]!.x - all[1]!.x, all[0]!.y - all[1]!.y);
      return { x, y, size };
    };
    element.addEventListener("pointerdown", (e) => {
      element.setPointerCapture(e.pointerId);
      fingers.set(e.pointerId, { x: e.clientX, y: e.clientY });
      spread = middle().size;
    });
    element.addEventListener("pointermove", (e) => {
      if (!fingers.has(e.pointerId)) return;
      const before = middle();
      fingers.set(e.pointerId, { x: e.clientX, y: e.clientY });
      const after = middle();
      const dx = after.x - before.x;
      const dy = after.y - before.y;
      const panning = fingers.size > 1 || e.buttons === 2 || e.shiftKey || this.mode === "top";
      if (panning) this.move(dx, dy);
      else this.rotate(-dx * 0.006, dy * 0.006);
      if (fingers.size > 1 && spread > 0 && after.size > 0) {
        this.zoom(spread / after.size);
        spread = after.size;
      }
    });
    const lift = (e: PointerEvent) => {
      fingers.delete(e.pointerId);
      spread = 0;
    };
    element.addEventListener("pointerup", lift);
    element.addEventListener("pointercancel", lift);
    element.addEventListener("contextmenu", (e) => e.preventDefault());
    element.addEventListener(
      "wheel",
      (e) => {
        e.preventDefault();
        this.zoom(Math.exp(Math.sign(e.deltaY) * Math.min(0.3, Math.abs(e.deltaY) * 0.0015)));
      },
      { passive: false },
    );
  }
}

const SCRATCH = new THREE.Vector3();
