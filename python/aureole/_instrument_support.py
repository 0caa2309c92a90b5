# SPDX-License-Identifier: Apache-2.0
"""Shared by the functions that measure: notes, errors in Python's words, pictures that may be files."""

from __future__ import annotations

import os
import warnings
from typing import Any, List, Mapping, Sequence, Tuple, Union

from ._arrays import file_path, text
from ._errors import Error
from ._image import Image, read_image
from ._scene import _defines
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
