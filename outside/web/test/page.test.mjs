// The page as people use it: examples, files of their own, refusals, no network.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { ended, fixtures, open, run, start } from "./browser.mjs";

let house;
before(async () => { house = await start(); });
after(() => house.stop());

const EXAMPLES = [
  ["a haptic arm with a gap", /^Named\. capstan-compliance at joint 2/, "gap/gap.html", "gap/corrected.toml"],
  ["a moving arm", /^Named\. payload/, "gap/gap.html", "gap/corrected.toml"],
  ["a data set of episodes", /^2 of 3 joints have a finding/, "doctor/doctor.html", "doctor/doctor.json"],
  ["an arm and a tracker", /30 of 54 parameters identified/, "fit/identify.html", "fit/identified.toml"],
  ["a ball in two sockets", /parameters identified/, "fit/identify.html", "fit/identified.toml"],
];

for (const form of ["folder", "single"]) {
  test(`${form}: every example answers with one click, and nothing is asked of a network`, async () => {
    const { context, page, requests, errors, loaded } = await open(house.browser, house[form]);
    assert.equal(loaded.length, form === "folder" ? 2 : 1, loaded.join(" "));
    await context.setOffline(true);
    for (const [name, printed, html, model] of EXAMPLES) {
      await page.getByRole("button", { name }).click();
      await page.locator("#shown-name", { hasText: html }).waitFor({ timeout: 60_000 });
      await ended(page);
      assert.match(await page.locator("#printed").textContent(), printed);
      assert.ok(await page.locator("#written").getByText(model, { exact: true }).isVisible());
      const frame = page.frameLocator("#page");
      await frame.locator("svg").first().waitFor({ timeout: 5000 });
      // its script ran
      await frame.getByRole("button", { name: "Copy" }).first().waitFor({ timeout: 5000 });
    }
    assert.deepEqual(requests, []);
    assert.deepEqual(errors, []);
    await context.close();
  });
}

for (const form of ["folder", "single"]) test(`${form}: links of a page lead to the files beside it`, async () => {
  const { context, page } = await open(house.browser, house[form]);
  await run(page, "haptical init . --example sockets");
  await run(page, "haptical identify --device arm6.urdf --rig rig.toml --log log.csv --out fit");
  await page.locator("#written").getByText("fit/report.html", { exact: true }).click();
  await page.frameLocator("#page").getByRole("link", { name: /identify\.html|Identification/ }).first().click();
  await page.locator("#shown-name", { hasText: "fit/identify.html" }).waitFor();
  const height = async () => (await page.locator("#page").boundingBox()).height;
  await page.waitForFunction(() => document.getElementById("page").offsetHeight !== 640);
  assert.ok((await height()) > 800, "the frame is as high as its page");
  await context.close();
});

test("files of one's own: what can be done is offered, and done", async () => {
  const { context, page } = await open(house.browser, house.folder);
  const names = ["devices/haptic7.toml", "logs/haptic7-sample.csv"];
  await page.locator("#choose-files").setInputFiles(names.map((name) => join(fixtures, name)));
  const step = page.getByRole("button", { name: "See what the log could identify" });
  await step.click();
  await ended(page);
  assert.match(await page.locator("#words").inputValue(), /^haptical check haptic7\.toml haptic7-sample\.csv$/);
  assert.match(await page.locator("#folder").textContent(), /haptic7\.tomldevice.*haptic7-sample\.csvlog/s);
  await context.close();
});

test("a moving arm's files", async () => {
  const { context, page } = await open(house.browser, house.folder);
  await page.locator("#choose-files").setInputFiles(["measured/kr300/kr300.urdf", "logs/arm-payload.csv.gz"].map((name) => join(fixtures, name)));
  await page.getByRole("button", { name: /Find what is still wrong/ }).click();
  await ended(page);
  assert.match(await page.locator("#printed").textContent(), /^Named\. payload/);
  await context.close();
});

