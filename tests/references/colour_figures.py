#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Print the colour figures that tests/optics/pigment/colour_difference_test.cpp and
tests/instrument/paint/colour_figures_test.cpp hold.

    python tests/references/colour_figures.py

Needs colour-science 0.4.7 (CIE 1976, CMC, CIE94, whiteness, yellowness, tables of lamps and observers) and coloraide
8 (DIN99o), both from PyPI; the sums over wavelengths, the metamerism index and the strengths are written out here.
"""
import warnings

warnings.filterwarnings("ignore")
import numpy as np  # noqa: E402
import colour  # noqa: E402
from coloraide import Color as Base  # noqa: E402
from coloraide.spaces.din99o import DIN99o  # noqa: E402
from coloraide.spaces.lab_d65 import LabD65  # noqa: E402
from coloraide.distance.delta_e_99o import DE99o  # noqa: E402


class Color(Base):
    """Colours with DIN99o."""


Color.register([DIN99o(), LabD65(), DE99o()], overwrite=True)

PAIRS = [((50, 2.6772, -79.7751), (50, 0, -82.7485)), ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387)),
         ((10, 5, 4), (12, 3, 6)), ((90, -2, 60), (88, 4, 55)), ((40, 30, -50), (41, 25, -52)),
         ((75, 0, 0), (74, 1, 1)), ((30, -40, 10), (33, -38, 16)), ((55, 0.5, 50), (55, -0.5, 50))]

NM = np.arange(360.0, 831.0)


def standard(nm):
    return 0.05 + 0.8 / (1 + np.exp(-(nm - 585) / 22)) + 0.12 * np.exp(-(((nm - 440) / 40) ** 2))


def sample(nm):
    return 0.06 + 0.76 / (1 + np.exp(-(nm - 588) / 15)) + 0.15 * np.exp(-(((nm - 430) / 30) ** 2))


def white(nm):
    return 0.88 - 0.35 * np.exp(-(nm - 360) / 18)


FIELDS = {2: "CIE 1931 2 Degree Standard Observer", 10: "CIE 1964 10 Degree Standard Observer"}


def lamp(name):
    sd = colour.SDS_ILLUMINANTS[name]
    return np.interp(NM, sd.wavelengths, sd.values, left=0, right=0)


def xyz(r, name, field):
    weights = lamp(name)[:, None] * colour.MSDS_CMFS[FIELDS[field]].values
    return 100 * (weights * r[:, None]).sum(0) / weights[:, 1].sum()


def lab(r, name, field):
    return colour.XYZ_to_Lab(xyz(r, name, field) / 100, colour.XYZ_to_xy(xyz(1 + 0 * NM, name, field)))


def numbers(values, digits=6):
    return ", ".join(f"{v:.{digits}f}" for v in values)


def differences(a, b):
    first, second = (Color("lab-d65", list(map(float, x))) for x in (a, b))
    return [colour.delta_E(a, b, method="CIE 1976"), colour.delta_E(a, b, method="CMC", l=2, c=1),
            colour.delta_E(a, b, method="CMC", l=1, c=1), colour.delta_E(a, b, method="CIE 1994", textiles=False),
            colour.delta_E(a, b, method="CIE 1994", textiles=True), first.delta_e(second, method="99o")]


def ks(r):
    return (1 - r) ** 2 / (2 * r)


def of_ks(q):
    return 1 + q - np.sqrt(q * q + 2 * q)


if __name__ == "__main__":
    print("76, CMC(2:1), CMC(1:1), 94 graphic arts, 94 textiles, 99o")
    for pair in PAIRS:
        print("{", numbers(differences(*pair)), "}")
    print("L*, a*, b* of standard and sample; metamerism index from D65/10")
    s, t, w = standard(NM), sample(NM), white(NM)
    for name, field in [("D65", 2), ("D65", 10), ("A", 10), ("C", 2), ("FL11", 10), ("LED-B3", 10), ("D50", 2)]:
        correction = xyz(s, "D65", 10) / xyz(t, "D65", 10)
        n = colour.XYZ_to_xy(xyz(1 + 0 * NM, name, field))
        index = np.linalg.norm(colour.XYZ_to_Lab(xyz(s, name, field) / 100, n) -
                               colour.XYZ_to_Lab(correction * xyz(t, name, field) / 100, n))
        print(f'{{"{name}/{field}", {{{numbers(lab(s, name, field))}}}, {{{numbers(lab(t, name, field))}}}, {index:.6f}}}')
    tens = np.arange(400.0, 701.0, 10)
    curve = colour.SpectralDistribution(dict(zip(tens, standard(tens))))
    for name, field in [("D65", 10), ("A", 2), ("FL11", 10)]:
        seen, ones = (colour.sd_to_XYZ(sd, colour.MSDS_CMFS[FIELDS[field]], colour.SDS_ILLUMINANTS[name], method="ASTM E308")
                      for sd in (curve, colour.sd_ones()))
        print(f"every 10 nm, by ASTM E308, {name}/{field}: {numbers(colour.XYZ_to_Lab(seen / 100, colour.XYZ_to_xy(ones)), 4)}")
    for name, field in [("D65", 2), ("D65", 10), ("C", 2), ("C", 10)]:
        v, n = xyz(w, name, field), xyz(1 + 0 * NM, name, field)
        wt = colour.colorimetry.whiteness_CIE2004(colour.XYZ_to_xy(v), v[1], colour.XYZ_to_xy(n), FIELDS[field])
        c = colour.colorimetry.YELLOWNESS_COEFFICIENTS_ASTME313[FIELDS[field]][name]
        print(f"{name}/{field}: whiteness, tint {numbers(wt)}; yellowness "
              f"{float(colour.colorimetry.yellowness_ASTME313(v, c)):.6f}")
    add_s, add_t = ks(s) - ks(w), ks(t) - ks(w)
    visible = (NM >= 400) & (NM <= 700)
    at = np.argmax(np.where(visible, add_s, 0))
    weights = (lamp("D65")[:, None] * colour.MSDS_CMFS[FIELDS[10]].values).sum(1)
    tone = of_ks(np.maximum(ks(w) + add_t / (add_t[at] / add_s[at]), 0))
    print("strength:", numbers([add_t[at] / add_s[at], NM[at], add_t[visible].sum() / add_s[visible].sum(),
                                (weights * add_t).sum() / (weights * add_s).sum()]),
          "tint tone CIEDE2000",
          f"{colour.delta_E(lab(s, 'D65', 10), lab(tone, 'D65', 10), method='CIE 2000'):.6f}")
