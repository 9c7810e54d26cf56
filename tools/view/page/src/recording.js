// Videos of the stage. From a log, the picture of each instant is drawn without a time limit; live views are in real time.

import { Video } from "./video.js";

export const kFps = 25;

/** Records a video of a log. @param how {from, to, speed, fps, go_to(since): resolves once that instant is displayed, paint(sheet),
    on_progress(share), is_over()} @returns the video's bytes */
export async function record_log({ from, to, speed, fps, go_to, paint, on_progress, is_over }) {
  const sheet = document.createElement("canvas");
  await go_to(from);
  paint(sheet);
  const video = await Video.open(sheet.width, sheet.height, fps);
  const pictures = Math.max(1, Math.round(((to - from) / speed) * fps));
  for (let i = 0; i < pictures && !is_over(); i += 1) {
    await go_to(from + (i * speed) / fps);
    paint(sheet);
    await video.add(sheet, i / fps);
    on_progress((i + 1) / pictures);
  }
  return video.end();
}

/** Records the live stage until is_over() or until the stage's size changes.
    @param how {fps, paint(sheet), on_progress(since_s), is_over()} @returns the video's bytes */
export async function record_live({ fps, paint, on_progress, is_over }) {
  const sheet = document.createElement("canvas");
  paint(sheet);
  const { width, height } = sheet;
  const video = await Video.open(width, height, fps);
  const began_ms = performance.now();
  for (let due_s = 0; !is_over(); ) {
    const now_ms = await new Promise(requestAnimationFrame);
    const since_s = Math.max(0, now_ms - began_ms) / 1e3;
    if (since_s < due_s) continue;
    due_s = since_s + 0.9 / fps;
    paint(sheet);
    if (sheet.width !== width || sheet.height !== height) break;
    await video.add(sheet, since_s);
    on_progress(since_s);
  }
  return video.end();
}

/** Makes a video and sends it, its progress or its failure to the server that requested it.
    @param key of the recording @param make called with the function to report progress; resolves to the video's bytes */
export async function send_video(key, make) {
  const post = (query, body) => fetch(`api/recording?${new URLSearchParams({ key, ...query })}`, { method: "POST", body });
  let told = 0;
  const report_progress = (share) => {
    if (share - told < 0.05) return;
    told = share;
    post({ done: share }, "");
  };
  try {
    await post({}, await make(report_progress));
  } catch (error) {
    await post({ failed: 1 }, String(error.message ?? error) || "unknown reason");
  }
}
