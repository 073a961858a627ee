// Lines of a width in pixels, drawn as one instanced quad a segment: one draw call for any number.

import * as THREE from "three";

const VERTEX = `
uniform vec2 resolution;
uniform float flatten;
uniform float ground;
uniform float near;
uniform float now;
attribute vec2 corner;
attribute vec3 p0;
attribute vec3 p1;
attribute vec4 color;
attribute vec2 span;
attribute vec2 style;
varying vec4 vColor;
varying float vSpan;
varying float vDash;
void main() {
  vec3 w0 = p0;
  vec3 w1 = p1;
  if (flatten > 0.5) { w0.z = ground; w1.z = ground; }
  vec4 a = modelViewMatrix * vec4(w0, 1.0);
  vec4 b = modelViewMatrix * vec4(w1, 1.0);
  float length3 = distance(w0, w1);
  float ta = 0.0;
  float tb = 1.0;
  if (near > 0.0) {
    float limit = -near;
    if (a.z > limit && b.z > limit) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
    float cut = (limit - a.z) / (b.z - a.z);
    if (a.z > limit) { a = mix(a, b, cut); ta = cut; }
    else if (b.z > limit) { b = mix(a, b, cut); tb = cut; }
  }
  vec4 ca = projectionMatrix * a;
  vec4 cb = projectionMatrix * b;
  vec2 sa = ca.xy / ca.w * resolution * 0.5;
  vec2 sb = cb.xy / cb.w * resolution * 0.5;
  vec2 along = sb - sa;
  float size = length(along);
  along = size > 1e-4 ? along / size : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  vec4 c = mix(ca, cb, corner.x);
  // Ends overlap to close the joints; not where a faint line would show it.
  float overlap = span.y > now ? 0.0 : 0.35;
  vec2 offset = (across * corner.y + along * (corner.x * 2.0 - 1.0) * overlap) * style.x * 0.5;
  c.xy += offset / resolution * 2.0 * c.w;
  float t = mix(ta, tb, corner.x);
  vColor = color;
  vSpan = mix(span.x, span.y, t);
  vDash = style.y > 0.0 ? t * length3 / style.y : -1.0;
  gl_Position = c;
}`;

const FRAGMENT = `
uniform float now;
uniform float later;
uniform float opacity;
varying vec4 vColor;
varying float vSpan;
varying float vDash;
void main() {
  if (vDash >= 0.0 && fract(vDash) > 0.55) discard;
  float alpha = vColor.a * opacity * (vSpan > now ? later : 1.0);
  if (alpha < 0.01) discard;
  gl_FragColor = vec4(vColor.rgb, alpha);
  #include <colorspace_fragment>
}`;

/** A segment's look: `width` in pixels, `dash` in metres (0 for a solid line). */
export interface Stroke {
  color: THREE.Color;
  alpha: number;
  width: number;
  dash: number;
}

export class FatLines {
  readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private capacity = 0;
  private count = 0;
  private data: Record<"p0" | "p1" | "color" | "span" | "style", THREE.InstancedBufferAttribute>;

  /** `capacity` is a first guess; it grows. */
  constructor(capacity: number, order: number) {
    const geometry = new THREE.InstancedBufferGeometry();
    const corners = new Float32Array([0, -1, 1, -1, 1, 1, 0, 1]);
    geometry.setAttribute("corner", new THREE.BufferAttribute(corners, 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      uniforms: {
        resolution: { value: new THREE.Vector2(1, 1) },
        near: { value: 0 },
        now: { value: Infinity },
        later: { value: 1 },
        opacity: { value: 1 },
        flatten: { value: 0 },
        ground: { value: 0 },
      },
    });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
    this.data = this.allocate(capacity);
  }

  /** The same segments dropped to the ground: a shadow. */
  shadow(order: number): THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial> {
    const material = this.mesh.material.clone();
    material.uniforms.flatten!.value = 1;
    const mesh = new THREE.Mesh(this.mesh.geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    return mesh;
  }

  private allocate(capacity: number): FatLines["data"] {
    const make = (size: number) =>
      new THREE.InstancedBufferAttribute(new Float32Array(size * capacity), size).setUsage(
        THREE.DynamicDrawUsage,
      );
    const data = { p0: make(3), p1: make(3), color: make(4), span: make(2), style: make(2) };
    // Buffers of another size need another geometry on the graphics card.
    this.mesh.geometry.dispose();
    for (const [name, attribute] of Object.entries(data)) {
      if (this.data) attribute.array.set(this.data[name as keyof typeof data].array);
      this.mesh.geometry.setAttribute(name, attribute);
    }
    this.capacity = capacity;
    return data;
  }

  begin(): void {
    this.count = 0;
  }

  add(
    x0: number,
    y0: number,
    z0: number,
    x1: number,
    y1: number,
    z1: number,
    stroke: Stroke,
    t0 = 0,
    t1 = 0,
  ): void {
    if (this.count === this.capacity) this.data = this.allocate(2 * this.capacity);
    const i = this.count++;
    const { p0, p1, color, span, style } = this.data;
    p0.setXYZ(i, x0, y0, z0);
    p1.setXYZ(i, x1, y1, z1);
    color.setXYZW(i, stroke.color.r, stroke.color.g, stroke.color.b, stroke.alpha);
    span.setXY(i, t0, t1);
    style.setXY(i, stroke.width, stroke.dash);
  }

  /** Makes the segments added since `begin` the ones drawn; `fixed` draws that many always. */
  end(fixed = 0): void {
    while (this.count < fixed) this.add(0, 0, -1e9, 0, 0, -1e9, NOTHING);
    this.mesh.geometry.instanceCount = this.count;
    this.mesh.visible = this.count > 0;
    for (const attribute of Object.values(this.data)) attribute.needsUpdate = true;
  }
}

const NOTHING: Stroke = { color: new THREE.Color(), alpha: 0, width: 0, dash: 0 };
