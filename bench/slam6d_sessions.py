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
import tempfile

from event_log import Writer, events, poses_of
from poses import compose, inverse, pose_at, read_tum
from programs import BIN, call

TRACKING, DEGRADED, LOST = range(3)
MAX_ERROR_M, MAX_ERROR_RAD = 0.5, math.radians(5.0)


def split(log, first, second):
    times = [event.utime for event in events(log)]
    middle = times[0] + (times[-1] - times[0]) // 2
    with Writer(first) as before, Writer(second) as after:
        for event in events(log):
            if event.channel in ("SCAN", "ODOMETRY"):
                (before if event.utime < middle else after).write(event)


def session(programs, log, out, *options):
    call(programs / "nodmap-slam6d", "--replay", log, "--out", out, "--set", "occupancy.publish_period_s=0", "--set", "occupancy.save_every_keyframes=0",
         *options)
    return list(poses_of(out / "out.lcmlog", "POSE_6D"))


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
    truth = read_tum(drive / "truth.tum")
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
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
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
            T_map_world = compose(mapped[0][1], inverse(pose_at(read_tum(drive / "truth.tum"), mapped[0][0])))
            row(arguments.bin, folder, folder / "map", T_map_world, drive, "second", f"{drive.name}, its second half")
            if following and following.name.split("-")[0] == drive.name.split("-")[0]:
                row(arguments.bin, folders[following], folder / "map", T_map_world, following, "first", f"{drive.name}, {following.name}")


if __name__ == "__main__":
    main()
