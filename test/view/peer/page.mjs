// page.mjs http://HOST:PORT log|live|proposals [FOLDER]: uses the page in headless Chromium as a person would; fails
// on any error in its console. Writes screenshots to FOLDER.

import assert from "node:assert";
import { readFileSync } from "node:fs";
import { finish, folder, kind, now, open as open_page, shot, until, url } from "./drive.mjs";

const look = JSON.parse(readFileSync(new URL("../../../logs/appearance/appearance.json", import.meta.url)));

async function open(...how) {
  const page = await open_page(...how);
  await page.evaluate(add_probes);
  return page;
}

/** Adds two functions to the page: `picture()` returns the current pixels of the stage and its position in the
    window; `proposals()` returns the number of shown proposals. */
function add_probes() {
  window.proposals = () =>
    Object.entries(vantage.stats().layers).reduce((sum, [topic, size]) => sum + (/^\/proposal\//.test(topic) ? size : 0), 0);
  window.picture = async () => {
    const next_picture = () => new Promise((resolve) => requestAnimationFrame(resolve));
    await next_picture();
    vantage.draw_again();
    await next_picture(); // the drawn pixels are readable until this frame ends
    const canvas = document.getElementById(document.getElementById("stage").dataset.drawn === "gl" ? "world" : "names");
    const sheet = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    sheet.drawImage(canvas, 0, 0);
    return { sheet, box: canvas.getBoundingClientRect() };
  };
}

/** Returns the number of targets that have their own colour at the position where the plan view draws them. */
async function targets_seen(paints) {
  const { sheet, box } = await picture();
  const truths = paints.map((paint) => paint[document.documentElement.dataset.theme].match(/\w\w/g).map((c) => parseInt(c, 16)));
  return ["R1", "R2", "R3", "R4", "R5"].filter((name, i) => {
    const at = vantage.pixel(`target/${name}`);
    if (at === null) return false;
    const [x, y] = at;
    const seen = sheet.getImageData(x - box.left, y - box.top + 3, 1, 1).data;
    // Drawn with lighting, a side is darker than its colour in the table.
    return truths[i].every((c, k) => Math.abs(c - seen[k]) < 60);
  }).length;
}

/** Returns the history's discoveries as {name: [since, robot]}. */
async function discoveries(page) {
  const start = await page.evaluate(() => vantage.state.start);
  const history = await (await fetch(`${url}/api/history`)).json();
  return Object.fromEntries(history.filter(([topic, , { name }]) => topic === "/events" && name === "found")
    .map(([, utime, { message }]) => [message.split(" ")[0], [utime * 1e-6 - start, message.split(" ").at(-1)]]));
}

/** After a jump in the log, checks the strip and the table of the result, and the line that marks the present in the
    list of events. */
async function check_result(page) {
  const fact = (key) => page.locator(`[data-fact="${key}"]`).innerText();
  await page.evaluate(() => vantage.seek_and_wait(40));
  await until(page, () => /^5 of 5 targets/.test(document.querySelector('[data-fact="found"]')?.innerText));
  const start = await page.evaluate(() => vantage.state.start);
  const team = (await (await fetch(`${url}/api/history`)).json())
    .filter(([topic, utime]) => topic === "/team" && utime * 1e-6 - start <= 40).at(-1)[2];
  await until(page, (rounds) => document.querySelector('[data-fact="late"]')?.innerText === rounds, `${team.rounds_late} of ${team.rounds} rounds late`);
  assert.equal(await fact("rmse"), `${team.rmse_m.toFixed(2)} m RMSE`);
  assert.equal(await fact("collisions"), `${team.collisions} collisions`);
  const found = await discoveries(page);
  assert.deepEqual(Object.keys(found).sort(), ["R1", "R2", "R3", "R4", "R5"]);
  for (const [name, [since, robot]] of Object.entries(found)) {
    const row = (await page.locator(`#targets [data-key="${name}"]`).innerText()).split("\n");
    assert.equal(row[1], `${since.toFixed(1)} s by ${robot}`);
    assert.match(row[2], /^\d\.\d\d m$/);
    assert.match(row[4], /^\d+\.?\d* s ago, Q[123]$/);
  }
  // Events above the line of the present are later, those below are earlier.
  const list = await page.evaluate(() => [...document.querySelectorAll("#events li")].map((item) => (item.className === "present" ? "now" : parseFloat(item.innerText))));
  assert(list.includes("now"), list.join());
  const at = list.indexOf("now");
  assert(list.slice(0, at).every((since) => since > 40) && list.slice(at + 1).every((since) => since <= 40), list.join());
  // Discoveries are marks in the first lane, and the bar has labelled ticks.
  assert.equal(await page.locator('#marks [data-kind="found"]').count(), 5);
  assert((await page.locator("#ticks span").count()) >= 6);
  assert.equal(await page.locator("#lanes span").count(), 4);
  // All processes without a problem share one line.
  assert.match(await page.locator("#processes .fold").innerText(), /^\d+ running$/);
  assert.equal(await page.locator("#processes .row:visible").count(), 0);
  // A target has one name in the plan: at its true position.
  const names = await page.evaluate(() => { vantage.draw_again(); return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(vantage.labels()[0].length)))); });
  assert.equal(names, 8, "three robots and five targets");
  await page.evaluate(() => vantage.seek_and_wait(4));
}

