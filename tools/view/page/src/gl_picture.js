// The world drawn by three.js with WebGL.

import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { shown } from "./appearance.js";
import { corners_of, glyph_of, glyph_scale, lines_of, matrix_of, pixels_of } from "./shapes.js";

function colour_of(color) {
  const { r, g, b } = shown(color);
  return new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace);
}

const materials = new Map(); // materials by class, then by options

/** Returns a material, shared for equal options, because a new material costs WebGL more time than an object. */
function material_of(kind, options) {
  if (!materials.has(kind)) materials.set(kind, new Map());
  const known = materials.get(kind);
  const key = JSON.stringify(options);
  if (!known.has(key)) known.set(key, new kind(options));
  return known.get(key);
}

function surface(alpha, kind, options) {
  return material_of(kind, { transparent: alpha < 1, opacity: alpha, depthWrite: alpha >= 1, ...options });
}

function make_triangles({ color }, positions, colours) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  const options = { vertexColors: true, side: THREE.DoubleSide };
  const object = new THREE.Mesh(geometry, surface(color.a, THREE.MeshBasicMaterial, options));
  return { object, buffer: geometry.attributes.position };
}

function make_lines({ color, thickness, scale_invariant }, positions, colours) {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(positions);
  geometry.setColors(colours);
  const options = { vertexColors: true, linewidth: thickness, worldUnits: !scale_invariant };
  const material = surface(color.a, LineMaterial, options);
  return { object: new LineSegments2(geometry, material), buffer: geometry.attributes.instanceStart.data };
}

/** All triangles or lines of one kind in one object. Their corners move with their frames. */
class Corners {
  constructor(shape, make) {
    this.shape = shape;
    this.make = make;
    this.pieces = []; // {frame, corners}
    this.colours = [];
  }

  add(frame, corners, color, glyph_m) {
    const { r, g, b } = colour_of(color);
    this.pieces.push({ frame, corners, glyph_m });
    corners.forEach(() => this.colours.push(r, g, b));
  }

  finish() {
    const flat = this.pieces.flatMap(({ corners }) => corners.flatMap((c) => [c.x, c.y, c.z]));
    const { object, buffer } = this.make(this.shape, flat, this.colours);
    this.object = object;
    this.buffer = buffer;
    this.moves = this.pieces.some(({ frame }) => !frame.is_fixed);
  }

  follow(camera, height_px) {
    if (!this.moves) return;
    const at = new THREE.Vector3();
    let next = 0;
    for (const { frame, corners, glyph_m } of this.pieces) {
      const scale = glyph_scale(camera, height_px, frame, glyph_m);
      for (const corner of corners) {
        // In a frame without a position all corners get the same point, so that the shape is invisible.
        if (frame.is_placed) at.set(scale * corner.x, scale * corner.y, corner.z).applyMatrix4(frame.matrix);
        at.toArray(this.buffer.array, next);
        next += 3;
      }
    }
    this.buffer.needsUpdate = true;
  }

  dispose() {
    this.object.removeFromParent();
    this.object.geometry.dispose();
  }
}

/** All bodies of one kind in one object. */
class Bodies {
  constructor(geometry, alpha) {
    this.geometry = geometry;
    this.alpha = alpha;
    this.pieces = []; // {frame, matrix, colour}
  }

  add(frame, shape, glyph_m) {
    this.pieces.push({ frame, matrix: matrix_of(shape), colour: colour_of(shape.color), glyph_m });
  }

  finish() {
    const material = surface(this.alpha, THREE.MeshLambertMaterial, {});
    this.object = new THREE.InstancedMesh(this.geometry, material, this.pieces.length);
    this.pieces.forEach(({ colour }, i) => this.object.setColorAt(i, colour));
  }

  follow(camera, height_px) {
    const world = new THREE.Matrix4();
    this.pieces.forEach(({ frame, matrix, glyph_m }, i) => {
      const scale = glyph_scale(camera, height_px, frame, glyph_m);
      world.makeScale(scale, scale, 1).multiply(matrix).premultiply(frame.matrix);
      if (!frame.is_placed) world.makeScale(0, 0, 0);
      this.object.setMatrixAt(i, world);
    });
    this.object.instanceMatrix.needsUpdate = true;
  }

  dispose() {
    this.object.removeFromParent();
    this.object.dispose(); // frees only the object's buffers, because the geometry is shared
  }
}

