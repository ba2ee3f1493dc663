"""Columns, capitals and the balustrade. A column stands at the local origin, its shaft along y."""
import math

import numpy as np

from .layout import EAST, SIDES, SPRING, STEP, UPPER_FLOOR, UPPER_SPRING, UPPER_WALL, WALL
from .mesh import turn, unit


def torus(radius, y, r, steps=5, start=-90.0, end=90.0):
    """Points (radius, y) of a bulging ring's outside, upwards."""
    return [(radius + r * math.cos(math.radians(a)), y + r * math.sin(math.radians(a)))
            for a in np.linspace(start, end, steps)]


def shaft(r0, r1, y0, y1, steps):
    """Entasis: straight below, narrowing more and more towards the top."""
    return [(r0 - (r0 - r1) * t ** 1.8, y0 + (y1 - y0) * t) for t in np.linspace(0.0, 1.0, steps)]


def leaf(mesh, r, y, height, width, curl, angle):
    """A capital's leaf: rises against the bell, bends outwards, its tip hanging over."""
    with mesh.frame(turn("y", angle)):
        path = np.array([(r, 0.0), (r + 0.01, 0.4 * height), (r + 0.3 * curl, 0.78 * height),
                         (r + 0.75 * curl, height), (r + 1.15 * curl, 0.97 * height),
                         (r + 1.3 * curl, 0.82 * height)])                          # (d, y) of the middle rib
        along = unit(np.gradient(path, axis=0))
        # The leaf's outer side, hanging under at its tip.
        out = np.stack([along[:, 1], -along[:, 0]], 1)
        half = width / 2 * np.array([0.8, 1.0, 0.95, 0.8, 0.6, 0.35])
        rows = [[(u * w, y + q[1] - abs(u) * 0.14 * w * o[1], q[0] - abs(u) * 0.14 * w * o[0])
                 for u in (-1.0, 0.0, 1.0)] for q, o, w in zip(path, out, half)]
        p = np.array(rows)
        mesh.grid("stone_trim", p, np.stack([p[..., 0], p[..., 1]], -1))


def column(mesh, y0, y1, r, segments, leaves, steps=6):
    """A column from y0 to y1 with lower radius r: plinth, base, shaft, leafy bell, abacus."""
    k = r / 0.25
    p = 1.42 * r
    mesh.box("stone_trim", (-p, y0, -p), (p, y0 + 0.1 * k, p), "b")
    b = y0 + 0.1 * k
    base = [(r * 1.3, b), *torus(r * 1.3, b + 0.04 * k, 0.04 * k, 4), (r * 1.22, b + 0.085 * k),
            (r * 1.16, b + 0.11 * k), *torus(r * 1.14, b + 0.137 * k, 0.026 * k, 3), (r * 1.06, b + 0.165 * k),
            (r, b + 0.2 * k)]
    cap = y1 - 0.46 * k
    top = 0.84 * r
    neck = [*torus(top, cap + 0.018 * k, 0.022 * k, 4), (top, cap + 0.045 * k), (top * 1.02, cap + 0.2 * k),
            (top * 1.16, cap + 0.29 * k), (top * 1.42, cap + 0.37 * k)]
    if not leaves:                                            # the small column: fewer rings
        base = [(r * 1.3, b), (r * 1.36, b + 0.03 * k), (r * 1.34, b + 0.07 * k), (r * 1.12, b + 0.12 * k),
                (r * 1.12, b + 0.15 * k), (r, b + 0.2 * k)]
        neck = [(top * 1.15, cap), (top * 1.15, cap + 0.04 * k), (top, cap + 0.05 * k), (top * 1.04, cap + 0.2 * k),
                (top * 1.42, cap + 0.37 * k)]
    mesh.lathe("stone_trim", base + shaft(r, top, b + 0.2 * k, cap - 0.01 * k, steps) + neck, segments)
    a = 1.46 * r
    low, high = cap + 0.36 * k, y1
    mesh.box("stone_trim", (-a * 0.93, low, -a * 0.93), (a * 0.93, low + 0.04 * k, a * 0.93), "t")
    mesh.box("stone_trim", (-a, low + 0.04 * k, -a), (a, high, a), "")
    for i in range(leaves):
        leaf(mesh, top * 1.1, cap + 0.045 * k, 0.2 * k, 5.4 * top / leaves, 0.085 * k, 360.0 * i / leaves)
    for i in range(4):                                        # tall leaves under the corners
        leaf(mesh, top * 1.13, cap + 0.05 * k, 0.3 * k, 0.66 * top, 0.145 * k, 90.0 * i + 45.0)


BALUSTER = [(0.055, 0.0), (0.054, 0.03), (0.034, 0.06), (0.062, 0.2), (0.036, 0.4),
            (0.026, 0.52), (0.042, 0.59), (0.03, 0.63), (0.052, 0.68)]
RAIL_LOW, RAIL_HIGH = UPPER_FLOOR + 0.12, UPPER_FLOOR + 0.8


def balustrade(mesh, side):
    """Upper storey: pedestals under the columns, rails and turned balusters between."""
    d = -UPPER_WALL / 2
    edges = side.upper
    for i in range(len(edges) - 1):
        s0, s1 = edges[i] + 0.19, edges[i + 1] - 0.19
        plinth = [(d + 0.1, UPPER_FLOOR), (d + 0.1, RAIL_LOW), (d - 0.1, RAIL_LOW), (d - 0.1, UPPER_FLOOR)]
        mesh.run("stone_trim", plinth, s0, s1)
        rail = [(d + 0.09, RAIL_HIGH), (d + 0.12, RAIL_HIGH + 0.03), (d + 0.14, RAIL_HIGH + 0.05),
                (d + 0.14, RAIL_HIGH + 0.11), (d + 0.1, RAIL_HIGH + 0.14), (d - 0.1, RAIL_HIGH + 0.14),
                (d - 0.14, RAIL_HIGH + 0.11), (d - 0.14, RAIL_HIGH + 0.05), (d - 0.12, RAIL_HIGH + 0.03),
                (d - 0.09, RAIL_HIGH)]
        mesh.run("stone_trim", rail, s0, s1, closed=True)
        count = int((s1 - s0) / 0.25)
        for k in range(count):
            with mesh.frame(offset=(s0 + (s1 - s0) * (k + 0.5) / count, RAIL_LOW, d)):
                mesh.lathe("stone_trim", BALUSTER, 6)
    for s in edges[1:-1]:
        with mesh.frame(offset=(s, 0, d)):
            mesh.box("stone_trim", (-0.19, UPPER_FLOOR, -0.19), (0.19, RAIL_HIGH + 0.03, 0.19), "bt")
            mesh.box("stone_trim", (-0.215, UPPER_FLOOR, -0.215), (0.215, UPPER_FLOOR + 0.13, 0.215), "b")
            mesh.box("stone_trim", (-0.22, RAIL_HIGH + 0.03, -0.22), (0.22, RAIL_HIGH + 0.16, 0.22))


def build(mesh):
    for side in SIDES:
        with side.frame(mesh):
            if side is not EAST:
                for s in side.bays[1:-1]:
                    with mesh.frame(offset=(s, 0, -WALL / 2)):
                        column(mesh, STEP, SPRING + 0.01, 0.25, 16, 8)
            balustrade(mesh, side)
            for s in side.upper[1:-1]:
                with mesh.frame(offset=(s, 0, -UPPER_WALL / 2)):
                    column(mesh, RAIL_HIGH + 0.16, UPPER_SPRING + 0.01, 0.14, 10, 0, 4)
