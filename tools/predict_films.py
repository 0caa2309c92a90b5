#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Predicts every film of a table by `aureole pigment mix` and prints the CIEDE2000 differences from the measurements.

    python3 tools/predict_films.py build/release/bin/aureole revigo.csv oils.csv ...

The first argument is the program, the second a table as tools/revigo_table.py writes it (per cent, cards as lines without
paints), the others are palettes per film. Films have the common thickness, the masses are those stated, and each card has its
mean inner reflectance by Saunderson's interface of K1 and K2. Needs the Python module `aureole`.
"""
import csv
import json
import subprocess
import sys
import tempfile

import numpy as np
from aureole import pigment

K1, K2 = 0.0418, 0.5963


def main() -> None:
    program, table, *palettes = sys.argv[1:]
    with open(table, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    headings = [name for name in rows[0] if name.isdigit()]
    nm = np.array(headings, dtype=float)
    measured = [np.array([float(row[name]) for name in headings]) / 100 for row in rows]
    inside = pigment.saunderson(K1, K2, specular="excluded")
    cards = {row["sample"]: float(np.mean(inside.inner(values))) for row, values in zip(rows, measured) if not row["paints"]}
    for palette in palettes:
        differences = []
        with tempfile.NamedTemporaryFile(suffix=".json") as report:
            for row, values in zip(rows, measured):
                if not row["paints"]:
                    continue
                subprocess.run([program, "pigment", "mix", palette, row["paints"], "--thickness", "1",
                                "--substrate", f"{cards[row['backing']]:.6f}", "--json", report.name], check=True, capture_output=True)
                with open(report.name, encoding="utf-8") as file:
                    mixed = json.load(file)
                predicted = pigment.lab(np.array(mixed["wavelengths_nm"]), np.array(mixed["reflectance"]))
                differences.append(float(pigment.ciede2000(pigment.lab(nm, values), predicted)))
        print(f"{palette} by {mixed['theory']}, {len(differences)} films: mean {np.mean(differences):.2f}, "
              f"median {np.median(differences):.2f}, largest {max(differences):.2f}")


if __name__ == "__main__":
    main()
