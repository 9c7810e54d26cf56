// Charts of numbers over time, with values under the cursor and a common time interval.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { kRefreshPeriod_ms, on_refresh } from "./refresh_timer.js";
import { digits, kDashes, appearance, robot_css, robot_appearance, title_of } from "./appearance.js";

const kWindow_s = 120; // s; displayed interval of a live view
const kPoints = 20000; // maximum number of points per series
const kRefresh_ms = 500; // ms; refresh period of each chart
const kReadoutMax = 8; // maximum number of series with values shown under the cursor
const kLeast_s = 0.2; // s; shortest displayed interval
const kLeast_px = 236; // minimum width of a chart
const kGap_px = 8;
const kFlatShare = 0.005; // charts whose values differ less are hidden
const kPadding = [6, 10, 0, 0]; // pixels around a plot: above, right, below, left

/// Returns the options of a plot in `body` without zoom and without uPlot's legend.
const still_options = (body) => ({
  width: Math.max(80, body.clientWidth),
  height: Math.max(60, body.clientHeight),
  legend: { show: false },
  padding: kPadding,
  cursor: { y: false, drag: { x: false, y: false, setScale: false }, points: { show: false } },
});

const number = (x) => (typeof x === "boolean" ? Number(x) : typeof x === "number" && Number.isFinite(x) ? x : null);
const robot_of = (topic) => topic.split("/")[2];

/** Returns the function `take` of a chart with two series: a team's number, and its mean over the robots' own beliefs. */
const team_and_robot = (team, robot) => (r) => [["team", number(r[team])], ["robot mean", number(r[robot])]];

/** Built-in charts. `take` converts a record into a list of [series, value]; the value is null if it is missing. */
const kCharts = [
  { key: "entropy", measure: "entropy", topic: /^\/team$/, take: team_and_robot("entropy_nats", "robot_entropy_nats") },
  { key: "map_entropy", measure: "map_entropy", topic: /^\/team$/, take: (r) => [["team", number(r.map_entropy_nats)]] },
  { key: "rmse", measure: "rmse", topic: /^\/team$/, take: team_and_robot("rmse_m", "robot_rmse_m"), zero: true },
  {
    key: "nees",
    measure: "nees",
    topic: /^\/team$/,
    take: (r) => (r.nees_by_age ?? []).map(({ age_s, samples, mean }) => [age_s, { samples, mean, expected: r.nees_expected }]),
    kind: "ages",
  },
  {
    key: "margin",
    measure: "margin",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [[robot_of(topic), number(r.margin_s * 1e3)]],
    zero: true,
  },
  {
    key: "deadlines",
    measure: "margin",
    title: "number of plans by deadline margin [ms]",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [[robot_of(topic), number(r.margin_s * 1e3)]],
    kind: "histogram",
  },
  {
    key: "latency",
    measure: "latency",
    topic: /^\/vehicle\//,
    take: (r, topic) => [[robot_of(topic), number(r.capture_to_setpoint_s * 1e3)]],
    zero: true,
  },
  {
    key: "gap",
    measure: "gap",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [[robot_of(topic), number(r.gap_nat)]],
    zero: true,
  },
  {
    key: "battery",
    measure: "battery",
    topic: /^\/vehicle\//,
    take: (r, topic) => [[robot_of(topic), number(r.battery_share * 100)]],
    range: [0, 105],
  },
  { key: "lost", measure: "lost", topic: /^\/team$/, take: (r) => [["team", number(r.messages_lost)]], zero: true, count: true },
];

/** Returns the member of a record at a path: ["a", "0", "b"]. */
export const member = (record, path) => path.reduce((value, key) => value?.[key], record);

/** Splits a topic into its family and the robot's name: "/vehicle/Q1" → ["/vehicle/*", "Q1"], "/lcm/PLAN_Q1" →
    ["/lcm/PLAN_*", "Q1"]. Without a robot: the topic and its last part. */
export function family_of(topic, robots) {
  for (const robot of robots) {
    const parts = topic.split(new RegExp(`(?<=[/_])${robot.replace(/[^\w]/g, "\\$&")}(?=/|$)`));
    if (parts.length === 2) return [parts.join("*"), robot];
  }
  return [topic, topic.split("/").at(-1)];
}

