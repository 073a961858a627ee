// The ground in relief: lit from the north-west, as maps are, with contour lines; nothing where it
// is unknown.

import * as THREE from "three";
import type { Terrain } from "./terrain";

const VERTEX = `
varying vec3 vWorld;
varying vec3 vNormal;
void main() {
  vWorld = position;
  vNormal = normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const FRAGMENT = `
uniform vec3 low;
uniform vec3 high;
uniform float lowest;
uniform float range;
uniform float contour;
varying vec3 vWorld;
varying vec3 vNormal;
void main() {
  float light = dot(normalize(vNormal), normalize(vec3(-1.0, 1.0, 1.4)));
  vec3 ground = mix(low, high, (vWorld.z - lowest) / range) * clamp(0.25 + light, 0.2, 1.15);
  float at = vWorld.z / contour;
  float width = fwidth(at);
  float line = 1.0 - smoothstep(0.5, 1.5, abs(fract(at - 0.5) - 0.5) / max(width, 1e-6));
  float fade = 1.0 - smoothstep(0.1, 0.35, width);
  gl_FragColor = vec4(ground * (1.0 - 0.3 * line * fade), 1.0);
  #include <colorspace_fragment>
}`;

export class Relief {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
  /** From one contour line to the next, metres. */
  readonly contour: number;

  constructor(terrain: Terrain) {
    const range = Math.max(1, terrain.highest - terrain.lowest);
    const size = 10 ** Math.floor(Math.log10(range / 10));
    this.contour = size * ([1, 2, 5].find((n) => range / (n * size) <= 20) ?? 10);
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      side: THREE.DoubleSide,
      // Shadows and lines on the ground lie before it.
      polygonOffset: true,
      polygonOffsetFactor: 2,
      polygonOffsetUnits: 2,
      uniforms: {
        low: { value: new THREE.Color() },
        high: { value: new THREE.Color() },
        lowest: { value: terrain.lowest },
        range: { value: range },
        contour: { value: this.contour },
      },
    });
    this.mesh = new THREE.Mesh(geometryOf(terrain), material);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }

  color([low, high]: [string, string]): void {
    this.mesh.material.uniforms.low!.value.set(low);
    this.mesh.material.uniforms.high!.value.set(high);
  }
}

function geometryOf({ corner, spacing, columns, rows, heights }: Terrain): THREE.BufferGeometry {
  const places = new Float32Array(3 * heights.length);
  heights.forEach((height, i) => {
    const x = corner[0] + spacing[0] * (i % columns);
    const y = corner[1] + spacing[1] * Math.floor(i / columns);
    places.set([x, y, Number.isFinite(height) ? height : 0], 3 * i);
  });
  const known = (...posts: number[]) => posts.every((post) => Number.isFinite(heights[post]!));
  const corners: number[] = [];
  for (let row = 0; row + 1 < rows; row++) {
    for (let column = 0; column + 1 < columns; column++) {
      const a = row * columns + column;
      const [b, c, d] = [a + 1, a + columns + 1, a + columns];
      if (known(a, b, c, d)) corners.push(a, b, c, a, c, d);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
  geometry.setIndex(corners);
  geometry.computeVertexNormals();
  return geometry;
}
