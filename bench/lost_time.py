#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what keeps the robot from its fastest speed in clutter: drives worlds without a goal, and prints the seconds lost to each cause.

    bench/lost_time.py [--seeds N] [--first SEED] [--only SCENARIO ...] [--fastest MPS] [--duration S] [--jobs N] [--set KEY=VALUE ...] [--out DIR] [--bin DIR]

A decision that commands the speed v, and that the next decision follows dt later, loses the time dt (1 - v / fastest). The sum over a run is the time that
the robot would save at its fastest speed. The cause is the rule that set v. Usually the reason in NAVIGATION names it. For a robot that steers it follows
from the speed: if this is the pitch controller's bound in PITCH_COMMAND or the fastest speed, the bound is the cause, otherwise a bend (lateral acceleration,
yaw rate) or the rollout that the robot chose. The last row counts how often the robot came to a standstill: from 0.15 m/s or more to less than 0.03 m/s.
"""
import argparse
import collections
import re
import struct
import sys

from event_log import events
from programs import ROOT, settings
from seeds import CHOOSING
from trial_runs import Trial, add_options, add_seed_options, add_set_option, result_folder, run_all, seeds_of, show_failures, show_table

sys.path.insert(0, str(ROOT / "lcmtypes"))
import lcm_files  # noqa: E402

STEER, TURN = 0, 2
# Below this a rotation on the spot counts as slow: Brake allows 0.17 rad/s over doubtful ground.
CREEPING_RAD_S = 0.2
# The bound that a decision has used may be one message newer than the last one before it in the log. It rises by 1 cm/s in 20 ms.
SAME_MPS = 0.03
START = "start: laser and servo"
# The cause that these reasons (modules/navigator/reason.cpp) name. Where the robot moves for any other reason, the cause follows from its motion; where it does
# not, the reason's sentence is the cause.
CAUSES = {
    '"something approaches", where nothing moves': "Approach",
    "a person is close": "SomebodyClose",
    "giving way": "GivesWay",
    "waiting until the laser has looked": "FirstLook LooksAhead FreeAhead",
    "the pitch controller's bound": "NoSpeed",
    "Brake: obstacles, ground not seen, the arc it is on": "SlowsDown ObstacleAhead",
    "backing up": "BacksUp BacksUpTrail",
    "no motion is free": "NoFreeDirection NoMotion CannotMove NoWayBack NoPath NoPathLooks",
}
SENTENCES = dict(re.findall(r'\{Why::k(\w+),\s*"([^"]*)"\}', (ROOT / "modules" / "navigator" / "reason.cpp").read_text(encoding="utf-8")))
CAUSE_OF = {SENTENCES[reason]: cause for cause, reasons in CAUSES.items() for reason in reasons.split()}
KNOWN = re.compile("|".join(re.escape(sentence).replace("%", ".+") for sentence in SENTENCES.values()))


def reader_of(name):
    """Reads messages of a type without arrays: a function from the bytes of an event to a dictionary of the fields."""
    fields = lcm_files.parse(ROOT / "lcmtypes" / f"nodmap_{name}.lcm")[0].fields
    formats = {"int64_t": ">q", "int32_t": ">i", "int8_t": ">b", "boolean": ">?", "double": ">d", "float": ">f"}

    def read(event):
        values, at = {}, 8  # after the fingerprint
        for kind, field, dimensions in fields:
            assert not dimensions, f"{name}.{field} is an array"
            if kind == "string":
                size, = struct.unpack_from(">i", event, at)
                values[field] = event[at + 4:at + 4 + size - 1].decode()
                at += 4 + size
            else:
                values[field], = struct.unpack_from(formats[kind], event, at)
                at += struct.calcsize(formats[kind])
        if at != len(event):
            raise ValueError(f"an event is no {name}")
        return values
    return read


def messages(path, channels):
    """Yields the messages of these channels: microseconds since the first event of the log, channel, message.

    `channels`: the message type of each, or None if the message is not needed."""
    readers = {channel: reader_of(name) if name else lambda _: None for channel, name in channels.items()}
    first_us = None
    for event in events(path):
        first_us = event.utime if first_us is None else first_us
        if event.channel in channels:
            yield event.utime - first_us, event.channel, readers[event.channel](event.data)


def decisions(path):
    """Reads of each DRIVE: time, forward speed, yaw rate, the pitch controller's bound, behaviour and reason. Also returns when the log ends (s)."""
    found, motions, bound_mps, now_us = [], {}, 0.0, 0
    for now_us, channel, message in messages(path, {"DRIVE": "drive_t", "NAVIGATION": "navigation_t", "PITCH_COMMAND": "pitch_command_t", "ODOMETRY": None}):
        if channel == "PITCH_COMMAND":
            bound_mps = message["max_forward_mps"]
        elif channel == "DRIVE":
            motions[message["drive_seq"]] = (message["forward_mps"], message["yaw_rate_rad_s"])
        elif channel == "NAVIGATION" and message["drive_seq"] in motions:
            found.append((now_us / 1e6, *motions.pop(message["drive_seq"]), bound_mps, message["behaviour"], message["reason"]))
    return found, now_us / 1e6


