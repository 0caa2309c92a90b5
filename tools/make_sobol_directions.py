#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes src/aureole/sampler/sobol_directions.inc: the direction numbers of Joe & Kuo 2008 ("Constructing Sobol sequences with better
two-dimensional projections", new-joe-kuo-6.21201) for the first dimensions, as scipy carries them. Each row: the primitive
polynomial's bits and the initial m_i."""
import argparse
import os

import numpy as np
import scipy.stats

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("output")
parser.add_argument("--dimensions", type=int, default=256)
args = parser.parse_args()

data = np.load(os.path.join(os.path.dirname(scipy.stats.__file__), "_sobol_direction_numbers.npz"))
poly, vinit = data["poly"], data["vinit"]
with open(args.output, "w") as out:
    out.write("// SPDX-License-Identifier: Apache-2.0\n// Joe & Kuo 2008, new-joe-kuo-6.21201: {polynomial, {m_1, m_2, ...}} per dimension.\n")
    out.write("// Written by tools/make_sobol_directions.py; not edited by hand.\n")
    for d in range(args.dimensions):
        p = int(poly[d])
        degree = p.bit_length() - 1
        m = [int(v) for v in vinit[d][:degree]]
        out.write("{%d, {%s}},\n" % (p, ", ".join(map(str, m))))
