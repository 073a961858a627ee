// The plots under the timeline: margin, course, climb, bank, decision time.

import uPlot from "uplot";
import { LEAST_CHANCE, type Run } from "./data";
import type { Theme } from "./theme";

const DEGREES = 180 / Math.PI;
/** Points of a curve; more would not show. */
const POINTS = 3000;
/** Length of the window, seconds. */
const WINDOW_S = 60;

export interface PlotInput {
  runs: Run[];
  visible: boolean[];
  focus: number;
  theme: Theme;
  start: number;
  end: number;
}

interface Curve {
  t: number[];
  values: (number | null)[];
}

interface Kind {
  title: string;
  unit: string;
  curve(run: Run): Curve;
  /** A second curve of the run in focus: a limit not to go below. */
  limit?(run: Run): Curve;
  /** Whether values far apart are drawn on a logarithmic scale. */
  log?: boolean;
  /** What stands above the plot at a moment. */
  read(run: Run, t: number): string;
  format?(value: number): string;
  range?(low: number, high: number, limit: number): [number, number];
}

/** Larger margins are off the scale, metres. */
const MOST_MARGIN_M = 500;

/** Every sample, or of each group of neighbours the one with the least margin. */
function picks(run: Run): number[] {
  const group = Math.max(1, Math.ceil(run.n / POINTS));
  const out: number[] = [];
  for (let i = 0; i < run.n; i += group) {
    let best = i;
    for (let k = i; k < Math.min(run.n, i + group); k++) {
      if (run.margin[k]! < run.margin[best]!) best = k;
    }
    out.push(best);
  }
  return out;
}

function sampled(run: Run, value: (i: number) => number | null): Curve {
  const places = picks(run);
  return { t: places.map((i) => run.columns.t[i]!), values: places.map(value) };
}

const finite = (x: number): number | null => (Number.isFinite(x) ? x : null);

function symmetric(least: number) {
  return (low: number, high: number): [number, number] => {
    const most = Math.max(least, 1.1 * Math.abs(low), 1.1 * Math.abs(high));
    return [-most, most];
  };
}

function compass(value: number): string {
  const turned = ((Math.round(value) % 360) + 360) % 360;
  return `${String(turned).padStart(3, "0")}°`;
}

/** The height above the ground. */
export function aboveWords(run: Run, t: number): string {
  const above = run.aboveGround(t);
  return Number.isNaN(above) ? "unknown" : `${above.toFixed(0)} m`;
}

/** One of the two chances of each decision on beliefs, percent. */
function loss(run: Run, which: 0 | 1): Curve {
  if (!run.believes) return { t: [], values: [] };
  return {
    t: run.decisionStarts,
    values: run.decisions.map((decision) => decision.loss && 100 * decision.loss[which]),
  };
}

function percent(chance: number): string {
  return chance < LEAST_CHANCE ? "<1 %" : `${Math.round(100 * chance)} %`;
}

