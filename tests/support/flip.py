"""FLIP in plain Python, a second time: whole two-dimensional kernels, nothing separated [Andersson2020],
[Andersson2021]. Slow; for small pictures.
python3 tests/support/flip.py prints the means that tests/unit/image_errors_test.cpp expects of the pictures made below.
"""
import math

PPD = 0.7 * 3840 / 0.7 * math.pi / 180
XYZ = [[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
       [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
       [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]]


def times(m, v): return [sum(a * b for a, b in zip(row, v)) for row in m]


def inverse(m):
    """By Gauss-Jordan elimination."""
    rows = [list(row) + [float(i == j) for j in range(3)] for i, row in enumerate(m)]
    for i in range(3):
        rows[i] = [v / rows[i][i] for v in rows[i]]
        for j in range(3):
            if j != i: rows[j] = [a - rows[j][i] * b for a, b in zip(rows[j], rows[i])]
    return [row[3:] for row in rows]


RGB = inverse(XYZ)
WHITE = times(XYZ, [1, 1, 1])


def opponent(rgb):
    x, y, z = (a / w for a, w in zip(times(XYZ, rgb), WHITE))
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def from_opponent(c):
    y = (c[0] + 16) / 116
    return times(RGB, [w * v for w, v in zip(WHITE, (y + c[1] / 500, y, y - c[2] / 200))])


def hunt(rgb):
    f = lambda t: t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    x, y, z = (f(a / w) for a, w in zip(times(XYZ, rgb), WHITE))
    l = 116 * y - 16
    return [l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)]


def hyab(a, b): return abs(a[0] - b[0]) + math.hypot(a[1] - b[1], a[2] - b[2])


def filtered(plane, kernel, radius):
    height, width = len(plane), len(plane[0])
    at = lambda x, y: plane[min(max(y, 0), height - 1)][min(max(x, 0), width - 1)]
    return [[sum(kernel[j + radius][i + radius] * at(x + i, y + j) for j in range(-radius, radius + 1)
                 for i in range(-radius, radius + 1))
             for x in range(width)] for y in range(height)]


def sensitivity(terms):
    """The filter of one channel, summing to 1: terms are (a, b)."""
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * PPD)
    k = [[sum(a * math.sqrt(math.pi / b) * math.exp(-math.pi ** 2 * (x * x + y * y) / PPD ** 2 / b) for a, b in terms)
          for x in range(-radius, radius + 1)] for y in range(-radius, radius + 1)]
    total = sum(map(sum, k))
    return [[v / total for v in row] for row in k], radius


def detector(point):
    """First or second derivative along x; positive weights sum to 1, negative ones to -1."""
    sd = 0.5 * 0.082 * PPD
    radius = math.ceil(3 * sd)
    k = [[((x * x / sd ** 2 - 1) if point else -x) * math.exp(-(x * x + y * y) / (2 * sd * sd))
          for x in range(-radius, radius + 1)] for y in range(-radius, radius + 1)]
    up, down = sum(v for row in k for v in row if v > 0), -sum(v for row in k for v in row if v < 0)
    return [[v / (up if v > 0 else down) for v in row] for row in k], radius


CSF = [sensitivity([(1, 0.0047)]), sensitivity([(1, 0.0053)]), sensitivity([(34.1, 0.04), (13.5, 0.025)])]
EDGE, POINT = detector(False), detector(True)
MOST = hyab(hunt([0, 1, 0]), hunt([0, 0, 1])) ** 0.7


def prepared(picture):
    """Hunt-adjusted colours as they are seen, and strengths of edges and points."""
    planes = [[[opponent([min(max(v, 0), 1) for v in p])[c] for p in row] for row in picture] for c in range(3)]
    seen = [filtered(plane, *CSF[c]) for c, plane in enumerate(planes)]
    colour = [[hunt([min(max(v, 0), 1) for v in from_opponent([seen[c][y][x] for c in range(3)])])
               for x in range(len(picture[0]))] for y in range(len(picture))]
    grey = [[(v + 16) / 116 for v in row] for row in planes[0]]
    strengths = []
    for kernel, radius in (EDGE, POINT):
        along = filtered(grey, kernel, radius), filtered(grey, [list(row) for row in zip(*kernel)], radius)
        strengths.append([[math.hypot(a, b) for a, b in zip(r, s)] for r, s in zip(*along)])
    return colour, strengths


def ldr(test, reference):
    (a, fa), (b, fb) = prepared(test), prepared(reference)
    result = []
    for y in range(len(test)):
        for x in range(len(test[0])):
            d, split = hyab(a[y][x], b[y][x]) ** 0.7, 0.4 * MOST
            d = 0.95 / split * d if d < split else 0.95 + (d - split) / (MOST - split) * 0.05
            feature = max(abs(fa[k][y][x] - fb[k][y][x]) for k in range(2))
            result.append(d ** (1 - math.sqrt(feature / math.sqrt(2))))
    return result


def hdr(test, reference):
    def curve(v):
        x = 0.6 * max(v, 0)
        return min(max(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0), 1)
    a, b, c = 2.51 - 0.85 * 2.43, 0.03 - 0.85 * 0.59, -0.85 * 0.14
    bright = (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a) / 0.6
    luminance = sorted(times(XYZ, p)[1] for row in reference for p in row)
    n = len(luminance)
    middle = 0.5 * (luminance[(n - 1) // 2] + luminance[n // 2])
    start, stop = math.log2(bright / luminance[-1]), math.log2(bright / middle)
    count = max(2, math.ceil(stop - start))
    worst = [0.0] * n
    for i in range(count):
        scale = 2 ** (start + (stop - start) * i / (count - 1))
        expose = lambda picture: [[[curve(scale * v) for v in p] for p in row] for row in picture]
        worst = [max(u, v) for u, v in zip(worst, ldr(expose(test), expose(reference)))]
    return worst


# The pictures: a lattice of colours with an edge and a spot; the other one has the edge elsewhere, a tint and no spot.
def reference(x, y):
    return [0.1 + 0.8 * (x % 5) / 4, 0.9 - 0.7 * (y % 4) / 3,
            0.2 + 0.5 * (x >= 9) + (0.3 if (x, y) == (4, 5) else 0)]
def test(x, y): return [0.1 + 0.8 * (x % 5) / 4, 0.85 - 0.7 * (y % 4) / 3, 0.25 + 0.5 * (x >= 11)]


if __name__ == '__main__':
    def mean(values): return sum(values) / len(values)
    pictures = [[[f(x, y) for x in range(16)] for y in range(12)] for f in (test, reference)]
    print('LDR', mean(ldr(*pictures)), 'of pixel 4, 5', ldr(*pictures)[5 * 16 + 4])
    # In HDR the same, squared and times 40: from black to far beyond white.
    pictures = [[[[40 * v * v for v in p] for p in row] for row in picture] for picture in pictures]
    print('HDR', mean(hdr(*pictures)))
