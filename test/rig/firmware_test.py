#!/usr/bin/env python3
"""firmware_test.py SOURCE_DIR: test/rig/firmware finds violated limits in the output of hil_check."""
import importlib.machinery
import importlib.util
import pathlib
import sys

sys.dont_write_bytecode = True
_loader = importlib.machinery.SourceFileLoader("firmware", str(pathlib.Path(sys.argv[1]) / "test/rig/firmware"))
FIRMWARE = importlib.util.module_from_spec(importlib.util.spec_from_loader("firmware", _loader))
_loader.exec_module(FIRMWARE)


def output_of(what, further_m=0.30, outside_m=-0.20, down_s=-1.0, states=""):
    """Returns two lines of hil_check --events with a budget of 0.50 m."""
    return (f"{what} Q1: 0.98 m/s, {further_m:.2f} m further (0.50 budgeted), {outside_m:.2f} m outside, inf m from "
            f"others, 0.10 m off course, down after {down_s:.1f} s\nSAID {what} Q1{states}\n")


def test_flight_within_its_limits_has_no_fault():
    assert FIRMWARE.broken(output_of("hold", states="; hold 0.05 (ordered)")) == []
    assert FIRMWARE.broken(output_of("plan-loss", further_m=3.0)) == []
    assert FIRMWARE.broken(output_of("cut", down_s=7.9, states="; hold 0.4 (autopilot silent); land 2.1")) == []
    assert FIRMWARE.broken(output_of("kill:up", down_s=8.0)) == []
    assert FIRMWARE.broken(output_of("kill:vicon", states="; hold 0.05 (pose stale); follow 2.1")) == []
    assert FIRMWARE.broken(output_of("kill:quadrotor", down_s=9.9, states="; land 1.9 (found flying)")) == []


def test_exceeding_the_budget_is_a_fault():
    assert len(FIRMWARE.broken(output_of("hold", further_m=0.53))) == 1
    assert FIRMWARE.broken(output_of("hold", further_m=0.52)) == []  # within the tolerance, the motion between two TRUTH frames
    assert FIRMWARE.broken(output_of("cut", further_m=0.90, down_s=5.0)) == []  # after a cut, this distance has no limit


def test_leaving_the_bounds_beyond_the_budget_is_a_fault():
    for what in ("hold", "cut", "kill:up", "stop:sensor"):
        assert len(FIRMWARE.broken(output_of(what, outside_m=0.51, down_s=4.0))) == 1, what
        assert FIRMWARE.broken(output_of(what, outside_m=0.50, down_s=4.0)) == [], what


def test_staying_in_the_air_is_a_fault():
    for what in ("cut", "kill:up", "stop:vicon", "stall:1"):
        assert len(FIRMWARE.broken(output_of(what))) == 1, what
        assert len(FIRMWARE.broken(output_of(what, down_s=8.1, states="; hold 0.1; land 0.6"))) == 1, what
    assert len(FIRMWARE.broken(output_of("kill:quadrotor", down_s=10.1, states="; land 1.9"))) == 1
    assert FIRMWARE.broken(output_of("stop:up", down_s=10.9, states="; hold 1.0; land 3.0")) == []
    assert len(FIRMWARE.broken(output_of("stop:up", down_s=11.1, states="; hold 1.0; land 3.0"))) == 1
    # A hold that begins long after the event does not count as a reaction in time.
    assert len(FIRMWARE.broken(output_of("kill:quadrotor", down_s=20.0, states="; hold 8.5"))) == 1


def test_each_vehicle_is_checked():
    two = output_of("cut", down_s=9.0) + "collision: Q1 with R2\n" + output_of("cut", down_s=9.5)
    assert len(FIRMWARE.broken(two)) == 2


def test_contacts_between_vehicles_always_count():
    text = "collision: Q1 with Q2\ncollision: Q1 with R2\ncollision: R1 with R2\ncollision: Q1 with bounds\n"
    assert FIRMWARE.contacts(text, False) == text.strip().splitlines()
    assert FIRMWARE.contacts(text, True) == ["collision: Q1 with Q2"]


for _name, _test in list(globals().items()):
    if _name.startswith("test_"):
        _test()
        print("passed", _name)
