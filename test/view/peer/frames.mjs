// frames.mjs http://HOST:PORT [SECONDS [FLAGS…]]: measures the frame rate of the page and the CPU time per frame of
// each Chromium process. Measured while a log plays, while playback is paused and both views are redrawn repeatedly,
// and while the 3-D view is rotated. FLAGS are passed to Chromium. The machine must be idle otherwise. Prints a line
// of JSON for each; SHOT=FILE writes a screenshot.
//
// A frame is a callback of requestAnimationFrame in which the page painted at least one view. The script also
// requests callbacks all the time, so that a slow compositor reduces both rates. Chromium is driven through its
// debugging port and not by playwright, because playwright receives a copy of all WebSocket messages, which costs a
// quarter of a core.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import WebSocket from "ws";

const [url, seconds = "8", ...flags] = process.argv.slice(2);
const folder = mkdtempSync(`${tmpdir()}/frames.`);
const browser = spawn(process.env.CHROMIUM ?? "/usr/bin/chromium", [
  "--headless", "--no-sandbox", "--remote-debugging-port=0", `--user-data-dir=${folder}`, "--no-first-run",
  "--disable-extensions", "--disable-background-networking", "--disable-component-update", "--mute-audio",
  "--window-size=1280,800", ...flags, "about:blank",
]);

const gone = new Promise((resolve) => browser.on("close", resolve)); // when all its processes have ended
process.on("uncaughtExceptionMonitor", () => browser.kill());

/** A connection to a debugging address, for calls. */
class Debugged {
  static async open(address) {
    const socket = new WebSocket(address);
    await new Promise((resolve, reject) => socket.on("open", resolve).on("error", reject));
    return new Debugged(socket);
  }

  constructor(socket) {
    this.socket = socket;
    this.calls = new Map();
    socket.on("message", (text) => {
      const { id, result, error } = JSON.parse(text);
      const call = this.calls.get(id);
      if (call) error ? call.reject(new Error(error.message)) : call.resolve(result);
      this.calls.delete(id);
    });
  }

  call(method, params = {}) {
    const id = (this.last = (this.last ?? 0) + 1);
    this.socket.send(JSON.stringify({ id, method, params }));
    return new Promise((resolve, reject) => this.calls.set(id, { resolve, reject }));
  }

  async evaluate(expression) {
    const { result, exceptionDetails } = await this.call("Runtime.evaluate", {
      expression, awaitPromise: true, returnByValue: true,
    });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }
}

const wait_ms = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Returns the CPU time by kind of process, s. */
async function processors(whole) {
  const used = {};
  for (const { type, cpuTime } of (await whole.call("SystemInfo.getProcessInfo")).processInfo) {
    used[type.replace(/.*\./, "")] = (used[type.replace(/.*\./, "")] ?? 0) + cpuTime;
  }
  return used;
}

async function measure(whole, page, what) {
  const before = await processors(whole);
  const counted = await page.evaluate(`new Promise((resolve) => {
    const begin = { at_ms: performance.now(), frames: vantage.stats().frames, now: vantage.state.now };
    const gaps_ms = [];
    let last_ms = begin.at_ms;
    const tick = () => {
      const at_ms = performance.now();
      gaps_ms.push(at_ms - last_ms);
      last_ms = at_ms;
      if (at_ms - begin.at_ms < ${1000 * Number(seconds)}) return requestAnimationFrame(tick);
      const took_s = (at_ms - begin.at_ms) / 1000;
      gaps_ms.sort((a, b) => a - b);
      resolve({
        pictures: vantage.stats().frames - begin.frames,
        pictures_per_s: (vantage.stats().frames - begin.frames) / took_s,
        callbacks_per_s: gaps_ms.length / took_s,
        gap_p95_ms: gaps_ms[Math.floor(0.95 * gaps_ms.length)],
        log_s_per_s: (vantage.state.now - begin.now) / took_s,
        entities: vantage.stats().entities,
      });
    };
    requestAnimationFrame(tick);
  })`);
  const after = await processors(whole);
  const cost_ms = {};
  for (const kind of Object.keys(after)) {
    cost_ms[kind] = Number(((1000 * (after[kind] - (before[kind] ?? 0))) / Math.max(1, counted.pictures)).toFixed(1));
  }
  for (const [key, value] of Object.entries(counted)) counted[key] = Number(value.toFixed(2));
  console.log(JSON.stringify({ what, ...counted, processor_ms_a_picture: cost_ms }));
}

async function turn(page, during) {
  const box = await page.evaluate(`(({ x, y }) => ({ x, y }))(document.getElementById("space-area").getBoundingClientRect())`);
  const mouse = (type, step) => page.call("Input.dispatchMouseEvent", {
    type, x: box.x + 100 + (step % 200), y: box.y + 150 + (step % 200) / 4, button: "left", buttons: 1, clickCount: 1,
  });
  await mouse("mousePressed", 0);
  let is_over = false;
  const over = during().finally(() => (is_over = true));
  for (let step = 1; !is_over; ++step) await mouse("mouseMoved", step);
  await mouse("mouseReleased", 0);
  await over;
}

try {
  const address = await new Promise((resolve, reject) => {
    let said = "";
    browser.on("error", reject).on("exit", () => reject(new Error(said)));
    browser.stderr.on("data", (text) => {
      said += text;
      const found = said.match(/ws:\/\/[^\s]+/);
      if (found) resolve(found[0]);
    });
  });
  const whole = await Debugged.open(address);
  const { targetId } = await whole.call("Target.createTarget", { url });
  const page = await Debugged.open(address.replace(/browser\/.*/, `page/${targetId}`));
  await page.call("Emulation.setDeviceMetricsOverride", { width: 1280, height: 800, deviceScaleFactor: 1, mobile: false });
  const until = async (condition) => {
    while (!(await page.evaluate(condition))) await wait_ms(50);
  };
  await until("window.vantage?.stats().entities > 10");
  await page.evaluate(`document.dispatchEvent(new KeyboardEvent("keydown", { key: "Home" }))`);
  await until("vantage.state.now < 1");
  await page.evaluate(`document.getElementById("play").click()`);
  await until("vantage.state.now > 4"); // until the team is in flight
  await measure(whole, page, "playing");
  await page.evaluate(`document.getElementById("play").click()`);
  await until("!vantage.state.is_playing");
  await wait_ms(500);
  await page.evaluate(`window.again = setInterval(() => vantage.draw_again(), 4), 0`);
  await measure(whole, page, "standing, both views drawn anew");
  await page.evaluate("clearInterval(again)");
  await turn(page, () => measure(whole, page, "standing, the 3-D view turned"));
  if (process.env.SHOT) {
    const { data } = await page.call("Page.captureScreenshot");
    writeFileSync(process.env.SHOT, Buffer.from(data, "base64"));
  }
  await whole.call("Browser.close");
} catch (error) {
  browser.kill();
  throw error;
} finally {
  await gone;
  rmSync(folder, { recursive: true, force: true });
}
