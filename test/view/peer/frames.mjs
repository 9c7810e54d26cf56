// frames.mjs http://HOST:PORT [SECONDS]: how often the page draws while a log plays, in headless
// Chromium on its software GL: a figure of a machine that does nothing else. Prints one line of JSON.

import { chromium } from "playwright-core";

const [url, seconds = "10"] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
page.setDefaultTimeout(120_000);
await page.goto(url);
await page.waitForFunction(() => window.vantage?.stats().entities > 10);
await page.click("#play");
await page.waitForFunction(() => window.vantage.state.now > 2);
const result = await page.evaluate(async (span_s) => {
  const drawn = () => window.vantage.stats().frames;
  const begin = { at_ms: performance.now(), drawn: drawn(), now: window.vantage.state.now };
  const gaps_ms = [];
  let asked = 0;
  let last_ms = begin.at_ms;
  await new Promise((resolve) => {
    const tick = () => {
      const at_ms = performance.now();
      asked += 1;
      gaps_ms.push(at_ms - last_ms);
      last_ms = at_ms;
      if (at_ms - begin.at_ms > 1000 * span_s) resolve();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  });
  const took_s = (performance.now() - begin.at_ms) / 1000;
  gaps_ms.sort((a, b) => a - b);
  return {
    animation_frames_per_s: asked / took_s,
    drawn_per_s: (drawn() - begin.drawn) / took_s,
    gap_p95_ms: gaps_ms[Math.floor(0.95 * gaps_ms.length)],
    log_s_per_s: (window.vantage.state.now - begin.now) / took_s,
    entities: window.vantage.stats().entities,
  };
}, Number(seconds));
if (process.env.SHOT) await page.screenshot({ path: process.env.SHOT });
console.log(JSON.stringify(result));
await browser.close();
