#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts the jumps of the pose of 6D SLAM on many simulated drives: does it ever jump without reporting so?

bench/slam6d_jumps.py [--seeds N] [--first SEED] [--duration S] [--jobs N] [--out DIR] [--bin DIR]

Drives S seconds (60) with N seeds in each of four worlds, with the odometry noise of bench/seeds.py. A jump is a change of POSE_6D's error, from one
pose to the next, by more than 5 cm. It is said if one of the two poses is not TRACKING. Prints a row for each world: drives, poses, how many were not
TRACKING, jumps that were said and that were not, the largest change of the error while TRACKING, and the mean and the worst ATE of trajectory.tum.
The exit code is 1 if a jump was not said.
"""
import argparse
import sys

from event_log import poses_of
from poses import compose, inverse, pose_at, read_tum
from programs import evaluate
from seeds import ODOMETRY_NOISE
from trial_runs import Pool, Trial, add_options, add_seed_options, result_folder, seeds_of, show_table

WORLDS = ("office", "cellar", "corridor30", "random")
COLUMNS = ("world", "drives", "poses", "not TRACKING", "jumps said", "jumps not said", "largest step", "ATE, mean", "ATE, worst")
MAX_STEP_M = 0.05
TRACKING = 0


def errors_of(folder):
    """The error (x, y) in metres of each POSE_6D, in the frame of the first one, and its state."""
    truth = read_tum(folder / "truth.tum")
    every = list(poses_of(folder / "trial.lcmlog", "POSE_6D"))
    T_map_world = compose(every[0][1], inverse(pose_at(truth, every[0][0])))
    for stamp, pose, state in every:
        true = compose(T_map_world, pose_at(truth, stamp))
        yield pose[0] - true[0], pose[1] - true[1], state


def jumps_of(folder):
    """The numbers of poses, of those that are not TRACKING, of jumps said and not said, and the largest step (m) while TRACKING."""
    said, silent, largest_m = 0, 0, 0.0
    every = list(errors_of(folder))
    for (x0, y0, state0), (x1, y1, state1) in zip(every, every[1:]):
        step_m = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        is_tracking = state0 == TRACKING and state1 == TRACKING
        if is_tracking:
            largest_m = max(largest_m, step_m)
        if step_m > MAX_STEP_M:
            silent, said = silent + is_tracking, said + (not is_tracking)
    others = sum(state != TRACKING for _, _, state in every)
    return len(every), others, said, silent, largest_m


def drive(run):
    """Runs a trial, and returns its jumps and its ATE (m). Its log is deleted then, because 200 of them take 7 GB."""
    trial, programs, out = run
    if not trial.run(programs, out).result:
        raise RuntimeError(f"{trial.name}: {trial.error}")
    counts = jumps_of(trial.dir)
    (trial.dir / "trial.lcmlog").unlink()
    ate_m = evaluate(programs, "trajectory", trial.dir / "slam6d" / "trajectory.tum", trial.dir / "truth.tum")["ate_rmse_m"]
    if counts[3]:
        print(f"{trial.name}: {counts[3]} jumps not said, by up to {100 * counts[4]:.1f} cm", file=sys.stderr)
    return (*counts, ate_m)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_seed_options(parser, 50)
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of each drive")
    add_options(parser)
    options = parser.parse_args()
    rows = []
    with result_folder(options.out) as out, Pool(options.jobs) as pool:
        for world in WORLDS:
            name = f"{world}:{{}}" if world == "random" else world
            runs = [(Trial(f"{world}-{seed}", name.format(seed), seed, options.duration, *ODOMETRY_NOISE, keep_log=True), options.bin, out)
                    for seed in seeds_of(options)]
            poses, others, said, silent, largest_m, ate_m = zip(*pool.map(drive, runs))
            rows.append((world, len(runs), sum(poses), sum(others), sum(said), sum(silent), f"{100 * max(largest_m):.1f} cm",
                         f"{100 * sum(ate_m) / len(ate_m):.2f} cm", f"{100 * max(ate_m):.2f} cm"))
    show_table(COLUMNS, rows)
    return 1 if any(row[5] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
