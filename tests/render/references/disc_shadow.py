#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Light in the shadow of an opaque disc, for tests/render/diffraction_test.cpp (ShadowsOfADiscAndABallAreRound).

    python3 -m venv venv && venv/bin/pip install numpy scipy
    venv/bin/python disc_shadow.py

A disc of 2 mm radius stands 1 m from a point light of 550 nm and 1 m from a screen. Behind an obstacle Lommel's functions V0 and V1 are
real and imaginary part of the field (Born & Wolf, Principles of Optics, 8.8), I/I0 = V0^2 + V1^2; the script checks them against
Fresnel's integral over the disc. It prints I/I0 by the distance from the axis, as a mean over two fringes and by Keller's coefficient
with the focus of a round edge, and the mean over the square that the test looks at.
"""

import numpy as np
from scipy.special import j0, jv

WAVELENGTH, RADIUS, TO_LAMP, TO_SCREEN = 550e-9, 2e-3, 1.0, 1.0
K = 2 * np.pi / WAVELENGTH
REDUCED = TO_LAMP * TO_SCREEN / (TO_LAMP + TO_SCREEN)
SQUARE = (0.2e-3, 2.2e-3)  # of x and of y


def projected(rho):
    """Where the straight way from the lamp to that distance from the axis on the screen meets the plane of the disc."""
    return rho * TO_LAMP / (TO_LAMP + TO_SCREEN)


def lommel(rho):
    u, v = K * RADIUS**2 / REDUCED, K * RADIUS * projected(rho) / REDUCED
    assert np.all(v < u)
    field = [sum((-1) ** m * (v / u) ** (n + 2 * m) * jv(n + 2 * m, v) for m in range(60)) for n in (0, 1)]
    return field[0] ** 2 + field[1] ** 2


def fresnel(rho, steps=200000):
    a = (np.arange(steps) + 0.5) / steps * RADIUS
    p = projected(rho)
    integral = np.sum(np.exp(0.5j * K * a * a / REDUCED) * j0(K * a * p / REDUCED) * a) * RADIUS / steps
    return abs(1 - K / (1j * REDUCED) * np.exp(0.5j * K * p * p / REDUCED) * integral) ** 2


def keller(rho):
    turned = [RADIUS / TO_LAMP + (RADIUS - side * rho) / TO_SCREEN for side in (1, -1)]
    straight = sum(WAVELENGTH / (4 * np.pi**2 * t * t) / REDUCED for t in turned)
    return straight * (1 + TO_SCREEN / TO_LAMP) * RADIUS / rho


def main():
    for rho in (0, 0.31e-3, 1.234e-3, 2.9e-3):
        assert abs(lommel(rho) - fresnel(rho)) < 1e-4, (rho, lommel(rho), fresnel(rho))
    fringe = WAVELENGTH * TO_SCREEN / (2 * RADIUS)
    for rho in np.arange(0.3e-3, 3.2e-3, 0.3e-3):
        mean = np.mean(lommel(rho + ((np.arange(64) + 0.5) / 32 - 1) * fringe))
        print(f"{1e3 * rho:.1f} mm: {mean:.5f}, Keller {keller(rho):.5f}")
    at = SQUARE[0] + (np.arange(800) + 0.5) / 800 * (SQUARE[1] - SQUARE[0])
    x, y = np.meshgrid(at, at)
    print(f"square: {np.mean(lommel(np.hypot(x, y))):.5f}, Keller {np.mean(keller(np.hypot(x, y))):.5f}")


if __name__ == "__main__":
    main()
