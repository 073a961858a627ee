// The 3D scene of one moment.

import * as THREE from "three";
import { Aircraft, aircraftGeometry } from "./aircraft";
import { CameraRig } from "./camera";
import { CollisionCone } from "./cone";
import type { Obstacle, Run, Vec3, Zone } from "./data";
import { Ground } from "./ground";
import { Labels } from "./labels";
import { FatLines, type Stroke } from "./lines";
import { Relief } from "./relief";
import type { Terrain } from "./terrain";
import type { Theme } from "./theme";
import { Track } from "./track";
import { ObstacleField } from "./volumes";
import { ZoneField } from "./zones";

/** How far ahead an obstacle's way is drawn, seconds. */
const PREDICTION_S = 20;

/** Opacity of the likeliest future of an aircraft. */
const FAN_ALPHA = 0.5;

/** What can be switched off. */
export interface Shown {
  candidates: boolean;
  cone: boolean;
  predictions: boolean;
  labels: boolean;
}

export interface Moment {
  t: number;
  runs: Run[];
  visible: boolean[];
  focus: number;
  theme: Theme;
  shown: Shown;
}

interface RunView {
  track: Track;
  aircraft: Aircraft;
}

export class Scene {
  readonly rig: CameraRig;
  readonly renderer: THREE.WebGLRenderer;
  ground = 0;
  private readonly scene = new THREE.Scene();
  private readonly grid = new Ground();
  private terrain: Terrain | null = null;
  private relief: Relief | null = null;
  private readonly field = new ObstacleField();
  private readonly zones = new ZoneField();
  private readonly cone = new CollisionCone();
  private readonly mission = new FatLines(64, 4);
  private readonly ahead = new FatLines(256, 4);
  private readonly fan = new FatLines(512, 3);
  private readonly paths = new FatLines(512, 7);
  private readonly vectors = new FatLines(64, 8);
  private readonly labels: Labels;
  private readonly geometry = aircraftGeometry();
  private readonly shadow: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private readonly shadowLines = new Track();
  private views: RunView[] = [];
  private drawnPaths = "";
  private drawnFan = "";

