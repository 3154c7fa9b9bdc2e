// The scripts of the pages that the command writes: only these may run in the page's frame.

import { createHash } from "node:crypto";
import { ConsoleStdout, Directory, File, OpenFile, PreopenDirectory, WASI } from "@bjorn3/browser_wasi_shim";

/** Commands that write each kind of page, run in this order. */
const COMMANDS = [
  "init . --example gap",
  "identify --device device.toml --log log.csv --out fit",
  "diagnose --device device.toml --log log.csv --out gap",
  "plan --device device.toml --out plan",
  "play --device device.toml --log log.csv --out play.html",
];

/** Version of the command, and the hashes of its pages' scripts. */
export async function frames(binary) {
  const module = await WebAssembly.compile(binary);
  const contents = new Map();
  for (const command of COMMANDS) await run(module, command.split(" "), contents);
  const hashes = new Set();
  for (const [name, { data }] of files(contents)) {
    if (!name.endsWith(".html")) continue;
    for (const [, script] of new TextDecoder().decode(data).matchAll(/<script>([\s\S]*?)<\/script>/g)) {
      hashes.add(`'sha256-${createHash("sha256").update(script).digest("base64")}'`);
    }
  }
  const [version] = await run(module, ["--version"], contents);
  return { version, hashes: [...hashes].sort() };
}

function* files(contents) {
  for (const [name, entry] of contents) {
    if (entry instanceof Directory) yield* files(entry.contents);
    else yield [name, entry];
  }
}

/** Runs a command; gives the lines that it prints. */
async function run(module, words, contents) {
  const said = [];
  const sink = ConsoleStdout.lineBuffered((line) => said.push(line));
  const input = new OpenFile(new File(new ArrayBuffer(0)));
  const wasi = new WASI(["haptical", ...words], [], [input, sink, sink, new PreopenDirectory(".", contents)], { debug: false });
  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
  const status = wasi.start(instance);
  if (status !== 0) throw new Error(`haptical ${words.join(" ")}: exit status ${status}\n${said.join("\n")}`);
  return said;
}
