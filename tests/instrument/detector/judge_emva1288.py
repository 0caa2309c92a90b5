#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Characterises a sensor of aureole expose by the reference implementation of EMVA 1288 (PyPI emva1288, run beside, never
shipped):

    pip install emva1288 && ./judge_emva1288.py AUREOLE [FOLDER]

prints what it finds beside what the sensor has, and fails where they differ by more than the tolerances of the table below.
Dark noise is that of electrons and of rounding. Exit code 77: emva1288 is not installed.
"""
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np

    if not hasattr(np, "asfarray"):  # emva1288 1.0.2 calls it; NumPy 2 has removed it
        np.asfarray = lambda values: np.asarray(values, dtype=float)
    from emva1288 import process
except ImportError:
    sys.exit(77)

SCENE = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="specfilm">
<integer name="width" value="240"/><integer name="height" value="180"/><float name="wavelength_min" value="545"/>
<float name="wavelength_max" value="555"/><integer name="bins" value="1"/><string name="component_format" value="float32"/>
<rfilter type="box"/></film><sampler type="sobol"><integer name="sample_count" value="16"/></sampler></sensor>
<emitter type="constant"><spectrum name="radiance" value="540:0.01, 560:0.01"/></emitter></scene>"""
GAIN, READ, EFFICIENCY, DSNU, PRNU, WELL, BLACK, DARK = 0.5, 5.0, 0.6, 2.0, 0.01, 7000, 100, 20.0
STEPS, SPATIAL = 25, 16


def main():
    aureole = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else made)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "flat.xml").write_text(SCENE)

        def run(*arguments):
            return subprocess.run([aureole, *map(str, arguments)], cwd=folder, check=True, capture_output=True, text=True).stdout

        run("render", "flat.xml", "-o", "flat.exr")
        (folder / "dark.xml").write_text(SCENE.replace("0.01, 560:0.01", "1e-30, 560:1e-30"))
        run("render", "dark.xml", "-o", "dark.exr")
        sensor = ["--efficiency", EFFICIENCY, "--gain", GAIN, "--read-noise", READ, "--dsnu", DSNU, "--prnu", PRNU, "--full-well",
                  WELL, "--black", BLACK, "--bits", 12, "--dark-current", DARK]

        def frames(picture, exposure, count, first, name):
            text = run("expose", picture, "--exposure", exposure, *sensor, "-o", f"{name}.tif", "--frames", count, "--frame", first)
            electrons = float(text.split(" electrons in the mean")[0].split()[-1])
            names = [line for line in text.splitlines() if line.endswith(".tif")]
            return electrons, names

        # Electrons per second: the exposures run up to 1.15 of the full well.
        probe, _ = frames("flat.exr", 1e-3, 1, 1, "probe")
        longest = 1.15 * WELL / (probe / 1e-3)
        lines = ["v 3.1", "n 12 240 180"]
        frame = 10
        for step in range(1, STEPS + 1):
            exposure = longest * step / STEPS
            count = SPATIAL if step == STEPS // 2 else 2
            nanoseconds = exposure * 1e9
            for c in ({2, count}):
                electrons, names = frames("flat.exr", exposure, c, frame, f"b{step}_{c}")
                lines.append(f"b {nanoseconds:.3f} {electrons / EFFICIENCY:.4f}")
                lines += [f"i {n}" for n in names]
                frame += c
                _, names = frames("dark.exr", exposure, c, frame, f"d{step}_{c}")
                lines.append(f"d {nanoseconds:.3f}")
                lines += [f"i {n}" for n in names]
                frame += c
        (folder / "set.txt").write_text("\n".join(lines) + "\n")
        info = process.ParseEmvaDescriptorFile(str(folder / "set.txt"), path=str(folder))
        images = process.LoadImageData(info.images)
        results = process.Results1288(process.Data1288(images.data).data)
        dark = math.sqrt(READ**2 + 1 / 12 / GAIN**2)
        rows = [
            ("K, DN/e", results.K, GAIN, 0.01),
            ("dark noise, e", results.sigma_d, dark, 0.02),
            ("quantum efficiency, %", results.QE, 100 * EFFICIENCY, 0.01),
            ("saturation, e", results.u_e_sat, WELL, 0.05),
            ("DSNU, e", results.DSNU1288, DSNU, 0.05),
            ("PRNU, %", results.PRNU1288, 100 * PRNU, 0.05),
        ]
        good = True
        for name, found, true, tolerance in rows:
            fine = abs(found - true) <= tolerance * true
            good &= fine
            print(f"{name:24} {found:10.4f} {true:10.4f} {'' if fine else 'differs'}")
        print(f"{'linearity error, %':24} {results.LE_min:10.4f} {results.LE_max:10.4f}")
        return 0 if good else 1


sys.exit(main())
