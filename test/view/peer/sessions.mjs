// sessions.mjs http://HOST:PORT sessions [FOLDER]: shows two trials of one bus after each other: an empty page says what to do,
// a trial that has ended is shown as ended, and the next one is another session. Environment: VANTAGE, the program; SCENARIO;
// BUS, the LCM URL.

import assert from "node:assert";
import { spawn } from "node:child_process";
import { finish, open, shot, until } from "./drive.mjs";

const { VANTAGE, SCENARIO, BUS } = process.env;

/** Runs a trial; resolves when it has ended. */
const run_trial = (...options) =>
  new Promise((resolve) => {
    const trial = spawn(VANTAGE, ["up", SCENARIO, "--url", BUS, "--no-log", "--json", "--ignore-load", ...options], { stdio: "ignore" });
    trial.on("close", resolve);
  });
const badge = (page) => page.locator("#link").innerText();
const found = (page) => page.evaluate(() => document.querySelector('[data-fact="found"]')?.innerText ?? "");

const page = await open(1366, 768, "light", "", undefined, () => window.vantage !== undefined);
await until(page, () => document.getElementById("link").textContent === "waiting for messages");
const empty = await page.locator("#empty").innerText();
assert(empty.includes(BUS) && empty.includes("vantage up"), empty);
const fits = () => page.evaluate(() => document.querySelector("footer").getBoundingClientRect().bottom - innerHeight);
assert(Math.abs(await fits()) <= 1, "the empty page does not fill the window");
await shot(page, "nothing");

let trial = run_trial("--duration-s", "12");
await until(page, () => document.getElementById("link").textContent === "live" && /^[1-5] of 5/.test(document.querySelector('[data-fact="found"]')?.innerText));
assert(await page.locator("#session").isHidden(), "the list is visible for a single session");
await trial;
await until(page, () => /^ended \d+ s ago$/.test(document.getElementById("link").textContent));
assert(await page.locator("#ended").isVisible());
await shot(page, "ended");
const first = await found(page);
const events = await page.locator(".event").count();

// A page that is opened after the end shows the same.
const late = await open(1366, 768, "dark", "");
await until(late, (facts) => document.querySelector('[data-fact="found"]')?.innerText === facts, first);
await until(late, () => /^ended \d+ s ago$/.test(document.getElementById("link").textContent));
await until(late, () => vantage.position("robot/Q1") !== null && vantage.stats().layers["/robots"] === 3);
await late.close();

trial = run_trial("--duration-s", "30", "--seed", "5");
await until(page, () => vantage.sessions().length === 2 && document.getElementById("link").textContent === "live");
await until(page, () => vantage.state.now < 15 && Object.values(vantage.series("entropy")).some(({ t }) => t.length > 2));
assert((await page.evaluate(() => Math.min(...vantage.series("entropy").team.t))) < 12, "the charts do not start again");
await shot(page, "second");

// The user can choose the first session, and then the present session again.
await page.selectOption("#session", "0");
await until(page, (facts) => document.querySelector('[data-fact="found"]')?.innerText === facts, first);
assert.equal(await badge(page), "earlier trial");
assert((await page.locator(".event").count()) >= events - 12, "events of the earlier trial are missing");
await shot(page, "back");
await page.selectOption("#session", "1");
await until(page, () => document.getElementById("link").textContent === "live" && vantage.stats().layers["/robots"] === 3);
await trial;
await finish();
