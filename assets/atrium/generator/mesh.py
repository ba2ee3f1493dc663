"""A triangle mesh by material, the primitives the atrium is made of, and its OBJ writer.

Local frames: the builders work in (s, y, d): s along a wall, y up, d out of the wall towards the viewer's side; the
frame is right-handed (s x y = d). Mesh.frame() places it in the world. Lengths are metres. UVs are metres divided by
the material's SCALE (metres a texture unit) unless a primitive says otherwise; v grows upwards.
"""
import contextlib
import math

import numpy as np

SCALE = {"limestone": 2.0, "plaster": 3.0, "stone_trim": 1.0, "floor": 2.0, "floor_border": 1.0, "terracotta": 1.0,
         "wood": 1.0, "iron": 1.0, "water": 1.0}
CREASE = math.cos(math.radians(38.0))  # profile corners sharper than this stay hard edges


def turn(axis, degrees):
    """Rotation matrix about the x, y or z axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    r = np.eye(3)
    r[i, i], r[i, j], r[j, i], r[j, j] = c, -s, s, c
    return r


def unit(v):
    """v over its length, along the last axis; zero stays zero."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(length > 0.0, length, 1.0)


def profile_pieces(points, closed=False):
    """Pieces (a, b, normal at a, normal at b, length at a, length at b) of a 2D profile.

    Normals stand to the right of the direction of travel and are shared across corners flatter than CREASE.
    """
    pts = np.asarray(points, float)
    if closed:
        pts = np.vstack([pts, pts[:1]])
    delta = np.diff(pts, axis=0)
    length = np.linalg.norm(delta, axis=1)
    keep = length > 1e-7
    delta, length, a = delta[keep], length[keep], pts[:-1][keep]
    flat = np.stack([delta[:, 1], -delta[:, 0]], axis=1) / length[:, None]
    at = np.concatenate([[0.0], np.cumsum(length)])
    n = len(flat)

    def shared(i, j):
        if not closed and (j < 0 or j >= n):
            return flat[i]
        other = flat[j % n]
        return unit(flat[i] + other) if flat[i] @ other > CREASE else flat[i]

    return [(a[i], a[i] + delta[i], shared(i, i - 1), shared(i, i + 1), at[i], at[i + 1]) for i in range(n)]


def sheet_normals(p):
    """Mean of the normals of the quads around each point of a (rows, columns, 3) patch."""
    quad = unit(np.cross(p[1:, 1:] - p[:-1, :-1], p[1:, :-1] - p[:-1, 1:]))
    total = np.zeros_like(p)
    for rows in (slice(0, -1), slice(1, None)):
        for cols in (slice(0, -1), slice(1, None)):
            total[rows, cols] += quad
    return unit(total)


