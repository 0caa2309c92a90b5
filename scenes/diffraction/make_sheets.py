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


def ring(name, comment, inner, outer, pieces=32, rim=6000.0):
    """A sheet with an opening between two circles; nothing holds the disc in its middle."""
    angles = [2 * math.pi * i / pieces for i in range(pieces)]
    radii, closed = ([inner, outer], [True, False]) if inner > 0 else ([outer], [False])
    while radii[-1] < rim:  # rings keep triangles from being slender
        radii.append(min(2.5 * radii[-1], rim))
        closed.append(True)
    vertices = [(r * math.cos(a), r * math.sin(a)) for r in radii for a in angles]
    faces = []
    if inner > 0:
        faces += [(0, i, i + 1) for i in range(1, pieces - 1)]
    for k in range(len(radii) - 1):
        if not closed[k + 1]:
            continue
        for i in range(pieces):
            j = (i + 1) % pieces
            a, b, c, d = k * pieces + i, (k + 1) * pieces + i, (k + 1) * pieces + j, k * pieces + j
            faces += [(a, b, c), (a, c, d)]
    write(name, comment, vertices, faces)


def comb(name, teeth=15, pitch=2.0, width=0.9, length=25.0, back=8.0):
    """A comb: a back from which teeth hang, each of two triangles."""
    half = teeth * pitch / 2
    vertices = [(-half, 0), (half, 0), (half, back), (-half, back)]
    faces = [(0, 1, 2), (0, 2, 3)]
    for i in range(teeth):
        x = -half + (i + 0.5) * pitch
        a = len(vertices)
        vertices += [(x - width / 2, -length), (x + width / 2, -length), (x + width / 2, 0), (x - width / 2, 0)]
        faces += [(a, a + 1, a + 2), (a, a + 2, a + 3)]
    write(name, f"A comb of {teeth} teeth, {width:g} mm wide, {pitch:g} mm apart.", vertices, faces)


def leaves(name, count=14, seed=4):
    """Leaves, 7 to 13 cm long, at random in a square of 36 cm, with folds along their middle. Their outlines have 96 pieces, 1 to 3 mm long, so that
    no straight piece or corner shines by itself."""
    import random

    rng = random.Random(seed)
    with open(name, "w", encoding="ascii") as out:
        out.write("# SPDX-License-Identifier: Apache-2.0\n# Leaves, in mm. Written by make_sheets.py.\n")
        n = 0
        for _ in range(count):
            x, y, z = rng.uniform(-180, 180), rng.uniform(-180, 180), rng.uniform(-60, 60)
            size, turn, tilt = rng.uniform(70, 130), rng.uniform(0, 2 * math.pi), rng.uniform(-0.7, 0.7)
            c, s = math.cos(turn), math.sin(turn)

            def place(u, v, lift):
                w = lift * abs(v) + math.sin(tilt) * u
                u *= math.cos(tilt)
                return (x + c * u - s * v, y + s * u + c * v, z + w)

            steps = 48
            for i in range(steps + 1):
                t = i / steps
                half = 0.28 * size * math.sin(math.pi * t) ** 0.8 * (1.15 - 0.5 * t)
                for v in (-half, 0, half):
                    out.write("v %.4f %.4f %.4f\n" % place(size * (t - 0.5), v, 0.25))
            for i in range(steps):
                a = n + 3 * i
                for k in (0, 1):
                    b = a + k
                    quad = (b, b + 3, b + 4, b + 1)
                    if i > 0:
                        out.write("f %d %d %d\n" % (quad[0] + 1, quad[1] + 1, quad[3] + 1))
                    if i < steps - 1:
                        out.write("f %d %d %d\n" % (quad[1] + 1, quad[2] + 1, quad[3] + 1))
            n += 3 * (steps + 1)


if __name__ == "__main__":
    comb("comb.obj")
    leaves("leaves.obj")
    ring("ring.obj", "A sheet with an opening between circles of 32 pieces, of radius 0.3 and 0.5 mm.", 0.3, 0.5)
    sheet_with_holes("square.obj", "A sheet with a square opening of 1 mm.", [-6000.0, -0.5, 0.5, 6000.0], [-6000.0, -0.5, 0.5, 6000.0],
                     lambda i, j: i == 1 and j == 1)
    # A razor blade: three slots of the usual kind, as one long and two short ones, and notches at its corners.
    sheet_with_holes("razor.obj", "A razor blade of 43 x 22 mm with slots.",
                     [-21.5, -18.5, -15.0, -11.0, -4.0, 4.0, 11.0, 15.0, 18.5, 21.5], [-11.0, -7.0, -2.5, -1.0, 1.0, 2.5, 7.0, 11.0],
                     lambda i, j: (i in (0, 8) and j in (0, 6)) or (j == 3 and 2 <= i <= 6) or (j in (2, 4) and i in (2, 4, 6)))
    sheet_with_holes("two_slits.obj", "A sheet with two slits, 0.2 mm wide, 0.6 mm apart, 4 mm long.",
                     [-600.0, -0.4, -0.2, 0.2, 0.4, 600.0], [-600.0, -2.0, 2.0, 600.0], lambda i, j: j == 1 and i in (1, 3))
    # Threads of a curtain: openings of 0.3 mm, 0.5 mm apart.
    lines = [x for i in range(6) for x in (0.5 * i - 1.4, 0.5 * i - 1.1)]
    sheet_with_holes("mesh.obj", "A sheet with 6 x 6 square openings of 0.3 mm, 0.5 mm apart.", [-600.0, *lines, 600.0], [-600.0, *lines, 600.0],
                     lambda i, j: i % 2 == 1 and j % 2 == 1)
