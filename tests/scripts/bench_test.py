#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/bench.sh runs an entry with the arguments that its program needs.

usage: bench_test.py SOURCE_DIR
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

SERIAL_BENCH = """\
#!/bin/sh
[ "$1" -gt 0 ] || exit 2
jobs=$(ps -o pid= --ppid $PPID | wc -l)
echo "$1 s beside $((jobs - 1)) loops"
"""


def measure(source, entry, program, text):
    """Runs an entry of a copy of the script, with `text` in place of its program; returns what it prints."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "scripts").mkdir()
        shutil.copy(source / "scripts" / "bench.sh", root / "scripts")
        stub = root / "build" / "release" / "bin" / program
        stub.parent.mkdir(parents=True)
        stub.write_text(text)
        stub.chmod(0o755)
        return subprocess.run([root / "scripts" / "bench.sh", "--measure", entry], check=True, capture_output=True, text=True).stdout


def main():
    source = pathlib.Path(sys.argv[1])
    printed = measure(source, "serial", "nodmap-bench-serial", SERIAL_BENCH)
    assert printed == "20 s beside 6 loops\n", printed


if __name__ == "__main__":
    main()
