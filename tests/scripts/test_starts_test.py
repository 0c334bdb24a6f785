#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A test that runs a whole robot (sim.pmd or robot.pmd) starts nearly every program, so no nodmap_test_starts() may name fewer for it:
./nodmap test would leave it out after a change of the others.

usage: test_starts_test.py SOURCE_DIR
"""
import pathlib
import re
import sys

TESTS = pathlib.Path(sys.argv[1]) / "tests"


def name_of_test(script, cmake):
    """The name under which a CMakeLists.txt adds the test that runs this script."""
    command = re.search(rf"(?:add_test\(NAME|nodmap_add_network_test\() *(\w+)[^()]*/{re.escape(script.name)}\b", cmake)
    assert command, f"{script}: no test runs it"
    return command[1]


def main():
    errors, found = [], 0
    for script in sorted([*TESTS.glob("*/*_test.sh"), *TESTS.glob("*/*_test.py")]):
        if script.parent.name != "scripts" and re.search(r"\b(sim|robot)\.pmd\b", script.read_text()):
            cmake = (script.parent / "CMakeLists.txt").read_text()
            name = name_of_test(script, cmake)
            found += 1
            if re.search(rf"nodmap_test_starts\({name}\b", cmake):
                errors.append(f"{script.relative_to(TESTS)}: runs a whole robot, but nodmap_test_starts({name} ...) names single programs")
    assert found >= 3, f"only {found} tests run a whole robot"
    print("\n".join(errors) or f"{found} tests may start every program")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
