"""vantage: active information acquisition by teams of robots.

Plans      Problem, Planner, Plan, plan(), algorithms()
Trials     Scenario, Trial: the whole stack in virtual time, step by step
Logs       Log, and what it gives, logs.Columns
Models     step_unicycle(), TargetModel, SensorModel, World; predict(), measure(), miss(), confine()
Learning   vantage.env: environments with the interfaces of Gymnasium and PettingZoo

SI units and radians, a unit in each name; poses are (x, y, yaw), viewpoints (x, y, z, yaw), in the
world's frame. What cannot be is refused as the commands do, as StartupError (a file or text) or
UsageError (an argument), both ValueErrors.

    import vantage
    print(vantage.plan("problem.json", nodes=100_000).cost)
"""
from . import logs
from ._vantage import (
    Plan, Planner, Problem, Scenario, SensorModel, StartupError, TargetModel, Trial, UsageError, World,
    __version__, algorithms, confine, entropy_nats, lab_primitives, log_det, measure, miss, plan, predict,
    standard_primitives, step_unicycle)
from .logs import Log

__all__ = [
    "Log", "Plan", "Planner", "Problem", "Scenario", "SensorModel", "StartupError", "TargetModel", "Trial",
    "UsageError", "World", "algorithms", "confine", "entropy_nats", "lab_primitives", "log_det", "logs",
    "measure", "miss", "plan", "predict", "standard_primitives", "step_unicycle"]
