#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the illuminances of luminaires as Radiance computes them, as CSV. The first form writes data/radiance_illuminances.csv
beside this script, of the luminaires of the tests, which the program AUREOLE converts to LM-63:

    python3 make_radiance_illuminances.py --program AUREOLE
    python3 make_radiance_illuminances.py [--opening point|file] -o FILE LAMP.ies ...

Needs pyradiance (PyPI), whose programs ies2rad, oconv and rtrace are run. The luminaires hang at the origin with gamma = 0 along
-z and their length along x, as points or with the luminous opening of the file. Illuminance in lx is 179 lm/W times
0.265 R + 0.670 G + 0.065 B.
"""
import argparse
import os
import pathlib
import subprocess
import tempfile

import pyradiance

HERE = pathlib.Path(__file__).resolve().parent
LAMPS = HERE.parents[1] / "references/scenes/luminaires"
PACKAGE = pathlib.Path(pyradiance.__file__).parent
os.environ["PATH"] = f"{PACKAGE / 'bin'}:{os.environ['PATH']}"
os.environ["RAYPATH"] = f".:{PACKAGE / 'lib'}"

POINTS = [(0, 0, -2), (1, 0, -2), (0, 1.3, -2), (-1.5, 0.8, -2), (2.2, -1.7, -2), (0.4, 2.9, -1.2), (-3, -0.3, -1), (1.1, 1.1, -3)]
#: A source is cut until its parts are small beside their distance.
EXACT = "-dj 0 -ds 0.02 -dt 0 -dc 1".split()


def illuminances(ies, folder):
    """Illuminances [lx] at all points."""
    def run(words, **more):
        return subprocess.run(words, cwd=folder, check=True, capture_output=True, **more).stdout

    run(["ies2rad", "-o", "lamp", ies])
    (folder / "lamp.oct").write_bytes(run(["oconv", "lamp.rad"]))
    rays = "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in POINTS)
    for line in run(["rtrace", "-I", "-h", "-ab", "0", *EXACT, "lamp.oct"], input=rays.encode()).decode().splitlines():
        r, g, b = map(float, line.split())
        yield 179 * (0.265 * r + 0.670 * g + 0.065 * b)


def as_point(ies, text):
    """The text of a file of LM-63 with an opening of size zero."""
    lines = text.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("TILT=NONE")) + 1
    words = lines[at].split()
    assert len(words) == 10, f"{ies}: the line behind TILT does not hold ten numbers"
    lines[at] = " ".join(words[:7] + ["0", "0", "0"])
    return "\n".join(lines) + "\n"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("lamps", nargs="*", type=pathlib.Path)
    options.add_argument("--program", type=pathlib.Path)
    options.add_argument("--opening", choices=("point", "file"), default="point")
    options.add_argument("-o", "--output", type=pathlib.Path, default=HERE / "data/radiance_illuminances.csv")
    o = options.parse_args()
    rows = ["file,x,y,z,lux"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for lamp in o.lamps or [LAMPS / n for n in ("downlight.ies", "batten.ldt", "asymmetric.ies")]:
            if o.program:
                subprocess.run([o.program.resolve(), "goniophotometer", "-q", lamp, "-o", folder / "lamp.ies"], check=True)
            else:
                (folder / "lamp.ies").write_text(lamp.read_text())
            text = (folder / "lamp.ies").read_text()
            (folder / "lamp.ies").write_text(as_point(lamp, text) if o.opening == "point" else text)
            rows += [f"{lamp.name},{x},{y},{z},{lux:.6g}" for (x, y, z), lux in zip(POINTS, illuminances("lamp.ies", folder))]
    o.output.write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
