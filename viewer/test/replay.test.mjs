// The replay page in a real browser, from the disk. The pages come from the example
// `replay_fixture` of the crate fga-report.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { colours, launch, open, seek, settle, stats } from "./browser.mjs";
import { built } from "./program.mjs";

const PAGES = mkdtempSync(join(tmpdir(), "fga-replay-"));
const page = (name) => join(PAGES, `${name}.html`);
let browser;

before(async () => {
  execFileSync(built("--example", "replay_fixture"), [PAGES], { stdio: "inherit" });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  rmSync(PAGES, { recursive: true, force: true });
});

/** Opens a fixture, runs the checks, and insists on silence: no error, no request. */
async function inPage(name, options, checks) {
  const opened = await open(browser, page(name), options);
  try {
    await checks(opened.page);
    assert.deepEqual(opened.errors, []);
    assert.deepEqual(opened.requests, []);
  } finally {
    await opened.close();
  }
}

async function drawn(view, least = 30) {
  const seen = await colours(view, "#scene");
  assert.ok(seen.kinds > least, `${seen.kinds} colours`);
  assert.ok(seen.most < 0.98, `${seen.most} of the scene is one colour`);
}

test("the ground is drawn in relief, but where it is unknown", async () => {
  for (const theme of ["light", "dark"]) {
    await inPage("hills", { theme }, async (view) => {
      await seek(view, 0);
      await drawn(view);
      // The script flies at 120 m; the ground below its start is 20 - 30 + 8 sin(24 / 9) m high there.
      assert.match(await view.locator("#readout").textContent(), /· 106 m above ground/);
      assert.equal(await view.locator(".plot canvas").count(), 6);
      assert.match(await view.locator("#scale").textContent(), /contours every \d+ m/);
      const { triangles } = await stats(view);
      await inPage("level", { theme }, async (level) => {
        await seek(level, 0);
        assert.doesNotMatch(await level.locator("#readout").textContent(), /ground/);
        // Two triangles for each of 119 x 119 cells without those of the hole, 29 x 29.
        const ground = 2 * (119 * 119 - 29 * 29);
        assert.equal(triangles - (await stats(level)).triangles, ground);
      });
    });
  }
});

