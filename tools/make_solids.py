#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the shapes of scenes/media: a candle and its flame, a chess pawn and the veins of its marble, a heap
of powder. Closed surfaces of revolution about the z axis, in cm (the heap: mm). Needs numpy for the veins."""
import math
import os

import numpy as np

from make_glass_of_milk import arc, line, write
from make_smoke import centres, turbulence, write_vol

SEGMENTS = 48


def smooth(points):
    """A profile through `points`, (x, z) counter-clockwise from the axis below to the axis above, with the normals of a smooth
    curve."""
    profile = []
    for i, point in enumerate(points):
        before, after = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
        dx, dz = after[0] - before[0], after[1] - before[1]
        length = math.hypot(dx, dz)
        normal = (dz / length, -dx / length)
        # On the axis the surface is level.
        profile.append((point, (0.0, math.copysign(1.0, normal[1])) if point[0] < 1e-9 else normal))
    return profile


def candle(radius=2.6, height=6.5, edge=0.45, hollow=0.6):
    """A cylinder whose top the flame has melted to a bowl."""
    profile = line((0, 0), (radius - 0.15, 0)) + list(arc(radius - 0.15, 0.15, 0.15, -90, 0, 4))
    profile += line((radius, 0.15), (radius, height - edge)) + list(arc(radius - edge, height - edge, edge, 0, 90, 8))
    rim = radius - edge
    bowl = [(rim * (1 - i / 16), height - hollow * 0.5 * (1 - math.cos(math.pi * min(1.5 * i / 16, 1)))) for i in range(17)]
    return profile + smooth(bowl)


def flame(height=2.4, radius=0.36):
    return smooth([(radius * math.sin(math.pi * t**0.6) * (1 - 0.25 * t), height * t) for t in (i / 20 for i in range(20))] + [(0, height)])


def pawn():
    """A foot with two mouldings, a slender body, a collar and a head."""
    profile = line((0, 0), (2.2, 0)) + list(arc(2.2, 0.35, 0.35, -90, 90, 12))
    profile += line((2.2, 0.7), (1.75, 0.7)) + list(arc(1.75, 1.0, 0.3, -90, 60, 10))
    body = [(0.62 + 1.15 * math.exp(-2.2 * t) - 0.12 * t, 1.3 + 3.3 * t) for t in (i / 14 for i in range(15))]
    profile += smooth(body) + list(arc(0.95, 4.75, 0.15, -90, 90, 8))
    start = math.degrees(math.acos(0.55 / 1.15))
    head = [(1.15 * math.cos(math.radians(a)), 5.85 + 1.15 * math.sin(math.radians(a)))
            for a in (-start + (90 + start) * i / 20 for i in range(20))]
    return profile + line((0.95, 4.9), head[0]) + smooth(head + [(0, 7.0)])


def heap(radius=9.0, height=4.2):
    """A heap whose sides lie at the angle of repose, with a round top."""
    round_top = 1.6
    points = []
    for i in range(25):
        x = radius * (1 - i / 24)
        z = height * (1 - (math.hypot(x, round_top) - round_top) / (math.hypot(radius, round_top) - round_top))
        points.append((x, max(z, 0.0)))
    return line((0, 0), (radius, 0)) + smooth(points)


def veins(rng, size):
    """Albedo of marble: dark veins where turbulence crosses zero."""
    at = centres(size)
    swirl = turbulence(rng, at * np.array([0.6, 0.6, 1]).reshape(3, 1, 1, 1), 3, 4)
    sheet = np.sin(9 * (at[0] * 0.6 + at[1] * 0.3 + at[2] * 0.8) + 9 * swirl)
    return 0.9992 - 0.012 * np.exp(-((sheet / 0.22) ** 2))


def main():
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes", "media")
    write(os.path.join(folder, "candle.ply"), candle(), SEGMENTS)
    write(os.path.join(folder, "flame.ply"), flame(), 24)
    write(os.path.join(folder, "pawn.ply"), pawn(), SEGMENTS)
    write(os.path.join(folder, "heap.ply"), heap(), SEGMENTS)
    write_vol(os.path.join(folder, "veins.vol"), veins(np.random.default_rng(2), (20, 20, 32)))


if __name__ == "__main__":
    main()
