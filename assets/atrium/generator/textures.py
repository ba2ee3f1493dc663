"""Paints the textures of the atrium scene: python3 assets/atrium/generator/textures.py [NAME...]

Writes ../textures/NAME.png, all or those named. Needs numpy. The same seeds give the same pictures, bit by bit.
Every texture is made for this scene from noise and drawn shapes; nothing is taken from photographs or libraries.

What tiles:            metres a tile (u x v)
  limestone            2 x 2      ashlar, four courses; also cut into columns' drums and voussoirs
  plaster              3 x 3
  stone_trim           1 x 1      smooth stone of cornices, bases and balusters
  floor                2 x 2      diagonal slabs of two stones
  floor_border         1 x 0.5    inlaid band, repeats along u only
  terracotta           1 x 1
  wood                 1 x 1      four planks along u
What does not: curtain_red, curtain_teal, curtain_ochre, banner (see texture_cloth.py), leaf, leaf_mask
(texture_leaf.py).
"""
import pathlib
import sys

import numpy as np

import texture_cloth
import texture_leaf
from texture_kit import (blend, blur, grid, inside, noise, relief, rgb, sample, shade, srgb_bytes, step, veins, warp,
                         write_png)


# ------------------------------------------------------------------------------------ ashlar

def ashlar(x, y, courses, tile, radius):
    """Blocks in courses: number of each pixel's block and signed distance to its rounded edge (negative inside).

    courses: from the bottom, (height, x of the vertical joints in [0, tile)); all in units of x and y.
    """
    x, y = x % tile, y % tile
    number = np.zeros(x.shape, dtype=int)
    distance = np.full(x.shape, np.inf)
    bottom, count = 0.0, 0
    for height, joints in courses:
        for i, left in enumerate(joints):
            width = (joints[(i + 1) % len(joints)] - left) % tile or tile
            along = (x - left) % tile
            here = (y >= bottom) & (y < bottom + height) & (along < width)
            dx = np.abs(along - 0.5 * width) - 0.5 * width + radius
            dy = np.abs(y - bottom - 0.5 * height) - 0.5 * height + radius
            box = np.hypot(np.maximum(dx, 0), np.maximum(dy, 0)) + np.minimum(np.maximum(dx, dy), 0) - radius
            distance = np.where(here, box, distance)
            number = np.where(here, count, number)
            count += 1
        bottom += height
    return number, distance


def each(number, values):
    """A field that holds for each pixel the value of its block or slab."""
    return np.asarray(values)[number]


