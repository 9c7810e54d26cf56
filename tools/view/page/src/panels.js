// Panels of text: vehicles, processes, events, and details of the selected item.

import { digits } from "./appearance.js";
import { on_refresh } from "./refresh_timer.js";

const kEventsShown = 600;
const kCrowd = 12; // number of rows above which rows without a problem are hidden at first

export function make(tag, className, text) {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

/** Compares names in natural order: Q2 before Q10. */
export const in_order = new Intl.Collator("en", { numeric: true }).compare;

/** Table of rows in a box, by key. Rows are created once, and updated at a beat if their text has
changed. With more than `of.crowd` rows,
    rows without a problem are hidden, and a heading shows the number of rows by state. */
class Table {
  /** @param of {row(key): the elements of a row and its title; is_normal(key): true if the row shows no problem;
      words(keys): text of the heading; crowd: number of rows that are never folded, kCrowd unless given} */
  constructor(box, of) {
    this.of = of;
    this.head = make("button", "fold");
    this.head.hidden = true;
    this.head.setAttribute("aria-expanded", false);
    this.head.onclick = () => this.unfold(this.head.getAttribute("aria-expanded") !== "true");
    this.list = make("div");
    box.append(this.head, this.list);
    this.rows = new Map();
    this.changed = new Set();
    on_refresh(() => this.write());
  }

  /** Shows all rows of a crowded box, or only the rows with a problem. */
  unfold(is_open) {
    this.head.setAttribute("aria-expanded", is_open);
    this.rows.forEach((_, key) => this.changed.add(key));
    this.write();
  }

  change(key) {
    this.changed.add(key);
  }

  write() {
    if (this.changed.size === 0) return;
    this.changed.forEach((key) => this.row(key));
    const is_crowd = this.rows.size > (this.of.crowd ?? kCrowd);
    if (is_crowd) {
      const said = this.of.words([...this.rows.keys()]);
      if (this.head.textContent !== said) this.head.textContent = said;
      if (this.head.hidden) this.rows.forEach((_, key) => this.changed.add(key)); // kCrowd has just been exceeded
    }
    this.head.hidden = !is_crowd;
    const is_folded = is_crowd && this.head.getAttribute("aria-expanded") !== "true";
    for (const key of this.changed) {
      const row = this.row(key);
      row.hidden = is_folded && this.of.is_normal(key);
      if (row.hidden) continue;
      const { elements, title } = this.of.row(key);
      const said = elements.map((element) => element.outerHTML).join("");
      if (said !== row.said) row.replaceChildren(...elements);
      row.said = said;
      row.title = title;
    }
    this.changed.clear();
  }

  row(key) {
    if (!this.rows.has(key)) {
      const row = make("div", "row");
      row.dataset.key = key;
      this.rows.set(key, row);
      const later = [...this.rows.keys()].sort(in_order).find((other) => in_order(other, key) > 0);
      this.list.insertBefore(row, later ? this.rows.get(later) : null);
    }
    return this.rows.get(key);
  }

  clear() {
    this.rows.clear();
    this.changed.clear();
    this.head.hidden = true;
    this.list.replaceChildren();
  }
}

/** Counts words, the most frequent first: "48 follow, 2 hold" for ["follow", "hold", …]. */
function counted(words) {
  const counts = new Map();
  words.forEach((word) => counts.set(word, (counts.get(word) ?? 0) + 1));
  return [...counts].sort(([, a], [, b]) => b - a).map(([word, count]) => `${count} ${word}`).join(", ");
}

const kGood = { follow: "good", idle: "calm", hold: "warn", land: "warn", killed: "bad" };

export class Vehicles {
  constructor(box) {
    this.table = new Table(box, { row: (robot) => this.row(robot), is_normal: (robot) => this.is_normal(robot), words: (robots) => this.words(robots) });
    this.plans = new Map();
    this.states = new Map();
  }

  on_state(state) {
    this.states.set(state.robot, state);
    this.table.change(state.robot);
  }

  on_plan(plan) {
    this.plans.set(plan.robot, plan);
    this.table.change(plan.robot);
  }

  is_normal(robot) {
    const [state, plan] = [this.states.get(robot), this.plans.get(robot)];
    const is_planned = !plan || (!plan.late && plan.source === "searched");
    return is_planned && (!state || (state.reasons.length === 0 && ["follow", "idle"].includes(state.state)));
  }

  words(robots) {
    const states = robots.map((robot) => this.states.get(robot)).filter(Boolean);
    const plans = robots.map((robot) => this.plans.get(robot)).filter(Boolean);
    const percents = states.map(({ battery_share }) => Math.round(100 * battery_share));
    const [low, high] = [Math.min(...percents), Math.max(...percents)];
    const late = plans.filter(({ late }) => late).length;
    const spare_ms = Math.round(1e3 * Math.min(...plans.filter(({ late }) => !late).map(({ margin_s }) => margin_s)));
    return [
      counted(states.map(({ state }) => state)) || `${robots.length} vehicles`,
      percents.length > 0 && `battery ${low === high ? low : `${low} to ${high}`} %`,
      late > 0 ? `${late} plans late` : Number.isFinite(spare_ms) && `plans at least ${spare_ms} ms early`,
    ].filter(Boolean).join(" · ");
  }

  row(robot) {
    const state = this.states.get(robot);
    const plan = this.plans.get(robot);
    const head = make("div", "line");
    head.append(make("b", "", robot));
    if (state) {
      const badge = make("span", "badge", state.state);
      badge.dataset.state = kGood[state.state] ?? "calm";
      head.append(badge, make("span", "quiet", `battery ${Math.round(100 * state.battery_share)} %`));
    }
    if (plan) {
      const note = make("span", "quiet", plan.late ? `plan ${(-1e3 * plan.margin_s).toFixed(0)} ms late` : `plan${plan.source === "searched" ? "" : ` ${plan.source},`} ${(1e3 * plan.margin_s).toFixed(0)} ms early`);
      if (plan.late || plan.source !== "searched") note.classList.add("warn");
      head.append(note);
    }
    const reasons = (state?.reasons ?? []).map((reason) => make("div", "reason", reason));
    return { elements: [head, ...reasons], title: "" };
  }

  clear() {
    this.table.clear();
    this.plans.clear();
    this.states.clear();
  }
}

const kProcess = { running: "good", starting: "calm", stopping: "calm", degraded: "warn" };

export class Processes {
  constructor(box) {
    this.table = new Table(box, {
      row: (process) => this.row(this.healths.get(process)),
      crowd: 0,
      is_normal: (process) => this.healths.get(process).state !== "degraded",
      words: (processes) => counted(processes.map((process) => this.healths.get(process).state)),
    });
    this.healths = new Map();
  }

  on_health(health) {
    this.healths.set(health.process, health);
    this.table.change(health.process);
  }

  row(health) {
    const badge = make("span", "badge", health.state);
    badge.dataset.state = kProcess[health.state] ?? "calm";
    const line = make("div", "line");
    const notes = [`loop ${(1e3 * health.loop_worst_s).toFixed(1)} ms`];
    if (health.deadlines_missed > 0) notes.push(`${health.deadlines_missed} late`);
    if (health.messages_lost > 0) notes.push(`${health.messages_lost} lost`);
    line.append(make("b", "", health.process), badge, make("span", "quiet", notes.join(", ")));
    return { elements: [line], title: health.counters.map((each) => `${each.name}: ${each.count}`).join("\n") };
  }

  clear() {
    this.table.clear();
    this.healths.clear();
  }
}

const kInfo = 2; // level of foxglove.Log
const who_of = ({ text }) => text.split(": ")[0];

export class Events {
  /** @param filter an input element: only events that contain its text are shown
      @param on_seek called with the time of a clicked event */
  constructor(box, filter, on_seek) {
    this.box = box;
    this.filter = filter;
    filter.oninput = () => [...box.children].forEach((item) => this.filter_item(item));
    this.on_seek = on_seek;
    this.open = new Map(); // by process: text element of its last health problem that has not ended
  }

  add(event) {
    if (event.kind === "health" && this.is_end(event)) return;
    const item = make("li", "event");
    item.dataset.kind = event.kind;
    item.since = event.since;
    const words = make("span", "", event.text);
    if (event.kind === "health" && event.level > kInfo) this.open.set(who_of(event), words);
    item.append(make("time", "", `${event.since.toFixed(1)} s`), make("b", "", event.kind.replaceAll("_", " ")), words);
    item.tabIndex = 0;
    item.onclick = () => this.on_seek(event.since);
    item.onkeydown = (key) => {
      if (key.key !== "Enter") return;
      key.stopPropagation();
      this.on_seek(event.since);
    };
    this.filter_item(item);
    // The newest event is the first; events that arrive late are sorted in.
    let before = this.box.firstChild;
    while (before && before !== this.mark && before.since > event.since) before = before.nextSibling;
    this.box.insertBefore(item, before === this.mark ? (before?.nextSibling ?? null) : before);
    while (this.box.children.length > kEventsShown) this.box.lastChild.remove();
  }

  /** Moves the line that marks the present in a log: later events are above it. @param now s; null: no line */
  mark_now(now) {
    if (now === null) return this.mark?.remove();
    this.mark ??= make("li", "present", "now");
    const items = [...this.box.children].filter((item) => item !== this.mark);
    const next = items.find((item) => item.since <= now) ?? null;
    if (this.mark.parentNode !== this.box || this.mark.nextSibling !== next) {
      this.box.insertBefore(this.mark, next);
      items.forEach((item) => item.classList.toggle("later", item.since > now));
      const list = this.box.parentNode;
      if (!list.matches(":hover, :focus-within")) list.scrollTop = this.mark.offsetTop - list.offsetTop - 60;
    }
  }

  filter_item(item) {
    if (item === this.mark) return;
    item.hidden = !item.textContent.toLowerCase().includes(this.filter.value.trim().toLowerCase());
  }

  /** If an event ends a displayed health problem, appends the event to the problem's line and returns true. */
  is_end(event) {
    const words = this.open.get(who_of(event));
    this.open.delete(who_of(event));
    if (event.level > kInfo || !words?.isConnected) return false;
    words.textContent += `; at ${event.since.toFixed(1)} s ${event.text.slice(who_of(event).length + 2)}`;
    return true;
  }

  clear() {
    this.open.clear();
    this.box.replaceChildren();
  }
}

/** Formats a time since an event: "0.4 s", "12 s", "3 min". */
export function age_text(age_s) {
  return age_s < 10 ? `${age_s.toFixed(1)} s` : age_s < 120 ? `${age_s.toFixed(0)} s` : `${(age_s / 60).toFixed(0)} min`;
}

/** Table of the targets: discovery, error, standard deviation and last sighting of each. */
export class Targets {
  /** @param color_of returns the CSS colour of a target @param on_pick called with the name of a clicked target */
  constructor(box, color_of, on_pick) {
    this.section = box.parentNode;
    const head = make("div", "cells head");
    head.append(...["target", "found", "error", "σ", "last seen"].map((title) => make("span", "", title)));
    head.lastChild.title = "time since the last measurement, and the robot that made it";
    head.children[3].title = "standard deviation of the estimate";
    box.append(head);
    this.color_of = color_of;
    this.states = new Map();
    this.found = new Map(); // {found_s, found_by} by target, from the events of a log
    this.table = new Table(box, {
      row: (name) => this.row(this.states.get(name)),
      is_normal: (name) => this.states.get(name).state !== "lost",
      words: () => this.words(),
    });
    box.onclick = (event) => {
      const row = event.target.closest("[data-key]");
      if (row) on_pick(row.dataset.key);
    };
  }

  /** Sets the discovery of a target from the event in a log. After a jump, the server has not read the log from its
      start, so it does not know earlier discoveries. */
  on_found(name, found_s, found_by) {
    if (!this.found.has(name)) this.found.set(name, { found_s, found_by });
  }

  on_states(record) {
    this.section.hidden = record.targets.length === 0;
    for (const state of record.targets) {
      this.states.set(state.name, { ...state, ...this.found.get(state.name) });
      this.table.change(state.name);
    }
  }

  /** Returns the number of targets, of those that were found, and of those that are lost. */
  counts() {
    const states = [...this.states.values()].map(({ state }) => state);
    return { all: states.length, found: states.filter((state) => state !== "sought").length, lost: states.filter((state) => state === "lost").length };
  }

  words() {
    const { all, found, lost } = this.counts();
    return `${found} of ${all} found${lost > 0 ? ` · ${lost} lost` : ""}`;
  }

  row({ name, state, found_s, found_by, error_m, sigma_m, seen_by, unseen_s }) {
    const title = make("b", "of", name);
    title.style.setProperty("--of", this.color_of(name));
    const found = state === "sought" ? "not yet" : found_s === undefined ? "before this view" : `${found_s.toFixed(1)} s by ${found_by}`;
    const seen = state === "sought" || unseen_s === undefined ? "" : `${age_text(unseen_s)} ago, ${seen_by}`;
    const cells = make("div", "cells");
    cells.dataset.state = state;
    cells.append(title, make("span", "", state === "lost" ? "lost" : found), make("span", "", error_m === undefined ? "" : `${error_m.toFixed(2)} m`),
      make("span", "", sigma_m === undefined ? "" : `${sigma_m.toFixed(2)} m`), make("span", "", seen));
    return { elements: [cells], title: state === "lost" ? `lost; first found ${found}` : "" };
  }

  clear() {
    this.states.clear();
    this.found.clear();
    this.table.clear();
    this.section.hidden = true;
  }
}

/** Strip that shows the trial's result in numbers. */
export class Results {
  constructor(box) {
    this.box = box;
    this.team = null;
    this.targets = null; // numbers of targets, from Targets
    this.steps = []; // {time, team} of each step of a log
    on_refresh(() => this.write());
  }

  on_team(team) {
    if (this.steps.length === 0) this.team = team;
  }

  /** Adds a step of a log. If steps are known, show_step() chooses the one to show, because the server's counts begin
      anew after a jump in the log. */
  add_step(time, team) {
    this.steps.push({ time, team });
  }

  show_step(now) {
    if (this.steps.length > 0) this.team = this.steps.findLast(({ time }) => time <= now)?.team ?? null;
  }

  on_targets(counts) {
    this.targets = counts;
  }

  /** Returns [key, value, name, state] of each fact that is known. */
  facts() {
    const { team, targets } = this;
    const out = [];
    if (targets && targets.all > 0) {
      out.push(["found", `${targets.found} of ${targets.all}`, "targets found", targets.found === targets.all ? "good" : ""]);
      if (targets.lost > 0) out.push(["lost", String(targets.lost), "lost now", "bad"]);
    }
    if (!team) return out;
    if (team.rmse_m !== undefined) out.push(["rmse", `${team.rmse_m.toFixed(2)} m`, "RMSE", ""]);
    if (team.map_entropy_nats !== undefined) out.push(["map", `${digits(team.map_entropy_nats)} nat`, "map entropy", ""]);
    out.push(["collisions", String(team.collisions), "collisions", team.collisions > 0 ? "bad" : ""]);
    if (team.separation_violations > 0) out.push(["near", String(team.separation_violations), "near misses", "warn"]);
    out.push(["late", `${team.rounds_late} of ${team.rounds}`, "rounds late", team.rounds_late > 0 ? "warn" : ""]);
    if (team.messages_lost > 0) out.push(["messages", String(team.messages_lost), "messages lost", "warn"]);
    return out;
  }

  write() {
    const facts = this.facts();
    const said = JSON.stringify(facts);
    if (said === this.said) return;
    this.said = said;
    this.box.replaceChildren(...facts.map(([key, value, name, state]) => {
      const fact = make("span", "fact");
      fact.dataset.fact = key;
      fact.dataset.state = state;
      fact.append(make("b", "", value), ` ${name}`);
      return fact;
    }));
  }

  clear() {
    this.team = this.targets = null;
    this.steps = [];
  }
}

/** Shows the details of one item.
    @param sections [title, [[key, value]]] @param raw [[key, value]]: all members as they are sent, shown folded */
export function write_inspect(box, id, title, is_followed, sections, raw = []) {
  box.hidden = id === null;
  if (id === null) return;
  const said = JSON.stringify([id, is_followed, sections, raw]);
  if (said === box.said) return;
  box.said = said;
  const head = make("div", "line");
  const follow = make("button", "", "Camera follows");
  follow.title = "The camera follows this object (C)";
  follow.dataset.act = "follow";
  follow.setAttribute("aria-pressed", is_followed);
  const close = make("button", "", "×");
  close.title = "Close (Esc)";
  close.setAttribute("aria-label", "Close");
  close.dataset.act = "close";
  head.append(make("b", "", title), make("span", "space"), follow, close);
  const list_of = (rows) => {
    const list = make("dl");
    rows.forEach(([key, value]) => list.append(make("dt", "", key), make("dd", "", value)));
    return list;
  };
  const parts = sections.filter(([, rows]) => rows.length > 0).flatMap(([name, rows]) => (name ? [make("h2", "minor", name), list_of(rows)] : [list_of(rows)]));
  if (raw.length > 0) {
    const all = make("details");
    all.open = box.querySelector("details")?.open ?? false;
    all.append(make("summary", "quiet", "All values as sent"), list_of(raw));
    parts.push(all);
  }
  const top = box.scrollTop;
  box.replaceChildren(head, ...parts);
  box.scrollTop = top;
}
