# SPDX-License-Identifier: BSD-3-Clause
"""Reads what the programs write: trajectories, tables, clouds and maps, as numpy arrays."""
import csv
import re

import numpy as np
import poses


def read_tum(path):
    """Reads a trajectory: stamps (s), positions (n x 2, m) and headings (rad)."""
    rows = np.array(poses.read_tum(path))
    return rows[:, 0], rows[:, 1:3], rows[:, 3]


def read_table(path):
    """Reads the columns of a CSV by name, without a list at the end of each row. Adds time_s, seconds since the first row."""
    with open(path, newline="") as file:
        rows = csv.reader(file)
        names = next(rows)
        values = np.array([[float(word) for word in row[:len(names)]] for row in rows if len(row) >= len(names) - 1])
    table = {name: values[:, i] for i, name in enumerate(names[:values.shape[1]])}
    table["time_s"] = 1e-6 * (table["utime_us"] - table["utime_us"][0])
    return table


def read_last_map(path):
    """Reads the points of the last message of an egocentric map: n x 3, m, in base."""
    with open(path) as file:
        names = next(file).strip().split(",")
        for line in file:
            last = line
    values = np.array([float(word) for word in last.split(",")[len(names) - 1:]])
    points = values.reshape(-1, 3)
    return points[np.isfinite(points).all(axis=1)]


def read_ply(path):
    """Reads the points (n x 3, m) of a binary PLY that nodmap has written."""
    data = path.read_bytes()
    head, body = data.split(b"end_header\n", 1)
    count = int(next(line for line in head.splitlines() if line.startswith(b"element vertex")).split()[2])
    vertex = np.dtype([("p", "<f4", 3), ("rgb", "u1", 3), ("time", "<f8"), ("sigma", "<f4")])
    return np.frombuffer(body, vertex, count)["p"].astype(float)


def read_grid(yaml_path):
    """Reads a ROS map: the image (rows from the top; 0 is occupied, 255 free) and its extent (left, right, bottom, top; m)."""
    fields = dict(line.split(":", 1) for line in yaml_path.read_text().splitlines() if ":" in line)
    resolution_m = float(fields["resolution"])
    left, bottom = [float(word) for word in fields["origin"].strip(" []").split(",")[:2]]
    data = (yaml_path.parent / fields["image"].strip()).read_bytes()
    width, height = (int(word) for word in re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", data).groups())
    grid = np.frombuffer(data[-width * height:], np.uint8).reshape(height, width)
    return grid, (left, left + width * resolution_m, bottom, bottom + height * resolution_m)


def to_start(positions, yaw):
    """Transforms a trajectory to the frame of its first pose, in the plane: positions n x 2 (m), headings (rad)."""
    c, s = np.cos(yaw[0]), np.sin(yaw[0])
    moved = positions - positions[0]
    return moved @ np.array([[c, -s], [s, c]]), np.angle(np.exp(1j * (yaw - yaw[0])))
