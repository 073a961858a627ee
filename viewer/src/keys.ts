// The keys: one table that both acts and is shown under `?`.

import { element } from "./panel";

export interface Key {
  /** As `KeyboardEvent.key`, lower case; several for the same action. */
  keys: string[];
  words: string;
  act(event: KeyboardEvent): void;
}

export function listen(keys: Key[]): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target as HTMLElement;
    if (target instanceof HTMLSelectElement) return;
    const pressed = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    // A focused button keeps its own space and enter.
    if (target instanceof HTMLButtonElement && pressed === "Enter") return;
    const key = keys.find((k) => k.keys.includes(pressed));
    if (!key) return;
    event.preventDefault();
    key.act(event);
  });
}

const NAMES: Record<string, string> = {
  " ": "Space",
  ArrowLeft: "←",
  ArrowRight: "→",
  ArrowUp: "↑",
  ArrowDown: "↓",
  Escape: "Esc",
};

export function fillHelp(root: HTMLElement, keys: Key[]): void {
  root.replaceChildren(
    ...keys.flatMap((key) => {
      const names = key.keys.map((k) =>
        element("kbd", "", NAMES[k] ?? (k.length === 1 ? k.toUpperCase() : k)),
      );
      return [element("dt", "", ...names), element("dd", "", key.words)];
    }),
  );
}
