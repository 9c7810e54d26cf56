"""Environments for reinforcement learning, based on the stack's own models and filters.

    make(name, **options)         gymnasium.Env: one agent controls all robots
    make_team(name, **options)    pettingzoo.ParallelEnv: one agent per robot
    make_vector(name, num_envs)   gymnasium.vector.VectorEnv: many tasks in parallel on several threads

Neither package needs to be installed. If Gymnasium is installed,
gymnasium.make("vantage/TargetTracking-v0") also works after import vantage.env. `tasks` contains the
tasks and their options.

Tracking: targets are double integrators in a square field; the team shares one extended Kalman filter
per target. Reward: negative mean entropy of the targets, nats. Options: robots, targets, side_m,
start_side_m, q_m2ps3, step_s, prior_position_sigma_m, prior_velocity_sigma_mps, detection_probability,
range_max_m, range_sigma_m, fov_deg, bearing_sigma_deg.
Mapping: robots with range finders explore an unknown world. Reward: decrease of the map's entropy, nats.
Options: robots, world (pillars or corridors), side_m, patch_cells.
Both: episode_steps; attacks (number of robots whose sensors are jammed simultaneously), attack_period_steps
(steps until other robots are jammed), attacker (greedy: jams the robots that observed most; random).
"""
from . import baselines
from .single import TaskEnv
from .team import TeamEnv
from .vector import TaskVectorEnv

tasks = {
    "TargetTracking": ("tracking", {"robots": 1, "targets": 5}),
    "TeamTracking": ("tracking", {"robots": 3, "targets": 8}),
    "ResilientTracking": ("tracking", {"robots": 5, "targets": 8, "attacks": 2}),
    "Exploration": ("mapping", {"robots": 1}),
    "TeamMapping": ("mapping", {"robots": 3}),
    "ResilientMapping": ("mapping", {"robots": 4, "attacks": 1}),
}
"""{name of the task: (kind, options that differ from the defaults of the kind)}."""


def _task(name, options):
    if name not in tasks:
        raise ValueError(f"name: must be one of {', '.join(tasks)}, got {name}")
    kind, own = tasks[name]
    return {"kind": kind, **own, **options}


def make(name, **options):
    """Returns the task as a TaskEnv; `options` override the task's options."""
    return TaskEnv(**_task(name, options))


def make_team(name, **options):
    """Returns the task as a TeamEnv; `options` override the task's options."""
    return TeamEnv(**_task(name, options))


def make_vector(name, num_envs, threads=None, **options):
    """Returns `num_envs` copies of the task as a TaskVectorEnv; `options` override the task's options."""
    return TaskVectorEnv(num_envs=num_envs, threads=threads, **_task(name, options))


def _register():
    try:
        import gymnasium
    except ImportError:
        return
    for name, (kind, options) in tasks.items():
        gymnasium.register(id=f"vantage/{name}-v0", entry_point="vantage.env:TaskEnv",
                           vector_entry_point="vantage.env:TaskVectorEnv",
                           kwargs={"kind": kind, **options})


_register()

__all__ = ["TaskEnv", "TaskVectorEnv", "TeamEnv", "baselines", "make", "make_team", "make_vector", "tasks"]
