// The table of many runs: lost ones first, then by the worst margin; sortable and filterable.

interface Row {
  name: string;
  source: string;
  policy: string;
  separated: boolean | null;
  avoidable: boolean | null;
  min_margin_m: number | null;
  max_cross_track_m: number | null;
  extra_path_m: number | null;
  link: string | null;
}

/** Rows drawn at most; more are reached by filtering and sorting. */
const SHOWN = 500;

interface Column {
  title: string;
  number: boolean;
  key(row: Row): string | number | null;
  text(row: Row): string;
  bad?(row: Row): boolean;
}

const metres = (value: number | null) => (value === null ? "" : value.toFixed(2).replace("-", "−"));

const lost = (row: Row) => row.separated === false;

const RUN: Column = { title: "Run", number: false, key: (r) => r.name, text: (r) => r.name };
const OUTCOME: Column = {
  title: "Outcome",
  number: false,
  // Lost ones come first in rising order.
  key: (r) => (r.separated === null ? 2 : Number(r.separated)),
  text: (r) => (r.separated === null ? "unknown" : r.separated ? "kept" : "lost"),
  bad: lost,
};
const EVERY_COLUMN: Column[] = [
  RUN,
  { title: "Policy", number: false, key: (r) => r.policy, text: (r) => r.policy },
  OUTCOME,
  {
    title: "Avoidable",
    number: false,
    key: (r) => (r.avoidable === null ? null : Number(!r.avoidable)),
    text: (r) => (r.avoidable === null ? "" : r.avoidable ? "yes" : "no"),
  },
  {
    title: "Least margin, m",
    number: true,
    key: (r) => r.min_margin_m,
    text: (r) => metres(r.min_margin_m),
    bad: lost,
  },
  {
    title: "Cross-track, m",
    number: true,
    key: (r) => r.max_cross_track_m,
    text: (r) => metres(r.max_cross_track_m),
  },
  {
    title: "Extra path, m",
    number: true,
    key: (r) => r.extra_path_m,
    text: (r) => metres(r.extra_path_m),
  },
  { title: "Drawn from", number: false, key: (r) => r.source, text: (r) => r.source },
];

const $ = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const data = JSON.parse($("data").textContent ?? "") as {
  title: string;
  note: string;
  rows: Row[];
};
const columns = EVERY_COLUMN.filter((c) => c === RUN || data.rows.some((row) => c.text(row) !== ""));
let by = OUTCOME;
let rising = true;

const order = new Intl.Collator(undefined, { numeric: true });

function compare(a: Row, b: Row): number {
  const x = by.key(a);
  const y = by.key(b);
  if (x === null || y === null) return Number(x === null) - Number(y === null);
  const sign = rising ? 1 : -1;
  return sign * (typeof x === "number" ? x - Number(y) : order.compare(x, String(y)));
}

function draw(): void {
  const words = $<HTMLInputElement>("filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const lostOnly = $<HTMLInputElement>("lost").checked;
  const linked = $<HTMLInputElement>("with").checked;
  const rows = data.rows.filter((row) => {
    if (lostOnly && !lost(row)) return false;
    if (linked && row.link === null) return false;
    const text = `${row.name} ${row.policy} ${row.source}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
  rows.sort((a, b) => compare(a, b) || (a.min_margin_m ?? 1e9) - (b.min_margin_m ?? 1e9));
  const head = document.querySelector("thead tr")!;
  head.replaceChildren(
    ...columns.map((column) => {
      const { title, number } = column;
      const cell = document.createElement("th");
      cell.className = number ? "number" : "";
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = column === by ? `${title} ${rising ? "▲" : "▼"}` : title;
      if (column === by) cell.setAttribute("aria-sort", rising ? "ascending" : "descending");
      button.addEventListener("click", () => {
        rising = column === by ? !rising : true;
        by = column;
        draw();
      });
      cell.append(button);
      return cell;
    }),
  );
  document.querySelector("tbody")!.replaceChildren(
    ...rows.slice(0, SHOWN).map((row) => {
      const line = document.createElement("tr");
      for (const column of columns) {
        const cell = document.createElement("td");
        cell.className = column.number ? "number" : column === RUN ? "name" : "";
        if (column.bad?.(row)) cell.classList.add("bad");
        if (column === RUN && row.link !== null) {
          const link = document.createElement("a");
          link.href = row.link;
          link.textContent = column.text(row);
          cell.append(link);
        } else cell.textContent = column.text(row);
        line.append(cell);
      }
      return line;
    }),
  );
  const all = data.rows.length;
  const lostOnes = rows.filter(lost).length;
  const shown = rows.length > SHOWN ? `; the first ${SHOWN} are shown` : "";
  $("count").textContent = `${rows.length} of ${all} runs, ${lostOnes} lost${shown}`;
}

$("title").textContent = data.title;
$("note").textContent = data.note;
$("note").hidden = data.note === "";
const dark = matchMedia("(prefers-color-scheme: dark)").matches;
document.documentElement.classList.toggle("dark", dark);
$("theme").addEventListener("click", () => document.documentElement.classList.toggle("dark"));
for (const id of ["filter", "lost", "with"]) $(id).addEventListener("input", draw);
draw();
