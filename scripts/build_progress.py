#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Shows a build on one line of a terminal, with what is left at the pace so far. Reads ninja's lines, written with NINJA_STATUS='%f %t %e '
(steps done, steps in all, seconds so far); what is no step, a compiler's message, is passed on."""
import math
import re
import sys

STEP = re.compile(r"(\d+) (\d+) (\d+\.\d+) ")
CHATTER = re.compile(r"ninja: (no work to do|Entering directory)")


def progress(done, total, elapsed_s):
    left = ""
    if done > 0 and elapsed_s >= 1.0:
        seconds = elapsed_s * (total - done) / done
        left = f", about {math.ceil(seconds)} s left" if seconds < 120 else f", about {math.ceil(seconds / 60)} min left"
    return f"  {done} of {total} steps{left}"


def main():
    shown = ""
    for line in sys.stdin:
        step = STEP.match(line)
        if step:
            shown = f"\r{progress(int(step[1]), int(step[2]), float(step[3]))}\033[K"
            print(shown, end="", flush=True)
        elif not CHATTER.match(line):
            print(("\r\033[K" if shown else "") + line, end="", flush=True)
            shown = ""
    if shown:
        print("\r\033[K", end="", flush=True)


if __name__ == "__main__":
    main()
