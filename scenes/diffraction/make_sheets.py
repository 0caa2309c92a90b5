#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the sheets of this folder: OBJ files in mm, in the plane z = 0."""
import math


def write(name, comment, vertices, faces):
    with open(name, "w", encoding="ascii") as out:
        out.write(f"# SPDX-License-Identifier: Apache-2.0\n# {comment} Written by make_sheets.py.\n")
        for x, y in vertices:
            out.write(f"v {x:.6f} {y:.6f} 0\n")
        for face in faces:
            out.write("f " + " ".join(str(i + 1) for i in face) + "\n")


def sheet_with_holes(name, comment, xs, ys, is_open):
    """A sheet of rectangles between the lines xs and ys, of which some are open."""
    vertices = [(x, y) for y in ys for x in xs]
    n = len(xs)
    faces = []
    for j in range(len(ys) - 1):
        for i in range(n - 1):
            if not is_open(i, j):
                a = j * n + i
                faces += [(a, a + 1, a + n + 1), (a, a + n + 1, a + n)]
    write(name, comment, vertices, faces)


def star(name, points=5, outer=1.0, inner=0.42, rim=6000.0):
    count = 2 * points
    angles = [math.pi / 2 + math.pi * i / points for i in range(count)]
    radii = [outer if i % 2 == 0 else inner for i in range(count)]
    vertices = [(r * math.cos(a), r * math.sin(a)) for r, a in zip(radii, angles)]
    faces = []
    ring, radius = 0, outer
    while radius < rim:  # rings keep triangles from being slender, which ray tracers meet with errors
        radius = min(2.5 * radius, rim)
        vertices += [(radius * math.cos(a), radius * math.sin(a)) for a in angles]
        for i in range(count):
            j = (i + 1) % count
            a, b, c, d = (ring + i, ring + count + i, ring + count + j, ring + j)
            faces += [(a, b, c), (a, c, d)]
        ring += count
    write(name, "A sheet of 6 m with a hole: a star of five points, 1 mm from its centre.", vertices, faces)


if __name__ == "__main__":
    star("star.obj")
    sheet_with_holes("two_slits.obj", "A sheet with two slits, 0.2 mm wide, 0.6 mm apart, 4 mm long.",
                     [-600.0, -0.4, -0.2, 0.2, 0.4, 600.0], [-600.0, -2.0, 2.0, 600.0], lambda i, j: j == 1 and i in (1, 3))
