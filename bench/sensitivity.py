#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how much the ideal parts of the simulated robot are worth: drives the same worlds with each of them less ideal.

    bench/sensitivity.py [--seeds N] [--first SEED] [--duration S] [--only VARIANT ...] [--worlds NAME ...] [--jobs N] [--out DIR] [--bin DIR]

For each seed the robot drives through the cellar, an office and a random world, with the odometry noise of bench/seeds.py. The ground is less even, or the
laser's zero, mount or ranges are wrong and the robot does not know. Prints a row for each variant: contacts of all drives, mean speed, and the errors of all
poses of 2D and 6D SLAM relative to the truth, with the first poses aligned: the mean of the drives, and in brackets the worst drive. A drive of the same variant,
world, seed and duration that is already in DIR is used again: use another DIR for another build.
"""
import argparse
import json
import statistics
import sys

from programs import settings
from seeds import ODOMETRY_NOISE
from trial_runs import Trial, add_options, add_seed_options, result_folder, results_of, run_all, seeds_of, show_failures, show_table

WORLDS = {"cellar": lambda seed: "cellar", "office": lambda seed: f"office:{seed}", "random": lambda seed: f"random:{seed}"}
# A step of the servo is 0.088 degrees; the robot takes 2048 for level.
VARIANTS = {
    "as simulated": [],
    "ground 0.3 deg": ["sim.ground_tilt_deg=0.3"],
    "ground 0.5 deg": ["sim.ground_tilt_deg=0.5"],
    "zero +0.53 deg": ["sim.servo_level_position=2054"],
    "zero -0.53 deg": ["sim.servo_level_position=2042"],
    "laser rolled 0.5 deg": ["sim.laser_roll_deg=0.5"],
    "laser yawed 0.5 deg": ["sim.laser_yaw_deg=0.5"],
    "ranges +15 mm": ["sim.range_bias_m=0.015"],
}


def take_from(out, trials):
    """Gives the trials that an earlier run has left in `out` their results; returns the others."""
    for trial in trials:
        file = out / trial.name / "result.json"
        if file.exists():
            trial.result = json.loads(file.read_text())
    return [trial for trial in trials if not trial.result]


def make_trials(variant, worlds, seeds, duration_s):
    return [Trial(f"{variant}-{world}-{seed}-{duration_s}s".replace(" ", "-"), WORLDS[world](seed), seed, duration_s, *ODOMETRY_NOISE, *settings(VARIANTS[variant]))
            for world in worlds for seed in seeds]


def row_of(variant, trials):
    results = results_of(trials)
    if not results:
        return [variant, 0, *["-"] * 6]
    row = [variant, len(results), sum(result["collisions"] for result in results),
           f"{statistics.mean(result['mean_speed_mps'] for result in results):.2f} m/s"]
    for slam in ("slam2d", "slam6d"):
        for key, scale, unit, digits in (("ate_rmse_m", 100, " cm", 2), ("rot_rmse_deg", 1, "°", 2)):
            errors = [scale * result[slam][key] for result in results]
            row.append(f"{statistics.mean(errors):.{digits}f} ({max(errors):.{digits}f}){unit}")
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_seed_options(parser, 3)
    parser.add_argument("--duration", type=int, default=40, help="of each drive, s")
    parser.add_argument("--only", nargs="+", choices=VARIANTS, default=list(VARIANTS))
    parser.add_argument("--worlds", nargs="+", choices=WORLDS, default=list(WORLDS))
    add_options(parser)
    arguments = parser.parse_args()
    groups = {variant: make_trials(variant, arguments.worlds, seeds_of(arguments), arguments.duration) for variant in arguments.only}
    trials = [trial for group in groups.values() for trial in group]
    with result_folder(arguments.out, may_contain=True) as out:
        run_all(take_from(out, trials), arguments.bin, out, arguments.jobs)
    show_table(("variant", "drives", "contacts", "speed", "2D ATE", "2D rotation", "6D ATE", "6D rotation"),
               [row_of(variant, group) for variant, group in groups.items()])
    return 1 if show_failures(trials) else 0


if __name__ == "__main__":
    sys.exit(main())
