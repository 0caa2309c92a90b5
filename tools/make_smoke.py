#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a procedural density grid as a .vol file (needs numpy):

    make_smoke.py smoke.vol                       # a plume of 128^3 voxels that rises along y
    make_smoke.py cloud.vol --kind cloud --size 192 144 192     # clouds in a sky that is 99 % empty

Turbulence is a sum of octaves of interpolated random numbers ("value noise"; Ebert et al. 2003, Texturing and Modeling,
chapter 2), and where it is looked up is itself moved by such noise. The same arguments give the same file.
"""
import argparse
import struct

import numpy as np


def noise(rng, at, cells):
    """Random numbers on a lattice of `cells` per unit, repeated, interpolated smoothly at `at` (3 x depth x height x width)."""
    lattice = rng.random((cells,) * 3, dtype=np.float32)
    p = at * cells
    base = np.floor(p).astype(int)
    t = p - base
    t = t * t * (3 - 2 * t)
    sum_ = 0
    for corner in range(8):
        offset = [(corner >> i) & 1 for i in range(3)]
        weight = np.prod([t[i] if offset[i] else 1 - t[i] for i in range(3)], axis=0)
        index = tuple((base[i] + offset[i]) % cells for i in range(3))
        sum_ = sum_ + weight * lattice[index]
    return sum_


def turbulence(rng, at, cells, octaves):
    """In [-1, 1], mostly near 0."""
    sum_, amplitude, total = 0, 1.0, 0.0
    for i in range(octaves):
        sum_ = sum_ + amplitude * (2 * noise(rng, at, cells << i) - 1)
        total += amplitude
        amplitude *= 0.55
    return sum_ / total


def smoke(rng, at):
    x, y, z = at
    moved = at + 0.12 * np.stack([turbulence(rng, at, 3, 3) for _ in range(3)]) * np.minimum(3 * y, 1)
    u, v, w = moved
    bend = 0.08 * np.sin(5 * v)
    radius = 0.05 + 0.28 * np.maximum(v, 0)
    core = np.exp(-((u - 0.5 - bend) ** 2 + (w - 0.5) ** 2) / radius**2)
    detail = np.clip(0.55 + 2.2 * turbulence(rng, moved * np.array([1, 0.7, 1]).reshape(3, 1, 1, 1), 6, 4), 0, None)
    fade = np.clip(y / 0.03, 0, 1) * np.clip((1 - y) / 0.25, 0, 1)
    border = np.clip(np.minimum.reduce([x, 1 - x, z, 1 - z]) / 0.05, 0, 1)
    return np.clip(core * detail - 0.12, 0, None) * fade * border * 0.05 / radius


def cloud(rng, at):
    moved = at + 0.04 * np.stack([turbulence(rng, at, 4, 3) for _ in range(3)])
    density = np.zeros(at.shape[1:], np.float32)
    for _ in range(5):
        centre = 0.15 + 0.7 * rng.random(3)
        radius = (0.06 + 0.06 * rng.random()) * np.array([1.3, 0.7, 1.3])
        distance2 = sum(((moved[i] - centre[i]) / radius[i]) ** 2 for i in range(3))
        density = np.maximum(density, 1 - distance2)
    return np.clip(density + 0.9 * turbulence(rng, at, 16, 3) - 0.1, 0, None) * (density > 0)


def centres(size):
    """Centres of the voxels of a unit cube (3 x depth x height x width), of `size` voxels along x, y, z."""
    width, height, depth = size
    z, y, x = np.meshgrid(*[(np.arange(n, dtype=np.float32) + 0.5) / n for n in (depth, height, width)], indexing="ij")
    return np.stack([x, y, z])


def write_vol(path, grid):
    """A grid (depth x height x width) of the unit cube in Mitsuba's format, as 32-bit numbers."""
    depth, height, width = grid.shape
    with open(path, "wb") as f:
        f.write(b"VOL\x03" + struct.pack("<5i6f", 1, width, height, depth, 1, 0, 0, 0, 1, 1, 1) + grid.astype("<f4").tobytes())
    print(f"{path}: {width} x {height} x {depth}, mean {grid.mean():.3g}, {(grid == 0).mean():.1%} empty")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--kind", choices=["smoke", "cloud"], default="smoke")
    parser.add_argument("--size", type=int, nargs="+", default=[128], help="voxels along x, y, z, or one number for all")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    size = args.size if len(args.size) == 3 else args.size * 3
    density = {"smoke": smoke, "cloud": cloud}[args.kind](np.random.default_rng(args.seed), centres(size))
    write_vol(args.file, density / density.max())


if __name__ == "__main__":
    main()
