"""A smoke cloud: a density of our own on a grid (gradient noise [Perlin2002] over some soft balls), and a closed
surface round it for the original, which knows homogeneous media only."""
import math
import random

from .mesh import Part, add, mul, sub


class Noise:
    """Gradient noise, period 256, about -1..1."""

    def __init__(self, seed):
        rng = random.Random(seed)
        self.p = list(range(256))
        rng.shuffle(self.p)
        self.p += self.p

    def at(self, x, y, z):
        p = self.p
        xi, yi, zi = math.floor(x), math.floor(y), math.floor(z)
        x, y, z = x - xi, y - yi, z - zi
        xi, yi, zi = xi & 255, yi & 255, zi & 255
        u, v, w = (t * t * t * (t * (t * 6 - 15) + 10) for t in (x, y, z))
        result = 0.0
        for dx, wx in ((0, 1 - u), (1, u)):
            for dy, wy in ((0, 1 - v), (1, v)):
                row = p[p[xi + dx] + yi + dy] + zi
                for dz, wz in ((0, 1 - w), (1, w)):
                    h = p[row + dz] & 15
                    a, b, c = x - dx, y - dy, z - dz
                    g = (a if h < 8 else b), (b if h < 4 else (a if h in (12, 14) else c))
                    result += wx * wy * wz * ((g[0] if h & 1 == 0 else -g[0]) + (g[1] if h & 2 == 0 else -g[1]))
        return result


# Centre and radius of the balls, in the unit box: a rising plume that leans and opens like a mushroom.
BALLS = [((0.40, 0.12, 0.52), 0.075), ((0.44, 0.20, 0.50), 0.085), ((0.42, 0.29, 0.53), 0.10),
         ((0.48, 0.38, 0.48), 0.125), ((0.41, 0.47, 0.54), 0.13), ((0.54, 0.50, 0.46), 0.15),
         ((0.34, 0.58, 0.50), 0.14), ((0.62, 0.60, 0.53), 0.16), ((0.47, 0.63, 0.60), 0.16),
         ((0.26, 0.68, 0.46), 0.12), ((0.72, 0.70, 0.46), 0.14), ((0.54, 0.74, 0.43), 0.17),
         ((0.40, 0.77, 0.53), 0.15), ((0.63, 0.80, 0.57), 0.13), ((0.80, 0.62, 0.52), 0.10), ((0.50, 0.85, 0.48), 0.10)]


