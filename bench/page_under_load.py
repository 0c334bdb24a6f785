#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how the demo's robot drives while a browser opens the page on a busy machine.

  python3 bench/page_under_load.py [--busy LOOPS] [--no-page] [--out DIR] [--bin DIR]

Runs `./nodmap demo --duration 90` beside LOOPS busy loops. Headless Chromium starts 12 s after the robot was released, opens the page, and stays open for
20 s once the page shows data. Prints one JSON object: how far the robot drove (by TRUTH) in the 10 s before, while the browser started and while the page
was open, and how many messages were lost. The exit code is the demo's: 1 if a process failed, or the robot hit something or hardly moved.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from programs import BIN, ROOT, call

sys.path.insert(0, str(ROOT / "tests" / "viewer"))
import webdriver  # noqa: E402

UNTIL_OPENED_S = 12
OPEN_S = 20
DURATION_S = 90  # of the demo; a browser may take 35 s until it shows data
STATIONARY = 0.02  # limit for the sum of the speeds in m/s and rad/s


def start_demo(out, log):
    """Starts the demo; returns once the robot drives."""
    environment = {key: value for key, value in os.environ.items() if key != "LCM_DEFAULT_URL"}
    demo = subprocess.Popen([ROOT / "nodmap", "demo", "--duration", str(DURATION_S), "--out", out], cwd=ROOT, env=environment,
                            stdout=log.open("w"), stderr=subprocess.STDOUT)
    while "driving for" not in log.read_text():
        if demo.poll() is not None:
            sys.exit(f"page_under_load: the demo has ended; see {log}")
        time.sleep(0.1)
    return demo


def open_page(log):
    """Opens the page for OPEN_S; returns when the first data came, in seconds since 1970."""
    address = re.search(r"http://\S*/#token=[0-9a-f]*", log.read_text()).group(0)
    with webdriver.Browser() as browser:
        browser.open(address)
        browser.wait_for("window.nodmap && nodmap.received() > 100")
        first_s = time.time()
        time.sleep(OPEN_S)
    return first_s


def truth(out, bin_dir):
    recording = min((out / "logger").glob("lcmlog-*"))
    table = out / "truth.csv"
    call(bin_dir / "nodmap-convert", "export", recording, table, "--channel", "TRUTH")
    with table.open() as file:
        return [{key: float(row[key]) for key in ("utime_us", "x_m", "y_m", "forward_mps", "yaw_rate_rad_s")} for row in csv.DictReader(file)]


def driven(rows, begin_s, end_s):
    """How far the robot drove between two times of the wall clock, which the demo's simulation follows."""
    rows = [row for row in rows if begin_s <= 1e-6 * row["utime_us"] < end_s]
    still = sum(abs(row["forward_mps"]) + abs(row["yaw_rate_rad_s"]) < STATIONARY for row in rows)
    distance_m = sum(((b["x_m"] - a["x_m"]) ** 2 + (b["y_m"] - a["y_m"]) ** 2) ** 0.5 for a, b in zip(rows, rows[1:]))
    return {"seconds": round(end_s - begin_s, 1), "driven_m": round(distance_m, 1), "stationary_percent": round(100 * still / max(1, len(rows)))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--busy", type=int, default=4, help="number of busy loops")
    parser.add_argument("--no-page", action="store_true", help="open no page, for comparison")
    parser.add_argument("--out", type=pathlib.Path, help="new folder for the demo's results; an existing one is never overwritten")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)
    arguments = parser.parse_args()
    out = (arguments.out or pathlib.Path(tempfile.mkdtemp(prefix="nodmap-page-")) / "demo").resolve()
    log = out.with_suffix(".log")

    loops = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(arguments.busy)]
    demo = None
    try:
        demo = start_demo(out, log)
        time.sleep(UNTIL_OPENED_S)
        opened_s, load = time.time(), [os.getloadavg()[0]]
        if arguments.no_page:
            time.sleep(OPEN_S)
            spans = {"no_page": (opened_s, opened_s + OPEN_S)}
        else:
            first_s = open_page(log)
            spans = {"browser_starts": (opened_s, first_s), "page_open": (first_s, first_s + OPEN_S)}
        load.append(os.getloadavg()[0])
        if demo.poll() is not None:
            sys.exit("page_under_load: the demo ended before the page was closed; try fewer busy loops")
        exit_code = demo.wait()
    finally:
        for loop in loops:
            loop.kill()
        if demo and demo.poll() is None:
            demo.terminate()
            demo.wait()

    rows = truth(out, arguments.bin)
    result = json.loads((out / "sim" / "result.json").read_text())
    watched = json.loads((out / "watch.json").read_text())["processes"]
    print(json.dumps({
        "load": load,
        "before": driven(rows, opened_s - 10, opened_s), **{name: driven(rows, *span) for name, span in spans.items()},
        **{name: result[name] for name in ("collisions", "bumps")},
        "lost": {name: process["lost"] for name, process in watched.items() if process["lost"]}, "demo_exit_code": exit_code}, indent=2))
    return exit_code


if __name__ == "__main__":
    sys.exit(main())
