// The data of the page, as `crates/fga-report/src/replay/encode.rs` writes them, decoded.
//
// Units: metres, seconds, radians; x east, y north, z up; course from +x towards +y, bank
// positive in a left turn.

import { bytes, floats } from "./base64";
import type { RawTerrain, Terrain } from "./terrain";

export type Vec3 = [number, number, number];

export const STATES = ["cruise", "threatened", "avoiding", "recovering", "manual"] as const;
export const PATH_KINDS = ["certified", "rejected", "chosen", "way back"] as const;

interface RawSamples {
  t: string;
  x: string;
  y: string;
  z: string;
  course: string;
  climb: string;
  bank: string;
  state: string;
}

export interface RawObstacle {
  id: number;
  name: string;
  r: number;
  h: number | null;
  present: [number | null, number | null] | null;
  known: number | null;
  pieces: number;
}

/** A zone; the last place of its ring is the first one again. */
export interface Zone {
  name: string;
  in: boolean;
  ring: [number, number][];
  floor: number | null;
  ceiling: number | null;
}

export interface RawDecision {
  t: number;
  state: number;
  lines: string[];
  threat: number | null;
  latest: number | null;
  origin: Vec3;
  step: number;
  paths: { kind: number; margin: number | null; n: number }[];
  loss?: [number, number];
  /** For each aircraft its identifier, and of each future the weight and the number of points. */
  futures?: [number, [number, number][]][];
}

export interface RunEvent {
  t: number;
  text: string;
}

/** The least margin: metres beyond a protected volume, negative inside. */
export interface Outcome {
  margin: number;
  t: number;
  id: number;
}

/** Alert levels and bands from a moment on. */
export interface Guidance {
  t: number;
  /** The highest alert level; 0 for no alert. */
  level: number;
  /** Obstacle, its alert level, seconds until the corrective volume is violated. */
  who: [number, number, number | null][];
  /** Direction clockwise from north, speed, climb, altitude: SI units. */
  values: number[];
  /** For each of them the parts of its scale: from, to, region. */
  bands: [number, number, number][][];
  /** For each of them the time until well clear is regained; -1 for never, null for no need. */
  recovery: (number | null)[];
}

export interface RawRun {
  name: string;
  samples: RawSamples;
  mission: Vec3[];
  obstacles: RawObstacle[];
  zones?: Zone[];
  motion: string;
  decisions: RawDecision[];
  points: string;
  interval: number;
  times: { t: string; us: string };
  events: RunEvent[];
  outcome: Outcome | null;
  levels?: number;
  guidance?: Guidance[];
}

export interface RawPage {
  title: string;
  live?: string;
  runs: RawRun[];
  ground?: RawTerrain;
}

/** A path of a decision record: points as x, y, z one after the other. */
export interface Path {
  kind: number;
  margin: number | null;
  points: Float32Array;
}

/** Smaller chances are not to be trusted; there are no futures then. */
export const LEAST_CHANCE = 0.01;

/** What an aircraft may do; points as x, y, z one after the other. */
export interface Futures {
  id: number;
  ways: { weight: number; points: Float32Array }[];
}

export interface Decision {
  t: number;
  state: number;
  lines: string[];
  threat: number | null;
  latest: number | null;
  paths: Path[];
  /** Chances of a loss on the mission and as flown; `null` of a decision without beliefs. */
  loss: [number, number] | null;
  /** Empty where the last ones still hold. */
  futures: Futures[];
}

/** A record with its paths; `pool` is read from `at` (in numbers) on. Returns the new place. */
export function decodeDecision(
  raw: RawDecision,
  pool: Int16Array,
  at: number,
): { decision: Decision; at: number } {
  const take = (n: number): Float32Array => {
    const points = new Float32Array(3 * n);
    for (let i = 0; i < 3 * n; i++) {
      points[i] = raw.origin[i % 3]! + (pool[at++] ?? 0) * raw.step;
    }
    return points;
  };
  const paths = raw.paths.map(({ kind, margin, n }) => ({ kind, margin, points: take(n) }));
  const futures = (raw.futures ?? []).map(([id, ways]) => ({
    id,
    ways: ways.map(([weight, n]) => ({ weight, points: take(n) })),
  }));
  const { t, state, lines, threat, latest, loss = null } = raw;
  return { decision: { t, state, lines, threat, latest, paths, loss, futures }, at };
}

/** The place of the last of `n` increasing values that is at most `t`; -1 before the first. */
export function lastAtMost(values: ArrayLike<number>, n: number, t: number): number {
  let low = 0;
  let high = n;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle]! <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

const PIECE = 7;

export class Obstacle {
  readonly id: number;
  readonly name: string;
  readonly radius: number;
  /** Half height of a cylinder; `null` for a sphere. */
  readonly halfHeight: number | null;
  readonly from: number;
  readonly to: number;
  readonly known: number;
  private readonly starts: Float32Array;
  private readonly pieces: Float32Array;

