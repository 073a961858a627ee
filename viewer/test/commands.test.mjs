// The program itself: what its commands write and serve, in the browser.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, describe, test } from "node:test";
import { colours, launch, open, seek, settle, stats } from "./browser.mjs";
import { built } from "./program.mjs";

const HOME = mkdtempSync(join(tmpdir(), "fga-commands-"));
let browser;
let program;

before(async () => {
  program = built("--bin", "fga");
  browser = await launch();
});

after(async () => {
  await browser?.close();
  rmSync(HOME, { recursive: true, force: true });
});

/** Runs the program in the temporary folder; 2 is the code of a run that was lost. */
function fga(...args) {
  const done = spawnSync(program, args, { cwd: HOME, encoding: "utf8" });
  assert.ok([0, 2].includes(done.status), done.stderr);
  return done;
}

/** Writes a scenario, flies it and gives the page's place. */
function fly(name, scenario, ...more) {
  writeFileSync(join(HOME, `${name}.toml`), scenario);
  fga("run", `${name}.toml`, "--out", `runs/${name}`, ...more);
  return join(HOME, "runs", name, "replay.html");
}

const line = (length, rest, seconds = 60) => `
name = "test"
duration_s = ${seconds}
[mission]
waypoints_m = [[0, 0, 100], [${length}, 0, 100]]
${rest}`;

const mast = (name, x, y, more = "") => `
[[obstacle]]
name = ${JSON.stringify(name)}
position_m = [${x}, ${y}, 100]
radius_m = 30
${more}`;

/** Opens a page, runs the checks, and insists on silence: no error, no request. */
async function inPage(place, checks, options = {}) {
  const opened = await open(browser, place, options);
  try {
    await checks(opened.page);
    assert.deepEqual(opened.errors, []);
    assert.deepEqual(opened.requests, []);
  } finally {
    await opened.close();
  }
}

async function drawn(view) {
  const seen = await colours(view, "#scene");
  assert.ok(seen.kinds > 15 && seen.most < 0.98, JSON.stringify(seen));
}

/** `fga view` on a free port, ended after the checks. */
async function viewed(folder, checks) {
  const server = spawn(program, ["view", folder, "--listen", "127.0.0.1:0"], {
    cwd: HOME,
    stdio: ["ignore", "pipe", "inherit"],
  });
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 } });
  try {
    const lines = createInterface({ input: server.stdout })[Symbol.asyncIterator]();
    const page = await context.newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    await page.goto((await lines.next()).value);
    await checks(page);
    assert.deepEqual(errors, []);
  } finally {
    await context.close();
    server.kill();
  }
}

/** A port that nobody listens on. */
async function freePort() {
  const server = createServer();
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const { port } = server.address();
  await new Promise((done) => server.close(done));
  return port;
}

const ready = (page) => page.waitForFunction(() => globalThis.fgaReplay !== undefined);
const names = (page) => page.locator("tbody td.name").allTextContents();

