#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write src/aureole/spectrum/data/rgb_primaries.inc: reflectances of the primaries of linear sRGB that add up to one.

    python tools/make_rgb_primaries.py [output file]

Needs numpy, scipy and colour-science 0.4 (PyPI). The method is that of I. Mallett and C. Yuksel, "Spectral primary
decomposition for rendering with sRGB reflectance", EGSR 2019: the three smoothest spectra (least squares of the
differences of neighbours) with values in [0, 1] that add up to 1 at each wavelength and have, under CIE D65 and for
the CIE 1931 observer, the tristimulus values of the primaries. Equations are weighted by 1e5 against smoothness; the
script prints by how much they are missed. Nodes lie every 5 nm from 380 to 780 nm; spectra keep the value at the end
beyond.
"""
import pathlib
import sys
import warnings

warnings.filterwarnings("ignore")
import numpy as np  # noqa: E402
import colour  # noqa: E402
from scipy.optimize import lsq_linear  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
NODES = np.arange(380, 781, 5)
PRIMARIES = np.array([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]])  # chromaticities of sRGB (IEC 61966-2-1)


def main():
    target = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "src/aureole/spectrum/data/rgb_primaries.inc"
    nm = np.arange(360, 831)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(
        colour.SpectralShape(360, 830, 1)).values
    d65 = colour.SDS_ILLUMINANTS["D65"]
    light = np.interp(nm, d65.wavelengths, d65.values)
    weights = observer * light[:, None]
    weights /= weights[:, 1].sum()
    white = weights.sum(axis=0)
    # The primaries' tristimulus values: multiples of their chromaticities that add up to the white.
    xyz = np.array([[x / y, 1, (1 - x - y) / y] for x, y in PRIMARIES])
    xyz *= np.linalg.solve(xyz.T, white)[:, None]
    # A value at a node contributes the integral of its hat function, held at the ends.
    hats = np.array([np.interp(nm, NODES, np.eye(len(NODES))[i]) for i in range(len(NODES))])
    colours = hats @ weights  # nodes x 3
    n = len(NODES)
    rows, right = [], []
    for p in range(3):
        for i in range(n - 1):
            row = np.zeros(3 * n)
            row[p * n + i], row[p * n + i + 1] = -1, 1
            rows.append(row), right.append(0)
    strength = 1e5
    for p in range(3):
        for c in range(3):
            row = np.zeros(3 * n)
            row[p * n:(p + 1) * n] = strength * colours[:, c]
            rows.append(row), right.append(strength * xyz[p, c])
    for i in range(n):
        row = np.zeros(3 * n)
        row[[i, n + i, 2 * n + i]] = strength
        rows.append(row), right.append(strength)
    found = lsq_linear(np.array(rows), np.array(right), (0, 1), method="bvls", tol=1e-14, max_iter=2000)
    spectra = found.x.reshape(3, n)
    print(f"sum of the primaries: off by at most {abs(spectra.sum(axis=0) - 1).max():.1e}")
    print(f"tristimulus values: off by at most {abs(spectra @ colours - xyz).max():.1e}")
    text = ("// SPDX-License-Identifier: Apache-2.0\n// Made by tools/make_rgb_primaries.py; do not edit.\n"
            "// Reflectances of the red, green and blue primary of linear sRGB under D65, every 5 nm from 380 nm on.\n"
            f"constexpr double kRgbPrimariesStart = {NODES[0]}, kRgbPrimariesStep = 5;\n"
            f"constexpr double kRgbPrimaries[3][{n}] = {{\n")
    for s in spectra:
        lines, line = [], ""
        for v in s:
            item = f"{v if v > 1e-9 else 0:.6g},"
            if len(line) + 1 + len(item) > 104:
                lines.append(line)
                line = ""
            line += (" " if line else "     ") + item
        text += "    {\n" + "\n".join(lines + [line]) + "},\n"
    target.write_text(text + "};\n")


main()
