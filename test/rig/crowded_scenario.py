#!/usr/bin/env python3
"""Prints a scenario with many robots and targets.

The default scenario serves to measure the viewer's frame rate: 80 m × 80 m, with the planner
lawn_mower. A scenario with --area-m2 serves to measure how the computing cost grows with the team
(test/bench/trial_bench): the field grows with the team, so that the number of neighbours per robot is
constant.
"""
import argparse
import math

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("robots", type=int)
parser.add_argument("targets", type=int)
parser.add_argument("--planner", default="lawn_mower", help="planner.algorithm")
parser.add_argument("--nodes", type=int, help="planner.node_budget")
parser.add_argument("--area-m2", type=float, help="area of the field per robot, m² (default: 80 m × 80 m in total)")
parser.add_argument("--duration-s", type=float, default=60)
parser.add_argument("--communication-range-m", type=float, default=10)
parser.add_argument("--neighbourhood-m", type=float, help="network.neighbourhood_m (default: all robots)")
parser.add_argument("--slots", type=int, help="planner.slots (default: one per robot)")
parser.add_argument("--cell-m", type=float, help="cell of the visibility grid, m (default: 100 x 100 cells)")
given = parser.parse_args()

columns = max(1, round(given.robots**0.5))
rows = math.ceil(given.robots / columns)
spacing_m = math.sqrt(given.area_m2) if given.area_m2 else 10
half_m = 0.5 * spacing_m * max(columns, rows) if given.area_m2 else 40
first_m = -half_m + 0.5 * spacing_m if given.area_m2 else -35
print(f"""name: crowd
duration_s: {given.duration_s:g}
seed: 1
world:
  bounds: {{min_m: [{-half_m:g}, {-half_m:g}], max_m: [{half_m:g}, {half_m:g}]}}
  ceiling_m: 30""")
if not given.area_m2:
    print("""  obstacles:
    - footprint: {min_m: [-32, -32], max_m: [-28, -28]}
      height_m: 5""")
print("""robot_defaults:
  primitives: standard
  limits: {speed_max_mps: 3, yaw_rate_max_radps: 3, brake_mps2: 4, radius_m: 0.25}
  sensor: {kind: range_bearing, range_max_m: 8, range_min_m: 0.1, fov_deg: 94}
robots:""")
for i in range(given.robots):
    x, y = (first_m + spacing_m * (i % columns), first_m + spacing_m * (i // columns))
    height_m = 1 + 0.5 * (i % 57)  # below the ceiling
    print(f"  - {{name: Q{i + 1}, start: {{x_m: {x:g}, y_m: {y:g}, yaw_deg: 0}}, height_m: {height_m:g}}}")
nodes = f", node_budget: {given.nodes}" if given.nodes else ""
slots = f", slots: {given.slots}" if given.slots else ""
cell_m = given.cell_m or (max(2.0, 2 * half_m / 100) if given.area_m2 else 2)
neighbourhood = f", neighbourhood_m: {given.neighbourhood_m:g}" if given.neighbourhood_m else ""
print(f"""targets: {{count: {given.targets}, name_prefix: R, radius_m: 0.2}}
estimator: {{target_model: {{kind: random_walk, q: 0.3}}, grid_resolution_m: {cell_m:g}}}
planner: {{algorithm: {given.planner}, horizon_steps: 6, step_s: 0.5, execute_steps: 2, team_budget_s: 0.5{nodes}{slots}}}
network: {{communication_range_m: {given.communication_range_m:g}{neighbourhood}}}""")
