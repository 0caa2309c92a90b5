#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints sobol_qualities.inc: t-values of two-dimensional projections of the Sobol points of scipy.stats.qmc, found by counting points in
elementary intervals."""
import numpy as np
from scipy.stats import qmc

points = qmc.Sobol(d=256, scramble=False, bits=30).random(1024)


def quality(p, m):
    """The smallest t for which the 2^m points p are a (t, m, 2)-net in base 2."""
    for t in range(m):
        for a in range(m - t + 1):
            b = m - t - a
            cell = (np.floor(p[:, 0] * 2**a).astype(int) << b) + np.floor(p[:, 1] * 2**b).astype(int)
            if not (np.bincount(cell, minlength=2 ** (m - t)) == 2**t).all():
                break
        else:
            return t
    return m


rng = np.random.default_rng(1)
pairs = [(0, 1), (0, 2), (1, 2), (2, 3), (3, 4), (4, 7), (7, 8), (10, 20), (15, 16), (31, 32), (44, 99), (63, 127), (100, 101),
         (128, 200), (254, 255), (0, 255)]
while len(pairs) < 40:
    pairs.append(tuple(int(d) for d in sorted(rng.choice(256, 2, replace=False))))
print("// SPDX-License-Identifier: Apache-2.0")
print("// {dimension, dimension, t of the first 16, 64, 256, 1024 points}; written by make_sobol_qualities.py")
for a, b in pairs:
    print("{%d, %d, %s}," % (a, b, ", ".join(str(quality(points[: 2**m][:, [a, b]], m)) for m in (4, 6, 8, 10))))
