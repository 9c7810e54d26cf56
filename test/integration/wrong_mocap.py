#!/usr/bin/env python3
"""A proxy between a mocap and its driver that emulates a lab with a wrong set-up.

  wrong_mocap.py FROM_PORT TO_PORT mirrored|turned-world|turned-bodies|swapped-names

Takes Vicon's UDP object stream from one port of this host to another and changes every object:
the world's y axis is inverted; the world is turned by 90 degrees; every body's x axis points to
its left; Q1 and Q2 have each other's names.
"""

import math
import socket
import struct
import sys

ITEM = struct.Struct("<BH24s6d")  # id, number of bytes that follow, name, mm, rad


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned_about(axis, angle_rad):
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = [[float(a == b) for b in range(3)] for a in range(3)]
    matrix[i][i] = matrix[j][j] = c
    matrix[i][j], matrix[j][i] = -s, s
    return matrix


def world_from_body(angles_rad):
    x, y, z = (turned_about(axis, angle) for axis, angle in enumerate(angles_rad))
    return product(product(x, y), z)


def angles_of(m):
    """Returns the angles (a, b, c) of R = Rx(a) Ry(b) Rz(c)."""
    return math.atan2(-m[1][2], m[2][2]), math.asin(max(-1.0, min(1.0, m[0][2]))), math.atan2(
        -m[0][1], m[0][0])


LEFT = turned_about(2, math.pi / 2)
MIRROR = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]
NAMES = {b"Q1": b"Q2", b"Q2": b"Q1"}


def changed(what, name, position_mm, matrix):
    x, y, z = position_mm
    if what == "mirrored":
        return name, (x, -y, z), product(product(MIRROR, matrix), MIRROR)
    if what == "turned-world":
        return name, (-y, x, z), product(LEFT, matrix)
    if what == "turned-bodies":
        return name, position_mm, product(matrix, LEFT)
    return NAMES.get(name, name), position_mm, matrix


def main():
    from_port, to_port, what = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    if what not in ("mirrored", "turned-world", "turned-bodies", "swapped-names"):
        sys.exit(__doc__)
    mocap = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    mocap.bind(("127.0.0.1", from_port))
    driver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    while True:
        datagram = bytearray(mocap.recv(65536))
        at = 5
        for _ in range(datagram[4]):
            kind, size, name, *numbers = ITEM.unpack_from(datagram, at)
            name, place_mm, matrix = changed(what, name.rstrip(b"\0"), tuple(numbers[:3]),
                                             world_from_body(numbers[3:]))
            ITEM.pack_into(datagram, at, kind, size, name, *place_mm, *angles_of(matrix))
            at += ITEM.size
        driver.sendto(datagram, ("127.0.0.1", to_port))


if __name__ == "__main__":
    main()
