// page.mjs http://HOST:PORT log|live|proposals [FOLDER]: drives the page in headless Chromium, as a person
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

/** @param prepare called with the page before it is loaded */
async function open(width, height, scheme, draw, prepare) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
  page.setDefaultTimeout(kPatience_ms);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("requestfailed", (request) => complaints.push(`${request.url()} failed`));
  page.on("request", (request) => request.url().startsWith(url) || request.url().startsWith("data:") || complaints.push(`asks for ${request.url()}`));
  await prepare?.(page);
  await page.goto(`${url}/${draw}`);
  await page.waitForFunction(() => window.vantage?.stats().entities > 10);
  await page.evaluate(add_probes);
  return page;
}

const now = (page) => page.evaluate(() => window.vantage.state.now);
const shot = (page, name) => folder && page.screenshot({ path: `${folder}/${kind}_${name}.png` });
const until = (page, condition, argument) => page.waitForFunction(condition, argument);

/** Gives the page `picture()`: the stage as it is drawn now, and where it is in the window; and
    `proposals()`: how many are shown. */
function add_probes() {
  window.proposals = () =>
    Object.entries(vantage.stats().layers).reduce((sum, [topic, size]) => sum + (/^\/proposal\//.test(topic) ? size : 0), 0);
  window.picture = async () => {
    const next_picture = () => new Promise((resolve) => requestAnimationFrame(resolve));
    await next_picture();
    vantage.draw_again();
    await next_picture(); // what the graphics drew is there until it ends
    const canvas = document.getElementById(document.getElementById("stage").dataset.drawn === "gl" ? "world" : "names");
    const sheet = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    sheet.drawImage(canvas, 0, 0);
    return { sheet, box: canvas.getBoundingClientRect() };
  };
}

/** How many targets are green where the plan view says that they are. */
async function targets_seen() {
  const { sheet, box } = await picture();
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

/** Goes there by the bar. */
async function seek(page, since) {
  const { length_s, x, y, width, height } = await page.evaluate(() => {
    const { x, y, width, height } = document.getElementById("timeline").getBoundingClientRect();
    return { length_s: vantage.state.range[1] - vantage.state.range[0], x, y, width, height };
  });
  await page.mouse.click(x + (width * since) / length_s, y + height / 2);
  await until(page, (to) => Math.abs(vantage.state.now - to) < 0.03, since);
}

/** `count` or more; 0: none. */
const proposals_shown = (page, count) =>
  until(page, (count) => (count === 0 ? proposals() === 0 : proposals() >= count), count);

/** Each robot's colour in the world and in every chart: one, and no other robot's. */
async function colours_of(page) {
  await until(page, () => vantage.state.has_history);
  await until(page, () => // each chart is drawn; of this planner nothing is proven, so there is no gap to chart
    vantage.colours().charts.every((series, i) => Object.keys(series).length === vantage.stats().series[i]));
  const { world, charts } = await page.evaluate(() => vantage.colours());
  const robots = Object.keys(world);
  assert.equal(new Set(Object.values(world)).size, robots.length);
  for (const series of charts) {
    for (const [name, colour] of Object.entries(series)) {
      if (robots.includes(name)) assert.equal(colour, world[name], name);
      else assert(!Object.values(world).includes(colour), `${name} looks like a robot`);
    }
  }
  assert.equal(charts.filter((series) => robots.every((robot) => robot in series)).length, 2);
  return world;
}

/** The charts' numbers in another order: robot by robot, the last one first. */
const turn_history = (page) =>
  page.route("**/api/history", async (route) => {
    const records = await (await route.fetch()).json();
    records.sort(([a, at], [b, bt]) => b.localeCompare(a) || at - bt);
    await route.fulfill({ json: records });
  });

/** A team of three that proposes in the first half of each round's budget, from x.455 s on. */
async function check_proposals(page) {
  await seek(page, 4.6);
  await proposals_shown(page, 3);

  // Switched off and on they leave the picture, and are as before, in their robots' colours.
  const differs = async () => {
    const { sheet } = await picture();
    const now = sheet.getImageData(0, 0, sheet.canvas.width, sheet.canvas.height).data;
    const before = (window.seen ??= now);
    const robots = Object.values(vantage.colours().world).map((css) => css.match(/\d+/g).map(Number));
    const near = robots.map(() => 0);
    let count = 0;
    for (let i = 0; i < now.length; i += 4) {
      if ([0, 1, 2, 3].every((k) => now[i + k] === before[i + k])) continue;
      count += 1;
      robots.forEach((colour, k) => {
        const distance = Math.hypot(...[0, 1, 2].map((c) => before[i + c] - colour[c]));
        if (before[i + 3] > 150 && distance < 40) near[k] += 1;
      });
    }
    return { count, near };
  };
  assert.equal((await page.evaluate(differs)).count, 0);
  await page.click('[data-layer="proposals"]');
  await proposals_shown(page, 0);
  const { count, near } = await page.evaluate(differs);
  assert(count > 300, `${count} pixels of proposals`);
  assert(near.every((pixels) => pixels > 20), `pixels in each robot's colour: ${near}`);
  await page.keyboard.press("s");
  await proposals_shown(page, 3);
  assert.equal((await page.evaluate(differs)).count, 0);

  // Gone at the end of the round, though nothing says so; and where one goes to.
  await seek(page, 4.9);
  await proposals_shown(page, 3);
  await page.selectOption("#speed", "0.1");
  await page.keyboard.press("Space");
  await until(page, () => vantage.state.now > 4.97);
  const shown = await page.evaluate(() => proposals());
  assert(shown >= 3 || (await now(page)) >= 5, `${shown} shown`);
  await until(page, () => vantage.state.now >= 5 && proposals() === 0);
  assert((await now(page)) < 5.4);
  await page.keyboard.press("Space");
  await until(page, () => !vantage.state.is_playing);
  await seek(page, 3.8);
  await proposals_shown(page, 1);
  await seek(page, 0.3); // before any
  await proposals_shown(page, 0);
  await seek(page, 3.8);
  await proposals_shown(page, 1);
  await seek(page, 5.2);
  await proposals_shown(page, 0);
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

if (kind === "proposals") {
  const known = [];
  for (const [scheme, draw, prepare] of [
    ["light", "?draw=canvas", null],
    ["dark", "?draw=gl", turn_history],
  ]) {
    const page = await open(1920, 1080, scheme, draw, prepare);
    known.push(await colours_of(page));
    await check_proposals(page);
    known.push(await colours_of(page));
    await page.close();
  }
  known.forEach((colours) => assert.deepEqual(colours, known[0]));
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
    if (kind !== "proposals") {
      await check_toggles(page);
      await check_inspection(page);
    }
  }
  if (kind === "proposals") {
    await seek(page, 4.6); // once in 768 pixels it is a finger's work
    await proposals_shown(page, 3);
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
