# SPDX-License-Identifier: Apache-2.0
"""`expose`: the raw pictures that the sensor of a digital camera reads."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, integer, scalar, text
from ._errors import Error
from ._image import Image
from ._instrument_support import Picture, Words, rendered_or_read
from ._bars import Report
from ._results import Table
from ._scene import Scene

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ExposureData(Table):
    """Result of `expose`.

    Attributes
    ----------
    exposure : float
        In s.
    electrons : numpy.ndarray of shape (height, width)
        Mean numbers of electrons that light frees.
    frames : list of numpy.ndarray of uint16, shape (height, width)
        Digital numbers, as the sensor reads them.
    black_level, white_level : float
        Digital numbers without light and at saturation.
    gain : float
        Digital numbers per electron.
    saturation : float
        Electrons at which a pixel or the converter is full.
    signal_to_noise : float
        At the mean number of electrons.
    dark_noise : float
        Standard deviation without light, in electrons.
    mosaic : numpy.ndarray of uint8
        The cell of colour filters that repeats: 0 red, 1 green, 2 blue; a single 0 has none.
    to_xyz : numpy.ndarray of shape (3, 3) or None
        From the sensor's R, G, B, balanced so that white is 1, to CIE XYZ, fitted on a virtual ColorChecker under D65.
    white : numpy.ndarray of shape (3,)
        The sensor's R, G, B of a white surface under D65; the largest is 1.
    delta_e : numpy.ndarray
        CIEDE2000 of the 24 patches; empty without colours.
    image : Image
        The picture that was rendered or read.
    """

    exposure: float
    electrons: Reals = field(repr=False)
    frames: "List[npt.NDArray[np.uint16]]" = field(repr=False)
    black_level: float
    white_level: float
    gain: float
    saturation: float
    signal_to_noise: float
    dark_noise: float
    mosaic: "npt.NDArray[np.uint8]" = field(repr=False)
    to_xyz: Optional[Reals] = field(repr=False)
    white: Reals = field(repr=False)
    delta_e: Reals = field(repr=False)
    image: Image = field(repr=False)
    _raw: Sequence[Any] = field(repr=False)

    def save(self, path: "str | os.PathLike[str]", frame: int = 0) -> None:
        """Writes a frame as .dng or as a 16-bit .tif, atomically.

        Parameters
        ----------
        path : path-like
        frame : int
            Index of the frame.
        """
        name = file_path("path", path)
        index = integer("frame", frame, minimum=0, maximum=len(self._raw) - 1)
        ending = os.path.splitext(name)[1].lower()
        if ending not in (".dng", ".tif", ".tiff"):
            raise Error(f'path: expected a name that ends with ".dng" or ".tif", got {name!r}')
        raw = self._raw[index]
        raw.write_dng(name) if ending == ".dng" else raw.write_tiff(name)

    def columns(self) -> Dict[str, Any]:
        """A row for each frame: mean and standard deviation of its digital numbers, and the fraction that is saturated."""
        return {
            "frame": np.arange(len(self.frames)),
            "mean_dn": np.array([f.mean() for f in self.frames]),
            "standard_deviation_dn": np.array([f.std() for f in self.frames]),
            "saturated": np.array([np.mean(f >= self.white_level) for f in self.frames]),
        }

    def plot(self, ax: Any = None, *, frame: int = 0) -> Any:
        """A frame in grey, from the black level to the largest of all but a thousandth of the pixels.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        frame : int

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for

        values = self.frames[integer("frame", frame, minimum=0, maximum=len(self.frames) - 1)]
        axes = axes_for(ax)
        brightest = max(float(np.quantile(values, 0.999)), self.black_level + 1)
        drawn = axes.imshow(values, cmap="gray", vmin=self.black_level, vmax=brightest)
        axes.figure.colorbar(drawn, ax=axes, label="digital number")
        axes.set_axis_off()
        return axes

    def _title(self) -> str:
        title = f"{self.exposure:g} s: {self.electrons.mean():.5g} electrons in the mean, full at {self.saturation:.5g}"
        if self.delta_e.size:
            title += f"\nCIEDE2000 of 24 patches: {self.delta_e.mean():.2f} in the mean, {self.delta_e.max():.2f} at most"
        return title


