// Links that contain the log, the instant, the layout and the cameras.

/** Converts a state into the text after a link's '#'.
    @param state {log, since, view, cameras, off, on, trail_s, zoomed, charts_off, charts_on, theme, fields,
    picked, side, follow}; members that are not set are left out */
export function write_link(state) {
  const out = new URLSearchParams();
  const put = (key, value) => value !== null && value !== undefined && value !== "" && out.set(key, value);
  put("log", state.log);
  put("t", state.since?.toFixed(2));
  put("view", state.view);
  put("cam", state.cameras?.map((x) => Number(x.toFixed(3))).join(","));
  put("on", state.on?.join(","));
  put("off", state.off?.join(","));
  put("trail", state.trail_s);
  put("win", state.zoomed?.map((x) => x.toFixed(3)).join(","));
  put("without", state.charts_off?.join(","));
  put("with", state.charts_on?.join(","));
  put("theme", state.theme);
  put("plot", state.fields?.map(([topic, path]) => `${topic}~${path.join(".")}`).join(" "));
  put("pick", state.picked);
  put("side", state.side);
  put("follow", state.follow);
  return out.toString();
}

const numbers = (text, count) => {
  const list = (text ?? "").split(",").map(Number);
  return list.length === count && list.every(Number.isFinite) ? list : null;
};

/** Parses the text of write_link(). Missing or unreadable members are null; missing lists are empty. */
export function read_link(hash) {
  const from = new URLSearchParams(hash.replace(/^#/, ""));
  const words = (key) => (from.get(key) ?? "").split(/[, ]/).filter(Boolean);
  const since = from.get("t") === null ? NaN : Number(from.get("t"));
  const trail_s = Number(from.get("trail") ?? NaN);
  return {
    log: from.get("log"),
    since: Number.isFinite(since) ? since : null,
    view: ["plan", "space", "both"].includes(from.get("view")) ? from.get("view") : null,
    cameras: numbers(from.get("cam"), 9),
    on: words("on"),
    off: words("off"),
    trail_s: Number.isFinite(trail_s) ? trail_s : null,
    zoomed: numbers(from.get("win"), 2),
    charts_off: words("without"),
    charts_on: words("with"),
    theme: ["light", "dark"].includes(from.get("theme")) ? from.get("theme") : null,
    fields: words("plot").map((each) => each.split("~")).filter((each) => each.length === 2).map(([topic, path]) => [topic, path.split(".")]),
    picked: from.get("pick"),
    side: from.get("side"),
    follow: from.get("follow"),
  };
}

/** Offers a file for download. */
export function save(name, content) {
  const link = document.createElement("a");
  link.download = name;
  link.href = URL.createObjectURL(content);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
