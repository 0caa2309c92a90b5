#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the small meshes and images of the reference scenes (needs numpy and OpenEXR).

    python make_assets.py        # writes meshes/ and textures/ next to this file
"""
import math
import struct
import zlib
from pathlib import Path

import numpy as np
import OpenEXR

HERE = Path(__file__).resolve().parent
MESHES, TEXTURES, VOLUMES = HERE / "meshes", HERE / "textures", HERE / "volumes"


# ---------------------------------------------------------------- geometry

def icosphere():
    """42 vertices, 80 faces on the unit sphere."""
    g = (1 + math.sqrt(5)) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
         (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
         (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
         (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    v = [np.array(p) / np.linalg.norm(p) for p in v]
    middle = {}

    def mid(a, b):
        key = (min(a, b), max(a, b))
        if key not in middle:
            p = v[a] + v[b]
            middle[key] = len(v)
            v.append(p / np.linalg.norm(p))
        return middle[key]

    faces = []
    for a, b, c in f:
        ab, bc, ca = mid(a, b), mid(b, c), mid(c, a)
        faces += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.array(v), faces


def hill(n=7):
    """A bump over [-1, 1]^2: positions, normals, uv, triangles."""
    s = np.linspace(-1, 1, n)
    x, y = np.meshgrid(s, s)
    z = 0.6 * np.exp(-2 * (x**2 + y**2)) + 0.15 * x
    nrm = np.stack([2.4 * x * np.exp(-2 * (x**2 + y**2)) - 0.15,
                    2.4 * y * np.exp(-2 * (x**2 + y**2)), np.ones_like(x)], -1)
    nrm /= np.linalg.norm(nrm, axis=-1, keepdims=True)
    uv = np.stack([(x + 1) / 2, (y + 1) / 2], -1)
    tris = []
    for j in range(n - 1):
        for i in range(n - 1):
            a = j * n + i
            tris += [(a, a + 1, a + n), (a + 1, a + n + 1, a + n)]
    return np.stack([x, y, z], -1).reshape(-1, 3), nrm.reshape(-1, 3), uv.reshape(-1, 2), tris


def numbers(row):
    return " ".join(f"{x:.6g}" for x in row)


# ---------------------------------------------------------------- OBJ

def write_icosphere():
    v, f = icosphere()
    lines = ["# unit icosphere: no normals, no uv"]
    lines += ["v " + numbers(p) for p in v]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in f]
    (MESHES / "icosphere.obj").write_text("\n".join(lines) + "\n")


def write_globe(nu=12, nv=6):
    """A unit sphere of quads and triangles with v/vt/vn, the uv seam being split."""
    lines = ["# unit sphere: v/vt/vn, quads with triangles at the poles, a uv seam"]
    pos = {}
    for j in range(nv + 1):
        for i in range(nu):
            if j in (0, nv) and i:
                continue
            t, p = math.pi * j / nv, 2 * math.pi * i / nu
            pos[i, j] = len(pos) + 1
            lines.append("v " + numbers((math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), math.cos(t))))
    lines += ["vn " + line[2:] for line in lines if line.startswith("v ")]
    lines += [f"vt {i / nu:.6g} {1 - j / nv:.6g}" for j in range(nv + 1) for i in range(nu + 1)]

    def corner(i, j):
        k = pos[0 if j in (0, nv) else i % nu, j]
        return f"{k}/{j * (nu + 1) + i + 1}/{k}"

    for j in range(nv):
        for i in range(nu):
            ring = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)]
            if j == 0:
                ring.pop()
            elif j == nv - 1:
                ring.pop(1)
            lines.append("f " + " ".join(ring))
    (MESHES / "globe.obj").write_text("\n".join(lines) + "\n")


def write_house():
    (MESHES / "house.obj").write_text("""\
