#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures both SLAMs on a drive of kilometres in one building: around `ring`, about 190 m each time.

bench/slam_laps.py [--laps N] [--seed S] [--out DIR] [--bin DIR]

N is 10 by default. The odometry noise is that of bench/seeds.py. Prints a row for each SLAM: the length of the drive, the errors of trajectory.tum
relative to the truth with the first poses aligned (RMS and worst of the positions, RMS of the rotation), the CPU time of the replay, and its peak
memory without the log.
"""
import argparse
import math
import pathlib

from days import replay
from poses import read_tum
from programs import BIN, evaluate
from seeds import ODOMETRY_NOISE, REPORTING
from trial_runs import WORLDS, Trial, result_folder, show_table

COLUMNS = ("", "length", "ATE", "worst", "rotation", "CPU time", "memory")
LAP_S = 450  # enough for one round at 0.45 m/s


def write_world(path, laps):
    """The world `ring` with as many rounds; its own goals, in the last line of its file, lead around it twice."""
    *head, goals = (WORLDS / "ring.yaml").read_text().splitlines()
    twice = goals.removeprefix("goals: [[").removesuffix("]]").split("], [")
    once = twice[: len(twice) // 2]
    every = "], [".join(once * laps)
    path.write_text("\n".join([*head, f"goals: [[{every}]]", ""]))


def length_m(trajectory):
    return sum(math.dist(a[1:3], b[1:3]) for a, b in zip(trajectory, trajectory[1:]))


def row(name, programs, drive):
    cpu_s, memory_b, _ = replay(programs / f"nodmap-{name}", drive / "trial.lcmlog", drive / f"{name}-replayed")
    measured = evaluate(programs, "trajectory", drive / f"{name}-replayed" / "trajectory.tum", drive / "truth.tum")
    return (name, f"{length_m(read_tum(drive / 'truth.tum')):.0f} m", f"{100 * measured['ate_rmse_m']:.2f} cm", f"{100 * measured['ate_max_m']:.1f} cm",
            f"{measured['rot_rmse_deg']:.2f}°", f"{cpu_s:.1f} s", f"{1e-6 * memory_b:.0f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--laps", type=int, default=10)
    parser.add_argument("--seed", type=int, default=REPORTING[1])
    parser.add_argument("--out", type=pathlib.Path, help="new folder in which the drive (some GB) is kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    options = parser.parse_args()
    with result_folder(options.out) as out:
        world = out.resolve() / "laps"
        write_world(world.with_suffix(".yaml"), options.laps)
        trial = Trial(f"laps-{options.seed}", str(world), options.seed, LAP_S * options.laps, *ODOMETRY_NOISE, "--no-slam6d", keep_log=True)
        if not trial.run(options.bin, out).result:
            raise SystemExit(trial.error)
        print(f"{trial.result['goals']['reached']} of {trial.result['goals']['asked']} goals reached")
        show_table(COLUMNS, [row(name, options.bin, trial.dir) for name in ("slam2d", "slam6d")])


if __name__ == "__main__":
    main()
