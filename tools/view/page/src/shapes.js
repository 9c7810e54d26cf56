// Corners and matrices of foxglove.SceneUpdate and foxglove.Grid, for both methods of drawing.

import * as THREE from "three";
import { channels_of } from "./appearance.js";

const kStrip = 0;
const kLoop = 1;
const kGlyph_px = 7; // minimum half width of a body
const kLeast_px = new Map([["/robots", kGlyph_px], ["/targets", 5]]); // minimum half width by topic; larger for robots

let memory_s = 30; // s; time after which observed ground is stale

/** Sets the time after which observed ground is stale. @param of_scenario s; the estimators' memory; 0 (unlimited): 30 s are used */
export function set_memory(of_scenario) {
  memory_s = of_scenario > 0 ? of_scenario : 30;
}

/** Returns the transform of a shape into its entity's frame, scaled by its `size` if it has one. */
export function matrix_of({ pose, size }) {
  const { position: p, orientation: q } = pose;
  return new THREE.Matrix4().compose(
    new THREE.Vector3(p.x, p.y, p.z),
    new THREE.Quaternion(q.x, q.y, q.z, q.w),
    size ? new THREE.Vector3(size.x, size.y, size.z) : new THREE.Vector3(1, 1, 1),
  );
}

/** Returns the corners of a shape in its entity's frame; three per triangle. */
export function corners_of(shape) {
  const matrix = matrix_of(shape);
  return shape.points.map((c) => new THREE.Vector3(c.x, c.y, c.z).applyMatrix4(matrix));
}

/** Returns the lines of a shape, each a list of corners. */
export function lines_of(shape) {
  const corners = corners_of(shape);
  if (shape.type === kLoop && corners.length > 0) corners.push(corners[0]);
  if (shape.type === kStrip || shape.type === kLoop) return [corners];
  return Array.from({ length: corners.length / 2 }, (_, i) => corners.slice(2 * i, 2 * i + 2));
}

/** Returns the radius [m] of an entity's body that must cover at least kGlyph_px on the screen, so that it stays visible;
    0 for other topics. */
export function glyph_of(topic, entity) {
  const least_px = kLeast_px.get(topic);
  if (!least_px) return 0;
  const reach_m = Math.max(...[...entity.cylinders, ...entity.cubes].map(({ size }) => 0.5 * Math.max(size.x, size.y)), 0);
  return (reach_m * kGlyph_px) / least_px;
}

/** Returns the factor by which a body is enlarged in its own plane so that it stays visible; ≥ 1.
    @param pixels_a_m pixels per metre at the body */
export const enlarged = (glyph_m, pixels_a_m) =>
  glyph_m > 0 && pixels_a_m > 0 ? Math.max(1, kGlyph_px / (glyph_m * pixels_a_m)) : 1;

const there = new THREE.Vector3();

/** Returns the pixels per metre at a frame's origin, as a camera sees it. */
export function pixels_a_metre(camera, height_px, frame) {
  const scale = 0.5 * height_px * camera.projectionMatrix.elements[5];
  if (camera.isOrthographicCamera) return scale;
  return scale / -there.setFromMatrixPosition(frame.matrix).applyMatrix4(camera.matrixWorldInverse).z;
}

export const glyph_scale = (camera, height_px, frame, glyph_m) =>
  glyph_m > 0 ? enlarged(glyph_m, pixels_a_metre(camera, height_px, frame)) : 1;

const mix = (from, to, share) => from.map((c, i) => c + (to[i] - c) * share);

/** Returns the function from a grid field's value to red, green and blue. Field age_s: from just observed to stale. Field
    occupancy: from free over undecided to occupied. */
function colours_of(field) {
  const [seen, stale, unseen, free, occupied] = ["seen", "stale", "unseen", "free", "occupied"].map(channels_of);
  return {
    age_s: (age_s) => (age_s < 0 ? unseen : mix(seen, stale, Math.min(1, age_s / memory_s))),
    occupancy: (p) => (p < 0.5 ? mix(free, unseen, 2 * p) : mix(unseen, occupied, 2 * p - 1)),
  }[field];
}

/** Converts a grid into colours, in rows of cells. */
export function pixels_of(grid) {
  const colour = colours_of(grid.fields[0].name);
  const bytes = Uint8Array.from(atob(grid.data), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const columns = grid.column_count;
  const rows = Math.floor(bytes.length / grid.row_stride);
  const pixels = new Uint8Array(4 * rows * columns);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const value = view.getFloat32(row * grid.row_stride + column * grid.cell_stride, true);
      pixels.set([...colour(value), 255], 4 * (row * columns + column));
    }
  }
  return { pixels, columns, rows };
}
