#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write suspension_references.inc: coefficients and phase functions of spheres in suspension by another program.

    pip install numpy numba miepython==3.3.0
    MIEPYTHON_USE_JIT=1 python tests/medium/references/make_suspension_references.py

Sums of miepython's (S. Prahl) efficiencies and phase functions over densely spaced radii, which takes minutes. The
radii are far denser than those of the medium `suspension`: spheres that absorb little do so in narrow resonances, so
that 64,000 radii of spheres of 4 um with k = 1e-5 leave an error of 2e-3.
"""
import pathlib

import miepython
import numpy as np

NM = [405, 477, 550, 633, 748]
ANGLES = [0, 2, 10, 45, 90, 120, 150, 165, 170, 175, 178]


def log_normal(median, sigma):
    return (lambda r: np.exp(-0.5 * (np.log(r / median) / sigma) ** 2) / r), median * np.exp(-5 * sigma), median * np.exp(6 * sigma)


def modified_gamma(mode, alpha):
    return (lambda r: r ** alpha * np.exp(-alpha * r / mode)), 0.01 * mode, 7 * mode


# parameters of the medium, density(r) with its range or a radius, in um, index of the host and of the spheres, number of radii
SPREAD = '<float name="size_spread" value="{}"/>'
GAMMA = '<string name="distribution" value="modified_gamma"/><float name="alpha" value="6"/><float name="gamma" value="1"/>'
CASES = [
    ("0.2um", "", 0.2, 1.33, 1.59, 1),
    ("1um", "", 1.0, 1.33, 1.59, 1),
    ("4um", "", 4.0, 1.0, 1.33 - 1e-5j, 1),
    ("0.3um", SPREAD.format(0.3), log_normal(0.3, 0.3), 1.33, 1.59 - 1e-4j, 40000),
    ("1um", SPREAD.format(0.1), log_normal(1, 0.1), 1.0, 1.33 - 1e-5j, 100000),
    ("4um", SPREAD.format(0.1), log_normal(4, 0.1), 1.0, 1.33 - 1e-5j, 1000000),
    ("4um", GAMMA, modified_gamma(4, 6), 1.0, 1.33 - 1e-5j, 1000000),
    ("4um", GAMMA, modified_gamma(4, 6), 1.0, 1.33 - 1e-3j, 100000)]


def sums(nm, radii, host, index, count):
    if count == 1:
        r, weight = np.array([radii]), np.ones(1)
    else:
        density, low, high = radii
        r = low + (high - low) * (np.arange(count) + 0.5) / count
        weight = density(r)
        keep = weight * r ** 4 > 1e-9 * np.sum(weight * r ** 4)
        r, weight = r[keep], weight[keep] / weight.sum()
    x, m = 2 * np.pi * r * host / (1e-3 * nm), index / host
    qext, qsca, _, g = miepython.efficiencies_mx(m, x)
    area = weight * np.pi * r ** 2
    scattering = np.sum(area * qsca)
    step = max(1, len(r) // 6000)
    part = slice(step // 2, None, step)
    mu = np.cos(np.radians(ANGLES))
    phase = sum(a * np.array(miepython.i_unpolarized(m, one, mu, norm="qsca")) for a, one in zip(area[part], x[part]))
    phase /= np.sum(area[part] * qsca[part])
    return np.sum(area * (qext - qsca)), scattering, np.sum(area * qsca * g) / scattering, phase


def main():
    rows = []
    for radius, sizes, radii, host, index, count in CASES:
        for nm in NM:
            absorption, scattering, g, phase = sums(nm, radii, host, index, count)
            k = abs(complex(index).imag)
            values = ", ".join(f"{v:.6g}" for v in phase)
            rows.append(f'    {{R"({radius})", R"({sizes})", {host:g}, {complex(index).real:g}, {k:g}, {nm}, '
                        f"{absorption if k else 0:.7g}, {scattering:.8g}, {g:.7g}, {{{values}}}}},")
            print(rows[-1], flush=True)
    lines = ["// SPDX-License-Identifier: Apache-2.0", "// Written by make_suspension_references.py.",
             "// radius, sizes, index of the host, n, k, nm, mean Cabs and Csca in um^2, g, phase function in 1/sr at "
             + ", ".join(map(str, ANGLES)) + " degrees",
             "const SuspensionReference kSuspensions[] = {", *rows, "};"]
    pathlib.Path(__file__).with_name("suspension_references.inc").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
