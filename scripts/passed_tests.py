#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Leaves out tests that have passed with the same inputs before.

usage: passed_tests.py select BUILD_DIR FILE [CTEST OPTION ...]  writes the numbers of those that must run, for ctest -I FILE, and prints
                                                                 how many these are and how many are left out
       passed_tests.py record BUILD_DIR FILE REPORT.xml          remembers in BUILD_DIR/passed_tests.txt which of them passed

The inputs of a test are its command and environment, its own program, the programs that it starts (nodmap_test_starts() in
cmake/Targets.cmake names them; a test of processes of which it says nothing may start every program), everything in the repository but Markdown
and C++ sources (those that tests of the package compile count), the recordings' names, sizes and times, and the installed packages. A test that skipped
itself or failed runs again.
"""
import functools
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent


@functools.cache
def digest_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""


def digest_of_surroundings():
    """Of what any test may read: scripts, configurations, worlds, recordings, packages."""
    names = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True).stdout
    files = [ROOT / os.fsdecode(name) for name in sorted(names.split(b"\0")) if name]
    lines = [f"{file} {digest_of(file)}" for file in files if file.suffix not in (".cpp", ".hpp", ".md") or "packaging" in file.parts]
    data = pathlib.Path(os.environ.get("NODMAP_DATA") or ROOT.parent / "shared/data")
    for file in sorted(data.rglob("*")):
        stat = file.lstat()
        lines.append(f"{file} {stat.st_size} {stat.st_mtime_ns}")
    lines.append(digest_of(pathlib.Path("/var/lib/dpkg/status")))
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


class Inputs:
    """The inputs of each test in a build folder."""

    def __init__(self, build):
        self.build = build
        self.surroundings = digest_of_surroundings()
        starts = (line.split() for line in (build / "test_starts.txt").read_text().splitlines())
        self.starts = {words[0]: words[1:] for words in starts if words}

    def key(self, test):
        """A digest of everything that may change the outcome of a test, as ctest --show-only=json-v1 describes it."""
        properties = {p["name"]: p["value"] for p in test["properties"]}
        command = test.get("command", [])  # none if its program has not been built
        words = command + properties.get("ENVIRONMENT", [])
        programs = {self.build / "tests" / p.name for p in map(pathlib.Path, command) if p.parent == self.build / "tests"}
        declared = [self.starts[name] for name in [test["name"], *(p.name for p in programs)] if name in self.starts]
        started = [name for names in declared for name in names]
        if not declared and "integration" in properties.get("LABELS", []):
            started = [p.name for p in (self.build / "bin").iterdir()]
        programs |= {self.build / folder / name for name in started for folder in ("bin", "tests")}
        lines = [self.surroundings, *words, *(f"{p} {digest_of(p)}" for p in sorted(programs))]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def ctest(build, *options):
    return subprocess.run(["ctest", "--test-dir", build, *options], capture_output=True, check=True, text=True).stdout


def tests_of(build, *options):
    return json.loads(ctest(build, "--show-only=json-v1", *options))["tests"]


def identity(test):
    """Tells two tests of the same name in two programs apart."""
    return test["name"], tuple(test.get("command", []))


def known_passes(build):
    file = build / "passed_tests.txt"
    return set(file.read_text().split()) if file.exists() else set()


def select(build, selection, *options):
    inputs, known = Inputs(build), known_passes(build)
    tests = tests_of(build)
    keys = [inputs.key(test) for test in tests]
    # With -E or -R CTest counts anew, but -I FILE means the numbers without them.
    number_of = {identity(test): number for number, test in enumerate(tests, 1)}
    asked = [number_of[identity(test)] for test in tests_of(build, *options)]
    must_run = [number for number in asked if keys[number - 1] not in known]
    # Start, end and stride come first; with a stride of 0 they select nothing.
    selection.write_text(",".join(map(str, [0, 0, 0, *must_run])) + "\n")
    selection.with_suffix(".json").write_text(json.dumps(keys))  # as they are now: record must not take a later change for tested
    print(len(must_run), len(asked) - len(must_run))


def record(build, selection, report):
    keys = json.loads(selection.with_suffix(".json").read_text())
    passed, not_passed = set(), set()  # of tests with the same name in two programs, both must have
    for case in ElementTree.parse(report).getroot().iter("testcase"):
        has_passed = case.get("status") == "run" and case.find("skipped") is None
        (passed if has_passed else not_passed).add(case.get("name"))
    known = known_passes(build) & set(keys)
    known |= {key for test, key in zip(tests_of(build), keys, strict=True) if test["name"] in passed - not_passed}
    (build / "passed_tests.txt").write_text("\n".join(sorted(known)) + "\n")


def main():
    verb, build, selection, *rest = sys.argv[1:]
    {"select": select, "record": record}[verb](pathlib.Path(build).resolve(), pathlib.Path(selection), *rest)


if __name__ == "__main__":
    main()
