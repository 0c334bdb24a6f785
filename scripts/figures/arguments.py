#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The arguments of ./nodmap figures. As a program it only checks them: it needs no packages, and so runs before any are installed."""
import argparse
import os

FIGURES = [3, 4, 5, 6, 7, 8, 9]


def read_arguments():
    """The arguments of this process; ends it with exit code 2 if they are wrong."""
    parser = argparse.ArgumentParser(prog="./nodmap figures", description="Makes the paper's figures from simulated runs: docs/pictures/paper/figN.png and "
                                     "docs/paper.md. Exits 1 when a target is missed.")
    parser.add_argument("figures", metavar="N", nargs="*", type=int, help=f"the figures to draw, of {FIGURES}; default: all")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="how many trials run at the same time; default: one for each processor")
    parser.add_argument("--no-page", action="store_true", help="leave the page as it is, and its images; the new images are then in logs/figures")
    arguments = parser.parse_args()
    unknown = set(arguments.figures) - set(FIGURES)
    if unknown:
        parser.error(f"there is no figure {min(unknown)}; there are {', '.join(map(str, FIGURES))}")
    arguments.figures = sorted(set(arguments.figures)) or FIGURES
    return arguments


if __name__ == "__main__":
    read_arguments()
