#!/usr/bin/env python3
"""landings.py [--times N] BIN_DIR SCENARIO TYPES EVENT...: checks that vehicles land before a trial
ends, for each EVENT that ends it.

Starts `vantage up` without --fly and an operator's console, which arms the vehicles, lets them take off
and follow, and stays alive. When all are in the air the EVENT happens:

  duration      --duration-s of `vantage up` is over
  interrupt     SIGINT to `vantage up`, as by Ctrl-C
  term, hangup  SIGTERM, SIGHUP to `vantage up`
  kill9         SIGKILL to `vantage up`, so that its processes get SIGTERM from the kernel
  twice         SIGTERM, and once more after 1 s: the autopilots land alone
  mocap         SIGKILL to the mocap driver until it is given up
  driver        SIGKILL to a driver, seven times
  stop          SIGSTOP to the mocap driver: it is detected within a second
  cut=S         no multicast route for S seconds; then the vehicles take off again, and SIGTERM. (Below
                `safe_height_m` a lost pose stops the motors, so some end in the state `killed`.)

At the end every vehicle must be on the ground and disarmed, by the simulator's own TRUTH and by the
status of its driver (or, where its autopilot lands alone, be named), no process may be left, and exit
code and report must agree with that. During a cut no process may be ended. A trial whose vehicles do not
take off (a busy host is refused) is flown again, at most twice as often as asked. TYPES is the folder
of the .lcm files. To be run in its own network: in_network.sh landings.py ...
"""

import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

from lcm_socket import receiver_and_sender, sent_by

URL = "udpm://239.255.76.67:7667?ttl=0"
ROUTE = ["224.0.0.0/4", "dev", "lo"]
PATIENCE_S = 60
GROUND_M = 0.1
AIRBORNE = {1, 2, 3}  # follow, hold, land
FOLLOW, HOLD = 1, 2
IDLE, KILLED = 0, 4


class NotFlown(Exception):
    """The vehicles did not take off, for example because a driver found its host busy."""


class Witness:
    """Keeps the newest TRUTH and VEHICLE_* messages of the network."""

    def __init__(self, truth_t, vehicle_t):
        self.types = {"TRUTH": truth_t, "VEHICLE": vehicle_t}
        self.receiver, _ = receiver_and_sender()
        self.receiver.settimeout(0.2)
        self.newest = {}
        self.is_over = False
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        while not self.is_over:
            try:
                channel, payload = sent_by(self.receiver.recv(65536))
            except TimeoutError:
                continue
            if channel == "TRUTH" or (channel or "").startswith("VEHICLE_"):
                self.newest[channel] = payload

    def close(self):
        self.is_over = True
        self.thread.join()
        self.receiver.close()

    def states(self):
        found = {}
        for channel, payload in list(self.newest.items()):
            if channel != "TRUTH":
                status = self.types["VEHICLE"].decode(payload)
                found[status.robot] = (status.state, status.reasons)
        return found

    def heights_m(self):
        truth = self.types["TRUTH"].decode(self.newest["TRUTH"])
        return {body.name: body.position_world_m[2] for body in truth.bodies if body.name in self.states()}


def command_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""


def processes():
    """Returns all processes of the trial, by id; those that have ended but are not reaped have no command."""
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        words = command_of(path.name)
        if "/vantage-" in words.split(" ")[0] or " log record " in words:
            if is_of_this_network(path):
                found[int(path.name)] = words
    return found


def is_of_this_network(path):
    try:
        return os.readlink(path / "ns/net") == os.readlink("/proc/self/ns/net")
    except OSError:
        return False


def one_of(pattern):
    return next((pid for pid, words in processes().items() if pattern in words), None)


