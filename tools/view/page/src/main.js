// The page: passes received records to the world, the charts, the panels and the timeline.

import "./style.css";
import { on_refresh } from "./refresh_timer.js";
import { Charts, live_window } from "./charts.js";
import { Connection, seconds_of } from "./connection.js";
import { write_legend } from "./legend.js";
import { Layouts } from "./layouts.js";
import { Operator, take_key } from "./operate.js";
import { read_link, save, write_link } from "./link.js";
import { appearance, color_of_role, color_of_target, set_ground, target_css } from "./appearance.js";
import { css_of } from "./outline.js";
import { Events, Processes, Results, Targets, Vehicles, make, write_inspect } from "./panels.js";
import { plain_rows, raw_rows } from "./plain_names.js";
import { record_live, record_log, send_video, kFps } from "./recording.js";
import { distance_words } from "./ruler.js";
import { Sessions } from "./sessions.js";
import { Timeline, kSpeeds } from "./timeline.js";
import { Topics } from "./topics.js";
import { Trails, trail_entity } from "./trails.js";
import { World } from "./world.js";

const by_id = (id) => document.getElementById(id);

const operate_key = take_key(); // taken before the link in the address is read

/** Layers of the picture that can be switched: pattern of their topics, key, initial state. */
const kLayers = [
  { name: "map", hint: "map, or time since each cell was seen", label: "Map", topic: /^\/(grid|map)$/, key: "g", shown: true },
  { name: "views", hint: "fields of view of the sensors", label: "Views", topic: /^\/views$/, key: "f", shown: true },
  { name: "plans", hint: "committed plans", label: "Plans", topic: /^\/plan\/[^/]+$/, key: "p", shown: true },
  { name: "proposals", hint: "proposals of the robots in this round", label: "Proposals", topic: /^\/proposal\/[^/]+$/, key: "s", shown: true },
  { name: "trails", hint: "past paths", label: "Trails", topic: /^\/trails$/, key: "t", shown: true }, // made by the page with selectable length; replaces /tracks
  { name: "estimates", hint: "team's estimates of the targets", label: "Estimates", topic: /^\/estimates$/, key: "e", shown: true },
  { name: "truth", hint: "true positions of the targets", label: "Truth", topic: /^\/targets$/, key: "o", shown: true },
  { name: "looks", hint: "measurements", label: "Measurements", topic: /^\/measurement\/[^/]+$/, key: "m", shown: false },
  { name: "beliefs", hint: "each robot's own estimates", label: "Per robot", topic: /^\/belief\/[^/]+$/, key: "b", shown: false },
];
/** Topics that are always subscribed: poses, the scene, and the topics of charts and panels. */
const kAlways = [/^\/transforms$/, /^\/world$/, /^\/robots$/, /^\/scenario$/, /^\/attack$/, /^\/team$/,
  /^\/targets\/status$/, /^\/events$/, /^\/vehicle\//, /^\/health\//, /^\/plan\/[^/]+\/status$/];
const kTrails = "/trails";
const kTrail_s = 5; // s; length of the trails at first
const kSilent_s = 3; // s; a live trial without messages for this time has ended, or is not received
const kStateSlack_s = 3; // s; older states (relative to the session) belong to an earlier session
const kSetBack_s = 60; // s; if a live record is older than the newest by this time, a clock was set back
const kTrailPeriod_s = 0.2;
const kShortStep_s = 0.1;
const kTrailLengths_s = [2, 5, 10, 20, 60, 300];

const state = {
  start: null, // s since the epoch: start of the log, or time of the first received record
  now: null, // displayed time, s since the start
  jumps: 0, // number of jumps of the log's player
  range: null, // [start, end] of the log; null: live
  session: null,
  speed: 1,
  is_playing: false,
  has_history: false,
  has_scenario: false,
  picked: null,
  log: null, // name of the log
  arrived: null, // newest time that the server has sent
  awaited: null, // {since, resolve} of the instant that seek_and_wait() waits for
  theme: null, // theme chosen by the user; null: theme of the system
  filming: null, // {is_over} while a video is recorded; else null
  jammed: [],
  colors: new Map(), // colour by body
  newest: new Map(), // newest record of the topics of kNewest, by topic
  received_until: new Map(), // time of the newest live record from the history or the connection, by topic
  trail_s: kTrail_s,
  targets: new Map(), // index in the scenario by name
  heard_at: null, // ms of performance.now() when the last live message was received
  side: "status",
  pending_link: read_link(location.hash), // content of the link, until it is applied
};

/** Parameters of the page's address. ?draw=gl or ?draw=canvas sets the method of drawing. */
const kQuery = new URLSearchParams(location.search);
const kDraw = { gl: false, canvas: true }[kQuery.get("draw")] ?? null;
/** Key of the recording for which this page was opened; null: none. With a key only the stage is shown. */
const kRecord = kQuery.get("record");
if (kRecord) {
  document.body.dataset.shown = "stage";
  // The size of the window of a headless browser is not reliable.
  for (const side of ["width", "height"]) document.body.style[side] = `${Number(kQuery.get(side))}px`;
}

const world = new World(by_id("stage"), (id) => pick(id), kDraw);
const vehicles = new Vehicles(by_id("vehicles"));
const targets = new Targets(by_id("targets"), (name) => target_css(state.targets.get(name) ?? 0), (name) => pick(`${world.find(`target/${name}`) ? "target" : "estimate"}/${name}`));
const results = new Results(by_id("results"));
const sessions = new Sessions(by_id("session"), (index) => show_session(index));
const processes = new Processes(by_id("processes"));
const events = new Events(by_id("events"), by_id("events-filter"), (since) => seek(since));
const charts = new Charts(by_id("charts"), {
  now: () => (state.range ? state.now : null),
  window: () => (state.range ? [0, state.range[1] - state.range[0]] : live_window(state.now ?? 0)),
  seek: (since) => seek(since),
  on_zoom: (zoomed) => {
    timeline.set_span(zoomed);
    by_id("all").hidden = zoomed === null;
    by_id("window").textContent = zoomed === null ? "" : `${zoomed[0].toFixed(1)} to ${zoomed[1].toFixed(1)} s`;
    update_link();
  },
  on_overflow: (left, right) => {
    for (const [id, count, words] of [["before", left, `‹ ${left} more`], ["after", right, `${right} more ›`]]) {
      by_id(id).hidden = count === 0;
      by_id(id).textContent = words;
    }
  },
  on_change: () => {
    write_hidden_charts();
    [...connection.channels.keys()].forEach(subscribe);
    update_link();
  },
});
/** Writes the list of removed charts, from which they can be restored. */
function write_hidden_charts() {
  const box = by_id("hidden-charts");
  const off = charts.unseen();
  if (box.dataset.keys === off.map(({ spec }) => spec.key).join()) return;
  box.dataset.keys = off.map(({ spec }) => spec.key).join();
  box.hidden = off.length === 0;
  box.replaceChildren(new Option("+ chart", ""), ...off.map(({ spec, title }) => new Option(title.textContent, spec.key)));
}

const operator = operate_key ? new Operator(by_id("operator"), operate_key) : null;

const trails = new Trails();
const topics = new Topics(by_id("topics"), {
  open: (topic, is_open) => {
    subscribe(topic);
    // A paused log sends no messages; a seek to the current position makes the server send the newest one.
    if (is_open && state.range && !state.is_playing) seek(state.now);
  },
  plot: (topic, path) => plot(topic, path),
  is_log: () => state.range !== null,
});
const timeline = new Timeline({
  date: (since) => (state.start === null ? "" : new Date(1e3 * (state.start + since)).toISOString().replace("T", " ").replace("Z", " UTC")),
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
  [vehicles, targets, results, processes, events, charts, timeline, trails, topics].forEach((part) => part.clear());
  state.newest.clear();
  state.received_until.clear();
  state.has_scenario = false;
  state.start = state.range?.[0] ?? null;
  state.now = null;
  by_id("jammed").hidden = true;
  by_id("empty").hidden = false;
}

on_refresh(() => write_hidden_charts(), 5);

/** Shows a session of the list: a log jumps to the start of the session; a live view shows the stored records of that session. */
function show_session(index) {
  sessions.choose(index);
  state.shown_session = sessions.is_last() ? undefined : index;
  if (state.range) return seek(Math.max(0, sessions.list[index].from - state.start));
  clear_all();
  connection.pause();
  connection.renew();
  load_history(state.session);
}

/** Writes whether a live trial runs, has ended or is awaited. */
function write_liveness() {
  if (state.range || !connection.is_open()) return;
  const silent_s = state.heard_at === null ? null : (performance.now() - state.heard_at) / 1000;
  const is_past = !sessions.is_last();
  const is_over = is_past || (silent_s !== null && silent_s > kSilent_s);
  const was_stopped = [...processes.healths.values()].some(({ state: each }) => each === "stopping");
  const ago = silent_s === null ? "" : silent_s < 120 ? `${silent_s.toFixed(0)} s ago` : `${(silent_s / 60).toFixed(0)} min ago`;
  if (silent_s === null && !is_past) set_badge("waiting for messages", "warn");
  else if (is_past) set_badge("earlier trial", "calm");
  else if (is_over) set_badge(was_stopped ? `ended ${ago}` : `no messages since ${ago.replace(" ago", "")}`, was_stopped ? "calm" : "warn");
  else set_badge("live", "good");
  document.body.dataset.ended = is_over ? "yes" : "";
  by_id("ended").hidden = !is_over;
  if (!is_over) return;
  by_id("ended").textContent = is_past ? "An earlier trial of this bus: its result, charts and events. Its log shows the world."
    : was_stopped ? `The trial has ended ${ago}. This is its last state.` : `No messages for ${ago.replace(" ago", "")}. This is the last received state.`;
}
on_refresh(() => write_liveness());
on_refresh(() => {
  events.mark_now(state.range && state.now !== null ? state.now : null);
  if (!state.range || state.now === null) return;
  sessions.follow(state.start + state.now);
  results.show_step(state.start + state.now);
});

/** Loads the history by HTTP: for a log all records, in a live view the records that the server has stored. */
async function load_history(session) {
  let history = [];
  try {
    history = await (await fetch("api/history")).json();
  } catch {
    // The connection has failed as well and will be opened again.
  }
  if (session !== state.session) return;
  for (const [topic, utime, record] of history) {
    if (topic === "/scenario") sessions.add(record, seconds_of(utime));
  }
  if (!state.range && sessions.list.length > 1) {
    if (state.shown_session !== undefined) sessions.choose(Math.min(state.shown_session, sessions.list.length - 1));
    const [from, to] = sessions.range(sessions.chosen);
    history = history.filter(([, utime]) => seconds_of(utime) >= from && seconds_of(utime) < to);
  }
  if (!state.range && history.length > 0) state.start = seconds_of(history[0][1]);
  state.has_history = state.range !== null && history.length > 0;
  for (const [topic, utime, record] of history) {
    const time = seconds_of(utime);
    if (!state.range) state.received_until.set(topic, time);
    if (topic === "/scenario" || topic === "/targets/status" || topic === "/team") {
      if (state.range && topic === "/team") results.add_step(time, record);
      if (!state.range) handlers.find(([pattern]) => pattern.test(topic))?.[1](record, topic, time);
    }
    if (!state.range && /^\/(vehicle|health)\//.test(topic)) handlers.find(([pattern]) => pattern.test(topic))[1](record, topic, time);
    if (topic === "/scenario") continue;
    if (topic === "/paths") {
      for (const [body, at] of Object.entries(record)) trails.add(body, time, ...at);
      state.trails_at = null; // draws the trails again even if the time does not change
    } else if (topic === "/events") {
      const event = event_of(time, record);
      timeline.add_event(event);
      events.add(event);
      const found = event.kind === "found" && event.text.match(/^(.+) found by (.+)$/);
      if (found && state.range) targets.on_found(found[1], event.since, found[2]);
    } else {
      charts.add(topic, time - state.start, record);
    }
  }
  if (!state.range && history.length > 0) {
    const last = seconds_of(history.at(-1)[1]);
    set_now(last);
    // The clock of this browser may differ from the server's; a small difference does not mean that
    // the trial has ended.
    state.heard_at ??= performance.now() - 1000 * Math.max(0, Date.now() / 1000 - last);
    place_bodies();
  }
  connection.resume();
  charts.fields().forEach(([topic, path]) => plot(topic, path));
  apply_link();
  if (kRecord) record();
}

/** Places each body that was not moved yet at the end of its path, so that an ended trial shows its last state. */
function place_bodies() {
  for (const [body, { x, y, z }] of trails.paths) {
    if (x.length === 0 || world.frame(body).is_placed) continue;
    const translation = { x: x.at(-1), y: y.at(-1), z: z.at(-1) };
    world.move([{ child_frame_id: body, translation, rotation: { x: 0, y: 0, z: 0, w: 1 } }]);
  }
}

/** Makes the video that the address requests. */
async function record() {
  const from = Number(kQuery.get("from"));
  await send_video(kRecord, async (on_progress) => {
    await seek_and_wait(from);
    while (state.wanted_cameras) await new Promise((resolve) => setTimeout(resolve, 20));
    return make_video({ from, to: Math.min(Number(kQuery.get("to")), state.range[1] - state.range[0]), speed: Number(kQuery.get("speed")), fps: Number(kQuery.get("fps")), on_progress });
  });
}

/** True if a live record was already received, in the history or by the connection. (The server sends the newest record
    again after each subscription.) */
function was_received(topic, time) {
  if (state.range) return false;
  const name = topic === "/transforms" ? "/paths" : topic; // topic of the bodies' positions in the history
  const until = state.received_until.get(name) ?? -Infinity;
  if (time <= until && time > until - kSetBack_s) return true;
  if (topic !== "/events") state.received_until.set(name, time); // events may share a time; the server does not repeat events
  return false;
}

function set_jammed(jammed) {
  state.jammed = jammed;
  by_id("jammed").hidden = jammed.length === 0;
  by_id("jammed").textContent = `jammed: ${jammed.join(", ")}`;
}

function move(record, time, is_known) {
  world.move(record.transforms);
  if (state.has_history || is_known) return;
  for (const { child_frame_id, translation: { x, y, z } } of record.transforms) trails.add(child_frame_id, time, x, y, z);
}

const handlers = [
  [/^\/transforms$/, (record, topic, time, is_known) => move(record, time, is_known)],
  [/^\/team$/, (record) => results.on_team(record)],
  [/^\/targets\/status$/, (record) => {
    targets.on_states(record);
    results.on_targets(targets.counts());
  }],
  [/^\/scenario$/, (record) => {
    state.targets = new Map(record.targets.map(({ name }, i) => [name, i]));
    const what = record.objective === "mapping" ? "mapping" : `${record.targets.length} targets`;
    by_id("scenario").textContent = `${record.name} · ${record.robots.length} robots · ${what}`;
    by_id("empty").hidden = true;
    document.title = `${record.name} · vantage`;
    state.has_scenario = true;
    state.memory_s = record.grid_memory_s;
    world.set_bounds(record);
    state.colors = new Map(record.robots.map(({ name, color }) => [name, color]));
    state.trails_at = null; // draws the trails again with the robots' colours
    charts.set_robots(record.robots.map(({ name }) => name));
  }],
  [/^\/attack$/, (record) => set_jammed(record.jammed)],
  [/^\/vehicle\//, (record) => vehicles.on_state(record)],
  [/^\/health\//, (record) => processes.on_health(record)],
  [/^\/plan\/[^/]+\/status$/, (record) => vehicles.on_plan(record)],
  [/^\/(grid|map)$/, (record, topic) => {
    // If there is a map, it is shown instead of the grid of last-seen times.
    if (!layer_of(topic).shown || (topic === "/grid" && world.layers.has("/map"))) return;
    if (topic === "/map") world.clear("/grid");
    world.update_grid(topic, record);
  }],
  [/^\/(?!lcm\/)/, (record, topic) => record.entities && (layer_of(topic)?.shown ?? true) && world.update(topic, tinted(topic, record))],
];

/** Draws each target's true position and its estimates in the colour of the target. */
function tinted(topic, record) {
  if (!/^\/(targets|estimates|belief\/[^/]+)$/.test(topic)) return record;
  for (const { id, cubes, lines, texts } of record.entities) {
    const index = state.targets.get(id.split("/").at(-1));
    if (index === undefined) continue;
    const color = color_of_target(index);
    for (const part of [...cubes, ...lines, ...texts]) part.color = { ...color, a: part.color.a };
  }
  return record;
}

const connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/`, {
  open: () => set_badge("connected", "good"),
  close: () => set_badge("no connection", "bad"),
  info: (info) => {
    state.range = info.range ?? null;
    if (info.session !== state.session) {
      state.session = info.session;
      clear_all();
      state.log = state.range ? (info.name.replace(/^vantage /, "").split("/").at(-1) ?? null) : null;
      timeline.set_length(state.range ? state.range[1] - state.range[0] : null);
      if (state.range) set_now(state.range[0]);
      state.bus = state.range ? null : info.name.replace(/^vantage ?/, "");
      sessions.clear();
      state.shown_session = undefined;
      write_empty(state.range ? ["The log is being read."] : nothing_yet());
      const of_another = state.pending_link?.log && state.pending_link.log !== state.log;
      by_id("note").hidden = !of_another;
      if (of_another) by_id("note").textContent = `the link is for ${state.pending_link.log}, but this server shows ${state.log ?? "live data"}`;
      connection.pause();
      load_history(info.session);
    }
    if (state.range) set_badge(`log ${state.log}`, "good");
    else write_liveness();
  },
  channel: (topic) => subscribe(topic),
  channels: () => update_scene(),
  status: ({ level, id, message }) => {
    if (id === "reading") set_badge([`log ${state.log}`, message].filter(Boolean).join(" · "), "good");
    else if (level > 0) set_badge(message, "warn");
  },
  time: (time) => {
    state.arrived = time; // all records up to this instant have been received
    set_now(time);
    if (state.awaited && Math.abs(state.now - state.awaited.since) < 2e-6) {
      state.awaited.resolve();
      state.awaited = null;
    }
  },
  playback: (now) => {
    if (now.sought) {
      state.jumps += 1;
      connection.forget_waiting();
      world.expire(Infinity);
      if (!state.has_history) trails.clear();
    }
    state.is_playing = now.status === "playing";
    state.speed = now.speed;
    timeline.set_playing(state.is_playing, now.speed);
    set_now(now.time);
  },
  record: (topic, time, record) => {
    if (!state.range) {
      if (topic === "/scenario" && is_next_session(record, time)) return;
      if (!sessions.is_last()) return; // an earlier session is shown
      if (sessions.list.length > 1 && time < sessions.list.at(-1).from - kStateSlack_s) return;
    }
    const is_known = was_received(topic, time);
    if (!state.range && !is_known && kHeard.test(topic)) state.heard_at = performance.now();
    if (!state.range) set_now(Math.max(time, (state.now ?? 0) + (state.start ?? time)));
    topics.take(topic, record);
    if (topic === "/events") {
      if (!state.has_history && !is_known) {
        const event = event_of(time, record);
        events.add(event);
        timeline.add_event(event);
      }
      return;
    }
    if (!state.has_history && !is_known) charts.add(topic, time - state.start, record);
    charts.add_field(topic, time - state.start, record);
    if (kNewest.test(topic)) state.newest.set(topic, record);
    handlers.find(([pattern]) => pattern.test(topic))?.[1](record, topic, time, is_known);
  },
});

/** Topics of messages that show that a trial runs. */
const kHeard = /^\/(transforms|team|vehicle\/|health\/|plan\/)/;

/** Notes a new session of a live view; returns true if it replaces another session, which is then cleared. */
function is_next_session(record, time) {
  const was_last = sessions.is_last();
  if (!sessions.add(record, time) || sessions.list.length < 2) return false;
  if (!was_last) {
    sessions.choose(state.shown_session);
    return true;
  }
  show_session(sessions.list.length - 1);
  return true;
}

/** Returns the lines of an empty live page: what is awaited and what to do. */
const nothing_yet = () => [
  `Nothing received yet${state.bus ? ` on ${state.bus}` : ""}.`,
  "Start a trial in another terminal: vantage up config/lab.yaml, or watch a simulated one: vantage demo --view.",
  "If a trial is running, it uses another network: give its address to vantage view --url.",
];

function write_empty(lines) {
  by_id("empty").replaceChildren(...lines.map((line) => make("p", "", line)));
}

/** Hides the stage for a log without a scenario. The log's messages can still be read and charted. */
function update_scene() {
  const has_none = state.range !== null && connection.channels.size > 0 && !connection.channels.has("/scenario");
  if (has_none === (document.body.dataset.scene === "none")) return;
  document.body.dataset.scene = has_none ? "none" : "";
  write_empty(has_none
    ? ["This log has no scenario. Its topics are listed at the side: open one, and press + next to a number to chart it."]
    : state.range ? ["The log is being read."] : nothing_yet());
  if (has_none) show_side("topics");
}

const kNewest = /^\/(vehicle\/|health\/|plan\/[^/]+\/status$)/;

const layer_of = (topic) => kLayers.find((layer) => layer.topic.test(topic));

function subscribe(topic) {
  const layer = layer_of(topic);
  const is_wanted =
    (layer ? layer.shown : kAlways.some((pattern) => pattern.test(topic))) ||
    topics.is_open(topic) ||
    (!state.range && charts.fields().some(([charted]) => charted === topic));
  connection.want(topic, is_wanted);
}

function toggle(layer) {
  layer.shown = !layer.shown;
  layer.button.setAttribute("aria-pressed", layer.shown);
  if (layer.topic.test(kTrails)) {
    if (layer.shown) draw_trails();
    else world.clear(kTrails);
  }
  for (const topic of connection.channels.keys()) {
    if (layer_of(topic) === layer) {
      subscribe(topic);
      if (!layer.shown) world.clear(topic);
    }
  }
  refresh_legend();
  update_link();
}

/** Returns a field's values over a complete log. Returns null if live, if the log is too large, or on failure: values are
    then added when records arrive. */
async function points_of(topic, path) {
  if (!state.range) return null;
  const field = path.map((key) => `/${key.replaceAll("~", "~0").replaceAll("/", "~1")}`).join("");
  try {
    const points = (await (await fetch(`api/series?${new URLSearchParams({ topic, field })}`)).json())
      .map(([utime, value]) => [seconds_of(utime) - state.start, value]);
    return points.length === 0 ? null : points; // the server returns no points for a log that is too large
    } catch {
    return null; // the connection has failed as well
  }
}

/** Resolves once the scenario is known, if there is one: family_of() needs the robots' names. */
async function scenario_known() {
  const is_awaited = () => (connection.channels.size === 0 ? state.range !== null : connection.channels.has("/scenario") && !state.has_scenario);
  while (is_awaited()) await new Promise((resolve) => setTimeout(resolve, 20));
}

let plotted = Promise.resolve();
let requested_fields = []; // [topic, path] of each requested field until its values arrive
/** Charts a number of a topic: over a complete log, or in a live view from now on. The charts are in the order of the requests,
    even if the answers arrive in another order. */
function plot(topic, path) {
  const field = [topic, path];
  requested_fields.push(field);
  plotted = Promise.all([points_of(topic, path), plotted.catch(() => {}), scenario_known()]).then(([points]) => {
    if (!requested_fields.includes(field)) return; // another layout has cancelled the request
    requested_fields = requested_fields.filter((each) => each !== field);
    charts.plot(topic, path, points);
  });
  return plotted;
}

/** Returns [topic, path] of each charted or requested field, for links and layouts. */
function wanted_fields() {
  const charted = charts.fields();
  const names = new Set(charted.map((field) => field.join()));
  return [...charted, ...requested_fields.filter((field) => !names.has(field.join()))];
}

function draw_trails() {
  state.trails_at = state.now;
  if (!kLayers.find(({ topic }) => topic.test(kTrails)).shown || state.now === null) return;
  const now = state.start + state.now;
  for (const body of trails.paths.keys()) {
    const points = trails.points(body, now, state.trail_s);
    const frame = world.frames.get(body);
    if (frame?.is_placed && points.length > 0) {
      const [x, y, z] = frame.matrix.elements.slice(12);
      points.push({ x, y, z });
    }
    const color = state.colors.get(body) ?? color_of_role("truth");
    world.put(kTrails, body, { frame: world.fixed, entity: trail_entity(body, points, color) });
  }
  world.set_stale();
}

for (const layer of kLayers) {
  layer.button = make("button", "chip", layer.label);
  layer.button.title = `${layer.hint} (${layer.key.toUpperCase()})`;
  layer.button.dataset.layer = layer.name;
  layer.button.setAttribute("aria-pressed", layer.shown);
  layer.button.onclick = () => toggle(layer);
  by_id("layers").append(layer.button);
}
const trail_select = make("select");
trail_select.id = "trail";
const trail_label = make("label", "quiet", "Trails of ");
trail_select.title = "Length of the trails";
trail_select.setAttribute("aria-label", "Length of the trails");
trail_select.replaceChildren(...kTrailLengths_s.map((length_s) => new Option(`${length_s} s`, length_s)), new Option("all", 1e9));
trail_select.onchange = () => {
  set_trail(Number(trail_select.value));
  trail_select.blur();
};
trail_label.append(trail_select);
by_id("layers").append(trail_label);

/** Dims the layers for which nothing was received. */
on_refresh(() => {
  for (const { button, topic, name } of kLayers) {
    const has_any = name === "trails" ? trails.paths.size > 0 : [...connection.channels.keys()].some((each) => topic.test(each));
    button.dataset.empty = has_any ? "" : "yes";
  }
}, 5);

function set_trail(length_s) {
  state.trail_s = length_s;
  trail_select.value = String(length_s);
  draw_trails();
  refresh_legend();
  update_link();
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
  world.select(id);
  if (id === null && world.followed && world.followed !== "team") follow(null);
  refresh_inspect();
  update_link();
}

function follow(id) {
  world.follow(id);
  by_id("follow").setAttribute("aria-pressed", id !== null);
  refresh_inspect();
  update_link();
}

const toggle_follow = () => follow(world.followed ? null : (state.picked ?? "team"));

const metadata_of = (found) => plain_rows("drawn", Object.fromEntries((found?.entity.metadata ?? []).map(({ key, value }) => [key, value])));

function refresh_inspect() {
  const id = state.picked;
  if (id === null) return write_inspect(by_id("inspect"), null, "", false, []);
  const found = world.find(id);
  const [kind, name] = [id.split("/")[0], id.split("/").slice(1).join("/")];
  const first = [];
  if (found) {
    const { x, y, z } = found.position;
    first.push(["at", `${x.toFixed(2)}, ${y.toFixed(2)}, ${z.toFixed(2)} m`]);
    if (found.yaw_rad !== null) first.push(["heading", `${((180 / Math.PI) * found.yaw_rad).toFixed(0)}°`]);
    const speed = state.now === null ? null : trails.speed(name, state.start + state.now);
    if (speed !== null && (kind === "robot" || kind === "target")) first.push(["speed", `${speed.toFixed(2)} m/s`]);
    first.push(...metadata_of(found));
  } else {
    first.push(["gone", "no longer on the bus"]);
  }
  const parts = [["", first]];
  const raw = [];
  const section = (title, topic, what) => {
    const record = state.newest.get(topic);
    if (!record) return;
    parts.push([title, plain_rows(what, record)]);
    raw.push(...raw_rows(record).map(([key, value]) => [`${title} ${key}`, value]));
  };
  if (kind === "robot") {
    section("Plan", `/plan/${name}/status`, "plan");
    section("Vehicle", `/vehicle/${name}`, "vehicle");
    for (const topic of [...state.newest.keys()].sort()) {
      if (topic.startsWith("/health/") && topic.endsWith(`_${name}`)) section(`Process ${topic.slice(8)}`, topic, "health");
    }
  }
  if (kind === "target" || kind === "estimate") {
    const [truth, estimate] = [world.find(`target/${name}`), world.find(`estimate/${name}`)];
    if (estimate && kind === "target") parts.push(["Team's estimate", metadata_of(estimate)]);
    if (truth?.is_placed && estimate) {
      const [a, b] = [truth.position, estimate.position];
      parts.push(["From the true to the estimated position", [["distance", distance_words([a.x, a.y], [b.x, b.y]).replaceAll(" · ", ", ")]]]);
    }
    for (const robot of state.colors.keys()) {
      const belief = world.find(`belief/${robot}/${name}`);
      if (belief) parts.push([`Estimate of ${robot}`, metadata_of(belief)]);
    }
  }
  write_inspect(by_id("inspect"), id, `${name} · ${kind}`, world.followed === id, parts, raw);
}

on_refresh(() => state.picked && refresh_inspect());
by_id("inspect").onclick = (event) => {
  if (event.target.dataset.act === "close") pick(null);
  if (event.target.dataset.act === "follow") follow(world.followed === state.picked ? null : state.picked);
};

/** Writes the legend of the glyphs that are visible now. */
function refresh_legend() {
  const sizes = Object.entries(world.sizes()).filter(([, size]) => size > 0).map(([topic]) => topic);
  const has = (pattern) => sizes.some((topic) => pattern.test(topic));
  const world_ids = [...(world.layers.get("/world")?.keys() ?? [])];
  const plans = has(/^\/plan\//) ? [...vehicles.plans.values()] : [];
  const is_mapped = has(/^\/map$/);
  write_legend(by_id("legend").querySelector("ul"), [
    has(/^\/robots$/) && "robot",
    state.jammed.length > 0 && "jammed",
    has(/^\/views$/) && "view",
    has(/^\/plan\//) && "plan",
    plans.some(({ late }) => late) && "late",
    plans.some(({ late, source }) => !late && source !== "searched") && "fallback",
    has(/^\/proposal\//) && "proposal",
    has(/^\/trails$/) && "trail",
    has(/^\/targets$/) && "truth",
    has(/^\/(estimates|belief\/.*)$/) && "estimate",
    has(/^\/measurement\//) && "look",
    ...(has(/^\/grid$/) && !is_mapped ? ["seen", "stale", "unseen"] : []),
    ...(is_mapped ? ["occupied", "free", "unknown"] : []),
    world_ids.some((id) => id.startsWith("obstacle")) && "obstacle",
    world_ids.some((id) => id.startsWith("region")) && "region",
  ].filter(Boolean), { trail: state.trail_s > 1e8 ? " minutes" : ` ${state.trail_s} s`, stale: ` ${state.memory_s > 0 ? state.memory_s : 30} s` });
}
on_refresh(refresh_legend, 2);

let link_timer = null;
/** Writes the current state of the page into the address bar after a short delay. */
function update_link() {
  link_timer ??= setTimeout(() => {
    link_timer = null;
    if (!state.pending_link) history.replaceState(null, "", `${location.search}#${link_text()}`);
  }, 400);
}

const kShownAtFirst = new Map(kLayers.map(({ name, shown }) => [name, shown]));

function link_text() {
  const changed = (is_shown) => kLayers.filter(({ name, shown }) => shown === is_shown && kShownAtFirst.get(name) !== shown).map(({ name }) => name);
  return write_link({
    log: state.log,
    since: state.range ? state.now : null,
    view: world.view,
    cameras: world.is_fitted ? null : world.cameras(),
    on: changed(true),
    off: changed(false),
    trail_s: state.trail_s === kTrail_s ? null : state.trail_s,
    zoomed: charts.zoomed,
    charts_off: charts.off(),
    charts_on: charts.forced(),
    theme: state.theme,
    fields: wanted_fields(),
    picked: state.picked,
    side: state.side === "status" ? null : state.side,
    follow: world.followed,
  });
}

/** Applies the content of a link once the history is loaded. */
function apply_link() {
  const { pending_link: wanted } = state;
  state.pending_link = null;
  if (!wanted) return;
  if (wanted.theme) set_theme(wanted.theme);
  charts.set_forced(wanted.charts_on);
  charts.set_off(wanted.charts_off);
  if (wanted.since !== null && state.range) seek(wanted.since);
  for (const layer of kLayers) {
    const is_shown = wanted.on.includes(layer.name) || (kShownAtFirst.get(layer.name) && !wanted.off.includes(layer.name));
    if (is_shown !== layer.shown) toggle(layer);
  }
  if (wanted.view) show_view(wanted.view);
  if (wanted.trail_s) set_trail(wanted.trail_s);
  if (wanted.zoomed) charts.zoom(...wanted.zoomed);
  wanted.fields.forEach(([topic, path]) => plot(topic, path));
  if (wanted.picked) pick(wanted.picked);
  if (wanted.side) show_side(wanted.side);
  if (wanted.cameras) {
    // Apply the link's cameras only after the world's size is known, because fitting to the size would override them.
    state.wanted_cameras = wanted.cameras;
    const look_when_known = () => {
      if (!world.layers.has("/world") || !state.has_scenario) return setTimeout(look_when_known, 50);
      world.view_from(wanted.cameras);
      state.wanted_cameras = null;
    };
    look_when_known();
  }
  if (wanted.follow) follow(wanted.follow);
}

addEventListener("hashchange", () => {
  state.pending_link = read_link(location.hash);
  apply_link();
});

async function share() {
  const address = `${location.origin}${location.pathname}${location.search}#${link_text()}`;
  history.replaceState(null, "", address);
  try {
    await navigator.clipboard.writeText(address);
    notify("link copied");
  } catch {
    notify("not copied: the link is in the address bar");
  }
}

/** Shows a message for 2.5 s. */
function notify(words) {
  by_id("note").textContent = words;
  by_id("note").hidden = false;
  setTimeout(() => (by_id("note").hidden = true), 2500);
}

/** Paints the stage into a canvas, with the scenario, the log and the time in a line below. */
function paint_stage(out) {
  world.set_stale();
  world.draw(); // the content of a WebGL canvas is valid only until it is displayed
  const canvases = [by_id("world"), by_id("names")].filter((canvas) => canvas.offsetWidth > 0);
  const { width, height } = by_id("names");
  const ratio = width / by_id("stage").clientWidth;
  const line = Math.round(26 * ratio);
  const even = (pixels) => pixels - (pixels % 2); // video encoders need even sizes
  if (out.width !== even(width) || out.height !== even(height + line)) [out.width, out.height] = [even(width), even(height + line)];
  const pen = out.getContext("2d");
  const style = getComputedStyle(document.documentElement);
  pen.fillStyle = style.getPropertyValue("--stage");
  pen.fillRect(0, 0, out.width, out.height);
  canvases.forEach((canvas) => pen.drawImage(canvas, 0, 0, width, height));
  pen.fillStyle = style.getPropertyValue("--quiet");
  pen.font = `${13 * ratio}px system-ui, sans-serif`;
  pen.textBaseline = "middle";
  pen.fillText([by_id("scenario").textContent, state.log ?? "live", by_id("clock").textContent, `ellipses: ${100 * appearance.ellipse_probability} %`].join("   ·   "), 12 * ratio, height + line / 2);
}

function take_shot() {
  const out = document.createElement("canvas");
  paint_stage(out);
  out.toBlob((blob) => save(`vantage_${file_stem()}.png`, blob));
}

/** Seeks to an instant of a log; resolves once the world shows that instant. */
function seek_and_wait(since) {
  return new Promise((resolve) => {
    state.awaited = { since, resolve };
    play(false, since);
  }).then(() => {
    connection.read_waiting();
    world.expire(state.start + state.now);
    draw_trails();
  });
}

/** Returns the interval of a video of a log: the zoomed interval of the charts, else from the current position to the end. */
const film_stretch = () => charts.zoomed ?? [state.now, state.range[1] - state.range[0]];

function make_video(how) {
  const common = { fps: kFps, paint: paint_stage, is_over: () => state.filming.is_over, ...how };
  state.filming = { is_over: false };
  return state.range ? record_log({ speed: state.speed, go_to: seek_and_wait, ...common }) : record_live(common);
}

/** Begins a video, or ends it and saves the recorded part. */
async function toggle_video() {
  if (state.filming) {
    state.filming.is_over = true;
    return;
  }
  const [from, to] = state.range ? film_stretch() : [];
  const name = `vantage_${file_stem()}.webm`;
  const button = by_id("video");
  button.setAttribute("aria-pressed", true);
  const on_progress = (done) => (button.textContent = state.range ? `${Math.round(100 * done)} %` : `${done.toFixed(0)} s`);
  try {
    save(name, new Blob([await make_video({ from, to, on_progress })], { type: "video/webm" }));
  } catch (error) {
    notify(`no video: ${error.message}`);
  }
  state.filming = null;
  button.setAttribute("aria-pressed", false);
  button.textContent = "Video";
}

const file_stem = () => `${(state.log ?? "live").replace(/\.lcmlog$/, "").replace(/[^\w-]+/g, "_")}_${(state.now ?? 0).toFixed(1)}s`;

function save_csv() {
  save(`vantage_${file_stem()}.csv`, new Blob([charts.csv()], { type: "text/csv" }));
}

function show_side(side) {
  state.side = side;
  for (const name of ["status", "topics"]) {
    by_id(name).hidden = name !== side;
    by_id(`tab-${name}`).setAttribute("aria-selected", name === side);
  }
  topics.show(side === "topics");
  update_link();
}

/** Parts of a narrow page, of which one is shown below the stage. */
const kParts = ["targets", "vehicles", "events", "charts", "topics"];
function show_part(part) {
  document.body.dataset.part = part;
  for (const button of by_id("narrow-tabs").children) button.setAttribute("aria-pressed", button.dataset.part === part);
  show_side(part === "topics" ? "topics" : "status");
}
for (const part of kParts) {
  const button = make("button", "", part[0].toUpperCase() + part.slice(1));
  button.dataset.part = part;
  button.onclick = () => show_part(part);
  by_id("narrow-tabs").append(button);
}
document.body.dataset.part = "targets";
by_id("narrow-tabs").firstChild.setAttribute("aria-pressed", true);

function toggle_measure() {
  world.measure(!world.is_measuring);
  by_id("measure").setAttribute("aria-pressed", world.is_measuring);
}

function show_view(view) {
  world.show(view);
  update_link();
  for (const button of by_id("views").children) {
    button.setAttribute("aria-pressed", button.dataset.view === view);
  }
}

for (const button of by_id("views").children) button.onclick = () => show_view(button.dataset.view);

function set_theme(theme) {
  document.documentElement.dataset.theme = theme;
  set_ground(theme);
  world.repaint();
  charts.restyle();
  refresh_legend();
}

/** Returns the current layout as text: a link without log, time, interval and selection. */
function layout_text() {
  const text = new URLSearchParams(link_text());
  ["log", "t", "win", "pick"].forEach((key) => text.delete(key));
  return text.toString();
}

function apply_layout(text) {
  requested_fields = [];
  charts.forget_fields();
  follow(null);
  const wanted = read_link(text);
  if (!wanted.cameras) fit();
  if (!wanted.trail_s) set_trail(kTrail_s);
  show_side(wanted.side ?? "status");
  state.pending_link = wanted;
  apply_link();
}

const layouts = new Layouts(by_id("layouts"), { take: layout_text, give: apply_layout, failed: notify });

const other_theme = () => (document.documentElement.dataset.theme === "dark" ? "light" : "dark");

/** Switches the theme. Links contain only a theme that the user has chosen, not the system's theme. */
function choose_theme() {
  state.theme = other_theme();
  set_theme(state.theme);
  update_link();
}

const kKeys = [
  ["space", "play or pause a log", () => play(!state.is_playing)],
  ["←", "1 s back (with shift 10 s)", (event) => seek(state.now - (event.shiftKey ? 10 : 1))],
  ["→", "1 s forward (with shift 10 s)", (event) => seek(state.now + (event.shiftKey ? 10 : 1))],
  [",", "0.1 s back", () => seek(state.now - kShortStep_s)],
  [".", "0.1 s forward", () => seek(state.now + kShortStep_s)],
  ["home", "to the start", () => seek(0)],
  ["end", "to the end", () => seek(Infinity)],
  ["+", "faster", () => step_speed(1)],
  ["-", "slower", () => step_speed(-1)],
  ["1", "plan view", () => show_view("plan")],
  ["2", "3-D", () => show_view("space")],
  ["3", "both", () => show_view("both")],
  ["r", "show the whole world", () => fit()],
  ["c", "the view follows the selected object, or the team", () => toggle_follow()],
  ["l", "measure a distance", () => toggle_measure()],
  ["h", "show or hide the legend", () => (by_id("legend").open = !by_id("legend").open)],
  ["i", "show topics with rates and messages, or the status", () => show_side(state.side === "topics" ? "status" : "topics")],
  ["z", "charts show the whole time", () => charts.zoom(null)],
  ["v", "save the values in the charts as CSV", () => save_csv()],
  ["x", "screenshot of the stage", () => take_shot()],
  ["w", "start or end a video of the time interval in the charts, or from the current time on", () => toggle_video()],
  ["k", "copy a link to this time and layout", () => share()],
  ["d", "light or dark colours", () => choose_theme()],
  ["n", "save or load a layout", () => layouts.open()],
  ["?", "show these keys", () => (by_id("help").open ? by_id("help").close() : by_id("help").showModal())],
  ["escape", "end measuring, or close the details", () => (world.is_measuring ? toggle_measure() : pick(null))],
  ...kLayers.map((layer) => [layer.key, `${layer.name} on or off`, () => toggle(layer)]),
];

const kNamed = { " ": "space", ArrowLeft: "←", ArrowRight: "→", "=": "+" };

document.addEventListener("keydown", (event) => {
  const { tagName } = event.target;
  const is_stop = operator !== null && event.key === " " && tagName !== "INPUT";
  if (!is_stop && (event.ctrlKey || event.metaKey || event.altKey || tagName === "SELECT" || tagName === "INPUT")) return;
  const name = kNamed[event.key] ?? event.key.toLowerCase();
  if (operator && name === "space") {
    // The emergency stop has priority over all other meanings of the key.
    event.preventDefault();
    if (!event.repeat) operator.send("estop", "");
    return;
  }
  if (name === "space" && (tagName === "BUTTON" || tagName === "SUMMARY")) return; // space presses the focused button
  if (by_id("layouts").open || (name === "escape" && by_id("help").open)) return;
  const found = kKeys.find(([key]) => key === name);
  if (found) {
    if (name !== "escape") event.preventDefault(); // escape must also close the dialog
    found[2](event);
  }
});

function fit() {
  follow(null);
  world.fit();
}

world.on_view = update_link;
// Removes the focus from a clicked button, so that keys go to the page.
document.addEventListener("click", (event) => event.detail > 0 && event.target.closest?.("button, summary")?.blur());
by_id("reset").onclick = fit;
by_id("follow").onclick = toggle_follow;
by_id("measure").onclick = toggle_measure;
by_id("shot").onclick = take_shot;
by_id("video").onclick = toggle_video;
by_id("share").onclick = share;
by_id("csv").onclick = save_csv;
by_id("before").onclick = () => charts.scroll(-1);
by_id("after").onclick = () => charts.scroll(1);
by_id("all").onclick = () => charts.zoom(null);
by_id("tab-status").onclick = () => show_side("status");
by_id("tab-topics").onclick = () => show_side("topics");
by_id("theme").onclick = choose_theme;
by_id("layout").onclick = () => layouts.open();
by_id("hidden-charts").onchange = (event) => {
  charts.restore(event.target.value);
  event.target.blur();
};
by_id("keys").onclick = () => by_id("help").showModal();
by_id("help").onclick = () => by_id("help").close();
const list = make("dl");
for (const [key, what] of kKeys) list.append(make("dt", "", key), make("dd", "", what));
by_id("help").append(make("h2", "", "Keys"), list);

set_theme(kQuery.get("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
show_view((Number(kQuery.get("width")) || innerWidth) < 1000 ? "plan" : "both");
set_trail(state.trail_s);
by_id("legend").open = innerWidth >= 1500;

function loop() {
  requestAnimationFrame(loop); // paused while the page is not visible
  connection.read_waiting();
  if (state.now !== null) world.expire(state.start + state.now);
  if (state.now !== null && Math.abs(state.now - (state.trails_at ?? -1)) >= kTrailPeriod_s) {
    draw_trails();
    if (state.range) update_link();
  }
  if (world.is_stale()) world.draw();
}
loop();

// Interface for tests: the content of the screen as numbers.
window.vantage = {
  state,
  stats: () => ({ entities: world.entities(), layers: world.sizes(), frames: world.frames_drawn, series: charts.lines().filter(({ box }) => !box.hidden).map((c) => c.series.size) }),
  colours: () => ({
    world: Object.fromEntries(world.shown("/robots").map(({ frame_id, cylinders }) => [frame_id, css_of(cylinders[0].color)])),
    charts: charts.lines().filter(({ box }) => !box.hidden).map((chart) => Object.fromEntries((chart.plot?.series ?? []).slice(1).map(({ label, stroke }) => [label, stroke()]))),
  }),
  sessions: () => sessions.list.map(({ name }) => name),
  labels: () => world.eyes().map(({ names }) => names),
  ascents: () => [...world.names.stamps.entries()].map(([key, { ascent }]) => [key, ascent]).sort(),
  scale: () => world.plan_scale(),
  cameras: () => world.cameras(),
  charts: () => charts.charts.filter(({ box }) => !box.hidden).map(({ spec, title }) => ({ key: spec.key, title: title.textContent, window: charts.own.window() })),
  series: (key) => Object.fromEntries(charts.charts.find(({ spec }) => spec.key === key)?.series ?? []),
  csv: () => charts.csv(),
  histogram: (key) => charts.charts.find(({ spec }) => spec.key === key).bins(),
  ages: (key) => charts.charts.find(({ spec }) => spec.key === key).classes(),
  trail: (body) => trails.paths.has(body) ? trails.points(body, state.start + state.now, state.trail_s).length : 0,
  measured: () => world.measured,
  followed: () => world.followed,
  position: (id) => world.find(id)?.position.toArray() ?? null,
  pixel: (id) => world.pixel(id),
  draw_again: () => world.set_stale(),
  hear: (topic, record) => connection.on.record(topic, state.start + state.now, record),
  seek_and_wait: (since) => seek_and_wait(since),
  zoom: (from, to) => charts.zoom(from, to),
  /** Returns the pixels of the stage, as they appear in a video. */
  painted: () => {
    const sheet = document.createElement("canvas");
    paint_stage(sheet);
    return sheet.getContext("2d").getImageData(0, 0, sheet.width, sheet.height);
  },
};
