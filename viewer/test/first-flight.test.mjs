// The replay page of the first flight as it is seen: on a phone and on a wide screen, light and dark.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { fileURLToPath } from "node:url";
import { colours, launch, open, SIZES, SKIPPED } from "./browser.mjs";
import { built } from "./program.mjs";

const SCENARIO = fileURLToPath(new URL("../../scenarios/first-flight.toml", import.meta.url));

describe("the first flight", { skip: SKIPPED }, () => {
  const home = mkdtempSync(join(tmpdir(), "fga-first-flight-"));
  let browser;

  before(async () => {
    const program = process.env.FGA_PROGRAM ?? built("--bin", "fga");
    const flown = spawnSync(program, ["run", SCENARIO, "--out", home], { encoding: "utf8" });
    assert.equal(flown.status, 0, flown.stderr);
    browser = await launch();
  });

  after(async () => {
    await browser?.close();
    rmSync(home, { recursive: true, force: true });
  });

  /** What a screenshot of the whole page shows: its colours, and how bright the background is. */
  async function seen(size, theme) {
    const { page, errors, close } = await open(browser, join(home, "replay.html"), { size, theme });
    try {
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= SIZES[size].width, `${size} scrolls sideways: ${wide} px`);
      assert.deepEqual(errors, []);
      const shown = await colours(page, "body");
      assert.ok(shown.kinds > 100, `${size}, ${theme}: ${shown.kinds} colours`);
      assert.ok(shown.most < 0.98, `${size}, ${theme}: ${shown.most} is one colour`);
      return shown.background;
    } finally {
      await close();
    }
  }

  for (const size of ["phone", "wide"]) {
    test(`fits and is darker in the dark: ${SIZES[size].width} px`, async () => {
      const [light, dark] = [await seen(size, "light"), await seen(size, "dark")];
      assert.ok(dark < 80 && light > 175, `brightness ${light} light, ${dark} dark, of 255`);
    });
  }
});
