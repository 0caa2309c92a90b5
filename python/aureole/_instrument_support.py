# SPDX-License-Identifier: Apache-2.0
"""Shared by the functions that measure: notes, errors in Python's words, pictures that may be files."""

from __future__ import annotations

import os
import warnings
from typing import Any, Callable, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _aureole
from ._arrays import file_path, integer, shown, text
from ._errors import Error
from ._image import Image, read_image
from ._render import render
from ._scene import Scene, _defines
from ._wording import python_names

Length = Union[float, str]
Angle = Union[float, str]
Picture = Union[Image, "str", "os.PathLike[str]"]


def defines_of(defines: Any) -> List[Tuple[str, str]]:
    """The argument `defines`, a dict or None, as pairs of texts."""
    if defines is None:
        return []
    if not isinstance(defines, Mapping):
        raise TypeError(f"defines: expected a dict of names and values, got {type(defines).__name__}")
    return _defines({text("defines", name): value for name, value in defines.items()})


def tell(notes: Sequence[str]) -> None:
    for note in notes:
        warnings.warn(python_names(note), stacklevel=3)


class Words:
    """Errors of the compiled module in the words of Python while it is entered."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        if type(error) is Error and (words := python_names(str(error))) != str(error):
            raise Error(words) from None


def axes_or_new(ax: Any) -> Any:
    from ._plot_support import axes_for

    return axes_for(ax)


def picture_of(name: str, value: Picture) -> "Tuple[Image, str]":
    """A picture or the content of its file, and its name for messages."""
    if isinstance(value, Image):
        return value, name
    if isinstance(value, (str, os.PathLike)):
        image = read_image(file_path(name, value))
        tell(image.notes)
        return image, str(value)
    raise TypeError(f"{name}: expected an Image or a path, got {type(value).__name__}")


def regions_of(value: Any) -> List[List[int]]:
    """The argument `regions`: rows of x, y, width and height in pixels."""
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, (Sequence, np.ndarray)):
        raise TypeError(f"regions: expected rows of x, y, width and height, got {type(value).__name__}")
    rows = []
    for row in value:
        if isinstance(row, (str, bytes)) or not isinstance(row, (Sequence, np.ndarray)) or len(row) != 4:
            raise Error(f"regions: expected x, y, width and height, got {shown(row)}")
        rows.append([integer("regions", v, minimum=0, maximum=2**20) for v in row])
    return rows


def is_scene_file(path: str) -> bool:
    return path.lower().endswith(".xml")


def rendered_or_read(name: str, target: Any, defines: Any, check: Callable[[Scene], Any], options: Mapping[str, Any]) -> "Tuple[Image, str, Optional[Scene]]":
    """The picture of a Scene or of the file of one, which is rendered with `options` once `check` has passed it; or an Image
    or its file. Returns its name for messages and the scene, too."""
    if isinstance(target, (str, os.PathLike)) and is_scene_file(file_path(name, target)):
        opened = Scene(_aureole.OpenScene.load_file(file_path(name, target), defines_of(defines), {}, "", ""))
        tell(opened.notes)
        called = str(target)
    elif isinstance(target, Scene):
        if defines is not None:
            raise Error("defines: expected the path of a scene, not a Scene")
        opened, called = target, name
    else:
        if defines is not None:
            raise Error("defines: expected the path of a scene, not a picture")
        for option in ("spp", "seed"):
            if options.get(option) is not None:
                raise Error(f"{option}: is for a scene, which is rendered; a picture is done")
        if options.get("threads"):
            raise Error("threads: is for a scene, which is rendered; a picture is done")
        return (*picture_of(name, target), None)
    with Words():
        check(opened)
    image = render(opened, **options)
    if not image.complete:
        raise Error("the render was interrupted before all samples were done")
    return image, called, opened
