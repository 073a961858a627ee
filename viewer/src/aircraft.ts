// A small fixed-wing aircraft, nose along +x, left wing along +y, one draw call.

import * as THREE from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import type { Pose } from "./data";

const LENGTH = 1.7;

function painted(geometry: THREE.BufferGeometry, shade: number): THREE.BufferGeometry {
  const plain = geometry.index ? geometry.toNonIndexed() : geometry;
  const count = plain.getAttribute("position").count;
  plain.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * count).fill(shade), 3));
  plain.deleteAttribute("uv");
  return plain;
}

/** A tapered, swept flat surface from the root at the origin along +y. */
function wing(span: number, root: number, tip: number, sweep: number, rise: number) {
  const thick = 0.05;
  const at = (x: number, y: number, z: number) => [x, y, z];
  const top = [
    at(root / 2, 0, thick),
    at(tip / 2 - sweep, span, rise + thick * 0.4),
    at(-tip / 2 - sweep, span, rise + thick * 0.2),
    at(-root / 2, 0, thick * 0.4),
  ];
  const low = top.map(([x, y, z]) => at(x!, y!, z! - thick));
  const quad = (a: number[], b: number[], c: number[], d: number[]) => [a, b, c, a, c, d].flat();
  const faces = [
    quad(top[0]!, top[1]!, top[2]!, top[3]!),
    quad(low[3]!, low[2]!, low[1]!, low[0]!),
    quad(low[0]!, low[1]!, top[1]!, top[0]!),
    quad(low[2]!, low[3]!, top[3]!, top[2]!),
    quad(low[1]!, low[2]!, top[2]!, top[1]!),
  ].flat();
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(faces), 3));
  geometry.computeVertexNormals();
  return geometry;
}

function mirrored(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  const other = geometry.clone().applyMatrix4(new THREE.Matrix4().makeScale(1, -1, 1));
  other.computeVertexNormals();
  return other;
}

export function aircraftGeometry(): THREE.BufferGeometry {
  const profile = [
    [0, -0.85],
    [0.03, -0.84],
    [0.05, -0.5],
    [0.13, 0.1],
    [0.14, 0.4],
    [0.1, 0.62],
    [0.04, 0.72],
    [0, 0.74],
  ].map(([r, x]) => new THREE.Vector2(r, x));
  const body = new THREE.LatheGeometry(profile, 12).rotateZ(-Math.PI / 2);
  const main = wing(1.25, 0.36, 0.2, 0.05, 0.09).translate(0.2, 0, 0.08);
  const tail = wing(0.42, 0.22, 0.14, 0.04, 0).translate(-0.72, 0, 0.02);
  const fin = wing(0.34, 0.26, 0.14, 0.12, 0)
    .rotateX(Math.PI / 2)
    .translate(-0.7, 0, 0.02);
  const parts = [
    painted(body, 0.92),
    painted(main, 1),
    painted(mirrored(main), 1),
    painted(tail, 1),
    painted(mirrored(tail), 1),
    painted(fin, 1),
  ];
  return mergeGeometries(parts)!;
}

export class Aircraft {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial>;

  constructor(geometry: THREE.BufferGeometry) {
    const material = new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.rotation.order = "ZYX";
    this.mesh.renderOrder = 1;
  }

  /** As flown; never smaller than `pixels` on the screen, `metres` to the pixel there. */
  place(pose: Pose, metres: number, pixels: number): void {
    this.mesh.position.set(pose.x, pose.y, pose.z);
    // Nose up turns against +y; a left bank lowers the wing along +y.
    this.mesh.rotation.set(-pose.bank, -pose.climb, pose.course);
    this.mesh.scale.setScalar(Math.max(1, (metres * pixels) / LENGTH));
  }
}
