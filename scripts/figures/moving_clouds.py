# SPDX-License-Identifier: BSD-3-Clause
"""Single clouds taken on the move (Fig. 8): finds when the robot drives fast in a run, and how far each cloud is from the true surfaces."""
import bisect
import csv
import json
import math

from poses import pose_at, read_tum

SCANS = 50
SPEED_MPS = 1.5
WINDOW_S = SCANS * 0.01332
EVERY_S = 2.0  # from one cloud to the next that is measured


def read_motions(folder, call):
    """Time (s since the first scan), forward speed (m/s) and yaw rate (rad/s) of each TRUTH after the first scan."""
    table = folder / "TRUTH.csv"
    if not table.exists():
        call("nodmap-convert", "export", folder / "trial.lcmlog", table, "--channel", "TRUTH")
    with open(table, newline="") as file:
        rows = [(1e-6 * float(row["utime_us"]), float(row["forward_mps"]), float(row["yaw_rate_rad_s"])) for row in csv.DictReader(file)]
    # The trajectory begins with the run, but the first scan comes only when laser and servo are ready.
    first_scan_s = read_tum(folder / "truth.tum")[0][0] + json.loads((folder / "result.json").read_text())["first_scan_s"]
    return [(time_s - first_scan_s, *motion) for time_s, *motion in rows if time_s > first_scan_s]


def fast_windows(motions):
    """The windows in which the robot always drives at 1.5 m/s (to 3 %): their starts (s since the first scan) and the rotation in each (degrees)."""
    times = [motion[0] for motion in motions]
    windows = []
    for i, start_s in enumerate(times):
        inside = motions[i:bisect.bisect_right(times, start_s + WINDOW_S)]
        if (len(inside) > 20 and min(forward_mps for _, forward_mps, _ in inside) > 0.97 * SPEED_MPS
                and (not windows or start_s > windows[-1][0] + EVERY_S)):
            windows.append((start_s, math.degrees(max(abs(rate) for _, _, rate in inside) * WINDOW_S)))
    return windows


def measure(folder, world, call):
    """Measures each such cloud of a trial that has kept its log, placed at the robot's true pose. `call` runs a program and returns what it prints."""
    truth = read_tum(folder / "truth.tum")
    clouds = []
    for start_s, rotation_deg in fast_windows(read_motions(folder, call)):
        path = folder / f"cloud{len(clouds)}.ply"
        call("nodmap-convert", "export", folder / "trial.lcmlog", path, "--start-s", f"{start_s:.3f}", "--scans", SCANS)
        x, y, yaw = pose = pose_at(truth, read_tum(path.with_suffix(".tum"))[0][0])
        errors = json.loads(call("nodmap-evaluate", "cloud", path, world, f"--start={x:.6f}", f"{y:.6f}", f"{math.degrees(yaw):.6f}"))
        clouds.append({"path": path, "pose": pose, "start_s": start_s, "rotation_deg": rotation_deg, "errors": errors})
    if not clouds:
        raise RuntimeError(f"{folder}: the robot never drives at {SPEED_MPS} m/s")
    return clouds
