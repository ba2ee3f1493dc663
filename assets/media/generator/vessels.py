"""Glasses, what is in them, saucer, spoon, ice. A vessel's profile runs from the axis below, up the outside, over the
rim and down the inside to the axis."""
import math
import random

from .mesh import Part, add, cross, dot, lathe, lathe_mesh, mul, rotation, rounded, rounded_box, sub, turn, unit


def liquid(name, material, inside, level, overlap, meniscus, reach, segments):
    """What fills a vessel up to `level`. `inside`: the glass's inner profile from the axis up. The liquid's skin lies
    `overlap` within the glass; at the wall its surface climbs by `meniscus`, falling off over `reach`."""
    profile = []
    top = level + meniscus
    for (r0, y0), (r1, y1) in zip(inside, inside[1:]):
        length = math.hypot(r1 - r0, y1 - y0)
        out = ((y1 - y0) / length * overlap, -(r1 - r0) / length * overlap)
        if not profile:
            profile.append((0.0, y0 + out[1]))
        if y1 + out[1] >= top:
            t = (top - (y0 + out[1])) / (y1 - y0)
            wall = r0 + (r1 - r0) * t
            profile.append((wall + out[0], top))
            break
        profile.append((r1 + out[0], y1 + out[1]))
    distances = [0.0, 0.12, 0.28, 0.5, 0.8, 1.2, 1.7, 2.4, 3.4, 5.0, 8.0]
    surface = [(wall - d * reach, level + meniscus * math.exp(-d)) for d in distances]
    rest = surface[-1][0]
    surface += [(rest * t, level) for t in (0.66, 0.33)] + [(0.0, level)]
    return lathe(name, material, profile + surface, segments, crease=50.0)


