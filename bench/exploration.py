#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Explores generated office buildings of ten rooms, with the tour and with the nearest frontier, and prints a table for docs/benchmark-navigation.md.

    bench/exploration.py [--seeds N] [--first SEED] [--duration S] [--jobs N] [--set KEY=VALUE ...] [--json] [--out DIR] [--bin DIR]

Seeds 0 to 999 are for reporting, 1000 to 1999 for choosing parameters, and each wheel counts 3 % too much (bench/seeds.py). The columns are: the distance
driven (m) and the time (s) until the 2D map showed 90 % of the floor; the fraction of the floor that it showed at the end; the time (s) until the robot
reported that it was home, the whole distance driven (m), and its true distance from the start then (m); the number of collisions. The last lines compare the
mean distance to 90 % of the floor of both policies.
"""
import argparse
import json
import sys

from navigation import rounded
from programs import settings as options_of
from seeds import ODOMETRY_NOISE
from trial_runs import Trial, add_options, add_seed_options, add_set_option, result_folder, run_all, seeds_of, show_failures, show_table

POLICIES = ["tour", "nearest_frontier"]
COLUMNS = ["seed", "policy", "to_90_m", "to_90_s", "seen", "home_s", "path_m", "from_start_m", "collisions"]


def make_trials(seeds, duration_s, settings):
    options = ["--explore", "--no-slam6d", *ODOMETRY_NOISE, *options_of(settings)]
    return [(seed, policy, Trial(f"building-{seed}-{policy}", f"building:{seed}", seed, duration_s, *options, "--set", f"explorer.policy={policy}"))
            for seed in seeds for policy in POLICIES]


def row_of(seed, policy, result):
    exploration = result["exploration"]
    row = {"seed": seed, "policy": policy, "seen": rounded(exploration["seen_ratio"], 3), "collisions": result["collisions"]}
    for key, digits in (("to_90_m", 1), ("to_90_s", 0), ("home_s", 0), ("path_m", 1), ("from_start_m", 3)):
        row[key] = rounded(exploration[key], digits)
    return row


def show_ratio(rows):
    """Prints the mean distances and their ratio, over the buildings in which both policies have seen 90 % of the floor."""
    to_90_m = {policy: {row["seed"]: row["to_90_m"] for row in rows if row["policy"] == policy and row["to_90_m"]} for policy in POLICIES}
    both = sorted(set(to_90_m["tour"]) & set(to_90_m["nearest_frontier"]))
    means = [sum(to_90_m[policy][seed] for seed in both) / max(1, len(both)) for policy in POLICIES]
    if both:
        print(f"\nmean distance until 90 % was seen, over {len(both)} buildings: tour {means[0]:.1f} m, nearest frontier {means[1]:.1f} m; "
              f"ratio {means[0] / means[1]:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_seed_options(parser, 10)
    parser.add_argument("--duration", type=float, default=600.0, help="longest time of an exploration, seconds")
    add_set_option(parser)
    parser.add_argument("--json", action="store_true", help="print a JSON object for each exploration instead of the table")
    add_options(parser)
    arguments = parser.parse_args()
    trials = make_trials(seeds_of(arguments), arguments.duration, arguments.set)
    with result_folder(arguments.out) as out:
        run_all([trial for _, _, trial in trials], arguments.bin, out, arguments.jobs)
        rows = [row_of(seed, policy, trial.result) for seed, policy, trial in trials if trial.result]
        if arguments.json:
            for row in rows:
                print(json.dumps(row))
        else:
            show_table(COLUMNS, [["" if row[column] is None else row[column] for column in COLUMNS] for row in rows])
            show_ratio(rows)
    return 1 if show_failures(trial for _, _, trial in trials) else 0


if __name__ == "__main__":
    sys.exit(main())
