// seek.mjs ws://HOST:PORT [SEEKS]: measures how long `vantage view LOG` takes to show another instant. Subscribes to
// every topic except raw messages. A seek is timed from its request until the server sends the new time, which
// follows the complete scene. The instants are random but the same in each run. Prints a line of JSON, in ms.

import WebSocket from "ws";

const [url, seeks = "200"] = process.argv.slice(2);
const kOver_ms = 50;

const began = performance.now();
const socket = new WebSocket(url, ["foxglove.sdk.v1"]);
let range = null;
let first_message_ms = null;
let subscription = 0;
let awaited = null;

socket.on("message", (data, is_binary) => {
  if (!is_binary) {
    const said = JSON.parse(data);
    if (said.op === "serverInfo") range = [said.dataStartTime, said.dataEndTime].map(({ sec, nsec }) => BigInt(sec) * 1_000_000n + BigInt(nsec / 1000));
    if (said.op !== "advertise") return;
    const subscriptions = said.channels.filter(({ topic }) => !topic.startsWith("/lcm/")).map(({ id }) => ({ id: ++subscription, channelId: id }));
    if (subscriptions.length > 0) socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
    return;
  }
  if (data[0] === 1) first_message_ms ??= performance.now() - began;
  if (data[0] === 2 && awaited && data.readBigUInt64LE(1) === awaited.ns) {
    awaited.resolve(performance.now() - awaited.at_ms);
    awaited = null;
  }
});

/** Returns pseudo-random numbers in [0, 1), the same in each run. */
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;

function seek(us) {
  const frame = Buffer.alloc(19);
  frame.writeUInt8(3, 0);
  frame.writeUInt8(1, 1);
  frame.writeFloatLE(1, 2);
  frame.writeUInt8(1, 6);
  frame.writeBigUInt64LE(us * 1000n, 7);
  return new Promise((resolve) => {
    awaited = { ns: us * 1000n, at_ms: performance.now(), resolve };
    socket.send(frame);
  });
}

await new Promise((resolve, reject) => socket.on("open", resolve).on("error", reject));
while (range === null || first_message_ms === null) await new Promise((resolve) => setTimeout(resolve, 5));
const took_ms = [];
for (let i = 0; i < Number(seeks); ++i) {
  const length = Number(range[1] - range[0]);
  took_ms.push(await seek(range[0] + BigInt(Math.floor(length * random()))));
}
took_ms.sort((a, b) => a - b);
const at = (share) => Number(took_ms[Math.floor(share * (took_ms.length - 1))].toFixed(1));
console.log(JSON.stringify({
  first_message_ms: Math.round(first_message_ms), seeks: took_ms.length, p50: at(0.5), p95: at(0.95), worst: at(1),
  over_50_ms: took_ms.filter((ms) => ms > kOver_ms).length,
}));
process.exit(0);