/** Shows a colour before an element's text. */
function mark_of(element, colour) {
  element.className = "of";
  element.style.setProperty("--of", colour);
}

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Returns the options that the axes of all charts share. */
const axis_look = () => ({
  stroke: css("--quiet"), font: "11px system-ui", gap: 3, grid: { stroke: css("--line"), width: 1 }, ticks: { stroke: css("--line"), width: 1, size: 4 },
});

/** Line styles of the series that do not belong to one robot. */
const kTeamStyles = { team: { colour: "--ink" }, "robot mean": { colour: "--quiet", dash: [5, 3] } };

class Chart {
  constructor(box, spec, source) {
    this.spec = spec;
    this.source = source;
    this.series = new Map(); // {t, v}: times and values, by name of the series
    this.box = document.createElement("figure");
    this.box.dataset.chart = spec.key;
    this.is_off = false; // true: the user has removed the chart
    this.is_forced = false; // true: the user has restored the chart, which is then shown even if it cannot vary
    this.ranges = new Map(); // [least, greatest] value by name of the series
    this.caption = document.createElement("figcaption");
    this.title = document.createElement("b");
    this.title.textContent = this.box.title = spec.title ?? title_of(spec.measure);
    this.names_box = document.createElement("span");
    this.caption.append(this.title, this.names_box);
    const close = document.createElement("button");
    close.textContent = "×";
    close.title = "Remove this chart";
    close.setAttribute("aria-label", `Remove ${this.title.textContent}`);
    close.onclick = () => source.remove(this);
    this.caption.append(close);
    this.body = document.createElement("div");
    this.body.setAttribute("role", "img");
    this.body.setAttribute("aria-label", `${this.title.textContent} over time`);
    this.readout = document.createElement("div");
    this.readout.className = "read";
    this.readout.hidden = true;
    this.box.append(this.caption, this.body);
    box.append(this.box);
    this.show();
  }

  /** Shows the chart unless it was removed, has no series, or has only one value. */
  show() {
    const is_flat = !this.spec.fields && !this.is_forced && !this.varies();
    this.box.hidden = this.is_off || (!this.spec.fields && this.series.size === 0) || is_flat;
  }

  /** True if the values of a series differ by more than kFlatShare of the greatest. */
  varies() {
    if (this.spec.kind === "ages") return true;
    return [...this.ranges.values()].some(([low, high]) => high - low > kFlatShare * Math.max(Math.abs(low), Math.abs(high)));
  }

  note_value(name, value) {
    if (typeof value !== "number") return;
    const [low, high] = this.ranges.get(name) ?? [value, value];
    if (value >= low && value <= high && this.ranges.has(name)) return;
    this.ranges.set(name, [Math.min(low, value), Math.max(high, value)]);
    if (this.box.hidden && this.varies()) this.show();
  }

  add(topic, time, record) {
    if (!this.spec.topic.test(topic)) return;
    for (const [name, value] of this.spec.take(record, topic)) {
      if (value !== null) this.put(name, time, value);
    }
  }

  put(name, time, value) {
    if (!this.series.has(name)) {
      this.series.set(name, { t: [], v: [] });
      this.destroy();
      this.show();
    }
    const line = this.series.get(name);
    if (line.t.length > 0 && time < line.t.at(-1)) line.t.length = line.v.length = 0;
    line.t.push(time);
    line.v.push(value);
    this.note_value(name, value);
    if (line.t.length > kPoints) {
      line.t.splice(0, kPoints / 10);
      line.v.splice(0, kPoints / 10);
    }
    this.is_stale = true;
  }

  /** Replaces a whole series. */
  fill(name, points) {
    this.series.set(name, { t: points.map(([t]) => t), v: points.map(([, v]) => v) });
    this.destroy();
    this.show();
    this.is_stale = true;
  }

  destroy() {
    this.plot?.destroy();
    this.plot = null;
  }

  names() {
    const [rank, teams] = [this.source.index_of, Object.keys(kTeamStyles)];
    const of_team = (name) => teams.indexOf(name);
    return [...this.series.keys()].sort((a, b) => (rank(a) === rank(b) ? of_team(a) - of_team(b) || (a < b ? -1 : 1) : rank(a) - rank(b)));
  }

