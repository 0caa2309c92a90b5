# SPDX-License-Identifier: Apache-2.0
"""`powermap`: received power on a plane or a shape, in the units of radio engineering."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, flag, integer, real, scalar, text
from ._bars import LoadBar, Report
from ._errors import Error
from ._image import Image
from ._instrument_support import Words, defines_of
from ._render import render
from ._results import Table
from ._scene import Scene
from ._wording import python_names

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PowerMap(Table):
    """Result of `powermap`: the map of one band. Arrays have the shape (height, width), with rows from the top.

    Attributes
    ----------
    channel, band : str
        The film's channel, and its frequency or wavelength in words.
    min_nm, max_nm, wavelength : float
        Range of the band in nm, and its mean wavelength in m.
    power : float
        Of all emitters in the band, in W.
    density : numpy.ndarray
        Power per area in W/m^2.
    free_space : numpy.ndarray
        The density without any shape.
    relative_db : numpy.ndarray
        Density over `free_space` in dB; -inf without power, NaN where free space would have none.
    received_dbm : numpy.ndarray
        What an isotropic antenna receives, in dBm.
    error_db : numpy.ndarray or None
        Standard error of both in dB; None for a map of one replicate.
    image : Image
        The picture that was rendered.
    """

    channel: str
    band: str
    min_nm: float
    max_nm: float
    wavelength: float
    power: float
    density: Reals = field(repr=False)
    free_space: Reals = field(repr=False)
    relative_db: Reals = field(repr=False)
    received_dbm: Reals = field(repr=False)
    error_db: Optional[Reals] = field(repr=False)
    image: Image = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """A row for each cell, with its column x and row y."""
        y, x = np.indices(self.density.shape)
        quantities: Dict[str, Any] = {
            "x": x,
            "y": y,
            "density_W_per_m2": self.density,
            "free_space_W_per_m2": self.free_space,
            "relative_dB": self.relative_db,
            "received_dBm": self.received_dbm,
        }
        if self.error_db is not None:
            quantities["error_dB"] = self.error_db
        return {name: np.reshape(values, -1) for name, values in quantities.items()}

    def plot(self, ax: Any = None, *, show: str = "relative") -> Any:
        """The map in colours.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        show : {"relative", "dBm"}
            In dB relative to free space, or in dBm.

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for

        if text("show", show) not in ("relative", "dBm"):
            raise Error(f'show: expected "relative" or "dBm", got {show!r}')
        values = self.relative_db if show == "relative" else self.received_dbm
        axes = axes_for(ax)
        finite = values[np.isfinite(values)]
        low, high = np.percentile(finite, [1, 99]) if finite.size else (-1.0, 1.0)
        drawn = axes.imshow(np.where(np.isfinite(values), values, np.nan), vmin=max(low, high - 60), vmax=high)
        axes.figure.colorbar(drawn, ax=axes, label="dB re free space" if show == "relative" else "dBm, isotropic antenna")
        axes.set(title=f"{self.band}, {self.power:.4g} W")
        axes.set_axis_off()
        return axes

    def _title(self) -> str:
        lit = np.isfinite(self.received_dbm)
        median = f", median {np.median(self.received_dbm[lit]):.2f} dBm" if np.any(lit) else ""
        return f"{self.band}: {self.power:.6g} W, power in {np.count_nonzero(self.density > 0)} of {self.density.size} cells{median}"


def powermap(
    scene: "Union[Scene, str, os.PathLike[str]]",
    spp: Optional[int] = None,
    *,
    power: "Union[float, str, None]" = None,
    seed: Optional[int] = None,
    threads: int = 0,
    time: float = 0.0,
    replicates: int = 1,
    integrator: str = "",
    max_depth: Optional[int] = None,
    diffraction: bool = False,
    diffraction_model: str = "",
    polarisation: str = "",
    plane: Optional[Sequence[float]] = None,
    size: Optional[Sequence[float]] = None,
    normal: Optional[Sequence[float]] = None,
    cell: float = 0.0,
    frequency: str = "",
    transmitters: Any = (),
    defines: Optional[Mapping[str, Any]] = None,
    client: Any = None,
    image: Optional[Image] = None,
    progress: Union[bool, Report] = True,
) -> List[PowerMap]:
    """Power on a plane or a shape, a map for each band of the film: `aureole powermap`.

    Parameters
    ----------
    scene : Scene, or str or path
        With a sensor that is a powermap; a path with `plane` may be any scene.
    spp, seed, threads, time, replicates, progress
        As for `render`.
    power : float or str, optional
        Of all emitters in the band, in W or with its unit ("500mW", "33dBm"); by default the scene's.
    integrator, max_depth, diffraction, diffraction_model
        Of a path: replace the scene's integrator or its parameters; edges diffract ("segments", the default, or "beams").
    polarisation : str
        Of light that edges diffract, with "segments": "none", "soft", "hard" or "both"; by default the scene's.
    plane, normal : (float, float, float), optional
        Centre and normal (by default z) of a map on a plane, instead of the scene's sensor. BSDFs with ids such as
        mat-itu_concrete become slabs of that material.
    size : (float, float), optional
        Width and height of the plane, in the scene's units.
    cell : float
        Side of a cell; 0: 200 cells along the longer side.
    frequency : str
        Of a map on a plane, with its unit ("3.5GHz"), or a wavelength.
    transmitters : rows of (float, float, float)
        Isotropic transmitters of 1 W that are added.
    defines : dict, optional
        Values of the $names of a path's file.
    client : dask.distributed.Client, optional
        Its workers render (`aureole.cluster.render`).
    image : Image, optional
        A picture of this scene that was rendered before, whose power is mapped without another render.

    Returns
    -------
    list of PowerMap
    """
    if client is not None and image is not None:
        raise Error("image: expected either a picture or a client that renders one")
    opened = _opened(
        scene,
        integrator,
        max_depth,
        diffraction,
        diffraction_model,
        polarisation,
        plane,
        normal,
        size,
        transmitters,
        frequency,
        cell,
        defines,
        progress is not False,
    )
    watts = (
        ""
        if power is None
        else text("power", power) if isinstance(power, str) else f"{scalar('power', power, positive=True, unit='W'):.17g}W"
    )
    with Words():
        _aureole.require_power_map(opened._open)
    if image is None:
        image = _rendered(opened, client, spp, seed, threads, time, replicates, progress)
    elif not isinstance(image, Image):
        raise TypeError(f"image: expected an Image, got {type(image).__name__}")
    try:
        found = _aureole.power_maps(opened._open, image._picture, watts)
    except Error as e:
        raise opened._in_words(Error(f"power: {e}" if watts and str(e).startswith('"') else str(e))) from None
    return [_map(one, image) for one in found]


