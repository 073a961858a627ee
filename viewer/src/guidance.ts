// Alerts and bands, as a detect-and-avoid display shows them: a compass with the directions that
// meet a conflict, tapes of speed, climb and altitude, and the times. Drawn as SVG from the record
// that holds at the moment; everything that comes from a file is put in as text.

import type { Guidance, Run } from "./data";
import { element } from "./panel";
import type { Theme } from "./theme";

/** By the code of a region: none, far, mid, near, recovery, outside of what can be flown. */
const REGION_WORDS = ["free", "far", "mid", "near", "recovery", "not flown"] as const;
const FEET = 1 / 0.3048;
const KNOTS = 3600 / 1852;
const TURN = 2 * Math.PI;

/** What a tape shows: name, unit, how many units a metre (a second) has, and how far it reaches. */
const TAPES = [
  { name: "Speed", unit: "kn", factor: KNOTS, half: 100, step: 50 },
  { name: "Climb", unit: "ft/min", factor: 60 * FEET, half: 3000, step: 1000 },
  { name: "Altitude", unit: "ft", factor: FEET, half: 1500, step: 500 },
] as const;

function svg(tag: string, attributes: Record<string, string | number>, text?: string): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}

/** A region's line: colour and width differ, and far is dashed. */
function stroke(code: number, theme: Theme): Record<string, string | number> | null {
  const color = theme.regions[code];
  if (code === 0 || color === undefined) return null;
  const width = code === 3 ? 9 : code === 5 ? 2 : 6;
  return { stroke: color, "stroke-width": width, ...(code === 1 ? { "stroke-dasharray": "4 3" } : {}) };
}

function compass(guidance: Guidance, theme: Theme): SVGElement {
  const root = svg("svg", { viewBox: "-70 -70 140 140", width: 140, height: 140, role: "img" });
  root.setAttribute("aria-label", "Compass with bands");
  root.append(svg("circle", { r: 50, fill: "none", stroke: theme.muted, "stroke-width": 1 }));
  const at = (angle: number, r: number) => [r * Math.sin(angle), -r * Math.cos(angle)] as const;
  for (const [low, high, code] of guidance.bands[0] ?? []) {
    const style = stroke(code, theme);
    if (!style) continue;
    if (high - low >= TURN - 1e-6) {
      root.append(svg("circle", { r: 54, fill: "none", ...style }));
      continue;
    }
    const [x0, y0] = at(low, 54);
    const [x1, y1] = at(high, 54);
    const large = high - low > Math.PI ? 1 : 0;
    root.append(svg("path", { d: `M${x0} ${y0}A54 54 0 ${large} 1 ${x1} ${y1}`, fill: "none", ...style }));
  }
  for (let k = 0; k < 36; k++) {
    const [x0, y0] = at((k * TURN) / 36, 50);
    const [x1, y1] = at((k * TURN) / 36, k % 9 === 0 ? 42 : k % 3 === 0 ? 45 : 47);
    root.append(svg("path", { d: `M${x0} ${y0}L${x1} ${y1}`, stroke: theme.muted }));
  }
  ["N", "E", "S", "W"].forEach((name, k) => {
    const [x, y] = at((k * TURN) / 4, 33);
    root.append(svg("text", { x, y: y + 4, class: "tick", "text-anchor": "middle" }, name));
  });
  const heading = ((guidance.values[0] ?? 0) * 360) / TURN;
  const needle = { d: "M0-48L5-34H-5ZM0-34V14M-11-8H11M-5 14H5", transform: `rotate(${heading})` };
  root.append(svg("path", { ...needle, fill: theme.foreground, stroke: theme.foreground, "stroke-width": 2 }));
  const degrees = String(Math.round(heading) % 360).padStart(3, "0");
  root.append(svg("text", { x: -68, y: -56, class: "value" }, `${degrees}°`));
  return root;
}