const KINDS: Kind[] = [
  {
    title: "Margin",
    unit: "m",
    curve: (run) => sampled(run, (i) => finite(run.margin[i]!)),
    limit: (run) => sampled(run, () => 0),
    read: (run, t) => {
      const i = run.sampleAt(t);
      const obstacle = run.obstacles[run.nearest[i] ?? -1];
      if (!obstacle) return "no obstacle";
      const margin = run.margin[i]!;
      return margin < 0 ? `${(-margin).toFixed(1)} m inside` : `${margin.toFixed(1)} m`;
    },
    range: (low, high) => [Math.min(0, 1.1 * low), Math.min(MOST_MARGIN_M, Math.max(20, 1.05 * high))],
  },
  {
    title: "P(loss)",
    unit: "%",
    curve: (run) => loss(run, 1),
    limit: (run) => loss(run, 0),
    read: (run, t) => {
      const chances = run.decisions[run.decisionAt(t)]?.loss;
      return chances ? `mission ${percent(chances[0])}, flown ${percent(chances[1])}` : "not weighed";
    },
    range: (_low, high) => [0, Math.min(100, Math.max(10, 1.1 * high))],
  },
  {
    title: "z and ground",
    unit: "m",
    curve: (run) => sampled(run, (i) => finite(run.columns.z[i]!)),
    limit: (run) =>
      sampled(run, (i) => finite(run.terrain?.at(run.columns.x[i]!, run.columns.y[i]!) ?? NaN)),
    read: (run, t) => `${aboveWords(run, t)} above ground`,
    range: (low, high) => {
      const spare = Math.max(5, 0.08 * (high - low));
      return [low - spare, high + spare];
    },
  },
  {
    title: "Course",
    unit: "°",
    curve: (run) => {
      let turned = 0;
      let last = NaN;
      return sampled(run, (i) => {
        const bearing = 90 - run.columns.course[i]! * DEGREES;
        if (Number.isFinite(last)) turned += 360 * Math.round((last - bearing - turned) / 360);
        last = bearing + turned;
        return finite(last);
      });
    },
    read: (run, t) => compass(90 - (run.pose(t)?.course ?? NaN) * DEGREES),
    format: compass,
    range: (low, high) => {
      const spare = Math.max(5, 0.1 * (high - low));
      return [low - spare, high + spare];
    },
  },
  {
    title: "Climb",
    unit: "°",
    curve: (run) => sampled(run, (i) => finite(run.columns.climb[i]! * DEGREES)),
    read: (run, t) => `${((run.pose(t)?.climb ?? NaN) * DEGREES).toFixed(1)}°`,
    range: symmetric(5),
  },
  {
    title: "Bank, left +",
    unit: "°",
    curve: (run) => sampled(run, (i) => finite(run.columns.bank[i]! * DEGREES)),
    read: (run, t) => `${((run.pose(t)?.bank ?? NaN) * DEGREES).toFixed(0)}°`,
    range: symmetric(10),
  },
  {
    title: "Decision time",
    unit: "µs",
    curve: (run) => {
      // Of many, the longest of each group: it is the one that matters.
      const group = Math.max(1, Math.ceil(run.timeT.length / POINTS));
      const out: Curve = { t: [], values: [] };
      for (let i = 0; i < run.timeT.length; i += group) {
        let best = i;
        for (let k = i; k < Math.min(run.timeT.length, i + group); k++) {
          if (run.timeUs[k]! > run.timeUs[best]!) best = k;
        }
        out.t.push(run.timeT[best]!);
        out.values.push(finite(run.timeUs[best]!));
      }
      return out;
    },
    read: (run, t) => {
      if (run.timeT.length === 0) return "not recorded";
      let i = 0;
      while (i + 1 < run.timeT.length && run.timeT[i + 1]! <= t + 1e-6) i++;
      return `${run.timeUs[i]!.toFixed(0)} µs`;
    },
    log: true,
    range: (_low, high) => [0, Math.max(10, 1.1 * high)],
  },
];

const [, LOSS, GROUND] = KINDS;
const DECISION_TIME = KINDS[KINDS.length - 1];

export class Plots {
  private plots: { plot: uPlot; value: HTMLElement; now: HTMLElement; kind: Kind; host: HTMLElement }[] =
    [];
  private readonly watcher: ResizeObserver;
  private t = 0;
  private input: PlotInput | null = null;
  /** While a plot is dragged its window stays, or it would run away from the pointer. */
  private held = false;
  /** Whether only the minute around the moment is shown. */
  windowed = false;

  constructor(
    private readonly root: HTMLElement,
    private readonly seek: (t: number) => void,
  ) {
    this.watcher = new ResizeObserver(() => this.fit());
    this.watcher.observe(root);
  }

  /** Makes them anew: other runs, other theme, more samples. */
  rebuild(input: PlotInput): void {
    this.input = input;
    for (const { plot } of this.plots) plot.destroy();
    this.root.replaceChildren();
    // Most pages have no decision times: an empty plot would take its room from the others.
    const timed = input.runs.some((run) => run.timeT.length > 0);
    const grounded = input.runs.some((run) => run.terrain !== null);
    const believes = input.runs.some((run) => run.believes);
    const kinds = KINDS.filter((kind) => {
      if (kind === DECISION_TIME) return timed;
      if (kind === LOSS) return believes;
      return kind !== GROUND || grounded;
    });
    this.plots = kinds.map((kind) => this.make(kind, input));
    this.fit();
  }

