# SPDX-License-Identifier: BSD-3-Clause
"""Poses in the plane: (x, y, yaw), metres and radians."""
import math


def compose(a, b):
    """Composes two poses: transforms b from the frame of a to the frame in which a is given."""
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]


def yaw_of(w, x, y, z):
    """The yaw of a quaternion."""
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
