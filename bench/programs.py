# SPDX-License-Identifier: BSD-3-Clause
"""Runs the programs of a build."""
import json
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = ROOT / "build" / "release" / "bin"
LOGS = ("intel", "fr079", "mit-csail")  # the public logs of 2D SLAM (docs/benchmark-2d.md)


def call(program, *arguments):
    """Runs a program and returns what it prints; raises RuntimeError with its error message."""
    done = subprocess.run([str(program), *(str(argument) for argument in arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{pathlib.Path(program).name}: {done.stderr.strip()}")
    return done.stdout


def evaluate(bin_dir, *arguments):
    return json.loads(call(bin_dir / "nodmap-evaluate", *arguments))


def settings(assignments):
    """The options for these assignments KEY=VALUE."""
    return [word for assignment in assignments for word in ("--set", assignment)]


def map_log(bin_dir, clf, out, *options):
    """Maps a CARMEN log into the folder `out`; leaves the converted log beside it."""
    log = clf.with_suffix(".lcmlog")
    call(bin_dir / "nodmap-convert", "carmen", clf, log)
    call(bin_dir / "nodmap-slam2d", "--replay", log, "--out", out, *options)
