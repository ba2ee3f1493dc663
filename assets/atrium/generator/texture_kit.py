"""What the texture recipes share: colour, seamless noise, masks from distances, and a PNG writer.

Conventions: images are float arrays [height, width, 3] of linear albedo, row 0 at the top (v = 1). Fields are float
arrays [height, width]. All noise is periodic, so that what is made of it tiles; all of it comes from fixed seeds.
"""
import struct
import zlib

import numpy as np


# ------------------------------------------------------------------------------------ colour

def rgb(r, g, b):
    """A linear colour, ready to be broadcast over an image."""
    return np.array([r, g, b], dtype=np.float64)


def blend(below, above, amount):
    """below where amount is 0, above where it is 1; both may be colours or images, amount is a field or a number."""
    amount = np.asarray(amount)
    if amount.ndim == 2:
        amount = amount[..., None]
    return below + (above - below) * amount


def shade(image, factor):
    """The image times a field."""
    return image * np.asarray(factor)[..., None]


def srgb_bytes(linear):
    """Linear to sRGB-encoded 8 bit (IEC 61966-2-1)."""
    linear = np.clip(linear, 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.floor(encoded * 255.0 + 0.5).astype(np.uint8)


# ------------------------------------------------------------------------------------ fields

def grid(width, height, tile_width=1.0, tile_height=1.0):
    """x to the right and y up of the pixel centres, over [0, tile_width] x [0, tile_height]."""
    x = (np.arange(width) + 0.5) * (tile_width / width)
    y = (height - 0.5 - np.arange(height)) * (tile_height / height)
    return np.meshgrid(x, y)


def step(edge0, edge1, value):
    """Smooth step from 0 at edge0 to 1 at edge1; edge0 may be the greater."""
    t = np.clip((value - edge0) / (edge1 - edge0), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def inside(distance, pixel):
    """Coverage of a shape by its signed distance (negative inside), antialiased over a pixel's size."""
    return np.clip(0.5 - distance / pixel, 0.0, 1.0)


def noise(shape, seed, low, high, slope=1.0, stretch=(1.0, 1.0)):
    """Seamless Gaussian noise of mean 0 and deviation 1, made of waves of `low` to `high` periods a tile.

    slope: amplitude falls as frequency^-slope (1 about as clouds, 0 all alike). stretch: (x, y) lengthens features
    along an axis by that factor. The band's ends are soft.
    """
    height, width = shape
    fx = np.abs(np.fft.rfftfreq(width, 1.0 / width))[None, :] * stretch[0]
    fy = np.abs(np.fft.fftfreq(height, 1.0 / height))[:, None] * stretch[1]
    frequency = np.hypot(fx, fy)
    safe = np.maximum(frequency, 1e-9)
    amplitude = safe ** -(slope + 1.0) * np.exp(-(frequency / high) ** 4) * (1.0 - np.exp(-(frequency / low) ** 4))
    amplitude[frequency == 0.0] = 0.0
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    field = np.fft.irfft2(white * amplitude, s=shape)
    return field / max(field.std(), 1e-12)


def sample(field, x, y):
    """field at pixel coordinates (columns x, rows y), bilinear, wrapping around."""
    height, width = field.shape[:2]
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - x0, y - y0
    if field.ndim == 3:
        u, v = u[..., None], v[..., None]
    xa, xb, ya, yb = x0 % width, (x0 + 1) % width, y0 % height, (y0 + 1) % height
    top = field[ya, xa] * (1 - u) + field[ya, xb] * u
    bottom = field[yb, xa] * (1 - u) + field[yb, xb] * u
    return top * (1 - v) + bottom * v


def warp(field, by_x, by_y):
    """field with each pixel fetched from (by_x, by_y) pixels away."""
    height, width = field.shape[:2]
    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    return sample(field, columns + by_x, rows + by_y)


def blur(field, radius):
    """Seamless Gaussian blur, radius (deviation) in pixels."""
    height, width = field.shape
    fx = np.fft.rfftfreq(width)[None, :]
    fy = np.fft.fftfreq(height)[:, None]
    kernel = np.exp(-2.0 * (np.pi * radius) ** 2 * (fx * fx + fy * fy))
    return np.fft.irfft2(np.fft.rfft2(field) * kernel, s=field.shape)


def relief(height, strength):
    """Factor about 1 of a height field (in pixels) seen under light from above and a little from the left."""
    slope_y = 0.5 * (np.roll(height, -1, 0) - np.roll(height, 1, 0))
    slope_x = 0.5 * (np.roll(height, -1, 1) - np.roll(height, 1, 1))
    return 1.0 + strength * np.tanh(slope_y + 0.45 * slope_x)


def veins(shape, seed, low, high, width, wander=18.0):
    """Thin, broken, branching lines, 0 to 1: zero crossings of warped noise, of uneven width and strength."""
    base = noise(shape, seed, low, high, 1.2)
    base = warp(base, wander * noise(shape, seed + 1, 2, 24, 1.0), wander * noise(shape, seed + 2, 2, 24, 1.0))
    uneven = width * np.exp(0.6 * noise(shape, seed + 3, 2, 12, 0.8))
    steep = np.maximum(np.hypot(*np.gradient(base)), 1e-4)
    distance = np.abs(base) / steep  # in pixels, to first order
    presence = step(-0.2, 1.2, noise(shape, seed + 4, 1, 7, 0.8))
    return np.exp(-(distance / uneven) ** 2) * presence


# ------------------------------------------------------------------------------------ png

def _filtered(rows, step_bytes, adaptive):
    """The image's rows with PNG's filter bytes; adaptive: for each row the filter of the least sum of differences."""
    rows = rows.astype(np.int16)
    up = np.vstack([np.zeros_like(rows[:1]), rows[:-1]])
    left = np.pad(rows, ((0, 0), (step_bytes, 0)))[:, :-step_bytes]
    up_left = np.pad(up, ((0, 0), (step_bytes, 0)))[:, :-step_bytes]
    guess = left + up - up_left
    a, b, c = np.abs(guess - left), np.abs(guess - up), np.abs(guess - up_left)
    paeth = np.where((a <= b) & (a <= c), left, np.where(b <= c, up, up_left))
    choices = [(difference & 255).astype(np.uint8) for difference in
               (rows, rows - left, rows - up, rows - ((left + up) >> 1), rows - paeth)]
    if not adaptive:
        return b"".join(b"\0" + row.tobytes() for row in choices[0])
    cost = np.stack([np.abs(choice.view(np.int8).astype(np.int32)).sum(1) for choice in choices])
    best = cost.argmin(0)
    return b"".join(bytes([kind]) + choices[kind][y].tobytes() for y, kind in enumerate(best))


def _chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _palette(pixels, size=256):
    """Up to `size` colours for uint8 pixels [n, 3], and each pixel's index: cuts along the widest axis, then averages.

    Ordered by lightness, so that neighbouring indices are neighbouring colours and PNG's filters have something to do.
    """
    unique, inverse, counts = np.unique(pixels, axis=0, return_inverse=True, return_counts=True)
    inverse = inverse.reshape(-1)
    colours, weights = unique.astype(np.float64), counts.astype(np.float64)
    if len(unique) > size:
        boxes = [np.arange(len(unique))]
        errors = [np.inf]
        while len(boxes) < size:
            widest = int(np.argmax(errors))
            box = boxes.pop(widest)
            errors.pop(widest)
            mean = np.average(colours[box], axis=0, weights=weights[box])
            axis = int(np.argmax(np.average((colours[box] - mean) ** 2, axis=0, weights=weights[box])))
            low = colours[box, axis] <= mean[axis]
            for half in (box[low], box[~low]):
                centre = np.average(colours[half], axis=0, weights=weights[half])
                spread = (weights[half][:, None] * (colours[half] - centre) ** 2).sum()
                boxes.append(half)
                errors.append(spread if len(half) > 1 else -1.0)
        centres = np.stack([np.average(colours[box], axis=0, weights=weights[box]) for box in boxes])
        for _ in range(3):
            nearest = _nearest(colours, centres)
            for channel in range(3):
                total = np.bincount(nearest, weights * colours[:, channel], len(centres))
                mass = np.bincount(nearest, weights, len(centres))
                centres[:, channel] = np.where(mass > 0, total / np.maximum(mass, 1), centres[:, channel])
    else:
        centres = colours
    centres = np.floor(centres + 0.5)
    centres = centres[np.argsort(centres @ [0.3, 0.6, 0.1], kind="stable")]
    return centres.astype(np.uint8), _nearest(colours, centres)[inverse].astype(np.uint8)


def _nearest(colours, centres):
    """Index of the nearest centre of each colour, in blocks that fit the cache."""
    result = np.empty(len(colours), dtype=np.int64)
    squares = (centres ** 2).sum(1)
    for begin in range(0, len(colours), 4096):
        block = colours[begin:begin + 4096]
        result[begin:begin + 4096] = (squares - 2.0 * block @ centres.T).argmin(1)
    return result


def write_png(path, pixels, indexed=False):
    """Writes uint8 pixels: [h, w] as grey, [h, w, 3] as RGB or, if indexed, by a palette of 256, [h, w, 4] as RGBA."""
    height, width = pixels.shape[:2]
    palette = b""
    if indexed:
        colours, index = _palette(pixels.reshape(-1, 3))
        pixels = index.reshape(height, width)
        palette = _chunk(b"PLTE", colours.tobytes())
    kind = 3 if indexed else {1: 0, 3: 2, 4: 6}[1 if pixels.ndim == 2 else pixels.shape[2]]
    step_bytes = 1 if pixels.ndim == 2 else pixels.shape[2]
    rows = pixels.reshape(height, -1)
    packed = min((zlib.compress(_filtered(rows, step_bytes, adaptive), 9) for adaptive in (False, True)), key=len)
    header = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + _chunk(b"sRGB", b"\0") + palette
                   + _chunk(b"IDAT", packed) + _chunk(b"IEND", b""))
