#!/usr/bin/env python3
"""speed.py [--seconds S] [--vantage BINARY] [--scenario FILE] [WHAT…]: how fast the module is.

  env    steps a second of each environment beside numpy_tasks.py, the same task in plain numpy
  plan   what a call of Planner.plan() takes besides the search
  trial  a trial stepped from Python beside `vantage trial`, one after the other, again and again

Set PYTHONPATH to the module's folder (build/release/python). Medians of several pieces of the same work;
on a machine that does something else they say little.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

import numpy
import vantage
import vantage.env

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy_tasks  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


def rate(run, seconds, pieces=5):
    """Median over pieces of the steps a second; run(n) does about n steps and says how many."""
    done, begin = run(20), time.perf_counter()
    done = run(20)
    steps = max(20, int(done * seconds / pieces / (time.perf_counter() - begin)))
    rates = []
    for _ in range(pieces):
        begin = time.perf_counter()
        done = run(steps)
        rates.append(done / (time.perf_counter() - begin))
    return statistics.median(rates)


def single(name):
    env = vantage.env.make(name)
    random = numpy.random.default_rng(0)
    env.reset(seed=0)
    size, actions = env.robots, env._tasks.actions

    def run(steps):
        for action in random.integers(actions, size=(steps, size)):
            if env.step(action if size > 1 else action[0])[3]:
                env.reset()
        return steps
    return run


def many(name, count, threads):
    env = vantage.env.make_vector(name, count, threads)
    random = numpy.random.default_rng(0)
    env.reset(seed=0)
    actions = [random.integers(env._tasks.actions, size=env.action_space.shape) for _ in range(64)]

    def run(steps):
        rounds = max(1, steps // count)
        for i in range(rounds):
            env.step(actions[i % 64])
        return rounds * count
    return run


def plain(name):
    kind, options = vantage.env.tasks[name]
    if kind == "tracking":
        task = numpy_tasks.Tracking(**options)
    else:
        task = numpy_tasks.Mapping(numpy_tasks.pillars(), **options)
    random = numpy.random.default_rng(0)
    task.reset(0)

    def run(steps):
        for i, action in enumerate(random.integers(len(task.controls), size=(steps, task.robots))):
            if task.step(action)[2]:
                task.reset(i)
        return steps
    return run


def compare_env(seconds):
    threads = len(os.sched_getaffinity(0))
    print(f"| task | numpy, steps/s | one, steps/s | × | 256 on {threads} threads, steps/s | × |")
    print("|---|---|---|---|---|---|")
    for name in vantage.env.tasks:
        # One after the other within a second or so: what else the machine does meets all alike.
        slow = rate(plain(name), seconds)
        one = rate(single(name), seconds)
        fast = rate(many(name, 256, threads), seconds)
        print(f"| {name} | {slow:,.0f} | {one:,.0f} | {one / slow:.0f} | {fast:,.0f} | {fast / slow:.0f} |",
              flush=True)


def compare_plan():
    print("| problem | nodes | call, µs | search, µs | besides, µs (median of 500) |")
    print("|---|---|---|---|---|")
    for file in ("tracking.json", "mapping.json"):
        problem = vantage.Problem(ROOT / "test/tools/problems" / file)
        for nodes in (100, 20_000):
            planner = vantage.Planner("beam", nodes=nodes)
            planner.plan(problem)
            calls = []
            for _ in range(500):
                begin = time.perf_counter()
                plan = planner.plan(problem)
                controls = plan.controls
                cost = plan.cost
                calls.append((time.perf_counter() - begin, plan.elapsed_s))
                del controls, cost
            call, search = (1e6 * statistics.median(each) for each in zip(*calls))
            besides = 1e6 * statistics.median(a - b for a, b in calls)
            print(f"| {file} | {nodes} | {call:.1f} | {search:.1f} | {besides:.1f} |", flush=True)


def compare_trial(binary, scenario, pairs, duration_s):
    """CPU time, which on a busy machine says more than the clock."""
    shares = []
    changed = vantage.Scenario(scenario).replace(duration_s=duration_s)
    for _ in range(pairs):
        before = os.times()
        subprocess.run([binary, "trial", scenario, "--duration-s", str(duration_s), "--json"], check=True,
                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        after = os.times()
        command_s = after.children_user + after.children_system - before.children_user - before.children_system
        begin = time.process_time()
        trial = vantage.Trial(changed)
        while not trial.is_over:
            trial.step()
            trial.robots, trial.beliefs
        json.dumps(trial.metrics)
        python_s = time.process_time() - begin
        shares.append(command_s / python_s)
        print(f"| {command_s:.3f} s | {python_s:.3f} s | {100 * shares[-1]:.0f} % |", flush=True)
    print(f"median {100 * statistics.median(shares):.0f} % of `vantage trial`'s speed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", default=["env", "plan", "trial"])
    parser.add_argument("--seconds", type=float, default=5.0, help="of each rate")
    parser.add_argument("--vantage", default=str(ROOT / "build/release/bin/vantage"))
    parser.add_argument("--scenario", default=str(ROOT / "config/lab.yaml"))
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--duration-s", type=float, default=20.0)
    given = parser.parse_args()
    if "env" in given.what:
        compare_env(given.seconds)
    if "plan" in given.what:
        compare_plan()
    if "trial" in given.what:
        compare_trial(given.vantage, given.scenario, given.pairs, given.duration_s)


if __name__ == "__main__":
    main()
