#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The standard error of a power map in the cells that only diffraction reaches.

    bench/powermap/cells.py map.exr --plain plain.exr --once once.exr

`plain.exr` is the map without diffraction at the same depth, `once.exr` that of one diffraction and nothing else (depth=2). Cells that are dark in the first and
irradiated in the second get their light around one edge; further bounces and edges may add to it. Prints their number, and the median and the worst
tenth of their errors, beside those of all cells that are lit.
"""

import argparse

import aureole
import numpy as np


def density(file):
    return aureole.read_image(file)["density"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map")
    parser.add_argument("--plain", required=True)
    parser.add_argument("--once", required=True)
    a = parser.parse_args()
    error = aureole.read_image(a.map)["error_dB"]
    lit = density(a.map) > 0
    around = lit & (density(a.plain) <= 0) & (density(a.once) > 0)
    for name, cells in (("lit", lit), ("reached only around one edge", around), ("lit without diffraction", lit & (density(a.plain) > 0))):
        e = np.where(np.isfinite(error[cells]), error[cells], np.inf)
        if e.size == 0:
            print(f"{name}: no cells")
        else:
            print(f"{name}: {e.size} cells, standard error {np.median(e):.2f} dB in the median, {np.quantile(e, 0.9):.2f} dB in the worst tenth")


if __name__ == "__main__":
    main()
