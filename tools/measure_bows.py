#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures where the first bow is in pictures of scenes/media/bow.xml, in light of one wavelength, beside Descartes' ray and Airy's
theory (needs the Python package; half a minute):

    PYTHONPATH=build/release/python .venv/bin/python tools/measure_bows.py
"""
import math
import os

import numpy as np

import aureole
from aureole import spectrum

SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes", "media", "bow.xml")
WIDTH, HEIGHT, FOV = 40, 600, 1.0


def descartes(m):
    """The angle from the antisolar point of the least deflected ray, in degrees; `m`: index of water over that of air."""
    i = math.acos(math.sqrt((m * m - 1) / 3))
    return math.degrees(4 * math.asin(math.sin(i) / m) - 2 * i)


def airy(m, x):
    """How far inside of it the first maximum of Airy's function is, in degrees (van de Hulst, Light Scattering by Small Particles, 1957,
    section 13.23, with two refractions and one reflection)."""
    h = 9 / 4 * math.sqrt((4 - m * m) / (m * m - 1) ** 3)
    return math.degrees(1.01879 * (h / x**2) ** (1 / 3))


def measured(nm, radius_um, near):
    scene = aureole.load_file(SCENE, width=WIDTH, height=HEIGHT, fov=FOV, elevation=near, nm_min=nm - 1, nm_max=nm + 1,
                              radius=f"{radius_um}um", variance=0.002)
    column = aureole.render(scene, spp=64, progress=False).rgb.sum(axis=(1, 2))
    up = -((np.arange(HEIGHT) + 0.5) * 2 / HEIGHT - 1) * math.tan(math.radians(FOV / 2)) * HEIGHT / WIDTH
    angle = near + np.degrees(np.arctan(up))
    # The middle of what is within 15 % of the brightest: a table has errors of a per cent, which move a maximum.
    top = np.convolve(column, np.ones(9) / 9, "same")
    sky = column[angle > near + 2].min()
    return float(np.mean(angle[top - sky > 0.85 * (top.max() - sky)]))


def main():
    print("nm   radius [um]  index   Descartes  Airy   picture")
    for nm, radius in ((650, 400), (500, 300), (550, 100), (550, 10)):
        m = float(spectrum.refractive_index("water", nm).real) / 1.000277
        ray = descartes(m)
        theory = ray - airy(m, 2 * math.pi * radius * 1e3 / nm)
        print(f"{nm}  {radius:>8}     {m:.4f}  {ray:>7.2f}  {theory:>7.2f}  {measured(nm, radius, theory):>7.2f}", flush=True)


if __name__ == "__main__":
    main()