def cause_of(forward_mps, yaw_rate_rad_s, bound_mps, behaviour, reason, fastest_mps):
    if not KNOWN.fullmatch(reason):
        raise ValueError(f"the log has a reason that reason.cpp does not have: {reason}")
    if reason in CAUSE_OF:
        return CAUSE_OF[reason]
    if behaviour == TURN and forward_mps <= 0.0:
        return "rotation on the spot" if abs(yaw_rate_rad_s) > CREEPING_RAD_S else "slow rotation on the spot over doubtful ground, or a standstill"
    if behaviour == STEER:
        if forward_mps >= min(bound_mps, fastest_mps) - SAME_MPS:
            return "the pitch controller's bound"
        return "bends, and slower rollouts that it chose"
    return reason or "other"


def lost_seconds(path, fastest_mps):
    """The seconds lost to each cause, the number of standstills, and the length of the log (s)."""
    lost, num_stops, is_moving = collections.Counter(), 0, False
    found, end_s = decisions(path)
    lost[START] = found[0][0] if found else end_s
    has_driven = False
    for this, following in zip(found, [*found[1:], (end_s,)]):
        time_s, forward_mps, yaw_rate_rad_s, bound_mps, behaviour, reason = this
        has_driven = has_driven or forward_mps != 0.0 or yaw_rate_rad_s != 0.0
        cause = cause_of(forward_mps, yaw_rate_rad_s, bound_mps, behaviour, reason, fastest_mps) if has_driven else START
        lost[cause] += (following[0] - time_s) * (1.0 - max(0.0, forward_mps) / fastest_mps)
        num_stops += is_moving and forward_mps < 0.03
        is_moving = forward_mps >= 0.15 or (is_moving and forward_mps >= 0.03)
    return lost, num_stops, end_s


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_seed_options(parser, 4, CHOOSING[1])
    parser.add_argument("--only", nargs="+", default=["dense", "random"], help="scenarios without a goal")
    parser.add_argument("--fastest", type=float, default=1.5, help="speed relative to which time is lost, m/s")
    parser.add_argument("--duration", type=float, default=60.0, help="length of a run from the first scan on, seconds")
    add_set_option(parser)
    add_options(parser)
    arguments = parser.parse_args()
    options = ["--no-slam6d", *settings(arguments.set)]
    runs = {scenario: [Trial(f"{scenario}-{s}", f"{scenario}:{s}", s, arguments.duration, *options, keep_log=True) for s in seeds_of(arguments)] for scenario in arguments.only}
    columns = {}
    every = [trial for trials in runs.values() for trial in trials]
    with result_folder(arguments.out) as out:
        run_all(every, arguments.bin, out, arguments.jobs)
        if show_failures(every):
            return 1
        for scenario, trials in runs.items():
            column = columns[scenario] = collections.Counter()
            for trial in trials:
                lost, num_stops, end_s = lost_seconds(trial.dir / "trial.lcmlog", arguments.fastest)
                column.update(lost)
                column["standstills"] += num_stops
                column["seconds"] += end_s
                column["mean_mps"] += trial.result["mean_speed_mps"] / len(trials)
                column["collisions"] += trial.result["collisions"]
    show(columns)
    return 0


def show(columns):
    """Prints a Markdown table: the seconds lost to each cause in each scenario, and their totals."""
    totals = ("seconds", "mean_mps", "collisions", "standstills")
    causes = sorted({cause for column in columns.values() for cause in column if cause not in totals},
                    key=lambda cause: -sum(column[cause] / column["seconds"] for column in columns.values()))
    lines = [*((cause, cause, 1) for cause in causes), ("of", "seconds", 0), ("mean_mps", "mean_mps", 2),
             ("collisions", "collisions", 0), ("standstills", "standstills", 0)]
    show_table(["lost to", *(f"{scenario}, s" for scenario in columns)],
               [[name, *(f"{column[key]:.{digits}f}" for column in columns.values())] for name, key, digits in lines])


if __name__ == "__main__":
    sys.exit(main())