# a pentagonal prism: v/vt, no normals; two pentagons, four quads (and no floor)
v -1 -1 0
v 1 -1 0
v 1 -1 1.2
v 0 -1 2
v -1 -1 1.2
v -1 1 0
v 1 1 0
v 1 1 1.2
v 0 1 2
v -1 1 1.2
vt 0 0
vt 1 0
vt 1 0.6
vt 0.5 1
vt 0 0.6
vt 1 1
vt 0 1
f 1/1 2/2 3/3 4/4 5/5
f 7/1 6/2 10/3 9/4 8/5
f 2/1 7/2 8/6 3/7
f 3/1 8/2 9/6 4/7
f 4/1 9/2 10/6 5/7
f 5/1 10/2 6/6 1/7
""")


def write_panel():
    (MESHES / "panel.obj").write_text("""\
# a flat L of triangles of unequal area facing -z: v//vn
v -1 -1 0
v 1 -1 0
v 1 0.2 0
v 0 0.2 0
v 0 1 0
v -1 1 0
v -1 0.2 0
vn 0 0 -1
f 1//1 3//1 2//1
f 1//1 7//1 3//1
f 7//1 6//1 5//1 4//1
""")


# ---------------------------------------------------------------- PLY

def write_ply():
    v, n, uv, tris = hill()
    head = "ply\nformat {} 1.0\ncomment aureole reference mesh\nelement vertex %d\n{}element face %d\n{}end_header\n" \
        % (len(v), len(tris))

    def properties(kind, names):
        return "".join(f"property {kind} {x}\n" for x in names.split())

    text = head.format("ascii", properties("float", "x y z nx ny nz u v"),
                       "property list uchar int vertex_indices\n")
    text += "".join(numbers(row) + "\n" for row in np.hstack([v, n, uv]))
    text += "".join("3 " + " ".join(map(str, t)) + "\n" for t in tris)
    (MESHES / "hill_ascii.ply").write_text(text)

    data = head.format("binary_little_endian", properties("float", "x y z"),
                       "property list uchar int vertex_indices\n").encode()
    data += v.astype("<f4").tobytes() + b"".join(struct.pack("<B3i", 3, *t) for t in tris)
    (MESHES / "hill_little.ply").write_bytes(data)

    data = head.format("binary_big_endian", properties("double", "x y z") + properties("float", "s t"),
                       "property list uchar uint vertex_index\n").encode()
    data += b"".join(struct.pack(">3d2f", *p, *t) for p, t in zip(v, uv))
    data += b"".join(struct.pack(">B3I", 3, *t) for t in tris)
    (MESHES / "hill_big.ply").write_bytes(data)


def write_attributes():
    """The hill with colours at vertices, a number at vertices, and colours on faces."""
    v, n, uv, tris = hill(5)
    x, y, z = v.T
    rgb = np.stack([0.5 + 0.4 * x, 0.5 - 0.4 * y, 0.2 + 0.9 * z.clip(0)], -1).clip(0.02, 0.95)
    paint = 0.1 + 0.8 * (np.arange(len(v)) % 3 == 0)
    faces = np.array([[0.8, 0.2, 0.1], [0.1, 0.5, 0.7], [0.7, 0.7, 0.3]])[np.arange(len(tris)) % 3]
    text = "ply\nformat ascii 1.0\ncomment aureole reference mesh\nelement vertex %d\n" % len(v)
    text += "".join(f"property float {p}\n" for p in "x y z nx ny nz r g b paint_x".split())
    text += "element face %d\nproperty list uchar int vertex_indices\n" % len(tris)
    text += "".join(f"property float {p}\n" for p in "r g b".split()) + "end_header\n"
    text += "".join(numbers(row) + "\n" for row in np.hstack([v, n, rgb, paint[:, None]]))
    text += "".join("3 " + " ".join(map(str, t)) + " " + numbers(c) + "\n" for t, c in zip(tris, faces))
    (MESHES / "hill_attributes.ply").write_text(text)


# ---------------------------------------------------------------- curves

def write_curves():
    """A spiral of growing radius, a straight tube and a thin arc that ends in a point."""
    spiral = [(1.6 * math.cos(t), 1.6 * math.sin(t), 0.12 * t, 0.08 + 0.025 * t) for t in 0.9 * np.arange(9)]
    tube = [(-0.6 + 0.5 * i, -0.3, 0.2 + 0.2 * i, 0.3 - 0.05 * i) for i in range(4)]
    arc = [(-2 + 0.6 * i, 0.8 - 0.3 * i, 0.3 + 0.25 * i * (5 - i), 0.15 if i < 4 else 0) for i in range(6)]
    (MESHES / "curves.txt").write_text("\n".join("".join(numbers(p) + "\n" for p in c) for c in (spiral, tube, arc)))


# ---------------------------------------------------------------- serialized (version 4)

def write_serialized():
    NORMALS, TEXCOORDS, SINGLE, DOUBLE = 1, 2, 0x1000, 0x2000
    v, n, uv, tris = hill()
    ico, faces = icosphere()
    meshes = [("hill", NORMALS | TEXCOORDS | SINGLE, "<f4", [v, n, uv], tris),
              ("icosphere", DOUBLE, "<f8", [ico], faces)]
    data, offsets = b"", []
    for name, flags, kind, arrays, indices in meshes:
        body = struct.pack("<I", flags) + name.encode() + b"\0"
        body += struct.pack("<QQ", len(arrays[0]), len(indices))
        body += b"".join(a.astype(kind).tobytes() for a in arrays)
        body += np.array(indices, "<u4").tobytes()
        offsets.append(len(data))
        data += struct.pack("<HH", 0x041C, 4) + zlib.compress(body, 9)
    data += struct.pack(f"<{len(offsets)}QI", *offsets, len(offsets))
    (MESHES / "pair.serialized").write_bytes(data)


# ---------------------------------------------------------------- images

def write_png(path, pixels):
    """8-bit grey (h, w), RGB (h, w, 3) or RGBA (h, w, 4)."""
    h, w = pixels.shape[:2]
    raw = b"".join(b"\0" + row.astype(np.uint8).tobytes() for row in pixels)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    path.write_bytes(b"\x89PNG\r\n\x1a\n"
                     + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 0 if pixels.ndim == 2 else 2 if pixels.shape[2] == 3 else 6, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def write_images():
    # An F, which has no symmetry, on a ground whose four corners differ.
    rows = ["R......G", ".FFFFF..", ".F......", ".FFFF...", ".F......", ".F......", ".F......", "B......Y"]
    colour = {".": (190, 188, 180), "F": (40, 60, 110), "R": (220, 50, 40), "G": (40, 170, 60),
              "B": (50, 70, 230), "Y": (235, 215, 40)}
    write_png(TEXTURES / "letter.png", np.array([[colour[c] for c in row] for row in rows]))

    x, y = np.meshgrid(np.arange(8), np.arange(4))
    write_png(TEXTURES / "ramp.png", 20 + 28 * x + 10 * y)

    # A height field that repeats, and the normals of another.
    x, y = np.meshgrid((np.arange(16) + 0.5) / 16, (np.arange(16) + 0.5) / 16)
    heights = 0.5 + 0.25 * np.sin(2 * np.pi * x) * np.cos(2 * np.pi * y) + 0.2 * np.sin(2 * np.pi * (2 * x + y))
    write_png(TEXTURES / "heights.png", np.round(255 * heights))
    normals = np.stack([0.6 * np.sin(2 * np.pi * (x + 2 * y)), 0.5 * np.cos(2 * np.pi * (2 * x - y)),
                        np.ones_like(x)], -1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    write_png(TEXTURES / "normals.png", np.round(255 * (normals + 1) / 2))

    # A transfer function of value (along x) and gradient (upward): opacity is alpha.
    x, y = np.meshgrid(np.arange(16) / 15, 1 - np.arange(8) / 7)
    transfer = np.stack([0.4 + 0.6 * x, 0.7 + 0 * x, 1 - 0.6 * x, np.clip(2 * x - 0.4, 0, 1) * (0.2 + 0.7 * y)], -1)
    write_png(TEXTURES / "transfer.png", np.round(255 * transfer))

    # Latitude-longitude maps, 16 x 8. One pixel is far brighter than the others.
    x, y = np.meshgrid(np.arange(16), np.arange(8))
    grey = 0.2 + 0.6 * (1 - y / 7) + 0.25 * np.cos(2 * np.pi * x / 16)
    grey[2, 5] = 40
    write_exr(TEXTURES / "sky_grey.exr", np.repeat(grey[..., None], 3, -1))
    up = (1 - y / 7)[..., None]
    sky = up * (0.25, 0.45, 0.9) + (1 - up) * (0.45, 0.3, 0.15)
    sky *= (1 + 0.4 * np.sin(2 * np.pi * x / 16))[..., None]
    sky[2, 5] = (60, 42, 21)
    write_exr(TEXTURES / "sky_colour.exr", sky)


def write_exr(path, rgb):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": rgb.astype(np.float32)}) as f:
        f.write(str(path))


# ---------------------------------------------------------------- volumes

def write_vol(path, values, lower=(0, 0, 0), upper=(1, 1, 1)):
    """An array of depth x height x width x channels as Mitsuba's .vol."""
    values = np.asarray(values, "<f4")
    depth, height, width, channels = values.shape
    path.write_bytes(b"VOL\x03" + struct.pack("<5i6f", 1, width, height, depth, channels, *lower, *upper)
                     + values.tobytes())


