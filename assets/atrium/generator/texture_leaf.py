"""A spray of leaves for foliage cards: root at the bottom's centre, colour bled beyond the mask. Does not tile."""
import numpy as np

from texture_kit import blend, blur, grid, inside, noise, rgb, shade, step

SIZE = 512


def _stem_point(t):
    """The main stem from the root, t from 0 to 1: a slow double curve."""
    return 0.5 + 0.055 * np.sin(4.2 * t) * t, 0.005 + 0.80 * t


def _strokes(x, y, points, width0, width1):
    """Signed distance to a tapering line through points, and how far along it each pixel lies (0 to 1)."""
    best, along = np.full(x.shape, np.inf), np.zeros(x.shape)
    last = len(points) - 1
    for i in range(last):
        (ax, ay), (bx, by) = points[i], points[i + 1]
        dx, dy = bx - ax, by - ay
        t = np.clip(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0, 1)
        s = (i + t) / last
        d = np.hypot(x - ax - t * dx, y - ay - t * dy) - (width0 + (width1 - width0) * s)
        along = np.where(d < best, s, along)
        best = np.minimum(best, d)
    return best, along


def _leaf_shape(x, y, root, angle, length, bend):
    """Signed distance of a leaf from its root outwards, and its own coordinates: s along (0 to 1), w across (-1 to
    1)."""
    a = np.radians(angle)
    px, py = x - root[0], y - root[1]
    along = (px * np.sin(a) + py * np.cos(a)) / length
    across = (px * np.cos(a) - py * np.sin(a)) / length
    across = across - bend * along * along
    s = np.clip(along, 0.0, 1.0)
    half = 0.265 * np.sin(np.pi * s ** 0.80) ** 0.85 * (1.0 - 0.35 * s) + 0.004
    half = half * (1.0 + 0.035 * np.abs(np.sin(11 * np.pi * s)))  # a slightly toothed rim
    distance = np.maximum(np.abs(across) - half, np.maximum(-along, along - 1.0)) * length * 0.85
    return distance, s, np.clip(across / half, -1.0, 1.0)


def _bleed(colour, mask):
    """Colour spread outwards from where the mask is set, by ever wider blurs; the card's sides do not meet."""
    margin = 192
    weight = np.pad(mask, margin)
    source = np.pad(colour, ((margin, margin), (margin, margin), (0, 0))) * weight[..., None]
    result, known = source / np.maximum(weight, 1e-6)[..., None], weight > 0.02
    for radius in (1.5, 3, 6, 12, 24, 48, 96):
        near = blur(weight, radius)
        fill = ~known & (near > 0.01)
        spread = np.stack([blur(source[..., c], radius) for c in range(3)], axis=-1)[fill] / near[fill][:, None]
        result[fill] = spread
        known |= fill
    result[~known] = (source.sum((0, 1)) / weight.sum())
    return np.clip(result[margin:-margin, margin:-margin], 0.01, 1.0)