describe("fga run", () => {
  test("policies laid over each other are switched one by one", async () => {
    const place = fly("overlay", line(600, mast("mast", 300, 5)), "--overlay", "published,none");
    await inPage(place, async (view) => {
      const all = await stats(view);
      assert.deepEqual(all.visible, [true, true, true]);
      const shown = await view.locator("#runs .name b").allTextContents();
      assert.deepEqual(shown, ["turn-aware", "published --start tc", "none"]);
      const shot = async () => (await view.locator("#scene").screenshot()).toString("base64");
      const pictures = new Set([await shot()]);
      for (const run of [1, 2]) {
        await view.locator("#runs input").nth(run).uncheck();
        await settle(view);
        pictures.add(await shot());
      }
      assert.equal(pictures.size, 3, "each one can be seen and taken away");
      assert.deepEqual((await stats(view)).visible, [true, false, false]);
      assert.ok((await stats(view)).calls < all.calls);
      await view.keyboard.press("3");
      await view.keyboard.press("r");
      await view.keyboard.press("r");
      await view.keyboard.press("c");
      await settle(view);
      assert.equal((await stats(view)).focus, 2);
      assert.match(await view.locator("#state").textContent(), /inside mast by 25\.0 m/);
    });
  });

  test("a run without obstacles", async () =>
    inPage(fly("empty", line(400, "")), async (view) => {
      await drawn(view);
      assert.match(await view.locator("#runs").textContent(), /no obstacle/);
      assert.match(await view.locator("#decision").textContent(), /\w/);
      await seek(view, 20);
      assert.match(await view.locator("#readout").textContent(), /x 300 y 0 z 100 m/);
    }));

  test("a run with 1,000 obstacles", async () => {
    // A forest beside the way, with a clearing along it.
    const trees = Array.from({ length: 1000 }, (_, i) => {
      const side = i % 2 === 0 ? 1 : -1;
      return mast(`tree ${i}`, 20 * (i % 50), side * (100 + 25 * Math.floor(i / 50)));
    });
    await inPage(fly("forest", line(1000, trees.join(""))), async (view) => {
      await drawn(view);
      const { calls, triangles } = await stats(view);
      assert.ok(calls <= 20, `${calls} draw calls`);
      assert.ok(triangles < 500_000, `${triangles} triangles`);
      assert.match(await view.locator("#runs").textContent(), /tree/);
    });
  });

  test("a lost encounter opens at the loss", async () =>
    inPage(fly("lost", line(600, mast("mast", 300, 5)), "--policy", "none"), async (view) => {
      assert.match(await view.locator("#runs").textContent(), /entered mast by 25\.0/);
      assert.ok(Math.abs((await stats(view)).t - 20) < 0.2);
      assert.match(await view.locator("#state").textContent(), /inside mast by 25\.0 m/);
      await drawn(view);
    }));

  test("a hostile name is text wherever it comes from", async () => {
    const name = "</script><img src=x onerror=alert(1)>";
    const scenario = line(600, mast(name, 300, 5)).replace('"test"', JSON.stringify(name));
    await inPage(fly("hostile", scenario), async (view) => {
      assert.equal(await view.locator("img").count(), 0);
      assert.equal(await view.locator("#title").textContent(), name);
      for (const part of ["#decision", "#events", "#runs"]) {
        const text = await view.locator(part).textContent();
        assert.ok(text.includes("</script><img src=x"), `${part}: ${text}`);
      }
    });
  });

  test("ten minutes among 50 obstacles: below 3 MB, and no dearer to draw than one", async () => {
    const masts = Array.from({ length: 50 }, (_, i) => mast(`mast ${i}`, 200 + 180 * i, 5));
    const long = fly("long", line(9500, masts.join(""), 600));
    const { size } = statSync(long);
    assert.ok(size < 3_000_000, `${size} bytes`);
    const cost = async (place) => {
      let seen;
      await inPage(place, async (view) => {
        await seek(view, 6);
        // Neither candidates nor the cone, which differ from one decision to the next.
        for (const key of ["v", "k"]) await view.keyboard.press(key);
        await settle(view);
        seen = await stats(view);
      });
      return seen;
    };
    const [much, little] = [await cost(long), await cost(fly("brief", line(900, masts.join(""), 60)))];
    assert.ok(much.samples[0] > 9 * little.samples[0], `${much.samples} ${little.samples}`);
    assert.equal(much.calls, little.calls);
    assert.equal(much.triangles, little.triangles);
  });
});

test("fga batch --replay: a click in fga view opens the worst encounter", async () => {
  const columns = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m";
  const rows = [25, 5, 60].map((y, i) => `${i},1,600,${y},0,-10,0,0,30`);
  writeFileSync(join(HOME, "e.csv"), [columns, ...rows, ""].join("\n"));
  fga("batch", "e.csv", "--policy", "none", "--tracks", "--replay", "2", "--out", "batch");
  await viewed("batch", async (page) => {
    assert.deepEqual(await names(page), ["1", "0", "2"]);
    assert.equal(await page.locator("tbody a").count(), 2);
    await page.locator("tbody a").first().click();
    await ready(page);
    assert.equal(await page.locator("#title").textContent(), "encounter 1");
    assert.match(await page.locator("#runs").textContent(), /entered obstacle 1 by 25\.0/);
    await drawn(page);
  });
});

test("a flight of one sample: nothing is ahead, so it is over at once", async () => {
  const columns = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m";
  writeFileSync(join(HOME, "behind.csv"), `${columns}\n0,1,-300,0,0,-20,0,0,30\n`);
  fga("batch", "behind.csv", "--replay", "1", "--out", "behind");
  await inPage(join(HOME, "behind/replay/0.html"), async (view) => {
    await drawn(view);
    assert.deepEqual((await stats(view)).samples, [1]);
    for (const key of ["Space", "c", "m", "End", ".", "a"]) await view.keyboard.press(key);
    await settle(view);
    assert.match(await view.locator("#readout").textContent(), /x 0 y 0 z 0 m/);
  });
});