class Mesh:
    """Corners by material: positions, normals, texture coordinates, and faces of four corner numbers
    (of a triangle the last stands twice)."""

    def __init__(self):
        self.parts = {}
        self._linear, self._offset = np.eye(3), np.zeros(3)

    @contextlib.contextmanager
    def frame(self, linear=None, offset=(0.0, 0.0, 0.0)):
        """Within: local points p are placed at linear @ p + offset of the frame around."""
        kept = self._linear, self._offset
        self._offset = self._offset + self._linear @ np.asarray(offset, float)
        self._linear = self._linear @ (np.eye(3) if linear is None else linear)
        yield
        self._linear, self._offset = kept

    def add(self, material, points, normals, uvs, faces):
        """Adds corners in the current frame (a rotation) and faces of three or four corners."""
        faces = np.asarray(faces, int)
        if faces.shape[1] == 3:
            faces = faces[:, [0, 1, 2, 2]]
        points = np.asarray(points, float).reshape(-1, 3) @ self._linear.T + self._offset
        normals = unit(np.asarray(normals, float).reshape(-1, 3)) @ self._linear.T
        self.parts.setdefault(material, []).append(
            (points, normals, np.asarray(uvs, float).reshape(-1, 2), faces))

    def quad(self, material, a, b, c, d, uv=None):
        """A flat quad, counter-clockwise; UVs by its own edges (a -> b is u) or the four given."""
        p = np.asarray([a, b, c, d], float)
        n = unit(np.cross(p[1] - p[0], p[3] - p[0]))
        self.add(material, p, np.tile(n, (4, 1)), self.box_uv(material, p, n) if uv is None else uv, [[0, 1, 2, 3]])

    @staticmethod
    def box_uv(material, points, normal):
        """Texture coordinates by the dominant axis of the normal, in local metres: walls are (s, y), floors (s, -d)."""
        p, axis = np.asarray(points), int(np.argmax(np.abs(normal)))
        if axis == 0:
            uv = np.stack([-p[:, 2] * np.sign(normal[0]), p[:, 1]], axis=1)
        elif axis == 1:
            uv = np.stack([p[:, 0], -p[:, 2] * np.sign(normal[1])], axis=1)
        else:
            uv = np.stack([p[:, 0] * np.sign(normal[2]), p[:, 1]], axis=1)
        if material == "wood" and np.ptp(uv[:, 1]) > np.ptp(uv[:, 0]):  # planks lie along u
            uv = uv[:, ::-1]
        return uv / SCALE[material]

    def box(self, material, low, high, skip=""):
        """An axis-aligned box; `skip` names faces left out: l r (s), b t (y), k f (back and front, d)."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        faces = {"f": [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
                 "k": [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)],
                 "r": [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)],
                 "l": [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
                 "t": [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)],
                 "b": [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)]}
        for name, corners in faces.items():
            if name not in skip:
                self.quad(material, *corners)

    def grid(self, material, points, uvs, normals=None):
        """A patch of (rows, columns, 3) points, facing column direction x row direction; smooth normals unless
        given."""
        p = np.asarray(points, float)
        rows, cols = p.shape[:2]
        if normals is None:
            normals = sheet_normals(p)
        i = (np.arange(rows - 1)[:, None] * cols + np.arange(cols - 1)).ravel()
        self.add(material, p, normals, uvs, np.stack([i, i + 1, i + cols + 1, i + cols], 1))

    def lathe(self, material, profile, segments, closed=False, start=0.0, sweep=2.0 * math.pi, flat=False):
        """Turns a profile of (radius, y), drawn upwards for an outside, about the y axis. `flat`: faceted around."""
        angle = start + sweep * np.arange(segments + 1) / segments
        reach = max(p[0] for p in profile)
        for a, b, na, nb, ua, ub in profile_pieces(profile, closed):
            for k in range(segments) if flat else [None]:
                th = angle if k is None else angle[k:k + 2]
                tn = th if k is None else np.full(2, th.mean())
                direction = np.stack([np.cos(th), np.zeros_like(th), -np.sin(th)], 1)
                facing = np.stack([np.cos(tn), np.zeros_like(th), -np.sin(tn)], 1)
                up = np.array([0.0, 1.0, 0.0])
                points = np.stack([direction * a[0] + up * a[1], direction * b[0] + up * b[1]])
                normals = np.stack([facing * na[0] + up * na[1], facing * nb[0] + up * nb[1]])
                u = th * reach / SCALE[material]
                uvs = np.stack([np.stack([u, np.full_like(u, w / SCALE[material])], 1) for w in (ua, ub)])
                self.grid(material, points, uvs, normals)

    def run(self, material, profile, s0, s1, mitre0=0.0, mitre1=0.0, closed=False, ends=False):
        """Extrudes a profile of (d, y), drawn upwards for a face towards +d, along s; ends shift by mitre * d."""
        scale = SCALE[material]
        for a, b, na, nb, ua, ub in profile_pieces(profile, closed):
            ends_of = [(s0 + mitre0 * q[0], s1 + mitre1 * q[0]) for q in (a, b)]
            points = [[(s, q[1], q[0]) for s in e] for q, e in zip((a, b), ends_of)]
            normals = [[(0.0, n[1], n[0])] * 2 for n in (na, nb)]
            uvs = [[(s / scale, u / scale) for s in e] for u, e in zip((ua, ub), ends_of)]
            if material == "wood" and abs(s1 - s0) < ub - ua:
                uvs = [[(v, u) for u, v in row] for row in uvs]
            self.grid(material, points, uvs, np.array(normals))
        if ends:  # convex profiles only
            for s, order in ((s0, -1), (s1, 1)):
                p = np.array([(s, y, d) for d, y in profile])
                n = np.array([float(order), 0.0, 0.0])
                fan = [(0, i, i + 1) for i in range(1, len(p) - 1)]
                area = sum(np.cross(p[i] - p[0], p[j] - p[0])[0] for _, i, j in fan)
                fan = fan if area * order > 0 else [(a, c, b) for a, b, c in fan]
                self.add(material, p, np.tile(n, (len(p), 1)), self.box_uv(material, p, n), fan)

    def arc(self, material, profile, centre, y, segments, start=0.0, end=math.pi, rise=None):
        """Sweeps a profile of (radius, d) about the d axis through (centre, y). Normals stand to the left of travel:
        radius growing faces +d. `rise` (height over half width) squeezes circles into ellipses."""
        th = start + (end - start) * np.arange(segments + 1) / segments
        k = 1.0 if rise is None else rise
        scale = SCALE[material]
        for a, b, na, nb, ua, ub in profile_pieces([(r, d) for r, d in profile]):
            points = np.stack([np.stack([centre + q[0] * np.cos(th), y + k * q[0] * np.sin(th),
                                         np.full_like(th, q[1])], 1) for q in (a, b)], 1)
            normals = np.stack([np.stack([-n[0] * np.cos(th), -n[0] * np.sin(th) / k,
                                          np.full_like(th, -n[1])], 1) for n in (na, nb)], 1)
            uvs = [[(t * a[0] / scale, ua / scale), (t * a[0] / scale, ub / scale)] for t in th]
            self.grid(material, points, uvs, normals)

    def triangle_count(self):
        return sum(2 * len(part[3]) - int((part[3][:, 2] == part[3][:, 3]).sum())
                   for parts in self.parts.values() for part in parts)