  constructor(
    private readonly host: HTMLElement,
    canvas: HTMLCanvasElement,
    changed: () => void,
  ) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: false });
    this.renderer.setPixelRatio(Math.min(2, globalThis.devicePixelRatio));
    this.rig = new CameraRig(canvas, changed);
    this.labels = new Labels(host);
    this.shadow = this.shadowLines.lines.shadow(1);
    const sun = new THREE.DirectionalLight(0xffffff, 2.2);
    sun.position.set(-0.4, -0.7, 1);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8899aa, 1.6), sun);
    this.scene.add(this.grid.mesh, this.field.group, this.cone.mesh, this.shadow);
    this.scene.add(this.zones.group);
    for (const lines of [this.mission, this.fan, this.ahead, this.paths, this.vectors]) {
      this.scene.add(lines.mesh);
    }
  }

  /** Takes over runs, focus or theme: whatever does not change from moment to moment. */
  rebuild({ runs, focus, theme }: Moment): void {
    this.scene.background = new THREE.Color(theme.background);
    while (this.views.length < runs.length) {
      const view = { track: new Track(), aircraft: new Aircraft(this.geometry) };
      this.scene.add(view.track.lines.mesh, view.aircraft.mesh);
      this.views.push(view);
    }
    for (const { track, aircraft } of this.views.slice(runs.length)) {
      track.lines.mesh.visible = false;
      aircraft.mesh.visible = false;
    }
    const run = runs[focus];
    this.setTerrain(run?.terrain ?? null);
    this.rebuildTracks(runs, focus, theme);
    this.field.rebuild(run?.obstacles ?? []);
    this.relief?.color(theme.relief);
    this.ground = this.terrain ? Math.floor(this.terrain.lowest) : groundOf(runs);
    this.zones.rebuild(run?.zones ?? [], this.ground, highestOf(runs), theme.threat);
    this.mission.begin();
    const points = run?.mission ?? [];
    const stroke = look(theme.mission, 0.9, 1.6, 14);
    for (let i = 0; i + 1 < points.length; i++) {
      this.mission.add(...points[i]!, ...points[i + 1]!, stroke);
    }
    this.mission.end();
    this.drawnPaths = "";
    this.drawnFan = "";
  }

  /** Puts the relief of this ground in place of the other one. */
  private setTerrain(terrain: Terrain | null): void {
    if (terrain === this.terrain) return;
    this.relief?.mesh.removeFromParent();
    this.relief?.dispose();
    this.terrain = terrain;
    this.relief = terrain && new Relief(terrain);
    if (this.relief) this.scene.add(this.relief.mesh);
  }

  /** The tracks alone, for runs that grow. */
  rebuildTracks(runs: Run[], focus: number, theme: Theme): void {
    runs.forEach((run, i) => {
      const view = this.views[i]!;
      const own = theme.runs[i % theme.runs.length]!;
      const colors = (i === focus ? theme.states : [own]).map((c) => new THREE.Color(c));
      view.track.rebuild(run, colors, i === focus ? 3.2 : 2);
      view.track.lines.mesh.renderOrder = i === focus ? 6 : 5;
      view.aircraft.mesh.material.color.set(runs.length === 1 ? theme.aircraft : own);
    });
    const run = runs[focus];
    const muted = [new THREE.Color(theme.muted)];
    if (run) this.shadowLines.rebuild(run, muted, 1.5, this.terrain ?? undefined);
  }

  /** From one contour line to the next, metres; 0 without relief. */
  get contour(): number {
    return this.relief?.contour ?? 0;
  }

  /** The height of what lies below a place: the ground, or the grid. */
  private below(x: number, y: number): number {
    const height = this.terrain?.at(x, y) ?? NaN;
    return Number.isNaN(height) ? this.ground : height;
  }

  /** How many segments of futures are drawn. */
  get futures(): number {
    return this.fan.mesh.geometry.instanceCount;
  }

  /** Length of a cell of the grid, metres. */
  get gridCell(): number {
    return this.grid.cell;
  }

  /** Looks at what happens around `t`, from behind and aside; the view moves with the aircraft. */
  frame(runs: Run[], t: number): void {
    const pose = runs[0]?.pose(t);
    if (pose) this.rig.azimuth = pose.course - 2.5;
    this.frameBox(boxOf(runs, t - 8, t + 16));
    this.rig.setFollow(true);
  }

  /** Looks at all that was flown. */
  frameAll(runs: Run[]): void {
    this.frameBox(boxOf(runs, -Infinity, Infinity));
  }

  private frameBox(box: THREE.Box3): void {
    const size = box.getSize(new THREE.Vector3()).length();
    this.rig.frame(size < 250 ? box.expandByScalar((250 - size) / 2) : box);
  }

  render(moment: Moment): void {
    const { t, runs, visible, focus, theme, shown } = moment;
    const width = this.host.clientWidth;
    const height = this.host.clientHeight;
    if (width === 0 || height === 0) return;
    const size = this.renderer.getSize(SIZE);
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    this.rig.resize(width, height);
    const run = runs[focus];
    const pose = run?.pose(t) ?? null;
    this.rig.update(pose);
    const camera = this.rig.camera;
    this.labels.begin(camera, width, height);
    runs.forEach((other, i) => {
      const view = this.views[i]!;
      const at = visible[i] ? other.pose(t) : null;
      view.track.lines.mesh.visible = at !== null && other.n > 1;
      view.aircraft.mesh.visible = at !== null;
      if (!at) return;
      view.aircraft.place(at, this.rig.metresAt(at.x, at.y, at.z), i === focus ? 44 : 34);
      view.track.lines.mesh.material.uniforms.now!.value = t;
      view.track.lines.mesh.material.uniforms.later!.value = i === focus ? 0.28 : 0.2;
      if (shown.labels && runs.length > 1) {
        const color = theme.runs[i % theme.runs.length]!;
        this.labels.put(at.x, at.y, at.z, other.name, color, i === focus);
      }
    });
    this.shadow.visible = run !== undefined && run.n > 1 && visible[focus] === true;
    this.shadow.material.uniforms.now!.value = t;
    this.shadow.material.uniforms.later!.value = 0.3;
    this.shadow.material.uniforms.opacity!.value = 0.45;
    this.shadow.material.uniforms.ground!.value = this.ground;
    this.shadow.material.uniforms.flatten!.value = this.terrain ? 0 : 1;
    const decision = run && visible[focus] ? run.decisions[run.decisionAt(t)] : undefined;
    const threat = run?.obstacle(decision?.threat ?? null);
    this.drawObstacles(moment, threat);
    if (shown.labels) this.nameZones(run?.zones ?? [], theme);
    this.drawFan(moment, run, shown.predictions && visible[focus] === true, threat);
    this.drawPaths(moment, run, shown.candidates && visible[focus] === true);
    this.drawCone(moment, run, shown.cone && visible[focus] === true ? threat : undefined);
    this.grid.update(this.rig.target, this.ground, this.rig.distance, theme.grid);
    this.scene.traverse((object) => {
      const material = (object as THREE.Mesh).material as THREE.ShaderMaterial | undefined;
      if (!material?.uniforms?.resolution) return;
      material.uniforms.resolution.value.set(width, height);
      material.uniforms.near!.value = this.rig.near;
    });
    this.labels.end();
    this.renderer.render(this.scene, camera);
  }

  /** The name of each zone at its first corner, on the ground. */
  private nameZones(zones: Zone[], theme: Theme): void {
    for (const { name, ring, floor } of zones) {
      const [x, y] = ring[0] ?? [0, 0];
      this.labels.put(x, y, floor ?? this.below(x, y), name, theme.threat, false);
    }
  }

  private drawObstacles(moment: Moment, threat: Obstacle | undefined): void {
    const { t, runs, focus, theme, shown } = moment;
    const run = runs[focus];
    const obstacles = run?.obstacles ?? [];
    const crowd = obstacles.length > 60;
    const plain = { color: new THREE.Color(theme.obstacle), alpha: 0.9 };
    const pose = run?.pose(t);
    // In a crowd those far away step back, or they would hide the aircraft.
    const faded = (at: Vec3): number =>
      crowd && pose
        ? Math.max(0.1, 0.8 - Math.hypot(at[0] - pose.x, at[1] - pose.y, at[2] - pose.z) / 500)
        : 1;
    const unknown = { color: new THREE.Color(theme.unknown), alpha: 0.35 };
    const danger = { color: new THREE.Color(theme.threat), alpha: 1.5 };
    // A volume that is entered warns too, whether it was seen as a threat or not.
    const nearest = run?.nearestAt(t);
    const entered = nearest && nearest.margin < 0 ? nearest.obstacle : undefined;
    const lookOf = (o: Obstacle) =>
      o === threat || o === entered ? danger : t < o.known ? unknown : plain;
    this.field.update(t, this.rig.isParallel, lookOf, faded, (at) => {
      const metres = this.rig.metresAt(...at);
      return Math.max(1, metres * (crowd ? 8 : 13));
    });
    this.ahead.begin();
    const at: Vec3 = [0, 0, 0];
    const v: Vec3 = [0, 0, 0];
    const near: { obstacle: Obstacle; x: number; y: number; z: number; away: number }[] = [];
    for (const obstacle of obstacles) {
      if (!obstacle.present(t)) continue;
      obstacle.position(t, at);
      obstacle.velocity(t, v);
      const mine = obstacle === threat || obstacle === entered;
      const color = lookOf(obstacle).color;
      if (shown.predictions && (t >= obstacle.known || mine) && Math.hypot(...v) > 0.05) {
        const until = Math.min(PREDICTION_S, Math.max(0, obstacle.to - t));
        const end = at.map((c, k) => c + v[k]! * until) as Vec3;
        const alpha = mine ? 1 : 0.75 * faded(at);
        this.ahead.add(...at, ...end, { color, alpha, width: mine ? 2.4 : 1.4, dash: 8 });
      }
      if (!crowd || mine) {
        const stem = { color, alpha: mine ? 0.8 : 0.4, width: 1, dash: 0 };
        this.ahead.add(...at, at[0], at[1], this.below(at[0], at[1]), stem);
      }
      if (shown.labels && pose) {
        const away = Math.hypot(at[0] - pose.x, at[1] - pose.y, at[2] - pose.z);
        near.push({ obstacle, x: at[0], y: at[1], z: at[2], away: mine ? -1 : away });
      }
    }
    if (pose) {
      const stem = look(theme.foreground, 0.6, 1.2, 0);
      this.ahead.add(pose.x, pose.y, pose.z, pose.x, pose.y, this.below(pose.x, pose.y), stem);
    }
    this.ahead.end();
    near.sort((a, b) => a.away - b.away);
    for (const { obstacle, x, y, z } of near.slice(0, 8)) {
      const mine = obstacle === threat || obstacle === entered;
      this.labels.put(x, y, z, obstacle.name, mine ? theme.threat : theme.muted, mine);
    }
  }

  /** What each aircraft may do: the likelier, the stronger. */
  private drawFan(moment: Moment, run: Run | undefined, shown: boolean, threat?: Obstacle): void {
    const { t, theme, focus } = moment;
    const index = run && shown ? run.futuresAt(t) : -1;
    const key = `${focus} ${index} ${threat?.id} ${theme.dark}`;
    if (key === this.drawnFan) return;
    this.drawnFan = key;
    this.fan.begin();
    for (const { id, ways } of run?.decisions[index]?.futures ?? []) {
      const color = id === threat?.id ? theme.threat : theme.obstacle;
      const likeliest = Math.max(...ways.map((way) => way.weight));
      for (const { weight, points: p } of ways) {
        const stroke = look(color, (FAN_ALPHA * weight) / likeliest, 1.6, 0);
        for (let i = 0; i + 5 < p.length; i += 3) {
          this.fan.add(p[i]!, p[i + 1]!, p[i + 2]!, p[i + 3]!, p[i + 4]!, p[i + 5]!, stroke);
        }
      }
    }
    this.fan.end();
  }

  private drawPaths(moment: Moment, run: Run | undefined, shown: boolean): void {
    const { t, theme, focus } = moment;
    const index = run && shown ? run.decisionAt(t) : -1;
    const key = `${focus} ${index} ${theme.dark}`;
    if (key === this.drawnPaths) return;
    this.drawnPaths = key;
    this.paths.begin();
    const paths = run?.decisions[index]?.paths ?? [];
    // Those that matter most are drawn last: over the others.
    for (const kind of [1, 0, 3, 2]) {
      const strokes = [
        look(theme.paths[0]!, 0.95, 2.2, 0),
        look(theme.paths[1]!, 0.9, 1.5, 7),
        look(theme.paths[2]!, 1, 4, 0),
        look(theme.paths[3]!, 1, 3, 16),
      ];
      const stroke = strokes[kind]!;
      for (const path of paths) {
        if (path.kind !== kind) continue;
        const p = path.points;
        for (let i = 0; i + 5 < p.length; i += 3) {
          this.paths.add(p[i]!, p[i + 1]!, p[i + 2]!, p[i + 3]!, p[i + 4]!, p[i + 5]!, stroke);
        }
      }
    }
    this.paths.end();
  }

  private drawCone(moment: Moment, run: Run | undefined, threat: Obstacle | undefined): void {
    const { t, theme } = moment;
    const pose = run?.pose(t);
    this.vectors.begin();
    this.cone.mesh.visible = false;
    if (run && pose && threat?.present(t)) {
      const own: Vec3 = [pose.x, pose.y, pose.z];
      const at = threat.position(t, [0, 0, 0]);
      if (this.cone.update(own, threat, at)) {
        this.cone.mesh.visible = true;
        this.cone.mesh.material.color.set(theme.threat);
        const { rim, rays } = this.cone;
        const stroke = look(theme.threat, 0.9, 1.4, 0);
        const point = (i: number): Vec3 => [rim[3 * i]!, rim[3 * i + 1]!, rim[3 * i + 2]!];
        for (let i = 0; i < rays; i++) {
          this.vectors.add(...point(i), ...point((i + 1) % rays), stroke);
          if (i % 12 === 0) this.vectors.add(...own, ...point(i), stroke);
        }
        const mine = run.velocity(t);
        const its = threat.velocity(t, [0, 0, 0]);
        if (mine) this.arrow(own, [mine[0] - its[0], mine[1] - its[1], mine[2] - its[2]], theme);
      }
    }
    this.vectors.end();
  }

  /** The relative velocity, as long as the cone. */
  private arrow(own: Vec3, relative: Vec3, theme: Theme): void {
    const speed = Math.hypot(...relative);
    if (speed < 0.1) return;
    const along = new THREE.Vector3(...relative).divideScalar(speed);
    const length = this.cone.length;
    const end = new THREE.Vector3(...own).addScaledVector(along, length);
    const head = 14 * this.rig.metresAt(end.x, end.y, end.z);
    const side = new THREE.Vector3()
      .setFromMatrixColumn(this.rig.camera.matrixWorld, 2)
      .cross(along)
      .normalize()
      .multiplyScalar(head * 0.45);
    const back = end.clone().addScaledVector(along, -head);
    const stroke = look(theme.foreground, 1, 1.8, 0);
    this.vectors.add(...own, end.x, end.y, end.z, stroke);
    for (const sign of [-1, 1]) {
      const barb = back.clone().addScaledVector(side, sign);
      this.vectors.add(end.x, end.y, end.z, barb.x, barb.y, barb.z, stroke);
    }
  }
}

