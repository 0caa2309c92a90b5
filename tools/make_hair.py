#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes scenes/hair/lock.txt, a wavy lock of hair as B-spline curves in millimetres, and scenes/hair/clasp.vol, the distance to
a clasp around it (needs numpy).

    tools/make_hair.py"""
import struct
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parents[1] / "scenes" / "hair"
STRANDS, POINTS, LENGTH, RADIUS = 520, 9, 62.0, 0.06


def lock():
    random = np.random.default_rng(11)
    lines = []
    for _ in range(STRANDS):
        angle, distance = 2 * np.pi * random.random(), np.sqrt(random.random())
        length = LENGTH * (0.86 + 0.14 * random.random())
        phase, own = 0.35 * random.normal(), 0.25 * random.normal(size=(2, POINTS))
        for i in reversed(range(POINTS)):  # from tip to root, as a positive scale_tilt has it
            # Control points lie a little beyond both ends, which the curve leaves out.
            t = (i - 1) / (POINTS - 3)
            # Held together by the clasp at a seventh of the length, spread above and below, drawn to a tip.
            below = np.clip((t - 0.14) / 0.86, 0, 1)
            spread = 1.9 + 8 * max(0.14 - t, 0) + 8.5 * below**0.8 * (1 - below) ** 0.6
            twist = angle + 1.1 * t
            wave = 4.5 * below * np.sin(2 * np.pi * 1.4 * t + phase)
            x = spread * distance * np.cos(twist) + wave + own[0, i] * t
            y = spread * distance * np.sin(twist) + 0.4 * wave + own[1, i] * t
            lines.append(f"{x:.3f} {y:.3f} {-length * t:.3f} {RADIUS * (1 - 0.75 * max(t - 0.6, 0)):.4f}")
        lines.append("")
    (FOLDER / "lock.txt").write_text("\n".join(lines))


def clasp():
    """A ring with a groove around it, in the cube [0, 1]^3, with its axis along z."""
    n = 20
    z, y, x = np.meshgrid(*([np.linspace(-1, 1, n)] * 3), indexing="ij")
    around = np.hypot(x, y) - 0.62
    band = np.hypot(around / 1.0, z / 1.9) - 0.21
    groove = np.hypot(around - 0.23, z) - 0.1
    values = np.maximum(band, -groove).astype("<f4")
    (FOLDER / "clasp.vol").write_bytes(b"VOL\x03" + struct.pack("<5i6f", 1, n, n, n, 1, 0, 0, 0, 1, 1, 1) + values.tobytes())


if __name__ == "__main__":
    lock()
    clasp()
