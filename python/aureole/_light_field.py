# SPDX-License-Identifier: Apache-2.0
"""`lightfield`: pictures from a light field, refocused and from other places."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, integer, real, scalar
from ._errors import Error
from ._image import FloatArray, Image
from ._instrument_support import Picture, Words, rendered_or_read
from ._bars import Report
from ._results import Table
from ._scene import Scene

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LightField(Table):
    """Result of `lightfield`: views through the cells of a rectangle, by two planes. Lengths are in units of the scene;
    x is to the right and y down, from the middle.

    Attributes
    ----------
    image : Image
        The mosaic of all views.
    views : (int, int)
        Their numbers along x and y.
    size : (int, int)
        Pixels of a view along x and y.
    aperture : (float, float)
        Width and height of the rectangle in the plane (s, t).
    plane_distance, field_width : float
        Distance of the plane (u, v) and width of its window.
    axes : str
        All of these in words, as the header of an EXR has them.
    """

    image: Image = field(repr=False)
    views: Tuple[int, int]
    size: Tuple[int, int]
    aperture: Tuple[float, float]
    plane_distance: float
    field_width: float
    axes: str = field(repr=False)

    @property
    def s(self) -> Reals:
        """Positions of the views along x."""
        return _middles(self.views[0], self.aperture[0])

    @property
    def t(self) -> Reals:
        """Positions of the views along y."""
        return _middles(self.views[1], self.aperture[1])

    @property
    def u(self) -> Reals:
        """Positions of the pixels in the window, along x."""
        return _middles(self.size[0], self.field_width)

    @property
    def v(self) -> Reals:
        """Positions of the pixels in the window, along y."""
        return _middles(self.size[1], self.field_width * self.size[1] / self.size[0])

    @property
    def array(self) -> FloatArray:
        """The radiance, float32 of shape (t, s, v, u, channels): a view of the picture's memory."""
        (nx, ny), (w, h) = self.views, self.size
        return self.image.array.reshape(ny, h, nx, w, -1).transpose(0, 2, 1, 3, 4)

    def picture(self, at: Sequence[float] = (0.0, 0.0), *, diameter: float = 0.0, focus: Optional[float] = None) -> Image:
        """The picture of a camera in the plane (s, t).

        Parameters
        ----------
        at : (float, float)
            Its place, from the middle.
        diameter : float
            Of a round synthetic aperture: the mean over its views. 0: a new view between the four nearest.
        focus : float, optional
            Distance of the plane in focus; by default that of the plane (u, v).

        Returns
        -------
        Image
        """
        place = real("at", at)
        if place.shape != (2,):
            raise Error(f"at: expected two numbers, got an array of shape {place.shape}")
        if np.any(2 * np.abs(place) > self.aperture):
            raise Error(f"at: lies outside of the light field, which reaches to {self.aperture[0] / 2:g}, {self.aperture[1] / 2:g}")
        distance = self.plane_distance if focus is None else scalar("focus", focus, positive=True)
        width = scalar("diameter", diameter, minimum=0, maximum=1e9)
        with Words():
            return Image._of(
                _aureole.light_field_picture(self.image._picture, self.axes, "light field", place.tolist(), width, distance)
            )

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes an EXR whose header has both pairs of axes, atomically."""
        name = file_path("path", path)
        if not name.lower().endswith(".exr"):
            raise Error(f'path: expected a name that ends with ".exr", got {name!r}')
        _aureole.write_light_field(self.image._picture, self.axes, name)

    def columns(self) -> Dict[str, Any]:
        """A row for each view, with its mean."""
        t, s = np.meshgrid(self.t, self.s, indexing="ij")
        means = self.array.mean(axis=(2, 3), dtype=np.float64)
        names = {f"mean_{name}": means[..., i].ravel() for i, name in enumerate(self.image.channels)}
        return {"s": s.ravel(), "t": t.ravel(), **names}

    def plot(self, ax: Any = None, **picture: Any) -> Any:
        """A picture of the light field.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        **picture
            Arguments of `picture`.

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for

        axes = axes_for(ax)
        axes.imshow(self.picture(**picture).tonemap())
        axes.set(title=f"{self.views[0]} x {self.views[1]} views")
        axes.set_axis_off()
        return axes

    def _title(self) -> str:
        return self.axes


def lightfield(
    target: "Union[Scene, Picture]",
    spp: Optional[int] = None,
    *,
    seed: Optional[int] = None,
    threads: int = 0,
    defines: Optional[Mapping[str, Any]] = None,
    progress: Union[bool, Report] = True,
) -> LightField:
    """A light field, from which `LightField.picture` makes pictures: `aureole lightfield`.

    Parameters
    ----------
    target : Scene, Image, or str or path
        A scene (.xml) with the sensor "lightfield", which is rendered; or the light field that one was saved as.
    spp, seed, threads, progress
        As for `render`, of a scene.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    LightField
    """
    options = {"spp": spp, "seed": seed, "threads": threads, "progress": progress}
    integer("threads", threads, minimum=0, maximum=4096)
    image, name, scene = rendered_or_read("target", target, defines, lambda s: _aureole.require_light_field(s._open), options)
    with Words():
        axes = image._picture.light_field if scene is None else _aureole.light_field_axes(scene._open)
        d = _aureole.parsed_light_field(image._picture, axes, name)
    return LightField(
        image, tuple(d["views"]), tuple(d["size"]), tuple(d["aperture"]), d["plane_distance"], d["field_width"], axes
    )


def _middles(count: int, width: float) -> Reals:
    return width * ((np.arange(count) + 0.5) / count - 0.5)


__all__ = ["LightField", "lightfield"]
