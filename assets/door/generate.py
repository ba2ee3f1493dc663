"""Writes door.obj and door.mtl: a dark room with a door to a sunlit court, in metres. python3 assets/door/generate.py

The room has its floor at y = 0 and its door in the wall towards -z. Walls are boxes that overlap beyond the corners,
and the leaf lies in a rebate on all four sides: closed, it lets no light in.
"""
import math
import pathlib

COLOURS = {  # Kd
    "plaster": (0.74, 0.7, 0.64),
    "boards": (0.36, 0.24, 0.15),
    "stone": (0.5, 0.47, 0.42),
    "brick": (0.55, 0.27, 0.17),
    "paint": (0.12, 0.3, 0.26),
    "iron": (0.12, 0.12, 0.13),
    "rug": (0.52, 0.07, 0.06),
    "border": (0.6, 0.47, 0.24),
    "wood": (0.42, 0.22, 0.1),
    "glaze": (0.1, 0.24, 0.5),
    "wax": (0.85, 0.8, 0.68),
    "ball": (0.8, 0.8, 0.8),
    "book_1": (0.45, 0.1, 0.08),
    "book_2": (0.1, 0.2, 0.38),
    "book_3": (0.16, 0.3, 0.13),
    "book_4": (0.62, 0.5, 0.26),
}
FLAME = (6, 3.4, 1.2)  # Ke; the candle's light is a lamp above it, since a flame this small is hard to hit by chance

# The room's inside, and its door: the opening, the rebate around it, the leaf.
WIDE, HIGH, DEEP, THICK = 4.0, 2.7, 5.0, 0.3
LEFT, RIGHT, TOP, SILL = -0.55, 0.45, 2.1, 0.02
REBATE, LEAF, GAP = 0.04, 0.045, 0.002
INNER, OUTER = -DEEP / 2, -DEEP / 2 - THICK  # z of the faces of the door's wall
HINGE = (LEFT - REBATE, OUTER)


class Model:
    """Objects of quads and triangles; smooth ones have a normal at each vertex."""

    def __init__(self):
        self.lines = []
        self.vertices = self.normals = 0

    def begin(self, name):
        self.lines += ["", f"o {name}"]

    def faces(self, material, vertices, faces, normals=None):
        self.lines.append(f"usemtl {material}")
        self.lines += ["v " + " ".join(number(c) for c in v) for v in vertices]
        self.lines += ["vn " + " ".join(number(c) for c in n) for n in normals or []]
        for face in faces:
            corner = (lambda i: f"{self.vertices + i + 1}//{self.normals + i + 1}") if normals else (
                lambda i: f"{self.vertices + i + 1}")
            self.lines.append("f " + " ".join(corner(i) for i in face))
        self.vertices += len(vertices)
        self.normals += len(normals or [])

    def box(self, material, low, high):
        """A closed box, its faces outwards."""
        x, y, z = zip(low, high)
        corners = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
        self.faces(material, corners, [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1),
                                       (4, 5, 7, 6)])

    def turned(self, material, centre, profile, segments=40):
        """A smooth body about the vertical through `centre`: (radius, height) from the bottom to the top; a corner is a
        point that is given twice."""
        vertices, normals, faces = [], [], []
        rings = len(profile)
        for k, (r, y) in enumerate(profile):
            before, after = profile[max(k - 1, 0)], profile[min(k + 1, rings - 1)]
            if (r, y) == before and k:
                before = (r, y)
            if (r, y) == after and k + 1 < rings:
                after = (r, y)
            dr, dy = after[0] - before[0], after[1] - before[1]
            length = math.hypot(dr, dy) or 1.0
            for i in range(segments):
                c, s = math.cos(2 * math.pi * i / segments), math.sin(2 * math.pi * i / segments)
                vertices.append((centre[0] + r * c, centre[1] + y, centre[2] - r * s))
                normals.append((dy / length * c, -dr / length, -dy / length * s))
        for k in range(rings - 1):
            if profile[k] == profile[k + 1]:
                continue
            for i in range(segments):
                j = (i + 1) % segments
                a, b, c, d = k * segments + i, k * segments + j, (k + 1) * segments + j, (k + 1) * segments + i
                face = [a, b, c, d]
                if profile[k][0] == 0:
                    face = [a, c, d]
                if profile[k + 1][0] == 0:
                    face = [a, b, d]
                faces.append(face)
        self.faces(material, vertices, faces, normals)


def number(value):
    return f"{round(value, 4) + 0.0:.4f}".rstrip("0").rstrip(".")