def expose(
    target: "Union[Scene, Picture]",
    spp: Optional[int] = None,
    *,
    camera: "Union[Mapping[str, Any], str, os.PathLike[str], None]" = None,
    exposure: Optional[float] = None,
    frames: int = 1,
    sensor: int = 1,
    frame: int = 1,
    seed: Optional[int] = None,
    threads: int = 0,
    defines: Optional[Mapping[str, Any]] = None,
    progress: Union[bool, Report] = True,
    **keys: Any,
) -> ExposureData:
    """The raw pictures of a digital camera (EMVA 1288): `aureole expose`.

    Parameters
    ----------
    target : Scene, Image, or str or path
        A scene (.xml), which is rendered, or a picture, of a "specfilm" with spectral bins.
    spp, seed, threads, progress
        As for `render`, of a scene.
    camera : dict, or str or path, optional
        Keys of a camera's file (docs/camera.md), or that file (.json).
    exposure : float, optional
        In s; by default from `shutter_open` to `shutter_close` of the scene.
    frames : int
        How many are read.
    sensor, frame : int
        Numbers of the sensor, which has its own fixed pattern, and of the first frame, which has its own noise.
    defines : dict, optional
        Values of the $names of the file.
    **keys
        Keys that replace those of the camera: `f_number`, `gain`, `read_noise`, `mosaic`, ... `efficiency` is a number, the
        name of a table, or a dict of lists: "nm" with "values", or with "red", "green" and "blue".

    Returns
    -------
    ExposureData
    """
    described, file = _camera(camera, keys)
    seconds = None if exposure is None else scalar("exposure", exposure, positive=True, unit="s")
    count = integer("frames", frames, minimum=1, maximum=2**20)
    seeds = integer("sensor", sensor, minimum=0, maximum=2**63), integer("frame", frame, minimum=0, maximum=2**63)
    options = {"spp": spp, "seed": seed, "threads": threads, "progress": progress}
    image, name, scene = rendered_or_read("target", target, defines, lambda s: _aureole.exposure_of_scene(s._open), options)
    with Words():
        if seconds is None:
            seconds = 0.0 if scene is None else float(_aureole.exposure_of_scene(scene._open))
        if not seconds > 0:
            raise Error("exposure: is needed, in seconds: the target states no shutter times")
        d = _aureole.expose_picture(image._picture, name, described, file, seconds, seeds, count)
    raw = d["raw"]
    colours = len(d["delta_e"]) > 0
    return ExposureData(
        seconds,
        np.array(d["electrons"]),
        [np.asarray(one.values) for one in raw],
        float(raw[0].black_level),
        float(raw[0].white_level),
        d["gain"],
        d["saturation"],
        d["signal_to_noise"],
        d["dark_noise"],
        np.array(d["mosaic"]),
        np.array(d["to_xyz"]).reshape(3, 3) if colours else None,
        np.array(d["white"]),
        np.array(d["delta_e"]),
        image,
        raw,
    )


def _camera(camera: Any, keys: Mapping[str, Any]) -> Tuple[str, str]:
    """The camera as the text of a JSON file, and that file's name for messages and tables beside it."""
    file = "the camera"
    values: Dict[str, Any] = {}
    if isinstance(camera, (str, os.PathLike)):
        file = file_path("camera", camera)
        with Words():
            values = json.loads(_aureole.camera_of_file(file))
    elif isinstance(camera, Mapping):
        values = {text("camera", key): value for key, value in camera.items()}
    elif camera is not None:
        raise TypeError(f"camera: expected a dict or a path, got {type(camera).__name__}")
    values.update(keys)
    return json.dumps({key: _plain(key, value) for key, value in values.items()}), file


def _plain(key: str, value: Any) -> Any:
    """A value of a camera as JSON has it."""
    if isinstance(value, Mapping):
        return {text(key, name): _plain(f"{key}.{name}", entry) for name, entry in value.items()}
    if isinstance(value, (str, os.PathLike)):
        return text(key, os.fspath(value))
    if isinstance(value, (list, tuple, np.ndarray)) and np.ndim(value) > 0:
        return [scalar(key, entry) for entry in value]
    return scalar(key, value)


__all__ = ["ExposureData", "expose"]
