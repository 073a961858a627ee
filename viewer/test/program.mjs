// The programs that the tests run, built as the tests of the workspace build them, so that nothing
// is compiled twice.

import { execFileSync } from "node:child_process";
import { fileURLToPath } from "node:url";

const ROOT = fileURLToPath(new URL("../..", import.meta.url));

/** Builds a program and gives its place: `built("--bin", "fga")`, `built("--example", …)`. */
export function built(kind, name) {
  const build = ["build", "--quiet", "--workspace", kind, name, "--profile", "test"];
  const told = execFileSync("cargo", [...build, "--message-format=json"], {
    cwd: ROOT,
    stdio: ["ignore", "pipe", "inherit"],
    maxBuffer: 1 << 28,
  });
  const artifacts = told.toString().trim().split("\n").map((line) => JSON.parse(line));
  return artifacts.findLast((a) => a.target?.name === name && a.executable).executable;
}
