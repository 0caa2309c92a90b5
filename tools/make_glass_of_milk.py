#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes scenes/milk/glass.ply and filling.ply: a tumbler and its filling, as closed surfaces of revolution about the
z axis, in cm, with normals. The filling reaches to the middle of the wall: where the two overlap the glass, which has the higher
priority, fills the space. Needs the standard library only."""
import math
import os
import struct

SEGMENTS = 96
RADIUS, HEIGHT, WALL, FLOOR, LEVEL = 3.2, 11.0, 0.22, 0.9, 8.5
MENISCUS = 0.25  # the decay of the surface's rise at the wall: the capillary length of water


def arc(x, z, radius, start, end, steps):
    """Points of an arc with angles in degrees from the x axis, and their normals."""
    for i in range(steps + 1):
        a = math.radians(start + (end - start) * i / steps)
        yield (x + radius * math.cos(a), z + radius * math.sin(a)), (math.cos(a), math.sin(a))


def line(start, end):
    """The two ends of a straight piece; the outside is on the right of the way from start to end."""
    dx, dz = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dz)
    normal = (dz / length, -dx / length)
    return [(start, normal), (end, normal)]


def tumbler():
    """From the axis below, outside, over the rim, down inside to the axis: counter-clockwise in the plane (x, z)."""
    edge, inner, half = 0.4, RADIUS - WALL, WALL / 2
    profile = line((0, 0), (RADIUS - edge, 0)) + list(arc(RADIUS - edge, edge, edge, -90, 0, 10))
    profile += line((RADIUS, edge), (RADIUS, HEIGHT - half)) + list(arc(RADIUS - half, HEIGHT - half, half, 0, 180, 12))
    profile += line((inner, HEIGHT - half), (inner, FLOOR + edge))
    # A concave corner: the outward normal of the glass points to the centre of the arc.
    for (x, z), (nx, nz) in arc(inner - edge, FLOOR + edge, edge, 0, -90, 10):
        profile.append(((x, z), (-nx, -nz)))
    return profile + line((inner - edge, FLOOR), (0, FLOOR))


def filling():
    outside, bottom, edge = RADIUS - WALL / 2, FLOOR - WALL / 2, 0.45
    inner = RADIUS - WALL

    def level(x):
        """exp(-d/a) is the linear solution at a straight wall."""
        return LEVEL + 0.2 * math.exp(-max(inner - x, 0) / MENISCUS)

    profile = line((0, bottom), (outside - edge, bottom)) + list(arc(outside - edge, bottom + edge, edge, -90, 0, 10))
    profile += line((outside, bottom + edge), (outside, level(outside)))
    profile += line((outside, level(outside)), (inner, level(inner)))
    for i in range(25):
        d = 8 * MENISCUS * (i / 24) ** 2
        x = inner - d
        slope = 0.2 / MENISCUS * math.exp(-d / MENISCUS)
        length = math.hypot(slope, 1)
        profile.append(((x, level(x)), (-slope / length, 1 / length)))
    return profile + line((inner - 8 * MENISCUS, LEVEL), (0, LEVEL))


def revolve(profile, segments=SEGMENTS):
    """Vertices (position and normal) and triangles; rows of the same place but another normal share no vertices."""
    vertices, triangles = [], []
    for (x, z), (nx, nz) in profile:
        for k in range(segments):
            c, s = math.cos(2 * math.pi * k / segments), math.sin(2 * math.pi * k / segments)
            vertices.append((x * c, x * s, z, nx * c, nx * s, nz))
    for row in range(len(profile) - 1):
        (x0, z0), (x1, z1) = profile[row][0], profile[row + 1][0]
        if math.hypot(x1 - x0, z1 - z0) < 1e-9:
            continue
        for k in range(segments):
            a, b = row * segments + k, row * segments + (k + 1) % segments
            c, d = a + segments, b + segments
            if x0 > 1e-9:
                triangles.append((a, b, c) if x1 < 1e-9 else (a, b, d))
            if x1 > 1e-9:
                triangles.append((a, d, c))
    return vertices, triangles


def write(path, profile, segments=SEGMENTS):
    vertices, triangles = revolve(profile, segments)
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    with open(path, "wb") as out:
        out.write(("\n".join(header) + "\n").encode())
        for v in vertices:
            out.write(struct.pack("<6f", *v))
        for t in triangles:
            out.write(struct.pack("<B3i", 3, *t))


def main():
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes", "milk")
    write(os.path.join(folder, "glass.ply"), tumbler())
    write(os.path.join(folder, "filling.ply"), filling())


if __name__ == "__main__":
    main()
