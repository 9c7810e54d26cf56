// foreign.mjs http://HOST:PORT foreign [FOLDER]: tests the page on the log of foreign_log.py, served with its .lcm
// files: topics with their types, members of a message, and charts of its numbers, all with the written values.

import assert from "node:assert";
import { finish, folder, open, shot, until, url } from "./drive.mjs";

const kRate_hz = 20;
const kMessages = 600;
const angle = (joint, since_s) => 0.5 * Math.sin((2 * Math.PI * since_s) / 10 + joint);

const is_ready = () => window.vantage?.state.range && document.querySelectorAll(".topic").length >= 3;
const page = await open(1920, 1080, "light", "", null, is_ready);
const topic = (name) => `[data-topic="/lcm/${name}"]`;

/** Opens a topic and adds charts of its fields. */
async function chart(page, name, fields) {
  await page.click(`${topic(name)} > summary`);
  await page.locator(`${topic(name)} [data-field="utime"]`).waitFor();
  await page.evaluate((topic) => document.querySelectorAll(`${topic} .message details`).forEach((part) => (part.open = true)), topic(name));
  for (const field of fields) await page.click(`${topic(name)} [data-field="${field}"]`);
}

// The log has no world, so the page shows the list of topics with their types first.
assert(await page.locator("#topics").isVisible());
assert(await page.locator("#empty").isVisible());
assert(await page.locator("#views").isHidden());
const { topics: types } = await (await fetch(`${url}/api/topics`)).json();
const type_of = Object.fromEntries(types.map(({ topic, type }) => [topic, type]));
assert.equal(type_of["/lcm/ARM_STATE"], "demo_arm.state_t");
assert.equal(type_of["/lcm/POWER"], "demo_arm.power_t");
assert.equal(type_of["/lcm/SECRET"], "0x0001020304050607");
assert.equal(await page.locator(`${topic("ARM_STATE")} > summary`).getAttribute("title"), "demo_arm.state_t");
await page.fill("#topics input", "power_t"); // filters topics by their type, too
await page.locator(topic("ARM_STATE")).waitFor({ state: "hidden" });
await page.fill("#topics input", "");

// Charts of an element of a list, a member of a struct, an element of a matrix and a flag have the written values.
await chart(page, "ARM_STATE", ["position_rad.1", "position_rad.3", "tip_m.z", "effort_nm.2.1", "is_enabled"]);
const line = async (key, name) => {
  await until(page, ([key, name, count]) => vantage.series(key)[name]?.t.length === count, [key, name, kMessages]);
  return page.evaluate(([key, name]) => vantage.series(key)[name], [key, name]);
};
const expect = async (field, value_at) => {
  const { t, v } = await line(`/lcm/ARM_STATE ${field}`, "ARM_STATE");
  t.forEach((since_s, i) => {
    assert(Math.abs(since_s - i / kRate_hz) < 1e-6);
    assert(Math.abs(v[i] - value_at(i / kRate_hz)) < 1e-6, `${field} at ${since_s}: ${v[i]}`);
  });
};
await expect("position_rad.1", (since_s) => angle(1, since_s));
await expect("position_rad.3", (since_s) => angle(3, since_s));
await expect("tip_m.z", (since_s) => 1 + 0.1 * since_s);
await expect("effort_nm.2.1", (since_s) => Math.fround(since_s));
await expect("is_enabled", (since_s) => Number(since_s > 10));
await chart(page, "POWER", ["voltage_v"]);
await line("/lcm/POWER voltage_v", "POWER");

// While playback is paused, a new chart marks the current time from its first frame on.
await page.evaluate(() => vantage.seek_and_wait(21));
await page.locator(`${topic("ARM_STATE")} [data-field="position_rad.2"]`).scrollIntoViewIfNeeded();
const marked = await page.evaluate(async () => {
  document.querySelector('[data-topic="/lcm/ARM_STATE"] [data-field="position_rad.2"]').click();
  for (;;) {
    const mark = document.querySelector('[data-chart="/lcm/ARM_STATE position_rad.2"] .now');
    await new Promise((resolve) => requestAnimationFrame(resolve));
    if (!mark) continue;
    const [at, over] = [mark, mark.parentElement].map((each) => each.getBoundingClientRect());
    return { share: ((at.left + at.right) / 2 - over.left) / over.width, wanted: vantage.state.now / (vantage.state.range[1] - vantage.state.range[0]) };
  }
});
assert(Math.abs(marked.share - marked.wanted) < 0.02, JSON.stringify(marked));

