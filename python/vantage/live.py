"""The running system's channels, read and published: any LCM type, on the stack's own transport.

    from vantage import live
    from vantage_lcm import measurement_t

    node = live.Node("DETECTOR", scenario="lab")
    node.subscribe("VICON", vicon_frame_t, lambda channel, frame: ...)
    node.every(0.5, lambda utime: node.publish("MEASUREMENT_Q1", message))
    node.run()

Types are classes with encode() and decode(), as `lcm-gen --python` writes; those of this stack are
the package vantage_lcm (Debian: vantage-lcmtypes). Without a type there are bytes.
"""
import time

from . import _vantage

__all__ = ["Bus", "Node"]


class Bus:
    """One process's end of the bus. One thread at a time; another waits.

    url: as in network.url ("" is $LCM_DEFAULT_URL, else LCM's own). scenario: a Scenario, or what
    makes one; its network.url when `url` is "", and its security: what is published is signed with the key of the
    channel's role, and what is heard is judged (docs/guide/security.md). Without, nobody is judged.

    Raises StartupError when there is no such network, or the keys are not as they should be.
    """

    def __init__(self, url="", scenario=None):
        if scenario is not None and not isinstance(scenario, _vantage.Scenario):
            scenario = _vantage.Scenario(scenario)
        self.scenario = scenario
        """The Scenario, or None."""
        self._bus = _vantage._Bus(url, scenario)
        self._run_id = self._bus.random_run_id()
        self._sequences = {}
        self._decode_errors = {}
        self._handled_s = 0.0  # spent in handlers

    def subscribe(self, channel, type, handler):
        """handler(channel, message) with each message on `channel`; one that ends in * is a prefix.

        type None: messages are bytes. What does not decode is counted and dropped. What a handler raises
        comes out of handle().
        """
        def timed(name, message):
            begin = time.monotonic()
            handler(name, message)
            self._handled_s += time.monotonic() - begin

        def decoded(name, data):
            try:
                message = type.decode(data)
            except Exception:  # generated decoders raise ValueError, struct.error and others
                key = f"{name}.decode_errors"
                self._decode_errors[key] = self._decode_errors.get(key, 0) + 1
                return
            timed(name, message)
        self._bus.subscribe(channel, timed if type is None else decoded)

    def publish(self, channel, message):
        """Sends bytes, or a message with encode(); False when the network did not take it (counted).

        A message with the fields run_id and sequence gets this process's run and the channel's next
        number; one whose utime is 0 the time that it is.
        """
        if not isinstance(message, (bytes, bytearray, memoryview)):
            if hasattr(message, "run_id") and hasattr(message, "sequence"):
                message.run_id = self._run_id
                message.sequence = self._sequences.get(channel, 0)
                self._sequences[channel] = message.sequence + 1
            if getattr(message, "utime", None) == 0:
                message.utime = self.utime
            message = message.encode()
        return self._bus.publish(channel, bytes(message))

    def handle(self, timeout_s=0.0):
        """Waits for a message for up to timeout_s, then calls the handlers of all that have come; how many."""
        return self._bus.handle(timeout_s)

    @property
    def utime(self):
        """What time it is for the stack, µs since the Unix epoch."""
        return self._bus.now_utime()

    @property
    def counters(self):
        """{name: count} of what was sent, received, lost, and refused by its signature; zeros are left out."""
        return {**self._bus.counters(), **self._decode_errors}


class Node(Bus):
    """A process on the bus: handlers of messages, and what is done every so often, until Ctrl-C.

    With vantage_lcm installed it says once a second how it is, on HEALTH_<name>, as every process does.
    """

    def __init__(self, name, url="", scenario=None):
        super().__init__(url, scenario)
        self.name = name
        """[A-Z0-9_]+"""
        self._tasks = []  # [due, period_s, action] by the monotonic clock
        self._is_stopped = False
        self._loops = 0
        self._worst_s = 0.0
        try:
            import vantage_lcm
            self._lcm = vantage_lcm
            self.every(1.0, self._say_health)
        except ImportError:
            self._lcm = None

    def every(self, period_s, action):
        """action(utime) every period_s; instants that were slept through are left out."""
        if not period_s > 0.0:
            raise _vantage.UsageError("period_s: must be > 0")
        self._tasks.append([time.monotonic(), period_s, action])

    def stop(self):
        """run() ends: for handlers and actions."""
        self._is_stopped = True

    def run(self, duration_s=None):
        """Handles messages and does what is due until stop(), Ctrl-C or duration_s later."""
        end = None if duration_s is None else time.monotonic() + duration_s
        self._is_stopped = False
        try:
            while not self._is_stopped and (end is None or time.monotonic() < end):
                self._turn(end)
        except KeyboardInterrupt:
            pass

    def _turn(self, end):
        wake = min([task[0] for task in self._tasks] + ([] if end is None else [end]), default=time.monotonic() + 0.1)
        handled_s = self._handled_s
        self.handle(min(max(wake - time.monotonic(), 0.0), 0.1))  # Ctrl-C is looked for as often
        begin = time.monotonic() - (self._handled_s - handled_s)
        for task in self._tasks:
            if task[0] <= time.monotonic():
                task[0] = max(task[0] + task[1], time.monotonic())
                task[2](self.utime)
        self._loops += 1
        self._worst_s = max(self._worst_s, time.monotonic() - begin)

    def _say_health(self, utime):
        health = self._lcm.health_t()
        health.utime = utime
        health.process = self.name
        health.state = 1  # running
        for name, count in sorted(self.counters.items()):
            counter = self._lcm.counter_t()
            counter.name, counter.count = name, count
            health.counters.append(counter)
        health.num_counters = len(health.counters)
        health.loops = self._loops
        health.loop_worst_s = self._worst_s
        self._worst_s = 0.0
        self.publish(f"HEALTH_{self.name}", health)
