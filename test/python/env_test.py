#!/usr/bin/env python3
"""Tests the environments: the rules of their interfaces, seeds, threads, baselines, and an independent
implementation."""
import unittest

import numpy
import numpy_tasks
import vantage.env
from env_rules import CheckedEnv, CheckedTeam
from vantage.env import baselines

try:
    import gymnasium
except ImportError:
    gymnasium = None
try:
    import pettingzoo
except ImportError:
    pettingzoo = None


def bytes_of(name, seed, steps=60):
    env = vantage.env.make(name)
    random = numpy.random.default_rng(5)
    trace = [env.reset(seed=seed)[0].tobytes()]
    for _ in range(steps):
        actions = random.integers(env._tasks.actions, size=env.robots)
        observation, reward, _, is_over, _ = env.step(actions if env.robots > 1 else actions[0])
        trace += [observation.tobytes(), reward]
        if is_over:
            trace.append(env.reset()[0].tobytes())
    return trace


class Seeds(unittest.TestCase):
    def test_equal_seeds_give_equal_bytes(self):
        for name in vantage.env.tasks:
            one, again, other = (bytes_of(name, seed) for seed in (7, 7, 8))
            self.assertEqual(one, again, name)
            self.assertNotEqual(one[0], other[0], name)

    def test_later_episodes_depend_on_the_first_seed(self):
        firsts = []
        for _ in range(2):
            env = vantage.env.make("TargetTracking")
            env.reset(seed=3)
            firsts.append([env.reset()[0].tobytes() for _ in range(3)])
        self.assertEqual(firsts[0], firsts[1])
        self.assertEqual(len(set(firsts[0])), 3)

    def test_team_and_single_agent_tasks_agree(self):
        single, team = vantage.env.make("TeamTracking"), vantage.env.make_team("TeamTracking")
        together, _ = single.reset(seed=11)
        apart, _ = team.reset(seed=11)
        for _ in range(50):
            for i, agent in enumerate(team.possible_agents):
                self.assertEqual(together[i].tobytes(), apart[agent].tobytes())
            actions = numpy.random.default_rng(1).integers(10, size=3)
            together, reward, _, _, _ = single.step(actions)
            apart, rewards, _, _, _ = team.step(dict(zip(team.possible_agents, actions)))
            self.assertEqual(set(rewards.values()), {reward})

    def test_vector_is_independent_of_its_threads(self):
        for name in ("ResilientTracking", "TeamMapping"):
            traces = []
            for threads in (1, 2, 5):
                env = vantage.env.make_vector(name, 7, threads, episode_steps=20)
                random = numpy.random.default_rng(2)
                trace = [env.reset(seed=4)[0].tobytes()]
                for _ in range(50):  # more than two episodes
                    observations, rewards, _, truncated, _ = env.step(
                        random.integers(env._tasks.actions, size=env.action_space.shape))
                    trace += [observations.tobytes(), rewards.tobytes(), truncated.tobytes()]
                traces.append(trace)
            self.assertEqual(traces[0], traces[1])
            self.assertEqual(traces[0], traces[2])

    def test_vector_equals_single_environments(self):
        vector = vantage.env.make_vector("TargetTracking", 3, 2)
        observations, _ = vector.reset(seed=20)
        for i in range(3):
            self.assertEqual(observations[i].tobytes(),
                             vantage.env.make("TargetTracking").reset(seed=20 + i)[0].tobytes())
        listed, _ = vector.reset(seed=[22, 21, 20])
        self.assertEqual(listed[0].tobytes(), observations[2].tobytes())

    def test_invalid_seeds_are_refused(self):
        env = vantage.env.make("TargetTracking")
        for seed in (-1, 1.5, "a", 2**64, True):
            with self.assertRaises(Exception, msg=seed) as refusal:
                env.reset(seed=seed)
            self.assertIsInstance(refusal.exception, (ValueError, TypeError) + (
                (gymnasium.error.Error,) if gymnasium else ()))


