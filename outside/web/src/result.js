// What a command printed and wrote.

const at = (id) => document.getElementById(id);
const element = (name, set = {}) => Object.assign(document.createElement(name), set);

/** Pages come first, then what programs read. */
const ORDER = ["html", "toml", "json", "csv", "xml", "urdf"];
const TYPES = { html: "text/html", svg: "image/svg+xml", json: "application/json" };
/** Bytes of a text that are shown. */
const SHOWN = 200_000;

const ending = (path) => path.slice(path.lastIndexOf(".") + 1).toLowerCase();

export class Result {
  /** @param {(path: string) => void} show called where a file's name is pressed */
  constructor(show) {
    this.wants = show;
    this.addresses = [];
  }

  /** An address of a blob, until the next command. */
  address(blob, path) {
    const address = URL.createObjectURL(new Blob([blob], { type: TYPES[ending(path)] ?? "text/plain" }));
    this.addresses.push(address);
    return address;
  }

  /** Shows what came of a run; gives what it printed. */
  async tell(done, files) {
    this.addresses.splice(0).forEach((address) => URL.revokeObjectURL(address));
    const printed = await done.output.text();
    const isRefused = !isAnswer(done.status) && !done.isStopped;
    this.text("printed", printed);
    const error = isRefused ? refusal(done) : null;
    at("refusal").hidden = !error;
    at("refusal").replaceChildren(...(error ?? []).map((textContent) => element("p", { textContent })));
    at("messages").hidden = done.messages.trim() === "" || isRefused;
    at("messages").querySelector("pre").textContent = done.messages;
    const written = done.written.filter(([path]) => !path.startsWith(".")).map(([path]) => path);
    written.sort((a, b) => rank(a) - rank(b) || a.localeCompare(b));
    this.written(written, files);
    at("answer").hidden = false;
    const page = written.find((path) => path.endsWith(".html") && !path.endsWith("report.html"));
    at("shown").hidden = true;
    if (page) await this.show(page, files);
    at("answer-title").focus({ preventScroll: false });
    return printed;
  }

  refuse(what, next) {
    at("answer").hidden = false;
    at("refusal").hidden = false;
    at("refusal").replaceChildren(element("p", { textContent: `error: ${what}` }), element("p", { textContent: `next: ${next}` }));
  }

  text(id, text) {
    at(id).hidden = text.trim() === "";
    at(id).textContent = text;
  }

  written(paths, files) {
    const items = paths.map((path) => {
      const item = element("li");
      const show = element("a", { href: "#shown-name", textContent: path });
      show.onclick = (event) => { event.preventDefault(); this.wants(path); };
      const save = element("a", { href: this.address(files.get(path), path), download: path.split("/").pop(), textContent: "download", ariaLabel: `download ${path}` });
      item.append(show, " ", save);
      return item;
    });
    at("written").hidden = items.length === 0;
    at("written").querySelector("ul").replaceChildren(...items);
  }

  /** Shows a file below the list. */
  async show(path, files) {
    const blob = files.get(path);
    if (!blob) return;
    const frame = at("page");
    at("shown").hidden = false;
    at("shown-name").textContent = path;
    Object.assign(at("shown-save"), { href: this.address(blob, path), download: path.split("/").pop() });
    const isPage = ["html", "svg"].includes(ending(path));
    const text = await (isPage ? blob : blob.slice(0, SHOWN)).text();
    frame.onload = () => {
      const inside = frame.contentDocument;
      if (!inside?.documentElement) return;
      const fit = () => { frame.style.height = `${Math.min(inside.documentElement.scrollHeight + 24, 20_000)}px`; };
      fit();
      // sections fold in and out
      inside.addEventListener("toggle", fit, true);
      inside.addEventListener("click", (event) => this.follow(event, path, files));
    };
    // of the page's own origin also where it was opened as a file
    frame.srcdoc = isPage ? text : `<!doctype html><meta name="color-scheme" content="light dark"><pre style="white-space:pre-wrap">${escaped(text)}</pre>`;
  }

  /** Links of a page lead to other files of the folder. */
  follow(event, path, files) {
    const link = event.target.closest?.("a[href]");
    const href = link?.getAttribute("href");
    if (!href || /^[a-z]+:/i.test(href)) return;
    event.preventDefault();
    if (href.startsWith("#")) {
      link.ownerDocument.getElementById(decodeURIComponent(href.slice(1)))?.scrollIntoView();
      return;
    }
    const place = new URL(href, `http://folder/${path}`).pathname.slice(1);
    const target = decodeURIComponent(place);
    if (files.has(target)) this.wants(target);
  }
}

const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

function rank(path) {
  const place = ORDER.indexOf(ending(path));
  return place < 0 ? ORDER.length : place;
}

/** Lines of a refusal: the command's own, or why the tab could not go on. */
/** Whether a command answered: 1 and 4 are answers, too (a result is not what it says; something was found, or is no longer true). */
export function isAnswer(status) {
  return [0, 1, 4].includes(status);
}

function refusal({ status, fault, messages }) {
  if (status !== null) return messages.trim() === "" ? [`exit status ${status}`] : messages.trim().split("\n");
  const isMemory = /memory allocation of|out of memory|Maximum call/i.test(`${fault} ${messages}`);
  const isGone = /NotReadableError/.test(String(fault));
  if (isGone) return ["error: a file changed on the disk after it was chosen", "next: choose it again"];
  const what = isMemory
    ? ["error: this tab has no more memory (4 GB at most)", "next: give a shorter or thinner log, leave the second one out, or run the same command in a terminal"]
    : [`error: the command broke down in this browser: ${fault}`, "next: run the same command in a terminal, and report it with the messages below"];
  return [...what, ...messages.trim().split("\n").filter(Boolean)];
}