describe("an encounter under three policies", () => {
  for (const size of ["desktop", "phone"]) {
    for (const theme of ["light", "dark"]) {
      test(`is drawn on ${size}, ${theme}`, () =>
        inPage("encounter", { size, theme }, async (view) => {
          await drawn(view);
          const plots = await view.locator(".plot canvas").count();
          assert.equal(plots, 5);
          assert.doesNotMatch(await view.locator("#legend").textContent(), /Futures/);
          const wide = await view.evaluate(() => document.documentElement.scrollWidth);
          assert.ok(wide <= (size === "phone" ? 390 : 1280), `scrolls sideways: ${wide} px`);
        }));
    }
  }

  test("opens at the manoeuvre and plays", () =>
    inPage("encounter", {}, async (view) => {
      const first = await stats(view);
      assert.ok(Math.abs(first.t - 14) < 0.11, `opens at ${first.t}`);
      await view.keyboard.press("Space");
      await view.waitForFunction((t) => globalThis.fgaReplay.stats().t > t + 0.3, first.t);
      await view.click("#play");
      const stopped = await stats(view);
      assert.equal(stopped.playing, false);
      await view.selectOption("#speed", "20");
      await view.keyboard.press("Home");
      await view.keyboard.press("Space");
      await view.waitForFunction(() => globalThis.fgaReplay.stats().t >= 59.9);
      await view.waitForFunction(() => !globalThis.fgaReplay.stats().playing);
    }));

  test("scrubs with the slider, with a plot and to the closest moment", () =>
    inPage("encounter", {}, async (view) => {
      await view.locator("#timeline input").fill("30");
      await settle(view);
      assert.equal((await stats(view)).t, 30);
      const plot = view.locator(".plot .u-over").first();
      const box = await plot.boundingBox();
      await plot.click({ position: { x: box.width / 4, y: box.height / 2 } });
      assert.ok(Math.abs((await stats(view)).t - 15) < 0.5);
      await view.keyboard.press("3");
      await view.keyboard.press("3");
      await view.locator("#runs .name").nth(2).click();
      await view.keyboard.press("c");
      await settle(view);
      // The script lets the unavoiding run meet N0 in its 22nd second.
      assert.ok(Math.abs((await stats(view)).t - 22) < 0.2);
      const text = await view.locator("#runs li").nth(2).textContent();
      assert.match(text, /entered N0 by 25\.0/);
    }));

  test("says the decision in words, record by record", () =>
    inPage("encounter", {}, async (view) => {
      await seek(view, 12.05);
      const words = await view.locator("#decision").textContent();
      assert.match(words, /Threat seen, waiting/);
      assert.match(words, /Threat: N0 in 10\.0 s, 12 m inside\./);
      assert.match(words, /Turn left 52°/);
      assert.match(words, /Chosen4\.2 m/);
      await view.keyboard.press(".");
      await settle(view);
      assert.match(await view.locator("#decision").textContent(), /N0 in 9\.9 s/);
      await view.keyboard.press(",");
      await view.keyboard.press(",");
      await settle(view);
      assert.match(await view.locator("#decision").textContent(), /N0 in 10\.1 s/);
      await seek(view, 2);
      assert.match(await view.locator("#decision").textContent(), /Clear: nothing/);
    }));

  test("switches runs on and off and into focus", () =>
    inPage("encounter", {}, async (view) => {
      const all = await stats(view);
      await view.locator("#runs input").nth(1).uncheck();
      await settle(view);
      const fewer = await stats(view);
      assert.deepEqual(fewer.visible, [true, false, true]);
      assert.ok(fewer.calls < all.calls, "one track and one aircraft fewer");
      await view.keyboard.press("2");
      await view.keyboard.press("r");
      await settle(view);
      assert.equal((await stats(view)).focus, 1);
      assert.match(await view.locator("#decision").textContent(), /Turn right/);
    }));

  test("has four cameras that show different pictures", () =>
    inPage("encounter", {}, async (view) => {
      const seen = new Set();
      for (const key of ["o", "h", "t", "s"]) {
        await view.keyboard.press(key);
        await settle(view);
        await drawn(view, 20);
        seen.add((await view.locator("#scene").screenshot()).toString("base64"));
      }
      assert.equal(seen.size, 4);
    }));

  test("turns and zooms with mouse and keys; switches parts off", () =>
    inPage("encounter", {}, async (view) => {
      const shot = async () => (await view.locator("#scene").screenshot()).toString("base64");
      const changes = async (act) => {
        const was = await shot();
        await act();
        await settle(view);
        assert.notEqual(await shot(), was);
      };
      await changes(async () => {
        await view.mouse.move(400, 300);
        await view.mouse.down();
        await view.mouse.move(500, 340, { steps: 3 });
        await view.mouse.up();
      });
      await changes(() => view.mouse.wheel(0, -300));
      for (const key of ["q", "ArrowUp", "v", "k", "p", "f"]) {
        if (key === "f") {
          await view.keyboard.press("f");
          await changes(() => view.keyboard.press("ArrowRight"));
        } else await changes(() => view.keyboard.press(key));
      }
    }));

  test("lists its keys under ?", () =>
    inPage("encounter", {}, async (view) => {
      await view.keyboard.press("?");
      assert.ok(await view.locator("#help").isVisible());
      assert.match(await view.locator("#keys").textContent(), /Closest moment/);
      await view.keyboard.press("Escape");
      assert.ok(!(await view.locator("#help").isVisible()));
    }));
});

test("a flight on beliefs draws a fan and the chances of a loss", () =>
  inPage("believed", {}, async (view) => {
    const fan = async (t) => {
      await seek(view, t);
      const on = await stats(view);
      await view.keyboard.press("p");
      await settle(view);
      const off = await stats(view);
      await view.keyboard.press("p");
      return on.fan - off.fan;
    };
    // Three futures of N0; the straight one of two points is one segment.
    assert.equal(await fan(12.55), 5);
    assert.equal(await fan(3), 0);
    assert.equal(await fan(31), 0);
    await seek(view, 12.55);
    const plot = view.locator(".plot", { hasText: "P(loss)" });
    assert.match(await plot.textContent(), /mission 30 %, flown 1 %/);
    assert.match(await view.locator("#legend").textContent(), /Futures.*P\(loss\) as flown.*within a minute/);
    await seek(view, 31);
    assert.match(await plot.textContent(), /not weighed/);
  }));

