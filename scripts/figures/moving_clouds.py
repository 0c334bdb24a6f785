# SPDX-License-Identifier: BSD-3-Clause
"""Single clouds taken on the move (Fig. 8): when in a run the robot drives fast, and how far each cloud is from the true surfaces.

Nothing but Python's own library, so that bench/trials.py, too, measures what fig8.py shows.
"""
import bisect
import csv
import json
import math

SCANS = 50
SPEED_MPS = 1.5
WINDOW_S = SCANS * 0.01332
EVERY_S = 2.0  # from one cloud to the next that is measured


def read_poses(path):
    """Stamp (s), x, y (m) and yaw (rad) of each line of a trajectory in the plane."""
    rows = [[float(word) for word in line.split()] for line in path.read_text().splitlines() if not line.startswith("#")]
    return [(row[0], row[1], row[2], 2.0 * math.atan2(row[6], row[7])) for row in rows]


def pose_at(poses, stamp):
    """x, y (m), yaw (rad) between the two poses around a stamp."""
    after = min(max(bisect.bisect(poses, (stamp,)), 1), len(poses) - 1)
    (t0, x0, y0, yaw0), (t1, x1, y1, yaw1) = poses[after - 1], poses[after]
    share = min(max((stamp - t0) / (t1 - t0), 0.0), 1.0)
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0), yaw0 + share * math.remainder(yaw1 - yaw0, 2.0 * math.pi)


def read_motions(folder, call):
    """Time (s after the first scan), forward speed (m/s) and turn rate (rad/s) of each TRUTH after the first scan."""
    table = folder / "TRUTH.csv"
    if not table.exists():
        call("nodmap-convert", "export", folder / "trial.lcmlog", table, "--channel", "TRUTH")
    with open(table, newline="") as file:
        rows = [(1e-6 * float(row["utime_us"]), float(row["forward_mps"]), float(row["yaw_rate_rad_s"])) for row in csv.DictReader(file)]
    # The trajectory begins with the run, the scans come when laser and servo have been found.
    first_scan_s = read_poses(folder / "truth.tum")[0][0] + json.loads((folder / "result.json").read_text())["first_scan_s"]
    return [(time_s - first_scan_s, *motion) for time_s, *motion in rows if time_s > first_scan_s]


def fast_windows(motions):
    """Starts (s after the first scan) of windows in which the robot drives at 1.5 m/s (to 3 %) throughout, with the turn in each (degrees)."""
    times = [motion[0] for motion in motions]
    windows = []
    for i, start_s in enumerate(times):
        inside = motions[i:bisect.bisect_right(times, start_s + WINDOW_S)]
        if (len(inside) > 20 and min(forward_mps for _, forward_mps, _ in inside) > 0.97 * SPEED_MPS
                and (not windows or start_s > windows[-1][0] + EVERY_S)):
            windows.append((start_s, math.degrees(max(abs(rate) for _, _, rate in inside) * WINDOW_S)))
    return windows


def measure(folder, world, call):
    """Every such cloud of a trial that has kept its log, laid at the robot's true place. `call` runs a program and gives what it prints."""
    truth = read_poses(folder / "truth.tum")
    clouds = []
    for start_s, turn_deg in fast_windows(read_motions(folder, call)):
        path = folder / f"cloud{len(clouds)}.ply"
        call("nodmap-convert", "export", folder / "trial.lcmlog", path, "--start-s", f"{start_s:.3f}", "--scans", SCANS)
        x, y, yaw = pose = pose_at(truth, read_poses(path.with_suffix(".tum"))[0][0])
        errors = json.loads(call("nodmap-evaluate", "cloud", path, world, f"--start={x:.6f}", f"{y:.6f}", f"{math.degrees(yaw):.6f}"))
        clouds.append({"path": path, "pose": pose, "start_s": start_s, "turn_deg": turn_deg, "errors": errors})
    if not clouds:
        raise RuntimeError(f"{folder}: the robot never drives at {SPEED_MPS} m/s")
    return clouds
