# SPDX-License-Identifier: Apache-2.0
"""`compare` and `info`: differences of pictures, and the content of files."""

from __future__ import annotations

import html
import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _aureole
from ._arrays import file_path, integer, shown
from ._errors import Error
from ._image import Image, read_image
from ._instrument_support import Picture, Words, axes_or_new, defines_of, picture_of, tell
from ._render import render
from ._results import Table
from ._scene import load_file


@dataclass(frozen=True)
class LayerDifference:
    """The difference of one layer of two pictures.

    Attributes
    ----------
    layer : str
        "" for R, G, B and Y.
    channels : list of str
    mean_a, mean_b, rmse, relative_mse : float
        Over all channels; the last is the mean of (a - b)^2/(b^2 + 0.01 mean(b)^2).
    max_difference : float
        The largest, at the pixel `max_at` (x, y).
    not_finite : int
        Values that are NaN or infinite in either picture.
    z_mean_square, z_outside, z_mean_difference : float or None
        Mean of z^2 (1 for the same picture), part of the values beyond the bound, and the difference of the means in
        standard errors; None where neither picture has variances.
    verdict : str
        In words; empty where nothing was tested.
    is_same : bool
        As far as is known.
    """

    layer: str
    channels: List[str]
    mean_a: float
    mean_b: float
    rmse: float
    relative_mse: float
    max_difference: float
    max_at: Tuple[int, int]
    not_finite: int
    z_mean_square: Optional[float]
    z_outside: Optional[float]
    z_mean_difference: Optional[float]
    verdict: str
    is_same: bool


