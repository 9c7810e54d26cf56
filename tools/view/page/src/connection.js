// Client of the Foxglove WebSocket protocol: converts received frames into calls of `on`.

const kMessage = 0x01;
const kTime = 0x02;
const kPlayback = 0x05;
const kRetry_ms = 1500;
/** Schemas whose record replaces all earlier ones of its topic. Of several records between two pictures, only the newest is
    parsed. */
const kPictures = new Set(["foxglove.SceneUpdate", "foxglove.FrameTransforms", "foxglove.Grid"]);

/** Topic of the bodies' poses, from which the trails are made. One record per kTrailPeriod_s (in the time of the records) is
    parsed even if pictures are drawn less often. */
const kBodies = "/transforms";
const kTrailPeriod_s = 0.2;
const kPassedMax = 1000;

/** Converts microseconds since the epoch into seconds. All times are converted here, so that equal times are equal numbers. */
export const seconds_of = (utime) => utime / 1e6;
const seconds_at = (view, offset) => seconds_of(Number(view.getBigUint64(offset, true) / 1000n));
export const seconds = (time) => time.sec + time.nsec * 1e-9;

export class Connection {
  /** @param on {open, close, info, channel, channels, record, time, playback, status}: called for each event */
  constructor(url, on) {
    this.url = url;
    this.on = on;
    this.channels = new Map(); // advertised channel by topic
    this.subscriptions = new Map(); // topic by subscription id
    this.waiting = new Map(); // newest unparsed record of kPictures, by topic
    this.passed = []; // earlier records of kBodies, parsed before the newest one
    this.passed_at = -Infinity; // time of the last record in `passed`
    this.next_id = 1;
    this.requests = 0;
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(this.url, ["foxglove.sdk.v1", "foxglove.websocket.v1"]);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => this.on.open();
    this.socket.onmessage = (event) =>
      typeof event.data === "string"
        ? this.receive_text(JSON.parse(event.data))
        : this.receive_binary(new DataView(event.data));
    this.socket.onclose = () => {
      this.channels.clear();
      this.subscriptions.clear();
      this.forget_waiting();
      this.held = null;
      this.on.close();
      setTimeout(() => this.connect(), kRetry_ms);
    };
  }

  receive_text(message) {
    if (message.op === "serverInfo") {
      this.on.info({
        name: message.name,
        session: message.sessionId,
        range: message.dataStartTime && [seconds(message.dataStartTime), seconds(message.dataEndTime)],
      });
    } else if (message.op === "advertise") {
      message.channels.forEach((channel) => this.channels.set(channel.topic, channel));
      message.channels.forEach(({ topic }) => this.on.channel(topic));
      this.on.channels();
    } else if (message.op === "status") {
      this.on.status(message);
    } else if (message.op === "removeStatus") {
      message.statusIds.forEach((id) => this.on.status({ level: 0, id, message: "" }));
    }
  }

  receive_binary(view) {
    const kind = view.getUint8(0);
    if (kind === kMessage) {
      const topic = this.subscriptions.get(view.getUint32(1, true));
      if (topic === undefined) return;
      if (kPictures.has(this.channels.get(topic)?.schemaName)) {
        if (topic === kBodies) this.keep_bodies(this.waiting.get(topic));
        this.waiting.delete(topic); // so that the topic is moved to the end of the map
        this.waiting.set(topic, view);
      } else {
        this.read(topic, view);
      }
    } else if (kind === kTime) {
      this.on.time(seconds_at(view, 1));
    } else if (kind === kPlayback) {
      this.on.playback({
        status: ["playing", "paused", "buffering", "ended"][view.getUint8(1)],
        time: seconds_at(view, 2),
        speed: view.getFloat32(10, true),
        sought: view.getUint8(14) !== 0,
      });
    }
  }

  /** Keeps a record that a newer one replaces, if kTrailPeriod_s has passed since the last record that was kept.
      @param view the replaced record, or undefined */
  keep_bodies(view) {
    if (!view || this.passed.length >= kPassedMax) return;
    const time = seconds_at(view, 5);
    const since = time - this.passed_at;
    if (since >= 0 && since < kTrailPeriod_s) return;
    this.passed_at = time;
    this.passed.push(view);
  }

  read(topic, view) {
    const text = new TextDecoder().decode(new Uint8Array(view.buffer, 13));
    const record = [topic, seconds_at(view, 5), JSON.parse(text)];
    if (this.held) this.held.push(record);
    else this.on.record(...record);
  }

  /** Delays the delivery of records until resume(). */
  pause() {
    this.held ??= [];
  }

  resume() {
    const held = this.held ?? [];
    this.held = null;
    held.forEach((record) => this.on.record(...record));
  }

  /** Delivers the waiting records. Call before each picture. */
  read_waiting() {
    const waiting = [...this.waiting];
    this.waiting.clear();
    this.passed.splice(0).forEach((view) => this.read(kBodies, view));
    waiting.forEach(([topic, view]) => this.read(topic, view));
  }

  /** Discards the waiting records after a jump of the player. */
  forget_waiting() {
    this.waiting.clear();
    this.passed.length = 0;
  }

  /** Subscribes to a known topic or unsubscribes from it. Does nothing if the topic already has this state. */
  want(topic, is_wanted) {
    const channel = this.channels.get(topic);
    const known = [...this.subscriptions].find(([, name]) => name === topic);
    if (channel === undefined || is_wanted === (known !== undefined)) return;
    if (is_wanted) {
      const id = this.next_id++;
      this.subscriptions.set(id, topic);
      this.send({ op: "subscribe", subscriptions: [{ id, channelId: channel.id }] });
    } else {
      this.subscriptions.delete(known[0]);
      this.waiting.delete(topic);
      this.send({ op: "unsubscribe", subscriptionIds: [known[0]] });
    }
  }

  is_open() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  /** Subscribes again to all subscribed topics, so that the server sends their newest records. */
  renew() {
    for (const topic of [...this.subscriptions.values()]) {
      this.want(topic, false);
      this.want(topic, true);
    }
  }

  /** Commands the player of a log. `seek`: seconds since the epoch, or undefined. */
  play(is_playing, speed, seek) {
    const id = new TextEncoder().encode(`page-${++this.requests}`);
    const frame = new DataView(new ArrayBuffer(19 + id.length));
    frame.setUint8(0, 0x03);
    frame.setUint8(1, is_playing ? 0 : 1);
    frame.setFloat32(2, speed, true);
    frame.setUint8(6, seek === undefined ? 0 : 1);
    frame.setBigUint64(7, BigInt(Math.round((seek ?? 0) * 1e6)) * 1000n, true);
    frame.setUint32(15, id.length, true);
    new Uint8Array(frame.buffer, 19).set(id);
    this.send(frame.buffer);
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(message instanceof ArrayBuffer ? message : JSON.stringify(message));
    }
  }
}