def room(model):
    x, z = WIDE / 2, DEEP / 2
    model.begin("floor")
    model.box("boards", (-x - THICK, -0.3, INNER), (x + THICK, 0, z + THICK))
    model.begin("ceiling")
    model.box("plaster", (-x - THICK, HIGH, OUTER), (x + THICK, HIGH + 0.3, z + THICK))
    model.begin("walls")
    model.box("plaster", (-x - THICK, -0.3, OUTER), (-x, HIGH + 0.1, z + THICK))
    model.box("plaster", (x, -0.3, OUTER), (x + THICK, HIGH + 0.1, z + THICK))
    model.box("plaster", (-x - 0.1, -0.3, z), (x + 0.1, HIGH + 0.1, z + THICK))
    # The wall of the door: in the depth of the leaf its opening is wider, by the rebate.
    stop = OUTER + LEAF + GAP
    for front, back, margin in ((OUTER, stop, REBATE + GAP), (stop, INNER, 0.0)):
        left, right, top, sill = LEFT - margin, RIGHT + margin, TOP + margin, SILL - margin
        model.box("plaster", (-x - 0.1, -0.3, front), (left, HIGH + 0.1, back))
        model.box("plaster", (right, -0.3, front), (x + 0.1, HIGH + 0.1, back))
        model.box("plaster", (left, top, front), (right, HIGH + 0.1, back))
        model.box("stone", (left, -0.3, front), (right, sill, back))
    model.begin("skirting")
    h, d = 0.09, 0.015
    model.box("wood", (-x, 0, -z), (-x + d, h, z))
    model.box("wood", (x - d, 0, -z), (x, h, z))
    model.box("wood", (-x + d, 0, -z), (LEFT - 0.08, h, -z + d))
    model.box("wood", (RIGHT + 0.08, 0, -z), (x - d, h, -z + d))
    model.box("wood", (-x + d, 0, z - d), (x - d, h, z))
    model.begin("frame")
    for left, right, low, high in ((LEFT - 0.08, LEFT, 0, TOP + 0.08), (RIGHT, RIGHT + 0.08, 0, TOP + 0.08),
                                   (LEFT, RIGHT, TOP, TOP + 0.08)):
        model.box("wood", (left, low, -z), (right, high, -z + 0.025))


def door(model):
    """The leaf, closed: a board with four raised panels on each side, a handle and its plates."""
    model.begin("door")
    left, right, low, high = LEFT - REBATE, RIGHT + REBATE, SILL - REBATE, TOP + REBATE
    front, back = OUTER, OUTER + LEAF
    model.box("paint", (left, low, front + 0.008), (right, high, back - 0.008))
    # Stiles and rails, on both sides 8 mm thick.
    middle, across = (left + right) / 2, (0.0, 0.24, 0.98, 1.14, high - low - 0.14, high - low)
    for z0, z1 in ((front, front + 0.008), (back - 0.008, back)):
        for x0, x1 in ((left, left + 0.13), (middle - 0.055, middle + 0.055), (right - 0.13, right)):
            model.box("paint", (x0, low, z0), (x1, high, z1))
        for y0, y1 in zip(across[::2], across[1::2]):
            for x0, x1 in ((left + 0.13, middle - 0.055), (middle + 0.055, right - 0.13)):
                model.box("paint", (x0, low + y0, z0), (x1, low + y1, z1))
    model.begin("handle")
    x, y = right - 0.075, 1.05
    for side, face in ((-1, front), (1, back)):
        plate, bar = sorted((face, face + side * 0.004)), sorted((face + side * 0.04, face + side * 0.054))
        neck = sorted((face, face + side * 0.05))
        model.box("iron", (x - 0.02, y - 0.1, plate[0]), (x + 0.02, y + 0.1, plate[1]))
        model.box("iron", (x - 0.008, y + 0.02, neck[0]), (x + 0.008, y + 0.036, neck[1]))
        model.box("iron", (x - 0.12, y + 0.02, bar[0]), (x + 0.008, y + 0.036, bar[1]))


