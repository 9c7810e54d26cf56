"""Environment with one agent for all robots: Gymnasium's interface."""
import numpy

from .. import _vantage
from . import spaces
from .picture import RENDER_MODES, Pictures, require_mode

try:
    from gymnasium import Env as _Env
except ImportError:
    class _Env:
        """Replacement of gymnasium.Env if Gymnasium is not installed."""
        metadata = {"render_modes": []}
        render_mode = None
        spec = None

        @property
        def unwrapped(self):
            return self

        @property
        def np_random(self):
            if getattr(self, "_np_random", None) is None:
                self._np_random = numpy.random.default_rng()
            return self._np_random

        def reset(self, *, seed=None, options=None):
            if seed is not None:
                self._np_random = numpy.random.default_rng(seed)

        def close(self):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *error):
            self.close()
            return False


def require_seed(seed):
    """Returns `seed` as an int. Raises ValueError unless it is a whole number ≥ 0 and < 2**64."""
    if isinstance(seed, bool) or not isinstance(seed, (int, numpy.integer)) or not 0 <= seed < 2**64:
        raise ValueError(f"seed: must be a whole number ≥ 0 and < 2**64, got {seed!r}")
    return int(seed)


def whole_numbers(actions):
    """Returns `actions` as an array of whole numbers. Raises ValueError for other values, such as 3.7."""
    given = numpy.asarray(actions)
    if given.dtype.kind in "iu":
        return given
    if given.dtype.kind != "f" or not (numpy.isfinite(given) & (given == numpy.round(given))).all():
        raise ValueError(f"actions: must be whole numbers, got {actions!r}")
    return given.astype(numpy.int64)


class Parts:
    """Access to the parts of an observation by name, and pictures of the tasks."""

    _pictures = None

    def _set_tasks(self, kind, count, threads, options):
        self._tasks = _vantage._Tasks(kind, count, threads, options)
        self.kind = kind
        """Name of the task: tracking or mapping."""
        self.robots = self._tasks.robots
        """Number of robots."""
        self.observation_parts = {}
        """{name: (slice, shape)} of one robot's observation."""
        begin = 0
        for name, shape in self._tasks.observation_parts:
            size = int(numpy.prod(shape))
            self.observation_parts[name] = (slice(begin, begin + size), tuple(shape))
            begin += size

    def parts(self, observation):
        """Returns one robot's observation as {name: array}. The arrays are views without a copy."""
        return {name: observation[where].reshape(shape)
                for name, (where, shape) in self.observation_parts.items()}

    def snapshot(self, index=0):
        """Returns the team's current estimates in task `index`: poses (N, 3), jammed (N,), entropy_nats, steps.
        Tracking adds means (M, 4), covariances (M, 4, 4), seen (M,) and errors_m (M,) against the truth.
        Mapping adds map (rows, columns), the occupancy probabilities, and map_resolution_m.
        """
        return self._tasks.state(index)


    def _picture(self):
        """Returns the picture of render() for the mode: None, or an array (height, width, 3)."""
        if self.render_mode is None:
            return None
        if self._pictures is None:
            self._pictures = Pictures(self._tasks, f"{self.kind}, {self.robots} robots")
        if self.render_mode == "human":
            self._pictures.show()
            return None
        return self._pictures.array()

    def _show(self):
        """Updates the page in mode human; called after each reset and step."""
        if self.render_mode == "human":
            self._picture()

    def close(self, **options):
        if self._pictures is not None:
            self._pictures.close()
            self._pictures = None
        super().close(**options)


class TaskEnv(Parts, _Env):
    """Task as a gymnasium.Env: one agent chooses a control for every robot.

    Observation: float32 in [−1, 1], (D,) for one robot, (N, D) for a team; observation_parts describes the
    entries. Action: Discrete for one robot, MultiDiscrete for a team. Episodes are truncated after
    episode_steps and never terminate. reset(seed=s) starts the same episode for the same s, byte for byte.
    """
    metadata = {"render_modes": RENDER_MODES, "render_fps": 2}

    def __init__(self, kind="tracking", render_mode=None, **options):
        self.render_mode = require_mode(render_mode)
        self._set_tasks(kind, 1, 1, options)
        self._is_over = True
        self._first = (0, 0) if self.robots == 1 else 0  # index into observations (1, N, D)
        size = self._tasks.observation_size
        shape = (size,) if self.robots == 1 else (self.robots, size)
        self.observation_space = spaces.Box(-1.0, 1.0, shape, numpy.float32)
        self.action_space = (spaces.Discrete(self._tasks.actions) if self.robots == 1
                             else spaces.MultiDiscrete([self._tasks.actions] * self.robots))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        seed = self.np_random.integers(2**63) if seed is None else require_seed(seed)
        observations = self._tasks.reset(numpy.array([seed], numpy.uint64))
        self._is_over = False
        self._show()
        return observations[self._first], {}

    def step(self, action):
        if self._is_over:
            raise RuntimeError("reset() must be called before the first step() and after the end of an episode")
        observations, rewards, over = self._tasks.step(numpy.atleast_1d(whole_numbers(action)))
        self._is_over = bool(over[0])
        self._show()
        return observations[self._first], float(rewards[0]), False, self._is_over, {}

    def render(self):
        """Returns the picture that `vantage demo` draws, (height, width, 3), in mode rgb_array. In mode human a
        page shows it in the browser, and the result is None.
        """
        return self._picture()
