// The world on the screen: one scene, seen from above and in perspective.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Batches, dispose, is_software_drawn, make_anchor, make_grid } from "./primitives.js";
import { Names } from "./names.js";

const kWorld = "world";
const kMargin = 1.12;

export class World {
  constructor(stage, on_pick) {
    this.stage = stage;
    this.is_plain = is_software_drawn(); // then each pixel counts
    this.names = new Names(document.getElementById("names"), this.is_plain);
    this.renderer = new THREE.WebGLRenderer({ canvas: document.getElementById("world"), antialias: !this.is_plain });
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV; // to ask waits for the graphics
    this.scene = new THREE.Scene();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.2);
    sun.position.set(3, -5, 10);
    this.scene.add(sun);
    this.frames = new Map();
    this.layers = new Map(); // topic → Map(id → anchor, or grid)
    this.batches = new Map(); // topic → what is seen of its entities
    this.changed = new Set(); // topics whose batches are to be made anew
    this.view = "both";
    this.bounds = { min_m: [-5, -5], max_m: [5, 5], ceiling_m: 3 };

    const plan = document.getElementById("plan-area");
    const space = document.getElementById("space-area");
    this.plan = { area: plan, camera: new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 1000) };
    this.space = { area: space, camera: new THREE.PerspectiveCamera(45, 1, 0.05, 2000) };
    for (const eye of [this.plan, this.space]) {
      eye.camera.up.set(0, 0, 1);
      eye.controls = new OrbitControls(eye.camera, eye.area);
      eye.controls.addEventListener("change", () => (this.is_stale = true));
    }
    this.plan.controls.enableRotate = false;
    this.plan.controls.mouseButtons = { LEFT: THREE.MOUSE.PAN, MIDDLE: THREE.MOUSE.DOLLY, RIGHT: THREE.MOUSE.PAN };
    this.plan.controls.touches = { ONE: THREE.TOUCH.PAN, TWO: THREE.TOUCH.DOLLY_PAN };
    this.space.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.listen_for_clicks(on_pick);
    new ResizeObserver(() => this.resize()).observe(stage);
    this.frames_drawn = 0;
    const loop = () => {
      requestAnimationFrame(loop);
      if (this.is_stale && !document.hidden) this.draw();
    };
    this.fit();
    loop();
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
    if (id === kWorld) return this.scene;
    if (!this.frames.has(id)) {
      const group = new THREE.Group();
      group.visible = false; // until somebody says where it is
      this.frames.set(id, group);
      this.scene.add(group);
    }
    return this.frames.get(id);
  }

  move(transforms) {
    for (const each of transforms) {
      const group = this.frame(each.child_frame_id);
      const { translation: p, rotation: q } = each;
      group.position.set(p.x, p.y, p.z);
      group.quaternion.set(q.x, q.y, q.z, q.w);
      group.visible = true;
    }
    this.is_stale = true;
  }

  layer(topic) {
    if (!this.layers.has(topic)) this.layers.set(topic, new Map());
    return this.layers.get(topic);
  }

  remove(topic, id) {
    const layer = this.layer(topic);
    if (layer.has(id)) {
      dispose(layer.get(id));
      layer.delete(id);
      this.changed.add(topic);
    }
  }

  put(topic, id, group, frame) {
    this.remove(topic, id);
    this.layer(topic).set(id, group);
    this.frame(frame).add(group);
    this.changed.add(topic);
    this.is_stale = true;
  }

  update(topic, scene) {
    for (const deletion of scene.deletions) {
      const ids = deletion.type === 1 ? [...this.layer(topic).keys()] : [deletion.id];
      ids.forEach((id) => this.remove(topic, id));
    }
    for (const entity of scene.entities) {
      this.put(topic, entity.id, make_anchor(entity), entity.frame_id);
    }
    this.is_stale = true;
  }

  update_grid(topic, grid) {
    this.put(topic, "grid", make_grid(grid), grid.frame_id);
  }

  /** Makes what is seen of changed topics, once however much has come, and puts all in place. */
  make_batches() {
    for (const topic of this.changed) {
      this.batches.get(topic)?.dispose();
      const anchors = [...(this.layers.get(topic)?.values() ?? [])];
      const entities = anchors.map((anchor) => anchor.userData.entity).filter(Boolean);
      this.batches.set(topic, new Batches(this.scene, entities, (id) => this.frame(id), this.is_plain));
    }
    this.changed.clear();
    this.scene.updateMatrixWorld();
    this.batches.forEach((batches) => batches.follow());
  }

  /** Takes a topic off the screen. */
  clear(topic) {
    for (const id of [...this.layer(topic).keys()]) this.remove(topic, id);
    this.layers.delete(topic);
    this.is_stale = true;
  }

  /** Takes everything off. */
  clear_all() {
    [...this.layers.keys()].forEach((topic) => this.clear(topic));
    for (const group of this.frames.values()) group.removeFromParent();
    this.frames.clear();
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
    const ratio = this.is_plain ? 1 : Math.min(window.devicePixelRatio, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.names.resize(width, height, ratio);
    this.is_stale = true;
  }

  /** Where an eye's area is on the stage. */
  area(eye) {
    const stage = this.stage.getBoundingClientRect();
    const box = eye.area.getBoundingClientRect();
    return { x: box.left - stage.left, y: box.top - stage.top, width: box.width, height: box.height };
  }

  draw() {
    this.is_stale = false;
    this.frames_drawn += 1;
    const style = getComputedStyle(document.documentElement);
    this.renderer.setClearColor(style.getPropertyValue("--stage").trim());
    this.make_batches();
    this.names.begin(style.getPropertyValue("--halo").trim());
    this.renderer.setScissorTest(true);
    const stage_height = this.stage.clientHeight;
    for (const eye of this.eyes()) {
      const at = this.area(eye);
      if (at.width < 2 || at.height < 2) continue;
      const { camera } = eye;
      if (camera.isOrthographicCamera) {
        const half = eye.half_height;
        const aspect = at.width / at.height;
        [camera.left, camera.right, camera.top, camera.bottom] = [-half * aspect, half * aspect, half, -half];
      } else {
        camera.aspect = at.width / at.height;
      }
      camera.updateProjectionMatrix();
      const bottom = stage_height - at.y - at.height;
      this.renderer.setViewport(at.x, bottom, at.width, at.height);
      this.renderer.setScissor(at.x, bottom, at.width, at.height);
      this.renderer.render(this.scene, camera);
      this.write_names(eye, at);
    }
  }

  write_names(eye, at) {
    const point = new THREE.Vector3();
    this.names.within(at, () => {
      for (const layer of this.layers.values()) {
        for (const group of layer.values()) {
          if (!group.parent?.visible) continue;
          for (const text of group.userData.entity?.texts ?? []) {
            point.copy(text.pose.position).applyMatrix4(group.matrixWorld).project(eye.camera);
            if (Math.abs(point.z) > 1) continue;
            const left = at.x + (0.5 + point.x / 2) * at.width;
            const top = at.y + (0.5 - point.y / 2) * at.height - 8;
            this.names.write(text, left, top);
          }
        }
      }
    });
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
      for (const group of layer.values()) {
        const entity = group.userData.entity;
        if (!entity || entity.metadata.length === 0 || !group.parent?.visible) continue;
        group.localToWorld(point.copy(centre_of(entity))).project(eye.camera);
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
        const group = layer.get(id);
        const at = group.localToWorld(centre_of(group.userData.entity));
        return { entity: group.userData.entity, position: at };
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
