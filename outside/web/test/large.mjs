// Logs of 100 MB and of 1 GB, and one that is too much: `npm run large`, some minutes and 6 GB of disk. The times are printed.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { built, ended, fixtures, native, open, run, start } from "./browser.mjs";

/** Seconds that an answer may take. */
const MOST_S = { "100 MB": 6, "1 GB": 25 };
/** Milliseconds that the page may be stuck. */
const MOST_STUCK_MS = 100;

let house;
const folder = join(built, "large");
const device = join(fixtures, "devices/haptic7.toml");
before(async () => {
  house = await start();
  mkdirSync(folder, { recursive: true });
});
after(() => house.stop());

/** A log of so many bytes; kept for the next time. */
function log(name, bytes, seed = 1) {
  const path = join(folder, `${name.replace(" ", "")}-${seed}.csv`);
  const row = 330;
  if (!existsSync(path)) {
    const seconds = String(Math.round(bytes / row / 1000));
    execFileSync(native, ["simulate", "--device", device, "--deviate", "0.3", "--seconds", seconds, "--rate-hz", "1000", "--seed", String(seed), "--out", path]);
  }
  return path;
}

/** Begins to look for moments in which the page does not answer; gives the longest when asked. */
async function watched(page) {
  await page.evaluate(() => {
    window.longest = 0;
    let last = performance.now();
    setInterval(() => {
      const now = performance.now();
      window.longest = Math.max(window.longest, now - last);
      last = now;
    }, 10);
  });
  return () => page.evaluate(() => window.longest);
}

for (const [name, bytes] of [["100 MB", 100e6], ["1 GB", 1e9]]) {
  test(`a log of ${name}`, { timeout: 600_000 }, async () => {
    const path = log(name, bytes);
    const { context, page } = await open(house.browser, house.folder);
    const longest = await watched(page);
    await page.locator("#choose-files").setInputFiles([device, path]);
    await page.getByRole("button", { name: /Find what is still wrong/ }).waitFor();
    const began = performance.now();
    await run(page, `haptical diagnose --device haptic7.toml --log ${path.split("/").pop()} --out gap`, 300_000);
    const seconds = (performance.now() - began) / 1000;
    const stuck = await longest();
    console.log(`${name} (${(statSync(path).size / 1e6).toFixed(0)} MB): ${seconds.toFixed(1)} s, stuck for ${stuck.toFixed(0)} ms at most`);
    console.log((await page.locator("#printed").textContent()).split("\n").slice(0, 3).join("\n"));
    assert.ok(await page.locator("#shown").isVisible(), await page.locator("#refusal").textContent());
    assert.ok(stuck < MOST_STUCK_MS, `${stuck} ms`);
    assert.ok(seconds < MOST_S[name], `${seconds} s`);
    await context.close();
  });
}

test("what needs more memory than a tab has is refused in a word, and the next run works", { timeout: 900_000 }, async () => {
  const logs = [1, 2, 3, 4].map((seed) => log("1 GB", 1e9, seed));
  const { context, page } = await open(house.browser, house.folder);
  await page.locator("#choose-files").setInputFiles([device, ...logs]);
  await page.locator("#steps button").first().waitFor({ timeout: 120_000 });
  const words = logs.map((path) => `--log ${path.split("/").pop()}`).join(" ");
  await run(page, `haptical diagnose --device haptic7.toml ${words} --out gap`, 600_000);
  const refusal = await page.locator("#refusal").textContent();
  console.log(refusal);
  assert.match(refusal, /^error: this tab has no more memory/);
  await run(page, "haptical init demo --example sockets");
  await run(page, "haptical identify --device demo/arm6.urdf --rig demo/rig.toml --log demo/log.csv --out fit");
  assert.ok(await page.locator("#shown").isVisible());
  await context.close();
});
