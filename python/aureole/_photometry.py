# SPDX-License-Identifier: Apache-2.0
"""`photometry`: statistics, glare and daylight factors of pictures in their units."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, flag, real, scalar
from ._errors import Error
from ._image import Image
from ._instrument_support import Picture, Words, defines_of, regions_of, rendered_or_read, tell
from ._bars import Report
from ._results import Table
from ._scene import Scene

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RegionStatistics:
    """Statistics of the finite values of a part of a map.

    Cells of a `powermap` on a shape count by their areas where the scene is known.

    Attributes
    ----------
    x, y, width, height : int
        In cells from the top left.
    mean, minimum, median, maximum : float
    uniformity, diversity : float
        Minimum over mean (EN 12464-1), and over the maximum.
    total : float
        Sum of the cells: of power and energy (W, lm, J, lm s), that through the region.
    """

    x: int
    y: int
    width: int
    height: int
    mean: float
    minimum: float
    median: float
    maximum: float
    uniformity: float
    diversity: float
    total: float


@dataclass(frozen=True, eq=False)
class Glare:
    """Discomfort glare by CIE 117, of a picture of the luminance.

    Attributes
    ----------
    rating : float
        UGR; -inf without sources.
    background : float
        Mean luminance of all pixels that are no sources, weighted by their projected solid angle, in cd/m^2.
    threshold : float
        Luminance from which pixels belong to sources, in cd/m^2.
    solid_angle : float
        Of the picture before the observer, in sr.
    position : numpy.ndarray of shape (sources, 2)
        x and y of the centres in pixels, the largest contribution first.
    pixels, luminance, source_solid_angle, position_index : numpy.ndarray of shape (sources,)
        In pixels, cd/m^2 and sr; the last by Guth.
    outside : int
        Sources smaller or larger than CIE 117 allows, 0.0003 to 0.1 sr.
    """

    rating: float
    background: float
    threshold: float
    solid_angle: float
    position: Reals = field(repr=False)
    pixels: Reals = field(repr=False)
    luminance: Reals = field(repr=False)
    source_solid_angle: Reals = field(repr=False)
    position_index: Reals = field(repr=False)
    outside: int


@dataclass(frozen=True, eq=False)
class PhotometryData(Table):
    """Result of `photometry`.

    Attributes
    ----------
    quantity, unit : str
        Such as "illuminance" and "lx".
    values : numpy.ndarray of shape (height, width)
        Rows from the top.
    regions : list of RegionStatistics
        The whole map where none was given.
    weber_contrast, michelson_contrast : float
        Of the first region against the second; NaN where there are not two.
    open_illuminance : float
        Of the open ground in lx, for daylight factors; NaN otherwise.
    glare : Glare or None
    image : Image
        The picture that was rendered or read.
    """

    quantity: str
    unit: str
    values: Reals = field(repr=False)
    regions: List[RegionStatistics]
    weber_contrast: float
    michelson_contrast: float
    open_illuminance: float
    glare: Optional[Glare]
    image: Image = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """A row for each region."""
        names = ("x", "y", "width", "height", "mean", "minimum", "median", "maximum", "uniformity", "diversity", "total")
        return {name: np.array([getattr(r, name) for r in self.regions]) for name in names}

    def false_color(
        self, *, low: Optional[float] = None, high: Optional[float] = None, log: bool = False, isolines: npt.ArrayLike = ()
    ) -> Image:
        """The picture that `aureole photometry` draws: colours with a scale and isolines.

        Parameters
        ----------
        low, high : float, optional
            Limits of the colours.
        log : bool
        isolines : array_like
            Their values; by default those of the scale.

        Returns
        -------
        Image
            sRGB-encoded, in [0, 1].
        """
        lines = np.atleast_1d(real("isolines", isolines)) if np.size(isolines) else np.empty(0)
        least, most = (None if v is None else scalar(name, v) for name, v in (("low", low), ("high", high)))
        with Words():
            return Image._of(
                _aureole.false_color_map(self.values, self.quantity, self.unit, least, most, flag("log", log), lines.ravel().tolist())
            )

    def plot(self, ax: Any = None, *, log: bool = False) -> Any:
        """The map in colours, with its regions.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        log : bool

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for, matplotlib

        axes = axes_for(ax)
        mpl = matplotlib()
        norm = mpl.colors.LogNorm() if flag("log", log) else None
        values = np.where(self.values > 0, self.values, np.nan) if log else self.values
        drawn = axes.imshow(values, norm=norm)
        axes.figure.colorbar(drawn, ax=axes, label=f"{self.quantity} [{self.unit}]")
        if len(self.regions) > 1 or self.regions[0].width * self.regions[0].height < self.values.size:
            for r in self.regions:
                axes.add_patch(mpl.patches.Rectangle((r.x - 0.5, r.y - 0.5), r.width, r.height, fill=False, color="white"))
        axes.set_axis_off()
        return axes

    def _title(self) -> str:
        title = f"{self.quantity}, {self.unit}; {self.values.shape[1]} x {self.values.shape[0]} cells"
        if self.glare is not None:
            title += f"\nUGR {self.glare.rating:.2f}, background {self.glare.background:.5g} cd/m^2, {len(self.glare.luminance)} sources"
        if np.isfinite(self.open_illuminance):
            title += f"\nopen ground: {self.open_illuminance:.6g} lx"
        return title


