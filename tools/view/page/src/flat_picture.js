// The world painted on a 2-D canvas, far items first. This method is many times faster than WebGL
// that the processor draws, and works in browsers without WebGL.
//
// Items are sorted by height; those farthest from the camera's height are painted first. This order is exact for horizontal
// items (fields of view, ellipses, plans, discs). Items behind an obstacle are painted before the obstacle. A line that is
// partly hidden by an obstacle is painted completely before or after the obstacle, depending on the line's middle.

import * as THREE from "three";
import { Line, Surface, edges_of } from "./outline.js";
import { corners_of, enlarged, glyph_of, lines_of, matrix_of, pixels_of } from "./shapes.js";
import { Ball, Block, Disc } from "./solids.js";

const kLevel_m = 0.02; // m; heights closer than this count as equal
const kLow_m = 0.1; // m; lower boxes are not treated as obstacles
const kCrowd = 250; // number of items above which thin lines are simplified
const kFar_m = 1e5; // m; assumed distance of the camera of a parallel projection

const origin = new THREE.Vector3();
const large = new THREE.Matrix4();

/** Projection of a camera into an area of the stage. */
class View {
  constructor(camera, at) {
    this.at = at;
    const [half_width, half_height] = [at.width / 2, at.height / 2];
    /** Matrix from metres in the world to homogeneous pixels of the stage (multiplied by the distance). */
    this.stage_from_world = new THREE.Matrix4()
      .set(half_width, 0, 0, at.x + half_width, 0, -half_height, 0, at.y + half_height, 0, 0, 1, 0, 0, 0, 0, 1)
      .multiply(camera.projectionMatrix)
      .multiply(camera.matrixWorldInverse);
    const backward = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 2);
    this.eye = new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld);
    if (camera.isOrthographicCamera) this.eye.addScaledVector(backward, kFar_m);
    this.scale = half_height * camera.projectionMatrix.elements[5];
    this.frames = new Map();
  }

  /** Returns the elements of the matrix from metres in a frame to pixels. */
  through(frame) {
    if (!this.frames.has(frame)) {
      this.frames.set(frame, new THREE.Matrix4().multiplyMatrices(this.stage_from_world, frame.matrix).elements);
    }
    return this.frames.get(frame);
  }

  /** Returns the elements for a body that is enlarged so that it stays visible. @param glyph_m radius of the body */
  through_glyph(frame, glyph_m) {
    const scale = enlarged(glyph_m, this.pixels_at(origin.setFromMatrixPosition(frame.matrix)));
    if (scale === 1) return this.through(frame);
    return large.makeScale(scale, scale, 1).premultiply(frame.matrix).premultiply(this.stage_from_world).elements;
  }

  distance_to(point) {
    const e = this.stage_from_world.elements;
    return e[3] * point.x + e[7] * point.y + e[11] * point.z + e[15];
  }

  /** Returns the pixels per metre at a point; negative behind the camera. */
  pixels_at(point) {
    return this.scale / this.distance_to(point);
  }
}

/** Grid, drawn as a coloured floor. Its image is kept until the grid or the view changes. */
class Floor {
  constructor(frame, grid) {
    this.frame = frame;
    const { pixels, columns, rows } = pixels_of(grid);
    this.colours = new Uint32Array(pixels.buffer);
    this.columns = columns;
    this.rows = rows;
    this.matrix = matrix_of(grid).scale(new THREE.Vector3(grid.cell_size.x, grid.cell_size.y, 1));
    this.painted = new Map(); // {key, canvas} by camera
  }

  paint(pen, view, camera) {
    const e = new THREE.Matrix4().fromArray(view.through(this.frame)).multiply(this.matrix).elements;
    const key = [...e, view.at.width, view.at.height].join();
    if (this.painted.get(camera)?.key !== key) {
      this.painted.set(camera, { key, canvas: this.make(e, view.at) });
    }
    pen.drawImage(this.painted.get(camera).canvas, view.at.x, view.at.y);
  }

