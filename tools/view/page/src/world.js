// The world on the screen: one scene with a plan view from above and a perspective view.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { seconds } from "./connection.js";
import { FlatPicture } from "./flat_picture.js";
import { GlPicture } from "./gl_picture.js";
import { Labels } from "./labels.js";
import { Names } from "./names.js";
import { css_of } from "./outline.js";
import { draw_caption, draw_measure, draw_ring, draw_scale, fit_perspective, grid_entity, spacing_of, write_numbers } from "./ruler.js";
import { glyph_of, glyph_scale, pixels_a_metre, set_memory } from "./shapes.js";

const kWorld = "world";
const kGrid = "/grid-lines"; // made by the page, treated as a topic
const kRoom = { left: 44, right: 20, top: 30, bottom: 58 }; // pixels; margins around the world for coordinates and the scale bar
/** Rank by topic. Labels of topics with lower ranks are placed first. */
const kRanks = { "/robots": 0, "/targets": 1, "/estimates": 2 };
const kCrowd = 24; // number of names in a view above which a name is shown only where it has space, or under the pointer
const kSpace_px = 52; // distance to the next name within which names of a crowd are hidden
const kHover_px = 45;

/** True if a GPU draws WebGL. If the processor draws it, as in a virtual machine or a remote desktop, WebGL is slower than
    painting on a 2-D canvas. */
function has_graphics() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const names = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return gl !== null && !/swiftshader|llvmpipe|software|basic render/i.test(name);
}

