#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how exactly 6D SLAM follows simulated drives, with different parameters.

bench/slam6d_drives.py [--out DIR] [--bin DIR] [--choose] [--setting "key=value ..." ...]

The drives take 100 s through office, cellar, loop and the corridor of Fig. 6, with the odometry noise of bench/seeds.py. Two seeds of each world are for
reporting; --choose takes two others, on which parameters may be chosen. A drive that is already in DIR is used again. Prints a table for each setting: the
error of all poses of 6D SLAM relative to the truth, with the first poses aligned, and that of 2D SLAM on the same drive.
"""
import argparse
import json
import pathlib
import tempfile

import seeds
from programs import BIN, call, evaluate, settings
from slam2d_drives import Drives
from trial_runs import result_folder

WORLDS = ("office", "cellar", "loop", "corridor30")
DURATION_S = 100


def errors(drives, folder, setting):
    with tempfile.TemporaryDirectory() as made:
        out = pathlib.Path(made) / "slam6d"
        call(drives.programs / "nodmap-slam6d", "--replay", folder / "trial.lcmlog", "--out", out, *settings(setting.split()))
        measured = evaluate(drives.programs, "trajectory", out / "trajectory.tum", folder / "truth.tum")
        return measured, json.loads((out / "result.json").read_text())["metrics"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the drives (1 GB) are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--choose", action="store_true", help="use seeds on which parameters may be chosen")
    parser.add_argument("--setting", nargs="+", default=[""], help="parameters of nodmap-slam6d; a table for each setting")
    options = parser.parse_args()
    some_seeds = seeds.CHOOSING[1:3] if options.choose else seeds.REPORTING[101:103]
    with result_folder(options.out, may_contain=True) as out:
        drives = Drives(out, options.bin)
        for setting in options.setting:
            print(f"{setting or 'defaults'}:\n\n| drive | ATE | worst | rotation | ATE of 2D SLAM | sweeps | refused |\n|---|---|---|---|---|---|---|")
            for world in WORLDS:
                for seed in some_seeds:
                    folder = drives.drive((world, seed, DURATION_S))
                    flat = evaluate(drives.programs, "trajectory", folder / "slam2d" / "trajectory.tum", folder / "truth.tum")
                    measured, metrics = errors(drives, folder, setting)
                    print(f"| {world}, seed {seed} | {100 * measured['ate_rmse_m']:.2f} cm | {100 * measured['ate_max_m']:.1f} cm "
                          f"| {measured['rot_rmse_deg']:.2f}° | {100 * flat['ate_rmse_m']:.2f} cm | {metrics['sweeps']} "
                          f"| {metrics['sweeps_lost']} |", flush=True)


if __name__ == "__main__":
    main()
