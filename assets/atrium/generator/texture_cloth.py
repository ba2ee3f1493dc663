"""The court's hangings: three curtains of figured cloth and a long banner. Their ornaments were drawn for this scene.

The device that comes back in all of them is the oil lamp (lucerna) with its flame. Lengths are in widths of the cloth,
u across, v up from the hem; none of these tile. Shapes are signed distances, negative inside.
"""
import numpy as np

from texture_kit import blend, blur, grid, inside, noise, relief, rgb, shade, step

GOLD = rgb(0.560, 0.360, 0.095)
PALE_GOLD = rgb(0.640, 0.485, 0.215)


# ------------------------------------------------------------------------------------ shapes

def disc(x, y, radius):
    return np.hypot(x, y) - radius


def ring(x, y, radius, half):
    return np.abs(disc(x, y, radius)) - half


def petal(x, y, reach, half):
    """Pointed at both ends, along y from -reach to reach, 2 half wide in its middle."""
    radius = (reach * reach + half * half) / (2 * half)
    return np.hypot(np.abs(x) + radius - half, y) - radius


def turned(x, y, degrees):
    """x and y in a frame turned anticlockwise."""
    a = np.radians(degrees)
    return x * np.cos(a) + y * np.sin(a), y * np.cos(a) - x * np.sin(a)


def petals(x, y, count, near, far, half, start=0.0):
    """Petals in a circle, from radius near to far; the first points up, turned by start degrees."""
    angle = np.arctan2(x, y) + np.radians(start)
    sector = 2 * np.pi / count
    angle = (angle + sector / 2) % sector - sector / 2
    r = np.hypot(x, y)
    return petal(r * np.sin(angle), r * np.cos(angle) - (near + far) / 2, (far - near) / 2, half)


def flame(x, y, size):
    """A flame that stands on the origin, size high, its tip swaying."""
    t = np.clip(y / size, 0.0, 1.0)
    sway = 0.13 * size * np.sin(2.6 * np.pi * t) * t
    half = 0.50 * size * np.sin(np.pi * t ** 0.62) * (1.0 - 0.45 * t)
    return np.maximum(0.8 * (np.abs(x - sway) - half), np.maximum(-y, y - size))


def lamp(x, y, size):
    """An oil lamp: shallow bowl with a spout to either side, foot and collar. The flame stands at y = 0.34 size."""
    bowl = np.maximum(np.hypot(0.74 * x, y - 0.30 * size) - 0.40 * size, y - 0.26 * size)
    spouts = petal(*turned(np.abs(x) - 0.47 * size, y - 0.24 * size, -62), 0.26 * size, 0.062 * size)
    collar = np.maximum(np.abs(x) - 0.24 * size, np.abs(y - 0.29 * size) - 0.028 * size)
    stem = np.maximum(np.abs(x) - 0.055 * size - 0.10 * np.abs(y + 0.15 * size), np.abs(y + 0.17 * size) - 0.11 * size)
    foot = np.maximum(np.abs(x) - 0.26 * size, np.abs(y + 0.30 * size) - 0.030 * size)
    return np.minimum.reduce([bowl, spouts, collar, stem, foot])


def lit_lamp(x, y, size, rays=9):
    """The lamp, its flame and rays about it; fits a circle of about radius size around the origin."""
    y = y + 0.34 * size
    fan = np.full(x.shape, 1.0)
    for k in range(rays):
        angle = -96 + 192 * k / (rays - 1)
        a, b = turned(x, y - 0.50 * size, angle)
        fan = np.minimum(fan, petal(a, b - 0.74 * size, (0.17 if k % 2 else 0.11) * size, 0.030 * size))
    return np.minimum.reduce([lamp(x, y, size), flame(x, y - 0.36 * size, 0.58 * size), fan])


