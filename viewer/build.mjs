// Builds the pages' templates: HTML files with the program inside and marks where title and data
// go. `--check` compares them with the committed ones instead of writing them.

import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const read = (path) => readFile(here(path), "utf8");
const hash = (text) => `sha256-${createHash("sha256").update(text).digest("base64")}`;

async function bundle(options) {
  const result = await build({
    bundle: true,
    minify: true,
    write: false,
    charset: "utf8",
    legalComments: "none",
    target: "es2022",
    absWorkingDir: here("."),
    logLevel: "warning",
    ...options,
  });
  return result.outputFiles[0].text.trim();
}

/** The notices that the licences of the packages inside ask for. */
async function notice(names) {
  const parts = await Promise.all(
    names.map(async (name) => {
      const { version } = JSON.parse(await read(`node_modules/${name}/package.json`));
      return `${name} ${version}\n${(await read(`node_modules/${name}/LICENSE`)).trim()}`;
    }),
  );
  return `<!--\nThis page contains the following software.\n\n${parts.join("\n\n")}\n-->\n`;
}

async function template({ html, script, styles, packages }) {
  const js = await bundle({ entryPoints: [here(script)], format: "iife" });
  const contents = (await Promise.all(styles.map(read))).join("\n");
  const css = await bundle({ stdin: { contents, loader: "css", resolveDir: here("src") } });
  for (const text of [js, css]) {
    if (/<\/(script|style)|<!--/i.test(text)) throw new Error(`${script} would end its own element`);
  }
  const page = (await read(html))
    .replace("%SCRIPT%", () => hash(js))
    .replace("%STYLE%", () => hash(css))
    .replace("%CSS%", () => css)
    .replace("%JS%", () => js);
  if (packages.length === 0) return page;
  const notices = await notice(packages);
  return page.replace("<!doctype html>\n", () => `<!doctype html>\n${notices}`);
}

const PAGES = {
  "../crates/fga-report/assets/replay.html": {
    html: "src/index.html",
    script: "src/main.ts",
    styles: ["node_modules/uplot/dist/uPlot.min.css", "src/style.css"],
    packages: ["three", "uplot"],
  },
  "../crates/fga-report/assets/list.html": {
    html: "src/list.html",
    script: "src/list.ts",
    styles: ["src/style.css", "src/list.css"],
    packages: [],
  },
};

for (const [target, parts] of Object.entries(PAGES)) {
  const page = await template(parts);
  if (!process.argv.includes("--check")) {
    await writeFile(here(target), page);
    console.log(`${target}: ${(page.length / 1000).toFixed(0)} kB`);
  } else if ((await read(target).catch(() => "")) !== page) {
    console.error(`${target} is not what \`npm run build\` makes; build and commit it.`);
    process.exitCode = 1;
  }
}
