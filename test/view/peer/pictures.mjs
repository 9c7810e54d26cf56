// pictures.mjs SOURCE_DIR VANTAGE FOLDER [SCENE…]: writes pictures of the page to FOLDER/SCENE_WIDTH_SCHEME.png, at
// widths of 1920, 1366 and 768 pixels, light and dark, for a person to judge (docs/results/viewer.md). Fails if a
// page reports an error in its console or is wider than its window.

import assert from "node:assert";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { chromium } from "playwright-core";

const [source, vantage, out, ...wanted] = process.argv.slice(2);
const folder = mkdtempSync(`${tmpdir()}/pictures.`);
const kSizes = [[1920, 1080], [1366, 768], [768, 1024]];

/** Flies a scenario without a network; returns the path of its log. */
function fly(name, scenario, duration_s) {
  const log = `${folder}/${name}.lcmlog`;
  execFileSync(vantage, ["trial", scenario, "--duration-s", String(duration_s), "--log", log], { stdio: ["ignore", "ignore", "inherit"] });
  return log;
}

/** Flies 50 robots and 100 targets; returns the path of the log. */
function crowd() {
  writeFileSync(`${folder}/crowd.yaml`, execFileSync(`${source}/test/rig/crowded_scenario.py`, ["50", "100"]));
  return fly("crowd", `${folder}/crowd.yaml`, 20);
}

/** Five robots in the camp of buildings and trees of experiments/surveillance/camp_world, flown by the stack; one of them is
    jammed. */
function camp() {
  const text = readFileSync(`${source}/experiments/surveillance/camp_world.cpp`, "utf8");
  const rows = (name) => [...text.match(new RegExp(`${name} = \\{\\{([^;]*)\\}\\};`))[1].matchAll(/\{([\d., ]+)\}/g)].map(([, row]) => row.split(",").map(Number));
  const box = (x, y, width, depth, height) => `    - {footprint: {min_m: [${x}, ${y}], max_m: [${x + width}, ${y + depth}]}, height_m: ${height}}`;
  const boxes = [
    ...rows("kBuildings").map(([x, y, width, depth, height]) => box(x, y, width, depth, height)),
    ...rows("kTrees").map(([x, y, height]) => box(x - 0.75, y - 0.75, 1.5, 1.5, height)),
  ];
  const starts = [[60, 52], [30, 55], [90, 55], [48, 20], [76, 14]];
  const robots = starts.map(([x, y], i) => `  - {name: Q${i + 1}, start: {x_m: ${x}, y_m: ${y}, yaw_deg: ${72 * i}}, height_m: ${5.5 + i}}`);
  writeFileSync(`${folder}/camp.yaml`, `name: camp
duration_s: 60
seed: 3
world:
  bounds: {min_m: [0, 0], max_m: [120, 90]}
  ceiling_m: 20
  obstacles:
${boxes.join("\n")}
robot_defaults:
  primitives: standard
  limits: {speed_max_mps: 3, yaw_rate_max_radps: 3, brake_mps2: 4, radius_m: 0.4}
  sensor: {kind: range_bearing, range_max_m: 15, range_min_m: 0.1, fov_deg: 120}
robots:
${robots.join("\n")}
targets: {count: 15, name_prefix: L, radius_m: 0.5}
target_truth: {motion: double_integrator, acceleration_q: 0.001}
estimator:
  target_model: {kind: double_integrator, q: 0.001}
  prior_velocity_sigma_mps: 0.5
  undiscovered_position_sigma_m: 30
  grid_resolution_m: 2
planner: {algorithm: arvi, attacks_max: 1, horizon_steps: 8, step_s: 0.5, execute_steps: 2, team_budget_s: 0.5, node_budget: 3000, separation_m: 1}
attacks:
  - {from_s: 20, to_s: 50, robots: [Q2]}
network: {communication_range_m: 60}
`);
  return fly("camp", `${folder}/camp.yaml`, 40);
}

