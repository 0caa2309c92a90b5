#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes scenes/splats: a potted plant as Gaussian splats (plant.spz, version 3, with harmonics of degree 1) and as points with normals
and radii (plant_points.ply). Needs numpy.

    tools/make_splats.py [--splats 16000] [--points 9000] [--folder scenes/splats]"""
import argparse
import gzip
import pathlib
import struct

import numpy as np


def surfaces(count, random):
    """Points, normals, tangents, colours (linear) and areas per point of the plant: y is up, the pot stands on y = 0."""
    parts = []

    def add(points, normals, tangents, colors):
        unit = lambda v: v / np.linalg.norm(v, axis=1, keepdims=True)
        parts.append((points, unit(normals), unit(tangents), np.broadcast_to(colors, points.shape) * random.uniform(0.85, 1.1, (len(points), 1))))

    areas = {"pot": 1.05, "rim": 0.3, "soil": 0.32, "leaves": 4.2}
    share = {k: int(count * v / sum(areas.values())) for k, v in areas.items()}
    # The pot: a truncated cone, and its rim.
    n = share["pot"]
    a, h = random.uniform(0, 2 * np.pi, n), random.uniform(0, 0.5, n)
    r = 0.26 + 0.16 * h
    out = np.stack([np.cos(a), np.zeros(n), np.sin(a)], 1)
    band = np.where(np.abs(h - 0.3) < 0.04, 0.55, 1.0)[:, None]
    add(np.stack([r * np.cos(a), h, r * np.sin(a)], 1), out + [0, -0.16, 0], np.stack([-np.sin(a), 0 * a, np.cos(a)], 1), np.array([0.42, 0.13, 0.06]) * band)
    n = share["rim"]
    a, b = random.uniform(0, 2 * np.pi, n), random.uniform(0, 2 * np.pi, n)
    normal = np.stack([np.cos(a) * np.cos(b), np.sin(b), np.sin(a) * np.cos(b)], 1)
    add(np.stack([0.35 * np.cos(a), 0.5 + 0 * a, 0.35 * np.sin(a)], 1) + 0.03 * normal, normal, np.stack([-np.sin(a), 0 * a, np.cos(a)], 1), np.array([0.45, 0.15, 0.07]))
    n = share["soil"]
    a, r = random.uniform(0, 2 * np.pi, n), 0.33 * np.sqrt(random.uniform(0, 1, n))
    add(np.stack([r * np.cos(a), 0.47 + random.normal(0, 0.006, n), r * np.sin(a)], 1), np.array([[0.0, 1, 0]]) + random.normal(0, 0.25, (n, 3)),
        np.tile([[1.0, 0, 0]], (n, 1)), np.array([0.035, 0.022, 0.014]))
    # Leaves: blades along curves that rise and bend outwards.
    leaves = 30
    for k in range(leaves):
        n = share["leaves"] // leaves
        turn = k * 2.39996 + random.uniform(-0.2, 0.2)
        bend, long, wide = random.uniform(0.5, 1.7), random.uniform(0.75, 1.15), random.uniform(0.06, 0.1)
        s = random.uniform(0, 1, n)
        across = random.uniform(-1, 1, n)

        def curve(s):
            angle = 0.15 + bend * s
            reach = long * s * np.sin(angle) * 0.9
            return np.stack([np.cos(turn) * (0.05 + reach), 0.47 + long * s * np.cos(angle * 0.8), np.sin(turn) * (0.05 + reach)], 1)

        along = curve(s + 1e-4) - curve(s)
        side = np.stack([-np.sin(turn) + 0 * s, 0 * s, np.cos(turn) + 0 * s], 1)
        normal = np.cross(side, along)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        profile = wide * np.sin(np.pi * np.clip(0.06 + 0.94 * s, 0, 1)) ** 0.7
        fold = 0.35 * np.abs(across)[:, None] * profile[:, None]
        points = curve(s) + side * (across * profile)[:, None] + normal * fold
        vein = np.where(np.abs(across) < 0.12, 1.5, 1.0)[:, None]
        young = random.uniform(0, 1)
        color = (np.array([0.05, 0.19, 0.03]) * (1 - young) + np.array([0.13, 0.3, 0.03]) * young) * vein * (0.7 + 0.5 * s)[:, None]
        add(points, normal - 0.35 * np.sign(across)[:, None] * side, along, color)
    points, normals, tangents, colors = (np.concatenate(p) for p in zip(*parts))
    return points, normals, tangents, colors, sum(areas.values()) / len(points)


def encode(linear):
    v = np.clip(linear, 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


def quaternions(x, y, z):
    """w, x, y, z of the rotations whose matrices have these columns."""
    m = np.stack([x, y, z], 2)
    q = np.empty((len(m), 4))
    for i, r in enumerate(m):
        values, vectors = np.linalg.eigh(np.array([
            [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0], [r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
            [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1], 0],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], r[0, 0] + r[1, 1] + r[2, 2]]]) / 3)
        v = vectors[:, 3]
        q[i] = [v[3], v[0], v[1], v[2]]
    return q


def spz(points, scales, q, opacities, sh0, sh1):
    """Version 3: numbers as in the axes right, up, back."""
    n = len(points)
    byte = lambda v: np.clip(np.round(v), 0, 255).astype("u1").tobytes()
    fixed = np.round(points * 4096).astype("<i4")
    out = struct.pack("<IIIBBBB", 0x5053474E, 3, n, 1, 12, 0, 0)
    out += fixed.view("u1").reshape(n, 3, 4)[:, :, :3].tobytes()
    out += byte(opacities * 255) + byte(sh0 * 0.15 * 255 + 127.5) + byte((np.log(scales) + 10) * 16)
    xyzw = np.roll(q, -1, axis=1)
    largest = np.abs(xyzw).argmax(axis=1)
    xyzw *= np.sign(xyzw[np.arange(n), largest])[:, None]
    bits = largest.astype(np.uint32)
    for k in range(4):
        component = (xyzw[:, k] < 0).astype(np.uint32) << 9 | np.round(np.abs(xyzw[:, k]) * np.sqrt(2) * 511).clip(0, 511).astype(np.uint32)
        bits = np.where(largest == k, bits, bits << 10 | component).astype(np.uint32)
    out += bits.astype("<u4").tobytes() + byte(sh1.reshape(n, 9) * 128 + 128)
    return gzip.compress(out, mtime=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--splats", type=int, default=16000)
    parser.add_argument("--points", type=int, default=9000)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("scenes/splats"))
    options = parser.parse_args()
    random = np.random.default_rng(7)

    points, normals, tangents, colors, area = surfaces(options.splats, random)
    light = np.array([0.45, 0.75, 0.48])
    shade = 0.55 + 0.45 * np.abs(normals @ light)[:, None]
    deep = np.clip(0.55 + 0.6 * np.linalg.norm(points[:, [0, 2]], axis=1), 0, 1)[:, None]
    encoded = encode(colors * shade * deep * 1.5)
    along = tangents - normals * (tangents * normals).sum(axis=1, keepdims=True)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    scale = 0.62 * np.sqrt(area)
    scales = scale * np.stack([np.full(len(points), 1.35), np.full(len(points), 0.8), np.full(len(points), 0.15)], 1)
    # A gloss that depends on the direction: lighter where seen from the side of the light.
    sh1 = np.zeros((len(points), 3, 3))
    for k, component in enumerate((1, 2, 0)):
        sh1[:, k, :] = (-1 if component != 2 else 1) * -0.06 * light[component]
    data = spz(points, scales, quaternions(along, np.cross(normals, along), normals), np.full(len(points), 0.93), (encoded - 0.5) / 0.28209479177387814, sh1)
    (options.folder / "plant.spz").write_bytes(data)

    points, normals, tangents, colors, area = surfaces(options.points, np.random.default_rng(9))
    shade = 0.55 + 0.45 * np.abs(normals @ light)[:, None]
    record = np.zeros(len(points), [("p", "<f4", 3), ("n", "<f4", 3), ("r", "<f4"), ("c", "u1", 3)])
    record["p"], record["n"], record["r"], record["c"] = points, normals, np.sqrt(area / np.pi) * 1.1, np.round(255 * encode(colors * shade * 1.3))
    names = ["float " + n for n in ("x", "y", "z", "nx", "ny", "nz", "radius")] + ["uchar " + n for n in ("red", "green", "blue")]
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n" + "".join(f"property {n}\n" for n in names) + "end_header\n"
    (options.folder / "plant_points.ply").write_bytes(header.encode() + record.tobytes())


main()
