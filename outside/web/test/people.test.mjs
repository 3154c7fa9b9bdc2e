// Screens, keyboards, screen readers, and names that would do harm.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { built, ended, fixtures, open, run, start, written } from "./browser.mjs";

let house;
before(async () => { house = await start(); });
after(() => house.stop());

const SCREENS = [[390, 800, "light"], [390, 800, "dark"], [1300, 900, "light"], [1300, 900, "dark"]];

test("390 and 1300 pixels, light and dark: nothing is wider than the screen, and text is readable", async () => {
  const { context, page } = await open(house.browser, house.folder);
  const look = async (step) => {
    for (const [width, height, colorScheme] of SCREENS) {
      const what = `${step}, ${width} pixels, ${colorScheme}`;
      await page.setViewportSize({ width, height });
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(100);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), what);
      assert.deepEqual(await page.evaluate(lowContrast), [], what);
      if (await page.locator("#page").isVisible()) {
        const frame = page.frameLocator("#page").locator("html");
        assert.ok(await frame.evaluate((html) => html.scrollWidth <= html.clientWidth), `${what}: the page in the frame`);
      }
      await page.screenshot({ path: join(built, `${step}-${width}-${colorScheme}.png`), fullPage: true });
    }
  };
  await look("begin");
  await page.getByRole("button", { name: "a haptic arm with a gap" }).click();
  await page.locator("#shown-name", { hasText: "gap.html" }).waitFor();
  await ended(page);
  await look("answer");
  await run(page, "haptical identify --device no-such.toml --log log.csv --out fit");
  await look("refusal");
  await context.close();
});

/** Texts whose contrast with what is behind them is below 4.5 (WCAG 2.1, 1.4.3). */
function lowContrast() {
  const parts = (colour) => colour.match(/[\d.]+/g).map(Number);
  const light = (colour) => {
    const [r, g, b] = parts(colour).slice(0, 3).map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const colour = getComputedStyle(at).backgroundColor;
      if ((parts(colour)[3] ?? 1) > 0) return colour;
    }
    return "rgb(255, 255, 255)";
  };
  const found = [];
  for (const element of document.querySelectorAll("body *")) {
    const hasText = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim() !== "");
    if (!hasText || element.offsetParent === null || element.matches(":disabled")) continue;
    const [a, b] = [light(getComputedStyle(element).color), light(behind(element))].sort((x, y) => y - x);
    const contrast = (a + 0.05) / (b + 0.05);
    if (contrast < 4.5) found.push(`${element.textContent.slice(0, 30)}: ${contrast.toFixed(2)}`);
  }
  return found;
}

test("a keyboard is enough", async () => {
  const { context, page } = await open(house.browser, house.folder);
  const focused = () => page.evaluate(() => document.activeElement.textContent || document.activeElement.id);
  const reach = async (name) => {
    for (let presses = 0; presses < 40; presses += 1) {
      await page.keyboard.press("Tab");
      if ((await focused()) === name) return;
    }
    assert.fail(`${name} is not reached`);
  };
  await reach("an arm and a tracker");
  const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  assert.equal(outline, "solid", "what has the focus is seen");
  await page.keyboard.press("Enter");
  await page.locator("#shown-name", { hasText: "identify.html" }).waitFor();
  await ended(page);
  // the answer has the focus, so a screen reader begins there
  assert.equal(await focused(), "3. Answer");
  await page.locator("#words").fill("haptical verify fit");
  await page.locator("#words").press("Enter");
  await ended(page);
  assert.match(await page.locator("#printed").textContent(), /Verified: these inputs give the same bytes/);
  await context.close();
});

test("all that can be used has a name, and progress is read out", async () => {
  const { context, page } = await open(house.browser, house.folder);
  await page.getByRole("button", { name: "an arm and a tracker" }).click();
  await page.locator("#shown-name", { hasText: "identify.html" }).waitFor();
  const unnamed = await page.evaluate(() => [...document.querySelectorAll("button, input, a, iframe, select")]
    .filter((element) => element.checkVisibility())
    .filter((element) => !(element.textContent.trim() || element.ariaLabel || element.title || element.labels?.length))
    .map((element) => element.outerHTML));
  assert.deepEqual(unnamed, []);
  const levels = await page.evaluate(() => [...document.querySelectorAll("h1, h2, h3")].map((element) => Number(element.tagName[1])));
  assert.deepEqual(levels.filter((level, index) => index > 0 && level > levels[index - 1] + 1), []);
  assert.equal(await page.locator("#progress").getAttribute("aria-live"), "polite");
  assert.ok(await page.getByRole("main").isVisible());
  await context.close();
});

test("names with scripts in them are text", async () => {
  const { context, page, requests, errors } = await open(house.browser, house.folder);
  const evil = "<img src=x onerror=document.title='owned'><script>document.title='owned'</script>";
  await page.locator("#choose-files").setInputFiles(join(fixtures, "devices/haptic7.toml"));
  await run(page, "haptical simulate --device haptic7.toml --deviate 0.2 --seconds 10 --rate-hz 100 --out log.csv");
  // the same log with another name and a column of that name
  const log = await written(page, "log.csv");
  const lines = log.trimEnd().split("\n").map((line, row) => `${line},${row === 0 ? `"${evil.replaceAll('"', '""')}"` : row % 7}`);
  await page.locator("#choose-files").setInputFiles({ name: `${evil.replaceAll("/", "_")}.csv`, mimeType: "text/csv", buffer: Buffer.from(lines.join("\n")) });
  await page.locator("#folder", { hasText: "onerror" }).waitFor();
  const name = await page.evaluate(() => [...document.querySelectorAll("#folder td:first-child")].map((cell) => cell.textContent).find((text) => text.includes("onerror")));
  await run(page, `haptical diagnose --device haptic7.toml --log '${name.replaceAll("'", "'\\''")}' --out gap`);
  await page.waitForTimeout(300);
  assert.notEqual(await page.title(), "owned");
  assert.deepEqual(requests, []);
  assert.deepEqual(errors, []);
  const shown = await page.locator("#shown").isVisible();
  const refused = await page.locator("#refusal").isVisible();
  assert.ok(shown !== refused, "an answer or a refusal");
  await context.close();
});

test("a file that is no log, folders and many files are taken without harm", async () => {
  const { context, page, errors } = await open(house.browser, house.folder);
  await page.locator("#choose-folder").setInputFiles(join(fixtures, "bad"));
  await page.locator("#folder tbody tr").nth(100).waitFor();
  await run(page, "haptical identify --device device-nul-bytes.toml --log log-nul-bytes.csv --out fit");
  assert.match(await page.locator("#refusal").textContent(), /^error: /);
  assert.deepEqual(errors, []);
  await context.close();
});
