#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes asymmetric.ies: a luminaire whose half-planes all differ, by a formula."""
import math
import pathlib

vertical = list(range(0, 181, 10))
horizontal = list(range(0, 361, 15))


def intensity(c, gamma):
    c, gamma = math.radians(c), math.radians(gamma)
    x, y, z = math.sin(gamma) * math.cos(c), math.sin(gamma) * math.sin(c), math.cos(gamma)
    return 300 * math.exp(3 * (0.6 * x + 0.3 * y + 0.74 * z - 1)) + 40 * (1 + y) ** 2


text = "IESNA:LM-63-2002\n[TEST] made by a formula\n[TESTLAB] none\n[ISSUEDATE] 2026-11-27\n[MANUFAC] none\nTILT=NONE\n"
text += f"1 -1 1 {len(vertical)} {len(horizontal)} 1 2 0 0 0\n1 1 10\n"
text += " ".join(map(str, vertical)) + "\n" + " ".join(map(str, horizontal)) + "\n"
for c in horizontal:
    text += " ".join(f"{intensity(c, g):.3f}" for g in vertical) + "\n"
(pathlib.Path(__file__).parent / "asymmetric.ies").write_text(text)
