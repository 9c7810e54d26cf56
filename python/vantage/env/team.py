"""Environment with one agent per robot: PettingZoo's parallel interface."""
import numpy

from . import spaces
from .picture import RENDER_MODES, require_mode
from .single import Parts, require_seed, whole_numbers

try:
    from pettingzoo import ParallelEnv as _ParallelEnv
except ImportError:
    class _ParallelEnv:
        """Replacement of pettingzoo.ParallelEnv if PettingZoo is not installed."""
        metadata = {"render_modes": []}

        @property
        def num_agents(self):
            return len(self.agents)

        @property
        def max_num_agents(self):
            return len(self.possible_agents)

        @property
        def unwrapped(self):
            return self

        def close(self):
            pass


class TeamEnv(Parts, _ParallelEnv):
    """Task as a pettingzoo.ParallelEnv: agents robot_0, robot_1, … with a common reward.

    Each agent observes float32 (D,) in [−1, 1] (observation_parts describes the entries); its action space is
    Discrete. All agents are truncated together after episode_steps. reset(seed=s) starts the same episode for
    the same s, byte for byte.
    """
    metadata = {"render_modes": RENDER_MODES, "render_fps": 2, "name": "vantage_v0", "is_parallelizable": True}

    def __init__(self, kind="tracking", render_mode=None, **options):
        self.render_mode = require_mode(render_mode)
        self._set_tasks(kind, 1, 1, options)
        self.possible_agents = [f"robot_{i}" for i in range(self.robots)]
        self.agents = []
        # The interface requires the same object at each call, because a space has its own random state.
        self.observation_spaces = {
            agent: spaces.Box(-1.0, 1.0, (self._tasks.observation_size,), numpy.float32)
            for agent in self.possible_agents}
        self.action_spaces = {agent: spaces.Discrete(self._tasks.actions) for agent in self.possible_agents}
        self._random = numpy.random.default_rng()
        self._observations = None

    def observation_space(self, agent):
        return self.observation_spaces[agent]

    def action_space(self, agent):
        return self.action_spaces[agent]

    def reset(self, seed=None, options=None):
        if seed is not None:
            seed = require_seed(seed)
            self._random = numpy.random.default_rng(seed)
        else:
            seed = self._random.integers(2**63)
        self.agents = self.possible_agents[:]
        self._observations = self._tasks.reset(numpy.array([seed], numpy.uint64))[0]
        self._show()
        return self._by_agent(self._observations), {agent: {} for agent in self.agents}

    def step(self, actions):
        """Steps with {agent: action} of all agents. Other keys are ignored, as PettingZoo's tests require."""
        if not self.agents:
            raise RuntimeError("reset() must be called before the first step() and after the end of an episode")
        try:
            chosen = whole_numbers([actions[agent] for agent in self.agents])
        except KeyError as missing:
            raise ValueError(f"actions: must contain every agent, missing {missing.args[0]}") from None
        observations, rewards, over = self._tasks.step(chosen)
        self._observations = observations[0]
        self._show()
        agents = self.agents
        reward, is_over = float(rewards[0]), bool(over[0])
        answer = (self._by_agent(self._observations), dict.fromkeys(agents, reward),
                  dict.fromkeys(agents, False), dict.fromkeys(agents, is_over),
                  {agent: {} for agent in agents})
        if is_over:
            self.agents = []
        return answer

    def state(self):
        """Returns the observations of all robots, (N · D,), for a centralised critic."""
        return self._observations.reshape(-1).copy()

    def render(self):
        """As TaskEnv.render()."""
        return self._picture()

    def _by_agent(self, observations):
        return dict(zip(self.possible_agents, observations))
