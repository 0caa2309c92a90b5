#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reference of SegmentDiffraction.BlocksOfMetalHaveTwoPolarisations, EndsNearThePlaneOfARoof and SquareBlocksOfMetal: the field
behind metal, over that without it.

A boundary integral equation in two dimensions, with Hankel's kernel (i/4) H0(k r) and elements of constant value that grow from the
corners on. Soft (u = 0): of the first kind for the normal derivative; hard (du/dn = 0): of the second kind for u. Both have 40 more
equations, that the field vanishes at points inside, without which the solution is not unique near resonances of the inside.

Lengths are in wavelengths. The block fills 0 < x < thickness, -depth < y < 0. The line source lies 20 from the edge (0, 0), `alpha`
degrees below the plane y = 0, the receiver 20 from the edge (thickness, 0), `beta` degrees below it. The mean over four depths cancels
what goes around below. The last step turns the ratio into that of a point source and edges without end: a factor sqrt(R/path), R being
the distance and `path` the length of the path over the block.

A second table has sources and receivers near the plane of the roof, without that step, which changes them by less than 0.04 dB. A third
one has a square of 10 by 10, around both sides of which light arrives: source at (-11.25, 6.875), receivers at (13, y).

    python3 metal_block.py [elements per wavelength, 8]     needs numpy and scipy; two minutes
