#!/usr/bin/env python3
"""external_check.py LOG REPORT [--held-up]: checks how the answers in a flight of external.sh were used.

--held-up: the host delayed processes, so late plans are not the planners' fault.
"""
import json
import sys

import vantage

log = vantage.Log(sys.argv[1])
report = json.loads(open(sys.argv[2]).readlines()[-1])
assert report["collisions"] == 0 and report["separation_violations"] == 0, report
counts = {}
for robot in ("Q1", "Q2", "Q3"):
    plans = log[f"PLAN_{robot}"]
    if "--held-up" not in sys.argv:
        assert not plans["late"].any(), robot
        assert (plans["finish_utime"] <= plans["deadline_utime"]).all(), robot
    health = log[f"HEALTH_PLANNER_{robot}"]
    last = slice(*health.offsets["counters"][-2:])
    counts[robot] = dict(zip(health["counters.name"][last], health["counters.count"][last].tolist()))
    counts[robot]["searched"] = int((plans["source"] == 0).sum())
    counts[robot]["plans"] = len(plans["source"])
    print(robot, {k: v for k, v in counts[robot].items() if "external" in k or k in ("searched", "plans",
          "plan_checks_failed", "fallbacks_shifted", "fallbacks_braking")})
assert counts["Q1"]["external_rounds"] >= 3 and counts["Q1"]["external_missing"] >= 3, counts["Q1"]
assert counts["Q1"]["searched"] >= 1, "no plan of the policy was flown"
assert counts["Q2"]["external_late"] >= 5 and counts["Q2"]["searched"] == 0, counts["Q2"]
assert counts["Q3"]["external_refused"] >= 5 and counts["Q3"]["searched"] == 0, counts["Q3"]
assert any(channel == "HEALTH_POLICY" for channel in log.channels), "the node publishes no health"
