"""Access to the running system's channels: any LCM type, on the stack's own transport.

    from vantage import live
    from vantage_lcm import measurement_t, mocap_frame_t

    node = live.Node("DETECTOR", scenario="lab")
    node.subscribe("VICON", mocap_frame_t, lambda channel, frame: ...)
    node.every(0.5, lambda utime: node.publish("MEASUREMENT_Q1", message))
    node.run()

Types are classes with encode() and decode(), as `lcm-gen --python` writes. The stack's types are in
the package vantage_lcm (Debian: vantage-lcmtypes). Without a type, messages are bytes.
"""
import time

from . import _vantage

__all__ = ["Bus", "Node"]


class Bus:
    """Connection of one process to the bus. Thread-safe: simultaneous calls are executed one after another.

    url: as in network.url ("": $LCM_DEFAULT_URL, else the default of LCM). scenario: a Scenario or its source.
    If `url` is "", the scenario's network.url is used. The scenario's security applies: published messages are
    signed with the key of the channel's role, and received messages are verified (docs/guide/security.md).
    Without a scenario, messages are not verified.

    Raises StartupError if the network is missing or the keys are invalid.
    """

    def __init__(self, url="", scenario=None):
        if scenario is not None and not isinstance(scenario, _vantage.Scenario):
            scenario = _vantage.Scenario(scenario)
        self.scenario = scenario
        """Scenario of this connection, or None."""
        self._bus = _vantage._Bus(url, scenario)
        self._run_id = self._bus.random_run_id()
        self._sequences = {}
        self._decode_errors = {}
        self._handled_s = 0.0  # time spent in handlers

    def subscribe(self, channel, type, handler):
        """Calls handler(channel, message) for each message on `channel`; a name that ends in * is a prefix.

        type None: messages are bytes. Messages that cannot be decoded are counted and dropped. Exceptions of a
        handler are raised by handle().
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
        """Sends bytes or a message with encode(). Returns False, and counts the failure, if the
        network refused the message.

        If a message has the fields run_id and sequence, they are set to this process's run and the channel's next
        number. A utime of 0 is replaced by the current time.
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
        """Waits up to timeout_s for a message and calls the handlers of all received messages. Returns their number."""
        return self._bus.handle(timeout_s)

    @property
    def utime(self):
        """Current time of the stack, µs since the Unix epoch."""
        return self._bus.now_utime()

    @property
    def counters(self):
        """{name: count} of messages sent, received, lost, and refused because of their signature; zeros are omitted."""
        return {**self._bus.counters(), **self._decode_errors}


class Node(Bus):
    """Process on the bus: handles messages and runs periodic actions until Ctrl-C.

    If vantage_lcm is installed, the node publishes its state once per second on HEALTH_<name>, as all processes do.
    """

    def __init__(self, name, url="", scenario=None):
        super().__init__(url, scenario)
        self.name = name
        """Name of the node, of the form [A-Z0-9_]+."""
        self._tasks = []  # [due, period_s, action], due on the monotonic clock
        self._is_stopped = False
        self._loops = 0
        self._worst_s = 0.0
        try:
            import vantage_lcm
            self._lcm = vantage_lcm
            self.every(1.0, self._publish_health)
        except ImportError:
            self._lcm = None

    def every(self, period_s, action):
        """Calls action(utime) every period_s. Missed instants are skipped."""
        if not period_s > 0.0:
            raise _vantage.UsageError("period_s: must be > 0")
        self._tasks.append([time.monotonic(), period_s, action])

    def stop(self):
        """Ends run(). For use in handlers and actions."""
        self._is_stopped = True

    def run(self, duration_s=None):
        """Handles messages and runs due actions until stop(), Ctrl-C or the end of duration_s."""
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
        self.handle(min(max(wake - time.monotonic(), 0.0), 0.1))  # at most 0.1 s, so that Ctrl-C is noticed
        begin = time.monotonic() - (self._handled_s - handled_s)
        for task in self._tasks:
            if task[0] <= time.monotonic():
                task[0] = max(task[0] + task[1], time.monotonic())
                task[2](self.utime)
        self._loops += 1
        self._worst_s = max(self._worst_s, time.monotonic() - begin)

    def _publish_health(self, utime):
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
