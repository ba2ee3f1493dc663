"""The scenes: where things stand, what they are made of, lamps, cameras, camera paths; and the files of each."""
import json
import math

from . import gems, smoke, vessels
from .mesh import Part, backdrop, box, mul, quad, rotation, softbox, sub, unit, write

LOWERED_IOR = 1.1  # of figures 5.12 to 5.15
CATALOGUE = {  # as published: sigma_s, sigma_a, g, ior
    "milk": ((18.2052, 20.3826, 22.3698), (0.00153, 0.0046, 0.01993), (0.75, 0.714, 0.681), 1.33),
    "espresso": ((7.78262, 8.1305, 8.53875), (4.79838, 6.57512, 8.84925), (0.907, 0.896, 0.88), 1.33),
    "coca cola": ((0.00254, 0.00299, 0.0), (0.10014, 0.16503, 0.2468), (0.965, 0.972, 0.0), 1.33),
    "grape juice": ((0.00138, 0.0, 0.0), (0.10404, 0.23958, 0.29325), (0.961, 0.0, 0.0), 1.33),
    "emerald": ((0.18, 0.07, 0.03), (0.97, 0.061, 1.45), (0.943, 0.953, 0.952), 1.52),
    "ruby": ((0.18, 0.07, 0.03), (0.061, 0.97, 1.45), (0.943, 0.953, 0.952), 1.77),
    "sapphire": ((0.18, 0.07, 0.03), (0.97, 1.45, 0.061), (0.943, 0.953, 0.952), 1.77),
    "glass": ((0.00011, 0.00014, 0.00014), (0.00189, 0.00183, 0.002), (0.943, 0.953, 0.952), 1.5),
}
# Not of the catalogue: a homogeneous cloud for the original.
CLOUD = ((0.03, 0.03, 0.03), (0.0006, 0.0006, 0.0006), (0.3, 0.3, 0.3), 1.0)


def clear(ior, tint=(0.95, 0.95, 0.95)):
    """MTL keys of something transparent: only other programs read them."""
    return {"Kd": tint, "Ks": (0.5, 0.5, 0.5), "Ns": 400, "Ni": ior, "d": 0.3}


def lamp(radiance):
    return {"Kd": (0, 0, 0), "Ke": radiance}


