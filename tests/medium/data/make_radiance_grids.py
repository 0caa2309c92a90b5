#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes tests/medium/data/radiance: small radiance grids in the layout of Plenoxels (svox2's SparseGrid.save), and radiance.txt, what
rays see in them by plain numpy in double precision: NeRF's sum by its definition, and the integral by the trapezoidal rule with
200,000 intervals. Needs numpy.

    tests/medium/data/make_radiance_grids.py

A line of radiance.txt is: file; what; origin; direction; red green blue transmittance."""
import pathlib

import numpy as np

HERE = pathlib.Path(__file__).parent / "radiance"


def harmonics(d, degree):
    """Real spherical harmonics with the Condon-Shortley phase by their definition: associated Legendre functions of the
    polar angle times cosine or sine of the azimuth."""
    from math import factorial, pi
    x, y, z = d
    phi = np.arctan2(y, x)
    s = np.sqrt(max(0, 1 - z * z))
    legendre = {(0, 0): 1, (1, 0): z, (1, 1): -s, (2, 0): (3 * z * z - 1) / 2, (2, 1): -3 * z * s, (2, 2): 3 * s * s,
                (3, 0): (5 * z**3 - 3 * z) / 2, (3, 1): -1.5 * (5 * z * z - 1) * s, (3, 2): 15 * z * s * s, (3, 3): -15 * s**3}
    out = []
    for l in range(degree + 1):
        for m in range(-l, l + 1):
            n = np.sqrt((2 * l + 1) / (4 * pi) * factorial(l - abs(m)) / factorial(l + abs(m)))
            if m == 0:
                out.append(n * legendre[l, 0])
            else:
                out.append(np.sqrt(2) * n * legendre[l, abs(m)] * (np.cos(m * phi) if m > 0 else np.sin(-m * phi)))
    return np.array(out)


class Grid:
    def __init__(self, seed, size, degree, filled=0.6):
        r = np.random.default_rng(seed)
        self.size, self.degree = np.array(size), degree
        terms = (degree + 1) ** 2
        n = int(filled * self.size.prod())
        self.links = np.full(self.size.prod(), -1, dtype=np.int32)
        self.links[r.permutation(self.size.prod())[:n]] = r.permutation(n)
        self.links = self.links.reshape(size)
        self.density = r.uniform(-0.5, 2.5, (n, 1)).astype(np.float32)
        self.sh = (r.normal(0, 1, (n, 3 * terms)) * np.tile(1 / (1 + np.arange(terms)), 3)).astype(np.float16)
        self.radius = np.array([1, 1.25, 1.5], dtype=np.float32)
        self.center = np.array([0.125, -0.25, 0.375], dtype=np.float32)

    def arrays(self):
        return dict(radius=self.radius, center=self.center, links=self.links, density_data=self.density, sh_data=self.sh, basis_type=1)

    def at(self, p, y):
        """Density and colours at points (n x 3) for the harmonics y of one direction, after clamping."""
        g = (np.asarray(p) - self.center.astype(float)) / self.radius.astype(float) * 0.5 * self.size + 0.5 * self.size - 0.5
        inside = ((g >= -0.5 - 1e-9) & (g <= self.size - 0.5 + 1e-9)).all(axis=1)
        g = np.clip(g, 0, self.size - 1)
        low = np.minimum(g.astype(int), self.size - 2)
        part = g - low
        density, color = np.zeros(len(g)), np.zeros((len(g), 3))
        terms = (self.degree + 1) ** 2
        colors = np.einsum("nct,t->nc", self.sh.astype(float).reshape(-1, 3, terms), y)
        for k in range(8):
            o = np.array([k & 1, k >> 1 & 1, k >> 2])
            w = np.prod(np.where(o, part, 1 - part), axis=1)
            link = self.links[tuple((low + o).T)]
            w = np.where(link >= 0, w, 0)
            density += w * self.density[link, 0]
            color += w[:, None] * colors[link]
        return np.where(inside, np.maximum(0, density), 0), np.maximum(0, color + 0.5)

    def crossing(self, o, d):
        a, b = (self.center - self.radius - o) / d, (self.center + self.radius - o) / d
        return max(0, np.minimum(a, b).max()), np.maximum(a, b).min()

    def nerf(self, o, d, step, opaque=False):
        """Equation 3 of Mildenhall and others 2020, with samples at the beginnings of steps of `step` voxels."""
        begin, end = self.crossing(o, d)
        delta = step / np.linalg.norm(d / self.radius * 0.5 * self.size)
        t = begin + delta * np.arange(int(np.ceil((end - begin) / delta)))
        sigma, color = self.at(o + t[:, None] * d, harmonics(d, self.degree))
        lengths = np.full(len(t), delta)
        if opaque:
            lengths[-1] = 1e10
        alpha = 1 - np.exp(-sigma * lengths)
        passed = np.concatenate([[1], np.cumprod(1 - alpha)])
        return [*(alpha * passed[:-1]) @ color, passed[-1]]

    def exact(self, o, d, decode):
        begin, end = self.crossing(o, d)
        t = np.linspace(begin, end, 200001)
        sigma, color = self.at(o + t[:, None] * d, harmonics(d, self.degree))
        if decode:
            color = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
        h = t[1] - t[0]
        thickness = np.concatenate([[0], np.cumsum(0.5 * h * (sigma[1:] + sigma[:-1]))])
        light = (np.exp(-thickness) * sigma)[:, None] * color
        return [*((light[1:] + light[:-1]).sum(axis=0) * 0.5 * h), np.exp(-thickness[-1])]


def main():
    HERE.mkdir(exist_ok=True)
    out = []
    for k, (name, save, size, degree) in enumerate([("sh2.npz", np.savez_compressed, (5, 6, 7), 2), ("sh0.npz", np.savez, (4, 4, 4), 0),
                                                    ("sh3.npz", np.savez_compressed, (3, 4, 5), 3), ("sh1.npz", np.savez, (6, 2, 3), 1)]):
        grid = Grid(30 + k, size, degree)
        save(HERE / name, **grid.arrays())
        r = np.random.default_rng(k)
        for _ in range(10):
            o = r.normal(size=3) * 3 + [0, 0, 6]
            d = grid.center + r.uniform(-0.7, 0.7, 3) - o
            d /= np.linalg.norm(d)
            if len(out) % 5 == 0:
                o = grid.center + r.uniform(-0.5, 0.5, 3)  # within the grid
            for what, seen in [("nerf", grid.nerf(o, d, 0.5)), ("opaque", grid.nerf(o, d, 0.5, True)), ("fine", grid.nerf(o, d, 0.01)),
                               ("exact", grid.exact(o, d, False)), ("linear", grid.exact(o, d, True))]:
                text = lambda v: " ".join(f"{x:.9g}" for x in v)
                out.append(";".join([name, what, text(o), text(d), text(seen)]))
    (HERE.parent / "radiance.txt").write_text("\n".join(out) + "\n")


main()