def handled(name, material, profile, segments, upper, lower, columns, reach, thickness):
    """A vessel with a handle at azimuth 0: where it joins, `columns` quads round and as many rows as lie within
    `upper` and `lower` (y from, to) are cut from the outer wall, and a tube is led from one hole to the other."""
    points, faces, rows = lathe_mesh(profile, segments)
    outer = max(range(len(profile)), key=lambda i: profile[i][1])  # the rim: beyond it is the inside

    def rows_in(span):
        inside = [i for i in range(outer)
                  if span[0] - 1e-6 <= profile[i][1] <= span[1] + 1e-6 and profile[i][0] > 0.5 * profile[outer][0]]
        return inside[0], inside[-1]

    spans = [rows_in(upper), rows_in(lower)]
    if spans[0][1] - spans[0][0] != spans[1][1] - spans[1][0]:
        raise ValueError(f"{name}: the handle's ends need as many rows: {spans}")
    count = spans[0][1] - spans[0][0]
    half = columns // 2
    wanted = {(i, k % segments) for a, b in spans for i in range(a, b) for k in range(-half, half)}
    kept, at = [], 0
    for i, (a, b) in enumerate(zip(rows, rows[1:])):
        for k in range(segments):
            corners = [a[k], a[(k + 1) % segments], b[(k + 1) % segments], b[k]]
            if (i, k) not in wanted:
                kept.append([c for j, c in enumerate(corners) if c != corners[j - 1]])
            at += 1
    # The holes' edges as (column, row), once round; the lower one upside down, as the tube arrives so.
    ring = ([(c, 0) for c in range(-half, half)] + [(half, r) for r in range(count)] +
            [(c, count) for c in range(half, -half, -1)] + [(-half, r) for r in range(count, 0, -1)])
    loops = []
    for s, (a, b) in enumerate(spans):
        loops.append([rows[a + (r if s == 0 else count - r)][c % segments] for c, r in ring])
    angles = [math.atan2(2.0 * r / count - 1.0, -2.0 * c / columns) for c, r in ring]  # z runs against the columns
    centres = [mul((sum(points[i][0] for i in loop), sum(points[i][1] for i in loop), 0.0), 1.0 / len(loop))
               for loop in loops]
    start, end = centres
    slope = [unit(sub(points[rows[b][0]], points[rows[a][0]])) for a, b in spans]
    out = [(t[1], -t[0], 0.0) for t in slope]  # the wall's normals
    p = [start, add(start, add(mul(out[0], 0.9 * reach), (0, 6.0, 0))),
         add(end, add(mul(out[1], 1.25 * reach), (0, 3.0, 0))), end]

    def bezier(t):
        u = 1.0 - t
        return tuple(u ** 3 * a + 3 * u * u * t * b + 3 * u * t * t * c + t ** 3 * d for a, b, c, d in zip(*p))

    def tangent(t):
        u = 1.0 - t
        return unit(tuple(3 * u * u * (b - a) + 6 * u * t * (c - b) + 3 * t * t * (d - c) for a, b, c, d in zip(*p)))

    steps = 34
    rings = [loops[0]]
    root = [max(abs(points[i][2]) for i in loop) for loop in loops]
    tall = [0.5 * abs(points[loop[len(loop) // 2]][1] - points[loop[0]][1]) for loop in loops]
    for j in range(1, steps):
        t = 0.5 - 0.5 * math.cos(math.pi * j / steps)
        t = 0.35 * t + 0.65 * j / steps
        c, d = bezier(t), tangent(t)
        n = (-d[1], d[0], 0.0)
        near = math.dist(c, start if t < 0.5 else end)
        flare = math.exp(-near / 2.6)
        s = 0 if t < 0.5 else 1
        a = thickness[0] + (root[s] - thickness[0]) * flare
        b = thickness[1] + (tall[s] - thickness[1]) * flare
        new = []
        for angle in angles:
            new.append(len(points))
            points.append(add(c, add(mul((0.0, 0.0, 1.0), a * math.cos(angle)), mul(n, b * math.sin(angle)))))
        rings.append(new)
    rings.append(loops[1])
    tube = [[a[m], a[(m + 1) % len(a)], b[(m + 1) % len(a)], b[m]] for a, b in zip(rings, rings[1:])
            for m in range(len(a))]
    edges = {(a, b) for f in kept for a, b in zip(f, f[1:] + f[:1])}
    if (tube[0][0], tube[0][1]) in edges:
        tube = [f[::-1] for f in tube]
    used = sorted({i for f in kept + tube for i in f})
    number = {old: new for new, old in enumerate(used)}
    return Part(name, material, [points[i] for i in used], [[number[i] for i in f] for f in kept + tube], crease=50.0)


def spoon(name, material):
    """A small steel spoon along x, its bowl at the origin's side: cross sections are thin crescents."""
    length, rings, points = 96.0, 46, []
    half = 8
    for j in range(rings + 1):
        s = j / rings
        x = length * (1.0 - math.cos(0.5 * math.pi * s * 2.0)) * 0.5
        bowl = 22.0
        if x < bowl:
            t = x / bowl
            width = (8.2 * math.sqrt(max(0.0, 1.0 - (2.0 * t - 1.0) ** 2)) ** 0.9 if t < 0.5 else
                     8.2 - (8.2 - 2.0) * (3 * (2 * t - 1) ** 2 - 2 * (2 * t - 1) ** 3))
            depth = 3.4 * math.sin(math.pi * min(1.0, t * 1.02)) ** 0.8 if t < 0.98 else 0.2
        else:
            t = (x - bowl) / (length - bowl)
            end = min(1.0, (1.0 - t) * 12.0)
            width = (2.0 + 2.2 * t ** 2) * math.sqrt(max(0.0, 1.0 - (1.0 - end) ** 2))
            depth = 0.25
        width = max(width, 0.05)
        lift = 0.0 if x < bowl else 9.0 * math.sin(0.5 * math.pi * (x - bowl) / (length - bowl)) ** 1.0
        thick = 0.8 * min(1.0, width / 1.5)
        for m in range(2 * half):
            a = math.pi * m / half
            u, top = math.cos(a), math.sin(a)
            y = lift - depth * (1.0 - u * u) + 0.5 * thick * top
            points.append((x, y, width * u))
    count = 2 * half
    faces = [[j * count + m, j * count + (m + 1) % count, (j + 1) * count + (m + 1) % count, (j + 1) * count + m]
             for j in range(rings) for m in range(count)]
    faces += [list(range(count))[::-1], [rings * count + m for m in range(count)]]
    return Part(name, material, points, faces, crease=60.0)


def boxes_apart(a, b, gap):
    """Two turned boxes (centre, matrix, half sizes) by separating axes, `gap` between them."""
    def axes(box):
        return [tuple(row[i] for row in box[1]) for i in range(3)]

    u, v = axes(a), axes(b)
    apart = sub(b[0], a[0])
    for n in u + v + [cross(p, q) for p in u for q in v]:
        length = math.sqrt(dot(n, n))
        if length < 1e-6:
            continue
        n = mul(n, 1.0 / length)
        reach = sum(h * abs(dot(n, e)) for h, e in zip(a[2], u)) + sum(h * abs(dot(n, e)) for h, e in zip(b[2], v))
        if abs(dot(n, apart)) > reach + gap:
            return True
    return False


def ice_cubes(count, half, radius_at, low, high, level, seed):
    """Cubes at random that touch neither each other nor the wall, as high and as near the wall as they fit: ice
    floats, and through 1 cm of cola one hardly sees. (centre, matrix, half sizes) each."""
    rng = random.Random(seed)
    placed = []
    for n in range(count):
        best, best_score = None, 0.0
        for _ in range(6000):
            sizes = tuple(h * rng.uniform(0.9, 1.08) for h in half)
            m = rotation((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)),
                         rng.uniform(0, 360) if n else rng.uniform(5, 40))
            a, r = rng.uniform(0, 2 * math.pi), rng.uniform(0.0, 24.0)
            c = (r * math.cos(a), rng.uniform(low, high), r * math.sin(a))
            corners = [add(c, turn(m, (sizes[0] * i, sizes[1] * j, sizes[2] * k)))
                       for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
            if (any(math.hypot(p[0], p[2]) > radius_at(p[1]) - 0.2 for p in corners) or
                    min(p[1] for p in corners) < 20.0):
                continue
            above = sum(p[1] > level for p in corners)
            if above > 4:
                continue
            score = c[1] + 0.6 * r
            if best and score <= best_score:
                continue
            if all(boxes_apart((c, m, sizes), other, 0.4) for other in placed):
                best, best_score = (c, m, sizes), score
        if best:
            placed.append(best)
    return placed


def ice_cube(name, material, placing, seed):
    """A rounded cube, a little melted: its sides wave."""
    centre, matrix, half = placing
    rng = random.Random(seed)
    waves = [((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)), rng.uniform(0, 6.3), rng.uniform(0.12, 0.3))
             for _ in range(5)]

    def shape(p):
        push = sum(a * math.sin(0.22 * dot(w, p) + f) for w, f, a in waves) - 0.75
        return add(p, mul(unit(p), push))

    return rounded_box(name, material, half, 3.2, arc=4, inner=6, shape=shape).placed(matrix, centre)


def espresso_cup():
    """Outer and inner profile of a thick glass cup, and its foot."""
    outside = [(0.0, 0.6), (14.0, 0.6), (15.5, 0.0, 0.8), (18.5, 0.0, 2.0), (26.5, 22.0, 26.0), (30.0, 56.0)]
    rim = [(30.0, 56.0), (30.2, 58.0, 1.15), (27.9, 58.0, 1.15), (27.7, 56.0)]
    inside = [(27.7, 56.0), (24.0, 24.0, 22.0), (17.0, 7.5, 9.0), (0.0, 7.0)]
    return outside, rim, inside


def profile_of(outside, rim, inside, step):
    up = rounded(outside, step)
    over = rounded(rim, 0.5, 30.0)
    down = rounded(inside, step)
    return up + over[1:] + down[1:], down[::-1]
