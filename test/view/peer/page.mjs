// page.mjs http://HOST:PORT log|live [FOLDER]: drives the page in headless Chromium, as a person
// would; fails on any error in its console. Leaves screenshots in FOLDER.

import assert from "node:assert";
import { chromium } from "playwright-core";

const [url, kind, folder] = process.argv.slice(2);
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const kPatience_ms = 60_000;

const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const complaints = [];

async function open(width, height, scheme, draw) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
  page.setDefaultTimeout(kPatience_ms);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("requestfailed", (request) => complaints.push(`${request.url()} failed`));
  page.on("request", (request) => request.url().startsWith(url) || request.url().startsWith("data:") || complaints.push(`asks for ${request.url()}`));
  await page.goto(`${url}/${draw}`);
  await page.waitForFunction(() => window.vantage?.stats().entities > 10);
  return page;
}

const now = (page) => page.evaluate(() => window.vantage.state.now);
const shot = (page, name) => folder && page.screenshot({ path: `${folder}/${kind}_${name}.png` });
const until = (page, condition, argument) => page.waitForFunction(condition, argument);

/** How many targets are green where the plan view says that they are. */
async function targets_seen() {
  const next_picture = () => new Promise((resolve) => requestAnimationFrame(resolve));
  await next_picture();
  vantage.draw_again();
  await next_picture(); // what the graphics drew is there until it ends
  const canvas = document.getElementById(document.getElementById("stage").dataset.drawn === "gl" ? "world" : "names");
  const sheet = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
  sheet.drawImage(canvas, 0, 0);
  const box = canvas.getBoundingClientRect();
  return ["R1", "R2", "R3", "R4", "R5"].filter((name) => {
    const at = vantage.pixel(`target/${name}`);
    if (at === null) return false;
    const [x, y] = at;
    const [r, g, b] = sheet.getImageData(x - box.left, y - box.top + 3, 1, 1).data;
    return g > r + 60 && g > b + 30;
  }).length;
}

async function check_log(page) {
  assert.equal(await page.locator("#link").textContent(), "log");
  await until(page, () => window.vantage.stats().series.every((count) => count > 0));

  // Plays, and pauses where it is told to.
  await page.click("#play");
  await until(page, () => window.vantage.state.now > 1 && window.vantage.state.is_playing);
  await page.keyboard.press("Space");
  await until(page, () => !window.vantage.state.is_playing);
  const held = await now(page);
  const where = await page.evaluate(() => window.vantage.position("robot/Q1"));

  // Seeks by the bar, by keys and by an event; the scene follows.
  const bar = await page.locator("#timeline").boundingBox();
  await page.mouse.click(bar.x + bar.width * 0.75, bar.y + bar.height / 2);
  await until(page, () => Math.abs(window.vantage.state.now - 45) < 1);
  await until(page, (x) => Math.abs(window.vantage.position("robot/Q1")[0] - x) > 0.01, where[0]);
  await page.keyboard.press("ArrowLeft");
  await until(page, () => Math.abs(window.vantage.state.now - 44) < 1);
  await page.keyboard.press("Home");
  await until(page, () => window.vantage.state.now < 0.1);
  assert(held > 1);

  // Goes as fast as it is told.
  await page.selectOption("#speed", "10");
  await page.keyboard.press("Space");
  await until(page, () => window.vantage.state.now > 20);
  await page.keyboard.press("Space");
  await until(page, () => !window.vantage.state.is_playing);
}

async function check_toggles(page) {
  // Of the plans alone: what else is shown comes and goes while robots fly.
  const plans_shown = (is_wanted) =>
    until(page, (wanted) => {
      const layers = Object.entries(window.vantage.stats().layers);
      return layers.some(([topic, size]) => /^\/plan\/[^/]+$/.test(topic) && size > 0) === wanted;
    }, is_wanted);
  await plans_shown(true);
  await page.click('[data-layer="plans"]');
  await plans_shown(false);
  assert.equal(await page.getAttribute('[data-layer="plans"]', "aria-pressed"), "false");
  await page.keyboard.press("p");
  await plans_shown(true);
  const theme = await page.evaluate(() => document.documentElement.dataset.theme);
  await page.keyboard.press("d");
  assert.notEqual(await page.evaluate(() => document.documentElement.dataset.theme), theme);
  await page.keyboard.press("d");
  await page.keyboard.press("?");
  assert(await page.locator("#help").isVisible());
  await page.keyboard.press("Escape");
  await page.locator("#help").waitFor({ state: "hidden" });
}

async function check_inspection(page) {
  await page.keyboard.press("1");
  await until(page, () => document.getElementById("stage").dataset.view === "plan");
  await until(page, () => window.vantage.pixel("robot/Q2") !== null);
  const spot = await page.evaluate(() => window.vantage.pixel("robot/Q2"));
  await page.mouse.click(spot[0], spot[1]);
  await page.locator("#inspect").waitFor();
  const text = await page.locator("#inspect").textContent();
  assert.match(text, /robot\/Q2/);
  assert.match(text, /lower bound/);
  await shot(page, "inspect");
  await page.keyboard.press("Escape");
  await page.locator("#inspect").waitFor({ state: "hidden" });
  await page.keyboard.press("3");
}

// Here a processor draws the graphics, so that the page paints unless it is told not to.
for (const [width, height, scheme, name, draw] of [
  [1920, 1080, "light", "1080p_light", ""],
  [1920, 1080, "dark", "1080p_dark", ""],
  [768, 1024, "light", "768", ""],
  [768, 1024, "dark", "768_dark", "?draw=canvas"],
  [1280, 800, "light", "gl", "?draw=gl"],
]) {
  const page = await open(width, height, scheme, draw);
  const drawn = await page.evaluate(() => document.getElementById("stage").dataset.drawn);
  assert.equal(drawn, draw === "?draw=gl" ? "gl" : "flat");
  if (name === "1080p_light") {
    if (kind === "log") await check_log(page);
    await check_toggles(page);
    await check_inspection(page);
  }
  await page.waitForTimeout(kind === "live" ? 8000 : 1500); // for the picture: charts with something in them
  // Live, none may be known yet.
  await page.waitForFunction(targets_seen, null, { timeout: 30000 }).catch((error) => {
    throw new Error(`${name}: no target in the picture`, { cause: error });
  });
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert(overflow <= 0, `${name}: ${overflow} px too wide`);
  await shot(page, name);
  if (width < 1000 && folder) {
    await page.screenshot({ path: `${folder}/${kind}_${name}_whole.png`, fullPage: true });
  }
  await page.close();
}
await browser.close();
assert.deepEqual([...new Set(complaints)], []);
console.log("ok");
