#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the generated worlds, family by family, and prints a table for docs/benchmark-navigation.md.

    bench/navigation.py [--seeds N] [--first SEED] [--only FAMILY ...] [--jobs N] [--set KEY=VALUE ...] [--explored] [--label TEXT] [--json] [--out DIR] [--bin DIR]

Seeds 0 to 999 are for reporting, 1000 to 1999 for choosing parameters, and each wheel counts 3 % too much (bench/seeds.py). With --explored
the robot explores each world first, and then drives to the goal from where it began, localising in the map that it has saved. The columns are:
  n                      runs; how many of how many if some have failed
  collisions, caused     contacts of the robot, and how many of them it caused: it moved at 0.05 m/s or more
  falls                  how often the robot fell into a hole
  bumped                 how often a person walked into the stationary robot
  reached                runs that reached the goal without a collision (family contact: also with)
  spl, time_s            success weighted by path length; median time of the runs that reached the goal
  mean_mps, clearance_m  mean speed; least clearance of all runs
  close_s                seconds with a person nearer than 0.45 m, over all runs (families with people)
  progress               speed towards the goal, relative to the same worlds without people (families with people)
  slips                  how often the robot noticed that its wheels slip
  noticed_s              how long after a contact: median, worst, and how many within 0.5 s (family contact)
  off_cm, off_deg        true distance and angle from a goal with a heading after docking: median and worst
