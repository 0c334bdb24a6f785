#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the simulator's larger worlds, sim/worlds/{corridor30,cellar,office,crowd,loop,ring,warehouse}.yaml. Every run writes the same bytes. With --check only
compares.

usage: make_worlds.py [--check]
"""
import math
import pathlib
import random
import sys

OUT = pathlib.Path(__file__).resolve().parent.parent / "sim" / "worlds"
CEILING = 2.6


def number(value):
    return f"{value:.3f}".rstrip("0").rstrip(".") if value else "0"


def numbers(values):
    return "[" + ", ".join(number(v) for v in values) + "]"


class World:
    """Collects the lines of a WORLD.yaml. Lengths are in metres, angles in degrees; x, y and z are in world."""

    def __init__(self, name, about):
        self.head = ["# SPDX-License-Identifier: BSD-3-Clause", f"# {about}", "# Made by scripts/make_worlds.py.", f"name: {name}"]
        self.name, self.objects, self.actors, self.tail = name, [], [], []

    def note(self, text):
        self.objects.append(f"  # {text}")

    def box(self, x, y, z_min, z_max, length, width, yaw=0, reflectivity=None):
        extra = (f", yaw_deg: {number(yaw)}" if yaw else "") + (f", reflectivity: {reflectivity}" if reflectivity else "")
        self.objects.append(f"  - box: {{center: {numbers((x, y, (z_min + z_max) / 2))}, "
                            f"size: {numbers((length, width, z_max - z_min))}{extra}}}")

    def cylinder(self, x, y, z_min, z_max, radius, reflectivity=None):
        extra = f", reflectivity: {reflectivity}" if reflectivity else ""
        self.objects.append(f"  - cylinder: {{center: {numbers((x, y, (z_min + z_max) / 2))}, "
                            f"radius: {number(radius)}, height: {number(z_max - z_min)}{extra}}}")

    def wall(self, x0, y0, x1, y1, z=(0, CEILING), thickness=0.1):
        self.objects.append(f"  - wall: {{from: {numbers((x0, y0))}, to: {numbers((x1, y1))}, z: {numbers(z)}, "
                            f"thickness: {number(thickness)}}}")

    def room(self, x0, y0, x1, y1):
        for a, b in (((x0, y0), (x1, y0)), ((x1, y0), (x1, y1)), ((x1, y1), (x0, y1)), ((x0, y1), (x0, y0))):
            self.wall(*a, *b)
        self.ceiling(x0, y0, x1, y1)

    def ceiling(self, x0, y0, x1, y1):
        self.box((x0 + x1) / 2, (y0 + y1) / 2, CEILING, CEILING + 0.1, x1 - x0 + 0.2, y1 - y0 + 0.2)

    def placed(self, x, y, yaw, dx, dy):
        """The place in world of a point dx, dy of an object that is at x, y and is rotated by yaw."""
        c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
        return x + c * dx - s * dy, y + s * dx + c * dy

    def table(self, x, y, length, width, yaw=0, top=0.74):
        self.box(x, y, top - 0.03, top, length, width, yaw, 0.6)
        for dx in (-1, 1):
            for dy in (-1, 1):
                leg = self.placed(x, y, yaw, dx * (length / 2 - 0.05), dy * (width / 2 - 0.05))
                self.cylinder(*leg, 0, top - 0.03, 0.02)

    def chair(self, x, y, yaw):
        """Adds an office chair that faces along yaw: seat, back, column and a foot of two bars."""
        self.box(x, y, 0.43, 0.49, 0.46, 0.46, yaw, 0.3)
        self.box(*self.placed(x, y, yaw, -0.22, 0), 0.55, 0.95, 0.04, 0.42, yaw, 0.3)
        self.cylinder(x, y, 0.08, 0.43, 0.025)
        self.box(x, y, 0.02, 0.08, 0.56, 0.05, yaw + 30, 0.1)
        self.box(x, y, 0.02, 0.08, 0.56, 0.05, yaw + 120, 0.1)

    def shelf(self, x, y, length, depth, yaw=0, height=1.8, boards=4, lowest=0.1):
        """Adds a shelf of four posts and some boards."""
        for dx in (-1, 1):
            for dy in (-1, 1):
                self.box(*self.placed(x, y, yaw, dx * (length / 2 - 0.02), dy * (depth / 2 - 0.02)), 0, height, 0.04, 0.04, yaw)
        for i in range(boards):
            z = lowest + (height - 0.03 - lowest) * i / (boards - 1)
            self.box(x, y, z, z + 0.03, length, depth, yaw)

    def walker(self, points, speed, radius=0.25, height=1.75):
        """Adds a person who walks from point to point and back to the first, again and again, at this speed (m/s)."""
        time, path = 0.0, []
        for here, there in zip(points, points[1:] + points[:1]):
            path.append((time, *here))
            time += math.dist(here, there) / speed
        path.append((time, *points[0]))
        self.actors.append(f"  - {{cylinder: {{radius: {number(radius)}, height: {number(height)}}}, "
                           f"path: [{', '.join(numbers(p) for p in path)}], loop: true}}")

    def text(self):
        lines = self.head + ["objects:"] + self.objects + (["actors:"] + self.actors if self.actors else []) + self.tail
        return "\n".join(lines) + "\n"


def corridor30():
    """A corridor whose walls have doors, set back by 0.12 m, and niches 0.6 m deep."""
    w = World("corridor30", "The paper's Fig. 6: a corridor of 30 m inside, from x = -1 m to 29 m, 2.2 m wide.")
    half = 1.1
    w.note("The ends and the ceiling.")
    w.wall(-1.05, -2, -1.05, 2)
    w.wall(29.05, -2, 29.05, 2)
    w.ceiling(-1.1, -2, 29.1, 2)
    recesses = {  # side: (x, width, depth) of doors and niches
        1: [(1.2, 1.0, 0.12), (5.0, 1.0, 0.12), (8.6, 2.0, 0.6), (12.3, 1.0, 0.12), (16.1, 1.0, 0.12), (19.4, 1.4, 0.6),
            (23.0, 1.0, 0.12), (26.5, 1.0, 0.12)],
        -1: [(0.4, 1.0, 0.12), (4.1, 1.0, 0.12), (6.9, 1.0, 0.12), (10.7, 1.0, 0.12), (14.2, 1.6, 0.6), (18.0, 1.0, 0.12),
             (21.2, 1.0, 0.12), (24.9, 1.8, 0.6), (27.3, 1.0, 0.12)]}
    for side, doors in recesses.items():
        w.note("The left wall." if side > 0 else "The right wall.")
        x = -1.0
        for at, width, depth in doors + [(29.0, 0, 0)]:
            y = side * (half + 0.05)
            w.wall(x, y, at, y)
            if width:
                back = side * (half + depth + 0.05)
                w.wall(at, back, at + width, back)
                for end in (at, at + width):
                    w.wall(end, side * half, end, side * (half + depth + 0.1), thickness=0.04)
            x = at + width
    w.note("Furniture: radiators, extinguishers, a cupboard, bins, notice boards, a bench.")
    for x, side, z0, z1, length, depth in ((3.0, 1, 0.12, 0.72, 1.0, 0.10), (14.6, 1, 0.12, 0.72, 1.0, 0.10),
                                           (25.0, 1, 0.12, 0.72, 1.0, 0.10), (9.3, -1, 0, 1.9, 0.9, 0.40),
                                           (17.4, 1, 1.2, 1.9, 1.2, 0.04), (2.6, -1, 1.2, 1.9, 1.0, 0.04),
                                           (22.8, -1, 0.42, 0.46, 1.3, 0.38)):
        w.box(x, side * (half - depth / 2), z0, z1, length, depth)
    for x, side, z0, z1, radius in ((4.6, 1, 0.8, 1.35, 0.08), (20.9, -1, 0.8, 1.35, 0.08), (11.6, 1, 0, 0.6, 0.15),
                                    (26.2, -1, 0, 0.45, 0.15), (7.9, 1, 0, CEILING, 0.06), (22.1, 1, 0, CEILING, 0.06)):
        w.cylinder(x, side * (half - radius - 0.01), z0, z1, radius)
    w.tail = ["robot: {start: [0, 0, 0]}", "goal: [28, 0]"]
    return w


def cellar():
    """A ring of about 28 m around a block. It is 2.6 m wide between the walls, and at least 1.3 m of this is free."""
    w = World("cellar", "The paper's Figs. 7 and 9: a cluttered cellar with a ring around a central block.")
    w.note("The walls, the block in the middle.")
    w.room(-5.5, -4.0, 5.5, 4.0)
    w.box(0, 0, 0, CEILING, 5.6, 2.8)
    w.note("South: shelves on the wall, crates at the block.")
    w.shelf(-3.2, -3.68, 1.8, 0.45)
    w.shelf(-1.1, -3.70, 1.2, 0.40, lowest=0.35)
    w.box(0.4, -3.60, 0, 0.35, 0.6, 0.5, 8)
    w.box(0.42, -3.62, 0.35, 0.65, 0.45, 0.4, -5)
    w.box(3.0, -3.62, 0, 0.12, 1.2, 0.6)
    w.box(1.9, -1.55, 0, 0.25, 0.5, 0.25, 4)
    w.box(-2.2, -1.58, 0, 0.5, 0.4, 0.3)
    w.note("East: workbench, drum, pipes, a board that sticks out.")
    w.table(5.1, -0.9, 0.6, 1.6, top=0.86)
    w.box(5.15, -0.6, 0, 0.3, 0.4, 0.5, 3)
    w.cylinder(5.1, 1.0, 0, 0.88, 0.29)
    w.cylinder(5.12, 1.65, 0, 0.88, 0.29)
    w.box(5.15, 2.7, 0.40, 0.44, 0.6, 0.9)
    w.cylinder(2.92, 0.9, 0, CEILING, 0.08)
    w.cylinder(2.92, 0.6, 0, CEILING, 0.05)
    w.box(2.95, -0.4, 0, 0.9, 0.2, 0.5)
    w.box(4.9, -3.4, 0, 0.7, 0.7, 0.7, 12)
    w.note("North: tables with things below, a row of boxes, a boiler.")
    w.table(2.2, 3.55, 1.6, 0.7)
    w.box(2.0, 3.6, 0, 0.4, 0.5, 0.5, 15)
    w.table(0.1, 3.55, 1.4, 0.7, top=0.44)
    for i, (yaw, height) in enumerate(((5, 0.3), (-8, 0.45), (0, 0.2), (12, 0.38))):
        w.box(-1.6 - 0.55 * i, 3.62, 0, height, 0.45, 0.45, yaw)
    w.cylinder(-4.85, 3.35, 0, 1.9, 0.42)
    w.cylinder(-4.2, 3.8, 0, CEILING, 0.06)
    w.box(0.8, 1.52, 0, 0.10, 0.8, 0.22)
    w.box(-1.4, 1.55, 0, 1.1, 0.5, 0.28)
    w.note("West: shelf, bicycle-sized clutter, ladder, a pallet.")
    w.shelf(-5.22, 0.9, 1.6, 0.4, yaw=90, lowest=0.4)
    w.box(-5.1, -0.6, 0, 0.14, 0.6, 0.9)
    w.cylinder(-5.0, -0.75, 0.14, 0.6, 0.2)
    w.cylinder(-3.0, 0.7, 0, 2.2, 0.03)
    w.cylinder(-3.0, 0.3, 0, 2.2, 0.03)
    w.box(-2.98, -0.6, 0, 0.3, 0.3, 0.6, 5)
    w.box(-5.0, -2.2, 0, 0.8, 0.7, 0.5, 85)
    w.note("Pipes under the ceiling.")
    w.box(0, -2.0, 2.25, 2.4, 10.8, 0.12)
    w.box(4.3, 0, 2.2, 2.3, 0.1, 7.8)
    w.tail = ["robot: {start: [-0.5, -2.4, 0]}"]
    return w


def office():
    """A corridor of 20 m with five rooms on each side."""
    w = World("office", "An office floor: a corridor with ten furnished rooms, doors 0.9 m wide.")
    rng = random.Random(20050701)
    rooms, width, depth, half, door = 5, 4.0, 4.5, 0.9, 0.9
    w.note("Outer walls and ceiling; the robot starts at x = 0 in the corridor.")
    x0, x1, y1 = -1.0, -1.0 + rooms * width, half + depth
    w.room(x0, -y1, x1, y1)
    for side in (1, -1):
        for i in range(rooms):
            left = x0 + i * width
            hinge = left + rng.choice((0.5, 1.5, 2.5))
            w.note(f"Room {i + 1} on the {'left' if side > 0 else 'right'}: walls, lintel, open door.")
            w.wall(left, side * half, hinge, side * half)
            w.wall(hinge + door, side * half, left + width, side * half)
            w.wall(hinge, side * half, hinge + door, side * half, z=(2.05, CEILING))
            w.wall(hinge, side * (half + 0.08), hinge, side * (half + 0.88), z=(0.01, 2.0), thickness=0.04)
            if i:
                w.wall(left, side * half, left, side * y1)
            furnish(w, rng, left, width, side, y1, hinge + door / 2, desks=1 + (i + (side > 0)) % 2)
    w.note("In the corridor: copier, plant, bin, extinguisher.")
    w.box(5.9, 0.62, 0, 1.1, 0.6, 0.4)
    w.cylinder(11.0, -0.68, 0, 0.35, 0.14)
    w.cylinder(15.1, 0.7, 0, 0.45, 0.12)
    w.cylinder(9.0, 0.76, 0.8, 1.35, 0.08)
    w.tail = ["robot: {start: [0, 0, 0]}", "goal: [17.5, 0]"]
    return w


def furnish(w, rng, left, width, side, y1, door_x, desks):
    """Adds one or two desks with chairs at the window, a shelf beside the door where there is room, and small objects."""
    right = left + width
    for x in (left + 1.0, right - 1.0)[:desks]:
        w.table(x, side * (y1 - 0.5), 1.5, 0.75, rng.choice((0, 0, 2, -3)), rng.choice((0.72, 0.74)))
        w.chair(x + rng.uniform(-0.3, 0.3), side * (y1 - 1.25 - rng.uniform(0, 0.3)), side * 90 + rng.uniform(-40, 40))
    w.box(left + rng.uniform(0.4, 0.7), side * (y1 - 0.45), 0, 0.42, 0.2, 0.45, rng.uniform(-5, 5), 0.2)
    wall_x, yaw = (right - 0.3, 90) if door_x < (left + right) / 2 else (left + 0.3, 90)
    w.box(wall_x, side * 2.4, 0, rng.choice((1.2, 1.9)), 1.0, 0.42, yaw)
    w.cylinder(rng.choice((left + 0.35, right - 0.35)), side * 3.4, 0, 0.32, 0.13)
    w.box((left + right) / 2 + rng.uniform(-0.5, 0.5), side * rng.uniform(3.0, 3.4), 0, rng.choice((0.1, 0.25, 0.3)),
          0.4, 0.3, rng.uniform(0, 90))


def crowd():
    """An open hall with columns, benches and people who walk in rounds."""
    w = World("crowd", "A hall with 14 walking people.")
    rng = random.Random(7)
    w.note("The hall, 16 m x 12 m.")
    w.room(-2, -6, 14, 6)
    w.note("Columns, benches, an information desk, bins.")
    for x in (2.5, 6.5, 10.5):
        for y in (-2.5, 2.5):
            w.cylinder(x, y, 0, CEILING, 0.2)
    for x, y in ((0.5, 5.5), (5.0, -5.5), (9.0, 5.5)):
        w.box(x, y, 0.42, 0.47, 1.8, 0.45)
        for dx in (-0.7, 0.7):
            w.box(x + dx, y, 0, 0.42, 0.06, 0.4)
    w.box(13.0, 0, 0, 1.1, 0.8, 2.4)
    w.cylinder(2.5, -5.6, 0, 0.7, 0.2)
    w.cylinder(12.0, 5.6, 0, 0.7, 0.2)
    free_of = [(x, y, 0.6) for x in (2.5, 6.5, 10.5) for y in (-2.5, 2.5)]
    while len(w.actors) < 14:
        points = [(rng.uniform(-1.3, 12.0), rng.uniform(-5.0, 5.0)) for _ in range(rng.choice((2, 3, 4)))]
        legs = list(zip(points, points[1:] + points[:1]))
        clear = all(distance_to_leg(c, leg) > c[2] for c in free_of for leg in legs)
        # Nobody begins near the robot's start.
        if clear and all(math.dist(a, b) > 2.5 for a, b in legs) and math.dist(points[0], (0, 0)) > 2.0:
            w.walker(points, rng.uniform(0.5, 1.3), rng.choice((0.2, 0.25, 0.3)), rng.choice((1.2, 1.65, 1.75, 1.85)))
    w.tail = ["robot: {start: [0, 0, 0]}", "goal: [11.5, 0]"]
    return w


def loop():
    """A ring of 42 m around a block. It is 2.5 m wide between the walls, and at least 1.3 m of this is free. The goals lead once around it."""
    w = World("loop", "A cluttered ring of 42 m around a block, to be driven once around: does the map close?")
    rng = random.Random(40)
    w.note("The walls, the block in the middle.")
    w.room(-7, -6, 7, 6)
    w.box(0, 0, 0, CEILING, 9.0, 7.0)
    w.note("South: shelves, crates, a radiator.")
    w.shelf(-3.0, -5.7, 1.8, 0.45)
    w.box(2.6, -5.75, 0.1, 0.7, 1.4, 0.12)
    w.box(4.0, -3.7, 0, 0.5, 0.6, 0.35, 6)
    w.note("East: workbench, drums, pipes.")
    w.table(6.6, -2.4, 0.6, 1.6, top=0.86)
    w.cylinder(6.62, 0.6, 0, 0.88, 0.29)
    w.cylinder(6.62, 1.3, 0, 0.88, 0.29)
    w.cylinder(4.62, -0.4, 0, CEILING, 0.08)
    w.cylinder(4.62, 1.9, 0, CEILING, 0.05)
    w.note("North: tables, a row of boxes, a boiler.")
    w.table(3.2, 5.55, 1.6, 0.7)
    w.table(0.9, 5.55, 1.4, 0.7, top=0.44)
    for i in range(5):
        w.box(-1.2 - 0.6 * i, 5.66, 0, rng.choice((0.2, 0.3, 0.38, 0.45)), 0.45, 0.45, rng.uniform(-12, 12))
    w.cylinder(-6.4, 5.4, 0, 1.9, 0.42)
    w.box(-2.2, 3.68, 0, 1.1, 0.5, 0.28)
    w.note("West: shelves, pallets, a ladder.")
    w.shelf(-6.72, 1.8, 1.6, 0.4, yaw=90, lowest=0.4)
    w.box(-6.6, -0.4, 0, 0.14, 0.6, 0.9)
    w.cylinder(-4.7, 1.2, 0, 2.2, 0.03)
    w.cylinder(-4.7, 0.8, 0, 2.2, 0.03)
    w.box(-6.5, -2.8, 0, 0.8, 0.7, 0.5, 85)
    w.tail = ["robot: {start: [0, -4.7, 0]}", "goals: [[5.6, -4.2], [5.6, 4.4], [-5.6, 4.6], [-5.6, -4.4], [0, -4.7]]"]
    return w


def ring():
    """Corridors 4 m wide around a block of 56 m x 36 m, with a hall in the south and 25 m without any object in the north. The goals lead twice around."""
    w = World("ring", "A ring of 200 m with a hall and a bare corridor, to be driven twice around: does the map close, and is it straight?")
    rng = random.Random(60)
    w.note("The outer walls, with a hall of 20 x 8 m in the south; the block in the middle.")
    corners = ((-32, -22), (-10, -22), (-10, -30), (10, -30), (10, -22), (32, -22), (32, 22), (-32, 22), (-32, -22))
    for a, b in zip(corners, corners[1:]):
        w.wall(*a, *b)
    w.ceiling(-32, -30, 32, 22)
    w.box(0, 0, 0, CEILING, 56, 36)
    w.note("Along the outer walls: cabinets, boxes, shelves, pipes, door frames.")
    for x0, y0, x1, y1, yaw in ((-30, -22, -11, -22, 0), (11, -22, 30, -22, 0), (32, -20, 32, 20, 90), (30, 22, 14, 22, 180), (-12, 22, -30, 22, 180),
                                (-32, 20, -32, -20, 270)):
        length = math.dist((x0, y0), (x1, y1))
        along = rng.uniform(1, 3)
        while along < length - 1.5:
            kind, depth = rng.randrange(4), rng.uniform(0.2, 0.6)
            width = rng.uniform(0.4, 1.8)
            x, y = x0 + (x1 - x0) * along / length, y0 + (y1 - y0) * along / length
            x, y = w.placed(x, y, yaw, 0, depth / 2)
            if kind == 0:
                w.shelf(x, y, max(width, 0.8), max(depth, 0.3), yaw=yaw)
            elif kind == 1:
                w.cylinder(x, y, 0, rng.choice((0.9, CEILING)), 0.5 * min(depth, 0.4))
            else:
                w.box(x, y, 0, rng.uniform(0.3, 2.2), width, depth, yaw)
            along += width + rng.uniform(1.5, 4.5)
    w.note("In the hall: pillars, tables.")
    for x in (-6, 0, 6):
        w.box(x, -25, 0, CEILING, 0.4, 0.4, 0)
        w.table(x + 2.5, -28, 1.6, 0.8, yaw=rng.uniform(-20, 20))
    once = "[26, -20], [30, -16], [30, 16], [26, 20], [-26, 20], [-30, 16], [-30, -16], [-26, -20], [-5, -20]"
    w.tail = ["robot: {start: [-12, -20, 0]}", f"goals: [{once}, {once}]"]
    return w


def warehouse():
    """A hall that is longer than the laser's range, with objects that the laser hardly sees or that dazzle it."""
    w = World("warehouse", "A hall of 70 m with dark and dazzling objects on the robot's path; its far end is beyond the laser's range.")
    w.note("The hall; its walls are far from the robot's path, and there is no ceiling.")
    for a, b in (((-10, -9), (60, -9)), ((60, -9), (60, 9)), ((60, 9), (-10, 9)), ((-10, 9), (-10, -9))):
        w.wall(*a, *b, z=(0, 8))
    w.note("Black: rubber mats on edge, tyres, cabinets. The last one is the darkest: the laser sees it from 2.5 m on.")
    w.box(4.0, 0.3, 0, 0.5, 0.3, 0.9, 10, 0.02)
    w.cylinder(7.5, -0.9, 0, 0.25, 0.35, 0.03)
    w.box(11.0, -0.4, 0, 1.2, 0.5, 0.8, -8, 0.02)
    w.box(15.0, 0.6, 0, 0.3, 0.6, 0.6, 20, 0.005)
    w.note("Reflectors: marker posts, a sign, a strip on a rack. Head-on they dazzle up to 7 m and 20 m.")
    for x, y in ((6.0, 1.4), (9.5, 0.9), (13.0, -1.5), (17.5, -0.3)):
        w.cylinder(x, y, 0, 1.0, 0.05, 50)
    w.box(20.0, 0.2, 0.2, 0.8, 0.04, 0.6, 0, 400)
    w.box(12.0, 3.0, 0.3, 0.4, 12.0, 0.05, 0, 50)
    w.note("Grey: racks, pallets.")
    w.shelf(2.0, -3.0, 2.7, 0.9, height=3.0)
    w.shelf(8.0, -4.0, 2.7, 0.9, height=3.0)
    w.shelf(15.0, 4.0, 2.7, 0.9, height=3.0)
    w.box(18.0, -2.6, 0, 0.14, 1.2, 0.8, 15, 0.3)
    w.tail = ["robot: {start: [0, 0, 0]}", "goal: [24, 0]"]
    return w


def distance_to_leg(point, leg):
    (x, y), (x0, y0), (x1, y1) = point[:2], *leg
    length_sq = (x1 - x0) ** 2 + (y1 - y0) ** 2
    fraction = max(0.0, min(1.0, ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length_sq)) if length_sq else 0.0
    return math.dist((x, y), (x0 + fraction * (x1 - x0), y0 + fraction * (y1 - y0)))


def main():
    worlds = {OUT / f"{world.name}.yaml": world.text() for world in (corridor30(), cellar(), office(), crowd(), loop(), ring(), warehouse())}
    changed = [path for path, text in worlds.items() if not path.exists() or path.read_text() != text]
    if "--check" in sys.argv[1:]:
        print("worlds that scripts/make_worlds.py makes otherwise:" if changed else "worlds: up to date", *(path.name for path in changed))
        return 1 if changed else 0
    for path in changed:
        path.write_text(worlds[path])
    return 0


if __name__ == "__main__":
    sys.exit(main())
