#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures 2D SLAM with level scans against virtual scans from the structure map, on the same drives.

bench/slam2d_structure_map.py [--out DIR] [--bin DIR] [--choose]

Drives 60 s through crowd, people, office and cellar, three seeds each, with the odometry noise of bench/seeds.py. A drive that is already in DIR is
used again. Prints a row for each world: the mean ATE and rotation error of all poses, with the first poses aligned, with level scans and with the
structure map.
"""
import argparse
import pathlib
import statistics
import tempfile

import seeds
from programs import BIN, call, evaluate
from slam2d_drives import Drives
from trial_runs import result_folder

WORLDS = ("crowd", "people", "office", "cellar")
DURATION_S = 60


def errors(drives, folder, from_structure_map):
    with tempfile.TemporaryDirectory() as made:
        out = pathlib.Path(made) / "slam2d"
        call(drives.programs / "nodmap-slam2d", "--replay", folder / "trial.lcmlog", "--out", out,
             "--set", f"level_scans.from_structure_map={from_structure_map}")
        measured = evaluate(drives.programs, "trajectory", out / "trajectory.tum", folder / "truth.tum")
        return measured["ate_rmse_m"], measured["rot_rmse_deg"]


def cell(every):
    ate_m, rotation_deg = zip(*every)
    return f"{100 * statistics.mean(ate_m):.1f} cm, {statistics.mean(rotation_deg):.2f}°"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the drives (0.7 GB) are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--choose", action="store_true", help="use seeds on which parameters may be chosen")
    options = parser.parse_args()
    some_seeds = (seeds.CHOOSING if options.choose else seeds.REPORTING)[1:4]
    with result_folder(options.out, may_contain=True) as out:
        drives = Drives(out, options.bin)
        print("| world | level scans | structure map |\n|---|---|---|")
        for world in WORLDS:
            folders = [drives.drive((f"people:{seed}" if world == "people" else world, seed, DURATION_S)) for seed in some_seeds]
            cells = [cell([errors(drives, folder, use) for folder in folders]) for use in ("false", "true")]
            print(f"| {world} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