/** Grid, drawn as a coloured floor. */
class Floor {
  constructor(frame, grid) {
    this.frame = frame;
    const { pixels, columns, rows } = pixels_of(grid);
    this.texture = new THREE.DataTexture(pixels, columns, rows);
    this.texture.colorSpace = THREE.SRGBColorSpace;
    this.texture.magFilter = THREE.NearestFilter;
    this.texture.needsUpdate = true;
    const [width, height] = [columns * grid.cell_size.x, rows * grid.cell_size.y];
    const material = new THREE.MeshBasicMaterial({ map: this.texture, transparent: true, depthWrite: false });
    const geometry = new THREE.PlaneGeometry(width, height).translate(width / 2, height / 2, 0);
    this.matrix = matrix_of(grid).premultiply(new THREE.Matrix4().makeTranslation(0, 0, -0.01)); // moves the grid 1 cm below items at z = 0
    this.object = new THREE.Mesh(geometry, material);
    this.object.renderOrder = -1;
    this.object.matrixAutoUpdate = false;
  }

  follow() {
    this.object.visible = this.frame.is_placed;
    this.object.matrix.multiplyMatrices(this.frame.matrix, this.matrix);
  }

  dispose() {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    this.object.material.dispose();
    this.texture.dispose();
  }
}

const cube = new THREE.BoxGeometry(1, 1, 1);
const sphere = new THREE.SphereGeometry(0.5, 16, 12);
const cylinder = new THREE.CylinderGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2);

/** Makes one object per kind of shape from many items, because the cost of drawing grows with the number of objects. */
function batches_of(topic, items) {
  const batches = new Map();
  const batch = (key, make) => {
    if (!batches.has(key)) batches.set(key, make());
    return batches.get(key);
  };
  for (const { frame, entity, grid } of items) {
    if (grid) batch("floor", () => new Floor(frame, grid));
    if (!entity) continue;
    const glyph_m = glyph_of(topic, entity);
    const add_bodies = (shapes, geometry) =>
      shapes.forEach((shape) =>
        batch(`${geometry.uuid} ${shape.color.a}`, () => new Bodies(geometry, shape.color.a)).add(frame, shape, glyph_m));
    const add_corners = (shapes, name, make, corners) =>
      shapes.forEach((shape) =>
        batch(`${name} ${shape.thickness} ${shape.scale_invariant} ${shape.color.a}`, () => new Corners(shape, make))
          .add(frame, corners(shape), shape.color, name === "triangles" ? glyph_m : 0));
    add_bodies(entity.cubes, cube);
    add_bodies(entity.spheres, sphere);
    add_bodies(entity.cylinders, cylinder);
    add_corners(entity.triangles, "triangles", make_triangles, corners_of);
    add_corners(entity.lines, "lines", make_lines, segments_of);
  }
  batches.forEach((each) => each.finish?.());
  return [...batches.values()];
}

/** Returns the corners of the segments of a shape's lines; two per segment. */
const segments_of = (shape) =>
  lines_of(shape).flatMap((line) => line.slice(1).flatMap((corner, i) => [line[i], corner]));

export class GlPicture {
  constructor(canvas) {
    this.is_kept = false; // each picture must draw all areas
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV; // off in production, because the check waits for the GPU
    this.renderer.setScissorTest(true);
    this.scene = new THREE.Scene();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.2);
    sun.position.set(3, -5, 10);
    this.scene.add(sun);
    this.batches = new Map(); // batches by topic
  }

  resize(width, height, ratio) {
    this.height = height;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  /** Replaces all items of a topic. */
  set(topic, items) {
    this.batches.get(topic)?.forEach((each) => each.dispose());
    this.batches.set(topic, batches_of(topic, items));
    for (const { object } of this.batches.get(topic)) {
      object.frustumCulled = false; // the object spans the whole world
      this.scene.add(object);
    }
  }

  begin(background) {
    this.renderer.setClearColor(background);
  }

  /** Draws all objects at the current positions of their frames, enlarged so that they stay visible to this camera. */
  draw(camera, at) {
    this.batches.forEach((batches) => batches.forEach((each) => each.follow(camera, at.height)));
    const bottom = this.height - at.y - at.height;
    this.renderer.setViewport(at.x, bottom, at.width, at.height);
    this.renderer.setScissor(at.x, bottom, at.width, at.height);
    this.renderer.render(this.scene, camera);
  }
}
