#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes and reads text files of splats by OpenUSD itself (PyPI usd-core 26.11).

    python3 -m venv venv && venv/bin/pip install usd-core==26.11 numpy gsply==0.4.6
    venv/bin/python tests/medium/data/make_usd_splats.py             writes tests/medium/data/splats/sh2.usda and sh1_half.usda from the
                                                                     numbers of sh2.ply and sh1.ply
    venv/bin/python tests/medium/data/make_usd_splats.py FILE.usda   prints what usd-core reads from a file: one splat a line, as
                                                                     position; rotation w x y z; scales; opacity; harmonics"""
import pathlib
import sys

from pxr import Gf, Usd, UsdGeom, UsdVol, Vt

HERE = pathlib.Path(__file__).parent / "splats"


def write(name, half):
    import gsply
    import numpy as np
    g = gsply.plyread(str(HERE / f"{name}.ply"))
    target = HERE / (f"{name}_half.usda" if half else f"{name}.usda")
    target.unlink(missing_ok=True)
    stage = Usd.Stage.CreateNew(str(target))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.Xform.Define(stage, "/World")
    prim = UsdVol.ParticleField3DGaussianSplat.Define(stage, "/World/Splats").GetPrim()
    rest = g.shN if g.shN is not None else np.zeros((len(g.means), 0, 3))
    harmonics = np.concatenate([g.sh0[:, None], rest.reshape(len(g.means), -1, 3)], axis=1)
    quats = g.quats / np.linalg.norm(g.quats, axis=1, keepdims=True)
    h = "h" if half else ""
    vec, quat, array = (Gf.Vec3h, Gf.Quath, Vt.Vec3hArray) if half else (Gf.Vec3f, Gf.Quatf, Vt.Vec3fArray)
    quats_of, numbers_of = (Vt.QuathArray, Vt.HalfArray) if half else (Vt.QuatfArray, Vt.FloatArray)
    rows = lambda a: array([vec(*map(float, r)) for r in a])
    prim.GetAttribute("positions" + h).Set(rows(g.means))
    prim.GetAttribute("scales" + h).Set(rows(np.exp(g.scales.astype(float))))
    prim.GetAttribute("orientations" + h).Set(quats_of([quat(*map(float, q)) for q in quats]))
    prim.GetAttribute("opacities" + h).Set(numbers_of([float(x) for x in 1 / (1 + np.exp(-g.opacities.astype(float).reshape(-1)))]))
    prim.GetAttribute("radiance:sphericalHarmonicsDegree").Set(int(round(harmonics.shape[1] ** 0.5)) - 1)
    prim.GetAttribute("radiance:sphericalHarmonicsCoefficients" + h).Set(rows(harmonics.reshape(-1, 3)))
    prim.GetAttribute("sortingModeHint").Set("cameraDistance")
    prim.GetAttribute("projectionModeHint").Set("tangential")
    stage.GetRootLayer().Save()


def show(file):
    stage = Usd.Stage.Open(file)
    for prim in stage.Traverse():
        if not prim.IsA(UsdVol.ParticleField3DGaussianSplat):
            continue
        get = lambda name: prim.GetAttribute(name).Get()
        terms = (get("radiance:sphericalHarmonicsDegree") + 1) ** 2
        harmonics = get("radiance:sphericalHarmonicsCoefficients")
        for i, p in enumerate(get("positions")):
            q = get("orientations")[i]
            numbers = [*p, q.GetReal(), *q.GetImaginary(), *get("scales")[i], get("opacities")[i]]
            for c in harmonics[terms * i:terms * (i + 1)]:
                numbers += [*c]
            print(" ".join(f"{x:.9g}" for x in numbers))


if len(sys.argv) > 1:
    show(sys.argv[1])
else:
    write("sh2", False)
    write("sh1", True)
