# SPDX-License-Identifier: BSD-3-Clause
"""Fig. 9: the 3D model of the cellar by 6D SLAM, from scans on the move and, for comparison, from stationary scans."""
import matplotlib.pyplot as plt
import numpy as np

import formats
import scene
import style
from trials import ODOMETRY_NOISE, REPORTING, Trial, evaluate

SEEDS = REPORTING[1:11]
SLAM = [*ODOMETRY_NOISE, "--without", "slam2d"]
MOVING = [Trial(f"fig9-moving-{seed}", "cellar", seed, 60, *SLAM, keep_log=False) for seed in SEEDS]
# The paper's keyframes are 2 m apart; our default is 1 m.
SPARSE = [Trial(f"fig9-sparse-{seed}", "cellar", seed, 60, *SLAM, "--set", "slam6d.keyframe.distance_m=2", keep_log=False) for seed in SEEDS]
# The navigator is killed for 4 s of each 9 s. Then the robot is stationary and nods over the whole 120 degrees; only those sweeps are registered.
STOPS = [word for second in range(8, 150, 9) for word in ("--kill", f"navigator@{second}+4")]
STATIONARY = [Trial(f"fig9-stationary-{seed}", "cellar", seed, 150, *SLAM, "--set", "slam6d.keyframe.stationary_only=true", *STOPS, keep_log=False)
            for seed in SEEDS]
TRIALS = MOVING + SPARSE + STATIONARY
TOP_M = 2.2  # points above this are on the ceiling, which would hide everything else


def errors_of(trial):
    return evaluate("cloud", trial.dir / "slam6d" / "cloud.ply", trial.world)


def draw_oblique(axes, points):
    camera, at = np.array([0.3, -8.2, 7.4]), np.array([0.5, 2.2, 0.3])
    uv, _, order = scene.project(points, camera, at, 62.0)
    drawn = axes.scatter(uv[:, 0], uv[:, 1], s=0.7, c=points[order, 2], cmap=style.HEIGHT_MAP, vmin=0, vmax=TOP_M, linewidths=0)
    low, high = np.percentile(uv, [0.2, 99.8], axis=0)
    axes.set_xlim(low[0] - 0.03, high[0] + 0.03)
    axes.set_ylim(low[1] - 0.03, high[1] + 0.03)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title("(a) model from scans on the move")
    return drawn


def draw_plan(axes, points, trial, title):
    order = np.argsort(points[:, 2])
    axes.scatter(points[order, 0], points[order, 1], s=0.35, c=points[order, 2], cmap=style.HEIGHT_MAP, vmin=0, vmax=TOP_M, linewidths=0)
    _, positions, _ = formats.read_tum(trial.dir / "slam6d" / "trajectory.tum")
    axes.plot(positions[:, 0], positions[:, 1], color=style.FIXED, linewidth=1.0)
    axes.set_xlim(-5.4, 6.4)
    axes.set_ylim(-2.0, 6.8)
    axes.set_title(title)
    style.as_plan(axes)


def below_ceiling(trial):
    """The model's points below the ceiling, one for each cube of 4 cm."""
    points = formats.read_ply(trial.dir / "slam6d" / "cloud.ply")
    points = points[points[:, 2] < TOP_M]
    _, first = np.unique(np.round(points / 0.04).astype(int), axis=0, return_index=True)
    return points[np.sort(first)]


def draw():
    best = min(STATIONARY, key=lambda trial: errors_of(trial)["rms_m"])
    moving, stationary = below_ceiling(MOVING[0]), below_ceiling(best)
    figure = plt.figure(figsize=(7.2, 5.6), constrained_layout=True)
    parts = figure.add_gridspec(2, 2, height_ratios=[1.25, 1])
    drawn = draw_oblique(figure.add_subplot(parts[0, :]), moving)
    plans = [figure.add_subplot(parts[1, i]) for i in (0, 1)]
    draw_plan(plans[0], moving, MOVING[0], "(b) the same from above")
    draw_plan(plans[1], stationary, best, "(c) from stationary scans")
    bar = figure.colorbar(drawn, ax=plans, location="right", shrink=0.9, aspect=22)
    bar.set_label("height (m)")
    style.save(figure, "fig9.png", colours=48)


