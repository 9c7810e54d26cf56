// foxglove.SceneUpdate and foxglove.Grid as three.js objects.

import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

const kStrip = 0;
const kLoop = 1;

const colour_of = (c) => new THREE.Color().setRGB(c.r, c.g, c.b, THREE.SRGBColorSpace);

function place(object, pose) {
  object.position.set(pose.position.x, pose.position.y, pose.position.z);
  const q = pose.orientation;
  object.quaternion.set(q.x, q.y, q.z, q.w);
  return object;
}

/** Frame from what has `pose`, and `size` where it has one. */
function matrix_of({ pose, size }) {
  const { position: p, orientation: q } = pose;
  return new THREE.Matrix4().compose(
    new THREE.Vector3(p.x, p.y, p.z),
    new THREE.Quaternion(q.x, q.y, q.z, q.w),
    size ? new THREE.Vector3(size.x, size.y, size.z) : new THREE.Vector3(1, 1, 1),
  );
}

const materials = new Map(); // by class, then by its options

/** A material, the same for the same words: a new one costs the graphics more than its object. */
function material_of(kind, options) {
  if (!materials.has(kind)) materials.set(kind, new Map());
  const known = materials.get(kind);
  const key = JSON.stringify(options);
  if (!known.has(key)) {
    known.set(key, new kind(options));
    known.get(key).userData.is_kept = true;
  }
  return known.get(key);
}

function surface(alpha, kind, options) {
  return material_of(kind, { transparent: alpha < 1, opacity: alpha, depthWrite: alpha >= 1, ...options });
}

/** The corners of a shape's lines, two a piece, or of its triangles, three a piece. */
function corners_of(shape, is_line) {
  const matrix = matrix_of(shape);
  const corners = shape.points.map((c) => new THREE.Vector3(c.x, c.y, c.z).applyMatrix4(matrix));
  if (!is_line || (shape.type !== kStrip && shape.type !== kLoop)) return corners;
  if (shape.type === kLoop && corners.length > 0) corners.push(corners[0]);
  return corners.slice(1).flatMap((corner, i) => [corners[i], corner]);
}

function flat_geometry(positions, colours) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  return { geometry, buffer: geometry.attributes.position };
}

function make_triangles({ color }, positions, colours) {
  const { geometry, buffer } = flat_geometry(positions, colours);
  const options = { vertexColors: true, side: THREE.DoubleSide };
  return { object: new THREE.Mesh(geometry, surface(color.a, THREE.MeshBasicMaterial, options)), buffer };
}

function make_thin_lines({ color }, positions, colours) {
  const { geometry, buffer } = flat_geometry(positions, colours);
  const material = surface(color.a, THREE.LineBasicMaterial, { vertexColors: true });
  return { object: new THREE.LineSegments(geometry, material), buffer };
}

function make_lines({ color, thickness, scale_invariant }, positions, colours) {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(positions);
  geometry.setColors(colours);
  const options = { vertexColors: true, linewidth: thickness, worldUnits: !scale_invariant };
  const material = surface(color.a, LineMaterial, options);
  return { object: new LineSegments2(geometry, material), buffer: geometry.attributes.instanceStart.data };
}

/** Corners of one kind in one object, which follow the frames that they are of. */
class Corners {
  constructor(shape, make) {
    this.shape = shape;
    this.make = make;
    this.pieces = []; // {frame, corners}
    this.colours = [];
  }

  add(frame, corners, color) {
    const { r, g, b } = colour_of(color);
    this.pieces.push({ frame, corners });
    corners.forEach(() => this.colours.push(r, g, b));
  }

  finish(scene) {
    const flat = this.pieces.flatMap(({ corners }) => corners.flatMap((c) => [c.x, c.y, c.z]));
    const { object, buffer } = this.make(this.shape, flat, this.colours);
    this.object = object;
    this.buffer = buffer;
    this.moves = this.pieces.some(({ frame }) => frame !== scene);
  }

  follow() {
    if (!this.moves) return;
    const at = new THREE.Vector3();
    let next = 0;
    for (const { frame, corners } of this.pieces) {
      for (const corner of corners) {
        // Of a frame that nobody has placed yet all corners fall together: nothing is seen.
        if (frame.visible) at.copy(corner).applyMatrix4(frame.matrixWorld);
        at.toArray(this.buffer.array, next);
        next += 3;
      }
    }
    this.buffer.needsUpdate = true;
  }
}

/** Bodies of one kind in one object. */
class Bodies {
  constructor(geometry, alpha) {
    this.geometry = geometry;
    this.alpha = alpha;
    this.pieces = []; // {frame, matrix, colour}
  }

  add(frame, shape) {
    this.pieces.push({ frame, matrix: matrix_of(shape), colour: colour_of(shape.color) });
  }

  finish() {
    const material = surface(this.alpha, THREE.MeshLambertMaterial, {});
    this.object = new THREE.InstancedMesh(this.geometry, material, this.pieces.length);
    this.pieces.forEach(({ colour }, i) => this.object.setColorAt(i, colour));
  }

