// Lines and horizontal surfaces on a 2-D canvas, as a camera sees them.

import { shown } from "./appearance.js";

const kNear_m = 0.02; // m; distance of the near clipping plane
const kStep_px = 0.7; // corners closer than this to the last drawn corner are left out
const kThin_px = 1.5; // thinner lines are drawn 1 pixel wide if there are many items, which halves the time

let last_x = 0;
let last_y = 0;

function go(pen, x, y, is_move) {
  if (is_move) pen.moveTo(x, y);
  else pen.lineTo(x, y);
  last_x = x;
  last_y = y;
}

/** Adds the visible part of a line or of a surface's edge, i.e. the part in front of the camera, to the pen's path.
    @param e elements of the matrix from the corners' frame to homogeneous pixels of the stage (multiplied by the distance)
    @param corners x, y, z of each corner */
export function trace(pen, e, corners, is_surface) {
  const count = corners.length;
  let is_first = true;
  let from_x = 0;
  let from_y = 0;
  let from_w = -1;
  for (let i = is_surface ? -3 : 0; i < count; i += 3) {
    const at = i < 0 ? count - 3 : i; // a surface's edge begins with the segment from its last corner
    const a = corners[at];
    const b = corners[at + 1];
    const c = corners[at + 2];
    const w = e[3] * a + e[7] * b + e[11] * c + e[15];
    const x = e[0] * a + e[4] * b + e[8] * c + e[12];
    const y = e[1] * a + e[5] * b + e[9] * c + e[13];
    const is_begin = i === (is_surface ? -3 : 0);
    const is_seen = w >= kNear_m;
    if (!is_begin && is_seen !== from_w >= kNear_m) {
      const share = (kNear_m - from_w) / (w - from_w);
      const cut_x = (from_x + share * (x - from_x)) / kNear_m;
      const cut_y = (from_y + share * (y - from_y)) / kNear_m;
      go(pen, cut_x, cut_y, is_first || (is_seen && !is_surface));
      is_first = false;
    }
    if (is_seen && !(is_begin && is_surface)) {
      const [px, py] = [x / w, y / w];
      const is_far = Math.abs(px - last_x) + Math.abs(py - last_y) >= kStep_px;
      if (is_first || is_far || i === count - 3) go(pen, px, py, is_first);
      is_first = false;
    }
    from_x = x;
    from_y = y;
    from_w = w;
  }
  if (is_surface && !is_first) pen.closePath();
}

export function css_of(color, shade = 1) {
  const { r, g, b, a } = shown(color);
  return `rgba(${[r, g, b].map((c) => Math.round(255 * Math.min(1, shade * c)))},${a})`;
}

const flat = (corners) => Float64Array.from(corners.flatMap((c) => [c.x, c.y, c.z]));

function middle_of(lines) {
  const corners = lines.flat();
  return corners.reduce((sum, corner) => sum.add(corner), corners[0].clone().set(0, 0, 0)).divideScalar(corners.length);
}

/** Lines of one colour. */
export class Line {
  constructor(frame, lines, { color, thickness, scale_invariant }) {
    this.frame = frame;
    this.rank = 1;
    this.lines = lines.map(flat);
    this.centre = middle_of(lines);
    this.style = css_of(color);
    this.thickness = thickness;
    this.is_in_pixels = scale_invariant;
  }

  paint(pen, e, view) {
    pen.beginPath();
    for (const corners of this.lines) trace(pen, e, corners, false);
    pen.strokeStyle = this.style;
    const width = this.is_in_pixels ? this.thickness : this.thickness * view.pixels_at(this.at);
    pen.lineWidth = view.is_crowded && width <= kThin_px ? 1 : width;
    pen.stroke();
  }
}

/** Horizontal surfaces of one colour. */
export class Surface {
  constructor(frame, edges, { color }) {
    this.frame = frame;
    this.rank = 0;
    this.edges = edges.map(flat);
    this.centre = middle_of(edges);
    this.style = css_of(color);
  }

  paint(pen, e) {
    pen.beginPath();
    for (const corners of this.edges) trace(pen, e, corners, true);
    pen.fillStyle = this.style;
    pen.fill();
  }
}

const name_of = (corner) => `${corner.x} ${corner.y} ${corner.z}`;

/** Returns the outline of the union of triangles, without the edges that two triangles share. (Seams would be visible between
    triangles that are painted one by one.) @param corners three per triangle */
export function edges_of(corners) {
  const ways = new Map(); // directed edges by the names of both ends
  for (let i = 0; i + 2 < corners.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const [from, to] = [corners[i + k], corners[i + ((k + 1) % 3)]];
      const [here, there] = [name_of(from), name_of(to)];
      if (here === there) continue;
      if (!ways.delete(`${there} > ${here}`)) ways.set(`${here} > ${there}`, { from, here, there });
    }
  }
  const onward = new Map(); // directed edges by the name of their start
  for (const way of ways.values()) {
    if (!onward.has(way.here)) onward.set(way.here, []);
    onward.get(way.here).push(way);
  }
  const edges = [];
  for (const begun of onward.values()) {
    while (begun.length > 0) {
      const edge = [];
      for (let way = begun.pop(); way; way = onward.get(way.there)?.pop()) edge.push(way.from);
      edges.push(edge);
    }
  }
  return edges;
}
