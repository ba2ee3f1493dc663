"""Writes figure.glb: a smooth figure that walks in a circle, and what is around it. python3 assets/figure/generate.py

The body is the surface of a distance field: round cones along the bones, joined smoothly [Quilez, "smooth minimum"].
Surface nets [Gibson 1998] find its vertices, which are then moved onto the surface. A vertex follows the bones near it.
The walk is solved backwards: feet that stand stay where they are, and legs bend to reach them. Metres, y up; at rest
the figure looks along +z.
"""
import json
import math
import pathlib
import struct

CELL = 0.0238  # of the grid in which the surface is found

# ------------------------------------------------------------------------------------------------------- vectors


def plus(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def times(a, f):
    return (a[0] * f, a[1] * f, a[2] * f)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return times(a, 1 / math.sqrt(dot(a, a)))


def mix(a, b, u):
    return plus(times(a, 1 - u), times(b, u))


# Rotations: unit quaternions x, y, z, w.
def about(axis, angle):
    s = math.sin(angle / 2)
    return (axis[0] * s, axis[1] * s, axis[2] * s, math.cos(angle / 2))


def after(a, b):
    """First b, then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def back(q):
    return (-q[0], -q[1], -q[2], q[3])


def turned(q, v):
    u = q[:3]
    t = times(cross(u, v), 2)
    return plus(plus(v, times(t, q[3])), cross(u, t))


def aiming(rest, rest_side, goal, goal_side):
    """The rotation that takes direction `rest` to `goal`, and the one side as near as may be to the other."""
    def basis(y, x):
        y = unit(y)
        x = unit(minus(x, times(y, dot(x, y))))
        return x, y, cross(x, y)
    a, b = basis(rest, rest_side), basis(goal, goal_side)
    m = [[sum(b[k][i] * a[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    # The largest of 4 w^2, 4 x^2, ... keeps the division safe.
    w, x, y, z = (1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2],
                  1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2])
    most = max(w, x, y, z)
    s = 2 * math.sqrt(most)
    if most == w:
        return ((m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s, s / 4)
    if most == x:
        return (s / 4, (m[0][1] + m[1][0]) / s, (m[0][2] + m[2][0]) / s, (m[2][1] - m[1][2]) / s)
    if most == y:
        return ((m[0][1] + m[1][0]) / s, s / 4, (m[1][2] + m[2][1]) / s, (m[0][2] - m[2][0]) / s)
    return ((m[0][2] + m[2][0]) / s, (m[1][2] + m[2][1]) / s, s / 4, (m[1][0] - m[0][1]) / s)


# ------------------------------------------------------------------------------------------------------- bones

ARM = (math.sin(math.radians(42)), -math.cos(math.radians(42)), 0.0)  # of the left arm at rest


def sided(v, side):
    return (v[0] * side, v[1], v[2])


def skeleton():
    """Name: (parent, place at rest, end). Parents come first."""
    bones = {"hips": (None, (0, 0.96, 0), (0, 1.06, 0)), "spine": ("hips", (0, 1.08, 0), (0, 1.22, 0)),
             "chest": ("spine", (0, 1.25, -0.005), (0, 1.42, -0.01)),
             "neck": ("chest", (0, 1.475, -0.015), (0, 1.55, 0)), "head": ("neck", (0, 1.575, 0.005), (0, 1.72, 0.01))}
    for name, side in (("left", 1), ("right", -1)):
        shoulder = (0.178, 1.425, -0.012)
        elbow, wrist = plus(shoulder, times(ARM, 0.285)), plus(shoulder, times(ARM, 0.535))
        tip = plus(shoulder, times(ARM, 0.69))
        hip, knee, ankle, toe = (0.092, 0.925, 0), (0.098, 0.5, 0.008), (0.098, 0.085, -0.022), (0.106, 0.03, 0.14)
        for bone, parent, at, end in (("upper_arm", "chest", shoulder, elbow), ("forearm", "upper_arm", elbow, wrist),
                                      ("hand", "forearm", wrist, tip), ("thigh", "hips", hip, knee),
                                      ("shin", "thigh", knee, ankle), ("foot", "shin", ankle, toe)):
            above = parent if parent in bones else f"{name}_{parent}"
            bones[f"{name}_{bone}"] = (above, sided(at, side), sided(end, side))
    return bones


BONES = skeleton()
NAMES = list(BONES)

# ------------------------------------------------------------------------------------------------------- surface


def parts():
    """Groups of round cones (ends and radii), with the width over which each group's parts join."""
    torso = [((-0.055, 0.95, -0.01), (0.055, 0.95, -0.01), 0.112, 0.112),
             ((-0.035, 0.95, -0.05), (0.035, 0.95, -0.05), 0.09, 0.09),
             ((0, 0.98, 0), (0, 1.16, 0.005), 0.117, 0.106), ((-0.05, 1.14, 0), (0.05, 1.14, 0), 0.09, 0.09),
             ((-0.065, 1.29, 0.002), (0.065, 1.29, 0.002), 0.118, 0.118),
             ((-0.13, 1.405, -0.012), (0.13, 1.405, -0.012), 0.068, 0.068),
             ((0, 1.36, -0.01), (0, 1.46, -0.02), 0.095, 0.06)]
    head = [((0, 1.42, -0.018), (0, 1.58, 0), 0.056, 0.05), ((0, 1.66, -0.012), (0, 1.69, -0.008), 0.09, 0.09),
            ((0, 1.645, 0.025), (0, 1.675, 0.02), 0.074, 0.078), ((0, 1.585, 0.052), (0, 1.605, 0.04), 0.037, 0.05),
            ((0, 1.625, 0.1), (0, 1.65, 0.09), 0.012, 0.009)]
    groups = [(torso, 0.05), (head, 0.028)]
    for side in (1, -1):
        at = {bone: (sided(BONES[f"left_{bone}"][1], side), sided(BONES[f"left_{bone}"][2], side))
              for bone in ("upper_arm", "forearm", "hand", "thigh", "shin", "foot")}
        shoulder, elbow = at["upper_arm"]
        wrist, tip = at["hand"]
        palm, thumb = mix(wrist, tip, 0.45), mix(wrist, tip, 0.5)
        across = (0, 0, 0.016)
        arm = [(shoulder, shoulder, 0.057, 0.057), (shoulder, elbow, 0.05, 0.04),
               (mix(shoulder, elbow, 0.5), mix(shoulder, elbow, 0.6), 0.049, 0.048), (elbow, wrist, 0.039, 0.028),
               (mix(elbow, wrist, 0.2), mix(elbow, wrist, 0.35), 0.043, 0.041),
               (plus(wrist, across), plus(palm, across), 0.022, 0.025),
               (minus(wrist, across), minus(palm, across), 0.022, 0.024),
               (plus(palm, across), plus(tip, times(across, 0.5)), 0.024, 0.014),
               (minus(palm, across), minus(tip, times(across, 0.5)), 0.023, 0.014),
               (plus(wrist, (0, 0, 0.02)), plus(thumb, (-0.012 * side, 0, 0.06)), 0.018, 0.013)]
        hip, knee = at["thigh"]
        ankle = at["shin"][1]
        leg = [(plus(hip, (0, -0.02, -0.012)), knee, 0.093, 0.054), (knee, knee, 0.056, 0.056),
               (knee, ankle, 0.052, 0.036), (plus(mix(knee, ankle, 0.2), (0, 0, -0.018)),
                                             plus(mix(knee, ankle, 0.42), (0, 0, -0.016)), 0.05, 0.046),
               ((0.098 * side, 0.042, -0.05), (0.108 * side, 0.036, 0.09), 0.04, 0.036),
               ((0.108 * side, 0.034, 0.09), (0.112 * side, 0.026, 0.155), 0.038, 0.026),
               (plus(ankle, (0, 0, 0)), (0.104 * side, 0.05, 0.06), 0.038, 0.03)]
        groups += [(arm, 0.022), (leg, 0.03)]
    return groups


def prepared(groups):
    cones = []
    for group, width in groups:
        cones.append(([(a, minus(b, a), max(dot(minus(b, a), minus(b, a)), 1e-12), ra, rb) for a, b, ra, rb in group],
                      width))
    return cones


CONES = prepared(parts())


def joined(a, b, width):
    """The smooth minimum."""
    h = max(width - abs(a - b), 0.0) / width
    return min(a, b) - h * h * width / 4


def distance(p):
    """About the distance from the body, negative inside."""
    whole = 1e3
    for group, width in CONES:
        one = 1e3
        for a, along, length2, ra, rb in group:
            v = (p[0] - a[0], p[1] - a[1], p[2] - a[2])
            u = min(max(dot(v, along) / length2, 0.0), 1.0)
            x, y, z = v[0] - u * along[0], v[1] - u * along[1], v[2] - u * along[2]
            one = joined(one, math.sqrt(x * x + y * y + z * z) - ra - u * (rb - ra), width)
        whole = joined(whole, one, 0.035)
    return max(whole, 0.003 - p[1])  # flat soles


def slope(p, step=1e-4):
    return unit(tuple(distance(plus(p, times(e, step))) - distance(minus(p, times(e, step)))
                      for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))))