  constructor(raw: RawObstacle, pool: Float32Array, at: number) {
    this.id = raw.id;
    this.name = raw.name === "" ? `#${raw.id}` : raw.name;
    this.radius = raw.r;
    this.halfHeight = raw.h;
    this.from = raw.present?.[0] ?? -Infinity;
    this.to = raw.present?.[1] ?? Infinity;
    this.known = raw.known ?? -Infinity;
    this.pieces = pool.slice(at, at + PIECE * raw.pieces);
    this.starts = new Float32Array(raw.pieces);
    for (let i = 0; i < raw.pieces; i++) this.starts[i] = this.pieces[PIECE * i]!;
  }

  present(t: number): boolean {
    return this.starts.length > 0 && t >= this.from && t <= this.to;
  }

  private piece(t: number): number {
    return PIECE * Math.max(0, lastAtMost(this.starts, this.starts.length, t));
  }

  position(t: number, out: Vec3): Vec3 {
    const at = this.piece(t);
    const after = t - this.pieces[at]!;
    for (let axis = 0; axis < 3; axis++) {
      out[axis] = this.pieces[at + 1 + axis]! + after * this.pieces[at + 4 + axis]!;
    }
    return out;
  }

  velocity(t: number, out: Vec3): Vec3 {
    const at = this.piece(t);
    for (let axis = 0; axis < 3; axis++) out[axis] = this.pieces[at + 4 + axis]!;
    return out;
  }

  /** Signed distance from the volume's surface to a point at this offset from its centre. */
  margin(dx: number, dy: number, dz: number): number {
    if (this.halfHeight === null) return Math.sqrt(dx * dx + dy * dy + dz * dz) - this.radius;
    const wall = Math.sqrt(dx * dx + dy * dy) - this.radius;
    const face = Math.abs(dz) - this.halfHeight;
    return wall > 0 && face > 0 ? Math.sqrt(wall * wall + face * face) : Math.max(wall, face);
  }
}

export interface Pose {
  x: number;
  y: number;
  z: number;
  course: number;
  climb: number;
  bank: number;
  state: number;
}

const COLUMNS = ["t", "x", "y", "z", "course", "climb", "bank"] as const;
type Column = (typeof COLUMNS)[number];

/** A run; it can grow at its end while it is live. */
export class Run {
  name: string;
  n: number;
  columns: Record<Column, Float32Array>;
  state: Uint8Array;
  /** Least margin over all obstacles at each sample, metres; NaN without obstacles. */
  margin: Float32Array;
  /** Which obstacle (place in `obstacles`) has it; -1 for none. */
  nearest: Int32Array;
  mission: Vec3[];
  obstacles: Obstacle[];
  zones: Zone[];
  decisions: Decision[] = [];
  decisionStarts: number[] = [];
  timeT: number[];
  timeUs: number[];
  events: RunEvent[];
  outcome: Outcome | null;
  interval: number;
  /** The most alert levels there are. */
  levels: number;
  guidance: Guidance[];
  private readonly guidanceStarts: number[];
  ended = true;

  /** `terrain` is the ground below it, where the page has one. */
  constructor(
    raw: RawRun,
    public terrain: Terrain | null = null,
  ) {
    this.name = raw.name;
    const columns = COLUMNS.map((c) => [c, floats(raw.samples[c])] as const);
    this.columns = Object.fromEntries(columns) as Record<Column, Float32Array>;
    this.state = bytes(raw.samples.state);
    this.n = this.columns.t.length;
    this.mission = raw.mission;
    this.zones = raw.zones ?? [];
    const pool = floats(raw.motion);
    let at = 0;
    this.obstacles = raw.obstacles.map((o) => {
      const obstacle = new Obstacle(o, pool, at);
      at += PIECE * o.pieces;
      return obstacle;
    });
    const points = new Int16Array(bytes(raw.points).buffer);
    let pointAt = 0;
    for (const d of raw.decisions) {
      const decoded = decodeDecision(d, points, pointAt);
      pointAt = decoded.at;
      this.addDecision(decoded.decision);
    }
    this.timeT = Array.from(floats(raw.times.t));
    this.timeUs = Array.from(floats(raw.times.us));
    this.events = raw.events;
    this.outcome = raw.outcome;
    this.interval = raw.interval;
    this.levels = raw.levels ?? 0;
    this.guidance = raw.guidance ?? [];
    this.guidanceStarts = this.guidance.map((record) => record.t);
    this.margin = new Float32Array(this.n);
    this.nearest = new Int32Array(this.n);
    for (let i = 0; i < this.n; i++) this.measure(i);
  }

  addDecision(decision: Decision): void {
    this.decisions.push(decision);
    this.decisionStarts.push(decision.t);
  }

  /** Appends a sample: t, x, y, z, course, climb, bank, state. */
  push(row: number[]): void {
    if (this.n === this.state.length) {
      const size = Math.max(256, 2 * this.n);
      const grown = <T extends { set(a: T): void }>(a: T, make: new (n: number) => T): T => {
        const bigger = new make(size);
        bigger.set(a);
        return bigger;
      };
      for (const c of COLUMNS) this.columns[c] = grown(this.columns[c], Float32Array);
      this.margin = grown(this.margin, Float32Array);
      this.nearest = grown(this.nearest, Int32Array);
      this.state = grown(this.state, Uint8Array);
    }
    const i = this.n++;
    COLUMNS.forEach((c, k) => (this.columns[c][i] = row[k] ?? NaN));
    this.state[i] = row[7] ?? 0;
    this.measure(i);
  }