def limestone():
    """Ashlar of warm limestone: bedding, shell pits, worn and chipped edges, lime mortar, streaks of rain."""
    size, tile = 1024, 2.0
    shape = (size, size)
    metre = size / tile
    courses = [(0.56, [0.13, 0.98, 1.52]), (0.46, [0.42, 1.06, 1.78]), (0.52, [0.20, 0.72, 1.44]),
               (0.46, [0.55, 1.20, 1.90])]
    x, y = grid(size, size, tile, tile)
    wobble = 0.0016
    x_edge = x + wobble * noise(shape, 11, 6, 90, 0.7)
    y_edge = y + wobble * noise(shape, 12, 6, 90, 0.7)
    number, distance = ashlar(x_edge, y_edge, courses, tile, 0.014)
    distance = distance * metre + 4.0  # pixels, joints of about 8 px
    # Chips: bites out of the edges, where noise is high.
    bite = np.maximum(noise(shape, 13, 14, 120, 0.6) - 1.75, 0.0)
    distance = distance + 7.0 * bite * step(-22, 0, distance)
    stone = inside(distance, 2.0)

    rng = np.random.default_rng(14)
    blocks = number.max() + 1
    offset_x, offset_y = each(number, rng.uniform(0, size, blocks)), each(number, rng.uniform(0, size, blocks))
    columns, rows = np.meshgrid(np.arange(size, dtype=float), np.arange(size, dtype=float))

    def in_block(field):
        """The field, from another place for each block, so that no pattern runs on across a joint."""
        return sample(field, columns + offset_x, rows + offset_y)

    bedding = in_block(noise(shape, 15, 3, 60, 0.8, stretch=(2.4, 0.6)))
    cloud = in_block(noise(shape, 16, 2, 16, 1.0))
    mottle = in_block(noise(shape, 17, 14, 90, 0.7))
    grain = noise(shape, 18, 90, 400, 0.2)
    tooled = in_block(warp(noise(shape, 19, 40, 130, 0.0, stretch=(0.5, 2.5)),
                           *[4 * noise(shape, s, 2, 9) for s in (20, 21)]))

    tone = each(number, rng.permutation(np.linspace(-1.0, 1.0, blocks)))
    honey = each(number, rng.uniform(0.0, 1.0, blocks))
    colour = blend(rgb(0.575, 0.510, 0.400), rgb(0.585, 0.475, 0.325), honey)
    colour = shade(colour, np.exp(0.125 * tone + 0.030 * bedding + 0.040 * cloud + 0.026 * mottle + 0.030 * grain +
                                  0.014 * tooled))
    iron = step(0.9, 2.6, in_block(noise(shape, 22, 2, 22, 1.0)))  # rusty clouds
    colour = blend(colour, colour * rgb(1.0, 0.86, 0.66), 0.55 * iron)
    pits = step(1.7, 2.5, in_block(noise(shape, 23, 50, 190, 0.3))) * step(-0.6, 0.9, in_block(noise(shape, 24, 3, 14)))
    colour = shade(colour, 1.0 - 0.34 * pits)
    shells = step(1.9, 2.4, in_block(noise(shape, 25, 40, 110, 0.2, stretch=(1.6, 0.7))))
    colour = blend(colour, rgb(0.66, 0.61, 0.52), 0.45 * shells)

    # Edges: rubbed pale at the arris, dirty just outside it; height makes the joint's shadow.
    arris = np.exp(-((distance + 5.0) / 4.0) ** 2) * step(-0.8, 1.0, noise(shape, 26, 4, 40))
    colour = shade(colour, 1.0 + 0.07 * arris)
    height = (3.0 * step(2.0, -7.0, distance - 5.0 * np.minimum(bite, 1.0)) - 1.2 * pits + 0.35 * mottle +
              0.2 * grain + 0.35 * tooled)
    mortar = shade(rgb(0.47, 0.41, 0.32) * np.ones(shape + (3,)),
                   np.exp(0.07 * noise(shape, 27, 60, 330, 0.2) + 0.07 * noise(shape, 28, 3, 20)))
    colour = blend(mortar, colour, stone)
    colour = shade(colour, 1.0 - 0.22 * np.exp(-((distance - 1.0) / 2.2) ** 2) * step(0.5, 0.0, bite))
    colour = shade(colour, relief(height, 0.17))

    # Dirt: soft in and below the joints, and thin streaks of rain.
    joint = (1.0 - stone)
    below = sum(np.roll(blur(joint, 2.5 + 2 * k), 5 * k, 0) for k in range(5)) / 5.0
    patchy = step(-0.7, 1.6, noise(shape, 29, 2, 20))
    streak = step(0.3, 2.4, noise(shape, 30, 3, 70, 0.5, stretch=(1.0, 9.0)))
    soot = 0.95 * below * patchy + 0.20 * streak + 0.05 * step(0.2, 2.0, noise(shape, 31, 1.5, 7))
    return blend(colour, colour * rgb(0.60, 0.555, 0.49), np.clip(soot, 0, 1))


# ------------------------------------------------------------------------------------ plaster, trim, clay

