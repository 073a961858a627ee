// The ground grid: one quad under the camera's target; lines are computed for each pixel, so that
// it has no end and needs no geometry.

import * as THREE from "three";

const VERTEX = `
varying vec3 vWorld;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

const FRAGMENT = `
uniform vec3 color;
uniform vec2 centre;
uniform float cell;
uniform float reach;
uniform float strength;
uniform float between;
varying vec3 vWorld;
float grid(vec2 at, vec2 width) {
  vec2 line = abs(fract(at - 0.5) - 0.5) / max(width, vec2(1e-6));
  vec2 shown = (1.0 - smoothstep(0.4, 1.3, line)) * (1.0 - smoothstep(0.2, 0.6, width));
  return max(shown.x, shown.y);
}
void main() {
  vec2 at = vWorld.xy / cell;
  vec2 width = fwidth(at);
  float fine = grid(at, width) * 0.35 * (1.0 - between);
  float coarse = grid(at / 10.0, width / 10.0) * mix(0.8, 0.35, between);
  float fade = 1.0 - smoothstep(0.25, 1.0, distance(vWorld.xy, centre) / reach);
  float alpha = max(fine, coarse) * fade * strength;
  if (alpha < 0.004) discard;
  gl_FragColor = vec4(color, alpha);
  #include <colorspace_fragment>
}`;

export class Ground {
  readonly mesh: THREE.Mesh<THREE.PlaneGeometry, THREE.ShaderMaterial>;
  cell = 10;

  constructor() {
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      uniforms: {
        color: { value: new THREE.Color() },
        centre: { value: new THREE.Vector2() },
        cell: { value: 10 },
        reach: { value: 1000 },
        strength: { value: 0.5 },
        between: { value: 0 },
      },
    });
    this.mesh = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = -1;
  }

  update(centre: THREE.Vector3, z: number, distance: number, color: string): void {
    const size = Math.log10(Math.max(distance, 20) / 6);
    this.cell = 10 ** Math.floor(size);
    const reach = distance * 8 + 500;
    this.mesh.position.set(centre.x, centre.y, z);
    this.mesh.scale.set(reach, reach, 1);
    const uniforms = this.mesh.material.uniforms;
    uniforms.color!.value.set(color);
    uniforms.centre!.value.set(centre.x, centre.y);
    uniforms.cell!.value = this.cell;
    uniforms.between!.value = size - Math.floor(size);
    uniforms.reach!.value = reach;
  }
}
