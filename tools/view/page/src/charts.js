// Charts of numbers over time: what is charted, what is under the cursor, which stretch is shown.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { digits, kDashes, look, robot_css, robot_look, title_of } from "./look.js";

const kWindow_s = 120; // of a live view
const kPoints = 20000; // a series at most
const kRefresh_ms = 500; // of each chart
const kRead = 8; // series whose values are told under the cursor
const kLeast_s = 0.2; // shown at least

const number = (x) => (typeof x === "boolean" ? Number(x) : typeof x === "number" && Number.isFinite(x) ? x : null);
const robot_of = (topic) => topic.split("/")[2];

/** What is charted: `take` gives [series, value] of a record, or nothing. */
const kCharts = [
  { key: "entropy", measure: "entropy", topic: /^\/team$/, take: (r) => ["team", number(r.entropy_nats)] },
  { key: "map_entropy", measure: "map_entropy", topic: /^\/team$/, take: (r) => ["team", number(r.map_entropy_nats)] },
  { key: "rmse", measure: "rmse", topic: /^\/team$/, take: (r) => ["team", number(r.rmse_m)], zero: true },
  {
    key: "margin",
    measure: "margin",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [robot_of(topic), number(r.margin_s * 1e3)],
    zero: true,
  },
  {
    key: "gap",
    measure: "gap",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [robot_of(topic), number(r.gap_nat)],
    zero: true,
  },
  {
    key: "battery",
    measure: "battery",
    topic: /^\/vehicle\//,
    take: (r, topic) => [robot_of(topic), number(r.battery_share * 100)],
    range: [0, 105],
  },
  {
    key: "deadlines",
    measure: "margin",
    title: "plans by deadline margin [ms]",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [robot_of(topic), number(r.margin_s * 1e3)],
    histogram: true,
  },
  { key: "lost", measure: "lost", topic: /^\/team$/, take: (r) => ["team", number(r.messages_lost)], zero: true, count: true },
];

/** The member of a record that a path names: ["a", "0", "b"]. */
export const member = (record, path) => path.reduce((value, key) => value?.[key], record);

/** Topics that differ in whose they are: "/vehicle/Q1" → ["/vehicle/*", "Q1"], "/lcm/PLAN_Q1" → ["/lcm/PLAN_*", "Q1"]. */
export function family_of(topic, robots) {
  for (const robot of robots) {
    const parts = topic.split(new RegExp(`(?<=[/_])${robot.replace(/[^\w]/g, "\\$&")}(?=/|$)`));
    if (parts.length === 2) return [parts.join("*"), robot];
  }
  return [topic, topic.split("/").at(-1)];
}

/** Puts a colour before an element's words. */
function mark_of(element, colour) {
  element.className = "of";
  element.style.setProperty("--of", colour);
}

class Chart {
  constructor(box, spec, source) {
    this.spec = spec;
    this.source = source;
    this.series = new Map(); // name → {t, v}
    this.box = document.createElement("figure");
    this.box.dataset.chart = spec.key;
    this.is_off = false; // taken away by the user
    this.caption = document.createElement("figcaption");
    this.title = document.createElement("b");
    this.title.textContent = this.box.title = spec.title ?? title_of(spec.measure);
    this.names_box = document.createElement("span");
    this.caption.append(this.title, this.names_box);
    const close = document.createElement("button");
    close.textContent = "×";
    close.title = "Take this chart away";
    close.setAttribute("aria-label", `Take ${this.title.textContent} away`);
    close.onclick = () => source.remove(this);
    this.caption.append(close);
    this.body = document.createElement("div");
    this.body.setAttribute("role", "img");
    this.body.setAttribute("aria-label", `${this.title.textContent} over time`);
    this.read = document.createElement("div");
    this.read.className = "read";
    this.read.hidden = true;
    this.box.append(this.caption, this.body);
    box.append(this.box);
    this.show();
  }

  /** A chart is on the page unless it was taken away or has nothing to show. */
  show() {
    this.box.hidden = this.is_off || (!this.spec.fields && this.series.size === 0);
  }

  add(topic, time, record) {
    if (!this.spec.topic.test(topic)) return;
    const [name, value] = this.spec.take(record, topic);
    if (value !== null) this.put(name, time, value);
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
    if (line.t.length > kPoints) {
      line.t.splice(0, kPoints / 10);
      line.v.splice(0, kPoints / 10);
    }
    this.is_stale = true;
  }

