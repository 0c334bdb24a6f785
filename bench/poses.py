# SPDX-License-Identifier: BSD-3-Clause
"""Poses in the plane: (x, y, yaw), metres and radians; and heights."""
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


def read_heights(path):
    """Reads the heights of a trajectory: stamp (s) and z (m) of each line."""
    return [(row[0], row[3]) for row in (list(map(float, line.split())) for line in path.read_text().splitlines() if not line.startswith("#"))]


def greatest_height_error(heights, truth):
    """The greatest error (m) of the heights above the first one. `truth`: has a height within milliseconds of each stamp."""
    stamps = [stamp for stamp, _ in truth]
    true_heights = [truth[min(bisect.bisect_left(stamps, stamp), len(truth) - 1)][1] for stamp, _ in heights]
    return max(abs((z - heights[0][1]) - (true_z - true_heights[0])) for (_, z), true_z in zip(heights, true_heights))


def pose_at(trajectory, stamp):
    """The pose at a stamp, interpolated between the two poses of a trajectory around it."""
    after = min(max(bisect.bisect(trajectory, (stamp,)), 1), len(trajectory) - 1)
    (t0, x0, y0, yaw0), (t1, x1, y1, yaw1) = trajectory[after - 1], trajectory[after]
    share = min(max((stamp - t0) / (t1 - t0), 0.0), 1.0)
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0), yaw0 + share * math.remainder(yaw1 - yaw0, 2.0 * math.pi)