async function check_log(page) {
  assert.equal(await page.locator("#link").textContent(), "log lab.lcmlog");
  const of_tracking = ["entropy", "rmse", "nees", "margin", "deadlines", "latency", "gap", "battery", "lost"];
  await until(page, (keys) => keys.every((key) => Object.keys(vantage.series(key)).length > 0), of_tracking);
  // Charts that cannot vary are hidden: in this log all plans are ready equally early, and no message is lost.
  const varying = of_tracking.filter((key) => !["margin", "deadlines", "latency", "lost"].includes(key));
  assert.deepEqual((await page.evaluate(() => vantage.charts())).map(({ key }) => key), varying);
  await check_result(page);

  // The page opens at a time at which robots are visible, not at an empty scene.
  const first = await now(page);
  assert(first > 0.5 && first < 10, `opened at ${first} s`);
  await until(page, (topics) => topics.every((topic) => vantage.stats().layers[topic] > 0),
    ["/robots", "/estimates", "/plan/Q1", "/plan/Q2", "/plan/Q3", "/trails"]);

  // The log plays, and pauses on a key.
  await page.click("#play");
  await until(page, () => window.vantage.state.now > 1 && window.vantage.state.is_playing);
  await page.keyboard.press("Space");
  await until(page, () => !window.vantage.state.is_playing);
  const held = await now(page);
  const where = await page.evaluate(() => window.vantage.position("robot/Q1"));

  // The time can be changed by the bar, by keys and by an event; the scene follows.
  const bar = await page.locator("#timeline").boundingBox();
  await page.mouse.click(bar.x + bar.width * 0.75, bar.y + bar.height / 2);
  await until(page, () => Math.abs(window.vantage.state.now - 45) < 1);
  await until(page, (x) => Math.abs(window.vantage.position("robot/Q1")[0] - x) > 0.01, where[0]);
  await page.keyboard.press("ArrowLeft");
  await until(page, () => Math.abs(window.vantage.state.now - 44) < 1);
  const [before_s, date] = await page.evaluate(() => [vantage.state.now, document.getElementById("clock").title]);
  assert.equal(date.slice(0, 21), new Date(1e3 * (await page.evaluate(() => vantage.state.start + vantage.state.now))).toISOString().replace("T", " ").slice(0, 21));
  await page.keyboard.press(",");
  await until(page, (at) => Math.abs(at - 0.1 - vantage.state.now) < 1e-3, before_s);
  await page.keyboard.press(".");
  await until(page, (at) => Math.abs(at - vantage.state.now) < 1e-3, before_s);
  await page.keyboard.press("Home");
  await until(page, () => window.vantage.state.now < 0.1);
  assert(held > 1);

  // Events can be filtered by their text.
  const shown = () => page.evaluate(() => [...document.querySelectorAll("#events .event")].filter((item) => item.checkVisibility()).map(({ textContent }) => textContent));
  const all = await shown();
  assert(all.some((text) => /Q1/.test(text)) && all.some((text) => !/Q1/.test(text)), all.join());
  await page.fill("#events-filter", "q1");
  assert.deepEqual(await shown(), all.filter((text) => /Q1/.test(text)));
  await page.fill("#events-filter", "");
  assert.deepEqual(await shown(), all);
  await page.evaluate(() => document.activeElement.blur());

  // The log plays at the selected speed.
  await page.selectOption("#speed", "10");
  await page.keyboard.press("Space");
  await until(page, () => window.vantage.state.now > 20);
  await page.keyboard.press("Space");
  await until(page, () => !window.vantage.state.is_playing);
}