def envelope(x, y, z):
    """1 well inside the balls, 0 at their border, negative outside."""
    best = 0.0
    for (cx, cy, cz), r in BALLS:
        d2 = ((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) / (r * r)
        if d2 < 2.2:
            best += math.exp(-2.2 * d2)
    return 1.5 * (best - 0.3)


def density(noise, x, y, z, octaves=5):
    """0..1."""
    base = envelope(x, y, z)
    if base < -0.47:
        return 0.0
    # Bends the finer noise: swirls.
    wx, wy, wz = (noise.at(4.0 * x + o, 4.0 * y + 7.1, 4.0 * z - o) for o in (3.3, 21.7, 47.9))
    sx, sy, sz = x + 0.05 * wx, y + 0.05 * wy, z + 0.05 * wz
    total, amplitude, frequency = 0.0, 0.62, 5.0
    for _ in range(octaves):
        total += amplitude * (0.45 - 1.3 * abs(noise.at(frequency * sx, frequency * sy, frequency * sz)))  # billows
        amplitude, frequency = 0.55 * amplitude, 2.03 * frequency
    d = base + 1.05 * total
    return max(0.0, min(1.0, 1.3 * d)) ** 1.2


def grid(size):
    noise = Noise(7)
    values = bytearray()
    for k in range(size[2]):
        for j in range(size[1]):
            for i in range(size[0]):
                x, y, z = (i + 0.5) / size[0], (j + 0.5) / size[1], (k + 0.5) / size[2]
                edge = min(i, j, k, size[0] - 1 - i, size[1] - 1 - j, size[2] - 1 - k)
                values.append(int(255.0 * density(noise, x, y, z) * min(1.0, edge / 3.0) + 0.5))
    return values


def write_nrrd(path, size, values):
    head = ("NRRD0004\n# Smoke cloud, density 0..1. MIT licence. Made by assets/media/generate.py.\n"
            f"type: uint8\ndimension: 3\nsizes: {size[0]} {size[1]} {size[2]}\nencoding: raw\n\n")
    path.write_bytes(head.encode("ascii") + bytes(values))


# Each cube in six tetrahedra about its long diagonal: neighbouring cubes cut their common face alike, so the surface is
# closed.
TETRAHEDRA = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def surface(name, material, cells, low, high):
    """The border of the lumpy envelope by marching tetrahedra, vertices relaxed once."""
    noise = Noise(7)
    field = {}

    def value(c):
        if c not in field:
            if min(c) <= 0 or max(c) >= cells:
                field[c] = -1.0
            else:
                x, y, z = (i / cells for i in c)
                lumps = sum(a * (0.4 - 1.3 * abs(noise.at(f * x, f * y, f * z))) for a, f in ((0.62, 5.0), (0.3, 10.3)))
                field[c] = envelope(x, y, z) + 0.55 * lumps
            if abs(field[c]) < 1e-4:
                field[c] = -1e-4
        return field[c]

    points, index, faces = [], {}, []

    def cut(a, b):
        key = (a, b) if a < b else (b, a)
        if key not in index:
            t = value(key[0]) / (value(key[0]) - value(key[1]))
            t = min(0.9, max(0.1, t))
            index[key] = len(points)
            points.append(tuple((p + (q - p) * t) / cells for p, q in zip(*key)))
        return index[key]

    for i in range(cells):
        for j in range(cells):
            for k in range(cells):
                corner = [(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2 & 1)) for b in range(8)]
                signs = [value(c) > 0.0 for c in corner]
                if all(signs) or not any(signs):
                    continue
                for tetrahedron in TETRAHEDRA:
                    inside = [corner[t] for t in tetrahedron if signs[t]]
                    outside = [corner[t] for t in tetrahedron if not signs[t]]
                    if not inside or not outside:
                        continue
                    if len(inside) == 2:
                        ring = [cut(inside[0], outside[0]), cut(inside[0], outside[1]), cut(inside[1], outside[1]),
                                cut(inside[1], outside[0])]
                        polygons = [[ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]]
                    elif len(inside) == 1:
                        polygons = [[cut(inside[0], o) for o in outside]]
                    else:
                        polygons = [[cut(i2, outside[0]) for i2 in inside]]
                    middle_in = [sum(c[a] for c in inside) / len(inside) for a in range(3)]
                    middle_out = [sum(c[a] for c in outside) / len(outside) for a in range(3)]
                    for f in polygons:
                        p, q, r = (points[v] for v in f)
                        n = ((q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1]),
                             (q[2] - p[2]) * (r[0] - p[0]) - (q[0] - p[0]) * (r[2] - p[2]),
                             (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))
                        along = sum(n[a] * (middle_out[a] - middle_in[a]) for a in range(3))
                        faces.append(f if along > 0.0 else f[::-1])
    # The largest piece alone, relaxed against the marching's stairs.
    parent = list(range(len(points)))

    def root(v):
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for f in faces:
        for v in f[1:]:
            parent[root(f[0])] = root(v)
    sizes = {}
    for f in faces:
        sizes[root(f[0])] = sizes.get(root(f[0]), 0) + 1
    largest = max(sizes, key=sizes.get)
    faces = [f for f in faces if root(f[0]) == largest]
    neighbours = {}
    for f in faces:
        for a in f:
            neighbours.setdefault(a, set()).update(v for v in f if v != a)
    for _ in range(4):
        moved = {v: mul((sum(points[n][0] for n in around), sum(points[n][1] for n in around),
                         sum(points[n][2] for n in around)), 1.0 / len(around))
                 for v, around in neighbours.items()}
        for v, p in moved.items():
            points[v] = add(mul(points[v], 0.5), mul(p, 0.5))
    used = sorted(neighbours)
    number = {old: new for new, old in enumerate(used)}
    span = sub(high, low)
    return Part(name, material, [tuple(low[a] + span[a] * points[v][a] for a in range(3)) for v in used],
                [[number[v] for v in f] for f in faces], crease=180.0)