  colour(name) {
    const index = this.source.index_of(name);
    if (index < Infinity) return robot_css(robot_appearance(index).body);
    if (kTeamStyles[name]) return css(kTeamStyles[name].colour);
    const others = [...this.series.keys()].filter((each) => this.source.index_of(each) === Infinity).sort();
    if (others.length > 1) return robot_css(others.indexOf(name) % appearance.robots.length);
    return css("--ink");
  }

  dash(name) {
    const index = this.source.index_of(name);
    return index < Infinity ? kDashes[robot_appearance(index).dash] : (kTeamStyles[name]?.dash ?? []);
  }

  make() {
    const axis = axis_look();
    const { zero, range, count } = this.spec;
    this.write_legend(); // written first, because the plot's size depends on it
    this.plot = new uPlot(
      {
        width: Math.max(80, this.body.clientWidth),
        height: Math.max(60, this.body.clientHeight),
        legend: { show: false },
        padding: kPadding,
        focus: { alpha: 0.35 },
        cursor: {
          y: false,
          drag: { x: false, y: false, setScale: false },
          focus: { prox: this.series.size > 1 ? 1e6 : -1 },
          sync: { key: "charts", setSeries: false },
          points: { size: 6 },
        },
        hooks: { setCursor: [() => this.write_readout()] },
        scales: {
          x: { time: false, range: () => this.source.window() },
          y: {
            range: (_, low, high) => {
              if (range) return range;
              if (low === null) return [0, 1];
              if (zero) [low, high] = [Math.min(0, low), Math.max(0, high)];
              if (count) return [0, Math.max(4, 1.08 * high)]; // a count has integer ticks
              const pad = Math.max(1e-6, 0.08 * (high - low || Math.abs(high) || 1));
              return [low < 0 || !zero ? low - pad : 0, high + pad];
            },
          },
        },
        axes: [
          { ...axis, size: 24, space: 45 },
          { ...axis, size: 46, space: 24, ...(count ? { incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 1e4, 1e5, 1e6] } : {}) },
        ],
        series: [
          {},
          ...this.names().map((name) => ({
            label: name,
            stroke: this.colour(name),
            dash: this.dash(name),
            width: 1.5,
            spanGaps: true,
            points: { show: false },
          })),
        ],
      },
      this.table(),
      this.body,
    );
    this.mark = document.createElement("div");
    this.mark.className = "now";
    this.plot.over.append(this.mark, this.readout);
    this.listen(this.plot.over);
  }

  /** Handles the mouse: the wheel zooms in time, dragging pans, a click seeks, a double click shows all. */
  listen(over) {
    const time_at = (event) => {
      const box = over.getBoundingClientRect();
      const [from, to] = this.source.window(); // the plot's scale is updated only when the plot is drawn
      return from + ((event.clientX - box.left) / box.width) * (to - from);
    };
    over.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [from, to] = this.source.window();
      const at = time_at(event);
      const factor = Math.exp(0.0018 * event.deltaY);
      this.source.zoom(at - (at - from) * factor, at + (to - at) * factor);
    }, { passive: false });
    over.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      const [from, to] = this.source.window();
      const start = event.clientX;
      let has_moved = false;
      over.setPointerCapture(event.pointerId);
      over.onpointermove = (move) => {
        const way = move.clientX - start;
        has_moved ||= Math.abs(way) > 4;
        const shift = (way * (to - from)) / Math.max(1, over.clientWidth);
        if (has_moved) this.source.zoom(from - shift, to - shift);
      };
      over.onpointerup = (up) => {
        over.onpointermove = over.onpointerup = null;
        if (!has_moved) this.source.seek(time_at(up));
      };
    });
    over.addEventListener("dblclick", () => this.source.zoom(null));
  }

  /** Shows the values under the cursor. If there are many series, shows only those nearest to the cursor. */
  write_readout() {
    const { idx, top } = this.plot.cursor;
    const names = this.names();
    if (idx === null || idx === undefined || !(this.plot.cursor.left >= 0)) {
      this.readout.hidden = true;
      return;
    }
    const time = this.plot.data[0][idx];
    // Series are sampled at different instants, so each one shows its newest value up to the cursor.
    let values = names.map((name, i) => {
      let at = idx;
      while (at > 0 && (this.plot.data[i + 1][at] ?? null) === null) at -= 1;
      return { name, value: this.plot.data[i + 1][at] ?? null };
    }).filter(({ value }) => value !== null);
    const all = values.length;
    if (all > kReadoutMax) {
      const under = this.plot.posToVal(top, "y");
      values = values.sort((a, b) => Math.abs(a.value - under) - Math.abs(b.value - under)).slice(0, kReadoutMax);
    }
    const line = (text, colour) => {
      const each = document.createElement("div");
      each.textContent = text;
      if (colour) mark_of(each, colour);
      return each;
    };
    const unit = appearance.measures[this.spec.measure]?.unit ?? "";
    this.readout.replaceChildren(
      line(`${time.toFixed(2)} s`),
      ...values.map(({ name, value }) => line(`${names.length > 1 ? `${name} ` : ""}${digits(value)} ${unit}`, this.colour(name))),
      ...(all > kReadoutMax ? [line(`and ${all - kReadoutMax} more`)] : []),
    );
    this.readout.hidden = false;
    this.readout.classList.toggle("left", this.plot.cursor.left > this.plot.over.clientWidth / 2);
  }

  /** Writes the names of the series, or their number if there is too little space. */
  write_legend() {
    const names = this.names();
    const label = (name) => {
      const each = document.createElement("i");
      each.textContent = name;
      mark_of(each, this.colour(name));
      return each;
    };
    const is_in_title = names.length < 2 && (!this.spec.fields || this.title.textContent.split(" ")[0] === names[0]);
    this.names_box.replaceChildren(...(is_in_title ? [] : names.map(label)));
    if (this.names_box.scrollWidth > this.caption.clientWidth - 34) {
      const words = document.createElement("i");
      words.textContent = `${names.length} series`;
      this.names_box.replaceChildren(words);
    }
  }

  table() {
    const lines = this.names().map((name) => this.series.get(name));
    return lines.length === 0 ? [[], []] : uPlot.join(lines.map((line) => [line.t, line.v]));
  }

  /** Marks the current position in a log by an element over the plot, so that the plot is not drawn again. The mark is placed
      without the plot's scale, which is valid only after drawing. */
  mark_now() {
    if (!this.mark) return; // the plot does not exist yet
    const now = this.source.now();
    const [from, to] = this.source.window();
    this.mark.hidden = now === null || now < from || now > to;
    if (!this.mark.hidden) this.mark.style.left = `calc(${(100 * (now - from)) / (to - from)}% - 1px)`;
  }

  refresh() {
    if (this.series.size === 0 || this.body.clientWidth === 0) return;
    const window = this.source.window().join();
    if (!this.plot) {
      this.make();
    } else if (this.is_stale) {
      this.plot.setData(this.table());
    } else if (window !== this.window) {
      this.plot.setScale("x", { min: 0, max: 1 }); // makes uPlot call range(), which returns the window
    }
    this.mark_now();
    this.window = window;
    this.is_stale = false;
  }

  resize() {
    if (!this.plot || this.body.clientWidth === 0) return;
    this.write_legend();
    this.plot.setSize({ width: this.body.clientWidth, height: this.body.clientHeight });
  }

  restyle() {
    this.destroy();
    this.refresh();
  }

  clear() {
    this.series.clear();
    this.ranges.clear();
    this.destroy();
    this.show();
    this.readout.hidden = true;
  }
}

