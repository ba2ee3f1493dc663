"""Writes a Mesh as Wavefront OBJ and its materials as MTL: the same bytes for the same mesh."""
import numpy as np

from .mesh import unit

TEXTURED = {"limestone": (0.03, 12), "plaster": (0.02, 8), "stone_trim": (0.04, 20), "floor": (0.05, 40),
            "floor_border": (0.05, 40), "terracotta": (0.02, 10), "wood": (0.03, 16), "curtain_red": (0.02, 8),
            "curtain_teal": (0.02, 8), "curtain_ochre": (0.02, 8), "leaf": (0.02, 16), "banner": (0.02, 8)}
PLAIN = {"iron": ((0.08, 0.08, 0.08), 0.05, 40), "water": ((0.03, 0.06, 0.07), 0.1, 200)}


def _short(value):
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def _table(key, rows):
    """Distinct rows in order of first use: their lines, and the number (from 1) of each given row."""
    scaled = np.round(rows * 1e4).astype(np.int64)
    _, first, inverse = np.unique(scaled, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    lines = [key + " " + " ".join(_short(x / 1e4) for x in scaled[first[i]]) for i in order]
    return lines, rank[inverse.ravel()] + 1


def _area2(points, triangles):
    """Twice the triangles' areas."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1)


def write(mesh, obj_path, mtl_path):
    """Writes both files, quads as quads (they split along 0-2); triangles without area after rounding are left out.
    Returns counts."""
    points, normals, uvs, faces, spans = [], [], [], [], []
    corners = 0
    for material in sorted(mesh.parts):
        begin = sum(map(len, faces))
        for p, n, t, f in mesh.parts[material]:
            points.append(p), normals.append(n), uvs.append(t), faces.append(f + corners)
            corners += len(p)
        spans.append((material, begin, sum(map(len, faces))))
    points = np.round(np.concatenate(points), 4)
    normals, uvs, faces = unit(np.concatenate(normals)), np.concatenate(uvs), np.concatenate(faces)
    solid = np.stack([_area2(points, faces[:, :3]), _area2(points, faces[:, [0, 2, 3]])], axis=1) > 2e-7
    used = np.zeros(len(points), bool)
    used[faces[solid[:, 0], :3]] = True
    used[faces[solid[:, 1]][:, [0, 2, 3]]] = True
    position = np.cumsum(used) - 1
    v, vi = _table("v", points[used])
    vt, ti = _table("vt", uvs[used])
    vn, ni = _table("vn", normals[used])
    lines = ["# Lucerna atrium: metres, y up, court along x, floor at y = 0. MIT licence. Made by generate.py.",
             "mtllib " + mtl_path.name, *v, *vt, *vn]
    for material, begin, end in spans:
        lines += ["g " + material, "usemtl " + material]
        for k in range(begin, end):
            first, second = solid[k]
            if first or second:
                corners = [c for c, kept in zip(position[faces[k]], (True, first, True, second)) if kept]
                lines.append("f " + " ".join(f"{vi[i]}/{ti[i]}/{ni[i]}" for i in corners))
    obj_path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")

    lines = ["# Lucerna atrium. Kd times map_Kd. MIT licence. Made by generate.py."]
    for name in sorted(mesh.parts):
        if name in TEXTURED:
            ks, ns = TEXTURED[name]
            kd, maps = (1, 1, 1), ([f"map_Kd textures/{name}.png"] +
                                   (["map_d textures/leaf_mask.png"] if name == "leaf" else []))
        else:
            (kd, ks, ns), maps = PLAIN[name], []
        lines += ["", "newmtl " + name, "Kd " + " ".join(map(str, kd)), f"Ks {ks} {ks} {ks}", f"Ns {ns}",
                  "illum 2", *maps]
    mtl_path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
    return {"triangles": int(solid.sum()), "positions": len(v), "uvs": len(vt), "normals": len(vn),
            "faces": int(solid.any(axis=1).sum())}
