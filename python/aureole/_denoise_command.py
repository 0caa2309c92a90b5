# SPDX-License-Identifier: Apache-2.0
"""`aureole denoise`: a picture without noise, or a scene that is rendered for it."""

from __future__ import annotations

import argparse
import os
import sys
import xml.etree.ElementTree as ElementTree
from typing import Any, Optional, Sequence

from ._command_faces import defines_of, exit_code_of
from ._errors import Error


def main(words: Optional[Sequence[str]] = None) -> int:
    """Runs the command with `words`, by default the process's arguments, and returns its exit code."""
    if list(sys.argv[1:] if words is None else words) == ["--check"]:  # asked by `aureole render --denoise`
        return exit_code_of(_check, None, "")
    parser = argparse.ArgumentParser(
        prog="aureole denoise",
        description="Remove noise by Intel Open Image Denoise (docs/pictures.md): of an EXR, or of a scene that is rendered for it.",
    )
    parser.add_argument("input", help="EXR with linear values, or a scene file (.xml)")
    parser.add_argument(
        "-o", "--output", required=True, help="EXR to write, with the noisy channels as the layer noisy; a PNG is written beside it"
    )
    parser.add_argument("--scene", help="of an EXR: its scene, whose albedos and normals guide the network")
    parser.add_argument("-D", "--define", action="append", default=[], metavar="NAME=VALUE", help="set a $name of the scene")
    parser.add_argument("--spp", type=int, help="of a scene: samples per pixel of each replicate (default: the scene's)")
    parser.add_argument(
        "--replicates", type=int, default=4, help="of a scene: independent renderings, for the variance that keeps clean pixels (default 4)"
    )
    parser.add_argument("--seed", type=int, help="of a scene: seed of the samples")
    parser.add_argument("--feature-spp", type=int, default=32, help="samples per pixel of albedos and normals (default 32)")
    parser.add_argument("--quality", choices=["high", "balanced", "fast"], default="high")
    parser.add_argument("--tonemap", help="of the PNG, as for aureole render: asinh:C:E (default: only highlights are compressed)")
    parser.add_argument("--no-mix", action="store_true", help="take the network's picture also where the noisy one is better")
    parser.add_argument("--cache", help="folder that keeps slow tables for the next start, or off (default: AUREOLE_CACHE, or ~/.cache/aureole)")
    parser.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    arguments = parser.parse_args(words)
    return exit_code_of(_denoise, arguments, "interrupted: no picture is written")


def _check(_: Any) -> int:
    """Whether pictures can be denoised here; else an Error."""
    from ._denoise import network

    network()
    return 0


def _denoise(a: Any) -> int:
    from . import cache
    from ._denoise import denoise, set_box_filter
    from ._image import convert, read_image
    from ._render import render
    from ._scene import load_file, load_string

    if not a.output.lower().endswith(".exr"):
        raise Error(f"-o {a.output}: the output is an .exr file (a .png is written beside it)")
    defines = defines_of(a.define)
    if a.cache is not None:
        cache.use(a.cache)
    scene = None
    if a.input.lower().endswith(".xml"):
        if a.scene:
            raise Error("--scene: is for an EXR; a scene is its own")
        root = ElementTree.fromstring(load_file(a.input, **defines).xml())
        set_box_filter(root)
        scene = load_string(ElementTree.tostring(root, encoding="unicode"), path=os.path.abspath(a.input))
        image = render(scene, a.spp, seed=a.seed, replicates=a.replicates, progress=not a.quiet)
        if not image.complete:
            return 1
    else:
        for option, value in (("--spp", a.spp), ("--seed", a.seed)):
            if value is not None:
                raise Error(f"{option}: is for a scene")
        image = read_image(a.input)
        if a.scene:
            scene = load_file(a.scene, **defines)
        elif defines:
            raise Error("-D sets names of scenes: give the picture's --scene")
    result = denoise(image, scene=scene, feature_samples=a.feature_spp, quality=a.quality, keep_clean=not a.no_mix, progress=not a.quiet)
    result.save(a.output)
    if any(c in result.channels for c in ("R", "Y")):
        convert(a.output, os.path.splitext(a.output)[0] + ".png", tonemap=a.tonemap)
    if not a.quiet:
        print(a.output)
    return 0
