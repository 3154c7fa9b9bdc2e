// The page: files, a command line, an answer.

import * as columns from "./columns.js";
import { chosen, dropped, size } from "./folder.js";
import { Result, isAnswer } from "./result.js";
import { Runner } from "./runner.js";
import { split } from "./words.js";

const FIT = "haptical identify --device arm6.urdf --rig rig.toml --log log.csv --out fit";
const EXAMPLES = [
  ["a haptic arm with a gap", "gap", "haptical diagnose --device device.toml --log log.csv --validate second.csv --out gap"],
  ["a moving arm", "moving-arm", "haptical diagnose --device arm7.xml --log log.csv.gz --out gap"],
  ["a data set of episodes", "data-set", "haptical doctor . --out doctor"],
  ["an arm and a tracker", "urdf-arm", FIT],
  ["a ball in two sockets", "sockets", FIT],
];

const at = (id) => document.getElementById(id);
const element = (name, set = {}) => Object.assign(document.createElement(name), set);

class Page {
  constructor(module, worker) {
    this.files = new Map();
    this.kinds = new Map();
    this.before = Promise.resolve();
    /** Whether a person wrote in the command line since the last run: then it stays. */
    this.isTyped = false;
    this.runner = new Runner(module, worker);
    this.result = new Result((path) => this.show(path));
    for (const id of ["choose-files", "choose-folder"]) {
      at(id).onchange = ({ target }) => {
        this.add(chosen(target));
        // the same file, changed or removed, can be chosen again
        target.value = "";
      };
    }
    const drop = document.body;
    drop.ondragover = (event) => { event.preventDefault(); at("drop").classList.add("over"); };
    drop.ondragleave = () => at("drop").classList.remove("over");
    drop.ondrop = async (event) => {
      event.preventDefault();
      at("drop").classList.remove("over");
      await this.add(await dropped(event.dataTransfer));
    };
    at("words").oninput = () => { this.isTyped = true; };
    at("command").onsubmit = (event) => { event.preventDefault(); this.run(at("words").value); };
    at("stop").onclick = () => this.runner.stop();
    for (const [name, kind, command] of EXAMPLES) {
      const button = element("button", { type: "button", textContent: name, disabled: true });
      button.onclick = () => this.example(kind, command);
      at("examples").append(button);
    }
    module.then(() => this.say("Ready."), (error) => this.say(`This browser cannot run the command: ${error}`));
    module.then(() => document.querySelectorAll("#examples button, #run").forEach((button) => { button.disabled = false; }));
  }

  say(text) {
    at("progress").textContent = text;
  }

  /** One thing at a time: what is asked for meanwhile waits. */
  alone(work) {
    document.body.setAttribute("aria-busy", "true");
    const failed = (error) => {
      this.say("Ended.");
      this.result.refuse(`the page broke down: ${error}`, "choose the files again, or load the page again");
    };
    const done = this.before.then(work).catch(failed).finally(() => {
      if (this.before === done) document.body.removeAttribute("aria-busy");
    });
    this.before = done;
    return done;
  }

  /** Takes files, and asks the command what can be done with them. */
  add(entries) {
    return this.alone(async () => {
      for (const [path, blob] of entries) this.files.set(path, blob);
      await this.look();
    });
  }

  async look() {
    const { status, output } = await this.runner.run(["haptical", "--json"], this.files);
    const nothing = { devices: [], rigs: [], logs: [], tables: [], next: [] };
    const found = status === 0 ? JSON.parse(await output.text()) : nothing;
    this.kinds.clear();
    for (const [kind, names] of Object.entries({ device: found.devices, rig: found.rigs, table: found.tables })) {
      names.forEach((name) => this.kinds.set(name, kind));
    }
    found.logs.forEach(({ name }) => this.kinds.set(name, "log"));
    this.found = found;
    this.list();
    this.steps(found.next);
  }

  list() {
    const rows = [...this.files].map(([path, blob]) => {
      const row = element("tr");
      const remove = element("button", { type: "button", textContent: "Remove", ariaLabel: `Remove ${path}` });
      remove.onclick = () => this.alone(() => {
        this.files.delete(path);
        return this.look();
      });
      const last = element("td");
      last.append(remove);
      row.append(element("td", { className: "text", textContent: path }),
        element("td", { className: "text", textContent: this.kinds.get(path) ?? "" }),
        element("td", { textContent: size(blob.size) }), last);
      return row;
    });
    at("folder").hidden = rows.length === 0;
    at("folder").querySelector("tbody").replaceChildren(...rows);
  }

