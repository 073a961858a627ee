// Protected volumes and obstacle markers: four instanced meshes, whatever the number of obstacles.

import * as THREE from "three";
import type { Obstacle, Vec3 } from "./data";

const VERTEX = `
attribute vec4 tint;
varying vec3 vNormal;
varying vec3 vView;
varying float vHeight;
varying vec4 vTint;
void main() {
  // Scales are equal in x and y and normals lie in the plane or along z: no inverse needed.
  vec4 view = modelViewMatrix * instanceMatrix * vec4(position, 1.0);
  vNormal = normalize(mat3(modelViewMatrix) * mat3(instanceMatrix) * normal);
  vView = view.xyz;
  vHeight = position.z;
  vTint = tint;
  gl_Position = projectionMatrix * view;
}`;

const FRAGMENT = `
uniform bool upright;
uniform bool parallel;
varying vec3 vNormal;
varying vec3 vView;
varying float vHeight;
varying vec4 vTint;
void main() {
  vec3 eye = parallel ? vec3(0.0, 0.0, 1.0) : normalize(-vView);
  float rim = pow(1.0 - abs(dot(normalize(vNormal), eye)), 2.5);
  float at = upright ? 1.0 - abs(vHeight) : abs(vHeight);
  float ring = 1.0 - smoothstep(0.0, 1.6, at / max(fwidth(vHeight), 1e-4));
  if (upright && fwidth(vHeight) < 1e-5) ring = 0.0;
  float alpha = vTint.a * (0.13 + 0.62 * rim + 0.4 * ring);
  gl_FragColor = vec4(vTint.rgb, min(alpha, 0.9));
  #include <colorspace_fragment>
}`;

type Volumes = THREE.InstancedMesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
type Markers = THREE.InstancedMesh<THREE.BufferGeometry, THREE.MeshLambertMaterial>;

export interface Look {
  color: THREE.Color;
  alpha: number;
}

export class ObstacleField {
  readonly group = new THREE.Group();
  private spheres!: Volumes;
  private cylinders!: Volumes;
  private movers!: Markers;
  private posts!: Markers;
  private obstacles: Obstacle[] = [];

  /** Room for these obstacles; call it again when there are others. */
  rebuild(obstacles: Obstacle[]): void {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      const mesh = child as Volumes | Markers;
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.dispose();
    }
    this.obstacles = obstacles;
    const count = Math.max(1, obstacles.length);
    const fine = obstacles.length <= 100;
    const sphere = fine
      ? new THREE.SphereGeometry(1, 32, 20)
      : new THREE.SphereGeometry(1, 16, 10);
    sphere.rotateX(Math.PI / 2);
    const cylinder = new THREE.CylinderGeometry(1, 1, 2, fine ? 40 : 20).rotateX(Math.PI / 2);
    this.spheres = this.volumes(sphere, count, false);
    this.cylinders = this.volumes(cylinder, count, true);
    this.movers = this.markers(new THREE.ConeGeometry(0.42, 1.5, 8).rotateZ(-Math.PI / 2), count);
    this.posts = this.markers(new THREE.OctahedronGeometry(0.5), count);
    this.group.add(this.movers, this.posts, this.spheres, this.cylinders);
  }

  private volumes(geometry: THREE.BufferGeometry, count: number, upright: boolean): Volumes {
    const tint = new THREE.InstancedBufferAttribute(new Float32Array(4 * count), 4);
    geometry.setAttribute("tint", tint.setUsage(THREE.DynamicDrawUsage));
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      forceSinglePass: true,
      uniforms: { upright: { value: upright }, parallel: { value: false } },
    });
    const mesh = new THREE.InstancedMesh(geometry, material, count);
    mesh.frustumCulled = false;
    mesh.renderOrder = 2;
    return mesh;
  }

  private markers(geometry: THREE.BufferGeometry, count: number): Markers {
    const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshLambertMaterial(), count);
    mesh.setColorAt(0, new THREE.Color());
    mesh.frustumCulled = false;
    return mesh;
  }

  /** Draws them as they are at `t`; `faded` and `size` tell how strongly and how
   * large, in metres, to draw what is at a place. */
  update(
    t: number,
    parallel: boolean,
    look: (obstacle: Obstacle) => Look,
    faded: (at: Vec3) => number,
    size: (at: Vec3) => number,
  ): void {
    const counts = { spheres: 0, cylinders: 0, movers: 0, posts: 0 };
    const at: Vec3 = [0, 0, 0];
    const velocity: Vec3 = [0, 0, 0];
    for (const obstacle of this.obstacles) {
      if (!obstacle.present(t)) continue;
      obstacle.position(t, at);
      obstacle.velocity(t, velocity);
      PLACE.set(...at);
      const { color, alpha } = look(obstacle);
      const h = obstacle.halfHeight;
      SCALE.set(obstacle.radius, obstacle.radius, h ?? obstacle.radius);
      const volumes = h === null ? this.spheres : this.cylinders;
      const i = h === null ? counts.spheres++ : counts.cylinders++;
      volumes.setMatrixAt(i, MATRIX.compose(PLACE, STRAIGHT, SCALE));
      const tint = volumes.geometry.getAttribute("tint") as THREE.InstancedBufferAttribute;
      tint.setXYZW(i, color.r, color.g, color.b, alpha * (alpha > 1 ? 1 : faded(at)));
      DIRECTION.set(...velocity);
      const moves = DIRECTION.length() > 0.05;
      const markers = moves ? this.movers : this.posts;
      const k = moves ? counts.movers++ : counts.posts++;
      if (moves) TURN.setFromUnitVectors(FORWARD, DIRECTION.normalize());
      SCALE.setScalar(size(at));
      markers.setMatrixAt(k, MATRIX.compose(PLACE, moves ? TURN : STRAIGHT, SCALE));
      markers.setColorAt(k, color);
    }
    for (const name of ["spheres", "cylinders", "movers", "posts"] as const) {
      const mesh = this[name];
      mesh.count = counts[name];
      mesh.visible = mesh.count > 0;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
    for (const mesh of [this.spheres, this.cylinders]) {
      mesh.geometry.getAttribute("tint").needsUpdate = true;
      mesh.material.uniforms.parallel!.value = parallel;
    }
  }
}

const PLACE = new THREE.Vector3();
const SCALE = new THREE.Vector3();
const DIRECTION = new THREE.Vector3();
const FORWARD = new THREE.Vector3(1, 0, 0);
const STRAIGHT = new THREE.Quaternion();
const TURN = new THREE.Quaternion();
const MATRIX = new THREE.Matrix4();
