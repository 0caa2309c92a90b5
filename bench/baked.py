#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""PSNR of scenes/splats/bake_room.xml, baked into splats, from a camera that the bake does not know: of the sRGB-encoded pictures, as
published (dilation 0.3 at the centre of a pixel) and without dilation. Or of scenes/splats/bake_thin.xml, baked into a radiance grid,
from three cameras. Needs numpy and OpenEXR.

    bench/baked.py [--size 256] [--count 60000] [--paths 32] [--degree 0] [--ball matte]
    bench/baked.py grid [--size 128] [--resolution 128] [--paths 64]"""
import argparse
import os
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenEXR

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHOWN = """<scene version="3.0.0"><integrator type="splat">{settings}</integrator><include filename="{view}"/>
<shape type="cube"><transform name="to_world"><scale value="9"/></transform><bsdf type="null"/>
<medium type="splats" name="interior"><string name="filename" value="baked.ply"/></medium></shape></scene>"""


GRID = """<scene version="3.0.0"><integrator type="radiance_field"/><include filename="{view}"/>
<emitter type="constant"><rgb name="radiance" value="0.5, 0.5, 0.5"/></emitter>
<shape type="cube"><transform name="to_world"><scale value="9"/></transform><bsdf type="null"/>
<medium type="radiance_grid" name="interior"><string name="filename" value="baked.npz"/></medium></shape></scene>"""
CAMERAS = ["1.2, 1.6, 3.4", "-2, 1.1, 2.6", "0.3, 2.6, 2.8"]


def encoded(file):
    with OpenEXR.File(str(file), separate_channels=True) as f:
        channels = f.channels()
        c = np.maximum(0, np.stack([channels[k].pixels for k in "RGB"], axis=2).astype(float))
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def psnr_of(a, b):
    return -10 * np.log10(np.mean((encoded(a) - encoded(b)) ** 2))


def grid(a, run, folder, scenes, size):
    thin = scenes / "bake_thin.xml"
    run("bake", thin, "-D", "origin=0, 1, 4", "-o", "baked.npz", "--to", "grid", "--resolution", a.resolution, "--paths", a.paths)
    (folder / "shown.xml").write_text(GRID.format(view=scenes / "bake_view.xml"))
    found = []
    for origin in CAMERAS:
        run("render", thin, "-D", f"origin={origin}", *size, "-o", "truth.exr", "--spp", a.spp)
        run("render", "shown.xml", "-D", f"origin={origin}", *size, "-o", "shown.exr", "--spp", 32)
        found.append(psnr_of(folder / "truth.exr", folder / "shown.exr"))
    print(f"thin objects, {a.resolution} voxels, {a.paths} paths, {a.size} x {a.size}: "
          + ", ".join(f"{x:.1f}" for x in found) + f" dB, mean {np.mean(found):.1f} dB")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("kind", nargs="?", choices=["splats", "grid"], default="splats")
    p.add_argument("--aureole", default=str(ROOT / "build/release/bin/aureole"))
    for name, value in [("size", None), ("count", 60000), ("paths", None), ("degree", 0), ("spp", 128), ("resolution", 128)]:
        p.add_argument("--" + name, type=int, default=value)
    p.add_argument("--ball", default="matte", help="matte or glossy")
    a = p.parse_args()
    a.size, a.paths = a.size or {"splats": 256, "grid": 128}[a.kind], a.paths or {"splats": 32, "grid": 64}[a.kind]
    scenes = ROOT / "scenes/splats"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        run = lambda *arguments: subprocess.run([a.aureole, *map(str, arguments)], cwd=folder, check=True, capture_output=True)
        size = ["-D", f"width={a.size}", "-D", f"height={a.size}"]
        if a.kind == "grid":
            grid(a, run, folder, scenes, size)
            return
        room = [scenes / "bake_room.xml", "-D", f"ball={a.ball}"]
        run("render", *room, *size, "-o", "truth.exr", "--spp", a.spp)
        run("bake", *room, "-D", "origin=0, 1, 4", "-o", "baked.ply", "--count", a.count, "--paths", a.paths, "--degree", a.degree)
        for name, settings in [("as published", ""),
                               ("without dilation", '<float name="dilation" value="0"/><string name="evaluated_at" value="sample"/>')]:
            (folder / "shown.xml").write_text(SHOWN.format(settings=settings, view=scenes / "bake_view.xml"))
            run("render", "shown.xml", *size, "-o", "shown.exr", "--spp", 64)
            psnr = psnr_of(folder / "truth.exr", folder / "shown.exr")
            print(f"{a.ball}, {a.count} splats of degree {a.degree}, {a.paths} paths, {a.size} x {a.size}, {name}: {psnr:.1f} dB")


main()