@dataclass(frozen=True, eq=False)
class Comparison(Table):
    """Result of `compare`.

    Attributes
    ----------
    layers : list of LayerDifference
    z_map : Image or None
        One channel: the z of largest magnitude of all layers; None where neither picture has variances.
    """

    layers: List[LayerDifference]
    z_map: Optional[Image] = field(repr=False)

    @property
    def is_same(self) -> bool:
        """No layer differs by more than noise."""
        return all(layer.is_same for layer in self.layers)

    def __bool__(self) -> bool:
        return self.is_same

    def columns(self) -> Dict[str, Any]:
        """A row for each layer."""
        names = (
            "mean_a",
            "mean_b",
            "rmse",
            "relative_mse",
            "max_difference",
            "not_finite",
            "z_mean_square",
            "z_outside",
            "z_mean_difference",
            "verdict",
        )
        return {
            "layer": [layer.layer or "colour" for layer in self.layers],
            **{n: [getattr(layer, n) for layer in self.layers] for n in names},
        }

    def plot(self, ax: Any = None) -> Any:
        """The map of z, from -4 (blue) to 4 (red).

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        if self.z_map is None:
            raise Error("neither picture has variances: render both with replicates=16 or more")
        axes = axes_or_new(ax)
        shown_map = axes.imshow(self.z_map.array[..., 0], cmap="RdBu_r", vmin=-4, vmax=4)
        axes.figure.colorbar(shown_map, ax=axes, label="z")
        axes.set_axis_off()
        return axes


def compare(a: Picture, b: Picture) -> Comparison:
    """The difference of two pictures, tested against their noise: `aureole compare`.

    Parameters
    ----------
    a, b : Image or path
        A picture and the reference. With variances (``replicates`` of `render`) the difference is tested.

    Returns
    -------
    Comparison
        True where no layer differs by more than noise.
    """
    pictures = [picture_of("a", a)[0], picture_of("b", b)[0]]
    counts = [
        _aureole.replicates_of_file(file_path("a", given)) if not isinstance(given, Image) else int(image.info.get("replicates", 0))
        for given, image in ((a, pictures[0]), (b, pictures[1]))
    ]
    layers, z_map = _aureole.compare_pictures(pictures[0]._picture, pictures[1]._picture, *counts)
    return Comparison([LayerDifference(**layer) for layer in layers], None if z_map is None else Image._of(z_map))


@dataclass(frozen=True, eq=False)
class FileInfo(Table):
    """Result of `info`. ``print`` shows the text; ``found["size"]`` is the line of that label.

    Attributes
    ----------
    kind : {"scene", "picture", "volume", "splats", "radiance grid", "state"}
    rows : list of (str, str)
        Label and text of each line; lines that go on with the one above have its label.
    text : str
        As `aureole info` prints it.
    path : str
        The file.
    defines : dict
        Values of a scene's $names.
    """

    kind: str
    rows: List[Tuple[str, str]] = field(repr=False)
    text: str = field(repr=False)
    path: str
    defines: Dict[str, Any] = field(repr=False)

    def __getitem__(self, label: str) -> str:
        lines = [line for name, line in self.rows if name == label]
        if not lines:
            raise KeyError(f"{label!r}: there are {', '.join(dict.fromkeys(name for name, _ in self.rows))}")
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.text

    def columns(self) -> Dict[str, Any]:
        """Label and text of each line."""
        return {"label": [name for name, _ in self.rows], "text": [line for _, line in self.rows]}

    def _repr_html_(self) -> str:
        return (
            "<table>"
            + "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(line)}</td></tr>" for name, line in self.rows)
            + "</table>"
        )

    def plot(self, ax: Any = None, *, exposure: float = 0.0, spp: int = 4, axis: str = "z", points: int = 20_000) -> Any:
        """The content of the file, which is read again.

        A picture, and the picture of a state file so far, as a display shows them; channels without colours by the first one.
        A scene is rendered. Of a volume or radiance grid the slice in its middle is shown; of splats their centres, seen along an axis,
        with the opacities and with the mean of the colours over all directions.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        exposure : float
            Of pictures and scenes, in stops.
        spp : int
            Samples per pixel of a scene.
        axis : {"x", "y", "z"}
            Of volumes, radiance grids and splats: the direction across the slice, or along which the centres are seen.
        points : int
            The largest number of centres that are shown, at equal steps of their order in the file.

        Returns
        -------
        matplotlib Axes
        """
        if axis not in ("x", "y", "z"):
            raise Error(f'axis: expected "x", "y" or "z", got {shown(axis)}')
        spp = integer("spp", spp, minimum=1, maximum=2**20)
        points = integer("points", points, minimum=1, maximum=10**7)
        axes = axes_or_new(ax)
        if self.kind in ("volume", "radiance grid"):
            _plot_slice(axes, self.path, self.kind, axis)
        elif self.kind == "splats":
            _plot_centres(axes, self.path, axis, points)
        else:
            image = (
                render(load_file(self.path, **self.defines), spp)
                if self.kind == "scene"
                else Image._of(_aureole.state_picture(self.path)) if self.kind == "state" else read_image(self.path)
            )
            image.plot(axes, exposure)
        axes.set_title(os.path.basename(self.path))
        return axes


def _plot_slice(axes: Any, path: str, kind: str, axis: str) -> None:
    values, across, up, index, count = _aureole.grid_slice(path, kind == "radiance grid", "xyz".index(axis))
    drawn = axes.imshow(values, origin="lower", aspect=up / across, cmap="gray", interpolation="nearest")
    label = "density" if kind == "radiance grid" else "value"
    axes.figure.colorbar(drawn, ax=axes, label=f"{label} in the slice {index} of {count} along {axis}")
    first, second = (name for name in "xyz" if name != axis)
    axes.set_xlabel(f"voxel along {first}")
    axes.set_ylabel(f"voxel along {second}")


def _plot_centres(axes: Any, path: str, axis: str, points: int) -> None:
    positions, colours, count = _aureole.splat_points(path, points)
    depth = "xyz".index(axis)
    across, up = (k for k in range(3) if k != depth)
    order = np.argsort(positions[:, depth])  # the nearest to the viewer, who is at the positive end, is drawn last
    axes.scatter(positions[order, across], positions[order, up], s=2, c=np.clip(colours[order], 0, 1), linewidths=0)
    axes.set_aspect("equal")
    axes.set_xlabel(f"{'xyz'[across]} ({len(positions)} of {count} centres)")
    axes.set_ylabel("xyz"[up])


def info(path: "str | os.PathLike[str]", defines: Optional[Mapping[str, Any]] = None) -> FileInfo:
    """The content of a scene, a picture, a volume, splats or a state file: `aureole info`.

    Parameters
    ----------
    path : path-like
    defines : dict, optional
        Values of a scene's $names.

    Returns
    -------
    FileInfo
    """
    with Words():
        kind, described, notes = _aureole.file_info(file_path("path", path), defines_of(defines))
    tell(notes)
    rows: List[Tuple[str, str]] = []
    for line in described.splitlines():
        label = line[:13].strip() if not line.startswith(" ") else ""
        rows.append((label or (rows[-1][0] if rows else ""), line[13:] if label else line.strip()))
    return FileInfo(kind, rows, described, file_path("path", path), dict(defines or {}))


__all__ = ["Comparison", "FileInfo", "LayerDifference", "compare", "info"]
