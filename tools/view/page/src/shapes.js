// What foxglove.SceneUpdate and foxglove.Grid say, as corners and matrices, however it is drawn then.

import * as THREE from "three";
import { channels_of } from "./look.js";

const kStrip = 0;
const kLoop = 1;
const kGlyph_px = 7; // half as wide as a body is at least
const kLeast_px = new Map([["/robots", kGlyph_px], ["/targets", 5]]); // by topic of bodies: robots stand out of a crowd

let memory_s = 30; // after which ground that was seen is stale

/** @param of_scenario the estimators' memory; 0: they do not forget */
export function set_memory(of_scenario) {
  memory_s = of_scenario > 0 ? of_scenario : 30;
}

/** Frame from what has `pose`, and `size` where it has one. */
export function matrix_of({ pose, size }) {
  const { position: p, orientation: q } = pose;
  return new THREE.Matrix4().compose(
    new THREE.Vector3(p.x, p.y, p.z),
    new THREE.Quaternion(q.x, q.y, q.z, q.w),
    size ? new THREE.Vector3(size.x, size.y, size.z) : new THREE.Vector3(1, 1, 1),
  );
}

/** The corners of a shape, in its entity's frame: of its triangles three a piece. */
export function corners_of(shape) {
  const matrix = matrix_of(shape);
  return shape.points.map((c) => new THREE.Vector3(c.x, c.y, c.z).applyMatrix4(matrix));
}

/** The lines of a shape, each a list of corners. */
export function lines_of(shape) {
  const corners = corners_of(shape);
  if (shape.type === kLoop && corners.length > 0) corners.push(corners[0]);
  if (shape.type === kStrip || shape.type === kLoop) return [corners];
  return Array.from({ length: corners.length / 2 }, (_, i) => corners.slice(2 * i, 2 * i + 2));
}

/** How far from its middle [m] the body of an entity is to reach kGlyph_px at any distance, so that it can be seen; 0 of other
    topics. */
export function glyph_of(topic, entity) {
  const least_px = kLeast_px.get(topic);
  if (!least_px) return 0;
  const reach_m = Math.max(...[...entity.cylinders, ...entity.cubes].map(({ size }) => 0.5 * Math.max(size.x, size.y)), 0);
  return (reach_m * kGlyph_px) / least_px;
}

/** How many times larger than it is a body is drawn, in its own plane, so that it can be seen.
    @param pixels_a_m at the body */
export const enlarged = (glyph_m, pixels_a_m) =>
  glyph_m > 0 && pixels_a_m > 0 ? Math.max(1, kGlyph_px / (glyph_m * pixels_a_m)) : 1;

const there = new THREE.Vector3();

/** Pixels a metre where a camera sees a frame's origin. */
export function pixels_a_metre(camera, height_px, frame) {
  const scale = 0.5 * height_px * camera.projectionMatrix.elements[5];
  if (camera.isOrthographicCamera) return scale;
  return scale / -there.setFromMatrixPosition(frame.matrix).applyMatrix4(camera.matrixWorldInverse).z;
}

export const glyph_scale = (camera, height_px, frame, glyph_m) =>
  glyph_m > 0 ? enlarged(glyph_m, pixels_a_metre(camera, height_px, frame)) : 1;

const mix = (from, to, share) => from.map((c, i) => c + (to[i] - c) * share);

/** What a grid's field looks like: a function of its value that gives red, green and blue. When a cell
    was last seen, from seen to stale. What stands there: free, not settled, occupied. */
function colours_of(field) {
  const [seen, stale, unseen, free, occupied] = ["seen", "stale", "unseen", "free", "occupied"].map(channels_of);
  return {
    age_s: (age_s) => (age_s < 0 ? unseen : mix(seen, stale, Math.min(1, age_s / memory_s))),
    occupancy: (p) => (p < 0.5 ? mix(free, unseen, 2 * p) : mix(unseen, occupied, 2 * p - 1)),
  }[field];
}

/** A grid as colours, rows of cells. */
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
