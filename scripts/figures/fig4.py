# SPDX-License-Identifier: BSD-3-Clause
"""Fig. 4: a scene, its obstacle map and its structure map, for a stationary robot that nods."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Polygon

import formats
import scene
import style
from trials import Trial

TRIAL = Trial("fig4", "fig4", 1, 9, "--without", "navigator", "--no-slam6d")
TRIALS = [TRIAL]
NEAR_M = 0.05  # R15: a point of the structure map that is this near to a wall counts as on it
# The corners of the inside of the four walls, as in sim/worlds/fig4.yaml.
ROOM = np.array([[-1.45, -2.15], [4.45, -2.15], [4.45, 2.15], [-1.45, 2.15]])


def wall_distance(points):
    """The distance of points (in base, m) from the nearest wall of the room, m; base is the world's origin."""
    inward = np.stack([points[:, 0] - ROOM[0, 0], ROOM[1, 0] - points[:, 0], points[:, 1] - ROOM[0, 1], ROOM[2, 1] - points[:, 1]])
    return np.abs(inward).min(axis=0)


def person_at(trial):
    """Where the person is when the maps are taken: the last TRUTH."""
    line = trial.table("TRUTH").read_text().splitlines()[-1]
    return [float(word) for word in line.split(",")[-2:]]


def draw_map(axes, solids, points, colours, title, person):
    scene.draw_plan(axes, solids, alpha=0.18)
    axes.add_patch(plt.Circle(person, 0.22, color="#BF4D4D", alpha=0.18, linewidth=0))
    drawn = axes.scatter(points[:, 0], points[:, 1], s=3.5, linewidths=0, zorder=3, **colours)
    axes.add_patch(Polygon([[0.25, 0], [-0.2, 0.15], [-0.2, -0.15]], color=style.SLAM, linewidth=0, zorder=4))
    axes.set_xlim(-1.7, 4.7)
    axes.set_ylim(-2.4, 2.4)
    axes.set_title(title)
    style.as_plan(axes)
    return drawn


def make():
    solids, _ = scene.load(TRIAL.world, ceiling=False)
    obstacles, structure = (formats.read_last_map(TRIAL.table(name)) for name in ("OBSTACLE_MAP", "STRUCTURE_MAP"))
    person = person_at(TRIAL)
    figure, axes = plt.subplots(1, 3, figsize=(7.6, 2.4), gridspec_kw={"width_ratios": [1.05, 1, 1]}, constrained_layout=True)
    people = [scene.person(*person), *scene.robot(0, 0, 0)]
    axes[0].imshow(scene.photograph(solids + people, (-1.3, -1.25, 1.7), (2.4, 0.1, 0.35), 660, 500, see_through=True))
    axes[0].set_title("(a) scene")
    axes[0].axis("off")
    heights = {"c": obstacles[:, 2], "cmap": style.HEIGHT_MAP, "vmin": 0, "vmax": 0.5}
    drawn = draw_map(axes[1], solids, obstacles, heights, "(b) obstacle map", person)
    draw_map(axes[2], solids, structure, {"color": style.TRUTH}, "(c) structure map", person)
    bar = figure.colorbar(drawn, ax=axes[1], location="bottom", shrink=0.6, pad=0.02, aspect=30)
    bar.set_label("height of the point (m)", fontsize=7)
    style.save(figure, "fig4.png")
    on_walls = (wall_distance(structure) <= NEAR_M).mean()
    in_front = (wall_distance(obstacles) > 0.15).sum()
    return {
        "title": "obstacle map and structure map",
        "alt": "A room with a chair, a table and a person: the obstacle map shows all three, the structure map only the walls",
        "paper": "In each direction the obstacle map holds the nearest point in the virtual corridor, and the structure map the farthest point. "
                 "Chair, table and person are in the obstacle map and disappear from the structure map.",
        "measured": f"The robot is stationary and nods; the maps are those at the end of the run. {in_front} of the obstacle map's "
                    f"{len(obstacles)} points belong to chair, table and person, and the others to walls. The table's top, at 0.74 m, is above "
                    "the robot, so that only its legs are in the obstacle map. "
                    f"{100 * on_walls:.1f} % of the structure map's {len(structure)} points lie within 5 cm of a true wall "
                    "(target 95 %).",
        "holds": [("structure map on the walls", f"{100 * on_walls:.1f} %", "≥ 95 %", on_walls >= 0.95)],
    }
