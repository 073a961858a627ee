// A run that goes on: messages from the WebSocket, as `crates/fga-report/src/replay/live.rs`
// writes them, put onto the runs.

import { bytes, floats } from "./base64";
import {
  decodeDecision,
  Obstacle,
  type Outcome,
  type RawDecision,
  type RawObstacle,
  type RawRun,
  Run,
  type RunEvent,
  type Vec3,
} from "./data";
import { type RawTerrain, Terrain } from "./terrain";

type Message =
  | { type: "reset" }
  | { type: "run"; data: RawRun }
  | { type: "sample"; run: number; row: number[] }
  | { type: "mission"; run: number; points: Vec3[] }
  | { type: "ground"; run: number; data: RawTerrain }
  | { type: "obstacle"; run: number; data: RawObstacle; motion: string }
  | { type: "decision"; run: number; data: RawDecision; points: string }
  | { type: "time"; run: number; row: [number, number] }
  | { type: "event"; run: number; data: RunEvent }
  | { type: "end"; run: number; outcome: Outcome | null };

/** What a message changed: nothing, the run's growing end, or its standing data. */
export type Change = "none" | "growth" | "structure";

export function apply(runs: Run[], text: string): Change {
  const message = JSON.parse(text) as Message;
  if (message.type === "run") {
    const run = new Run(message.data);
    run.ended = false;
    runs.push(run);
    return "structure";
  }
  if (message.type === "reset") {
    runs.length = 0;
    return "structure";
  }
  const run = runs[message.run];
  if (!run) return "none";
  switch (message.type) {
    case "sample":
      // A sample that comes late would turn time back.
      if (run.n > 0 && !(message.row[0]! > run.end)) return "none";
      run.push(message.row);
      return "growth";
    case "mission":
      run.mission = message.points;
      return "structure";
    case "ground":
      run.terrain = new Terrain(message.data);
      return "structure";
    case "obstacle": {
      const obstacle = new Obstacle(message.data, floats(message.motion), 0);
      const place = run.obstacles.findIndex((o) => o.id === obstacle.id);
      if (place < 0) run.obstacles.push(obstacle);
      else run.obstacles[place] = obstacle;
      return "structure";
    }
    case "decision": {
      const points = new Int16Array(bytes(message.points).buffer);
      const believed = run.believes;
      run.addDecision(decodeDecision(message.data, points, 0).decision);
      // The legend names what is new.
      return run.believes === believed ? "growth" : "structure";
    }
    case "time":
      run.timeT.push(message.row[0]);
      run.timeUs.push(message.row[1]);
      return "growth";
    case "event":
      run.events.push(message.data);
      return "structure";
    case "end":
      run.outcome = message.outcome ?? run.outcome;
      run.ended = true;
      return "structure";
    default:
      return "none";
  }
}

/** Where to listen: `?ws=/path` or what the page was made with; always the page's own host. */
export function liveAddress(made: string | undefined): string | null {
  const path = new URLSearchParams(location.search).get("ws") ?? made;
  if (!path?.startsWith("/") || path.startsWith("//")) return null;
  if (location.protocol !== "http:" && location.protocol !== "https:") return null;
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`;
}
