#!/usr/bin/env python3
"""external_faults.py SCENARIO: answers Q2 one round too late, and Q3 with plans that no vehicle can fly."""
import sys

from vantage import live
from vantage_lcm import plan_segment_t, plan_t

node = live.Node("FAULTS", scenario=sys.argv[1])
before = []


def send(asked, speed_mps):
    segment = plan_segment_t()
    segment.speed_mps, segment.duration_s = speed_mps, 1.0
    asked.segments, asked.num_segments = [segment], 1
    node.publish(f"EXTERNAL_PLAN_{asked.robot}", asked)


def late(channel, asked):
    before.append(asked)
    if len(before) > 1:
        send(before.pop(0), 0.5)


node.subscribe("EXTERNAL_REQUEST_Q2", plan_t, late)
node.subscribe("EXTERNAL_REQUEST_Q3", plan_t, lambda channel, asked: send(asked, 50.0))
node.run()
