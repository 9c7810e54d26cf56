"""Trials over combinations of scenario options and seeds."""
import concurrent.futures
import itertools
import json
import os
import threading

import numpy

from ._vantage import Scenario, Trial, UsageError

_KEYS = ("duration_s", "planner", "communication_range_m", "node_budget")


class _Stopped(Exception):
    """Exception raised in a trial that was cancelled."""


def sweep(scenario, parameters, seeds, *, threads=None, progress=None):
    """Runs a trial for every combination of values and seeds; returns columns of numpy arrays.

    sweep(scenario, {"node_budget": [200, 2000]}, seeds=range(10)): `scenario` as for Trial. The keys of
    `parameters` are options of Scenario.replace() or full paths of scenario keys
    ("robot_defaults.sensor.range_sigma_m"), the values are lists. Seeds vary fastest. The result is a
    dict with one row per trial in each column: the keys, seed, and every number of Trial.metrics under its
    name ("rmse_m", "per_robot.entropy", …), nan if absent; lists are omitted. The result is bit-identical
    for any number of `threads` (default: one per core). The calling thread calls progress(share) after
    each trial.

    All arguments are checked before the first trial starts. A sweep ends early after Ctrl-C or an exception of
    a trial or of `progress`. The exception's attribute `columns` then contains the rows of the completed
    trials, in order; running trials are cancelled within 0.5 s of trial time:

        try:
            columns = vantage.sweep(…)
        except KeyboardInterrupt as stopped:
            columns = stopped.columns
    """
    if not isinstance(scenario, Scenario):
        scenario = Scenario(scenario)
    rows = _rows(parameters, seeds)
    scenarios = [_scenario_of(scenario, row) for row in rows]
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


def _scenario_of(scenario, row):
    """Returns the scenario of one trial. JSON values are valid YAML."""
    options = {key: value for key, value in row.items() if "." not in key}
    return scenario.replace(**options, keys={key: json.dumps(_plain(value)) for key, value in row.items() if "." in key})


def _plain(value):
    return value.tolist() if isinstance(value, (numpy.generic, numpy.ndarray)) else value


def _rows(parameters, seeds):
    """Returns the option or key and its value, for each trial."""
    for key, values in parameters.items():
        if key not in _KEYS and "." not in key:
            raise UsageError(f"parameters: unknown key {key}; valid keys are {', '.join(_KEYS)} and full paths such as "
                             "planner.separation_m")
        if isinstance(values, str) or not numpy.iterable(values):
            raise UsageError(f"parameters: {key}: must be a list of values, got {values}")
    if not numpy.iterable(seeds):
        raise UsageError(f"seeds: must be a list of whole numbers, got {seeds}")
    keys = [*parameters, "seed"]
    rows = [dict(zip(keys, values)) for values in itertools.product(*parameters.values(), seeds)]
    if not rows:
        raise UsageError("parameters, seeds: each must have at least one value")
    return rows


def _numbers(metrics, before=""):
    """Returns {name: number or None} of the metrics without lists and text."""
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