def surface():
    """Vertices on the body and quads, whose fronts are outside."""
    low, counts = (-0.74, -0.04, -0.2), tuple(int(math.ceil(size / CELL)) for size in (1.48, 1.88, 0.46))
    nx, ny, nz = counts
    place = (lambda i, j, k: (low[0] + i * CELL, low[1] + j * CELL, low[2] + k * CELL))
    # Coarse to fine: far from the surface a value says that its neighbours are empty, too.
    value = {}
    coarse = 4
    for i in range(0, nx, coarse):
        for j in range(0, ny, coarse):
            for k in range(0, nz, coarse):
                far = distance(place(i + coarse / 2, j + coarse / 2, k + coarse / 2))
                near = abs(far) < 1.2 * coarse * CELL
                for a in range(i, i + coarse):
                    for b in range(j, j + coarse):
                        for c in range(k, k + coarse):
                            value[a, b, c] = distance(place(a, b, c)) if near else far
    vertices, index, quads = [], {}, []
    corners = [(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
    edges = [(p, q) for n, p in enumerate(corners) for q in corners[n + 1:]
             if sum(abs(x - y) for x, y in zip(p, q)) == 1]
    for i in range(nx - 1):
        for j in range(ny - 1):
            for k in range(nz - 1):
                v = {c: value[i + c[0], j + c[1], k + c[2]] for c in corners}
                crossings = [mix(p, q, v[p] / (v[p] - v[q])) for p, q in edges if (v[p] < 0) != (v[q] < 0)]
                if not crossings:
                    continue
                middle = times(tuple(map(sum, zip(*crossings))), 1 / len(crossings))
                index[i, j, k] = len(vertices)
                vertices.append(place(i + middle[0], j + middle[1], k + middle[2]))
    for (i, j, k) in index:
        for axis in range(3):
            other = [(i, j, k)[n] + (1 if n == axis else 0) for n in range(3)]
            a, b = value[i, j, k], value[tuple(other)]
            if (a < 0) == (b < 0):
                continue
            u, w = [tuple(1 if n == m else 0 for n in range(3)) for m in range(3) if m != axis]
            around = [(i, j, k), tuple(x - y for x, y in zip((i, j, k), u)),
                      tuple(x - y - z for x, y, z in zip((i, j, k), u, w)), tuple(x - z for x, z in zip((i, j, k), w))]
            quad = [index[c] for c in around]
            quads.append(quad if (a < 0) == (axis != 1) else quad[::-1])
    for _ in range(4):
        vertices = [minus(p, times(slope(p), distance(p))) for p in vertices]
    return vertices, quads


THICK = {"hips": 0.11, "spine": 0.1, "chest": 0.12, "head": 0.09, "thigh": 0.075}  # of bones; others 0.045


def depth(p, bone):
    """The distance from a bone's flesh, about."""
    _, a, b = BONES[bone]
    along = minus(b, a)
    u = min(max(dot(minus(p, a), along) / dot(along, along), 0.0), 1.0)
    return math.dist(p, mix(a, b, u)) - THICK.get(bone.split("_")[-1], 0.045)


def weights(vertices, quads):
    """Up to four joints a vertex, and their weights, of 255 in all: at first those of the nearest bone and of its
    neighbours, then smoothed along the surface."""
    shares = []
    for p in vertices:
        nearest = min(NAMES, key=lambda bone: depth(p, bone))
        least = depth(p, nearest)
        family = [bone for bone in NAMES if bone == nearest or BONES[bone][0] == nearest or BONES[nearest][0] == bone]
        near = {bone: math.exp(-(depth(p, bone) - least) / 0.02) for bone in family}
        whole = sum(near.values())
        shares.append({bone: share / whole for bone, share in near.items()})
    beside = [set() for _ in vertices]
    for quad in quads:
        for i in range(4):
            beside[quad[i]] |= {quad[i - 1], quad[(i + 1) % 4]}
    for _ in range(10):
        smooth_ones = []
        for own, others in zip(shares, beside):
            mean = {bone: 0.5 * share for bone, share in own.items()}
            for other in others:
                for bone, share in shares[other].items():
                    mean[bone] = mean.get(bone, 0.0) + 0.5 * share / len(others)
            smooth_ones.append(mean)
        shares = smooth_ones
    result = []
    for own in shares:
        most = sorted(((share, NAMES.index(bone)) for bone, share in own.items()), reverse=True)[:4]
        whole = sum(share for share, _ in most)
        numbers = [round(255 * share / whole) for share, _ in most]
        numbers[0] += 255 - sum(numbers)
        most = [(joint, number) for (_, joint), number in zip(most, numbers) if number] + [(0, 0)] * 3
        result.append(list(zip(*most[:4])))
    return result


# ------------------------------------------------------------------------------------------------------- walk

RADIUS, STEPS, SECONDS, KEYS = 1.4, 16, 0.58, 8  # of the circle; steps of a round; of a step; keys of a step
STANDS = 0.6  # share of a foot's cycle
LOWER = 0.062  # of the hips, below where they are at rest


def at_path(angle, offset=0.0):
    """Place and heading on the circle, anticlockwise from above; `offset` to the left."""
    return (((RADIUS - offset) * math.cos(angle), 0.0, -(RADIUS - offset) * math.sin(angle)),
            about((0, 1, 0), angle + math.pi))


def smooth(u):
    u = min(max(u, 0.0), 1.0)
    return u * u * (3 - 2 * u)


def foot(side, time):
    """The ankle's place and the foot's rotation."""
    ankle, toe, heel = sided(BONES["left_foot"][1], side), (0.11 * side, 0.0, 0.165), (0.099 * side, 0.0, -0.085)
    angle = 2 * math.pi / STEPS / SECONDS
    cycle = time / (2 * SECONDS) - (0.0 if side > 0 else 0.5)
    number = math.floor(cycle)
    u = cycle - number
    # The hips pass over a foot in the middle of the time that it stands.
    places = [at_path(angle * 2 * SECONDS * (n + STANDS / 2 + (0.0 if side > 0 else 0.5)))
              for n in (number, number + 1)]
    landing, leaving = -math.radians(12), math.radians(32)
    if u < STANDS:
        place, heading = places[0]
        pitch, lift = landing * (1 - smooth(u / 0.1)) + leaving * smooth((u - 0.38) / (STANDS - 0.38)), 0.0
    else:
        s = (u - STANDS) / (1 - STANDS)
        place = mix(places[0][0], places[1][0], smooth(s))
        turn = 2 * angle * SECONDS * smooth(s)
        heading = after(about((0, 1, 0), turn), places[0][1])
        pitch, lift = leaving + (landing - leaving) * smooth(s), 0.055 * math.sin(math.pi * s) ** 2
    rotation = after(heading, about((1, 0, 0), pitch))
    pivot = mix(heel, toe, smooth((pitch - landing) / (0.3 - landing)) if u >= STANDS else float(pitch > 0))
    at = plus(plus(place, turned(heading, pivot)), turned(rotation, minus(ankle, pivot)))
    return plus(at, (0, lift, 0)), rotation


def pose(time):
    """The hips' place, and each joint's rotation in the world."""
    angle = 2 * math.pi / STEPS / SECONDS * time
    swing = 2 * math.pi * (time / (2 * SECONDS) - STANDS / 2)  # 0: the hips are over the left foot
    path, heading = at_path(angle)
    lean = after(heading, about((0, 0, 1), math.radians(2.5)))  # into the curve
    twist = math.sin(swing)
    hips = after(lean, after(about((0, 1, 0), math.radians(5) * twist), about((1, 0, 0), math.radians(3))))
    place = plus(path, plus((0, BONES["hips"][1][1] - LOWER + 0.011 * math.cos(2 * swing), 0),
                            turned(heading, (0.018 * math.cos(swing), 0, 0))))
    world = {"hips": hips, "spine": after(lean, about((1, 0, 0), math.radians(3))),
             "chest": after(lean, after(about((0, 1, 0), -math.radians(7) * twist), about((1, 0, 0), math.radians(4)))),
             "neck": after(lean, about((1, 0, 0), math.radians(2))), "head": heading}
    for name, side in (("left", 1), ("right", -1)):
        # An arm swings with the other side's leg.
        ahead = -side * twist
        down = about((0, 0, 1), -side * math.radians(33))
        upper = after(world["chest"], after(about((1, 0, 0), math.radians(3 - 24 * ahead)), down))
        bend = math.radians(24 + 12 * ahead)
        fore = after(upper, after(back(down), after(about((1, 0, 0), -bend), down)))
        world[f"{name}_upper_arm"], world[f"{name}_forearm"] = upper, fore
        world[f"{name}_hand"] = after(fore, about(unit(ARM if side > 0 else sided(ARM, -1)), -side * math.radians(15)))
        ankle, rotation = foot(side, time)
        thigh, shin = f"{name}_thigh", f"{name}_shin"
        hip = plus(place, turned(hips, minus(BONES[thigh][1], BONES["hips"][1])))
        first, second = minus(BONES[shin][1], BONES[thigh][1]), minus(BONES[f"{name}_foot"][1], BONES[shin][1])
        a, b = math.sqrt(dot(first, first)), math.sqrt(dot(second, second))
        reach = minus(ankle, hip)
        c = min(math.sqrt(dot(reach, reach)), 0.9995 * (a + b))
        along = unit(reach)
        forward = turned(mix_turn(heading, rotation), (0, 0, 1))
        forward = unit(minus(forward, times(along, dot(forward, along))))
        cosine = (a * a + c * c - b * b) / (2 * a * c)
        knee = plus(hip, times(plus(times(along, cosine), times(forward, math.sqrt(max(1 - cosine * cosine, 0)))), a))
        end = plus(hip, times(along, c))
        side_axis = cross(along, forward)
        world[thigh] = aiming(first, (-1, 0, 0), minus(knee, hip), side_axis)
        world[shin] = aiming(second, (-1, 0, 0), minus(end, knee), side_axis)
        world[f"{name}_foot"] = rotation
    return place, world


def mix_turn(heading, rotation):
    """Halfway between the headings of the body and of a foot: where a knee points."""
    ahead = plus(turned(heading, (0, 0, 1)), turned(rotation, (0, 0, 1)))
    return about((0, 1, 0), math.atan2(ahead[0], ahead[2]))


# ------------------------------------------------------------------------------------------------------- place


def box(low, high):
    """Vertices, normals and triangles of a closed box."""
    points, normals, triangles = [], [], []
    for axis in range(3):
        for side, value in ((-1, low[axis]), (1, high[axis])):
            u, w = (axis + 1) % 3, (axis + 2) % 3
            first = len(points)
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)) if side > 0 else ((0, 0), (0, 1), (1, 1), (1, 0)):
                p = [0.0, 0.0, 0.0]
                p[axis], p[u], p[w] = value, (low, high)[a][u], (low, high)[b][w]
                points.append(tuple(p))
                normals.append(tuple(side if n == axis else 0 for n in range(3)))
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return points, normals, triangles


