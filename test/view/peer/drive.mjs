// Shared by the tests of the page: a headless Chromium, a list of all errors in the consoles of its pages, and
// functions that wait and read. Arguments: http://HOST:PORT KIND [FOLDER].

import assert from "node:assert";
import { chromium } from "playwright-core";

export const [url, kind, folder] = process.argv.slice(2);
const kPatience_ms = Number(process.env.PATIENCE_MS ?? 180_000); // enough for a trial and two pages without a graphics card on a busy core

export const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const complaints = [];

const shows_a_world = () => window.vantage?.stats().entities > 10;

/** @param prepare called with the page before it is loaded @param is_ready repeated in the page until it is true */
export async function open(width, height, scheme, draw, prepare, is_ready = shows_a_world) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
  page.setDefaultTimeout(kPatience_ms);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("requestfailed", (request) => {
    const why = request.failure()?.errorText;
    // Requests that are aborted because the page is closed are not failures.
    if (why !== "net::ERR_ABORTED") complaints.push(`${request.url()} failed: ${why}`);
  });
  page.on("request", (request) => /^(data|blob):/.test(request.url()) || request.url().startsWith(url) || complaints.push(`asks for ${request.url()}`));
  await prepare?.(page);
  await page.goto(`${url}/${draw}`);
  await page.waitForFunction(is_ready);
  return page;
}

export const now = (page) => page.evaluate(() => window.vantage.state.now);
export const shot = (page, name) => folder && page.screenshot({ path: `${folder}/${kind}_${name}.png` });
export const until = (page, condition, argument) => page.waitForFunction(condition, argument);

/** Ends the browser; fails if a page reported an error that does not match `expected`. */
export async function finish(expected = /^$/) {
  await browser.close();
  assert.deepEqual([...new Set(complaints)].filter((complaint) => !expected.test(complaint)), []);
  console.log("ok");
}
