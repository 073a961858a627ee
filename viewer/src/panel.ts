// Beside the scene: the decision record in words, the runs, what the colours mean. Everything that
// comes from a file is put in as text.

import type { Decision, Run } from "./data";
import { PATH_KINDS, STATES } from "./data";
import type { Shown } from "./scene";
import type { Theme } from "./theme";

type Child = Node | string;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className: string,
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.append(...children);
  return made;
}

const STATE_WORDS: Record<(typeof STATES)[number], string> = {
  cruise: "On the mission",
  threatened: "Threat seen, waiting",
  avoiding: "Avoiding",
  recovering: "On the way back",
  manual: "Pilot flies",
};

export function stateWords(state: number): string {
  const name = STATES[state];
  return name ? STATE_WORDS[name] : `State ${state}`;
}

function metres(value: number): string {
  return `${value < 0 ? "−" : ""}${Math.abs(value).toFixed(1)} m`;
}

function marginWords(run: Run): string {
  const least = run.least();
  if (!least) return run.n === 0 ? "no samples" : "no obstacle";
  const who = run.obstacle(least.id)?.name ?? `#${least.id}`;
  const by = `${Math.abs(least.margin).toFixed(1)}\u00a0m`;
  const when = `${least.t.toFixed(1)}\u00a0s`;
  return least.margin < 0
    ? `entered ${who} by ${by}, ${when}`
    : `least margin ${by} (${who}, ${when})`;
}

export class DecisionPanel {
  private key = "";

  constructor(private readonly root: HTMLElement) {}

  update(run: Run | undefined, index: number, theme: Theme, visible: boolean): void {
    const key = `${run?.name} ${index} ${run?.decisions.length ? 1 : 0} ${theme.dark} ${visible}`;
    if (key === this.key) return;
    this.key = key;
    const decision = run?.decisions[index];
    if (!run || run.n === 0) {
      this.root.replaceChildren(element("p", "quiet", "Nothing was recorded."));
      return;
    }
    if (!visible) {
      this.root.replaceChildren(element("p", "quiet", "This run is switched off."));
      return;
    }
    if (!decision) {
      const text = run.decisions.length === 0 ? "No decision records." : "No decision yet.";
      this.root.replaceChildren(element("p", "quiet", text));
      return;
    }
    this.root.replaceChildren(...this.record(run, decision, theme));
  }

  private record(run: Run, decision: Decision, theme: Theme): Node[] {
    const chip = element("span", "chip", stateWords(decision.state));
    chip.style.setProperty("--chip", theme.states[decision.state] ?? theme.muted);
    const when = element("span", "when", `decided at ${decision.t.toFixed(1)} s`);
    const nodes: Node[] = [element("p", "state", chip, " ", when)];
    decision.lines.forEach((line, i) => nodes.push(element("p", i === 0 ? "headline" : "", line)));
    const facts = element("dl", "facts");
    PATH_KINDS.forEach((name, kind) => {
      const paths = decision.paths.filter((path) => path.kind === kind);
      if (paths.length === 0 || kind === 3) return;
      const margins = paths.flatMap((path) => (path.margin === null ? [] : [path.margin]));
      const margin =
        margins.length === 0
          ? ""
          : kind === 2 || margins.length === 1
            ? metres(margins[0]!)
            : `${metres(Math.min(...margins))} to ${metres(Math.max(...margins))}`;
      const swatch = element("i", `line kind${kind}`);
      swatch.style.color = theme.paths[kind]!;
      const label = element("dt", "", swatch, ` ${name[0]!.toUpperCase()}${name.slice(1)}`);
      facts.append(label, element("dd", "", kind === 2 ? margin : `${paths.length}: ${margin}`));
    });
    if (facts.childElementCount > 0) nodes.push(facts);
    if (run.interval > 0) {
      const every = `Records are kept every ${run.interval} s and at each change.`;
      nodes.push(element("p", "quiet", every));
    }
    return nodes;
  }
}

export interface RunActions {
  toggle(run: number): void;
  focus(run: number): void;
}