class Trial:
    def __init__(self, arguments, folder, event, types):
        self.event, self.folder = event, folder
        self.witness = Witness(*types)
        words = [arguments.binaries + "/vantage", "up", arguments.scenario, "--url", URL,
                 "--log", f"{folder}/flight.lcmlog", "--json"]
        if event == "duration":
            words += ["--duration-s", str(arguments.duration_s)]
        self.begin = time.monotonic()
        self.errors = open(f"{folder}/up.err", "w+", encoding="utf-8")
        self.report = open(f"{folder}/up.json", "w+", encoding="utf-8")
        self.up = subprocess.Popen(words, stdout=self.report, stderr=self.errors)
        self.console = subprocess.Popen([arguments.binaries + "/vantage", "console", "--url", URL], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)

    def heights(self):
        return self.witness.heights_m() if "TRUTH" in self.witness.newest else "unknown heights"

    def order(self, words):
        self.console.stdin.write(words + "\n")
        self.console.stdin.flush()

    def words(self):
        return pathlib.Path(f"{self.folder}/up.err").read_text(encoding="utf-8")

    def until(self, holds, what, patience_s=PATIENCE_S):
        give_up = time.monotonic() + patience_s
        while not holds():
            assert time.monotonic() < give_up, f"no {what}: {self.witness.states()} at {self.heights()}\n{self.words()}"
            time.sleep(0.05)

    def all_in(self, states, count=3):
        now = self.witness.states()
        return len(now) == count and all(state in states for state, _ in now.values())

    def fly(self):
        """Returns when all are in the air and one of them follows its plan."""
        try:
            self.take_off()
        except AssertionError as error:
            raise NotFlown(error) from error

    def take_off(self):
        self.until(lambda: "TRUTH" in self.witness.newest and self.all_in({IDLE, KILLED}), "vehicles")
        # Motors that idle for long are stopped. `hold`, repeated for 0.75 s, drops old orders. If the
        # motors were stopped, the first `arm` only ends the state `killed`.
        steps = [(0.0, {IDLE: ("hold",), KILLED: ("arm",)}), (1.5, {IDLE: ("arm", "take-off")})]
        begin, done = time.monotonic(), 0

        def are_up():
            nonlocal begin, done
            if done < len(steps) and time.monotonic() >= begin + steps[done][0]:
                for robot, (state, _) in self.witness.states().items():
                    for order in steps[done][1].get(state, ()):
                        self.order(f"{order} {robot}")
                done += 1
            if time.monotonic() >= begin + 20.0:
                begin, done = time.monotonic(), 0
            heights = self.witness.heights_m()
            return self.all_in(AIRBORNE) and all(height > 0.3 for height in heights.values())

        self.until(are_up, "flight", 2 * PATIENCE_S)  # a busy host refuses take-off for a while
        self.order("follow")
        self.until(lambda: any(state == FOLLOW for state, _ in self.witness.states().values()), "plan")

    def is_down(self):
        return self.all_in({IDLE, KILLED}) and all(h < GROUND_M for h in self.witness.heights_m().values())

    def cut(self, seconds):
        before = processes()
        subprocess.run(["ip", "route", "del", *ROUTE], check=True)
        time.sleep(seconds)
        after = processes()
        subprocess.run(["ip", "route", "add", *ROUTE], check=True)
        assert set(before) <= set(after), f"ended in a cut: {[before[p] for p in set(before) - set(after)]}"
        time.sleep(1.0)
        self.until(self.is_down, "landing after a cut")
        assert "sent no heartbeat" not in self.words(), self.words()
        self.take_off()  # operable again
        self.up.send_signal(signal.SIGTERM)

    def happen(self):
        kind, _, value = self.event.partition("=")
        signals = {"interrupt": signal.SIGINT, "term": signal.SIGTERM, "hangup": signal.SIGHUP}
        if kind in signals:
            self.up.send_signal(signals[kind])
        elif kind == "twice":
            self.up.send_signal(signal.SIGTERM)
            time.sleep(1.0)
            self.up.send_signal(signal.SIGTERM)
        elif kind == "kill9":
            self.up.kill()
        elif kind == "stop":
            pid = one_of("vantage-vicon")
            os.kill(pid, signal.SIGSTOP)
            self.until(lambda: not command_of(pid), "end of the mocap driver", 2.5)
            self.up.send_signal(signal.SIGTERM)
        elif kind in ("mocap", "driver"):
            name = "vantage-vicon" if kind == "mocap" else "vantage-quadrotor"
            killed = 0
            while killed < 7 and "is given up" not in self.words():
                pid = one_of(name)
                if pid:
                    os.kill(pid, signal.SIGKILL)
                    killed += 1
                    self.until(lambda: not command_of(pid), "end of one that was killed")
                time.sleep(0.05)
            if kind == "driver":
                assert "is given up" not in self.words(), self.words()
                self.up.send_signal(signal.SIGTERM)
        elif kind == "cut":
            self.cut(float(value))

    def judge(self):
        happened = time.monotonic()
        is_killed = self.event == "kill9"
        code = self.up.wait(timeout=90)
        self.until(lambda: not processes(), "end of all processes", 70)
        took_s = time.monotonic() - happened
        heights, states = self.witness.heights_m(), self.witness.states()
        left = []
        if not is_killed:
            text = pathlib.Path(f"{self.folder}/up.json").read_text(encoding="utf-8").splitlines()
            report = json.loads(next(line for line in text if line.startswith("{")))
            left = report["left_flying"]
            is_given_up = self.event == "mocap"
            failed = (left, is_given_up, report["collisions"], report["killed"], report["log"]["was_unwritten"])
            assert (code != 0) == any(failed), (code, report, self.words())
            assert bool(report["given_up"]) == is_given_up, report
        if self.event == "twice":
            assert len(left) == 3 and code == 1, (left, code)
        else:
            assert not left, (left, self.words())
            assert all(height < GROUND_M for height in heights.values()), (heights, states, self.words())
            assert all(state in (IDLE, KILLED) for state, _ in states.values()), (states, heights)
        print(f"{self.event}: down and ended after {took_s:.1f} s, exit code {code}, left flying {left}, "
              f"{time.monotonic() - self.begin:.0f} s in all", flush=True)

    def run(self):
        try:
            self.fly()
            self.happen()
            self.judge()
        finally:
            for process in (self.up, self.console):
                if process.poll() is None:
                    process.kill()
            self.console.stdin.close()
            self.console.wait()
            self.up.wait()
            for pid in processes():
                os.kill(pid, signal.SIGKILL)
            self.witness.close()
            self.errors.close()
            self.report.close()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--times", type=int, default=1)
    parser.add_argument("--duration-s", type=float, default=60.0)
    parser.add_argument("binaries")
    parser.add_argument("scenario")
    parser.add_argument("types")
    parser.add_argument("events", nargs="+")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as types:
        subprocess.run(["sh", "-c", f"lcm-gen --python --ppath {types} {arguments.types}/*.lcm"], check=True)
        sys.path.insert(0, types)
        from vantage_lcm.vehicle_t import vehicle_t
        from vantage_lcm.truth_t import truth_t
        failed = 0
        for event in arguments.events:
            flown, tries = 0, 0
            while flown < arguments.times and tries < 2 * arguments.times + 3:
                tries += 1
                with tempfile.TemporaryDirectory() as folder:
                    try:
                        Trial(arguments, folder, event, (truth_t, vehicle_t)).run()
                        flown += 1
                    except NotFlown as reason:
                        print(f"{event}: not flown, tried again: {reason}", flush=True)
                    except (AssertionError, StopIteration, subprocess.TimeoutExpired) as error:
                        flown += 1
                        failed += 1
                        print(f"{event}: FAILED: {error}", flush=True)
            print(f"{event}: flown {flown} times, {tries - flown} not flown, {failed} failed so far", flush=True)
            failed += arguments.times - flown
        return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
