// The flown track with a fixed number of segments, however long the run: those points are kept
// that carry its shape (Ramer–Douglas–Peucker by importance) and those where the state changes.

import * as THREE from "three";
import type { Run } from "./data";
import { FatLines } from "./lines";
import type { Terrain } from "./terrain";

export const TRACK_SEGMENTS = 2048;

/** Places of at most `limit` samples, first and last among them, in order. */
export function importantSamples(run: Run, limit: number): number[] {
  const n = run.n;
  if (n <= limit) return Array.from({ length: n }, (_, i) => i);
  const { x, y, z } = run.columns;
  const importance = new Float32Array(n);
  const stack: [number, number, number][] = [];
  let from = 0;
  importance[0] = importance[n - 1] = Infinity;
  for (let i = 1; i < n; i++) {
    if (run.state[i] !== run.state[i - 1] || i === n - 1) {
      importance[i] = Infinity;
      stack.push([from, i, Infinity]);
      from = i;
    }
  }
  while (stack.length > 0) {
    const [a, b, parent] = stack.pop()!;
    if (b - a < 2) continue;
    const dx = x[b]! - x[a]!;
    const dy = y[b]! - y[a]!;
    const dz = z[b]! - z[a]!;
    const square = Math.max(dx * dx + dy * dy + dz * dz, 1e-12);
    let far = -1;
    let best = a + ((b - a) >> 1);
    for (let i = a + 1; i < b; i++) {
      const px = x[i]! - x[a]!;
      const py = y[i]! - y[a]!;
      const pz = z[i]! - z[a]!;
      const f = Math.min(1, Math.max(0, (px * dx + py * dy + pz * dz) / square));
      const off = (px - f * dx) ** 2 + (py - f * dy) ** 2 + (pz - f * dz) ** 2;
      if (off > far) {
        far = off;
        best = i;
      }
    }
    const own = Math.min(parent, Math.max(far, 0));
    if (own < 1e-4) continue;
    importance[best] = own;
    stack.push([a, best, own], [best, b, own]);
  }
  const order = Array.from({ length: n }, (_, i) => i);
  order.sort((i, j) => importance[j]! - importance[i]! || i - j);
  return order.slice(0, limit).sort((i, j) => i - j);
}

function evenSamples(run: Run): number[] {
  const every = Math.max(1, Math.ceil(run.n / TRACK_SEGMENTS));
  return Array.from({ length: Math.floor((run.n - 1) / every) + 1 }, (_, k) => k * every);
}

export class Track {
  readonly lines = new FatLines(TRACK_SEGMENTS, 5);

  /** `colors` by state, or one for the whole track; `ground` for its shadow there. */
  rebuild(run: Run, colors: THREE.Color[], width: number, ground?: Terrain): void {
    const kept = ground ? evenSamples(run) : importantSamples(run, TRACK_SEGMENTS + 1);
    const { t, x, y } = run.columns;
    const z = ground ? x.map((east, i) => ground.at(east, y[i]!)) : run.columns.z;
    this.lines.begin();
    for (let k = 0; k + 1 < kept.length; k++) {
      const i = kept[k]!;
      const j = kept[k + 1]!;
      if (Number.isNaN(z[i]!) || Number.isNaN(z[j]!)) continue;
      const color = colors[Math.min(run.state[i]!, colors.length - 1)]!;
      const stroke = { color, alpha: 1, width, dash: 0 };
      this.lines.add(x[i]!, y[i]!, z[i]!, x[j]!, y[j]!, z[j]!, stroke, t[i]!, t[j]!);
    }
    this.lines.end(TRACK_SEGMENTS);
  }
}
