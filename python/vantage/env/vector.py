"""Many tasks on several threads: Gymnasium's vector interface."""
import os

import numpy

from . import spaces
from .picture import RENDER_MODES, require_mode
from .single import Parts, require_seed, whole_numbers

try:
    from gymnasium.vector import VectorEnv as _VectorEnv
except ImportError:
    class _VectorEnv:
        """Replacement of gymnasium.vector.VectorEnv if Gymnasium is not installed."""
        metadata = {}
        spec = None
        render_mode = None
        closed = False

        @property
        def unwrapped(self):
            return self

        def close(self, **options):
            self.closed = True

        def __enter__(self):
            return self

        def __exit__(self, *error):
            self.close()
            return False

try:
    from gymnasium.vector import AutoresetMode
    _NEXT_STEP = AutoresetMode.NEXT_STEP
except ImportError:
    _NEXT_STEP = "NextStep"


class TaskVectorEnv(Parts, _VectorEnv):
    """`num_envs` tasks, stepped together without the interpreter's lock, on `threads` threads (None: one per core).

    Observations (num_envs, D) for one robot, (num_envs, N, D) for a team; actions (num_envs,) or
    (num_envs, N). After an episode's last step the next step() starts a new episode of that task, ignores the
    action and gives reward 0 (Gymnasium's AutoresetMode.NEXT_STEP). reset(seed=s) gives task i the seed s + i,
    or takes a list of seeds, which determine the seeds of later episodes. The results do not depend on the number
    of threads.
    """

    def __init__(self, kind="tracking", num_envs=1, threads=None, render_mode=None, **options):
        self.render_mode = require_mode(render_mode)
        threads = len(os.sched_getaffinity(0)) if threads is None else threads
        self._set_tasks(kind, num_envs, min(threads, num_envs), options)
        self.metadata = {"render_modes": RENDER_MODES, "render_fps": 2, "autoreset_mode": _NEXT_STEP}
        self.num_envs = num_envs
        size, actions = self._tasks.observation_size, self._tasks.actions
        one = (size,) if self.robots == 1 else (self.robots, size)
        self.single_observation_space = spaces.Box(-1.0, 1.0, one, numpy.float32)
        self.observation_space = spaces.Box(-1.0, 1.0, (num_envs, *one), numpy.float32)
        if self.robots == 1:
            self.single_action_space = spaces.Discrete(actions)
            self.action_space = spaces.MultiDiscrete([actions] * num_envs)
        else:
            self.single_action_space = spaces.MultiDiscrete([actions] * self.robots)
            self.action_space = spaces.MultiDiscrete(numpy.full((num_envs, self.robots), actions))
        self._random = numpy.random.default_rng()
        self._never = numpy.zeros(num_envs, bool)

    def reset(self, *, seed=None, options=None):
        if seed is None:
            seeds = self._random.integers(2**63, size=self.num_envs, dtype=numpy.uint64)
        elif isinstance(seed, (list, tuple, numpy.ndarray)):
            if len(seed) != self.num_envs:
                raise ValueError(f"seed: must be one number or a list of {self.num_envs}, got {len(seed)}")
            drawn = self._random.integers(2**63, size=self.num_envs, dtype=numpy.uint64)
            seeds = [drawn[i] if each is None else require_seed(each) for i, each in enumerate(seed)]
        else:
            self._random = numpy.random.default_rng(require_seed(seed))
            seeds = [(int(seed) + i) % 2**64 for i in range(self.num_envs)]
        observations = self._tasks.reset(numpy.array(seeds, numpy.uint64))
        self._show()
        return observations.reshape(self.observation_space.shape), {}

    def step(self, actions):
        observations, rewards, over = self._tasks.step(whole_numbers(actions))
        self._show()
        return observations.reshape(self.observation_space.shape), rewards, self._never.copy(), over, {}

    def render(self):
        """Returns the pictures of all tasks as a tuple in mode rgb_array. Mode human shows the first task."""
        if self.render_mode != "rgb_array":
            return self._picture()
        first = self._picture()
        return (first, *(self._pictures.array(i) for i in range(1, self.num_envs)))