test("fga view on a campaign: filter, sort and open an encounter", async () => {
  const campaign = `name = "few"
encounters = 60
seeds = [3]
policies = ["turn-aware", "none"]
horizon_s = 30
[[grid]]
family = "threats"
count = [1, 2]
first_seen_m = [300]
speed_mps = [[15, 30]]
`;
  writeFileSync(join(HOME, "few.toml"), campaign);
  fga("campaign", "run", "few.toml", "--oracle", "--out", "few");
  await viewed("few", async (page) => {
    assert.match(await page.locator("#note").textContent(), /60 of 60 encounters flown, each by 2/);
    const margins = async () => {
      const texts = await page.locator("tbody td.bad.number").allTextContents();
      return texts.map((text) => Number(text.replace("−", "-")));
    };
    const worst = await margins();
    assert.ok(worst.length > 5 && worst.every((m, i) => i === 0 || worst[i - 1] <= m));
    if (process.env.SHOTS) await page.screenshot({ path: join(process.env.SHOTS, "campaign.png") });
    assert.ok((await page.locator("#table thead").textContent()).includes("Avoidable"));
    const shares = await page.locator("#shares tbody tr").allTextContents();
    assert.match(shares[0], /^turn-aware60100\.00 % \[93\.98, 100\.00\]/);
    assert.match(shares[1], /^none60\d+\.\d\d % \[/);
    await page.selectOption("#policy", "none");
    await page.selectOption("#outcome", "lost although avoidable");
    const although = await page.locator("#count").textContent();
    assert.match(although, /^(\d+) of 120 runs, \1 lost/);
    await page.getByLabel("Filter Least margin, m").fill("-1000..-0.01");
    assert.equal(await page.locator("#count").textContent(), although);
    await page.getByLabel("Filter Least margin, m").fill("");
    await page.selectOption("#policy", "all");
    await page.selectOption("#outcome", "all");
    await page.fill("#filter", "turn-aware threats:2");
    const kept = await page.locator("#count").textContent();
    assert.match(kept, /^30 of 120 runs/);
    await page.locator("th button", { hasText: "Run" }).click();
    const shown = (await names(page)).map(Number);
    assert.ok(shown.every((n, i) => i === 0 || shown[i - 1] < n));
    await page.locator("tbody a").first().click();
    await ready(page);
    assert.equal(await page.locator("#title").textContent(), `few, encounter ${shown[0]}`);
    const runs = await page.locator("#runs .name b").allTextContents();
    assert.deepEqual(runs, ["turn-aware", "none"]);
    await drawn(page);
  });
});

test("fga run --live is followed to its end", async () => {
  writeFileSync(join(HOME, "live.toml"), line(600, mast("mast", 300, 5)));
  const args = ["run", "live.toml", "--live", "--speed", "10", "--out", "live"];
  const flight = spawn(program, args, { cwd: HOME, stdio: ["ignore", "ignore", "pipe"] });
  const ended = new Promise((done) => flight.on("exit", done));
  const lines = createInterface({ input: flight.stderr })[Symbol.asyncIterator]();
  const address = (await lines.next()).value.replace("live at ", "");
  const { page, errors, close } = await open(browser, address);
  await page.waitForFunction(() => document.getElementById("live").textContent === "ended");
  assert.match(await page.locator("#runs").textContent(), /least margin.*mast/);
  assert.deepEqual(errors, []);
  await close();
  assert.equal(await ended, 0);
  const track = readFileSync(join(HOME, "live/track.csv"), "utf8").trim().split("\n");
  assert.ok(track.length > 300);
});

test("fga fly --live shows the flight, the ground, the threat and the avoidance", async () => {
  // The ArduPlane-like emulator flies north; a mast stands on its way.
  const config = `[[obstacle]]
name = "mast <b>"
latitude_deg = 37.6243
longitude_deg = -122.375
altitude_m = 104
radius_m = 60
[terrain]
file = "N37W123.hgt"
clearance_m = 20
`;
  writeFileSync(join(HOME, "fly.toml"), config);
  // A valley along the flight, at 0 m, with walls of 200 m.
  const posts = 1201;
  const heights = Buffer.alloc(2 * posts * posts);
  for (let i = 0; i < posts * posts; i++) {
    const east = 90 * (-123 + (i % posts) / (posts - 1) + 122.375);
    heights.writeInt16BE(Math.round(200 * Math.min(1, Math.max(0, Math.abs(east) - 1))), 2 * i);
  }
  writeFileSync(join(HOME, "N37W123.hgt"), heights);
  const port = await freePort();
  const served = ["--alone", "--serve", `tcpin:127.0.0.1:${port}`, "--seconds", "120"];
  const emulator = spawn(program, ["emulate", ...served], { stdio: "ignore" });
  const connect = ["--connect", `tcp:127.0.0.1:${port}`, "--config", "fly.toml", "--out", "fly"];
  const companion = spawn(program, ["fly", ...connect, "--live", "--quiet"], {
    cwd: HOME,
    stdio: ["ignore", "ignore", "pipe"],
  });
  const ended = new Promise((done) => companion.on("exit", done));
  try {
    const lines = createInterface({ input: companion.stderr })[Symbol.asyncIterator]();
    const address = (await lines.next()).value.replace("live at ", "");
    const { page, errors, close } = await open(browser, address);
    const says = (words) =>
      page.waitForFunction(
        (text) => document.getElementById("events").textContent.includes(text),
        words,
        { timeout: 90_000 },
      );
    await says("in command");
    await says("a certified manoeuvre begins (mast <b>)");
    assert.match(await page.locator("#decision").textContent(), /mast <b>/);
    await page.waitForFunction(() => globalThis.fgaReplay.stats().samples[0] > 80);
    assert.ok((await stats(page)).live);
    assert.match(await page.locator("#scale").textContent(), /contours every \d+ m/);
    assert.ok((await stats(page)).triangles > 10_000, "the relief");
    if (process.env.SHOTS) await page.screenshot({ path: join(process.env.SHOTS, "fly.png") });
    await drawn(page);
    companion.kill("SIGINT");
    await page.waitForFunction(() => document.getElementById("live").textContent === "ended");
    assert.deepEqual(errors, []);
    await close();
    assert.equal(await ended, 0);
  } finally {
    companion.kill();
    emulator.kill();
  }
});