def plaster():
    """Lime plaster: trowel sweeps, water stains with rims, a few repairs and hair cracks."""
    size = 1024
    shape = (size, size)
    bend = [26 * noise(shape, s, 2, 7, 1.0) for s in (41, 42)]
    trowel = warp(noise(shape, 43, 8, 150, 0.75, stretch=(3.2, 0.8)), *bend)
    trowel = 0.6 * trowel + 0.4 * warp(noise(shape, 44, 8, 120, 0.75, stretch=(0.8, 2.6)), *bend)
    cloud = noise(shape, 45, 2, 14, 1.1)
    sand = noise(shape, 46, 120, 420, 0.1)
    colour = blend(rgb(0.715, 0.655, 0.540), rgb(0.695, 0.600, 0.450), step(-1.4, 1.6, noise(shape, 47, 2, 9, 1.0)))
    colour = shade(colour, np.exp(0.026 * trowel + 0.030 * cloud + 0.014 * sand))
    # Repairs: patches of a fresher mix with their own edge.
    patch = noise(shape, 48, 2, 40, 1.4)
    repaired = step(1.22, 1.30, patch)
    colour = blend(colour, shade(colour, 1.0 + 0.012 * sand) * rgb(1.045, 1.055, 1.085), 0.45 * repaired)
    colour = shade(colour, 1.0 - 0.03 * np.exp(-((patch - 1.26) / 0.035) ** 2))
    # Stains: damp that dried, darker at its rim.
    damp = warp(noise(shape, 49, 2, 40, 1.5), *[6 * noise(shape, s, 8, 60, 0.8) for s in (50, 51)])
    stain = 0.5 * step(0.65, 1.3, damp) + 0.5 * np.exp(-((damp - 0.75) / 0.07) ** 2) * step(-0.5, 1.2, cloud)
    runs = step(0.4, 2.6, noise(shape, 52, 3, 60, 0.6, stretch=(1.0, 7.0)))
    colour = blend(colour, colour * rgb(0.83, 0.765, 0.66), np.clip(0.34 * stain + 0.25 * runs, 0, 1))
    # Worn spots show the coarser coat below; cracks.
    worn = step(3.0, 3.2, noise(shape, 53, 7, 160, 1.0))
    under = shade(rgb(0.56, 0.475, 0.36) * np.ones(shape + (3,)), np.exp(0.09 * noise(shape, 54, 60, 300, 0.2)))
    colour = blend(colour, under, 0.8 * worn)
    crack = veins(shape, 55, 2, 40, 0.75, 10.0) * step(0.1, 1.3, noise(shape, 56, 2, 6))
    colour = shade(colour, 1.0 - 0.30 * crack)
    height = 0.9 * trowel + 0.35 * sand + 0.5 * cloud + 0.8 * repaired - 2.2 * worn - 2.0 * crack
    return shade(colour, relief(height, 0.085))


def stone_trim():
    """Fine pale stone of carved parts: faint clouds and veins, the marks of rubbing, a little dust in the pores."""
    shape = (512, 512)
    cloud = warp(noise(shape, 61, 2, 12, 1.1), *[20 * noise(shape, s, 2, 8) for s in (62, 63)])
    mottle = noise(shape, 64, 10, 80, 0.7)
    grain = noise(shape, 65, 70, 220, 0.1)
    rubbed = noise(shape, 66, 20, 200, 0.3, stretch=(5.0, 0.7))
    colour = blend(rgb(0.615, 0.568, 0.480), rgb(0.595, 0.525, 0.415), step(-1.3, 1.5, cloud))
    colour = shade(colour, np.exp(0.040 * cloud + 0.026 * mottle + 0.014 * grain + 0.008 * rubbed))
    pale = _seams(shape, 67, 2, 1.3)
    dark = _seams(shape, 710, 3, 0.7)
    colour = blend(colour, rgb(0.71, 0.68, 0.62), 0.40 * pale)
    colour = blend(colour, rgb(0.40, 0.34, 0.26), 0.34 * dark)
    pores = step(2.0, 2.7, noise(shape, 76, 50, 170, 0.2)) * step(0.0, 1.2, noise(shape, 77, 3, 12))
    colour = shade(colour, 1.0 - 0.28 * pores)
    return shade(colour, relief(0.4 * grain + 0.5 * mottle - 1.5 * pores, 0.06))