def column(x, z, radius, high, segments=28):
    points, normals, triangles = [], [], []
    for i in range(segments + 1):
        c, s = math.cos(2 * math.pi * i / segments), math.sin(2 * math.pi * i / segments)
        for y, r in ((0.16, radius), (high - 0.14, 0.86 * radius)):
            points.append((x + r * c, y, z - r * s))
            normals.append((c, 0.0, -s))
    for i in range(segments):
        a = 2 * i
        triangles += [(a, a + 2, a + 3), (a, a + 3, a + 1)]
    w = 1.35 * radius
    shapes = [(points, normals, triangles), box((x - w, 0, z - w), (x + w, 0.16, z + w)),
              box((x - w, high - 0.14, z - w), (x + w, high, z + w))]
    return together(shapes)


def together(shapes):
    points, normals, triangles = [], [], []
    for p, n, t in shapes:
        triangles += [tuple(i + len(points) for i in corner) for corner in t]
        points += p
        normals += n
    return points, normals, triangles


def surroundings():
    """Name, colour and shape of what stands still."""
    slabs = {0: [], 1: []}
    for i in range(-5, 5):
        for j in range(-5, 5):
            x, z = 0.8 * i, 0.8 * j
            slabs[(i + j) % 2].append(([(x, 0, z), (x, 0, z + 0.8), (x + 0.8, 0, z + 0.8), (x + 0.8, 0, z)],
                                       [(0, 1, 0)] * 4, [(0, 1, 2), (0, 2, 3)]))
    columns = [column(x, -2.6, 0.2, 3.0) for x in (-3.2, -1.07, 1.07, 3.2)]
    beam = box((-3.6, 3.0, -2.9), (3.6, 3.35, -2.3))
    roof = box((-3.6, 3.35, -4.1), (3.6, 3.5, -2.2))
    ground = box((-14, -0.4, -14), (14, -0.06, 14))
    return [("ground", (0.36, 0.31, 0.24), ground), ("light_slabs", (0.62, 0.58, 0.5), together(slabs[0])),
            ("dark_slabs", (0.38, 0.2, 0.15), together(slabs[1])),
            ("columns", (0.66, 0.61, 0.53), together([*columns, beam, roof])),
            ("wall", (0.6, 0.4, 0.24), box((-3.6, 0, -4.3), (3.6, 3.5, -4.0))),
            ("bench", (0.66, 0.61, 0.53), together([box((-0.9, 0.36, -3.9), (0.9, 0.46, -3.45)),
                                                    box((-0.75, 0, -3.85), (-0.6, 0.36, -3.5)),
                                                    box((0.6, 0, -3.85), (0.75, 0.36, -3.5))]))]


