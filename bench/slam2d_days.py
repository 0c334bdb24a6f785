#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether 2D SLAM's costs stay constant for days: the robot drives up and down one corridor, for hours of log time.

bench/slam2d_days.py [--bin DIR] [--hours H ...] [--set KEY=VALUE ...]

For each H it writes a CARMEN log of H hours and maps it. In the log a robot drives up and down a corridor of 24 m with doors, and stops for a minute at each
end. It has a level laser with 181 beams and a range noise of 1 cm, takes a scan every 0.3 s while it drives and every 5 s while it is stationary, and its
wheels drift. Prints a row for each H: the CPU time of a scan and of a *further* one, of those which the row before does not have (the former contains what is done
once at the end), the peak memory without the log, and the size of the map. If the costs are constant, all further scans are alike.
"""
import math
import pathlib
import random
import tempfile

from days import BEAMS, LENGTH_M, MAX_RANGE_M, Wheels, further, map_recording, parser, wall_m, walls
from programs import call

STEP_M, STEP_S, STAND_S = 0.15, 0.3, 60.0


def ranges_m(segments, x, y, yaw):
    return [min(wall_m(segments, x, y, yaw + math.radians(beam - 90)), MAX_RANGE_M) for beam in range(BEAMS)]


def lap():
    """The poses of one lap, each with the time to the next: along the corridor, rotate, back, and rotate."""
    poses = []
    steps = round(LENGTH_M / STEP_M)
    for heading, xs in ((0.0, range(steps + 1)), (math.pi, range(steps, -1, -1))):
        poses += [(STEP_M * k, 0.3 * math.sin(STEP_M * k), heading, STEP_S) for k in xs]
        end = poses[-1]
        poses += [(end[0], end[1], heading, 5.0)] * round(STAND_S / 5.0)
        poses += [(end[0], end[1], heading + math.radians(10 * k), STEP_S) for k in range(1, 18)]
    return poses


def write_log(path, hours, seed=1):
    noise = random.Random(seed)
    segments = walls()
    poses = lap()
    scans = [ranges_m(segments, *pose[:3]) for pose in poses]
    wheels = Wheels(poses[0][:3], lambda ahead: 0.003 * ahead * noise.gauss(1.0, 1.0))
    time_s = 1.6e9
    lines = 0
    with path.open("w", encoding="ascii") as log:
        while time_s < 1.6e9 + 3600.0 * hours:
            for pose, scan in zip(poses, scans):
                x, y, yaw = wheels.count(pose[:3])
                measured = " ".join(f"{max(0.1, r + noise.gauss(0.0, 0.01)):.2f}" if r < MAX_RANGE_M else "81.83" for r in scan)
                at = f"{x:.4f} {y:.4f} {yaw:.5f}"
                log.write(f"ODOM {at} 0 0 0 {time_s:.3f} host {time_s:.3f}\n")
                log.write(f"FLASER {BEAMS} {measured} {at} {at} {time_s:.3f} host {time_s:.3f}\n")
                lines += 1
                time_s += pose[3]
    return lines


def main():
    options = parser(__doc__, [3, 6, 12, 24], "nodmap-slam2d").parse_args()
    print("| hours | scans | CPU time of a scan | of a further one | memory | keyframes | submaps | whole map |\n|---|---|---|---|---|---|---|---|", flush=True)
    before = None
    for hours in options.hours:
        with tempfile.TemporaryDirectory(prefix="nodmap-days-") as name:
            folder = pathlib.Path(name)
            scans = write_log(folder / "days.clf", hours)
            call(options.bin / "nodmap-convert", "carmen", folder / "days.clf", folder / "days.lcmlog")
            (folder / "days.clf").unlink()
            cpu_s, memory_b, metrics = map_recording(options, "nodmap-slam2d", folder)
            size = (folder / "out" / "keyframes.lcmlog").stat().st_size
            print(f"| {hours:g} | {scans} | {1e3 * cpu_s / scans:.2f} ms | {further(cpu_s, scans, before)} | {memory_b / 1e6:.0f} MB | {metrics['keyframes']} | {metrics['submaps']} "
                  f"| {size / 1e6:.1f} MB |", flush=True)
            before = cpu_s, scans


if __name__ == "__main__":
    main()
