#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Traces rays through the lenses of tests/references/scenes/lenses by optiland (PyPI, MIT licence; tested with 0.6.3) and writes
data/optiland_rays.csv: first-order properties, single rays, and root mean square spots, for lens_system_test.cpp.

    pip install optiland && ./make_lens_rays.py
"""
import math
import pathlib
import sys
import warnings

warnings.simplefilter("ignore")

import numpy as np  # noqa: E402
from optiland import materials, optic  # noqa: E402
from optiland.analysis import SpotDiagram  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
LENSES = HERE.parents[1] / "references/scenes/lenses"
# Sellmeier's coefficients of the data sheets of Schott.
GLASSES = {
    "sk16": ((1.34317774, 0.00704687339), (0.241144399, 0.0229005), (0.994317969, 92.7508526)),
    "ssk2": ((1.4306027, 0.00823982975), (0.153150554, 0.0333736841), (1.01390904, 106.870822)),
    "sk2": ((1.28189012, 0.0072719164), (0.257738258, 0.0242823527), (0.96818604, 110.377773)),
    "f5": ((1.3104463, 0.00958633048), (0.19603426, 0.0457627627), (0.96612977, 115.011883)),
    "f2": ((1.34533359, 0.00997743871), (0.209073176, 0.0470450767), (0.937357162, 111.886764)),
}
# Name, diameter of the entrance pupil [mm], fields [degrees].
CASES = (("double_gauss", 33.33, (0, 10, 14)), ("triplet", 10, (0, 14, 20)))


def index(glass, um):
    if glass in ("air", "-"):
        return 1.0
    return math.sqrt(1 + sum(b * um * um / (um * um - c) for b, c in GLASSES[glass]))


def rows_of(name):
    for line in (LENSES / f"{name}.lens").read_text().splitlines():
        words = line.split("#")[0].split()
        if not words or words[0] == "name":
            continue
        plane = words[0] in ("stop", "plane")
        yield (math.inf if plane else float(words[0]), float(words[1]), words[2], words[0] == "stop" or "stop" in words[4:])


def build(name, um, pupil, fields):
    lens = optic.Optic()
    lens.add_surface(index=0, thickness=np.inf)
    count = 1
    for radius, thickness, glass, stop in rows_of(name):
        material = "air" if glass in ("air", "-") else materials.IdealMaterial(n=index(glass, um))
        lens.add_surface(index=count, radius=radius, thickness=thickness, material=material, is_stop=stop)
        count += 1
    lens.add_surface(index=count)
    lens.set_aperture("EPD", pupil)
    lens.set_field_type("angle")
    for angle in fields:
        lens.add_field(y=angle)
    lens.add_wavelength(value=um, is_primary=True)
    return lens


def main():
    with open(HERE / "data/optiland_rays.csv", "w", encoding="ascii") as out:
        out.write("# written by make_lens_rays.py\n")
        out.write("# first,lens,um,focal length,entrance pupil from the first vertex,exit pupil from the film [mm]\n")
        out.write("# ray,lens,um,field [degrees],pupil x,pupil y (of the entrance pupil's radius),x,y on the film [mm]\n")
        out.write("# spot,lens,um,field [degrees],root mean square radius [mm]\n")
        for name, pupil, fields in CASES:
            for um in (0.4861327, 0.5875618, 0.6562725):
                lens = build(name, um, pupil, fields)
                p = lens.paraxial
                out.write(f"first,{name},{um},{float(p.f2()):.9f},{float(p.EPL()):.9f},{float(p.XPL()):.9f}\n")
                for field in fields:
                    for x, y in ((0, 0), (0, 0.9), (0, -0.7), (0.8, 0.3)):
                        rays = lens.trace_generic(Hx=0, Hy=field / max(fields), Px=x, Py=y, wavelength=um)
                        out.write(f"ray,{name},{um},{field},{x},{y},{float(rays.x[0]):.9f},{float(rays.y[0]):.9f}\n")
                spots = SpotDiagram(lens, num_rings=60, distribution="hexapolar").rms_spot_radius()
                for field, spot in zip(fields, spots):
                    out.write(f"spot,{name},{um},{field},{float(spot[0]):.7f}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
