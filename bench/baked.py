#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""PSNR of scenes/splats/bake_room.xml, baked into splats, from a camera that the bake does not know: of the sRGB-encoded pictures, as
published (dilation 0.3 at the centre of a pixel) and without dilation. Needs numpy and OpenEXR.

    bench/baked.py [--size 256] [--count 60000] [--paths 32] [--degree 0] [--ball matte]"""
import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenEXR

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHOWN = """<scene version="3.0.0"><integrator type="splat">{settings}</integrator><include filename="{view}"/>
<shape type="cube"><transform name="to_world"><scale value="9"/></transform><bsdf type="null"/>
<medium type="splats" name="interior"><string name="filename" value="baked.ply"/></medium></shape></scene>"""


def encoded(file):
    with OpenEXR.File(str(file), separate_channels=True) as f:
        channels = f.channels()
        c = np.maximum(0, np.stack([channels[k].pixels for k in "RGB"], axis=2).astype(float))
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--aureole", default=str(ROOT / "build/release/bin/aureole"))
    for name, value in [("size", 256), ("count", 60000), ("paths", 32), ("degree", 0), ("spp", 128)]:
        p.add_argument("--" + name, type=int, default=value)
    p.add_argument("--ball", default="matte", help="matte or glossy")
    a = p.parse_args()
    scenes = ROOT / "scenes/splats"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        run = lambda *arguments: subprocess.run([a.aureole, *map(str, arguments)], cwd=folder, check=True, capture_output=True)
        size = ["-D", f"width={a.size}", "-D", f"height={a.size}"]
        room = [scenes / "bake_room.xml", "-D", f"ball={a.ball}"]
        run("render", *room, *size, "-o", "truth.exr", "--spp", a.spp)
        run("bake", *room, "-D", "origin=0, 1, 4", "-o", "baked.ply", "--count", a.count, "--paths", a.paths, "--degree", a.degree)
        for name, settings in [("as published", ""),
                               ("without dilation", '<float name="dilation" value="0"/><string name="evaluated_at" value="sample"/>')]:
            (folder / "shown.xml").write_text(SHOWN.format(settings=settings, view=scenes / "bake_view.xml"))
            run("render", "shown.xml", *size, "-o", "shown.exr", "--spp", 64)
            psnr = -10 * np.log10(np.mean((encoded(folder / "truth.exr") - encoded(folder / "shown.exr")) ** 2))
            print(f"{a.ball}, {a.count} splats of degree {a.degree}, {a.paths} paths, {a.size} x {a.size}, {name}: {psnr:.1f} dB")


main()
