#!/usr/bin/env python3
"""VANTAGE_ENV_STEPS random steps of each environment obey the rules of its interface."""
import os
import unittest

import numpy
import vantage.env
from env_rules import CheckedEnv, CheckedTeam, check_observation

STEPS = int(os.environ.get("VANTAGE_ENV_STEPS", "20000"))


class RandomSteps(unittest.TestCase):
    def test_gymnasium_environments_obey_the_rules(self):
        for name in vantage.env.tasks:
            with self.subTest(name=name):
                env = CheckedEnv(self, vantage.env.make(name))
                env.env.action_space.seed(1)
                env.reset(seed=1)
                for _ in range(STEPS):
                    if env.is_over:
                        env.reset()
                    env.step(env.env.action_space.sample())

    def test_pettingzoo_environments_obey_the_rules(self):
        for name in vantage.env.tasks:
            with self.subTest(name=name):
                env = CheckedTeam(self, vantage.env.make_team(name))
                for i, agent in enumerate(env.env.possible_agents):
                    env.env.action_space(agent).seed(i)
                env.reset(seed=1)
                for _ in range(STEPS // env.env.max_num_agents):
                    if not env.env.agents:
                        env.reset()
                    env.step({agent: env.env.action_space(agent).sample() for agent in env.env.agents})

    def test_gymnasium_vectors_obey_the_rules(self):
        count = 50
        for name in vantage.env.tasks:
            with self.subTest(name=name):
                env = vantage.env.make_vector(name, count, threads=2)
                env.action_space.seed(1)
                check_observation(self, env.observation_space, env.reset(seed=1)[0])
                was_over = numpy.zeros(count, bool)
                for _ in range(STEPS // count):
                    observations, rewards, terminated, truncated, infos = env.step(env.action_space.sample())
                    check_observation(self, env.observation_space, observations)
                    self.assertTrue(numpy.isfinite(rewards).all() and rewards.shape == (count,))
                    self.assertTrue((rewards[was_over] == 0.0).all())  # a restart has reward 0
                    self.assertFalse((truncated & was_over).any())
                    self.assertFalse(terminated.any())
                    self.assertEqual(infos, {})
                    was_over = truncated


if __name__ == "__main__":
    unittest.main()
