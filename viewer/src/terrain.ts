// The heights of the ground, as the page has them: a regular grid, bilinear between its posts.

import { bytes } from "./base64";

/** As the page has it: a height is `low` and as many steps, 65535 where it is unknown. */
export interface RawTerrain {
  corner: [number, number];
  spacing: [number, number];
  columns: number;
  low: number;
  step: number;
  heights: string;
}

const UNKNOWN = 65535;

export class Terrain {
  readonly corner: [number, number];
  readonly spacing: [number, number];
  readonly columns: number;
  readonly rows: number;
  /** Row by row from the south, each from the west, metres; NaN where unknown. */
  readonly heights: Float32Array;
  readonly lowest: number;
  readonly highest: number;

  constructor(raw: RawTerrain) {
    const steps = new Uint16Array(bytes(raw.heights).buffer);
    this.corner = raw.corner;
    this.spacing = raw.spacing;
    this.columns = raw.columns;
    this.rows = Math.floor(steps.length / raw.columns);
    this.heights = Float32Array.from(steps, (n) => (n === UNKNOWN ? NaN : raw.low + n * raw.step));
    this.lowest = raw.low;
    this.highest = this.heights.reduce((most, h) => (h > most ? h : most), raw.low);
  }

  /** The height of the ground at a place, metres; NaN where unknown. */
  at(x: number, y: number): number {
    const east = (x - this.corner[0]) / this.spacing[0];
    const north = (y - this.corner[1]) / this.spacing[1];
    const column = Math.min(Math.floor(east), this.columns - 2);
    const row = Math.min(Math.floor(north), this.rows - 2);
    if (!(column >= 0 && row >= 0 && east <= this.columns - 1 && north <= this.rows - 1)) return NaN;
    const post = (i: number, j: number) => this.heights[(row + j) * this.columns + column + i]!;
    const [a, b] = [east - column, north - row];
    const south = (1 - a) * post(0, 0) + a * post(1, 0);
    return (1 - b) * south + b * ((1 - a) * post(0, 1) + a * post(1, 1));
  }
}