// A rate refers to the log's own time: jumps and the playback speed do not change it.
await page.selectOption("#speed", "0.5");
await page.click("#play");
const rate = () => page.locator(`${topic("ARM_STATE")} > summary .quiet`).textContent();
const counted = () => page.waitForResponse(/api\/topics/).then((response) => response.finished());
const rates = [];
for (const key of ["ArrowLeft", "ArrowRight", "ArrowLeft"]) {
  await counted();
  await page.keyboard.press(`Shift+${key}`);
  await counted();
  rates.push(await rate());
}
const is_told = () => /^(1[5-9]|2[0-5]) Hz$/.test(document.querySelector('[data-topic="/lcm/ARM_STATE"] > summary .quiet').textContent);
for (let asked = 0; !(await page.evaluate(is_told)); ++asked) {
  assert(asked < 120, "no rate is shown");
  await counted();
  if (await page.evaluate(() => vantage.state.is_playing)) continue;
  await page.evaluate(() => vantage.seek_and_wait(1)); // playback has reached the end of the log
  await page.click("#play");
  await until(page, () => vantage.state.is_playing);
}
assert(rates.every((said) => said === "" || (parseFloat(said) > 12 && parseFloat(said) < 30)), rates.join());
await page.click("#play");
await until(page, () => !vantage.state.is_playing);

// The cursor shows the chart's value at its time. After a click, the topic list shows the message of that time.
const charted = page.locator('[data-chart="/lcm/ARM_STATE position_rad.1"]');
await charted.scrollIntoViewIfNeeded();
const over = await charted.locator(".u-over").boundingBox();
await page.mouse.move(over.x + over.width / 2 + 9, over.y + over.height / 2);
await page.mouse.move(over.x + over.width / 2, over.y + over.height / 2);
await charted.locator(".read").waitFor();
const [time, value] = (await charted.locator(".read").innerText()).split("\n").map(parseFloat);
assert(Math.abs(time - 15) < 0.5 && Math.abs(value - angle(1, time)) < 0.006, `${value} at ${time} s`);
await page.mouse.click(over.x + over.width / 2, over.y + over.height / 2);
await until(page, () => Math.abs(vantage.state.now - 15) < 0.5);
await until(page, () => /0\.\d|1\.\d|2\.\d/.test(document.querySelector('[data-topic="/lcm/ARM_STATE"] .message').innerText));
const now = await page.evaluate(() => vantage.state.now);
await until(page, (z) => Math.abs(parseFloat(document.querySelector('[data-field="tip_m.z"]').parentElement.querySelector(".value").textContent) - z) < 0.006, 1 + 0.1 * now);

// A message of an unknown type is shown by its size and fingerprint.
await page.click(`${topic("SECRET")} > summary`);
await until(page, () => /0x0001020304050607/.test(document.querySelector('[data-topic="/lcm/SECRET"] .message').innerText));
await shot(page, "1080p_light");

// A page that is opened by the link shows the same charts.
await until(page, () => decodeURIComponent(location.hash).includes("position_rad.2")); // the address is updated within half a second
const address = await page.evaluate(() => location.href);
const other = await open(1366, 768, "dark", address.slice(url.length + 1), null, () => window.vantage && Object.keys(vantage.series("/lcm/POWER voltage_v")).length > 0);
const keys = (await page.evaluate(() => vantage.charts())).map(({ key }) => key);
await until(other, (count) => vantage.charts().length >= count, keys.length); // charts appear one after another
assert.deepEqual((await other.evaluate(() => vantage.charts())).map(({ key }) => key), keys);
await other.waitForTimeout(folder ? 1500 : 0);
await shot(other, "1366_dark");
for (const each of [page, other]) {
  assert((await each.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 0, "too wide");
  await each.close();
}
await finish();
