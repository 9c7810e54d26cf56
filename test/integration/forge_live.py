#!/usr/bin/env python3
"""forge_live.py TYPES SPAN: forges messages of a live flight without a key.

Waits until every vehicle that publishes on VEHICLE_* follows plans; exit code 3 if not all follow.
Then, for 8 s, forges the received messages with the live streams' own run ids, next sequence numbers and
current stamps: poses that drift away, plans that hover, orders to land, to disarm and to arm. Each is
sent unsigned and with the trailer of the true message appended; the true message is sent again, too.
TYPES is a folder of lcm-gen --python; SPAN is a file that receives the first and the last instant of the
forgery, µs since the Unix epoch. To be run in its own network.
"""

import sys
import time

from lcm_socket import receiver_and_sender, say, sent_by

sys.path.insert(0, sys.argv[1])
from vantage_lcm.command_t import command_t  # noqa: E402
from vantage_lcm.plan_t import plan_t  # noqa: E402
from vantage_lcm.vehicle_t import vehicle_t  # noqa: E402
from vantage_lcm.mocap_frame_t import mocap_frame_t  # noqa: E402

IDLE, FOLLOW, LAND, EMERGENCY_STOP, ARM = 0, 1, 5, 6, 1
SPAN_S, WAIT_S = 8.0, 100.0
NOT_ALL_FOLLOW = 3

receiver, sender = receiver_and_sender()
receiver.settimeout(1.0)


def received_messages():
    """Yields (channel, bytes) of each whole short message of others; (None, b"") at least once per second."""
    while True:
        try:
            packet, source = receiver.recvfrom(65536)
        except TimeoutError:
            yield None, b""
            continue
        channel, payload = sent_by(packet)
        if channel and sender.getsockname()[1] != source[1]:
            yield channel, payload


sent = 0


def send(channel, payload):
    global sent
    say(sender, channel, payload, sent)
    sent += 1


def forge(channel, message, true):
    """Sends `message` unsigned and with the trailer of `true`; then sends `true` again."""
    plain = message.encode()
    send(channel, plain)
    trailer = true[len(kinds(channel).decode(true).encode()):]
    if trailer:
        send(channel, plain + trailer)
        send(channel, true)


def kinds(channel):
    return (mocap_frame_t if channel == "VICON" else
            command_t if channel == "COMMAND" else plan_t)


newest_states, changes, lifted = {}, [], set()
start = time.monotonic()
give_up = start + WAIT_S
for channel, payload in received_messages():
    if channel and channel.startswith("VEHICLE_"):
        status = vehicle_t.decode(payload)
        words = (status.state, *status.reasons)
        if newest_states.get(status.robot) != words:
            changes.append(f"{time.monotonic() - start:7.2f} s {status.robot}: {words}")
        newest_states[status.robot] = words
        lifted.update([status.robot] if status.state != IDLE else [])
        if status.state == IDLE and status.robot in lifted:
            give_up = 0.0  # a vehicle that has landed stays down
    if len(newest_states) > 1 and all(state == FOLLOW for state, *_ in newest_states.values()):
        break
    if time.monotonic() > give_up:
        print("forge_live: not all follow:", *changes, sep="\n  ", file=sys.stderr)
        sys.exit(NOT_ALL_FOLLOW)

begin = time.time()
kinds_forged = set()
for channel, payload in received_messages():
    since_s = time.time() - begin
    if since_s > SPAN_S:
        break
    if channel == "VICON":
        frame = mocap_frame_t.decode(payload)
        frame.sequence += 1
        for body in frame.bodies:
            position = list(body.position_world_m)
            position[0] += 0.3 * since_s
            body.position_world_m = position
        forge(channel, frame, payload)
    elif channel == "COMMAND":
        for action in (LAND, EMERGENCY_STOP, ARM) if since_s > 4.0 else (LAND,):
            order = command_t.decode(payload)
            order.sequence += 1
            order.action, order.robot = action, ""
            forge(channel, order, payload)
    elif channel and channel.startswith("PLAN_"):
        plan = plan_t.decode(payload)
        plan.sequence += 1
        plan.utime += 100_000
        plan.segments = plan.segments[:1]
        plan.num_segments = len(plan.segments)
        forge(channel, plan, payload)
    if channel:
        kinds_forged.add(channel.split("_")[0])
with open(sys.argv[2], "w") as span:
    print(int(begin * 1e6), int(time.time() * 1e6), file=span)
print(sent, "forged:", *sorted(kinds_forged & {"VICON", "COMMAND", "PLAN"}))
sys.exit(0 if {"VICON", "COMMAND", "PLAN"} <= kinds_forged else 1)
