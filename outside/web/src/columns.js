// The mapping file that `haptical import --guess` proposes, as a form: which column is which of a log, in what unit.

import { quoted } from "./words.js";

const NAMES = ["t_s", "run", "theta1_rad", "theta1_m", "out1_rad", "torque1_nm", "command1_rad", "current1_a", "x_m", "y_m", "z_m",
  "qw", "qx", "qy", "qz", "cable_m", "contact", "plane", "tool", "hand", "fx_n", "fy_n", "fz_n", "temp_degc"];
const UNITS = ["rad", "deg", "m", "mm", "um", "in", "s", "ms", "us", "ns", "Nm", "Nmm", "N", "A", "mA", "degC", "K"];

/** The text of a TOML string, basic or literal, in one line. */
function plain(text) {
  for (const quote of ["\'\'\'", "'"]) {
    if (text.startsWith(quote) && text.endsWith(quote)) return text.slice(quote.length, -quote.length);
  }
  if (text.startsWith('"""')) return JSON.parse(`"${text.slice(3, -3).replace(/(?<!\\)"/g, '\\"')}"`);
  return JSON.parse(text);
}

/** What was proposed: the tables before the columns, and the columns. */
export function parse(text) {
  const lines = text.split("\n");
  const first = lines.findIndex((line, index) => line === "[[column]]" || (index > 0 && /^# (NO JOINT|Left out)/.test(line)));
  const before = lines.slice(0, first < 0 ? lines.length : first);
  while (before.at(-1)?.startsWith("#") && before.length > 4) before.pop();
  const columns = [];
  let column = null;
  let why = [];
  for (const line of lines.slice(before.length)) {
    const value = /^(\w+) = (.*)$/.exec(line);
    const left = /^# column \d+ `(.*)`: (.*)$/.exec(line);
    if (line === "[[column]]") {
      column = { from: "", log: "", unit: "", why: why.join(" "), more: [] };
      columns.push(column);
    } else if (left) {
      columns.push({ from: left[1], log: "", unit: "", why: left[2], more: [] });
    } else if (value && column && ["from", "log", "unit"].includes(value[1])) {
      column[value[1]] = plain(value[2]);
    } else if (value && column) {
      column.more.push(line);
    } else if (line.startsWith("# ")) {
      why.push(line.slice(2));
      continue;
    }
    why = [];
  }
  return { before: before.join("\n").trimEnd(), columns };
}

/** The mapping file of what the form has now. */
export function write({ before, columns }) {
  const kept = columns.filter(({ log }) => log.trim() !== "");
  const text = ({ from, log, unit, more }) => {
    const keys = [`log = ${JSON.stringify(log.trim())}`, `from = ${JSON.stringify(from)}`];
    if (unit.trim() !== "") keys.push(`unit = ${JSON.stringify(unit.trim())}`);
    return ["[[column]]", ...keys, ...more].join("\n");
  };
  return `${[before, ...kept.map(text)].join("\n\n")}\n`;
}

/** Fills the form; `make` gets the mapping file's name and text, and the command that reads it. */
export function show(form, text, { tables, device, isTaken }, make) {
  const proposed = parse(text);
  const element = (name, set, ...children) => {
    const made = Object.assign(document.createElement(name), set);
    made.append(...children);
    return made;
  };
  const options = (id, values) => element("datalist", { id }, ...values.map((value) => element("option", { value })));
  const cell = (column, key, list, label) => {
    const input = element("input", { value: column[key], ariaLabel: `${label} of column ${column.from}` });
    input.setAttribute("list", list);
    input.addEventListener("input", () => { column[key] = input.value; });
    return element("td", { className: "text" }, input);
  };
  const rows = proposed.columns.map((column) => element("tr", {},
    element("td", { className: "text", textContent: column.from }),
    cell(column, "log", "log-names", "meaning"),
    cell(column, "unit", "units", "unit"),
    element("td", { className: "text note", textContent: column.why })));
  const heads = ["column", "is", "unit", "why this is proposed"];
  const head = element("tr", {}, ...heads.map((textContent) => element("th", { scope: "col", className: "text", textContent })));
  form.replaceChildren(
    element("h3", { id: "mapping-title", textContent: "Which columns are these?" }),
    element("p", { className: "note", textContent: "Read each line and correct it. A column with an empty name is left out; any other name is kept as it is." }),
    options("log-names", NAMES), options("units", UNITS),
    element("div", { className: "scroll" }, element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows))),
    element("p", { className: "row" }, element("button", { type: "submit", className: "first", textContent: "Make the log" })));
  form.hidden = false;
  form.onsubmit = (event) => {
    event.preventDefault();
    form.hidden = true;
    const free = (name, end) => {
      for (let number = 1; ; number += 1) {
        const path = `${name}${number > 1 ? `-${number}` : ""}.${end}`;
        if (!isTaken(path)) return path;
      }
    };
    const [mapping, out] = [free("columns", "toml"), free("log", "csv")];
    const of = device ? ` --device ${quoted(device)}` : "";
    make(mapping, write(proposed), `haptical import --columns ${mapping} ${tables.map(quoted).join(" ")}${of} --out ${out}`);
  };
}