const SIZE = new THREE.Vector2();

function look(color: string, alpha: number, width: number, dash: number): Stroke {
  return { color: new THREE.Color(color), alpha, width, dash };
}

function boxOf(runs: Run[], from: number, to: number): THREE.Box3 {
  const box = new THREE.Box3();
  for (const { n, columns } of runs) {
    for (let i = 0; i < n; i++) {
      if (columns.t[i]! < from || columns.t[i]! > to) continue;
      box.expandByPoint(POINT.set(columns.x[i]!, columns.y[i]!, columns.z[i]!));
    }
  }
  return box.isEmpty() ? box.expandByPoint(POINT.set(0, 0, 0)) : box;
}

const POINT = new THREE.Vector3();

/** The highest altitude flown, metres. */
function highestOf(runs: Run[]): number {
  let highest = -Infinity;
  for (const { n, columns } of runs) {
    for (let i = 0; i < n; i++) highest = Math.max(highest, columns.z[i]!);
  }
  return Number.isFinite(highest) ? highest : 0;
}

/** Where the grid lies: at 0 where everything flies above it, else below the lowest. */
function groundOf(runs: Run[]): number {
  let lowest = Infinity;
  for (const run of runs) {
    for (let i = 0; i < run.n; i++) lowest = Math.min(lowest, run.columns.z[i]!);
    for (const point of run.mission) lowest = Math.min(lowest, point[2]);
  }
  if (!Number.isFinite(lowest) || lowest > 15) return lowest > 400 ? base(lowest) : 0;
  return base(lowest);
}

function base(lowest: number): number {
  return Number.isFinite(lowest) ? Math.floor((lowest - 60) / 50) * 50 : 0;
}
