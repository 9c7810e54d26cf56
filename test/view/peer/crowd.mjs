// crowd.mjs ws://HOST:PORT SECONDS READERS STALLED: connects many viewers to one server. Each subscribes to all
// channels. READERS of them read (with Foxglove's own client), STALLED of them stop reading. Prints what each reader
// has received, as a line of JSON every 10 s and at the end.

import foxglove from "@foxglove/ws-protocol";
import WebSocket from "ws";

const { FoxgloveClient } = foxglove;

const [url, seconds, readers, stalled] = process.argv.slice(2);
const kReport_ms = 10_000;
const subprotocols = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

function read(index) {
  const socket = new WebSocket(url, [subprotocols[index % subprotocols.length]]);
  const client = new FoxgloveClient({ ws: socket });
  const heard = { messages: 0, bytes: 0, channels: 0, warnings: [], is_open: false };
  client.on("open", () => (heard.is_open = true));
  client.on("close", () => (heard.is_open = false));
  client.on("error", () => {}); // the client does not know one frame of the newer subprotocol
  client.on("status", (event) => heard.warnings.push(event.message));
  client.on("advertise", (channels) => {
    heard.channels += channels.length;
    channels.forEach((channel) => client.subscribe(channel.id));
  });
  client.on("message", ({ data }) => {
    heard.messages += 1;
    heard.bytes += data.byteLength;
  });
  return heard;
}

/** Subscribes to all that is advertised and stops reading after five seconds. */
function stall(index) {
  const state = { is_open: true };
  const socket = new WebSocket(url, [subprotocols[index % subprotocols.length]]);
  socket.on("close", () => (state.is_open = false));
  socket.on("message", (text, is_binary) => {
    const message = is_binary ? {} : JSON.parse(text);
    if (message.op === "advertise") {
      const subscriptions = message.channels.map(({ id }) => ({ id, channelId: id }));
      socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
    }
  });
  setTimeout(() => socket.pause(), 5000);
  return state;
}

const heard = Array.from({ length: Number(readers) }, (_, index) => read(index));
const silent = Array.from({ length: Number(stalled) }, (_, index) => stall(index));
const began = Date.now();
const report = () =>
  console.log(
    JSON.stringify({
      elapsed_s: Math.round((Date.now() - began) / 1000),
      readers: heard,
      stalled_open: silent.filter((each) => each.is_open).length,
    }),
  );
setInterval(report, kReport_ms);
setTimeout(() => {
  report();
  process.exit(0);
}, 1000 * Number(seconds));
