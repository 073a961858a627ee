// Names beside what they name. They are elements over the canvas, filled as text.

import * as THREE from "three";

export class Labels {
  private readonly pool: HTMLElement[] = [];
  private used = 0;
  private camera: THREE.Camera | null = null;
  private width = 0;
  private height = 0;
  private taken: [number, number][] = [];

  constructor(private readonly host: HTMLElement) {}

  begin(camera: THREE.Camera, width: number, height: number): void {
    this.used = 0;
    this.camera = camera;
    this.width = width;
    this.height = height;
    this.taken = [];
  }

  put(x: number, y: number, z: number, text: string, color: string, strong: boolean): void {
    const at = POINT.set(x, y, z).project(this.camera!);
    if (at.z > 1 || at.z < -1 || Math.abs(at.x) > 1 || Math.abs(at.y) > 1) return;
    const left = ((at.x + 1) / 2) * this.width + 14;
    const top = ((1 - at.y) / 2) * this.height - 22;
    // One over the other reads as neither.
    if (this.taken.some(([l, t]) => Math.abs(l - left) < 60 && Math.abs(t - top) < 15)) return;
    this.taken.push([left, top]);
    let label = this.pool[this.used];
    if (!label) {
      label = document.createElement("div");
      label.className = "label";
      this.host.append(label);
      this.pool.push(label);
    }
    this.used++;
    if (label.textContent !== text) label.textContent = text;
    label.style.color = color;
    label.style.fontWeight = strong ? "700" : "500";
    label.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
    label.hidden = false;
  }

  end(): void {
    for (let i = this.used; i < this.pool.length; i++) this.pool[i]!.hidden = true;
  }
}

const POINT = new THREE.Vector3();
