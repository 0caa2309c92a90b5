#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders the reference images with Mitsuba 3 in spectral mode (needs mitsuba, numpy, OpenEXR).

    make_references.py SCENE.xml|FOLDER ... [-D k=v ...] [--name NAME]   add or replace references
    make_references.py [--only 'filter-*' ...]                          render again what the index lists

Every scene is rendered R times with independent seeds. NAME.exr (float32, ZIP) holds R, G, B, the mean over the
replicates, and variance.R, variance.G, variance.B, the variance of that mean (sample variance / R); channels of an
integrator with one nested in it (aov, moment) follow likewise. The index
references.json lists name, scene, overrides, spp (of one replicate) and replicates. A scene outside the repository
must lie under --shared; it is listed as shared:<path below it>.

Mitsuba's spectral mode interpolates shapes of spectra and their scales apart in an envmap (docs/mitsuba.md). So maps are
given to it with their bilinear interpolant sampled at further points, 9 times as many columns and 8 times as many rows:
the interpolant is the same, and between neighbours that differ little that fault is small.
"""
import argparse
import fnmatch
import json
import os
import re
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenEXR

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("scenes", nargs="*", type=Path, help="scene files, or folders of them")
    p.add_argument("-o", "--out", type=Path, default=HERE, help="where the images and the index go")
    p.add_argument("-r", "--replicates", type=int, help="renders of each scene (default: 32, or the index's)")
    p.add_argument("--spp", type=int, help="samples per pixel of one replicate (default: the scene's, or the index's)")
    p.add_argument("-D", dest="overrides", metavar="k=v", action="append", default=[], help="scene parameter")
    p.add_argument("--name", help="name of the reference (one scene only; default: the file's)")
    p.add_argument("--shared", type=Path, help="the folder that shared: stands for")
    p.add_argument("--only", metavar="GLOB", action="append", help="with no scenes: which references of the index")
    p.add_argument("--variant", default="llvm_ad_spectral")
    p.add_argument("--threads", type=int, default=1)
    a = p.parse_args()
    if a.name and (len(a.scenes) != 1 or a.scenes[0].is_dir()):
        p.error("--name needs exactly one scene file")
    if (a.overrides or a.name) and not a.scenes:
        p.error("-D and --name need a scene; the index has its own overrides")
    if a.replicates is not None and a.replicates < 2:
        p.error("a variance needs two replicates or more")
    for o in a.overrides:
        if "=" not in o:
            p.error(f"-D {o}: expected k=v")
    return a


def locate(reference, shared):
    if not reference.startswith("shared:"):
        return REPOSITORY / reference
    if shared is None:
        sys.exit(f"{reference}: give --shared")
    return shared.resolve() / reference[len("shared:"):]


def describe(path, shared):
    path = path.resolve()
    if path.is_relative_to(REPOSITORY):
        return path.relative_to(REPOSITORY).as_posix()
    if shared and path.is_relative_to(shared.resolve()):
        return "shared:" + path.relative_to(shared.resolve()).as_posix()
    sys.exit(f"{path}: outside the repository and outside --shared")


def jobs(a, index):
    """(entry, path, spp or None for the scene's own)."""
    if not a.scenes:
        for entry in index.values():
            if not a.only or any(fnmatch.fnmatch(entry["name"], g) for g in a.only):
                entry = dict(entry, replicates=a.replicates or entry["replicates"])
                yield entry, locate(entry["scene"], a.shared), a.spp or entry["spp"]
        return
    for given in a.scenes:
        for path in sorted(given.glob("*.xml")) if given.is_dir() else [given]:
            entry = {"name": a.name or path.stem, "scene": describe(path, a.shared), "overrides": a.overrides,
                     "spp": None, "replicates": a.replicates or 32}
            yield entry, path, a.spp


def refined(mi, file, folder):
    """Writes an environment map with further samples of its interpolant into `folder`; returns the new file's name."""
    rgb = np.array(mi.Bitmap(str(file)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False), dtype=np.float64)
    height, width = rgb.shape[:2]

    def between(values, axis, at, periodic):
        low = np.floor(at).astype(int)
        size, part = values.shape[axis], np.expand_dims(at - low, tuple(a for a in range(3) if a != axis))
        index = (lambda i: i % size) if periodic else (lambda i: np.minimum(i, size - 1))
        return np.take(values, index(low), axis) * (1 - part) + np.take(values, index(low + 1), axis) * part

    columns = (np.arange(9 * width) + 0.5) / 9 - 0.5  # texels are centred in azimuth, the first and last rows are the poles
    rows = np.arange(8 * (height - 1) + 1) / 8
    fine = between(between(rgb, 1, columns, True), 0, rows, False)
    name = Path(folder) / (file.stem + "-refined.exr")
    mi.Bitmap(fine.astype(np.float32)).write(str(name))
    return name


def load(mi, path, overrides, folder):
    """Loads a scene, with refined environment maps if the variant is spectral."""
    parameters = dict(o.split("=", 1) for o in overrides)
    text = path.read_text()
    pattern = re.compile(r'(<emitter type="envmap"[^>]*>.*?<string name="filename" value=")([^"]*)(")', re.DOTALL)
    # optimize=False: the shapes as in the file, without merging meshes (which fails where two differ in flip_normals).
    if "spectral" not in mi.variant() or not pattern.search(text):
        return mi.load_file(str(path), parallel=False, optimize=False, **parameters)
    text = pattern.sub(lambda m: m[1] + str(refined(mi, path.parent / m[2], folder)) + m[3], text)
    mi.file_resolver().append(str(path.parent))
    return mi.load_string(text, parallel=False, optimize=False, **parameters)


def render(mi, path, overrides, spp, replicates, threads):
    """Names of channels, mean, variance of the mean, samples per pixel, largest studentised deviation per pixel."""
    import drjit
    drjit.set_thread_count(max(2, threads))  # with one, Mitsuba 3.9.1 waits for ever when it reads an EXR
    with tempfile.TemporaryDirectory() as folder:
        scene = load(mi, path, overrides, folder)
    drjit.set_thread_count(threads)
    spp = spp or scene.sensors()[0].sampler().sample_count()
    images = np.stack([np.array(mi.render(scene, spp=spp, seed=i), dtype=np.float64) for i in range(replicates)])
    # After the picture come AOVs, which aov_names() lists last.
    further = images.shape[-1] - 3 if scene.integrator().aov_names() else 0
    names = ["R", "G", "B"] + (scene.integrator().aov_names()[-further:] if further else [])
    images = images[..., :len(names)]
    if not np.isfinite(images).all():
        sys.exit(f"{path}: not finite")
    mean, sigma = images.mean(0), images.std(0, ddof=1)
    outlier = np.abs(images - mean).max(0) / np.where(sigma > 0, sigma, np.inf)
    return names, mean, sigma**2 / replicates, spp, outlier


def write(path, names, mean, variance, header):
    channels = {n: mean[..., i] for i, n in enumerate(names)}
    channels |= {"variance." + n: variance[..., i] for i, n in enumerate(names)}
    header = {k: str(v) for k, v in header.items()}
    header |= {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    temporary = path.with_suffix(".part.exr")
    with OpenEXR.File(header, {k: np.ascontiguousarray(v, np.float32) for k, v in channels.items()}) as f:
        f.write(str(temporary))
    os.replace(temporary, path)


def main():
    a = arguments()
    import mitsuba as mi
    mi.set_variant(a.variant)
    mi.set_log_level(mi.LogLevel.Warn)

    a.out.mkdir(parents=True, exist_ok=True)
    index_file = a.out / "references.json"
    index = {e["name"]: e for e in json.loads(index_file.read_text())} if index_file.exists() else {}
    for entry, path, spp in list(jobs(a, index)):
        wall, cpu = time.time(), time.process_time()
        names, mean, variance, entry["spp"], outlier = render(mi, path, entry["overrides"], spp,
                                                              entry["replicates"], a.threads)
        write(a.out / (entry["name"] + ".exr"), names, mean, variance,
              {"scene": entry["scene"], "name": entry["name"], "mitsuba": mi.__version__, "variant": a.variant,
               "spp": entry["spp"], "replicates": entry["replicates"], "overrides": " ".join(entry["overrides"])})
        index[entry["name"]] = entry
        lines = ",\n".join(" " + json.dumps(index[n]) for n in sorted(index))
        index_file.write_text(f"[\n{lines}\n]\n")
        # Noise of the reference where it is not black, and pixels that one replicate dominates (fireflies).
        lit = mean > 0.02 * mean.mean()
        noise = np.sqrt(variance[lit]) / mean[lit]
        print(f"{entry['name']:28} {entry['spp']:6} x {entry['replicates']}  mean {mean.mean():8.4f}  noise median "
              f"{np.median(noise):.4f} max {noise.max():.4f}  outliers {(outlier > 4.5).mean():.4f}  "
              f"{time.process_time() - cpu:5.1f} s cpu {time.time() - wall:5.1f} s", flush=True)


if __name__ == "__main__":
    main()
