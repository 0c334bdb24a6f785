#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the paper's figures from simulated runs: docs/pictures/paper/figN.png and docs/paper.md. Exits 1 when a target is missed."""
import importlib
import pathlib
import shutil
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "bench"))
from arguments import read_arguments  # noqa: E402
import page  # noqa: E402
import style  # noqa: E402
from trial_runs import run_all, show_failures  # noqa: E402
from trials import BIN, OUT  # noqa: E402


def run_trials(figures, jobs):
    """Runs all trials, `jobs` at a time; returns how many have failed."""
    trials = [trial for figure in figures.values() for trial in figure.TRIALS]
    for trial in trials:
        shutil.rmtree(trial.dir, ignore_errors=True)  # with the tables of an earlier run
    run_all(trials, BIN, OUT, jobs)
    return show_failures(trials)


def main():
    arguments = read_arguments()
    if arguments.no_page:
        style.PICTURES = OUT
    figures = {number: importlib.import_module(f"fig{number}") for number in arguments.figures}
    if run_trials(figures, arguments.jobs):
        return 1
    made = {}
    for number, figure in figures.items():
        made[number] = {"commands": [trial.command() for trial in figure.TRIALS], **figure.make()}
    if not arguments.no_page:
        page.write(made)
        print(f"the page is {page.PAGE}")
    for number, each in made.items():
        print(f"Fig. {number}: {each['title']}")
        for what, measured, target, ok in each.get("holds", []):
            print(f"    {what}: {measured} ({target}){'' if ok else '  MISSED'}")
    return 0 if all(row[3] for each in made.values() for row in each.get("holds", [])) else 1


if __name__ == "__main__":
    sys.exit(main())