def photometry(
    target: "Union[Scene, Picture]",
    spp: Optional[int] = None,
    *,
    scene: "Union[Scene, str, os.PathLike[str], None]" = None,
    glare: bool = False,
    threshold: float = 0.0,
    daylight: bool = False,
    up: Optional[Sequence[float]] = None,
    regions: Sequence[Sequence[int]] = (),
    seed: Optional[int] = None,
    threads: int = 0,
    defines: Optional[Mapping[str, Any]] = None,
    progress: Union[bool, Report] = True,
) -> PhotometryData:
    """Illuminance, luminance and other quantities of a picture: `aureole photometry`.

    Parameters
    ----------
    target : Scene, Image, or str or path
        A scene (.xml) is rendered. Its film states a `quantity`, as the header of a picture does.
    spp, seed, threads, progress
        As for `render`, of a scene.
    scene : Scene, or str or path, optional
        Of a picture, for glare and daylight.
    glare : bool
        Find the sources of glare and the unified glare rating (CIE 117) of a picture of the luminance.
    threshold : float
        Luminance of glare sources in cd/m^2; 0: five times the mean of the picture.
    daylight : bool
        The map becomes the daylight factor in %: the illuminance over that of the open ground.
    up : (float, float, float), optional
        Upwards in the scene, for glare and daylight; by default z.
    regions : rows of (int, int, int, int)
        x, y, width and height of parts of which statistics are wanted; two of them are compared.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    PhotometryData
    """
    wants_glare, wants_daylight = flag("glare", glare), flag("daylight", daylight)
    if up is not None and not (wants_glare or wants_daylight):
        raise Error("up: is for glare and daylight")
    upwards = real("up", (0.0, 0.0, 1.0) if up is None else up, minimum=-1e15, maximum=1e15)
    if upwards.shape != (3,):
        raise Error(f"up: expected three numbers, got an array of shape {upwards.shape}")
    axis = upwards.tolist()
    limit = scalar("threshold", threshold, minimum=0, maximum=1e12, unit="cd/m^2")
    if limit > 0 and not wants_glare:
        raise Error("threshold: is for glare")
    rows = regions_of(regions)
    options = {"spp": spp, "seed": seed, "threads": threads, "progress": progress}
    of_scene = None if scene is None else _opened(scene)

    def check(s: Scene) -> None:
        empty = _aureole.photometric_map(_one_pixel(s), "target")
        if wants_daylight:
            _aureole.require_daylight_map(empty["quantity"], empty["unit"])

    image, name, opened = rendered_or_read("target", target, defines, check, options)
    if opened is not None and of_scene is not None:
        raise Error("scene: is the scene of a picture; the target is a scene itself")
    opened = opened or of_scene
    with Words():
        found = _aureole.photometric_map(image._picture, name)
        values: Reals = np.array(found["values"])
        quantity, unit = found["quantity"], found["unit"]
        if (wants_glare or wants_daylight) and opened is None:
            raise Error(f"{'glare' if wants_glare else 'daylight'}: needs the camera and the sky of the picture: give its scene")
        ground = float("nan")
        if wants_daylight and opened is not None:
            _aureole.require_daylight_map(quantity, unit)
            ground = float(_aureole.open_illuminance(opened._open, axis))
            if not ground > 0:
                raise Error("daylight: the scene has no sky or sun above `up`")
            values *= 100 / ground
            quantity, unit = "daylight factor", "%"
        rows = rows or [[0, 0, values.shape[1], values.shape[0]]]
        areas = [] if opened is None else _aureole.cell_areas(opened._open, values.shape[1], values.shape[0])
        statistics = [RegionStatistics(*row, *_aureole.map_statistics(values, row, areas)[1:]) for row in rows]
        glared = None
        if wants_glare and opened is not None:
            glared = _glare(_aureole.picture_glare(values, quantity, unit, opened._open, axis, limit))
    weber, michelson = _contrasts(statistics)
    return PhotometryData(quantity, unit, values, statistics, weber, michelson, ground, glared, image)


def _contrasts(regions: List[RegionStatistics]) -> Tuple[float, float]:
    if len(regions) != 2 or not regions[1].mean > 0:
        return float("nan"), float("nan")
    first, second = regions[0].mean, regions[1].mean
    return first / second - 1, (first - second) / (first + second)


def _glare(d: Mapping[str, Any]) -> Glare:
    rows = np.array(d["sources"], dtype=np.float64).reshape(-1, 6)
    if d["outside"]:
        tell([f"{d['outside']} of {len(rows)} sources are smaller than 0.0003 sr or larger than 0.1 sr, for which UGR is not meant"])
    if d["solid_angle"] < 2:
        tell([f"the background is that of the picture, {d['solid_angle']:.2g} sr of the 6.28 sr before the observer"])
    pixels, luminance, angle, index = (rows[:, i] for i in range(2, 6))
    return Glare(d["rating"], d["background"], d["threshold"], d["solid_angle"], rows[:, :2], pixels, luminance, angle, index, d["outside"])


def _one_pixel(scene: Scene) -> Any:
    """The picture of a scene without a sample, to ask for the units of its film."""
    return _aureole.empty_picture(scene._open, 1, None, 1, None)


def _opened(scene: Any) -> Scene:
    if isinstance(scene, Scene):
        return scene
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene: expected a Scene or a path, got {type(scene).__name__}")
    return Scene(_aureole.OpenScene.load_file(file_path("scene", scene), defines_of(None), {}, "", ""))


__all__ = ["Glare", "PhotometryData", "RegionStatistics", "photometry"]
