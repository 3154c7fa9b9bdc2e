// The page as a folder: the command is the file beside it.

import { begin } from "./page.js";
import worker from "worker-text";

const fetched = fetch("haptical.wasm.gz").then(async (response) => {
  if (!response.ok) throw new Error(`haptical.wasm.gz: ${response.status}`);
  const plain = response.body.pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compileStreaming(new Response(plain, { headers: { "Content-Type": "application/wasm" } }));
});
begin(fetched, worker);
