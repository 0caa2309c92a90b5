#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes scenes/condensation/finger_trace.png: mist on a pane through which a finger has drawn a line. Grey values are area
fractions, black is a pane that is wiped clean. Needs the standard library only."""
import math
import os
import struct
import zlib

SIZE = 384


def heart(t):
    """A heart drawn in one stroke, in [-1, 1]^2."""
    x = 16 * math.sin(t) ** 3
    y = 13 * math.cos(t) - 5 * math.cos(2 * t) - 2 * math.cos(3 * t) - math.cos(4 * t)
    return x / 19, (y + 2) / 19


def main():
    stroke = [heart(2 * math.pi * i / 400) for i in range(401)]
    rows = []
    for j in range(SIZE):
        row = bytearray([0])
        y = 1 - 2 * (j + 0.5) / SIZE
        for i in range(SIZE):
            x = 2 * (i + 0.5) / SIZE - 1
            d = min(math.hypot(x * 1.25 - u, y * 1.25 - v) for u, v in stroke)
            # Wiped clean in the middle of the stroke, water pushed to its edges, fading density further out.
            mist = 0.8 + 0.06 * math.sin(7 * x + 3 * y) * math.sin(5 * y - 2 * x)
            mist += 0.2 * math.exp(-(((d - 0.105) / 0.018) ** 2))
            mist *= 1 / (1 + math.exp(-(d - 0.075) / 0.006))
            row.append(max(0, min(255, round(255 * 0.62 * mist))))
        rows.append(bytes(row))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 0, 0, 0, 0))
    png += chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b"")
    path = os.path.join(os.path.dirname(__file__), "../scenes/condensation/finger_trace.png")
    with open(path, "wb") as out:
        out.write(png)


main()
