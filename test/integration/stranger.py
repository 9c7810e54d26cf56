#!/usr/bin/env python3
"""stranger.py BIN_DIR SCENARIO TYPES: runs SCENARIO with `security: require` while another
program without keys publishes in the name of another supervisor and another vehicle, reports collisions,
and sends names that contain escape sequences. The trial starts and ends well, does not count forged
collisions, and reports their number; its terminal receives none of the forged escape sequences, and the
memory of `vantage up` does not grow. To be run in its own network.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

from lcm_socket import receiver_and_sender, say

binary, scenario, types = sys.argv[1] + "/vantage", sys.argv[2], sys.argv[3]
folder = pathlib.Path(tempfile.mkdtemp())
subprocess.run(["sh", "-c", f"lcm-gen --python --ppath {folder} {types}/*.lcm"], check=True)
sys.path.insert(0, str(folder))
from vantage_lcm.collision_t import collision_t  # noqa: E402
from vantage_lcm.host_t import host_t  # noqa: E402
from vantage_lcm.vehicle_t import vehicle_t  # noqa: E402

ESCAPE = "\x1b]0;owned\x07"
MEMORY_MAX_KIB = 200_000
_, sender = receiver_and_sender()
is_over = False


def stamped(message, number):
    message.utime, message.run_id, message.sequence = int(time.time() * 1e6), 7, number
    return message


def forge():
    """Sends the forged messages until the test is over."""
    number = 0
    while not is_over:
        host = stamped(host_t(), number)
        host.host = f"X{number % 6000}" + ESCAPE
        say(sender, "HOST_X", host.encode())
        say(sender, f"HOST_{host.host}"[:60], host.encode())
        status = stamped(vehicle_t(), number)
        status.robot, status.plan_round = "Q9", -1
        say(sender, "VEHICLE_Q9", status.encode())
        contact = stamped(collision_t(), number)
        contact.body_a, contact.body_b = "Q1" + ESCAPE, "Q2"
        for _ in range(4):
            say(sender, "COLLISION", contact.encode())
            contact.sequence += 1
        number += 4
        time.sleep(0.002)


def memory_kib(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1])
    return 0


subprocess.run([binary, "keys", "new", folder / "keys"], check=True, stdout=subprocess.DEVNULL)
signed = folder / "signed.yaml"
signed.write_text(pathlib.Path(scenario).read_text() +
                  f"\nsecurity: {{mode: require, keys: {folder}/keys}}\n")
attacker = threading.Thread(target=forge)
attacker.start()
try:
    up = subprocess.Popen([binary, "up", signed, "--no-log", "--json", "--duration-s", "6"],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    most_kib = 0

    def measure():
        global most_kib
        while up.poll() is None:
            try:
                most_kib = max(most_kib, memory_kib(up.pid))
            except OSError:
                pass
            time.sleep(0.1)

    meter = threading.Thread(target=measure)
    meter.start()
    out, errors = up.communicate(timeout=120)
    meter.join()
finally:
    is_over = True
    attacker.join()
assert up.returncode == 0, (up.returncode, errors)
result = json.loads(out)
assert result["collisions"] == 0, result["collisions"]
assert result["contacts_unverified"] > 100, result["contacts_unverified"]
assert "as host X" in errors and "more such messages" in errors and "COLLISION" in errors, errors
assert "\x1b" not in errors and "\x07" not in errors, repr(errors)
assert most_kib < MEMORY_MAX_KIB, most_kib
print(f"stranger: {result['contacts_unverified']} forged collisions refused, {most_kib} KiB")