  steps(next) {
    const starts = ["diagnose", "identify", "import", "plan --settle", "export", ""];
    const begins = (start) => next.findIndex(({ command }) => command.startsWith(`haptical ${start}`));
    const first = starts.map(begins).find((place) => place >= 0);
    const buttons = next.map(({ what, command }, index) => {
      const button = element("button", { type: "button", textContent: what, title: command });
      if (index === first) button.className = "first";
      button.onclick = () => this.run(command);
      return button;
    });
    at("steps").replaceChildren(...buttons);
    if (next[first] && !this.isTyped) at("words").value = next[first].command;
  }

  /** Puts an example in the place of the files, and answers it. */
  example(kind, command) {
    return this.alone(async () => {
      this.files.clear();
      await this.execute(`haptical init . --example ${kind}`);
      await this.execute(command);
    });
  }

  run(line) {
    return this.alone(() => this.execute(line));
  }

  async execute(line) {
    this.isTyped = false;
    at("words").value = line;
    let words = null;
    try {
      words = split(line);
    } catch (error) {
      this.result.refuse(`The command cannot be read: ${error.message}.`, "close it, or write \\ before it");
      return;
    }
    if (words[0] !== "haptical") words.unshift("haptical");
    const began = performance.now();
    const seconds = () => `${((performance.now() - began) / 1000).toFixed(1)} s`;
    let step = "starting";
    const tick = () => this.say(`${step} … ${seconds()}`);
    const timer = setInterval(tick, 200);
    at("run").hidden = true;
    at("stop").hidden = false;
    at("mapping").hidden = true;
    at("answer").hidden = true;
    tick();
    const done = await this.runner.run(words, this.files, (message) => { step = message; tick(); });
    clearInterval(timer);
    at("run").hidden = false;
    at("stop").hidden = true;
    this.say(done.isStopped ? `Stopped after ${seconds()}; nothing was written.` : `${isAnswer(done.status) ? "Done" : "Ended"} in ${seconds()}.`);
    done.removed.forEach((path) => this.files.delete(path));
    done.written.forEach(([path, blob]) => this.files.set(path, blob));
    const printed = await this.result.tell(done, this.files);
    if (done.written.length > 0 || done.removed.length > 0) {
      await this.look();
      if (!this.isTyped) at("words").value = line;
    }
    if (done.status === 0 && words[1] === "import" && words.includes("--guess") && !words.includes("--out") && !words.includes("--json")) {
      this.map(printed, operands(words.slice(2)));
    }
  }

  /** The form of a mapping file. */
  map(text, tables) {
    const device = this.found?.devices[0];
    columns.show(at("mapping"), text, { tables, device, isTaken: (name) => this.files.has(name) }, (name, mapping, command) => {
      this.files.set(name, new Blob([mapping]));
      this.run(command);
    });
  }

  show(path) {
    this.result.show(path, this.files);
  }
}

/** Words of `import` that are neither flags nor their values. */
function operands(words) {
  const isValue = (index) => /^--(device|rig|base|tip|columns)$/.test(words[index - 1] ?? "");
  return words.filter((word, index) => !word.startsWith("--") && !isValue(index));
}

/** Runs a command for a program: words without the program's name, and files as bytes or blobs by their paths. */
async function alone(module, worker, { args, files = {} }) {
  const runner = new Runner(module, worker);
  const blobs = Object.entries(files).map(([path, data]) => [path, data instanceof Blob ? data : new Blob([data])]);
  const { status, fault, output, messages, written } = await runner.run(["haptical", ...args], new Map(blobs));
  const bytes = written.map(async ([path, blob]) => [path, new Uint8Array(await blob.arrayBuffer())]);
  runner.close();
  return { status, stdout: await output.text(), stderr: fault ? `${messages}\n${fault}` : messages, files: Object.fromEntries(await Promise.all(bytes)) };
}

/** Begins. From now on nothing may be fetched: what a page in a frame or a broken file might ask for is refused. */
export function begin(module, worker) {
  globalThis.haptical = { run: (what) => alone(compiled, worker, what) };
  const compiled = module.then((wasm) => {
    const policy = element("meta", { httpEquiv: "Content-Security-Policy", content: "connect-src 'none'" });
    document.head.append(policy);
    return wasm;
  });
  return new Page(compiled, worker);
}
