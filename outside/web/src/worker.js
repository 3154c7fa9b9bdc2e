// Runs the command once: files in memory, words in, bytes out. The page ends the worker afterwards.

import { Directory, Fd, PreopenDirectory, WASI, wasi } from "@bjorn3/browser_wasi_shim";
import { BlobFile } from "./blob_file.js";

/** How the command begins a line that says what it is doing. */
const PROGRESS = "progress: ";

/** Standard output or error. It is no terminal, or tables were cut to its width. */
class Sink extends Fd {
  constructor(take) {
    super();
    this.take = take;
  }

  fd_fdstat_get() {
    const fdstat = new wasi.Fdstat(wasi.FILETYPE_UNKNOWN, 0);
    fdstat.fs_rights_base = BigInt(wasi.RIGHTS_FD_WRITE);
    return { ret: wasi.ERRNO_SUCCESS, fdstat };
  }

  fd_filestat_get() {
    return { ret: wasi.ERRNO_SUCCESS, filestat: new wasi.Filestat(0n, wasi.FILETYPE_UNKNOWN, 0n) };
  }

  fd_write(data) {
    this.take(data);
    return { ret: wasi.ERRNO_SUCCESS, nwritten: data.byteLength };
  }
}

/** Standard input: nothing comes. */
class Nothing extends Fd {
  fd_read() {
    return { ret: wasi.ERRNO_SUCCESS, data: new Uint8Array(0) };
  }
}

/** Takes bytes, hands out lines. */
function lines(take) {
  const decoder = new TextDecoder();
  let rest = "";
  const sink = new Sink((data) => {
    const parts = (rest + decoder.decode(data, { stream: true })).split("\n");
    rest = parts.pop();
    parts.forEach(take);
  });
  return { sink, end: () => rest && take(rest) };
}

/** A folder of these paths and blobs. */
function folder(entries) {
  const root = new Directory(new Map());
  for (const [path, blob] of entries) {
    const parts = path.split("/").filter((part) => part !== "" && part !== ".");
    const name = parts.pop();
    let place = root;
    for (const part of parts) {
      if (!(place.contents.get(part) instanceof Directory)) {
        place.contents.set(part, new Directory(new Map()));
      }
      const below = place.contents.get(part);
      below.parent = place;
      place = below;
    }
    place.contents.set(name, new BlobFile(blob));
  }
  return root;
}

/** Paths and files below a folder. */
function* files(directory, prefix = "") {
  for (const [name, entry] of directory.contents) {
    if (entry instanceof Directory) yield* files(entry, `${prefix}${name}/`);
    else yield [prefix + name, entry];
  }
}

function run({ module, words, entries }) {
  const output = [];
  const messages = [];
  const stdout = new Sink((data) => output.push(data.slice()));
  const stderr = lines((line) => {
    if (line.startsWith(PROGRESS)) postMessage({ progress: line.slice(PROGRESS.length) });
    else messages.push(line);
  });
  const root = folder(entries);
  const preopened = new PreopenDirectory(".", root.contents);
  const wasiOf = new WASI(words, ["HAPTICAL_PROGRESS=lines"], [new Nothing(), stdout, stderr.sink, preopened], { debug: false });
  // the shim counts UTF-16 units where bytes are asked for
  wasiOf.wasiImport.args_sizes_get = (count, size) => {
    const view = new DataView(wasiOf.inst.exports.memory.buffer);
    const encoder = new TextEncoder();
    view.setUint32(count, words.length, true);
    view.setUint32(size, words.reduce((sum, word) => sum + encoder.encode(word).length + 1, 0), true);
    return wasi.ERRNO_SUCCESS;
  };
  // and writes offsets of an argument by units, too
  wasiOf.wasiImport.args_get = (pointers, buffer) => {
    const view = new DataView(wasiOf.inst.exports.memory.buffer);
    const bytes = new Uint8Array(wasiOf.inst.exports.memory.buffer);
    words.forEach((word, index) => {
      const encoded = new TextEncoder().encode(word);
      view.setUint32(pointers + 4 * index, buffer, true);
      bytes.set(encoded, buffer);
      bytes[buffer + encoded.length] = 0;
      buffer += encoded.length + 1;
    });
    return wasi.ERRNO_SUCCESS;
  };
  let status = null;
  let fault = null;
  try {
    const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: wasiOf.wasiImport });
    status = wasiOf.start(instance);
  } catch (error) {
    fault = String(error);
  }
  stderr.end();
  const left = new Map(files(root));
  const written = [];
  for (const [path, file] of left) {
    if (!file.blob && status !== null) written.push([path, new Blob([file.data])]);
  }
  const removed = status === null ? [] : entries.map(([path]) => path).filter((path) => !left.has(path));
  postMessage({
    done: { status, fault, output: new Blob(output), messages: messages.join("\n"), written, removed },
  });
}

onmessage = ({ data }) => run(data);
