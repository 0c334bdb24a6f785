#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compiles sources each alone, with the flags of the build in the given folder, but only as far as their errors.

usage: compile_alone.py BUILD_DIR [--all | --changed]
    --all       every source; without it, all but the tests
    --changed   only sources that changed, or whose header of the same name did, as run_clang_tidy.py takes them

The build compiles up to sixteen sources as one. One of them may therefore use a constant or an include of another without anyone noticing, and
change its meaning when that one does.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

from check_layers import is_test
from run_clang_tidy import ROOT, changed_sources, compiler_command, sources_of


def command_for(entry, source):
    """The build's command, for this source instead of the unit that it is joined into."""
    return [str(ROOT / source) if word == entry["file"] else word for word in compiler_command(entry)] + ["-fsyntax-only"]


def check(entry, source):
    """Returns what the compiler says: an empty text if it compiles."""
    run = subprocess.run(command_for(entry, source), cwd=entry["directory"], capture_output=True, text=True)
    return "" if run.returncode == 0 else run.stderr or f"{source}: does not compile\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0], allow_abbrev=False)
    parser.add_argument("build", type=lambda name: pathlib.Path(name).resolve())
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--all", action="store_true")
    choice.add_argument("--changed", action="store_true")
    arguments = parser.parse_args()
    entries = {}  # by source: it may be in two programs
    for entry in json.loads((arguments.build / "compile_commands.json").read_text()):
        sources = sources_of(entry)
        if len(sources) > 1:  # others are compiled alone anyway
            entries.update({source: entry for source in sources if arguments.all or not is_test(source)})
    if arguments.changed:
        changed = changed_sources()
        entries = {source: entry for source, entry in entries.items() if source.with_suffix("") in changed}
    bad = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for output in pool.map(check, entries.values(), entries.keys()):
            if output:
                bad += 1
                print(output, end="", flush=True)
    print(f"compiled alone: {len(entries)} sources, {bad} do not compile")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