def terracotta():
    """Fired clay: soft bands of the kiln and the hand, grog, lime bloom, sooty and mossy spots."""
    shape = (512, 512)
    bands = warp(noise(shape, 81, 2, 50, 0.8, stretch=(6.0, 0.9)), 0.0, 5 * noise(shape, 82, 2, 8))
    cloud = noise(shape, 83, 2, 14, 1.1)
    mottle = noise(shape, 84, 10, 90, 0.6)
    grain = noise(shape, 85, 80, 230, 0.1)
    colour = blend(rgb(0.430, 0.178, 0.092), rgb(0.395, 0.215, 0.130), step(-1.0, 1.7, cloud))
    colour = blend(colour, rgb(0.36, 0.120, 0.066), 0.7 * step(0.2, 2.2, noise(shape, 86, 2, 20, 0.9)))
    colour = shade(colour, np.exp(0.070 * bands + 0.060 * mottle + 0.045 * grain))
    grog = step(1.9, 2.5, noise(shape, 87, 50, 160, 0.2))
    colour = blend(colour, rgb(0.50, 0.33, 0.22), 0.55 * grog)
    pits = step(1.9, 2.6, noise(shape, 88, 40, 150, 0.3))
    colour = shade(colour, 1.0 - 0.4 * pits)
    bloom = step(0.4, 2.0, noise(shape, 89, 3, 60, 0.9)) * step(-0.8, 1.2, mottle)
    colour = blend(colour, rgb(0.55, 0.42, 0.32), 0.24 * bloom)
    moss = step(1.7, 2.7, noise(shape, 90, 4, 110, 0.9))
    colour = blend(colour, shade(rgb(0.17, 0.145, 0.075) * np.ones(shape + (3,)), np.exp(0.2 * grain)), 0.45 * moss)
    return shade(colour, relief(0.6 * grain + 0.7 * mottle + 0.8 * bands - 2.0 * pits + 0.8 * moss, 0.12))


# ------------------------------------------------------------------------------------ wood

def wood():
    """Four old oak planks along u: year rings, rays, knots, checks, and the shadowed gaps between."""
    size, planks = 512, 4
    shape = (size, size)
    x, y = grid(size, size)
    columns, rows = np.meshgrid(np.arange(size, dtype=float), np.arange(size, dtype=float))
    number = np.minimum((y * planks).astype(int), planks - 1)
    across = y * planks - number  # 0 to 1 over a plank
    rng = np.random.default_rng(101)
    shift_x, shift_y = each(number, rng.uniform(0, size, planks)), each(number, rng.uniform(0, size, planks))

    def in_plank(field):
        return sample(field, columns + shift_x, rows + shift_y)

    # Rings: a distance across the plank, bent by slow noise and pushed aside by knots.
    bent = across + 0.16 * in_plank(noise(shape, 102, 1, 9, 1.2, stretch=(3.0, 1.0)))
    knots = np.zeros(shape)
    for plank, (kx, ky) in enumerate([(0.22, 0.62), (0.71, 0.35), (0.48, 0.70), (0.90, 0.45)]):
        dx = (x - kx + 0.5) % 1.0 - 0.5
        dy = (across - ky) * 0.25
        near = np.where(number == plank, np.exp(-np.hypot(dx * 0.35, dy) ** 2 / 0.012 ** 2), 0.0)
        bent = bent + 0.35 * near * np.sign(across - ky + 1e-9) * step(0.0, 0.05, np.abs(across - ky))
        knots = np.maximum(knots, np.where(number == plank, np.exp(-(np.hypot(dx * 0.6, dy) / 0.008) ** 2), 0.0))
    phase = bent * each(number, [8.0, 11.0, 7.0, 9.0])
    ring = phase - np.floor(phase)
    late = step(0.35, 0.92, ring) * step(1.0, 0.94, ring)  # slowly darker, then sharply light again
    fibre = in_plank(noise(shape, 103, 30, 250, 0.1, stretch=(14.0, 1.0)))
    streak = in_plank(noise(shape, 104, 6, 90, 0.7, stretch=(10.0, 1.0)))
    vessel = step(1.2, 2.2, in_plank(noise(shape, 105, 40, 220, 0.1, stretch=(8.0, 1.0))))
    tone = each(number, [0.10, -0.16, 0.02, -0.05])
    warmth = each(number, [0.2, 0.7, 0.9, 0.0])
    colour = blend(rgb(0.255, 0.140, 0.068), rgb(0.235, 0.112, 0.050), warmth)
    colour = shade(colour, np.exp(tone + 0.10 * fibre + 0.20 * streak - 0.34 * late))
    colour = shade(colour, 1.0 - 0.38 * vessel * step(0.6, 0.1, ring))
    colour = blend(colour, rgb(0.075, 0.036, 0.018), 0.85 * step(0.25, 0.8, knots))
    colour = shade(colour, 1.0 - 0.25 * np.exp(-((knots - 0.25) / 0.1) ** 2))
    grey = step(-0.2, 2.0, in_plank(noise(shape, 106, 2, 20, 1.0, stretch=(3.0, 1.0))))
    colour = blend(colour, shade(rgb(0.25, 0.185, 0.125) * np.ones(shape + (3,)), np.exp(0.12 * fibre - 0.2 * late)),
                   0.35 * grey)
    edge = np.minimum(across, 1.0 - across) * size / planks  # pixels from the gap
    edge = edge + 0.7 * noise(shape, 107, 4, 60, 0.6, stretch=(3.0, 1.0))
    check = step(2.3, 3.0, in_plank(noise(shape, 108, 12, 120, 0.4, stretch=(16.0, 1.0))))
    colour = shade(colour, 1.0 + 0.22 * np.exp(-((edge - 5.0) / 2.5) ** 2))
    colour = shade(colour,
                   (1.0 - 0.86 * step(2.6, 0.8, edge)) * (1.0 - 0.25 * step(9.0, 2.0, edge)) * (1.0 - 0.5 * check))
    height = 2.0 * step(0.5, 5.0, edge) + 0.35 * fibre - 0.4 * late - 0.8 * vessel - 1.0 * check
    return shade(colour, relief(height, 0.16))


