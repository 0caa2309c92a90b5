#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write disort_references.inc and iad_references.inc: light on layers by other programs.

    pip install numpy scipy PythonicDISORT==1.8 iadpython==0.5.3
    python tests/optics/stack/references/make_stack_references.py

PythonicDISORT (D. J. X. Ho, J. Open Source Softw. 9 (2024) 6442) has discrete ordinates by eigenvalues: oblique beams, two layers and
radiances, without interfaces. It takes no albedo of 1. iadpython (S. Prahl) has adding and doubling with Fresnel's interfaces and slides,
of normal beams; at index 1 it is used with 24 directions, since from 32 on it fails there; elsewhere with 48, since from 64 on it loses digits.
"""
import pathlib

import iadpython
import numpy as np
from PythonicDISORT import pydisort

# Of those nodes that are nearest: between them PythonicDISORT interpolates by polynomials, which radiance of odd modes is not.
COSINES, AZIMUTHS = [0.1, 0.35, 0.6, 0.85, 1.0], [0, np.pi / 3, np.pi]
# streams, cosine of the beam, reflectance of the substrate, depth inside, layers (optical thickness, albedo, share of g1, g1, g2)
STACKS = [
    (64, 0.6, 0.0, 0.5, [(1, 0.9, 1, 0.75, 0)]),
    (64, 0.2, 0.0, 2.0, [(5, 0.99, 1, 0.0, 0)]),
    (64, 0.5, 0.4, 1.0, [(0.5, 0.95, 1, 0.7, 0), (2, 0.6, 1, 0.3, 0)]),
    (80, 0.9, 0.0, 0.1, [(0.5, 0.9, 0.8, 0.8, -0.4)]),
    (64, 0.75, 0.8, 3.0, [(2, 0.999, 1, 0.6, 0), (4, 0.98, 0.7, 0.6, -0.3)]),
    (256, 0.7, 0.0, 1.0, [(2, 0.95, 1, 0.92, 0)])]
# albedo, optical thickness, g, index, index of the slides, directions
SLABS = [(0.9, 2, 0.75, 1, 1, 24), (0.5, 1, 0.9, 1.4, 1, 48), (0.5, 1, 0.9, 1.4, 1.5, 48), (0.99, 10, 0.8, 1.5, 1, 48), (1, 4, 0.5, 1.33, 1, 48),
         (0.8, 0.5, 0, 1.33, 1.52, 48), (0.95, 5, 0.6, 1.7, 1, 48)]


def row(values):
    return "{" + ", ".join(f"{v:.9g}" for v in values) + "}"


def disort(streams, mu0, substrate, depth, layers):
    count = streams + 1
    l = np.arange(count)
    moments = np.array([share * g1 ** l + (1 - share) * (g2 ** l if g2 else (l == 0)) for _, _, share, g1, g2 in layers])
    bottoms, albedos = np.cumsum([float(t[0]) for t in layers]), np.array([t[1] for t in layers])
    # The beam's irradiance on the stack is 1.
    nodes, up, down, _, radiance = pydisort(bottoms, albedos, streams, moments, mu0, 1 / mu0, 0.0, NLeg=streams, NFourier=streams,
                                        BDRF_Fourier_modes=[substrate] if substrate else [])
    total = bottoms[-1]
    fluxes = [up(0), sum(down(total)), down(total)[1], up(depth), sum(down(depth)), down(depth)[1], up(total)]
    chosen = [int(np.argmin(abs(nodes - c))) for c in COSINES]
    mirrored = [int(np.argmin(abs(nodes + c))) for c in COSINES]
    phi = np.array(AZIMUTHS)
    values = [np.ravel(radiance(tau, phi)[rows]) for tau, rows in
              ((0.0, chosen), (total, mirrored), (depth, chosen), (depth, mirrored))]
    described = ", ".join(row(layer) for layer in layers)
    return (f"    {{{mu0}, {substrate}, {depth}, {{{described}}},\n     {row(map(float, fluxes))},\n"
            f"     {{{', '.join(f'{nodes[i]:.16g}' for i in chosen)}}},\n"
            + ",\n".join(f"     {row(v)}" for v in values) + "},")


def iad(albedo, thickness, g, index, slides, directions):
    sample = iadpython.Sample(a=albedo, b=thickness, g=g, n=index, n_above=slides, n_below=slides, quad_pts=directions)
    r, t, ru, tu = sample.rt()
    return f"    {{{albedo}, {thickness}, {g}, {index}, {slides}, {r:.8g}, {t:.8g}, {ru:.8g}, {tu:.8g}}},"


def write(name, comments, head, rows):
    lines = ["// SPDX-License-Identifier: Apache-2.0", "// Written by make_stack_references.py.", *comments, head, *rows, "};"]
    pathlib.Path(__file__).with_name(name).write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    write("disort_references.inc",
          ["// Cosine of the beam, substrate, depth, layers (optical thickness, albedo, share, g1, g2); fluxes of irradiance 1: up at the top;",
           "// down at the bottom, and its unscattered part; up, down and unscattered at the depth; up at the bottom; then radiances at",
           "// five cosines, which come first, and azimuths 0, 60, 180 degrees: up at the top, down at the bottom, up and down at the depth."],
          "inline const DisortReference kDisort[] = {", (disort(*stack) for stack in STACKS))
    write("iad_references.inc", ["// Albedo, optical thickness, g, index, index of slides; R and T of a normal beam, and of diffuse light."],
          "inline const IadReference kIad[] = {", (iad(*slab) for slab in SLABS))


if __name__ == "__main__":
    main()
