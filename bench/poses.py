# SPDX-License-Identifier: BSD-3-Clause
"""Poses in the plane: (x, y, yaw), metres and radians."""
import bisect
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


def read_tum(path):
    """Reads a trajectory: stamp (s), x, y, yaw of each line."""
    rows = [list(map(float, line.split())) for line in path.read_text().splitlines() if not line.startswith("#")]
    return [(stamp, x, y, yaw_of(qw, qx, qy, qz)) for stamp, x, y, _, qx, qy, qz, qw in rows]


def pose_at(trajectory, stamp):
    """The pose at a stamp, interpolated between the two poses of a trajectory around it."""
    after = min(max(bisect.bisect(trajectory, (stamp,)), 1), len(trajectory) - 1)
    (t0, x0, y0, yaw0), (t1, x1, y1, yaw1) = trajectory[after - 1], trajectory[after]
    share = min(max((stamp - t0) / (t1 - t0), 0.0), 1.0)
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0), yaw0 + share * math.remainder(yaw1 - yaw0, 2.0 * math.pi)
