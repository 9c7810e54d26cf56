// The page: what the connection hears goes to the world, the charts, the panels and the timeline.

import "./style.css";
import { Charts, live_window } from "./charts.js";
import { Connection } from "./connection.js";
import { css_of } from "./outline.js";
import { Events, Processes, Vehicles, make, write_inspect } from "./panels.js";
import { Timeline, kSpeeds } from "./timeline.js";
import { World } from "./world.js";

const by_id = (id) => document.getElementById(id);

/** Switchable parts of the picture: topics by pattern, a key, shown at first or not. */
const kLayers = [
  { name: "map", topic: /^\/(grid|map)$/, key: "g", shown: true },
  { name: "views", topic: /^\/views$/, key: "f", shown: true },
  { name: "plans", topic: /^\/plan\/[^/]+$/, key: "p", shown: true },
  { name: "proposals", topic: /^\/proposal\/[^/]+$/, key: "s", shown: true },
  { name: "tracks", topic: /^\/tracks$/, key: "t", shown: true },
  { name: "estimates", topic: /^\/estimates$/, key: "e", shown: true },
  { name: "truth", topic: /^\/targets$/, key: "o", shown: true },
  { name: "looks", topic: /^\/measurement\/[^/]+$/, key: "m", shown: false },
  { name: "beliefs", topic: /^\/belief\/[^/]+$/, key: "b", shown: false },
];
/** Always heard: what is moved, and what is told in numbers. */
const kAlways = [/^\/transforms$/, /^\/world$/, /^\/robots$/, /^\/scenario$/, /^\/attack$/, /^\/team$/,
  /^\/events$/, /^\/vehicle\//, /^\/health\//, /^\/plan\/[^/]+\/status$/];

const state = {
  start: null, // of the log, or of the first record heard; seconds since the epoch
  now: null, // since the start
  range: null, // of a log
  session: null,
  speed: 1,
  is_playing: false,
  has_history: false,
  picked: null,
};

/** How the world is drawn, where the address says so (?draw=gl or ?draw=canvas). */
const kDraw = { gl: false, canvas: true }[new URLSearchParams(location.search).get("draw")] ?? null;

const world = new World(by_id("stage"), (id) => pick(id), kDraw);
const vehicles = new Vehicles(by_id("vehicles"));
const processes = new Processes(by_id("processes"));
const events = new Events(by_id("events"), (since) => seek(since));
const charts = new Charts(by_id("charts"), {
  now: () => (state.range ? state.now : null),
  window: () => (state.range ? [0, state.range[1] - state.range[0]] : live_window(state.now ?? 0)),
});
const timeline = new Timeline({
  seek: (since) => seek(since),
  play: (is_playing) => play(is_playing),
  speed: (value) => set_speed(value),
});

function set_badge(text, kind) {
  by_id("link").textContent = text;
  by_id("link").dataset.state = kind;
}

function set_now(time) {
  state.start ??= time;
  state.now = time - state.start;
  timeline.set_now(state.now);
}

function event_of(time, record) {
  return { since: time - state.start, kind: record.name, text: record.message, level: record.level };
}

function clear_all() {
  world.clear_all();
  [vehicles, processes, events, charts, timeline].forEach((part) => part.clear());
  state.start = state.range?.[0] ?? null;
  state.now = null;
  by_id("jammed").hidden = true;
  by_id("empty").hidden = false;
}

/** Charts and marks of a whole log come at once, by HTTP. */
async function load_history(session) {
  const history = await (await fetch("api/history")).json();
  if (session !== state.session) return;
  state.has_history = history.length > 0;
  for (const [topic, utime, record] of history) {
    if (topic === "/events") {
      const event = event_of(utime * 1e-6, record);
      timeline.add_event(event);
      events.add(event);
    } else {
      charts.add(topic, utime * 1e-6 - state.start, record);
    }
  }
}

const takers = [
  [/^\/transforms$/, (record) => world.move(record.transforms)],
  [/^\/scenario$/, (record) => {
    by_id("scenario").textContent = `${record.name} · ${record.robots.length} robots · ${record.targets.length} targets`;
    by_id("empty").hidden = true;
    world.set_bounds(record);
    charts.set_colours(record.robots.map(({ name, color }) => [name, css_of(color)]));
  }],
  [/^\/attack$/, (record) => {
    by_id("jammed").hidden = record.jammed.length === 0;
    by_id("jammed").textContent = `jammed: ${record.jammed.join(", ")}`;
  }],
  [/^\/vehicle\//, (record) => vehicles.on_state(record)],
  [/^\/health\//, (record) => processes.on_health(record)],
  [/^\/plan\/[^/]+\/status$/, (record) => vehicles.on_plan(record)],
  [/^\/(grid|map)$/, (record, topic) => world.update_grid(topic, record)],
  [/./, (record, topic) => record.entities && world.update(topic, record)],
];

const connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/`, {
  open: () => set_badge("connected", "good"),
  close: () => set_badge("no connection", "bad"),
  info: (info) => {
    state.range = info.range ?? null;
    if (info.session !== state.session) {
      state.session = info.session;
      clear_all();
      timeline.set_length(state.range ? state.range[1] - state.range[0] : null);
      if (state.range) {
        set_now(state.range[0]);
        load_history(info.session);
      }
    }
    set_badge(state.range ? "log" : "live", "good");
  },
  channel: (topic) => subscribe(topic),
  status: (status) => status.level > 0 && set_badge(status.message, "warn"),
  time: (time) => set_now(time),
  playback: (now) => {
    if (now.sought) {
      connection.forget_waiting();
      world.expire(Infinity);
    }
    state.is_playing = now.status === "playing";
    state.speed = now.speed;
    timeline.set_playing(state.is_playing, now.speed);
    set_now(now.time);
  },
  record: (topic, time, record) => {
    if (!state.range) set_now(Math.max(time, (state.now ?? 0) + (state.start ?? time)));
    if (topic === "/events") {
      if (!state.has_history) {
        const event = event_of(time, record);
        events.add(event);
        timeline.add_event(event);
      }
      return;
    }
    if (!state.has_history) charts.add(topic, time - state.start, record);
    takers.find(([pattern]) => pattern.test(topic))[1](record, topic);
  },
});

const layer_of = (topic) => kLayers.find((layer) => layer.topic.test(topic));

function subscribe(topic) {
  const layer = layer_of(topic);
  const is_wanted = layer ? layer.shown : kAlways.some((pattern) => pattern.test(topic));
  connection.want(topic, is_wanted);
}

function toggle(layer) {
  layer.shown = !layer.shown;
  layer.button.setAttribute("aria-pressed", layer.shown);
  for (const topic of connection.channels.keys()) {
    if (layer_of(topic) === layer) {
      connection.want(topic, layer.shown);
      if (!layer.shown) world.clear(topic);
    }
  }
}

for (const layer of kLayers) {
  layer.button = make("button", "", layer.name);
  layer.button.title = `${layer.name} (${layer.key.toUpperCase()})`;
  layer.button.dataset.layer = layer.name;
  layer.button.setAttribute("aria-pressed", layer.shown);
  layer.button.onclick = () => toggle(layer);
  by_id("layers").append(layer.button);
}

function play(is_playing, since) {
  if (state.range) connection.play(is_playing, state.speed, since === undefined ? undefined : state.start + since);
}

function seek(since) {
  if (!state.range) return;
  const length_s = state.range[1] - state.range[0];
  play(state.is_playing, Math.min(length_s, Math.max(0, since)));
}

function set_speed(speed) {
  state.speed = speed;
  play(state.is_playing);
}

function step_speed(by) {
  const at = kSpeeds.findIndex((speed) => speed >= state.speed - 1e-6);
  set_speed(kSpeeds[Math.min(kSpeeds.length - 1, Math.max(0, at + by))]);
}

function pick(id) {
  state.picked = id;
  refresh_inspect();
}

function refresh_inspect() {
  const id = state.picked;
  const extra = [];
  const plan = id?.startsWith("robot/") && vehicles.plans.get(id.slice(6));
  if (plan) {
    const put = (key, value, unit) => value !== undefined && extra.push([key, `${value.toFixed(2)} ${unit}`]);
    put("cost", plan.cost_nat, "nat");
    put("lower bound", plan.lower_bound_nat, "nat");
    put("gap", plan.gap_nat, "nat");
    extra.push(["nodes", String(plan.nodes)], ["round", String(plan.round)]);
  }
  write_inspect(by_id("inspect"), id, id && world.find(id), extra);
}

setInterval(() => state.picked && refresh_inspect(), 250);
by_id("inspect").onclick = (event) => event.target.dataset.close && pick(null);

function show_view(view) {
  world.show(view);
  for (const button of by_id("views").children) {
    button.setAttribute("aria-pressed", button.dataset.view === view);
  }
}

for (const button of by_id("views").children) button.onclick = () => show_view(button.dataset.view);

function set_theme(theme) {
  document.documentElement.dataset.theme = theme;
  world.set_stale();
  charts.restyle();
}

const other_theme = () => (document.documentElement.dataset.theme === "dark" ? "light" : "dark");

const kKeys = [
  ["space", "play or pause a log", () => play(!state.is_playing)],
  ["←", "1 s back (with shift 10 s)", (event) => seek(state.now - (event.shiftKey ? 10 : 1))],
  ["→", "1 s on (with shift 10 s)", (event) => seek(state.now + (event.shiftKey ? 10 : 1))],
  ["home", "to the start", () => seek(0)],
  ["end", "to the end", () => seek(Infinity)],
  ["+", "faster", () => step_speed(1)],
  ["-", "slower", () => step_speed(-1)],
  ["1", "plan view", () => show_view("plan")],
  ["2", "3-D", () => show_view("space")],
  ["3", "both", () => show_view("both")],
  ["r", "whole world in view", () => world.fit()],
  ["d", "light or dark", () => set_theme(other_theme())],
  ["?", "these keys", () => (by_id("help").open ? by_id("help").close() : by_id("help").showModal())],
  ["escape", "close what is inspected", () => pick(null)],
  ...kLayers.map((layer) => [layer.key, `${layer.name} on or off`, () => toggle(layer)]),
];

const kNamed = { " ": "space", ArrowLeft: "←", ArrowRight: "→", "=": "+" };

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
  const name = kNamed[event.key] ?? event.key.toLowerCase();
  const found = kKeys.find(([key]) => key === name);
  if (found) {
    if (name !== "escape") event.preventDefault(); // it also closes the dialog
    found[2](event);
  }
});

by_id("reset").onclick = () => world.fit();
by_id("theme").onclick = () => set_theme(other_theme());
by_id("keys").onclick = () => by_id("help").showModal();
by_id("help").onclick = () => by_id("help").close();
const list = make("dl");
for (const [key, what] of kKeys) list.append(make("dt", "", key), make("dd", "", what));
by_id("help").append(make("h2", "", "Keys"), list);

set_theme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
show_view(innerWidth < 1000 ? "plan" : "both");

function loop() {
  requestAnimationFrame(loop); // not called while nobody sees the page
  connection.read_waiting();
  if (state.now !== null) world.expire(state.start + state.now);
  if (world.is_stale()) world.draw();
}
loop();

// For tests: what is on the screen, as numbers.
window.vantage = {
  state,
  stats: () => ({ entities: world.entities(), layers: world.sizes(), frames: world.frames_drawn, series: charts.charts.map((c) => c.series.size) }),
  colours: () => ({
    world: Object.fromEntries(world.shown("/robots").map(({ frame_id, cylinders }) => [frame_id, css_of(cylinders[0].color)])),
    charts: charts.charts.map((chart) => Object.fromEntries((chart.plot?.series ?? []).slice(1).map(({ label, stroke }) => [label, stroke()]))),
  }),
  position: (id) => world.find(id)?.position.toArray() ?? null,
  pixel: (id) => world.pixel(id),
  draw_again: () => world.set_stale(),
};
