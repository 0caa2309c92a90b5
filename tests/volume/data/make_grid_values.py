#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes grid_values.txt: values of Mitsuba 3's `gridvolume` (needs mitsuba 3.9.1 and numpy).

The grid has 6 x 5 x 4 voxels, voxel i (x fastest) holds frac(i * 0.6180339887498949) in single precision; its box is
(1, 2, 3) to (3, 3, 5). Each line: filter, wrap, 1 where the box counts, the point, the value. to_world is a rotation
about z by 30 degrees after which everything is scaled by 2.
"""
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_spectral")
here = Path(__file__).resolve().parent
values = ((np.arange(120) * 0.6180339887498949) % 1).astype(np.float32).reshape(4, 5, 6, 1)
file = here / "grid.vol"
file.write_bytes(b"VOL\x03" + np.array([1, 6, 5, 4, 1], "<i4").tobytes()
                 + np.array([1, 2, 3, 3, 3, 5], "<f4").tobytes() + values.tobytes())
random = np.random.default_rng(1)
lines = []
place = mi.SurfaceInteraction3f()
place.wavelengths = [400, 500, 600, 700]
for filter_type in ("trilinear", "nearest"):
    for wrap_mode in ("clamp", "repeat", "mirror"):
        for use_box in (False, True):
            transform = mi.ScalarTransform4d().scale(2).rotate([0, 0, 1], 30)
            volume = mi.load_dict({"type": "gridvolume", "filename": str(file), "filter_type": filter_type,
                                   "wrap_mode": wrap_mode, "use_grid_bbox": use_box, "to_world": transform})
            for _ in range(8):
                local = random.uniform(-0.7, 1.7, 3)
                if use_box:
                    local = local * (2, 1, 2) + (1, 2, 3)
                p = np.float32(np.array(transform.matrix)[:3, :3] @ local)
                place.p = p
                lines.append(f"{filter_type} {wrap_mode} {int(use_box)} {p[0]:.9g} {p[1]:.9g} {p[2]:.9g} "
                             f"{volume.eval(place)[0]:.8g}")
file.unlink()
(here / "grid_values.txt").write_text("\n".join(lines) + "\n")
