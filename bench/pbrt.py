#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`bdpt` beside the integrator of that name of pbrt-v4, which has to be installed: time and noise of pictures of equal samples.

The scenes are those of bench/two_way that have a counterpart `.pbrt`. One thread, in turns, with other seeds each time. Noise is the
variance of luminance between seeds; docs/performance.md has the definitions. Needs numpy and OpenEXR (3.3 or later)."""
import argparse
import os
import resource
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "bench" / "two_way"
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
WIDTH, HEIGHT = 96, 64
# Parameters with which ours are the scenes of pbrt: it drops wavelengths behind glass with dispersion, its microfacets are GGX's, and its
# coats are sampled at random.
DEFINES = {
    "caustic": {"dispersion": "false"},
    "indirect_room": {"distribution": "ggx", "ball": "diffuse", "ball_reflectance": "reflectance"},
}


def luminance(file):
    channels = OpenEXR.File(str(file)).channels()
    rgb = channels["RGB"].pixels if "RGB" in channels else np.stack([channels[c].pixels for c in "RGB"], -1)
    return rgb[..., :3].astype(float) @ LUMINANCE


def cpu_seconds(command):
    def used():
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime

    before = used()
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
    return used() - before


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pbrt", type=Path, help="the program")
    parser.add_argument("--aureole", type=Path, default=ROOT / "build" / "release" / "bin" / "aureole")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel, a power of 2")
    parser.add_argument("--replicates", type=int, default=8)
    parser.add_argument("--scenes", nargs="+", choices=DEFINES, default=list(DEFINES))
    a = parser.parse_args()
    print("scene | program | us per sample | mean | variance/mean^2 | relative | the median of pixels")
    for scene in a.scenes:
        defines = [part for name, value in DEFINES[scene].items() for part in ("-D", f"{name}={value}")]
        pictures, seconds = {"pbrt-v4": [], "aureole": []}, dict.fromkeys(("pbrt-v4", "aureole"), 0.0)
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out.exr"
            for seed in range(1, a.replicates + 1):
                commands = {
                    "pbrt-v4": [a.pbrt, "--quiet", "--nthreads", 1, "--spp", a.spp, "--seed", seed, "--outfile", out,
                                SCENES / f"{scene}.pbrt"],
                    "aureole": [a.aureole, "render", SCENES / f"{scene}.xml", "-D", "integrator=bdpt", *defines,
                                "--threads", 1, "--spp", a.spp, "--seed", seed, "-q", "--restart", "-o", out]}
                for program, command in commands.items():
                    seconds[program] += cpu_seconds(command) / a.replicates
                    pictures[program].append(luminance(out))
        truth = np.mean([np.mean(p, 0) for p in pictures.values()], 0)
        noise = {}
        for program, rendered in pictures.items():
            variance = np.var(rendered, 0, ddof=1)
            relative = variance / (truth**2 + (0.01 * truth.mean())**2)
            noise[program] = np.array([variance.mean() / truth.mean()**2, relative.mean(), np.median(relative)])
            time = 1e6 * seconds[program] / (WIDTH * HEIGHT * a.spp)
            print(f"{scene} | {program} | {time:.2f} | {np.mean(rendered):.5f} | " +
                  " | ".join(f"{n:.3g}" for n in noise[program]))
        gain = noise["pbrt-v4"] * seconds["pbrt-v4"] / (noise["aureole"] * seconds["aureole"])
        print(f"{scene} | efficiency over pbrt-v4 | | | " + " | ".join(f"{g:.1f}" for g in gain), flush=True)


if __name__ == "__main__":
    main()
