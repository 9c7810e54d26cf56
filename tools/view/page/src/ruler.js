// Drawings over or under the world: grid with numbers, scale bar, measured distance, ring around the selection.

import * as THREE from "three";
import { css_of_role } from "./appearance.js";

const kSpace_px = 72; // minimum distance between lines of the grid
const kBar_px = 150; // maximum length of the scale bar
const kFont = '11px system-ui, "DejaVu Sans", sans-serif';

/** Returns the smallest number of 1, 2, 5, 10, … (times a power of ten) that is ≥ `least`. */
export function round_up(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((step) => step * decade).find((step) => step >= least * (1 - 1e-9));
}

export const metres = (value) => String(Number(value.toPrecision(6)));

/** Returns the coordinates of grid lines between two coordinates. */
function ticks(from, to, spacing) {
  const out = [];
  for (let i = Math.ceil(from / spacing - 1e-6); i * spacing <= to + 1e-6 * spacing; ++i) out.push(i * spacing);
  return out;
}

export const spacing_of = (pixels_a_m) => round_up(kSpace_px / pixels_a_m);

/** Returns the grid as an entity of a scene. */
export function grid_entity({ min_m, max_m }, spacing) {
  const z = 0.004;
  const lines = [
    ...ticks(min_m[0], max_m[0], spacing).map((x) => [x, min_m[1], x, max_m[1]]),
    ...ticks(min_m[1], max_m[1], spacing).map((y) => [min_m[0], y, max_m[0], y]),
  ];
  return {
    id: "grid", frame_id: "world", metadata: [], texts: [], cubes: [], spheres: [], cylinders: [], triangles: [],
    lines: [{
      type: 2, pose: { position: { x: 0, y: 0, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
      thickness: 1, scale_invariant: true, color: { r: 0.5, g: 0.54, b: 0.6, a: 0.28 },
      points: lines.flatMap(([ax, ay, bx, by]) => [{ x: ax, y: ay, z }, { x: bx, y: by, z }]),
    }],
  };
}

/** Writes the coordinates next to the world's edges; in the plan view they stay within the picture. */
export function write_numbers(pen, project, at, { min_m, max_m }, spacing, is_plan) {
  pen.font = kFont;
  pen.fillStyle = css_of_role("wall");
  const inside = (value, low, high) => Math.min(high, Math.max(low, value));
  const draw = (list, place, words) => {
    let last = null;
    for (const value of list) {
      const point = place(value);
      if (!point) continue;
      const width = pen.measureText(metres(value)).width;
      if (last && Math.hypot(point[0] - last[0], point[1] - last[1]) < Math.max(18, width + 6)) continue;
      last = point;
      pen.fillText(metres(value), point[0], point[1]);
    }
    if (last) pen.fillText(words, last[0], last[1] + (words === "x [m]" ? 14 : -16));
  };
  pen.textBaseline = "middle";
  pen.textAlign = "center";
  draw(ticks(min_m[0], max_m[0], spacing), (x) => {
    const p = project(x, min_m[1], 0);
    if (!p || p[0] < at.x + 8 || p[0] > at.x + at.width - 8) return null;
    return [p[0], is_plan ? inside(p[1] + 12, at.y + 10, at.y + at.height - 8) : p[1] + 12];
  }, "x [m]");
  pen.textAlign = "right";
  draw(ticks(min_m[1], max_m[1], spacing), (y) => {
    const p = project(min_m[0], y, 0);
    if (!p || p[1] < at.y + 8 || p[1] > at.y + at.height - 8) return null;
    return [is_plan ? inside(p[0] - 6, at.x + 24, at.x + at.width - 8) : p[0] - 8, p[1]];
  }, "y [m]");
}

/** Writes the name of a view, and a line at its left edge if another view is to the left. */
export function draw_caption(pen, at, words) {
  pen.font = kFont;
  pen.fillStyle = css_of_role("wall");
  pen.textAlign = "left";
  pen.textBaseline = "top";
  pen.fillText(words, at.x + 10, at.y + 9);
  pen.fillStyle = css_of_role("wall", 0.3);
  if (at.x > 0) pen.fillRect(at.x, at.y, 1, at.height);
}

/** Returns the length of the scale bar: {length_m, width_px}. */
export function scale_of(pixels_a_m) {
  const most_m = kBar_px / pixels_a_m;
  const length_m = [5, 2, 1].map((step) => step * 10 ** Math.floor(Math.log10(most_m))).find((step) => step <= most_m);
  return { length_m, width_px: length_m * pixels_a_m };
}

export function draw_scale(pen, at, pixels_a_m) {
  const { length_m, width_px } = scale_of(pixels_a_m);
  const [x, y] = [at.x + at.width - 18 - width_px, at.y + at.height - 14];
  pen.strokeStyle = pen.fillStyle = css_of_role("truth");
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(x, y - 5);
  pen.lineTo(x, y);
  pen.lineTo(x + width_px, y);
  pen.lineTo(x + width_px, y - 5);
  pen.stroke();
  pen.font = kFont;
  pen.textAlign = "center";
  pen.textBaseline = "bottom";
  pen.fillText(`${metres(length_m)} m`, x + width_px / 2, y - 3);
}

/** Draws the ring around the selected entity. */
export function draw_ring(pen, point, radius_px) {
  pen.strokeStyle = css_of_role("truth", 0.85);
  pen.lineWidth = 1.5;
  pen.setLineDash([4, 3]);
  pen.beginPath();
  pen.arc(point[0], point[1], radius_px, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
}

/** Returns the distance and direction between two points on the ground as text. */
export function distance_words(a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const degrees = (180 / Math.PI) * Math.atan2(dy, dx);
  return `${Math.hypot(dx, dy).toFixed(2)} m · Δx ${dx.toFixed(2)} · Δy ${dy.toFixed(2)} · ${degrees.toFixed(0)}°`;
}

export function draw_measure(pen, project, at, a, b) {
  const [from, to] = [project(a[0], a[1], 0), project(b[0], b[1], 0)];
  if (!from || !to) return;
  const ink = css_of_role("truth");
  pen.strokeStyle = ink;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
  pen.fillStyle = ink;
  for (const [x, y] of [from, to]) pen.fillRect(x - 3, y - 3, 6, 6);
  const words = distance_words(a, b);
  pen.font = `600 12px system-ui, "DejaVu Sans", sans-serif`;
  const width = pen.measureText(words).width + 12;
  const left = Math.min(at.x + at.width - width - 4, Math.max(at.x + 4, (from[0] + to[0]) / 2 - width / 2));
  const top = Math.max(at.y + 4, (from[1] + to[1]) / 2 - 28);
  pen.fillStyle = css_of_role("seen", 0.94);
  pen.strokeStyle = css_of_role("wall", 0.6);
  pen.lineWidth = 1;
  pen.beginPath();
  pen.rect(left, top, width, 20);
  pen.fill();
  pen.stroke();
  pen.fillStyle = ink;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  pen.fillText(words, left + 6, top + 10);
}

/** Moves a camera without turning it, so that corners fill the free part of an area. Moves `target` as well.
    @param corners corners of the box to be visible
    @param room {left, right, top, bottom}: pixels to leave empty at each edge */
export function fit_perspective(camera, target, corners, { width, height }, room) {
  const backward = new THREE.Vector3().subVectors(camera.position, target).normalize();
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  const box_of = () => {
    camera.position.copy(target).addScaledVector(backward, distance);
    camera.lookAt(target);
    camera.updateMatrixWorld();
    const points = corners.map((corner) => corner.clone().project(camera));
    const [xs, ys] = [points.map(({ x }) => x), points.map(({ y }) => y)];
    return { left: Math.min(...xs), right: Math.max(...xs), bottom: Math.min(...ys), top: Math.max(...ys) };
  };
  // Free area in normalised device coordinates.
  const free = {
    left: -1 + (2 * room.left) / width, right: 1 - (2 * room.right) / width,
    bottom: -1 + (2 * room.bottom) / height, top: 1 - (2 * room.top) / height,
  };
  let distance = camera.position.distanceTo(target);
  const tangent = Math.tan((camera.fov * Math.PI) / 360);
  for (let i = 0; i < 30; ++i) {
    const box = box_of();
    const larger = Math.max((box.right - box.left) / (free.right - free.left), (box.top - box.bottom) / (free.top - free.bottom));
    distance *= 1 + 0.7 * (larger - 1);
    const seen = box_of();
    // Move along the axes of the picture, so that the centres of the box and of the free area coincide.
    const off_x = (seen.left + seen.right - free.left - free.right) / 2;
    const off_y = (seen.bottom + seen.top - free.bottom - free.top) / 2;
    const side = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    const ahead = new THREE.Vector3(-backward.x, -backward.y, 0).normalize();
    target.addScaledVector(side, 0.8 * off_x * tangent * camera.aspect * distance);
    target.addScaledVector(ahead, (0.8 * off_y * tangent * distance) / Math.max(0.3, backward.z));
  }
  box_of();
}
