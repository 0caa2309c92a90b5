#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes tests/medium/data/splats: small files of splats by gsply 0.4.6 and gaussforge 0.6.0 (MIT), and splats.txt, the
numbers that these programs read from them (of .spz of version 1, which neither writes, by the format's description).
The files written_*.ply and written_*.spz are those that this program writes of sh0.ply and sh3.ply:
AUREOLE_WRITTEN_SPLATS=tests/medium/data/splats build/release/bin/aureole_tests --gtest_filter=Splat.WrittenFiles*.

    python3 -m venv venv && venv/bin/pip install gsply==0.4.6 gaussforge==0.6.0 zstandard numpy
    venv/bin/python tests/medium/data/make_splats.py

A line of splats.txt is: file; number of the splat; x y z; scales; rotation w x y z; opacity; harmonics, all as the file's axes have
them. Rotations are normalised here."""
import gzip
import pathlib
import struct
import tempfile

import gaussforge
import gsply
import numpy as np

HERE = pathlib.Path(__file__).parent / "splats"
COUNT = 12


def cloud(degree, seed):
    r = np.random.default_rng(seed)
    terms = (degree + 1) ** 2 - 1
    q = r.normal(size=(COUNT, 4))
    # Each component is the largest of some rotation, with either sign: the encodings of .spz differ in it.
    for i in range(8):
        q[i] = r.uniform(-0.3, 0.3, 4)
        q[i, i % 4] = 1 if i < 4 else -1
    return dict(means=r.uniform(-3, 3, (COUNT, 3)), scales=r.uniform(-6, -0.5, (COUNT, 3)), quats=q, opacities=r.uniform(-4, 4, COUNT),
                sh0=r.uniform(-1.5, 1.5, (COUNT, 3)), shN=r.uniform(-0.9, 0.9, (COUNT, terms, 3)))


def ply_bytes(c):
    """The first program's layout, by its description: all coefficients of red, then of green, then of blue."""
    rest = c["shN"].shape[1]
    names = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"] + [f"f_rest_{k}" for k in range(3 * rest)]
    names += ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {COUNT}\n" + "".join(f"property float {n}\n" for n in names) + "end_header\n"
    columns = [c["means"], np.zeros((COUNT, 3)), c["sh0"], c["shN"].transpose(0, 2, 1).reshape(COUNT, -1), c["opacities"][:, None],
               c["scales"], c["quats"]]
    return head.encode() + np.concatenate(columns, axis=1).astype("<f4").tobytes()


def spz1(c):
    """Version 1 of .spz, positions as float16 and rotations as in version 2, and what its bytes stand for."""
    q = c["quats"] / np.linalg.norm(c["quats"], axis=1, keepdims=True)
    xyz = q[:, 1:] * np.where(q[:, :1] < 0, -1, 1)
    byte = lambda v: np.clip(np.round(v), 0, 255).astype("u1")
    means, alphas, colors = c["means"].astype("<f2"), byte(255 / (1 + np.exp(-c["opacities"]))), byte(c["sh0"] * 0.15 * 255 + 127.5)
    scales, turns, rest = byte((c["scales"] + 10) * 16), byte(xyz * 127.5 + 127.5), byte(c["shN"] * 128 + 128)
    body = struct.pack("<IIIBBBB", 0x5053474E, 1, COUNT, 1, 12, 0, 0) + b"".join(
        v.tobytes() for v in (means, alphas, colors, scales, turns, rest))
    v = turns / 127.5 - 1
    w = np.sqrt(np.maximum(0, 1 - (v * v).sum(axis=1)))
    decoded = (means.astype(float), np.exp(scales / 16 - 10.0), np.concatenate([w[:, None], v], axis=1), alphas / 255,
               (colors / 255 - 0.5) / 0.15, (rest - 128.0) / 128)
    return gzip.compress(body, mtime=0), decoded


def lines(name, means, scales, quats, opacities, sh0, shN):
    quats = quats / np.linalg.norm(quats, axis=1, keepdims=True)
    for i in range(len(means)):
        harmonics = np.concatenate([sh0[i][None], shN[i]]).reshape(-1)
        text = lambda v: " ".join(f"{x:.7g}" for x in np.atleast_1d(v))
        yield ";".join([name, str(i), text(means[i]), text(scales[i]), text(quats[i]), text(opacities[i]), text(harmonics)])


def main():
    HERE.mkdir(exist_ok=True)
    forge = gaussforge.GaussForge()
    out = []

    def judged(name, kind):
        """Numbers of a file that gaussforge has turned into a PLY, which gsply reads."""
        made = forge.convert((HERE / name).read_bytes(), kind, "ply")
        with tempfile.NamedTemporaryFile(suffix=".ply") as ply:
            ply.write(made["data"])
            ply.flush()
            add(name, gsply.plyread(ply.name))

    def add(name, g):
        rest = g.shN if g.shN is not None else np.zeros((COUNT, 0, 3))
        opacities = 1 / (1 + np.exp(-g.opacities.astype(float).reshape(-1)))
        out.extend(lines(name, g.means, np.exp(g.scales.astype(float)), g.quats, opacities, g.sh0, rest.reshape(COUNT, -1, 3)))

    for degree in range(4):
        c = cloud(degree, 10 + degree)
        name = f"sh{degree}.ply"
        (HERE / name).write_bytes(ply_bytes(c))
        add(name, gsply.plyread(str(HERE / name)))
        for version in (2, 3, 4):
            if degree in (0, 3) or version == 3:
                spz = f"sh{degree}_v{version}.spz"
                (HERE / spz).write_bytes(forge.convert((HERE / name).read_bytes(), "ply", "spz", spz_version=version)["data"])
                add(spz, gsply.read_spz(str(HERE / spz)))  # both programs as judges
                judged(spz, "spz")
    made = forge.convert((HERE / "sh0.ply").read_bytes(), "ply", "splat")
    (HERE / "sh0.splat").write_bytes(made["data"])
    judged("sh0.splat", "splat")
    for degree in (0, 3):
        name = f"written_sh{degree}"
        add(name + ".ply", gsply.plyread(str(HERE / (name + ".ply"))))
        judged(name + ".ply", "ply")
        add(name + ".spz", gsply.read_spz(str(HERE / (name + ".spz"))))
        judged(name + ".spz", "spz")
    c = cloud(1, 20)
    data, decoded = spz1(c)
    (HERE / "sh1_v1.spz").write_bytes(data)
    out.extend(lines("sh1_v1.spz", *decoded))
    (HERE.parent / "splats.txt").write_text("\n".join(out) + "\n")


main()
