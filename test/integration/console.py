#!/usr/bin/env python3
"""console.py BIN_DIR TYPES SCENARIO: tests which commands vehicles receive when an operator types into
`vantage console`.

At a terminal: arrows, Home, End, F2 and Delete are not orders, although each sequence ends in the letter
of an order; SPACE stops all vehicles whatever is selected; a robot is selected by its name. A terminal that
is stopped by Ctrl-S, or whose output is not read, ends neither the heartbeat nor the emergency stop, nor the
heartbeat of `vantage up SCENARIO --fly`; Ctrl-Z and Ctrl-\\ do nothing. From a pipe: orders for a robot
that was not received yet are sent to that robot, in their order; a line that is not an order, or that names
an unknown robot, gives exit code 1. TYPES is the folder of the .lcm files. To be run in its own network.
"""

import os
import pty
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time

from lcm_socket import receiver_and_sender, sent_by, say

binary, types, scenario = sys.argv[1] + "/vantage", sys.argv[2], sys.argv[3]
URL = "udpm://239.255.76.67:7667?ttl=0"
folder = tempfile.mkdtemp()
subprocess.run(["sh", "-c", f"lcm-gen --python --ppath {folder} {types}/*.lcm"], check=True)
sys.path.insert(0, folder)
from vantage_lcm.command_t import command_t  # noqa: E402
from vantage_lcm.vehicle_t import vehicle_t  # noqa: E402

PATIENCE_S, SETTLE_S = 10, 2
WORDS = ["beat", "arm", "take-off", "follow", "hold", "land", "estop"]
receiver, sender = receiver_and_sender()
is_over = False


def speak():
    """Publishes the status of Q1 and Q2 until the test is over."""
    number = 0
    while not is_over:
        for robot in ("Q1", "Q2"):
            status = vehicle_t()
            status.utime, status.sequence, status.run_id = int(time.time() * 1e6), number, 7
            status.robot, status.battery_share, status.plan_round = robot, 1.0, -1
            say(sender, "VEHICLE_" + robot, status.encode())
        number += 1
        time.sleep(0.1)


def received_orders(until):
    """Returns the different orders received until `until(orders)` is true, and those already queued then."""
    out, is_last = [], False
    receiver.settimeout(0.05)
    while True:
        try:
            channel, payload = sent_by(receiver.recvfrom(65536)[0])
            if channel == "COMMAND":
                order = command_t.decode(payload)
                words = f"{WORDS[order.action]} {order.robot}".strip()
                if words not in out:
                    out.append(words)
        except (TimeoutError, BlockingIOError):
            if is_last:
                return out
        if not is_last and until(out):
            is_last = True
            receiver.settimeout(0.0)


def forget():
    """Discards all datagrams received so far."""
    receiver.settimeout(0.0)
    try:
        while True:
            receiver.recv(65536)
    except BlockingIOError:
        pass


def typed(keys):
    """Returns the orders received while the `keys` are pressed one after the other at a terminal."""
    forget()
    give_up = time.monotonic() + PATIENCE_S
    pid, terminal = pty.fork()
    if pid == 0:
        os.execv(binary, [binary, "console", "--url", URL])
    received_orders(lambda out: "beat" in out)

    def press(out):
        while select.select([terminal], [], [], 0)[0]:
            os.read(terminal, 65536)
        if keys:
            os.write(terminal, keys.pop(0))
        return "estop" in out or time.monotonic() > give_up

    out = received_orders(press)
    os.write(terminal, b"q")
    while True:
        try:
            if not os.read(terminal, 65536):
                break
        except OSError:
            break
    assert os.waitpid(pid, 0)[1] == 0
    return [words for words in out if words != "beat"]


class Foreground:
    """A program at its own terminal, whose output is not read."""

    def __init__(self, *words, is_full=False):
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            if is_full:
                os.set_blocking(1, False)
                try:
                    while True:
                        os.write(1, b"x" * 64)
                except BlockingIOError:
                    os.set_blocking(1, True)
            os.execv(words[0], words)

    def press(self, key):
        os.write(self.terminal, key)

    def end(self, signal_number):
        os.kill(self.pid, signal_number)
        while True:
            try:
                if not os.read(self.terminal, 65536):
                    break
            except OSError:
                break
        os.waitpid(self.pid, 0)


