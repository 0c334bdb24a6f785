#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over the sources that the build in the given folder compiles, as many at a time as there are processors.

usage: run_clang_tidy.py BUILD_DIR [--all | --changed]
    --all       the tests and benchmarks too, by tests/.clang-tidy
    --changed   only sources that changed, or whose header of the same name did, since the branch left origin/main; on main itself in the last
                10 commits. What is not committed counts.

A file is checked again only when something that it is made of has changed: the key of a good run, a digest of the preprocessed
text, of the rules and of clang-tidy's version, is kept in the user's cache ($XDG_CACHE_HOME/nodmap/clang-tidy), for every clone.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
GOOD = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "nodmap" / "clang-tidy"
VERSION = subprocess.run(["clang-tidy", "--version"], capture_output=True).stdout


def is_test(path):
    return "test" in path.parts or path.parts[0] in ("tests", "bench")


def key_of(entry, config):
    """A digest of all that clang-tidy would see, or None where the preprocessor fails."""
    command = [w for w in shlex.split(entry["command"])]
    if "ccache" in command[0]:
        command = command[1:]
    out = command.index("-o")
    command = command[:out] + command[out + 2:]
    run = subprocess.run(command + ["-E", "-P"], cwd=entry["directory"], capture_output=True)
    # Comments hold the NOLINT marks and are gone after preprocessing: the file itself counts too.
    source = pathlib.Path(entry["file"]).read_bytes()
    return hashlib.sha256(run.stdout + source + config.read_bytes() + VERSION).hexdigest() if run.returncode == 0 else None


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True).stdout.split()


def changed_sources():
    """Paths in the repository without their extension."""
    head, base = git("rev-parse", "HEAD"), git("merge-base", "HEAD", "origin/main")
    since = base if base and base != head else git("rev-list", "--max-count=11", "HEAD")[-1:]
    return {pathlib.Path(name).with_suffix("") for name in git("diff", "--name-only", *since)}


def check(build, entry):
    path = pathlib.Path(entry["file"]).relative_to(ROOT)
    config = ROOT / ("tests/.clang-tidy" if is_test(path) else ".clang-tidy")
    key = key_of(entry, config)
    if key and (GOOD / key).exists():
        return path, True, ""
    run = subprocess.run(["clang-tidy", "-quiet", "-p", str(build), f"--config-file={config}",
                          "--extra-arg=-Wno-unknown-warning-option", str(ROOT / path)],
                         capture_output=True, text=True)
    if run.returncode == 0 and key:
        GOOD.mkdir(parents=True, exist_ok=True)
        (GOOD / key).touch()
    return path, run.returncode == 0, run.stdout


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    entries = [e for e in json.loads((build / "compile_commands.json").read_text()) if str(build) not in e["file"]]
    if "--all" not in sys.argv[2:]:
        entries = [e for e in entries if not is_test(pathlib.Path(e["file"]).relative_to(ROOT))]
    if "--changed" in sys.argv[2:]:
        changed = changed_sources()
        entries = [e for e in entries if pathlib.Path(e["file"]).relative_to(ROOT).with_suffix("") in changed]
    bad = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for done, (path, good, output) in enumerate(pool.map(lambda e: check(build, e), entries), 1):
            if sys.stderr.isatty():
                print(f"\r{done}/{len(entries)}", end="", file=sys.stderr)
            if not good:
                bad += 1
                print(output or f"{path}: clang-tidy failed")
    print(f"clang-tidy: {len(entries)} files, {bad} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
