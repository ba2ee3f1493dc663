"""Walls, arches, vaults, floors: everything flat or arched. Local frames as in layout.Side."""
import math

import numpy as np

from .layout import SPRING
from .mesh import turn

# Distance from an arch's foot to the centre line of its column, by storey.
GROUND_FOOT, UPPER_FOOT, PIER_FOOT = 0.36, 0.215, 0.42
VAULT_RISE = 1.52


def spandrel(mesh, material, s0, s1, centre, radius, spring, top, segments):
    """The wall around one arch in the plane d = 0, facing +d."""
    for a, b in ((s0, centre - radius), (centre + radius, s1)):
        if b - a > 1e-6:
            mesh.quad(material, (a, spring, 0), (b, spring, 0), (b, top, 0), (a, top, 0))
    th = np.linspace(math.pi, 0.0, segments + 1)
    s = centre + radius * np.cos(th)
    points = np.array([[(x, spring + radius * math.sin(t), 0.0) for x, t in zip(s, th)], [(x, top, 0.0) for x in s]])
    mesh.grid(material, points, mesh.box_uv(material, points.reshape(-1, 3), (0, 0, 1)),
              np.tile([0.0, 0.0, 1.0], (2, len(s), 1)))


def archivolt(radius, thick, width, step, beads):
    """Profile (radius, d) of an arch from its back edge through the intrados to the moulding on its court face."""
    r, t, w = radius, thick, width
    bead = [(r + 0.55 * w + 0.16 * w * (1 - math.cos(a)), step + 0.2 * w * math.sin(a))
            for a in np.linspace(0.4, 2.5, beads)] if beads else []
    return [(r, -t), (r, step * 0.6), (r + 0.38 * w, step * 0.6), (r + 0.42 * w, step), *bead,
            (r + w - 0.012, step * 0.75), (r + w, step * 0.5), (r + w, 0.0)]


def arcade(mesh, edges, feet, spring, top, thick, width, step, segments, material="limestone"):
    """A wall on arches, one for each bay; d from 0 (court face) to -thick.

    `feet`: half the width of the wall's foot at each edge; `spring`: height, or one for each bay; `width`, `step`:
    moulding."""
    for i in range(len(edges) - 1):
        s0, s1 = edges[i], edges[i + 1]
        a, b = s0 + feet[i], s1 - feet[i + 1]
        centre, radius = (a + b) / 2, (b - a) / 2
        y = spring[i] if isinstance(spring, dict) else spring
        spandrel(mesh, material, s0, s1, centre, radius + width, y, top, segments)
        mesh.arc("stone_trim", archivolt(radius, thick, width, step, 4 if segments > 16 else 0), centre, y, segments)
        with mesh.frame(turn("y", 180), (0, 0, -thick)):
            spandrel(mesh, "plaster", -s1, -s0, -centre, radius, y, top, segments)
        # the undersides at the feet
        for p, q in ((s0, a), (b, s1)):
            mesh.quad("stone_trim", (p, y, -thick), (q, y, -thick), (q, y, 0), (p, y, 0))
        for r0, f in ((a - width, a), (b, b + width)):  # foot of the moulding
            mesh.quad("stone_trim", (r0, y, 0), (f, y, 0), (f, y, step), (r0, y, step))


def keystone(mesh, centre, crown, low, high, half, step):
    """A tapering block over an arch's crown."""
    y0, y1, wide, d = crown + low, crown + high, half * 1.35, step * 1.3
    f = [(centre - half, y0, step), (centre + half, y0, step), (centre + wide, y1, d), (centre - wide, y1, d)]
    k = [(s, y, 0.0) for s, y, _ in f]
    mesh.quad("stone_trim", *f)
    for i in range(4):
        mesh.quad("stone_trim", k[i], k[(i + 1) % 4], f[(i + 1) % 4], f[i])


def groin_vault(mesh, s0, s1, d0, d1, segments=12):
    """A cross vault over a rectangle of the ground gallery: four webs, springing at SPRING, meeting at the groins."""
    cs, cd, hs, hd = (s0 + s1) / 2, (d0 + d1) / 2, (s1 - s0) / 2, (d1 - d0) / 2
    angle = np.linspace(0.0, math.pi / 2, segments // 2 + 1)
    w = np.cos(angle)                       # distance from the crown line along the curve, 1 at the springing
    for axis in (0, 1):
        for sign in (-1.0, 1.0):
            # web |along| >= |across|; height depends on `across` alone
            across = np.concatenate([w, -w[::-1][1:]])
            rows = []
            for k in (0.0, 1.0):          # a web is straight along its barrel: from the groin to the edge
                rows.append([(c, sign * (abs(c) + (1.0 - abs(c)) * k)) for c in across])
            uv_arc = np.arccos(across)
            points, normals, uvs = [], [], []
            for row in rows:
                for (c, along), t in zip(row, uv_arc):
                    h = SPRING + VAULT_RISE * math.sqrt(max(0.0, 1.0 - c * c))
                    x, z = (c, along) if axis == 0 else (along, c)
                    points.append((cs + hs * x, h, cd + hd * z))
                    half = hs if axis == 0 else hd
                    n = (-c / half, -math.sqrt(max(0.0, 1 - c * c)) / VAULT_RISE)
                    normals.append((n[0], n[1], 0) if axis == 0 else (0, n[1], n[0]))
                    run = (hd if axis == 0 else hs) * along
                    uvs.append((t * half / 3.0, run / 3.0))
            shape = (2, len(across), 3)
            p, n = np.reshape(points, shape), np.reshape(normals, shape)
            uv = np.reshape(uvs, (2, len(across), 2))
            face = np.cross(p[0, 3] - p[0, 2], p[1, 2] - p[0, 2])
            if face @ n[0, 2] < 0:
                p, n, uv = p[:, ::-1], n[:, ::-1], uv[:, ::-1]
            mesh.grid("plaster", p, uv, n)


def wall_with_openings(mesh, material, s0, s1, y0, y1, openings):
    """A wall face in d = 0 with rectangular openings (s, s, y, y): the face only."""
    ss = sorted({s0, s1, *(o[0] for o in openings), *(o[1] for o in openings)})
    for a, b in zip(ss, ss[1:]):
        here = sorted((o[2], o[3]) for o in openings if o[0] < (a + b) / 2 < o[1])
        low = y0
        for p, q in [*here, (y1, y1)]:
            if p > low:
                mesh.quad(material, (a, low, 0), (b, low, 0), (b, p, 0), (a, p, 0))
            low = q
