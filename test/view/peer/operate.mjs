// operate.mjs http://HOST:PORT operate [FOLDER]: the operator page orders emulated vehicles. Environment: VANTAGE, the program;
// SCENARIO; BUS, the LCM URL; KEY, the key that `vantage view --operate` has printed.

import assert from "node:assert";
import { spawn } from "node:child_process";
import { finish, open, shot, until } from "./drive.mjs";

const { VANTAGE, SCENARIO, BUS, KEY } = process.env;
const role = (expected) => (page) => until(page, (expected) => document.querySelector("#operator .badge").textContent === expected, expected);
const receipts = (page) => page.locator("#operator .receipt:visible").allInnerTexts();

const trial = spawn(VANTAGE, ["up", SCENARIO, "--url", BUS, "--no-log", "--json", "--ignore-load"], { stdio: "ignore" });
const ended = new Promise((resolve) => trial.on("close", resolve));
const is_loaded = () => window.vantage !== undefined;

const stranger = await open(1366, 768, "light", "", undefined, is_loaded);
assert(await stranger.locator("#operator").isHidden(), "without the key the page only views");
await stranger.close();

const page = await open(1366, 768, "light", `#operate=${KEY}`, undefined, is_loaded);
assert(!page.url().includes(KEY), "copied links do not contain the key");
await role("not operating")(page);
await until(page, () => document.querySelectorAll("#operator .row").length === 4);
await page.click('#operator [data-robot="Q1"] [data-action="hold"]');
await until(page, () => /another page operates|claim has ended/.test(document.querySelector("#operator p").textContent));
await page.click('#operator [data-act="claim"]');
await role("in charge")(page);

// An order without effect is reported with the reason.
await until(page, () => document.querySelector('#operator [data-robot="Q1"] [data-action="follow"]').title.startsWith("no effect now"));
await page.click('#operator [data-robot="Q1"] [data-action="follow"]');
await until(page, () => /sent follow to Q1; no effect on Q1: /.test(document.querySelector("#operator .journal").textContent));
await until(page, () => /follow: unconfirmed/.test(document.querySelector('#operator [data-robot="Q1"] .receipt').textContent));
await shot(page, "in_charge");

// Only one page operates at a time; the other page can stop the vehicles.
const other = await open(1366, 768, "dark", `#operate=${KEY}`, undefined, is_loaded);
await other.click('#operator [data-act="claim"]');
await until(other, () => /another page operates/.test(document.querySelector("#operator p").textContent));
await other.keyboard.press("Space");
for (const each of [page, other]) {
  await until(each, () => [...document.querySelectorAll("#operator .receipt")].filter(({ textContent }) => /^estop: confirmed \(killed/.test(textContent)).length === 3);
}
assert.equal((await receipts(other)).length, 3);
await shot(other, "stopped");

// When the page in charge is closed, the other one can take over.
await page.close();
await until(other, () => {
  if (document.querySelector("#operator .badge").textContent === "in charge") return true;
  if (document.querySelector("#operator [data-act=claim]").textContent === "Operate") document.querySelector("#operator [data-act=claim]").click();
  return false;
});
trial.kill("SIGINT");
await ended;
await finish(/status of 409/); // the browser reports refused requests
