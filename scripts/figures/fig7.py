# SPDX-License-Identifier: BSD-3-Clause
"""Fig. 7: the 2D map of a cluttered loop of at least 40 m, which ends where it begins."""
import matplotlib.pyplot as plt
import numpy as np

import formats
import style
from trials import ODOMETRY_NOISE, REPORTING, Trial

TRIALS = [Trial(f"fig7-{seed}", "loop", seed, 240, *ODOMETRY_NOISE, keep_log=False) for seed in REPORTING[1:6]]


def draw(trial):
    grid, extent = formats.read_grid(trial.dir / "slam2d" / "map.yaml")
    shade = np.where(grid < 100, 0.0, np.where(grid > 250, 1.0, 0.86))
    figure, axes = plt.subplots(figsize=(5.4, 4.0), constrained_layout=True)
    axes.imshow(shade, extent=extent, cmap="gray", vmin=0, vmax=1, interpolation="nearest")
    paths = (("odometry.tum", style.ODOMETRY, "odometry", 1.1, 1), ("truth.tum", style.TRUTH, "truth", 3.0, 0.3),
            ("slam2d/trajectory.tum", style.SLAM, "2D SLAM", 1.1, 1))
    for file, colour, label, width, alpha in paths:
        _, positions, yaw = formats.read_tum(trial.dir / file)
        moved, _ = formats.to_start(positions, yaw)
        axes.plot(moved[:, 0], moved[:, 1], color=colour, linewidth=width, alpha=alpha, label=label)
        axes.plot(*moved[-1], "s", color=colour, markersize=4, alpha=alpha)
    axes.plot(0, 0, "o", color=style.NODDING, markersize=5, label="start", zorder=5)
    axes.set_xlim(-7.3, 7.3)
    axes.set_ylim(-1.6, 11.0)
    axes.legend(loc="center", handlelength=1.5)
    style.as_plan(axes)
    style.save(figure, "fig7.png")


def worst_end(slam):
    """The greatest error of an end pose: metres, degrees."""
    return [max(trial.result[slam][key] for trial in TRIALS) for key in ("end_error_m", "end_error_deg")]


def make():
    rounds = [trial for trial in TRIALS if trial.result["goal"]["reached"]]
    if not rounds:
        raise RuntimeError("Fig. 7: no run went around the block")
    trial = rounds[0]
    draw(trial)
    loop_m = trial.result["distance_m"]
    worst_m, worst_deg = worst_end("slam2d")
    worst_6d_m, worst_6d_deg = worst_end("slam6d")
    form = "{:.1f} cm, {:.2f}°"
    slam, odometry = (form.format(100 * end["end_error_m"], end["end_error_deg"])
                      for end in (trial.result["slam2d"], trial.result["odometry"]))
    rows = (f"| once around the block, {loop_m:.0f} m | {slam} | {odometry} | ≤ 3 cm, 0.3° |\n"
            f"| worst of {len(TRIALS)} runs | {form.format(100 * worst_m, worst_deg)} | | ≤ 3 cm, 0.3° |\n")
    return {
        "title": "2D map of a cluttered loop",
        "alt": "Occupancy grid of a ring around a block: the trajectory of 2D SLAM lies on the true one, that of odometry beside it",
        "paper": "\"Due to the online re-localization the scan matching trajectory is corrected and thus reflects that the robot drove "
                 "back to its starting position.\"",
        "measured": "The robot drives once around the block, from goal to goal. Each wheel counts 3 % too much, and by the wheels alone the heading drifts by 1° times the root of the metres, which a gyro corrects in part. "
                    "The table shows the error of the last pose, which a square marks in the image:\n\n"
                    "| | 2D SLAM | odometry | target |\n|---|---|---|---|\n" + rows,
        "holds": [("runs that went around the block", f"{len(rounds)} of {len(TRIALS)}", "all", len(rounds) == len(TRIALS)),
                  (f"end pose, worst of {len(TRIALS)} runs", form.format(100 * worst_m, worst_deg), "≤ 3 cm, 0.3°",
                   worst_m <= 0.03 and worst_deg <= 0.3),
                  (f"end pose by 6D SLAM, worst of {len(TRIALS)} runs", form.format(100 * worst_6d_m, worst_6d_deg), "≤ 3 cm, 0.3°",
                   worst_6d_m <= 0.03 and worst_6d_deg <= 0.3),
                  ("driven once around", f"{loop_m:.0f} m", "≥ 40 m", loop_m >= 40)],
        "commands": [trial.command()],
    }