# ------------------------------------------------------------------------------------------------------- glTF


class Glb:
    def __init__(self):
        self.root = {"asset": {"version": "2.0", "generator": "assets/figure/generate.py"}, "scene": 0,
                     "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [], "accessors": [],
                     "bufferViews": [], "buffers": [{}]}
        self.data = bytearray()

    def add(self, kind, value):
        self.root[kind].append(value)
        return len(self.root[kind]) - 1

    def numbers(self, rows, shape, code, kind, bounded=False, **more):
        """An accessor; code: of struct; kind: of glTF."""
        flat = [x for row in rows for x in (row if isinstance(row, (tuple, list)) else (row,))]
        self.data += b"\0" * (-len(self.data) % 4)
        begin = len(self.data)
        self.data += struct.pack(f"<{len(flat)}{code}", *flat)
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": begin, "byteLength": len(self.data) - begin})
        accessor = {"bufferView": view, "componentType": kind, "count": len(rows), "type": shape, **more}
        if bounded:
            wide = len(rows[0]) if isinstance(rows[0], (tuple, list)) else 1
            single = [struct.unpack("<f", struct.pack("<f", x))[0] for x in flat]
            accessor["min"] = [min(single[n::wide]) for n in range(wide)]
            accessor["max"] = [max(single[n::wide]) for n in range(wide)]
        return self.add("accessors", accessor)

    def mesh(self, name, colour, points, normals, triangles, attributes=None, roughness=0.9):
        material = self.add("materials", {"name": name, "pbrMetallicRoughness": {
            "baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": roughness}})
        whole = {"POSITION": self.numbers(points, "VEC3", "f", 5126, True),
                 "NORMAL": self.numbers(normals, "VEC3", "f", 5126), **(attributes or {})}
        indices = self.numbers([i for t in triangles for i in t], "SCALAR", "H", 5123)
        return self.add("meshes", {"name": name, "primitives": [{"attributes": whole, "indices": indices,
                                                                 "material": material}]})

    def write(self, file):
        self.data += b"\0" * (-len(self.data) % 4)
        self.root["buffers"][0]["byteLength"] = len(self.data)
        text = json.dumps(self.root, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        file.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.data)) +
                         struct.pack("<I4s", len(text), b"JSON") + text +
                         struct.pack("<I4s", len(self.data), b"BIN\0") + bytes(self.data))


