// The page: what is shown, at which moment, and what the controls do.

import { MODES, type Mode } from "./camera";
import { type RawPage, Run } from "./data";
import { GuidancePanel } from "./guidance";
import { fillHelp, type Key, listen } from "./keys";
import { apply, type Change, liveAddress } from "./live";
import {
  DecisionPanel,
  element,
  fillEvents,
  fillLegend,
  fillRuns,
  SHOWN_WORDS,
  stateWords,
  updateMargins,
} from "./panel";
import { aboveWords, Plots } from "./plots";
import { type Moment, Scene, type Shown } from "./scene";
import { Terrain } from "./terrain";
import { type Theme, themeOf } from "./theme";
import { Timeline } from "./timeline";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20];
const LIVE_REDRAW_MS = 400;
/** Longer runs open with the minute around the moment in the plots. */
const LONG_S = 180;

const $ = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

class App {
  readonly runs: Run[];
  visible: boolean[];
  focus = 0;
  t = 0;
  playing = false;
  speed = 1;
  shown: Shown = { candidates: true, cone: true, predictions: true, labels: true };
  theme: Theme;
  scene: Scene | null = null;
  /** Keeps up with the newest sample of a live run. */
  private atEnd = false;
  private start = 0;
  private end = 0;
  private stale = true;
  private last = 0;
  private readonly plots: Plots;
  private readonly timeline: Timeline;
  private readonly decision: DecisionPanel;
  private readonly guidance: GuidancePanel;

  constructor(page: RawPage) {
    const terrain = page.ground ? new Terrain(page.ground) : null;
    this.runs = page.runs.map((raw) => new Run(raw, terrain));
    this.visible = this.runs.map(() => true);
    this.theme = themeOf(matchMedia("(prefers-color-scheme: dark)").matches);
    $("title").textContent = page.title;
    this.plots = new Plots($("plots"), (t) => this.seek(t));
    const slider = document.querySelector<HTMLInputElement>("#timeline input")!;
    const band = document.querySelector<HTMLCanvasElement>("#timeline canvas")!;
    this.timeline = new Timeline(band, slider, (t) => this.seek(t));
    this.decision = new DecisionPanel($("decision"));
    this.guidance = new GuidancePanel($("guidance-box"), $("guidance"));
    try {
      this.scene = new Scene($("view"), $<HTMLCanvasElement>("scene"), () => this.redraw());
    } catch {
      $("no-graphics").hidden = false;
    }
    this.span();
    this.plots.windowed = this.end - this.start > LONG_S;
    this.t = this.opening();
    this.controls();
    this.retheme();
    this.scene?.frame(this.runs, this.t);
    this.setCamera("orbit");
    new ResizeObserver(() => this.redraw()).observe($("view"));
    const address = liveAddress(page.live);
    if (address) this.listen(address);
    requestAnimationFrame((now) => this.tick(now));
  }

  /** The page opens where the first manoeuvre begins, or at the closest moment, or at the start. */
  private opening(): number {
    const run = this.runs[0];
    const least = run?.least();
    return run?.maneuverStart() ?? (least && least.margin < 0 ? least.t : this.start);
  }

  private span(): void {
    const flown = this.runs.filter((run) => run.n > 0);
    this.start = flown.length > 0 ? Math.min(...flown.map((run) => run.start)) : 0;
    this.end = flown.length > 0 ? Math.max(...flown.map((run) => run.end)) : 0;
  }

  redraw(): void {
    this.stale = true;
  }

  /** Standing parts: after a change of runs, focus or theme. */
  private rebuild(): void {
    this.scene?.rebuild(this.moment());
    this.retime();
    const { runs, visible, focus, theme } = this;
    fillRuns($("runs"), runs, visible, focus, theme, {
      toggle: (i) => this.toggleRun(i),
      focus: (i) => this.setFocus(i),
    });
    fillEvents($("events"), runs[focus], (t) => this.seek(t));
    const manual = runs.some((run) => run.state.subarray(0, run.n).includes(4));
    const believes = runs.some((run) => run.believes);
    fillLegend($("legend"), theme, manual, believes ? theme.runs[focus % theme.runs.length] : undefined);
    this.redraw();
  }

  /** Parts along the time. */
  private retime(): void {
    this.span();
    const { runs, visible, focus, theme, start, end } = this;
    this.plots.rebuild({ runs, visible, focus, theme, start, end });
    this.timeline.rebuild(runs[focus], start, end, theme);
  }

