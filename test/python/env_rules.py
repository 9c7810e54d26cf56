"""Checks every call against the rules of Gymnasium's and PettingZoo's interfaces.

The rules are those of their published checkers (gymnasium.utils.env_checker, passive_env_checker,
pettingzoo.test.parallel_api_test), written down here so that neither has to be installed.
"""
import numpy


def check_observation(test, space, observation):
    test.assertIs(type(observation), numpy.ndarray)
    test.assertEqual(observation.dtype, space.dtype)
    test.assertEqual(observation.shape, space.shape)
    test.assertTrue(observation in space)  # also finite: a Box contains no NaN


def check_number(test, reward):
    test.assertIs(type(reward), float)
    test.assertTrue(numpy.isfinite(reward))


class CheckedEnv:
    """A gymnasium.Env that checks every call."""

    def __init__(self, test, env):
        self.test, self.env = test, env
        for name in ("metadata", "render_mode", "spec", "unwrapped", "np_random", "observation_space",
                     "action_space", "close", "render"):
            test.assertTrue(hasattr(env, name), name)
        test.assertIs(env.unwrapped, env)
        test.assertIn("render_modes", env.metadata)
        low, high = env.observation_space.low, env.observation_space.high
        test.assertTrue(numpy.isfinite(low).all() and numpy.isfinite(high).all() and (low < high).all())
        self.is_over = True

    def reset(self, **arguments):
        answer = self.env.reset(**arguments)
        self.test.assertIs(type(answer), tuple)
        self.test.assertEqual(len(answer), 2)
        check_observation(self.test, self.env.observation_space, answer[0])
        self.test.assertIs(type(answer[1]), dict)
        self.is_over = False
        return answer

    def step(self, action):
        self.test.assertTrue(action in self.env.action_space)
        answer = self.env.step(action)
        self.test.assertIs(type(answer), tuple)
        self.test.assertEqual(len(answer), 5)
        observation, reward, terminated, truncated, info = answer
        check_observation(self.test, self.env.observation_space, observation)
        check_number(self.test, reward)
        self.test.assertIs(type(terminated), bool)
        self.test.assertIs(type(truncated), bool)
        self.test.assertIs(type(info), dict)
        self.is_over = terminated or truncated
        return answer


class CheckedTeam:
    """A pettingzoo.ParallelEnv that checks every call."""

    def __init__(self, test, env):
        self.test, self.env = test, env
        for name in ("metadata", "possible_agents", "num_agents", "max_num_agents", "unwrapped", "close", "render",
                     "state"):
            test.assertTrue(hasattr(env, name), name)
        test.assertIn("name", env.metadata)
        test.assertEqual(len(set(env.possible_agents)), env.max_num_agents)
        for agent in env.possible_agents:
            test.assertIs(env.observation_space(agent), env.observation_space(agent))
            test.assertIs(env.action_space(agent), env.action_space(agent))

    def reset(self, **arguments):
        answer = self.env.reset(**arguments)
        self.test.assertEqual(len(answer), 2)
        self.test.assertEqual(self.env.agents, self.env.possible_agents)
        self.check_observations(answer[0])
        self.check_keys(answer[1], self.env.agents)
        return answer

    def step(self, actions):
        alive = list(self.env.agents)
        answer = self.env.step(actions)
        self.test.assertEqual(len(answer), 5)
        observations, rewards, terminated, truncated, infos = answer
        self.check_observations(observations)
        for each in answer:
            self.check_keys(each, alive)
        for agent in alive:
            check_number(self.test, rewards[agent])
            self.test.assertIs(type(terminated[agent]), bool)
            self.test.assertIs(type(truncated[agent]), bool)
            self.test.assertIs(type(infos[agent]), dict)
        # Removes agents that have ended; no agent may return before reset().
        left = [agent for agent in alive if not (terminated[agent] or truncated[agent])]
        self.test.assertEqual(self.env.agents, left)
        self.test.assertEqual(self.env.num_agents, len(left))
        return answer

    def check_keys(self, each, agents):
        self.test.assertIs(type(each), dict)
        self.test.assertEqual(set(each), set(agents))

    def check_observations(self, observations):
        self.check_keys(observations, observations)
        for agent, observation in observations.items():
            check_observation(self.test, self.env.observation_space(agent), observation)
