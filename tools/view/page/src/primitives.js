// foxglove.SceneUpdate and foxglove.Grid as three.js objects.

import * as THREE from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
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

function surface(c, kind = THREE.MeshLambertMaterial) {
  return new kind({
    color: colour_of(c),
    transparent: c.a < 1,
    opacity: c.a,
    depthWrite: c.a >= 1,
    side: THREE.DoubleSide,
  });
}

function solid(geometry, shape) {
  const mesh = place(new THREE.Mesh(geometry, surface(shape.color)), shape.pose);
  mesh.scale.set(shape.size.x, shape.size.y, shape.size.z);
  return mesh;
}

function make_line(shape) {
  const flat = shape.points.flatMap((p) => [p.x, p.y, p.z]);
  if (shape.type === kLoop && flat.length > 0) flat.push(flat[0], flat[1], flat[2]);
  if (flat.length < 6) return null;
  const is_path = shape.type === kStrip || shape.type === kLoop;
  const geometry = is_path ? new LineGeometry() : new LineSegmentsGeometry();
  geometry.setPositions(flat);
  const material = new LineMaterial({
    color: colour_of(shape.color),
    linewidth: shape.thickness,
    worldUnits: !shape.scale_invariant,
    transparent: shape.color.a < 1,
    opacity: shape.color.a,
  });
  return place(is_path ? new Line2(geometry, material) : new LineSegments2(geometry, material), shape.pose);
}

function make_triangles(shape) {
  const geometry = new THREE.BufferGeometry();
  const flat = new Float32Array(shape.points.flatMap((p) => [p.x, p.y, p.z]));
  geometry.setAttribute("position", new THREE.BufferAttribute(flat, 3));
  return place(new THREE.Mesh(geometry, surface(shape.color, THREE.MeshBasicMaterial)), shape.pose);
}

const cube = new THREE.BoxGeometry(1, 1, 1);
const sphere = new THREE.SphereGeometry(0.5, 16, 12);
const cylinder = new THREE.CylinderGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2);
const shared = new Set([cube, sphere, cylinder]);

/** A group with everything of one scene entity; its texts are left to the caller. */
export function make_entity(entity) {
  const group = new THREE.Group();
  const add = (object) => object && group.add(object);
  entity.cubes.forEach((each) => add(solid(cube, each)));
  entity.spheres.forEach((each) => add(solid(sphere, each)));
  entity.cylinders.forEach((each) => add(solid(cylinder, each)));
  entity.triangles.forEach((each) => add(make_triangles(each)));
  entity.lines.forEach((each) => add(make_line(each)));
  group.userData.entity = entity;
  return group;
}

export function dispose(group) {
  group.removeFromParent();
  group.traverse((object) => {
    if (object.geometry && !shared.has(object.geometry)) object.geometry.dispose();
    object.material?.map?.dispose();
    object.material?.dispose();
  });
}

const kFade_s = 30;

/** When each cell was last seen, as a coloured floor: fresh is strong, never is nothing. */
export function make_grid(grid) {
  const bytes = Uint8Array.from(atob(grid.data), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const rows = Math.floor(bytes.length / grid.row_stride);
  const pixels = new Uint8Array(4 * rows * grid.column_count);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < grid.column_count; ++column) {
      const age_s = view.getFloat32(row * grid.row_stride + column * grid.cell_stride, true);
      const freshness = age_s < 0 ? 0 : Math.max(0.08, 1 - age_s / kFade_s);
      pixels.set([30, 150, 160, Math.round(105 * freshness)], 4 * (row * grid.column_count + column));
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
