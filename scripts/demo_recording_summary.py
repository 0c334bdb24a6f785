#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Says what a demo has made: messages used, lost and rejected by each process, and the files. Exits 1 when something is missing."""
import json
import pathlib
import sys

from demo_files import show_files

FILES = [
    ("map-server/map.png", "obstacle and structure map"),
    ("slam2d/map.png", "corrected 2D map"),
    ("slam2d/map.yaml", "the same for ROS's map_server"),
    ("slam2d/trajectory.tum", "corrected 2D trajectory"),
    ("slam6d/map.png", "registered 3D cloud, an image"),
    ("slam6d/cloud.ply", "registered 3D cloud"),
    ("slam6d/map.bt", "OctoMap (octovis map.bt)"),
    ("slam6d/trajectory.tum", "corrected 3D trajectory"),
]


def main():
    out, bad = pathlib.Path(sys.argv[1]), False
    print(f"\n{'process':<12} {'read':>8} {'used':>8} {'lost':>6} {'corrupt':>8}  rejected")
    for name in ("map-server", "slam2d", "slam6d"):
        result = out / name / "result.json"
        if not result.exists():
            print(f"{name:<12} left no result.json")
            bad = True
            continue
        m = json.loads(result.read_text())["messages"]
        rejected = ", ".join(f"{cause} {count}" for cause, count in m["rejected"].items()) or "-"
        print(f"{name:<12} {m['read']:>8} {m['used']:>8} {m['lost']:>6} {m['corrupt']:>8}  {rejected}")
        bad = bad or m["read"] == 0
    print()
    bad = bool(show_files(out, FILES)) or bad
    logs = sorted((out / "logger").glob("lcmlog-*"))
    bad = bad or not logs
    for log in logs or ["no log of the run: MISSING"]:
        print(f"  {log}  everything that went over LCM")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
