"""Gymnasium's spaces if Gymnasium is installed, else the subset that the environments need."""
import numpy

try:
    from gymnasium.spaces import Box, Discrete, MultiDiscrete
except ImportError:
    class _Space:
        """Base of a set of values: shape, dtype, sample(), contains()."""

        def __init__(self, shape, dtype, seed=None):
            self.shape = shape
            self.dtype = numpy.dtype(dtype)
            self.seed(seed)

        def seed(self, seed=None):
            self._random = numpy.random.default_rng(seed)
            return [seed]

        @property
        def np_random(self):
            return self._random

        def __contains__(self, value):
            return self.contains(value)

    class Box(_Space):
        """Arrays of one shape with entries in [low, high]."""

        def __init__(self, low, high, shape, dtype=numpy.float32, seed=None):
            super().__init__(tuple(shape), dtype, seed)
            self.low = numpy.full(self.shape, low, self.dtype)
            self.high = numpy.full(self.shape, high, self.dtype)

        def sample(self):
            return self._random.uniform(self.low, self.high).astype(self.dtype)

        def contains(self, value):
            return (isinstance(value, numpy.ndarray) and value.shape == self.shape
                    and numpy.can_cast(value.dtype, self.dtype)
                    and bool(numpy.all(value >= self.low) and numpy.all(value <= self.high)))

        def __eq__(self, other):
            return (isinstance(other, Box) and self.dtype == other.dtype
                    and numpy.array_equal(self.low, other.low) and numpy.array_equal(self.high, other.high))

        def __repr__(self):
            return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"

    class Discrete(_Space):
        """Whole numbers 0 … n − 1."""

        def __init__(self, n, seed=None):
            super().__init__((), numpy.int64, seed)
            self.n = numpy.int64(n)

        def sample(self):
            return numpy.int64(self._random.integers(self.n))

        def contains(self, value):
            if isinstance(value, numpy.ndarray) and value.shape != ():
                return False
            kind = numpy.asarray(value).dtype.kind
            return kind in "iu" and 0 <= int(value) < self.n

        def __eq__(self, other):
            return isinstance(other, Discrete) and self.n == other.n

        def __repr__(self):
            return f"Discrete({self.n})"

    class MultiDiscrete(_Space):
        """Arrays of whole numbers; entry i is in 0 … nvec[i] − 1."""

        def __init__(self, nvec, seed=None):
            self.nvec = numpy.asarray(nvec, numpy.int64)
            super().__init__(self.nvec.shape, numpy.int64, seed)

        def sample(self):
            return self._random.integers(self.nvec).astype(self.dtype)

        def contains(self, value):
            return (isinstance(value, numpy.ndarray) and value.shape == self.shape and value.dtype.kind in "iu"
                    and bool(numpy.all(value >= 0) and numpy.all(value < self.nvec)))

        def __eq__(self, other):
            return isinstance(other, MultiDiscrete) and numpy.array_equal(self.nvec, other.nvec)

        def __repr__(self):
            return f"MultiDiscrete({self.nvec})"

__all__ = ["Box", "Discrete", "MultiDiscrete"]
