#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Errors of pictures with and without `aureole.denoise`, at equal time, against a long reference (docs/pictures.md).

    PYTHONPATH=build/release/python .venv/bin/python bench/denoise.py [--spp 16] [--reference 1024] [--scale 1] [--threads 0] [NAME ...]

The noisy picture of `spp` samples in each of 4 replicates has a box filter; features and network are counted as time, and the picture without
denoising gets as many more samples as `render(denoise=True)` takes longer. Time is that of the processor, of all threads together, so that
other programs on the machine count little; `denoise` also loads the scene again, with its tables.
"""
from __future__ import annotations

import argparse
import os
import sys
import time
import xml.etree.ElementTree as ElementTree

import numpy as np

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

import aureole
from aureole import _denoise

SCENES = {
    "demo": ("scenes/condensation/condensation.xml", {"width": 240, "height": 160}),
    "fog": ("scenes/media/fog.xml", {"width": 120, "height": 75}),
    "wax": ("scenes/marble/marble.xml", {"width": 120, "height": 45}),
    "milk": ("scenes/milk/milk.xml", {"width": 120, "height": 67}),
}


def boxed(path, defines):
    """The scene with a box filter."""
    text = aureole.load_file(path, **defines).xml()
    root = ElementTree.fromstring(text)
    _denoise.set_box_filter(root)
    return aureole.load_string(ElementTree.tostring(root, encoding="unicode"), path=path)


def error(image, truth):
    """Root of the mean squared error of the picture as a display shows it, so that a few bright pixels do not decide; and relative to it."""
    shown = lambda i: aureole.Image(i).tonemap().astype(float) / 255
    return float(np.sqrt(np.mean((shown(image) - shown(truth)) ** 2))), float(np.sqrt(np.mean((image - truth) ** 2 / (truth**2 + 1e-2 * np.mean(truth) ** 2))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=list(SCENES))
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--reference", type=int, default=1024)
    parser.add_argument("--scale", type=float, default=1, help="of width and height")
    parser.add_argument("--threads", type=int, default=0)
    a = parser.parse_args()
    print(f"{'scene':8} {'way':28} {'seconds':>8} {'RMSE shown':>11} {'relative':>9}")
    for name in a.names or SCENES:
        path, defines = SCENES[name]
        scene = boxed(path, {key: max(8, round(a.scale * size)) for key, size in defines.items()})
        truth = aureole.render(scene, a.reference, seed=99, progress=False, threads=a.threads).rgb
        begun = time.process_time()
        noisy = aureole.render(scene, a.spp, replicates=4, progress=False, threads=a.threads)
        render_s = time.process_time() - begun
        begun = time.process_time()
        found = aureole.denoise(noisy, scene=scene, feature_samples=16)
        denoise_s = time.process_time() - begun
        plain = aureole.denoise(noisy, scene=scene, feature_samples=16, keep_clean=False)
        blind = aureole.denoise(noisy)
        begun = time.process_time()
        once = aureole.render(scene, 4 * a.spp, progress=False, threads=a.threads, denoise=True)
        once_s = time.process_time() - begun
        more = int(np.ceil(4 * a.spp * once_s / render_s / 16)) * 16
        begun = time.process_time()
        longer = aureole.render(scene, more, seed=5, progress=False, threads=a.threads).rgb
        longer_s = time.process_time() - begun
        rows = [(f"{4 * a.spp} samples", noisy.rgb, render_s), (f"{more} samples, equal time", longer, longer_s),
                ("denoised", found[["R", "G", "B"]], render_s + denoise_s), ("denoised, unmixed", plain[["R", "G", "B"]], render_s + denoise_s),
                ("denoised without features", blind[["R", "G", "B"]], render_s), ("render(denoise=True)", once[["R", "G", "B"]], once_s)]
        for way, picture, seconds in rows:
            shown, relative = error(np.ascontiguousarray(picture), truth)
            print(f"{name:8} {way:28} {seconds:8.2f} {shown:11.4f} {relative:9.3f}")
        found.save(f"denoised-{name}.exr")
        aureole.Image(np.ascontiguousarray(found[["R", "G", "B"]])).save(f"denoised-{name}.png")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
