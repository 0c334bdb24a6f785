#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the worlds of the BARN challenge (static or dynamic) and prints one JSON object with the challenge's score.

    bench/barn.py FILE [OPTIMAL] [--robot kurt3d|jackal] [--runs N] [--first S] [--only I,J,...] [--every K] [--jobs N] [--set KEY=VALUE ...] [--out DIR] [--bin DIR]

FILE holds the worlds as text (sim/world/barn_file.hpp); OPTIMAL the lengths of their reference paths (default: optimal.txt beside FILE). The robot has no map. A run ends
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


def is_dynamic(file):
    return "\nC " in file.read_text()


def world_indices(file):
    return [int(line.split()[1]) for line in file.read_text().splitlines() if line.startswith("W ")]


def make_trials(arguments):
    """The trials of each world, by its index."""
    options = ["--no-slam6d", "--robot", arguments.robot, *ODOMETRY_NOISE, *settings(arguments.set)]
    if is_dynamic(arguments.file):
        options += ["--without", "slam2d"]
    indices = arguments.only or world_indices(arguments.file)[::arguments.every]
    return {index: [Trial(f"{index}-{seed}", f"barn:{arguments.file}:{index}", seed, None, *options) for seed in range(arguments.first, arguments.first + arguments.runs)] for index in indices}


def reference_paths(file):
    """The length of the reference path (m) of each world: a line of FILE is its index, this length, and what is not used here."""
    lines = [line.split() for line in file.read_text().splitlines()]
    return {int(line[0]): float(line[1]) for line in lines if line and not line[0].startswith("#")}


def indices_of(text):
    """The indices in "I,J,...", which may also be apart by blanks."""
    return [int(index) for index in text.replace(",", " ").split()]


def outcome_of(result, reference_path_m=None):
    """The outcome, time (s) and score of a run by the rules of the challenge. Without `reference_path_m`, with the one of the trial."""
    goal = result["goal"]
    if result["collisions"] or result["bumped"]:
        return "collision", None, 0.0
    if not goal["reached"]:
        return "timeout", None, 0.0
    optimal_s = (reference_path_m or goal["reference_path_m"]) / OPTIMAL_MPS
    time_s = goal["after_motion_s"]
    return "success", time_s, optimal_s / min(max(time_s, 2 * optimal_s), 8 * optimal_s)


def run_of(trial, reference_path_m=None):
    """The outcome, time and score of a trial, and whether the robot caused a contact."""
    outcome, time_s, score = outcome_of(trial.result, reference_path_m)
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
    parser.add_argument("optimal", type=pathlib.Path, nargs="?", help="lengths of the reference paths; default: optimal.txt beside FILE")
    parser.add_argument("--robot", choices=["kurt3d", "jackal"], default="kurt3d")
    parser.add_argument("--runs", type=int, default=1, help="runs of each world, with the seeds from --first on")
    parser.add_argument("--first", type=int, default=0, help="first seed of the noise")
    parser.add_argument("--only", type=indices_of, metavar="I,J,...", help="indices of the worlds; default: all")
    parser.add_argument("--every", type=int, default=1, help="drive only every K-th world")
    add_set_option(parser)
    add_options(parser)
    arguments = parser.parse_args()
    paths = reference_paths(arguments.optimal) if arguments.optimal else {}
    if not is_dynamic(arguments.file) and not arguments.optimal and not (arguments.file.parent / "optimal.txt").exists():
        parser.error(f"there is no optimal.txt beside {arguments.file}: name the file with the lengths of the reference paths as OPTIMAL")
    worlds = make_trials(arguments)
    if without := [index for index in worlds if arguments.optimal and index not in paths]:
        parser.error(f"{arguments.optimal} has no reference path of the worlds {without}")
    every = [trial for trials in worlds.values() for trial in trials]
    with result_folder(arguments.out) as out:
        run_all(every, arguments.bin, out, arguments.jobs)
    if show_failures(every):
        return 1
    print(json.dumps(summary([[run_of(trial, paths.get(index)) for trial in trials] for index, trials in worlds.items()])))
    return 0


if __name__ == "__main__":
    sys.exit(main())