const kBins = 24; // approximate number of bins of a histogram

/** Returns the width of bins, 1, 2 or 5 times a power of ten, so that a range has at most about kBins bins. */
function bin_width(range) {
  const least = Math.max(range, 1e-9) / kBins;
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((each) => each * power >= least);
}

/** Histogram of a number in the displayed interval. Negative values have the colour of late plans. */
class Histogram extends Chart {
  constructor(...how) {
    super(...how);
    this.body.setAttribute("aria-label", this.title.textContent);
  }

  /** Returns the width of the bins, the start of each bin and the number of values in it. */
  bins() {
    const [from, to] = this.source.window();
    const values = [...this.series.values()].flatMap(({ t, v }) => v.filter((_, i) => t[i] >= from && t[i] <= to));
    if (values.length === 0) return { width: 1, starts: [], counts: [] };
    const [low, high] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [0, 0]);
    const width = bin_width(high - low);
    const first = Math.floor(low / width);
    const starts = Array.from({ length: Math.floor(high / width) - first + 1 }, (_, i) => (first + i) * width);
    const counts = starts.map(() => 0);
    values.forEach((value) => (counts[Math.floor(value / width) - first] += 1));
    return { width, starts, counts };
  }

  table() {
    const { width, starts, counts } = (this.binned = this.bins());
    const middles = starts.map((start) => start + width / 2);
    return [middles, counts.map((count, i) => (middles[i] < 0 ? count : null)), counts.map((count, i) => (middles[i] < 0 ? null : count))];
  }

  make() {
    const axis = axis_look();
    const bars = (label, colour) => ({ label, stroke: colour, fill: colour, width: 0, paths: uPlot.paths.bars({ size: [0.9, 60], align: 0 }), points: { show: false } });
    this.write_legend();
    this.plot = new uPlot(
      {
        ...still_options(this.body),
        hooks: { setCursor: [() => this.write_readout()] },
        scales: {
          x: { time: false, range: () => [this.binned.starts[0] ?? 0, (this.binned.starts.at(-1) ?? 0) + this.binned.width] },
          y: { range: (_, low, high) => [0, Math.max(1, 1.08 * (high ?? 1))] },
        },
        axes: [{ ...axis, size: 24, space: 45 }, { ...axis, size: 46, space: 24, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 1e4, 1e5] }],
        series: [{}, bars("late", css("--bad")), bars("in time", css("--accent"))],
      },
      this.table(),
      this.body,
    );
    this.plot.over.append(this.readout);
  }

  write_readout() {
    const { idx, left } = this.plot.cursor;
    const start = this.binned.starts[idx ?? -1];
    this.readout.hidden = start === undefined || !(left >= 0);
    if (this.readout.hidden) return;
    const unit = appearance.measures[this.spec.measure].unit;
    this.readout.textContent = `${digits(start)} to ${digits(start + this.binned.width)} ${unit}: ${this.binned.counts[idx]}`;
    this.readout.classList.toggle("left", left > this.plot.over.clientWidth / 2);
  }

  write_legend() {
    const { starts, counts } = this.bins();
    const late = counts.reduce((sum, count, i) => sum + (starts[i] < 0 ? count : 0), 0);
    const words = document.createElement("i");
    words.textContent = `${late} of ${counts.reduce((sum, count) => sum + count, 0)} late`;
    this.names_box.replaceChildren(words);
  }

  mark_now() {}

  refresh() {
    if (this.series.size === 0 || this.body.clientWidth === 0) return;
    const window = this.source.window().join();
    if (!this.plot) {
      this.make();
    } else if (this.is_stale || window !== this.window) {
      this.plot.setData(this.table());
      this.write_legend();
    }
    this.window = window;
    this.is_stale = false;
  }
}