# ------------------------------------------------------------------------------------ floor

def _seams(shape, seed, count, width):
    """Long jagged veins that run aslant, thin out and swell: contours of several stretched fields, sheared; 0 to 1."""
    height, breadth = shape
    columns, rows = np.meshgrid(np.arange(breadth, dtype=float), np.arange(height, dtype=float))
    total = np.zeros(shape)
    for k in range(count):
        field = noise(shape, seed + 7 * k, 1, 70, 1.45, stretch=(2.4, 0.8))
        field = sample(field, columns, rows + (1 if k % 4 else -1) * columns)  # a whole shear keeps it seamless
        dy = np.roll(field, -1, 0) - np.roll(field, 1, 0)
        dx = np.roll(field, -1, 1) - np.roll(field, 1, 1)
        distance = np.abs(field) / np.maximum(0.5 * np.hypot(dx, dy), 0.006)
        swell = width * np.exp(0.8 * noise(shape, seed + 7 * k + 1, 2, 30, 0.7))
        presence = step(-0.7, 1.5, noise(shape, seed + 7 * k + 2, 2, 12, 0.9))
        line = np.exp(-(distance / swell) ** 2) + 0.30 * np.exp(-distance / (7.0 * swell))
        total = np.maximum(total, np.clip(line, 0, 1) * presence)
    return total


def _pale_marble(shape, seed):
    """Cream stone, honey clouds drawn out aslant, thin brown seams."""
    columns, rows = np.meshgrid(np.arange(shape[1], dtype=float), np.arange(shape[0], dtype=float))
    drift = [30 * noise(shape, seed + k, 1, 8, 1.2) for k in (0, 1)]
    cloud = warp(sample(noise(shape, seed + 2, 2, 60, 1.0, stretch=(2.2, 0.6)), columns, rows + columns), *drift)
    mottle = noise(shape, seed + 3, 16, 130, 0.6)
    colour = blend(rgb(0.565, 0.515, 0.430), rgb(0.500, 0.420, 0.310), step(-0.9, 2.2, cloud + 0.3 * mottle))
    colour = blend(colour, rgb(0.44, 0.40, 0.335), 0.6 * step(0.7, 2.3, -cloud + 0.3 * mottle))
    colour = blend(colour, rgb(0.285, 0.205, 0.130), 0.52 * _seams(shape, seed + 10, 5, 1.0))
    colour = blend(colour, rgb(0.640, 0.600, 0.530), 0.45 * _seams(shape, seed + 60, 3, 2.2))
    return shade(colour, np.exp(0.022 * mottle + 0.018 * noise(shape, seed + 4, 110, 420, 0.1)))


