#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps simulated drives of which SLAM receives nothing for up to a minute at a time, as on a machine that is far too busy.

bench/slam_losses.py [--module slam2d|slam6d] [--lost CHANNEL ...] [--worlds WORLD ...] [--seeds N ...] [--duration S] [--jobs N] [--out DIR] [--bin DIR]
                     [--set KEY=VALUE ...]

The robot drives on meanwhile, and its odometry goes on counting. Once in every two minutes SCAN and ODOMETRY, or what --lost names, are lost for 5 to
60 s. Each published pose is compared with the truth, from the first pose on: it is wrong if it is off by more than 0.5 m, 6 degrees, or 0.1 m in height (the
ground is level). Prints a row for each drive: for how many seconds it is right, wrong but DEGRADED or LOST (said), and wrong and TRACKING (silent), what it is
at the end, and the share of all poses that are not TRACKING. The last row sums up.

Seeds below 1000 are for reporting, others for choosing parameters (bench/seeds.py).
"""
import argparse
import collections
import math
import pathlib
import random
import tempfile

import seeds
from event_log import Writer, events, heights_of, poses_of
from poses import compose, inverse, pose_at, read_tum
from programs import BIN, call, settings
from trial_runs import Pool, Trial, result_folder

POSE_OF = {"slam2d": "POSE_2D", "slam6d": "POSE_6D"}
PERIOD_S, LOSS_S = 120.0, (5.0, 60.0)
WRONG_M, WRONG_RAD, WRONG_HEIGHT_M = 0.5, math.radians(6.0), 0.1


def losses(begin_s, end_s, seed):
    """(begin, end) of each loss, seconds."""
    generator = random.Random(f"losses {seed}")
    found = []
    while begin_s + PERIOD_S <= end_s:
        duration_s = generator.uniform(*LOSS_S)
        start_s = begin_s + generator.uniform(20.0, PERIOD_S - duration_s)
        found.append((start_s, start_s + duration_s))
        begin_s += PERIOD_S
    return found


def write_with_losses(log, out, seed, channels):
    every = list(events(log))
    gaps = losses(1e-6 * every[0].utime, 1e-6 * every[-1].utime, seed)
    with Writer(out) as writer:
        for event in every:
            if event.channel not in channels or not any(begin_s <= 1e-6 * event.utime < end_s for begin_s, end_s in gaps):
                writer.write(event)


def off(origin, pose, true_origin, true_pose):
    """By how much (m, rad) a pose is off, if the first one, `origin`, is right."""
    x, y, yaw = compose(inverse(compose(inverse(true_origin), true_pose)), compose(inverse(origin), pose))
    return math.hypot(x, y), abs(math.remainder(yaw, 2.0 * math.pi))


class Bench:
    def __init__(self, options, out):
        self.options, self.out = options, out

    def drive(self, world, seed):
        trial = Trial(f"{world.replace(':', '-')}-{seed}", world, seed, self.options.duration, *seeds.ODOMETRY_NOISE, "--no-slam6d", keep_log=True)
        folder = self.out / trial.name
        if not (folder / "result.json").exists() and not trial.run(self.options.bin, self.out).result:
            raise RuntimeError(trial.error)
        return folder

    def outcomes(self, run):
        """The time, the outcome and the state of each pose."""
        folder = self.drive(*run)
        with tempfile.TemporaryDirectory() as made:
            log, out = pathlib.Path(made) / "log.lcmlog", pathlib.Path(made) / "out"
            write_with_losses(folder / "trial.lcmlog", log, run[1], self.options.lost)
            call(self.options.bin / f"nodmap-{self.options.module}", "--replay", log, "--out", out, *settings(self.options.settings))
            published = list(poses_of(out / "out.lcmlog", POSE_OF[self.options.module]))
            heights_m = list(heights_of(out / "out.lcmlog", POSE_OF[self.options.module]))
        truth = read_tum(folder / "truth.tum")
        first_s, origin, _ = published[0]
        names = []
        for (time_s, pose, state), height_m in zip(published, heights_m):
            off_m, off_rad = off(origin, pose, pose_at(truth, first_s), pose_at(truth, time_s))
            is_wrong = off_m > WRONG_M or off_rad > WRONG_RAD or abs(height_m - heights_m[0]) > WRONG_HEIGHT_M
            names.append((time_s, "right" if not is_wrong else "silent" if state == 0 else "said", state))
        return names

    def row(self, run):
        names = self.outcomes(run)
        seconds = collections.Counter()
        for (time_s, name, _), (next_s, _, _) in zip(names, names[1:]):
            seconds[name] += min(next_s - time_s, 1.0)  # not during the losses
        return seconds, names[-1][1], sum(state != 0 for _, _, state in names) / len(names)


def cells(seconds):
    return " | ".join(f"{seconds[name]:.0f} s" for name in ("right", "said", "silent"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--module", choices=POSE_OF, default="slam2d")
    parser.add_argument("--lost", nargs="+", choices=("SCAN", "ODOMETRY"), default=["SCAN", "ODOMETRY"])
    parser.add_argument("--worlds", nargs="*", default=["cellar"])
    parser.add_argument("--seeds", nargs="*", type=int, default=seeds.REPORTING[:4])
    parser.add_argument("--duration", type=float, default=600.0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the drives are kept, and used again; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--set", nargs="*", default=[], dest="settings", help="parameters of the module")
    options = parser.parse_args()
    with result_folder(options.out, may_contain=True) as out:
        bench = Bench(options, out)
        runs = [(world, seed) for world in options.worlds for seed in options.seeds]
        total, ends = collections.Counter(), collections.Counter()
        print("| world, seed | right | said | silent | at the end | not TRACKING |\n|---|---|---|---|---|---|")
        with Pool(options.jobs) as pool:
            for (world, seed), (seconds, end, share) in zip(runs, pool.map(bench.row, runs)):
                total.update(seconds)
                ends[end] += 1
                print(f"| {world}, {seed} | {cells(seconds)} | {end} | {100.0 * share:.1f} % |", flush=True)
        print(f"| all | {cells(total)} | " + ", ".join(f"{n} {name}" for name, n in ends.items()) + " | |")


if __name__ == "__main__":
    main()