def write_volumes():
    # A plume that leans and widens as it rises along y, and the same with another colour at each height.
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (10, 14, 12)), indexing="ij")
    radius2 = (x - 0.35 - 0.3 * y**2) ** 2 + (z - 0.5 - 0.1 * np.sin(4 * y)) ** 2
    plume = np.maximum(np.exp(-radius2 / (0.02 + 0.06 * y)) - 0.1, 0)[..., None]
    write_vol(VOLUMES / "smoke.vol", plume, (-1, 0, -1), (1, 2.5, 1))
    # Labels on the grid of the plume: three layers across x.
    write_vol(VOLUMES / "labels.vol", np.broadcast_to(np.arange(12) // 4, (10, 14, 12))[..., None], (-1, 0, -1), (1, 2.5, 1))
    tint = np.stack([0.9 + 0 * y, 0.85 - 0.4 * y, 0.3 + 0.5 * y], -1)
    write_vol(VOLUMES / "tint.vol", tint[:4, :, :5])
    # Extinction and albedo in colours that lie away from black and white, on grids of other sizes. The largest
    # component of each extinction is 0.5, for which Mitsuba's grids have the spectrum of the same <rgb>.
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (5, 4, 6)), indexing="ij")
    extinction = np.stack([0.1 + 0.7 * x, 0.15 + 0.5 * y * (1 - x), 0.8 - 0.6 * z], -1)
    write_vol(VOLUMES / "extinction.vol", 0.5 * extinction / extinction.max(-1, keepdims=True))
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (3, 5, 4)), indexing="ij")
    write_vol(VOLUMES / "albedo.vol", np.stack([0.3 + 0.5 * z, 0.7 - 0.4 * x, 0.35 + 0.3 * y], -1))
    # Two balls that flow together, and a ring, as distances at the nodes of a grid over [0, 1]^3.
    z, y, x = np.meshgrid(*([np.linspace(0, 1, 14)] * 3), indexing="ij")
    balls = [np.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) - r
             for a, b, c, r in ((0.37, 0.45, 0.35, 0.22), (0.64, 0.52, 0.66, 0.17))]
    blob = -0.08 * np.log(sum(np.exp(-ball / 0.08) for ball in balls))
    write_vol(VOLUMES / "blob.vol", blob[..., None])
    z, y, x = np.meshgrid(*([np.linspace(0, 1, 9)] * 3), indexing="ij")
    ring = np.hypot(np.hypot(x - 0.5, y - 0.5) - 0.29, z - 0.5) - 0.13
    write_vol(VOLUMES / "ring.vol", ring[..., None])


if __name__ == "__main__":
    for folder in (MESHES, TEXTURES, VOLUMES):
        folder.mkdir(exist_ok=True)
    write_icosphere()
    write_globe()
    write_house()
    write_panel()
    write_ply()
    write_attributes()
    write_curves()
    write_serialized()
    write_images()
    write_volumes()
