# SPDX-License-Identifier: BSD-3-Clause
"""The seeds of simulated drives and random worlds. Results are reported on seeds on which no parameter was chosen.

A script that reports results (bench/trials.py, scripts/figures) takes its seeds from REPORTING. A script that compares parameters
(bench/slam2d_drives.py) takes them from CHOOSING. Some parameters were chosen before this rule; docs/decisions names their worlds and seeds.
"""
REPORTING = range(0, 1000)
CHOOSING = range(1000, 2000)

# Mapping and navigation are reported with this odometry: each wheel counts 3 % too much, and the heading drifts by a random walk with the simulator's default of
# 1 degree times the root of the metres over a long drive: 0.9 degrees after 1 m, 1.9 degrees after 4 m and so on.
ODOMETRY_NOISE = ("--set", "sim.odometry_scale_bias=0.03", "--set", "sim.slip_heading_deg=1")
