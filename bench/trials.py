#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the closed-loop trials that check the requirements on the whole robot, and prints a table of results and targets.

    bench/trials.py [--jobs N] [--quick] [--only GROUP ...] [--out DIR] [--bin DIR]

The trials of the paper's figures are in scripts/figures. Each group is a function that defines its trials and adds rows with their results. Every trial is
deterministic, so that the table is the same on every machine, apart from the times that the group `speed` measures. The exit code is 1 if a target is missed.
"""
import argparse
import math
import os
import sys
import traceback

from poses import greatest_height_error, read_heights
from programs import evaluate
from seeds import ODOMETRY_NOISE, REPORTING
from trial_runs import Trial, add_options, result_folder, results_of, run_all, with_result

# After the loss of any part the robot may need this much more time and distance than braking takes.
REACTION_S, REACTION_M = 0.3, 0.3
FAULTS = ["laser:unplug", "laser:silent", "laser:freeze", "servo:unplug", "servo:silent", "servo:stall", "base:unplug",
          "base:silent"]
# Lines that damage or delay some of what is sent: amounts of bytes, seconds. At 1 % of the bytes it may be some time until one hurts, and what is
# lost or damaged then may not hurt at all, so that the robot need not stop at once, or not at all.
DAMAGES = [f"{part}:{kind}={amount}" for part in ["laser", "servo", "base"] for kind, amount in [
    ("drop", 0.01), ("drop", 0.1), ("corrupt", 0.01), ("corrupt", 0.1), ("delay", 0.1), ("delay", 0.3)]]
PROCESSES = ["kurt", "laser3d", "pitch_controller", "map_server", "navigator"]


class Table:
    """Rows of measured values and their targets."""

    def __init__(self):
        self.rows = []

    def add(self, what, measured, target, holds):
        self.rows.append((what, measured, target, holds))

    def show(self):
        widths = [max(len(str(row[i])) for row in [("what", "measured", "target"), *self.rows]) for i in range(3)]
        line = "{:<%d} | {:<%d} | {:<%d} | {}" % tuple(widths)
        print(line.format("what", "measured", "target", ""))
        for what, measured, target, holds in self.rows:
            print(line.format(what, measured, target, "ok" if holds else "MISSED"))

    def all_hold(self):
        return all(row[3] for row in self.rows)


# The robot never drives as --appear demands: no failure.
NO_PLACE = "never drives straight"


def add_failures(trials, table):
    for trial in trials:
        if trial.result is None and NO_PLACE not in trial.error:
            table.add(trial.name, trial.error[-60:], "runs", False)


def add_group(name, trials, add_rows, table, bin_dir):
    """Adds the rows of a group. What cannot be evaluated becomes a row, so that the results of the other groups are not lost."""
    if not results_of(trials):
        table.add(f"{name}: trials with a result", f"0 of {len(trials)}", "at least 1", False)
        return
    try:
        add_rows(table, bin_dir)
    except Exception as error:
        traceback.print_exc()
        table.add(f"{name}: not evaluated", repr(error)[-60:], "evaluated", False)


def collided(results):
    return sum(result["collisions"] > 0 for result in results)


def add_distance(table, what, results, least_m):
    """A stationary robot meets nearly every other target."""
    driven_m = min(result["distance_m"] for result in results)
    table.add(f"{what}: least distance driven, m", f"{driven_m:.1f}", f">= {least_m}", driven_m >= least_m)


# Each group returns its trials, and a function that adds their rows to the table.

def random_clutter(quick):
    trials = [Trial(f"random-{s}", f"random:{s}", s, 20 if quick else 60, "--no-slam6d") for s in REPORTING[:2 if quick else 100]]

    def add_rows(table, _):
        results = results_of(trials)
        speeds = [result["mean_speed_mps"] for result in results]
        table.add(f"random clutter, {len(results)} worlds: collisions", sum(r["collisions"] for r in results), "0",
                  collided(results) == 0)
        table.add("random clutter: mean speed (lowest of all worlds), m/s",
                  f"{sum(speeds) / len(speeds):.2f} ({min(speeds):.2f})", ">= 0.5", sum(speeds) / len(speeds) >= 0.5)
        # No target: the simulator puts a robot that touches something back to where it did not.
        table.add("random clutter: least clearance, m", f"{min(r['min_clearance_m'] for r in results):.3f}", "", True)
    return trials, add_rows


def crowd(quick):
    trials = [Trial(f"crowd-{s}", "crowd", s, 30 if quick else 60, "--no-slam6d") for s in REPORTING[1:3 if quick else 11]]

    def add_rows(table, _):
        results = results_of(trials)
        table.add(f"crowd, {len(results)} runs: collisions", sum(r["collisions"] for r in results), "0", collided(results) == 0)
        table.add("crowd: people who walked into the stationary robot", sum(r["bumped"] for r in results), "", True)
        add_distance(table, "crowd", results, 1)
    return trials, add_rows


def nearest_rank(values, share):
    return sorted(values)[math.ceil(share * len(values)) - 1]


def appearing(quick):
    # The robot brakes in about half of the trials and steers past the obstacle in the others: this number gives at least 100 brakings.
    n = 3 if quick else 250
    trials = [Trial(f"appear-{s}", f"random:{s}", s, 16, "--no-slam6d", "--appear", 6 + s % 5) for s in REPORTING[:n]]

    def add_rows(table, _):
        results = results_of(trials)
        without_place = sum(trial.result is None and NO_PLACE in trial.error for trial in trials)
        table.add("appearing: trials without a place for an obstacle, which count nowhere below", without_place, "", True)
        latencies = [r["brake_latency_ms"] for r in results]
        events = [event for l in latencies for event in l["events"]]
        within = sum(event["latency_ms"] <= event["limit_ms"] for event in events)
        unanswered = sum(l["unanswered"] for l in latencies)
        # The simulator takes a touch at less than 0.05 m/s for a bump: that somebody has walked into the robot. This obstacle does not move.
        touches = sum(r["collisions"] + r["bumped"] for r in results)
        table.add(f"appearing obstacle, {len(results)} trials: contacts", touches, "0", touches == 0)
        braked = sum(bool(l["events"]) for l in latencies)
        table.add(f"appearing: trials in which the robot braked (times it steered past: {sum(l['evaded'] for l in latencies)})", braked,
                  ">= 100", braked >= (0 if quick else 100))
        table.add("appearing: obstacles to which the robot never reacted", unanswered, "0", unanswered == 0)
        table.add("appearing: obstacles where the robot would have been slow anyway", sum(l["masked"] for l in latencies), "", True)
        # The robot was slow already, or told to be, when the obstacle entered its stopping zone or became visible there.
        nothing = sum(not (l["events"] or l["unanswered"] or l["evaded"] or l["masked"]) for l in latencies)
        table.add("appearing: trials in which nothing was measured", nothing, "", True)
        if events:
            values = [event["latency_ms"] for event in events]
            shares = [event["latency_ms"] / event["limit_ms"] for event in events]
            table.add("appearing: brake latency p50/p99/max, ms",
                      f"{nearest_rank(values, 0.5):.0f}/{nearest_rank(values, 0.99):.0f}/{max(values):.0f}", "", True)
            table.add("appearing: brakings within the limit: two sweeps of that moment, a scan and 20 ms", f"{within} of {len(events)}",
                      "all", within == len(events))
            table.add("appearing: fraction of this limit, p50/p99/max",
                      f"{nearest_rank(shares, 0.5):.2f}/{nearest_rank(shares, 0.99):.2f}/{max(shares):.2f}", "<= 1",
                      max(shares) <= 1.0)
    return trials, add_rows


def stops(quick):
    things = [("fault", fault) for fault in FAULTS] + [("kill", process) for process in PROCESSES]
    things = things[::4] if quick else things
    trials = [Trial(f"stop-{what.replace(':', '-')}", "corridor30", 3, 20, "--no-slam6d", f"--{kind}", f"{what}@10+2")
              for kind, what in things]

    def add_rows(table, _):
        for trial in with_result(trials):
            stop = trial.result["stops"][0]
            beyond_m = stop["distance_m"] - stop["braking_distance_m"]
            stopped = stop["stopped_after_s"] is not None
            resumed = stop["resumed_after_s"]
            # A robot that did not drive has nothing to stop.
            holds = (stop["speed_mps"] >= 0.5 and stopped and stop["reaction_s"] <= REACTION_S and beyond_m <= REACTION_M and resumed is not None
                     and trial.result["collisions"] == 0)
            table.add(f"{stop['what']} at {stop['speed_mps']:.1f} m/s: time and distance beyond braking; at half of that speed again after",
                      (f"{1000 * stop['reaction_s']:.0f} ms, {beyond_m:.2f} m" if stopped else "did not stop") +
                      (f"; {resumed:.1f} s" if resumed is not None else "; never"), "300 ms, 0.30 m", holds)
    return trials, add_rows


def damages(quick):
    def trial_of(damage):
        what, amount = damage.split("=")
        return Trial(f"damage-{what.replace(':', '-')}-{amount}", "corridor30", 3, 36, "--no-slam6d", "--fault", f"{what}@10+6={amount}")

    trials = [trial_of(damage) for damage in (DAMAGES[::5] if quick else DAMAGES)]

    def add_rows(table, _):
        for trial in with_result(trials):
            stop, odometry, slam = (trial.result[key] for key in ("stops", "odometry", "slam2d"))
            stop = stop[0]
            is_rare = trial.name.endswith("-0.01")
            beyond_m = stop["distance_m"] - stop["braking_distance_m"]
            stopped, resumed = stop["stopped_after_s"] is not None, stop["resumed_after_s"]
            in_time = stopped and stop["reaction_s"] <= REACTION_S and beyond_m <= REACTION_M
            holds = stop["speed_mps"] >= 0.5 and (is_rare or in_time) and resumed is not None and trial.result["collisions"] == 0
            table.add(f"{trial.name} at {stop['speed_mps']:.1f} m/s: beyond braking; on again after; end of odometry, 2D SLAM off by",
                      (f"{1000 * stop['reaction_s']:.0f} ms, {beyond_m:.2f} m" if stopped else "did not stop") +
                      (f"; {resumed:.1f} s" if resumed is not None else "; never") +
                      f"; {odometry['end_error_m']:.2f} m, {slam['end_error_m']:.3f} m", "drives on" if is_rare else "300 ms, 0.30 m", holds)
    return trials, add_rows


def cellar(quick):
    trial = Trial("cellar", "cellar", 1, 30 if quick else 120, *ODOMETRY_NOISE)

    def add_rows(table, _):
        slam, odometry = trial.result["slam2d"], trial.result["odometry"]
        table.add(f"cellar, {trial.result['distance_m']:.0f} m, odometry with 3 % bias and 1 deg per root of a metre: error of the end pose",
                  f"{slam['end_error_m']:.3f} m, {slam['end_error_deg']:.2f} deg", "<= 0.10 m, 1 deg",
                  slam["end_error_m"] <= 0.10 and slam["end_error_deg"] <= 1.0)
        table.add("cellar: error of the end pose by odometry, for comparison",
                  f"{odometry['end_error_m']:.2f} m, {odometry['end_error_deg']:.1f} deg", "", True)
        add_distance(table, "cellar", [trial.result], 10)
        table.add("cellar: collisions", trial.result["collisions"], "0", trial.result["collisions"] == 0)
    return [trial], add_rows


def drive_to_goal(world, seeds, duration_s):
    trials = [Trial(f"{world}-{s}", world, s, duration_s, "--no-slam6d") for s in seeds]

    def add_rows(table, _):
        results = results_of(trials)
        table.add(f"{world}, {len(results)} runs: collisions (of these, falls)",
                  f"{sum(r['collisions'] for r in results)} ({sum(r['falls'] for r in results)})", "0", collided(results) == 0)
        reached = sum(r["goal"]["reached"] for r in results)
        table.add(f"{world}: goals reached; metres driven in a run",
                  f"{reached} of {len(results)}; {min(r['distance_m'] for r in results):.1f} to {max(r['distance_m'] for r in results):.1f}", "all",
                  reached == len(results))
    return trials, add_rows


def stairs(quick):
    return drive_to_goal("stairs", REPORTING[1:3 if quick else 11], 60)


def warehouse(quick):
    return drive_to_goal("warehouse", REPORTING[1:3 if quick else 11], 60)


def storeys(quick):
    trials = [Trial(f"storeys-{s}", "storeys", s, 240, *ODOMETRY_NOISE) for s in REPORTING[: 1 if quick else 3]]

    def add_rows(table, _):
        results = results_of(trials)
        table.add(f"storeys, {len(results)} runs: collisions (of these, falls)",
                  f"{sum(r['collisions'] for r in results)} ({sum(r['falls'] for r in results)})", "0", collided(results) == 0)
        reached, asked = (sum(r["goals"][what] for r in results) for what in ("reached", "asked"))
        table.add("storeys: goals reached, up and down the ramp", f"{reached} of {asked}", "all", reached == asked)
        for trial in with_result(trials):
            worst_m = greatest_height_error(read_heights(trial.dir / "slam6d" / "trajectory.tum"), read_heights(trial.dir / "truth.tum"))
            table.add(f"{trial.name}: greatest error of the height by 6D SLAM, 3 m up", f"{100 * worst_m:.1f} cm", "<= 5 cm", worst_m <= 0.05)
    return trials, add_rows


def occupancy(quick):
    trials = [Trial(f"occupancy-{world}", world, 1, 20 if quick else 60, "--without", "slam2d", *ODOMETRY_NOISE) for world in ("cellar", "office")]

    def add_rows(table, _):
        for trial in with_result(trials):
            occupancy = trial.result["occupancy"]
            table.add(f"OctoMap of {trial.world.stem}, {trial.result['distance_m']:.0f} m: precision and recall, to one voxel of 5 cm",
                      f"{occupancy['precision']:.3f}, {occupancy['recall']:.3f}", "", True)
    return trials, add_rows


def map_error(trial, bin_dir):
    return evaluate(bin_dir, "cloud", trial.dir / "slam6d" / "cloud.ply", trial.world)


def clouds(quick):
    corridor_moving = Trial("corridor-moving", "corridor30", 2, 12 if quick else 25, *ODOMETRY_NOISE)
    stationary = Trial("cellar-stationary", "cellar", 2, 12, "--without", "navigator")
    cellar_moving = Trial("cellar-moving", "cellar", 2, 20 if quick else 40, *ODOMETRY_NOISE)

    def add_rows(table, bin_dir):
        table.add(f"3D map of {corridor_moving.result['distance_m']:.0f} m of corridor by 6D SLAM: distance from the true surfaces",
                  f"{1000 * map_error(corridor_moving, bin_dir)['rms_m']:.1f} mm RMS", "", True)
        still, moved = map_error(stationary, bin_dir), map_error(cellar_moving, bin_dir)
        ratio = moved["rms_m"] / still["rms_m"]
        # Fig. 9 compares drives with drives that stop; this reference is one place with a stationary robot, without any registration.
        table.add("cellar: distance from the true surfaces, 3D map of a drive / of one place, stationary",
                  f"{ratio:.2f} ({1000 * moved['rms_m']:.1f} / {1000 * still['rms_m']:.1f} mm)",
                  "<= 1.5", ratio <= 1.5)
    return [corridor_moving, stationary, cellar_moving], add_rows


def speed(quick):
    trials = [Trial(f"speed-{world}", world, 1, 20 if quick else 60) for world in ("office", "cellar")]

    def add_rows(table, _):
        for trial in with_result(trials):
            result = trial.result
            per_cpu_s = result["realtime_factor"] * result["wall_s"] / result["cpu_s"]
            table.add(f"{trial.world.stem}, whole robot with both SLAMs: simulated seconds per second of CPU time", f"{per_cpu_s:.1f}",
                      ">= 10", per_cpu_s >= 10.0)
    return trials, add_rows


GROUPS = {"random": random_clutter, "crowd": crowd, "appearing": appearing, "stops": stops, "damages": damages, "cellar": cellar, "occupancy": occupancy,
          "stairs": stairs, "warehouse": warehouse, "storeys": storeys, "clouds": clouds, "speed": speed}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser, os.cpu_count())
    parser.add_argument("--quick", action="store_true", help="run only a few short trials of each group")
    parser.add_argument("--only", nargs="+", choices=GROUPS, default=list(GROUPS))
    arguments = parser.parse_args()
    groups = [(name, *GROUPS[name](arguments.quick)) for name in arguments.only]
    trials = [trial for _, group, _ in groups for trial in group]
    table = Table()
    with result_folder(arguments.out) as out:
        run_all(trials, arguments.bin, out, arguments.jobs)
        add_failures(trials, table)
        for name, group, add_rows in groups:
            add_group(name, group, add_rows, table, arguments.bin)
    table.show()
    factors = [result["realtime_factor"] for result in results_of(trials)]
    if factors:
        print(f"{len(factors)} trials; {min(factors):.0f} to {max(factors):.0f} times as fast as real time")
    return 0 if table.all_hold() else 1


if __name__ == "__main__":
    sys.exit(main())