def leaf():
    """Returns colour [512, 512, 3] and mask [512, 512]: sixteen leaves, upper sides lit through, on a forked stem."""
    shape = (SIZE, SIZE)
    pixel = 1.0 / SIZE
    x, y = grid(SIZE, SIZE)
    x = x + 0.0022 * noise(shape, 1400, 3, 30, 0.8)
    y = y + 0.0022 * noise(shape, 1401, 3, 30, 0.8)
    colour = np.zeros(shape + (3,))
    mask = np.zeros(shape)
    rng = np.random.default_rng(1402)
    mottle = noise(shape, 1403, 6, 90, 0.7)
    cells = noise(shape, 1404, 60, 200, 0.1)

    def paint(paints, cover, shadow_reach=5.0):
        """Lays something over what is there, with a soft shadow on it."""
        nonlocal colour, mask
        colour = shade(colour, 1.0 - 0.42 * np.roll(blur(cover, shadow_reach), 3, 0) * (1.0 - cover))
        total = cover + mask * (1.0 - cover)
        colour = blend(colour, paints, cover / np.maximum(total, 1e-6))
        mask = total

    def paint_stem(points, width0, width1):
        distance, along = _strokes(x, y, points, width0, width1)
        bark = blend(rgb(0.115, 0.080, 0.040), rgb(0.130, 0.170, 0.045), step(0.1, 0.9, along))
        paint(shade(bark, np.exp(0.12 * mottle) * (1.0 + 0.25 * np.clip(-distance / 0.006, 0, 1))),
              inside(distance, pixel), 3.0)

    def paint_leaf(root, angle, length, bend, young):
        distance, s, w = _leaf_shape(x, y, root, angle, length, bend)
        cover = inside(distance, pixel)
        blade = blend(rgb(0.060, 0.150, 0.030), rgb(0.185, 0.300, 0.052), young)
        blade = blend(blade, rgb(0.150, 0.225, 0.050), 0.7 * step(0.45, 1.0, np.abs(w)))
        # Side veins run forward from the midrib; the blade bulges between them.
        phase = 7.0 * (s - 0.32 * np.abs(w)) + 0.06 * mottle
        wave = np.abs(phase - np.round(phase))
        side_vein = step(0.13, 0.02, wave) * step(1.0, 0.7, np.abs(w))
        bulge = np.cos(2 * np.pi * phase) * np.sign(w + 1e-9)
        rib = step(0.075, 0.02, np.abs(w) * (0.30 + s))
        tone = (0.10 * mottle + 0.05 * cells - 0.075 * bulge + 0.24 * (s - 0.5) +
                0.13 * np.tanh(4 * w) * np.cos(np.radians(angle - 40)))
        blade = shade(blade * np.ones(shape + (3,)), np.exp(tone))
        blade = blend(blade, rgb(0.27, 0.36, 0.11), 0.30 * side_vein)
        blade = blend(blade, rgb(0.32, 0.39, 0.14), 0.72 * rib)
        sick = step(1.3, 2.4, mottle + 0.9 * step(0.75, 1.0, s) + 0.3 * rng.uniform(-1, 1))
        blade = blend(blade, rgb(0.30, 0.21, 0.055), 0.55 * sick)
        paint(blade, cover)

    stem = [_stem_point(t) for t in np.linspace(0.0, 0.93, 18)]
    paint_stem(stem, 0.0105, 0.0035)
    # Pairs from the root upwards, the lowest behind: (place on the stem, angle, length).
    for at, angle, length in [
            (0.15, -98, 0.25), (0.13, 92, 0.27), (0.24, -80, 0.33), (0.25, 78, 0.35), (0.32, -66, 0.25),
            (0.36, -61, 0.39), (0.42, 52, 0.26), (0.44, 62, 0.37), (0.53, -47, 0.36), (0.60, 44, 0.35),
            (0.64, -18, 0.24), (0.71, -41, 0.29), (0.77, 33, 0.27), (0.85, -24, 0.22), (0.88, 22, 0.20)]:
        base = _stem_point(at)
        a = np.radians(angle + rng.uniform(-5, 5))
        reach = 0.055
        root = (base[0] + reach * np.sin(a), base[1] + reach * np.cos(a))
        paint_stem([base, root], 0.0045, 0.0030)
        paint_leaf(root, np.degrees(a), length * rng.uniform(0.94, 1.04),
                   -0.20 * np.sign(angle) * rng.uniform(0.3, 1.0), 0.15 + 0.75 * at)
    paint_leaf(_stem_point(0.90), 3.0, 0.25, 0.08, 0.95)
    # Nothing may touch the card's border but the root.
    frame = np.minimum(np.minimum(x, 1 - x), 1 - y)
    mask = mask * step(0.004, 0.010, frame)
    return _bleed(0.66 * colour, mask), mask
