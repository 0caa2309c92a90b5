#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Render a sheet of Klems matrices with Radiance and with aureole, and print the ratio of the radiances.

    python render_with_radiance.py AUREOLE

Needs pyradiance 1.3 and numpy (PyPI). The sheet shade_klems.xml lies in the plane z = 0, with y up, and one small source
irradiates it. Views and source are at random azimuths on both sides. Each line has the angles of view and light from +z,
f [1/sr] by Radiance's rtrace and by aureole's direct integrator.
"""
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pyradiance

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = pathlib.Path(pyradiance.__file__).parent
SHEET = HERE / "shade_klems.xml"


def vector(theta, phi):
    return np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])


def by_radiance(view, light, folder):
    environment = dict(os.environ, RAYPATH=f"{PACKAGE / 'lib'}:{HERE}", PATH=f"{PACKAGE / 'bin'}:{os.environ['PATH']}")
    scene = (f"void BSDF mat\n6 0 {SHEET.name} 0 1 0 .\n0\n0\nmat polygon p\n0\n0\n12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n"
             f"void light sun\n0\n0\n3 1e6 1e6 1e6\nsun source s\n0\n0\n4 {light[0]} {light[1]} {light[2]} 0.5\n")
    (folder / "sheet.rad").write_text(scene)
    octree = subprocess.run(["oconv", "sheet.rad"], capture_output=True, env=environment, cwd=folder, check=True).stdout
    (folder / "sheet.oct").write_bytes(octree)
    ray = " ".join(str(x) for x in [*(3 * view), *(-view)])
    out = subprocess.run(["rtrace", "-h", "-ab", "0", "-dj", "0", "-ss", "0", "sheet.oct"], input=ray.encode(),
                         capture_output=True, env=environment, cwd=folder, check=True).stdout
    solid_angle = 2 * math.pi * (1 - math.cos(math.radians(0.25)))
    return float(out.split()[1]) / (1e6 * solid_angle * abs(light[2]))


def by_aureole(program, view, light, folder):
    origin, direction = 3 * view, -light
    scene = f"""<scene version="3.0.0"><integrator type="direct"/>
<sensor type="radiancemeter">
  <point name="origin" x="{origin[0]}" y="{origin[1]}" z="{origin[2]}"/>
  <vector name="direction" x="{-view[0]}" y="{-view[1]}" z="{-view[2]}"/>
  <sampler type="sobol"><integer name="sample_count" value="256"/></sampler>
  <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
    <string name="pixel_format" value="luminance"/><rfilter type="box"/></film></sensor>
<emitter type="directional"><vector name="direction" x="{direction[0]}" y="{direction[1]}" z="{direction[2]}"/>
  <rgb name="irradiance" value="1, 1, 1"/></emitter>
<shape type="rectangle"><bsdf type="klems"><string name="filename" value="{SHEET}"/></bsdf></shape></scene>"""
    (folder / "sheet.xml").write_text(scene)
    subprocess.run([program, "render", "sheet.xml", "-o", "sheet.pfm"], capture_output=True, cwd=folder, check=True)
    return np.frombuffer((folder / "sheet.pfm").read_bytes()[-4:], np.float32)[0] / abs(light[2])


def main():
    rng = np.random.default_rng(4)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for k in range(16):
            view_angle, light_angle = np.radians(rng.uniform(5, 80, 2))
            view_angle = math.pi - view_angle if k % 2 else view_angle
            light_angle = math.pi - light_angle if k % 4 >= 2 else light_angle
            view, light = vector(view_angle, rng.uniform(0, 2 * math.pi)), vector(light_angle, rng.uniform(0, 2 * math.pi))
            a, b = by_radiance(view, light, folder), by_aureole(sys.argv[1], view, light, folder)
            print(f"{math.degrees(view_angle):6.1f} {math.degrees(light_angle):6.1f}   {a:.5f} {b:.5f}   ratio {b / a:.4f}")


main()
