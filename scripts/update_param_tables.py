#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the parameter table of the README of each module, driver and the simulator between its markers, as the program prints it. With --check only compares.

usage: update_param_tables.py BIN_DIR [--check]
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"<!-- parameters -->\n.*?<!-- /parameters -->", re.S)


def main():
    bin_dir, check = pathlib.Path(sys.argv[1]), "--check" in sys.argv[2:]
    stale = []
    for readme in sorted(readme for where in ("modules/*", "drivers/*", "sim") for readme in ROOT.glob(f"{where}/README.md")):
        program = bin_dir / ("nodmap-" + readme.parent.name.replace("_", "-"))
        text = readme.read_text()
        if not BLOCK.search(text):
            continue
        table = subprocess.run([program, "--params-markdown"], capture_output=True, text=True, check=True).stdout
        fresh = BLOCK.sub(lambda _: f"<!-- parameters -->\n{table}<!-- /parameters -->", text)
        if fresh != text:
            stale.append(str(readme.relative_to(ROOT)))
            if not check:
                readme.write_text(fresh)
    if check and stale:
        print("stale parameter tables, run ./nodmap docs:", *stale)
        return 1
    print("parameter tables:", "up to date" if not stale else "wrote " + ", ".join(stale))
    return 0


if __name__ == "__main__":
    sys.exit(main())