test("a hostile name is text", () =>
  inPage("hostile", {}, async (view) => {
    assert.equal(await view.locator("img").count(), 0);
    assert.match(await view.title(), /<\/script><img/);
    assert.match(await view.locator("#title").textContent(), /<\/script><img src=x/);
    assert.match(await view.locator("#decision").textContent(), /<\/script><img src=x/);
    assert.match(await view.locator("#events").textContent(), /<\/script><img src=x/);
    const labels = await view.locator(".label").allTextContents();
    assert.ok(labels.some((text) => text.includes("</script><img")));
    await drawn(view);
  }));

test("a run without obstacles", () =>
  inPage("empty", {}, async (view) => {
    await drawn(view, 15);
    assert.match(await view.locator("#runs").textContent(), /no obstacle/);
    assert.match(await view.locator(".plot").first().textContent(), /no obstacle/);
  }));

test("no run at all", () =>
  inPage("nothing", {}, async (view) => {
    assert.match(await view.locator("#decision").textContent(), /Nothing was recorded/);
    for (const key of ["Space", "c", "m", "r", "1", "h", "End", ".", "a"]) {
      await view.keyboard.press(key);
    }
    await settle(view);
  }));

test("a run of one sample", () =>
  inPage("one", {}, async (view) => {
    await drawn(view);
    assert.deepEqual((await stats(view)).samples, [1]);
    await view.keyboard.press("Space");
    await settle(view);
    assert.match(await view.locator("#readout").textContent(), /x 0 y 0 z 120 m/);
  }));

test("a lost encounter says so and opens at the loss", () =>
  inPage("lost", {}, async (view) => {
    assert.match(await view.locator("#runs").textContent(), /entered N0 by 25\.0/);
    assert.ok(Math.abs((await stats(view)).t - 22) < 0.2);
    assert.match(await view.locator("#state").textContent(), /inside N0 by 25\.0 m/);
    await drawn(view);
  }));

test("1,000 obstacles are a dozen draw calls", () =>
  inPage("many", {}, async (view) => {
    await drawn(view);
    const { calls, triangles } = await stats(view);
    assert.ok(calls <= 20, `${calls} draw calls`);
    assert.ok(triangles < 500_000, `${triangles} triangles`);
  }));

test("the plots of a long run show the minute around the moment", () =>
  inPage("long", {}, async (view) => {
    const plot = view.locator(".plot canvas").first();
    const shot = async () => (await plot.screenshot()).toString("base64");
    const pictures = new Set();
    for (const t of [100, 300, 500]) {
      await seek(view, t);
      pictures.add(await shot());
    }
    assert.equal(pictures.size, 3);
    // A click in the middle of the window is the moment itself.
    const over = view.locator(".plot .u-over").first();
    const { width, height } = await over.boundingBox();
    await over.click({ position: { x: width / 2, y: height / 2 } });
    assert.ok(Math.abs((await stats(view)).t - 500) < 1);
    await over.click({ position: { x: width / 4, y: height / 2 } });
    assert.ok(Math.abs((await stats(view)).t - 485) < 2);
  }));

test("draw calls and triangles do not grow with the length of the run", async () => {
  const cost = async (name) => {
    let seen;
    await inPage(name, {}, async (view) => {
      await seek(view, 14);
      seen = await stats(view);
    });
    return seen;
  };
  const short = await cost("short");
  const long = await cost("long");
  assert.ok(long.samples[0] > 9 * short.samples[0]);
  assert.equal(long.calls, short.calls);
  assert.equal(long.triangles, short.triangles);
});

test("ten minutes among 50 obstacles stay below 3 MB", () => {
  assert.ok(statSync(page("long")).size < 3_000_000);
});
