#!/usr/bin/env python3
"""Writes a few small right inputs for each fuzz target: make_corpus.py FOLDER. What the fuzzer mutates begins here."""
import base64
import json
import pathlib
import struct
import sys
import zlib

folder = pathlib.Path(sys.argv[1])


def put(target, *contents):
    place = folder / target
    place.mkdir(parents=True, exist_ok=True)
    for i, content in enumerate(contents):
        (place / f"seed{i}").write_bytes(content if isinstance(content, bytes) else content.encode())


def png(width, height, bits, kind, rows, more=b""):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)) + more
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def palette_chunk(data):
    return struct.pack(">I", len(data)) + b"PLTE" + data + struct.pack(">I", zlib.crc32(b"PLTE" + data))


def tga(kind, width, height, bits, data, palette=b"", entries=0):
    head = struct.pack("<BBBHHBHHHHBB", 0, entries > 0, kind, 0, entries, 24 if entries else 0, 0, 0, width, height,
                       bits, 32)
    return head + palette + data


def bmp(width, height, bits, palette, data, compression=0):
    begin = 54 + len(palette)
    head = struct.pack("<IIIIiiHHIIiiII", begin + len(data), 0, begin, 40, width, height, 1, bits, compression, 0, 0, 0,
                       len(palette) // 4, 0)
    return b"BM" + head + palette + data


# 16 x 8 pixels, progressive: as tests/unit/picture_header_test.cpp has it.
jpeg_test = (pathlib.Path(__file__).parent.parent / "unit/picture_header_test.cpp").read_text()
jpeg_test = jpeg_test.split("kJpegHex =")[1].split(";")[0]
jpeg = bytes.fromhex("".join(part for part in jpeg_test.split('"')[1::2]))

pictures = [
    png(2, 2, 8, 2, b"\0\1\2\3\4\5\6" * 2), png(8, 2, 1, 0, b"\0\xaa" * 2), png(2, 1, 8, 6, b"\0" + bytes(8)),
    png(2, 1, 16, 4, b"\0" + bytes(8)), png(2, 1, 8, 3, b"\0\0\1", palette_chunk(b"\1\2\3\4\5\6")), jpeg,
    tga(2, 2, 1, 24, bytes(6)), tga(2, 1, 1, 32, bytes(4)), tga(3, 2, 1, 8, b"\1\2"),
    tga(10, 4, 1, 24, b"\x82\1\2\3\0\4\5\6"), tga(11, 3, 1, 8, b"\x82\7"),
    tga(1, 2, 1, 8, b"\0\1", bytes(6), 2), tga(9, 2, 1, 8, b"\x81\1", bytes(6), 2),
    bmp(1, 2, 24, b"", bytes(8)), bmp(1, -2, 32, b"", bytes(8)), bmp(2, 1, 8, bytes(8), bytes(4)),
    bmp(9, 1, 1, bytes(8), bytes(4)), bmp(3, 1, 4, bytes(64), bytes(4)), bmp(3, 1, 16, b"", bytes(8)),
    bmp(4, 2, 8, bytes(8), b"\2\1\0\2\1\1\1\1\0\0\0\1", 1), bmp(8, 1, 4, bytes(8), b"\0\5\1\1\x10\0\3\x10\0\1", 2),
    bmp(1, 1, 32, struct.pack("<IIII", 255, 65280, 16711680, 0), bytes(4), 3)]
put("picture", *pictures)
put("picture_header", *pictures)

runs = b"\2\2\0\x08" + b"\x88\x80" * 4
put("linear_picture",
    b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 8\n" + runs * 2,
    b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n+Y 1 -X 4\n" + b"\1\2\3\x80\1\1\1\3",
    b"PF\n2 1\n-1.0\n" + struct.pack("<6f", 1, 2, 3, 4, 5, 6), b"Pf\n1 2\n1.0\n" + struct.pack(">2f", 1, 2))

put("obj", "v 0 0 0\nv 1 .5 0\nv 0 -1e-3 +2\nvt 0 .1\nvn 0 0 1\nf 1/1/1 2//1 -1/1\nf 1 2 \\\n 3\n", "v 1 2 3\nf 1 1 1",
    'mtllib "fuzz.obj" b c.mtl\nnewmtl a\nKd 1\nKs 1 1 1\nNs 9\nd 0.5\nillum 7\nNi 1.5\nPm 1\nPr .5\nKe 1\n'
    "map_Kd -s 2 2 2 -o 0.5 a b.png\nbump n.png -bm 1\nusemtl a\n"
    "v 0 0 0 1 0 0\nv 2 0 0 0 1 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nvt 0 0\nf 1/1 2/1 3/1 4/1 5/1 6/1\n",
    "v 12958091.1 50 1\nv 12958091.2 50 1\nv 12958091.1 51 1\nf 1 2 3\n",
    "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\nf 1 2 3 4 1 5 6 7 8 5\n")
ply = "ply\nformat %s 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\nproperty float y\n" \
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n" \
      "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n" \
      "element tristrips 1\nproperty list int int vertex_indices\nelement camera 1\nproperty float x\nend_header\n"
vertex = struct.pack("<fffBBB", 0, 1, 2, 255, 0, 9)
put("ply", ply % "ascii" + "0 0 0 255 0 0\n1 0 0 1 2 3\n0 1 0 4 5 6\n3 0 1 2 6 0 0 1 0 0 1\n4 0 1 2 -1\n7\n",
    (ply % "binary_little_endian").encode() + vertex * 3 + struct.pack("<BiiiBffffff", 3, 0, 1, 2, 6, 0, 0, 1, 0, 0, 1)
    + struct.pack("<iiiiif", 4, 0, 1, 2, -1, 7), (ply % "binary_big_endian").encode() + bytes(80))
put("stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid a\n", b"COLOR=\1\2\3\4".ljust(80) + struct.pack("<I12fH", 1, *range(12), 31))

put("scene_json",
    '{"model":"m.obj","scale":1000,"camera":{"position":[0,0,4],"target":[0,0,0],"up":[0,1,0],"fov":40},'
    '"sun":{"direction":[0,-1,0],"irradiance":[1,1,1]},"background":[0,0,0],"exposure":1}',
    '{"model":"m.obj","cameras":[{"name":"a","position":[0,0,4],"direction":[0,0,-1]}],"sun":null,'
    '"spots":[{"position":[0,3,0],"target":[0,0,0],"intensity":[1,1,1],"innerAngle":20,"outerAngle":30}],'
    '"points":[{"position":[0,3,0],"intensity":[1,1,1]}],'
    '"environment":{"picture":"p.pfm","radiance":[1,1,1],"rotation":90}}',
    '{"model":"m.obj","scale":1,"media":{"x":{"catalogue":"milk","scale":2},'
    '"y":{"scattering":[1,1,1],"absorption":[0.1,0.1,0.1],"g":0.5,"density":{"file":"d.raw","size":[2,2,2]}}},'
    '"materials":{"a":{"bsdf":"dielectric","ior":1.5,"interior":"x","priority":1,"roughness":0.1}},'
    '"cameraMedium":"y","keyFrames":"k.txt"}',
    '{"model":"m.obj","sun":{"direction":{"times":[0,1],"values":[[0,-1,0],[1,-1,0]]},"irradiance":[1,1,1]},'
    '"camera":{"position":{"times":[0,2],"values":[[0,0,4],[1,0,4]],"interpolation":"cubic","loop":true},'
    '"target":[0,0,0],"fov":{"times":[0,1,3],"values":[40,60,20]}},'
    '"points":[{"position":[0,3,0],"intensity":{"times":[0,1],"values":[[1,1,1],[0,0,0]],"interpolation":"step"}}],'
    '"objects":{"o":{"turn":{"axis":[0,1,0],"degrees":{"times":[0,2],"values":[0,360]}},"pivot":[1,0,0],'
    '"translation":{"times":[-1,1],"values":[[0,0,0],[1,0,0]]},"scale":{"times":[0,1],"values":[1,-1]}}},'
    '"exposure":{"times":[0,1],"values":[1,2]},"background":{"times":[0,1],"values":[[0,0,0],[1,1,1]]}}',
    '{"model":"m.obj","scale":1000,"sun":{"latitude":50,"day":172,"hour":{"times":[0,24],"values":[0,24],"loop":true},'
    '"irradiance":[1,1,1],"turbidity":3},"objects":{"o":{"scale":[1,2,1]}},'
    '"materials":{"a":{"emission":{"times":[0,1],"values":[[0,0,0],[1,1,1]]}}},'
    '"media":{"x":{"sigma_s":{"times":[0,1],"values":[[1,1,1],[0,0,0]]},"sigma_a":[0,0,0]}}}')
put("original_scene_json",
    '{"scene":{"camera":[0,0,4],"cameraLookAt":[0,0,0],"fov":45,"lightPos":[0,4,0],"lightColor":[1,1,1],'
    '"lightIntensity":100,"scale":1},'
    '"b c":{"sigma_s":[1,1,1],"sigma_a":[0.1,0.1,0.1],"g":[0.5,0.5,0.5],"ior":1.33},"// a":0}',
    '{"scene":{"camera":[0,4,0],"cameraLookAt":[0,0,0],"fov":45,"lightPos":[0,4,0],"lightColor":[1,1,1],'
    '"lightIntensity":1},"0":{"sigma_s":[0,0,0],"sigma_a":[0,0,0],"g":[0,0,0],"ior":1}}')
put("mtl", "newmtl Milk.001\nNi 1.33\nd 0.5\nKd 1 1 1\nnewmtl wall\nTr 0.2\n", "newmtl a b\n")

numbers = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<12B", *[0, 1, 2, 0] * 3)
numbers += struct.pack("<16f", *[1 if k % 5 == 0 else 0 for k in range(16)])
numbers += struct.pack("<2f", 0.0, 1.5) + struct.pack("<18f", *[0.1 * k + 0.1 for k in range(18)])
gltf = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"children": [1, 2, 3]},
              {"mesh": 0, "weights": [0.5],
               "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}},
              {"mesh": 0, "skin": 0, "translation": [1, 2, 3], "rotation": [0, 0, 1, 0], "scale": [-1, 1, 1]},
              {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 0, "JOINTS_0": 1, "WEIGHTS_0": 2},
                                "targets": [{"POSITION": 0}], "indices": 3, "mode": 5, "material": 0}]}],
    "skins": [{"joints": [0], "inverseBindMatrices": 4}],
    "cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}}],
    "extensionsUsed": ["EXT_mesh_gpu_instancing", "VENDOR_x"],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "range": 1, "spot": {"innerConeAngle": 0.1}}]}},
    "materials": [{"name": "m", "alphaMode": "MASK", "alphaCutoff": 0.3, "emissiveFactor": [1, 1, 1],
                   "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": {
                       "index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.1, 0.2], "rotation": 0.5}}}},
                   "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5},
                                  "KHR_materials_volume": {
                                      "attenuationDistance": 1, "attenuationColor": [0, 1, 0.5]}}}],
    "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071}],
    "images": [{"uri": "data:image/bmp;base64," + base64.b64encode(bmp(1, 1, 24, b"", bytes(4))).decode()}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"},
                  {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4", "normalized": True},
                  {"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR", "sparse": {
                      "count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 1}}},
                  {"bufferView": 2, "componentType": 5126, "count": 1, "type": "MAT4"},
                  {"bufferView": 3, "componentType": 5126, "count": 2, "type": "SCALAR"},
                  {"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3"},
                  {"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC4"},
                  {"bufferView": 4, "componentType": 5126, "count": 6, "type": "VEC3"}],
    "animations": [{"channels": [{"sampler": k, "target": {"node": n, "path": path}} for k, n, path in (
                        (0, 2, "translation"), (1, 2, "rotation"), (2, 0, "scale"), (3, 1, "weights"))],
                    "samplers": [{"input": 5, "output": 6}, {"input": 5, "output": 7, "interpolation": "STEP"},
                                 {"input": 5, "output": 8, "interpolation": "CUBICSPLINE"},
                                 {"input": 5, "output": 5}]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 64},
                    {"buffer": 0, "byteOffset": 112, "byteLength": 8},
                    {"buffer": 0, "byteOffset": 120, "byteLength": 72}],
    "buffers": [{"byteLength": len(numbers)}]}
inside = json.dumps(gltf)
inside += " " * (-len(inside) % 4)
gltf["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(numbers).decode()
moving = dict(gltf, skins=[{"joints": [0, 1, 2]}])  # the other's joint is out of range
put("gltf", json.dumps(gltf), json.dumps(moving),
    b"glTF" + struct.pack("<III", 2, 28 + len(inside) + len(numbers), len(inside)) + b"JSON" + inside.encode() +
    struct.pack("<I", len(numbers)) + b"BIN\0" + numbers)

put("key_frames",
    "# a path\np 4 2 4 d -1 -0.3 -1 u 0 1 0 f 45\np 3 2 5 d -0.8 -0.3 -1 u 0 1 0 r 1 0 0 a 1.5\n",
    "p 0 0 0 d 1 0 0 u 0 1 0\np 0 0 0 d -1 0 0 u 0 1 0")

header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nendian: little\n\n"
ktx = (b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<9I", 9, 1, 2, 2, 2, 0, 1, 1, 0) + bytes(32) +
       struct.pack("<3Q", 104, 8, 8))
put("density",
    b"\0" + header.encode() + bytes(8),
    b"\0" + header.replace("uint8", "float").encode() + struct.pack("<8f", *range(8)),
    b"\1" + ktx[:104] + bytes(8), b"\2" + bytes(8), b"\2" + bytes(32))

triangle = struct.pack("<9f3fIIf", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 100, 0, 0.5)
put("rad_file", struct.pack("<I", 1) + triangle, struct.pack("<I", 2) + triangle * 2)

patch = (struct.pack("<6I15fiI2f", 0, 1, 2, 0, 1, 2, *([0] * 6), *([0, 0, 1] * 3), 0, 0, 0.5, 0) +
         struct.pack("<25d", *([0] * 6), 0.5, *([0.5] * 18)))
settings = (b"radiosity.edge=0 radiosity.resolution=64 radiosity.exact-pixels=12 radiosity.part-distance=3 "
            b"radiosity.parts=8 radiosity.seed=1 radiosity.repair=on radiosity.refinements=0")
points = struct.pack("<9d", 0, 0, 0, 1, 0, 0, 0, 1, 0)
solution = struct.pack("<8s4I5Q5d", b"LUCLIGHT", 3, 1, 0, len(settings), 0, 3, 1, 3, 0, 1, 0, 0, 0, 1)
put("solution", solution + settings + points + patch)

rows = struct.pack("<IIQQ", 0, 1, 1, 0) + struct.pack("<IffIf", 1, 0.5, 0, 1, 0.5)
head = struct.pack("<8sIIQ", b"LUCROWS\n", 2, 16, 7)
more_rows = struct.pack("<IIQQ", 1, 2, 0, 0) + struct.pack("<IIffff", 0, 0, 0, 0, 1, 1)
put("rows", head, head + rows, head + rows + more_rows)

put("sweep_checkpoint",
    struct.pack("<8sII5Qd", b"LUCRADSW", 1, 2, 1, 2, 3, 2, 1, 0.5) + struct.pack("<3f", 1, 2, 3) + bytes(8))
reference = struct.pack("<8sQQdd4i", b"LUCREF01", 5, 4, 1.5, 0.1, 2, 1, 3, 4)
put("reference", reference + b"mesa" + struct.pack("<12f", *range(12)) + bytes(8))
put("settings_file",
    '{"technique":"lpv","fidelity":"corrected","deviations":["lpv.x=on"],"settings":["lpv.cells=16"],'
    '"measured":{"ms":3.5}}', '{"technique":"path","spp":16}')
put("stability_table",
    '{"rows":[{"technique":"lpv","case":"a","parameter":"b","expected":1.5,"tolerance":0.1,"rule":"equals",'
    '"measured":1.45,"verdict":"pass"},'
    '{"technique":"path","case":"c","parameter":"","expected":0,"tolerance":0,"rule":"at most","measured":null,'
    '"verdict":"fail"}]}')