/** Seeks by the bar and waits for the data of that time, since data of another time may still arrive before. */
async function seek(page, since) {
  const { length_s, x, y, width, height } = await page.evaluate(() => {
    const { x, y, width, height } = document.getElementById("timeline").getBoundingClientRect();
    return { length_s: vantage.state.range[1] - vantage.state.range[0], x, y, width, height };
  });
  await page.evaluate(() => (vantage.state.arrived = null));
  await page.mouse.click(x + (width * since) / length_s, y + height / 2);
  await until(page, (to) => Math.abs(vantage.state.arrived - vantage.state.start - to) < 0.03, since);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

/** Waits until at least `count` proposals are shown; 0: none. */
const proposals_shown = (page, count) =>
  until(page, (count) => (count === 0 ? proposals() === 0 : proposals() >= count), count);

/** Returns each robot's colour. Checks that the world and every chart show the robot in its colour, and that nothing
    else has this colour. */
async function colours_of(page) {
  await until(page, () => vantage.state.has_history);
  await until(page, () => // each chart is drawn; this planner proves no bound, so the gap has no chart
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
  assert(charts.filter((series) => robots.every((robot) => robot in series)).length >= 1);
  return world;
}

/** Reverses the order of the charts' records: robot by robot, the last robot first. */
const turn_history = (page) =>
  page.route("**/api/history", async (route) => {
    const records = await (await route.fetch()).json();
    records.sort(([a, at], [b, bt]) => b.localeCompare(a) || at - bt);
    await route.fulfill({ json: records });
  });

/** Checks the proposals of a team of three. They are published from 0.455 s after each full second of the log, in the
    first half of each round's budget. */
async function check_proposals(page) {
  await seek(page, 4.6);
  await proposals_shown(page, 3);

  // Proposals that are switched off disappear from the picture. Switched on again, they are unchanged and have their
  // robots' colours.
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
  // A robot that proposes its present plan draws both at the same position, so only two colours are required.
  assert(near.filter((pixels) => pixels > 20).length >= 2, `pixels in each robot's colour: ${near}`);
  await page.keyboard.press("s");
  await proposals_shown(page, 3);
  assert.equal((await page.evaluate(differs)).count, 0);

  // Proposals disappear at the end of the round without a message, also after a seek.
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
  await seek(page, 0.3); // before the first proposal
  await proposals_shown(page, 0);
  await seek(page, 3.8);
  await proposals_shown(page, 1);
  await seek(page, 5.2);
  await proposals_shown(page, 0);
}

const overlaps = (boxes) =>
  boxes.flatMap((a, i) => boxes.slice(0, i).filter((b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom));

/** Checks labels, grid, scale, the ruler, and the camera that follows a robot. */
async function check_stage(page) {
  await page.keyboard.press("1");
  await page.keyboard.press("r");
  await until(page, () => document.getElementById("stage").dataset.view === "plan");
  await seek(page, 30);
  await page.evaluate(() => picture());
  for (const names of await page.evaluate(() => vantage.labels())) {
    assert(names.length >= 8, `${names.length} names`);
    assert.deepEqual(overlaps(names), []);
  }

  // Labels are complete in each view, also after another view was drawn.
  const ascents = async (view) => {
    await page.keyboard.press(view); // redraws all labels
    await page.evaluate(() => picture());
    return Object.fromEntries(await page.evaluate(() => vantage.ascents()));
  };
  const [in_space, in_plan] = [await ascents("2"), await ascents("1")];
  const common = Object.keys(in_space).filter((key) => key in in_plan);
  assert(common.length > 0);
  common.forEach((key) => assert.equal(in_space[key], in_plan[key], key));

  // The ruler from a target to a robot shows the distance between them.
  const [target, robot] = await page.evaluate(() => ["target/R1", "robot/Q1"].map((id) => ({ at: vantage.position(id), pixel: vantage.pixel(id) })));
  await page.keyboard.press("l");
  await page.mouse.click(...target.pixel);
  await page.mouse.move(...robot.pixel);
  await page.mouse.click(...robot.pixel);
  const measured = await page.evaluate(() => vantage.measured());
  assert.deepEqual(measured.map(([x, y]) => [x.toFixed(3), y.toFixed(3)]), [target, robot].map(({ at: [x, y] }) => [x.toFixed(3), y.toFixed(3)]));
  // A ruler as long as the scale bar, on bare ground, shows one metre.
  await page.keyboard.press("l");
  await page.keyboard.press("l");
  const scale = await page.evaluate(() => vantage.scale());
  const box = await page.locator("#plan-area").boundingBox();
  const [x, y] = [box.x + 60, box.y + 40];
  await page.mouse.click(x, y);
  await page.mouse.click(x + scale, y);
  const [from, to] = await page.evaluate(() => vantage.measured());
  assert(Math.abs(to[0] - from[0] - 1) < 0.02 && Math.abs(to[1] - from[1]) < 0.02, `${from} to ${to}`);
  await shot(page, "measure");
  await page.keyboard.press("Escape");
  assert.deepEqual(await page.evaluate(() => vantage.measured()), []);

  // The camera follows a robot, and stays in place when following is switched off.
  await page.mouse.click(...robot.pixel);
  await page.locator("#inspect").waitFor();
  await page.keyboard.press("c");
  assert.equal(await page.evaluate(() => vantage.followed()), "robot/Q1");
  const above = () => page.evaluate(() => vantage.cameras().slice(0, 2));
  for (const since of [35, 40]) {
    await seek(page, since);
    await until(page, () => vantage.cameras().slice(0, 2).every((x, i) => Math.abs(x - vantage.position("robot/Q1")[i]) < 0.01));
  }
  await page.keyboard.press("c");
  const kept = await above();
  await seek(page, 50);
  assert.deepEqual(await above(), kept);
  await page.keyboard.press("Escape");

  // The length of the trails can be selected.
  await page.selectOption("#trail", "2");
  await until(page, () => vantage.trail("Q1") <= 14);
  const short = await page.evaluate(() => vantage.trail("Q1"));
  await page.selectOption("#trail", "20");
  const long = await page.evaluate(() => vantage.trail("Q1"));
  assert(short > 2 && long > 5 * short, `trails of ${short} and ${long} points`);
  await page.keyboard.press("r");
  await page.keyboard.press("3");
}

/** Checks that the cursor shows the log's values; also zooming, a chart of a topic's field, and CSV export. */
async function check_charts(page) {
  const of_chart = (key) => page.locator(`[data-chart="${key}"] .u-over`);
  await of_chart("entropy").waitFor();
  await page.evaluate(() => vantage.draw_again());
  const box = await of_chart("entropy").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const read = page.locator('[data-chart="entropy"] .read');
  await read.waitFor();
  const [time, value, of_robot] = (await read.innerText()).split("\n").map((line) => parseFloat(line.match(/-?[\d.]+/)[0]));
  assert(Math.abs(time - 30) < 1, `${time} s`);
  const history = await (await fetch(`${url}/api/history`)).json();
  const start = await page.evaluate(() => vantage.state.start);
  const told = history.filter(([topic, utime]) => topic === "/team" && utime * 1e-6 - start <= time + 0.006).at(-1)[2];
  assert(Math.abs(value - told.entropy_nats) < 0.006, `${value} for ${told.entropy_nats}`);
  assert(Math.abs(of_robot - told.robot_entropy_nats) < 0.006, `${of_robot} for ${told.robot_entropy_nats}`);
  const of_both = history.filter(([topic, , { robot_entropy_nats }]) => topic === "/team" && robot_entropy_nats !== undefined).map(([, , { entropy_nats, robot_entropy_nats }]) => robot_entropy_nats - entropy_nats);
  assert(of_both.length > 100 && of_both.every((more) => more > -1e-9) && of_both.some((more) => more > 0.1), "a robot has less entropy than the team");
  // The cursor also shows the value of each robot in all other charts.
  assert.match(await page.locator('[data-chart="battery"] .read').innerText(), /Q1 9\d.*%\nQ2 9\d.*%\nQ3 9\d/);
  await shot(page, "cursor");

  // The wheel zooms all charts, the time bar shows the window, and dragging moves it.
  const windows = () => page.evaluate(() => vantage.charts().map(({ window }) => window));
  await page.mouse.wheel(0, -600);
  await until(page, () => !document.getElementById("span").hidden);
  const zoomed = await windows();
  assert(zoomed.every(([from, to]) => to - from < 30 && Math.abs((from + to) / 2 - 30) < 2), JSON.stringify(zoomed));
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 4, box.y + box.height / 2, { steps: 4 });
  await page.mouse.up();
  assert((await windows())[0][0] > zoomed[0][0] + 2);
  const rows = (await page.evaluate(() => vantage.csv())).trim().split("\n");
  assert.match(rows[0], /^time \[s\],entropy per target \[nat\] team,/);
  const [low, high] = (await windows())[0];
  assert(rows.length > 10 && rows.slice(1).every((row) => parseFloat(row) >= low && parseFloat(row) <= high));
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#csv")]);
  assert.match(download.suggestedFilename(), /^vantage_lab_[\d.]+s\.csv$/);
  await page.keyboard.press("z");
  await until(page, () => document.getElementById("span").hidden);
  assert.deepEqual((await windows())[0], [0, await page.evaluate(() => vantage.state.range[1] - vantage.state.range[0])]);

  // A click in a chart seeks to that time.
  await page.mouse.click(box.x + box.width * 0.25, box.y + box.height / 2);
  await until(page, () => Math.abs(vantage.state.now - 15) < 1);

  // The list shows every topic, its rate while the log plays and its newest message; its fields can be charted.
  await page.keyboard.press("i");
  const topic = (name) => page.locator(`[data-topic="${name}"]`);
  await topic("/vehicle/Q1").waitFor();
  await page.fill("#topics input", "vehicle");
  await topic("/team").waitFor({ state: "hidden" });
  await page.click('[data-topic="/vehicle/Q1"] > summary');
  await page.locator('[data-field="battery_share"]').waitFor();
  await page.keyboard.press("Escape");
  await page.click("#play");
  await until(page, () => /\d Hz/.test(document.querySelector('[data-topic="/vehicle/Q1"] summary').innerText));
  await page.click("#play");
  for (const robot of ["Q1", "Q2"]) {
    if (robot === "Q2") await page.click('[data-topic="/vehicle/Q2"] > summary');
    await page.click(`[data-topic="/vehicle/${robot}"] [data-field="plan_round"]`);
  }
  await until(page, () => Object.keys(vantage.series("/vehicle/* plan_round")).join() === "Q1,Q2");
  const rounds = await page.evaluate(() => vantage.series("/vehicle/* plan_round").Q1);
  assert(rounds.t.length > 100 && rounds.v.at(-1) - rounds.v[0] >= 50, "the chart does not cover the complete log");
  // Fields of raw bus messages can also be charted.
  await page.fill("#topics input", "/lcm/plan_q1");
  await page.click('[data-topic="/lcm/PLAN_Q1"] > summary');
  await page.click('[data-topic="/lcm/PLAN_Q1"] [data-field="nodes"]');
  await until(page, () => vantage.series("/lcm/PLAN_* nodes").Q1?.t.length > 50);
  await shot(page, "topics");
  await page.locator('[data-chart="/lcm/PLAN_* nodes"] figcaption button').click();
  await page.locator('[data-chart="/lcm/PLAN_* nodes"]').waitFor({ state: "detached" });
  await page.fill("#topics input", "");
  await page.keyboard.press("Escape");
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("i");
  await page.locator("#status").waitFor();
}

/** Checks the histogram of the times by which plans were ready before their deadlines. */
async function check_histogram(page) {
  const history = await (await fetch(`${url}/api/history`)).json();
  const start = await page.evaluate(() => vantage.state.start);
  const margins_ms = history.filter(([topic, , { margin_s }]) => /^\/plan\/[^/]+\/status$/.test(topic) && Number.isFinite(margin_s))
    .map(([, utime, { margin_s }]) => [utime * 1e-6 - start, 1e3 * margin_s]);
  const counted = () => page.evaluate(() => vantage.histogram("deadlines"));
  const expect = async (from, to) => {
    const inside = margins_ms.filter(([since]) => since >= from && since <= to).map(([, margin]) => margin);
    const { width, starts, counts } = await counted();
    assert.deepEqual(counts, starts.map((at) => inside.filter((margin) => Math.floor(margin / width) === Math.round(at / width)).length));
    assert.equal(counts.reduce((sum, count) => sum + count, 0), inside.length);
    assert(starts.length > 5 && starts.length < 60, `${starts.length} bins`);
    return inside.length;
  };
  await page.selectOption("#hidden-charts", "deadlines");
  await page.locator('[data-chart="deadlines"] .u-over').scrollIntoViewIfNeeded();
  const all = await expect(0, Infinity);
  await page.evaluate(() => vantage.zoom(10, 20));
  await until(page, (all) => vantage.histogram("deadlines").counts.reduce((sum, count) => sum + count, 0) < all, all);
  await expect(10, 20);
  const { starts, width, counts } = await counted();
  const box = await page.locator('[data-chart="deadlines"] .u-over').boundingBox();
  const most = counts.indexOf(Math.max(...counts));
  await page.mouse.move(box.x + (box.width * (most + 0.5)) / starts.length, box.y + box.height / 2);
  await until(page, (count) => document.querySelector('[data-chart="deadlines"] .read').textContent.endsWith(`ms: ${count}`), counts[most]);
  assert(width > 0);
  await page.keyboard.press("z");
}

/** Checks the latency from a measurement to the set-points of the plan that used it: one value for each followed
    plan, less than two rounds. */
async function check_latency(page) {
  const latencies = await page.evaluate(() => vantage.series("latency"));
  assert.deepEqual(Object.keys(latencies).sort(), ["Q1", "Q2", "Q3"]);
  const look = JSON.parse(await page.evaluate(async () => JSON.stringify(await (await fetch("api/series?topic=/vehicle/Q1&field=/capture_to_setpoint_s")).json())));
  assert(latencies.Q1.v.length > 50, `${latencies.Q1.v.length} rounds`);
  const all = new Set(look.map(([, value]) => (1e3 * value).toFixed(3)));
  assert(latencies.Q1.v.every((ms) => ms > 0 && ms < 2000 && all.has(ms.toFixed(3))), "differs from the vehicle's topic");
}

/** Checks NEES by the time for which a target was unseen: the means over the shown interval, and bands from means
    over 5 s. */
async function check_ages(page) {
  const history = await (await fetch(`${url}/api/history`)).json();
  const start = await page.evaluate(() => vantage.state.start);
  const steps = history.filter(([topic]) => topic === "/team").map(([, utime, { nees_by_age }]) => [utime * 1e-6 - start, nees_by_age ?? []]);
  assert.equal(history.find(([, , { nees_expected }]) => nees_expected)[2].nees_expected, 2);
  const kT = { 1: 12.706, 11: 2.201, 12: 2.179 }; // Student's t, two-sided 95 %, from a table
  const expect = async (from, to, batches) => {
    const classes = await page.evaluate(() => vantage.ages("nees"));
    assert(classes.length >= 2, `${classes.length} classes`);
    let compared = 0;
    for (const { age, samples, mean, half } of classes) {
      const inside = steps.filter(([since]) => since >= from && since <= to)
        .flatMap(([since, by_age]) => by_age.filter(({ age_s }) => age_s === age).map((each) => ({ since, ...each })));
      const sum = (of, take) => of.reduce((all, each) => all + take(each), 0);
      const count = sum(inside, (each) => each.samples);
      assert.equal(samples, count);
      const expected = sum(inside, (each) => each.samples * each.mean) / count;
      assert(Math.abs(mean - expected) < 1e-9 * expected, `${mean} for ${expected}`);
      const parts = new Map();
      inside.forEach((each) => parts.set(Math.floor(each.since / 5), [...(parts.get(Math.floor(each.since / 5)) ?? []), each]));
      if (parts.size === 1) assert.equal(half, null);
      if (!(parts.size - 1 in kT)) continue;
      const of_parts = [...parts.values()].map((part) => sum(part, (each) => each.samples * (each.mean - expected)));
      const band = kT[parts.size - 1] * Math.sqrt((sum(of_parts, (x) => x * x) * parts.size) / (parts.size - 1)) / count;
      assert(Math.abs(half - band) < 1e-3 * band, `${half} for ${band}`);
      compared += 1;
    }
    assert(compared > 0, "no band was compared");
    return classes;
  };
  await page.locator('[data-chart="nees"] .u-over').scrollIntoViewIfNeeded();
  const [first] = await expect(0, Infinity);
  const box = await page.locator('[data-chart="nees"] .u-over').boundingBox();
  const { length } = await page.evaluate(() => vantage.ages("nees"));
  await page.mouse.move(box.x + (box.width * 0.5) / length, box.y + box.height / 2);
  await until(page, (samples) => document.querySelector('[data-chart="nees"] .read').textContent.startsWith("unseen for 0–1 s: mean ") && document.querySelector('[data-chart="nees"] .read').textContent.endsWith(`, ${samples} samples`), first.samples);
  await page.evaluate(() => vantage.zoom(11, 19));
  await expect(11, 19);
  await page.keyboard.press("z");
}

/** Checks that a named layout restores closed charts, charted fields, cameras and layers, but not the time. */
async function check_layouts(page) {
  const shown = () => page.evaluate(() => vantage.charts().map(({ key }) => key));
  await page.click('[data-chart="battery"] figcaption button');
  await page.locator('[data-chart="battery"]').waitFor({ state: "hidden" });
  await page.keyboard.press("1");
  await page.keyboard.press("g"); // switches the map off
  await page.keyboard.press("n");
  await page.fill("#layouts input", "plan only");
  await page.keyboard.press("Enter");
  await page.locator('[data-layout="plan only"]').waitFor();
  await page.keyboard.press("Escape");
  const kept = await shown();
  assert(!kept.includes("battery"));
  await page.keyboard.press("3");
  await page.keyboard.press("g");
  await page.selectOption("#hidden-charts", "battery");
  assert((await shown()).includes("battery"));
  await seek(page, 12);
  await page.keyboard.press("n");
  // A link that is made while values are being loaded contains their fields, too.
  const held = [];
  let have_both;
  const both = new Promise((resolve) => (have_both = resolve));
  await page.route("**/api/series?*", (route) => held.push(route) === 2 && have_both());
  await page.click('[data-layout="plan only"]');
  await page.evaluate(() => {
    history.replaceState(null, "", location.pathname);
    document.getElementById("share").click();
  });
  assert(["Q1", "Q2"].every((robot) => page.url().includes(`${robot}%7Eplan_round`)), page.url());
  await both;
  await Promise.all(held.map((route) => route.continue()));
  await page.unroute("**/api/series?*");
  await until(page, () => document.getElementById("stage").dataset.view === "plan");
  await until(page, (keys) => vantage.charts().map(({ key }) => key).join() === keys, kept.join());
  assert.equal(await page.getAttribute('[data-layer="map"]', "aria-pressed"), "false");
  assert(Math.abs((await now(page)) - 12) < 0.1);
  // The browser stores the layout; a link also lists the closed charts.
  await until(page, () => /without=battery/.test(location.href) && /plan_round/.test(location.href));
  await page.reload();
  await until(page, () => window.vantage?.stats().entities > 10 && vantage.state.pending_link === null);
  await until(page, (keys) => vantage.charts().map(({ key }) => key).join() === keys, kept.join());
  await page.evaluate(add_probes);
  await page.keyboard.press("n");
  await page.locator('[data-layout="plan only"]').waitFor();
  await shot(page, "layouts");
  await page.click('[aria-label="Forget plan only"]');
  await page.locator('[data-layout="plan only"]').waitFor({ state: "detached" });
  await page.keyboard.press("Escape");
  await page.selectOption("#hidden-charts", "battery");
  await page.keyboard.press("g");
  await page.keyboard.press("3");
}

/** Checks that a page opened by a link shows the same as the page that made the link. */
async function check_link(page) {
  await page.keyboard.press("3");
  await page.keyboard.press("b"); // switches beliefs on
  await page.keyboard.press("f"); // switches views off
  await page.selectOption("#trail", "5");
  await seek(page, 41);
  const area = await page.locator("#space-area").boundingBox();
  await page.mouse.move(area.x + area.width / 2, area.y + area.height / 2);
  await page.mouse.down();
  await page.mouse.move(area.x + area.width / 2 + 80, area.y + area.height / 2 + 30, { steps: 5 });
  await page.mouse.up();
  await page.locator('[data-chart="entropy"] .u-over').scrollIntoViewIfNeeded();
  const chart = await page.locator('[data-chart="entropy"] .u-over').boundingBox();
  await page.mouse.move(chart.x + chart.width / 2, chart.y + chart.height / 2);
  await page.mouse.wheel(0, -500);
  await until(page, () => vantage.charts()[0].window[0] > 0);
  await page.click("#share");
  await until(page, () => ["Q1", "Q2"].every((robot) => location.href.includes(`${robot}%7Eplan_round`)) && /win=/.test(location.href));
  const facts = (of) =>
    of.evaluate(() => ({
      now: vantage.state.now.toFixed(1),
      cameras: vantage.cameras().map((x) => x.toFixed(2)),
      layers: [...document.querySelectorAll("[data-layer]")].map((each) => [each.dataset.layer, each.getAttribute("aria-pressed")]),
      charts: vantage.charts().map(({ key, window }) => [key, window.map((x) => x.toFixed(2))]),
      trail: document.getElementById("trail").value,
    }));
  const before = await facts(page);
  assert.equal(before.charts.at(-1)[0], "/vehicle/* plan_round", "a field is charted");
  const address = await page.evaluate(() => location.href);
  assert.match(address, /#log=lab\.lcmlog&t=41/);
  const other = await open(1920, 1080, "light", address.slice(url.length + 1));
  await until(other, () => Math.abs(vantage.state.now - 41) < 0.1 && Object.keys(vantage.series("/vehicle/* plan_round")).length === 2);
  await until(other, (cameras) => vantage.cameras().every((x, i) => Math.abs(x - cameras[i]) < 0.02), before.cameras.map(Number));
  assert.deepEqual(await facts(other), before);
  assert(await other.locator("#note").isHidden());
  await other.close();
  const wrong = await open(1920, 1080, "light", "#log=other.lcmlog&t=5");
  await until(wrong, () => /other\.lcmlog/.test(document.getElementById("note").textContent));
  await wrong.close();
  for (const key of ["b", "f", "z", "r"]) await page.keyboard.press(key);
  await page.selectOption("#trail", "20");
  await page.locator('[data-chart="/vehicle/* plan_round"] figcaption button').click();

  const [download] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("x")]);
  const png = readFileSync(await download.path());
  assert.equal(png.toString("latin1", 1, 4), "PNG");
  const stage = await page.locator("#stage").boundingBox();
  assert(Math.abs(png.readUInt32BE(16) - stage.width) <= 2 && png.readUInt32BE(20) > stage.height);
}

async function check_toggles(page) {
  // Checks only the plans: other layers change while robots fly.
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
  // In a live trial the robot moves, so clicks are repeated until one hits the robot.
  for (let is_hit = false; !is_hit; is_hit = /Q2 · robot/.test(await page.locator("#inspect").textContent())) {
    const spot = await page.evaluate(() => window.vantage.pixel("robot/Q2"));
    await page.mouse.click(spot[0], spot[1]);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  }
  // Waits, because a late plan has no bound, and a body that was seen only once has no speed.
  const told = await until(page, () => {
    const text = document.getElementById("inspect").textContent;
    return /lower bound/.test(text) && /speed/.test(text) && text;
  });
  const text = await told.jsonValue();
  assert.match(text, /Q2 · robot/);
  assert.match(text, /heading.*°.*speed.*m\/s.*battery/);
  await shot(page, "inspect");
  await page.keyboard.press("Escape");
  await page.locator("#inspect").waitFor({ state: "hidden" });
  await page.keyboard.press("3");
}

/** Checks that the list of many robots shows only those with a remark until it is unfolded, and that one line reports
    the start and the end of a trouble. */
async function check_words(page) {
  await page.evaluate(() => {
    for (let i = 1; i <= 20; ++i) {
      const is_held = i === 7;
      vantage.hear(`/vehicle/C${i}`, { robot: `C${i}`, state: is_held ? "hold" : "follow", reasons: is_held ? ["pose too old"] : [], battery_share: 0.5, plan_round: 1 });
    }
  });
  const shown = (expected) => until(page, (expected) =>
    [...document.querySelectorAll("#vehicles .row")].filter((row) => row.checkVisibility() && /^C\d/.test(row.textContent)).length === expected, expected);
  await shown(1);
  assert.match(await page.locator('#vehicles [data-key="C7"]').textContent(), /hold.*pose too old/);
  const fold = page.locator("#vehicles .fold");
  assert.match(await fold.textContent(), /\d+ follow.* hold.*battery 50/);
  await fold.click();
  await shown(20);
  await fold.click();
  await shown(1);
  if (kind !== "live") return;
  const lines = await page.evaluate(() => {
    for (const [level, what] of [[3, "degraded: something was missed"], [2, "recovered after 30 s"], [3, "degraded: something was missed"]]) {
      vantage.hear("/events", { name: "health", level, message: `PLANNER_C7: ${what}` });
    }
    return [...document.querySelectorAll("#events li")].map(({ textContent }) => textContent).filter((text) => /PLANNER_C7/.test(text));
  });
  assert.equal(lines.length, 2);
  assert.match(lines[1], /degraded: something was missed; at [\d.]+ s recovered after 30 s$/);
}

if (kind === "proposals") {
  const known = [];
  const rgba = (hex) => `rgba(${hex.match(/\w\w/g).map((c) => parseInt(c, 16))},1)`;
  /** Returns the index of each robot's colour in the table. */
  const places = (colours, scheme) =>
    Object.fromEntries(Object.entries(colours).map(([robot, css]) => [robot, look.robots.findIndex((paint) => rgba(paint[scheme]) === css)]));
  for (const [scheme, draw, prepare] of [
    ["light", "?draw=canvas", null],
    ["dark", "?draw=gl", turn_history],
  ]) {
    const page = await open(1920, 1080, scheme, draw, prepare);
    known.push(places(await colours_of(page), scheme));
    await check_proposals(page);
    known.push(places(await colours_of(page), scheme));
    await page.close();
  }
  known.forEach((colours) => assert.deepEqual(colours, { Q1: 0, Q2: 1, Q3: 2 }));
}

// Without a graphics card, the page paints on a canvas unless `?draw=gl` requests WebGL.
for (const [width, height, scheme, name, draw] of [
  [1920, 1080, "light", "1080p_light", ""],
  [1920, 1080, "dark", "1080p_dark", ""],
  [1366, 768, "light", "1366", ""],
  [1366, 768, "dark", "1366_dark", ""],
  [768, 1024, "light", "768", ""],
  [768, 1024, "dark", "768_dark", "?draw=canvas"],
  [1280, 800, "light", "gl", "?draw=gl"],
]) {
  const page = await open(width, height, scheme, draw);
  const drawn = await page.evaluate(() => document.getElementById("stage").dataset.drawn);
  assert.equal(drawn, draw === "?draw=gl" ? "gl" : "flat");
  if (name === "1080p_light") {
    if (kind === "log") {
      await check_log(page);
      await check_stage(page);
      await check_charts(page);
      await check_histogram(page);
      await check_ages(page);
      await check_latency(page);
      await check_layouts(page);
      await check_link(page);
    }
    if (kind !== "proposals") {
      await check_toggles(page);
      await check_inspection(page);
      await check_words(page);
    }
  }
  if (kind === "proposals") {
    await seek(page, 4.6); // a time at which all proposals are shown
    await proposals_shown(page, 3);
  }
  if (folder) await page.waitForTimeout(kind === "live" ? 8000 : 1500); // so that the charts in the picture have data
  // In a live trial, no target may be tracked at first.
  await page.waitForFunction(targets_seen, look.targets, { timeout: 30000 }).catch((error) => {
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
await finish();
