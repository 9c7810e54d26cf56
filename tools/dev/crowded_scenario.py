#!/usr/bin/env python3
"""crowded_scenario.py ROBOTS TARGETS: a scenario with so many, on standard output; for the viewer's
frame rate, not for what the planners make of it (the lawn mower flies them)."""
import sys

robots, targets = int(sys.argv[1]), int(sys.argv[2])
columns = max(1, round(robots**0.5))
print(f"""name: crowd
duration_s: 60
seed: 1
world:
  bounds: {{min_m: [-40, -40], max_m: [40, 40]}}
  ceiling_m: 30
  obstacles:
    - footprint: {{min_m: [-32, -32], max_m: [-28, -28]}}
      height_m: 5
robot_defaults:
  primitives: standard
  limits: {{speed_max_mps: 3, yaw_rate_max_radps: 3, brake_mps2: 4, radius_m: 0.25}}
  sensor: {{kind: range_bearing, range_max_m: 8, range_min_m: 0.1, fov_deg: 94}}
robots:""")
for i in range(robots):
    x, y = (10 * (i % columns) - 35, 10 * (i // columns) - 35)
    print(f"  - {{name: Q{i + 1}, start: {{x_m: {x}, y_m: {y}, yaw_deg: 0}}, height_m: {1 + 0.5 * i}}}")
print(f"""targets: {{count: {targets}, name_prefix: R, radius_m: 0.2}}
estimator: {{grid_resolution_m: 2}}
planner: {{algorithm: lawn_mower, horizon_steps: 6, step_s: 0.5, execute_steps: 2, team_budget_s: 0.5}}
network: {{communication_range_m: 10}}""")
