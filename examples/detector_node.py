#!/usr/bin/env python3
"""detector_node.py SCENARIO ROBOT: custom sensor on the network that replaces vantage-sensor.
ROBOT's estimator uses its detections. Replace find() with your detector."""
import sys
import numpy
from vantage import live
from vantage_lcm import detection_t, measurement_t

def find():  # returns {target id: (range, m; bearing from the robot's heading, rad)}
    return {3: (1.0, 0.5)}

def measure(utime):
    message = measurement_t()
    message.utime, message.robot = utime, sys.argv[2]
    for target, z in find().items():
        seen = detection_t()
        seen.target_id, seen.dim, seen.z = target, 2, z
        seen.covariance_z = numpy.diag([0.1**2, 0.05**2]).tolist()
        message.detections.append(seen)
    message.num_detections = len(message.detections)
    node.publish(f"MEASUREMENT_{message.robot}", message)

node = live.Node("DETECTOR", scenario=sys.argv[1])
node.every(0.5, measure)
node.run()
