#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens a DNG by rawpy (PyPI; LibRaw) and checks what it makes of it:

    judge_raw.py picture.dng values.u16 MOSAIC BLACK WHITE

`values.u16` are the digital numbers, little-endian, row by row. MOSAIC is rggb, ..., xtrans or mono. The picture shows a
neutral surface under D65, so that developing it must give a grey. Exit code 77: rawpy is not installed.
"""
import sys

try:
    import numpy as np
    import rawpy
except ImportError:
    sys.exit(77)


def main():
    file, values, mosaic, black, white = sys.argv[1:]
    with rawpy.imread(file) as raw:
        got = raw.raw_image_visible
        want = np.fromfile(values, "<u2").reshape(got.shape)
        assert np.array_equal(got, want), "the digital numbers differ"
        assert raw.white_level == int(white), (raw.white_level, white)
        assert all(abs(b - float(black)) < 0.5 for b in raw.black_level_per_channel), raw.black_level_per_channel
        if mosaic == "mono":
            return
        letters = "".join("RGB"[min(int(c), 2) if c < 3 else 1] for c in raw.raw_pattern.ravel())
        colors = "".join(raw.color_desc.decode()[int(c)] for c in raw.raw_colors_visible[:6, :6].ravel())
        cell = 6 if mosaic == "xtrans" else 2
        expected = {
            "xtrans": "GBGGRGRGRBGBGBGGRGGRGGBGBGBRGRGRGGBG",
        }.get(mosaic, mosaic.upper())
        for y in range(6):
            for x in range(6):
                assert colors[6 * y + x] == expected[cell * (y % cell) + x % cell], (x, y, colors, letters)
        rgb = raw.postprocess(use_camera_wb=True, no_auto_bright=True, output_bps=16, gamma=(1, 1))
        mean = rgb[8:-8, 8:-8].reshape(-1, 3).mean(axis=0)
        assert mean.min() > 1000, mean
        assert mean.max() / mean.min() < 1.03, mean


main()