def beats_within(count, seconds):
    """Returns True if at least `count` heartbeats arrive within `seconds`."""
    give_up, beats = time.monotonic() + seconds, 0
    receiver.settimeout(0.05)
    while beats < count and time.monotonic() < give_up:
        try:
            channel, payload = sent_by(receiver.recvfrom(65536)[0])
            beats += channel == "COMMAND" and command_t.decode(payload).action == 0
        except TimeoutError:
            pass
    return beats >= count


def check_terminal(keys, is_full, words, stops):
    """Checks that heartbeats continue after `keys`, and that SPACE still stops (if `stops`)."""
    forget()
    program = Foreground(*words, is_full=is_full)
    try:
        assert beats_within(1, PATIENCE_S), f"{words[1]}: no heartbeat at the start"
        for key in keys:
            program.press(key)
        beats_within(1000, SETTLE_S)  # the screen is drawn every quarter of a second
        assert beats_within(10, PATIENCE_S), f"{words[1]}: no heartbeat after {keys}, {is_full}"
        if stops:
            program.press(b" ")
            give_up = time.monotonic() + PATIENCE_S
            out = received_orders(lambda out: "estop" in out or time.monotonic() > give_up)
            assert "estop" in out, (keys, out)
    finally:
        program.end(signal.SIGKILL)


def piped(text):
    """Returns the orders that the console sends for the input `text`, and its exit code."""
    forget()
    console = subprocess.Popen([binary, "console", "--url", URL], stdin=subprocess.PIPE,
                               stdout=subprocess.DEVNULL, text=True)
    console.stdin.write(text)
    console.stdin.close()
    out = received_orders(lambda _: console.poll() is not None)
    return [words for words in out if words != "beat"], console.returncode


speaker = threading.Thread(target=speak)
speaker.start()
try:
    for keys in ([b"\x1b[A", b"\x1b[F", b"\x1b[H", b"\x1bOQ", b"\x1b[3~", b"h", b" "],
                 [b"\x1b", b"[", b"A", b"\x1bOF", b"h", b"\x1b", b" "]):
        found = typed(keys)
        assert found == ["hold", "estop"], found
    # SPACE stops all though Q2 is selected; e stops Q2; names select in any letter case.
    for keys, orders in (([b"2", b"h", b" "], ["hold Q2", "estop"]),
                         ([b"r", b"q", b"1", b"\n", b"h", b"e", b" "], ["hold Q1", "estop Q1", "estop"]),
                         ([b"r", b"Q", b"2", b"\n", b"l", b"\t", b" "], ["land Q2", "estop"]),
                         ([b"r", b"h", b" "], ["estop"])):
        found = typed(keys)
        assert found == orders, (keys, found)
    console = (binary, "console", "--url", URL)
    for keys, is_full in (((b"\x13",), False), ((b"\x1a", b"\x1c"), False), ((), True)):
        check_terminal(keys, is_full, console, True)
    up = (binary, "up", scenario, "--fly", "--no-log", "--duration-s", "60", "--ignore-others")
    for keys, is_full in (((b"\x13",), False), ((), True)):
        check_terminal(keys, is_full, up, False)
    for text, orders, code in (("estop Q1\n", ["estop Q1"], 0),
                               ("arm Q1\ntake-off Q1\nland Q2\n", ["land Q2", "arm Q1", "take-off Q1"], 0),
                               ("follow\nhold\n", ["hold"], 0),
                               ("land Q1\nlnad Q2\n", ["land Q1"], 1),
                               ("arm Q9\n", [], 1),
                               ("estop Q9\n", ["estop Q9", "estop"], 0)):
        found = piped(text)
        assert found == (orders, code), (text, found)
finally:
    is_over = True
    speaker.join()
