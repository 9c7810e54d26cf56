// Operator part of the page: orders to the vehicles, their confirmations and refusals.

import { make } from "./panels.js";

const kKey = "vantage.operate";
/** Orders: word of the console, label, hint. */
const kOrders = [
  ["arm", "Arm"], ["take-off", "Take off"], ["follow", "Follow"], ["hold", "Hold"], ["land", "Land"], ["estop", "E-stop"],
];
const kReturn_ms = 10_000; // ms; a page that was silent for longer (on a sleeping computer) does not take charge again
const kOutcome = { awaited: "calm", confirmed: "good", refused: "bad", unconfirmed: "warn" };

/** Returns the key that the address contains after "#operate=", and removes it from the address, so that no shared link has it.
    A reloaded page takes it from this tab's storage. Returns null if the page is not an operator
    page. */
export function take_key() {
  const found = location.hash.match(/^#operate=([0-9a-f]{32})$/);
  if (found) {
    sessionStorage.setItem(kKey, found[1]);
    history.replaceState(null, "", location.pathname + location.search);
  }
  return sessionStorage.getItem(kKey);
}

export class Operator {
  constructor(box, key) {
    this.box = box;
    this.key = key;
    this.token = "";
    this.state = null;
    this.error = "";
    this.rows = new Map();
    const head = make("div", "line");
    this.badge = make("span", "badge", "connecting");
    this.claim_button = make("button", "", "Operate");
    this.claim_button.title = "Take charge: send the heartbeat and orders from this page";
    this.claim_button.dataset.act = "claim";
    this.claim_button.onclick = () => (this.token ? this.release() : this.claim());
    head.append(make("h2", "", "Operator"), this.badge, make("span", "space"), this.claim_button);
    this.stop = make("button", "estop", "EMERGENCY STOP: all (space)");
    this.stop.onclick = () => this.send("estop", "");
    this.words = make("p", "quiet");
    this.words.setAttribute("role", "status");
    this.table = make("div");
    this.journal = make("ol", "journal");
    this.journal.setAttribute("aria-label", "Orders");
    box.append(head, this.stop, this.words, this.table, this.journal);
    box.hidden = false;
    this.worker = new Worker(new URL("./presence.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => this.on_state(data);
    this.worker.onerror = () => this.on_state({ error: "the page cannot report its presence" });
    this.share_token();
    addEventListener("pagehide", () => this.release());
  }

  share_token() {
    this.worker.postMessage({ key: this.key, token: this.token });
  }

  async request(what, body = {}) {
    const answer = await fetch(`api/operate/${what}`, {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Vantage-Key": this.key, "X-Vantage-Token": this.token },
      body: JSON.stringify(body),
      keepalive: true,
    });
    const content = await answer.json().catch(() => ({}));
    if (!answer.ok) throw new Error(content.error ?? `${answer.status} ${answer.statusText}`);
    return content;
  }

  async claim() {
    try {
      this.token = (await this.request("claim")).token;
      this.share_token();
      this.say("");
    } catch (error) {
      this.say(error.message);
    }
  }

  release() {
    if (!this.token) return;
    this.request("release").catch(() => {}); // if this fails, the claim ends after its timeout
    this.token = "";
    this.share_token();
  }

  /** Sends an order. An emergency stop is sent again until the server has answered. */
  async send(action, robot) {
    try {
      await this.request("order", { action, robot });
      this.say("");
    } catch (error) {
      this.say(`${action} ${robot || "all"}: ${error.message}`);
      if (action === "estop" && error instanceof TypeError) setTimeout(() => this.send(action, robot), 100);
    }
  }

  say(words) {
    this.error = words;
    this.write();
  }

  on_state({ state, error }) {
    this.link_error = error ?? "";
    if (state) {
      if (!state.is_operator && this.token && this.was_operator) {
        // The server ends the claim if reports are delayed, although the operator is still here.
        this.token = "";
        if (Date.now() - this.operated_at < kReturn_ms) this.claim();
      }
      if (state.is_operator) this.operated_at = Date.now();
      this.was_operator = state.is_operator;
      this.state = state;
    }
    this.write();
  }

  write() {
    const station = this.state?.station;
    const is_operator = this.state?.is_operator ?? false;
    const role = this.link_error ? "no connection" : is_operator ? station.role : "not operating";
    this.badge.textContent = role;
    this.badge.dataset.state = this.link_error ? "bad" : role === "in charge" ? "good" : "warn";
    this.claim_button.textContent = is_operator ? "Leave" : "Operate";
    this.claim_button.title = is_operator ? "End the heartbeat: vehicles in the air hold and then land" : "Take charge: send the heartbeat and orders from this page";
    this.words.textContent = [
      this.link_error, this.error, is_operator && role !== "in charge" ? station.words : "",
      station?.lacks_signature ? "vehicles that require signed commands ignore this page: start it with --scenario FILE" : "",
      station?.is_log_lost ? "the log is not being written" : "",
    ].filter(Boolean).join(" · ");
    if (!station) return;
    const names = station.vehicles.map(({ robot }) => robot);
    if (names.join() !== this.names) {
      this.names = names.join();
      this.make_rows(names);
    }
    for (const vehicle of station.vehicles) this.write_row(vehicle, station.receipts[vehicle.robot], is_operator);
    this.write_journal(station.journal);
  }

  make_rows(names) {
    this.rows.clear();
    this.table.replaceChildren(...(names.length === 0 ? [make("p", "quiet", "No vehicle status received yet.")] : ["", ...names].map((robot) => {
      const row = make("div", "row");
      row.dataset.robot = robot;
      const head = make("div", "line");
      const badge = make("span", "badge");
      const note = make("span", "quiet");
      const receipt = make("div", "receipt");
      head.append(make("b", "", robot || "all"), badge, note);
      badge.hidden = robot === "";
      const orders = make("div", "orders");
      const buttons = new Map(kOrders.map(([action, label]) => {
        const button = make("button", action === "estop" ? "estop" : "", label);
        button.dataset.action = action;
        button.onclick = () => this.send(action, robot);
        orders.append(button);
        return [action, button];
      }));
      row.append(head, orders, receipt);
      this.rows.set(robot, { badge, note, receipt, buttons });
      return row;
    })));
  }

  write_row({ robot, state, battery_share, age_s, is_silent, reasons, obstacles }, receipt, is_operator) {
    const row = this.rows.get(robot);
    row.badge.textContent = is_silent ? "silent" : state;
    row.badge.dataset.state = is_silent || state === "killed" ? "bad" : state === "follow" ? "good" : "calm";
    row.note.textContent = [`battery ${Math.round(100 * battery_share)} %`, is_silent ? `no status for ${age_s.toFixed(0)} s` : "", ...reasons].filter(Boolean).join(" · ");
    for (const [action, button] of row.buttons) {
      button.dataset.blocked = obstacles[action] ? "yes" : "";
      button.title = obstacles[action] ? `no effect now: ${obstacles[action]}` : is_operator || action === "estop" ? "" : "press Operate first";
    }
    row.receipt.hidden = !receipt;
    if (!receipt) return;
    row.receipt.dataset.state = kOutcome[receipt.outcome];
    row.receipt.textContent = `${receipt.action}: ${receipt.outcome}${receipt.words ? ` (${receipt.words})` : ""}`;
  }

  write_journal(lines) {
    const newest = lines.at(-1)?.number ?? 0;
    if (newest === this.newest) return;
    this.newest = newest;
    this.journal.replaceChildren(...lines.slice(-30).reverse().map(({ at_s, words }) => {
      const item = make("li", /^(not sent|unknown|no message)|no effect/.test(words) ? "warn" : "", words);
      item.prepend(make("time", "", `${at_s.toFixed(1)} s `));
      return item;
    }));
  }
}
