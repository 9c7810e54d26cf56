// Encoder of a video from pictures of a canvas. Each picture has its own time stamp, so drawing it may take any time.

import { webm } from "./webm.js";

const kKeyPeriod_s = 2; // s; time between key frames, to which a player can seek
const kWaiting = 8; // maximum number of pictures that wait for the encoder
const kBitsAPixel = 0.14;
const kCodecs = [["vp09.00.40.08", "V_VP9"], ["vp8", "V_VP8"]];

/** Returns the reason why this browser cannot encode videos; null if it can. */
export const why_no_video = () =>
  typeof VideoEncoder !== "undefined" ? null
    : window.isSecureContext ? "this browser has no video encoder (WebCodecs)"
      : "browsers encode video only for pages from localhost or https";

export class Video {
  /** Opens an encoder. @param width, height even, pixels @param fps largest number of pictures per second
      @throws Error if the browser cannot encode */
  static async open(width, height, fps) {
    const why_not = why_no_video();
    if (why_not) throw new Error(why_not);
    for (const [codec, name] of kCodecs) {
      const config = { codec, width, height, framerate: fps, bitrate: Math.round(kBitsAPixel * width * height * fps), latencyMode: "quality" };
      if ((await VideoEncoder.isConfigSupported(config)).supported) return new Video(config, { codec: name, width, height, fps });
    }
    throw new Error("this browser can encode neither VP9 nor VP8");
  }

  constructor(config, track) {
    this.track = track;
    this.pictures = [];
    this.key_at_s = -Infinity;
    this.until_s = 0;
    this.encoder = new VideoEncoder({
      output: (chunk) => {
        const data = new Uint8Array(chunk.byteLength);
        chunk.copyTo(data);
        this.pictures.push({ at_ms: Math.round(chunk.timestamp / 1e3), is_key: chunk.type === "key", data });
      },
      error: (error) => (this.failure ??= error),
    });
    this.encoder.configure(config);
  }

  /** Adds a picture. @param since_s s since the first picture */
  async add(canvas, since_s) {
    if (this.failure) throw this.failure;
    const picture = new VideoFrame(canvas, { timestamp: Math.round(1e6 * since_s), alpha: "discard" });
    const keyFrame = since_s - this.key_at_s >= kKeyPeriod_s - 1e-6;
    if (keyFrame) this.key_at_s = since_s;
    this.until_s = since_s + 1 / this.track.fps;
    this.encoder.encode(picture, { keyFrame });
    picture.close();
    while (this.encoder.encodeQueueSize > kWaiting) await new Promise((resolve) => setTimeout(resolve, 2));
  }

  /** Ends the encoder and returns the bytes of the WebM file. */
  async end() {
    await this.encoder.flush();
    this.encoder.close();
    if (this.failure) throw this.failure;
    return webm(this.track, this.pictures, Math.round(1e3 * this.until_s));
  }
}
