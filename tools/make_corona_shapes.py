#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the shapes of scenes/corona that are no primitives: curtain.ply and glasses.txt. Lengths in metres."""
import math
import pathlib
import struct

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "corona"


def curtain(columns=150, rows=16, width=2.4, height=1.7):
    """A hanging cloth with folds that open towards the hem; u runs along the cloth, v upwards."""
    def point(i, j):
        s, t = i / (columns - 1), j / (rows - 1)  # t: 0 at the hem
        phase = 2 * math.pi * (9 * s + 0.25 * math.sin(2 * math.pi * s * 1.3) + 0.08 * math.sin(3 * t + 5 * s))
        depth = 0.035 * (1.25 - 0.5 * t) * (1 + 0.3 * math.sin(4 * s + 1))
        z = depth * math.sin(phase) + 0.012 * math.sin(2.3 * phase + 2 * t)
        x = width * (s - 0.5) + 0.25 * depth * math.sin(2 * phase)
        return x, height * t, z

    grid = [[point(i, j) for i in range(columns)] for j in range(rows)]
    vertices = bytearray()
    for row in grid:
        along = 0.0
        for i, p in enumerate(row):
            if i:
                along += math.dist(p, row[i - 1])
            vertices += struct.pack("<5f", *p, along, p[1])
    faces = bytearray()
    for j in range(rows - 1):
        for i in range(columns - 1):
            a = j * columns + i
            for triangle in ((a, a + 1, a + columns + 1), (a, a + columns + 1, a + columns)):
                faces += struct.pack("<B3H", 3, *triangle)
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {columns * rows}\n"
              + "".join(f"property float {n}\n" for n in ("x", "y", "z", "u", "v"))
              + f"element face {2 * (columns - 1) * (rows - 1)}\nproperty list uchar ushort vertex_indices\nend_header\n")
    (FOLDER / "curtain.ply").write_bytes(header.encode() + vertices + faces)


def glasses(lens=0.03, centre=0.0355, wire=0.0011):
    """The rims, the bridge and the temples, as control points of cubic B-splines; the bridge's middle is (0, 0, 0)."""
    curves = []
    for side in (-1, 1):
        n = 48  # a closed curve: the first three points come again
        grow = 1 / (1 - (2 * math.pi / n) ** 2 / 6)  # the spline runs inside its control points
        rim = [(side * centre + lens * grow * math.cos(2 * math.pi * k / n),
                lens * grow * math.sin(2 * math.pi * k / n), 0) for k in range(n + 3)]
        curves.append(rim)
        x = side * (centre + lens)
        curves.append([(x - side * 0.002, 0.006, 0)] * 3 + [(x + side * 0.004, 0.007, 0.001),
                      (x + side * 0.006, 0.007, 0.012), (x + side * 0.008, 0.007, 0.06)]
                      + [(x + side * 0.009, 0.006, 0.13)] * 3)
    edge = centre - lens
    curves.append([(-edge - 0.001, 0.004, 0)] * 3 + [(-edge * 0.6, 0.0085, 0), (0, 0.0105, 0), (edge * 0.6, 0.0085, 0)]
                  + [(edge + 0.001, 0.004, 0)] * 3)
    text = "\n\n".join("\n".join(f"{x:.6f} {y:.6f} {z:.6f} {wire}" for x, y, z in c) for c in curves)
    (FOLDER / "glasses.txt").write_text(text + "\n")


if __name__ == "__main__":
    curtain()
    glasses()
