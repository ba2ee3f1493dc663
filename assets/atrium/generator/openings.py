"""Doors and windows in the galleries' back walls: niches with surrounds. Frame: d = 0 is the wall's face."""
from .layout import EAST, STEP, UPPER_FLOOR

DEPTH = 0.36


def niche(mesh, s0, s1, y0, y1, window):
    """One opening: reveals, leaf at the bottom of the niche, stone surround. Returns its rectangle."""
    d = -DEPTH
    mesh.quad("plaster", (s0, y0, 0), (s0, y0, d), (s0, y1, d), (s0, y1, 0))
    mesh.quad("plaster", (s1, y0, d), (s1, y0, 0), (s1, y1, 0), (s1, y1, d))
    mesh.quad("plaster", (s0, y1, d), (s1, y1, d), (s1, y1, 0), (s0, y1, 0))
    mesh.quad("stone_trim", (s0, y0, 0), (s1, y0, 0), (s1, y0, d), (s0, y0, d))
    mesh.quad("wood", (s0, y0, d), (s1, y0, d), (s1, y1, d), (s0, y1, d))
    middle = (s0 + s1) / 2
    rows = 3 if y1 - y0 > 1.9 else 2
    for a, b in ((s0, middle - 0.01), (middle + 0.01, s1)):   # two leaves of framed panels
        stile = 0.1
        for x0, x1 in ((a, a + stile), (b - stile, b)):
            mesh.box("wood", (x0, y0, d), (x1, y1, d + 0.05), "kb")
        for k in range(rows + 1):
            y = y0 + (y1 - y0 - 0.12) * k / rows
            mesh.box("wood", (a + stile, y, d), (b - stile, y + 0.12, d + 0.045), "klr")
    w, t = 0.16, 0.06
    base = y0 - (0.12 if window else 0.0)
    mesh.box("stone_trim", (s0 - w, y0, 0), (s0, y1, t), "kb")
    mesh.box("stone_trim", (s1, y0, 0), (s1 + w, y1, t), "kb")
    mesh.box("stone_trim", (s0 - w, y1, 0), (s1 + w, y1 + w, t), "k")
    mesh.box("stone_trim", (s0 - w - 0.08, y1 + w, 0), (s1 + w + 0.08, y1 + w + 0.09, 0.16), "k")
    if window:
        mesh.box("stone_trim", (s0 - w - 0.06, base, 0), (s1 + w + 0.06, y0, 0.13), "k")
    return (s0, s1, y0, y1)


def openings(mesh, side, storey):
    """Builds the niches of one side's back wall; returns their rectangles."""
    middles = (side.bays[:-1] + side.bays[1:]) / 2
    made = []
    for i, s in enumerate(middles):
        if storey == 0:
            if side is EAST and i == 1:
                made.append(niche(mesh, s - 1.1, s + 1.1, STEP, 3.2, False))
            elif i % 2 == 1:
                made.append(niche(mesh, s - 0.65, s + 0.65, STEP, 2.55, False))
            else:
                made.append(niche(mesh, s - 0.5, s + 0.5, 1.3, 2.7, True))
        elif i % 2 == 0:
            made.append(niche(mesh, s - 0.6, s + 0.6, UPPER_FLOOR, UPPER_FLOOR + 2.4, False))
        else:
            made.append(niche(mesh, s - 0.45, s + 0.45, UPPER_FLOOR + 1.0, UPPER_FLOOR + 2.3, True))
    return made
