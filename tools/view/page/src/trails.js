// Past paths of bodies, displayed for a selectable time.

const kLeast_s = 0.15;
const kLeast_m = 0.02;
const kSpeed_s = 1.2; // s; last part of the path, from which the speed is computed
const kGone_s = 5; // s; the speed of a body that was not visible for this time is unknown
const kPointsMax = 40_000; // maximum number of points per body

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
    this.paths = new Map(); // {t, x, y, z} by body
    this.seen = new Map(); // s; time when each body was last visible, with or without motion
  }

  clear() {
    this.paths.clear();
    this.seen.clear();
  }

  add(body, time, x, y, z) {
    if (!this.paths.has(body)) this.paths.set(body, { t: [], x: [], y: [], z: [] });
    this.seen.set(body, time);
    const path = this.paths.get(body);
    const last = path.t.length - 1;
    if (last >= 0) {
      if (time < path.t[last] - 1) Object.values(path).forEach((list) => (list.length = 0)); // the time decreased: a new run has begun
      else if (time - path.t[last] < kLeast_s || Math.hypot(x - path.x[last], y - path.y[last], z - path.z[last]) < kLeast_m) return;
    }
    path.t.push(time);
    path.x.push(x);
    path.y.push(y);
    path.z.push(z);
    if (path.t.length > kPointsMax) Object.values(path).forEach((list) => list.splice(0, kPointsMax / 10));
  }

  /** Returns the points of the path between `now` − `length_s` and `now`. */
  points(body, now, length_s) {
    const path = this.paths.get(body);
    const [from, to] = [after(path.t, now - length_s), after(path.t, now)];
    return Array.from({ length: to - from }, (_, i) => ({ x: path.x[from + i], y: path.y[from + i], z: path.z[from + i] }));
  }

  /** Returns the speed of a body at `now` [m/s], from its path of the last kSpeed_s; null if unknown. A path gets no points
      while its body is stationary, so a path without recent points gives 0. */
  speed(body, now) {
    const path = this.paths.get(body);
    if (!path || this.seen.get(body) < now - kGone_s) return null;
    const at = Math.min(now, this.seen.get(body));
    const to = after(path.t, at) - 1;
    if (to < 1) return null;
    if (path.t[to] < at - kSpeed_s) return 0;
    const from = Math.min(after(path.t, at - kSpeed_s), to - 1);
    let length = 0;
    for (let i = from; i < to; ++i) length += Math.hypot(path.x[i + 1] - path.x[i], path.y[i + 1] - path.y[i], path.z[i + 1] - path.z[i]);
    return length / (path.t[to] - path.t[from]);
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
