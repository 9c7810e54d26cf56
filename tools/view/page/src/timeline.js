// Bar at the bottom: position in the log, marks of events, and the controls of the player.

import { on_refresh } from "./refresh_timer.js";

const kLive_s = 300; // s; displayed time of a live view
const kTick_px = 64; // smallest distance between two ticks
/** Lanes of the events, from top to bottom: label and kinds of events. The last lane takes all other kinds. */
export const kLanes = [
  ["targets", ["found", "lost"]],
  ["attacks", ["attack"]],
  ["plans", ["late", "fallback"]],
  ["safety", []],
];
const lane_of = (kind) => kLanes.findIndex(([, kinds], i) => kinds.includes(kind) || i === kLanes.length - 1);

/** Returns the distance between two ticks, 1, 2 or 5 times a power of ten, so that a range has at most `count` ticks. */
export function tick_step(range_s, count) {
  const least = Math.max(range_s, 1e-3) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((each) => each * power >= least * 0.999);
}
export const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20];

export class Timeline {
  /** @param on {seek(since), play(is_playing), speed(value), date(since)} */
  constructor(on) {
    this.on = on;
    this.bar = document.getElementById("timeline");
    this.marks = document.getElementById("marks");
    this.ticks = document.getElementById("ticks");
    this.head = document.getElementById("head");
    document.getElementById("lanes").replaceChildren(...kLanes.map(([name]) => {
      const lane = document.createElement("span");
      lane.textContent = name;
      return lane;
    }));
    this.span = document.getElementById("span");
    this.clock = document.getElementById("clock");
    this.button = document.getElementById("play");
    this.speeds = document.getElementById("speed");
    this.speeds.replaceChildren(...kSpeeds.map((speed) => new Option(`${speed}×`, speed, speed === 1, speed === 1)));
    this.events = [];
    this.length_s = null; // s; length of the log; null: live
    this.now = 0;
    this.is_playing = false;
    on_refresh(() => this.write());
    new ResizeObserver(() => this.draw_ticks()).observe(this.bar);
    this.button.onclick = () => on.play(!this.is_playing);
    this.speeds.onchange = () => {
      on.speed(Number(this.speeds.value));
      this.speeds.blur(); // so that the page receives the keys again
    };
    this.bar.onmousemove = (event) => {
      const box = this.bar.getBoundingClientRect();
      const [from, to] = this.window();
      this.bar.title = `${(from + ((event.clientX - box.left) / box.width) * (to - from)).toFixed(1)} s`;
    };
    const seek = (event) => {
      const box = this.bar.getBoundingClientRect();
      const share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      on.seek(share * this.length_s);
    };
    this.bar.onpointerdown = (event) => {
      if (this.length_s === null) return;
      this.bar.setPointerCapture(event.pointerId);
      seek(event);
      let last = performance.now();
      let at_px = event.clientX;
      this.bar.onpointermove = (move) => {
        if (performance.now() - last > 80) {
          last = performance.now();
          at_px = move.clientX;
          seek(move);
        }
      };
      this.bar.onpointerup = (up) => {
        this.bar.onpointermove = this.bar.onpointerup = null;
        if (up.clientX !== at_px) seek(up); // a second seek to the same instant would only clear the picture
      };
    };
  }

  /** Sets the length of the log; null: live. */
  set_length(length_s) {
    this.length_s = length_s;
    document.body.dataset.mode = length_s === null ? "live" : "log";
    this.written = null;
    document.getElementById("length").textContent = length_s === null ? "" : `${length_s.toFixed(1)} s`;
    this.bar.setAttribute("aria-valuemin", "0");
    this.bar.setAttribute("aria-valuemax", length_s === null ? "" : length_s.toFixed(1));
    this.draw_marks();
  }

  set_now(since) {
    this.now = since;
    if (this.length_s !== null && !this.is_playing) this.write(); // otherwise the next beat calls write()
  }

  write() {
    if (this.now === this.written) return;
    const since = (this.written = this.now);
    const [from, to] = this.window();
    this.head.style.transform = `translateX(${(100 * (since - from)) / (to - from)}%)`;
    const text = since.toFixed(1);
    if (text !== this.bar.getAttribute("aria-valuenow")) {
      this.bar.setAttribute("aria-valuenow", text);
      this.clock.textContent = `${text} s`;
    }
    this.clock.title = this.on.date(since);
    if (this.length_s === null && since - (this.drawn_at ?? -1) > 1) this.draw_marks();
  }

  set_playing(is_playing, speed) {
    this.is_playing = is_playing;
    this.button.textContent = is_playing ? "❚❚" : "▶";
    this.button.setAttribute("aria-label", is_playing ? "Pause" : "Play");
    if (speed !== undefined) {
      const nearest = kSpeeds.reduce((a, b) => (Math.abs(b - speed) < Math.abs(a - speed) ? b : a));
      this.speeds.value = String(nearest);
    }
  }

  /** Marks the interval that the charts show; null: all times. */
  set_span(zoomed) {
    this.zoomed = zoomed;
    this.span.hidden = zoomed === null;
    if (zoomed === null) return;
    const [from, to] = this.window();
    const share = (time) => Math.min(1, Math.max(0, (time - from) / (to - from)));
    this.span.style.left = `${100 * share(zoomed[0])}%`;
    this.span.style.width = `${100 * Math.max(0.002, share(zoomed[1]) - share(zoomed[0]))}%`;
  }

  window() {
    return this.length_s === null ? [Math.max(0, this.now - kLive_s), Math.max(this.now, 10)] : [0, this.length_s];
  }

  add_event(event) {
    this.events.push(event);
    if (this.events.length > 5000) this.events.shift();
    this.draw_mark(event);
  }

  draw_marks() {
    this.drawn_at = this.now;
    this.marks.replaceChildren();
    this.set_span(this.zoomed ?? null);
    this.draw_ticks();
    this.events.forEach((event) => this.draw_mark(event));
  }

  draw_ticks() {
    const [from, to] = this.window();
    const step = tick_step(to - from, this.bar.clientWidth / kTick_px);
    const ticks = [];
    for (let i = Math.ceil(from / step); i * step <= to; ++i) {
      const tick = document.createElement("span");
      tick.style.left = `${(100 * (i * step - from)) / (to - from)}%`;
      tick.textContent = `${Number((i * step).toFixed(3))} s`;
      if ((i * step - from) / (to - from) > 0.94) tick.className = "last";
      ticks.push(tick);
    }
    this.ticks.replaceChildren(...ticks);
  }

  draw_mark(event) {
    const [from, to] = this.window();
    if (event.since < from || event.since > to) return;
    const mark = document.createElement("i");
    mark.dataset.kind = event.kind;
    mark.style.setProperty("--lane", lane_of(event.kind));
    mark.style.left = `${(100 * (event.since - from)) / (to - from)}%`;
    mark.title = `${event.since.toFixed(1)} s ${event.text}`;
    this.marks.append(mark);
  }

  clear() {
    this.events = [];
    this.zoomed = null;
    this.draw_marks();
  }
}
