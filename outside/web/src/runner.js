// A worker for each run: memory that a run took goes with it, and Stop ends it at once.

export class Runner {
  /** @param {Promise<WebAssembly.Module>} module @param {string} source text of the worker */
  constructor(module, source) {
    this.module = module;
    this.address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.worker = null;
    this.end = null;
  }

  /** Runs words on files; what it gives has `status` null where the run was stopped or broke down. */
  async run(words, files, onProgress = () => {}) {
    const module = await this.module;
    const done = new Promise((resolve) => {
      this.end = resolve;
      this.worker = new Worker(this.address);
      this.worker.onmessage = ({ data }) => {
        if (data.progress) onProgress(data.progress);
        if (data.done) resolve(data.done);
      };
      this.worker.onerror = (event) => {
        event.preventDefault();
        resolve(broken(event.message));
      };
      this.worker.postMessage({ module, words, entries: [...files] });
    });
    const result = await done;
    this.worker?.terminate();
    this.worker = null;
    return result;
  }

  /** To be called after the last run. */
  close() {
    URL.revokeObjectURL(this.address);
  }

  stop() {
    this.end?.({ ...broken(null), isStopped: true });
  }
}

function broken(fault) {
  return { status: null, fault, output: new Blob([]), messages: "", written: [], removed: [] };
}
