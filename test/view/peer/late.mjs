// late.mjs http://HOST:PORT late [FOLDER]: tests that a page that is opened during a trial, or that reconnects after
// it has lost the server, shows each earlier record exactly once.

import assert from "node:assert";
import { finish, open, until } from "./drive.mjs";

/** Stores the newest frame of each subscription of every WebSocket of the page, for repeat(). */
function listen_in() {
  const newest = new Map();
  const is_event = (data) => "level" in JSON.parse(new TextDecoder().decode(new Uint8Array(data, 13)));
  window.sockets = [];
  window.WebSocket = class extends window.WebSocket {
    constructor(...how) {
      super(...how);
      window.sockets.push(this);
      this.addEventListener("message", ({ data }) => {
        if (data instanceof ArrayBuffer && new DataView(data).getUint8(0) === 1) newest.set(new DataView(data).getUint32(1, true), data);
      });
    }
  };
  /** Delivers the newest frame of each subscription again, except events, as a server does for a new subscription. */
  window.repeat = () => newest.forEach((data) => is_event(data) || window.sockets.at(-1).onmessage({ data }));
}

const heard = (page) =>
  page.evaluate(() => {
    const { t: times } = vantage.series("margin").Q1;
    const events = [...document.querySelectorAll(".event")].map(({ textContent }) => textContent);
    return { first: vantage.state.start + times[0], times, trail: vantage.trail("Q1"), events };
  });

/** Returns the records that the page has received twice. (A comparison of counts would fail, because the trial
    continues during the query.) */
const twice = ({ times, events }) => [
  ...times.filter((time, i) => i > 0 && time <= times[i - 1]),
  ...events.filter((event, i) => events.indexOf(event) < i),
];

const first = await open(1366, 768, "light", "");
await until(first, () => vantage.series("margin").Q1?.t.length > 12 && vantage.trail("Q1") > 5);
const known = await heard(first);

const late = await open(1366, 768, "light", "", (page) => page.addInitScript(listen_in));
await until(late, () => vantage.series("margin").Q1?.t.length > 0);
const told = await heard(late);
assert(told.first <= known.first + 0.01, `from ${told.first} on, the first viewer from ${known.first} on`);
assert(told.times.length >= known.times.length);
assert.deepEqual(twice(told), []);
assert(told.trail > 5);

// The stored records are delivered again: the charts show each record once and lose none.
await late.evaluate(() => repeat());
const again = await heard(late);
assert(again.times.length >= told.times.length, `${again.times.length} of ${told.times.length} are left`);
assert.deepEqual(twice(again), [], "repeated");
assert(again.events.length >= told.events.length);

// The page reconnects to the same trial after its connection was closed.
await late.evaluate(() => window.sockets.at(-1).close());
await until(late, (count) => window.sockets.length > 1 && vantage.series("margin").Q1?.t.length > count + 2, again.times.length);
const later = await heard(late);
assert(later.first === again.first, "the first instant changed");
assert.deepEqual(twice(later), [], "records received twice after the reconnect");
await finish();
