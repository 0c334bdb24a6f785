#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the worlds of the BARN challenge (static or dynamic) and prints one JSON object with the challenge's score.

    bench/barn.py FILE [--robot kurt3d|jackal] [--runs N] [--worlds I ...] [--every K] [--jobs N] [--set KEY=VALUE ...] [--out DIR] [--bin DIR]

FILE holds the worlds as text (sim/world/barn_file.hpp); optimal.txt beside it holds the lengths of the reference paths. The robot has no map. A run ends
at the first contact, within 1 m of the goal, or 100 s after the robot has moved by 0.1 m. Its score is

    s = success * OT / clip(T, 2 OT, 8 OT),

where OT is the time for the reference path at 2 m/s, and T the time since the robot has moved by 0.1 m. The result is the mean over the runs of each
world, and then over the worlds; the highest possible score is 0.5. The dynamic worlds contain nothing but moving objects, which gives 2D SLAM nothing to
map; in them the robot drives by odometry. The worlds are the public ones, but the simulator is ours: the robot's motion, the laser's noise and the
latencies are those of nodmap-trial, not those of the challenge's Gazebo, and each wheel counts 3 % too much (bench/seeds.py). A run is determined by
its seed.
"""
import argparse
import json
import pathlib
import sys

from navigation import mean
from programs import settings
from seeds import ODOMETRY_NOISE
from trial_runs import Trial, add_options, add_set_option, result_folder, run_all, show_failures

OPTIMAL_MPS = 2.0


def world_indices(file):
    return [int(line.split()[1]) for line in file.read_text().splitlines() if line.startswith("W ")]


def make_trials(arguments):
    """The trials of each world, by its index."""
    options = ["--no-slam6d", "--robot", arguments.robot, *ODOMETRY_NOISE, *settings(arguments.set)]
    if "\nC " in arguments.file.read_text():  # dynamic
        options += ["--without", "slam2d"]
    indices = arguments.worlds or world_indices(arguments.file)[::arguments.every]
    return {index: [Trial(f"{index}-{seed}", f"barn:{arguments.file}:{index}", seed, None, *options) for seed in range(arguments.runs)] for index in indices}


def outcome_of(result):
    """The outcome, time (s) and score of a run by the rules of the challenge."""
    goal = result["goal"]
    if result["collisions"] or result["bumped"]:
        return "collision", None, 0.0
    if not goal["reached"]:
        return "timeout", None, 0.0
    optimal_s = goal["reference_path_m"] / OPTIMAL_MPS
    time_s = goal["after_motion_s"]
    return "success", time_s, optimal_s / min(max(time_s, 2 * optimal_s), 8 * optimal_s)


def run_of(trial):
    """The outcome, time and score of a trial, and whether the robot caused a contact."""
    outcome, time_s, score = outcome_of(trial.result)
    print(f"world-seed {trial.name}: {outcome}" + (f" {time_s:.1f} s" if time_s else "") + f", score {score:.3f}", file=sys.stderr)
    return outcome, time_s, score, trial.result["contacts_caused"] > 0


def summary(worlds):
    """Means over the runs. `worlds`: for each world the list of its runs, as of run_of()."""
    runs = [run for world in worlds for run in world]
    share = {name: mean([run[0] == name for run in runs]) for name in ("success", "collision", "timeout")}
    return {"n": len(runs), "score": mean([mean([run[2] for run in world]) for world in worlds]), **share,
            "contact_caused": mean([run[3] for run in runs]), "time_s": mean([run[1] for run in runs if run[1] is not None])}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--robot", choices=["kurt3d", "jackal"], default="kurt3d")
    parser.add_argument("--runs", type=int, default=1, help="runs of each world, with the seeds 0, 1, ...")
    parser.add_argument("--worlds", type=int, nargs="+", help="indices of the worlds; default: all")
    parser.add_argument("--every", type=int, default=1, help="drive only every K-th world")
    add_set_option(parser)
    add_options(parser)
    arguments = parser.parse_args()
    worlds = make_trials(arguments)
    every = [trial for trials in worlds.values() for trial in trials]
    with result_folder(arguments.out) as out:
        run_all(every, arguments.bin, out, arguments.jobs)
    if show_failures(every):
        return 1
    print(json.dumps(summary([[run_of(trial) for trial in trials] for trials in worlds.values()])))
    return 0


if __name__ == "__main__":
    sys.exit(main())