class Rules(unittest.TestCase):
    def test_are_obeyed_in_two_episodes(self):
        for name in vantage.env.tasks:
            env = CheckedEnv(self, vantage.env.make(name, episode_steps=30))
            env.reset(seed=1, options={})
            for _ in range(2):
                steps = 0
                while not env.is_over:
                    env.step(env.env.action_space.sample())
                    steps += 1
                self.assertEqual(steps, 30)
                with self.assertRaises(RuntimeError):
                    env.env.step(env.env.action_space.sample())
                env.reset()
            team = CheckedTeam(self, vantage.env.make_team(name, episode_steps=30))
            team.reset(seed=0, options={"options": 1})
            steps = 0
            while team.env.agents:
                team.step({agent: team.env.action_space(agent).sample() for agent in team.env.agents})
                self.assertTrue(numpy.isfinite(team.env.state()).all())
                steps += 1
            self.assertEqual(steps, 30)
            with self.assertRaises(RuntimeError):
                team.env.step({})

    def test_checker_detects_a_violation(self):
        class Wrong(vantage.env.TaskEnv):
            def step(self, action):
                observation, reward, terminated, truncated, info = super().step(action)
                return 3 * observation, reward, terminated, truncated, info
        env = CheckedEnv(self, Wrong())
        env.reset(seed=1)
        with self.assertRaises(self.failureException):
            for _ in range(20):
                env.step(0)

    def test_invalid_actions_are_refused(self):
        env = vantage.env.make("TargetTracking")
        env.reset(seed=1)
        for action in (10, -1, [1, 2]):
            with self.assertRaises(vantage.UsageError):
                env.step(action)
        for action in (3.7, float("nan"), "3", None, True):
            with self.assertRaisesRegex(ValueError, "must be whole numbers", msg=action):
                env.step(action)
        env.step(3.0)
        team = vantage.env.make_team("TeamTracking")
        team.reset(seed=1)
        with self.assertRaisesRegex(ValueError, "missing robot_2"):
            team.step({"robot_0": 0, "robot_1": 0})

    def test_invalid_options_are_refused(self):
        for options, words in (({"robot": 3}, "unknown option robot; valid options are robots"),
                               ({"robots": 0}, "robots: must be ≥ 1"),
                               ({"targets": 2.5}, "targets: must be a whole number, got 2.5"),
                               ({"attacks": 2}, "attacks: must be ≥ 0 and ≤ robots \\(1\\), got 2"),
                               ({"attacker": "evil"}, "attacker: must be one of"),
                               ({"side_m": float("nan")}, "side_m: must be")):
            with self.assertRaisesRegex(vantage.UsageError, words):
                vantage.env.make("TargetTracking", **options)
        with self.assertRaisesRegex(ValueError, "name: must be one of TargetTracking"):
            vantage.env.make("Tracking")
        with self.assertRaisesRegex(vantage.UsageError, "world: must be one of pillars"):
            vantage.env.make("Exploration", world="forest")

    @unittest.skipUnless(gymnasium, "gymnasium is not installed")
    def test_gymnasium_checker_passes(self):
        from gymnasium.utils.env_checker import check_env
        for name in vantage.env.tasks:
            check_env(vantage.env.make(name), skip_render_check=True)
            env = gymnasium.make(f"vantage/{name}-v0")
            env.reset(seed=1)
            env.step(env.action_space.sample())
            vector = gymnasium.make_vec(f"vantage/{name}-v0", num_envs=3)
            vector.reset(seed=1)
            vector.step(vector.action_space.sample())

    @unittest.skipUnless(pettingzoo, "pettingzoo is not installed")
    def test_pettingzoo_checker_passes(self):
        from pettingzoo.test import parallel_api_test, parallel_seed_test
        for name in vantage.env.tasks:
            parallel_api_test(vantage.env.make_team(name), num_cycles=250)
            parallel_seed_test(lambda name=name: vantage.env.make_team(name))


