// Strip charts of the numbers on the stream.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

const kWindow_s = 120; // of a live view
const kPoints = 20000; // a series at most
const kRefresh_ms = 500; // of each chart

const number = (x) => (typeof x === "number" && Number.isFinite(x) ? x : null);
const robot_of = (topic) => topic.split("/")[2];

/** What is charted: `take` gives [series, value] of a record, or nothing. */
const kCharts = [
  { key: "entropy", title: "entropy [nat]", topic: /^\/team$/, take: (r) => ["team", number(r.entropy_nats)] },
  { key: "rmse", title: "RMSE [m]", topic: /^\/team$/, take: (r) => ["team", number(r.rmse_m)], zero: true },
  {
    key: "margin",
    title: "deadline margin [ms]",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [robot_of(topic), number(r.margin_s * 1e3)],
    zero: true,
  },
  {
    key: "gap",
    title: "gap to bound [nat]",
    topic: /^\/plan\/[^/]+\/status$/,
    take: (r, topic) => [robot_of(topic), number(r.gap_nat)],
    zero: true,
  },
  { key: "lost", title: "messages lost", topic: /^\/team$/, take: (r) => ["all", number(r.messages_lost)], zero: true },
  {
    key: "battery",
    title: "battery [%]",
    topic: /^\/vehicle\//,
    take: (r, topic) => [robot_of(topic), number(r.battery_share * 100)],
    range: [0, 105],
  },
];

class Chart {
  /** @param colours by robot, the same in every chart; what is of no robot has the ink's */
  constructor(box, spec, source, colours) {
    this.spec = spec;
    this.source = source;
    this.colours = colours;
    this.series = new Map(); // name → {t, v}
    this.box = document.createElement("figure");
    this.box.dataset.chart = spec.key;
    this.caption = document.createElement("figcaption");
    this.caption.textContent = spec.title;
    this.body = document.createElement("div");
    this.box.append(this.caption, this.body);
    box.append(this.box);
  }

  add(topic, time, record) {
    if (!this.spec.topic.test(topic)) return;
    const [name, value] = this.spec.take(record, topic);
    if (value === null) return;
    if (!this.series.has(name)) {
      this.series.set(name, { t: [], v: [] });
      this.plot?.destroy();
      this.plot = null;
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

  names() {
    return [...this.series.keys()].sort();
  }

  colour(name) {
    return this.colours.get(name) ?? getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  }

  make() {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--quiet").trim();
    const lines = style.getPropertyValue("--line").trim();
    const axis = { stroke: ink, font: "11px system-ui", gap: 3, grid: { stroke: lines, width: 1 }, ticks: { stroke: lines, width: 1, size: 4 } };
    const { zero, range } = this.spec;
    this.plot = new uPlot(
      {
        width: Math.max(80, this.body.clientWidth),
        height: Math.max(60, this.body.clientHeight),
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false } },
        scales: {
          x: { time: false, range: () => this.source.window() },
          y: {
            range: (_, low, high) => {
              if (range) return range;
              if (low === null) return [0, 1];
              if (zero) [low, high] = [Math.min(0, low), Math.max(0, high)];
              const pad = Math.max(1e-6, 0.08 * (high - low || Math.abs(high) || 1));
              return [low < 0 || !zero ? low - pad : 0, high + pad];
            },
          },
        },
        axes: [
          { ...axis, size: 24, space: 45 },
          { ...axis, size: 46, space: 24 },
        ],
        series: [
          {},
          ...this.names().map((name) => ({
            label: name,
            stroke: this.colour(name),
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
    this.plot.over.append(this.mark);
    this.caption.replaceChildren(this.spec.title, ...this.legend());
  }

  legend() {
    const names = this.names();
    if (names.length < 2 || names.length > 6) return [];
    return names.map((name) => {
      const label = document.createElement("span");
      label.textContent = name;
      label.style.color = this.colour(name);
      return label;
    });
  }

  table() {
    const lines = this.names().map((name) => this.series.get(name));
    return lines.length === 0 ? [[], []] : uPlot.join(lines.map((line) => [line.t, line.v]));
  }

  /** Marks where we are in a log. Over the plot, so that it need not be drawn again for that. */
  mark_now() {
    const now = this.source.now();
    this.mark.hidden = now === null;
    if (now !== null) this.mark.style.transform = `translateX(${Math.round(this.plot.valToPos(now, "x"))}px)`;
  }

  refresh() {
    if (this.series.size === 0) return;
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
    this.plot?.setSize({ width: this.body.clientWidth, height: this.body.clientHeight });
  }

  restyle() {
    this.plot?.destroy();
    this.plot = null;
    this.refresh();
  }
}

export class Charts {
  /** @param source {now, window}: in seconds since the start */
  constructor(box, source) {
    this.colours = new Map();
    const charts = kCharts.map((spec) => new Chart(box, spec, source, this.colours));
    this.charts = charts;
    new ResizeObserver(() => charts.forEach((chart) => chart.resize())).observe(box);
    // One after the other: all at once is a pause that one sees.
    let turn = 0;
    setInterval(() => !document.hidden && charts[turn++ % charts.length].refresh(), kRefresh_ms / charts.length);
  }

  add(topic, time, record) {
    this.charts.forEach((chart) => chart.add(topic, time, record));
  }

  /** @param colours [robot, colour] of each */
  set_colours(colours) {
    if (colours.every(([robot, colour]) => this.colours.get(robot) === colour)) return;
    this.colours.clear();
    colours.forEach(([robot, colour]) => this.colours.set(robot, colour));
    this.restyle();
  }

  clear() {
    this.colours.clear();
    for (const chart of this.charts) {
      chart.series.clear();
      chart.plot?.destroy();
      chart.plot = null;
    }
  }

  restyle() {
    this.charts.forEach((chart) => chart.restyle());
  }
}

export const live_window = (now) => [Math.max(0, now - kWindow_s), Math.max(now, 10)];
