#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compare values and densities of .bsdf files, such as those of RGL's database, with Mitsuba 3.

    python compare_with_mitsuba.py FILE.bsdf ...

Needs mitsuba 3.9, numpy (PyPI) and the module aureole. For each file 4,000 pairs of directions are drawn, half of which are
sampled by Mitsuba. Spectra are compared at 8 wavelengths. For files in linear sRGB aureole's values at three wavelengths
are a linear map of Mitsuba's colours; the map is fitted over all pairs, and its rows must add up to one. A line has the
largest and the mean relative deviation of values, of densities, and, for colours, of the sums of the rows from one.
"""
import pathlib
import sys

import aureole
import mitsuba as mi
import numpy as np

PAIRS = 4000


def directions(rng, n):
    z, phi = rng.uniform(0.02, 1, n), rng.uniform(0, 2 * np.pi, n)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)


def by_mitsuba(file, wi, wo, nm, rng):
    bsdf = mi.load_dict({"type": "measured", "filename": str(file)})
    si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
    values, densities = [], []
    for k in range(len(wi)):
        si.wi = wi[k]
        if nm is not None:
            si.wavelengths = nm[:4]
        if k % 2:
            sample, _ = bsdf.sample(context, si, 0.5, mi.Point2f(rng.uniform(0, 1), rng.uniform(0, 1)))
            if sample.wo.z > 0.01:
                wo[k] = np.array(sample.wo, float)
        value = list(bsdf.eval(context, si, list(wo[k])))
        if nm is not None:
            si.wavelengths = nm[4:]
            value += list(bsdf.eval(context, si, list(wo[k])))
        values.append([float(v) for v in value])
        densities.append(float(bsdf.pdf(context, si, list(wo[k]))))
    return np.array(values), np.array(densities)


def main():
    for name in sys.argv[1:]:
        file = pathlib.Path(name).resolve()
        is_spectral = b"wavelengths" in file.read_bytes()[:4096]
        mi.set_variant("scalar_spectral" if is_spectral else "scalar_rgb")
        rng = np.random.default_rng(5)
        wi, wo = directions(rng, PAIRS), directions(rng, PAIRS)
        nm = [395.0, 441.7, 480.3, 520.1, 563.9, 611.2, 660.6, 720.8] if is_spectral else None
        theirs, their_pdf = by_mitsuba(file, wi, wo, nm, rng)
        bsdf = aureole.load_dict({"type": "measured", "filename": str(file)})
        at = nm if is_spectral else [450.0, 540.0, 620.0]
        ours = bsdf.eval(wi[:, None], wo[:, None], at)
        our_pdf = bsdf.pdf(wi, wo, 550.0)
        is_lit = (theirs > 1e-6).all(1) & (their_pdf > 1e-6)
        theirs, their_pdf, ours, our_pdf = theirs[is_lit], their_pdf[is_lit], ours[is_lit], our_pdf[is_lit]
        rows = ""
        if not is_spectral:
            scale = 1 / theirs.mean(1)  # relative residuals
            fit = np.linalg.lstsq(theirs * scale[:, None], ours * scale[:, None], rcond=None)[0]
            theirs = theirs @ fit
            rows = f"   rows {np.abs(fit.sum(0) - 1).max():.1e}"
        value, density = np.abs(ours / theirs - 1), np.abs(our_pdf / their_pdf - 1)
        print(f"{file.name:36} {is_lit.sum()} pairs   values {value.max():.1e} {value.mean():.1e}   "
              f"densities {density.max():.1e} {density.mean():.1e}{rows}")


if __name__ == "__main__":
    main()
