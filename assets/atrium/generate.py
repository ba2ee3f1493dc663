"""Builds the atrium: python3 assets/atrium/generate.py. Needs numpy.

Writes atrium.obj and atrium.mtl beside this file.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from generator import columns, obj, placement, roof, shell  # noqa: E402
from generator.mesh import Mesh  # noqa: E402


def main():
    mesh = Mesh()
    for part in (shell, columns, roof, placement):
        before = mesh.triangle_count()
        part.build(mesh)
        print(f"{part.__name__.split('.')[-1]:12} {mesh.triangle_count() - before:7} triangles")
    counts = obj.write(mesh, HERE / "atrium.obj", HERE / "atrium.mtl")
    print(counts, (HERE / "atrium.obj").stat().st_size, "bytes")


if __name__ == "__main__":
    main()