const kMostShown = 8; // times the expected value: upper limit of the axis; larger means are marked at the edge
const kBatch_s = 5; // s; length of a batch, which counts as one sample because its steps are correlated

/** Returns the half width of the 95 % band of a mean in standard errors (Student's t).
    Source: Abramowitz and Stegun 26.7.5 (0.7 % too small for 3 degrees of freedom); exact for 1 and 2. */
export function t_95(freedom) {
  if (freedom < 3) return [Infinity, 12.706, 4.303][freedom];
  const z = 1.95996;
  return z + (z ** 3 + z) / (4 * freedom) + (5 * z ** 5 + 16 * z ** 3 + 3 * z) / (96 * freedom ** 2) + (3 * z ** 7 + 19 * z ** 5 + 17 * z ** 3 - 15 * z) / (384 * freedom ** 3);
}

/** Chart of the mean NEES of the robots' beliefs in the displayed interval, by the time since the target was last seen, with
    the 95 % band of the mean and the value expected of consistent estimators. */
class ByAge extends Chart {
  constructor(...how) {
    super(...how);
    this.body.setAttribute("aria-label", `${this.title.textContent}: mean and its 95 % band`);
  }

  /** Returns {age, samples, mean, half} of each class; half: half width of the band, null with fewer than two batches.
      Consecutive steps are correlated, so the band is computed from the means of batches, weighted by their samples. */
  classes() {
    const [from, to] = this.source.window();
    return [...this.series].sort(([a], [b]) => parseFloat(a) - parseFloat(b)).map(([age, { t, v }]) => {
      const batches = new Map();
      let [samples, sum] = [0, 0];
      t.forEach((time, i) => {
        if (time < from || time > to) return;
        const key = Math.floor(time / kBatch_s);
        const batch = batches.get(key) ?? { samples: 0, sum: 0 };
        batch.samples += v[i].samples;
        batch.sum += v[i].samples * v[i].mean;
        batches.set(key, batch);
        samples += v[i].samples;
        sum += v[i].samples * v[i].mean;
      });
      const mean = sum / samples;
      const count = batches.size;
      const squares = [...batches.values()].reduce((all, batch) => all + (batch.sum - batch.samples * mean) ** 2, 0);
      const half = count > 1 ? (t_95(count - 1) * Math.sqrt((squares * count) / (count - 1))) / samples : null;
      return { age, samples, mean, half };
    }).filter(({ samples }) => samples > 0);
  }

