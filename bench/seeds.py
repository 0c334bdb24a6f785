# SPDX-License-Identifier: BSD-3-Clause
"""Seeds of simulated drives and random worlds. Results are reported with seeds that no parameter was chosen with.

A script that reports (bench/trials.py, scripts/figures) takes its seeds from REPORTING, one that compares parameters (bench/slam2d_drives.py) from
CHOOSING. Parameters chosen before this rule was kept: docs/decisions names their worlds and seeds.
"""
REPORTING = range(0, 1000)
CHOOSING = range(1000, 2000)

# The odometry with which mapping is reported: each wheel counts 3 % too much, and the heading drifts by 1 degree after 1 m, 2 degrees after 4 m
# and so on (the simulator's default).
ODOMETRY_NOISE = ("--set", "sim.odometry_scale_bias=0.03", "--set", "sim.slip_heading_deg=1")