def rosette(x, y, size):
    """Eight pointed petals with veins left open, small ones between, a ring of beads."""
    open_vein = petals(x, y, 8, 0.30 * size, 0.72 * size, 0.018 * size)
    big = np.maximum(petals(x, y, 8, 0.20 * size, 0.86 * size, 0.125 * size), -open_vein)
    small = petals(x, y, 8, 0.50 * size, 0.96 * size, 0.050 * size, 22.5)
    angle = (np.arctan2(x, y) % (np.pi / 4)) - np.pi / 8
    r = np.hypot(x, y)
    beads = np.hypot(r * np.sin(angle), r * np.cos(angle) - 1.06 * size) - 0.045 * size
    return np.minimum.reduce([big, small, beads, ring(x, y, 0.155 * size, 0.028 * size), disc(x, y, 0.075 * size)])


def sprig(x, y, size):
    """A stem with three pairs of leaves and a bud that opens like a flame."""
    stem = np.maximum(np.abs(x) - 0.022 * size, np.abs(y + 0.25 * size) - 0.62 * size)
    leaves = np.full(x.shape, 1.0)
    for k, (at, reach) in enumerate([(-0.62, 0.30), (-0.34, 0.29), (-0.06, 0.25)]):
        a, b = turned(np.abs(x) - 0.02 * size, y - at * size, -52 + 6 * k)
        vein = petal(a, b - reach * size, 0.72 * reach * size, 0.012 * size)
        leaves = np.minimum(leaves, np.maximum(petal(a, b - reach * size, reach * size, 0.098 * size), -vein))
    bud = np.maximum(petal(x, y - 0.52 * size, 0.40 * size, 0.22 * size),
                     -petal(x, y - 0.50 * size, 0.26 * size, 0.085 * size))
    cup = np.maximum(ring(x, y - 0.36 * size, 0.25 * size, 0.030 * size), y - 0.30 * size)
    return np.minimum.reduce([stem, leaves, bud, cup, petal(x, y - 0.50 * size, 0.19 * size, 0.045 * size)])


# ------------------------------------------------------------------------------------ cloth

def weave(shape, seed, coarse=1.0):
    """Height of woven threads: a twill's diagonal, uneven warp and weft, slubs. Mean about 0, deviation about 1."""
    height, width = shape
    rng = np.random.default_rng(seed)
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    twill = np.sin(2 * np.pi * (columns + 2 * rows) / 6.0)
    warp_threads = rng.standard_normal(width)[None, :]
    weft_threads = rng.standard_normal(height)[:, None]
    slubs = (noise(shape, seed + 1, 30, 250, 0.1, stretch=(14.0, 1.0)) +
             0.7 * noise(shape, seed + 2, 30, 250, 0.1, stretch=(1.0, 22.0)))
    return coarse * (0.35 * twill + 0.35 * warp_threads + 0.45 * weft_threads) + 0.45 * slubs


def stitched(cloth, thread, amount, height, slant):
    """Lays embroidery of a colour onto cloth where amount is 1; returns cloth and height with the stitches' relief."""
    rows, columns = np.indices(amount.shape)
    stitch = np.sin(2 * np.pi * (columns + slant * rows) / 5.0)
    uneven = noise(amount.shape, 900 + slant, 8, 120, 0.5)
    colour = shade(thread * np.ones(amount.shape + (3,)), np.exp(0.13 * stitch + 0.09 * uneven))
    shadow = 0.34 * blur(amount, 2.2) * (1.0 - amount)
    return (blend(shade(cloth, 1.0 - shadow), colour, amount),
            height * (1 - 0.6 * amount) + 2.0 * blur(amount, 1.2) + 0.35 * amount * stitch)