  expected() {
    return [...this.series.values()].map(({ v }) => v.at(-1)?.expected).find((each) => each !== undefined) ?? null;
  }

  table() {
    this.judged = this.classes();
    const places = this.judged.map((_, i) => i);
    // The axis extends half a class beyond both ends, so that the line of the expected value
    // crosses the complete plot.
    const all = places.length === 0 ? [] : [-0.5, ...places, places.length - 0.5];
    return [all, all.map(() => this.expected()), all.map((i) => this.judged[i]?.mean ?? null)];
  }

  make() {
    const axis = axis_look();
    this.write_legend();
    this.plot = new uPlot(
      {
        ...still_options(this.body),
        hooks: { setCursor: [() => this.write_readout()], draw: [(plot) => this.draw_bands(plot)] },
        scales: {
          x: { time: false, range: () => [-0.5, Math.max(0.5, this.judged.length - 0.5)] },
          y: { range: () => [0, this.top()] },
        },
        axes: [
          { ...axis, size: 24, grid: { show: false }, splits: () => this.judged.map((_, i) => i), values: () => this.judged.map(({ age }) => age.replace("-", "–")) },
          { ...axis, size: 46, space: 24 },
        ],
        series: [
          {},
          { label: "expected", stroke: css("--good"), width: 1.5, dash: [6, 4], points: { show: false } },
          { label: "mean", stroke: css("--accent"), width: 0, paths: () => null, points: { show: true, size: 8, fill: css("--accent"), width: 0 } },
        ],
      },
      this.table(),
      this.body,
    );
    this.plot.over.append(this.readout);
  }

  /** Returns the upper limit of the axis: above all means and bands (a band counts up to twice its mean), but between 2 and
      kMostShown times the expected value. */
  top() {
    const expected = this.expected() ?? 1;
    const most = Math.max(2 * expected, ...this.judged.map(({ mean, half }) => Math.min(mean + (half ?? 0), 2 * mean)));
    return Math.min(1.08 * most, kMostShown * expected);
  }

  draw_bands(plot) {
    const { ctx, bbox } = plot;
    const top = this.top();
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.strokeStyle = css("--accent");
    ctx.lineWidth = 2 * ratio;
    ctx.beginPath();
    this.judged.forEach(({ mean, half }, i) => {
      const x = plot.valToPos(i, "x", true);
      if (mean > top) {
        // Draw only an arrow; the value is shown under the cursor.
        ctx.moveTo(x - 5 * ratio, bbox.top + 9 * ratio);
        ctx.lineTo(x, bbox.top + 2 * ratio);
        ctx.lineTo(x + 5 * ratio, bbox.top + 9 * ratio);
        return;
      }
      if (half === null) return;
      const [low, high] = [Math.max(0, mean - half), mean + half].map((value) => plot.valToPos(value, "y", true));
      const wing = 5 * ratio;
      for (const [x1, y1, x2, y2] of [[x, low, x, high], [x - wing, low, x + wing, low], [x - wing, high, x + wing, high]]) {
        ctx.moveTo(x1, y1);
        ctx.lineTo(x2, y2);
      }
    });
    ctx.stroke();
    ctx.restore();
  }

  write_readout() {
    const { left } = this.plot.cursor;
    const of = left >= 0 ? this.judged[Math.round(this.plot.posToVal(left, "x"))] : undefined;
    this.readout.hidden = of === undefined;
    if (!of) return;
    const band = of.half === null ? "" : ` ± ${digits(of.half)}`;
    this.readout.textContent = `unseen for ${of.age.replace("-", "–")} s: mean ${digits(of.mean)}${band}, ${of.samples} samples`;
    this.readout.classList.toggle("left", left > this.plot.over.clientWidth / 2);
  }

