#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether 6D SLAM's costs stay constant for days: the robot drives up and down one corridor, for hours of log time.

bench/slam6d_days.py [--bin DIR] [--hours H ...] [--set KEY=VALUE ...]

Writes the recording of a robot that drives up and down the corridor of bench/days.py and stops for a minute at each end: a nodding laser with 181 beams
and a range noise of 1 cm, 75 scans a second, wheels that drift. Maps a recording of H hours for each H and prints a row: CPU time of a sweep, peak
memory without the recording (sampled every 50 ms), what the map holds, and the error of all poses. The CPU time is that of the whole process, by the number of
sweeps; it contains the final adjustment once, and falls with the hours. That of a *further* sweep, of those which the row before does not
have, shows whether costs grow. If the costs are constant, all further sweeps are alike.
"""
import math
import pathlib
import random
import re
import struct
import tempfile

from days import BEAMS, LENGTH_M, MAX_RANGE_M, Wheels, further, map_recording, parser, wall_m, walls
from event_log import Event, Writer
from programs import ROOT, evaluate

PERIOD_US, SPEED_MPS, TURN_RAD_S, STAND_S = 13320, 0.6, 0.6, 60.0
NOD_SCANS, HIGHEST_DEG = 160, 40.0  # down and up again
CEILING_M, LASER_M, NOISE_M = 2.5, 0.5, 0.01


def lap():
    """Poses (x, y, yaw) of all scans of one lap, which is a whole number of nods: there, stand, round; back, stand, round."""
    poses = []
    steps = round(LENGTH_M / (SPEED_MPS * PERIOD_US * 1e-6))
    for there in (True, False):
        for k in range(steps):
            x = LENGTH_M * (k if there else steps - k) / steps
            poses.append((x, 0.2 * math.sin(0.5 * x), math.atan(0.1 * math.cos(0.5 * x)) + (0.0 if there else math.pi)))
        x = LENGTH_M if there else 0.0
        y = 0.2 * math.sin(0.5 * x)
        yaw = math.atan(0.1 * math.cos(0.5 * x)) + (0.0 if there else math.pi)
        poses += [(x, y, yaw)] * round(STAND_S / (PERIOD_US * 1e-6))
        turns = round(math.pi / (TURN_RAD_S * PERIOD_US * 1e-6))
        poses += [(x, y, yaw + math.pi * k / turns) for k in range(turns)]
    return poses + [(poses[-1][0], poses[-1][1], yaw + math.pi)] * (-len(poses) % NOD_SCANS)


def pitch_rad(scan):
    phase = scan % NOD_SCANS / NOD_SCANS
    return math.radians(HIGHEST_DEG * (4.0 * abs(phase - 0.5) - 1.0))


def ranges_m(segments, pose, pitch):
    ranges = []
    for beam in range(BEAMS):
        angle = math.radians(beam - 90)
        ahead, left, up = math.cos(angle) * math.cos(pitch), math.sin(angle), math.cos(angle) * math.sin(pitch)
        level_m = (CEILING_M - LASER_M) / up if up > 1e-9 else LASER_M / -up if up < -1e-9 else math.inf
        wall = wall_m(segments, pose[0], pose[1], pose[2] + math.atan2(left, ahead)) / math.hypot(ahead, left)
        ranges.append(min(wall, level_m, MAX_RANGE_M))
    return ranges


def cast_lap(poses):
    """The noiseless ranges of each scan of a lap. A stationary robot sees the same in every nod."""
    segments, seen, scans = walls(), {}, []
    for k, pose in enumerate(poses):
        key = (pose, k % NOD_SCANS)
        if key not in seen:
            seen[key] = ranges_m(segments, pose, pitch_rad(k))
        scans.append(seen[key])
    return scans


class Recording(Writer):
    """An LCM log of SCAN and ODOMETRY."""

    def __init__(self, path):
        super().__init__(path)
        known = (ROOT / "tests" / "contract" / "released_fingerprints.inc").read_text(encoding="utf-8")
        self.fingerprints = {name: int(value) for name, value in re.findall(r'\{"nodmap\.(\w+)", (-?\d+)\}', known)}

    def odometry(self, utime, seq, pose):
        x, y, yaw = pose
        self.write(Event(utime, "ODOMETRY", struct.pack(">qqq7d2d36d", self.fingerprints["odometry_t"], utime, seq, x, y, 0.0, math.cos(0.5 * yaw), 0.0, 0.0,
                                                   math.sin(0.5 * yaw), 0.0, 0.0, *[math.nan] * 36)))

    def scan(self, utime, seq, pitch, ranges):
        self.write(Event(utime, "SCAN", struct.pack(f">qqqq4d?2d10di{BEAMS}fi", self.fingerprints["scan_t"], utime, 0, seq, math.radians(-90.0), math.radians(1.0),
                                               pitch, pitch, True, 0.05, 80.0, 0.0, 0.0, LASER_M, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, BEAMS, *ranges, 0)))


def write_recording(folder, hours, poses, scans):
    """days.lcmlog and truth.tum. Returns the number of sweeps."""
    noise = random.Random(2)
    errors = [noise.gauss(0.0, NOISE_M) for _ in range(100003)]
    noise_of_wheels = random.Random(1)
    wheels = Wheels(poses[0], lambda ahead: 0.003 * ahead + 0.004 * math.sqrt(ahead) * noise_of_wheels.gauss(0.0, 1.0))
    count = len(poses) * max(1, round(3600e6 * hours / (PERIOD_US * len(poses))))
    with Recording(folder / "days.lcmlog") as recording, (folder / "truth.tum").open("w", encoding="ascii") as truth:
        for seq in range(count):
            utime = 1_600_000_000_000_000 + PERIOD_US * seq
            pose = poses[seq % len(poses)]
            first = noise.randrange(len(errors) - BEAMS)
            recording.odometry(utime, seq, wheels.count(pose))
            recording.scan(utime, seq, pitch_rad(seq), [r + e if r < MAX_RANGE_M else math.inf
                                                        for r, e in zip(scans[seq % len(scans)], errors[first:first + BEAMS])])
            if seq % 4 == 0:
                truth.write(f"{1e-6 * utime:.6f} {pose[0]:.5f} {pose[1]:.5f} 0 0 0 {math.sin(0.5 * pose[2]):.8f} {math.cos(0.5 * pose[2]):.8f}\n")
    return 2 * count / NOD_SCANS


def main():
    options = parser(__doc__, [1, 2, 4], "nodmap-slam6d").parse_args()
    poses = lap()
    scans = cast_lap(poses)
    print("| hours | sweeps | CPU of a sweep | of a further one | memory | keyframes | their clouds | keyframes.lcmlog | ATE, worst |\n|---|---|---|---|---|---|---|---|---|", flush=True)
    before = None
    for hours in options.hours:
        with tempfile.TemporaryDirectory(prefix="nodmap-days-") as name:
            folder = pathlib.Path(name)
            sweeps = write_recording(folder, hours, poses, scans)
            cpu_s, memory_b, metrics = map_recording(options, "nodmap-slam6d", folder)
            errors = evaluate(options.bin, "trajectory", folder / "out" / "trajectory.tum", folder / "truth.tum")
            size = (folder / "out" / "keyframes.lcmlog").stat().st_size
            clouds_b = metrics.get("keyframe_memory_bytes", math.nan)
            print(f"| {hours:g} | {sweeps:.0f} | {1e3 * cpu_s / sweeps:.1f} ms | {further(cpu_s, sweeps, before)} | {memory_b / 1e6:.0f} MB | {len(metrics['keyframes'])} | {clouds_b / 1e6:.0f} MB "
                  f"| {size / 1e6:.0f} MB | {100 * errors['ate_rmse_m']:.2f}, {100 * errors['ate_max_m']:.1f} cm |", flush=True)
            before = cpu_s, sweeps


if __name__ == "__main__":
    main()
