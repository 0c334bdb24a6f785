#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Says how a demo went: what was driven, received and lost, and the files. Exits 1 when something is not as it should be.

usage: demo_summary.py sim|recording DIR
"""
import json
import pathlib
import shlex
import sys

# The files that a demo leaves, and for each kind of demo those that only it has.
FILES = [
    ("map-server/map.png", "obstacle and structure map at the end"),
    ("slam2d/map.png", "2D map"),
    ("slam2d/map.yaml", "the same for ROS's map_server"),
    ("slam6d/map.png", "3D cloud, an image"),
    ("slam6d/cloud.ply", "3D cloud"),
    ("slam6d/map.bt", "OctoMap (octovis map.bt)"),
]
MORE_FILES = {
    "sim": [("slam2d/path.png", "the path driven, corrected")],
    "recording": [("slam2d/trajectory.tum", "corrected 2D trajectory"), ("slam6d/trajectory.tum", "corrected 3D trajectory")],
}
ENDED_WELL = "Stopped (OK)"
# What is lost where, and what helps. A busy machine loses something, and the robot is made for that: it is said, and no failure.
CAUSES = {
    "nodmap-laser3d": "scans that did not become messages: the driver or the simulated devices were not run in time; the machine is too busy (nodmap-doctor tells about real-time priority)",
    "": "messages that it had no time for: the machine is too busy",
}


def read(path):
    return json.loads(path.read_text()) if path.exists() else None


def show_robot(out):
    """Prints how the simulated robot drove; returns what is wrong."""
    wrong = []
    watch, truth, status = read(out / "watch.json"), read(out / "sim/result.json"), read(out / "status.json")
    if not (watch and truth and status):
        return ["not every process has left its result"]

    print(f"\n{'process':<26} {'handled':>8} {'lost':>5} {'corrupt':>8} {'rejected':>9} {'p99':>9}")
    for name, p in sorted(watch["processes"].items()):
        print(f"{name:<26} {p['handled']:>8} {p['lost']:>5} {p['corrupt']:>8} {p['rejected']:>9} {p['latency_p99_us'] / 1e3:>6.2f} ms")
        if p["health"] == 2:
            wrong.append(f"{name} failed: {p['reason']}")

    # What the page has missed is in the table; the robot has not.
    lost = {name: p["lost"] for name, p in watch["processes"].items() if p["lost"] and name != "nodmap-viewer"}
    clearance_m = truth["min_clearance_m"]  # none in a world without objects
    nearest = "" if clearance_m is None else f", never nearer than {100 * clearance_m:.0f} cm to anything"
    print(f"\n{truth['distance_m']:.1f} m driven, {watch['max_forward_mps']:.2f} m/s at most{nearest}; {truth['collisions']} collisions, "
          f"{truth['bumps']} bumps, {watch['keyframes']} keyframes, {sum(lost.values())} scans or messages lost")
    if watch["seen_m2"]:
        print(f"{watch['seen_m2']:.0f} m2 of floor in the 2D map{'; all is seen, and the robot is back home' if watch['is_home'] else ''}")
    for name, n in lost.items():
        print(f"nodmap demo: warning: {name} lost {n} {CAUSES.get(name, CAUSES[''])}", file=sys.stderr)
    if truth["collisions"]:
        wrong.append(f"the robot has hit something {truth['collisions']} times")
    wrong += [f"{name} has received {p['corrupt']} corrupt messages" for name, p in watch["processes"].items() if p["corrupt"]]
    if truth["distance_m"] < 1.0:
        wrong.append("the robot hardly moved")
    sweeps = (read(out / "slam6d/result.json") or {}).get("metrics", {})
    if sweeps.get("sweeps_lost", 0) >= max(1, sweeps.get("sweeps_tracked", 0)):
        wrong.append(f"6D SLAM was lost: {sweeps['sweeps_lost']} of {sweeps['sweeps']} sweeps do not fit its map")
    return wrong + [f"{c['command']}: {c['state']} {c['end']}" for c in status["commands"] if c["state"] != ENDED_WELL]


def show_recording(out):
    """Prints what each process has used of a recording; returns what is wrong."""
    wrong = []
    print(f"\n{'process':<12} {'read':>8} {'used':>8} {'lost':>6} {'corrupt':>8}  rejected")
    for name in ("map-server", "slam2d", "slam6d"):
        result = read(out / name / "result.json")
        if not result:
            wrong.append(f"{name} left no result.json")
            continue
        m = result["messages"]
        rejected = ", ".join(f"{cause} {count}" for cause, count in m["rejected"].items()) or "-"
        print(f"{name:<12} {m['read']:>8} {m['used']:>8} {m['lost']:>6} {m['corrupt']:>8}  {rejected}")
        if m["read"] == 0:
            wrong.append(f"{name} has read nothing")
    return wrong


def show_files(out, files):
    """Prints these files; returns which are missing or empty."""
    missing = []
    print()
    for file, what in files:
        path = out / file
        here = path.exists() and path.stat().st_size > 0
        print(f"  {path}{'' if here else '  MISSING'}  {what}")
        missing += [] if here else [f"{file} is missing"]
    return missing


def main():
    kind, out = sys.argv[1], pathlib.Path(sys.argv[2])
    wrong = {"sim": show_robot, "recording": show_recording}[kind](out)
    wrong += show_files(out, FILES + MORE_FILES[kind])
    logs = sorted((out / "logger").glob("lcmlog-*"))
    for log in logs:
        print(f"  {log}  everything that went over LCM")
    if logs:
        print(f"\nto see it again: build/release/bin/nodmap-viewer --replay {shlex.join(map(str, logs))}, "
              "and a browser on http://127.0.0.1:8765/")
    else:
        wrong.append("there is no log of the run")
    for sentence in wrong:
        print(f"nodmap demo: {sentence}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