def lattice(u, v, across, up):
    """Ogee lattice: local coordinates from the nearest centre (alternate rows shifted) and the net's signed
    distance."""
    best = None
    for shift in (0.0, 0.5):
        x = (u / across + shift) % 1.0 - 0.5
        y = (v / up + shift) % 1.0 - 0.5
        near = np.abs(x) + np.abs(y) < 0.5
        if best is None:
            best = (x * across, y * up)
        best = (np.where(near, x * across, best[0]), np.where(near, y * up, best[1]))
    x, y = best
    # The sides of each lozenge swing out near its waist and in near its tips, as an ogee's do.
    half = 0.25 * across * (1.0 + np.cos(2 * np.pi * y / up))
    net = np.minimum(np.abs(np.abs(x) - half), np.abs(0.5 * across - np.abs(x) + 0.5 * (half - 0.5 * across)) + 1.0)
    return x, y, net / np.sqrt(1.0 + (0.5 * np.pi * across / up * np.sin(2 * np.pi * y / up)) ** 2)


def curtain(ground, shadow, thread, accent, motif, seed, across, up, motif_size):
    """Figured cloth with a net and motifs in metal thread, braid along its edges, a rich border and fringe at the
    hem."""
    width, height = 512, 1024
    shape = (height, width)
    pixel = 1.0 / width
    u, v = grid(width, height, 1.0, 2.0)
    u = u + 0.0016 * noise(shape, seed, 2, 16, 1.0)
    v = v + 0.0016 * noise(shape, seed + 1, 2, 16, 1.0)
    threads = weave(shape, seed + 2)
    cloth = blend(ground, shadow, 0.30 * step(-1.5, 2.0, noise(shape, seed + 5, 2, 14, 1.0)))
    # Damask figure in the ground, the same colour at another angle of the thread.
    x, y, net = lattice(u - 0.5, v - 0.51, across, up)
    damask = inside(np.minimum(petals(x, y, 4, 0.055, 0.185, 0.030), ring(x, y, 0.132, 0.006) + 0.3 * np.abs(x)), pixel)
    damask = np.maximum(damask, inside(np.abs(net) - 0.016, pixel))
    cloth = blend(cloth, shadow, 0.62 * damask)
    relief_height = 0.8 * threads
    field = (v > 0.35) & (v < 1.95) & (np.abs(u - 0.5) < 0.47)
    figures = np.where(field, np.minimum(motif(x, y, motif_size), np.abs(net) - 0.0042), 1.0)
    cloth, relief_height = stitched(cloth, thread, inside(figures, pixel), relief_height, 1)
    dots = np.where(field, np.minimum(np.hypot(x, np.abs(y) - 0.5 * up),
                                      np.hypot(np.abs(x) - 0.5 * across, y)) - 0.017, 1.0)
    cloth, relief_height = stitched(cloth, accent, inside(dots, pixel), relief_height, -1)

    # Hem: an arcade of flames between braids; all on a darker band.
    band = inside(np.abs(v - 0.205) - 0.150, pixel)
    cloth = blend(cloth, 0.5 * cloth + 0.2 * shadow, band)
    pitch = 0.932 / 7
    a = ((u - 0.034) % pitch) - 0.5 * pitch
    arch = np.maximum(ring(a, v - 0.232, 0.053, 0.0050), -(v - 0.232))
    posts = np.maximum(np.abs(np.abs(a) - 0.053) - 0.0050, np.abs(v - 0.176) - 0.056)
    sill = np.abs(v - 0.108) - 0.0055
    buds = np.minimum(lamp(a, v - 0.152, 0.074), flame(a, v - 0.180, 0.066))
    spandrel = np.hypot(np.abs(a) - 0.5 * pitch, v - 0.296) - 0.0125
    cloth, relief_height = stitched(cloth, thread, inside(np.minimum.reduce([arch, posts, sill, spandrel]), pixel),
                                    relief_height, -1)
    cloth, relief_height = stitched(cloth, accent, inside(buds, pixel), relief_height, 1)

    # Braids: along both edges, above and below the hem's band, at the head.
    side = np.abs(np.abs(u - 0.5) - 0.476) - 0.010
    bars = np.minimum.reduce([np.abs(v - 0.348) - 0.012, np.abs(v - 0.066) - 0.012, np.abs(v - 1.955) - 0.012])
    braid = np.minimum(side, bars)
    cloth, relief_height = stitched(cloth, thread * 0.92, inside(braid, pixel), relief_height, 2)
    plait = np.where(side < bars, np.sin(2 * np.pi * (v / 0.022)), np.sin(2 * np.pi * (u / 0.022)))
    cloth = shade(cloth, 1.0 + 0.22 * plait * inside(braid + 0.003, pixel))
    # Fringe: bundles of thread below the lowest braid.
    tassels = np.abs(np.sin(np.pi * u / 0.0156 + 0.3 * noise(shape, seed + 6, 4, 40)))
    fringe = inside(v - 0.054, pixel)
    cloth = blend(cloth, shade(thread * np.ones(shape + (3,)), 0.34 + 0.62 * tassels ** 0.8), fringe)

    # Wear: paler along the folds it has hung in, dusty at the hem, bleached towards the head.
    folds = np.repeat(noise(shape, seed + 7, 5, 40, 0.5, stretch=(1.0, 30.0)).mean(0, keepdims=True), height, 0)
    cloth = shade(cloth, np.exp(0.055 * threads + 0.08 * folds + 0.03 * noise(shape, seed + 8, 3, 60, 0.8)))
    dust = 0.22 * step(0.55, 0.0, v) * step(-1.2, 1.6, noise(shape, seed + 9, 2, 30, 0.9))
    cloth = blend(cloth, rgb(0.33, 0.27, 0.20), dust)
    cloth = blend(cloth, cloth * 1.06 + 0.012, step(0.9, 2.0, v))
    return shade(cloth, relief(relief_height, 0.17))


