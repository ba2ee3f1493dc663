"""The plan of the court. World: x along the court, y up, z across; metres; floor at y = 0; the origin in its middle.

From the court outwards: the arcade walls (court face at |x| = 12, |z| = 5), galleries, back walls, outside.
"""
import numpy as np

COURT_X, COURT_Z = 12.0, 5.0      # half the clear court
WALL = 0.6                        # thickness of the ground arcade
UPPER_WALL = 0.46                 # thickness of the upper arcade, its court face as below
GALLERY = 3.4                     # clear depth of the galleries
BACK_X, BACK_Z = COURT_X + WALL + GALLERY, COURT_Z + WALL + GALLERY   # inner faces of the back walls: 16, 9
OUTER = 2.2                       # thickness of the back walls: two LPV cells, so that the sun outside does not leak in
UPPER_FLOOR = 5.0
SLAB = 4.7                        # underside of the upper floor
UPPER_TOP = 9.5                   # top of the upper arcade
CEILING = 9.3                     # underside of the upper ceiling boards
EAVE_Y, EAVE_OUT = 9.78, 0.62     # lower edge of the roof: height, reach into the court
ROOF_SLOPE = 0.34
SHELL_TOP = 12.0                  # outside walls end above the roof

STEP = 0.14                       # the galleries' floor above the court's
STEP_OUT = 0.12                   # its edge's reach into the court

SPRING = 3.0                      # ground arches spring here
UPPER_SPRING = 8.1


class Side:
    """One side of the court: its frame (s along, y up, d towards the court, d = 0 at the court face) and its bays."""

    def __init__(self, name, normal, inner, bays, upper):
        n = np.array(normal, float)
        self.name = name
        self.linear = np.stack([[n[2], 0.0, -n[0]], [0.0, 1.0, 0.0], n], axis=1)
        self.offset = -n * (COURT_X if normal[0] else COURT_Z)
        self.inner = inner                    # half the clear court along s
        self.back = inner + WALL + GALLERY    # half the back wall along s
        self.long = inner == COURT_X
        self.bays = np.asarray(bays)          # edges of the ground bays along s: the columns' centres, the corners
        self.upper = np.linspace(-inner, inner, upper + 1)

    def frame(self, mesh):
        return mesh.frame(self.linear, self.offset)


PORTAL_HALF = 2.3                 # centre of the portal's piers
SOUTH = Side("south", (0, 0, -1), COURT_X, np.linspace(-COURT_X, COURT_X, 8), 14)   # at +z, in the sun
NORTH = Side("north", (0, 0, 1), COURT_X, np.linspace(-COURT_X, COURT_X, 8), 14)    # at -z, in the shade
EAST = Side("east", (-1, 0, 0), COURT_Z, [-COURT_Z, -PORTAL_HALF, PORTAL_HALF, COURT_Z], 7)   # at +x, with the portal
WEST = Side("west", (1, 0, 0), COURT_Z, np.linspace(-COURT_Z, COURT_Z, 4), 6)       # at -x
SIDES = [SOUTH, NORTH, EAST, WEST]
