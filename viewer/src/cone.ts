// The collision cone of a threat: every direction of the relative velocity (own minus the
// threat's) in which a straight flight would enter the protected volume. Apex at the aircraft.

import * as THREE from "three";
import type { Obstacle, Vec3 } from "./data";

const RAYS = 48;

/** Whether a ray from `from` (relative to the volume's centre) along `to` meets the volume. */
function meets(obstacle: Obstacle, from: THREE.Vector3, to: THREE.Vector3): boolean {
  const h = obstacle.halfHeight;
  const r = obstacle.radius;
  if (h === null) {
    const along = -from.dot(to);
    return along > 0 && from.lengthSq() - along * along <= r * r;
  }
  // Within the faces for s in [s0, s1], within the wall where the quadratic is at most 0.
  let s0 = 0;
  let s1 = Infinity;
  if (Math.abs(to.z) > 1e-12) {
    const a = (-h - from.z) / to.z;
    const b = (h - from.z) / to.z;
    s0 = Math.max(s0, Math.min(a, b));
    s1 = Math.min(s1, Math.max(a, b));
  } else if (Math.abs(from.z) > h) return false;
  const a = to.x * to.x + to.y * to.y;
  const b = from.x * to.x + from.y * to.y;
  const c = from.x * from.x + from.y * from.y - r * r;
  if (a < 1e-12) return c <= 0 && s0 <= s1;
  const root = b * b - a * c;
  if (root < 0) return false;
  const half = Math.sqrt(root);
  return Math.max(s0, (-b - half) / a) <= Math.min(s1, (-b + half) / a);
}

export class CollisionCone {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  /** The rim, x, y, z of each ray's end. */
  readonly rim = new Float32Array(3 * RAYS);
  readonly rays = RAYS;
  length = 0;
  private readonly positions: THREE.BufferAttribute;

  constructor() {
    const geometry = new THREE.BufferGeometry();
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * (RAYS + 1)), 3);
    geometry.setAttribute("position", this.positions.setUsage(THREE.DynamicDrawUsage));
    const index = Array.from({ length: RAYS }, (_, i) => [0, 1 + i, 1 + ((i + 1) % RAYS)]);
    geometry.setIndex(index.flat());
    const material = new THREE.MeshBasicMaterial({
      transparent: true,
      opacity: 0.14,
      depthWrite: false,
      side: THREE.DoubleSide,
      forceSinglePass: true,
    });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
  }

  /** The cone from `own` to the obstacle at `at`; `false` where there is none (inside). */
  update(own: Vec3, obstacle: Obstacle, at: Vec3): boolean {
    const from = new THREE.Vector3(own[0] - at[0], own[1] - at[1], own[2] - at[2]);
    if (obstacle.margin(from.x, from.y, from.z) <= 0) return false;
    this.length = from.length();
    const axis = from.clone().multiplyScalar(-1 / this.length);
    const up = Math.abs(axis.z) < 0.9 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(1, 0, 0);
    const right = new THREE.Vector3().crossVectors(axis, up).normalize();
    up.crossVectors(right, axis);
    this.positions.setXYZ(0, ...own);
    const side = new THREE.Vector3();
    const ray = new THREE.Vector3();
    for (let i = 0; i < RAYS; i++) {
      const around = (2 * Math.PI * i) / RAYS;
      side.copy(right).multiplyScalar(Math.cos(around)).addScaledVector(up, Math.sin(around));
      let low = 0;
      let high = Math.PI;
      for (let k = 0; k < 24; k++) {
        const angle = (low + high) / 2;
        ray.copy(axis).multiplyScalar(Math.cos(angle)).addScaledVector(side, Math.sin(angle));
        if (meets(obstacle, from, ray)) low = angle;
        else high = angle;
      }
      ray.copy(axis).multiplyScalar(Math.cos(low)).addScaledVector(side, Math.sin(low));
      ray.multiplyScalar(this.length);
      const end: Vec3 = [own[0] + ray.x, own[1] + ray.y, own[2] + ray.z];
      this.rim.set(end, 3 * i);
      this.positions.setXYZ(1 + i, ...end);
    }
    this.positions.needsUpdate = true;
    return true;
  }
}
