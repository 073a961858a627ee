// Colours: the Okabe–Ito set, which people with any colour vision can tell apart, on a light and
// a dark ground. Where two things could still be confused they differ in line style as well.

export interface Theme {
  dark: boolean;
  background: string;
  grid: string;
  foreground: string;
  muted: string;
  /** By state: cruise, threatened, avoiding, recovering, manual. */
  states: string[];
  /** By kind of path: certified, rejected, chosen, way back. */
  paths: string[];
  obstacle: string;
  unknown: string;
  threat: string;
  mission: string;
  /** The ground in relief, from its lowest to its highest. */
  relief: [string, string];
  /** A single aircraft; several take the colours of their runs. */
  aircraft: string;
  /** To tell runs apart. */
  runs: string[];
  /** By region of a band: none, far, mid, near, recovery, not flown. */
  regions: string[];
}

const LIGHT: Theme = {
  dark: false,
  background: "#eef2f6",
  grid: "#5b6b7b",
  foreground: "#10181f",
  muted: "#4c5a67",
  states: ["#0072b2", "#b87a00", "#d55e00", "#009e73", "#a3527f"],
  paths: ["#2a8fcb", "#8a8f96", "#000000", "#009e73"],
  obstacle: "#5f7182",
  unknown: "#a9b4bf",
  threat: "#d55e00",
  mission: "#5a6672",
  relief: ["#c3d3bb", "#efe6d6"],
  aircraft: "#33424f",
  runs: ["#a3527f", "#2a8fcb", "#222222", "#b87a00", "#009e73", "#d55e00", "#0072b2"],
  regions: ["#cfd8e1", "#d9b400", "#e69f00", "#d55e00", "#009e73", "#a9b4bf"],
};

const DARK: Theme = {
  dark: true,
  background: "#10161d",
  grid: "#7d90a3",
  foreground: "#eef3f8",
  muted: "#a7b4c1",
  states: ["#56b4e9", "#e6c229", "#ff8a3d", "#1fc796", "#dd8fb9"],
  paths: ["#56b4e9", "#7f8994", "#ffffff", "#1fc796"],
  obstacle: "#9fb0c0",
  unknown: "#56616c",
  threat: "#ff8a3d",
  mission: "#93a1ae",
  relief: ["#25352f", "#575145"],
  aircraft: "#ffffff",
  runs: ["#dd8fb9", "#56b4e9", "#ffffff", "#e6c229", "#1fc796", "#ff8a3d", "#f0e442"],
  regions: ["#2d3a47", "#f0e442", "#e69f00", "#ff6a2b", "#1fc796", "#56616c"],
};

export function themeOf(dark: boolean): Theme {
  return dark ? DARK : LIGHT;
}