export function fillRuns(
  root: HTMLElement,
  runs: Run[],
  visible: boolean[],
  focus: number,
  theme: Theme,
  actions: RunActions,
): void {
  if (runs.length === 0) root.replaceChildren(element("li", "quiet", "No run."));
  else root.replaceChildren(
    ...runs.map((run, i) => {
      const box = element("input", "");
      box.type = "checkbox";
      box.checked = visible[i] === true;
      box.setAttribute("aria-label", `Show ${run.name}`);
      box.addEventListener("change", () => actions.toggle(i));
      const swatch = element("i", "swatch");
      swatch.style.background = theme.runs[i % theme.runs.length]!;
      const least = run.least();
      const words = element("small", least && least.margin < 0 ? "bad" : "", marginWords(run));
      const name = element("button", "name", element("b", "", run.name || "run"), words);
      name.type = "button";
      name.setAttribute("aria-pressed", String(i === focus));
      name.addEventListener("click", () => actions.focus(i));
      const row = element("li", i === focus ? "focus" : "", box, swatch, name);
      if (i < 9) row.append(element("kbd", "", String(i + 1)));
      return row;
    }),
  );
}

/** Says the least margins of the runs anew, as a live run goes on. */
export function updateMargins(root: HTMLElement, runs: Run[]): void {
  root.querySelectorAll("small").forEach((words, i) => {
    const run = runs[i];
    if (!run) return;
    words.textContent = marginWords(run);
    words.classList.toggle("bad", (run.least()?.margin ?? 0) < 0);
  });
}

export function fillEvents(root: HTMLElement, run: Run | undefined, seek: (t: number) => void) {
  const events = (run?.events ?? []).slice(0, 300);
  root.replaceChildren(
    ...events.map((event) => {
      const button = element("button", "", element("b", "", `${event.t.toFixed(1)} s`), event.text);
      button.type = "button";
      button.addEventListener("click", () => seek(event.t));
      return element("li", "", button);
    }),
  );
  root.parentElement!.hidden = events.length === 0;
}

/** `flown` is the colour of the run in focus, where a run weighs chances. */
export function fillLegend(root: HTMLElement, theme: Theme, manual: boolean, flown?: string): void {
  const entry = (className: string, color: string, text: string) => {
    const swatch = element("i", className);
    swatch.style.color = color;
    return element("li", "", swatch, text);
  };
  root.replaceChildren(
    ...STATES.flatMap((name, i) =>
      name === "manual" && !manual ? [] : [entry("line thick", theme.states[i]!, STATE_WORDS[name])],
    ),
    entry("line kind1", theme.mission, "Mission"),
    entry("ball", theme.obstacle, "Protected volume"),
    entry("ball", theme.threat, "Volume of the threat"),
    entry("ball", theme.unknown, "Not yet known"),
    entry("line kind1", theme.obstacle, "Predicted way, 20 s"),
    ...(flown === undefined
      ? []
      : [
          entry("fan", theme.obstacle, "Futures: the likelier, the stronger"),
          entry("line kind1", theme.states[2]!, "P(loss) on the mission"),
          entry("line", flown, "P(loss) as flown"),
          element("li", "quiet", "P(loss): the chance to enter a protected volume within a minute"),
        ]),
    entry("wedge", theme.threat, "Collision cone"),
    entry("arrow", theme.foreground, "Relative velocity"),
    entry("line kind0", theme.paths[0]!, "Candidate, certified"),
    entry("line kind1", theme.paths[1]!, "Candidate, rejected"),
    entry("line kind2", theme.paths[2]!, "Candidate, chosen"),
    entry("line kind3", theme.paths[3]!, "Way back"),
    entry("mark down", theme.foreground, "Least margin"),
    entry("mark diamond", theme.foreground, "Latest safe start"),
  );
}

export const SHOWN_WORDS: [keyof Shown, string][] = [
  ["candidates", "Candidates"],
  ["cone", "Collision cone"],
  ["predictions", "Predicted ways"],
  ["labels", "Names"],
];