"""
import sys

import numpy as np
from scipy.special import hankel1

K = 2 * np.pi
NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)
FROM_CORNER = np.array([0, 0.02, 0.06, 0.15, 0.3, 0.55, 1.0])  # in elements
DISTANCE = 20.0


class Boundary:
    """Elements around the block, clockwise, with normals that point outwards."""

    def __init__(self, thickness, depth, per_wavelength):
        corners = np.array([[0, 0], [thickness, 0], [thickness, -depth], [0, -depth]], float)
        begin, end = [], []
        for a, b in zip(corners, np.roll(corners, -1, axis=0)):
            count = max(8, int(np.ceil(np.linalg.norm(b - a) * per_wavelength)))
            near = FROM_CORNER / count
            t = np.unique(np.round(np.concatenate([near, np.linspace(0, 1, count + 1)[1:-1], 1 - near]), 12))
            points = a + np.outer(t[np.concatenate([[True], np.diff(t) > 1e-9])], b - a)
            begin.append(points[:-1])
            end.append(points[1:])
        self.begin, self.end = np.vstack(begin), np.vstack(end)
        self.along = self.end - self.begin
        self.length = np.hypot(*self.along.T)
        unit = self.along / self.length[:, None]
        self.normal = np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        self.middle = 0.5 * (self.begin + self.end)

    def potential(self, points, is_double):
        """Integrals over each element of the kernel, or of its normal derivative, for points far from the boundary."""
        out = np.zeros((len(points), len(self.begin)), complex)
        for x, weight in zip(NODES, WEIGHTS):
            r = points[:, None] - (self.begin + self.along * (0.5 * (x + 1)))
            out += kernel(r, self.normal, is_double) * (0.5 * weight * self.length)
        return out

    def on_itself(self, is_double):
        """Integrals at the middles of the elements: those of near elements by a quadrature that is finer towards the nearest point."""
        out = self.potential(self.middle, is_double)
        near = np.hypot(*np.moveaxis(self.middle[:, None] - self.middle, 2, 0)) < 3 * self.length
        for i, j in zip(*np.where(near)):
            nearest = np.clip((self.middle[i] - self.begin[j]) @ self.along[j] / self.length[j] ** 2, 0, 1)
            steps = 0.4 ** np.arange(1, 15)
            cuts = np.concatenate([[0, 1, nearest], nearest - steps, nearest + steps])
            cuts = np.unique(cuts[(cuts >= 0) & (cuts <= 1)])
            t = cuts[:-1, None] + np.diff(cuts)[:, None] * 0.5 * (NODES + 1)
            weights = 0.5 * np.diff(cuts)[:, None] * WEIGHTS * self.length[j]
            r = self.middle[i] - (self.begin[j] + t.reshape(-1, 1) * self.along[j])
            out[i, j] = np.sum(kernel(r, self.normal[j], is_double) * weights.reshape(-1))
        return out


def kernel(r, normal, is_double):
    distance = np.hypot(r[..., 0], r[..., 1])
    if is_double:
        return 0.25j * K * hankel1(1, K * distance) * np.sum(r * normal, axis=-1) / distance
    return 0.25j * hankel1(0, K * distance)


def fields(thickness, depth, sources, receivers, is_hard, per_wavelength):
    """u at the receivers (rows) over that without the block, for each source (columns)."""
    block = Boundary(thickness, depth, per_wavelength)
    random = np.random.default_rng(1)
    inside = np.stack([random.uniform(0.1, 0.9, 40) * thickness, -random.uniform(0.05, 0.95, 40) * depth], axis=1)
    own = block.on_itself(is_hard)
    if is_hard:
        np.fill_diagonal(own, 0)
        own = 0.5 * np.eye(len(own)) - own
    within = block.potential(inside, is_hard)
    matrix = np.vstack([own, -within if is_hard else within])
    incident = [kernel(points[:, None] - sources, None, False) for points in (block.middle, inside, receivers)]
    unknown = np.linalg.lstsq(matrix, np.concatenate(incident[:2]), rcond=None)[0]
    scattered = block.potential(receivers, is_hard) @ unknown
    return 1 + (scattered if is_hard else -scattered) / incident[2]


def mean_of_depths(thickness, sources, receivers, is_hard, per_wavelength):
    all_depths = (26, 26.27, 26.55, 26.8)
    return np.mean([fields(thickness, d, sources, receivers, is_hard, per_wavelength) for d in all_depths], axis=0)


def at(edge, degrees, sign):
    """Points 20 from an edge of the roof, so many degrees below its plane, to the left (-1) or to the right (1)."""
    angle = np.radians(degrees)
    return np.stack([edge + sign * DISTANCE * np.cos(angle), -DISTANCE * np.sin(angle)], axis=-1)


def main():
    per_wavelength = float(sys.argv[1]) if len(sys.argv) > 1 else 8
    print("thickness alpha  beta   soft dB   hard dB")
    for thickness, alpha in ((0.3, 10), (1, 10), (3, 10), (8, 2), (8, 15), (3, -10)):
        betas = np.array([-20, -4, -1, 1, 4, 15, 25, 40] if alpha > 0 else [4, 8, 15, 25, 40])
        source, receivers = at(0, alpha, -1), at(thickness, betas, 1)
        straight = np.hypot(*(receivers - source).T)
        # Above the plane of the roof light goes by way of the first edge alone.
        by_first = DISTANCE + np.hypot(*receivers.T)
        path = np.maximum(straight, np.where(betas > 0, 2 * DISTANCE + thickness, by_first) if alpha > 0 else straight)
        if alpha < 0:
            path = np.hypot(*(source - [thickness, 0])) + DISTANCE
        db = []
        for is_hard in (False, True):
            u = mean_of_depths(thickness, source[None], receivers, is_hard, per_wavelength)[:, 0]
            db.append(20 * np.log10(np.abs(u) * np.sqrt(straight / np.maximum(path, straight))))
        for beta, soft, hard in zip(betas, *db):
            print(f"{{{thickness}, {alpha}, {beta}, {soft:.2f}, {hard:.2f}}},")
    alphas, betas = [2, 0.5, 0, -0.1, -0.5, -2, -5], [10, 2, 0.5, 0, -0.1, -0.5, -2, -5]
    print("near the plane of the roof: thickness, alpha, then dB at beta =", betas)
    for is_hard in (False, True):
        for thickness in (0.3, 1, 3, 8):
            u = mean_of_depths(thickness, at(0, alphas, -1), at(thickness, betas, 1), is_hard, per_wavelength)
            for alpha, column in zip(alphas, 20 * np.log10(np.abs(u)).T):
                values = ", ".join(f"{x:.2f}" for x in column)
                print(f"{{{thickness}, {alpha}, {{{values}}}}},  // {'hard' if is_hard else 'soft'}")
    print("square: y, soft dB, hard dB")
    y = np.linspace(-7, -16, 37)
    receivers = np.stack([np.full(len(y), 13.0), y], axis=1)
    source = np.array([[-11.25, 6.875]])
    both = [fields(10, 10, source, receivers, is_hard, per_wavelength)[:, 0] for is_hard in (False, True)]
    for values in zip(y, *(20 * np.log10(np.abs(u)) for u in both)):
        print("{{{:g}, {:.2f}, {:.2f}}},".format(*values))


if __name__ == "__main__":
    main()
