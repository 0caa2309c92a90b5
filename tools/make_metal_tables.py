#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write src/aureole/spectrum/data/metals.inc from a folder of tabulated complex refractive indices.

    python tools/make_metal_tables.py DIRECTORY [output file]

DIRECTORY holds pairs NAME.eta.spd, NAME.k.spd of lines "wavelength_nm value" with comments starting with '#', as
the PyPI package `mitsuba` ships them under data/ior (collected at luxpop.com). Only the numbers are taken, with the
original source that the comments name. Pairs with the same numbers become one table with two names.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PALIK_1 = "E. D. Palik (ed.), Handbook of Optical Constants of Solids, Academic Press 1985"
PALIK_2 = "E. D. Palik (ed.), Handbook of Optical Constants of Solids II, Academic Press 1991"
PALIK = "E. D. Palik (ed.), Handbook of Optical Constants of Solids I or II, Academic Press 1985, 1991"
UNSTATED = "source not stated by the collection (luxpop.com)"


def read(path):
    """The (wavelength, value) pairs as text, and the comments."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [tuple(line.split()) for line in lines if line.strip() and not line.startswith("#")]
    return rows, "\n".join(line for line in lines if line.startswith("#"))


def source_of(name, comments):
    if "Solids II'" in comments:
        return PALIK_2
    if "Optical Constants of Solids'" in comments:
        return PALIK_1
    # The other parts of these concatenations (Henke et al. 1993; Windt et al. 1988) end below 125 nm.
    from_palik = name.endswith("_palik") or re.search(r"Concatenation of.*_palik", comments, re.S)
    return PALIK if from_palik else UNSTATED


def number(text):
    return repr(float(text)).removesuffix(".0")


def main():
    directory = pathlib.Path(sys.argv[1])
    target = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "src/aureole/spectrum/data/metals.inc"
    tables, materials = {}, []
    for path in sorted(directory.glob("*.eta.spd"), key=lambda p: p.name):
        name = path.name.removesuffix(".eta.spd")
        eta, comments = read(path)
        k, _ = read(directory / f"{name}.k.spd")
        if [w for w, _ in eta] != [w for w, _ in k]:
            sys.exit(f"{name}: n and k are not given at the same wavelengths")
        rows = tuple((number(w), number(n), number(kk)) for (w, n), (_, kk) in zip(eta, k))
        what = re.search(r"Optical constants for (.*)", comments).group(1).strip()
        best = source_of(name, comments)
        if rows not in tables or (tables[rows][1] == PALIK and best != PALIK):
            tables[rows] = (tables[rows][0] if rows in tables else len(tables), best)
        materials.append((name, rows))
        print(f"{name}: {what}; {rows[0][0]}-{rows[-1][0]} nm, {len(rows)} rows; {best}")

    text = "// SPDX-License-Identifier: Apache-2.0\n// Made by tools/make_metal_tables.py; do not edit.\n"
    text += "// Rows of wavelength in nm, n, k.\n"
    for rows, (index, best) in tables.items():
        text += f"// {', '.join(n for n, r in materials if r == rows)}: {best}.\n"
        text += f"constexpr MetalRow kMetal{index}[] = {{\n"
        line = "   "
        for row in rows:
            item = " {" + ", ".join(row) + "},"
            if len(line) + len(item) > 110:
                text += line + "\n"
                line = "   "
            line += item
        text += line + "\n};\n"
    text += "constexpr MetalRecord kMetals[] = {\n"
    for name, rows in materials:
        index, best = tables[rows]
        constant = {PALIK_1: "kPalik1", PALIK_2: "kPalik2", PALIK: "kPalik", UNSTATED: "kUnstated"}[best]
        text += f'    {{"{name}", kMetal{index}, {constant}}},\n'
    text += "};\n"
    target.write_text(text, encoding="utf-8", newline="\n")
    print(f"wrote {target.name}: {len(text)} bytes, {len(materials)} names, {len(tables)} tables")


if __name__ == "__main__":
    main()
