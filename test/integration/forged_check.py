#!/usr/bin/env python3
"""forged_check.py TYPES LOG SPAN [--signed] [--held-up]: checks whether forge_live.py changed a flight.

Reads the log of the flight: what the vehicles did in the span (none may land, be killed or hold for
more than a second), and what their drivers refused. Prints it; exit code 0: nothing changed. hil_check
checks for collisions.
--signed: each kind of forgery must have been refused. --held-up: the host delayed processes, so these
are not judged: holding, late plans, a landing because a stream was silent (SILENCES), and the end of the flight.
"""

import collections
import struct
import sys

sys.path.insert(0, sys.argv[1])
from vantage_lcm.health_t import health_t  # noqa: E402
from vantage_lcm.vehicle_t import vehicle_t  # noqa: E402

# Reasons for which a driver lands when a stream is silent. A landing by a forged order has no reason; a
# landing by a forged pose has another reason.
SILENCES = {"pose lost", "operator lost", "autopilot lost"}
NAMES = {0: "idle", 1: "follow", 2: "hold", 3: "land", 4: "killed"}


def events(path):
    data = open(path, "rb").read()
    at = 0
    while at + 28 <= len(data):
        sync, _, utime, channel, size = struct.unpack(">IqqII", data[at:at + 28])
        assert sync == 0xEDA1DA01, at
        body = at + 28 + channel
        yield utime, data[at + 28:body].decode(), data[body:body + size]
        at = body + size


begin, end = map(int, open(sys.argv[3]).read().split())
seen = collections.defaultdict(collections.Counter)
rounds = collections.defaultdict(set)
refused = collections.defaultdict(dict)
landed_for = {}  # reasons of each vehicle when it began to land
for utime, channel, data in events(sys.argv[2]):
    if channel.startswith("VEHICLE_") and begin <= utime <= end:
        status = vehicle_t.decode(data)
        seen[status.robot][NAMES[status.state]] += 1
        rounds[status.robot].add(status.plan_round)
        if NAMES[status.state] == "land" and status.robot not in landed_for:
            landed_for[status.robot] = {reason.split(";")[0] for reason in status.reasons}
    elif channel.startswith("HEALTH_QUADROTOR_"):
        for counter in health_t.decode(data).counters:
            if counter.name.rsplit(".")[-1] in ("unsigned", "bad_mac", "replayed"):
                refused[channel[17:]][counter.name] = counter.count

changed = not seen
for robot in sorted(seen):
    states = seen[robot]
    why = sorted(landed_for.get(robot, ()))
    print(robot, dict(states), f"landed for {why};" if robot in landed_for else "", len(rounds[robot]),
          "rounds; refused", refused[robot])
    is_held_up = "--held-up" in sys.argv
    ended = robot in landed_for or states["killed"] > 0
    changed |= ended and not (is_held_up and SILENCES.intersection(why))
    changed |= not is_held_up and (states["hold"] > 10 or len(rounds[robot]) < 2)
print("changed" if changed else "nothing changed")
for robot in seen if "--signed" in sys.argv else ():
    for channel in ("VICON", "COMMAND", f"PLAN_{robot}"):
        for reason in ("unsigned", "bad_mac", "replayed"):
            if not refused[robot].get(f"{channel}.{reason}"):
                sys.exit(f"{robot} has not counted {channel}.{reason}")
sys.exit(1 if changed else 0)
