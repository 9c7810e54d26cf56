#!/usr/bin/env python3
"""forged_health.py BIN_DIR SCENARIO TYPES: runs SCENARIO without `security` while another program publishes
HEALTH in the name of every process: with another run id, stamped 1.9 s ahead, and with impossible states
and counts. No process is killed or restarted, and the trial ends well. To be run in its own network.
"""

import json
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time

from lcm_socket import receiver_and_sender, say, sent_by

binary, scenario, types = sys.argv[1] + "/vantage", sys.argv[2], sys.argv[3]
folder = pathlib.Path(tempfile.mkdtemp())
subprocess.run(["sh", "-c", f"lcm-gen --python --ppath {folder} {types}/*.lcm"], check=True)
sys.path.insert(0, str(folder))
from vantage_lcm.health_t import health_t  # noqa: E402

AHEAD_S = 1.9
RUN_ID = 7
receiver, sender = receiver_and_sender()
receiver.settimeout(0.05)
receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
sent = {}  # number of messages by process
is_over = False


def claim(process, number):
    """Returns a forged HEALTH of `process`: plausible, or with an impossible state."""
    message = health_t()
    message.process, message.run_id, message.sequence = process, RUN_ID, number
    message.utime = int((time.time() + AHEAD_S) * 1e6)
    message.state = (1, 3, -1, 2**31 - 1)[number % 4]
    message.loop_worst_s = (0.001, float("nan"), float("inf"), -1.0)[number % 4]
    message.loops = message.deadlines_missed = (number, 2**63 - 1, -1, 0)[number % 4]
    return message.encode()


def forge():
    """Learns the names of the processes from their messages, and publishes in the name of each."""
    while not is_over:
        try:
            channel, content = sent_by(receiver.recv(65536))
        except TimeoutError:
            continue
        if not channel or not channel.startswith("HEALTH_") or health_t.decode(content).run_id == RUN_ID:
            continue
        process = channel.removeprefix("HEALTH_")
        sent.setdefault(process, 0)
        for each in sent:
            for _ in range(4):
                say(sender, "HEALTH_" + each, claim(each, sent[each]))
                sent[each] += 1


attacker = threading.Thread(target=forge)
attacker.start()
try:
    up = subprocess.run([binary, "up", scenario, "--no-log", "--json", "--duration-s", "10"],
                        capture_output=True, text=True, timeout=120)
finally:
    is_over = True
    attacker.join()
print(f"forged_health: {sum(sent.values())} forged messages of {len(sent)} processes")
assert {"SIM", "PLANNER_Q1", "ESTIMATOR_Q1"} <= set(sent), sorted(sent)
assert min(sent[each] for each in ("SIM", "PLANNER_Q1", "ESTIMATOR_Q1")) > 100, sent
assert up.returncode == 0, (up.returncode, up.stderr)
result = json.loads(up.stdout)
for what in ("restarts", "given_up", "killed", "ended_badly", "processes"):
    assert not result[what], (what, result[what], up.stderr)
