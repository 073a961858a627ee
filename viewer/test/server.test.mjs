// The live view and the table of runs, served by the crate fga-view.

import assert from "node:assert/strict";
import { spawn, execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";
import { colours, launch, open, seek, settle, stats } from "./browser.mjs";
import { built } from "./program.mjs";

const RUNS = mkdtempSync(join(tmpdir(), "fga-view-"));
let browser;
let server;
let live;
let table;

function run(name, margin) {
  const folder = join(RUNS, name);
  mkdirSync(folder, { recursive: true });
  const document = { name, policy: "turn-aware", separated: margin >= 0, min_margin_m: margin };
  writeFileSync(join(folder, "run.json"), JSON.stringify(document));
  return folder;
}

before(async () => {
  const fixtures = join(RUNS, "fixtures");
  execFileSync(built("--example", "replay_fixture"), [fixtures], { stdio: "inherit" });
  copyFileSync(join(fixtures, "lost.html"), join(run("lost", -25), "replay.html"));
  copyFileSync(join(fixtures, "encounter.html"), join(run("good", 53.9), "replay.html"));
  run("<img src=x>", 1.5);
  run("run 10", 10);
  run("run 9", 9);
  const live_fixture = built("--example", "live_fixture");
  server = spawn(live_fixture, [RUNS], { stdio: ["pipe", "pipe", "inherit"] });
  const lines = createInterface({ input: server.stdout })[Symbol.asyncIterator]();
  live = (await lines.next()).value;
  table = (await lines.next()).value;
  browser = await launch();
});

after(async () => {
  await browser?.close();
  server?.stdin.end();
  rmSync(RUNS, { recursive: true, force: true });
});

test("a live run is followed to its end", async () => {
  const { page, errors, close } = await open(browser, `${live}/`);
  assert.equal(await page.locator("#title").textContent(), "Live <flight>");
  await page.waitForFunction(() => globalThis.fgaReplay.stats().samples[0] > 20);
  const midway = await stats(page);
  assert.ok(midway.live && midway.t > 0, "it keeps up while the run goes on");
  await page.waitForFunction(() => document.getElementById("live").textContent === "ended");
  const ended = await stats(page);
  assert.deepEqual(ended.samples, [301]);
  assert.ok(Math.abs(ended.t - 30) < 1e-3);
  assert.match(await page.locator("#runs").textContent(), /least margin 7\.3.*N3/);
  await seek(page, 10);
  assert.match(await page.locator("#decision").textContent(), /Decided live at 8\.0 s/);
  assert.match(await page.locator("#events").textContent(), /avoiding/);
  assert.equal((await stats(page)).fan, 1);
  assert.match(await page.locator("#plots").textContent(), /mission 40 %, flown 2 %/);
  assert.match(await page.locator("#legend").textContent(), /P\(loss\) as flown/);
  assert.ok((await colours(page, "#scene")).kinds > 30);
  assert.deepEqual(errors, []);
  await close();
});

test("a browser that comes after the end sees the whole run", async () => {
  const { page, errors, close } = await open(browser, `${live}/?ws=/live`, { size: "phone" });
  await page.waitForFunction(() => globalThis.fgaReplay.stats().samples[0] === 301);
  await settle(page);
  assert.deepEqual(errors, []);
  await close();
});

test("the table sorts, filters and opens a replay", async () => {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 } });
  const page = await context.newPage();
  const errors = [];
  page.on("console", (m) => m.type() === "error" && errors.push(m.text()));
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(table);
  const names = () => page.locator("tbody td.name").allTextContents();
  assert.equal((await names())[0], "lost");
  assert.equal((await names()).length, 5);
  assert.equal(await page.locator("img").count(), 0);
  assert.match(await page.locator("#count").textContent(), /5 of 5 runs, 1 lost/);
  await page.locator("th button", { hasText: "Least margin" }).click();
  await page.locator("th button", { hasText: "Least margin" }).click();
  assert.equal((await names())[0], "good");
  await page.locator("th button", { hasText: "Run" }).click();
  await page.fill("#filter", "run");
  assert.deepEqual(await names(), ["run 9", "run 10"]);
  await page.fill("#filter", "");
  await page.selectOption("#outcome", "lost");
  assert.deepEqual(await names(), ["lost"]);
  await page.selectOption("#outcome", "lost although avoidable");
  assert.deepEqual(await names(), []);
  await page.selectOption("#outcome", "all");
  const margin = page.getByLabel("Filter Least margin, m");
  await margin.fill("< 0");
  assert.deepEqual(await names(), ["lost"]);
  await margin.fill("soon");
  assert.equal(await margin.getAttribute("aria-invalid"), "");
  assert.equal((await names()).length, 5);
  await margin.fill("");
  await page.selectOption("#outcome", "lost");
  if (process.env.SHOTS) await page.screenshot({ path: join(process.env.SHOTS, "list.png") });
  await page.locator("tbody a").click();
  await page.waitForFunction(() => globalThis.fgaReplay !== undefined);
  assert.match(await page.locator("#runs").textContent(), /entered N0/);
  await page.keyboard.press("?");
  await page.click("#help-close");
  assert.ok(!(await page.locator("#help").isVisible()));
  assert.deepEqual(errors.filter((text) => !/GPU stall|favicon/.test(text)), []);
  await context.close();
});
