#!/usr/bin/env python3
"""Evaluates the beliefs in logs of trials with one robot, for docs/results/tour.md.

  tour_metrics.py --targets 20 --prior-sigma-m 58 far_*.lcmlog

Prints for each log the sum of log det of the targets' position covariances in the last belief, in
nats, and the time since the last observation, in seconds, averaged over targets and beliefs. A
target that has not been discovered has the covariance of the prior and was last observed at the
start. The last line is the mean over the logs.
"""

import argparse
import math
import pathlib
import struct


def events(path, channel):
    """Yields the data of each event of a channel of an LCM event log."""
    data = pathlib.Path(path).read_bytes()
    at = 0
    while at + 28 <= len(data):
        sync, _, _, name_length, length = struct.unpack_from(">IqqII", data, at)
        assert sync == 0xEDA1DA01, f"{path}: no event at byte {at}"
        name = data[at + 28:at + 28 + name_length]
        begin = at + 28 + name_length
        if name.decode() == channel:
            yield data[begin:begin + length]
        at = begin + length


def inverse(matrix):
    """Returns the inverse of a small positive definite matrix by Gauss-Jordan elimination."""
    n = len(matrix)
    rows = [list(row) + [float(i == j) for j in range(n)] for i, row in enumerate(matrix)]
    for i in range(n):
        pivot = rows[i][i]
        rows[i] = [x / pivot for x in rows[i]]
        for j in range(n):
            if j != i:
                factor = rows[j][i]
                rows[j] = [x - factor * y for x, y in zip(rows[j], rows[i])]
    return [row[n:] for row in rows]


def belief(data):
    """Returns the time of a belief_t in s and, for each target, (log det, time last seen in s)."""
    utime, _, _, length = struct.unpack_from(">qqqi", data, 8)
    at = 8 + 28 + length + 8 + 32
    _, count = struct.unpack_from(">ii", data, at)
    at += 8
    targets = []
    for _ in range(count):
        _, dim = struct.unpack_from(">ii", data, at)
        at += 8 + 8 * dim
        values = struct.unpack_from(f">{dim * dim}d", data, at)
        at += 8 * dim * dim
        (seen,) = struct.unpack_from(">q", data, at)
        at += 8
        covariance = inverse([values[dim * i:dim * (i + 1)] for i in range(dim)])
        (xx, xy), (_, yy) = covariance[0][:2], covariance[1][:2]
        targets.append((math.log(xx * yy - xy * xy), 1e-6 * seen))
    return 1e-6 * utime, targets


def evaluate(path, robot, count, prior_sigma_m):
    """Returns the final sum of log det and the mean time since the last observation."""
    start_s = None
    ages_s = []
    log_det = 0.0
    for data in events(path, f"BELIEF_{robot}"):
        now_s, targets = belief(data)
        start_s = now_s if start_s is None else start_s
        unknown = count - len(targets)
        ages_s.append((sum(now_s - max(seen_s, start_s) for _, seen_s in targets) +
                       unknown * (now_s - start_s)) / count)
        log_det = sum(each for each, _ in targets) + unknown * 4.0 * math.log(prior_sigma_m)
    return log_det, sum(ages_s) / len(ages_s)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("logs", nargs="+")
    parser.add_argument("--robot", default="Q1")
    parser.add_argument("--targets", type=int, required=True)
    parser.add_argument("--prior-sigma-m", type=float, required=True)
    asked = parser.parse_args()
    rows = [evaluate(path, asked.robot, asked.targets, asked.prior_sigma_m) for path in asked.logs]
    for path, row in zip(asked.logs, rows):
        print(f"{pathlib.Path(path).name}: log det {row[0]:.2f} nat, unobserved for {row[1]:.2f} s")
    mean = [sum(column) / len(rows) for column in zip(*rows)]
    print(f"mean: log det {mean[0]:.2f} nat, unobserved for {mean[1]:.2f} s")


if __name__ == "__main__":
    main()
