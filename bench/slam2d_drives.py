#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how the parameters of 2D SLAM affect its errors: maps the same simulated drives with different parameters.

bench/slam2d_drives.py [--out DIR] [--bin DIR] [--setting "key=value ..." ...]

Drives 30 times through the corridor of Fig. 6 (60 s) and 20 times through the cellar (120 s), a loop like that of Fig. 7, with the odometry
noise and the seeds for choosing of bench/seeds.py; the figures show other seeds. A drive that is already in DIR is used again. Prints a row with the worst
errors for each setting; the first setting is the default parameters.
"""
import argparse
import os
import pathlib
import tempfile

import seeds
from programs import BIN, call, evaluate, settings
from trial_runs import Pool, Trial, result_folder

CORRIDOR = [("corridor30", seed, 60) for seed in seeds.CHOOSING[:30]]
CELLAR = [("cellar", seed, 120) for seed in seeds.CHOOSING[:20]]
SETTINGS = ["", "matcher.min_line_distance_m=0.25", *(f"map.line_radius_m={radius_m}" for radius_m in (0.25, 0.15, 0.12))]


class Drives:
    def __init__(self, out, programs):
        self.out, self.programs = out, programs

    def drive(self, run):
        world, seed, duration_s = run
        trial = Trial(f"{world}-{seed}-{duration_s}s", world, seed, duration_s, *seeds.ODOMETRY_NOISE, "--no-slam6d", keep_log=True)
        folder = self.out / trial.name
        if not (folder / "result.json").exists() and not trial.run(self.programs, self.out).result:  # an interrupted drive has none
            raise RuntimeError(trial.error)
        return folder

    def errors(self, run, setting):
        """The errors along the corridor or at the end of the drive, as nodmap-evaluate prints them."""
        folder = self.drive(run)
        with tempfile.TemporaryDirectory() as made:
            out = pathlib.Path(made) / "slam2d"
            call(self.programs / "nodmap-slam2d", "--replay", folder / "trial.lcmlog", "--out", out, *settings(setting.split()))
            kind = "corridor" if run[0] == "corridor30" else "trajectory"
            return evaluate(self.programs, kind, out / "trajectory.tum", folder / "truth.tum")

    def worst(self, runs, setting, keys):
        with Pool(os.cpu_count()) as pool:
            every = list(pool.map(lambda run: self.errors(run, setting), runs))
        return [max(abs(errors[key]) for errors in every) for key in keys]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the drives (5 GB) are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--setting", nargs="+", default=SETTINGS, help="parameters of nodmap-slam2d; a row for each setting")
    options = parser.parse_args()
    with result_folder(options.out, may_contain=True) as out:
        drives = Drives(out, options.bin)
        print("| setting | Fig. 6: length | bow | heading | Fig. 7: end |\n|---|---|---|---|---|")
        for setting in options.setting:
            length_percent, bow_m, heading_deg = drives.worst(CORRIDOR, setting, ("length_error_percent", "bow_m", "heading_error_deg"))
            end_m, end_deg = drives.worst(CELLAR, setting, ("end_error_m", "end_error_deg"))
            print(f"| {setting or 'defaults'} | {length_percent:.2f} % | {100 * bow_m:.1f} cm | {heading_deg:.2f}° "
                  f"| {100 * end_m:.1f} cm, {end_deg:.2f}° |", flush=True)


if __name__ == "__main__":
    main()
