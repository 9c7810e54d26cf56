// List of all topics of the server with their rates. An opened topic shows its newest message; its numbers can be charted.

import { on_refresh } from "./refresh_timer.js";
import { digits } from "./appearance.js";
import { in_order, make } from "./panels.js";

const kPoll_ms = 1000;
const kWriteBeats = 2;
const kCounted_s = 0.2; // s; minimum time over which a rate is computed
const kElements = 24; // maximum number of displayed elements of a list
const kText = 80; // maximum number of displayed characters of a text

export class Topics {
  /** @param on {open(topic, is_open), plot(topic, path), is_log()} */
  constructor(box, on) {
    this.on = on;
    this.box = box;
    this.filter = make("input");
    this.filter.type = "search";
    this.filter.placeholder = "filter topics";
    this.filter.setAttribute("aria-label", "Filter topics");
    this.filter.oninput = () => this.write();
    this.list = make("div", "topics");
    this.box.append(this.filter, this.list);
    this.rows = new Map(); // {row, rate, body} by topic
    this.counts = new Map(); // {type, count, hz} by topic
    this.counted = null; // {time_s, jumps} of the last poll; time_s: time of the log, or clock if live. No rates across a jump
    this.opened = new Map(); // newest record or null, by topic
    this.is_shown = false;
    setInterval(() => this.is_shown && !document.hidden && this.poll(), kPoll_ms);
    on_refresh(() => this.is_shown && this.write_opened(), kWriteBeats);
  }

  show(is_shown) {
    this.is_shown = is_shown;
    if (is_shown) this.poll();
  }

  async poll() {
    let known;
    try {
      known = await (await fetch("api/topics")).json();
    } catch {
      return; // the connection's badge shows the failure
    }
    const now = { jumps: known.jumps, time_s: this.on.is_log() ? known.time_s : performance.now() / 1e3 };
    const is_known = now.time_s !== null && this.counted !== null && this.counted.time_s !== null;
    const passed_s = is_known && this.counted.jumps === now.jumps ? now.time_s - this.counted.time_s : 0;
    this.counted = now;
    for (const { topic, schema, type, count } of known.topics) {
      const before = this.counts.get(topic);
      const hz = before && passed_s > kCounted_s ? (count - before.count) / passed_s : (before?.hz ?? null);
      this.counts.set(topic, { type: type ?? schema, count, hz });
    }
    this.write();
  }

  write() {
    const wanted = this.filter.value.trim().toLowerCase();
    for (const [topic, { type, hz }] of [...this.counts].sort(([a], [b]) => in_order(a, b))) {
      if (!this.rows.has(topic)) this.rows.set(topic, this.make_row(topic, type));
      const { row, rate } = this.rows.get(topic);
      const said = hz === null ? "" : `${hz >= 10 ? hz.toFixed(0) : hz.toFixed(1)} Hz`;
      if (rate.textContent !== said) rate.textContent = said;
      row.hidden = wanted !== "" && !`${topic} ${type}`.toLowerCase().includes(wanted);
    }
  }

  make_row(topic, type) {
    const row = make("details", "topic");
    row.dataset.topic = topic;
    const head = make("summary", "line");
    const rate = make("span", "quiet", "");
    head.append(make("b", "", topic), make("span", "space"), rate);
    head.title = type;
    const body = make("div", "message");
    row.append(head, make("div", "quiet", type), body);
    row.ontoggle = () => {
      if (row.open) this.opened.set(topic, this.opened.get(topic) ?? null);
      else this.opened.delete(topic);
      this.on.open(topic, row.open);
      this.write_opened();
    };
    const later = [...this.rows.keys()].filter((other) => in_order(other, topic) > 0).sort(in_order)[0];
    this.list.insertBefore(row, later ? this.rows.get(later).row : null);
    return { row, rate, body };
  }

  is_open(topic) {
    return this.opened.has(topic);
  }

  take(topic, record) {
    if (this.opened.has(topic)) this.opened.set(topic, record);
  }

  write_opened() {
    for (const [topic, record] of this.opened) {
      const { body } = this.rows.get(topic);
      if (record === null) {
        body.textContent = "no message yet";
        body.written = null;
      } else if (record !== body.written) {
        body.written = record;
        this.write_record(body, topic, record);
      }
    }
  }

  /** Writes values into the existing elements, so that opened parts stay open and buttons can be clicked. */
  write_record(body, topic, record) {
    const shape = shape_of(record);
    if (shape !== body.shape) {
      body.shape = shape;
      body.leaves = [];
      body.replaceChildren(this.make_tree(topic, record, [], body.leaves));
    }
    for (const { element, path } of body.leaves) {
      const said = words_of(path.reduce((value, key) => value?.[key], record));
      if (element.textContent !== said) element.textContent = said;
    }
  }

  make_tree(topic, value, path, leaves) {
    const list = make("ul");
    const entries = Object.entries(value);
    for (const [key, inside] of entries.slice(0, kElements)) {
      const item = make("li");
      const here = [...path, key];
      if (inside !== null && typeof inside === "object") {
        const part = make("details");
        part.open = path.length === 0 && Object.keys(inside).length <= 4;
        const size = Array.isArray(inside) ? ` [${inside.length}]` : "";
        part.append(make("summary", "", key + size), this.make_tree(topic, inside, here, leaves));
        item.append(part);
      } else {
        const said = make("span", "value", "");
        leaves.push({ element: said, path: here });
        item.append(make("span", "key", key), said);
        if (typeof inside === "number" || typeof inside === "boolean") {
          const add = make("button", "add", "+");
          add.title = `Chart ${here.join(".")}`;
          add.dataset.field = here.join(".");
          add.setAttribute("aria-label", add.title);
          add.onclick = () => this.on.plot(topic, here);
          item.append(add);
        }
      }
      list.append(item);
    }
    if (entries.length > kElements) list.append(make("li", "quiet", `and ${entries.length - kElements} more`));
    return list;
  }

  clear() {
    this.rows.clear();
    this.counts.clear();
    this.opened.clear();
    this.counted = null;
    this.list.replaceChildren();
  }
}

/** Returns the structure of a record without its values. Records of equal structure share one tree of elements. */
function shape_of(value) {
  if (value === null || typeof value !== "object") return typeof value === "number" || typeof value === "boolean" ? "n" : "t";
  const entries = Object.entries(value);
  return `{${entries.length}${entries.slice(0, kElements).map(([key, inside]) => `${key}:${shape_of(inside)}`).join()}}`;
}

function words_of(value) {
  if (typeof value === "number") return Number.isSafeInteger(value) ? String(value) : digits(value); // all digits of integers
  const text = String(value);
  return text.length > kText ? `${text.slice(0, kText)}… (${text.length} characters)` : text;
}
