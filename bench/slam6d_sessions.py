#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps the first half of recorded drives, and puts the robot into that map with the second half: to localise in it, and to carry on with it.

bench/slam6d_sessions.py DRIVE ... [--bin DIR]

A DRIVE is a folder with trial.lcmlog and truth.tum, as nodmap-trial writes it. In the second half odometry begins somewhere else: nothing but the map
tells where the robot is. Prints a table: how long until the robot is found, errors of all poses since then against the truth, the first pose of the
first half agreeing, and how many sweeps fitted.
"""
import argparse
import json
import pathlib
import struct
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADER = struct.Struct(">IqqII")  # sync, number, time, lengths of channel and data


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip()}")
    return done.stdout


def events(log):
    """All events of a log: time and bytes."""
    data = memoryview(log.read_bytes())
    at = 0
    while at + HEADER.size <= len(data):
        _, _, utime, channel_size, data_size = HEADER.unpack_from(data, at)
        end = at + HEADER.size + channel_size + data_size
        yield utime, bytes(data[at + HEADER.size:at + HEADER.size + channel_size]), data[at:end]
        at = end


def split(log, first, second):
    times = [utime for utime, _, _ in events(log)]
    middle = times[0] + (times[-1] - times[0]) // 2
    with first.open("wb") as before, second.open("wb") as after:
        for utime, channel, event in events(log):
            if channel in (b"SCAN", b"ODOMETRY"):
                (before if utime < middle else after).write(event)


def poses(file):
    return [line for line in file.read_text().splitlines() if line and not line.startswith("#")]


def session(programs, log, out, *options):
    quiet = [word for value in ("occupancy.publish_period_s=0", "occupancy.save_every_keyframes=0") for word in ("--set", value)]
    run(programs / "nodmap-slam6d", "--replay", log, "--out", out, *quiet, *options)
    return poses(out / "trajectory.tum"), json.loads((out / "result.json").read_text())["metrics"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("drives", type=pathlib.Path, nargs="+", metavar="DRIVE")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build" / "release" / "bin")
    arguments = parser.parse_args()
    print("| drive | second half | found after | ATE | worst | rotation | tracked, degraded, lost |\n|---|---|---|---|---|---|---|")
    for drive in arguments.drives:
        with tempfile.TemporaryDirectory() as work:
            folder = pathlib.Path(work)
            split(drive / "trial.lcmlog", folder / "first.lcmlog", folder / "second.lcmlog")
            first, _ = session(arguments.bin, folder / "first.lcmlog", folder / "first")
            start = next(events(folder / "second.lcmlog"))[0] * 1e-6
            for name, option in (("localises", "--localise"), ("carries on", "--map-in")):
                found, metrics = session(arguments.bin, folder / "second.lcmlog", folder / name, option, folder / "first")
                both = folder / "both.tum"
                both.write_text("\n".join([first[0], *found]) + "\n")
                error = json.loads(run(arguments.bin / "nodmap-evaluate", "trajectory", both, drive / "truth.tum"))
                after = float(found[0].split()[0]) - start if found else float("nan")
                print(f"| {drive.name} | {name} | {after:.1f} s | {100 * error['ate_rmse_m']:.2f} cm | {100 * error['ate_max_m']:.1f} cm "
                      f"| {error['rot_rmse_deg']:.2f}° | {metrics['sweeps_tracked']}, {metrics['sweeps_degraded']}, {metrics['sweeps_lost']} |", flush=True)


if __name__ == "__main__":
    main()