def _red_marble(shape, seed):
    """Red-brown nodular marble: rounded paler lumps in a dark clayey net, and a few white seams."""
    drift = [9 * noise(shape, seed + k, 4, 40, 0.9) for k in (0, 1)]
    lumps = np.full(shape, np.inf)
    for k in range(3):  # creases where a field changes its sign
        field = warp(noise(shape, seed + 2 + k, 7, 30, 0.4, stretch=(1.3, 0.8)), *drift)
        lumps = np.minimum(lumps, np.abs(field) + 0.35 * (k > 0))
    cloud = noise(shape, seed + 6, 2, 40, 0.9)
    mottle = noise(shape, seed + 7, 16, 150, 0.5)
    colour = blend(rgb(0.305, 0.158, 0.108), rgb(0.415, 0.262, 0.190), step(0.05, 1.0, lumps + 0.10 * mottle))
    colour = blend(colour, rgb(0.245, 0.105, 0.070), 0.75 * step(0.0, 2.2, cloud + 0.3 * mottle))
    net = step(0.16, 0.02, lumps + 0.03 * mottle) * step(-1.0, 0.8, noise(shape, seed + 8, 3, 20))
    colour = blend(colour, rgb(0.150, 0.058, 0.040), 0.62 * net)
    colour = blend(colour, rgb(0.590, 0.500, 0.420), 0.66 * _seams(shape, seed + 10, 3, 1.1))
    return shade(colour, np.exp(0.045 * mottle + 0.022 * noise(shape, seed + 9, 110, 420, 0.1)))