def curtain_red():
    """Madder red with lit lamps."""
    return curtain(rgb(0.485, 0.038, 0.034), rgb(0.235, 0.022, 0.026), GOLD, PALE_GOLD, lit_lamp, 1000, 0.30, 0.428,
                   0.100)


def curtain_teal():
    """Teal with rosettes."""
    return curtain(rgb(0.032, 0.395, 0.415), rgb(0.030, 0.165, 0.195), GOLD, PALE_GOLD, rosette, 1100, 0.30, 0.428,
                   0.096)


def curtain_ochre():
    """Ochre with sprigs in madder, edged in pale gold."""
    return curtain(rgb(0.560, 0.310, 0.042), rgb(0.380, 0.175, 0.032), rgb(0.290, 0.052, 0.034), PALE_GOLD, sprig, 1200,
                   0.30, 0.428, 0.120)


# ------------------------------------------------------------------------------------ banner

def banner():
    """Long heraldic banner: azure with the golden lamp, a dancing chevron; gules below with a rosette and two stars; a
    chequered foot."""
    width, height = 512, 1024
    shape = (height, width)
    pixel = 1.0 / width
    u, v = grid(width, height, 1.0, 2.0)
    u = u + 0.0014 * noise(shape, 1300, 2, 16, 1.0)
    v = v + 0.0014 * noise(shape, 1301, 2, 16, 1.0)
    threads = weave(shape, 1302)
    x = u - 0.5
    azure, gules, cream = rgb(0.032, 0.082, 0.260), rgb(0.430, 0.034, 0.034), rgb(0.640, 0.560, 0.410)
    height_field = 0.8 * threads

    # Party per chevron: azure above, gules below, a cream chevron with dancing edge between.
    chevron = v - 0.92 + 0.62 * np.abs(x)
    cloth = blend(azure * np.ones(shape + (3,)), gules, inside(chevron / 1.18, pixel))
    diaper = np.minimum.reduce([np.abs(((u + s * v) / 0.11) % 1.0 - 0.5) * 0.11 / 1.42 for s in (1.0, -1.0)])
    knots = np.hypot(((u + v) / 0.11 + 0.5) % 1.0 - 0.5, ((u - v) / 0.11 + 0.5) % 1.0 - 0.5) * 0.078 - 0.011
    cloth = blend(cloth, cloth * 0.52, 0.8 * inside(np.minimum(diaper - 0.0022, knots), pixel))
    zigzag = np.abs((x / 0.09) % 1.0 - 0.5) * 0.05 - 0.0125
    bar = np.abs((chevron + zigzag) / 1.18) - 0.058
    cloth, height_field = stitched(cloth, cream, inside(bar, pixel), height_field, 1)
    rim = np.abs(bar) - 0.0065
    cloth, height_field = stitched(cloth, GOLD, inside(rim, pixel), height_field, -1)
    # The lamp in its ring of rays.
    cx, cy = x, v - 1.44
    halo = np.minimum(ring(cx, cy, 0.318, 0.007), ring(cx, cy, 0.292, 0.0035))
    tips = petals(cx, cy, 24, 0.330, 0.385, 0.011)
    cloth, height_field = stitched(cloth, GOLD, inside(np.minimum(halo, tips), pixel), height_field, 2)
    size = 0.285
    base = -0.34 * size  # of the lamp, below the ring's centre
    device = lit_lamp(cx, cy, size, 11)
    cloth, height_field = stitched(cloth, PALE_GOLD, inside(device, pixel), height_field, 1)
    cloth, height_field = stitched(cloth, gules, inside(flame(cx, cy - base - 0.40 * size, 0.31 * size), pixel),
                                   height_field, -1)
    grooves = np.abs(np.hypot(0.74 * cx, cy - base - 0.30 * size) - 0.31 * size) - 0.003
    cloth = blend(cloth, cloth * 0.45, inside(np.maximum(grooves, cy - base - 0.21 * size), pixel))
    # A rosette between two stars of six points in the gules.
    for sx, sy in ((-0.235, 0.520), (0.235, 0.520)):
        star = petals(x - sx, v - sy, 6, -0.02, 0.085, 0.024)
        cloth, height_field = stitched(cloth, PALE_GOLD, inside(np.minimum(star, disc(x - sx, v - sy, 0.030)), pixel),
                                       height_field, 1)
    cloth, height_field = stitched(cloth, PALE_GOLD, inside(rosette(x, v - 0.530, 0.150), pixel), height_field, -1)

    # Foot: two rows of chequers; border of braid all round; fringe.
    squares = (np.floor(u / 0.0625) + np.floor((v - 0.115) / 0.0625)) % 2
    foot = inside(np.abs(v - 0.1775) - 0.0625, pixel)
    cloth = blend(cloth, np.where((squares > 0)[..., None], cream, azure), foot)
    frame = np.minimum(np.abs(np.abs(x) - 0.470) - 0.014, np.minimum.reduce(
        [np.abs(v - 1.955) - 0.015, np.abs(v - 0.092) - 0.013, np.abs(v - 0.258) - 0.013]))
    cloth, height_field = stitched(cloth, GOLD, inside(frame, pixel), height_field, 2)
    plait = np.where(np.abs(np.abs(x) - 0.470) < 0.014, np.sin(2 * np.pi * v / 0.026), np.sin(2 * np.pi * u / 0.026))
    cloth = shade(cloth, 1.0 + 0.24 * plait * inside(frame + 0.004, pixel))
    tassels = np.abs(np.sin(np.pi * u / 0.0156 + 0.3 * noise(shape, 1306, 4, 40)))
    cloth = blend(cloth, shade(GOLD * np.ones(shape + (3,)), 0.34 + 0.62 * tassels ** 0.8), inside(v - 0.079, pixel))

    folds = np.repeat(noise(shape, 1307, 4, 40, 0.5, stretch=(1.0, 30.0)).mean(0, keepdims=True), height, 0)
    cloth = shade(cloth, np.exp(0.055 * threads + 0.04 * folds + 0.03 * noise(shape, 1308, 3, 60, 0.8)))
    cloth = blend(cloth, rgb(0.33, 0.27, 0.20),
                  0.12 * step(0.5, 0.0, v) * step(-1.2, 1.6, noise(shape, 1309, 2, 30, 0.9)))
    return shade(cloth, relief(height_field, 0.17))
