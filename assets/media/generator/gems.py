"""Cuts of gems as planes [Webster1994, names and usual angles]: round and oval brilliant, emerald (step) cut, rose
cut. The girdle's radius is 1 before scaling."""
import math

from .mesh import convex, rotation_between, unit


def facet(azimuth, angle, point, down=False):
    """A plane that leans `angle` degrees from level towards `azimuth`, through (radius, y, azimuth of that point)."""
    a, t = math.radians(azimuth), math.radians(angle)
    y = -math.cos(t) if down else math.cos(t)
    n = (math.sin(t) * math.cos(a), y, math.sin(t) * math.sin(a))
    r, height, at = point
    p = (r * math.cos(math.radians(at)), height, r * math.sin(math.radians(at)))
    return n, n[0] * p[0] + n[1] * p[1] + n[2] * p[2]


def brilliant():
    """57 facets and a girdle: 8 kites and 8 pavilion mains; stars, upper and lower halves between them."""
    girdle, table = 0.025, 0.57
    crown, star, upper, pavilion, lower = 34.5, 21.0, 40.5, 40.8, 42.0
    top = girdle + (1.0 - table) * math.tan(math.radians(crown))
    planes = [((0, 1, 0), top), ((0, -1, 0), girdle + 0.98 * math.tan(math.radians(pavilion)))]
    for k in range(8):
        at = 45.0 * k
        planes.append(facet(at, crown, (1.0, girdle, at)))
        planes.append(facet(at + 22.5, star, (table, top, at)))
        planes.append(facet(at, pavilion, (1.0, -girdle, at), down=True))
        for side in (-11.25, 11.25):
            planes.append(facet(at + side, upper, (1.0, girdle, at)))
            planes.append(facet(at + side, lower, (1.0, -girdle, at), down=True))
    planes += [facet(360.0 * k / 96, 90.0, (math.cos(math.pi / 96), 0.0, 360.0 * k / 96)) for k in range(96)]
    return planes


def emerald():
    """An oblong with cut corners; three steps of crown and three of pavilion on each of its eight sides."""
    sides = [(0.0, 1.0), (180.0, 1.0), (90.0, 0.74), (270.0, 0.74)] + [(a, 0.99) for a in (45.0, 135.0, 225.0, 315.0)]
    girdle = 0.03
    planes = []
    for at, distance in sides:
        planes.append(facet(at, 90.0, (distance, 0.0, at)))
        inset, y = 0.0, girdle
        for angle, width in ((47.0, 0.11), (38.0, 0.11), (28.0, 0.11)):
            planes.append(facet(at, angle, (distance - inset, y, at)))
            inset, y = inset + width, y + width * math.tan(math.radians(angle))
        top = y
        inset, y = 0.0, -girdle
        for angle, width in ((52.0, 0.16), (46.0, 0.2), (39.0, 0.3)):
            planes.append(facet(at, angle, (distance - inset, y, at), down=True))
            inset, y = inset + width, y - width * math.tan(math.radians(angle))
    return planes + [((0, 1, 0), top)]


def rose():
    """A flat base under a dome of 6 star, 6 and 12 lower facets."""
    planes = [((0, -1, 0), 0.0)]
    rim = 0.1
    planes += [facet(360.0 * k / 48, 90.0, (math.cos(math.pi / 48), 0.0, 360.0 * k / 48)) for k in range(48)]
    for k in range(12):
        planes.append(facet(30.0 * k + 15.0, 52.0, (1.0, rim, 30.0 * k)))
    for k in range(6):
        planes.append(facet(60.0 * k, 41.0, (0.93, 0.2, 60.0 * k)))
        planes.append(facet(60.0 * k + 30.0, 23.0, (0.0, 0.66, 0.0)))
    return planes


def scaled(planes, x, y, z):
    """The same planes after a scaling along the axes."""
    result = []
    for n, d in planes:
        m = (n[0] / x, n[1] / y, n[2] / z)
        length = math.sqrt(m[0] ** 2 + m[1] ** 2 + m[2] ** 2)
        result.append((unit(m), d / length))
    return result


def resting(part, azimuth, angle):
    """Laid on the pavilion facet nearest to that azimuth and angle, its lowest point 0.02 above the floor."""
    want = (math.sin(math.radians(angle)) * math.cos(math.radians(azimuth)), -math.cos(math.radians(angle)),
            math.sin(math.radians(angle)) * math.sin(math.radians(azimuth)))
    normals = [unit(part.face_normal(f)) for f in part.faces]
    down = max(normals, key=lambda n: n[0] * want[0] + n[1] * want[1] + n[2] * want[2])
    part.placed(rotation_between(down, (0.0, -1.0, 0.0)))
    return part.placed(offset=(0.0, 0.02 - part.low(), 0.0))


def gem(name, material, planes, size):
    return convex(name, material, scaled(planes, *size))