def floor():
    """Slabs laid diagonally, pale stone and red-brown marble in turn: veined, worn, with grout and scratches."""
    size, tile, period = 1024, 2.0, 2.0 / 3.0  # a slab's diagonal is 2 / 3 m, its side 0.47 m
    shape = (size, size)
    metre = size / tile
    x, y = grid(size, size, tile, tile)
    wobble = 0.0007
    xe, ye = x + wobble * noise(shape, 201, 6, 120, 0.6), y + wobble * noise(shape, 202, 6, 120, 0.6)
    p, q = (xe + ye) / period, (xe - ye) / period
    i, j = np.floor(p).astype(int), np.floor(q).astype(int)
    number = ((i + j + 1) % 6) * 6 + (i - j) % 6  # where its centre lies in the tile, in steps of period / 2
    side = period / np.sqrt(2)
    distance = np.maximum(np.abs(p - i - 0.5), np.abs(q - j - 0.5)) - 0.5
    distance = distance * side * metre + 1.9  # pixels, joints of about 4 px
    corner = 1.0 + 2.0 * np.minimum(np.abs(p - i - 0.5), np.abs(q - j - 0.5))  # chips sooner at the corners
    bite = np.maximum(noise(shape, 203, 14, 130, 0.5) - 1.75, 0.0)
    distance = distance + 7.0 * bite * step(-14, 0, distance) * corner
    slab = inside(distance, 1.6)
    red = (i + j) % 2 == 0

    # Each slab is cut from another place of its marble, and turned.
    rng = np.random.default_rng(204)
    columns, rows = np.meshgrid(np.arange(size, dtype=float), np.arange(size, dtype=float))
    dx = (x - (i + j + 1) * period / 2 + 1.0) % 2.0 - 1.0
    dy = (y - (i - j) * period / 2 + 1.0) % 2.0 - 1.0
    angle = each(number, rng.uniform(0, 2 * np.pi, 36))
    a = (dx * np.cos(angle) - dy * np.sin(angle)) * metre + each(number, rng.uniform(0, size, 36))
    b = (dx * np.sin(angle) + dy * np.cos(angle)) * metre + each(number, rng.uniform(0, size, 36))
    colour = np.where(red[..., None], sample(_red_marble(shape, 300), a, b), sample(_pale_marble(shape, 400), a, b))
    tint = each(number, rng.normal(0.0, 1.0, 36))
    colour = shade(colour, np.exp(0.075 * tint + 0.028 * each(number, rng.normal(0.0, 1.0, 36)) * (dx + dy) / 0.3))

    # Wear: the rubbed middle of the slabs is paler, their edges hold dirt; fine scratches every way.
    edge = np.exp(-np.maximum(-distance, 0) / 5.0)
    scratches = sum(step(2.3, 3.2, noise(shape, 205 + k, 40, 400, 0.0, stretch=s))
                    for k, s in enumerate([(9, 1), (1, 9), (5, 1)]))
    colour = blend(colour, rgb(0.56, 0.52, 0.45), 0.16 * np.clip(scratches, 0, 1))
    pits = step(2.4, 3.0, noise(shape, 208, 70, 240, 0.2))
    colour = shade(colour, 1.0 - 0.4 * pits)
    dull = step(-0.6, 1.8, noise(shape, 209, 2, 24, 0.9))
    colour = blend(colour, colour * rgb(0.80, 0.765, 0.70) + 0.015, 0.42 * dull)
    colour = shade(colour, 1.0 - 0.22 * edge * step(-1.0, 1.0, noise(shape, 199, 3, 40)))
    grout = shade(rgb(0.235, 0.200, 0.160) * np.ones(shape + (3,)),
                  np.exp(0.16 * noise(shape, 198, 50, 350, 0.2) + 0.14 * noise(shape, 197, 3, 30)))
    colour = blend(grout, colour, slab)
    return shade(colour, relief(1.3 * step(2.0, -2.5, distance) - 0.7 * pits, 0.12))


