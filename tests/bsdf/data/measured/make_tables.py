#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write small tables in the formats of MERL and of goniometers, with values for tests.

    python make_tables.py

Needs numpy. small_merl.binary has 16 x 16 x 32 bins of a rough metal over a coloured diffuse ground (GGX, alpha 0.25,
Schlick's Fresnel term). merl_reference.txt has lines of wi (3), wo (3) and red, green, blue of the bin that contains the
pair, found here from the definition of the angles by rotations. glossy_table.csv has 300 random outgoing directions for
each of 6 angles of incidence; paper_table.csv has reflected and transmitted radiant intensities over half of the azimuths.
"""
import math
import pathlib
import struct

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
SCALE = np.array([1, 1.15, 1.66]) / 1500


def unit(v):
    return v / np.linalg.norm(v)


def brdf(wi, wo, alpha=0.25, diffuse=(0.3, 0.12, 0.05)):
    h = unit(wi + wo)
    d = alpha**2 / (math.pi * (h[2]**2 * (alpha**2 - 1) + 1)**2)

    def g1(w):
        t2 = (1 - w[2]**2) / w[2]**2
        return 2 / (1 + math.sqrt(1 + alpha**2 * t2))

    f = 0.5 + 0.5 * (1 - max(wi @ h, 0))**5
    specular = 0.6 * f * d * g1(wi) * g1(wo) / (4 * wi[2] * wo[2])
    return np.array(diffuse) / math.pi * 0.8 + specular


def from_angles(theta, phi):
    return np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])


def rotate(v, axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    return v * c + np.cross(axis, v) * s + axis * (axis @ v) * (1 - c)


def pair_of(theta_h, theta_d, phi_d):
    """Directions with these half and difference angles, and azimuth 0 of the half vector."""
    h, y = from_angles(theta_h, 0), np.array([0.0, 1, 0])
    wi = rotate(from_angles(theta_d, phi_d), y, theta_h)
    return wi, 2 * (wi @ h) * h - wi


def make_merl():
    n, m, k = 16, 16, 32
    table = np.zeros((3, n, m, k))
    for i in range(n):
        for j in range(m):
            for p in range(k):
                theta_h = ((i + 0.5) / n)**2 * math.pi / 2
                wi, wo = pair_of(theta_h, (j + 0.5) / m * math.pi / 2, (p + 0.5) / k * math.pi)
                table[:, i, j, p] = brdf(wi, wo) / SCALE if wi[2] > 0.02 and wo[2] > 0.02 else -1
    (HERE / "small_merl.binary").write_bytes(struct.pack("<3i", n, m, k) + table.astype("<f8").tobytes())
    rng, lines = np.random.default_rng(2), []
    while len(lines) < 100:
        wi, wo = (from_angles(math.acos(rng.uniform(0.05, 1)), rng.uniform(0, 2 * math.pi)) for _ in range(2))
        h = unit(wi + wo)
        theta_h, phi_h = math.acos(h[2]), math.atan2(h[1], h[0])
        d = rotate(rotate(wi, np.array([0, 0, 1.0]), -phi_h), np.array([0, 1.0, 0]), -theta_h)
        theta_d, phi_d = math.acos(min(d[2], 1)), math.atan2(d[1], d[0])
        if phi_d < 0:
            phi_d += math.pi
        place = (math.sqrt(theta_h / (math.pi / 2)) * n, theta_d / (math.pi / 2) * m, phi_d / math.pi * k)
        if any(abs(x - round(x)) < 1e-3 for x in place):
            continue  # rounding decides which bin it is
        value = np.maximum(table[(slice(None), *(int(x) for x in place))] * SCALE, 0)
        lines.append(" ".join(f"{x:.9g}" for x in (*wi, *wo, *value)))
    (HERE / "merl_reference.txt").write_text("\n".join(lines) + "\n")


def make_csv():
    rng = np.random.default_rng(8)
    with open(HERE / "glossy_table.csv", "w") as out:
        out.write("# f in 1/sr, random outgoing directions\ntheta_i,theta_o,phi_o,400nm,550nm,700nm\n")
        for theta_i in (0, 15, 30, 45, 60, 75):
            wi = from_angles(math.radians(theta_i), 0)
            for _ in range(300):
                theta_o, phi_o = math.degrees(math.asin(math.sqrt(rng.uniform(0, 0.995)))), rng.uniform(0, 360)
                f = brdf(wi, from_angles(math.radians(theta_o), math.radians(phi_o)), 0.4)
                out.write(f"{theta_i},{theta_o:.2f},{phi_o:.2f},{f[2]:.5f},{f[1]:.5f},{f[0]:.5f}\n")
    with open(HERE / "paper_table.csv", "w") as out:
        out.write("theta_i,phi_i,theta_o,phi_o,f\n")
        for theta_i in (0, 30, 60, 80):
            for theta_o in (*range(0, 90, 10), *range(100, 181, 10)):
                for phi_o in range(0, 181, 30):
                    cosine = abs(math.cos(math.radians(theta_o)))
                    value = (0.5 if theta_o < 90 else 0.3) / math.pi * cosine
                    out.write(f"{theta_i},0,{theta_o},{phi_o},{value:.5f}\n")


make_merl()
make_csv()