function tape(guidance: Guidance, index: number, theme: Theme): SVGElement {
  const { name, unit, factor, half, step } = TAPES[index]!;
  const value = (guidance.values[index + 1] ?? 0) * factor;
  const root = svg("svg", { viewBox: "0 0 84 150", width: 84, height: 150, role: "img" });
  root.setAttribute("aria-label", `${name} with bands`);
  const y = (v: number) => 76 - ((v - value) / half) * 60;
  const within = (v: number) => Math.min(value + half, Math.max(value - half, v));
  root.append(svg("text", { x: 42, y: 10, class: "tick", "text-anchor": "middle" }, `${name}, ${unit}`));
  root.append(svg("path", { d: "M30 16V136", stroke: theme.muted }));
  for (const [low, high, code] of guidance.bands[index + 1] ?? []) {
    const style = stroke(code, theme);
    const [a, b] = [within(low * factor), within(high * factor)];
    if (style && b > a) root.append(svg("path", { d: `M24 ${y(b)}V${y(a)}`, ...style }));
  }
  for (let v = Math.ceil((value - half) / step) * step; v <= value + half; v += step) {
    root.append(svg("path", { d: `M30 ${y(v)}h5`, stroke: theme.muted }));
    if (Math.abs(y(v) - 76) > 9) root.append(svg("text", { x: 38, y: y(v) + 4, class: "tick" }, String(v)));
  }
  root.append(svg("path", { d: "M30 76l7-5v10Z", fill: theme.foreground }));
  root.append(svg("text", { x: 39, y: 80, class: "value" }, String(Math.round(value))));
  return root;
}

const NAMES = ["direction", "speed", "climb", "altitude"] as const;

function seconds(value: number): string {
  return `${value.toFixed(0)}\u00a0s`;
}

/** The highest level and the times, in words. */
function words(run: Run, guidance: Guidance): Node[] {
  const level = guidance.level === 0 ? "No alert" : `Alert level ${guidance.level} of ${run.levels}`;
  const nodes: Node[] = [element("p", "headline", level)];
  for (const [id, own, entry] of guidance.who) {
    if (own === 0 && entry === null) continue;
    const name = run.obstacle(id)?.name ?? `#${id}`;
    const when =
      entry === null ? "no violation ahead" : entry > 0 ? `violation in ${seconds(entry)}` : "violated now";
    nodes.push(element("p", "", `${name}: level ${own}, ${when}`));
  }
  guidance.recovery.forEach((time, k) => {
    if (time === null) return;
    const text = time < 0 ? "nothing regains well clear" : `well clear again after ${seconds(time)}`;
    nodes.push(element("p", "quiet", `Recovery in ${NAMES[k]}: ${text}.`));
  });
  return nodes;
}

export class GuidancePanel {
  private key = "";

  constructor(
    private readonly box: HTMLElement,
    private readonly root: HTMLElement,
  ) {}

  update(run: Run | undefined, t: number, theme: Theme): void {
    const index = run ? run.guidanceAt(t) : -1;
    const key = `${run?.name} ${index} ${theme.dark} ${run?.guidance.length}`;
    if (key === this.key) return;
    this.key = key;
    this.box.hidden = !run || run.guidance.length === 0;
    const guidance = run?.guidance[index];
    if (!run || !guidance) {
      this.root.replaceChildren(element("p", "quiet", "No other aircraft is known yet."));
      return;
    }
    const tapes = element("div", "tapes");
    TAPES.forEach((_, k) => tapes.append(tape(guidance, k, theme)));
    const seen = new Set(guidance.bands.flat().map(([, , code]) => code));
    const legend = element("p", "regions");
    REGION_WORDS.forEach((name, code) => {
      if (code === 0 || !seen.has(code)) return;
      const swatch = element("i", "swatch");
      swatch.style.background = theme.regions[code] ?? theme.muted;
      legend.append(element("span", "", swatch, ` ${name}`));
    });
    const drawn = element("div", "display");
    drawn.append(compass(guidance, theme));
    this.root.replaceChildren(...words(run, guidance), drawn, tapes, legend);
  }
}
