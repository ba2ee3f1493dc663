"""Curtains, fountain, planters, banners, lanterns: their shapes. Where they stand is in placement.py."""
import math

import numpy as np

from .mesh import turn


def curtain(mesh, material, s0, s1, top, bottom, d, folds, depth, gather=None, seed=0):
    """A hanging sheet between s0 and s1; folds deepen towards the hem.

    `gather`: (height, where, how much) ties it aside."""
    cols, rows = folds * 6 + 1, 12 if gather else 7
    u, v = np.meshgrid(np.linspace(0, 1, cols), np.linspace(0, 1, rows))
    rng = np.random.default_rng(seed)
    phase, wobble = rng.uniform(0, 6.28, 3), rng.uniform(0.5, 1.0, 3)
    warp = u + 0.012 * np.sin(5 * u * 3.14 + phase[0]) * wobble[0]
    down = 1.0 - v
    fold = np.sin(2 * math.pi * folds * warp + 0.35 * down * np.sin(3 * u + phase[1]))
    amplitude = depth * (0.55 + 0.45 * down) * (0.75 + 0.25 * np.sin(9 * u + phase[2]))
    s = s0 + (s1 - s0) * u + 0.08 * (s1 - s0) / folds * np.cos(2 * math.pi * folds * warp) * (0.4 + 0.6 * down)
    y = bottom + (top - bottom) * v
    z = d + amplitude * fold
    if gather:
        height, where, amount = gather
        pull = amount * np.exp(-((v - height) / 0.3) ** 2) * np.where(v < height, 1.0, 1.0)
        low = amount * 0.75 * np.clip((height - v) / height, 0, 1) ** 0.5
        pull = np.where(v < height, np.maximum(pull, low), pull)
        centre = s0 + (s1 - s0) * where
        s = s + (centre - s) * pull
        z = d + (z - d) * (1.0 + 0.6 * pull)
    mesh.grid(material, np.stack([s, y, z], -1), np.stack([u, v], -1))


def rod(mesh, s0, s1, y, d, r=0.018):
    """An iron rod along s."""
    with mesh.frame(turn("z", -90), (s0, y, d)):
        mesh.lathe("iron", [(r, 0.0), (r, s1 - s0)], 8)


def fountain(mesh):
    """An eight-sided basin with a bowl on a baluster in its middle; stands at the origin."""
    eighth = math.pi / 8
    wall = [(2.12, 0.0), (2.12, 0.1), (2.08, 0.12), (1.84, 0.12), (1.84, 0.16), (1.78, 0.2), (1.76, 0.36), (1.8, 0.41),
            (1.9, 0.44), (1.92, 0.47), (1.92, 0.53), (1.89, 0.55), (1.62, 0.55), (1.58, 0.53), (1.58, 0.3)]
    mesh.lathe("stone_trim", wall, 8, start=eighth, flat=True)
    mesh.lathe("water", [(1.6, 0.43), (0.0, 0.43)], 8, start=eighth, flat=True)
    stem = [(0.36, 0.38), (0.36, 0.52), (0.3, 0.55), (0.2, 0.62), (0.15, 0.7), (0.19, 0.8), (0.2, 0.88), (0.13, 1.02),
            (0.12, 1.06), (0.17, 1.09), (0.17, 1.12), (0.3, 1.14), (0.6, 1.22), (0.76, 1.32), (0.81, 1.4), (0.84, 1.41),
            (0.84, 1.45), (0.8, 1.46), (0.74, 1.4)]
    mesh.lathe("stone_trim", stem, 24)
    mesh.lathe("water", [(0.77, 1.42), (0.0, 1.42)], 24)
    finial = [(0.13, 1.38), (0.13, 1.48), (0.09, 1.5), (0.07, 1.6), (0.1, 1.66), (0.15, 1.7), (0.16, 1.74), (0.1, 1.78),
              (0.06, 1.82), (0.09, 1.88), (0.08, 1.94), (0.0, 1.99)]
    mesh.lathe("stone_trim", finial, 16)


def pot(mesh, radius, height):
    """A terracotta pot with soil."""
    r, h = radius, height
    body = [(0.66 * r, 0.0), (0.7 * r, 0.03 * h), (0.68 * r, 0.06 * h), (0.84 * r, 0.4 * h), (0.93 * r, 0.66 * h),
            (0.93 * r, 0.72 * h), (0.96 * r, 0.72 * h), (0.96 * r, 0.76 * h), (0.92 * r, 0.78 * h), (0.9 * r, 0.86 * h),
            (r, 0.89 * h), (1.02 * r, 0.96 * h), (0.98 * r, h), (0.86 * r, h), (0.84 * r, 0.86 * h)]
    mesh.lathe("terracotta", body, 18)
    mesh.lathe("wood", [(0.86 * r, 0.9 * h), (0.0, 0.9 * h)], 12)


