// The world on the screen: one scene, seen from above and in perspective.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { seconds } from "./connection.js";
import { FlatPicture } from "./flat_picture.js";
import { GlPicture } from "./gl_picture.js";
import { Names } from "./names.js";

const kWorld = "world";
const kMargin = 1.12;

/** Whether the graphics draw faster than we paint: not those of a virtual machine or a remote desktop,
    which a processor draws, and not none. */
function has_graphics() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const names = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return gl !== null && !/swiftshader|llvmpipe|software|basic render/i.test(name);
}

export class World {
  /** @param is_flat painted and not drawn by the graphics; null: whatever is faster here */
  constructor(stage, on_pick, is_flat) {
    this.stage = stage;
    this.is_flat = is_flat ?? !has_graphics();
    stage.dataset.drawn = this.is_flat ? "flat" : "gl";
    // A painted picture is on the canvas of the names, which the graphics should not touch.
    this.names = new Names(document.getElementById("names"), { willReadFrequently: this.is_flat });
    this.picture = this.is_flat ? new FlatPicture() : new GlPicture(document.getElementById("world"));
    this.fixed = { matrix: new THREE.Matrix4(), is_placed: true, is_fixed: true };
    this.frames = new Map(); // by id: {matrix, is_placed, is_fixed}
    this.layers = new Map(); // topic → Map(id → {frame, entity} or {frame, grid})
    this.changed = new Set(); // topics that the picture does not yet show as they are
    this.passing = new Set(); // {topic, id, item, until} of what is shown for a while only
    this.view = "both";
    this.bounds = { min_m: [-5, -5], max_m: [5, 5], ceiling_m: 3 };

    const plan = document.getElementById("plan-area");
    const space = document.getElementById("space-area");
    this.plan = { area: plan, camera: new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 1000) };
    this.space = { area: space, camera: new THREE.PerspectiveCamera(45, 1, 0.05, 2000) };
    for (const eye of [this.plan, this.space]) {
      eye.camera.up.set(0, 0, 1);
      eye.controls = new OrbitControls(eye.camera, eye.area);
      eye.controls.addEventListener("change", () => (eye.is_stale = true));
    }
    this.plan.controls.enableRotate = false;
    this.plan.controls.mouseButtons = { LEFT: THREE.MOUSE.PAN, MIDDLE: THREE.MOUSE.DOLLY, RIGHT: THREE.MOUSE.PAN };
    this.plan.controls.touches = { ONE: THREE.TOUCH.PAN, TWO: THREE.TOUCH.DOLLY_PAN };
    this.space.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.listen_for_clicks(on_pick);
    new ResizeObserver(() => this.resize()).observe(stage);
    this.frames_drawn = 0;
    this.fit();
  }

  /** Whether what is on the screen is not what there is. */
  is_stale() {
    return this.eyes().some((eye) => eye.is_stale);
  }

  /** All is to be drawn anew. */
  set_stale() {
    this.plan.is_stale = this.space.is_stale = true;
  }

  eyes() {
    return { plan: [this.plan], space: [this.space], both: [this.plan, this.space] }[this.view];
  }

  show(view) {
    this.view = view;
    this.stage.dataset.view = view;
    this.resize();
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
      const lifetime_s = seconds(entity.lifetime); // 0: for ever
      if (lifetime_s > 0) {
        this.passing.add({ topic, id: entity.id, item, until: seconds(entity.timestamp) + lifetime_s });
      }
    }
    this.set_stale();
  }

  /** Takes off what was to be shown until `now` [s since the epoch] at most. */
  expire(now) {
    for (const passing of this.passing) {
      if (now < passing.until) continue;
      this.passing.delete(passing);
      const { topic, id, item } = passing;
      if (this.layers.get(topic)?.get(id) !== item) continue; // another one took its place
      this.remove(topic, id);
      this.set_stale();
    }
  }

  update_grid(topic, grid) {
    this.put(topic, "grid", { frame: this.frame(grid.frame_id), grid });
    this.set_stale();
  }

  /** Takes a topic off the screen. */
  clear(topic) {
    this.layers.delete(topic);
    this.changed.add(topic);
    this.set_stale();
  }

  /** Takes everything off. */
  clear_all() {
    [...this.layers.keys()].forEach((topic) => this.clear(topic));
    this.frames.clear();
    this.passing.clear();
  }

  set_bounds(scenario) {
    this.bounds = { ...scenario.bounds, ceiling_m: scenario.ceiling_m };
    this.fit();
  }

  /** The whole world in view. */
  fit() {
    const { min_m, max_m } = this.bounds;
    const centre = [(min_m[0] + max_m[0]) / 2, (min_m[1] + max_m[1]) / 2];
    const width = max_m[0] - min_m[0];
    const height = max_m[1] - min_m[1];
    const box = this.plan.area.getBoundingClientRect();
    const aspect = box.width > 0 ? box.width / box.height : 1;
    this.plan.half_height = (kMargin / 2) * Math.max(height, width / aspect);
    this.plan.camera.zoom = 1;
    this.plan.camera.position.set(centre[0], centre[1] - 1e-4, 500);
    this.plan.controls.target.set(centre[0], centre[1], 0);
    const room = this.space.area.getBoundingClientRect();
    const far = Math.max(height, width / (room.width > 0 ? Math.min(1.6, room.width / room.height) : 1));
    this.space.camera.position.set(centre[0], centre[1] - 1.15 * far, 0.95 * far);
    this.space.controls.target.set(centre[0], centre[1], 0);
    this.plan.controls.update();
    this.space.controls.update();
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const stage = this.stage.getBoundingClientRect();
    for (const eye of [this.plan, this.space]) {
      const box = eye.area.getBoundingClientRect();
      const x = Math.round(box.left - stage.left - this.stage.clientLeft);
      const y = Math.round(box.top - stage.top - this.stage.clientTop);
      eye.at = { x, y, width: Math.round(box.width), height: Math.round(box.height) }; // on the stage
    }
    const ratio = this.is_flat ? 1 : Math.min(window.devicePixelRatio, 2);
    this.picture.resize(width, height, ratio);
    this.names.resize(width, height, ratio);
    this.set_stale();
  }

  draw() {
    this.frames_drawn += 1;
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
      if (camera.isOrthographicCamera) {
        const half = eye.half_height;
        const aspect = at.width / at.height;
        [camera.left, camera.right, camera.top, camera.bottom] = [-half * aspect, half * aspect, half, -half];
      } else {
        camera.aspect = at.width / at.height;
      }
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
      this.names.within(at, (pen) => {
        this.picture.draw(camera, at, pen);
        this.write_names(camera, at);
      });
    }
  }

  write_names(camera, at) {
    const point = new THREE.Vector3();
    for (const layer of this.layers.values()) {
      for (const { frame, entity } of layer.values()) {
        if (!frame.is_placed || !entity) continue;
        for (const text of entity.texts) {
          point.copy(text.pose.position).applyMatrix4(frame.matrix).project(camera);
          if (Math.abs(point.z) > 1) continue;
          const left = at.x + (0.5 + point.x / 2) * at.width;
          const top = at.y + (0.5 - point.y / 2) * at.height - 8;
          this.names.write(text, left, top);
        }
      }
    }
  }

  listen_for_clicks(on_pick) {
    for (const eye of [this.plan, this.space]) {
      let start = null;
      eye.area.addEventListener("pointerdown", (event) => (start = [event.clientX, event.clientY]));
      eye.area.addEventListener("pointerup", (event) => {
        const is_click =
          start && Math.hypot(event.clientX - start[0], event.clientY - start[1]) < 5;
        if (is_click) on_pick(this.pick(eye, event));
      });
    }
  }

  /** The nearest named entity within a fingertip of a click, or null. */
  pick(eye, event) {
    const box = eye.area.getBoundingClientRect();
    const point = new THREE.Vector3();
    let best = null;
    let best_px = 28;
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

  /** A scene entity as it came last, and where its frame is now. */
  find(id) {
    for (const layer of this.layers.values()) {
      if (layer.has(id)) {
        const { frame, entity } = layer.get(id);
        return { entity, position: centre_of(entity).applyMatrix4(frame.matrix) };
      }
    }
    return null;
  }

  /** Where an entity is in the window, as the plan shows it. */
  pixel(id) {
    const found = this.find(id);
    if (!found) return null;
    const box = this.plan.area.getBoundingClientRect();
    const point = found.position.project(this.plan.camera);
    return [box.left + (0.5 + point.x / 2) * box.width, box.top + (0.5 - point.y / 2) * box.height];
  }

  entities() {
    return [...this.layers.values()].reduce((sum, layer) => sum + layer.size, 0);
  }

  /** The entities of a topic. */
  shown(topic) {
    return [...(this.layers.get(topic)?.values() ?? [])].map(({ entity }) => entity);
  }

  sizes() {
    return Object.fromEntries([...this.layers].map(([topic, layer]) => [topic, layer.size]));
  }
}

/** Where an entity of the world frame is: the mean of its first line; of others their origin. */
function centre_of(entity) {
  const points = entity.frame_id === kWorld ? (entity.lines[0]?.points ?? []) : [];
  const centre = new THREE.Vector3();
  if (points.length > 0) {
    points.forEach((p) => centre.add(new THREE.Vector3(p.x, p.y, p.z)));
    centre.divideScalar(points.length);
  }
  return centre;
}
