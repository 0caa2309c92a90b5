#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Seconds of the processor until a scene is loaded, at the first start and at the second (docs/cache.md).

    bench/cache.py [--binary build/release/bin/aureole] [NAME ...]

One sample of one pixel is traced, so that loading is all that takes time. The cache is a folder of the script's own.
"""
from __future__ import annotations

import argparse
import os
import resource
import subprocess
import tempfile
import time

SCENES = {
    "rainbow": ("scenes/media/bow.xml", ["radius=250um", "variance=0.005"]),
    "fogbow": ("scenes/media/bow.xml", []),
    "powder": ("scenes/media/powder.xml", []),
    "fog": ("scenes/media/fog.xml", []),
    "milk": ("scenes/milk/milk.xml", []),
    "turbid": ("scenes/media/turbid.xml", []),
    "rutile": ("scenes/paint/rutile.xml", []),
    "varnish": ("scenes/paint/varnish.xml", []),
    "demo": ("scenes/condensation/condensation.xml", []),
    "droplets": ("scenes/condensation/droplets.xml", []),
    "spheres": ("scenes/corona/spheres.xml", []),
    "curtain": ("scenes/corona/curtain.xml", []),
    "double_gauss": ("scenes/light/double_gauss.xml", []),
    "street": ("scenes/street/street.xml", []),
}


def start(binary: str, scene: str, defines: list[str], cache: str, folder: str) -> tuple[float, float]:
    """Seconds of the processor and of the clock of one start."""
    words = [binary, "render", scene, "-q", "--pixel", "0,0", "--samples", "0:1", "--cache", cache, "-o", os.path.join(folder, "x.exr")]
    words += [w for d in defines for w in ("-D", d)]
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.perf_counter() - begun


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=list(SCENES))
    parser.add_argument("--binary", default="build/release/bin/aureole")
    a = parser.parse_args()
    print(f"{'scene':14} {'without':>9} {'first':>9} {'second':>9} {'MB':>8}   (seconds of the processor)")
    for name in a.names or SCENES:
        scene, defines = SCENES[name]
        with tempfile.TemporaryDirectory() as folder:
            cache = os.path.join(folder, "tables")
            without = start(a.binary, scene, defines, "off", folder)[0]
            first = start(a.binary, scene, defines, cache, folder)[0]
            second = min(start(a.binary, scene, defines, cache, folder)[0] for _ in range(3))
            kept = sum(e.stat().st_size for e in os.scandir(cache)) if os.path.isdir(cache) else 0
        print(f"{name:14} {without:9.2f} {first:9.2f} {second:9.2f} {kept * 1e-6:8.2f}", flush=True)


if __name__ == "__main__":
    main()