  private measure(i: number): void {
    const { t, x, y, z } = this.columns;
    let least = Infinity;
    let who = -1;
    const at: Vec3 = [0, 0, 0];
    for (let k = 0; k < this.obstacles.length; k++) {
      const obstacle = this.obstacles[k]!;
      if (!obstacle.present(t[i]!)) continue;
      obstacle.position(t[i]!, at);
      const margin = obstacle.margin(x[i]! - at[0], y[i]! - at[1], z[i]! - at[2]);
      if (margin < least) {
        least = margin;
        who = k;
      }
    }
    this.margin[i] = who < 0 ? NaN : least;
    this.nearest[i] = who;
  }

  get start(): number {
    return this.n > 0 ? this.columns.t[0]! : 0;
  }

  get end(): number {
    return this.n > 0 ? this.columns.t[this.n - 1]! : 0;
  }

  sampleAt(t: number): number {
    return Math.max(0, lastAtMost(this.columns.t, this.n, t));
  }

  /** Where the aircraft is, between samples in a straight line; `null` without samples. */
  pose(t: number): Pose | null {
    if (this.n === 0) return null;
    const i = this.sampleAt(t);
    const j = Math.min(i + 1, this.n - 1);
    const c = this.columns;
    const span = c.t[j]! - c.t[i]!;
    const f = span > 0 ? Math.min(1, Math.max(0, (t - c.t[i]!) / span)) : 0;
    const mix = (k: Column): number => c[k][i]! + f * (c[k][j]! - c[k][i]!);
    const turn = Math.atan2(
      Math.sin(c.course[j]! - c.course[i]!),
      Math.cos(c.course[j]! - c.course[i]!),
    );
    return {
      x: mix("x"),
      y: mix("y"),
      z: mix("z"),
      course: c.course[i]! + f * turn,
      climb: mix("climb"),
      bank: mix("bank"),
      state: this.state[i]!,
    };
  }

  /** The height above the ground at `t`, metres; NaN where that is unknown. */
  aboveGround(t: number): number {
    const pose = this.pose(t);
    return pose && this.terrain ? pose.z - this.terrain.at(pose.x, pose.y) : NaN;
  }

  /** Velocity over the ground between the samples about `t`; `null` where there is one only. */
  velocity(t: number): Vec3 | null {
    const i = Math.min(this.sampleAt(t), this.n - 2);
    if (i < 0) return null;
    const c = this.columns;
    const span = c.t[i + 1]! - c.t[i]!;
    if (!(span > 0)) return null;
    return [
      (c.x[i + 1]! - c.x[i]!) / span,
      (c.y[i + 1]! - c.y[i]!) / span,
      (c.z[i + 1]! - c.z[i]!) / span,
    ];
  }

  /** The obstacle whose volume is nearest at `t`, and the margin to it; `null` without one. */
  nearestAt(t: number): { obstacle: Obstacle; margin: number } | null {
    const pose = this.pose(t);
    const obstacle = this.obstacles[this.nearest[this.sampleAt(t)] ?? -1];
    if (!pose || !obstacle) return null;
    const at = obstacle.position(t, [0, 0, 0]);
    return { obstacle, margin: obstacle.margin(pose.x - at[0], pose.y - at[1], pose.z - at[2]) };
  }

  decisionAt(t: number): number {
    return lastAtMost(this.decisionStarts, this.decisions.length, t + 1e-6);
  }

  /** Whether there are decisions on beliefs. */
  get believes(): boolean {
    return this.decisions.some((decision) => decision.loss !== null);
  }

  /** The record whose futures hold at `t`; -1 where none do. */
  futuresAt(t: number): number {
    let i = this.decisionAt(t);
    while (i >= 0 && this.decisions[i]!.futures.length === 0) {
      const { loss } = this.decisions[i]!;
      if (loss === null || loss[0] < LEAST_CHANCE) return -1;
      i--;
    }
    return i;
  }

  guidanceAt(t: number): number {
    return lastAtMost(this.guidanceStarts, this.guidanceStarts.length, t + 1e-6);
  }

  obstacle(id: number | null): Obstacle | undefined {
    return id === null ? undefined : this.obstacles.find((o) => o.id === id);
  }

  /** The least margin: as the simulator gave it, else the least one at the samples. */
  least(): Outcome | null {
    if (this.outcome) return this.outcome;
    let best = -1;
    for (let i = 0; i < this.n; i++) {
      if (this.nearest[i]! >= 0 && (best < 0 || this.margin[i]! < this.margin[best]!)) best = i;
    }
    if (best < 0) return null;
    const who = this.obstacles[this.nearest[best]!]!;
    return { margin: this.margin[best]!, t: this.columns.t[best]!, id: who.id };
  }

  /** When the aircraft first avoids; `null` if it never does. */
  maneuverStart(): number | null {
    for (let i = 0; i < this.n; i++) if (this.state[i] === 2) return this.columns.t[i]!;
    return null;
  }
}