  write_legend() {
    const words = document.createElement("i");
    words.textContent = `expected ${this.expected() ?? "–"}`;
    mark_of(words, css("--good"));
    this.names_box.replaceChildren(words);
  }

  mark_now() {}

  refresh() {
    Histogram.prototype.refresh.call(this);
  }
}

const kKinds = { histogram: Histogram, ages: ByAge };

export class Charts {
  /** @param source {now(), window(), seek(since), on_zoom([from, to] or null), on_change(), on_overflow(left, right)}. Times
      are seconds since the start. left, right: numbers of charts beyond the edges */
  constructor(box, source) {
    this.box = box;
    this.source = source;
    this.robots = [];
    this.zoomed = null; // displayed interval; null: all times
    const own = {
      now: source.now,
      seek: source.seek,
      window: () => this.zoomed ?? source.window(),
      zoom: (from, to) => this.zoom(from, to),
      index_of: (name) => {
        const index = this.robots.indexOf(name);
        return index < 0 ? Infinity : index;
      },
      remove: (chart) => this.remove(chart),
    };
    this.own = own;
    this.charts = kCharts.map((spec) => new (kKinds[spec.kind] ?? Chart)(box, spec, own));
    // Observe each chart, because a new chart makes the other charts smaller.
    this.sizes = new ResizeObserver(() => {
      this.arrange();
      this.charts.forEach((chart) => chart.resize());
    });
    this.sizes.observe(box);
    this.charts.forEach((chart) => this.sizes.observe(chart.body));
    box.addEventListener("scroll", () => this.report_overflow(), { passive: true });
    on_refresh((beat) => this.refresh(beat));
  }

  /** Refreshes a part of the charts at each beat, because refreshing all charts together would cause a visible pause. */
  refresh(beat) {
    const turns = Math.ceil(kRefresh_ms / kRefreshPeriod_ms);
    this.charts.forEach((chart, i) => (i % turns === beat % turns ? chart.refresh() : chart.mark_now()));
  }

