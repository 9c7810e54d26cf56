#!/usr/bin/env python3
"""external_planner.py SCENARIO ROBOT…: computes the plans of a team with planner.algorithm:
external. Each robot turns to its least certain target and drives towards it for a second. Replace
answer() with your own (learned) policy."""
import sys
import numpy
from vantage import live
from vantage_lcm import belief_t, plan_segment_t, plan_t

def answer(channel, asked):
    targets = beliefs[asked.robot].targets if asked.robot in beliefs else []
    asked.segments = []
    if targets:
        least = min(targets, key=lambda t: numpy.linalg.slogdet(t.information_matrix)[1])
        mean = numpy.linalg.solve(least.information_matrix, least.information_vector)
        bearing = numpy.arctan2(mean[1] - asked.start_y_world_m, mean[0] - asked.start_x_world_m)
        turn = numpy.remainder(bearing - asked.start_yaw_world_rad + numpy.pi, 2 * numpy.pi) - numpy.pi
        for speed, yaw_rate, duration in ((0, numpy.sign(turn), abs(turn)), (0.5, 0, 1)):
            segment = plan_segment_t()
            segment.speed_mps, segment.yaw_rate_radps, segment.duration_s = speed, yaw_rate, duration
            asked.segments.append(segment)
    asked.num_segments = len(asked.segments)
    node.publish(f"EXTERNAL_PLAN_{asked.robot}", asked)  # start, time and round as requested

beliefs = {}
node = live.Node("POLICY", scenario=sys.argv[1])
node.subscribe("BELIEF_*", belief_t, lambda channel, belief: beliefs.update({belief.robot: belief}))
for robot in sys.argv[2:]:
    node.subscribe(f"EXTERNAL_REQUEST_{robot}", plan_t, answer)
node.run()
