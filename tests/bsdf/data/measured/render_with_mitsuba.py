#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Render measured materials of all four kinds with Mitsuba 3 and with aureole, and print a z-test of the pictures.

    python render_with_mitsuba.py AUREOLE

Needs mitsuba 3.9 and numpy (PyPI). Two scenes have an isotropic and an anisotropic sphere each: files in linear sRGB,
rendered by Mitsuba's variant scalar_rgb, and files of spectra (scalar_spectral). Each program renders 16 pictures of
different seeds. A line has the mean of z^2 over pixels and channels (expected: 1.07 for variances of 16 pictures), the
share of |z| > 4, and z of the mean of the picture for red, green and blue.
"""
import pathlib
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PICTURES = 16
SCENE = """<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="2"/></integrator>
<sensor type="perspective"><float name="fov" value="36"/>
  <transform name="to_world"><lookat origin="0,-8,2" target="0,0,0" up="0,0,1"/></transform>
  <sampler type="independent"><integer name="sample_count" value="64"/></sampler>
  <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/>
    <string name="pixel_format" value="rgb"/><rfilter type="box"/></film></sensor>
<emitter type="constant"><rgb name="radiance" value="0.2,0.2,0.2"/></emitter>
<shape type="rectangle"><emitter type="area"><rgb name="radiance" value="3,3,3"/></emitter>
  <transform name="to_world"><scale value="1.5"/><lookat origin="3,-3,4" target="0,0,0" up="0,0,1"/></transform></shape>
{}</scene>"""
SPHERE = """<shape type="sphere"><point name="center" x="{}" y="0" z="0"/>
  <bsdf type="measured"><string name="filename" value="{}"/></bsdf></shape>
"""


def by_mitsuba(scene, variant):
    mi.set_variant(variant)
    loaded = mi.load_file(str(scene))
    return np.array([np.array(mi.render(loaded, seed=k, spp=64)) for k in range(PICTURES)], float)


def by_aureole(scene, program):
    pictures = []
    for k in range(PICTURES):
        out = scene.with_name(f"{k}.exr")
        subprocess.run([program, "render", scene, "-o", out, "--seed", str(k + 1), "--restart", "-q"], check=True,
                       capture_output=True)
        bitmap = mi.Bitmap(str(out)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
        pictures.append(np.array(bitmap))
    return np.array(pictures, float)


def compare(kind, theirs, ours):
    variance = (theirs.var(0, ddof=1) + ours.var(0, ddof=1)) / PICTURES
    is_lit = variance > 1e-12
    z = (ours.mean(0) - theirs.mean(0))[is_lit] / np.sqrt(variance[is_lit])
    of_pictures = [pictures.mean(axis=(1, 2)) for pictures in (theirs, ours)]
    error = np.sqrt(sum(m.var(0, ddof=1) for m in of_pictures) / PICTURES)
    z_mean = (of_pictures[1].mean(0) - of_pictures[0].mean(0)) / error
    print(f"{kind:24} mean z^2 {np.mean(z**2):.3f}   |z| > 4: {np.mean(abs(z) > 4):.4f}   means: z {z_mean.round(2)}")


VARIANTS = {"rgb": "scalar_rgb", "spectral": "scalar_spectral"}


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    if len(sys.argv) == 2:
        # A process for each variant: after scalar_rgb the first scene of scalar_spectral has other values in Mitsuba 3.9.1.
        for name in VARIANTS:
            subprocess.run([sys.executable, __file__, program, name], check=True)
        return
    name = sys.argv[2]
    with tempfile.TemporaryDirectory() as folder:
        files = [HERE / f"{kind}_{name}.bsdf" for kind in ("isotropic", "anisotropic")]
        scene = pathlib.Path(folder) / f"{name}.xml"
        scene.write_text(SCENE.format(SPHERE.format(-1.3, files[0]) + SPHERE.format(1.3, files[1])))
        theirs, ours = by_mitsuba(scene, VARIANTS[name]), by_aureole(scene, program)
        for k, half in enumerate((slice(0, 12), slice(12, 24))):
            compare(files[k].name, theirs[:, :, half], ours[:, :, half])


if __name__ == "__main__":
    main()
