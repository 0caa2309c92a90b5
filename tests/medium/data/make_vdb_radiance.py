#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes radiance/sh1.vdb and cd.vdb, and turned.vdb and plain.vdb beside this file: radiance grids of OpenVDB's own Python module (Debian's python3-openvdb).

sh1.vdb: 3 x 4 x 5 voxels from (-1, 0, 2), of the edges 0.5, 0.25 and 1, with the density 1 + x / 4 - y / 8 + z / 16 and the coefficients
(x / 128 + k / 8, y / 64 - k / 8, z / 32), k = 0 to 3, at the voxel x, y, z. cd.vdb: a density of 2 at 16 x 8 x 8 voxels (tiles) with the
linear colour (0.25, 0.5, 1) in the half of lower x and nothing in the other. turned.vdb: one voxel in a grid that a transform turns. plain.vdb: a density without colours."""
import pathlib

import pyopenvdb as vdb

HERE = pathlib.Path(__file__).parent / "radiance"


def named(grid, name, transform):
    grid.name, grid.transform = name, transform
    return grid


def main():
    # Row vectors: the last row is the translation.
    scaled = vdb.createLinearTransform([[0.5, 0, 0, 0], [0, 0.25, 0, 0], [0, 0, 1, 0], [10, -2, 0.5, 1]])
    density = named(vdb.FloatGrid(0), "density", scaled)
    terms = [named(vdb.Vec3SGrid((0, 0, 0)), f"sh_{k}", scaled) for k in range(4)]
    for x in range(-1, 2):
        for y in range(4):
            for z in range(2, 7):
                density.getAccessor().setValueOn((x, y, z), 1 + x / 4 - y / 8 + z / 16)
                for k, term in enumerate(terms):
                    term.getAccessor().setValueOn((x, y, z), (x / 128 + k / 8, y / 64 - k / 8, z / 32))
    vdb.write(str(HERE / "sh1.vdb"), grids=[density, *terms])
    same = vdb.createLinearTransform(0.1)
    density, color = named(vdb.FloatGrid(0), "density", same), named(vdb.Vec3SGrid((0, 0, 0)), "Cd", same)
    density.fill((0, 0, 0), (15, 7, 7), 2.0)
    color.fill((0, 0, 0), (7, 7, 7), (0.25, 0.5, 1))
    density.prune(0.0)
    color.prune((0.0, 0.0, 0.0))
    vdb.write(str(HERE / "cd.vdb"), grids=[density, color])
    vdb.write(str(HERE.parent / "plain.vdb"), grids=[density])
    turned = vdb.createLinearTransform([[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    density, color = named(vdb.FloatGrid(0), "density", turned), named(vdb.Vec3SGrid((0, 0, 0)), "Cd", turned)
    density.getAccessor().setValueOn((0, 0, 0), 1.0)
    color.getAccessor().setValueOn((0, 0, 0), (1, 1, 1))
    vdb.write(str(HERE.parent / "turned.vdb"), grids=[density, color])


main()