  private moment(): Moment {
    const { t, runs, visible, focus, theme, shown } = this;
    return { t, runs, visible, focus, theme, shown };
  }

  seek(t: number): void {
    this.t = Math.min(this.end, Math.max(this.start, Number.isFinite(t) ? t : this.start));
    this.atEnd = this.live && this.t >= this.end - 1e-6;
    this.redraw();
  }

  get live(): boolean {
    return this.runs.some((run) => !run.ended);
  }

  play(playing: boolean): void {
    if (playing && !this.live && this.t >= this.end - 1e-6) this.seek(this.start);
    this.playing = playing;
    const button = $("play");
    button.textContent = playing ? "❚❚" : "▶";
    button.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.redraw();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    $<HTMLSelectElement>("speed").value = String(speed);
  }

  private faster(by: number): void {
    const place = SPEEDS.indexOf(this.speed) + by;
    this.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, place))]!);
  }

  setFocus(run: number): void {
    if (!this.runs[run]) return;
    this.focus = run;
    this.visible[run] = true;
    this.rebuild();
  }

  toggleRun(run: number): void {
    if (!this.runs[run]) return;
    this.visible[run] = !this.visible[run];
    this.rebuild();
  }

  setCamera(mode: Mode): void {
    if (this.scene && this.scene.rig.mode !== mode) this.scene.rig.setMode(mode);
    for (const button of $("cameras").querySelectorAll("button")) {
      button.setAttribute("aria-pressed", String(button.dataset.mode === mode));
    }
  }

  /** To the next or the previous record of the run in focus. */
  private stepDecision(by: 1 | -1): void {
    const run = this.runs[this.focus];
    if (!run) return;
    const here = run.decisionAt(this.t);
    const back = by < 0 && here >= 0 && this.t - run.decisionStarts[here]! > 1e-3;
    const next = run.decisionStarts[back ? here : here + by];
    if (next !== undefined) this.seek(next);
  }

  private toManeuver(): void {
    const start = this.runs[this.focus]?.maneuverStart();
    if (start !== null && start !== undefined) this.seek(start);
  }

  private toClosest(): void {
    const least = this.runs[this.focus]?.least();
    if (least) this.seek(least.t);
  }

  private show(what: keyof Shown): void {
    this.shown[what] = !this.shown[what];
    const box = document.querySelector<HTMLInputElement>(`#shown input[name="${what}"]`);
    if (box) box.checked = this.shown[what];
    this.redraw();
  }

  private zoomPlots(): void {
    this.plots.windowed = !this.plots.windowed;
    $<HTMLInputElement>("window").checked = this.plots.windowed;
    this.retime();
    this.redraw();
  }

  private retheme(dark = this.theme.dark): void {
    this.theme = themeOf(dark);
    document.documentElement.classList.toggle("dark", dark);
    this.rebuild();
  }

  private help(open?: boolean): void {
    const dialog = $<HTMLDialogElement>("help");
    if (open ?? !dialog.open) dialog.showModal();
    else dialog.close();
  }

  private controls(): void {
    $("play").addEventListener("click", () => this.play(!this.playing));
    $("theme").addEventListener("click", () => this.retheme(!this.theme.dark));
    $("help-open").addEventListener("click", () => this.help(true));
    $("help-close").addEventListener("click", () => this.help(false));
    $("maneuver").addEventListener("click", () => this.toManeuver());
    $("critical").addEventListener("click", () => this.toClosest());
    $("compass").addEventListener("click", () => this.setCamera("top"));
    const speed = $<HTMLSelectElement>("speed");
    for (const value of SPEEDS) speed.add(new Option(`${value}×`, String(value)));
    speed.value = "1";
    speed.addEventListener("change", () => this.setSpeed(Number(speed.value)));
    for (const mode of MODES) {
      const button = element("button", "", mode[0]!.toUpperCase() + mode.slice(1));
      button.type = "button";
      button.dataset.mode = mode;
      button.addEventListener("click", () => this.setCamera(mode));
      $("cameras").append(button);
    }
    for (const [name, words] of SHOWN_WORDS) {
      const box = element("input", "");
      box.type = "checkbox";
      box.name = name;
      box.checked = true;
      box.addEventListener("change", () => this.show(name));
      $("shown").append(element("label", "", box, words));
    }
    const box = element("input", "");
    box.type = "checkbox";
    box.id = "window";
    box.checked = this.plots.windowed;
    box.addEventListener("change", () => this.zoomPlots());
    $("shown").append(element("label", "", box, "Plots: one minute"));
    const keys = this.keys();
    listen(keys);
    fillHelp($("keys"), keys);
  }

  private keys(): Key[] {
    const step = (event: KeyboardEvent) => (event.shiftKey ? 0.1 : 1);
    const rig = this.scene?.rig;
    return [
      { keys: [" "], words: "Play or pause", act: () => this.play(!this.playing) },
      {
        keys: ["ArrowLeft"],
        words: "Back 1 s; with Shift 0.1 s",
        act: (e) => this.seek(this.t - step(e)),
      },
      {
        keys: ["ArrowRight"],
        words: "On 1 s; with Shift 0.1 s",
        act: (e) => this.seek(this.t + step(e)),
      },
      { keys: [","], words: "Previous decision", act: () => this.stepDecision(-1) },
      { keys: ["."], words: "Next decision", act: () => this.stepDecision(1) },
      { keys: ["Home"], words: "Start", act: () => this.seek(this.start) },
      { keys: ["End"], words: "End; a live run is followed", act: () => this.seek(this.end) },
      { keys: ["m"], words: "Start of the manoeuvre", act: () => this.toManeuver() },
      { keys: ["c"], words: "Closest moment: the least margin", act: () => this.toClosest() },
      { keys: ["[", "]"], words: "Slower, faster", act: (e) => this.faster(e.key === "[" ? -1 : 1) },
      { keys: ["o"], words: "Camera: orbit", act: () => this.setCamera("orbit") },
      { keys: ["h"], words: "Camera: chase", act: () => this.setCamera("chase") },
      { keys: ["t"], words: "Camera: top, north up", act: () => this.setCamera("top") },
      { keys: ["s"], words: "Camera: side", act: () => this.setCamera("side") },
      {
        keys: ["f"],
        words: "Follow the aircraft, or stay",
        act: () => rig?.setFollow(!rig.follow),
      },
      {
        keys: ["a"],
        words: "See all of the flight",
        act: () => this.scene?.frameAll(this.runs),
      },
      {
        keys: ["ArrowUp", "ArrowDown"],
        words: "Nearer, farther; with Shift tilt",
        act: (e) => {
          const up = e.key === "ArrowUp";
          if (e.shiftKey) rig?.rotate(0, up ? 0.08 : -0.08);
          else rig?.zoom(up ? 0.85 : 1 / 0.85);
        },
      },
      { keys: ["q", "e"], words: "Turn the view", act: (e) => rig?.rotate(e.key === "q" ? -0.1 : 0.1, 0) },
      {
        keys: ["1", "2", "3", "4", "5", "6", "7", "8", "9"],
        words: "Show or hide a run",
        act: (e) => this.toggleRun(Number(e.key) - 1),
      },
      {
        keys: ["r"],
        words: "Next run in focus",
        act: () => this.setFocus((this.focus + 1) % Math.max(1, this.runs.length)),
      },
      { keys: ["v"], words: "Candidate manoeuvres", act: () => this.show("candidates") },
      { keys: ["k"], words: "Collision cone", act: () => this.show("cone") },
      { keys: ["p"], words: "Predicted ways", act: () => this.show("predictions") },
      { keys: ["l"], words: "Names", act: () => this.show("labels") },
      { keys: ["z"], words: "Plots: whole run or one minute", act: () => this.zoomPlots() },
      { keys: ["d"], words: "Light or dark", act: () => this.retheme(!this.theme.dark) },
      { keys: ["?"], words: "These keys", act: () => this.help() },
    ];
  }

  private listen(address: string): void {
    const badge = $("live");
    badge.hidden = false;
    badge.textContent = "connecting";
    const socket = new WebSocket(address);
    // Messages wait for the next redraw, so that a picture never shows half of what came.
    let waiting: string[] = [];
    let timer = 0;
    socket.addEventListener("open", () => (badge.textContent = "● live"));
    socket.addEventListener("close", () => {
      clearTimeout(timer);
      catchUp();
      badge.textContent = this.runs.some((run) => run.ended) && !this.live ? "ended" : "disconnected";
      for (const run of this.runs) run.ended = true;
    });
    const catchUp = () => {
      timer = 0;
      let change: Change = "none";
      for (const text of waiting) {
        const what = apply(this.runs, text);
        if (what === "structure" || change === "none") change = what;
      }
      waiting = [];
      if (change === "none") return;
      const first = this.visible.length === 0;
      while (this.visible.length < this.runs.length) this.visible.push(true);
      this.span();
      if (change === "structure") this.rebuild();
      else {
        this.scene?.rebuildTracks(this.runs, this.focus, this.theme);
        this.retime();
        updateMargins($("runs"), this.runs);
      }
      if (first) {
        this.atEnd = true;
        this.scene?.frame(this.runs, this.end);
        if (this.scene) {
          this.scene.rig.distance = 500;
          this.scene.rig.setFollow(true);
        }
      }
      if (this.atEnd) this.t = this.end;
      if (!this.live) badge.textContent = "ended";
      this.redraw();
    };
    socket.addEventListener("message", (event) => {
      waiting.push(String(event.data));
      if (timer === 0) timer = window.setTimeout(catchUp, LIVE_REDRAW_MS);
    });
  }

  private tick(now: number): void {
    const passed = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (this.playing) {
      this.t += passed * this.speed;
      if (this.t >= this.end) {
        this.t = this.end;
        if (this.live) this.atEnd = true;
        else this.play(false);
      }
      this.stale = true;
    }
    if (this.stale) {
      this.stale = false;
      this.draw();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  private draw(): void {
    const run = this.runs[this.focus];
    const pose = run?.pose(this.t);
    this.plots.update(run, this.t);
    const index = run ? run.decisionAt(this.t) : -1;
    const decision = run?.decisions[index];
    const waiting = decision && decision.latest !== null && decision.state === 1;
    this.timeline.update(this.t, waiting ? decision.t + decision.latest! : null);
    this.decision.update(run, index, this.theme, this.visible[this.focus] === true);
    this.guidance.update(run, this.t, this.theme);
    $("time").textContent = `${this.t.toFixed(1)} s`;
    const above = run?.terrain ? ` · ${aboveWords(run, this.t)} above ground` : "";
    $("readout").textContent = pose
      ? `x ${whole(pose.x)} y ${whole(pose.y)} z ${whole(pose.z)} m${above}`
      : "No samples";
    const state = $("state");
    state.hidden = !pose;
    if (pose) {
      // The same words as the panel: those of the decision, which holds until the next one.
      const held = decision?.state ?? pose.state;
      state.textContent = stateWords(held);
      state.style.setProperty("--chip", this.theme.states[held] ?? this.theme.muted);
      const nearest = run?.nearestAt(this.t);
      const inside = nearest && nearest.margin < 0;
      if (nearest) {
        const by = `${Math.abs(nearest.margin).toFixed(1)} m`;
        const name = nearest.obstacle.name;
        state.append(inside ? ` · inside ${name} by ${by}` : ` · ${by} beyond ${name}`);
      }
      state.classList.toggle("bad", inside === true);
    }
    if (!this.scene) return;
    this.scene.render(this.moment());
    const needle = document.querySelector<SVGElement>("#compass svg")!;
    needle.style.transform = `rotate(${this.scene.rig.north}rad)`;
    const { contour, gridCell, ground } = this.scene;
    const lines = contour > 0 ? `, contours every ${contour} m` : "";
    $("scale").textContent = `grid ${gridCell} m at z = ${ground} m${lines}`;
  }

  /** For tests: what a frame costs and where the page stands. */
  stats() {
    const { calls, triangles } = this.scene?.renderer.info.render ?? { calls: 0, triangles: 0 };
    const { t, playing, focus, visible } = this;
    const samples = this.runs.map((run) => run.n);
    const fan = this.scene?.futures ?? 0;
    return { calls, triangles, fan, t, playing, focus, visible: [...visible], samples, live: this.live };
  }
}

/** Without decimals, and without a minus before nothing. */
function whole(value: number): string {
  return String(Math.round(value) || 0);
}

const page = JSON.parse($("data").textContent ?? "") as RawPage;
const app = new App(page);
Object.assign(globalThis, { fgaReplay: { stats: () => app.stats(), seek: (t: number) => app.seek(t) } });
