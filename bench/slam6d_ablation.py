#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what each part of 6D SLAM is worth: the same drives, each time without one part.

bench/slam6d_ablation.py [--out DIR] [--bin DIR] [--choose] [--only PART ...]

The drives are those of bench/slam6d_drives.py, and one of 388 m around `ring`; the clouds are those of nodding_seq, if NODMAP_DATA has them. A drive
that is already in DIR is used again. Prints a row for each part: mean and worst ATE and mean rotation error of the drives and their sweeps LOST, the
ATE around the ring, and ATE and rotation error of nodding_seq. A part that is left out is not replaced.
"""
import argparse
import json
import os
import pathlib

import seeds
from programs import BIN, call, settings
from slam2d_drives import Drives
from slam6d_drives import DURATION_S, WORLDS, errors
from trial_runs import result_folder

# What is left out, and the parameters that do so.
PARTS = {
    "nothing": "",
    "planes (distances between points: Eq. 3)": "registration.metric=point_to_point",
    "the wide kernel at first": "registration.coarse_residual_scale_m=0.015",
    "directions that normals cannot tell": "registration.normal_error_deg=0",
    "headings tried again when in doubt": "registration.good_inlier_ratio=0",
    "rotation that is not steady within a sweep": "registration.bend_deg=0",
    "the wheels' calibration": "calibration.translation_scale=0 calibration.rotation_scale=0 calibration.yaw_per_m_deg=0 calibration.min_scatter=1",
    "the pitch's delay": "pitch_latency.sigma_s=0",
    "level ground": "odometry.level_height_m=1000 odometry.level_tilt_deg=360",
    "loops": "loop.enabled=false",
    "adjustment at the end": "adjustment.use_adjustment=false",
}
RING_S = 900


def measure(drives, runs, setting):
    every = [errors(drives, drives.drive(run), setting) for run in runs]
    measured = [trajectory for trajectory, _ in every]
    return measured, sum(metrics["sweeps_lost"] for _, metrics in every)


def sequence(programs, setting):
    """ATE (m) and rotation error (degrees) of nodding_seq; None without the data."""
    folder = pathlib.Path(os.environ.get("NODMAP_DATA", ""), "nodding_seq")
    if not folder.is_dir():
        return None
    return json.loads(call(programs / "nodmap-bench-registration", "sequence", folder, *settings(setting.split())))


def cells(drives, runs, ring, setting):
    measured, lost = measure(drives, runs, setting)
    ate_m = [each["ate_rmse_m"] for each in measured]
    rotation_deg = [each["rot_rmse_deg"] for each in measured]
    (around,), _ = measure(drives, [ring], setting)
    row = [f"{100 * sum(ate_m) / len(ate_m):.2f} cm", f"{100 * max(ate_m):.1f} cm", f"{sum(rotation_deg) / len(rotation_deg):.3f}°", str(lost),
           f"{100 * around['ate_rmse_m']:.2f} cm"]
    clouds = sequence(drives.programs, setting)
    return row + ([f"{1000 * clouds['ate_rmse_m']:.1f} mm", f"{clouds['rot_rmse_deg']:.3f}°"] if clouds else ["", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the drives (1.5 GB) are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--choose", action="store_true", help="use seeds on which parameters may be chosen")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), metavar="PART")
    options = parser.parse_args()
    some_seeds = seeds.CHOOSING[1:3] if options.choose else seeds.REPORTING[101:103]
    runs = [(world, seed, DURATION_S) for world in WORLDS for seed in some_seeds]
    with result_folder(options.out, may_contain=True) as out:
        drives = Drives(out, options.bin)
        print("| without | ATE, mean | worst | rotation | LOST | ATE, ring | nodding_seq | rotation |\n|---|---|---|---|---|---|---|---|")
        for part in options.only:
            print(f"| {part} | {' | '.join(cells(drives, runs, ('ring', some_seeds[0], RING_S), PARTS[part]))} |", flush=True)


if __name__ == "__main__":
    main()
