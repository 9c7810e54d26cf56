#!/usr/bin/env python3
"""team_bound.py P_M9_s0.json … [--teams 10] [--nodes 100000] [--work 4e6]: compares the value of
the team decision `rain` (with and without attacks) with an upper bound over all paths of the team. The
result is the median over teams with random starts."""
import argparse
import json
import math
import pathlib
import random
import statistics
import time

import vantage


def team_of(spec, robots, seed):
    """Draws robots within 15 m of the given start, with any heading."""
    draw = random.Random(seed)
    about = spec["robot"]
    return [{**spec, "robot": {"x": about["x"] + draw.uniform(-15, 15), "y": about["y"] + draw.uniform(-15, 15),
                               "yaw": draw.uniform(-math.pi, math.pi)}} for _ in range(robots)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("problems", nargs="+", type=pathlib.Path)
    parser.add_argument("--teams", type=int, default=10)
    parser.add_argument("--nodes", type=int, default=100_000, help="of each robot's search")
    parser.add_argument("--work", type=float, default=4e6, help="nodes of the bound, of each robot")
    asked = parser.parse_args()
    print("problem robots attacks measure | value, nats  bound  beyond, %  bound's CPU s")
    for path in asked.problems:
        spec = json.loads(path.read_text())
        for robots in (1, 2, 4, 8):
            for attacks in (0, 1, 2):
                if attacks >= robots:
                    continue
                for measure in ("mutual", "logdet"):
                    rows = []
                    for seed in range(1, asked.teams + 1):
                        decision = vantage.decide(team_of(spec, robots, seed), "rain", nodes=asked.nodes,
                                                  attacks_max=attacks, measure=measure)
                        value = decision.worst_attack(attacks)[1]
                        began_s = time.thread_time()
                        bound = decision.paths_bound(attacks, int(asked.work * robots))
                        rows.append((value, bound, 100 * (bound / value - 1), time.thread_time() - began_s))
                        assert value <= bound, (path, seed, rows[-1])
                    value, bound, beyond, cpu_s = map(statistics.median, zip(*rows))
                    print(f"{path.stem:9} {robots} {attacks} {measure:7} | {value:9.1f} {bound:9.1f} {beyond:7.1f} {cpu_s:7.2f}", flush=True)


if __name__ == "__main__":
    main()