  /** Puts a whole series at once. */
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
    return [...this.series.keys()].sort((a, b) => this.source.index_of(a) - this.source.index_of(b) || (a < b ? -1 : 1));
  }

  colour(name) {
    const index = this.source.index_of(name);
    if (index < Infinity) return robot_css(robot_look(index).body);
    const others = [...this.series.keys()].filter((each) => this.source.index_of(each) === Infinity).sort();
    if (others.length > 1) return robot_css(others.indexOf(name) % look.robots.length);
    return getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  }

  dash(name) {
    const index = this.source.index_of(name);
    return index < Infinity ? kDashes[robot_look(index).dash] : [];
  }

  make() {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--quiet").trim();
    const lines = style.getPropertyValue("--line").trim();
    const axis = { stroke: ink, font: "11px system-ui", gap: 3, grid: { stroke: lines, width: 1 }, ticks: { stroke: lines, width: 1, size: 4 } };
    const { zero, range, count } = this.spec;
    this.write_legend(); // which says how much room there is
    this.plot = new uPlot(
      {
        width: Math.max(80, this.body.clientWidth),
        height: Math.max(60, this.body.clientHeight),
        legend: { show: false },
        focus: { alpha: 0.35 },
        cursor: {
          y: false,
          drag: { x: false, y: false, setScale: false },
          focus: { prox: this.series.size > 1 ? 1e6 : -1 },
          sync: { key: "charts", setSeries: false },
          points: { size: 6 },
        },
        hooks: { setCursor: [() => this.tell()] },
        scales: {
          x: { time: false, range: () => this.source.window() },
          y: {
            range: (_, low, high) => {
              if (range) return range;
              if (low === null) return [0, 1];
              if (zero) [low, high] = [Math.min(0, low), Math.max(0, high)];
              if (count) return [0, Math.max(4, 1.08 * high)]; // of whole things
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
    this.plot.over.append(this.mark, this.read);
    this.listen(this.plot.over);
  }

  /** The wheel zooms in time, dragging goes along it, a click goes there, two show all. */
  listen(over) {
    const time_at = (event) => {
      const box = over.getBoundingClientRect();
      const [from, to] = this.source.window(); // which the plot may not have drawn yet
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

  /** Values where the cursor is, those nearest to it first where there are many. */
  tell() {
    const { idx, top } = this.plot.cursor;
    const names = this.names();
    if (idx === null || idx === undefined || !(this.plot.cursor.left >= 0)) {
      this.read.hidden = true;
      return;
    }
    const time = this.plot.data[0][idx];
    // Series are not sampled at the same instants: of each its newest value until then.
    let values = names.map((name, i) => {
      let at = idx;
      while (at > 0 && (this.plot.data[i + 1][at] ?? null) === null) at -= 1;
      return { name, value: this.plot.data[i + 1][at] ?? null };
    }).filter(({ value }) => value !== null);
    const all = values.length;
    if (all > kRead) {
      const under = this.plot.posToVal(top, "y");
      values = values.sort((a, b) => Math.abs(a.value - under) - Math.abs(b.value - under)).slice(0, kRead);
    }
    const line = (text, colour) => {
      const each = document.createElement("div");
      each.textContent = text;
      if (colour) mark_of(each, colour);
      return each;
    };
    const unit = look.measures[this.spec.measure]?.unit ?? "";
    this.read.replaceChildren(
      line(`${time.toFixed(2)} s`),
      ...values.map(({ name, value }) => line(`${names.length > 1 ? `${name} ` : ""}${digits(value)} ${unit}`, this.colour(name))),
      ...(all > kRead ? [line(`and ${all - kRead} more`)] : []),
    );
    this.read.hidden = false;
    this.read.classList.toggle("left", this.plot.cursor.left > this.plot.over.clientWidth / 2);
  }

  /** Names where there is room for all of them; else how many. */
  write_legend() {
    const names = this.names();
    const label = (name) => {
      const each = document.createElement("i");
      each.textContent = name;
      mark_of(each, this.colour(name));
      return each;
    };
    this.names_box.replaceChildren(...(names.length < 2 && !this.spec.fields ? [] : names.map(label)));
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

  /** Marks where we are in a log. Over the plot, so that it need not be drawn again for that. */
  mark_now() {
    const now = this.source.now();
    const [from, to] = this.source.window();
    this.mark.hidden = now === null || now < from || now > to;
    if (!this.mark.hidden) this.mark.style.transform = `translateX(${Math.round(this.plot.valToPos(now, "x"))}px)`;
  }

  refresh() {
    if (this.series.size === 0 || this.body.clientWidth === 0) return;
    const window = this.source.window().join();
    if (!this.plot) {
      this.make();
    } else if (this.is_stale) {
      this.plot.setData(this.table());
    } else if (window !== this.window) {
      this.plot.setScale("x", { min: 0, max: 1 }); // asks for the window again
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
    this.destroy();
    this.show();
    this.read.hidden = true;
  }
}

const kBins = 24; // of a histogram, about

/** How wide bins are so that there are about kBins over a range: 1, 2 or 5 times a power of ten. */
function bin_width(range) {
  const least = Math.max(range, 1e-9) / kBins;
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((each) => each * power >= least);
}

/** How often a number had which value in the stretch that is shown; below zero in the colour of what is late. */
class Histogram extends Chart {
  constructor(...how) {
    super(...how);
    this.body.setAttribute("aria-label", this.title.textContent);
  }

  /** [from, to) of each bin and how many values are in it. */
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
    const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis = { stroke: css("--quiet"), font: "11px system-ui", gap: 3, grid: { stroke: css("--line"), width: 1 }, ticks: { stroke: css("--line"), width: 1, size: 4 } };
    const bars = (label, colour) => ({ label, stroke: colour, fill: colour, width: 0, paths: uPlot.paths.bars({ size: [0.9, 60], align: 0 }), points: { show: false } });
    this.write_legend();
    this.plot = new uPlot(
      {
        width: Math.max(80, this.body.clientWidth),
        height: Math.max(60, this.body.clientHeight),
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false, setScale: false }, points: { show: false } },
        hooks: { setCursor: [() => this.tell()] },
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
    this.plot.over.append(this.read);
  }

  tell() {
    const { idx, left } = this.plot.cursor;
    const start = this.binned.starts[idx ?? -1];
    this.read.hidden = start === undefined || !(left >= 0);
    if (this.read.hidden) return;
    const unit = look.measures[this.spec.measure].unit;
    this.read.textContent = `${digits(start)} to ${digits(start + this.binned.width)} ${unit}: ${this.binned.counts[idx]}`;
    this.read.classList.toggle("left", left > this.plot.over.clientWidth / 2);
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

export class Charts {
  /** @param source {now(), window(), seek(since), on_zoom([from, to] or null), on_change()}: in seconds since the start */
  constructor(box, source) {
    this.box = box;
    this.source = source;
    this.robots = [];
    this.zoomed = null; // what is shown, where it is not all
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
    this.charts = kCharts.map((spec) => new (spec.histogram ? Histogram : Chart)(box, spec, own));
    // One more chart makes the others smaller.
    this.sizes = new ResizeObserver(() => this.charts.forEach((chart) => chart.resize()));
    this.charts.forEach((chart) => this.sizes.observe(chart.body));
    // One after the other: all at once is a pause that one sees.
    let turn = 0;
    setInterval(() => !document.hidden && this.charts[turn++ % this.charts.length]?.refresh(), kRefresh_ms / kCharts.length);
  }

  /** Shows a stretch of time in all charts; null: all of it. */
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

  /** What comes on the topics of charted fields. */
  add_field(topic, time, record) {
    for (const chart of this.charts) {
      const name = chart.spec.fields?.get(topic);
      const value = name && !chart.is_whole ? number(member(record, chart.spec.path)) : null;
      // The newest comes again to who subscribes anew.
      if (value !== null && value !== undefined && chart.series.get(name)?.t.at(-1) !== time) chart.put(name, time, value);
    }
  }

  /** Charts a number of a topic; of topics that differ in whose they are in one chart.
      @param path ["a", "0", "b"] @param points of a log, [since, value]; null: as they come */
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

  /** Those that draw lines over time. */
  lines() {
    return this.charts.filter(({ spec }) => !spec.histogram);
  }

  /** One of a field goes; one of our own can be had back. */
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

  /** Keys of our own charts that were taken away. */
  off() {
    return this.charts.filter(({ is_off }) => is_off).map(({ spec }) => spec.key);
  }

  set_off(keys) {
    for (const chart of this.charts) {
      chart.is_off = !chart.spec.fields && keys.includes(chart.spec.key);
      chart.show();
      chart.refresh();
    }
    this.source.on_change();
  }

  /** Takes the charts of all fields away. */
  forget_fields() {
    this.charts.filter(({ spec }) => spec.fields).forEach((chart) => this.remove(chart));
  }

  /** [topic, path] of each field that is charted. */
  fields() {
    return this.charts.flatMap(({ spec }) => [...(spec.fields?.keys() ?? [])].map((topic) => [topic, spec.path]));
  }

  /** Comma-separated values of all that is shown, in the stretch that is shown. */
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

  /** @param robots names, in the scenario's order */
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
