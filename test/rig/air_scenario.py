#!/usr/bin/env python3
"""Prints config/field.yaml with another team size, and as many targets as robots, at least nine.

  test/rig/air_scenario.py 10 --budget-kbitps 33 --loss 0.2 > air.yaml
"""
import argparse
import math
import pathlib
import re

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("robots", type=int)
parser.add_argument("--budget-kbitps", type=float, default=0, help="network.budget_kbitps (default: none)")
parser.add_argument("--loss", type=float, default=0, help="network.simulation.loss")
parser.add_argument("--rate-kbitps", type=float, default=0, help="network.simulation.rate_kbitps")
parser.add_argument("--duration-s", type=float, default=120)
parser.add_argument("--nodes", type=int, default=1000, help="planner.node_budget")
given = parser.parse_args()

field = (pathlib.Path(__file__).parents[2] / "config/field.yaml").read_text()
columns = math.ceil(given.robots**0.5)
robots = "robots:\n"
for i in range(given.robots):
    x, y = (-24 + 48 * ((k + 0.5) / columns) for k in (i % columns, i // columns))
    robots += (f"  - {{name: Q{i + 1}, start: {{x_m: {x:g}, y_m: {y:g}, yaw_deg: {i * 97 % 360}}}, "
               f"height_m: {1.5 + 7.5 * i / max(30, given.robots):g}}}\n")
field = re.sub(r"robots:.*?\ntargets:", robots + "\ntargets:", field, flags=re.S)
field = re.sub(r"count: 9 ", f"count: {max(9, given.robots)} ", field)
field = re.sub(r"duration_s: \d+ ", f"duration_s: {given.duration_s:g} ", field)
field = field.replace("team_budget_s: 0.5 ", f"team_budget_s: 0.5\n  node_budget: {given.nodes} ")
field += f"""
  budget_kbitps: {given.budget_kbitps:g}
  simulation: {{loss: {given.loss:g}, rate_kbitps: {given.rate_kbitps:g}}}
"""
print(field)
