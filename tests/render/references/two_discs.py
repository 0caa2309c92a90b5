#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints intensities behind two equal discs one behind the other, which SegmentDiffraction.DiscsOneBehindTheOther stores.

A plane wave of 550 nm falls on two opaque discs of radius 0.3 mm with a common axis, `spacing` apart; the screen is 1 m behind
the first one. Intensities at 0, 0.05, ... 0.85 mm from the axis, in Fresnel's approximation by Hankel integrals over the two
discs. Needs numpy and scipy.
"""
import numpy as np
from scipy.special import j0

WAVELENGTH, RADIUS = 550e-9, 0.3e-3
X, W = np.polynomial.legendre.leggauss(4000)
Q, W = (X + 1) / 2 * RADIUS, W * RADIUS / 2


def over_disc(field, distance, r):
    """The field at the distances `r` from the axis of light that leaves the disc with `field` at the nodes Q."""
    a = 1 / (WAVELENGTH * distance)
    kernel = np.exp(1j * np.pi * a * (Q**2 + r[:, None] ** 2)) * j0(2 * np.pi * a * Q * r[:, None])
    return 2 * np.pi * a / 1j * kernel @ (W * Q * field)


def intensities(spacing):
    r = np.arange(18) * 0.05e-3
    behind_first = 1 - over_disc(1, spacing, Q)
    return np.abs(1 - over_disc(1, 1, r) - over_disc(behind_first, 1 - spacing, r)) ** 2


for spacing in (0.3e-3, 0.01, 0.1):
    print(spacing, ", ".join(f"{v:.5g}" for v in intensities(spacing)))
