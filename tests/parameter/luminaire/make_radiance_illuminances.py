#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes data/radiance_illuminances.csv: illuminances of luminaires as Radiance computes them.

    python3 make_radiance_illuminances.py AUREOLE

Needs pyradiance (PyPI), whose programs ies2rad, oconv and rtrace are run; AUREOLE is the program, which converts the file of
EULUMDAT to LM-63. The luminaires hang at the origin with gamma = 0 along -z and their length along x, as points. Illuminance
in lx is 179 lm/W times 0.265 R + 0.670 G + 0.065 B.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

import pyradiance

HERE = pathlib.Path(__file__).resolve().parent
LAMPS = HERE.parents[1] / "references/scenes/luminaires"
PACKAGE = pathlib.Path(pyradiance.__file__).parent
os.environ["PATH"] = f"{PACKAGE / 'bin'}:{os.environ['PATH']}"
os.environ["RAYPATH"] = f".:{PACKAGE / 'lib'}"

POINTS = [(0, 0, -2), (1, 0, -2), (0, 1.3, -2), (-1.5, 0.8, -2), (2.2, -1.7, -2), (0.4, 2.9, -1.2), (-3, -0.3, -1), (1.1, 1.1, -3)]


def illuminances(ies):
    subprocess.run(["ies2rad", "-o", "lamp", ies], check=True, stderr=subprocess.DEVNULL)
    # Sizes of the opening are set to zero, so that the light is a point.
    pathlib.Path("lamp.oct").write_bytes(subprocess.run(["oconv", "lamp.rad"], check=True, capture_output=True).stdout)
    rays = "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in POINTS)
    out = subprocess.run("rtrace -I -h -ab 0 -dj 0 -ds 0 -dt 0 -dc 1 lamp.oct".split(), input=rays, text=True, check=True, capture_output=True).stdout
    for line in out.splitlines():
        r, g, b = map(float, line.split())
        yield 179 * (0.265 * r + 0.670 * g + 0.065 * b)


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    rows = ["file,x,y,z,lux"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in ("downlight.ies", "batten.ldt", "asymmetric.ies"):
            subprocess.run([program, "goniophotometer", "-q", LAMPS / name, "-o", "lamp.ies"], check=True)
            text = pathlib.Path("lamp.ies").read_text().split("\n")
            at = text.index("TILT=NONE") + 1
            words = text[at].split()
            text[at] = " ".join(words[:7] + ["0", "0", "0"])
            pathlib.Path("lamp.ies").write_text("\n".join(text))
            for (x, y, z), lux in zip(POINTS, illuminances("lamp.ies")):
                rows.append(f"{name},{x},{y},{z},{lux:.6g}")
    (HERE / "data/radiance_illuminances.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