function sample() {
  const log = `${folder}/lab.lcmlog`;
  writeFileSync(log, execFileSync("xz", ["-dkc", `${source}/logs/sample/lab_60s.lcmlog.xz`], { maxBuffer: 1 << 28 }));
  return log;
}

const plotted = ["ARM_STATE~position_rad.1", "ARM_STATE~position_rad.3", "ARM_STATE~tip_m.z", "POWER~voltage_v"].map((field) => `/lcm/${field}`);

/** Scenes by name: arguments of the server, link to the page, action before the picture. */
const kScenes = {
  live: { args: () => ["demo", "--scenario", `${source}/config/lab.yaml`, "--duration-s", "900", "--out", `${folder}/demo`, "--view"], settle_ms: 30_000 },
  field: { args: () => ["view", fly("field", `${source}/config/field.yaml`, 90)], link: "t=80" },
  crowd: { args: () => ["view", crowd()], link: "t=15" },
  mapping: { args: () => ["view", fly("mapping", `${source}/config/mapping.yaml`, 60)], link: "t=35" },
  camp: { args: () => ["view", camp()], link: "t=38&view=space" },
  opened: { args: () => ["view", sample()] },
  foreign: {
    args: () => (execFileSync(`${source}/test/view/foreign_log.py`, [folder]), ["view", `${folder}/foreign.lcmlog`, "--types", `${folder}/types`]),
    is_ready: () => document.querySelectorAll("#topics [data-topic]").length > 1,
    link: `t=21&${new URLSearchParams({ plot: plotted.join(" ") })}`,
    act: (page) => page.locator('[data-topic="/lcm/ARM_STATE"] > summary').click(),
  },
};

/** Starts a server; returns its address and a function that ends it. */
async function serve(args) {
  const server = spawn(vantage, [...args, "--port", "0"]);
  let said = "";
  const url = await new Promise((resolve, reject) => {
    server.on("exit", () => reject(new Error(said)));
    for (const stream of [server.stdout, server.stderr]) {
      stream.on("data", (text) => {
        said += text;
        const found = said.match(/http:\/\/[\d.:]+/);
        if (found) resolve(found[0]);
      });
    }
  });
  server.removeAllListeners("exit");
  const gone = new Promise((resolve) => server.on("close", resolve));
  return { url, end: () => (server.kill("SIGINT"), gone) };
}

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const complaints = [];
try {
  for (const name of wanted.length > 0 ? wanted : Object.keys(kScenes)) {
    const scene = kScenes[name];
    const server = await serve(scene.args());
    for (const scheme of ["light", "dark"]) {
      for (const [width, height] of kSizes) {
        const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
        page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(`${name}: ${message.text()}`));
        page.on("pageerror", (error) => complaints.push(`${name}: ${error}`));
        await page.goto(`${server.url}/${scene.link ? `#${scene.link}` : ""}`);
        await page.waitForFunction(scene.is_ready ?? (() => window.vantage?.stats().entities > 10));
        const at_s = Number(new URLSearchParams(scene.link).get("t"));
        // The server first sends the position of the previous page, then the requested one.
        if (at_s && !scene.is_ready) await page.waitForFunction((at_s) =>
          vantage.state.jumps > 0 && Math.abs(vantage.state.arrived - vantage.state.start - at_s) < 0.1 &&
          ["/robots", "/plan/Q1"].every((topic) => vantage.stats().layers[topic] > 0), at_s);
        await scene.act?.(page);
        if (scene.settle_ms && width === 1920 && scheme === "light") await page.waitForTimeout(scene.settle_ms);
        await page.waitForTimeout(2500); // charts are drawn one after another
        const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        if (overflow > 0) complaints.push(`${name} at ${width}: ${overflow} px too wide`);
        await page.screenshot({ path: `${out}/${name}_${width}_${scheme}.png`, fullPage: width < 1000 });
        await page.close();
      }
    }
    await server.end();
    console.log(name);
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
assert.deepEqual([...new Set(complaints)], []);
