# SPDX-License-Identifier: BSD-3-Clause
"""What slam2d_days.py and slam6d_days.py share: the corridor in which the robot drives up and down for days, and what a map of it costs."""
import argparse
import json
import math
import pathlib
import re
import resource
import subprocess
import time

from programs import BIN, settings

LENGTH_M, HALF_WIDTH_M = 24.0, 1.1
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


def wall_m(segments, x, y, angle):
    """Horizontal distance to the nearest wall."""
    dx, dy = math.cos(angle), math.sin(angle)
    nearest = math.inf
    for x0, y0, x1, y1 in segments:
        det = dx * (y1 - y0) - dy * (x1 - x0)
        if det != 0.0:
            distance = ((x0 - x) * (y1 - y0) - (y0 - y) * (x1 - x0)) / det
            if 0.0 < distance < nearest and 0.0 <= ((x0 - x) * dy - (y0 - y) * dx) / det <= 1.0:
                nearest = distance
    return nearest


class Wheels:
    """Odometry: 1 % too long and too far round, and a heading that drifts. `drift`: the error of the heading (rad) after so many metres."""

    def __init__(self, pose, drift):
        self.last, self.drift, (self.x, self.y, self.yaw) = pose, drift, pose

    def count(self, pose):
        """Drives to the next true pose; returns the pose by odometry."""
        ahead = math.hypot(pose[0] - self.last[0], pose[1] - self.last[1])
        rotation = (pose[2] - self.last[2] + math.pi) % (2.0 * math.pi) - math.pi
        self.last = pose
        self.yaw += 1.01 * rotation + self.drift(ahead)
        self.x += 1.01 * ahead * math.cos(self.yaw)
        self.y += 1.01 * ahead * math.sin(self.yaw)
        return self.x, self.y, self.yaw


def parser(description, hours, program):
    """The arguments that both have."""
    arguments = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--bin", type=pathlib.Path, default=BIN)
    arguments.add_argument("--hours", type=float, nargs="+", default=hours)
    arguments.add_argument("--set", nargs="*", default=[], help=f"parameters of {program}")
    return arguments


def peak_memory_b(command, errors):
    """Runs a command; returns the most memory of its own, sampled every 50 ms: the pages of a mapped recording come and go and are not its own."""
    peak_b = 0
    with errors.open("w") as stderr, subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=stderr) as process:
        status = pathlib.Path(f"/proc/{process.pid}/status")
        while process.poll() is None:
            own = re.search(r"RssAnon:\s+(\d+) kB", status.read_text())
            peak_b = max(peak_b, 1024 * int(own.group(1)) if own else 0)
            time.sleep(0.05)
    if process.returncode != 0:
        raise SystemExit(errors.read_text())
    return peak_b


def further(cpu_s, count, before):
    """The CPU time of one of the scans or sweeps by which a row has more than the row before, as text (ms); `before`: (CPU time, count) of that row."""
    return f"{1e3 * (cpu_s - before[0]) / (count - before[1]):.2f} ms" if before and count != before[1] else ""


def replay(program, log, out, *options):
    """Replays a log into the new folder `out`; returns CPU time (s), peak memory (bytes) and the metrics."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    memory_b = peak_memory_b([program, "--replay", log, "--out", out, *options], out.with_suffix(".errors.txt"))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    metrics = json.loads((out / "result.json").read_text(encoding="utf-8"))["metrics"]
    return cpu_s, memory_b, metrics


def map_recording(options, program, folder):
    """Maps FOLDER/days.lcmlog into FOLDER/out; returns CPU time (s), peak memory (bytes) and the metrics."""
    return replay(options.bin / program, folder / "days.lcmlog", folder / "out", *settings(options.set))