  /** Shows an interval of time in all charts; null: all times. */
  zoom(from, to) {
    const [first, last] = this.source.window();
    let next = null;
    if (from !== null && Number.isFinite(from) && Number.isFinite(to)) {
      const length = Math.max(kLeast_s, to - from);
      const low = this.source.now() === null ? Math.min(from, last - kLeast_s) : Math.max(first, Math.min(from, last - length));
      const high = this.source.now() === null ? low + length : Math.min(last, low + length);
      if (low > first + 1e-9 || high < last - 1e-9) next = [low, high];
    }
    this.zoomed = next;
    this.source.on_zoom(next);
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      this.charts.forEach((chart) => chart.refresh());
    });
  }

  add(topic, time, record) {
    this.charts.forEach((chart) => !chart.spec.fields && chart.add(topic, time, record));
  }

  /** Adds a record of a topic with charted fields. */
  add_field(topic, time, record) {
    for (const chart of this.charts) {
      const name = chart.spec.fields?.get(topic);
      const value = name && !chart.is_whole ? number(member(record, chart.spec.path)) : null;
      // The server sends the newest record again after a new subscription.
      if (value !== null && value !== undefined && chart.series.get(name)?.t.at(-1) !== time) chart.put(name, time, value);
    }
  }

  /** Charts a number of a topic. Topics that differ only in the robot share one chart.
      @param path ["a", "0", "b"] @param points [since, value] of a complete log; null: points are added from records */
  plot(topic, path, points) {
    const [family, name] = family_of(topic, this.robots);
    const key = `${family} ${path.join(".")}`;
    let chart = this.charts.find(({ spec }) => spec.key === key);
    if (!chart) {
      const title = `${family.replace(/^\/(lcm\/)?/, "").replace(/[/_]\*/, "")} ${path.join(".")}`;
      chart = new Chart(this.box, { key, title, fields: new Map(), path }, this.own);
      this.charts.push(chart);
      this.sizes.observe(chart.body);
    }
    chart.spec.fields.set(topic, name);
    chart.is_whole = points !== null;
    if (points) chart.fill(name, points);
    chart.refresh();
    chart.box.scrollIntoView({ block: "nearest", inline: "nearest" });
    this.source.on_change();
  }

  /** Sets the number of charts that are displayed side by side, so that every displayed chart is completely visible. */
  arrange() {
    const count = this.charts.filter(({ box }) => !box.hidden).length;
    const fitting = Math.max(1, Math.floor((this.box.clientWidth + kGap_px) / (kLeast_px + kGap_px)));
    this.box.style.setProperty("--shown", Math.max(1, Math.min(count, fitting)));
    this.report_overflow();
  }

  /** Reports the numbers of charts beyond the left and right edges. */
  report_overflow() {
    const { left, right } = this.box.getBoundingClientRect();
    const boxes = this.charts.filter(({ box }) => !box.hidden).map(({ box }) => box.getBoundingClientRect());
    const middle = (at) => (at.left + at.right) / 2;
    this.source.on_overflow(boxes.filter((at) => middle(at) < left).length, boxes.filter((at) => middle(at) > right).length);
  }

  /** Scrolls by one page. @param way direction: −1 left, 1 right */
  scroll(way) {
    this.box.scrollBy({ left: way * (this.box.clientWidth + kGap_px) });
  }

  /** Returns the charts that draw lines over time. */
  lines() {
    return this.charts.filter(({ spec }) => !spec.kind);
  }

  /** Removes the chart of a field, or hides a built-in chart, which can be shown again. */
  remove(chart) {
    if (chart.spec.fields) {
      this.charts.splice(this.charts.indexOf(chart), 1);
      chart.destroy();
      this.sizes.unobserve(chart.body);
      chart.box.remove();
    } else {
      chart.is_off = true;
      chart.show();
    }
    this.source.on_change();
  }

  /** Returns the keys of the hidden built-in charts. */
  off() {
    return this.charts.filter(({ is_off }) => is_off).map(({ spec }) => spec.key);
  }

  /** Returns the charts with values that are not shown: removed by the user, or flat. */
  unseen() {
    return this.charts.filter(({ box, series }) => box.hidden && series.size > 0);
  }

  /** Returns the keys of the charts that are shown even if they cannot vary. */
  forced() {
    return this.charts.filter(({ is_forced }) => is_forced).map(({ spec }) => spec.key);
  }

  set_forced(keys) {
    for (const chart of this.charts) chart.is_forced = keys.includes(chart.spec.key);
  }

  /** Shows a removed or flat chart. */
  restore(key) {
    const chart = this.charts.find(({ spec }) => spec.key === key);
    chart.is_forced = true;
    this.set_off(this.off().filter((each) => each !== key));
  }

  set_off(keys) {
    for (const chart of this.charts) {
      chart.is_off = !chart.spec.fields && keys.includes(chart.spec.key);
      chart.show();
      chart.refresh();
    }
    this.source.on_change();
  }

  /** Removes the charts of all fields. */
  forget_fields() {
    this.charts.filter(({ spec }) => spec.fields).forEach((chart) => this.remove(chart));
  }

  /** Returns [topic, path] of each charted field. */
  fields() {
    return this.charts.flatMap(({ spec }) => [...(spec.fields?.keys() ?? [])].map((topic) => [topic, spec.path]));
  }

  /** Returns the series of all displayed line charts in the displayed interval as comma-separated values. */
  csv() {
    const [from, to] = this.zoomed ?? this.source.window();
    const columns = this.lines().filter(({ is_off }) => !is_off).flatMap((chart) =>
      chart.names().map((name) => ({ title: `${chart.box.title} ${name}`, line: chart.series.get(name) })));
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const rows = [["time [s]", ...columns.map(({ title }) => quoted(title))]];
    if (columns.length > 0) {
      const [times, ...values] = uPlot.join(columns.map(({ line }) => [line.t, line.v]));
      times.forEach((time, i) => {
        if (time >= from && time <= to) rows.push([time.toFixed(6), ...values.map((column) => column[i] ?? "")]);
      });
    }
    return rows.map((row) => row.join(",")).join("\n") + "\n";
  }

  /** Sets the robots, which determine colours and order. @param robots names in the scenario's order */
  set_robots(robots) {
    if (robots.join() === this.robots.join()) return;
    this.robots = robots;
    this.restyle();
  }

  clear() {
    this.robots = [];
    this.zoomed = null;
    for (const chart of this.charts) chart.clear();
  }

  restyle() {
    this.charts.forEach((chart) => chart.restyle());
  }
}

export const live_window = (now) => [Math.max(0, now - kWindow_s), Math.max(now, 10)];
