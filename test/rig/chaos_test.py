#!/usr/bin/env python3
"""chaos_test.py SOURCE_DIR: test/rig/chaos finds the faults of a flight, and test/rig/soak finds quantities that
grow."""
import copy
import importlib.machinery
import importlib.util
import pathlib
import sys

sys.dont_write_bytecode = True


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(pathlib.Path(sys.argv[1]) / "test/rig" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


CHAOS, SOAK = load("chaos"), load("soak")
ROBOT = {"reactions_s": [0.12], "healed": True, "end": "idle", "height_m": 0.0, "states": ["follow"],
         "lost_counted": 100, "twice_counted": 0, "late_counted": 0}
GOOD = {"robots": {"Q1": ROBOT}, "missing": 100, "frames": 1900, "twice": 0, "late": 0, "collisions": 0, "separation_m": 1.2,
        "never_flown": [], "left_flying": []}


def spoilt(**changes):
    seen = copy.deepcopy(GOOD)
    for key, value in changes.items():
        (seen if key in seen else seen["robots"]["Q1"])[key] = value
    return seen


def test_good_flight_has_no_fault():
    assert CHAOS.judge(GOOD, True) == []


def test_each_fault_is_found():
    for changes in ({"reactions_s": [None]}, {"reactions_s": [0.12, 0.5]}, {"healed": False}, {"end": "follow"}, {"height_m": 1.0},
                    {"lost_counted": 10}, {"collisions": 1}, {"separation_m": 0.4}, {"never_flown": ["Q1"]},
                    {"left_flying": ["Q1"]}):
        assert CHAOS.judge(spoilt(**changes), True), changes
    assert CHAOS.judge(GOOD, False), "losses are a fault if the network is undisturbed"


def test_arrivals_are_classified():
    frames = [(0.0, 1, 1), (0.1, 1, 2), (0.2, 1, 2), (0.3, 1, 4), (0.4, 1, 3), (0.5, 1, 5)]
    assert CHAOS.arrivals(frames) == ([0.0, 0.1, 0.3, 0.5], 1, 1)


def test_reactions_count_only_while_following():
    fresh = [0.0, 0.02, 1.02, 1.04, 2.04]
    statuses = [(0.0, "follow"), (0.13, "hold"), (1.03, "hold"), (1.5, "follow")]
    # During the second gap, the vehicle is already in HOLD.
    assert [round(each, 2) for each in CHAOS.reactions(fresh, statuses)] == [0.11]
    assert CHAOS.reactions(fresh, [(0.0, "follow")]) == [None, None]


def test_recovery_means_following_again_or_being_on_the_ground():
    assert CHAOS.has_recovered([(9.0, "hold"), (12.0, "follow")], 10.0)
    assert CHAOS.has_recovered([(9.0, "land"), (12.0, "idle")], 10.0)
    assert not CHAOS.has_recovered([(9.0, "hold"), (12.0, "hold")], 10.0)
    assert not CHAOS.has_recovered([(9.0, "hold"), (17.0, "follow")], 10.0)
    assert not CHAOS.has_recovered([], 10.0)


def test_there_are_sixty_cells():
    assert 3 * len(CHAOS.KINDS) >= 60


def test_slope_is_in_mebibytes_per_day():
    assert abs(SOAK.slope([(t, 1000 + t * 1024 / 86_400) for t in range(0, 1000, 5)]) - 1.0) < 1e-9
    assert SOAK.slope([(0.0, 1), (5.0, 1)]) is None
    assert SOAK.settled([(t, 0) for t in range(101)])[0][0] == 10
    assert SOAK.settled([(t * 3600.0, 0) for t in range(101)])[0][0] == 3600.0


def soaked(descriptors, memory_kib=lambda i: 1000, period_s=5.0):
    samples = [{"s": period_s * i, "log_bytes": 0, "processes": [["sim", 7, memory_kib(i), descriptors(i), 2]]} for i in range(40)]
    up = {"collisions": 0, "restarts": 0, "log": {"unrecorded_s": 0.0}}
    return SOAK.table(samples, up, {"wire.Q1.pose_p99_us": 5000}, [])


def test_growth_is_a_fault():
    text, faults = soaked(lambda i: 9)
    assert faults == [] and "| sim | 1 |" in text and "| wire.Q1.pose |  | 5.00 |  |" in text
    assert soaked(lambda i: 9 + i // 10)[1], "leaked descriptors are a fault"
    assert soaked(lambda i: 9 + (i == 20))[1] == [], "one temporarily open file is not a fault"


def test_memory_growth_over_hours_is_a_fault():
    kib_per_s = 1024 / 86_400  # 1 MiB per day

    def rises(mib_per_day, period_s=300.0):
        return soaked(lambda i: 9, lambda i: 1000 + mib_per_day * kib_per_s * period_s * i, period_s)[1]

    assert len(rises(1.1)) == 1 and "1.1 MiB per day" in rises(1.1)[0]
    assert rises(0.9) == []
    assert rises(100.0, 5.0) == [], "growth during the first minutes is not a fault"


for name, test in sorted(globals().items()):
    if name.startswith("test_"):
        test()
