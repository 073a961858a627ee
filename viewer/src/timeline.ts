// The timeline: the states of the run in focus as a coloured band, marks for what happened, and a
// slider over it.

import type { Run } from "./data";
import { STATES } from "./data";
import type { Theme } from "./theme";

export class Timeline {
  private readonly context: CanvasRenderingContext2D;
  private start = 0;
  private end = 1;
  private run: Run | undefined;
  private theme: Theme | null = null;
  private latest: number | null = null;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly slider: HTMLInputElement,
    seek: (t: number) => void,
  ) {
    this.context = canvas.getContext("2d")!;
    slider.addEventListener("input", () => seek(Number(slider.value)));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  rebuild(run: Run | undefined, start: number, end: number, theme: Theme): void {
    this.run = run;
    this.start = start;
    this.end = Math.max(end, start + 1e-3);
    this.theme = theme;
    this.slider.min = String(start);
    this.slider.max = String(this.end);
    this.draw();
  }

  /** Marks a moment and the latest safe start known then. */
  update(t: number, latest: number | null): void {
    if (latest !== this.latest) {
      this.latest = latest;
      this.draw();
    }
    this.slider.value = String(t);
    const state = this.run && this.run.n > 0 ? STATES[this.run.pose(t)!.state] : undefined;
    this.slider.setAttribute("aria-valuetext", `${t.toFixed(1)} s, ${state ?? "no data"}`);
  }

  private draw(): void {
    const { canvas, context, run, theme } = this;
    if (!theme) return;
    const ratio = globalThis.devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    canvas.width = Math.max(1, Math.round(width * ratio));
    canvas.height = Math.max(1, Math.round(height * ratio));
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const x = (t: number) => ((t - this.start) / (this.end - this.start)) * width;
    context.fillStyle = `${theme.grid}40`;
    context.fillRect(0, 8, width, height - 16);
    if (!run) return;
    const { t } = run.columns;
    let from = 0;
    for (let i = 1; i <= run.n; i++) {
      if (i < run.n && run.state[i] === run.state[from]) continue;
      context.fillStyle = theme.states[run.state[from]!] ?? theme.muted;
      const left = x(t[from]!);
      const right = i < run.n ? x(t[i]!) : x(run.end);
      context.fillRect(left, 8, Math.max(1.5, right - left), height - 16);
      from = i;
    }
    context.fillStyle = theme.foreground;
    // Many events would hide the states: they stay below the band then.
    const top = run.events.length > width / 12 ? height - 8 : 3;
    for (const event of run.events) context.fillRect(x(event.t) - 0.5, top, 1, height - 3 - top);
    if (this.latest !== null) {
      const at = x(this.latest);
      context.save();
      context.translate(at, height / 2);
      context.rotate(Math.PI / 4);
      context.fillStyle = theme.background;
      context.strokeStyle = theme.foreground;
      context.lineWidth = 1.5;
      context.fillRect(-5, -5, 10, 10);
      context.strokeRect(-5, -5, 10, 10);
      context.restore();
    }
    const least = run.least();
    if (least) {
      // The least margin: a mark above; filled where the volume was entered.
      const at = x(least.t);
      context.beginPath();
      context.moveTo(at - 6, 0);
      context.lineTo(at + 6, 0);
      context.lineTo(at, 9);
      context.closePath();
      context.fillStyle = least.margin < 0 ? theme.states[2]! : theme.background;
      context.fill();
      context.strokeStyle = theme.foreground;
      context.lineWidth = 1.2;
      context.stroke();
    }
  }
}
