#!/usr/bin/env python3
"""Computes the costs of plans of `vantage experiment search-or-sampling` again.

  rescore_plans.py DIRECTORY [--problems 100]

Reads the tables in the experiment's directory and computes J of each complete plan by the plain
recursion, without code of vantage: prediction, then an update with the information of each
measurement. The problems are spread over the families. Also checks that no cost is below a
certified bound of its problem, and that no pose is inside a box. Exit status 1 on a difference.
"""

import argparse
import csv
import math
import pathlib
import sys


def rows_of(directory, table):
    """Returns the rows of a table by (family, trial)."""
    out = {}
    with open(directory / f"{table}.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            out.setdefault((row["family"], int(row["trial"])), []).append(row)
    return out


def times(a, b):
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]


def transposed(a):
    return [list(row) for row in zip(*a)]


def plus(a, b):
    return [[x + y for x, y in zip(p, q)] for p, q in zip(a, b)]


def determinant_and_inverse(a):
    """Returns determinant and inverse of a positive definite matrix, by Gauss-Jordan elimination."""
    n = len(a)
    rows = [list(row) + [float(i == j) for j in range(n)] for i, row in enumerate(a)]
    det = 1.0
    for i in range(n):
        pivot = rows[i][i]
        det *= pivot
        rows[i] = [x / pivot for x in rows[i]]
        for j in range(n):
            if j != i:
                factor = rows[j][i]
                rows[j] = [x - factor * y for x, y in zip(rows[j], rows[i])]
    return det, [row[n:] for row in rows]


def is_blocked(a, b, boxes):
    """True if the segment from a to b crosses the interior of a box."""
    for box in boxes:
        low, high = 0.0, 1.0
        for axis, (least, most) in enumerate((box[0::2], box[1::2])):
            way = b[axis] - a[axis]
            if way == 0.0:
                if not least < a[axis] < most:
                    low, high = 1.0, 0.0
                continue
            ends = sorted(((least - a[axis]) / way, (most - a[axis]) / way))
            low, high = max(low, ends[0]), min(high, ends[1])
        if low < high:
            return True
    return False


def information(problem, pose, mean, boxes):
    """Returns the information of one measurement about the position, or None if not visible."""
    x, y, yaw = pose
    dx, dy = mean[0] - x, mean[1] - y
    r = math.hypot(dx, dy)
    if not float(problem["range_min_m"]) <= r < float(problem["range_max_m"]) or r == 0.0:
        return None
    bearing = math.remainder(math.atan2(dy, dx) - yaw, 2.0 * math.pi)
    fov = float(problem["fov_rad"])
    if fov < 2.0 * math.pi - 1e-9 and abs(bearing) >= 0.5 * fov:
        return None
    if is_blocked((x, y), mean, boxes):
        return None
    along = 0.0 if problem["sensor"] == "bearing" else float(problem["range_sigma_m"]) ** -2
    across = 0.0 if problem["sensor"] == "range" else (
        float(problem["bearing_sigma_rad"]) * r) ** -2
    ux, uy = dx / r, dy / r
    return [[along * ux * ux + across * uy * uy, (along - across) * ux * uy],
            [(along - across) * ux * uy, along * uy * uy + across * ux * ux]]


def cost_of(problem, targets, boxes, poses):
    """Returns J of the poses."""
    dt = float(problem["step_s"])
    cost = 0.0
    for target in targets:
        mean = [float(target[key]) for key in ("x_m", "y_m", "vx_mps", "vy_mps")]
        p, v = float(target["position_variance_m2"]), float(target["velocity_variance_m2ps2"])
        q = float(target["q"])
        n = 4 if target["kind"] == "double_integrator" else 2
        eye = [[float(i == j) for j in range(n)] for i in range(n)]
        step = [list(row) for row in eye]
        noise = [[0.0] * n for _ in range(n)]
        covariance = [[(p if i < 2 else v) * float(i == j) for j in range(n)] for i in range(n)]
        if n == 4:
            for i in range(2):
                step[i][i + 2] = dt
                noise[i][i] = q * dt ** 3 / 3.0
                noise[i][i + 2] = noise[i + 2][i] = q * dt ** 2 / 2.0
                noise[i + 2][i + 2] = q * dt
        elif target["kind"] == "random_walk":
            for i in range(2):
                noise[i][i] = q * dt
        for pose in poses:
            mean = [sum(a * b for a, b in zip(row, mean[:n])) for row in step]
            covariance = plus(times(times(step, covariance), transposed(step)), noise)
            gained = information(problem, pose, mean[:2], boxes)
            if gained is not None:
                _, inverse = determinant_and_inverse(covariance)
                for i in range(2):
                    for j in range(2):
                        inverse[i][j] += gained[i][j]
                _, covariance = determinant_and_inverse(inverse)
            if problem["cost"] == "trace":
                cost += sum(covariance[i][i] for i in range(n))
            else:
                cost += math.log(determinant_and_inverse(covariance)[0])
    return cost


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--problems", type=int, default=100)
    asked = parser.parse_args()
    tables = {name: rows_of(asked.directory, name)
              for name in ("problems", "targets", "boxes", "poses", "plans")}
    units = sorted(tables["problems"], key=lambda unit: (unit[1], unit[0]))[:asked.problems]
    worst, plans, errors = 0.0, 0, 0
    for unit in units:
        problem = tables["problems"][unit][0]
        boxes = [[float(row[key]) for key in ("x_min_m", "y_min_m", "x_max_m", "y_max_m")]
                 for row in tables["boxes"].get(unit, [])]
        bound = max(float(row["lower_bound"]) for row in tables["plans"][unit])
        for plan in tables["plans"][unit]:
            poses = [tuple(float(row[key]) for key in ("x_m", "y_m", "yaw_rad"))
                     for row in tables["poses"].get(unit, []) if row["method"] == plan["method"]]
            if not poses:
                continue
            plans += 1
            told = float(plan["cost"])
            again = cost_of(problem, tables["targets"].get(unit, []), boxes, poses)
            difference = abs(again - told) / max(1.0, abs(told))
            worst = max(worst, difference)
            in_box = any(box[0] < x < box[2] and box[1] < y < box[3]
                         for box in boxes for x, y, _ in poses)
            if difference > 1e-6 or again < bound - 1e-6 * max(1.0, abs(bound)) or in_box:
                errors += 1
                print(f"{unit} {plan['method']}: cost {told}, computed {again}, bound {bound}, "
                      f"inside a box: {in_box}")
    print(f"{plans} plans of {len(units)} problems, largest relative difference {worst:.2g}, "
          f"{errors} errors")
    return 1 if errors or not plans else 0


if __name__ == "__main__":
    sys.exit(main())
