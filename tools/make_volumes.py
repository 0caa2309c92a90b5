#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the grids of scenes/volumes as NRRD files (needs numpy):

    make_volumes.py orbital orbital.nrrd    # wave function of hydrogen, n = 4, l = 2, m = 0, its largest value 1000
    make_volumes.py part part.nrrd          # a machine part: aluminium 120, steel bolts 220, air 0
    make_volumes.py head head.nrrd --inv3 Cranium.inv3    # the CT head of Debian's package invesalius-examples (GPL-2)

The same arguments give the same file.
"""
import argparse
import gzip
import plistlib
import tarfile
from pathlib import Path

import numpy as np


def axes(size, reach):
    """Coordinates z, y, x of the voxel centres from -reach to reach."""
    return np.meshgrid(*[(np.arange(n) + 0.5) / n * 2 * r - r for n, r in zip(size, reach)], indexing="ij")


def orbital():
    """Real wave function of hydrogen for n = 4, l = 2, m = 0; lengths in Bohr radii."""
    z, y, x = axes((104, 84, 84), (44, 34, 34))
    r = np.sqrt(x * x + y * y + z * z)
    rho = r / 2  # 2 r / n
    psi = rho**2 * (6 - rho) * np.exp(-rho / 2) * (3 * z * z / np.maximum(r * r, 1e-9) - 1)
    return np.round(1000 * psi / np.abs(psi).max()).astype("<i2"), "int16", (88 / 104, 68 / 84, 68 / 84), (44, 34, 34)


def part():
    """A flanged pipe with four bolts, averaged over 2^3 points of each voxel; lengths in millimetres."""
    n = 128
    z, y, x = axes((2 * n // 2, 2 * n, 2 * n), (16, 32, 32))
    r = np.hypot(x, y)
    solid = ((r < 30) & (z < -6) & (z > -14)) | ((r < 14) & (z > -14) & (z < 14)) | ((np.abs(r - 16) < 1.5) & (np.abs(z + 5.5) < 1))
    solid |= ((np.abs(x) < 1.2) | (np.abs(y) < 1.2)) & (r < 14 + (2 - z) * 0.8) & (z < 4) & (z > -7)
    solid &= r > 9
    value = np.where(solid, 120.0, 0.0)
    for k in range(4):
        a = np.pi / 4 + k * np.pi / 2
        d = np.hypot(x - 23 * np.cos(a), y - 23 * np.sin(a))
        value[(d < 3.4) & (z < 0)] = 0
        bolt = (d < 2.8) & (z > -15) & (z < -1)
        u, v = x - 23 * np.cos(a), y - 23 * np.sin(a)
        head = np.maximum.reduce([np.abs(u), np.abs(0.5 * u + 0.866 * v), np.abs(0.5 * u - 0.866 * v)])
        bolt |= (head < 5) & (z > -6) & (z < -2)
        value[bolt] = 220
    value = value.reshape(n // 2, 2, n, 2, n, 2).mean((1, 3, 5))
    for axis in range(3):  # as blurred as a scan
        value = (np.roll(value, 1, axis) + 2 * value + np.roll(value, -1, axis)) / 4
    return np.round(value).astype(np.uint8), "uint8", (0.5,) * 3, (16, 32, 32)


def head(path):
    with tarfile.open(path) as tar:
        members = {Path(m.name).name: m for m in tar.getmembers()}
        main = plistlib.loads(tar.extractfile(members["main.plist"]).read())
        matrix = np.frombuffer(tar.extractfile(members[main["matrix"]["filename"]]).read(), main["matrix"]["dtype"])
    values = matrix.reshape(main["matrix"]["shape"])
    spacing = main["spacing"][::-1]
    return values, "int16", spacing, [s * n / 2 for s, n in zip(spacing, values.shape)]


def write(path, values, kind, spacing, reach):
    """`spacing` and `reach`, half of the size, along z, y, x; the grid lies around the origin."""
    sizes = " ".join(str(n) for n in values.shape[::-1])
    step = list(spacing)[::-1]
    vectors = " ".join("(" + ",".join(f"{step[i] if i == k else 0:.9g}" for k in range(3)) + ")" for i in range(3))
    origin = ",".join(f"{-r + s / 2:.9g}" for r, s in zip(list(reach)[::-1], step))
    text = (f"NRRD0005\ntype: {kind}\ndimension: 3\nsizes: {sizes}\nspace: right-anterior-superior\n"
            f"space directions: {vectors}\nspace origin: ({origin})\nspace units: \"mm\" \"mm\" \"mm\"\nendian: little\nencoding: gzip\n\n")
    path.write_bytes(text.encode() + gzip.compress(values.tobytes(), 9, mtime=0))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("kind", choices=["orbital", "part", "head"])
    p.add_argument("file", type=Path)
    p.add_argument("--inv3", type=Path, help="the project that `head` reads")
    a = p.parse_args()
    if a.kind == "head" and not a.inv3:
        p.error("head needs --inv3, a file of Debian's package invesalius-examples")
    write(a.file, *(orbital() if a.kind == "orbital" else part() if a.kind == "part" else head(a.inv3)))


if __name__ == "__main__":
    main()
