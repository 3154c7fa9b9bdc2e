// A browser, and the page in it.

import { createServer } from "node:http";
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const root = join(dirname(fileURLToPath(import.meta.url)), "..", "..", "..");
/** Where the page was built. */
export const built = process.env.HAPTICAL_PAGE ?? join(root, "outside", "web", "dist");
/** The native command, for comparison. */
export const native = process.env.HAPTICAL ?? join(root, "target", "debug", "haptical");
export const fixtures = join(root, "fixtures");

const TYPES = { html: "text/html", gz: "application/gzip" };
const programs = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** Opens a browser and a server of the built folder. */
export async function start() {
  const server = createServer(async (request, response) => {
    const name = new URL(request.url, "http://localhost").pathname.replace(/\/$/, "/index.html").slice(1);
    try {
      const bytes = await readFile(join(built, name));
      response.writeHead(200, { "Content-Type": TYPES[name.split(".").pop()] ?? "application/octet-stream" });
      response.end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const browser = await chromium.launch({
    executablePath: programs.find((path) => path && existsSync(path)),
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  const folder = `http://127.0.0.1:${server.address().port}/`;
  const single = pathToFileURL(join(built, "haptical.html")).href;
  return { browser, folder, single, stop: async () => { await browser.close(); server.close(); } };
}

/** The page, ready, with what it asked for and what went wrong in it since. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const requests = [];
  const errors = [];
  page.on("request", (request) => { if (!request.url().startsWith("blob:")) requests.push(request.url()); });
  page.on("console", (message) => { if (message.type() === "error") errors.push(message.text()); });
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(address);
  await page.locator("#run:enabled").waitFor();
  const loaded = requests.splice(0);
  return { context, page, requests, errors, loaded };
}

/** Waits for the end of a run. */
export async function ended(page, timeout = 120_000) {
  await page.locator("body:not([aria-busy])").waitFor({ timeout });
  await page.locator("#progress", { hasText: /^(Done|Ended|Stopped)/ }).waitFor({ timeout });
}

/** Runs a command line. */
export async function run(page, words, timeout) {
  await page.locator("#words").fill(words);
  await page.locator("#run").click();
  await ended(page, timeout);
}

/** A file that the page has, as text. */
export async function written(page, path) {
  const link = page.locator(`#written a[aria-label="download ${path}"]`);
  const address = await link.getAttribute("href");
  // the policy forbids to fetch even blobs, but not to load one into a frame or to read it here
  const download = page.waitForEvent("download");
  await page.evaluate(({ href, name }) => Object.assign(document.createElement("a"), { href, download: name }).click(), { href: address, name: "file" });
  return readFile(await (await download).path(), "utf8");
}
