#!/usr/bin/env python3
"""Runs the trials behind docs/results: paired by seed, resumable, with confidence intervals.

  tools/dev/study.py lab    ARVI against one-step greedy, lawn mower and random walk (config/lab.yaml)
  tools/dev/study.py field  communication range 0, 5, 10, 30 m (config/field.yaml)

Each trial is one `vantage trial … --json`; a trial whose JSON exists is not run again.
"""

import argparse
import concurrent.futures
import json
import math
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Student's t at 97.5 %, by degrees of freedom.
T_975 = {1: 12.71, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306, 9: 2.262,
         14: 2.145, 19: 2.093, 29: 2.045}

STUDIES = {
    "lab": {
        "scenario": "config/lab.yaml",
        "cases": {name: ["--planner", name]
                  for name in ("arvi", "greedy", "lawn_mower", "random_walk")},
        "reference": "arvi",
        "axis": "planner",
    },
    "field": {
        "scenario": "config/field.yaml",
        "cases": {f"{r}": ["--communication-range-m", f"{r}"] for r in (0, 5, 10, 30)},
        "reference": "0",
        "axis": "communication range [m]",
        # As in the source's figure 3.3: every robot by its own belief, mean over the robots.
        "columns": {
            "RMSE of a robot [m]": lambda t: t["per_robot"]["rmse_m"],
            "entropy of a robot [nat]": lambda t: t["per_robot"]["entropy"],
            "discovery by a robot [s]": lambda t: t["per_robot"]["discovery_time_s"],
            "found by a robot": lambda t: t["per_robot"]["discovered"] / t["targets"],
        },
    },
}


def mean_ci(values):
    """Mean and half width of its 95 % confidence interval."""
    n = len(values)
    mean = statistics.fmean(values)
    if n < 2:
        return mean, math.nan
    return mean, T_975.get(n - 1, 1.96) * statistics.stdev(values) / math.sqrt(n)


def run(binary, scenario, flags, seed, path, extra):
    if not path.exists():
        done = subprocess.run(
            [binary, "trial", scenario, "--seed", str(seed), "--json", *flags, *extra],
            cwd=ROOT, capture_output=True, text=True, check=False)
        if done.returncode != 0 or not done.stdout.strip():
            raise RuntimeError(f"{path.stem}: exit {done.returncode}: {done.stderr.strip()}")
        path.write_text(done.stdout)
    return json.loads(path.read_text())


def discovery(trial):
    """Mean time until a target is known; one never found counts with the trial's length."""
    return statistics.fmean(trial["duration_s"] if t is None else t
                            for t in trial["discovery_time_s"])


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/study")
    parser.add_argument("--binary", default=str(ROOT / "build/release/bin/vantage"))
    parser.add_argument("--cases", nargs="*", help="only these")
    parser.add_argument("--plot", type=pathlib.Path, help="draw the measures into this .svg or .png")
    parser.add_argument("--extra", default="", help="further flags of `vantage trial`")
    args = parser.parse_args()
    study = STUDIES[args.study]
    cases = {k: v for k, v in study["cases"].items() if not args.cases or k in args.cases}
    args.out.mkdir(parents=True, exist_ok=True)

    jobs = [(case, seed) for seed in range(1, args.seeds + 1) for case in cases]
    trials = {case: {} for case in cases}
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        futures = {
            pool.submit(run, args.binary, study["scenario"], cases[case], seed,
                        args.out / f"{args.study}_{case}_{seed}.json", args.extra.split()): (case, seed)
            for case, seed in jobs}
        for number, future in enumerate(concurrent.futures.as_completed(futures), 1):
            case, seed = futures[future]
            trials[case][seed] = future.result()
            print(f"\r{number}/{len(jobs)} trials", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)

    columns = dict(study.get("columns", {})) | {
        "RMSE [m]": lambda t: t["rmse_m"],
        "entropy [nat]": lambda t: t["entropy"],
        "discovery [s]": discovery,
        "found": lambda t: t["discovered"] / t["targets"],
        "unknown share": lambda t: t["undiscovered_share"],
    }
    totals = ("collisions", "separation_violations", "fallbacks", "rounds", "rounds_late",
              "messages_lost")
    print(f"| {study['axis']} | " + " | ".join(columns) + " | min. separation [m] | "
          + " | ".join(t.replace("_", " ") for t in totals) + " |")
    print("|" + "---|" * (2 + len(columns) + len(totals)))
    rows = []
    for case in cases:
        runs = [trials[case][s] for s in sorted(trials[case])]
        cells, row = [], [case]
        for of in columns.values():
            mean, half = mean_ci([of(t) for t in runs])
            cells.append(f"{mean:.3f} ± {half:.3f}")
            row += [mean, half]
        rows.append(row)
        print(f"| {case} | " + " | ".join(cells)
              + f" | {min(t['min_separation_m'] for t in runs):.2f} | "
              + " | ".join(str(sum(t[k] for t in runs)) for k in totals) + " |")
    reference = study["reference"]
    if reference in cases and args.study == "lab":
        print(f"\nPaired by seed, other − {reference} (positive: {reference} is better):\n")
        for case in cases:
            if case == reference:
                continue
            parts = []
            for name in ("RMSE [m]", "entropy [nat]"):
                of = columns[name]
                mean, half = mean_ci([of(trials[case][s]) - of(trials[reference][s])
                                      for s in sorted(trials[case])])
                parts.append(f"{name} {mean:+.3f} ± {half:.3f}")
            print(f"- {case}: " + ", ".join(parts))
    table = args.out / f"{args.study}.dat"
    table.write_text(
        "# case " + " ".join(f'"{c}" ±' for c in columns) + "\n"
        + "\n".join(" ".join(str(x) for x in row) for row in rows) + "\n")
    if args.plot:
        plot(table, study["axis"], list(columns), args.plot, is_swept=args.study == "field")


def plot(table, axis, columns, path, is_swept):
    """One panel a measure, mean and 95 % confidence interval over the cases, by gnuplot; joined by
    lines when the cases are values of one quantity."""
    style = "yerrorlines" if is_swept else "yerrorbars"
    shown = [*columns[:4]] if is_swept else ["RMSE [m]", "entropy [nat]", "discovery [s]",
                                             "unknown share"]
    commands = [
        f"set terminal {'svg' if path.suffix == '.svg' else 'pngcairo'} size 1000,640 noenhanced font 'sans,11'",
        f"set output '{path}'", "set multiplot layout 2,2", "set grid ytics lc rgb '#dddddd'",
        "unset key", "set border 3", "set tics nomirror", "set offsets 0.3, 0.3, 0, 0",
        f"set xlabel '{axis}'"]
    for name in shown:
        column = 2 + 2 * columns.index(name)
        commands += [f"set ylabel '{name}'",
                     f"plot '{table}' using 0:{column}:{column + 1}:xtic(1) with {style} "
                     "lw 2 pt 7 ps 1 lc rgb '#1f5fa8'"]
    subprocess.run(["gnuplot"], input="\n".join(commands), text=True, check=True)


if __name__ == "__main__":
    main()