def make():
    draw()
    pairs = [(errors_of(moving), errors_of(stationary)) for moving, stationary in zip(MOVING, STATIONARY)]
    # The reference is the best of the stationary models, because a stationary run may fail, too, and is then no reference.
    reference_m = min(stationary["rms_m"] for _, stationary in pairs)
    worst_stationary_m = max(stationary["rms_m"] for _, stationary in pairs)
    ratios = [moving["rms_m"] / reference_m for moving, _ in pairs]
    sparse = [errors_of(trial)["rms_m"] / reference_m for trial in SPARSE]
    rows = "".join(
        f"| {seed} | {trial.result['distance_m']:.0f} m | {1000 * moving['rms_m']:.1f} mm ({100 * moving['outlier_share']:.1f} %) "
        f"| {still.result['distance_m']:.0f} m | {1000 * stationary['rms_m']:.1f} mm ({100 * stationary['outlier_share']:.1f} %) | {ratio:.2f} |\n"
        for seed, trial, still, (moving, stationary), ratio in zip(SEEDS, MOVING, STATIONARY, pairs, ratios))
    return {
        "title": "3D model",
        "alt": "3D model of the cellar, coloured by height: from scans on the move, seen obliquely and from above, and from stationary scans",
        "paper": "A 3D model from clouds taken while roaming; \"slightly more distorted compared to those that can be achieved by "
                 "performing 3D scans while standing\".",
        "measured": "The robot drives through a cellar with the odometry errors of Fig. 7 (3 % too much, 1° times the root of the metres, a gyro), and 6D SLAM registers its sweeps. "
                    "For comparison the robot stops for 4 s of each 9 s, and only the sweeps over the whole 120° that it takes while stationary are "
                    "registered (`slam6d.keyframe.stationary_only`). The table shows the RMS distance of the registered points from the true surfaces, and "
                    "in brackets the fraction of points farther away than 10 cm. The paper gives no number; our targets are 10 mm for the models from stationary scans, and a ratio of at "
                    "most 1.2 to the best of them:\n\n"
                    f"| seed | driven | on the move | driven | stationary | ratio to the best stationary model ({1000 * reference_m:.1f} mm) |\n|---|---|---|---|---|---|\n" + rows + "\n"
                    "The few stationary clouds overlap little. After a slip between two of them one may be placed wrongly; the fraction of points farther "
                    "away than 10 cm then shows it. Sweeps at speed cover the virtual corridor: walls, but hardly any floor or ceiling. Odometry and the "
                    "earlier sweeps therefore determine the height and tilt of their clouds. With the paper's 2 m between two keyframes, successive clouds "
                    f"overlap less, and the ratios are {', '.join(f'{ratio:.2f}' for ratio in sparse)}. All other parameters are the defaults, which were "
                    "chosen in other worlds ([decision 5](decisions/005-every-sweep-is-tracked.md)).",
        "holds": [(f"stationary, worst of {len(pairs)} seeds", f"{1000 * worst_stationary_m:.1f} mm", "≤ 10 mm", worst_stationary_m <= 0.010),
                  (f"distortion moving / best stationary, worst of {len(ratios)} seeds", f"{max(ratios):.2f}", "≤ 1.2", max(ratios) <= 1.2)],
        "commands": [MOVING[0].command(), short(STATIONARY[0].command())],
    }


def short(command):
    """The command with most of its stops left out, as they are all alike."""
    words = command.split(" --kill ")
    last = words[-1].split(" ", 1)
    return f"{words[0]} --kill {words[1]} --kill {words[2]} ... --kill {last[0]} {last[1]}"