The exit code is 1 if a run failed, or if the robot has hit something or fallen in a family without people. In the family contact
the robot runs into what its laser does not see.
"""
import argparse
import json
import lzma
import os
import pathlib
import statistics
import sys

from programs import settings as options_of
from seeds import ODOMETRY_NOISE
from trial_runs import Trial, add_options, add_seed_options, add_set_option, result_folder, results_of, run_all, seeds_of, show_failures, show_table

# For each family its scenarios, and the seconds that a run may take.
FAMILIES = {"random": (["random"], 60), "dense": (["dense"], 60), "holes": (["holes"], 120), "goals": (["goals"], 120),
            "mazes": (["maze", "zigzag", "dead-end", "slot"], 180), "doors": (["doors", "office"], 180),
            "people": (["people"], 60), "reacting": (["reacting"], 60), "recorded": (["eth", "zara01"], 60),
            "ramps": (["ramps"], 60), "sills": (["sills"], 90), "glass": (["glass"], 90), "drums": (["drums"], 90),
            "contact": (["contact"], 60),
            "corridor": (["corridor"], 120), "docks": (["dock"], 120)}
EXPLORATION_S = 400
# The robot runs into something that its laser does not see, and must leave it again.
INTO_CONTACT = ["contact"]
WITH_PEOPLE = ["people", "reacting", "recorded"]
FRAMES_PER_S = {"eth": 15, "zara01": 2.5}
COLUMNS = ["family", "n", "collisions", "caused", "falls", "bumped", "reached", "spl", "time_s", "mean_mps", "clearance_m", "slips", "close_s", "progress"]
CONTACT_COLUMNS = ["noticed_s", "worst_noticed_s", "within_half_s"]
# For families whose goals have a heading.
DOCKING_COLUMNS = ["off_cm", "worst_off_cm", "off_deg", "worst_off_deg"]


def recorded_crowds(folder):
    """Unpacks the recordings in NODMAP_DATA to text files in `folder`, and returns these by name."""
    data = os.environ.get("NODMAP_DATA")
    files = {}
    for name in FRAMES_PER_S:
        packed = pathlib.Path(data or "", "pedestrians", name + ".txt.xz")
        if data and packed.exists():
            files[name] = folder / (name + ".txt")
            files[name].write_bytes(lzma.decompress(packed.read_bytes()))
    return files


def world_name(scenario, seed, crowds):
    if scenario in FRAMES_PER_S:
        return f"pedestrians:{crowds[scenario]}:{FRAMES_PER_S[scenario]}:{seed}"
    return f"{scenario}:{seed}"


def make_trials(family, seeds, settings, crowds):
    """The trials of a family, and for families with people the same trials without them."""
    scenarios, duration_s = FAMILIES[family]
    options = ["--no-slam6d", *ODOMETRY_NOISE, *options_of(settings)]
    trials, empty = [], []
    for scenario in scenarios:
        if scenario in FRAMES_PER_S and scenario not in crowds:
            print(f"{scenario}: left out, because its recording is not in NODMAP_DATA", file=sys.stderr)
            continue
        for seed in seeds:
            world = world_name(scenario, seed, crowds)
            trials.append(Trial(f"{scenario}-{seed}", world, seed, duration_s, *options))
            if family in WITH_PEOPLE:
                empty.append(Trial(f"{scenario}-{seed}-nobody", world, seed, duration_s, *options, "--no-actors"))
    return trials, empty


def explore_first(trials, bin_dir, out, jobs):
    """Explores the world of each trial, and lets the trial localise in the map of that. Returns the explorations."""
    explorations = [Trial(f"{trial.name}-explored", trial.world, trial.seed, EXPLORATION_S, *trial.options, "--explore") for trial in trials]
    run_all(explorations, bin_dir, out, jobs)
    for trial, exploration in zip(trials, explorations):
        trial.options = ["--set", "navigator.planner.use_map=true", *trial.options, "--localise", exploration.dir / "slam2d"]
    return explorations


def mean(values):
    return sum(values) / len(values) if values else None


def rounded(value, digits):
    return None if value is None else round(value, digits)


def progress(results):
    """The mean speed towards the goal over the runs, m/s."""
    rates = []
    for result in results:
        goal = result["goal"]
        time_s = goal["time_s"] if goal["reached"] else result["duration_s"]
        rates.append((goal["start_to_goal_m"] - goal["remaining_m"]) / time_s)
    return mean(rates)


def relative_progress(trials, empty):
    """The mean speed towards the goal among people, relative to that in the same worlds without them."""
    pairs = [(trial.result, alone.result) for trial, alone in zip(trials, empty) if trial.result and alone.result]
    alone_mps = progress([alone for _, alone in pairs])
    return progress([among for among, _ in pairs]) / alone_mps if alone_mps else None


def row_of(family, trials, empty):
    results = results_of(trials)
    row = {"family": family, "n": len(results) if len(results) == len(trials) else f"{len(results)} of {len(trials)}"}
    for column, key in (("collisions", "collisions"), ("caused", "contacts_caused"), ("falls", "falls"), ("bumped", "bumped")):
        row[column] = sum(result[key] for result in results)
    goals = [result for result in results if result["goal"]]
    reached = [result for result in goals if result["goal"]["reached"] and (family in INTO_CONTACT or not result["collisions"])]
    row["reached"] = f"{len(reached)}/{len(goals)}" if goals else None
    without_path = [trial.name for trial in trials if trial.result in goals and not trial.result["goal"]["shortest_path_m"]]
    if without_path:
        print(f"no path for a disc, so not in SPL: {' '.join(without_path)}", file=sys.stderr)
    spl = [result["goal"]["spl"] if result in reached else 0.0 for result in goals if result["goal"]["shortest_path_m"]]
    row["spl"] = rounded(mean(spl), 2)
    row["time_s"] = rounded(statistics.median(r["goal"]["time_s"] for r in reached), 1) if reached else None
    row["mean_mps"] = rounded(mean([result["mean_speed_mps"] for result in results]), 2)
    clearances = [result["min_clearance_m"] for result in results if result["min_clearance_m"] is not None]
    row["clearance_m"] = rounded(min(clearances), 3) if clearances else None
    row["close_s"] = rounded(sum(result["close_to_person_s"] for result in results), 1) if empty else None
    row["progress"] = rounded(relative_progress(trials, empty), 2)
    row["slips"] = sum(result["slips"] for result in results)
    if family in INTO_CONTACT:
        add_noticing(row, results)
    add_docking(row, [result["goal"] for result in reached])
    return row


def add_noticing(row, results):
    """Adds how soon after each contact slip was noticed; a contact that was not noticed before the next one counts as missed."""
    delays_s = [delay for result in results for delay in result["noticed_s"]]
    noticed_s = [delay for delay in delays_s if delay is not None]
    row["noticed_s"] = rounded(statistics.median(noticed_s), 2) if noticed_s else None
    row["worst_noticed_s"] = rounded(max(noticed_s), 2) if noticed_s else None
    row["within_half_s"] = f"{sum(delay <= 0.5 for delay in noticed_s)}/{len(delays_s)}"


def add_docking(row, goals):
    """Adds the distance and the angle from the goal at which the robot reported that it had docked: median and worst."""
    goals = [goal for goal in goals if goal["heading_error_deg"] is not None]
    if goals:
        off_cm = [100 * goal["remaining_m"] for goal in goals]
        off_deg = [abs(goal["heading_error_deg"]) for goal in goals]
        row["off_cm"], row["worst_off_cm"] = rounded(statistics.median(off_cm), 1), rounded(max(off_cm), 1)
        row["off_deg"], row["worst_off_deg"] = rounded(statistics.median(off_deg), 2), rounded(max(off_deg), 2)


def cell(column, value):
    """A value of the table; those of one column have equally many digits."""
    if value is None:
        return ""
    return f"{value:.2f}" if column in ("spl", "mean_mps", "progress") else str(value)


def show(rows, label):
    columns = COLUMNS + [column for column in CONTACT_COLUMNS + DOCKING_COLUMNS if any(column in row for row in rows)]
    show_table([label, *columns[1:]], [[cell(column, row.get(column)) for column in columns] for row in rows])


def has_contacts(row):
    return row["family"] not in WITH_PEOPLE + INTO_CONTACT and row["collisions"] + row["bumped"] + row["falls"] > 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_seed_options(parser, 10)
    parser.add_argument("--only", nargs="+", choices=FAMILIES, default=list(FAMILIES))
    add_set_option(parser)
    parser.add_argument("--explored", action="store_true", help="explore each world first, and localise in the map of that")
    parser.add_argument("--label", default="family", help="heading of the table's first column")
    parser.add_argument("--json", action="store_true", help="print a JSON object for each family instead of the table")
    add_options(parser)
    arguments = parser.parse_args()
    with result_folder(arguments.out) as out:
        crowds = recorded_crowds(out)
        families = {family: make_trials(family, seeds_of(arguments), arguments.set, crowds) for family in arguments.only}
        every = [trial for trials, empty in families.values() for trial in trials + empty]
        explorations = explore_first(every, arguments.bin, out, arguments.jobs) if arguments.explored else []
        run_all(every, arguments.bin, out, arguments.jobs)
        rows = [row_of(family, trials, empty) for family, (trials, empty) in families.items()]
        if arguments.json:
            for row in rows:
                print(json.dumps(row))
        else:
            show(rows, arguments.label)
    return 1 if show_failures(explorations + every) or any(has_contacts(row) for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
