# SPDX-License-Identifier: BSD-3-Clause
"""Draws a simulated world as a camera sees it, or as a plan. Only boxes, walls and cylinders are drawn; a world's other objects are
left out."""
import math

import numpy as np
import yaml
from matplotlib.patches import Circle, Polygon

FLOOR, SKY = np.array([0.78, 0.75, 0.70]), np.array([1.0, 1.0, 1.0])
LIGHT = np.array([0.45, 0.35, 0.82]) / np.linalg.norm([0.45, 0.35, 0.82])


class Solid:
    """A box (half sizes and yaw) or an upright cylinder (radius in half[0], half the height in half[2]), with its centre in world; metres."""

    def __init__(self, center, half, yaw_rad=0.0, is_round=False, colour=(0.8, 0.8, 0.8)):
        self.center, self.half, self.is_round = np.array(center, float), np.array(half, float), is_round
        self.axes = np.array([[math.cos(yaw_rad), math.sin(yaw_rad), 0], [-math.sin(yaw_rad), math.cos(yaw_rad), 0], [0, 0, 1]])
        self.colour = np.array(colour)

    def top_m(self):
        return self.center[2] + self.half[2]

    def outline(self):
        """The four corners of its ground plan: 4 x 2, m."""
        signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        return self.center[:2] + (signs * self.half[:2]) @ self.axes[:2, :2]

    def cast(self, origin, rays):
        """The distance to the first hit and the normal there, for each ray; infinity where there is none."""
        o, d = self.axes @ (origin - self.center), rays @ self.axes.T
        near, far, normal = self._slabs(o, d) if not self.is_round else self._tube(o, d)
        way = np.where((near <= far) & (near > 1e-6), near, np.inf)
        return way, normal @ self.axes

    def _slabs(self, o, d):
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (-self.half - o) / d, (self.half - o) / d
        enter, leave = np.fmin(a, b), np.fmax(a, b)
        side = np.argmax(enter, axis=1)
        normal = np.zeros_like(d)
        rows = np.arange(len(d))
        normal[rows, side] = -np.sign(d[rows, side])
        return enter.max(axis=1), leave.min(axis=1), normal

    def _tube(self, o, d):
        radius = self.half[0]
        a, b = (d[:, :2] ** 2).sum(axis=1), (d[:, :2] * o[:2]).sum(axis=1)
        root = b * b - a * ((o[:2] ** 2).sum() - radius * radius)
        with np.errstate(divide="ignore", invalid="ignore"):
            side_in, side_out = (-b - np.sqrt(root)) / a, (-b + np.sqrt(root)) / a
            cap_a, cap_b = (-self.half[2] - o[2]) / d[:, 2], (self.half[2] - o[2]) / d[:, 2]
        cap_in, cap_out = np.fmin(cap_a, cap_b), np.fmax(cap_a, cap_b)
        near = np.where(root > 0, np.fmax(side_in, cap_in), np.inf)
        hit = o + d * np.where(np.isfinite(near), near, 0.0)[:, None]
        normal = np.where((cap_in > side_in)[:, None], [0.0, 0.0, 1.0] * -np.sign(d[:, 2:3]),
                          np.column_stack([hit[:, :2] / radius, np.zeros(len(d))]))
        return near, np.fmin(side_out, cap_out), normal


def load(path, ceiling=True):
    """Reads the solids of a world, if wanted without its ceiling, so that a camera above sees the inside."""
    world = yaml.safe_load(path.read_text())
    solids = [solid_of(item) for item in world["objects"] if set(item) & {"box", "wall", "cylinder"}]
    return [solid for solid in solids if ceiling or solid.center[2] - solid.half[2] < 2.55], world


def solid_of(item):
    (kind, of), = item.items()
    if kind == "box":
        size = of["size"]
        colour = (0.93, 0.93, 0.90) if size[2] > 2.0 or of["center"][2] > 2.5 else (0.72, 0.56, 0.38)
        return Solid(of["center"], [0.5 * s for s in size], math.radians(of.get("yaw_deg", 0)), colour=colour)
    if kind == "cylinder":
        half = [of["radius"], of["radius"], 0.5 * of["height"]]
        return Solid(of["center"], half, is_round=True, colour=(0.45, 0.52, 0.58))
    (x1, y1), (x2, y2), (z1, z2) = of["from"], of["to"], of["z"]
    half = [0.5 * math.hypot(x2 - x1, y2 - y1), 0.5 * of["thickness"], 0.5 * (z2 - z1)]
    center = [0.5 * (x1 + x2), 0.5 * (y1 + y2), 0.5 * (z1 + z2)]
    return Solid(center, half, math.atan2(y2 - y1, x2 - x1), colour=(0.93, 0.93, 0.90))