class Task(unittest.TestCase):
    def test_observation_contains_the_beliefs(self):
        env = vantage.env.make("TeamTracking")
        observation, _ = env.reset(seed=2)
        known = env.snapshot()
        parts = env.parts(observation[1])
        self.assertEqual(parts["self"].shape, (5,))
        self.assertEqual(parts["teammates"].shape, (2, 4))
        self.assertEqual(parts["targets"].shape, (8, 6))
        x, y, yaw = known["poses"][1]
        numpy.testing.assert_allclose(parts["self"], [(x - 20) / 20, (y - 20) / 20, numpy.cos(yaw), numpy.sin(yaw), 0],
                                      atol=1e-6)
        turn = numpy.array([[numpy.cos(yaw), numpy.sin(yaw)], [-numpy.sin(yaw), numpy.cos(yaw)]])
        numpy.testing.assert_allclose(parts["targets"][:, :2],
                                      (known["means"][:, :2] - (x, y)) @ turn.T / (20 * 8**0.5), atol=1e-6)
        entropies = [vantage.entropy_nats(covariance) for covariance in known["covariances"]]
        numpy.testing.assert_allclose(parts["targets"][:, 4], numpy.clip(numpy.array(entropies) / 10, -1, 1), atol=1e-6)
        self.assertAlmostEqual(known["entropy_nats"], numpy.mean(entropies))
        _, reward, _, _, _ = env.step([0, 0, 0])
        self.assertAlmostEqual(reward, -env.snapshot()["entropy_nats"])

    def test_mapping_reward_is_the_information_gain(self):
        env = vantage.env.make("TeamMapping", attacks=1, attack_period_steps=3)
        env.reset(seed=2)

        def entropy(p):
            p = numpy.clip(p, 0.01005, 0.98995)  # a settled cell keeps the clamp's entropy, 4.595
            p = numpy.where(p <= 0.0101, 1 / (1 + numpy.exp(4.595)), numpy.where(p >= 0.98990, 1 / (1 + numpy.exp(-4.595)), p))
            return -(p * numpy.log(p) + (1 - p) * numpy.log(1 - p)).sum()
        before = env.snapshot()
        self.assertAlmostEqual(before["entropy_nats"], entropy(before["map"]), delta=1e-3)
        for _ in range(30):
            _, reward, _, _, _ = env.step(env.action_space.sample())
            after = env.snapshot()
            self.assertAlmostEqual(reward, before["entropy_nats"] - after["entropy_nats"], delta=1e-9)
            self.assertAlmostEqual(after["entropy_nats"], entropy(after["map"]), delta=1e-3)
            self.assertEqual(after["jammed"].sum(), 1)
            before = after

    def test_patch_observation_shows_the_nearby_map(self):
        env = vantage.env.make("Exploration", patch_cells=8)
        observation, _ = env.reset(seed=3)
        known = env.snapshot()
        patch = env.parts(observation)["map"]
        column, row = numpy.floor(known["poses"][0, :2] / known["map_resolution_m"]).astype(int)
        numpy.testing.assert_allclose(patch, 2 * known["map"][row - 4:row + 4, column - 4:column + 4] - 1, atol=1e-6)

    def test_jams_the_stated_number_of_robots(self):
        for attacker in ("greedy", "random"):
            env = vantage.env.make("ResilientTracking", attacker=attacker, attack_period_steps=5)
            env.reset(seed=1)
            chosen = set()
            for _ in range(60):
                env.step(env.action_space.sample())
                jammed = env.snapshot()["jammed"]
                self.assertEqual(jammed.sum(), 2)
                chosen.add(tuple(jammed))
            self.assertGreater(len(chosen), 1)
        worse, better = (numpy.mean([baselines.evaluate(
            env, baselines.Random(env), episodes=5).mean()]) for env in (
                vantage.env.make("ResilientTracking", attacks=4), vantage.env.make("ResilientTracking", attacks=0)))
        self.assertLess(worse, better)

    def test_keeps_robots_inside(self):
        for name in ("TargetTracking", "Exploration"):
            env = vantage.env.make(name)
            side_m = 40 if name == "TargetTracking" else 16
            env.reset(seed=1)
            for _ in range(100):
                env.step(5 if name == "TargetTracking" else 10)  # straight ahead at full speed
                x, y, _ = env.snapshot()["poses"][0]
                self.assertTrue(0.19 <= x <= side_m - 0.19 and 0.19 <= y <= side_m - 0.19)


