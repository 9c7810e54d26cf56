#!/usr/bin/env python3
"""Compares plans and trials with the recorded results of one commit, so that they do not change unnoticed.

  guard.py --bin BUILD/bin                 compares with table.json; prints each difference, exit code 1
  guard.py --bin BUILD/bin --record        writes table.json again: after a decision in docs/decisions

Plans: cost, bound, nodes and controls of every algorithm for forty random problems of both families, within
a budget of nodes. Trials: the summary, and a digest of all messages and of the picture. The trials fly the
scenarios of config and of test/guard/scenarios (in which no two robots are alike) with two seeds each, and
the lab with every algorithm. Log tools: their output for the sample log. Experiments, shortened: a digest of
each table. The sample log's exact replay and the fault table have separate tests.
"""

import argparse
import hashlib
import json
import lzma
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
SCENARIOS = {"lab": 12, "field": 8, "lab-attack": 12, "lab-energy": 12, "mapping": 8, "lab-unlabelled": 12,  # seconds
             "uneven": 20, "uneven-search": 20, "uneven-mapping": 16}
EXPERIMENTS = ("active-mapping", "dls-objective", "dls-savings", "hardware", "heterogeneous", "resilient-hardware",
               "resilient-tracking", "surveillance", "tracking-communication")
LOOKS = {"info": (), "check": (), "metrics": (), "metrics, as JSON": ("--json",), "metrics, latency": ("--latency",),
         "fit-motion": ("--json",), "fit-ranges": ("--json",)}


def tracking(seed):
    """Returns a 64 m world without obstacles, with double integrators and the robot at its centre."""
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
    """Returns a 10 m world with boxes and stationary landmarks. The range sensor sees all round or has a limited
    field of view."""
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
    if done.returncode not in (0, 1):  # 1: no complete plan, which is a valid result
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


def digest(*parts):
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


def messages(vantage, log, folder):
    """Returns a digest of all messages by kind of channel, except SCENARIO, which contains the version of the
    build."""
    run([vantage, "log", "export", log, "--to", "csv", "--raw", "--out", folder])
    kinds = {}
    for path in sorted(folder.iterdir()):
        kinds.setdefault(re.sub(r"_[A-Z]\d+$", "", path.stem), []).append(path)
    return {kind: digest(*(p.read_bytes() for p in paths)) for kind, paths in kinds.items() if kind != "SCENARIO"}


def path_of(scenario):
    own = pathlib.Path(__file__).parent / f"scenarios/{scenario}.yaml"
    return own if own.exists() else ROOT / f"config/{scenario}.yaml"


def trials(vantage, folder):
    jobs = [(f"{name}, seed {seed}", name, ("--seed", seed, "--duration-s", duration_s))
            for name, duration_s in SCENARIOS.items() for seed in (1, 2)]
    listed = re.search(r"--planner TEXT:\{(.*?)\}", run([vantage, "trial", "--help"]), re.DOTALL).group(1)
    jobs += [(f"lab, {planner}", "lab", ("--seed", 3, "--duration-s", 6, "--planner", planner))
             for planner in listed.split(",") if planner != "external"]
    jobs += [(f"field, within {range_m} m", "field", ("--seed", 4, "--duration-s", 30, "--communication-range-m", range_m))
             for range_m in (0, 6, 100)]

    def trial(job):
        title, name, options = job
        place = folder / title.replace(" ", "_")
        place.mkdir()
        log, picture = place / "a.lcmlog", place / "a.svg"
        summary = json.loads(run([vantage, "trial", path_of(name), *options, "--nodes", 2000, "--json", "--log", log,
                                  "--svg", picture]))
        summary["messages"] = messages(vantage, log, place / "csv")
        summary["picture"] = digest(picture.read_bytes())
        return title, summary

    with ThreadPoolExecutor(2) as pool:
        return dict(pool.map(trial, jobs))


def sample(vantage, folder):
    """Returns the results of the log tools for the sample log."""
    (folder / "sample.lcmlog").write_bytes(lzma.decompress((ROOT / "logs/sample/lab_60s.lcmlog.xz").read_bytes()))
    outputs = {}
    for title, options in LOOKS.items():
        text = run([vantage.resolve(), "log", title.partition(",")[0], "sample.lcmlog", *options], cwd=folder)
        outputs[title] = json.loads(text) if "--json" in options else text.splitlines()
    return outputs | {"messages": messages(vantage, folder / "sample.lcmlog", folder / "sample")}


def experiments(vantage, folder):
    def experiment(name):
        out = folder / name
        run([vantage, "experiment", name, "--smoke", "--out", out])
        return name, {path.name: digest(path.read_bytes()) for path in sorted(out.glob("*.csv")) if path.name != "times.csv"}

    with ThreadPoolExecutor(2) as pool:
        return dict(pool.map(experiment, EXPERIMENTS))


def differences(wanted, found, where=""):
    if isinstance(wanted, dict) and isinstance(found, dict):
        for key in sorted(wanted.keys() | found.keys()):
            yield from differences(wanted.get(key), found.get(key), f"{where}/{key}")
    elif isinstance(wanted, float) and isinstance(found, float) and math.isnan(wanted) and math.isnan(found):
        return
    elif isinstance(wanted, list) and isinstance(found, list) and len(wanted) == len(found):
        for i, pair in enumerate(zip(wanted, found)):
            yield from differences(*pair, f"{where}/{i}")
    elif wanted != found:
        yield f"{where}: was {json.dumps(wanted)}, is {json.dumps(found)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    parser.add_argument("--record", action="store_true")
    options = parser.parse_args()
    vantage = options.bin / "vantage"
    with tempfile.TemporaryDirectory() as folder:
        parts = (plans, trials, sample, experiments)
        found = {}
        for part in parts:
            place = pathlib.Path(folder) / part.__name__
            place.mkdir()
            found[part.__name__] = part(vantage, place)
    if options.record:
        TABLE.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")
        return 0
    wanted = json.loads(TABLE.read_text())
    bad = list(differences(wanted, found))
    for line in bad[:40]:
        print(line)
    print(f"guard: {len(found['plans'])} plans, {len(found['trials'])} trials, "
          f"{len(found['experiments'])} experiments, {len(bad)} differences")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
