#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what each part of the navigation contributes: drives the same worlds with and without it, and prints the tables of docs/ablation.md.

    bench/ablation.py [--only PART ...] [--seeds N] [--first SEED] [--jobs N] [--out DIR] [--bin DIR]

The worlds, their families and the columns are those of bench/navigation.py. A part that is removed is not replaced: several of these robots are unsafe
and are driven for comparison only.
"""
import argparse
import dataclasses
import sys

from navigation import make_trials, recorded_crowds, row_of, show
from trial_runs import add_options, add_seed_options, result_folder, run_all, seeds_of, show_failures

WITHOUT_LOCAL_MAP = ["navigator.local_map.use_local_map=false"]
BEHAVIOURS = ["navigator.planner.use_planner=false", "navigator.planner.roams=false"]


@dataclasses.dataclass
class Ablation:
    """A part of the navigation, the families of worlds in which it matters, and the settings of each variant by the variant's name."""
    title: str
    families: list
    variants: dict


ABLATIONS = {
    "laser": Ablation("Nodding or level laser, with the paper's behaviours and maps only", ["random", "sills", "drums"], {
        "nodding": BEHAVIOURS + WITHOUT_LOCAL_MAP,
        "level": BEHAVIOURS + WITHOUT_LOCAL_MAP + ["pitch_controller.mode=fixed"]}),
    "local-map": Ablation("Local map", ["random", "sills", "holes", "ramps"], {
        "with": [],
        "without": WITHOUT_LOCAL_MAP}),
    "planner": Ablation("Plan and rollouts, or Steer, Brake and Turn", ["random", "dense", "goals", "doors"], {
        "plan and rollouts": [],
        "Steer, Brake, Turn": BEHAVIOURS}),
    "nod": Ablation("Nod by speed or by plan", ["random", "dense", "goals", "holes"], {
        "by speed": [],
        "by plan": ["pitch_controller.follows_path=true"]}),
    "people": Ablation("Tracking of people", ["people", "reacting"], {
        "with": [],
        "without": ["navigator.people.use_people=false"]}),
}


def measure(ablation, seeds, bin_dir, out, jobs, crowds):
    """Runs all trials of an ablation; returns a row for each family and variant, and the number of trials without a result."""
    groups = []
    for family in ablation.families:
        for variant, settings in ablation.variants.items():
            trials, empty = make_trials(family, seeds, settings, crowds)
            for trial in trials + empty:
                trial.name = f"{variant.replace(' ', '-')}/{trial.name}"
            groups.append((f"{family}, {variant}", trials, empty))
    run_all([trial for _, trials, empty in groups for trial in trials + empty], bin_dir, out, jobs)
    failed = show_failures(trial for _, trials, empty in groups for trial in trials + empty)
    return [row_of(name, trials, empty) for name, trials, empty in groups], failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=ABLATIONS, default=list(ABLATIONS))
    add_seed_options(parser, 10)
    add_options(parser)
    arguments = parser.parse_args()
    failed = 0
    with result_folder(arguments.out) as out:
        crowds = recorded_crowds(out)
        for part in arguments.only:
            ablation = ABLATIONS[part]
            print(f"## {ablation.title}\n")
            (out / part).mkdir(exist_ok=True)
            rows, num_failed = measure(ablation, seeds_of(arguments), arguments.bin, out / part, arguments.jobs, crowds)
            failed += num_failed
            show(rows, "worlds")
            print(flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
