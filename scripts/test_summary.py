#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Reads a JUnit report of ctest: prints "RAN FAILED SKIPPED", then a summary that names what failed and what was skipped and why."""
import re
import sys
import xml.etree.ElementTree as ElementTree


def reason_not_run(case):
    """Why a test did not run, as CTest says: SKIP_... if it skipped itself. Empty if it ran."""
    skipped = case.find("skipped")
    return "" if skipped is None else skipped.get("message", "")


def main():
    ran, failed, skipped = 0, [], []
    for case in ElementTree.parse(sys.argv[1]).getroot().iter("testcase"):
        output = "".join(node.text or "" for node in case.iter("system-out"))
        name = case.get("name")
        not_run = reason_not_run(case)
        if not_run.startswith("SKIP_"):
            reason = re.search(r"Skipped\s*\n(.*)|(missing data: .*|skipped: .*)", output)
            skipped.append(f"  skipped: {name}: {(reason.group(1) or reason.group(2)).strip() if reason else 'no reason given'}")
            continue
        ran += 1
        # A test that could not be run, for example because its program is missing, has failed.
        if case.get("status") != "run":
            failed.append(f"  FAILED: {name}" + (f": {not_run}" if not_run else ""))
    print(ran, len(failed), len(skipped))
    print(f"{ran} tests ran, {len(failed)} failed, {len(skipped)} were skipped")
    print("\n".join(failed + skipped))


if __name__ == "__main__":
    main()
