#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the paper's figures from simulated runs: docs/pictures/paper/figN.png and docs/paper.md. Exits 1 when a target is missed."""
import argparse
import concurrent.futures
import importlib
import os
import sys

import page
from pool import Pool

FIGURES = [3, 4, 5, 6, 7, 8, 9]


def run_trials(figures, jobs):
    """Runs all trials, `jobs` at a time."""
    trials = [trial for figure in figures.values() for trial in figure.TRIALS]
    with Pool(jobs) as pool:
        running = {pool.submit(trial.run): trial for trial in trials}
        for done, future in enumerate(concurrent.futures.as_completed(running), 1):
            future.result()
            show(f"run {done} of {len(trials)}: {running[future].name}")


def show(text):
    """Shows progress: on a terminal in one line that is overwritten, elsewhere in a line each."""
    if sys.stdout.isatty():
        print(f"\r\033[K{text}", end="", flush=True)
    else:
        print(text, flush=True)


def main():
    parser = argparse.ArgumentParser(prog="./nodmap figures", description=__doc__)
    parser.add_argument("figures", metavar="N", nargs="*", type=int, help=f"the figures to draw, of {FIGURES}; default: all")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="how many trials run at the same time; default: one for each processor")
    arguments = parser.parse_args()
    wanted = sorted(set(arguments.figures)) or FIGURES
    unknown = set(wanted) - set(FIGURES)
    if unknown:
        parser.error(f"there is no figure {min(unknown)}; there are {', '.join(map(str, FIGURES))}")
    figures = {number: importlib.import_module(f"fig{number}") for number in wanted}
    run_trials(figures, arguments.jobs)
    made = {}
    for number, figure in figures.items():
        show(f"drawing figure {number}")
        made[number] = {"commands": [trial.command() for trial in figure.TRIALS], **figure.make()}
    page.write(made)
    show("")
    for number, each in made.items():
        print(f"Fig. {number}: {each['title']}")
        for what, measured, target, ok in each.get("holds", []):
            print(f"    {what}: {measured} ({target}){'' if ok else '  MISSED'}")
    print(f"the page is {page.PAGE}")
    return 0 if all(row[3] for each in made.values() for row in each.get("holds", [])) else 1


if __name__ == "__main__":
    sys.exit(main())
