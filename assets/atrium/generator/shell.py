"""The closed shell: floors, arcade walls, vaults, ceilings, back walls, outside. Local frames as in layout.Side."""
import numpy as np

from .architecture import (GROUND_FOOT, PIER_FOOT, UPPER_FOOT, VAULT_RISE, arcade, groin_vault, keystone,
                           wall_with_openings)
from .layout import (BACK_X, BACK_Z, CEILING, COURT_X, COURT_Z, EAST, GALLERY, OUTER, SHELL_TOP, SIDES, SLAB, SPRING,
                     STEP, STEP_OUT, UPPER_FLOOR, UPPER_SPRING, UPPER_TOP, UPPER_WALL, WALL)
from .mesh import turn
from .openings import openings

PORTAL_SPRING = 2.55
BORDER = 1.0                      # width of the floor's border
BACK = -(WALL + GALLERY)          # d of the back walls


def floors(mesh):
    """Court, border, step, galleries of both storeys, and the underside of everything."""
    x, z = COURT_X - STEP_OUT, COURT_Z - STEP_OUT
    a, b = x - BORDER, z - BORDER
    mesh.quad("floor", (-a, 0, b), (a, 0, b), (a, 0, -b), (-a, 0, -b))
    for side in SIDES:
        inner = side.inner - STEP_OUT
        with side.frame(mesh):
            d0, d1 = STEP_OUT - 0.03, STEP_OUT + BORDER
            mesh.quad("floor_border",
                      (-inner + BORDER, 0, d1), (inner - BORDER, 0, d1), (inner + 0.03, 0, d0), (-inner - 0.03, 0, d0),
                      [(-inner + BORDER, 0), (inner - BORDER, 0), (inner, 1), (-inner, 1)])
            nose = [(d0, 0.0), (d0, 0.085), (d0 + 0.03, 0.1), (d0 + 0.03, STEP - 0.02), (d0 + 0.01, STEP),
                    (-WALL - 0.1, STEP)]
            mesh.run("stone_trim", nose, -side.inner, side.inner, 1, -1)
            s = side.back if side.long else side.inner + WALL + 0.1
            if side.long:
                mesh.quad("floor", (-s, STEP, -WALL - 0.1), (-s, STEP, BACK), (s, STEP, BACK), (s, STEP, -WALL - 0.1))
                mesh.quad("floor", (-s, UPPER_FLOOR, 0), (s, UPPER_FLOOR, 0), (s, UPPER_FLOOR, BACK),
                          (-s, UPPER_FLOOR, BACK))
            else:
                mesh.quad("floor", (-s, STEP, -WALL - 0.1), (s, STEP, -WALL - 0.1), (s, STEP, BACK), (-s, STEP, BACK))
                s = side.inner
                mesh.quad("floor", (-s, UPPER_FLOOR, 0), (s, UPPER_FLOOR, 0), (s, UPPER_FLOOR, BACK),
                          (-s, UPPER_FLOOR, BACK))
    x, z = BACK_X + OUTER, BACK_Z + OUTER
    mesh.quad("limestone", (-x, -0.5, -z), (x, -0.5, -z), (x, -0.5, z), (-x, -0.5, z))


def arcades(mesh, side):
    """Both storeys of arches on one side, with the corners' backs."""
    n = len(side.bays)
    feet = [GROUND_FOOT] * n
    spring = SPRING
    if side is EAST:
        feet = [GROUND_FOOT, PIER_FOOT, PIER_FOOT, GROUND_FOOT]
        spring = {0: SPRING, 1: PORTAL_SPRING, 2: SPRING}
    arcade(mesh, side.bays, feet, spring, UPPER_FLOOR, WALL, 0.26, 0.05, 20)
    arcade(mesh, side.upper, [UPPER_FOOT] * len(side.upper), UPPER_SPRING, UPPER_TOP, UPPER_WALL, 0.15, 0.035, 10)
    for low, high, thick in ((STEP, SLAB, WALL), (UPPER_FLOOR, UPPER_TOP, UPPER_WALL)):
        for s0, s1 in ((-side.inner - thick, -side.inner), (side.inner, side.inner + thick)):
            mesh.quad("plaster", (s1, low, -thick), (s0, low, -thick), (s0, high, -thick), (s1, high, -thick))
    for i in range(n - 1):
        a, b = side.bays[i] + feet[i], side.bays[i + 1] - feet[i + 1]
        y = spring[i] if isinstance(spring, dict) else spring
        keystone(mesh, (a + b) / 2, y + (b - a) / 2, -0.03, 0.36, 0.1, 0.09)


