#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints intensities behind rows of half planes, which the test SegmentDiffraction.RowsOfEdges stores.

A plane wave of 550 nm meets n sheets x < 0, `spacing` apart; the screen is 1 m behind the first. The field is carried from
sheet to sheet by the angular spectrum in Fresnel's approximation. Each number is the mean over a cell of 0.25 mm, from -1.5 to
1.5 mm. Needs numpy.
"""
import numpy as np

WAVELENGTH, WIDTH, SAMPLES = 550e-9, 0.06, 2**20


def propagate(field, distance):
    k = 2 * np.pi * np.fft.fftfreq(SAMPLES, WIDTH / SAMPLES)
    return np.fft.ifft(np.fft.fft(field) * np.exp(-1j * k**2 * distance * WAVELENGTH / (4 * np.pi)))


def intensities(count, spacing):
    x = (np.arange(SAMPLES) - SAMPLES / 2) * (WIDTH / SAMPLES)
    window = np.exp(-((np.abs(x) / (0.42 * WIDTH)) ** 40))
    field = window.astype(complex)
    for i in range(count):
        if i > 0:
            field = propagate(field, spacing) * window
        field = field * (x >= 0)
    intensity = np.abs(propagate(field, 1 - spacing * (count - 1))) ** 2
    edges = np.linspace(-1.5e-3, 1.5e-3, 13)
    return [intensity[(x >= a) & (x < b)].mean() for a, b in zip(edges, edges[1:])]


for count, spacing in ((2, 0.1), (3, 1e-3), (3, 0.1), (4, 0.1)):
    print(count, spacing, ", ".join(f"{v:.5g}" for v in intensities(count, spacing)))
