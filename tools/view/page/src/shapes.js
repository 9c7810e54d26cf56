// What foxglove.SceneUpdate and foxglove.Grid say, as corners and matrices, however it is drawn then.

import * as THREE from "three";

const kStrip = 0;
const kLoop = 1;
const kFade_s = 30;

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

/** Colour and opacity of a cell, by the field that a grid has: [red, green, blue, opacity], each in
    [0, 255]. When it was last seen: fresh is strong, never is nothing. What stands there: free is
    light, occupied dark, unknown nothing. */
const kCellColours = {
  age_s: (age_s) => [30, 150, 160, age_s < 0 ? 0 : Math.round(105 * Math.max(0.08, 1 - age_s / kFade_s))],
  occupancy: (p) =>
    p < 0.5 ? [240, 240, 230, Math.round(200 * (1 - 2 * p))] : [40, 30, 60, Math.round(230 * (2 * p - 1))],
};

/** A grid as colours, rows of cells. */
export function pixels_of(grid) {
  const colour = kCellColours[grid.fields[0].name];
  const bytes = Uint8Array.from(atob(grid.data), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const columns = grid.column_count;
  const rows = Math.floor(bytes.length / grid.row_stride);
  const pixels = new Uint8Array(4 * rows * columns);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const value = view.getFloat32(row * grid.row_stride + column * grid.cell_stride, true);
      pixels.set(colour(value), 4 * (row * columns + column));
    }
  }
  return { pixels, columns, rows };
}
