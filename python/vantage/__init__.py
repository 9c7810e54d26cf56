"""vantage: active information acquisition with teams of robots.

Plans      Problem, Planner, Plan, plan(), algorithms()
Teams      decide(), Decision, team_algorithms(): joint plans of a team of robots
Trials     Scenario, Trial: the complete stack in virtual time, step by step; sweep(): many trials
Logs       Log, and its result logs.Columns
Live       vantage.live: subscribe and publish on the running system's channels, in a node of 20 lines
Own        vantage.own: target models, costs, filters and planners written in Python
Models     step_unicycle(), TargetModel, SensorModel, World; predict(), measure(), miss(), confine()
Learning   vantage.env: environments with the interfaces of Gymnasium and PettingZoo

Units are SI and radians, and names contain the unit. Poses are (x, y, yaw) and viewpoints
(x, y, z, yaw), in the world frame. Invalid input raises the errors of the commands: StartupError (a
file or text) or UsageError (an argument). Both are ValueErrors.

    import vantage
    print(vantage.plan("problem.json", nodes=100_000).cost)
"""
from . import live, logs, own
from ._sweep import sweep
from ._vantage import (
    Decision, Plan, Planner, Problem, Scenario, SensorModel, StartupError, TargetModel, Trial, UsageError, World,
    __version__, algorithms, confine, decide, entropy_nats, lab_primitives, log_det, measure, miss, plan, predict,
    standard_primitives, step_unicycle, team_algorithms)
from .logs import Log

__all__ = [
    "Decision", "Log", "Plan", "Planner", "Problem", "Scenario", "SensorModel", "StartupError", "TargetModel", "Trial",
    "UsageError", "World", "algorithms", "confine", "decide", "entropy_nats", "lab_primitives", "live", "log_det",
    "logs", "measure", "miss", "own", "plan", "predict", "standard_primitives", "step_unicycle", "sweep",
    "env", "team_algorithms"]


def __getattr__(name):
    if name == "env":  # imported at its first use, because it needs numpy's random generators
        import importlib

        return importlib.import_module(".env", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