def person(x, y, radius=0.22, height=1.75):
    return Solid([x, y, 0.5 * height], [radius, radius, 0.5 * height], is_round=True, colour=(0.75, 0.30, 0.30))


def robot(x, y, yaw_rad):
    """The robot KURT3D: its body, and the scanner on top of it."""
    return [Solid([x, y, 0.14], [0.225, 0.165, 0.12], yaw_rad, colour=(0.20, 0.35, 0.65)),
            Solid([x + 0.08 * math.cos(yaw_rad), y + 0.08 * math.sin(yaw_rad), 0.365], [0.08, 0.08, 0.105], yaw_rad,
                  colour=(0.25, 0.25, 0.28))]


def axes_of_camera(camera, at):
    """The directions right, up and ahead of a camera at `camera` that is directed at `at`."""
    ahead = (at - camera) / np.linalg.norm(at - camera)
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    return right, np.cross(right, ahead), ahead


def photograph(solids, camera, at, width=640, height=400, view_deg=60.0, see_through=False):
    """Renders what a camera at `camera` sees when it is directed at `at`: height x width x 3. `see_through` leaves out the walls between
    the two."""
    camera, at = np.array(camera, float), np.array(at, float)
    right, up, ahead = axes_of_camera(camera, at)
    u = (np.arange(width) + 0.5 - 0.5 * width) / (0.5 * width) * math.tan(math.radians(0.5 * view_deg))
    v = (0.5 * height - np.arange(height) - 0.5) / (0.5 * width) * math.tan(math.radians(0.5 * view_deg))
    rays = (ahead + u[None, :, None] * right + v[:, None, None] * up).reshape(-1, 3)
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    with np.errstate(divide="ignore"):
        best = np.where(rays[:, 2] < 0, -camera[2] / rays[:, 2], np.inf)
    hit = camera + rays * np.where(np.isfinite(best), best, 0)[:, None]
    tile = (np.floor(hit[:, 0] / 0.5) + np.floor(hit[:, 1] / 0.5)) % 2
    colour = np.where(np.isfinite(best)[:, None], FLOOR * (1.0 - 0.06 * tile[:, None]), SKY)
    for solid in solids:
        if see_through and solid.top_m() > 2.0 and inside_out(solid, camera, at):
            continue
        way, normal = solid.cast(camera, rays)
        nearer = way < best
        shade = 0.62 + 0.38 * np.abs(normal @ LIGHT)
        colour = np.where(nearer[:, None], solid.colour * shade[:, None], colour)
        best = np.where(nearer, way, best)
    return np.clip(colour, 0, 1).reshape(height, width, 3)


def project(points, camera, at, view_deg):
    """Image coordinates (in units of the half width), distances and indices of the points in front of the camera, the farthest first."""
    seen = (points - camera) @ np.stack(axes_of_camera(camera, at)).T
    order = np.argsort(-seen[:, 2])
    order = order[seen[order, 2] > 0.2]
    seen = seen[order]
    return seen[:, :2] / seen[:, 2:] / math.tan(math.radians(0.5 * view_deg)), seen[:, 2], order


def inside_out(solid, camera, at):
    """Whether a wall is between the camera and the point at which it is directed."""
    thin = int(np.argmin(solid.half[:2]))
    axis = solid.axes[thin]
    a, b = axis @ (camera - solid.center), axis @ (at - solid.center)
    return a * b < 0


def plan_colour(bottom_m):
    """Brown for objects that stand on the floor, blue for objects above the plane of a level laser."""
    return "#8FB3CC" if bottom_m > 0.38 else "#C9A66B"


def draw_plan(axes, solids, below_m=0.47, alpha=1.0):
    """Draws ground plans: walls dark, objects that the robot can hit coloured, and objects below which it passes as outlines."""
    for solid in sorted(solids, key=Solid.top_m):
        bottom_m = solid.center[2] - solid.half[2]
        is_wall = solid.half[2] > 1.0
        is_high = bottom_m > below_m
        if bottom_m > 2.2:
            continue
        style = {"facecolor": "none" if is_high else ("#444444" if is_wall else plan_colour(bottom_m)), "edgecolor": "#4A4A4A",
                 "linewidth": 0.0 if is_wall else 0.5, "linestyle": "--" if is_high else "-", "alpha": alpha}
        shape = Circle(solid.center[:2], solid.half[0], **style) if solid.is_round else Polygon(solid.outline(), **style)
        axes.add_patch(shape)
