"""Writes cornell.obj and cornell.mtl: the Cornell box as measured, in metres. python3 assets/cornell/generate.py

The coordinates and colours are facts published by the Cornell Program of Computer Graphics (see README.md); they are
given here in millimetres. The room's faces point inwards, the blocks are closed and their faces point outwards.
"""
import pathlib

COLOURS = {  # Kd, Ke
    "white": ((0.725, 0.71, 0.68), None),
    "red": ((0.63, 0.065, 0.05), None),
    "green": ((0.14, 0.45, 0.091), None),
    "light": ((0.78, 0.78, 0.78), (17, 12, 4)),
}

# Name, material, corners anticlockwise as seen from inside. The opening towards the camera is at z = 0.
ROOM = [
    ("floor", "white", [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]),
    ("ceiling", "white", [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]),
    ("back", "white", [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]),
    ("right_green", "green", [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]),
    ("left_red", "red", [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]),
    # The light fills a hole of the ceiling; here it hangs half a millimetre below, so that the ceiling stays one quad.
    ("light", "light", [(343, 548.3, 227), (343, 548.3, 332), (213, 548.3, 332), (213, 548.3, 227)]),
]

# Name, height, corners (x, z) of the top, clockwise as drawn with x to the right and z up.
BLOCKS = [
    ("short_block", 165, [(130, 65), (82, 225), (240, 272), (290, 114)]),
    ("tall_block", 330, [(423, 247), (265, 296), (314, 456), (472, 406)]),
]


def room_faces(corners):
    """Vertices and faces of one quad."""
    return list(corners), [range(len(corners))]


def block_faces(height, outline):
    """Vertices and faces of a closed block: bottom ring first, then the top ring."""
    count = len(outline)
    vertices = [(x, y, z) for y in (0, height) for x, z in outline]
    top = range(count, 2 * count)
    bottom = range(count - 1, -1, -1)
    sides = [((i + 1) % count, (i + 1) % count + count, i + count, i) for i in range(count)]
    return vertices, [top, bottom, *sides]


def number(value):
    """A number of millimetres in metres, without needless zeros."""
    return f"{value / 1000:.4f}".rstrip("0").rstrip(".")


def obj_text():
    lines = ["# The Cornell box as measured at the Cornell Program of Computer Graphics. "
             "Metres, y up. Made by generate.py.",
             "mtllib cornell.mtl"]
    parts = [(name, material, *room_faces(corners)) for name, material, corners in ROOM]
    parts += [(name, "white", *block_faces(height, outline)) for name, height, outline in BLOCKS]
    first = 1
    for name, material, vertices, faces in parts:
        lines += ["", f"o {name}", f"usemtl {material}"]
        lines += ["v " + " ".join(number(c) for c in vertex) for vertex in vertices]
        lines += ["f " + " ".join(str(first + i) for i in face) for face in faces]
        first += len(vertices)
    return "\n".join(lines) + "\n"


def mtl_text():
    lines = ["# Linear RGB of the measured paints and of the light. Made by generate.py."]
    for name, (diffuse, emission) in COLOURS.items():
        lines += ["", f"newmtl {name}", "Kd " + " ".join(map(str, diffuse)), "Ks 0 0 0"]
        if emission:
            lines.append("Ke " + " ".join(map(str, emission)))
        lines.append("illum 1")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    folder = pathlib.Path(__file__).resolve().parent
    (folder / "cornell.obj").write_text(obj_text(), encoding="ascii")
    (folder / "cornell.mtl").write_text(mtl_text(), encoding="ascii")
