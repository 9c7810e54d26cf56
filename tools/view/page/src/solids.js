// Bodies on a 2-D canvas: the faces that are turned to the camera, lit as in gl_picture.js.

import * as THREE from "three";
import { css_of, trace } from "./outline.js";
import { matrix_of } from "./shapes.js";

const kSun = new THREE.Vector3(3, -5, 10).normalize();
const kGamma = 2.2;

/** Returns the brightness of a face with a normal. */
function shade_of(normal) {
  const sky = 0.5 * (1 + normal.z) + 0.25 * 0.5 * (1 - normal.z); // the ground reflects a quarter of the light
  return Math.pow((2.2 * sky + 1.2 * Math.max(0, normal.dot(kSun))) / Math.PI, 1 / kGamma);
}

const kSides = [0, 1, 2].flatMap((axis) =>
  [-0.5, 0.5].map((end) => {
    const around = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    const corners = around.flatMap(([a, b]) => [[end, a, b], [a, end, b], [a, b, end]][axis]);
    return { axis, end, corners: Float64Array.from(corners) };
  }),
);

/** Box: a unit cube scaled by its matrix. */
export class Block {
  constructor(frame, shape) {
    this.frame = frame;
    this.rank = 0;
    this.matrix = matrix_of(shape);
    this.centre = new THREE.Vector3().setFromMatrixPosition(this.matrix);
    this.height_m = shape.size.z;
    this.color = shape.color;
    this.eye = new THREE.Vector3();
    this.inverse = new THREE.Matrix4();
  }

  /** Stores the camera's position in the box's frame. */
  look(view) {
    this.inverse.multiplyMatrices(this.frame.matrix, this.matrix).invert();
    this.eye.copy(view.eye).applyMatrix4(this.inverse);
  }

  faces({ axis, end }) {
    return this.eye.getComponent(axis) * Math.sign(end) > 0.5;
  }

  /** True if a point is behind each face that is turned to the camera, so that it cannot hide the box. */
  is_before(point) {
    const at = scratch.copy(point).applyMatrix4(this.inverse);
    return kSides.every((side) => !this.faces(side) || at.getComponent(side.axis) * Math.sign(side.end) < 0.5);
  }

  paint(pen, e, view) {
    this.look(view);
    const through = through_scratch.fromArray(e).multiply(this.matrix).elements;
    const normal = new THREE.Vector3();
    for (const side of kSides) {
      if (!this.faces(side)) continue;
      normal.setFromMatrixColumn(this.matrix, side.axis).multiplyScalar(Math.sign(side.end));
      pen.beginPath();
      trace(pen, through, side.corners, true);
      pen.fillStyle = css_of(this.color, shade_of(normal.transformDirection(this.frame.matrix)));
      pen.fill();
    }
  }
}

const scratch = new THREE.Vector3();
const through_scratch = new THREE.Matrix4();

function ring(count) {
  return Array.from({ length: count }, (_, i) => (2 * Math.PI * i) / count).map((angle) => [
    0.5 * Math.cos(angle),
    0.5 * Math.sin(angle),
  ]);
}
const kRings = [8, 12, 24].map(ring);
const kUpright = new THREE.Vector3(0, 0, 1);
const kAside = new THREE.Vector3(0, -1, 0);

/** Cylinder: the end and the part of the lateral surface that face the camera. */
export class Disc {
  constructor(frame, shape) {
    this.frame = frame;
    this.rank = 2;
    this.matrix = matrix_of(shape);
    this.centre = new THREE.Vector3().setFromMatrixPosition(this.matrix);
    this.radius_m = 0.5 * Math.max(shape.size.x, shape.size.y);
    this.end_style = css_of(shape.color, shade_of(kUpright));
    this.mantle_style = css_of(shape.color, shade_of(kAside));
  }

  paint(pen, e, view) {
    const radius_px = this.radius_m * view.pixels_at(this.at);
    if (!(radius_px > 0)) return; // the cylinder is behind the camera
    const corners = kRings[radius_px < 4 ? 0 : radius_px < 12 ? 1 : 2];
    const m = through_scratch.fromArray(e).multiply(this.matrix).elements;
    const ends = [-0.5, 0.5].map((z) =>
      corners.map(([x, y]) => {
        const w = m[3] * x + m[7] * y + m[11] * z + m[15];
        return [(m[0] * x + m[4] * y + m[8] * z + m[12]) / w, (m[1] * x + m[5] * y + m[9] * z + m[13]) / w];
      }),
    );
    const [below, above] = ends;
    pen.fillStyle = this.mantle_style;
    pen.beginPath();
    corners.forEach((_, i) => {
      const next = (i + 1) % corners.length;
      polygon_if_facing(pen, [below[i], below[next], above[next], above[i]]);
    });
    pen.fill();
    pen.fillStyle = this.end_style;
    pen.beginPath();
    polygon_if_facing(pen, above);
    polygon_if_facing(pen, [...below].reverse());
    pen.fill();
  }
}

/** Adds a polygon if its corners are counter-clockwise on the screen (y down), i.e. if it faces the camera. */
function polygon_if_facing(pen, corners) {
  let twice_area = 0;
  let [x0, y0] = corners.at(-1);
  for (const [x, y] of corners) {
    twice_area += x0 * y - x * y0;
    [x0, y0] = [x, y];
  }
  if (twice_area >= 0) return;
  corners.forEach(([x, y], i) => (i === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
  pen.closePath();
}

const kDotMin_px = 1;

/** Sphere. */
export class Ball {
  constructor(frame, shape) {
    this.frame = frame;
    this.rank = 2;
    this.centre = new THREE.Vector3().setFromMatrixPosition(matrix_of(shape));
    this.radius_m = 0.5 * Math.max(shape.size.x, shape.size.y, shape.size.z);
    this.style = css_of(shape.color);
  }

  paint(pen, e, view) {
    const radius_px = this.radius_m * view.pixels_at(this.at);
    if (!(radius_px > 0)) return;
    const { x, y, z } = this.centre;
    const w = e[3] * x + e[7] * y + e[11] * z + e[15];
    pen.beginPath();
    pen.arc(
      (e[0] * x + e[4] * y + e[8] * z + e[12]) / w,
      (e[1] * x + e[5] * y + e[9] * z + e[13]) / w,
      Math.max(kDotMin_px, radius_px), 0, 2 * Math.PI,
    );
    pen.fillStyle = this.style;
    pen.fill();
  }
}
