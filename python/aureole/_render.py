# SPDX-License-Identifier: Apache-2.0
"""Rendering: one call for a picture, and an iterator over its refinements."""
from __future__ import annotations

import warnings
from typing import Iterator, Optional, Union

from . import _aureole, _denoise
from ._arrays import flag, integer, scalar
from ._bars import RenderBar, Report
from ._errors import Error
from ._image import Image
from ._scene import Scene

_BLOCK = 16  # samples of a unit of work; refinements consist of whole units


class InterruptedWarning(UserWarning):
    """A render was stopped by Ctrl-C; the picture holds what was done."""


def render(scene: Scene, spp: Optional[int] = None, *, seed: Optional[int] = None, threads: int = 0, time: float = 0.0,
           replicates: int = 1, adaptive: Optional[str] = None, progress: Union[bool, Report] = True,
           start: Optional[Image] = None, denoise: bool = False) -> Image:
    """Renders a picture: the same bits as the command line's for the same scene, samples and seed.

    Ctrl-C stops the render and returns the unfinished picture (`Image.complete` is then False, and an `InterruptedWarning` is
    given); a second one raises KeyboardInterrupt. Other Python threads run meanwhile.

    Parameters
    ----------
    scene : Scene
    spp : int, optional
        Samples per pixel; by default the scene's.
    seed : int, optional
        Seed of the samples; by default the scene's.
    threads : int
        0 for all cores; the picture does not depend on it.
    time : float
        Ends after the first whole block of 16 samples after this many seconds; 0 for no limit.
    replicates : int
        Independently scrambled pictures; with two or more the image has a variance.
    adaptive : {"none", "absolute", "display", "relative"}, optional
        Pixels take half to 4 times as many samples, more where the noise is larger, at most `spp` on average: for
        small squared errors of the picture, of the picture as a display shows it, or in units of each pixel's
        brightness. By default the scene's.
    progress : bool or callable
        A bar in terminals and notebooks, or a function of (units done, units, seconds, samples per second).
    start : Image, optional
        A picture of the same scene and seed that is continued: only missing samples are rendered.
    denoise : bool
        Removes noise by Open Image Denoise (`aureole.denoise`). The film gets a box filter, albedos and normals of the first surfaces that are
        no mirrors or glass are rendered with the picture, and without `replicates` the samples are divided among 2 to 4 of them. The image
        keeps the noisy channels as the layer "noisy", and the features.

    Returns
    -------
    Image
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene (from load_file, load_string or load_dict), got {type(scene).__name__}")
    if spp is not None:
        spp = integer("spp", spp, minimum=1, maximum=2**32)
    if seed is not None:
        seed = integer("seed", seed, minimum=0, maximum=2**64 - 1)
    threads = integer("threads", threads, minimum=0, maximum=4096)
    replicates = integer("replicates", replicates, minimum=1, maximum=2**20)
    limit = scalar("time", time, minimum=0)
    if adaptive is not None and not isinstance(adaptive, str):
        raise TypeError(f"adaptive: expected a string, got {type(adaptive).__name__}")
    if flag("denoise", denoise):
        if start is not None:
            raise Error("start: a picture that is denoised can't be continued")
        _denoise.network()
    if start is not None and not isinstance(start, Image):
        raise TypeError(f"start: expected an Image, got {type(start).__name__}")
    with RenderBar(progress) as report:
        try:
            picture, outcome = _aureole.render(scene._open, 0, spp, seed, threads, replicates, limit, adaptive,
                                               start._picture if start is not None else None, report, None, denoise)
        except Error as e:
            raise scene._in_words(e) from None
    image = Image._of(picture, outcome)
    if denoise and image.complete:
        return _denoise.denoise(image)
    if outcome == "interrupted":
        part = 100 * float(image.info["part"])
        warnings.warn(f"the render was interrupted at {part:.1f} %: the picture holds what was done "
                      f"({image.samples} samples in every pixel); go on with render(scene, ..., start=image)",
                      InterruptedWarning, stacklevel=2)
    return image


def render_iter(scene: Scene, spp: Optional[int] = None, *, step: Optional[int] = None, seed: Optional[int] = None,
                threads: int = 0, adaptive: Optional[str] = None, progress: Union[bool, Report] = False) -> Iterator[Image]:
    """Renders refinements of a picture, each with more samples than the one before; the last equals `render`'s.

    Parameters
    ----------
    scene, spp, seed, threads, adaptive, progress
        As for `render`.
    step : int, optional
        Samples from one picture to the next, a multiple of 16; by default their number doubles from 16.

    Yields
    ------
    Image

    Examples
    --------
    >>> for image in aureole.render_iter(scene, spp=1024):      # doctest: +SKIP
    ...     if good_enough(image):
    ...         break
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene (from load_file, load_string or load_dict), got {type(scene).__name__}")
    end = scene.sample_count if spp is None else integer("spp", spp, minimum=1, maximum=2**32)
    if step is not None:
        step = integer("step", step, minimum=1)
        if step % _BLOCK:
            raise Error(f"step: expected a multiple of {_BLOCK}, got {step}")
    return _refinements(scene, end, step, seed, threads, adaptive, progress)


def _refinements(scene: Scene, end: int, step: Optional[int], seed: Optional[int], threads: int,
                 adaptive: Optional[str], progress: Union[bool, Report]) -> Iterator[Image]:
    image: Optional[Image] = None
    samples = 0
    while samples < end:
        samples = min(end, samples + (step or max(_BLOCK, samples)))
        image = render(scene, samples, seed=seed, threads=threads, adaptive=adaptive, progress=progress, start=image)
        yield image
        if not image.complete:
            return


__all__ = ["InterruptedWarning", "render", "render_iter"]
