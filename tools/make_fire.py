#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the grids of a camp fire as .vol files (needs numpy):

    make_fire.py scenes/media       # soot.vol (relative extinction), albedo.vol and temperature.vol (K) in scenes/media

Tongues of flame rise along y, bent by the turbulence of make_smoke.py. Soot in them absorbs and glows; above them the gas
cools, and smoke, droplets of tar and ash, scatters. The same arguments give the same files.
"""
import argparse
import os

import numpy as np

from make_smoke import centres, turbulence, write_vol

SIZE = (24, 40, 24)
AMBIENT, HOTTEST = 300.0, 2050.0
ALBEDO_SOOT, ALBEDO_SMOKE = 0.23, 0.9  # of young soot; of the smoke of damp wood


def flame(rng, at):
    """Density of the flame, in [0, 1]; 1 in the middle of its foot."""
    x, y, z = at
    rise = np.clip(y, 0, 1)
    moved = at + 0.22 * np.stack([turbulence(rng, at * np.array([1, 0.6, 1]).reshape(3, 1, 1, 1), 3, 3) for _ in range(3)]) * rise
    inside = np.zeros_like(x)
    for _ in range(11):
        angle, distance = 2 * np.pi * rng.random(), 0.24 * np.sqrt(rng.random())
        height, width = 0.4 + 0.45 * rng.random(), 0.08 + 0.05 * rng.random()
        u = moved[0] - 0.5 - distance * np.cos(angle) * (1 - 0.7 * rise)
        w = moved[2] - 0.5 - distance * np.sin(angle) * (1 - 0.7 * rise)
        up = moved[1] / height
        # A tongue is widest at a third of its height and ends in a point.
        radius = width * np.clip(1.6 * np.sqrt(np.clip(up + 0.15, 0, None)) * (1 - up), 1e-3, None)
        inside = np.maximum(inside, np.exp(-(u**2 + w**2) / radius**2) * np.clip(4 * (1 - up), 0, 1))
    return inside * np.clip(y / 0.02, 0, 1)


def smoke(rng, at):
    """The plume above, from half of the height on."""
    x, y, z = at
    moved = at + 0.3 * np.stack([turbulence(rng, at, 3, 3) for _ in range(3)])
    radius = 0.1 + 0.16 * y
    core = np.exp(-((moved[0] - 0.5) ** 2 + (moved[2] - 0.5) ** 2) / radius**2)
    border = np.clip(np.minimum.reduce([x, 1 - x, z, 1 - z]) / 0.1, 0, 1)
    return core * np.clip((y - 0.4) / 0.25, 0, 1) * np.clip((1 - y) / 0.3, 0, 1) * border


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--size", type=int, nargs=3, default=SIZE, help="voxels along x, y, z")
    parser.add_argument("--seed", type=int, default=4)
    args = parser.parse_args()
    rng = np.random.default_rng(args.seed)
    at = centres(args.size)
    fire = flame(rng, at)
    above = smoke(rng, at)
    # Soot glows in the outer part of a flame, where it burns; the gas cools as it rises.
    soot, smoke_part = np.clip(fire - 0.05, 0, None), 0.5 * above
    both = soot + smoke_part
    albedo = np.where(both > 0, (ALBEDO_SOOT * soot + ALBEDO_SMOKE * smoke_part) / np.where(both > 0, both, 1), ALBEDO_SMOKE)
    temperature = AMBIENT + (HOTTEST - AMBIENT) * np.clip(fire, 0, 1) ** 0.3 * (1 - 0.3 * at[1])
    write_vol(os.path.join(args.folder, "soot.vol"), both)
    write_vol(os.path.join(args.folder, "albedo.vol"), albedo)
    write_vol(os.path.join(args.folder, "temperature.vol"), temperature)


if __name__ == "__main__":
    main()