def text_of(value, indent="  "):
    """JSON with a line for each member of the outer two levels."""
    def inner(v):
        return json.dumps(v, separators=(", ", ": "))

    lines = []
    for key, member in value.items():
        if isinstance(member, dict) and any(isinstance(m, dict) for m in member.values()):
            rows = [f"{indent * 2}{json.dumps(k)}: {inner(m)}" for k, m in member.items()]
            lines.append(f"{indent}{json.dumps(key)}: {{\n" + ",\n".join(rows) + f"\n{indent}}}")
        elif isinstance(member, list) and member and isinstance(member[0], dict):
            rows = [indent * 2 + inner(m) for m in member]
            lines.append(f"{indent}{json.dumps(key)}: [\n" + ",\n".join(rows) + f"\n{indent}]")
        elif isinstance(member, dict) and len(member) > 4:
            rows = [f"{indent * 2}{json.dumps(k)}: {inner(m)}" for k, m in member.items()]
            lines.append(f"{indent}{json.dumps(key)}: {{\n" + ",\n".join(rows) + f"\n{indent}}}")
        else:
            lines.append(f"{indent}{json.dumps(key)}: {inner(member)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write_scene(folder, stem, value):
    (folder / f"{stem}.json").write_text(text_of(value), encoding="ascii", newline="\n")


def camera(name, position, target, fov):
    return {"name": name, "position": list(position), "target": list(target), "fov": fov}


def original(camera_, light, colour, intensity, media):
    """The original's own JSON."""
    keys = {"camera": camera_["position"], "cameraLookAt": camera_["target"], "fov": camera_["fov"],
            "lightPos": list(light), "lightColor": list(colour), "lightIntensity": intensity, "scale": 1.0}
    result = {"scene": keys}
    for name, (scattering, absorption, g, ior) in media.items():
        result[name] = {"sigma_s": list(scattering), "sigma_a": list(absorption), "g": list(g), "ior": ior}
    return result


def walk(path, title, target, position, arc, lift, near, fov, keys=7):
    """A camera path: an arc of so many degrees about the target with a rise and a dive towards it."""
    offset = sub(position, target)
    radius, start = math.hypot(offset[0], offset[2]), math.atan2(offset[0], offset[2])
    lines = [f"# {title} (millimetres, y up). Made by assets/media/generate.py.",
             "# p position, d viewing direction, u up, f vertical field of view in degrees. "
             "The format: engine/scene/key_frames.hpp.", ""]
    for i in range(keys):
        t = i / (keys - 1)
        a = start + math.radians(arc) * (t - 0.5)
        r = radius * (1.0 - near * math.sin(math.pi * t) ** 2)
        p = (target[0] + r * math.sin(a), position[1] + lift * math.sin(2 * math.pi * t), target[2] + r * math.cos(a))
        d = unit(sub(target, p))
        lines.append("p " + " ".join(f"{c:.1f}" for c in p) + "  d " + " ".join(f"{c:.3f}" for c in d) +
                     f"  u 0 1 0  f {fov:g}")
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


def tiles(name, size, count, parity, centre=(0.0, 0.0)):
    """Every other square of a floor."""
    points, faces = [], []
    for i in range(-count, count):
        for j in range(-count, count):
            if (i + j) % 2 != parity:
                continue
            x, z = centre[0] + i * size, centre[1] + j * size
            faces.append([len(points) + k for k in range(4)])
            points += [(x, 0, z + size), (x + size, 0, z + size), (x + size, 0, z), (x, 0, z)]
    return Part(name, name, points, faces, crease=0.0, closed=False)


def planks(half_width, front, back, width, woods):
    """A table's boards along x, each with bevelled edges, their top at y = 0."""
    parts, z, i = [], back, 0
    while z < front:
        shade = woods[(i * 7 + i // 3) % len(woods)]
        parts.append(box(f"board_{i}", shade, (-half_width + 11.0 * (i % 3), -22.0, z + 0.5),
                         (half_width - 13.0 * (i % 2), 0.0, z + width - 0.5), bevel=1.2))
        z, i = z + width, i + 1
    return parts


WOODS = {"wood_a": {"Kd": (0.30, 0.175, 0.095)}, "wood_b": {"Kd": (0.26, 0.145, 0.075)},
         "wood_c": {"Kd": (0.34, 0.205, 0.115)}, "wood_d": {"Kd": (0.28, 0.16, 0.088)}}


def build_gems(folder, paths):
    stones = [
        gems.resting(gems.gem("emerald", "emerald", gems.emerald(), (6.4, 6.0, 6.0)), 90, 46)
        .placed(rotation((0, 1, 0), 14), (-3.2, 0, 6.6)),
        gems.resting(gems.gem("ruby", "ruby", gems.brilliant(), (5.9, 5.0, 5.0)), 90, 40.8)
        .placed(rotation((0, 1, 0), 24), (-11.6, 0, -2.2)),
        gems.resting(gems.gem("sapphire", "sapphire", gems.brilliant(), (5.2, 5.2, 5.2)), 90, 40.8)
        .placed(rotation((0, 1, 0), -16), (2.4, 0, -5.6)),
        gems.gem("glass", "glass", gems.rose(), (6.2, 6.2, 6.2)).placed(rotation((0, 1, 0), 9), (11.2, 0.02, 3.0)),
    ]
    key, target = (-34.0, 58.0, 6.0), (0.0, 2.0, 0.0)
    parts = stones + [
        backdrop("sweep", "paper", 160, 140, -70, 130, 40),
        softbox("key", key, target, 42, 42, "key"),
        softbox("rim", (36, 34, -48), target, 14, 44, "rim"),
        softbox("window", (52, 46, 44), target, 40, 12, "window")]
    materials = {name: clear(CATALOGUE[name][3]) for name in ("emerald", "ruby", "sapphire", "glass")}
    materials |= {"paper": {"Kd": (0.26, 0.255, 0.25)}, "key": lamp((8.4, 7.8, 6.9)),
                  "rim": lamp((16, 18, 21)), "window": lamp((9, 9, 9))}
    count = write(folder, "gems", parts, materials, "Four gems.")
    view = camera("published", (1.0, 27.0, 48.0), (0.2, 1.4, 0.3), 27)
    scene = {"description": "Four gems as in the VPT original's series over samples: an emerald cut, an oval and a "
                            "round brilliant and a rose cut, on a paper sweep.",
             "model": "gems.obj", "scale": 1,
             "cameras": [view, camera("ruby", (-4.0, 13.0, 22.0), (-11.0, 2.6, -1.5), 28),
                         camera("above", (0.0, 62.0, 8.0), (0.0, 0.0, 0.5), 27)],
             "sun": None, "exposure": 1.3, "environment": {"radiance": [0.1, 0.11, 0.13]},
             "keyFrames": "../../../keyFrames/gems.txt",
             "materials": {name: {"interior": name} for name in ("emerald", "ruby", "sapphire", "glass")}}
    write_scene(folder, "gems", scene)
    write_scene(folder, "gems_original", original(view, (-33.2, 56.5, 6.0), (1, 0.93, 0.82), 8.4 * 42 * 42,
                                                  {n: CATALOGUE[n] for n in ("emerald", "ruby", "sapphire", "glass")}))
    walk(paths / "gems.txt", "Round the four gems", (0.0, 2.0, 0.0), view["position"], 150, 6, 0.35, 27)
    return count


def build_block(folder, paths):
    from .mesh import rounded_box
    cube = rounded_box("block", "block", (6, 6, 6), 0.7, arc=5).placed(rotation((0, 1, 0), 27), (0, 6.02, 0))
    key, target = (-23.0, 28.0, -16.0), (0.0, 5.5, 0.0)
    parts = [
        cube, tiles("tile_light", 4.0, 15, 0), tiles("tile_dark", 4.0, 15, 1),
        quad("wall", "wall", (-60, 0, -36), (60, 0, -36), (60, 66, -36), (-60, 66, -36)),
        # Large: light from within is found by chance.
        softbox("key", key, target, 32, 32, "key"), softbox("fill", (26, 24, 24), target, 28, 28, "fill")]
    materials = {"block": clear(1.33), "tile_light": {"Kd": (0.72, 0.69, 0.63)},
                 "tile_dark": {"Kd": (0.1, 0.16, 0.24)}, "wall": {"Kd": (0.3, 0.4, 0.46)},
                 "key": lamp((5.4, 5.1, 4.6)), "fill": lamp((3.0, 3.2, 3.5))}
    count = write(folder, "block", parts, materials, "A block on a chequered floor.")
    view = camera("published", (9.5, 18.5, 33.5), (0.0, 5.6, 0.0), 28)
    for stem, medium, what in (("milk", "milk", "Milk"), ("juice", "grape juice", "Grape juice"),
                               ("coffee", "espresso", "Espresso")):
        scene = {"description": f"{what} as a block of 12 mm: the VPT original's series over coefficients.",
                 "model": "block.obj", "scale": 1,
                 "cameras": [view, camera("edge", (8.0, 10.5, 17.0), (1.2, 7.8, 3.0), 32)],
                 "sun": None, "exposure": 1.3, "environment": {"radiance": [0.2, 0.21, 0.23]},
                 "keyFrames": "../../../keyFrames/block.txt",
                 "materials": {"block": {"interior": medium}}}
        write_scene(folder, stem, scene)
        write_scene(folder, f"{stem}_original", original(view, (-22.2, 27.0, -15.4), (1, 0.94, 0.85), 5.4 * 32 * 32,
                                                         {"block": CATALOGUE[medium]}))
    # Figure 5.12 b, the milk's scattering over 100, in a block of a quarter of the size: a slight haze.
    scattering, absorption, g, _ = CATALOGUE["milk"]
    haze = original(view, (-22.2, 27.0, -15.4), (1, 0.94, 0.85), 5.4 * 32 * 32,
                    {"block": ([round(s / 100, 6) for s in scattering], absorption, g, LOWERED_IOR)})
    haze["scene"]["scale"] = 0.25
    write_scene(folder, "milk_haze_original", haze)
    walk(paths / "block.txt", "Round the block", (0.0, 5.5, 0.0), view["position"], 120, 5, 0.3, 30)
    return count


def build_espresso(folder, paths):
    outside, rim, inside = vessels.espresso_cup()
    profile, inner = vessels.profile_of(outside, rim, inside, 2.2)
    stand = 3.55
    placement = rotation((0, 1, 0), -28), (0, stand, 0)
    cup = vessels.handled("cup", "glass", profile, 80, (41.0, 50.5), (18.8, 27.5), 4, 29.0, (3.4, 2.4))
    cup = cup.placed(*placement)
    coffee = vessels.liquid("espresso", "espresso", inner, 41.0, 0.3, 1.1, 0.9, 80).placed(*placement)
    saucer_profile = vessels.rounded([
        (0.0, 1.0), (17.0, 1.0), (18.5, 0.0, 0.8), (22.0, 0.0, 1.5), (30.0, 2.6, 10.0), (58.0, 10.6, 20.0),
        (61.5, 11.2, 0.9), (60.8, 12.6, 0.9), (31.0, 5.6, 8.0), (24.5, 4.4, 2.0), (23.0, 3.5, 1.5), (0.0, 3.5)], 3.0)
    saucer = vessels.lathe("saucer", "porcelain", saucer_profile, 96)
    # Its stem lies over the saucer's rim.
    steel = vessels.spoon("spoon", "steel").placed(rotation((0, 1, 0), 195), (-14.0, 13.4, 41.0))
    key, target = (-150.0, 190.0, -120.0), (0.0, 35.0, 0.0)
    parts = [cup, coffee, saucer, steel] + planks(330, 230, -330, 62, sorted(WOODS)) + [
        quad("wall", "wall", (-700, -80, -430), (700, -80, -430), (700, 620, -430), (-700, 620, -430)),
        softbox("key", key, target, 150, 190, "key"),
        softbox("side", (230, 130, 60), target, 60, 190, "side"),
        softbox("front", (-120, 220, 260), target, 110, 80, "front")]
    materials = {"glass": clear(1.5), "espresso": clear(1.33, (0.1, 0.05, 0.02)),
                 "porcelain": {"Kd": (0.76, 0.75, 0.72)},
                 "steel": {"Kd": (0, 0, 0), "Ks": (0.66, 0.62, 0.57), "Ns": 200},
                 **WOODS, "wall": {"Kd": (0.16, 0.17, 0.18)},
                 "key": lamp((9.5, 9, 8.3)), "side": lamp((6, 5.6, 5)), "front": lamp((3, 3.1, 3.4))}
    count = write(folder, "espresso", parts, materials, "Espresso in a glass cup.")
    views = [camera("published", (62.0, 112.0, 176.0), (3.0, 24.0, 0.0), 30),
             camera("close-up", (30.0, 92.0, 92.0), (7.0, 43.0, 8.0), 27)]
    scene = {"description": "Espresso in a glass cup: glass and liquid overlap by 0.3 mm, and the glass has priority.",
             "model": "espresso.obj", "scale": 1, "cameras": views,
             "sun": None, "exposure": 1.5, "environment": {"radiance": [0.12, 0.13, 0.15]},
             "keyFrames": "../../../keyFrames/espresso.txt",
             "materials": {"glass": {"interior": "glass", "priority": 2},
                           "espresso": {"interior": "espresso", "priority": 1},
                           "steel": {"bsdf": "conductor", "roughness": 0.12}}}
    write_scene(folder, "espresso", scene)
    for stem, view in (("espresso_original", views[0]), ("espresso_close_original", views[1])):
        write_scene(folder, stem, original(view, (-148.0, 187.0, -118.0), (1, 0.95, 0.87), 9.5 * 150 * 190,
                                           {"glass": CATALOGUE["glass"], "espresso": CATALOGUE["espresso"]}))
    walk(paths / "espresso.txt", "Round the cup of espresso", (0.0, 30.0, 0.0), views[0]["position"], 110, 20, 0.4, 30)
    return count


def build_cola(folder, paths):
    outside = [(0.0, 1.2), (21.0, 1.2), (23.0, 0.0, 1.0), (27.0, 0.0, 3.0), (34.0, 134.0)]
    rim = [(34.0, 134.0), (34.15, 136.4, 0.95), (32.15, 136.4, 0.95), (32.0, 134.0)]
    inside = [(32.0, 134.0), (25.2, 13.0, 7.0), (0.0, 11.5)]
    profile, inner = vessels.profile_of(outside, rim, inside, 6.0)
    glass = vessels.lathe("tumbler", "glass", profile, 88, crease=50.0)
    level = 100.0
    cola = vessels.liquid("cola", "cola", inner, level, 0.3, 1.5, 1.3, 88)
    placed = vessels.ice_cubes(12, (8.6, 8.6, 8.6), lambda y: 25.2 + (32.0 - 25.2) * (y - 13.0) / 121.0,
                               50.0, 112.0, level, 11)
    ice = [vessels.ice_cube(f"ice_{i}", "ice", p, 100 + i) for i, p in enumerate(placed)]
    key, target = (-200.0, 350.0, -190.0), (0.0, 70.0, 0.0)
    parts = [glass, cola] + ice + planks(520, 300, -380, 85, sorted(WOODS)) + [
        quad("wall", "wall", (-900, -80, -520), (900, -80, -520), (900, 900, -520), (-900, 900, -520)),
        softbox("key", key, target, 200, 260, "key"),
        softbox("side", (260, 150, 30), target, 70, 280, "side"),
        softbox("glow", (40, 350, -330), (0, 90, -520), 260, 120, "glow")]
    materials = {"glass": clear(1.5), "cola": clear(1.33, (0.2, 0.06, 0.02)), "ice": clear(1.5), **WOODS,
                 "wall": {"Kd": (0.62, 0.6, 0.56)},
                 "key": lamp((9, 9, 9)), "side": lamp((6, 5.8, 5.4)), "glow": lamp((16, 14.8, 13))}
    count = write(folder, "cola", parts, materials, "Cola with ice in a tumbler.")
    view = camera("published", (40.0, 205.0, 290.0), (0.0, 69.0, 0.0), 28)
    scene = {"description": "Coca Cola with ice in a tumbler. Glass, ice and cola overlap, with priorities; the ice is "
                            "the medium glass, as published.",
             "model": "cola.obj", "scale": 1,
             "cameras": [view, camera("ice", (30.0, 165.0, 120.0), (2.0, 100.0, 4.0), 30)],
             "sun": None, "exposure": 1.4, "environment": {"radiance": [0.14, 0.15, 0.17]},
             "keyFrames": "../../../keyFrames/cola.txt",
             "materials": {"glass": {"interior": "glass", "priority": 3},
                           "ice": {"interior": "glass", "ior": 1.5, "priority": 2},
                           "cola": {"interior": "coca cola", "priority": 1}}}
    write_scene(folder, "cola", scene)
    write_scene(folder, "cola_original", original(view, (-197.0, 344.0, -186.5), (1, 1, 1), 9 * 200 * 260,
                                                  {"glass": CATALOGUE["glass"], "ice": CATALOGUE["glass"],
                                                   "cola": CATALOGUE["coca cola"]}))
    walk(paths / "cola.txt", "Round the tumbler", (0.0, 70.0, 0.0), view["position"], 110, 30, 0.4, 28)
    return count


def build_smoke(folder, paths, with_grid=True):
    low, high = (-210.0, 12.0, -210.0), (210.0, 432.0, 210.0)
    key, target = (640.0, 640.0, -60.0), (0.0, 220.0, 0.0)

    def room():
        return [backdrop("sweep", "room", 1400, 900, -620, 1100, 200),
                softbox("key", key, target, 260, 260, "key"),
                softbox("rim", (-760, 330, -420), target, 160, 360, "rim")]

    materials = {"room": {"Kd": (0.035, 0.038, 0.044)}, "key": lamp((60, 55, 47)), "rim": lamp((14, 18, 25))}
    bounds = box("bounds", "smoke", low, high)
    count = write(folder, "smoke", [bounds] + room(), {"smoke": clear(1.0), **materials}, "A box of smoke.")
    if with_grid:  # what takes long
        size = (96, 96, 96)
        smoke.write_nrrd(folder / "smoke.nrrd", size, smoke.grid(size))
    view = camera("published", (-60.0, 250.0, 980.0), (0.0, 212.0, 0.0), 28)
    scene = {"description": "A cloud of smoke on a density grid of 96^3 cells.", "model": "smoke.obj", "scale": 1,
             "cameras": [view, camera("near", (120.0, 300.0, 430.0), (10.0, 270.0, 0.0), 34)],
             "sun": None, "exposure": 1.0, "environment": {"radiance": [0.05, 0.06, 0.08]},
             "keyFrames": "../../../keyFrames/smoke.txt",
             "media": {"smoke": {"sigma_s": [0.045, 0.045, 0.045], "sigma_a": [0.0009, 0.001, 0.0012],
                                 "g": 0.3, "ior": 1,
                                 "grid": {"file": "smoke.nrrd", "min": list(low), "max": list(high)}}},
             "materials": {"smoke": {"bsdf": "none", "interior": "smoke"}}}
    write_scene(folder, "smoke", scene)
    cloud = smoke.surface("cloud", "smoke", 34, low, high)
    count += write(folder, "smoke_cloud", [cloud] + room(), {"smoke": clear(1.0), **materials},
                   "A homogeneous cloud for the original.")
    write_scene(folder, "smoke_cloud", original(view, (633.0, 634.0, -59.4), (1, 0.92, 0.8), 60 * 260 * 260,
                                                {"smoke": CLOUD}))
    walk(paths / "smoke.txt", "Round the cloud", target, view["position"], 140, 60, 0.35, 28)
    return count


SCENES = {"gems": build_gems, "block": build_block, "espresso": build_espresso, "cola": build_cola,
          "smoke": build_smoke}
