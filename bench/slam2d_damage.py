#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps damaged recordings with 2D SLAM: measures the error when odometry stands still, jumps or is missing for a while.

bench/slam2d_damage.py --data DIR [--alone] [--bin DIR] [--logs NAME ...] [--kinds KIND ...] [--seeds N ...] [--set KEY=VALUE ...]

DIR holds NAME.clf and NAME.relations (docs/benchmark-2d.md). About twice a minute, while the robot moves, a log is damaged in one of these ways:
  stall   odometry repeats a pose for 0.5 to 1.5 s and then catches up, as with a driver that hangs
  gap     nothing is recorded for 1 to 5 s
  kick    odometry jumps by up to 0.5 m and 60 degrees and does not return, as with wheels that slip
  pause   nothing is recorded for 0.5 to 1.5 s, and odometry does not count the motion during that time
Prints a row for each log and kind of damage: the error of translation and rotation for each seed, over the relations whose two scans are left (a gap
removes scans, and a pause, too), and how many are not; the first row is the undamaged log. Relations without a pose, though their scans are left, have a
note of their own: whoever gives no pose where it is difficult must not look better.

With --alone it tries each damage alone, in the piece of the log from 40 s before it to 15 s after it: is POSE_2D right afterwards, and if not, does it say
so? The poses after the damage, relative to the last pose before it, are compared with those of the undamaged log. A pose is wrong if it is off by more than
25 cm in the first 4 s, by more than 50 cm afterwards (because the map of a short piece drifts), or by more than 4 degrees. Prints a row for each log and kind
of damage, with the number of damages after which POSE_2D is
  right   never wrong for a second or longer
  said    wrong, but DEGRADED or LOST meanwhile
  silent  wrong, and TRACKING for a second or longer
and the percentage of the poses after a damage that are not TRACKING, which is the cost.

Seeds below 1000 are for reporting, others for choosing parameters (bench/seeds.py).
"""
import argparse
import bisect
import functools
import math
import pathlib
import random
import tempfile

import seeds
from event_log import poses_of
from poses import compose, inverse, read_tum
from programs import BIN, LOGS, evaluate, map_log, settings

KINDS = {"stall": (0.5, 1.5), "gap": (1.0, 5.0), "kick": (0.0, 0.0), "pause": (0.5, 1.5)}  # durations, s
PERIOD_S = 30.0
BEFORE_S, AFTER_S, DRIFT_S = 40.0, 15.0, 4.0
WRONG_M, WRONG_WITH_DRIFT_M, WRONG_RAD = 0.25, 0.5, math.radians(4.0)
LONG_SCANS = 5  # a second of the slowest log


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


def difference(a, b, c, d):
    """The difference (m, rad) between the motion from a to b and that from c to d."""
    x, y, yaw = compose(inverse(compose(inverse(a), b)), compose(inverse(c), d))
    return math.hypot(x, y), abs(math.remainder(yaw, 2.0 * math.pi))


class Bench:
    """Damages whole logs."""
    HEAD = "| log | damage | error for each seed: translation, rotation |\n|---|---|---|"
    KINDS = ["as it is", *KINDS]

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
            return self.errors(name, head + "".join(texts))
        lines = [Line(text) for text in texts]
        return "; ".join(self.errors(name, head + "".join(damaged(lines, kind, seed))) for seed in numbers)


class AfterDamage(Bench):
    """Tries each damage alone."""
    HEAD = "| log | damage | right | said | silent | no pose | not TRACKING in the 15 s afterwards |\n|---|---|---|---|---|---|---|"
    KINDS = list(KINDS)

    def poses(self, text):
        """Maps a CARMEN log: the published poses, and the poses corrected at the end by their time in ms."""
        with tempfile.TemporaryDirectory() as made:
            out = self.map(text, pathlib.Path(made))
            corrected = {round(1e3 * time_s): tuple(pose) for time_s, *pose in read_tum(out / "trajectory.tum")}
            return list(poses_of(out / "out.lcmlog", "POSE_2D")), corrected

    def outcome(self, published, truth, begin_s, end_s):
        """The outcome (right, said, silent, or none without poses), how many poses after the damage are not TRACKING, and how many there are."""
        known = [(time_s, pose, state, truth[round(1e3 * time_s)]) for time_s, pose, state in published if round(1e3 * time_s) in truth]
        first = bisect.bisect_right([row[0] for row in known], begin_s) - 1
        after = [row for row in known if row[0] >= end_s]
        wrong = silent = 0
        for time_s, pose, state, true_pose in after:
            off_m, off_rad = difference(known[first][3], true_pose, known[first][1], pose)
            if off_m > (WRONG_M if time_s < end_s + DRIFT_S else WRONG_WITH_DRIFT_M) or off_rad > WRONG_RAD:
                wrong += 1
                silent += state == 0
        name = "none" if len(after) < LONG_SCANS else "silent" if silent >= LONG_SCANS else "said" if wrong >= LONG_SCANS else "right"
        return name, sum(row[2] != 0 for row in after), len(after)

    def row(self, name, kind, numbers):
        head, texts = read_log(self.data / f"{name}.clf")
        lines, truth = [Line(text) for text in texts], self.truth(name)
        counts = dict.fromkeys(("right", "said", "silent", "none"), 0)
        not_tracking = scans = 0
        for seed in numbers:
            for begin_s, end_s in moments(lines, kind, random.Random(f"{kind} {seed}")):
                piece = [line for line in lines if begin_s - BEFORE_S <= line.time_s <= end_s + AFTER_S]
                text = head + "".join(damaged_at([(begin_s, end_s)], piece, kind, random.Random(f"{kind} {seed} {begin_s}")))
                result, degraded, total = self.outcome(self.poses(text)[0], truth, begin_s, end_s)
                counts[result] += 1
                not_tracking += degraded
                scans += total
        return " | ".join(map(str, counts.values())) + f" | {100.0 * not_tracking / max(1, scans):.1f} %"

    @functools.cache
    def truth(self, name):
        """The corrected poses of the undamaged log by their time in ms."""
        return self.poses((self.data / f"{name}.clf").read_text(errors="replace"))[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True)
    parser.add_argument("--alone", action="store_true", help="try each damage alone")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--logs", nargs="*", default=LOGS)
    parser.add_argument("--kinds", nargs="*", help="default: all")
    parser.add_argument("--seeds", nargs="*", type=int, default=seeds.REPORTING[:3])
    parser.add_argument("--set", nargs="*", default=[], dest="settings", help="parameters of nodmap-slam2d")
    options = parser.parse_args()
    bench = (AfterDamage if options.alone else Bench)(options)
    print(bench.HEAD)
    for name in options.logs:
        for kind in options.kinds or bench.KINDS:
            print(f"| {name} | {kind} | {bench.row(name, kind, options.seeds)} |", flush=True)


if __name__ == "__main__":
    main()
