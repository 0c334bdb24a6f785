#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Reads a JUnit report of ctest: prints "RAN FAILED SKIPPED", then a summary that names what failed and what was skipped and why."""
import re
import sys
import xml.etree.ElementTree as ElementTree


def main():
    ran, failed, skipped = 0, [], []
    for case in ElementTree.parse(sys.argv[1]).getroot().iter("testcase"):
        output = "".join(node.text or "" for node in case.iter("system-out"))
        name = case.get("name")
        if case.get("status") == "notrun" or case.find("skipped") is not None:
            reason = re.search(r"Skipped\s*\n(.*)|(missing data: .*|skipped: .*)", output)
            skipped.append(f"  skipped: {name}: {(reason.group(1) or reason.group(2)).strip() if reason else 'no reason given'}")
        else:
            ran += 1
            if case.get("status") != "run":
                failed.append(f"  FAILED: {name}")
    print(ran, len(failed), len(skipped))
    print(f"{ran} tests ran, {len(failed)} failed, {len(skipped)} were skipped")
    print("\n".join(failed + skipped))


if __name__ == "__main__":
    main()
