#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write coated_references.inc and average_references.inc: spheres, coated spheres and averages over sizes by other programs.

    pip install numpy miepython==3.3.0 scattnlay==2.4
    python tests/optics/particle/references/make_particle_references.py

Coated spheres: scattnlay (Ladutenko et al., Comput. Phys. Commun. 214 (2017) 225), which has its own recurrences.
Averages: sums over densely spaced radii of efficiencies and phase functions by miepython (S. Prahl), another program.
"""
import pathlib

import miepython
import numpy as np
import scattnlay

COATED = [  # core x, x, index of core, index of coat, over that of the medium
    (0.3, 0.5, 1.5, 1.33), (0.3581416, 13.1213, 1.59 + 0.66j, 1.409 + 0.1747j), (3, 5, 1.33, 1.6 + 0.01j), (9.9, 10, 1.5, 1.33 + 0.3j),
    (1, 40, 2.5 + 1j, 1.4), (80, 100, 1.33, 1.5), (50, 60, 0.75, 1.2 + 0.2j), (150, 300, 1.1 + 0.001j, 1.6 + 1e-5j)]
ANGLES = np.radians([0, 10, 45, 90, 135, 170, 180])


def coated():
    for core, x, m_core, m_coat in COATED:
        sizes, indices = np.array([[core, x]]), np.array([[m_core, m_coat]], dtype=complex)
        result = scattnlay.scattnlay(sizes, indices, theta=ANGLES)
        _, qext, qsca, _, _, _, g, _, s1, s2 = [np.ravel(r) for r in result]
        values = ", ".join(f"{v:.9g}" for v in 0.5 * (abs(s1) ** 2 + abs(s2) ** 2))
        yield (f"    {{{core}, {x}, {{{m_core.real:g}, {complex(m_core).imag:g}}}, {{{m_coat.real:g}, {complex(m_coat).imag:g}}}, "
               f"{qext[0]:.9g}, {qsca[0]:.9g}, {g[0]:.9g}, {{{values}}}}},")


# name of the distribution, density(r), range, wavelength, medium, index, all lengths in um
AVERAGES = [
    ("log_normal(0.4e-6, 0.25)", lambda r: np.exp(-0.5 * (np.log(r / 0.4) / 0.25) ** 2) / r, 0.1, 2.2, 0.55, 1.333, 1.463 - 4.6e-6j),
    ("gamma(1.05e-6, 0.07)", lambda r: r ** ((1 - 3 * 0.07) / 0.07) * np.exp(-r / (1.05 * 0.07)), 0.02, 4.5, 0.55, 1.0, 1.44),
    ("modified_gamma(0.5e-6, 2, 1)", lambda r: r ** 2 * np.exp(-2 * r / 0.5), 0.002, 8.0, 0.65, 1.0, 1.75 - 0.44j)]


def averages():
    mu = np.cos(ANGLES)
    for name, density, low, high, wavelength, medium, index in AVERAGES:
        r = np.linspace(low, high, 24001)
        weight = density(r)
        weight /= weight.sum()
        x, m = 2 * np.pi * r * medium / wavelength, index / medium
        qext, qsca, _, g = [np.array(v) for v in zip(*(miepython.efficiencies_mx(m, one) for one in x))]
        area = weight * np.pi * r ** 2
        scattering = np.sum(area * qsca)
        phase = sum(a * np.array(miepython.i_unpolarized(m, one, mu, norm="qsca")) for a, one in zip(area[::8], x[::8]))
        phase *= 8 / scattering
        values = ", ".join(f"{v:.6g}" for v in phase)
        yield (f"    {{RadiusDistribution::{name}, {1000 * wavelength:g}, {medium:g}, {{{complex(index).real:g}, {abs(complex(index).imag):g}}}, "
               f"{np.sum(area * qext):.8g}, {scattering:.8g}, {np.sum(area * qsca * g) / scattering:.8g}, {{{values}}}}},")


def write(name, comment, head, rows):
    lines = ["// SPDX-License-Identifier: Apache-2.0", "// Written by make_particle_references.py.", comment, head, *rows, "};"]
    pathlib.Path(__file__).with_name(name).write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    write("coated_references.inc", "// core x, x, indices, Qext, Qsca, g, (|S1|^2 + |S2|^2)/2 at 0, 10, 45, 90, 135, 170, 180 degrees",
          "const CoatedReference kCoated[] = {", coated())
    write("average_references.inc", "// distribution, nm, medium, index, mean Cext and Csca in um^2, g, phase function in 1/sr at those angles",
          "const AverageReference kAverages[] = {", averages())


if __name__ == "__main__":
    main()
