#!/usr/bin/env python3
"""speed.py [--seconds S] [--vantage BINARY] [--scenario FILE] [WHAT…]: measures the speed of the Python module.

  env    steps per second of each environment compared with numpy_tasks.py, the same task in plain
         numpy: the rows of docs/reference/environments.md
  plan   overhead of a call of Planner.plan(): time of the call minus time of the search
  trial  time of a trial stepped from Python and of the same `vantage trial`, measured alternately

Without WHAT, all three are measured.

Set PYTHONPATH to the module's folder (build/release/python). Results are medians of several
repetitions, in CPU time unless stated otherwise, because wall time is unreliable on a busy machine.
"""
import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import time

import numpy
import numpy_tasks
import vantage
import vantage.env

ROOT = pathlib.Path(__file__).resolve().parents[2]


def rate(run, seconds, clock=time.process_time, pieces=5):
    """Returns the median of the steps per second; run(n) performs about n steps and returns their number."""
    run(20)
    begin = clock()
    done = run(20)
    steps = max(20, int(done * seconds / pieces / (clock() - begin)))
    rates = []
    for _ in range(pieces):
        begin = clock()
        done = run(steps)
        rates.append(done / (clock() - begin))
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


def three_figures(number):
    """Returns a number as text with three significant digits and separated thousands: 54 612.3 as "54 600"."""
    digits = max(0, len(str(int(number))) - 3)
    return f"{round(number, -digits):,.0f}".replace(",", " ")


def compare_env(seconds):
    threads = len(os.sched_getaffinity(0))
    clocked = {}
    print("Steps per second of CPU time, one thread:")
    print("| task | numpy | one environment | × | 256 together | × |")
    print("|---|---|---|---|---|---|")
    for name in vantage.env.tasks:
        # Measured within a few seconds, so that other load of the machine affects all three rates
        # equally.
        slow, one, together = (rate(run, seconds) for run in (plain(name), single(name), many(name, 256, 1)))
        clocked[name] = three_figures(rate(many(name, 256, threads), seconds, time.perf_counter))
        print(f"| `{name}` | {three_figures(slow)} | {three_figures(one)} | {one / slow:.0f} "
              f"| {three_figures(together)} | {together / slow:.0f} |", flush=True)
    print(f"Wall-clock rate, 256 environments on {threads} threads: "
          + ", ".join(f"{name} {each}" for name, each in clocked.items()))


def compare_plan():
    print("CPU time, median of 500:")
    print("| problem | nodes | call, µs | search, µs | overhead, µs |")
    print("|---|---|---|---|---|")
    for file in ("tracking.json", "mapping.json"):
        problem = vantage.Problem(ROOT / "test/tools/problems" / file)
        for nodes in (100, 2_000):
            planner = vantage.Planner("beam", nodes=nodes)
            planner.plan(problem)
            calls = []
            for _ in range(500):
                begin = time.thread_time()
                plan = planner.plan(problem)
                controls, states, cost = plan.controls, plan.states, plan.cost
                calls.append((time.thread_time() - begin, plan.cpu_s))
                del controls, states, cost
            call, search = (1e6 * statistics.median(each) for each in zip(*calls))
            besides = 1e6 * statistics.median(a - b for a, b in calls)
            print(f"| {file} | {nodes} | {call:.1f} | {search:.1f} | {besides:.1f} |", flush=True)


def compare_trial(binary, scenario, pairs, duration_s):
    shares = []
    print("| `vantage trial`, CPU time | from Python, CPU time | speed |")
    print("|---|---|---|")
    changed = vantage.Scenario(scenario).replace(duration_s=duration_s)
    for _ in range(pairs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([binary, "trial", scenario, "--duration-s", str(duration_s), "--json"], check=True,
                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        command_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
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
    parser.add_argument("what", nargs="*", metavar="WHAT", help="what to compare: env, plan or trial")
    parser.add_argument("--seconds", type=float, default=5.0, help="s; duration of each rate measurement (default: 5)")
    parser.add_argument("--vantage", default=str(ROOT / "build/release/bin/vantage"))
    parser.add_argument("--scenario", default=str(ROOT / "config/lab.yaml"))
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--duration-s", type=float, default=60.0)
    given = parser.parse_args()
    compared = {"env": lambda: compare_env(given.seconds), "plan": compare_plan,
                "trial": lambda: compare_trial(given.vantage, given.scenario, given.pairs, given.duration_s)}
    for what in given.what:
        if what not in compared:
            parser.error(f"WHAT: must be one of {', '.join(compared)}, got {what}")
    for what in given.what or compared:
        compared[what]()


if __name__ == "__main__":
    main()
