// Sessions of a bus or a log: each run of a trial is one.

import { make } from "./panels.js";

export class Sessions {
  /** @param box a select element, hidden while there is only one session @param on_choose called with the index of the session */
  constructor(box, on_choose) {
    this.box = box;
    this.list = []; // {id, name, from}: from in s since the epoch
    box.onchange = () => {
      on_choose(Number(box.value));
      box.blur();
    };
    this.chosen = null;
  }

  /** Adds the session of a scenario record. Returns true if it is new. */
  add(record, time) {
    if (this.list.some(({ id, from }) => id === record.session && Math.abs(from - time) < 1)) return false;
    this.list.push({ id: record.session, name: record.name, from: time });
    this.list.sort((a, b) => a.from - b.from);
    this.chosen = this.list.length - 1;
    this.write();
    return true;
  }

  /** Returns [from, to] of a session, s since the epoch. The first session also includes the time
  before its scenario record. */
  range(index) {
    return [index > 0 ? this.list[index].from : -Infinity, this.list[index + 1]?.from ?? Infinity];
  }

  /** Chooses the session of an instant of a log. */
  follow(time) {
    const index = Math.max(0, this.list.findLastIndex(({ from }) => from <= time));
    if (this.list.length < 2 || index === this.chosen) return;
    this.choose(index);
  }

  choose(index) {
    this.chosen = index;
    this.box.value = String(index);
  }

  is_last() {
    return this.chosen === null || this.chosen === this.list.length - 1;
  }

  write() {
    this.box.hidden = this.list.length < 2;
    const time = (from) => new Date(1e3 * from).toISOString().slice(11, 19);
    this.box.replaceChildren(...this.list.map(({ name, from }, i) => {
      const option = make("option", "", `${i + 1} · ${name} · ${time(from)} UTC`);
      option.value = String(i);
      return option;
    }));
    this.box.value = String(this.chosen ?? 0);
  }

  clear() {
    this.list = [];
    this.chosen = null;
    this.write();
  }
}
