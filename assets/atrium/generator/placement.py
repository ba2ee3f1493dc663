"""Where the furnishings hang and stand."""
from .architecture import GROUND_FOOT, VAULT_RISE
from .furnishing import banner, bush, curtain, fountain, lantern, rod, tree
from .layout import EAST, GALLERY, NORTH, SOUTH, SPRING, STEP, UPPER_FLOOR, WALL, WEST

# Bay: colour and how it hangs. On the south side s runs towards -x, on the north side towards +x.
CURTAINS = {SOUTH: {0: ("teal", "closed"), 1: ("ochre", "left"), 2: ("red", "closed"), 4: ("teal", "pair"),
                    5: ("ochre", "closed"), 6: ("red", "left")},
            NORTH: {0: ("ochre", "closed"), 1: ("red", "pair"), 3: ("teal", "closed"), 5: ("ochre", "right"),
                    6: ("red", "closed")}}
TOP, BOTTOM = SPRING - 0.13, STEP + 0.1


def hang(mesh, side, bay, colour, how):
    """One bay's curtain or pair of curtains, between the columns."""
    s0, s1 = side.bays[bay] + GROUND_FOOT + 0.1, side.bays[bay + 1] - GROUND_FOOT - 0.1
    d, name, seed = -WALL / 2, "curtain_" + colour, bay + (10 if side is NORTH else 0)
    rod(mesh, s0 - 0.12, s1 + 0.12, TOP + 0.012, d)
    if how == "closed":
        curtain(mesh, name, s0, s1, TOP, BOTTOM, d, 8, 0.085, seed=seed)
    elif how == "pair":                                        # two leaves, each tied to its column
        middle = (s0 + s1) / 2
        curtain(mesh, name, s0, middle - 0.02, TOP, BOTTOM, d, 6, 0.07, (0.42, 0.08, 0.62), seed)
        curtain(mesh, name, middle + 0.02, s1, TOP, BOTTOM, d, 6, 0.07, (0.42, 0.92, 0.62), seed + 1)
    else:                                                      # pushed together on one side
        a, b = (s0, s0 + 1.25) if how == "left" else (s1 - 1.25, s1)
        curtain(mesh, name, a, b, TOP, BOTTOM, d, 7, 0.085, seed=seed)


def build(mesh):
    for side, bays in CURTAINS.items():
        with side.frame(mesh):
            for bay, (colour, how) in bays.items():
                hang(mesh, side, bay, colour, how)
    for side in (SOUTH, NORTH):
        with side.frame(mesh):
            for i in (1, 3, 5):
                lantern(mesh, (side.bays[i] + side.bays[i + 1]) / 2, SPRING + VAULT_RISE, -WALL - GALLERY / 2)
    for side, places in ((EAST, (-2.3, 2.3)),
                         (NORTH, (SIDE_COLUMNS[1], SIDE_COLUMNS[3], SIDE_COLUMNS[4], SIDE_COLUMNS[6])),
                         (WEST, (-5.0 / 3, 5.0 / 3))):
        with side.frame(mesh):
            for k, s in enumerate(places):
                banner(mesh, s, UPPER_FLOOR + 0.72, 3.5, 0.22, 0.78, 1.7 * k)
    fountain(mesh)
    for k, (x, z) in enumerate(((-10.9, 3.95), (10.75, 3.95), (-10.9, -3.95), (10.75, -3.95))):
        tree(mesh, x, z, seed=k)
    for k, (x, z) in enumerate(((-5.14, 4.25), (1.71, 4.25), (5.14, -4.25), (-1.71, -4.25), (10.95, 2.3),
                                (10.95, -2.3))):
        bush(mesh, x, z, seed=10 + k)


SIDE_COLUMNS = NORTH.bays
