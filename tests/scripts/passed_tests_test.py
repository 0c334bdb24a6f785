#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which tests scripts/passed_tests.py runs again, in an artificial build folder whose programs are shell scripts, of which one is missing.

usage: passed_tests_test.py SOURCE_DIR
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])

CMAKE = """
cmake_minimum_required(VERSION 3.25)
project(made_up NONE)
enable_testing()
add_test(NAME alone COMMAND ${CMAKE_BINARY_DIR}/tests/alone)
add_test(NAME starts_one COMMAND ${CMAKE_BINARY_DIR}/tests/starts_one)
add_test(NAME processes COMMAND true)
add_test(NAME skips COMMAND false)
add_test(NAME not_built COMMAND ${CMAKE_BINARY_DIR}/tests/not_built)
set_tests_properties(processes skips PROPERTIES LABELS integration)
set_tests_properties(skips PROPERTIES SKIP_RETURN_CODE 1)
"""


class MadeUpBuild:
    def __init__(self, folder):
        self.folder = folder
        (folder / "CMakeLists.txt").write_text(CMAKE)
        for name in ("tests/alone", "tests/starts_one", "bin/one", "bin/two"):
            self.write(name, "exit 0")
        (folder / "test_starts.txt").write_text("starts_one one\n")
        subprocess.run(["cmake", "-S", folder, "-B", folder], check=True, capture_output=True)

    def write(self, name, line):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"#!/bin/sh\n{line}\n")
        path.chmod(0o755)

    def script(self, *arguments):
        environment = os.environ | {"NODMAP_DATA": str(self.folder / "no recordings")}
        run = subprocess.run([SOURCE / "scripts/passed_tests.py", *arguments], env=environment, check=True, capture_output=True, text=True)
        return run.stdout

    def run(self, *options):
        """Runs the tests that must run again; returns their names."""
        selection, report = self.folder / "now.selection", self.folder / "now.xml"
        must_run, left_out = map(int, self.script("select", self.folder, selection, *options).split())
        if must_run == 0:
            return set()
        ctest = ["ctest", "--test-dir", self.folder, "-I", selection, "--output-junit", report]
        listed = subprocess.run([*ctest, "-N"], capture_output=True, text=True, check=True).stdout
        subprocess.run(ctest, capture_output=True)
        self.script("record", self.folder, selection, report)
        names = set(re.findall(r"Test +#\d+: (\w+)", listed))
        assert len(names) == must_run, (names, must_run, left_out)
        return names


def expect(found, wanted, what):
    assert found == wanted, f"{what}: {sorted(found)} ran instead of {sorted(wanted)}"


def main():
    with tempfile.TemporaryDirectory() as folder:
        build = MadeUpBuild(pathlib.Path(folder))
        expect(build.run("-R", "alone"), {"alone"}, "an option of CTest")
        expect(build.run(), {"starts_one", "processes", "skips", "not_built"}, "the others")
        expect(build.run(), {"skips", "not_built"}, "nothing changed")
        build.write("tests/alone", "exit 1")
        expect(build.run(), {"alone", "skips", "not_built"}, "its own program changed, and it fails")
        expect(build.run(), {"alone", "skips", "not_built"}, "it failed before")
        build.write("tests/alone", "exit 0")
        expect(build.run("-R", "alone"), {"alone"}, "it failed, and its program is as it was when it passed")
        build.write("bin/one", "exit 3")
        expect(build.run("-E", "skips"), {"starts_one", "processes", "not_built"}, "a program that one starts changed")
        build.write("bin/two", "exit 3")
        expect(build.run("-E", "skips"), {"processes", "not_built"}, "a program that none names changed")
        expect(build.run("-E", "alone|starts_one|processes"), {"skips", "not_built"}, "the tests before it are left out")


if __name__ == "__main__":
    main()
