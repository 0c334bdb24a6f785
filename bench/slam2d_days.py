#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether 2D SLAM's costs stay constant for days: the robot drives up and down one corridor, for hours of log time.

bench/slam2d_days.py [--bin DIR] [--hours H ...] [--set KEY=VALUE ...]

For each H it writes a CARMEN log of H hours and maps it. In the log a robot drives up and down a corridor of 24 m with doors, and stops for a minute at each
end. It has a level laser with 181 beams and a range noise of 1 cm, takes a scan every 0.3 s while it drives and every 5 s while it is stationary, and its
wheels drift. Prints a row for each H: the CPU time of a scan, the peak memory without the log, and the size of the map. If the costs are constant, all rows
are alike.
"""
import argparse
import json
import math
import pathlib
import random
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LENGTH_M, HALF_WIDTH_M, STEP_M, STEP_S, STAND_S = 24.0, 1.1, 0.15, 0.3, 60.0
BEAMS, MAX_RANGE_M = 181, 30.0


def walls():
    """The walls as segments (x0, y0, x1, y1): two walls with doors, which are set back by 20 cm and not opposite each other, and the end walls."""
    segments = [(-2.0, -HALF_WIDTH_M, -2.0, HALF_WIDTH_M), (LENGTH_M + 2.0, -HALF_WIDTH_M, LENGTH_M + 2.0, HALF_WIDTH_M)]
    for side, first in ((1.0, 0.5), (-1.0, 2.1)):
        x, y, depth = -2.0, side * HALF_WIDTH_M, side * (HALF_WIDTH_M + 0.2)
        for k in range(6):
            door = first + 3.9 * k + 0.3 * (k % 3)
            segments += [(x, y, door, y), (door, y, door, depth), (door, depth, door + 1.0, depth), (door + 1.0, depth, door + 1.0, y)]
            x = door + 1.0
        segments.append((x, y, LENGTH_M + 2.0, y))
    return segments


def ranges_m(segments, x, y, yaw):
    ranges = []
    for beam in range(BEAMS):
        angle = yaw + math.radians(beam - 90)
        dx, dy = math.cos(angle), math.sin(angle)
        nearest = math.inf
        for x0, y0, x1, y1 in segments:
            det = dx * (y1 - y0) - dy * (x1 - x0)
            if det == 0.0:
                continue
            distance = ((x0 - x) * (y1 - y0) - (y0 - y) * (x1 - x0)) / det
            along = ((x0 - x) * dy - (y0 - y) * dx) / det
            if 0.0 < distance < nearest and 0.0 <= along <= 1.0:
                nearest = distance
        ranges.append(min(nearest, MAX_RANGE_M))
    return ranges


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
    time_s, x, y, yaw, last = 1.6e9, 0.0, 0.0, 0.0, poses[0]
    lines = 0
    with path.open("w", encoding="ascii") as log:
        while time_s < 1.6e9 + 3600.0 * hours:
            for pose, scan in zip(poses, scans):
                ahead = math.hypot(pose[0] - last[0], pose[1] - last[1])
                rotation = (pose[2] - last[2] + math.pi) % (2.0 * math.pi) - math.pi
                yaw += rotation * 1.01 + 0.003 * ahead * noise.gauss(1.0, 1.0)
                x += 1.01 * ahead * math.cos(yaw)
                y += 1.01 * ahead * math.sin(yaw)
                last = pose
                measured = " ".join(f"{max(0.1, r + noise.gauss(0.0, 0.01)):.2f}" if r < MAX_RANGE_M else "81.83" for r in scan)
                at = f"{x:.4f} {y:.4f} {yaw:.5f}"
                log.write(f"ODOM {at} 0 0 0 {time_s:.3f} host {time_s:.3f}\n")
                log.write(f"FLASER {BEAMS} {measured} {at} {at} {time_s:.3f} host {time_s:.3f}\n")
                lines += 1
                time_s += pose[3]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build" / "release" / "bin")
    parser.add_argument("--hours", type=float, nargs="+", default=[3, 6, 12, 24])
    parser.add_argument("--set", nargs="*", default=[], help="parameters of nodmap-slam2d")
    options = parser.parse_args()
    settings = [word for value in options.set for word in ("--set", value)]
    print("| hours | scans | CPU time of a scan | memory | keyframes | submaps | whole map |\n|---|---|---|---|---|---|---|", flush=True)
    for hours in options.hours:
        with tempfile.TemporaryDirectory(prefix="nodmap-days-") as name:
            folder = pathlib.Path(name)
            scans = write_log(folder / "days.clf", hours)
            subprocess.run([options.bin / "nodmap-convert", "carmen", folder / "days.clf", folder / "days.lcmlog"], check=True, capture_output=True)
            (folder / "days.clf").unlink()
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            command = [options.bin / "nodmap-slam2d", "--replay", folder / "days.lcmlog", "--out", folder / "out", *settings]
            process = subprocess.run(["/usr/bin/time", "-f", "%M", *command], check=True, capture_output=True, text=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            # The log is mapped into memory and therefore counted; it is subtracted, because it is not part of the map.
            memory_b = 1024 * int(process.stderr.strip().splitlines()[-1]) - (folder / "days.lcmlog").stat().st_size
            metrics = json.loads((folder / "out" / "result.json").read_text(encoding="utf-8"))["metrics"]
            size = (folder / "out" / "keyframes.lcmlog").stat().st_size
            print(f"| {hours:g} | {scans} | {1e3 * cpu_s / scans:.2f} ms | {memory_b / 1e6:.0f} MB | {metrics['keyframes']} | {metrics['submaps']} "
                  f"| {size / 1e6:.1f} MB |", flush=True)


if __name__ == "__main__":
    main()