def add_figure(glb):
    vertices, quads = surface()
    bound = weights(vertices, quads)
    attributes = {"JOINTS_0": glb.numbers([joints for joints, _ in bound], "VEC4", "B", 5121),
                  "WEIGHTS_0": glb.numbers([shares for _, shares in bound], "VEC4", "B", 5121, normalized=True)}
    triangles = [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]
    mesh = glb.mesh("figure", (0.58, 0.34, 0.2), vertices, [slope(p) for p in vertices], triangles, attributes, 0.7)
    first = len(glb.root["nodes"])
    for name in NAMES:
        parent, place, _ = BONES[name]
        offset = minus(place, BONES[parent][1]) if parent else place
        glb.add("nodes", {"name": name, "translation": list(offset)})
        if parent:
            glb.root["nodes"][first + NAMES.index(parent)].setdefault("children", []).append(first + NAMES.index(name))
    binds = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *times(BONES[name][1], -1), 1) for name in NAMES]
    glb.root["skins"] = [{"joints": [first + i for i in range(len(NAMES))], "skeleton": first,
                          "inverseBindMatrices": glb.numbers(binds, "MAT4", "f", 5126)}]
    glb.root["scenes"][0]["nodes"] += [first, glb.add("nodes", {"name": "figure", "mesh": mesh, "skin": 0})]
    # The walk: a round.
    keys = [SECONDS * k / KEYS for k in range(STEPS * KEYS + 1)]
    poses = [pose(t) for t in keys]
    input_ = glb.numbers(keys, "SCALAR", "f", 5126, True)
    samplers, channels = [], []

    def channel(node, path, rows, shape):
        samplers.append({"input": input_, "output": glb.numbers(rows, shape, "f", 5126)})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": first + node, "path": path}})
    channel(0, "translation", [place for place, _ in poses], "VEC3")
    for node, name in enumerate(NAMES):
        parent = BONES[name][0]
        rows = [after(back(world[parent]), world[name]) if parent else world[name] for _, world in poses]
        channel(node, "rotation", rows, "VEC4")
    glb.root["animations"] = [{"name": "walk", "samplers": samplers, "channels": channels}]


if __name__ == "__main__":
    glb = Glb()
    add_figure(glb)
    for name, colour, shape in surroundings():
        glb.root["scenes"][0]["nodes"].append(glb.add("nodes", {"name": name, "mesh": glb.mesh(name, colour, *shape)}))
    glb.write(pathlib.Path(__file__).resolve().parent / "figure.glb")
