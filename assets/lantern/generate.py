"""Writes lantern.obj and lantern.mtl: a lantern that is carried, in metres. python3 assets/lantern/generate.py

It stands at the origin, y up, and its ring is 0.36 m high. Its light is a lamp of the scene at (0, 0.185, 0), above the
flame, which is small and lights next to nothing.
"""
import math
import pathlib

IRON, WAX, FLAME = (0.05, 0.04, 0.03), (0.4, 0.36, 0.28), (9, 5.2, 1.9)  # Kd, Kd, Ke


def lathe(profile, segments, flat):
    """Faces of a body about the vertical through the origin: (radius, height) along its outline, outside to the left of
    the way down. Each face: corners and their normals."""
    faces = []
    for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
        length = math.hypot(r1 - r0, y1 - y0)
        out, up = (y1 - y0) / length, (r0 - r1) / length
        for i in range(segments):
            angles = [2 * math.pi * (i + k) / segments for k in (0, 1)]
            around = [(math.cos(a), math.sin(a)) for a in angles]
            middle = (math.cos(sum(angles) / 2), math.sin(sum(angles) / 2))
            turned = [middle, middle] if flat else around
            corners = [((r * c, y, -r * s), (out * nc, up, -out * ns))
                       for r, y, k in ((r0, y0, 0), (r0, y0, 1), (r1, y1, 1), (r1, y1, 0))
                       for (c, s), (nc, ns) in [(around[k], turned[k])]]
            faces.append([corner for n, corner in enumerate(corners) if corner[0] not in
                          [other[0] for other in corners[:n]]])
    return faces


def bar(ends, half):
    """Faces of a four-sided bar along a line."""
    (ax, ay, az), (bx, by, bz) = ends
    along = (bx - ax, by - ay, bz - az)
    side = (-along[2], 0.0, along[0]) if abs(along[0]) + abs(along[2]) > 1e-9 else (1.0, 0.0, 0.0)
    side = scaled(side, half / norm(side))
    other = cross(along, side)
    other = scaled(other, half / norm(other))
    faces = []
    for u, v in ((side, other), (other, scaled(side, -1)), (scaled(side, -1), scaled(other, -1)),
                 (scaled(other, -1), side)):
        low, high, normal = plus(u, scaled(v, -1)), plus(u, v), scaled(u, 1 / half)
        faces.append([(plus(p, q), normal) for p, q in ((ends[0], low), (ends[0], high), (ends[1], high),
                                                        (ends[1], low))])
    return faces


def plus(a, b):
    return tuple(x + y for x, y in zip(a, b))


def scaled(a, factor):
    return tuple(x * factor for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a):
    return math.hypot(*a)


def ring(centre, radius, thick, segments=24, sides=8):
    """Faces of a ring that stands across x."""
    def point(i, k):
        a, b = 2 * math.pi * i / segments, 2 * math.pi * k / sides
        normal = (math.cos(b) * math.cos(a), math.cos(b) * math.sin(a), math.sin(b))
        return plus(centre, plus((radius * math.cos(a), radius * math.sin(a), 0.0), scaled(normal, thick))), normal
    return [[point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1)]
            for i in range(segments) for k in range(sides)]


def parts():
    iron = lathe([(0, 0), (0.085, 0), (0.095, 0.008), (0.095, 0.02), (0.08, 0.028), (0, 0.028)], 6, True)
    iron += lathe([(0, 0.252), (0.07, 0.245), (0.105, 0.245), (0.105, 0.255), (0.045, 0.3), (0.02, 0.312),
                   (0.02, 0.33), (0, 0.332)], 6, True)
    for k in range(6):
        c, s = math.cos(math.pi * k / 3), math.sin(math.pi * k / 3)
        iron += bar(((0.078 * c, 0.026, -0.078 * s), (0.078 * c, 0.248, -0.078 * s)), 0.004)
    iron += ring((0, 0.352, 0), 0.026, 0.004)
    wax = lathe([(0.022, 0.028), (0.022, 0.06), (0.019, 0.063), (0, 0.061)], 20, False)
    flame = lathe([(0, 0.064), (0.006, 0.07), (0.01, 0.082), (0.008, 0.1), (0.004, 0.12), (0, 0.135)], 12, False)
    return [("iron", iron), ("wax", wax), ("flame", flame)]


def number(value):
    return f"{round(value, 5) + 0.0:.5f}".rstrip("0").rstrip(".")


def obj_text():
    lines = ["# A lantern. Metres, y up. Made by generate.py.", "mtllib lantern.mtl", "", "o lantern"]
    count = 0
    for material, faces in parts():
        lines.append(f"usemtl lantern_{material}")
        for face in faces:
            for position, normal in face:
                lines.append("v " + " ".join(map(number, position)))
                lines.append("vn " + " ".join(map(number, normal)))
            lines.append("f " + " ".join(f"{count + i + 1}//{count + i + 1}" for i in range(len(face))))
            count += len(face)
    return "\n".join(lines) + "\n"


def mtl_text():
    lines = ["# Linear RGB. Made by generate.py."]
    for name, diffuse, emission in (("iron", IRON, None), ("wax", WAX, None), ("flame", (0, 0, 0), FLAME)):
        lines += ["", f"newmtl lantern_{name}", "Kd " + " ".join(map(str, diffuse)), "Ks 0 0 0"]
        lines += ["Ke " + " ".join(map(str, emission))] if emission else []
        lines.append("illum 1")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    folder = pathlib.Path(__file__).resolve().parent
    (folder / "lantern.obj").write_text(obj_text(), encoding="ascii")
    (folder / "lantern.mtl").write_text(mtl_text(), encoding="ascii")
