// record.mjs http://HOST:PORT record VIDEO [FOLDER]: tests VIDEO, which `vantage view LOG --record` made of 20 to 22
// s of the log that HOST serves, 640 × 480, ten pictures per second. Chromium plays VIDEO, and each picture must
// equal the page at the same time. Then tests the page's own button, which records the interval that the charts show.

import assert from "node:assert";
import { readFileSync, writeFileSync } from "node:fs";
import { browser, finish, folder as video_path, open, until, url } from "./drive.mjs";

const kLike = 5; // of 255; largest mean colour difference that video coding causes
const shots = process.argv[5];

/** Opens a video; returns {duration, width, height, page, picture_at()}; picture_at(time_s) returns the pixels at
    that time. */
async function play(bytes) {
  const page = await browser.newPage();
  await page.evaluate(add_text_of);
  const facts = await page.evaluate(async (base64) => {
    const data = Uint8Array.from(atob(base64), (each) => each.charCodeAt(0));
    const video = document.createElement("video");
    video.muted = true;
    video.src = URL.createObjectURL(new Blob([data], { type: "video/webm" }));
    await new Promise((resolve, reject) => {
      video.onloadeddata = resolve;
      video.onerror = () => reject(new Error(video.error.message));
    });
    window.picture_at = async (time_s) => {
      // A seek ends before the picture is shown; until then a canvas may get the previous picture.
      const is_shown = new Promise((resolve) => video.requestVideoFrameCallback(resolve));
      const is_sought = new Promise((resolve) => (video.onseeked = resolve));
      video.currentTime = time_s;
      await is_sought;
      await is_shown;
      const sheet = new OffscreenCanvas(video.videoWidth, video.videoHeight).getContext("2d");
      sheet.drawImage(video, 0, 0);
      return text_of(sheet.getImageData(0, 0, video.videoWidth, video.videoHeight).data);
    };
    return { duration: video.duration, width: video.videoWidth, height: video.videoHeight };
  }, bytes.toString("base64"));
  return { ...facts, page, picture_at: async (time_s) => Buffer.from(await page.evaluate((time_s) => picture_at(time_s), time_s), "base64") };
}

/** Adds `text_of(bytes)` to a page: it returns base64, because lists of millions of numbers are transferred slowly.
    */
function add_text_of() {
  window.text_of = (bytes) =>
    new Promise((resolve) => {
      const reader = new FileReader();
      reader.onload = () => resolve(reader.result.split(",")[1]);
      reader.readAsDataURL(new Blob([bytes]));
    });
}

const drawn_at = async (page, since) =>
  Buffer.from(await page.evaluate(async (since) => {
    await vantage.seek_and_wait(since);
    return text_of(vantage.painted().data);
  }, since), "base64");

function difference(a, b) {
  assert.equal(a.length, b.length);
  let sum = 0;
  for (let i = 0; i < a.length; i += 1) if (i % 4 !== 3) sum += Math.abs(a[i] - b[i]);
  return sum / (0.75 * a.length);
}

/** Returns the mean differences of `seen` from `own` and from `other`. Only moving parts count, i.e. the pixels in
    which `own` and `other` differ. */
function of_what_moves(seen, own, other) {
  let [to_own, to_other, count] = [0, 0, 0];
  for (let i = 0; i < own.length; i += 1) {
    if (i % 4 === 3 || Math.abs(own[i] - other[i]) < 60) continue;
    to_own += Math.abs(seen[i] - own[i]);
    to_other += Math.abs(seen[i] - other[i]);
    count += 1;
  }
  assert(count > 100, `${count} numbers move`);
  return [to_own / count, to_other / count];
}

async function compare(video, page, from, fps, pictures) {
  const last = await drawn_at(page, from + (pictures - 1) / fps);
  for (const i of [0, Math.floor(pictures / 2), pictures - 1]) {
    const seen = await video.picture_at((i + 0.5) / fps);
    const own = await drawn_at(page, from + i / fps);
    const far = i === pictures - 1 ? await drawn_at(page, from) : last;
    assert(difference(seen, own) < kLike, `picture ${i} differs by ${difference(seen, own)}`);
    const [to_own, to_other] = of_what_moves(seen, own, far);
    assert(to_own < 0.5 * to_other, `picture ${i} is ${to_own} from its own instant, ${to_other} from another`);
  }
}

const bytes = readFileSync(video_path);
const made = await play(bytes);
assert.deepEqual([made.width, made.height], [640, 480]);
assert(Math.abs(made.duration - 2) < 0.02, `${made.duration} s`);
const open_page = async (...how) => {
  const page = await open(...how);
  await page.evaluate(add_text_of);
  return page;
};
const alone = await open_page(640, 480, "light", "?theme=light", (page) => page.addInitScript(() => addEventListener("DOMContentLoaded", () => (document.body.dataset.shown = "stage"))));
await alone.evaluate(() => dispatchEvent(new Event("resize")));
await compare(made, alone, 20, 10, 20);
await made.page.close();
await alone.close();

// Key W records the interval that the charts show. The button shows its usual text afterwards.
const page = await open_page(1280, 800, "dark", "");
await page.evaluate(() => vantage.zoom(30, 30.8));
const [download] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("w")]);
assert.match(download.suggestedFilename(), /^vantage_lab_[\d.]+s\.webm$/);
await until(page, () => document.getElementById("video").textContent === "Video");
const saved = readFileSync(await download.path());
if (shots) writeFileSync(`${shots}/button.webm`, saved);
const own = await play(saved);
assert(Math.abs(own.duration - 0.8) < 0.02, `${own.duration} s`);
await compare(own, page, 30, 25, 20);
await own.page.close();

// A second press ends the recording; the file contains what was recorded until then.
await page.evaluate(() => vantage.zoom(10, 50));
await page.keyboard.press("w");
await until(page, () => /^\d+ %$/.test(document.getElementById("video").textContent));
const [part] = await Promise.all([page.waitForEvent("download"), page.click("#video")]);
const short = await play(readFileSync(await part.path()));
assert(short.duration > 0 && short.duration < 30, `${short.duration} s`);
await short.page.close();
await page.close();
await finish();
