// The page's answers are those of the command in a terminal.

import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync, mkdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fixtures, native, open, run, start, written } from "./browser.mjs";

let house;
let folder;
before(async () => {
  house = await start();
  folder = mkdtempSync(join(tmpdir(), "haptical-native-"));
});
after(async () => {
  rmSync(folder, { recursive: true, force: true });
  await house.stop();
});

/** Numbers of both that differ by more than a share, by their places. */
function differences(a, b, share, place = "") {
  if (typeof a === "number" && typeof b === "number") {
    return Math.abs(a - b) <= share * Math.max(Math.abs(a), Math.abs(b)) ? [] : [`${place}: ${a}, ${b}`];
  }
  if (a && b && typeof a === "object" && typeof b === "object") {
    const keys = new Set([...Object.keys(a), ...Object.keys(b)]);
    return [...keys].flatMap((key) => differences(a[key], b[key], share, `${place}.${key}`));
  }
  return a === b ? [] : [`${place}: ${a}, ${b}`];
}

const CASES = [
  ["a log with a gap", "init . --example gap", [], "diagnose --device device.toml --log log.csv --validate second.csv --out gap", "gap/gap.json", 1e-6],
  ["a moving arm", "init . --example moving-arm", [], "diagnose --device arm7.xml --log log.csv.gz --out gap", "gap/gap.json", 1e-6],
  ["a data set", "init . --example data-set", [], "doctor . --out doctor", "doctor/doctor.json", 1e-6],
  ["a payload", null, ["measured/kr300/kr300.urdf", "logs/arm-payload.csv.gz"], "diagnose --device kr300.urdf --log arm-payload.csv.gz --out gap", "gap/gap.json", 1e-6],
  ["a tracker", "init . --example urdf-arm", [], "identify --device arm6.urdf --rig rig.toml --log log.csv --out fit", "fit/identified.json", 1e-9],
  ["a plan", "init . --example urdf-arm", [], "plan --device arm6.urdf --measure pose:unknown --poses 20 --out plan", "plan/plan.json", 1e-9],
];

for (const [name, init, files, command, result, share] of CASES) {
  test(`${name}: the same words and numbers, and verified by the native command`, async () => {
    const { context, page } = await open(house.browser, house.folder);
    const here = join(folder, name);
    mkdirSync(here);
    const words = command.split(" ");
    if (init) {
      await run(page, `haptical ${init}`);
      execFileSync(native, init.split(" "), { cwd: here });
    } else {
      await page.locator("#choose-files").setInputFiles(files.map((file) => join(fixtures, file)));
      await page.locator("#steps button").first().waitFor();
      files.forEach((file) => writeFileSync(join(here, file.split("/").pop()), readFileSync(join(fixtures, file))));
    }
    await run(page, `haptical ${command}`);
    const printed = await page.locator("#printed").textContent();
    const paths = await page.locator("#written li a:first-child").allTextContents();
    const inTab = new Map();
    for (const path of paths) inTab.set(path, await written(page, path));
    await context.close();
    const done = spawnSync(native, words, { cwd: here, encoding: "utf8" });
    // 4: the doctor found something
    assert.equal(done.status, words[0] === "doctor" ? 4 : 0, done.stderr);
    assert.equal(printed, done.stdout);
    const ours = JSON.parse(inTab.get(result));
    const theirs = JSON.parse(readFileSync(join(here, result), "utf8"));
    delete ours.provenance;
    delete theirs.provenance;
    assert.deepEqual(differences(ours, theirs, share), []);
    for (const [path, text] of inTab) {
      mkdirSync(dirname(join(here, path)), { recursive: true });
      writeFileSync(join(here, path), text);
    }
    // what the doctor writes names no inputs to compute it from
    if (words[0] === "doctor") return;
    const verified = spawnSync(native, ["verify", dirname(result)], { cwd: here, encoding: "utf8" });
    assert.equal(verified.status, 0, verified.stdout);
  });
}
