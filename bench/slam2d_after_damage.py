#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether POSE_2D is right after a recording was damaged, and if not, whether POSE_2D says so.

bench/slam2d_after_damage.py --data DIR [--bin DIR] [--logs NAME ...] [--kinds KIND ...] [--seeds N ...] [--set KEY=VALUE ...]

Damages a log as bench/slam2d_damage.py does, but tries each damage alone, in the piece of the log from 40 s before it to 15 s after it. The poses after
the damage, relative to the last pose before it, are compared with those of the undamaged log. A pose is wrong if it is off by more than 25 cm in the first
4 s, by more than 50 cm afterwards (because the map of a short piece drifts), or by more than 4 degrees. Prints a row for each log and kind of damage, with
the number of damages after which POSE_2D is
  right   never wrong for a second or longer
  said    wrong, but DEGRADED or LOST meanwhile
  silent  wrong, and TRACKING for a second or longer
and the percentage of the poses after a damage that are not TRACKING, which is the cost.
"""
import bisect
import math
import pathlib
import random
import tempfile

from event_log import poses_of
from poses import compose, inverse, read_tum
from slam2d_damage import KINDS, Bench, Line, damaged_at, moments, parse_arguments, read_log

BEFORE_S, AFTER_S, DRIFT_S = 40.0, 15.0, 4.0
WRONG_M, WRONG_WITH_DRIFT_M, WRONG_RAD = 0.25, 0.5, math.radians(4.0)
LONG_SCANS = 5  # a second of the slowest log


def difference(a, b, c, d):
    """The difference (m, rad) between the motion from a to b and that from c to d."""
    x, y, yaw = compose(inverse(compose(inverse(a), b)), compose(inverse(c), d))
    return math.hypot(x, y), abs(math.remainder(yaw, 2.0 * math.pi))


class AfterDamage(Bench):
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

    def row(self, name, kind, numbers, truth):
        head, texts = read_log(self.data / f"{name}.clf")
        lines = [Line(text) for text in texts]
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
        return [str(counts[key]) for key in counts] + [f"{100.0 * not_tracking / max(1, scans):.1f} %"]

    def truth(self, name):
        return self.poses((self.data / f"{name}.clf").read_text(errors="replace"))[1]


def main():
    options = parse_arguments(__doc__, list(KINDS))
    bench = AfterDamage(options)
    print("| log | damage | right | said | silent | no pose | not TRACKING in the 15 s afterwards |\n|---|---|---|---|---|---|---|")
    for name in options.logs:
        truth = bench.truth(name)
        for kind in options.kinds:
            print(f"| {name} | {kind} | " + " | ".join(bench.row(name, kind, options.seeds, truth)) + " |", flush=True)


if __name__ == "__main__":
    main()
