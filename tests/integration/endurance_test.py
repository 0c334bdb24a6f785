#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""R47 in short: runs the whole robot live with both SLAMs and the viewer, with the program that otherwise measures it for ten minutes.

Tests that the measurement is complete and that no queue grows. Does not test speed and lost messages, which depend on the machine.
Environment: NODMAP_BENCH_LIVE (program), NODMAP_WORLD (file).
"""
import json
import os
import subprocess
import tempfile
import unittest

SCAN_PERIOD_US = 13_320

PROCESSES = ["kurt", "laser3d", "logger", "map-server", "navigator", "pitch-controller", "sim", "slam2d", "slam6d", "viewer"]


class Endurance(unittest.TestCase):
    def test_a_short_run(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([os.environ["NODMAP_BENCH_LIVE"], "--world", os.environ["NODMAP_WORLD"], "--out", f"{folder}/live",
                                   "latency", "--warm-up", "2", "--duration", "10", "--viewer", "--any-timing"], capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 1), done.stderr + done.stdout)  # 1 if messages were lost
        report = json.loads(done.stdout)
        self.assertEqual(report["collisions"], 0)
        self.assertEqual(report["ended_badly"], [])
        for name, process in report["processes"].items():
            if name != "nodmap-viewer":  # messages missed by the page alone do not matter
                self.assertEqual(process["corrupt"], 0, name)
        # Scans that the laser driver lost were never messages, so they do not count.
        has_lost = any(process["lost"] for name, process in report["processes"].items() if name not in ("nodmap-viewer", "nodmap-laser3d"))
        self.assertEqual(done.returncode, 1 if has_lost or report["lost"] else 0, done.stderr + done.stdout)
        for reaction in ("scan_to_obstacle_map", "scan_to_drive"):
            for part in (report[reaction], report[reaction]["without_viewer"], report[reaction]["with_viewer"]):
                # 75 scans a second in ten seconds, or in five; a busy machine may lose most of them.
                self.assertGreater(part["n"], 50)
                self.assertGreater(part["p99_us"], 0)
            # While a queue grows, every message waits for longer than all before it. Other work on the machine delays some, so the least wait
            # of a second tells. One below the period of the scans is no queue: the next scan has not even come.
            least_us = report[reaction]["min_us_over_time"]
            self.assertLess(least_us[-1], max(SCAN_PERIOD_US, 2 * least_us[0]), least_us)
        for name in PROCESSES:
            process = report["processes"][f"nodmap-{name}"]
            self.assertEqual(len(process["resident_mib_over_time"]), 11, name)
            self.assertGreater(process["resident_mib_over_time"][0], 0.5, name)
        self.assertGreater(report["processes"]["nodmap-sim"]["cpu_percent_by_half"][1], 0)
        self.assertIsNone(report["processes"]["nodmap-viewer"]["cpu_percent_by_half"][0])
        self.assertGreater(report["viewer_client"]["messages"], 100)


if __name__ == "__main__":
    unittest.main(verbosity=2)
