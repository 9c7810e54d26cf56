// Plain names and units of the members of records, for the inspector.

import { digits } from "./appearance.js";

const ms = (seconds) => `${(1e3 * seconds).toFixed(1)} ms`;
const unit = (name) => (value) => `${digits(Number(value))} ${name}`;
const yes_no = (value) => (value ? "yes" : "no");
/** Formats the number of a round as all programs do: its last five digits. */
export const round_text = (round) => (round < 0 ? "none" : String(round % 100000));

/** [member, plain name, text of the value] by kind of record, in the order of display. */
const kMembers = {
  plan: [
    ["round", "round", round_text], ["source", "result of", (source) => ({ searched: "search", shifted: "shifting the last plan", braking: "braking" })[source] ?? source],
    ["margin_s", "ready before the deadline", ms], ["late", "late", yes_no], ["cost_nat", "cost", unit("nat")],
    ["lower_bound_nat", "proven lower bound", unit("nat")], ["gap_nat", "cost above the bound", unit("nat")], ["nodes", "searched nodes", digits],
    ["passes", "search passes", digits], ["epsilon", "pruning ε", digits], ["delta_m", "pruning δ", unit("m")],
  ],
  vehicle: [
    ["state", "state", String], ["battery_share", "battery", (share) => `${(100 * share).toFixed(0)} %`], ["plan_round", "follows the plan of round", round_text],
    ["capture_to_setpoint_s", "measurement to set-point", ms], ["reasons", "reasons", (reasons) => reasons.join(", ") || "none"],
  ],
  health: [
    ["state", "state", String], ["loop_worst_s", "slowest loop", ms], ["deadlines_missed", "missed deadlines", digits], ["messages_lost", "lost messages", digits],
  ],
  drawn: [
    ["sensor_range_m", "sensor range", unit("m")], ["jammed", "sensor jammed", String], ["robot", "best informed robot", String], ["sigma_m", "σ", unit("m")],
    ["error_m", "error", unit("m")], ["round", "round", String], ["source", "result of", String], ["late", "late", String], ["value_nat", "gain", unit("nat")],
    ["moves", "moves", String], ["detections", "detections", String],
  ],
};

/** Returns [plain name, text] of the known members of a record. */
export function plain_rows(kind, record) {
  return kMembers[kind].filter(([key]) => record[key] !== undefined && record[key] !== null).map(([key, name, text]) => [name, text(record[key])]);
}

/** Returns [name, text] of all members of a record that are not objects, unchanged. */
export function raw_rows(record) {
  return Object.entries(record)
    .filter(([key, value]) => key !== "timestamp" && (value === null || typeof value !== "object" || Array.isArray(value)))
    .map(([key, value]) => [key, Array.isArray(value) ? value.map((each) => (typeof each === "object" ? `${each.name}: ${each.count}` : each)).join(", ") : String(value)]);
}