  private make(kind: Kind, input: PlotInput) {
    const { runs, visible, focus, theme } = input;
    const host = document.createElement("section");
    host.className = "plot";
    const head = document.createElement("h3");
    head.textContent = kind.title;
    const value = document.createElement("span");
    head.append(" ", value);
    host.append(head);
    this.root.append(host);
    const tables: uPlot.AlignedData[] = [];
    const series: uPlot.Series[] = [{}];
    const add = (curve: Curve, options: uPlot.Series) => {
      if (curve.t.length === 0) return;
      const increasing = curve.t.every((t, i) => i === 0 || t > curve.t[i - 1]!);
      if (!increasing) return;
      tables.push([curve.t, curve.values] as uPlot.AlignedData);
      series.push({ spanGaps: kind !== LOSS, points: { show: curve.t.length === 1, size: 6 }, ...options });
    };
    const order = runs.map((_, i) => i).filter((i) => visible[i] && i !== focus);
    if (visible[focus]) order.push(focus);
    const focused = runs[focus];
    let most = 0;
    const curves = order.map((i) => kind.curve(runs[i]!));
    const logarithmic = kind.log === true && farApart(curves);
    if (kind.limit && focused && visible[focus]) {
      const danger = theme.states[2]!;
      const limit = kind.limit(focused);
      most = limit.values.reduce<number>((a, b) => Math.max(a, b ?? 0), 0);
      add(limit, {
        stroke: danger,
        width: 1.5,
        dash: [5, 3],
        fill: `${danger}2e`,
      });
    }
    order.forEach((i, k) => {
      const color = theme.runs[i % theme.runs.length]!;
      add(curves[k]!, { stroke: color, width: i === focus ? 2 : 1.25 });
    });
    const data = tables.length > 0 ? uPlot.join(tables) : ([[input.start], []] as never);
    const axis = {
      stroke: theme.muted,
      font: "11px system-ui, sans-serif",
      grid: { stroke: `${theme.grid}33`, width: 1 },
      ticks: { show: false },
    };
    const format = kind.format ?? ((v: number) => String(Math.round(v * 100) / 100));
    const plot = new uPlot(
      {
        width: 200,
        height: 120,
        padding: [6, 16, 0, 0],
        legend: { show: false },
        cursor: { drag: { x: false, y: false }, points: { show: false }, y: false },
        scales: {
          x: { time: false, range: () => this.reach(input) },
          y: logarithmic
            ? { distr: 3, range: (_u, low, high) => [0.8 * (low ?? 1), 1.25 * (high ?? 10)] }
            : { range: (_u, low, high) => bounds(kind, low, high, most) },
        },
        series,
        axes: [
          { ...axis, size: 22, gap: 2, space: 45, values: (_u, v) => v.map((x) => `${x} s`) },
          {
            ...axis,
            size: 44,
            gap: 3,
            space: 24,
            ...(logarithmic ? { splits: (_u, _i, low, high) => powers(low, high) } : {}),
            values: (_u, v) => v.map((x) => (x === null ? "" : format(x))),
          },
        ],
      },
      data,
      host,
    );
    host.classList.toggle("blank", tables.length === 0);
    const now = document.createElement("div");
    now.className = "now";
    plot.over.append(now);
    const scrub = (e: PointerEvent) => {
      const box = plot.over.getBoundingClientRect();
      this.seek(plot.posToVal(e.clientX - box.left, "x"));
    };
    plot.over.addEventListener("pointerdown", (e) => {
      plot.over.setPointerCapture(e.pointerId);
      this.held = true;
      scrub(e);
    });
    const release = () => (this.held = false);
    plot.over.addEventListener("pointerup", release);
    plot.over.addEventListener("pointercancel", release);
    plot.over.addEventListener("pointermove", (e) => {
      if (e.buttons > 0) scrub(e);
    });
    return { plot, value, now, kind, host };
  }

  /** The times shown: the whole run, or the window around the moment. */
  private reach({ start, end }: PlotInput): [number, number] {
    if (!this.windowed || end - start <= WINDOW_S) return [start, Math.max(end, start + 1)];
    const from = Math.min(Math.max(start, this.t - WINDOW_S / 2), end - WINDOW_S);
    return [from, from + WINDOW_S];
  }

  private fit(): void {
    for (const { plot, host } of this.plots) {
      const width = host.clientWidth;
      const height = host.clientHeight - 22;
      if (width < 40 || height < 30) continue;
      if (plot.width !== width || plot.height !== height) plot.setSize({ width, height });
    }
    this.moment?.();
  }

  private moment: (() => void) | null = null;

  /** Marks a moment and reads the values there. */
  update(run: Run | undefined, t: number): void {
    if (!this.held) this.t = t;
    this.moment = () => {
      const [from, to] = this.input ? this.reach(this.input) : [0, 1];
      for (const { plot, value, now, kind } of this.plots) {
        if (this.windowed && !this.held) plot.setScale("x", { min: from, max: to });
        const text = run && run.n > 0 ? kind.read(run, t) : "no data";
        if (value.textContent !== text) value.textContent = text;
        // Not the plot's own conversion: it takes a new range over a moment later.
        const x = ((t - from) / (to - from)) * plot.over.clientWidth;
        now.hidden = !Number.isFinite(x) || x < -1 || x > plot.over.clientWidth + 1;
        now.style.transform = `translateX(${x}px)`;
      }
    };
    this.moment();
  }
}

/** The powers of ten in a range. */
function powers(low: number, high: number): number[] {
  const out: number[] = [];
  for (let k = Math.ceil(Math.log10(low)); k <= Math.log10(high); k++) out.push(10 ** k);
  return out;
}

/** Whether the largest value would press the others against the axis. */
function farApart(curves: Curve[]): boolean {
  const values = curves.flatMap((curve) => curve.values.filter((v) => v !== null));
  values.sort((a, b) => a - b);
  const middle = values[values.length >> 1] ?? 0;
  return middle > 0 && values[0]! > 0 && values[values.length - 1]! > 20 * middle;
}

function bounds(
  kind: Kind,
  low: number | null,
  high: number | null,
  limit: number,
): [number, number] {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) {
    return [0, 1];
  }
  return kind.range?.(low, high, limit) ?? [low, high];
}
