#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps each public log in one session and in two, where the second half is mapped with --map-in on the map of the first half.

bench/slam2d_sessions.py --data DIR [--bin DIR]

DIR holds NAME.clf and NAME.relations of intel, fr079 and mit-csail (docs/benchmark-2d.md). Prints a table of the errors over all relations, including
those between the sessions, and of how many relations have no pose because the robot had not been found yet.
"""
import argparse
import pathlib
import tempfile

from programs import BIN, LOGS, evaluate, map_log


def split(log, first, second):
    """Writes the two halves of a CARMEN log, each with the PARAM lines at its beginning."""
    lines = log.read_text(errors="replace").splitlines(keepends=True)
    head = [line for line in lines if line.startswith("PARAM")]
    middle = len(lines) // 2
    first.write_text("".join(lines[:middle]))
    second.write_text("".join(head + [line for line in lines[middle:] if not line.startswith("PARAM")]))


def map_session(programs, clf, out, *options):
    map_log(programs, clf, out, *options)
    return (out / "trajectory.tum").read_text()


def errors(programs, trajectory, relations, folder):
    file = folder / "all.tum"
    file.write_text(trajectory)
    return evaluate(programs, "relations", file, relations)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True)
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    arguments = parser.parse_args()
    print("| log | one session | two sessions | relations without a pose |\n|---|---|---|---|")
    for name in LOGS:
        with tempfile.TemporaryDirectory() as work:
            folder = pathlib.Path(work)
            clf, relations = arguments.data / f"{name}.clf", arguments.data / f"{name}.relations"
            split(clf, folder / "first.clf", folder / "second.clf")
            (folder / "whole.clf").write_bytes(clf.read_bytes())
            whole = map_session(arguments.bin, folder / "whole.clf", folder / "whole")
            first = map_session(arguments.bin, folder / "first.clf", folder / "first")
            second = map_session(arguments.bin, folder / "second.clf", folder / "second", "--map-in", folder / "first")
            one, two = (errors(arguments.bin, text, relations, folder) for text in (whole, first + second))
            print(f"| {name} | {one['trans_mean_m']:.4f} m, {one['rot_mean_deg']:.3f}° | {two['trans_mean_m']:.4f} m, {two['rot_mean_deg']:.3f}° "
                  f"| {two['missing']} of {two['n'] + two['missing']} |", flush=True)


if __name__ == "__main__":
    main()
