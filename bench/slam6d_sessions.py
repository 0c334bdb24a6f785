#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Starts the robot in a saved map without a start pose: does 6D SLAM find the robot, and does it report where it does not?

bench/slam6d_sessions.py DRIVE ... [--bin DIR]

A DRIVE is a folder WORLD-SEED with trial.lcmlog and truth.tum, as nodmap-trial writes it. The first half of each drive is mapped. Two robots are then started
in this map: that of the second half of the drive, which may leave the map, and that of the first half of the next drive through the same world, which does
not leave it. Odometry begins at an arbitrary pose, so only the map can show where the robot is. Prints a table for `--localise` and for `--map-in`: when the
robot is first found; the median error of the poses that are right (within 0.5 m and 5 degrees of the truth); and how many poses are right, wrong and
DEGRADED, wrong and TRACKING, or LOST.
"""
import argparse
import math
import pathlib
import statistics
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts" / "figures"))
from moving_clouds import pose_at, read_poses  # noqa: E402

HEADER = struct.Struct(">IqqII")  # sync, number, time, lengths of channel and data
POSE = struct.Struct(">8xq3d4d")  # the fields of a pose_t after its fingerprint: utime, position, orientation; the last byte of the message is the state
TRACKING, DEGRADED, LOST = range(3)
MAX_ERROR_M, MAX_ERROR_RAD = 0.5, math.radians(5.0)


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip()}")
    return done.stdout


def events(log):
    """Yields all events of a log: time, channel, data, and the bytes of the whole event."""
    data = memoryview(log.read_bytes())
    at = 0
    while at + HEADER.size <= len(data):
        _, _, utime, channel_size, data_size = HEADER.unpack_from(data, at)
        begin = at + HEADER.size + channel_size
        yield utime, bytes(data[at + HEADER.size:begin]), data[begin:begin + data_size], data[at:begin + data_size]
        at = begin + data_size


def split(log, first, second):
    times = [utime for utime, *_ in events(log)]
    middle = times[0] + (times[-1] - times[0]) // 2
    with first.open("wb") as before, second.open("wb") as after:
        for utime, channel, _, event in events(log):
            if channel in (b"SCAN", b"ODOMETRY"):
                (before if utime < middle else after).write(event)


def yaw_of(w, x, y, z):
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]


def poses(log):
    """Yields each POSE_6D: time in seconds, (x, y, yaw), state."""
    for _, channel, data, _ in events(log):
        if channel == b"POSE_6D":
            utime, x, y, _, *orientation = POSE.unpack_from(data)
            yield utime * 1e-6, (x, y, yaw_of(*orientation)), data[-1]


def session(programs, log, out, *options):
    run(programs / "nodmap-slam6d", "--replay", log, "--out", out, "--set", "occupancy.publish_period_s=0", "--set", "occupancy.save_every_keyframes=0",
        *options)
    return list(poses(out / "out.lcmlog"))


def evaluate(found, truth, T_map_world):
    """The numbers of poses that are right, wrong and DEGRADED, wrong and TRACKING, and LOST; the errors (m) of the right ones; the time of the first of them."""
    counts, errors, first = [0, 0, 0, 0], [], None
    for time_s, pose, state in found:
        if state == LOST:
            counts[3] += 1
            continue
        off = compose(inverse(compose(T_map_world, pose_at(truth, time_s))), pose)
        error_m, error_rad = math.hypot(off[0], off[1]), abs(math.remainder(off[2], 2 * math.pi))
        is_right = error_m < MAX_ERROR_M and error_rad < MAX_ERROR_RAD
        counts[0 if is_right else 1 if state == DEGRADED else 2] += 1
        if is_right:
            errors.append(error_m)
            first = time_s if first is None else first
    return counts, errors, first


def row(programs, folder, map_dir, T_map_world, drive, half, names):
    truth = read_poses(drive / "truth.tum")
    cells = []
    for name, option in (("localises", "--localise"), ("continues", "--map-in")):
        with tempfile.TemporaryDirectory() as out:
            found = session(programs, folder / f"{half}.lcmlog", pathlib.Path(out) / "out", option, map_dir)
        counts, errors, first = evaluate(found, truth, T_map_world)
        when = f"{first - found[0][0]:.1f} s" if first else "never"
        error = f"{100 * statistics.median(errors):.1f} cm" if errors else ""
        cells.append(f"| {names} | {name} | {when} | {error} | {', '.join(map(str, counts))} |")
    print("\n".join(cells), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("drives", type=pathlib.Path, nargs="+", metavar="DRIVE")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build" / "release" / "bin")
    arguments = parser.parse_args()
    print("| map, robot | | found after | median error | poses: right; wrong, DEGRADED; wrong, TRACKING; LOST |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as work:
        folders = {drive: pathlib.Path(work) / drive.name for drive in arguments.drives}
        for drive, folder in folders.items():
            folder.mkdir()
            split(drive / "trial.lcmlog", folder / "first.lcmlog", folder / "second.lcmlog")
        for drive, following in zip(arguments.drives, [*arguments.drives[1:], None]):
            folder = folders[drive]
            mapped = session(arguments.bin, folder / "first.lcmlog", folder / "map")
            T_map_world = compose(mapped[0][1], inverse(pose_at(read_poses(drive / "truth.tum"), mapped[0][0])))
            row(arguments.bin, folder, folder / "map", T_map_world, drive, "second", f"{drive.name}, its second half")
            if following and following.name.split("-")[0] == drive.name.split("-")[0]:
                row(arguments.bin, folders[following], folder / "map", T_map_world, following, "first", f"{drive.name}, {following.name}")


if __name__ == "__main__":
    main()
