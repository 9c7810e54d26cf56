"""Policies without learning, as a baseline for learned policies.

    env = vantage.env.make("TargetTracking")
    policy = vantage.env.baselines.Planner(env, "beam")
    print(vantage.env.baselines.evaluate(env, policy, episodes=10).mean())
"""
import numpy

from .. import _vantage

__all__ = ["Planner", "Random", "evaluate"]


def _answer(env, actions):
    """Returns `actions`, one per robot, in the format of the environment's step()."""
    if hasattr(env, "possible_agents"):
        return dict(zip(env.possible_agents, (int(action) for action in actions)))
    return int(actions[0]) if env.robots == 1 else numpy.asarray(actions)


class Random:
    """Policy that chooses all controls with equal probability."""

    def __init__(self, env, seed=0):
        self._env = env.unwrapped
        self._random = numpy.random.default_rng(seed)

    def reset(self):
        """Must be called before each episode."""

    def act(self, observation=None):
        return _answer(self._env, self._random.integers(self._env._tasks.actions, size=self._env.robots))


class Planner:
    """The stack's planners as a policy: robots plan in order, each given the plans of the previous robots.

    algorithm: in tracking a name of vantage.algorithms() ("beam", "arvi", "greedy", …) with a budget of
    `nodes` per robot and plan; in mapping "forward", an exhaustive search over its horizon, or "greedy", the best next
    step. None: "beam" in tracking, "forward" in mapping.
    A plan is followed for replan_steps steps. The planner uses the team's beliefs (snapshot()) instead of the
    observations, which contain less information. The planner never uses the truth.
    """

    def __init__(self, env, algorithm=None, *, horizon_steps=None, nodes=20_000, replan_steps=None):
        env = env.unwrapped
        is_mapping = env.kind == "mapping"
        if algorithm is None:
            algorithm = "forward" if is_mapping else "beam"
        if is_mapping and algorithm == "greedy":
            algorithm, horizon_steps = "forward", 1
        if horizon_steps is None:
            horizon_steps = 4 if is_mapping else 12
        if replan_steps is None:
            replan_steps = horizon_steps if is_mapping else min(6, horizon_steps)
        if not 1 <= replan_steps <= horizon_steps:
            raise ValueError(f"replan_steps: must be ≥ 1 and ≤ horizon_steps ({horizon_steps}), got {replan_steps}")
        self._env = env
        self._planner = _vantage._Baseline(env._tasks, algorithm, horizon_steps, nodes)
        self._replan_steps = replan_steps
        self.reset()

    def reset(self):
        """Must be called before each episode."""
        self._plans = None
        self._step = 0

    def act(self, observation=None):
        if self._plans is None or self._step == self._replan_steps:
            self._plans = self._planner.plan(0)
            self._step = 0
        # After the end of its plan a robot uses control 0; if control 0 is blocked, the robot keeps
        # its position.
        actions = [plan[self._step] if self._step < len(plan) else 0 for plan in self._plans]
        self._step += 1
        return _answer(self._env, actions)


def evaluate(env, policy, episodes=1, seed=0):
    """Returns the mean reward per step of each episode, (episodes,). Episode i has the seed seed + i."""
    means = []
    for episode in range(episodes):
        observation, _ = env.reset(seed=seed + episode)
        policy.reset()
        rewards, is_over = [], False
        while not is_over:
            observation, reward, terminated, truncated, _ = env.step(policy.act(observation))
            if isinstance(reward, dict):
                reward, terminated, truncated = (next(iter(each.values()))
                                                 for each in (reward, terminated, truncated))
            rewards.append(reward)
            is_over = terminated or truncated
        means.append(numpy.mean(rewards))
    return numpy.array(means)