  /** Makes an image in which each pixel has the colour of its cell. */
  make(e, at) {
    const stage_from_cells = new THREE.Matrix3().set(e[0], e[4], e[12], e[1], e[5], e[13], e[3], e[7], e[15]);
    const m = stage_from_cells.invert().elements;
    const canvas = document.createElement("canvas");
    canvas.width = at.width;
    canvas.height = at.height;
    const pen = canvas.getContext("2d", { willReadFrequently: true });
    const image = pen.createImageData(at.width, at.height);
    const out = new Uint32Array(image.data.buffer);
    for (let row = 0, i = 0; row < at.height; ++row) {
      const y = at.y + row + 0.5;
      let column_part = m[0] * (at.x + 0.5) + m[3] * y + m[6];
      let row_part = m[1] * (at.x + 0.5) + m[4] * y + m[7];
      let nearness = m[2] * (at.x + 0.5) + m[5] * y + m[8];
      for (let column = 0; column < at.width; ++column, ++i) {
        const c = Math.floor(column_part / nearness);
        const r = Math.floor(row_part / nearness);
        if (nearness > 0 && c >= 0 && c < this.columns && r >= 0 && r < this.rows) {
          out[i] = this.colours[r * this.columns + c];
        }
        column_part += m[0];
        row_part += m[1];
        nearness += m[2];
      }
    }
    pen.putImageData(image, 0, 0);
    return canvas;
  }
}

function drawables_of(topic, { frame, entity, grid }) {
  if (grid) return [new Floor(frame, grid)];
  const line = (shape) => new Line(frame, lines_of(shape), shape);
  const surface = (shape) => new Surface(frame, edges_of(corners_of(shape)), shape);
  const bodies = [
    ...entity.triangles.filter((shape) => shape.points.length >= 3).map(surface),
    ...entity.cubes.map((shape) => new Block(frame, shape)),
    ...entity.cylinders.map((shape) => new Disc(frame, shape)),
    ...entity.spheres.map((shape) => new Ball(frame, shape)),
  ];
  const glyph_m = glyph_of(topic, entity);
  bodies.forEach((body) => (body.glyph_m = glyph_m));
  return [...bodies, ...entity.lines.filter((shape) => shape.points.length >= 2).map(line)];
}

const from_far = (a, b) => a.level - b.level || a.rank - b.rank || b.distance - a.distance;

export class FlatPicture {
  constructor() {
    this.is_kept = true; // areas that are not drawn keep their last picture
    this.drawables = new Map(); // painted items by topic
  }

  resize() {}

  /** Replaces all items of a topic. */
  set(topic, items) {
    this.drawables.set(topic, items.flatMap((item) => drawables_of(topic, item)));
  }

  begin() {}

  draw(camera, at, pen) {
    const view = new View(camera, at);
    const floors = [];
    const blocks = [];
    const others = [];
    for (const drawables of this.drawables.values()) {
      for (const drawable of drawables) {
        if (!drawable.frame.is_placed) continue;
        if (drawable instanceof Floor) {
          floors.push(drawable);
          continue;
        }
        drawable.at = (drawable.at ?? new THREE.Vector3()).copy(drawable.centre).applyMatrix4(drawable.frame.matrix);
        drawable.distance = view.distance_to(drawable.at);
        drawable.level = -Math.round(Math.abs(drawable.at.z - view.eye.z) / kLevel_m);
        (drawable instanceof Block && drawable.height_m > kLow_m ? blocks : others).push(drawable);
      }
    }
    view.is_crowded = others.length > kCrowd;
    floors.forEach((floor) => floor.paint(pen, view, camera));
    blocks.sort((a, b) => view.eye.distanceToSquared(b.at) - view.eye.distanceToSquared(a.at));
    blocks.forEach((block) => block.look(view));
    const turns = [...blocks.map((block) => ({ block, before: [] })), { before: [] }];
    for (const drawable of others) {
      turns.find(({ block }) => !block || block.is_before(drawable.at)).before.push(drawable);
    }
    const paint = (drawable) =>
      drawable.paint(pen, drawable.glyph_m ? view.through_glyph(drawable.frame, drawable.glyph_m) : view.through(drawable.frame), view);
    for (const { block, before } of turns) {
      before.sort(from_far).forEach(paint);
      if (block) paint(block);
    }
  }
}