  follow() {
    const world = new THREE.Matrix4();
    this.pieces.forEach(({ frame, matrix }, i) => {
      world.multiplyMatrices(frame.matrixWorld, matrix);
      if (!frame.visible) world.makeScale(0, 0, 0);
      this.object.setMatrixAt(i, world);
    });
    this.object.instanceMatrix.needsUpdate = true;
  }
}

const bodies_of = (fineness) => ({
  cube: new THREE.BoxGeometry(1, 1, 1),
  sphere: new THREE.SphereGeometry(0.5, 4 * fineness, 3 * fineness),
  cylinder: new THREE.CylinderGeometry(0.5, 0.5, 1, 6 * fineness).rotateX(Math.PI / 2),
});
const kFine = bodies_of(4);
const kPlain = bodies_of(2);
const shared = new Set([...Object.values(kFine), ...Object.values(kPlain)]);

/** All bodies, lines and triangles of many entities, an object for each kind: what a crowd costs is
    the number of objects. Its texts are left to the caller. */
export class Batches {
  /** @param frame_of the object of a frame's id
      @param is_plain few corners, and lines a pixel wide whatever they ask for */
  constructor(scene, entities, frame_of, is_plain) {
    const { cube, sphere, cylinder } = is_plain ? kPlain : kFine;
    const batches = new Map();
    const batch = (key, make) => {
      if (!batches.has(key)) batches.set(key, make());
      return batches.get(key);
    };
    for (const entity of entities) {
      const frame = frame_of(entity.frame_id);
      const add_bodies = (shapes, geometry) =>
        shapes.forEach((shape) =>
          batch(`${geometry.uuid} ${shape.color.a}`, () => new Bodies(geometry, shape.color.a)).add(frame, shape));
      const add_corners = (shapes, name, make, is_line) =>
        shapes.forEach((shape) =>
          batch(`${name} ${shape.thickness} ${shape.scale_invariant} ${shape.color.a}`, () => new Corners(shape, make))
            .add(frame, corners_of(shape, is_line), shape.color));
      add_bodies(entity.cubes, cube);
      add_bodies(entity.spheres, sphere);
      add_bodies(entity.cylinders, cylinder);
      add_corners(entity.triangles, "triangles", make_triangles, false);
      add_corners(entity.lines, "lines", is_plain ? make_thin_lines : make_lines, true);
    }
    this.batches = [...batches.values()];
    for (const each of this.batches) {
      each.finish(scene);
      each.object.frustumCulled = false; // it is everywhere
      scene.add(each.object);
    }
  }

  /** Puts everything where its frame is now. */
  follow() {
    this.batches.forEach((each) => each.follow());
  }

  dispose() {
    this.batches.forEach((each) => dispose(each.object));
  }
}

/** Whether the graphics are drawn by a processor: a virtual machine, a remote desktop. */
export function is_software_drawn() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const names = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** What stands for an entity in its frame: where it is, and what it says. */
export function make_anchor(entity) {
  const anchor = new THREE.Group();
  anchor.userData.entity = entity;
  return anchor;
}

export function dispose(group) {
  group.removeFromParent();
  group.traverse((object) => {
    object.dispose?.(); // an instanced mesh's own buffers
    if (object.geometry && !shared.has(object.geometry)) object.geometry.dispose();
    if (object.material?.userData.is_kept) return;
    object.material?.map?.dispose();
    object.material?.dispose();
  });
}

const kFade_s = 30;

/** Colour and opacity of a cell, by the field that a grid has. */
const kCellColours = {
  age_s: (age_s) => [30, 150, 160, age_s < 0 ? 0 : Math.round(105 * Math.max(0.08, 1 - age_s / kFade_s))],
  occupancy: (p) => (p < 0.5 ? [240, 240, 230, Math.round(200 * (1 - 2 * p))] : [40, 30, 60, Math.round(230 * (2 * p - 1))]),
};

/** A grid as a coloured floor: when each cell was last seen (fresh is strong, never is nothing), or
 * what stands there (free is light, occupied dark, unknown nothing). */
export function make_grid(grid) {
  const colour = kCellColours[grid.fields[0].name];
  const bytes = Uint8Array.from(atob(grid.data), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const rows = Math.floor(bytes.length / grid.row_stride);
  const pixels = new Uint8Array(4 * rows * grid.column_count);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < grid.column_count; ++column) {
      const value = view.getFloat32(row * grid.row_stride + column * grid.cell_stride, true);
      pixels.set(colour(value), 4 * (row * grid.column_count + column));
    }
  }
  const texture = new THREE.DataTexture(pixels, grid.column_count, rows);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.magFilter = THREE.NearestFilter;
  texture.needsUpdate = true;
  const width = grid.column_count * grid.cell_size.x;
  const height = rows * grid.cell_size.y;
  const material = new THREE.MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false });
  const floor = new THREE.Mesh(new THREE.PlaneGeometry(width, height), material);
  floor.position.set(width / 2, height / 2, 0);
  const group = place(new THREE.Group(), grid.pose);
  group.add(floor);
  return group;
}