def things(model):
    model.begin("rug")
    model.box("border", (-1.15, 0, -1.35), (0.75, 0.008, 1.25))
    model.box("rug", (-1.03, 0.001, -1.23), (0.63, 0.012, 1.13))
    # A table with a vase, a ball and a candle.
    model.begin("table")
    x0, x1, z0, z1, top = 1.05, 1.8, -1.7, -0.5, 0.74
    model.box("wood", (x0, top - 0.03, z0), (x1, top, z1))
    for x in (x0 + 0.05, x1 - 0.11):
        for z in (z0 + 0.05, z1 - 0.11):
            model.box("wood", (x, 0, z), (x + 0.06, top - 0.03, z + 0.06))
    for z in (z0 + 0.065, z1 - 0.095):
        model.box("wood", (x0 + 0.11, top - 0.12, z), (x1 - 0.11, top - 0.03, z + 0.03))
    for x in (x0 + 0.065, x1 - 0.095):
        model.box("wood", (x, top - 0.12, z0 + 0.11), (x + 0.03, top - 0.03, z1 - 0.11))
    model.begin("vase")
    shape = [(0.055, 0), (0.075, 0.03), (0.105, 0.09), (0.112, 0.14), (0.1, 0.2), (0.068, 0.26), (0.045, 0.3),
             (0.045, 0.33), (0.06, 0.36), (0.066, 0.366), (0.054, 0.358), (0.036, 0.33), (0.036, 0.3), (0, 0.28)]
    model.turned("glaze", (1.5, top, -1.35), [(0, 0), (0.055, 0), *shape])
    model.begin("candle")
    model.turned("iron", (1.35, top, -0.75), [(0, 0), (0.07, 0), (0.07, 0), (0.078, 0.012), (0.07, 0.012), (0, 0.008)])
    model.turned("wax", (1.35, top, -0.75), [(0.022, 0.006), (0.022, 0.15), (0.022, 0.15), (0, 0.147)], 24)
    flame = [(0, 0), (0.003, 0.004), (0.005, 0.011), (0.004, 0.02), (0.002, 0.03), (0, 0.038)]
    model.turned("flame", (1.35, top + 0.152, -0.75), flame, 12)
    model.begin("ball")
    radius, steps = 0.16, 24
    arc = [math.pi * k / steps for k in range(steps + 1)]
    model.turned("ball", (-1.45, radius, -1.55),
                 [(radius * math.sin(a) if 0 < k < steps else 0, -radius * math.cos(a)) for k, a in enumerate(arc)], 48)
    # A shelf with books on the wall to the left.
    model.begin("shelf")
    z0, z1, depth = -0.9, 0.9, 0.26
    x0, x1 = -WIDE / 2, -WIDE / 2 + depth
    for z in (z0, z1 - 0.03):
        model.box("wood", (x0, 0, z), (x1, 1.83, z + 0.03))
    boards = (0.09, 0.52, 0.95, 1.38, 1.8)
    for y in boards:
        model.box("wood", (x0, y, z0 + 0.03), (x1 - 0.005, y + 0.03, z1 - 0.03))
    model.begin("books")
    state = 7
    for y in boards[:-1]:
        z = z0 + 0.04
        while True:
            state = state * 1103515245 + 12345 & 0x7fffffff
            thick, high, back = 0.02 + (state >> 8) % 31 / 1000, 0.2 + (state >> 13) % 130 / 1000, (state >> 20) % 5
            if z + thick > z1 - 0.06 - 0.4 * ((state >> 16) % 2):
                break
            if back:
                model.box(f"book_{back}", (x0 + 0.02, y + 0.03, z),
                          (x0 + 0.13 + 0.3 * high, y + 0.03 + high, z + thick))
            z += thick + 0.002


def outside(model):
    model.begin("court")
    model.box("stone", (-7, -0.5, -9), (7, -0.05, OUTER - 0.001))
    model.begin("step")
    model.box("stone", (LEFT - 0.4, -0.06, OUTER - 0.5), (RIGHT + 0.4, SILL - REBATE - GAP, OUTER + 0.01))
    model.begin("garden_wall")
    model.box("brick", (-7, -0.1, -9), (7, 2.2, -8.6))
    model.box("stone", (-7, 2.2, -9.05), (7, 2.28, -8.55))


def obj_text():
    model = Model()
    for part in (room, door, things, outside):
        part(model)
    head = ["# A dark room with a door to a sunlit court. Metres, y up. Made by generate.py.", "mtllib door.mtl"]
    return "\n".join(head + model.lines) + "\n"


def mtl_text():
    lines = ["# Albedos, linear RGB. Made by generate.py."]
    for name, diffuse in COLOURS.items():
        lines += ["", f"newmtl {name}", "Kd " + " ".join(map(str, diffuse)), "Ks 0 0 0", "illum 1"]
    lines += ["", "newmtl flame", "Kd 0 0 0", "Ks 0 0 0", "Ke " + " ".join(map(str, FLAME)), "illum 1"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    folder = pathlib.Path(__file__).resolve().parent
    (folder / "door.obj").write_text(obj_text(), encoding="ascii")
    (folder / "door.mtl").write_text(mtl_text(), encoding="ascii")
