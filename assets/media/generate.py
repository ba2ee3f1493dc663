"""Builds the media scenes: python3 assets/media/generate.py [NAME...]. Writes models, materials, scene JSON, camera
paths and the density grid. No packages needed; the grid takes about a minute."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from generator import scenes  # noqa: E402


def main():
    for name in sys.argv[1:] or scenes.SCENES:
        folder = HERE / name
        folder.mkdir(exist_ok=True)
        print(f"{name:10} {scenes.SCENES[name](folder, HERE.parent.parent / 'keyFrames'):7} triangles")


if __name__ == "__main__":
    main()
