"""Cornices, rafters and the tiled roof over the galleries."""
import math

import numpy as np

from .layout import EAVE_OUT, EAVE_Y, GALLERY, ROOF_SLOPE, SIDES, UPPER_FLOOR, UPPER_TOP, WALL
from .mesh import unit

TILE, TILE_LENGTH = 0.285, 0.46
DEEP = WALL + GALLERY


def cornices(mesh, side):
    """String course between the storeys and cornice under the eaves, mitred in the corners."""
    y = UPPER_FLOOR
    string = [(0.0, y - 0.34), (0.03, y - 0.33), (0.03, y - 0.26), (0.05, y - 0.24), (0.09, y - 0.2), (0.11, y - 0.15),
              (0.17, y - 0.14), (0.19, y - 0.12), (0.19, y - 0.03), (0.16, y), (0.0, y)]
    mesh.run("stone_trim", string, -side.inner, side.inner, 1, -1)
    y = UPPER_TOP
    crown = [(0.0, y - 0.45), (0.03, y - 0.44), (0.03, y - 0.36), (0.05, y - 0.34), (0.05, y - 0.2), (0.09, y - 0.17),
             (0.14, y - 0.1), (0.15, y - 0.04), (0.22, y - 0.03), (0.24, y), (0.24, y + 0.08), (0.0, y + 0.1)]
    mesh.run("stone_trim", crown, -side.inner, side.inner, 1, -1)


def slab(mesh, side):
    """Boards under the tiles, their front edge, rafters' heads. Height is EAVE_Y + slope * distance from the edge."""
    low, k, out = EAVE_Y, ROOF_SLOPE, EAVE_OUT
    profile = [(-DEEP, low + k * (out + DEEP)), (out, low), (out, low + 0.05)]
    mesh.run("wood", profile, -side.inner, side.inner, 1, -1)
    count = int(2 * side.inner / 0.6)
    for i in range(count + 1):
        s = -side.inner + 2 * side.inner * i / count
        if abs(s) > side.inner - out:
            continue
        head = [(0.0, low + k * out - 0.16), (out - 0.2, low + k * 0.2 - 0.16), (out - 0.1, low + k * 0.1 - 0.1),
                (out - 0.06, low + k * 0.06), (0.0, low + k * out)]
        mesh.run("wood", head[:4], s - 0.055, s + 0.055)
        for x, order in ((s - 0.055, -1), (s + 0.055, 1)):
            p = np.array([(x, y, d) for d, y in head])
            fan = [(0, i, i + 1) if order < 0 else (0, i + 1, i) for i in range(1, 4)]
            n = unit(np.cross(p[fan[0][1]] - p[0], p[fan[0][2]] - p[0]))
            mesh.add("wood", p, np.tile(n, (5, 1)), p[:, [2, 1]], fan)


def half_pipe(mesh, s, d0, d1, r0, r1, y0, y1, steps, cap, valley=False):
    """A tile: half a cone from (d0, y0) to (d1, y1); covers bulge upwards, pans (valley) sag."""
    th = np.linspace(math.pi, 0.0, steps + 1)
    sign = -1.0 if valley else 1.0
    rows = np.array([[(s + r * math.cos(t), y + sign * 0.8 * r * math.sin(t), d) for t in th]
                     for r, y, d in ((r0, y0, d0), (r1, y1, d1))])
    n = np.array([[(math.cos(t) * sign, math.sin(t), 0.0) for t in th]] * 2)
    arc = th * r0
    uv = np.array([[(d, a) for a in -arc] for d in (0.0, math.hypot(d1 - d0, y1 - y0))])
    mesh.grid("terracotta", rows, uv, n)
    if cap:  # the open end's thickness, as a ring, and its dark inside
        ring = np.array([[(s + f * r0 * math.cos(t), y0 + 0.8 * f * r0 * math.sin(t), d0) for t in th]
                         for f in (0.8, 1.0)])
        mesh.grid("terracotta", ring, ring[..., :2], np.tile([0.0, 0.0, 1.0], (2, steps + 1, 1)))


def tiles(mesh, side):
    """Courses of barrel tiles from the eave upwards; two courses one by one, the rest as one long piece."""
    k, out = ROOF_SLOPE, EAVE_OUT
    reach = side.inner + DEEP
    count = int(round(2 * (side.inner - out) / TILE))
    pitch = 2 * (side.inner - out) / count
    extra = int(math.ceil((DEEP + out) / pitch))
    for i in range(-extra, count + extra + 1):
        s = -(side.inner - out) + pitch * i
        if abs(s) > reach - 0.1:
            continue
        start = max(0.0, abs(s) - (side.inner - out))          # the valleys are mitred
        end = out + DEEP
        y = lambda a: EAVE_Y + 0.07 + k * a
        first = start == 0.0
        a = start - (0.06 if first else 0.0)
        for course in range(2 if first else 0):
            b = a + TILE_LENGTH
            half_pipe(mesh, s, out - a, out - b, pitch * 0.36, pitch * 0.29, y(a) + 0.035, y(b) + 0.01, 5, course == 0)
            a = b - 0.06
        half_pipe(mesh, s, out - a, out - end, pitch * 0.33, pitch * 0.33, y(a) + 0.02, y(end) + 0.02, 3, False)
        if i < count + extra:
            m = s + pitch / 2
            st = max(0.0, abs(m) - (side.inner - out))
            half_pipe(mesh, m, out - st + (0.04 if st == 0 else 0), out - end, pitch * 0.4, pitch * 0.4, y(st) + 0.035,
                      y(end) + 0.035, 3, False, True)


def build(mesh):
    for side in SIDES:
        with side.frame(mesh):
            cornices(mesh, side)
            slab(mesh, side)
            tiles(mesh, side)