test("a refusal is the command's, and the next run works", async () => {
  const { context, page, errors } = await open(house.browser, house.folder);
  const bad = ["bad/sound-device.toml", "bad/log-unclosed-quote.csv", "bad/log-twice-compressed.csv.gz"];
  await page.locator("#choose-files").setInputFiles(bad.map((name) => join(fixtures, name)));
  for (const name of ["log-unclosed-quote.csv", "log-twice-compressed.csv.gz", "no-such.csv"]) {
    await run(page, `haptical identify --device sound-device.toml --log ${name} --out fit`);
    const lines = await page.locator("#refusal p").allTextContents();
    assert.deepEqual(lines.map((line) => line.trim().split(":")[0]), ["error", "where", "next"], lines.join("\n"));
    assert.match(lines[1], new RegExp(name.replaceAll(".", "\\.")));
  }
  await run(page, "haptical --version");
  assert.match(await page.locator("#printed").textContent(), /^haptical \d/);
  assert.ok(await page.locator("#refusal").isHidden());
  await page.locator("#words").fill("haptical check 'open");
  await page.locator("#run").click();
  assert.match(await page.locator("#refusal").textContent(), /quotation mark ' is not closed/);
  assert.deepEqual(errors, []);
  await context.close();
});

test("Stop ends a run at once, and the next one works", async () => {
  const { context, page } = await open(house.browser, house.folder);
  await run(page, "haptical init .");
  await page.locator("#words").fill("haptical plan --device device.toml --poses 1000 --candidates 20000 --out plan");
  await page.locator("#run").click();
  await page.locator("#progress", { hasText: /poses … [1-9]/ }).waitFor({ timeout: 60_000 });
  await page.getByRole("button", { name: "Stop" }).click();
  await page.locator("#progress", { hasText: /^Stopped after .*nothing was written/ }).waitFor({ timeout: 2000 });
  await run(page, "haptical check device.toml log.csv");
  assert.match(await page.locator("#progress").textContent(), /^Done/);
  await context.close();
});

test("a table of another maker becomes a log by a form", async () => {
  const { context, page } = await open(house.browser, house.folder);
  const rows = Array.from({ length: 50 }, (_, row) => [0.01 * row, 40 * Math.sin(row / 9), 30 * Math.cos(row / 7), 300 + row, 2 * row].join(","));
  const text = ["time,j\\1,Joint \"B\",tcp_x,<img src=x onerror=alert(1)>", ...rows].join("\n");
  await page.locator("#choose-files").setInputFiles({ name: "übung 1.csv", mimeType: "text/csv", buffer: Buffer.from(text) });
  await page.getByRole("button", { name: "Make a log of a table" }).click();
  await ended(page);
  const name = page.getByLabel("meaning of column j\\1");
  assert.equal(await name.inputValue(), "theta1_rad");
  assert.equal(await page.getByLabel("unit of column j\\1").inputValue(), "deg");
  await page.getByLabel('meaning of column Joint "B"').fill("theta2_rad");
  await page.getByLabel('unit of column Joint "B"').fill("deg");
  await page.getByLabel("meaning of column tcp_x").fill("");
  await page.getByRole("button", { name: "Make the log" }).click();
  await page.locator("#shown-name, #written li").first().waitFor();
  await ended(page);
  const words = await page.locator("#words").inputValue();
  assert.equal(await page.locator("#refusal").isVisible(), false, await page.locator("#refusal").textContent());
  assert.match(await page.locator("#folder").textContent(), /log\.csvlog/, words);
  await context.close();
});

test("a program calls the command with bytes, several at once", async () => {
  const { context, page, errors } = await open(house.browser, house.single);
  const done = await page.evaluate(async () => {
    const made = await haptical.run({ args: ["init", ".", "--example", "sockets"] });
    const args = ["identify", "--device", "arm6.urdf", "--rig", "rig.toml", "--log", "log.csv", "--out", "fit"];
    const [fit, wrong] = await Promise.all([haptical.run({ args, files: made.files }), haptical.run({ args })]);
    return { made: Object.keys(made.files), status: fit.status, stdout: fit.stdout, files: Object.keys(fit.files), bytes: fit.files["fit/identified.toml"].length, wrong };
  });
  assert.deepEqual(done.made.sort(), ["arm6.urdf", "log.csv", "rig.toml"]);
  assert.equal(done.status, 0);
  assert.match(done.stdout, /parameters identified/);
  assert.ok(done.files.includes("fit/identified.json") && !done.files.includes("log.csv"), done.files.join(" "));
  assert.ok(done.bytes > 1000);
  assert.equal(done.wrong.status, 2);
  assert.match(done.wrong.stderr, /^error: /);
  assert.deepEqual(errors, []);
  await context.close();
});

test("a file that was removed or changed can be chosen again, and an input is not overwritten", async () => {
  const { context, page, errors } = await open(house.browser, house.folder);
  const device = join(fixtures, "devices/haptic7.toml");
  await page.locator("#choose-files").setInputFiles(device);
  await page.getByRole("button", { name: "Remove haptic7.toml" }).click();
  await page.locator("#folder").waitFor({ state: "hidden" });
  await page.locator("#choose-files").setInputFiles(device);
  await page.getByRole("button", { name: "Remove haptic7.toml" }).waitFor();
  await run(page, "haptical simulate --device haptic7.toml --seconds 2 --rate-hz 50 --out ./haptic7.toml --force");
  assert.match(await page.locator("#refusal").textContent(), /is an input of this run/);
  assert.deepEqual(errors, []);
  await context.close();
});
