#!/usr/bin/env python3
"""What must not change unnoticed: plans and trials, as one commit gave them.

  guard.py --bin BUILD/bin                 compares with table.json; says each difference, exit code 1
  guard.py --bin BUILD/bin --record        writes table.json anew: after a decision in docs/decisions

Plans: forty problems of both families (drawn here, by seed) by every algorithm within a budget of
nodes: cost, bound, nodes and controls. Trials: lab, field, attack, energy, mapping, two seeds each. The
sample log's exact replay and the fault table have tests of their own.
"""

import argparse
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = pathlib.Path(__file__).with_name("table.json")
NODES = 3000
CONTROLS = [[v, w] for v in (1.0, 3.0) for w in (0.0, 1.0, -1.0, 3.0, -3.0)]
TRIALS = {"lab": 12, "field": 8, "lab-attack": 12, "lab-energy": 12, "mapping": 8}  # seconds


def tracking(seed):
    """64 m without obstacles, double integrators, the robot in the middle."""
    draw = random.Random(f"tracking {seed}")
    targets = [[draw.uniform(-20, 20), draw.uniform(-20, 20), draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5)]
               for _ in range([1, 3, 9, 16][seed % 4])]
    return {"name": f"tracking {seed}", "family": "P", "n_targets": len(targets), "seed": seed,
            "map": {"min": [-32, -32], "max": [32, 32], "res": 0.5, "obstacles": []},
            "robot": {"x": 0.0, "y": 0.0, "yaw": draw.uniform(-3, 3)}, "tau": 0.5, "controls": CONTROLS, "T": 12,
            "target_model": "double_integrator_2d", "q": 0.001, "targets": targets,
            "prior_cov_diag": [1.0, 1.0, 0.1, 0.1],
            "sensor": {"type": "range_bearing", "range": 10.0, "fov_deg": 94.0, "sigma_r": 0.15, "sigma_b_deg": 5.0},
            "cost": "logdet", "notes": ""}


def landmarks(seed):
    """10 m with boxes, landmarks that stand, ranges all round or a field of view."""
    draw = random.Random(f"landmarks {seed}")
    boxes = [[x, y, x + 1.5, y + 1.5] for x, y in ((2.0, 2.0), (2.0, 6.0), (6.5, 2.5), (6.0, 6.5)) if draw.random() < 0.8]
    targets = [[draw.uniform(0.3, 9.7), draw.uniform(0.3, 1.7)] for _ in range(3 + seed % 5)]
    sensor = {"type": "range", "range": 4.0, "fov_deg": 360.0, "sigma_r": 0.1} if seed % 2 else {
        "type": "range_bearing", "range": 5.0, "fov_deg": 94.0, "sigma_r": 0.15, "sigma_b_deg": 5.0}
    return {"name": f"landmarks {seed}", "family": "A", "n_targets": len(targets), "seed": seed,
            "map": {"min": [0, 0], "max": [10, 10], "res": 0.1, "obstacles": boxes},
            "robot": {"x": 5.0, "y": 5.0, "yaw": draw.uniform(-3, 3)}, "tau": 0.5, "controls": CONTROLS,
            "T": 10, "target_model": "static_2d", "q": 0.0, "targets": targets, "prior_cov_diag": [0.25, 0.25],
            "sensor": sensor, "cost": "trace" if seed % 5 == 4 else "logdet", "notes": ""}


def run(arguments, **more):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, **more)
    if done.returncode not in (0, 1):  # 1: no complete plan, which is an answer
        sys.exit(f"guard: {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


def plans(vantage, folder):
    listed = run([vantage, "plan", "--help"]).split("Algorithms:")[1]
    algorithms = re.findall(r"^  (\w+)  ", listed, re.MULTILINE)
    jobs = []
    for problem in [f(seed) for f in (tracking, landmarks) for seed in range(20)]:
        path = folder / f"{problem['name'].replace(' ', '_')}.json"
        path.write_text(json.dumps(problem))
        jobs += [(problem["name"], a, path) for a in algorithms]

    def plan(job):
        name, algorithm, path = job
        out = json.loads(run([vantage, "plan", path, "--algorithm", algorithm, "--nodes", NODES, "--json"]))
        return f"{name}, {algorithm}", [
            out["cost"], out["lower_bound"], out["nodes_generated"], "".join(chr(97 + c) for c in out["controls"])]

    with ThreadPoolExecutor(2) as pool:
        return dict(pool.map(plan, jobs))


def trials(vantage):
    def trial(job):
        name, duration_s, seed = job
        summary = json.loads(run([vantage, "trial", ROOT / f"config/{name}.yaml", "--seed", seed, "--duration-s",
                                  duration_s, "--nodes", 2000, "--json"]))
        return f"{name}, seed {seed}", summary

    with ThreadPoolExecutor(2) as pool:
        return dict(pool.map(trial, [(n, d, s) for n, d in TRIALS.items() for s in (1, 2)]))


def differences(wanted, found, where=""):
    if isinstance(wanted, dict) and isinstance(found, dict):
        for key in sorted(wanted.keys() | found.keys()):
            yield from differences(wanted.get(key), found.get(key), f"{where}/{key}")
    elif isinstance(wanted, float) and isinstance(found, float) and math.isnan(wanted) and math.isnan(found):
        return
    elif wanted != found:
        yield f"{where}: was {json.dumps(wanted)}, is {json.dumps(found)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    parser.add_argument("--record", action="store_true")
    options = parser.parse_args()
    vantage = options.bin / "vantage"
    with tempfile.TemporaryDirectory() as folder:
        found = {"plans": plans(vantage, pathlib.Path(folder)), "trials": trials(vantage)}
    if options.record:
        TABLE.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")
        return 0
    wanted = json.loads(TABLE.read_text())
    bad = list(differences(wanted, found))
    for line in bad[:40]:
        print(line)
    print(f"guard: {len(found['plans'])} plans, {len(found['trials'])} trials, {len(bad)} differences")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
