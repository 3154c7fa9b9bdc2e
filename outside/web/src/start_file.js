// The page as one file: the command is in it, packed, as text.

import { begin } from "./page.js";
import worker from "worker-text";

async function unpacked() {
  const text = document.getElementById("packed").textContent.trim();
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compileStreaming(new Response(plain, { headers: { "Content-Type": "application/wasm" } }));
}

begin(unpacked(), worker);
