// Takes a picture of a page for the docs, as `cargo xtask pictures` asks:
// `node viewer/pictures.mjs PAGE OUT [--size phone] [--theme dark] [--at SECONDS]
// [--press KEYS] [--only SELECTOR] [--table]`.

import { parseArgs } from "node:util";
import { launch, open, seek, settle, SIZES } from "./test/browser.mjs";

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    size: { type: "string" },
    theme: { type: "string" },
    at: { type: "string" },
    press: { type: "string" },
    only: { type: "string" },
    table: { type: "boolean" },
  },
});
const [place, out] = positionals;
const { size = "desktop", theme = "light" } = values;
const browser = await launch();
try {
  if (values.table) {
    const page = await browser.newPage({ viewport: SIZES[size], colorScheme: theme });
    await page.goto(place);
    await page.screenshot({ path: out });
  } else {
    const { page, errors } = await open(browser, place, { size, theme });
    if (values.at !== undefined) await seek(page, Number(values.at));
    for (const key of values.press ?? "") await page.keyboard.press(key);
    await settle(page);
    const what = values.only === undefined ? page : page.locator(values.only);
    await what.screenshot({ path: out });
    if (errors.length > 0) throw new Error(errors.join("\n"));
  }
} finally {
  await browser.close();
}
