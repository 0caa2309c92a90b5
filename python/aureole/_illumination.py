# SPDX-License-Identifier: Apache-2.0
"""`illumination`: local illumination, by light that was scattered once, beside global illumination."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, integer
from ._errors import Error
from ._image import Image
from ._instrument_support import Words, defines_of, regions_of, tell
from ._bars import Report
from ._render import render
from ._results import Table
from ._scene import Scene

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class IlluminationData(Table):
    """Result of `illumination`: means over runs with seeds of their own.

    Attributes
    ----------
    quantity, unit : str
        Of the film; "relative luminance" where it has none.
    local_map, global_map : numpy.ndarray of shape (height, width)
        By light that was scattered once (on receivers: by light that arrives from the lamps), and by all light.
    region : numpy.ndarray of int, shape (regions, 4)
        x, y, width and height.
    local, local_error, total, total_error : numpy.ndarray of shape (regions,)
        Means of the regions by local and by all light, with their standard errors.
    runs : int
    local_image, global_image : Image
        Linear colours.
    """

    quantity: str
    unit: str
    local_map: Reals = field(repr=False)
    global_map: Reals = field(repr=False)
    region: "npt.NDArray[np.int64]"
    local: Reals
    local_error: Reals
    total: Reals
    total_error: Reals
    runs: int
    local_image: Image = field(repr=False)
    global_image: Image = field(repr=False)

    @property
    def repeated(self) -> Reals:
        """Means of the regions by light that was scattered more than once."""
        return self.total - self.local

    @property
    def repeated_error(self) -> Reals:
        """Standard error of `repeated`."""
        return np.hypot(self.local_error, self.total_error)

    @property
    def share(self) -> Reals:
        """Share of light that was scattered more than once, of each cell; NaN where there is no light."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.global_map > 0, 1 - self.local_map / self.global_map, np.nan)

    def columns(self) -> Dict[str, Any]:
        """A row for each region."""
        return {
            **{name: self.region[:, i] for i, name in enumerate(("x", "y", "width", "height"))},
            "local": self.local,
            "local_error": self.local_error,
            "global": self.total,
            "global_error": self.total_error,
            "repeated": self.repeated,
            "repeated_error": self.repeated_error,
        }

    def plot(self, ax: Any = None) -> Any:
        """The share of light that was scattered more than once, in colours.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for

        axes = axes_for(ax)
        drawn = axes.imshow(100 * self.share, vmin=0, vmax=100)
        axes.figure.colorbar(drawn, ax=axes, label="light scattered more than once [%]")
        axes.set_axis_off()
        return axes

    def _title(self) -> str:
        return f"{self.quantity}, {self.unit}; means with their standard errors over {self.runs} runs"


def illumination(
    scene: "str | os.PathLike[str]",
    spp: Optional[int] = None,
    *,
    runs: int = 8,
    seed: int = 0,
    threads: int = 0,
    regions: Sequence[Sequence[int]] = (),
    defines: Optional[Mapping[str, Any]] = None,
    progress: Union[bool, Report] = True,
) -> IlluminationData:
    """Local illumination (the integrator "direct") beside global illumination ("path"): `aureole illumination`.

    Parameters
    ----------
    scene : str or path
        Its integrator is replaced.
    spp : int, optional
        Samples per pixel of each run.
    runs : int
        Runs with seeds of their own from `seed` on, for the standard errors.
    regions : rows of (int, int, int, int)
        x, y, width and height of parts of which means are wanted; by default the whole picture.
    threads, progress
        As for `render`.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    IlluminationData
    """
    file, values = file_path("scene", scene), defines_of(defines)
    rows, count = regions_of(regions), integer("runs", runs, minimum=2, maximum=1000)
    first = integer("seed", seed, minimum=0, maximum=2**63)
    found: List[Mapping[str, Any]] = []
    for is_local in (True, False):
        with Words():
            opened = Scene(_aureole.load_illumination(file, values, is_local))
        if not is_local:
            tell(opened.notes)
        pictures = []
        for run in range(count):
            image = render(opened, spp, seed=first + run, threads=threads, adaptive="none", progress=progress)
            if not image.complete:
                raise Error("the render was interrupted before all samples were done")
            pictures.append(image._picture)
        with Words():
            found.append(_aureole.illumination_means(pictures, file, rows))
    local, everything = found
    numbers = [np.array(d["regions"], dtype=np.float64).reshape(-1, 6) for d in found]
    return IlluminationData(
        everything["quantity"],
        everything["unit"],
        np.array(local["values"]),
        np.array(everything["values"]),
        numbers[0][:, :4].astype(np.int64),
        numbers[0][:, 4],
        numbers[0][:, 5],
        numbers[1][:, 4],
        numbers[1][:, 5],
        count,
        Image._of(local["colors"]),
        Image._of(everything["colors"]),
    )


__all__ = ["IlluminationData", "illumination"]