def floor_border():
    """Inlaid band: two strands, red and green, woven around roundels on a cream ground, between fillets."""
    width, height = 512, 256
    shape = (height, width)
    x, y = grid(width, height, 1.0, 0.5)
    pixel = 1.0 / width
    bend = [0.0009 * noise(shape, 501 + k, 4, 60, 0.6) for k in range(2)]
    x, y = x + bend[0], y - 0.25 + bend[1]
    period, swing, half = 0.5, 0.098, 0.036

    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    big = (512, 512)
    cream, red = _pale_marble(big, 520), _red_marble(big, 640)
    net = sample(_seams(big, 760, 6, 1.4), columns + 40, rows)
    serpent = shade(rgb(0.118, 0.165, 0.112) * np.ones(shape + (3,)), np.exp(0.24 * noise(shape, 780, 4, 90, 0.6)))
    serpent = blend(serpent, rgb(0.36, 0.40, 0.31), 0.55 * net)
    cream_here, red_here, red_other = cream[:height], red[:height], red[height:]

    colour = cream_here.copy()
    seam = np.zeros(shape)  # joints between the pieces

    def inlay(stone, distance, joint=0.0022):
        """Lets in a piece of stone and leaves a thin joint around it; covers joints that lie below."""
        nonlocal colour, seam
        cover = inside(distance, pixel)
        colour = blend(colour, stone, cover)
        rim = np.clip(1.0 - np.abs(distance) / joint, 0, 1)
        seam = np.maximum(seam * (1.0 - cover), rim)

    # Roundels in the eyes of the weave, every other with a star of four points.
    cell = np.floor(x / (period / 2))
    dx = x - (cell + 0.5) * period / 2
    radius = np.hypot(dx, y)
    inlay(np.where((cell % 2 == 0)[..., None], serpent, red_other), radius - 0.044)
    star = np.abs(dx) ** 0.62 + np.abs(y) ** 0.62 - 0.040 ** 0.62
    inlay(cream_here * 1.06, star * 0.11)
    # Small lozenges in the spandrels outside the weave.
    at_crossing = (x + period / 4) % (period / 2) - period / 4
    inlay(red_other, 0.7 * (np.abs(at_crossing) + np.abs(np.abs(y) - 0.128) - 0.030))

    # The strands; at every crossing the other one lies on top.
    wave = 2 * np.pi / period
    nearest = np.round(x / (period / 2)).astype(int) % 2
    curves = []
    for sign in (1.0, -1.0):
        middle = sign * swing * np.sin(wave * x)
        slope = sign * swing * wave * np.cos(wave * x)
        curves.append((y - middle) / np.sqrt(1 + 0.8 * slope * slope))
    stones = (red_here * 0.88, serpent)
    for layer in range(2):
        for which in range(2):
            on_top = (nearest == which)
            mine = on_top if layer else ~on_top
            d = np.where(mine, np.abs(curves[which]) - half, 1.0)
            inlay(stones[which], d)
            inlay(cream_here * 1.04, np.where(mine, np.abs(np.abs(curves[which]) - 0.021) - 0.0042, 1.0), 0.0012)

    # Fillets along both edges.
    out = np.abs(y)
    inlay(serpent, np.abs(out - 0.196) - 0.016)
    inlay(cream_here * 0.97, np.where(out > 0.212, -(out - 0.2135), 1.0))
    inlay(red_here, np.abs(out - 0.243) - 0.0065)
    cut = np.abs((x + 0.125 * np.sign(y)) % 0.5 - 0.25)
    seam = np.maximum(seam, np.clip(1.0 - cut / 0.0018, 0, 1) * (out > 0.18))

    dull = step(-0.6, 1.8, noise(shape, 503, 2, 24, 0.9))
    colour = blend(colour, colour * rgb(0.80, 0.765, 0.70) + 0.015, 0.5 * dull)
    colour = blend(colour, rgb(0.47, 0.43, 0.36), 0.10 * step(0.2, 2.4, noise(shape, 504, 5, 90, 0.7)))
    colour = blend(colour, rgb(0.150, 0.118, 0.088), 0.62 * seam * step(-1.8, 0.6, noise(shape, 505, 4, 60, 0.6)))
    pits = step(2.3, 3.0, noise(shape, 506, 50, 200, 0.2))
    return shade(shade(colour, 1.0 - 0.35 * pits),
                 np.exp(0.03 * noise(shape, 507, 60, 230, 0.1)) * relief(-0.6 * seam, 0.10))


# ------------------------------------------------------------------------------------ main

RECIPES = {
    "limestone": limestone, "plaster": plaster, "stone_trim": stone_trim, "terracotta": terracotta, "wood": wood,
    "floor": floor, "floor_border": floor_border,
    "curtain_red": texture_cloth.curtain_red, "curtain_teal": texture_cloth.curtain_teal,
    "curtain_ochre": texture_cloth.curtain_ochre, "banner": texture_cloth.banner,
    "leaf": texture_leaf.leaf,  # writes leaf_mask too
}


def main(names):
    folder = pathlib.Path(__file__).resolve().parent.parent / "textures"
    folder.mkdir(exist_ok=True)
    unknown = [name for name in names if name not in RECIPES]
    if unknown:
        sys.exit(f"unknown: {' '.join(unknown)}; known are: {' '.join(RECIPES)}")
    for name in names or RECIPES:
        image = RECIPES[name]()
        if name == "leaf":
            colour, mask = image
            mask = np.floor(np.clip(mask, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
            write_png(folder / "leaf.png", np.dstack([srgb_bytes(colour), mask]))
            write_png(folder / "leaf_mask.png", mask)
        else:
            write_png(folder / f"{name}.png", srgb_bytes(image), indexed=True)
        albedo = image[0] if name == "leaf" else image
        mean = ", ".join(f"{value:.3f}" for value in albedo.mean((0, 1)))
        print(f"{name}: mean albedo ({mean}), {(folder / (name + '.png')).stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main(sys.argv[1:])
