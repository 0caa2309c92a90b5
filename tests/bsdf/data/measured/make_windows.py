#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write small files of windows in XML, and what Radiance computes with them.

    python make_windows.py [FOLDER]

Needs pyradiance 1.3 and numpy (PyPI). The files have random values, so that azimuths, sides and the order of numbers
matter. Beside this script it writes shade_klems.xml (matrices on an angle basis of their own), shade_colour.xml (CIE XYZ
on Klems' quarter basis), shade_tree3.xml, shade_tree4.xml and window_reference.txt, whose lines are: file, theta_i, phi_i,
theta_o, phi_o [degrees, both directions away from the surface], f [1/sr] by Radiance's library. Real files metalGrate.xml
and blindsT3.xml in FOLDER get lines, too. window_colour_reference.txt has f for the responses X, Y and Z of shade_colour.xml.
"""
import pathlib
import sys

import numpy as np
from pyradiance import bsdf

HERE = pathlib.Path(__file__).resolve().parent
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="http://windows.lbl.gov/BSDF-v1.4.xsd">
<WindowElementType>System</WindowElementType>
<FileType>BSDF</FileType>
<Optical>
<Layer>
\t<Material>
\t\t<Name>synthetic</Name>
\t\t<Manufacturer>none</Manufacturer>
\t</Material>
\t<DataDefinition>
\t\t<IncidentDataStructure>STRUCTURE</IncidentDataStructure>
BASIS\t</DataDefinition>
"""
TAIL = "</Layer>\n</Optical>\n</WindowElement>\n"
DIRECTIONS = ["Transmission Front", "Transmission Back", "Reflection Front", "Reflection Back"]
RINGS = [(0, 20, 1), (20, 55, 4), (55, 90, 6)]


def block(direction, basis, data, spectrum="Visible"):
    bases = (f"\t\t\t<AngleBasis>{basis}</AngleBasis>\n" if basis == "LBNL/Shirley-Chiu" else
             f"\t\t\t<ColumnAngleBasis>{basis}</ColumnAngleBasis>\n\t\t\t<RowAngleBasis>{basis}</RowAngleBasis>\n")
    kind = "BTDF" if direction.startswith("T") else "BRDF"
    return (f"\t<WavelengthData>\n\t\t<LayerNumber>System</LayerNumber>\n"
            f"\t\t<Wavelength unit=\"Integral\">{spectrum}</Wavelength>\n"
            f"\t\t<WavelengthDataBlock>\n\t\t\t<WavelengthDataDirection>{direction}</WavelengthDataDirection>\n{bases}"
            f"\t\t\t<ScatteringDataType>{kind}</ScatteringDataType>\n\t\t\t<ScatteringData>\n{data}\n"
            f"\t\t\t</ScatteringData>\n\t\t</WavelengthDataBlock>\n\t</WavelengthData>\n")


def rows(matrix):
    return "\n".join(" ".join(f"{v:.4f}" for v in row) for row in matrix)


def tree(rng, rank, depth, indent=0):
    """Leaves at some depth; a node of grids where two levels are left."""
    pad = " " * indent
    if depth == 0:
        return f"{pad}{{ {rng.uniform(0, 0.25):.4f} }}\n"
    if depth == 1 and rng.uniform() < 0.5:
        return pad + "{ " + " ".join(f"{v:.4f}" for v in rng.uniform(0, 0.25, 2**rank)) + " }\n"
    if rng.uniform() < 0.3 and indent > 0:
        return f"{pad}{{ {rng.uniform(0, 0.25):.4f} }}\n"
    return pad + "{\n" + "".join(tree(rng, rank, depth - 1, indent + 1) for _ in range(2**rank)) + pad + "}\n"


def main():
    rng = np.random.default_rng(3)
    basis = "\t\t<AngleBasis>\n\t\t\t<AngleBasisName>Eleven patches</AngleBasisName>\n"
    for low, high, n in RINGS:
        basis += (f"\t\t\t<AngleBasisBlock>\n\t\t\t\t<Theta>{(low + high) / 2:g}</Theta>\n\t\t\t\t<nPhis>{n}</nPhis>\n"
                  f"\t\t\t\t<ThetaBounds>\n\t\t\t\t\t<LowerTheta>{low}</LowerTheta>\n\t\t\t\t\t<UpperTheta>{high}</UpperTheta>\n"
                  "\t\t\t\t</ThetaBounds>\n\t\t\t</AngleBasisBlock>\n")
    basis += "\t\t</AngleBasis>\n"
    text = HEAD.replace("STRUCTURE", "Columns").replace("BASIS", basis)
    for direction in DIRECTIONS:
        text += block(direction, "Eleven patches", rows(rng.uniform(0.01, 0.25, (11, 11))))
    (HERE / "shade_klems.xml").write_text(text + TAIL)
    # Colours: X, Y and Z of one sheet, as rows.
    text = HEAD.replace("STRUCTURE", "Rows").replace("BASIS", "")
    for direction in DIRECTIONS[1:3]:
        y = rng.uniform(0.02, 0.2, (41, 41))
        for spectrum, factor in (("Visible", 1), ("CIE-X", rng.uniform(0.85, 1, (41, 41))),
                                 ("CIE-Z", rng.uniform(0.8, 1.1, (41, 41)))):
            text += block(direction, "LBNL/Klems Quarter", rows(y * factor), spectrum)
    (HERE / "shade_colour.xml").write_text(text + TAIL)
    for rank, depth in ((3, 3), (4, 2)):
        text = HEAD.replace("STRUCTURE", f"TensorTree{rank}").replace("BASIS", "")
        for direction in DIRECTIONS:
            text += block(direction, "LBNL/Shirley-Chiu", tree(rng, rank, depth))
        (HERE / f"shade_tree{rank}.xml").write_text(text + TAIL)
    lines = []
    files = [HERE / f"shade_{name}.xml" for name in ("klems", "tree3", "tree4")]
    if len(sys.argv) > 1:
        files += [pathlib.Path(sys.argv[1]) / name for name in ("metalGrate.xml", "blindsT3.xml")]
    for file in files:
        sheet = bsdf.load_file(str(file))
        rng = np.random.default_rng(5)
        for _ in range(200):
            angles = []
            for _ in range(2):
                theta = np.degrees(np.arcsin(np.sqrt(rng.uniform(0, 0.99))))
                angles += [theta if rng.uniform() < 0.5 else 180 - theta, rng.uniform(0, 360)]
            angles = [round(a, 2) for a in angles]
            f = bsdf.query(sheet, *angles)[1]
            lines.append(f"{file.name} " + " ".join(f"{a:.2f}" for a in angles) + f" {f:.9g}")
    (HERE / "window_reference.txt").write_text("\n".join(lines) + "\n")
    sheet, lines = bsdf.load_file(str(HERE / "shade_colour.xml")), []
    rng = np.random.default_rng(7)
    while len(lines) < 60:
        # The file has reflection at the front and transmission from the back: both leave on the front, z < 0 in Radiance.
        angles = []
        for side in (rng.uniform() < 0.5, True):
            theta = round(float(np.degrees(np.arcsin(np.sqrt(rng.uniform(0, 0.98))))), 2)
            angles += [180 - theta if side else theta, round(rng.uniform(0, 360), 2)]
        xyz = bsdf.query(sheet, *angles)
        if xyz[1] > 0:
            lines.append(" ".join(f"{a:.2f}" for a in angles) + "".join(f" {v:.7g}" for v in xyz))
    (HERE / "window_colour_reference.txt").write_text("\n".join(lines) + "\n")


main()
