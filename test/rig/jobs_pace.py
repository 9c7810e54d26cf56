#!/usr/bin/env python3
"""Measures the speed-up of an experiment with J jobs over one job (docs/guide/experiments.md):

  test/rig/jobs_pace.py VANTAGE EXPERIMENT [--trials N] [--jobs J] [--pairs P]

Runs the experiment with one job and with J jobs in turn. Prints for each pair the wall time, the CPU time,
the number of cores used by other programs, and the speed-up corrected for those programs. For the correction, the time in which a thread was
ready without a core (/proc/PID/task/*/schedstat) is subtracted from its wall time. The rest is the thread's
work and its waits for locks and, at the end, for the slowest thread."""

import argparse
import glob
import os
import statistics
import subprocess
import tempfile
import time


def busy_s():
    """Returns the CPU time of the whole machine in s."""
    with open("/proc/stat", encoding="ascii") as file:
        ticks = [int(word) for word in file.readline().split()[1:9]]
    return (sum(ticks) - ticks[3] - ticks[4]) / os.sysconf("SC_CLK_TCK")


def run(arguments, jobs):
    """Runs the experiment once. Returns (wall time in s, CPU time in s, number of cores used by other programs, core
    time in s that was available to this run)."""
    waited_s = {}
    ran_s = {}
    with tempfile.TemporaryDirectory() as folder:
        before, start = busy_s(), time.monotonic()
        process = subprocess.Popen(
            [arguments.vantage, "experiment", arguments.experiment, "--jobs", str(jobs), "--out",
             folder + "/out"] + (["--trials", arguments.trials] if arguments.trials else []),
            stdout=subprocess.DEVNULL)
        ended = 0
        while ended == 0:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            for path in glob.glob(f"/proc/{process.pid}/task/*/schedstat"):
                try:
                    with open(path, encoding="ascii") as file:
                        ran, waited, _ = file.read().split()
                    ran_s[path], waited_s[path] = int(ran) * 1e-9, int(waited) * 1e-9
                except OSError:
                    pass  # the thread has ended
            time.sleep(0.02)
        wall_s = time.monotonic() - start
        assert status == 0, "the experiment failed"
        cpu_s = usage.ru_utime + usage.ru_stime
        others = (busy_s() - before - cpu_s) / wall_s
    workers = sorted(ran_s, key=ran_s.get)[-jobs:]
    return wall_s, cpu_s, others, jobs * wall_s - sum(waited_s[path] for path in workers)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("vantage")
    parser.add_argument("experiment")
    parser.add_argument("--trials")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--pairs", type=int, default=5)
    arguments = parser.parse_args()
    paces = []
    for _ in range(arguments.pairs):
        one, many = run(arguments, 1), run(arguments, arguments.jobs)
        paces.append(arguments.jobs * one[3] / many[3])
        print(f"jobs 1 and {arguments.jobs}: wall {one[0]:.2f} and {many[0]:.2f} s, CPU {one[1]:.2f} "
              f"and {many[1]:.2f} s, other processes used {one[2]:.2f} and {many[2]:.2f} cores: "
              f"{one[0] / many[0]:.2f} times as fast, {paces[-1]:.2f} with the cores to itself",
              flush=True)
    print(f"without other load: median {statistics.median(paces):.2f}, "
          f"from {min(paces):.2f} to {max(paces):.2f}")


if __name__ == "__main__":
    main()
