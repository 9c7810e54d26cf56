"""Trial after trial over values of a scenario's options and seeds."""
import concurrent.futures
import itertools
import os
import threading

import numpy

from ._vantage import Scenario, Trial, UsageError

_KEYS = ("duration_s", "planner", "communication_range_m", "node_budget")


class _Stopped(Exception):
    """Raised within a trial that nobody waits for any more."""


def sweep(scenario, parameters, seeds, *, threads=None, progress=None):
    """Whole trials of all combinations of values and seeds, as columns of numpy.

    sweep(scenario, {"node_budget": [200, 2000]}, seeds=range(10)): `scenario` as of Trial; the keys of
    `parameters` are those of Scenario.replace(), the values lists; the seeds come last, and fastest. It
    gives a dict with a row a trial in each column: the keys, seed, and every number of Trial.metrics
    by its name there ("rmse_m", "per_robot.entropy", …), nan where there is none; lists are left out.
    To the bit the same whatever the number of `threads` (default: one a core). progress(share) is
    called by the caller's thread after each trial.

    Everything is read before anything flies. What ends a sweep early, Ctrl-C among it, or what a trial or
    `progress` raises, has the rows of the trials that had ended, in order, as its attribute `columns`;
    trials on their way are given up within half a second of theirs:

        try:
            columns = vantage.sweep(…)
        except KeyboardInterrupt as stopped:
            columns = stopped.columns
    """
    if not isinstance(scenario, Scenario):
        scenario = Scenario(scenario)
    rows = _rows(parameters, seeds)
    scenarios = [scenario.replace(**row) for row in rows]
    threads = len(os.sched_getaffinity(0)) if threads is None else threads
    if threads < 1:
        raise UsageError(f"threads: must be ≥ 1, got {threads}")
    stop = threading.Event()

    def go_on(share):
        if stop.is_set():
            raise _Stopped

    def fly(own):
        go_on(0.0)
        trial = Trial(own)
        trial.run(go_on)
        return trial.metrics

    pool = concurrent.futures.ThreadPoolExecutor(threads)
    flights = []
    try:
        flights += [pool.submit(fly, own) for own in scenarios]
        for ended, flight in enumerate(concurrent.futures.as_completed(flights), 1):
            flight.result()
            if progress is not None:
                progress(ended / len(rows))
    except BaseException as error:
        stop.set()
        pool.shutdown(cancel_futures=True)
        done = [i for i, flight in enumerate(flights) if not flight.cancelled() and flight.exception() is None]
        error.columns = _columns(parameters, [rows[i] for i in done], [flights[i].result() for i in done])
        raise
    pool.shutdown()
    return _columns(parameters, rows, [flight.result() for flight in flights])


def _rows(parameters, seeds):
    """What each trial replaces of the scenario."""
    for key, values in parameters.items():
        if key not in _KEYS:
            raise UsageError(f"parameters: unknown key {key}; known here are {', '.join(_KEYS)}")
        if isinstance(values, str) or not numpy.iterable(values):
            raise UsageError(f"parameters: {key}: must be a list of values, got {values}")
    if not numpy.iterable(seeds):
        raise UsageError(f"seeds: must be a list of whole numbers, got {seeds}")
    keys = [*parameters, "seed"]
    rows = [dict(zip(keys, values)) for values in itertools.product(*parameters.values(), seeds)]
    if not rows:
        raise UsageError("parameters, seeds: must have one value at least each")
    return rows


def _numbers(metrics, before=""):
    """{name: number or None} of what the metrics say, lists and text left out."""
    out = {}
    for name, value in metrics.items():
        if isinstance(value, dict):
            out.update(_numbers(value, before + name + "."))
        elif value is None or isinstance(value, (int, float)):
            out[before + name] = value
    return out


def _columns(parameters, rows, metrics):
    columns = {key: numpy.array([row[key] for row in rows]) for key in (*parameters, "seed")}
    numbers = [_numbers(each) for each in metrics]
    for name in numbers[0] if numbers else ():
        values = [each[name] for each in numbers]
        columns.setdefault(name, numpy.array([numpy.nan if value is None else value for value in values]))
    return columns