class Baselines(unittest.TestCase):
    def test_planning_baselines_beat_random_actions(self):
        env = vantage.env.make("TargetTracking", episode_steps=100)
        chance, greedy, arvi, beam = (baselines.evaluate(env, policy, episodes=6).mean() for policy in (
            baselines.Random(env), baselines.Planner(env, "greedy"), baselines.Planner(env, "arvi"),
            baselines.Planner(env)))
        self.assertGreater(arvi, max(greedy, chance))
        self.assertGreater(beam, chance + 1.5)
        env = vantage.env.make("TeamMapping", episode_steps=40)
        chance, forward = (baselines.evaluate(env, policy, episodes=2).mean() for policy in (
            baselines.Random(env), baselines.Planner(env, "forward", horizon_steps=3)))
        self.assertGreater(forward, 1.2 * chance)

    def test_both_interfaces_give_equal_results(self):
        for name in ("TeamTracking", "TeamMapping"):
            results = []
            for env in (vantage.env.make(name, episode_steps=12), vantage.env.make_team(name, episode_steps=12)):
                results.append(baselines.evaluate(env, baselines.Planner(env, "greedy"), episodes=2, seed=4).tolist())
            self.assertEqual(results[0], results[1])

    def test_refuse_unsupported_options(self):
        with self.assertRaisesRegex(vantage.UsageError, "algorithm: must be forward for mapping, got arvi"):
            baselines.Planner(vantage.env.make("Exploration"), "arvi")
        with self.assertRaisesRegex(ValueError, "replan_steps"):
            baselines.Planner(vantage.env.make("TargetTracking"), replan_steps=0)


class SecondOpinion(unittest.TestCase):
    """Independent versions of the tasks in plain numpy give the same rewards up to random differences."""

    def compare(self, env, task, episodes, steps):
        means = []
        for which in ("library", "numpy"):
            rewards = []
            for episode in range(episodes):
                random = numpy.random.default_rng(1000 + episode)
                total = 0.0
                (env if which == "library" else task).reset(**(
                    {"seed": episode} if which == "library" else {"seed": 50_000 + episode}))
                for _ in range(steps):
                    action = random.integers(env._tasks.actions, size=env.robots)
                    if which == "library":
                        total += env.step(action if env.robots > 1 else action[0])[1]
                    else:
                        total += task.step(action)[1]
                rewards.append(total / steps)
            means.append((numpy.mean(rewards), numpy.std(rewards, ddof=1) / len(rewards)**0.5))
        (one, one_error), (other, other_error) = means
        self.assertLess(abs(one - other), 4 * numpy.hypot(one_error, other_error), means)
        self.assertLess(numpy.hypot(one_error, other_error), 0.15 * max(1.0, abs(one)))

    def test_tracking_rewards_agree(self):
        self.compare(vantage.env.make("TeamTracking"), numpy_tasks.Tracking(3, 8), episodes=80, steps=60)

    def test_mapping_rewards_agree(self):
        self.compare(vantage.env.make("TeamMapping"), numpy_tasks.Mapping(numpy_tasks.pillars(), 3),
                     episodes=60, steps=12)

    def test_observations_agree(self):
        for env, task in ((vantage.env.make("TeamTracking"), numpy_tasks.Tracking(3, 8)),
                          (vantage.env.make("TeamMapping"), numpy_tasks.Mapping(numpy_tasks.pillars(), 3))):
            self.assertEqual(env.reset(seed=0)[0].shape, task.reset(0).shape)


if __name__ == "__main__":
    unittest.main()
