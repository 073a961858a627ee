// Screenshots to look at: `node test/shots.mjs PAGES_DIR OUT_DIR [name…]`.

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { launch, open, settle } from "./browser.mjs";

const [pages, out, ...names] = process.argv.slice(2);
mkdirSync(out, { recursive: true });
const browser = await launch();
for (const name of names.length > 0 ? names : ["encounter"]) {
  for (const [size, theme] of [
    ["desktop", "light"],
    ["desktop", "dark"],
    ["phone", "light"],
    ["phone", "dark"],
  ]) {
    const { page, errors, close } = await open(browser, join(pages, `${name}.html`), { size, theme });
    const shot = (what) => page.screenshot({ path: join(out, `${name}-${size}-${theme}${what}.png`) });
    await shot("");
    if (size === "desktop") {
      for (const key of ["h", "t", "s"]) {
        await page.keyboard.press(key);
        await settle(page);
        await shot(`-${key}`);
      }
    } else {
      const path = join(out, `${name}-${size}-${theme}-full.png`);
      await page.screenshot({ path, fullPage: true });
    }
    if (errors.length > 0) console.log(name, size, theme, errors);
    await close();
  }
}
await browser.close();
