#!/usr/bin/env python3
"""foreign_log.py FOLDER: writes FOLDER/foreign.lcmlog, half a minute of an arm that is not part of vantage, and
FOLDER/types, the .lcm files of its messages. The Python code of lcm-gen encodes them; the log follows LCM's
specification. One more channel has a type that no file describes."""
import importlib
import math
import pathlib
import struct
import subprocess
import sys

TYPES = {
    "vector_t": "package demo_arm; struct vector_t { double x, y, z; }",
    "state_t": """package demo_arm;
struct state_t
{
  int64_t utime;
  string name;
  int32_t num_joints;
  double position_rad[num_joints];
  float effort_nm[num_joints][2];
  vector_t tip_m;
  boolean is_enabled;
}""",
    "power_t": "package demo_arm; struct power_t { int64_t utime; double voltage_v, current_a; int8_t cell; }"}
START_UTIME = 1_700_000_000_000_000
RATE_HZ = 20
LENGTH_S = 30
JOINTS = 6


def state_at(of, since_s):
    state = of.state_t()
    state.utime = START_UTIME + round(1e6 * since_s)
    state.name = "arm"
    state.num_joints = JOINTS
    state.position_rad = [0.5 * math.sin(2.0 * math.pi * since_s / 10.0 + j) for j in range(JOINTS)]
    state.effort_nm = [[float(j), since_s] for j in range(JOINTS)]
    state.tip_m.x, state.tip_m.y, state.tip_m.z = math.cos(since_s), math.sin(since_s), 1.0 + 0.1 * since_s
    state.is_enabled = since_s > 10.0
    return state.encode()


def power_at(of, since_s):
    power = of.power_t()
    power.utime = START_UTIME + round(1e6 * since_s)
    power.voltage_v, power.current_a, power.cell = 24.0 - 0.1 * since_s, 3.0, int(since_s) % 4
    return power.encode()


def main():
    folder = pathlib.Path(sys.argv[1])
    types = folder / "types"
    types.mkdir()
    for name, text in TYPES.items():
        (types / f"{name}.lcm").write_text(text)
    subprocess.run(["lcm-gen", "--python", "--ppath", folder, *types.glob("*.lcm")], check=True)
    sys.path.insert(0, str(folder))
    made = importlib.import_module("demo_arm")
    with open(folder / "foreign.lcmlog", "wb") as log:
        for number in range(RATE_HZ * LENGTH_S):
            since_s = number / RATE_HZ
            for i, (channel, data) in enumerate((
                    ("ARM_STATE", state_at(made, since_s)), ("POWER", power_at(made, since_s)),
                    ("SECRET", bytes(range(8)) + b"of a type that nobody told"))):
                log.write(struct.pack(">IqqII", 0xEDA1DA01, 3 * number + i,
                                      START_UTIME + round(1e6 * since_s), len(channel), len(data)))
                log.write(channel.encode() + data)


if __name__ == "__main__":
    main()
