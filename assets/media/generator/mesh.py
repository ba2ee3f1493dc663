"""Meshes of the media scenes: solids (closed, outward), sheets, normals by crease angle, OBJ and MTL. Millimetres, y
up."""
import math


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def mul(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return mul(a, 1.0 / length) if length > 0.0 else (0.0, 0.0, 0.0)


def rotation(axis, degrees):
    """3x3 matrix, rows."""
    x, y, z = unit(axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    t = 1.0 - c
    return ((t * x * x + c, t * x * y - s * z, t * x * z + s * y),
            (t * x * y + s * z, t * y * y + c, t * y * z - s * x),
            (t * x * z - s * y, t * y * z + s * x, t * z * z + c))


def rotation_between(a, b):
    """Turns the unit vector a into b."""
    axis = cross(a, b)
    if dot(axis, axis) < 1e-18:
        return rotation((1, 0, 0), 0.0 if dot(a, b) > 0.0 else 180.0)
    return rotation(axis, math.degrees(math.atan2(math.sqrt(dot(axis, axis)), dot(a, b))))


def turn(m, p):
    return (dot(m[0], p), dot(m[1], p), dot(m[2], p))


class Part:
    """Points and polygons of one material. `crease`: edges sharper than this many degrees stay hard; 0: flat."""

    def __init__(self, name, material, points, faces, crease=35.0, closed=True):
        self.name, self.material, self.points, self.faces = (
            name, material, [tuple(p) for p in points], [list(f) for f in faces])
        self.crease, self.closed = crease, closed
        if closed:
            if self.volume() < 0.0:
                self.faces = [f[::-1] for f in self.faces]
            self.check()

    def placed(self, matrix=None, offset=(0.0, 0.0, 0.0)):
        if matrix:
            self.points = [turn(matrix, p) for p in self.points]
        self.points = [add(p, offset) for p in self.points]
        return self

    def low(self):
        return min(p[1] for p in self.points)

    def triangles(self):
        return [(f[0], f[i], f[i + 1]) for f in self.faces for i in range(1, len(f) - 1)]

    def volume(self):
        return sum(dot(self.points[a], cross(self.points[b], self.points[c])) for a, b, c in self.triangles()) / 6.0

    def check(self):
        """Every edge once each way, and something inside."""
        edges = {}
        for f in self.faces:
            for a, b in zip(f, f[1:] + f[:1]):
                if (a, b) in edges or a == b:
                    raise ValueError(f"{self.name}: edge {a}-{b} stands twice the same way")
                edges[a, b] = True
        for a, b in edges:
            if (b, a) not in edges:
                raise ValueError(f"{self.name}: edge {a}-{b} is open")
        if not self.volume() > 0.0:
            raise ValueError(f"{self.name}: no volume")

    def face_normal(self, f):
        """Newell's, twice the area long."""
        n = (0.0, 0.0, 0.0)
        for a, b in zip(f, f[1:] + f[:1]):
            n = add(n, cross(self.points[a], self.points[b]))
        return n

    def normals(self):
        """A normal for each corner of each face."""
        full = [self.face_normal(f) for f in self.faces]
        flat = [unit(n) for n in full]
        around = {}
        for i, f in enumerate(self.faces):
            for a in f:
                around.setdefault(a, []).append(i)
        limit = math.cos(math.radians(self.crease))
        result = []
        for i, f in enumerate(self.faces):
            corners = []
            for a in f:
                n = (0.0, 0.0, 0.0)
                for j in around[a]:
                    if j == i or (self.crease > 0.0 and dot(flat[i], flat[j]) >= limit):
                        n = add(n, full[j])
                corners.append(unit(n))
            result.append(corners)
        return result


def rounded(corners, step, turn_step=18.0):
    """A polyline of (x, y) or (x, y, radius) with its corners rounded, no piece longer than `step` nor an arc's
    turning more than `turn_step` degrees."""
    corners = [(c[0], c[1], c[2] if len(c) > 2 else 0.0) for c in corners]
    points = [corners[0][:2]]

    def line_to(x, y):
        x0, y0 = points[-1]
        length = math.hypot(x - x0, y - y0)
        count = max(1, math.ceil(length / step - 1e-9))
        if length > 1e-6:
            points.extend((x0 + (x - x0) * i / count, y0 + (y - y0) * i / count) for i in range(1, count + 1))

    for (x0, y0, _), (x1, y1, r), (x2, y2, _) in zip(corners, corners[1:], corners[2:]):
        ax, ay, bx, by = x0 - x1, y0 - y1, x2 - x1, y2 - y1
        la, lb = math.hypot(ax, ay), math.hypot(bx, by)
        ax, ay, bx, by = ax / la, ay / la, bx / lb, by / lb
        angle = math.acos(max(-1.0, min(1.0, ax * bx + ay * by)))
        if r <= 0.0 or angle > math.pi - 1e-3:
            line_to(x1, y1)
            continue
        cut = min(r / math.tan(0.5 * angle), 0.49 * la, 0.49 * lb)
        r = cut * math.tan(0.5 * angle)
        mx, my = ax + bx, ay + by
        lm = math.hypot(mx, my)
        cx, cy = x1 + mx / lm * r / math.sin(0.5 * angle), y1 + my / lm * r / math.sin(0.5 * angle)
        line_to(x1 + ax * cut, y1 + ay * cut)
        start = math.atan2(y1 + ay * cut - cy, x1 + ax * cut - cx)
        end = math.atan2(y1 + by * cut - cy, x1 + bx * cut - cx)
        sweep = (end - start + math.pi) % (2.0 * math.pi) - math.pi
        count = max(1, math.ceil(abs(sweep) * r / step), math.ceil(abs(math.degrees(sweep)) / turn_step))
        points.extend((cx + r * math.cos(start + sweep * i / count), cy + r * math.sin(start + sweep * i / count))
                      for i in range(1, count + 1))
    line_to(*corners[-1][:2])
    return points


def lathe_mesh(profile, segments):
    """Points and faces of a profile of (radius, y) turned about the y axis; ends on the axis become one point."""
    points, rows = [], []
    for r, y in profile:
        if r < 1e-9:
            rows.append([len(points)] * segments)
            points.append((0.0, y, 0.0))
        else:
            rows.append(list(range(len(points), len(points) + segments)))
            points.extend((r * math.cos(2 * math.pi * k / segments), y, -r * math.sin(2 * math.pi * k / segments))
                          for k in range(segments))
    faces = []
    for a, b in zip(rows, rows[1:]):
        for k in range(segments):
            n = (k + 1) % segments
            corners = [a[k], a[n], b[n], b[k]]
            faces.append([c for i, c in enumerate(corners) if c != corners[i - 1]])
    return points, faces, rows


def lathe(name, material, profile, segments, crease=35.0):
    points, faces, _ = lathe_mesh(profile, segments)
    return Part(name, material, points, faces, crease)


def convex(name, material, planes):
    """The polyhedron within planes (normal, distance from the origin): each in turn cuts what is left of a large cube.
    Flat facets."""
    s = 1e3
    polygons = []
    for axis in range(3):
        for sign in (1, -1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            polygon = []
            for du, dv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = [0.0] * 3
                p[axis], p[u], p[v] = sign * s, du * s, dv * s
                polygon.append(tuple(p))
            polygons.append(polygon if sign > 0 else polygon[::-1])
    for normal, distance in planes:
        n = unit(normal)
        kept, cut = [], []
        for polygon in polygons:
            out = []
            for a, b in zip(polygon, polygon[1:] + polygon[:1]):
                da, db = dot(a, n) - distance, dot(b, n) - distance
                if da <= 1e-7:
                    out.append(a)
                if (da < -1e-7 and db > 1e-7) or (da > 1e-7 and db < -1e-7):
                    out.append(add(a, mul(sub(b, a), da / (da - db))))
                    cut.append(out[-1])
                elif abs(da) <= 1e-7:
                    cut.append(a)
            if len(out) > 2:
                kept.append(out)
        if cut:
            centre = mul((sum(p[0] for p in cut), sum(p[1] for p in cut), sum(p[2] for p in cut)), 1.0 / len(cut))
            u = unit(cross(n, (0.0, 1.0, 0.0) if abs(n[1]) < 0.9 else (1.0, 0.0, 0.0)))
            v = cross(n, u)
            ring = sorted(cut, key=lambda p: math.atan2(dot(sub(p, centre), v), dot(sub(p, centre), u)))
            face = []
            for p in ring:
                if not face or math.dist(p, face[-1]) > 1e-5:
                    face.append(p)
            if len(face) > 1 and math.dist(face[0], face[-1]) < 1e-5:
                face.pop()
            if len(face) > 2 and not any(all(abs(dot(p, n) - distance) < 1e-6 for p in polygon) for polygon in kept):
                kept.append(face)
        polygons = kept
    points, index, faces = [], {}, []

    def number(p):
        key = tuple(round(c, 4) for c in p)
        for dx in (-1e-4, 0.0, 1e-4):  # a neighbour across the rounding's border
            for dy in (-1e-4, 0.0, 1e-4):
                for dz in (-1e-4, 0.0, 1e-4):
                    k = (round(key[0] + dx, 4), round(key[1] + dy, 4), round(key[2] + dz, 4))
                    if k in index:
                        return index[k]
        index[key] = len(points)
        points.append(p)
        return index[key]

    for polygon in polygons:
        face = []
        for p in polygon:
            i = number(p)
            if not face or face[-1] != i:
                face.append(i)
        if len(face) > 1 and face[0] == face[-1]:
            face.pop()
        if len(face) > 2:
            faces.append(face)
    return Part(name, material, points, faces, crease=0.0)


def rounded_box(name, material, half, radius, arc=4, inner=1, shape=None):
    """A box with rounded edges about the origin, `half` its half sizes; `inner` pieces a side between the roundings;
    `shape` moves its points."""
    steps = [math.tan(math.radians(45.0 * i / arc)) for i in range(arc + 1)]

    def coordinates(h):
        flat = h - radius
        side = [flat + radius * t for t in steps]
        middle = [flat * (2.0 * i / inner - 1.0) for i in range(1, inner)]
        return [-c for c in side[::-1]] + middle + side

    axes = [coordinates(h) for h in half]
    points, index, faces = [], {}, []

    def corner(ijk):
        if ijk not in index:
            p = tuple(axes[a][ijk[a]] for a in range(3))
            core = tuple(max(-(half[a] - radius), min(half[a] - radius, p[a])) for a in range(3))
            q = add(core, mul(unit(sub(p, core)), radius))
            index[ijk] = len(points)
            points.append(shape(q) if shape else q)
        return index[ijk]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for last in (0, 1):
            for i in range(len(axes[u]) - 1):
                for j in range(len(axes[v]) - 1):
                    face = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        ijk = [0] * 3
                        ijk[axis] = len(axes[axis]) - 1 if last else 0
                        ijk[u], ijk[v] = i + di, j + dj
                        face.append(corner(tuple(ijk)))
                    faces.append(face if last else face[::-1])
    return Part(name, material, points, faces)


def box(name, material, low, high, bevel=0.0):
    centre = mul(add(low, high), 0.5)
    half = mul(sub(high, low), 0.5)
    if bevel > 0.0:
        return rounded_box(name, material, half, bevel, arc=2).placed(offset=centre)
    corners = [tuple((high if bits >> a & 1 else low)[a] for a in range(3)) for bits in range(8)]
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return Part(name, material, corners, faces, crease=0.0)


def sphere(name, material, centre, radius, level=2):
    """A subdivided octahedron: 8 * 4^level triangles."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    for _ in range(level):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(unit(mul(add(points[a], points[b]), 0.5)))
            return middles[key]

        faces = [t for a, b, c in faces for m, n, o in [(middle(a, b), middle(b, c), middle(c, a))]
                 for t in ([a, m, o], [m, b, n], [o, n, c], [m, n, o])]
    return Part(name, material, [add(centre, mul(p, radius)) for p in points], faces, crease=180.0)


def quad(name, material, a, b, c, d):
    """A sheet facing where a, b, c, d run anticlockwise."""
    return Part(name, material, [a, b, c, d], [[0, 1, 2, 3]], crease=0.0, closed=False)


def softbox(name, centre, target, width, height, material="light"):
    """A lamp's face of that size that looks at `target`."""
    n = unit(sub(target, centre))
    u = unit(cross((0.0, 1.0, 0.0) if abs(n[1]) < 0.95 else (0.0, 0.0, 1.0), n))
    v = cross(n, u)
    u, v = mul(u, 0.5 * width), mul(v, 0.5 * height)
    return quad(name, material,
                *(add(centre, add(mul(u, i), mul(v, j))) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))))


def backdrop(name, material, half_width, front, back, height, radius, segments=12):
    """A studio sweep: floor at y = 0 from z = front to z = back, bent up into a wall."""
    profile = rounded([(front, 0.0), (back, 0.0, radius), (back, height)], 1e9, 90.0 / segments)
    points = [(x, y, z) for z, y in profile for x in (-half_width, half_width)]
    faces = [[2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2] for i in range(len(profile) - 1)]
    return Part(name, material, points, faces, crease=60.0, closed=False)


def write(folder, stem, parts, materials, comment):
    """`materials`: name to a dictionary of MTL keys. Returns the number of triangles."""
    def text(values):
        return " ".join((f"{v:.4f}".rstrip("0").rstrip(".") if abs(v) >= 5e-5 else "0") for v in values)

    lines = [f"# {comment} Millimetres, y up. MIT licence. Made by assets/media/generate.py.", f"mtllib {stem}.mtl"]
    first, normal_index, triangles = 1, {}, 0
    for part in parts:
        lines += [f"o {part.name}", f"usemtl {part.material}"]
        lines += ["v " + text(p) for p in part.points]
        faces = []
        for f, corners in zip(part.faces, part.normals()):
            pieces = []
            for a, n in zip(f, corners):
                key = text(n)
                if key not in normal_index:
                    normal_index[key] = len(normal_index) + 1
                    lines.append("vn " + key)
                pieces.append(f"{a + first}//{normal_index[key]}")
            # Larger facets as a fan, so that every reader cuts them alike.
            polygons = ([pieces] if len(pieces) <= 4 else
                        [[pieces[0], pieces[i], pieces[i + 1]] for i in range(1, len(pieces) - 1)])
            faces += ["f " + " ".join(p) for p in polygons]
            triangles += len(f) - 2
        lines += faces
        first += len(part.points)
    (folder / f"{stem}.obj").write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
    lines = [f"# {comment} Linear colours. MIT licence. Made by assets/media/generate.py."]
    for name, keys in materials.items():
        lines += ["", f"newmtl {name}"] + [f"{k} {text(v) if isinstance(v, (tuple, list)) else text([v])}"
                                           for k, v in keys.items()]
    (folder / f"{stem}.mtl").write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
    return triangles
