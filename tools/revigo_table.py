#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the Revigo drawdowns as a table that `aureole pigment fit --joint` reads.

The folder has spectra.txt (per cent; rows NNX_b, _w, _ob, _ow: bare black and white card, paint over them) and
mixtures.txt (specimen, paints, per cent by mass). The table goes to standard output. Specimens NNX belong to the
series NN.
"""
import pathlib
import sys


def table(folder: pathlib.Path) -> str:
    rows = [line.split("\t") for line in (folder / "spectra.txt").read_text().splitlines() if line]
    spectra = {row[0]: row[1:] for row in rows[1:]}
    lines = ["sample,specimen,series,paints,backing,unit," + ",".join(rows[0][1:])]
    for line in (folder / "mixtures.txt").read_text().splitlines():
        if not line:
            continue
        name, recipe = line.split("\t")
        paints, shares = recipe.split("|")
        parts = [f"{paint}: {share}" for paint, share in zip(paints.split("-"), shares.split("-")) if float(share) > 0]
        for card in ("b", "w"):
            lines.append(f"{name}_{card},,,,,percent," + ",".join(spectra[f"{name}_{card}"]))
        for card in ("b", "w"):
            lines.append(f"{name}_o{card},{name},{name[:2]},{' + '.join(parts)},{name}_{card},percent,"
                         + ",".join(spectra[f"{name}_o{card}"]))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: revigo_table.py FOLDER > revigo.csv")
    print(table(pathlib.Path(sys.argv[1])), end="")
