#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmarks' scripts do: bench.sh runs an entry with the arguments that its program needs, navigation.py fails where the robot hits something,
trials.py shows what it has when something fails, slam2d_damage.py counts what it cannot measure, slam6d_sessions.py compares a pose with the truth of the same
time, lost_time.py knows the navigator's reasons, sensitivity.py keeps drives apart, and Fig. 3 shows a speed that is held.

usage: bench_test.py SOURCE_DIR
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SERIAL_BENCH = """\
#!/bin/sh
[ "$1" -gt 0 ] || exit 2
jobs=$(ps -o pid= --ppid $PPID | wc -l)
echo "$1 s beside $((jobs - 1)) loops"
"""


def measure(source, entry, program, text):
    """Runs an entry of a copy of the script, with `text` in place of its program; returns what it prints."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "scripts").mkdir()
        shutil.copy(source / "scripts" / "bench.sh", root / "scripts")
        stub = root / "build" / "release" / "bin" / program
        stub.parent.mkdir(parents=True)
        stub.write_text(text)
        stub.chmod(0o755)
        return subprocess.run([root / "scripts" / "bench.sh", "--measure", entry], check=True, capture_output=True, text=True).stdout


GOAL = {"reached": True, "spl": 1.0, "time_s": 9.0, "shortest_path_m": 7.0, "start_to_goal_m": 7.0, "remaining_m": 0.2, "heading_error_deg": None}
NO_CONTACT = {"collisions": 0, "contacts_caused": 0, "falls": 0, "bumped": 0, "mean_speed_mps": 0.7, "min_clearance_m": 0.1, "close_to_person_s": 0.0, "slips": 0,
              "duration_s": 10.0, "distance_m": 20.0, "realtime_factor": 9.0, "goal": GOAL}
TRIAL = """\
#!/bin/sh
while [ "$1" != --out ]; do shift; done
mkdir -p "$2"
touch "$2/trial.lcmlog"
cp "$0.json" "$2/result.json"
"""


def drive(source, family, result):
    """The exit code of bench/navigation.py after a run in this family with this result."""
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / "nodmap-trial"
        program.write_text(TRIAL)
        program.chmod(0o755)
        program.with_name("nodmap-trial.json").write_text(json.dumps(result))
        return subprocess.run([sys.executable, source / "bench" / "navigation.py", "--only", family, "--seeds", "1", "--bin", folder],
                              capture_output=True).returncode


SOME_TRIAL = """\
#!/bin/sh
case "$*" in *--seed\\ 1\\ *) echo "disk full" >&2; exit 1 ;; esac
""" + TRIAL.split("\n", 1)[1]


def table(source, group, trial, result):
    """What bench/trials.py prints of a group, and its exit code."""
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / "nodmap-trial"
        program.write_text(trial)
        program.chmod(0o755)
        program.with_name("nodmap-trial.json").write_text(json.dumps(result))
        done = subprocess.run([sys.executable, source / "bench" / "trials.py", "--quick", "--only", *group, "--bin", folder], capture_output=True, text=True)
        return done.stdout, done.returncode


def check_trials(source):
    """A trial that fails, or a group that cannot be evaluated, must not lose the results of the others."""
    text, code = table(source, ["crowd"], SOME_TRIAL, NO_CONTACT)
    assert "crowd, 1 runs: collisions" in text and "disk full" in text and code == 1, text
    text, code = table(source, ["occupancy", "crowd"], TRIAL, NO_CONTACT | {"occupancy": None})
    assert "occupancy: not evaluated" in text and "crowd, 2 runs: collisions" in text and code == 1, text
    for group, row in (("crowd", "distance driven"), ("stairs", "goals reached"), ("warehouse", "goals reached")):
        text, code = table(source, [group], TRIAL, NO_CONTACT | {"distance_m": 0.0, "goal": GOAL | {"reached": False}})
        assert code == 1 and any(row in line and line.endswith("MISSED") for line in text.splitlines()), "a stationary robot hits nothing: " + text
    text, code = table(source, ["storeys"], TRIAL, NO_CONTACT | {"goals": {"asked": 5, "reached": 4}})
    assert code == 1 and any("goals reached" in line and line.endswith("MISSED") for line in text.splitlines()), text
    text, code = table(source, ["crowd"], "#!/bin/sh\nexit 1\n", NO_CONTACT)
    assert text.count("MISSED") == 3 and code == 1, text


def check_heights(source):
    """The greatest error of the height above the first one: here the trajectory begins 1 m higher than the truth, and ends 2 cm too low."""
    sys.path.insert(0, str(source / "bench"))
    from poses import greatest_height_error
    truth = [(0.01 * i, 0.001 * i) for i in range(101)]
    assert abs(greatest_height_error([(0.0, 1.0), (0.5, 1.05), (1.0, 1.08)], truth) - 0.02) < 1e-9


def check_appearing(source):
    """A robot that never drives as --appear demands is no failed trial, but not a met target either."""
    sys.path.insert(0, str(source / "bench"))
    from trials import NO_PLACE
    assert NO_PLACE in (source / "tools" / "trial" / "appearing_obstacle.cpp").read_text()
    text, code = table(source, ["appearing"], f"#!/bin/sh\necho 'it {NO_PLACE}' >&2\nexit 1\n", NO_CONTACT)
    assert text.count("MISSED") == 1 and "trials with a result" in text and code == 1, text


def check_event_log(source):
    sys.path.insert(0, str(source / "bench"))
    from event_log import Event, Writer, events
    written = [Event(1_000_000, "SCAN", b"abc"), Event(2_000_000, "ODOMETRY", b"")]
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "log"
        with Writer(path) as log:
            for event in written:
                log.write(event)
        assert list(events(path)) == written
        path.write_bytes(bytes(28))
        try:
            list(events(path))
        except ValueError:
            return
        raise AssertionError("28 zeros are no log")


class Run:
    def __init__(self, speed_mps=None):
        self.name, self.result = "run", None
        if speed_mps:
            self.result = NO_CONTACT | {"goal": GOAL | {"reached": False, "start_to_goal_m": 10.0 * speed_mps, "remaining_m": 0.0}}


def check_progress(source):
    """Only worlds that were driven both among people and alone are compared, and a run that failed is seen in n."""
    sys.path.insert(0, str(source / "bench"))
    import navigation
    row = navigation.row_of("people", [Run(0.5), Run(), Run(0.2)], [Run(1.0), Run(0.1), Run()])
    assert row["progress"] == 0.5 and row["n"] == "2 of 3", row


def check_lost_time(source):
    """lost_time.py knows every sentence of the navigator, and refuses any other."""
    sys.path.insert(0, str(source / "bench"))
    import lost_time
    reasons = (source / "modules" / "navigator" / "reason.hpp").read_text().split("enum class Why", 1)[1].split("};", 1)[0]
    assert len(lost_time.SENTENCES) == len(re.findall(r"^ *k[A-Z]", reasons, re.M)), "a sentence of reason.cpp was not read"
    at_rest = (0.0, 0.0, 1.0, 4)
    assert lost_time.cause_of(*at_rest, "Backs up.", 1.5) == lost_time.cause_of(*at_rest, "Cannot turn: backs up along its trail.", 1.5) == "backing up"
    assert lost_time.cause_of(*at_rest, "Stopped by viewer.", 1.5) == "Stopped by viewer."
    try:
        lost_time.cause_of(*at_rest, "Backs up a little.", 1.5)
    except ValueError:
        return
    raise AssertionError("an unknown reason was taken")


def check_odometry_noise(source):
    """Maps are reported with this noise (bench/seeds.py)."""
    sys.path.insert(0, str(source / "bench"))
    import trials
    drives = [trial for trial in trials.clouds(True)[0] if trial.name.endswith("-moving")]
    assert len(drives) == 2
    for trial in drives:
        assert "sim.odometry_scale_bias=0.03" in trial.options, trial.name


def check_steady_speed(source):
    """A window begins only after a dip, and there is none in a drive that never holds the speed or never reaches it."""
    sys.path.append(str(source / "scripts" / "figures"))
    from steady import steady_from
    times_s = [0.02 * i for i in range(500)]
    dip = [0.05 if 1.0 <= time_s < 3.0 else 1.5 for time_s in times_s]
    assert abs(steady_from(times_s, dip, 1.5, 2.4) - 3.3) < 0.03, "0.3 s after the dip, to one sample and a rounding error"
    assert abs(steady_from(times_s, dip, 1.5, 0.5) - 0.3) < 0.01, "before the dip"
    for never in ([1.0] * 500, [1.5 if time_s % 2 > 0.1 else 1.4 for time_s in times_s], [1.6] * 500):
        try:
            steady_from(times_s, never, 1.5, 2.4)
        except RuntimeError as error:
            assert "never holds 1.5 m/s" in str(error)
            continue
        raise AssertionError("a speed that is never held was found")


def check_truth_between_samples(source):
    """A robot at 1 m/s, whose truth has a sample every 10 ms, and whose pose has no error."""
    sys.path.insert(0, str(source / "bench"))
    import slam6d_sessions
    truth = [(0.01 * i, 0.01 * i, 0.0, 0.0) for i in range(3)]
    counts, errors, first = slam6d_sessions.evaluate([(0.005, (0.005, 0.0, 0.0), slam6d_sessions.TRACKING)], truth, (0.0, 0.0, 0.0))
    assert counts == [1, 0, 0, 0] and first == 0.005, (counts, first)
    assert errors[0] < 1e-12, errors


def check_relations_without_a_scan(source):
    """A log of three scans, with a gap over the middle one, and two relations, one of them to it."""
    sys.path.insert(0, str(source / "bench"))
    import slam2d_damage
    scans = [f"FLASER 1 2.0 0 0 0 0 0 0 {time_s}.0 host {time_s}.0\n" for time_s in range(3)]
    left = "".join(slam2d_damage.damaged_at([(0.5, 1.5)], [slam2d_damage.Line(scan) for scan in scans], "gap", None))
    num = slam2d_damage.without_scan(left, "# comment\n0.0 2.0 1 0 0 0 0 0\n0.0 1.0 1 0 0 0 0 0\n")
    assert num == 1, left
    errors = {"trans_mean_m": 0.01, "rot_mean_deg": 0.1, "n": 1, "missing": 1}
    assert slam2d_damage.cell(errors, 1) == "0.0100 m, 0.100°, 1 of 2 without a scan"
    assert slam2d_damage.cell(errors, 0) == "0.0100 m, 0.100°, **1 without a pose**"


def check_kept_drives(source):
    """Two drives that differ never have the same folder, in which an earlier one would be found and used for the other."""
    sys.path.insert(0, str(source / "bench"))
    import sensitivity
    trials = [trial for duration_s in (20, 40) for variant in sensitivity.VARIANTS for trial in sensitivity.make_trials(variant, sensitivity.WORLDS, range(12), duration_s)]
    assert len({trial.name for trial in trials}) == len(trials)


def main():
    source = pathlib.Path(sys.argv[1])
    check_truth_between_samples(source)
    check_trials(source)
    check_heights(source)
    check_appearing(source)
    check_event_log(source)
    check_lost_time(source)
    check_odometry_noise(source)
    check_progress(source)
    check_relations_without_a_scan(source)
    check_kept_drives(source)
    check_steady_speed(source)
    printed = measure(source, "serial", "nodmap-bench-serial", SERIAL_BENCH)
    assert printed == "20 s beside 6 loops\n", printed
    assert drive(source, "holes", NO_CONTACT) == 0
    assert drive(source, "holes", NO_CONTACT | {"collisions": 1, "contacts_caused": 1, "falls": 1}) == 1
    assert drive(source, "holes", NO_CONTACT | {"bumped": 1}) == 1, "what does not move cannot have bumped into the robot"
    assert drive(source, "people", NO_CONTACT | {"bumped": 1}) == 0


if __name__ == "__main__":
    main()
