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

interface Estimate {
  value: number;
  low: number;
  high: number;
}

interface Share {
  policy: string;
  runs: number;
  separated: Estimate | null;
  avoidable: number;
  saved: Estimate | null;
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

/** A cell of drawn threats in words, as in "3 threats, first seen at 100–500 m, 55–60 m/s"; other sources as they are. */
function drawnFrom(source: string): string {
  const cell = /^threats:(\d+):([\d.-]+):([\d.-]+)(?:,(.+))?$/.exec(source);
  if (!cell) return source;
  const [, count, seen, speeds, more] = cell;
  const span = (text: string) => text.replace("-", "–");
  const threats = count === "1" ? "1 threat" : `${count} threats`;
  const words = `${threats}, first seen at ${span(seen!)} m, ${span(speeds!)} m/s`;
  return more ? `${words}, ${more}` : words;
}

const lost = (row: Row) => row.separated === false;

/** The outcomes that can be asked for. */
const OUTCOMES: [title: string, holds: (row: Row) => boolean][] = [
  ["all", () => true],
  ["lost", lost],
  ["lost although avoidable", (row) => lost(row) && row.avoidable === true],
  ["kept", (row) => row.separated === true],
];

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
  { title: "Drawn from", number: false, key: (r) => r.source, text: (r) => drawnFrom(r.source) },
];

const $ = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const data = JSON.parse($("data").textContent ?? "") as {
  title: string;
  note: string;
  shares: Share[];
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

/** What a column's filter asks: "< 5", ">= 2", "2..5" or "5" of numbers, else words. Null: not understood. */
function asks(column: Column, text: string): ((row: Row) => boolean) | null {
  const wanted = text.trim().toLowerCase().replaceAll("−", "-");
  if (wanted === "") return () => true;
  if (!column.number) return (row) => column.text(row).toLowerCase().includes(wanted);
  const NUMBER = "(-?[0-9]+\\.?[0-9]*)";
  const bound = new RegExp(`^(<=?|>=?|=?)\\s*${NUMBER}$`).exec(wanted);
  const range = new RegExp(`^${NUMBER}\\s*\\.\\.\\s*${NUMBER}$`).exec(wanted);
  const test = (holds: (value: number) => boolean) => (row: Row) => {
    const value = column.key(row);
    return typeof value === "number" && holds(value);
  };
  if (range) return test((value) => value >= Number(range[1]) && value <= Number(range[2]));
  if (!bound) return null;
  const limit = Number(bound[2]);
  switch (bound[1]) {
    case "<":
      return test((value) => value < limit);
    case "<=":
      return test((value) => value <= limit);
    case ">":
      return test((value) => value > limit);
    case ">=":
      return test((value) => value >= limit);
    default:
      // As many digits as the table shows.
      return test((value) => Math.abs(value - limit) < 0.005);
  }
}

const filters = new Map<Column, HTMLInputElement>();

/** The filter of each column; made once, so that what is typed stays. */
function makeFilters(): void {
  const line = document.querySelector("tr.filters")!;
  for (const column of columns) {
    const input = document.createElement("input");
    input.type = "search";
    input.placeholder = column.number ? "< 5, 2..5" : "contains";
    input.setAttribute("aria-label", `Filter ${column.title}`);
    input.addEventListener("input", draw);
    filters.set(column, input);
    const cell = document.createElement("th");
    cell.append(input);
    line.append(cell);
  }
}

/** The filters of the columns as one question; what is not understood is marked and asks nothing. */
function columnsHold(): (row: Row) => boolean {
  const questions = [...filters].map(([column, input]) => {
    const question = asks(column, input.value);
    input.toggleAttribute("aria-invalid", question === null);
    return question ?? (() => true);
  });
  return (row) => questions.every((holds) => holds(row));
}

const percent = (of: Estimate | null) =>
  of === null
    ? "–"
    : `${(100 * of.value).toFixed(2)} % [${(100 * of.low).toFixed(2)}, ${(100 * of.high).toFixed(2)}]`;

/** How often each policy kept every volume, over all runs. */
function showShares(): void {
  const table = $<HTMLTableElement>("shares");
  const asked = data.shares.some((share) => share.avoidable > 0);
  if (data.shares.length === 0) return table.remove();
  const titles = ["Policy", "Runs", "Kept (95 % interval)"];
  if (asked) titles.push("Avoidable", "Kept of avoidable (95 % interval)");
  const line = (kind: "th" | "td", texts: string[]) => {
    const row = document.createElement("tr");
    row.append(
      ...texts.map((text, column) => {
        const cell = document.createElement(kind);
        cell.textContent = text;
        cell.className = column > 0 ? "number" : "";
        return cell;
      }),
    );
    return row;
  };
  table.tHead!.append(line("th", titles));
  for (const share of data.shares) {
    const texts = [share.policy, String(share.runs), percent(share.separated)];
    if (asked) texts.push(String(share.avoidable), percent(share.saved));
    table.tBodies[0]!.append(line("td", texts));
  }
}

function offer(select: HTMLSelectElement, titles: string[]): void {
  select.replaceChildren(...titles.map((title) => new Option(title, title)));
  select.addEventListener("input", draw);
}

function draw(): void {
  const words = $<HTMLInputElement>("filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const policy = $<HTMLSelectElement>("policy");
  const outcome = OUTCOMES[$<HTMLSelectElement>("outcome").selectedIndex]?.[1] ?? (() => true);
  const linked = $<HTMLInputElement>("with").checked;
  const hold = columnsHold();
  const rows = data.rows.filter((row) => {
    if (policy.selectedIndex > 0 && row.policy !== policy.value) return false;
    if (!outcome(row) || !hold(row)) return false;
    if (linked && row.link === null) return false;
    const text = `${row.name} ${row.policy} ${row.source} ${drawnFrom(row.source)}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
  rows.sort((a, b) => compare(a, b) || (a.min_margin_m ?? 1e9) - (b.min_margin_m ?? 1e9));
  const head = document.querySelector("#table thead tr")!;
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
  document.querySelector("#table tbody")!.replaceChildren(
    ...rows.slice(0, SHOWN).map((row) => {
      const line = document.createElement("tr");
      for (const column of columns) {
        const cell = document.createElement("td");
        // A narrow page shows the title beside each value.
        cell.dataset.title = column.title;
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
for (const id of ["filter", "with"]) $(id).addEventListener("input", draw);
const policies = [...new Set(data.rows.map((row) => row.policy))].filter(Boolean);
offer($("policy"), ["all", ...policies]);
$("by-policy").hidden = policies.length < 2;
offer(
  $("outcome"),
  OUTCOMES.map(([title]) => title),
);
showShares();
makeFilters();
draw();
