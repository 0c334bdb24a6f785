#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the scans of a uos folder (KURT3D) as a sequence of clouds for `nodmap-bench-registration sequence OUT`.

bench/kurt3d_clouds.py UOS OUT

Points from 0.5 to 30 m are used, as in nodmap-slam6d. The poses by odometry are also written as the true ones, which are not known: only the time of such a
sequence means something.
"""
import argparse
import array
import math
import pathlib
import struct

METRES = 0.01  # uos files are in centimetres: x to the right, y up, z ahead
NEAREST_M, FARTHEST_M = 0.5, 30.0


def from_uos(x, y, z):
    return METRES * z, -METRES * x, METRES * y


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def rotation(axis, angle_rad):
    """About one axis of uos, whose frame is left-handed."""
    sine, cosine = math.sin(angle_rad), math.cos(angle_rad)
    matrix = [[float(i == j) for j in range(3)] for i in range(3)]
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[a][a] = matrix[b][b] = cosine
    matrix[a][b], matrix[b][a] = -sine, sine
    return matrix


def pose(file):
    numbers = [float(word) for word in file.read_text().split()]
    uos = product(product(*(rotation(axis, math.radians(numbers[3 + axis])) for axis in (0, 1))), rotation(2, math.radians(numbers[5])))
    # Axes x, y, z of the base are z, -x, y of uos.
    axes, signs = (2, 0, 1), (1, -1, 1)
    turned = [[signs[i] * signs[j] * uos[axes[i]][axes[j]] for j in range(3)] for i in range(3)]
    position = from_uos(*numbers[:3])
    return "".join(" ".join(repr(number) for number in (*turned[i], position[i])) + "\n" for i in range(3)) + "0 0 0 1\n"


def cloud(file):
    points = array.array("f")
    for line in file.read_text().splitlines():
        words = line.split()
        if len(words) == 3:
            p = from_uos(*(float(word) for word in words))
            if NEAREST_M < math.hypot(*p) < FARTHEST_M:
                points.extend(p)
    return struct.pack("<Q", len(points) // 3) + points.tobytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("uos", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for k, scan in enumerate(sorted(args.uos.glob("scan*.3d"))):
        (args.out / f"{k:03}.bin").write_bytes(cloud(scan))
        for kind in ("gt", "odo"):
            (args.out / f"{k:03}_{kind}.txt").write_text(pose(scan.with_suffix(".pose")))


if __name__ == "__main__":
    main()
