// channels.mjs ws://HOST:PORT [MIN_CHANNELS]: reads the viewer server's channels with Foxglove's own client.
// Subscribes to all advertised channels, by each subprotocol in turn. If the server shows a log, plays it. Prints
// one line per channel. Fails unless each channel sends data (/events need not), and each message is an object of
// its channel's schema.

import assert from "node:assert";
import { get } from "node:http";
import foxglove from "@foxglove/ws-protocol";
import WebSocket from "ws";

const { FoxgloveClient } = foxglove;

const [url, least = "10"] = process.argv.slice(2);
const kPatience_ms = 60_000;
const kRaw = "/lcm/PLAN_Q1"; // plans as published on the bus
const kPlayed = 500; // least number of /transforms messages that shows that a log is playing

/** Returns the members of `value` that are not in the schema or have another type. */
function strangers(schema, value, at) {
  if (schema.type === "object" && !schema.properties) return value !== null && typeof value === "object" ? [] : [at];
  if (schema.type === "object") {
    if (value === null || typeof value !== "object" || Array.isArray(value)) return [at];
    return Object.entries(value).flatMap(([key, member]) =>
      key in schema.properties ? strangers(schema.properties[key], member, `${at}.${key}`) : [`${at}.${key}`],
    );
  }
  if (schema.type === "array") {
    if (!Array.isArray(value)) return [at];
    return value.flatMap((element) => strangers(schema.items, element, `${at}[]`));
  }
  const is_good = {
    number: Number.isFinite(value),
    integer: Number.isInteger(value),
    string: typeof value === "string",
    boolean: typeof value === "boolean",
  }[schema.type];
  return is_good ? [] : [at];
}

function request(is_playing, speed) {
  const frame = Buffer.alloc(19);
  frame.writeUInt8(3, 0);
  frame.writeUInt8(is_playing ? 0 : 1, 1);
  frame.writeFloatLE(speed, 2);
  return frame;
}

async function listen(subprotocol) {
  const socket = new WebSocket(url, [subprotocol]);
  const client = new FoxgloveClient({ ws: socket });
  const channels = new Map();
  const by_subscription = new Map();
  const failures = [];
  const statuses = [];
  let info;
  client.on("serverInfo", (event) => (info = event));
  // Foxglove's client does not know the playback state (5) of the newer subprotocol; any other error is a failure.
  client.on("error", (error) => {
    const is_playback = subprotocol === "foxglove.sdk.v1" && String(error).endsWith("binary message: 5");
    if (!is_playback) failures.push(String(error));
  });
  client.on("status", (event) => statuses.push(event));
  client.on("advertise", (advertised) => {
    for (const channel of advertised) {
      assert.equal(channel.encoding, "json");
      assert.equal(channel.schemaEncoding, "jsonschema");
      const entry = { ...channel, parsed: JSON.parse(channel.schema), count: 0 };
      assert.equal(entry.parsed.title, channel.schemaName);
      if (channel.topic.startsWith("/lcm/") && channel.topic !== kRaw) continue; // raw messages would double the work
      channels.set(channel.id, entry);
      by_subscription.set(client.subscribe(channel.id), entry);
    }
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const entry = by_subscription.get(subscriptionId);
    const value = JSON.parse(new TextDecoder().decode(data));
    entry.count += 1;
    assert(timestamp > 0n);
    failures.push(...strangers(entry.parsed, value, entry.topic));
  });
  await new Promise((resolve, reject) => {
    client.on("open", resolve);
    client.on("error", reject);
  });
  assert.equal(socket.protocol, subprotocol);
  const began = Date.now();
  const until = async (holds) => {
    while (!holds() && Date.now() - began < kPatience_ms) {
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  };
  await until(() => channels.size >= Number(least));
  const is_log = info.capabilities.includes("playbackControl");
  if (is_log) socket.send(request(true, 20));
  const count = (topic) => [...channels.values()].find((each) => each.topic === topic)?.count ?? 0;
  await until(() => !is_log || count("/transforms") >= kPlayed);
  await until(() => [...channels.values()].every((each) => each.count > 0 || each.topic === "/events"));
  await until(() => [...channels.values()].some((each) => each.topic === kRaw && each.count > 0)); // published once per round
  if (is_log) socket.send(request(false, 1));
  client.close();
  return { info, channels: [...channels.values()], failures, statuses };
}

for (const subprotocol of ["foxglove.sdk.v1", "foxglove.websocket.v1"]) {
  const heard = await listen(subprotocol);
  console.log(`${subprotocol}: ${heard.info.name}, capabilities [${heard.info.capabilities}]`);
  for (const channel of heard.channels) {
    console.log(`  ${String(channel.count).padStart(5)}  ${channel.topic}  ${channel.schemaName}`);
  }
  assert.deepEqual([...new Set(heard.failures)], []);
  assert.deepEqual(heard.statuses, []);
  assert(heard.channels.some(({ topic, count }) => topic === kRaw && count > 0), "no raw messages of the bus");
  assert(heard.channels.length >= Number(least), `${heard.channels.length} channels`);
  const silent = heard.channels.filter((each) => each.count === 0).map((each) => each.topic);
  assert.deepEqual(silent.filter((topic) => topic !== "/events"), []);
}

const refused = new WebSocket(url, ["something.else"]);
await new Promise((resolve, reject) => {
  refused.on("unexpected-response", (_, response) =>
    response.statusCode === 400 ? resolve() : reject(new Error(String(response.statusCode))),
  );
  refused.on("open", () => reject(new Error("another subprotocol was accepted")));
  refused.on("error", () => {});
});

// The server also refuses requests under a host name that a third party could resolve to this address (DNS
// rebinding), and requests from pages of other servers.
const { hostname, port } = new URL(url);
const status_of = (headers) =>
  new Promise((resolve, reject) => get({ hostname, port, path: "/api/topics", headers }, ({ statusCode }) => resolve(statusCode)).on("error", reject));
assert.equal(await status_of({}), 200);
assert.equal(await status_of({ host: "evil.example:8765" }), 403);
assert.equal(await status_of({ origin: "https://evil.example" }), 403);
const opens = (origin) =>
  new Promise((resolve) => {
    const socket = new WebSocket(url, ["foxglove.sdk.v1"], { origin });
    socket.on("open", () => resolve(true));
    socket.on("unexpected-response", (_, response) => resolve(response.statusCode));
    socket.on("error", () => {});
  });
assert.equal(await opens("https://app.foxglove.dev"), true);
assert.equal(await opens("http://localhost:8080"), true);
assert.equal(await opens("https://evil.example"), 403);
console.log("ok");
process.exit(0);
