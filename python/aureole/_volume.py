# SPDX-License-Identifier: Apache-2.0
"""Grids of numbers as files of Mitsuba's format .vol, which the volume `gridvolume` reads."""
from __future__ import annotations

import os
import struct
from typing import Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import real
from ._errors import Error

_HEAD = struct.Struct("<3sB5i6f")


def _file(path: Union[str, "os.PathLike[str]"]) -> str:
    """The argument `path` as text."""
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"path: expected a str or a path, got a {type(path).__name__}")
    name = os.fspath(path)
    if not isinstance(name, str) or "\0" in name:
        raise Error("path: is no name of a file")
    return name


def write_vol(path: Union[str, "os.PathLike[str]"], values: npt.ArrayLike,
              box: Sequence[Sequence[float]] = ((0, 0, 0), (1, 1, 1))) -> None:
    """Writes a grid as a .vol file (version 3, single precision).

    Parameters
    ----------
    path : str or path
        The file.
    values : array_like, depth x height x width, or x 1, 3 or 6
        The value `values[z, y, x]` belongs to the voxel's centre, at ((x + 0.5)/width, (y + 0.5)/height, (z +
        .5)/depth) of the box. Three numbers are a linear sRGB colour.
    box : two points
        Lowest and highest corner of the box that the voxels fill. `gridvolume` uses it with `use_grid_bbox`.

    Raises
    ------
    aureole.Error
        For another shape, a box that is empty or inverted, or numbers that are not finite; or where the
        file cannot be written.

    Examples
    --------
    >>> import os, tempfile
    >>> import aureole
    >>> import numpy as np
    >>> z, y, x = np.meshgrid(*[np.linspace(-1, 1, 16)] * 3, indexing="ij")
    >>> file = os.path.join(tempfile.mkdtemp(), "ball.vol")
    >>> aureole.write_vol(file, np.where(x**2 + y**2 + z**2 < 1, 5.0, 0.0))
    >>> aureole.read_vol(file)[0].shape
    (16, 16, 16, 1)
    """
    grid = real("values", values)
    if grid.ndim == 3:
        grid = grid[..., None]
    if grid.ndim != 4 or grid.shape[3] not in (1, 3, 6) or grid.size == 0:
        raise Error(f"values: expected depth x height x width [x 1, 3 or 6] numbers, got {np.shape(values)}")
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(grid, "<f4")
    if not np.isfinite(single).all():
        raise Error("values: a number exceeds single precision")
    corners = real("box", box)
    if corners.shape != (2, 3) or not (corners[0] < corners[1]).all():
        raise Error("box: expected a lower corner and a higher one, three numbers each")
    depth, height, width, channels = grid.shape
    file = _file(path)
    _aureole.write_file(file, _HEAD.pack(b"VOL", 3, 1, width, height, depth, channels, *corners.ravel()) + single.tobytes())


def read_vol(path: Union[str, "os.PathLike[str]"]) -> Tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Reads a .vol file of numbers in single precision.

    Parameters
    ----------
    path : str or path
        The file.

    Returns
    -------
    values : numpy.ndarray of float32, depth x height x width x channels
    box : numpy.ndarray of float32, 2 x 3
        The lowest and the highest corner of the box.

    Raises
    ------
    aureole.Error
        Where the file cannot be read, has another format, or is truncated.
    """
    file = _file(path)
    content = _aureole.read_file(file)
    if len(content) < _HEAD.size or content[:4] != b"VOL\x03":
        raise Error(f"{file}: is no .vol file of version 3")
    _, _, encoding, width, height, depth, channels, *box = _HEAD.unpack_from(content)
    if encoding != 1:
        raise Error(f"{file}: has encoding {encoding}; 1 (single precision) is supported")
    shape = (depth, height, width, channels)
    if min(shape) < 1 or len(content) < _HEAD.size + 4 * depth * height * width * channels:
        raise Error(f"{file}: is truncated or damaged")
    values = np.frombuffer(content, "<f4", depth * height * width * channels, _HEAD.size).reshape(shape)
    return values.copy(), np.array(box, np.float32).reshape(2, 3)