def _map(one: Mapping[str, Any], image: Image) -> PowerMap:
    def grid(key: str) -> Reals:
        return np.array(one[key], dtype=np.float64).reshape(one["height"], one["width"])

    return PowerMap(
        one["channel"],
        one["band"],
        one["min_nm"],
        one["max_nm"],
        one["wavelength"],
        one["power"],
        grid("density"),
        grid("free_space"),
        grid("relative_db"),
        grid("received_dbm"),
        grid("error_db") if one["error"] else None,
        image,
    )


def _rendered(
    scene: Scene,
    client: Any,
    spp: Optional[int],
    seed: Optional[int],
    threads: int,
    time: float,
    replicates: int,
    progress: Union[bool, Report],
) -> Image:
    if client is None:
        return render(scene, spp, seed=seed, threads=threads, time=time, replicates=replicates, progress=progress)
    from . import cluster

    if time:
        raise Error("time: a cluster renders all samples: expected 0")
    return cluster.render(
        scene, client, spp, seed=seed, replicates=replicates, threads=max(1, integer("threads", threads, minimum=0)), progress=progress
    )


def _opened(
    scene: Any,
    integrator: str,
    max_depth: Optional[int],
    diffraction: bool,
    diffraction_model: str,
    polarisation: str,
    plane: Any,
    normal: Any,
    size: Any,
    transmitters: Any,
    frequency: str,
    cell: float,
    defines: Optional[Mapping[str, Any]],
    shows_progress: bool,
) -> Scene:
    lists = {}
    for name, value, count in (("plane", plane, 3), ("normal", normal, 3), ("size", size, 2)):
        numbers = real(name, [] if value is None else value, minimum=-1e12, maximum=1e12)
        if value is not None and numbers.shape != (count,):
            raise Error(f"{name}: expected {count} numbers, got an array of shape {numbers.shape}")
        lists[name] = [float(v) for v in numbers.reshape(-1)]
    places = np.atleast_2d(real("transmitters", transmitters, minimum=-1e12, maximum=1e12)) if np.size(transmitters) else np.empty((0, 3))
    if places.ndim != 2 or places.shape[1] != 3:
        raise Error(f"transmitters: expected rows of three numbers, got an array of shape {places.shape}")
    model = text("diffraction_model", diffraction_model)
    if model not in ("", "beams", "segments"):
        raise Error(f'diffraction_model: expected "beams" or "segments", got {model!r}')
    of_field = text("polarisation", polarisation)
    if of_field not in ("", "none", "soft", "hard", "both"):
        raise Error(f'polarisation: expected "none", "soft", "hard" or "both", got {of_field!r}')
    depth = None if max_depth is None else integer("max_depth", max_depth, minimum=-1, maximum=2**31 - 1)
    options = (
        text("integrator", integrator),
        depth,
        flag("diffraction", diffraction),
        model,
        of_field,
        lists["plane"],
        lists["normal"],
        lists["size"],
        [float(v) for v in places.reshape(-1)],
        text("frequency", frequency),
        scalar("cell", cell, minimum=0),
    )
    if isinstance(scene, Scene):
        if any(option not in ("", None, False, 0.0) and option != [] for option in options) or defines is not None:
            raise Error("scene: the integrator, a plane, transmitters and defines need the path of a scene, not a Scene")
        return scene
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene: expected a Scene or a path, got {type(scene).__name__}")
    with Words(), LoadBar(os.path.basename(scene), shows_progress):
        opened, notes = _aureole.load_power_map(file_path("scene", scene), defines_of(defines), *options)
    result = Scene(opened)
    for note in [*result.notes, *notes]:
        warnings.warn(python_names(note), stacklevel=3)
    return result


__all__ = ["PowerMap", "powermap"]