def responds(mesh, side):
    """The square half piers in the corners, both storeys, and the portal's piers."""
    for half, foot, low, high, thick in ((side.inner, GROUND_FOOT, STEP, SPRING, WALL),
                                         (side.inner, UPPER_FOOT, UPPER_FLOOR, UPPER_SPRING, UPPER_WALL)):
        mesh.box("limestone", (-half, low, -thick), (-half + foot, high, 0), "lbt")
        mesh.box("limestone", (half - foot, low, -thick), (half, high, 0), "rbt")
    if side is EAST:
        for edge in side.bays[1:3]:
            for s0, s1 in ((edge - PIER_FOOT, edge), (edge, edge + PIER_FOOT)):
                inside = abs(s0 + s1) / 2 < abs(edge)
                high = PORTAL_SPRING if inside else SPRING
                mesh.box("limestone", (s0, STEP, -WALL), (s1, high, 0), "bt" + ("r" if s1 == edge else "l"))


def vaults(mesh, side):
    """Groin vaults of one side's ground gallery, the corner bay at its +s end, and the ribs between."""
    d0, d1 = BACK, -WALL
    edges = side.bays
    for s0, s1 in zip(edges, edges[1:]):
        groin_vault(mesh, s0, s1, d0, d1)
    groin_vault(mesh, side.inner + WALL, side.back, d0, d1)
    half = GALLERY / 2
    for s, w in ([(e, 0.15) for e in edges[1:-1]] +
                 [(-side.inner - WALL / 2, WALL / 2), (side.inner + WALL / 2, WALL / 2)]):
        with mesh.frame(turn("y", 90), (s, 0, (d0 + d1) / 2)):
            profile = [(half + 0.02, -w), (half - 0.1, -w), (half - 0.1, w), (half + 0.02, w)]
            mesh.arc("stone_trim", profile, 0.0, SPRING, 20, rise=VAULT_RISE / half)
    for s, w in ([(e, 0.15) for e in edges[1:-1]] +
                 [(-side.inner - WALL / 2, WALL / 2), (side.inner + WALL / 2, WALL / 2)]):
        mesh.box("stone_trim", (s - w, STEP, BACK), (s + w, SPRING, BACK + 0.1), "kbt")
        mesh.box("stone_trim", (s - w - 0.04, SPRING - 0.16, BACK), (s + w + 0.04, SPRING, BACK + 0.15), "k")
        mesh.box("stone_trim", (s - w - 0.04, STEP, BACK), (s + w + 0.04, STEP + 0.3, BACK + 0.15), "kb")


def ceiling(mesh, side):
    """Boards and beams over one side's upper gallery."""
    s = side.back if side.long else side.inner + UPPER_WALL
    mesh.quad("wood", (-s, CEILING, BACK), (s, CEILING, BACK), (s, CEILING, -UPPER_WALL), (-s, CEILING, -UPPER_WALL))
    pitch = side.upper[1] - side.upper[0]
    places = np.concatenate([side.upper, [side.inner + pitch, -side.inner - pitch]]) if side.long else side.upper[1:-1]
    for at in places:
        mesh.box("wood", (at - 0.09, CEILING - 0.2, BACK), (at + 0.09, CEILING, -UPPER_WALL), "tkf")
        mesh.box("wood", (at - 0.07, CEILING - 0.36, BACK), (at + 0.07, CEILING - 0.2, BACK + 0.4), "tk")


def outside(mesh, side):
    """Outer faces and the wall above the roof."""
    s, d = side.back + OUTER, BACK - OUTER
    mesh.quad("limestone", (s, -0.5, d), (-s, -0.5, d), (-s, SHELL_TOP, d), (s, SHELL_TOP, d))
    i = side.back
    mesh.quad("plaster", (-i, CEILING, BACK), (i, CEILING, BACK), (i, SHELL_TOP, BACK), (-i, SHELL_TOP, BACK))
    mesh.quad("stone_trim", (-i, SHELL_TOP, BACK), (i, SHELL_TOP, BACK), (s, SHELL_TOP, d), (-s, SHELL_TOP, d))


def back_walls(mesh, side):
    """Inner faces of the back walls; openings come from openings.py."""
    for storey, low, high in ((0, STEP, SLAB), (1, UPPER_FLOOR, CEILING)):
        with mesh.frame(offset=(0, 0, BACK)):
            wall_with_openings(mesh, "plaster", -side.back, side.back, low, high, openings(mesh, side, storey))


def build(mesh):
    floors(mesh)
    for side in SIDES:
        with side.frame(mesh):
            arcades(mesh, side)
            responds(mesh, side)
            vaults(mesh, side)
            ceiling(mesh, side)
            outside(mesh, side)
            back_walls(mesh, side)
