# SPDX-License-Identifier: BSD-3-Clause
"""Runs the programs of a build."""
import json
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = ROOT / "build" / "release" / "bin"


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
