// What is told in words: vehicles, processes, events, and the thing that was clicked.

const kEventsShown = 200;
const kRefresh_ms = 200;

export function make(tag, className, text) {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

/** Names as people order them: Q2 before Q10. */
export const in_order = new Intl.Collator("en", { numeric: true }).compare;

/** Rows by key in a box, made once; written again, five times a second whatever comes, where what
    they say is another. */
class Table {
  /** @param make_row gives the elements of a key's row, and the title of it */
  constructor(box, make_row) {
    this.box = box;
    this.rows = new Map();
    this.changed = new Set();
    setInterval(() => {
      if (document.hidden) return;
      for (const key of this.changed) {
        const { elements, title } = make_row(key);
        const row = this.row(key);
        const said = elements.map((element) => element.outerHTML).join("");
        if (said !== row.said) row.replaceChildren(...elements);
        row.said = said;
        row.title = title;
      }
      this.changed.clear();
    }, kRefresh_ms);
  }

  change(key) {
    this.changed.add(key);
  }

  row(key) {
    if (!this.rows.has(key)) {
      const row = make("div", "row");
      row.dataset.key = key;
      this.rows.set(key, row);
      const later = [...this.rows.keys()].sort(in_order).find((other) => in_order(other, key) > 0);
      this.box.insertBefore(row, later ? this.rows.get(later) : null);
    }
    return this.rows.get(key);
  }

  clear() {
    this.rows.clear();
    this.changed.clear();
    this.box.replaceChildren();
  }
}

const kGood = { follow: "good", idle: "calm", hold: "warn", land: "warn", killed: "bad" };

export class Vehicles {
  constructor(box) {
    this.table = new Table(box, (robot) => this.row(robot));
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
      const note = make("span", "quiet", plan.late ? `plan ${(-1e3 * plan.margin_s).toFixed(0)} ms late` : `plan ${plan.source}, ${(1e3 * plan.margin_s).toFixed(0)} ms spare`);
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
    this.table = new Table(box, (process) => this.row(this.healths.get(process)));
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

export class Events {
  /** @param on_seek called with a time when an event is clicked */
  constructor(box, on_seek) {
    this.box = box;
    this.on_seek = on_seek;
  }

  add(event) {
    const item = make("li", "event");
    item.dataset.kind = event.kind;
    item.append(make("time", "", `${event.since.toFixed(1)} s`), make("b", "", event.kind.replaceAll("_", " ")), make("span", "", event.text));
    item.tabIndex = 0;
    item.onclick = () => this.on_seek(event.since);
    item.onkeydown = (key) => {
      if (key.key !== "Enter") return;
      key.stopPropagation();
      this.on_seek(event.since);
    };
    this.box.prepend(item);
    while (this.box.children.length > kEventsShown) this.box.lastChild.remove();
  }

  clear() {
    this.box.replaceChildren();
  }
}

/** Shows one thing with everything known of it.
    @param sections [title, [[key, value]]] */
export function write_inspect(box, id, is_followed, sections) {
  box.hidden = id === null;
  if (id === null) return;
  const said = JSON.stringify([id, is_followed, sections]);
  if (said === box.said) return;
  box.said = said;
  const head = make("div", "line");
  const follow = make("button", "", "Follow");
  follow.title = "The view goes with it (C)";
  follow.dataset.act = "follow";
  follow.setAttribute("aria-pressed", is_followed);
  const close = make("button", "", "×");
  close.title = "Close (Esc)";
  close.setAttribute("aria-label", "Close");
  close.dataset.act = "close";
  head.append(make("b", "", id), make("span", "space"), follow, close);
  const parts = sections.filter(([, rows]) => rows.length > 0).flatMap(([title, rows]) => {
    const list = make("dl");
    rows.forEach(([key, value]) => list.append(make("dt", "", key), make("dd", "", value)));
    return title ? [make("h2", "minor", title), list] : [list];
  });
  const top = box.scrollTop;
  box.replaceChildren(head, ...parts);
  box.scrollTop = top;
}
