// Puts the page together: `node build.mjs COMMAND.wasm FOLDER [any-size]` writes FOLDER/index.html with FOLDER/haptical.wasm.gz (for a
// static host) and FOLDER/haptical.html (one file). Both have a limit of size, unless the command is one for tests.

import { createHash } from "node:crypto";
import { mkdir, readFile, stat, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";
import { frames } from "./frames.mjs";

/** Most bytes: of the folder's files as they travel, and of the single file. */
const MOST_FOLDER = 5e6;
const MOST_FILE = 7e6;

const here = dirname(fileURLToPath(import.meta.url));
const [wasm, out, limit] = process.argv.slice(2);
if (!wasm || !out) throw new Error("usage: node build.mjs COMMAND.wasm FOLDER");

const source = (name) => join(here, "src", name);
const bundled = async (entry, plugins = []) => {
  const made = await build({
    entryPoints: [source(entry)], bundle: true, write: false, minify: true, format: "iife", target: "es2022", charset: "utf8", plugins,
  });
  return made.outputFiles[0].text;
};
const worker = await bundled("worker.js");
const withWorker = {
  name: "worker-text",
  setup(steps) {
    steps.onResolve({ filter: /^worker-text$/ }, () => ({ path: "worker-text", namespace: "worker-text" }));
    steps.onLoad({ filter: /.*/, namespace: "worker-text" }, () => ({ contents: worker, loader: "text" }));
  },
};
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const fill = (template, values) => template.replace(/\{\{(\w+)\}\}/g, (_, name) => values[name]);

const binary = await readFile(wasm);
const packed = gzipSync(binary, { level: 9 });
const style = await readFile(source("style.css"), "utf8");
const template = await readFile(source("index.html"), "utf8");
const { version, hashes } = await frames(binary);
const frame = [...new Set(hashes)].join(" ");
const common = `default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; worker-src blob:; frame-src 'none'; base-uri 'none'; form-action 'none'`;

await mkdir(out, { recursive: true });
const script = await bundled("start_folder.js", [withWorker]);
const folder = fill(template, {
  POLICY: `${common}; connect-src 'self'; script-src 'wasm-unsafe-eval' ${hash(script)} ${frame}`,
  STYLE: `<style>\n${style}</style>`, SCRIPT: `<script>${script}</script>`, VERSION: version,
});
await writeFile(join(out, "index.html"), folder);
await writeFile(join(out, "haptical.wasm.gz"), packed);

const alone = await bundled("start_file.js", [withWorker]);
const single = fill(template, {
  POLICY: `${common}; script-src 'wasm-unsafe-eval' ${hash(alone)} ${frame}`,
  STYLE: `<style>\n${style}</style>`, VERSION: version,
  SCRIPT: `<script type="text/plain" id="packed">${packed.toString("base64")}</script>\n<script>${alone}</script>`,
});
const file = join(out, "haptical.html");
await writeFile(file, single);

const travelling = packed.length + gzipSync(folder, { level: 9 }).length;
const whole = (await stat(file)).size;
const megabytes = (bytes) => `${(bytes / 1e6).toFixed(2)} MB`;
console.log(`${join(out, "index.html")}: ${megabytes(travelling)} by gzip\n${file}: ${megabytes(whole)}`);
if (limit !== "any-size" && (travelling > MOST_FOLDER || whole > MOST_FILE)) {
  throw new Error(`larger than ${megabytes(MOST_FOLDER)} by gzip, or than ${megabytes(MOST_FILE)} as one file`);
}
