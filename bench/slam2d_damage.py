#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps damaged recordings with 2D SLAM: measures the error when odometry stands still, jumps or is missing for a while.

bench/slam2d_damage.py --data DIR [--bin DIR] [--logs NAME ...] [--kinds KIND ...] [--seeds N ...] [--set KEY=VALUE ...]

DIR holds NAME.clf and NAME.relations (docs/benchmark-2d.md). About twice a minute, while the robot moves, a log is damaged in one of these ways:
  stall   odometry repeats a pose for 0.5 to 1.5 s and then catches up, as with a driver that hangs
  gap     nothing is recorded for 1 to 5 s
  kick    odometry jumps by up to 0.5 m and 60 degrees and does not return, as with wheels that slip
  pause   nothing is recorded for 0.5 to 1.5 s, and odometry does not count the motion during that time
Prints a row for each log and kind of damage: the error of translation and rotation for each seed, over the relations whose two scans are left (a gap
removes scans, and a pause, too), and how many are not; the first row is the undamaged log. Relations without a pose, though their scans are left, have a
note of their own: whoever gives no pose where it is difficult must not look better.
Seeds below 1000 are for reporting, others for choosing parameters (bench/seeds.py).
"""
import argparse
import math
import pathlib
import random
import tempfile

import seeds
from poses import compose, inverse
from programs import BIN, LOGS, evaluate, map_log, settings

KINDS = {"stall": (0.5, 1.5), "gap": (1.0, 5.0), "kick": (0.0, 0.0), "pause": (0.5, 1.5)}  # durations, s
PERIOD_S = 30.0


class Line:
    """A line of a CARMEN log that has a pose by odometry, in the fields `first` to `first` + 2."""
    def __init__(self, text):
        self.words = text.split()
        self.first = int(self.words[1]) + 5 if self.words[0] == "FLASER" else 1
        self.time_s = float(self.words[-3])
        self.pose = tuple(map(float, self.words[self.first:self.first + 3]))

    def text(self, pose):
        words = list(self.words)
        words[self.first:self.first + 3] = [f"{value:.6f}" for value in pose]
        return " ".join(words) + "\n"


def moments(lines, kind, generator):
    """(begin, end) of each damage, seconds: one in each period in which the robot moves."""
    found, begin_s = [], lines[0].time_s
    moving = [a.time_s for a, b in zip(lines, lines[10:])
              if math.dist(a.pose[:2], b.pose[:2]) > 0.05 or abs(math.remainder(b.pose[2] - a.pose[2], 2.0 * math.pi)) > 0.1]
    while begin_s < lines[-1].time_s:
        choice = [time_s for time_s in moving if begin_s + 2.0 <= time_s < begin_s + PERIOD_S - 7.0]
        begin_s += PERIOD_S
        if choice:
            time_s = generator.choice(choice)
            found.append((time_s, time_s + generator.uniform(*KINDS[kind])))
    return found


def damaged(lines, kind, seed):
    """Damages the lines of a log that have a pose."""
    generator = random.Random(f"{kind} {seed}")
    return damaged_at(moments(lines, kind, generator), lines, kind, generator)


def damaged_at(places, lines, kind, generator):
    """Damages the lines at these places: (begin, end) of each damage, seconds."""
    places = list(places)
    correction, before, out = (0.0, 0.0, 0.0), lines[0].pose, []
    for line in lines:
        if places and line.time_s > places[0][1]:
            jump = (0.0, 0.0, 0.0)
            if kind == "kick":
                jump = (generator.uniform(-0.5, 0.5), generator.uniform(-0.2, 0.2), math.radians(generator.uniform(-60.0, 60.0)))
            if kind == "pause":
                jump = compose(inverse(line.pose), before)
            correction = compose(correction, compose(line.pose, compose(jump, inverse(line.pose))))
            places.pop(0)
        if places and places[0][0] < line.time_s:
            if kind == "stall":
                out.append(line.text(compose(correction, before)))
            continue
        before = line.pose
        out.append(line.text(compose(correction, line.pose)))
    return out


def without_scan(text, relations):
    """The number of relations of which a scan is missing in a log."""
    stamps = {round(1e6 * Line(line).time_s) for line in text.splitlines() if line.startswith("FLASER")}
    ends = [line.split()[:2] for line in relations.splitlines() if line.strip() and not line.startswith("#")]
    return sum(any(round(1e6 * float(stamp)) not in stamps for stamp in pair) for pair in ends)


def cell(errors, num_without_scan):
    """The errors of a damaged log, and over how many relations they are not."""
    total, without_pose = errors["n"] + errors["missing"], errors["missing"] - num_without_scan
    notes = [f"{num_without_scan} of {total} without a scan"] * (num_without_scan > 0) + [f"**{without_pose} without a pose**"] * (without_pose > 0)
    return ", ".join([f"{errors['trans_mean_m']:.4f} m, {errors['rot_mean_deg']:.3f}°", *notes])


def read_log(clf):
    """The PARAM lines of a log as one text, and those lines that have a pose."""
    every = clf.read_text(errors="replace").splitlines(keepends=True)
    return "".join(line for line in every if line.startswith("PARAM")), [line for line in every if line.startswith(("ODOM", "FLASER"))]


class Bench:
    def __init__(self, options):
        self.programs, self.data, self.settings = options.bin, options.data, settings(options.settings)

    def map(self, text, folder):
        """Maps the text of a CARMEN log; returns the folder with the results."""
        (folder / "log.clf").write_text(text)
        map_log(self.programs, folder / "log.clf", folder / "out", *self.settings)
        return folder / "out"

    def errors(self, name, text):
        """A cell of the table."""
        relations = self.data / f"{name}.relations"
        with tempfile.TemporaryDirectory() as made:
            errors = evaluate(self.programs, "relations", self.map(text, pathlib.Path(made)) / "trajectory.tum", relations)
            return cell(errors, without_scan(text, relations.read_text()))

    def row(self, name, kind, numbers):
        head, texts = read_log(self.data / f"{name}.clf")
        if kind == "as it is":
            return [self.errors(name, head + "".join(texts))]
        lines = [Line(text) for text in texts]
        return [self.errors(name, head + "".join(damaged(lines, kind, seed))) for seed in numbers]


def parse_arguments(description, kinds):
    """Reads the options of this script and of slam2d_after_damage.py. `kinds`: the kinds of damage if --kinds is not given."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True)
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--logs", nargs="*", default=LOGS)
    parser.add_argument("--kinds", nargs="*", default=kinds)
    parser.add_argument("--seeds", nargs="*", type=int, default=seeds.REPORTING[:3])
    parser.add_argument("--set", nargs="*", default=[], dest="settings", help="parameters of nodmap-slam2d")
    return parser.parse_args()


def main():
    options = parse_arguments(__doc__, ["as it is", *KINDS])
    bench = Bench(options)
    print("| log | damage | error for each seed: translation, rotation |\n|---|---|---|")
    for name in options.logs:
        for kind in options.kinds:
            print(f"| {name} | {kind} | {'; '.join(bench.row(name, kind, options.seeds))} |", flush=True)


if __name__ == "__main__":
    main()