export class World {
  /** @param on_pick called with the id of a clicked entity, or null
      @param is_flat true: paint on a 2-D canvas; false: draw with WebGL; null: the faster method on this machine */
  constructor(stage, on_pick, is_flat) {
    this.stage = stage;
    this.is_flat = is_flat ?? !has_graphics();
    stage.dataset.drawn = this.is_flat ? "flat" : "gl";
    // A painted picture is on the canvas of the labels; willReadFrequently keeps that canvas in main memory.
    this.names = new Names(document.getElementById("names"), { willReadFrequently: this.is_flat });
    this.picture = this.is_flat ? new FlatPicture() : new GlPicture(document.getElementById("world"));
    this.fixed = { matrix: new THREE.Matrix4(), is_placed: true, is_fixed: true };
    this.frames = new Map(); // {matrix, is_placed, is_fixed} by id
    this.layers = new Map(); // topic → Map(id → {frame, entity} or {frame, grid})
    this.changed = new Set(); // topics to update in the picture
    this.passing = new Set(); // {topic, id, item, until} of items with a lifetime
    this.view = "both";
    this.bounds = { min_m: [-5, -5], max_m: [5, 5], ceiling_m: 3 };
    this.selected = null; // id of the selected entity
    this.followed = null; // id of the followed entity, or "team"
    this.measured = []; // up to two points of the ground [m]
    this.is_measuring = false;
    this.has_grid = true;

    const plan = document.getElementById("plan-area");
    const space = document.getElementById("space-area");
    this.plan = { labels: new Labels(), area: plan, camera: new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 1000) };
    this.space = { labels: new Labels(), area: space, camera: new THREE.PerspectiveCamera(45, 1, 0.05, 2000) };
    for (const eye of [this.plan, this.space]) {
      eye.camera.up.set(0, 0, 1);
      eye.controls = new OrbitControls(eye.camera, eye.area);
      eye.controls.addEventListener("change", () => (eye.is_stale = true));
    }
    this.plan.controls.enableRotate = false;
    this.plan.controls.mouseButtons = { LEFT: THREE.MOUSE.PAN, MIDDLE: THREE.MOUSE.DOLLY, RIGHT: THREE.MOUSE.PAN };
    this.plan.controls.touches = { ONE: THREE.TOUCH.PAN, TWO: THREE.TOUCH.DOLLY_PAN };
    this.space.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.on_view = () => {};
    for (const { controls } of [this.plan, this.space]) {
      controls.addEventListener("start", () => (this.is_fitted = false));
      controls.addEventListener("end", () => this.on_view());
    }
    this.listen_for_clicks(on_pick);
    new ResizeObserver(() => this.on_resize()).observe(stage);
    this.frames_drawn = 0;
    this.fit();
  }

  /** True if a view must be drawn again. */
  is_stale() {
    return this.eyes().some((eye) => eye.is_stale);
  }

  /** Marks both views to be drawn again. */
  set_stale() {
    this.plan.is_stale = this.space.is_stale = true;
  }

  eyes() {
    return { plan: [this.plan], space: [this.space], both: [this.plan, this.space] }[this.view];
  }

  show(view) {
    this.view = view;
    this.stage.dataset.view = view;
    this.on_resize();
  }

  frame(id) {
    if (id === kWorld) return this.fixed;
    if (!this.frames.has(id)) {
      this.frames.set(id, { matrix: new THREE.Matrix4(), is_placed: false, is_fixed: false });
    }
    return this.frames.get(id);
  }

  move(transforms) {
    const [position, rotation, one] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3(1, 1, 1)];
    for (const { child_frame_id, translation, rotation: q } of transforms) {
      const frame = this.frame(child_frame_id);
      frame.matrix.compose(position.copy(translation), rotation.set(q.x, q.y, q.z, q.w), one);
      frame.is_placed = true;
    }
    this.set_stale();
  }

  layer(topic) {
    if (!this.layers.has(topic)) this.layers.set(topic, new Map());
    return this.layers.get(topic);
  }

  remove(topic, id) {
    if (this.layer(topic).delete(id)) this.changed.add(topic);
  }

  put(topic, id, item) {
    this.layer(topic).set(id, item);
    this.changed.add(topic);
  }

  update(topic, scene) {
    for (const deletion of scene.deletions) {
      const ids = deletion.type === 1 ? [...this.layer(topic).keys()] : [deletion.id];
      ids.forEach((id) => this.remove(topic, id));
    }
    for (const entity of scene.entities) {
      const item = { frame: this.frame(entity.frame_id), entity };
      this.put(topic, entity.id, item);
      const lifetime_s = seconds(entity.lifetime); // s; 0: unlimited lifetime
      if (lifetime_s > 0) {
        this.passing.add({ topic, id: entity.id, item, until: seconds(entity.timestamp) + lifetime_s });
      }
    }
    this.set_stale();
  }

  /** Removes items whose lifetime has ended at `now` [s since the epoch]. */
  expire(now) {
    for (const passing of this.passing) {
      if (now < passing.until) continue;
      this.passing.delete(passing);
      const { topic, id, item } = passing;
      if (this.layers.get(topic)?.get(id) !== item) continue; // the item was replaced by a newer one
      this.remove(topic, id);
      this.set_stale();
    }
  }

  update_grid(topic, grid) {
    this.put(topic, "grid", { frame: this.frame(grid.frame_id), grid });
    this.set_stale();
  }

  /** Removes all items of a topic. */
  clear(topic) {
    this.layers.delete(topic);
    this.changed.add(topic);
    this.set_stale();
  }

  /** Removes all items and frames. */
  clear_all() {
    [...this.layers.keys()].forEach((topic) => this.clear(topic));
    this.spacing = null;
    this.frames.clear();
    this.passing.clear();
  }

  /** Sets the bounds of the world. @returns true if they have changed */
  set_bounds(scenario) {
    set_memory(scenario.grid_memory_s);
    const bounds = { ...scenario.bounds, ceiling_m: scenario.ceiling_m };
    if (JSON.stringify(bounds) === JSON.stringify(this.bounds)) return false;
    this.bounds = bounds;
    this.spacing = null;
    this.fit();
    return true;
  }

  /** Moves the cameras so that the complete world is visible and as large as possible. */
  fit() {
    this.followed = null;
    const { min_m, max_m } = this.bounds;
    const [width, height] = [max_m[0] - min_m[0], max_m[1] - min_m[1]];
    const centre = [(min_m[0] + max_m[0]) / 2, (min_m[1] + max_m[1]) / 2];
    const plan = this.plan.area.getBoundingClientRect();
    const free = (box) => [Math.max(50, box.width - kRoom.left - kRoom.right), Math.max(50, box.height - kRoom.top - kRoom.bottom)];
    if (plan.width > 0) {
      const [free_x, free_y] = free(plan);
      const pixels_a_m = Math.min(free_x / width, free_y / height);
      const x = centre[0] + (kRoom.right - kRoom.left) / 2 / pixels_a_m;
      const y = centre[1] + (kRoom.top - kRoom.bottom) / 2 / pixels_a_m;
      this.look_at_plan(x, y, plan.height / 2 / pixels_a_m);
    }
    const space = this.space.area.getBoundingClientRect();
    if (space.width > 0) {
      const { camera, controls } = this.space;
      const far = Math.max(width, height);
      controls.target.set(centre[0], centre[1], 0);
      camera.position.set(centre[0], centre[1] - 1.0 * far, 0.95 * far);
      const corners = [[0, 0], [0, 1], [1, 0], [1, 1]].map(([i, j]) => new THREE.Vector3(i ? max_m[0] : min_m[0], j ? max_m[1] : min_m[1], 0));
      fit_perspective(camera, controls.target, corners, space, { left: 30, right: 24, top: 70, bottom: 46 });
      controls.update();
    }
    this.is_fitted = true;
    this.resize();
    this.on_view?.();
  }

  /** Keeps the complete world visible unless the user has moved a camera. */
  on_resize() {
    if (this.is_fitted) this.fit();
    else this.resize();
  }

  /** Sets the camera of the plan. @param half_height half the height of the visible area [m] */
  look_at_plan(x, y, half_height) {
    this.plan.half_height = half_height;
    this.plan.camera.zoom = 1;
    this.plan.camera.position.set(x, y - 1e-4, 500);
    this.plan.controls.target.set(x, y, 0);
    this.plan.controls.update();
  }

  /** Returns the positions of both cameras as numbers for view_from(). */
  cameras() {
    const { camera, controls } = this.space;
    return [
      this.plan.controls.target.x, this.plan.controls.target.y, this.plan.half_height / this.plan.camera.zoom,
      ...camera.position.toArray(), ...controls.target.toArray(),
    ];
  }

  view_from([x, y, half_height, ...space]) {
    this.is_fitted = false;
    this.look_at_plan(x, y, half_height);
    this.space.camera.position.fromArray(space, 0);
    this.space.controls.target.fromArray(space, 3);
    this.space.controls.update();
    this.set_stale();
  }

  /** Moves the cameras with the followed item. */
  follow_target() {
    const at = this.followed && this.position_of(this.followed);
    if (!at) return;
    for (const { camera, controls } of [this.plan, this.space]) {
      const way = new THREE.Vector3(at.x - controls.target.x, at.y - controls.target.y, 0);
      if (way.length() < 1e-4) continue;
      camera.position.add(way);
      controls.target.add(way);
      controls.update();
    }
  }

  /** Returns the position of an entity, or the mean position of the team for "team"; null if unknown. */
  position_of(id) {
    if (id !== "team") return this.find(id)?.position ?? null;
    const placed = [...(this.layers.get("/robots")?.values() ?? [])].filter(({ frame }) => frame.is_placed);
    if (placed.length === 0) return null;
    const sum = new THREE.Vector3();
    placed.forEach(({ frame }) => sum.add(new THREE.Vector3().setFromMatrixPosition(frame.matrix)));
    return sum.divideScalar(placed.length);
  }

  follow(id) {
    this.followed = id;
    this.set_stale();
  }

  select(id) {
    this.selected = id;
    this.set_stale();
  }

  /** Rebuilds all items after a change of the background. */
  repaint() {
    [...this.layers.keys()].forEach((topic) => this.changed.add(topic));
    this.names.forget();
    this.set_stale();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const stage = this.stage.getBoundingClientRect();
    for (const eye of [this.plan, this.space]) {
      const box = eye.area.getBoundingClientRect();
      const x = Math.round(box.left - stage.left - this.stage.clientLeft);
      const y = Math.round(box.top - stage.top - this.stage.clientTop);
      eye.at = { x, y, width: Math.round(box.width), height: Math.round(box.height) }; // pixels on the stage
    }
    const ratio = this.is_flat ? 1 : Math.min(window.devicePixelRatio, 2);
    this.picture.resize(width, height, ratio);
    this.names.resize(width, height, ratio);
    this.set_stale();
  }

  /** Returns the pixels per metre of the plan. */
  plan_scale() {
    return (this.plan.at.height / 2 / this.plan.half_height) * this.plan.camera.zoom;
  }

  /** Rebuilds the grid lines if the scale of the plan view (or else of the 3-D view) requires another spacing. */
  update_grid_lines() {
    const pixels_a_m = this.view === "space" ? pixels_a_metre(this.space.camera, this.space.at.height, { matrix: new THREE.Matrix4().setPosition(this.space.controls.target) }) : this.plan_scale();
    const spacing = this.has_grid && pixels_a_m > 0 && Number.isFinite(pixels_a_m) ? spacing_of(pixels_a_m) : null;
    if (spacing === this.spacing && (spacing === null || this.layers.has(kGrid))) return;
    this.spacing = spacing;
    if (spacing === null) this.clear(kGrid);
    else this.put(kGrid, "grid", { frame: this.fixed, entity: grid_entity(this.bounds, spacing) });
    this.set_stale();
  }

  draw() {
    this.frames_drawn += 1;
    this.follow_target();
    for (const eye of this.eyes()) this.aim(eye);
    this.update_grid_lines();
    for (const topic of this.changed) {
      this.picture.set(topic, [...(this.layers.get(topic)?.values() ?? [])]);
    }
    this.changed.clear();
    const style = getComputedStyle(document.documentElement);
    this.picture.begin(style.getPropertyValue("--stage").trim());
    this.names.begin(style.getPropertyValue("--halo").trim());
    for (const eye of this.eyes()) {
      if (this.picture.is_kept && !eye.is_stale) continue;
      eye.is_stale = false;
      const { camera, at } = eye;
      if (at.width < 2 || at.height < 2) continue;
      this.names.within(at, (pen) => {
        this.picture.draw(camera, at, pen);
        this.draw_over(eye, pen);
      });
    }
  }

  aim({ camera, at, half_height }) {
    if (camera.isOrthographicCamera) {
      const aspect = at.width / at.height;
      [camera.left, camera.right, camera.top, camera.bottom] = [-half_height * aspect, half_height * aspect, half_height, -half_height];
    } else {
      camera.aspect = at.width / at.height;
    }
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  /** Draws over the world: numbers, scale, labels, selection and measured distance. */
  draw_over(eye, pen) {
    const { camera, at } = eye;
    const is_plan = eye === this.plan;
    const point = new THREE.Vector3();
    const project = (x, y, z) => {
      point.set(x, y, z).project(camera);
      return Math.abs(point.z) > 1 ? null : [at.x + (0.5 + point.x / 2) * at.width, at.y + (0.5 - point.y / 2) * at.height];
    };
    if (this.has_grid) write_numbers(pen, project, at, this.bounds, this.spacing, is_plan);
    draw_caption(pen, at, is_plan ? "plan" : "3-D");
    if (is_plan) draw_scale(pen, at, this.plan_scale());
    this.draw_leaders(pen, project);
    this.write_names(eye, project);
    const selected = this.selected && this.find(this.selected);
    if (selected) {
      const { x, y, z } = selected.position;
      const spot = project(x, y, z);
      if (spot) draw_ring(pen, spot, 14);
    }
    const [from, to] = [this.measured[0], this.measured[1] ?? this.pointed];
    if (this.is_measuring && from && to) draw_measure(pen, project, at, from, to);
  }

  /** Draws a thin line from each target's true position to its estimate. */
  draw_leaders(pen, project) {
    pen.lineWidth = 1;
    for (const [id, { entity }] of this.layers.get("/estimates") ?? []) {
      const truth = this.layers.get("/targets")?.get(id.replace("estimate/", "target/"));
      if (!truth?.frame.is_placed) continue;
      const from = centre_of(truth.entity).applyMatrix4(truth.frame.matrix);
      const to = centre_of(entity);
      const [a, b] = [project(from.x, from.y, from.z), project(to.x, to.y, to.z)];
      if (!a || !b || Math.hypot(b[0] - a[0], b[1] - a[1]) < 4) continue;
      pen.strokeStyle = css_of(entity.lines[0].color);
      pen.beginPath();
      pen.moveTo(...a);
      pen.lineTo(...b);
      pen.stroke();
    }
  }

  /** True if the name of an estimate is left out, because the true target with the same name is shown. */
  is_named_elsewhere(topic, id) {
    if (topic !== "/estimates" && !topic.startsWith("/belief/")) return false;
    return this.layers.get("/targets")?.get(`target/${id.split("/").at(-1)}`)?.frame.is_placed ?? false;
  }

  /** In a crowd, returns the names that have space, that are selected, or that are next to the pointer. */
  readable(wanted, eye) {
    if (wanted.length <= kCrowd) return wanted;
    const near = ({ x, y }, [px, py], limit) => Math.abs(x - px) < limit && Math.abs(y - py) < limit;
    return wanted.filter((label) => {
      if (label.rank < 0 || (eye.pointer && near(label, eye.pointer, kHover_px))) return true;
      return !wanted.some((other) => other !== label && near(label, [other.x, other.y], kSpace_px));
    });
  }

  write_names(eye, project) {
    const { camera, at, labels } = eye;
    const wanted = [];
    const origin = new THREE.Vector3();
    for (const [topic, layer] of this.layers) {
      for (const [id, { frame, entity }] of layer) {
        if (!frame.is_placed || !entity || this.is_named_elsewhere(topic, id)) continue;
        entity.texts.forEach((text, i) => {
          origin.copy(text.pose.position);
          if (entity.frame_id !== kWorld) origin.set(0, 0, 0); // the label is placed next to the body
          origin.applyMatrix4(frame.matrix);
          const spot = project(origin.x, origin.y, origin.z);
          if (!spot) return;
          const glyph_m = glyph_of(topic, entity);
          const radius_px = glyph_m > 0 ? glyph_m * glyph_scale(camera, at.height, frame, glyph_m) * pixels_a_metre(camera, at.height, frame) : 5;
          const rank = (id === this.selected ? -1 : kRanks[topic] ?? 3) + 0.001 * i;
          wanted.push({ key: `${id} ${i}`, x: spot[0], y: spot[1], radius_px, rank, text, ...this.names.size_of(text) });
        });
      }
    }
    eye.names = labels.place(this.readable(wanted, eye), at, (label, left, top) => this.names.write(label.text, left, top));
  }

  listen_for_clicks(on_pick) {
    for (const eye of [this.plan, this.space]) {
      let start = null;
      eye.area.addEventListener("pointerdown", (event) => (start = [event.clientX, event.clientY]));
      eye.area.addEventListener("pointermove", (event) => {
        const box = eye.area.getBoundingClientRect();
        eye.pointer = eye.at && [eye.at.x + event.clientX - box.left, eye.at.y + event.clientY - box.top];
        if (this.entities() > kCrowd) eye.is_stale = true;
        if (!this.is_measuring || this.measured.length !== 1) return;
        this.pointed = this.ground_at(eye, event);
        this.set_stale();
      });
      eye.area.addEventListener("pointerup", (event) => {
        const is_click =
          start && Math.hypot(event.clientX - start[0], event.clientY - start[1]) < 5;
        if (!is_click) return;
        if (this.is_measuring) this.add_measured(this.ground_at(eye, event));
        else on_pick(this.pick(eye, event));
      });
    }
  }

  measure(is_measuring) {
    this.is_measuring = is_measuring;
    this.measured = [];
    this.pointed = null;
    this.stage.dataset.measuring = is_measuring ? "yes" : "";
    this.set_stale();
  }

  add_measured(point) {
    if (!point) return;
    if (this.measured.length === 2) this.measured = [];
    this.measured.push(point);
    this.set_stale();
  }

  /** Returns [x, y] of the item under the pointer, or else of the ground under the pointer; null: the pointer is on the sky. */
  ground_at(eye, event) {
    const id = this.pick(eye, event, 12);
    if (id) {
      const { x, y } = this.find(id).position;
      return [x, y];
    }
    const box = eye.area.getBoundingClientRect();
    const from = new THREE.Vector3((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height, -1);
    const to = from.clone().setZ(1);
    from.unproject(eye.camera);
    to.unproject(eye.camera);
    const share = from.z / (from.z - to.z);
    if (!(share > 0 && share < 1)) return null;
    return [from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)];
  }

  /** Returns the id of the nearest entity with metadata within `within_px` of a click; null if there is none. */
  pick(eye, event, within_px = 28) {
    const box = eye.area.getBoundingClientRect();
    const point = new THREE.Vector3();
    let best = null;
    let best_px = within_px;
    for (const layer of this.layers.values()) {
      for (const { frame, entity } of layer.values()) {
        if (!entity || entity.metadata.length === 0 || !frame.is_placed) continue;
        point.copy(centre_of(entity)).applyMatrix4(frame.matrix).project(eye.camera);
        const left = box.left + (0.5 + point.x / 2) * box.width;
        const top = box.top + (0.5 - point.y / 2) * box.height;
        const distance_px = Math.hypot(event.clientX - left, event.clientY - top);
        if (distance_px < best_px) {
          best_px = distance_px;
          best = entity.id;
        }
      }
    }
    return best;
  }

  /** Returns the newest entity with an id and its current position; null if there is none. */
  find(id) {
    for (const layer of this.layers.values()) {
      if (layer.has(id)) {
        const { frame, entity } = layer.get(id);
        if (!entity) return null;
        const position = centre_of(entity).applyMatrix4(frame.matrix);
        const e = frame.matrix.elements;
        return { entity, position, yaw_rad: frame.is_fixed ? null : Math.atan2(e[1], e[0]), is_placed: frame.is_placed };
      }
    }
    return null;
  }

  /** Returns the position of an entity in the plan, in pixels of the window; null if there is none. */
  pixel(id) {
    const found = this.find(id);
    if (!found) return null;
    const box = this.plan.area.getBoundingClientRect();
    const point = found.position.project(this.plan.camera);
    return [box.left + (0.5 + point.x / 2) * box.width, box.top + (0.5 - point.y / 2) * box.height];
  }

  entities() {
    return [...this.layers].reduce((sum, [topic, layer]) => sum + (topic === kGrid ? 0 : layer.size), 0);
  }

  /** Returns the entities of a topic. */
  shown(topic) {
    return [...(this.layers.get(topic)?.values() ?? [])].map(({ entity }) => entity);
  }

  sizes() {
    return Object.fromEntries([...this.layers].map(([topic, layer]) => [topic, layer.size]));
  }
}

/** Returns the centre of an entity in its frame: the mean of its first line in the world frame, the origin in other frames. */
function centre_of(entity) {
  const points = entity.frame_id === kWorld ? (entity.lines[0]?.points ?? []) : [];
  const centre = new THREE.Vector3();
  if (points.length > 0) {
    points.forEach((p) => centre.add(new THREE.Vector3(p.x, p.y, p.z)));
    centre.divideScalar(points.length);
  }
  return centre;
}
