#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes data/ugr_tables.json: tables of UGR by eulumdat-ugr (PyPI, MIT licence) for luminaires of this repository.

    pip install eulumdat-ugr aureole
    python3 make_ugr_tables.py

That program has the transfer factors and geometric multipliers of CIE 190:2010 and the position index of CIE 117 as tables; it
runs beside aureole and is never shipped. Each table is made twice, by its own index and by the formula of the index. With the name of a folder it prints how far aureole's tables are from those of other
programs instead: FOLDER/input/sample_NN.ldt and FOLDER/reference/ugr_table_NN_NAME.csv, as the repository of eulumdat-ugr has them.
"""
import json
import pathlib
import sys
import tempfile

import numpy as np

import aureole

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SPACINGS = {"Dialux": 0.25, "Relux": 0.25, "cie190": 1.0}


def trough():
    """The modelled luminaire, with its flux as that of a lamp: the judge takes no absolute photometry."""
    lines = (ROOT / "scenes/light/trough.ldt").read_text().splitlines()
    assert lines[26] == "-1"
    return "\r\n".join(lines[:26] + ["1"] + lines[27:]) + "\r\n"


def batten():
    """A batten without its luminous sides, with two lamps as one: the judge multiplies their total flux by their number."""
    data = aureole.goniophotometer(ROOT / "tests/references/scenes/luminaires/batten.ldt", opening=(1.2, 0.12, 0))
    lines = data.text("ldt").splitlines()
    assert lines[26] == "2"
    return "\r\n".join(lines[:26] + ["1"] + lines[27:]) + "\r\n"


def downlight():
    data = aureole.goniophotometer(ROOT / "tests/references/scenes/luminaires/downlight.ies")
    return data.text("ldt")


def index_by_formula(cls, h_r, t_r):
    """Guth's position index by the formula of the IES Lighting Handbook (1984), where it is below 16."""
    alpha, beta = np.degrees(np.arctan2(t_r, h_r)), np.degrees(np.arctan(np.hypot(t_r, h_r)))
    exponent = (35.2 - 0.31889 * alpha - 1.22 * np.exp(-2 * alpha / 9)) * 1e-3 * beta
    p = np.exp(exponent + (21 + 0.26667 * alpha - 0.002963 * alpha**2) * 1e-5 * beta**2)
    return np.where(p < 16, p, np.nan)


def make():
    from eulumdat_ugr import UgrCalculator
    from eulumdat_ugr.guth import GuthTable
    from pyldt import LdtReader

    files = {"trough.ldt": trough(), "batten.ldt": batten(), "downlight.ldt": downlight()}
    own, tables = GuthTable.__dict__["p_vec"], []
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            file = pathlib.Path(folder) / name
            file.write_text(content, newline="")
            for index, method in (("table", own), ("formula", classmethod(index_by_formula))):
                GuthTable.p_vec = method
                for spacing in (0.25, 1.0):
                    values = UgrCalculator.compute(LdtReader.read(file), spacing).values
                    tables.append({"file": name, "index": index, "spacing": spacing, "values": np.round(values, 3).tolist()})
                    found = aureole.ugr(file, spacing=spacing)
                    difference = np.concatenate([found.crosswise, found.endwise], axis=1) - values
                    print(f"{name:14} {index:8} {spacing:4g} H: {difference.mean():6.3f} {difference.std():6.3f} {difference.min():6.3f} {difference.max():6.3f}")
    out = HERE / "data/ugr_tables.json"
    out.parent.mkdir(exist_ok=True)
    out.write_text(json.dumps({"program": "eulumdat-ugr 1.0.2", "tables": tables, "files": files}, indent=0) + "\n")


def compare(folder):
    print(f"{'file':14} {'table':8} {'mean':>6} {'sd':>6} {'min':>6} {'max':>6}  (aureole less the other)")
    for file in sorted(folder.glob("input/*.ldt")):
        number = file.stem.split("_")[1]
        for reference in sorted(folder.glob(f"reference/ugr_table_{number}_*.csv")):
            name = reference.stem.split("_")[3]
            rows = [[float(cell) if cell.strip("-.0123456789") == "" and cell else np.nan for cell in line.split(",")] for line in reference.read_text().split()]
            theirs = np.array(rows)
            if theirs.shape != (19, 10):
                print(f"{file.name:14} {name:8} has {theirs.shape} cells")
                continue
            found = aureole.ugr(file, spacing=SPACINGS[name])
            difference = np.concatenate([found.crosswise, found.endwise], axis=1) - theirs
            print(f"{file.name:14} {name:8} {np.nanmean(difference):6.2f} {np.nanstd(difference):6.2f} {np.nanmin(difference):6.2f} {np.nanmax(difference):6.2f}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        compare(pathlib.Path(sys.argv[1]))
    else:
        make()
