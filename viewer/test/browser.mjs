// What the tests share: Debian's Chromium, a page that reports its errors and requests, pixels.

import { existsSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

export const SIZES = {
  desktop: { width: 1280, height: 720 },
  phone: { width: 390, height: 844 },
  wide: { width: 1400, height: 900 },
};

const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const absent = !existsSync(executablePath) && `no Chromium at ${executablePath}; set CHROMIUM`;

/** Why a test is skipped here, if it is; with CI=true it fails instead. */
export const SKIPPED = process.env.CI !== "true" && absent;

export async function launch() {
  if (absent) throw new Error(absent);
  return chromium.launch({
    executablePath,
    args: [
      "--headless",
      "--no-sandbox",
      "--disable-gpu",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
    ],
  });
}

/** Opens a file or an address; collects errors and every request but the page itself. */
export async function open(browser, place, { size = "desktop", theme = "light" } = {}) {
  const context = await browser.newContext({ viewport: SIZES[size], colorScheme: theme });
  const page = await context.newPage();
  const url = place.startsWith("http") ? place : pathToFileURL(place).href;
  const errors = [];
  const requests = [];
  page.on("console", (message) => {
    // The software renderer's remarks on its own speed are no fault of the page.
    if (/GPU stall due to ReadPixels/.test(message.text())) return;
    if (["error", "warning"].includes(message.type())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => {
    if (request.url() !== url) requests.push(request.url());
  });
  await page.goto(url);
  await page.waitForFunction(() => globalThis.fgaReplay !== undefined);
  await settle(page);
  return { page, errors, requests, close: () => context.close() };
}

/** Waits until what was asked for is drawn. */
export async function settle(page) {
  await page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))),
  );
}

export const stats = (page) => page.evaluate(() => globalThis.fgaReplay.stats());

export async function seek(page, t) {
  await page.evaluate((at) => globalThis.fgaReplay.seek(at), t);
  await settle(page);
}

/** How many colours an area of the page shows, the share of the commonest, and how bright that is, 0 to 255. */
export async function colours(page, selector) {
  const shot = await page.locator(selector).screenshot();
  const other = await page.context().newPage();
  const counted = await other.evaluate(async (base64) => {
    const data = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([data], { type: "image/png" }));
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    const counts = new Map();
    for (let i = 0; i < pixels.length; i += 4) {
      const key = (pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2];
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    const [colour, count] = [...counts].reduce((a, b) => (b[1] > a[1] ? b : a));
    const background = ((colour >> 16) + ((colour >> 8) & 255) + (colour & 255)) / 3;
    return { kinds: counts.size, most: count / (pixels.length / 4), background };
  }, shot.toString("base64"));
  await other.close();
  return counted;
}
