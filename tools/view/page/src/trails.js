// Paths of bodies, displayed over a selectable time.

const kLeast_s = 0.15;
const kLeast_m = 0.02;
const kSpeed_s = 1.2; // part of the path from which the speed is computed
const kGone_s = 5; // the speed of a body not seen for this time is unknown
const kPointsMax = 40_000; // per body

/** Returns the first index whose time is after `time`. */
function after(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return low;
}

export class Trails {
  constructor() {
    this.ways = new Map(); // {t, x, y, z} by body
    this.seen = new Map(); // time when last seen, also without motion, by body
  }

  clear() {
    this.ways.clear();
    this.seen.clear();
  }

  add(body, time, x, y, z) {
    if (!this.ways.has(body)) this.ways.set(body, { t: [], x: [], y: [], z: [] });
    this.seen.set(body, time);
    const way = this.ways.get(body);
    const last = way.t.length - 1;
    if (last >= 0) {
      if (time < way.t[last] - 1) Object.values(way).forEach((list) => (list.length = 0)); // the time went back: another run
      else if (time - way.t[last] < kLeast_s || Math.hypot(x - way.x[last], y - way.y[last], z - way.z[last]) < kLeast_m) return;
    }
    way.t.push(time);
    way.x.push(x);
    way.y.push(y);
    way.z.push(z);
    if (way.t.length > kPointsMax) Object.values(way).forEach((list) => list.splice(0, kPointsMax / 10));
  }

  /** Returns the points of the path between `now` − `length_s` and `now`. */
  points(body, now, length_s) {
    const way = this.ways.get(body);
    const [from, to] = [after(way.t, now - length_s), after(way.t, now)];
    return Array.from({ length: to - from }, (_, i) => ({ x: way.x[from + i], y: way.y[from + i], z: way.z[from + i] }));
  }

  /** Returns the speed of a body at `now` [m/s], from its path of the last kSpeed_s; null if unknown. A path gets no points
      while its body is stationary, so a path without recent points gives 0. */
  speed(body, now) {
    const way = this.ways.get(body);
    if (!way || this.seen.get(body) < now - kGone_s) return null;
    const at = Math.min(now, this.seen.get(body));
    const to = after(way.t, at) - 1;
    if (to < 1) return null;
    if (way.t[to] < at - kSpeed_s) return 0;
    const from = Math.min(after(way.t, at - kSpeed_s), to - 1);
    let length = 0;
    for (let i = from; i < to; ++i) length += Math.hypot(way.x[i + 1] - way.x[i], way.y[i + 1] - way.y[i], way.z[i + 1] - way.z[i]);
    return length / (way.t[to] - way.t[from]);
  }
}

/** Returns a trail as an entity of a scene. */
export function trail_entity(body, points, color) {
  return {
    id: `track/${body}`, frame_id: "world", metadata: [], texts: [], cubes: [], spheres: [], cylinders: [], triangles: [],
    lines: [{
      type: 0, pose: { position: { x: 0, y: 0, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
      thickness: 1.5, scale_invariant: true, color: { ...color, a: 0.55 }, points,
    }],
  };
}
