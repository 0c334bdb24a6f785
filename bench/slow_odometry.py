#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what slow odometry costs both SLAMs: replays simulated drives with only some of their odometry messages.

bench/slow_odometry.py [--out DIR] [--bin DIR] [--rate HZ ...]

The drives take 60 s through office and cellar, with the odometry noise of bench/seeds.py. A drive that is already in DIR is used again. Prints a row for each
drive, program and rate: the error of all poses relative to the truth, with the first poses aligned, and how many scans had no odometry.
"""
import argparse
import json
import pathlib
import struct
import tempfile

import seeds
from event_log import Writer, events
from programs import BIN, call, evaluate
from slam2d_drives import Drives
from trial_runs import result_folder

WORLDS = ("office", "cellar")
DURATION_S = 60
RATES_HZ = (100, 50, 20, 10, 5)
ODOMETRY = struct.Struct(">8xqq")  # after the fingerprint: time (us), sequence number
JITTER_US = 2000  # of the stamps, less than half the shortest period


def thin(log, thinned, rate_hz):
    """Copies scans and odometry, but of odometry only as many messages as a base with this rate would send."""
    period_us, due, number = 1e6 / rate_hz, None, 0
    with Writer(thinned) as out:
        for event in events(log):
            if event.channel == "ODOMETRY":
                utime, _ = ODOMETRY.unpack_from(event.data)
                due = utime if due is None else due
                if utime < due - JITTER_US:
                    continue
                data = bytearray(event.data)
                struct.pack_into(">q", data, ODOMETRY.size - 8, number)
                event, due, number = event._replace(data=bytes(data)), due + period_us, number + 1
            elif event.channel != "SCAN":
                continue
            out.write(event)


def row(programs, folder, program, rate_hz):
    with tempfile.TemporaryDirectory() as made:
        log, out = pathlib.Path(made) / "thinned.lcmlog", pathlib.Path(made) / program
        thin(folder / "trial.lcmlog", log, rate_hz)
        call(programs / program, "--replay", log, "--out", out)
        measured = evaluate(programs, "trajectory", out / "trajectory.tum", folder / "truth.tum")
        rejected = json.loads((out / "result.json").read_text())["messages"]["rejected"].get("scan_without_odometry", 0)
        return f"{100 * measured['ate_rmse_m']:.2f} cm | {100 * measured['ate_max_m']:.1f} cm | {measured['rot_rmse_deg']:.2f}° | {rejected}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the drives (100 MB) are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    parser.add_argument("--rate", type=float, nargs="+", default=RATES_HZ, help="messages a second")
    options = parser.parse_args()
    with result_folder(options.out, may_contain=True) as out:
        drives = Drives(out, options.bin)
        print("| drive | program | odometry | ATE | worst | rotation | scans without odometry |\n|---|---|---|---|---|---|---|")
        for world in WORLDS:
            folder = drives.drive((world, seeds.REPORTING[1], DURATION_S))
            for program in ("nodmap-slam6d", "nodmap-slam2d"):
                for rate_hz in options.rate:
                    print(f"| {world} | {program} | {rate_hz:g} Hz | {row(options.bin, folder, program, rate_hz)} |", flush=True)


if __name__ == "__main__":
    main()