def crown(mesh, centre, size, cards, card, seed):
    """Leaf cards on an ellipsoid: each a sheet bent in its middle, stem inside, tip outwards and a little down."""
    rng = np.random.default_rng(seed)
    golden = math.pi * (3.0 - math.sqrt(5.0))
    for k in range(cards):
        y = 1.0 - 2.0 * (k + 0.5) / cards
        ring, turned = math.sqrt(1.0 - y * y), k * golden + rng.uniform(-0.3, 0.3)
        out = np.array([ring * math.cos(turned), y, ring * math.sin(turned)])
        side = np.cross(out, [0.0, 1.0, 0.0]) + 0.35 * rng.normal(size=3)
        tip = out * rng.uniform(0.35, 0.8) + np.array([0.0, rng.uniform(-0.35, 0.55), 0.0]) + 0.3 * rng.normal(size=3)
        tip /= np.linalg.norm(tip)
        side -= tip * (side @ tip)
        side /= np.linalg.norm(side)
        face = np.cross(side, tip)
        if face @ out < 0.0:
            side, face = -side, -face
        length = card * rng.uniform(0.8, 1.15)
        foot = np.asarray(centre) + np.asarray(size) * out * rng.uniform(0.45, 0.8) - tip * length * 0.35
        rows = [[foot + side * length * 0.5 * u + tip * length * v + face * bend for u in (-1.0, 1.0)]
                for v, bend in ((0.0, 0.0), (0.55, 0.06 * length), (1.0, -0.1 * length))]
        normal = 0.55 * face + 0.6 * out                       # softened towards the crown's own shape
        mesh.grid("leaf", rows, [[(0, v), (1, v)] for v in (0.0, 0.55, 1.0)],
                  np.tile(normal / np.linalg.norm(normal), (3, 2, 1)))


def bush(mesh, x, z, y=0.0, seed=0):
    with mesh.frame(turn("y", 57.0 * seed), (x, y, z)):
        pot(mesh, 0.4, 0.62)
        crown(mesh, (0.0, 0.98, 0.0), (0.46, 0.46, 0.46), 70, 0.42, seed)


def tree(mesh, x, z, y=0.0, seed=0):
    with mesh.frame(turn("y", 57.0 * seed), (x, y, z)):
        pot(mesh, 0.48, 0.74)
        mesh.lathe("wood", [(0.055, 0.6), (0.04, 1.1), (0.045, 1.6), (0.02, 2.3)], 8)
        crown(mesh, (0.0, 2.15, 0.0), (0.74, 0.68, 0.74), 150, 0.5, seed)


def lantern(mesh, s, y, d):
    """A six-sided iron lantern whose hook is at (s, y, d); hangs 1.1 m."""
    with mesh.frame(offset=(s, y - 1.1, d)):
        mesh.lathe("iron", [(0.0, 0.0), (0.03, 0.03), (0.03, 0.06), (0.11, 0.08), (0.12, 0.1), (0.1, 0.12)],
                   6, flat=True)
        mesh.lathe("iron", [(0.15, 0.42), (0.19, 0.43), (0.19, 0.45), (0.1, 0.53), (0.03, 0.58), (0.03, 0.62),
                            (0.008, 0.64), (0.008, 1.1)], 6, flat=True)
        mesh.lathe("iron", [(0.19, 0.43), (0.15, 0.42), (0.0, 0.45)][::-1], 6, flat=True)
        for k in range(6):
            with mesh.frame(turn("y", 60.0 * k)):
                mesh.run("iron", [(0.100, 0.1), (0.112, 0.1), (0.168, 0.43), (0.156, 0.43)], -0.007, 0.007, closed=True)


def banner(mesh, s, top, bottom, d, width, seed):
    """A banner under an iron rod, a little blown."""
    v, u = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9), indexing="ij")
    blow = 0.035 * (1 - v) * np.sin(4.5 * v + 2.2 * u + seed) + 0.02 * np.sin(9.0 * u + seed) * (1.1 - v)
    points = np.stack([s + width * (u - 0.5), bottom + (top - bottom) * v, d + 0.03 + blow], -1)
    mesh.grid("banner", points, np.stack([u, v], -1))
    rod(mesh, s - width / 2 - 0.06, s + width / 2 + 0.06, top + 0.012, d + 0.03, 0.016)
    for x in (-0.35, 0.35):                                    # brackets back to the wall
        mesh.box("iron", (s + x * width - 0.01, top + 0.002, -0.1), (s + x * width + 0.01, top + 0.022, d + 0.03), "")
