# SPDX-License-Identifier: Apache-2.0
"""From checked arguments to the flat arrays that the compiled loops take, and back."""
from __future__ import annotations

import math
from typing import Any, Tuple

import numpy as np
import numpy.typing as npt

from ._arrays import shown
from ._errors import Error

#: Results of one call, at most: 2 GiB of real numbers. More is a mistaken shape, or better done in parts.
MOST_RESULTS = 2**28


def limit_results(names: str, *shapes: Tuple[int, ...]) -> None:
    """Refuse results too large for memory; `names` are the arguments that they come from."""
    count = math.prod(math.prod(shape) for shape in shapes)
    if count > MOST_RESULTS:
        raise Error(f"{names}: expected at most {MOST_RESULTS} results, got {count}: call it for parts")


def broadcast(**arrays: npt.NDArray[Any]) -> Tuple[Tuple[int, ...], Tuple[npt.NDArray[Any], ...]]:
    """The common shape of the named arrays, and each of them with that shape, flat and contiguous."""
    names = " and ".join(arrays)
    try:
        shape = np.broadcast_shapes(*(a.shape for a in arrays.values()))
    except ValueError:
        shapes = " and ".join(str(a.shape) for a in arrays.values())
        raise Error(f"{names}: expected shapes that fit together by numpy's broadcasting, got {shapes}") from None
    limit_results(names, shape)
    return shape, tuple(np.ascontiguousarray(np.broadcast_to(a, shape)).reshape(-1) for a in arrays.values())


def shaped(flat: npt.NDArray[Any], shape: Tuple[int, ...]) -> Any:
    """`flat` with a shape; a scalar where that is ()."""
    return flat.reshape(shape)[()]


def of_rows(function: Any, dtype: Any = np.float64, **arrays: npt.NDArray[Any]) -> Any:
    """A compiled function of rows of numbers, for the named arrays broadcast against each other."""
    shape, flat = broadcast(**arrays)
    result = np.empty(flat[0].size, dtype)
    function(np.stack(flat, axis=-1).reshape(-1), result)
    return shaped(result, shape)


def last_axis(name: str, array: npt.NDArray[Any], size: int) -> None:
    """Require shape (..., size)."""
    if array.ndim == 0 or array.shape[-1] != size:
        raise Error(f"{name}: expected an array of shape (..., {size}), got shape {array.shape}")


def choice(name: str, value: Any, *allowed: str) -> str:
    """The argument `name` as one of the allowed strings."""
    if not isinstance(value, str) or value not in allowed:
        raise Error(f"{name}: expected {' or '.join(repr(a) for a in allowed)}, got {shown(value)}")
    return value
