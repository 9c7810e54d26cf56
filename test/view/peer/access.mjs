// access.mjs http://HOST:PORT access [FOLDER]: checks the page by axe-core's rules (WCAG 2.2 A and AA, and axe's best
// practices), in each state of the page, light and dark; then checks its use by keyboard alone.

import assert from "node:assert";
import { readFileSync } from "node:fs";
import { finish, now, open, shot, until } from "./drive.mjs";

const axe = readFileSync(new URL("node_modules/axe-core/axe.min.js", import.meta.url), "utf8");

async function check(page, state) {
  await page.evaluate(axe);
  const { violations, passes } = await page.evaluate(() => axe.run({ runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] }));
  assert(passes.length > 8, `${passes.length} rules`);
  const said = violations.flatMap(({ id, nodes }) => nodes.map(({ target, any, all }) => `${id}: ${target} ${[...any, ...all].map(({ message }) => message).join("; ")}`));
  assert.deepEqual(said, [], state);
}

/** Checks that the Tab key reaches each control, and that the focused control has a name and shows its focus. */
async function check_tabs(page) {
  const seen = new Set();
  for (let i = 0; i < 90; ++i) {
    await page.keyboard.press("Tab");
    const { id, name, is_shown } = await page.evaluate(() => {
      const { activeElement: it } = document;
      const style = getComputedStyle(it);
      return {
        id: it.id || it.dataset?.layer || it.dataset?.view || it.tagName,
        name: it.getAttribute("aria-label") || it.title || it.textContent,
        is_shown: it === document.body || (style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0),
      };
    });
    if (id === "BODY") continue; // the focus has passed the last control
    seen.add(id);
    assert(name || id === "SUMMARY", `${id} has no name`);
    assert(is_shown, `${id}: the focus is not visible`);
  }
  for (const id of ["plan", "space", "both", "reset", "follow", "measure", "shot", "share", "theme", "keys", "plans", "trail", "tab-topics", "csv", "play", "speed", "timeline"]) {
    assert(seen.has(id), `${id} is not reached by the Tab key; reached: ${[...seen].join()}`);
  }
}

for (const scheme of ["light", "dark"]) {
  const page = await open(1366, 768, scheme, "");
  await until(page, () => vantage.state.has_history && document.querySelectorAll("#charts canvas").length > 3);
  await check(page, `${scheme}, as opened`);
  await page.keyboard.press("i");
  await page.locator('[data-topic="/vehicle/Q1"]').waitFor();
  await page.locator('[data-topic="/vehicle/Q1"] > summary').press("Enter");
  await page.locator('[data-field="battery_share"]').waitFor();
  await page.locator('[data-field="battery_share"]').press("Enter");
  await until(page, () => vantage.series("/vehicle/* battery_share").Q1?.t.length > 10);
  await check(page, `${scheme}, topics`);
  await shot(page, `${scheme}_topics`);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("i");
  await page.keyboard.press("?");
  await page.locator("#help[open]").waitFor();
  await check(page, `${scheme}, keys`);
  await page.keyboard.press("Escape");
  await page.evaluate(() => document.activeElement.blur());
  const [x, y] = await page.evaluate(() => vantage.pixel("robot/Q1"));
  await page.mouse.click(x, y);
  await page.locator("#inspect").waitFor();
  await check(page, `${scheme}, a robot selected`);
  await page.keyboard.press("Escape");

  // The time is a slider that the arrow keys move.
  await page.focus("#timeline");
  const before = await now(page);
  await page.keyboard.press("ArrowRight");
  await until(page, (at) => Math.abs(vantage.state.now - at - 1) < 0.05, before);
  assert.equal(await page.getAttribute("#timeline", "aria-valuenow"), (await now(page)).toFixed(1));
  await page.evaluate(() => document.activeElement.blur());
  if (scheme === "light") await check_tabs(page);
  await page.setViewportSize({ width: 768, height: 1024 });
  await check(page, `${scheme}, 768 pixels`);
  await page.close();
}
await finish();
