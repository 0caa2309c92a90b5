#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write synthetic .bsdf files of all kinds, and what Mitsuba 3 computes with them.

    python make_synthetic.py [BRUSHED]

Needs mitsuba 3.9 and numpy (PyPI). Tables are smooth random functions: no surface has them, so that every table, axis
and order of axes matters to the values. The files NAME.bsdf and reference.txt are written beside this script. Lines of
reference.txt: file, wi (3), wo (3), pdf, values (4 wavelengths 412.5, 500, 587.3, 731 nm, or red, green, blue, 0).
BRUSHED is a file of three wavelengths, which is written again as the file of red, green and blue brushed_rgb.bsdf:

    aureole convert-bsdf scenes/measured/materials.xml#brushed_copper BRUSHED --angles 7 --azimuths 13 --resolution 6 \\
        --normals 16 --step 235
"""
import math
import pathlib
import sys

import mitsuba as mi
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
NM = [412.5, 500.0, 587.3, 731.0]


def smooth(rng, shape, low, high):
    """Random values, averaged with their neighbours along the last two axes."""
    values = rng.uniform(low, high, shape)
    for axis in (-1, -2):
        padded = np.concatenate([np.take(values, [0], axis), values, np.take(values, [-1], axis)], axis)
        n = values.shape[axis]
        values = (np.take(padded, range(n), axis) + np.take(padded, range(1, n + 1), axis)
                  + np.take(padded, range(2, n + 2), axis)) / 3
    return values.astype(np.float32)


def write(name, seed, phi, theta, nm, relative):
    rng = np.random.default_rng(seed)
    n, channels = 6, len(nm) if nm else 3
    sigma = smooth(rng, (9, 8), 0.3, 1)
    if len(phi) == 1:
        sigma[:] = sigma[0]  # the projected area of an isotropic surface is the same from all azimuths
    slices = (len(phi), len(theta))
    fields = {
        "description": f"synthetic {name}",
        "phi_i": np.array(phi, np.float32),
        "theta_i": np.array(theta, np.float32),
        "sigma": sigma,
        "ndf": smooth(rng, (10, 9), 0.2, 3),
        # No half vectors per area of the square lie at u = 0.
        "vndf": smooth(rng, (*slices, 11, 8), 0.2, 2) * np.linspace(0, 1, 8, dtype=np.float32)**3,
        "luminance": smooth(rng, (*slices, n, n), 0.1, 1),
        "jacobian": np.array([relative], np.uint8),
    }
    if nm:
        fields["wavelengths"] = np.array(nm, np.float32)
    fields["spectra" if nm else "rgb"] = smooth(rng, (*slices, channels, n, n), 0.01, 0.2)
    mi.tensor_io.write(str(HERE / f"{name}.bsdf"), **fields)


def direction(rng):
    z, phi = rng.uniform(0.05, 1), rng.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return [r * math.cos(phi), r * math.sin(phi), z]


def main():
    pi = math.pi
    theta = [0, 0.35, 0.8, 1.2, 1.5]
    nm = [360, 430, 470.5, 520, 600, 700, 1000]
    kinds = {
        "isotropic_spectral": (1, [0.0], theta, nm, 1),
        "anisotropic_spectral": (2, list(np.linspace(-pi, 0, 5)), theta, nm, 1),
        "isotropic_rgb": (3, [0.0], theta, None, 1),
        "anisotropic_rgb": (4, list(np.linspace(-pi, -pi / 2, 4)), theta[:4], None, 1),
        "full_circle": (5, list(np.linspace(-pi, pi, 6)), theta[:3], nm[:5], 0),
    }
    lines = []
    for name, arguments in kinds.items():
        write(name, *arguments)
        spectral = arguments[3] is not None
        mi.set_variant("scalar_spectral" if spectral else "scalar_rgb")
        bsdf = mi.load_dict({"type": "measured", "filename": str(HERE / f"{name}.bsdf")})
        rng = np.random.default_rng(17)
        si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
        for _ in range(40):
            wi, wo = direction(rng), direction(rng)
            si.wi = wi
            if spectral:
                si.wavelengths = NM
            value = [float(x) for x in bsdf.eval(context, si, wo)]
            numbers = wi + wo + [float(bsdf.pdf(context, si, wo))] + (value if spectral else value[:3] + [0.0])
            lines.append(name + " " + " ".join(f"{x:.9g}" for x in numbers))
    (HERE / "reference.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    mi.set_variant("scalar_spectral")
    if len(sys.argv) > 1:
        fields = mi.tensor_io.read(sys.argv[1])
        fields["rgb"] = fields.pop("spectra")[:, :, ::-1]
        del fields["wavelengths"]
        mi.tensor_io.write(str(HERE / "brushed_rgb.bsdf"), **fields)
    main()
