#!/usr/bin/env python3
"""mrclam_folder.py FOLDER [SECONDS]: writes a small data set in the format of UTIAS MRCLAM: three simulated
robots among twelve landmarks. The cameras report 1.03 times the depth plus 0.1 m, with stamps 0.04 s late.
Each camera is 0.08 m ahead of the robot's tracked point. Commands act after 0.15 s, and turns are 4 % too
small.
"""
import math
import pathlib
import random
import sys

STEP_S = 0.02
ROBOTS = 3
SCALE, OFFSET_M, FORWARD_M, STAMP_DELAY_S = 1.03, 0.1, 0.08, 0.04
COMMAND_DELAY_S, TURN_SCALE = 0.15, 0.96
LANDMARKS = {6 + k: (4 * math.cos(k * math.pi / 6), 3 * math.sin(k * math.pi / 6)) for k in range(12)}


def sightings(seen, pose, draw):
    """Returns (subject, range, bearing) of the points in `seen` that a robot at `pose` observes."""
    x, y, yaw = pose
    x, y = x + FORWARD_M * math.cos(yaw), y + FORWARD_M * math.sin(yaw)
    for subject, (at_x, at_y) in seen.items():
        distance_m = math.hypot(at_x - x, at_y - y)
        bearing_rad = math.remainder(math.atan2(at_y - y, at_x - x) - yaw, 2 * math.pi)
        if abs(bearing_rad) < 0.58 and 0.6 < distance_m < 8:
            sigma_m = 0.02 + 0.001 * distance_m ** 2
            yield (subject, SCALE * distance_m * math.cos(bearing_rad) + OFFSET_M + draw.gauss(0, sigma_m),
                   bearing_rad + draw.gauss(0, 0.008))


def main():
    folder = pathlib.Path(sys.argv[1])
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 90
    draw = random.Random(7)
    begin_s = 1248444175.1
    poses = [[1.5 * math.cos(2.1 * k), 1.5 * math.sin(2.1 * k), 2.1 * k + 1] for k in range(ROBOTS)]
    turns, speeds = [0.0] * ROBOTS, [0.15] * ROBOTS
    waiting = [[(0.0, 0.0)] * round(COMMAND_DELAY_S / STEP_S) for _ in range(ROBOTS)]
    files = {(k, kind): [] for k in range(ROBOTS) for kind in ("Odometry", "Measurement", "Groundtruth")}
    for step in range(round(seconds / STEP_S)):
        at_s = begin_s + step * STEP_S
        for k, pose in enumerate(poses):
            if step % 60 == 0:
                turns[k] = draw.uniform(-0.4, 0.4)
                if math.hypot(pose[0] / 4, pose[1] / 3) > 0.5:  # turn to the middle
                    turns[k] = 0.6 * math.copysign(1, math.remainder(
                        math.atan2(-pose[1], -pose[0]) - pose[2], 2 * math.pi))
                speeds[k] = draw.uniform(0.05, 0.2)
            files[k, "Odometry"].append(f"{at_s:.3f} \t {speeds[k]:.4f} \t {turns[k]:.4f}")
            files[k, "Groundtruth"].append(f"{at_s:.3f} \t {pose[0]:.6f} \t {pose[1]:.6f} \t {pose[2]:.6f}")
            waiting[k].append((speeds[k], turns[k]))
            speed_mps, turn_radps = waiting[k].pop(0)
            turn_rad = TURN_SCALE * turn_radps * STEP_S
            pose[0] += speed_mps * STEP_S * math.cos(pose[2] + turn_rad / 2)
            pose[1] += speed_mps * STEP_S * math.sin(pose[2] + turn_rad / 2)
            pose[2] += turn_rad
        if step % 10 == 0:
            for k, pose in enumerate(poses):
                seen = LANDMARKS | {1 + j: poses[j][:2] for j in range(ROBOTS) if j != k}
                for subject, range_m, bearing_rad in sightings(seen, pose, draw):
                    files[k, "Measurement"].append(f"{at_s + STEP_S + STAMP_DELAY_S:.3f} \t {10 * subject} \t "
                                                   f"{range_m:.4f} \t {bearing_rad:.4f}")
    folder.mkdir(parents=True)
    write = lambda name, rows: (folder / name).write_text("# synthetic\n" + "".join(row + "\n" for row in rows))
    for (k, kind), rows in files.items():
        write(f"Robot{k + 1}_{kind}.dat", rows)
    write("Barcodes.dat", [f"{subject} \t {10 * subject}" for subject in [*range(1, ROBOTS + 1), *LANDMARKS]])
    write("Landmark_Groundtruth.dat",
          [f"{subject} \t {x:.6f} \t {y:.6f} \t 0.0001 \t 0.0001" for subject, (x, y) in LANDMARKS.items()])


if __name__ == "__main__":
    main()
