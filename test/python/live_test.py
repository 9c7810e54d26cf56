#!/usr/bin/env python3
"""Tests channels of the running system in Python: messages between Python, C++ and other LCM programs,
in both directions and also signed. To be run in its own network (in_network.sh)."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import vantage
from here import BINARY, SOURCE
from vantage import live

BIN = pathlib.Path(os.environ["VANTAGE_BIN"])
URL = "udpm://239.255.76.67:7667?ttl=0"
FOLDER = tempfile.TemporaryDirectory()
subprocess.run(["lcm-gen", "--python", "--ppath", FOLDER.name, *SOURCE.glob("lcmtypes/*.lcm")], check=True)
sys.path.insert(0, FOLDER.name)
import vantage_lcm  # noqa: E402: it has just been made


def until(bus, condition, timeout_s=20.0):
    """Handles messages until condition() or the timeout; returns True if the condition was met."""
    end = bus.utime + 1e6 * timeout_s
    while not condition() and bus.utime < end:
        bus.handle(0.05)
    return condition()


def measurement(robot="Q1"):
    message = vantage_lcm.measurement_t()
    message.robot, message.x_world_m = robot, 1.25
    detection = vantage_lcm.detection_t()
    detection.target_id, detection.dim = 3, 2
    detection.z, detection.covariance_z = [1.0, 0.5], [[0.01, 0.0], [0.0, 0.02]]
    message.detections, message.num_detections = [detection], 1
    return message


class Started:
    """A process that receives SIGTERM at the end of the `with` block, which waits until it has ended."""

    def __init__(self, *command, **how):
        self.process = subprocess.Popen(list(map(str, command)), **how)

    def __enter__(self):
        return self.process

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        self.process.wait(20)


class Live(unittest.TestCase):
    def test_carries_any_type_and_bytes(self):
        sender, receiver = live.Bus(URL), live.Bus(URL)
        received, raw, large = [], [], []
        receiver.subscribe("MEASUREMENT_*", vantage_lcm.measurement_t, lambda *message_parts: received.append(message_parts))
        receiver.subscribe("MINE", None, lambda *message_parts: raw.append(message_parts))
        receiver.subscribe("LARGE", None, lambda *message_parts: large.append(message_parts))
        for _ in range(3):
            self.assertTrue(sender.publish("MEASUREMENT_Q1", measurement()))
        sender.publish("MINE", b"\x00\xff")
        sender.publish("LARGE", bytes(300_000))
        self.assertTrue(until(receiver, lambda: large))
        self.assertEqual(raw, [("MINE", b"\x00\xff")])
        self.assertEqual(large, [("LARGE", bytes(300_000))])
        self.assertEqual([name for name, _ in received], ["MEASUREMENT_Q1"] * 3)
        self.assertEqual([each.sequence for _, each in received], [0, 1, 2])
        self.assertEqual(len({each.run_id for _, each in received}), 1)
        self.assertLess(abs(received[0][1].utime - receiver.utime), 60e6)
        self.assertEqual(list(received[0][1].detections[0].z), [1.0, 0.5])

    def test_counts_undecodable_messages_and_raises_handler_errors(self):
        sender, receiver = live.Bus(URL), live.Bus(URL)
        receiver.subscribe("BELIEF_Q1", vantage_lcm.belief_t, lambda *message_parts: self.fail("decoded"))
        receiver.subscribe("BAD", None, lambda channel, data: 1 / 0)
        sender.publish("BELIEF_Q1", b"no belief")
        sender.publish("BELIEF_Q1", measurement())
        self.assertTrue(until(receiver, lambda: receiver.counters.get("BELIEF_Q1.decode_errors") == 2))
        sender.publish("BAD", b"")
        with self.assertRaises(ZeroDivisionError):
            until(receiver, lambda: False)
        with self.assertRaisesRegex(vantage.UsageError, "1 to 63 bytes"):
            sender.publish("X" * 64, b"")
        with self.assertRaises(vantage.StartupError):
            live.Bus("nonsense://")

    def test_other_threads_run_while_it_waits(self):
        bus = live.Bus(URL)
        waiter = threading.Thread(target=bus.handle, args=(0.5,))
        waiter.start()
        turns = 0
        while waiter.is_alive():
            turns += 1
        self.assertGreater(turns, 1000)
        waiter.join()

    def test_lcm_receives_its_messages(self):
        log = pathlib.Path(FOLDER.name, "stock.lcmlog")
        with Started("lcm-logger", "--quiet", "--force", f"--lcm-url={URL}", log):
            bus = live.Bus(URL)
            self.assertTrue(until(bus, lambda: bus.publish("MEASUREMENT_Q7", measurement("Q7"))
                                  and log.exists() and b"MEASUREMENT_Q7" in log.read_bytes()))
        recorded = vantage.Log(log)["MEASUREMENT_Q7"]
        self.assertEqual(recorded.type, "measurement_t")
        self.assertEqual(set(recorded["detections.z"]), {1.0, 0.5})


class Stack(unittest.TestCase):
    """Tests with the stack's own processes."""

    def follow(self, scenario_text):
        """Returns the beliefs of Q1's estimator when examples/detector_node.py replaces Q1's sensor."""
        path = pathlib.Path(FOLDER.name, "lab.yaml")
        path.write_text(scenario_text)
        node = live.Node("WITNESS", scenario=path)
        beliefs, health = [], []
        node.subscribe("BELIEF_Q1", vantage_lcm.belief_t, lambda _, belief: beliefs.append(belief))
        node.subscribe("HEALTH_*", vantage_lcm.health_t, lambda _, each: health.append(each.process))
        node.every(0.1, lambda utime: any(each.num_targets for each in beliefs[-3:]) and "DETECTOR" in health
                   and "ESTIMATOR_Q1" in health and node.stop())
        environment = {**os.environ, "PYTHONPATH": os.environ["PYTHONPATH"] + os.pathsep + FOLDER.name}
        with Started(BIN / "vantage-estimator", "--scenario", path, "--robot", "Q1"), \
                Started(sys.executable, SOURCE / "examples/detector_node.py", path, "Q1", env=environment):
            node.run(30.0)
        self.assertIn("ESTIMATOR_Q1", health)
        self.assertIn("DETECTOR", health)
        return beliefs

    def test_estimator_uses_measurements_of_python(self):
        beliefs = self.follow((SOURCE / "config/lab.yaml").read_text())
        self.assertEqual([each.target_id for each in beliefs[-1].targets], [3])

    def test_signed_measurements_are_used_and_unsigned_ones_refused(self):
        keys = pathlib.Path(FOLDER.name, "keys")
        subprocess.run([BINARY, "keys", "new", keys], check=True, capture_output=True)
        lab = (SOURCE / "config/lab.yaml").read_text()
        beliefs = self.follow(lab + f"security: {{mode: require, keys: {keys}}}\n")
        self.assertEqual([each.target_id for each in beliefs[-1].targets], [3])
        scenario = vantage.Scenario.parse(lab + f"security: {{mode: require, keys: {keys}}}\n")
        member, stranger = live.Bus(scenario=scenario), live.Bus(URL)
        received = []
        member.subscribe("MEASUREMENT_Q1", vantage_lcm.measurement_t, lambda *message_parts: received.append(message_parts))
        stranger.publish("MEASUREMENT_Q1", measurement())
        self.assertTrue(until(member, lambda: member.counters.get("MEASUREMENT_Q1.unsigned") == 1))
        member.publish("MEASUREMENT_Q1", measurement())
        self.assertTrue(until(member, lambda: received))
        self.assertEqual(len(received), 1)


if __name__ == "__main__":
    unittest.main()
