#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over the translation units that the build in the given folder compiles with clang, as many at a time as there are processors.

usage: run_clang_tidy.py BUILD_DIR [--all | --changed]
    --all       the tests too, by tests/.clang-tidy
    --changed   only units with a source that changed, or whose header of the same name did, since the branch left origin/main; on main itself
                in the last 10 commits. What is not committed counts.

Most of the time goes into the headers of the standard library and Eigen, so sources that are compiled as one are checked as one. A unit is
checked again only when something that it is made of has changed: the key of a good run, a digest of the preprocessed text, of the rules and of
clang-tidy's version, is kept in the user's cache ($XDG_CACHE_HOME/nodmap/clang-tidy), for every clone.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

from check_layers import is_test

ROOT = pathlib.Path(__file__).resolve().parent.parent
GOOD = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "nodmap" / "clang-tidy"
VERSION = subprocess.run(["clang-tidy", "--version"], capture_output=True).stdout


def sources_of(entry):
    """The sources, as paths in the repository, that the unit of an entry of compile_commands.json is made of; none if it is generated."""
    unit = pathlib.Path(entry["file"])
    files = [unit]
    if unit.name.startswith("unity_"):
        files = [pathlib.Path(name) for name in re.findall(r'#include "(.*)"', unit.read_text())]
    build = pathlib.Path(entry["directory"])
    return [file.relative_to(ROOT) for file in files if file.is_relative_to(ROOT) and not file.is_relative_to(build)]


def compiler_command(entry):
    """The words of the compiler's command of an entry, without a cache in front and without its output."""
    command = shlex.split(entry["command"])
    if "ccache" in command[0]:
        command = command[1:]
    out = command.index("-o")
    return command[:out] + command[out + 2:]


def key_of(entry, config):
    """A digest of all that clang-tidy would see, or None where the preprocessor fails."""
    command = compiler_command(entry)
    # With comments, which hold the NOLINT marks. What is precompiled is of the packages, whose version is clang's own.
    run = subprocess.run(command + ["-E", "-P", "-CC"], cwd=entry["directory"], capture_output=True)
    return hashlib.sha256(run.stdout + config.read_bytes() + VERSION).hexdigest() if run.returncode == 0 else None


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True).stdout.split()


def changed_sources():
    """Paths in the repository without their extension."""
    head, base = git("rev-parse", "HEAD"), git("merge-base", "HEAD", "origin/main")
    since = base if base and base != head else git("rev-list", "--max-count=11", "HEAD")[-1:]
    return {pathlib.Path(name).with_suffix("") for name in git("diff", "--name-only", *since)}


def check(build, entry):
    """Returns what clang-tidy says of one unit: an empty text if it is good."""
    sources = sources_of(entry)
    config = ROOT / ("tests/.clang-tidy" if is_test(sources[0]) else ".clang-tidy")
    key = key_of(entry, config)
    if key and (GOOD / key).exists():
        return ""
    # Sources that are compiled as one are included by a generated file.
    run = subprocess.run(["clang-tidy", "-quiet", "-p", str(build), f"--config-file={config}", "--checks=-bugprone-suspicious-include",
                          entry["file"]], capture_output=True, text=True)
    if run.returncode != 0:
        return run.stdout or f"{sources[0]}: clang-tidy failed: {run.stderr}"
    if key:
        GOOD.mkdir(parents=True, exist_ok=True)
        (GOOD / key).touch()
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0], allow_abbrev=False)
    parser.add_argument("build", type=lambda name: pathlib.Path(name).resolve())
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--all", action="store_true")
    choice.add_argument("--changed", action="store_true")
    arguments = parser.parse_args()
    build = arguments.build
    units = {}  # by file: a source may be in two programs
    for entry in json.loads((build / "compile_commands.json").read_text()):
        sources = sources_of(entry)
        if sources and (arguments.all or not is_test(sources[0])):
            units[entry["file"]] = entry
    if arguments.changed:
        changed = changed_sources()
        units = {file: unit for file, unit in units.items() if any(s.with_suffix("") in changed for s in sources_of(unit))}
    bad = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for done, output in enumerate(pool.map(lambda unit: check(build, unit), units.values()), 1):
            if sys.stderr.isatty():
                print(f"\r{done}/{len(units)}", end="", file=sys.stderr)
            if output:
                bad += 1
                print(output, flush=True)
    print(f"clang-tidy: {len(units)} units, {bad} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
