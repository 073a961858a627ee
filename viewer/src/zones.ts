// Zones as glass: a body to keep out of, walls to keep within.

import * as THREE from "three";
import type { Zone } from "./data";

/** A zone without a ceiling is drawn this high above the highest flight, metres. */
const ABOVE = 60;

export class ZoneField {
  readonly group = new THREE.Group();

  /** Draws these from the ground to above the highest flight, or between their own heights. */
  rebuild(zones: Zone[], ground: number, highest: number, color: string): void {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      const mesh = child as THREE.Mesh<THREE.BufferGeometry, THREE.Material>;
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    for (const zone of zones) {
      const floor = zone.floor ?? ground;
      const height = Math.max(1, (zone.ceiling ?? Math.max(highest + ABOVE, floor + ABOVE)) - floor);
      const glass = zone.in ? walls(zone, height) : body(zone, height);
      glass.translate(0, 0, floor);
      const look = { color, transparent: true, depthWrite: false };
      const mesh = new THREE.Mesh(
        glass,
        new THREE.MeshBasicMaterial({
          ...look,
          opacity: zone.in ? 0.05 : 0.1,
          side: THREE.DoubleSide,
          forceSinglePass: true,
        }),
      );
      const edges = new THREE.LineSegments(
        new THREE.EdgesGeometry(glass, 20),
        new THREE.LineBasicMaterial({ ...look, opacity: 0.55 }),
      );
      mesh.renderOrder = 1;
      edges.renderOrder = 1;
      this.group.add(mesh, edges);
    }
  }
}

function body(zone: Zone, depth: number): THREE.BufferGeometry {
  const shape = new THREE.Shape(zone.ring.map(([x, y]) => new THREE.Vector2(x, y)));
  return new THREE.ExtrudeGeometry(shape, { depth, bevelEnabled: false });
}

function walls(zone: Zone, height: number): THREE.BufferGeometry {
  const places: number[] = [];
  for (let i = 0; i + 1 < zone.ring.length; i++) {
    const [a, b] = [zone.ring[i]!, zone.ring[i + 1]!];
    const corners = [
      [...a, 0],
      [...b, 0],
      [...b, height],
      [...a, height],
    ];
    for (const corner of [0, 1, 2, 0, 2, 3]) places.push(...corners[corner]!);
  }
  const geometry = new THREE.BufferGeometry();
  return geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
}
