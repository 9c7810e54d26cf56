"""LCM event logs as columns of numbers."""
import collections
import collections.abc

import numpy

from . import _vantage

__all__ = ["Columns", "Log"]


class Columns(collections.abc.Mapping):
    """Messages of one channel: a numpy array for each field of its .lcm file.

    For n messages a scalar field is (n,), a field of constant size (n, k); text has dtype object. Integers are
    int64 and floating-point numbers float64, for all widths in the message.

    Lists of variable length are concatenated: columns["segments.duration_s"] contains the segments of all
    messages; the segments of message i are offsets["segments"][i]:offsets["segments"][i + 1]. The offsets of a
    nested list count rows of the outer list. Two-dimensional lists are row-major.
    """

    def __init__(self, channel, read):
        self._values, self.offsets, self._lists, self.log_utime, self.type, self.refused = read
        self.channel = channel
        """The channel's name."""

    def __getitem__(self, field):
        try:
            return self._values[field]
        except KeyError:
            raise KeyError(f"{self.channel}: no field {field}; the fields are {', '.join(self._values)}") from None

    def __iter__(self):
        return iter(self._values)

    def __len__(self):
        """Returns the number of fields; len(columns.log_utime) is the number of messages."""
        return len(self._values)

    def row(self, field):
        """Returns, for each value of a field in a list, the index of its element or message."""
        name = self._lists[field]
        if name is None:
            return numpy.arange(len(self[field]))
        return numpy.repeat(numpy.arange(len(self.offsets[name]) - 1), numpy.diff(self.offsets[name]))

    def split(self, field):
        """Returns the values of a field in a list as one array per message or outer element."""
        name = self._lists[field]
        return numpy.split(self[field], [] if name is None else self.offsets[name][1:-1])

    def __repr__(self):
        return f"<vantage.logs.Columns {self.channel}: {len(self.log_utime)} {self.type}, {len(self)} fields>"


Channel = collections.namedtuple("Channel", "type messages first_utime last_utime")


class Log:
    """LCM event log. If the log is damaged, all intact events are read.

    log["PLAN_Q1"] reads a channel; read() reads a part of a channel. log.channels contains all channels.
    Raises StartupError if the file cannot be read.
    """

    def __init__(self, path):
        self._log = _vantage._Log(path)
        self.channels = {name: Channel(**entry) for name, entry in self._log.channels().items()}
        """{name: (type, messages, first_utime, last_utime)}; type is None unless it is one of vantage's."""

    @property
    def path(self):
        return self._log.path

    @property
    def start_utime(self):
        """Time at which the first message was logged, µs since the Unix epoch."""
        return min((each.first_utime for each in self.channels.values()), default=0)

    @property
    def damaged_bytes(self):
        """Number of bytes that belong to no event."""
        return self._log.damaged_bytes()

    def read(self, channel, from_s=None, to_s=None):
        """Returns the Columns of the messages logged in [from_s, to_s) since the log's start; None: no limit."""
        def utime(since_s):
            return None if since_s is None else self.start_utime + round(1e6 * since_s)
        return Columns(channel, self._log.read(channel, utime(from_s), utime(to_s)))

    def __getitem__(self, channel):
        return self.read(channel)

    def __iter__(self):
        return iter(self.channels)

    def __contains__(self, channel):
        return channel in self.channels

    def __len__(self):
        return len(self.channels)

    def __repr__(self):
        return f"<vantage.Log {self.path}: {len(self.channels)} channels>"
