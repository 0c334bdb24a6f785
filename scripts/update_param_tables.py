#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the parameter table of the README of each module, driver and the simulator between its markers, as the program prints it. With --check only compares.

Every program that needs a parameter of the robot has all of them: these rows stand once, in common/robot/README.md.

usage: update_param_tables.py BIN_DIR [--check]
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"<!-- parameters -->\n.*?<!-- /parameters -->", re.S)
ROBOT = "common/robot/README.md"
ROBOT_ROWS = re.compile(r"(?:\| `robot\..*\n)+")
ROBOT_LINK = f"| `robot.*` | | | The robot, described alike for all programs: [common/robot](../../{ROBOT}). |\n"


def table_for(readme, bin_dir):
    name = "navigator" if readme == ROOT / ROBOT else readme.parent.name.replace("_", "-")
    table = subprocess.run([bin_dir / f"nodmap-{name}", "--params-markdown"], capture_output=True, text=True, check=True).stdout
    if readme == ROOT / ROBOT:
        return "".join(table.splitlines(True)[:2]) + ROBOT_ROWS.search(table)[0]
    return ROBOT_ROWS.sub(ROBOT_LINK, table)


def main():
    bin_dir, check = pathlib.Path(sys.argv[1]), "--check" in sys.argv[2:]
    stale = []
    for readme in sorted(readme for where in ("common/robot", "modules/*", "drivers/*", "sim") for readme in ROOT.glob(f"{where}/README.md")):
        text = readme.read_text()
        if not BLOCK.search(text):
            continue
        table = table_for(readme, bin_dir)
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
