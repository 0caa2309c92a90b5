# SPDX-License-Identifier: Apache-2.0
"""Checking of array arguments: exceptions that name the argument and say what was expected."""
from __future__ import annotations

import os
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from ._errors import Error


def real(name: str, value: Any, *, minimum: Optional[float] = None, maximum: Optional[float] = None,
         positive: bool = False, unit: str = "") -> npt.NDArray[np.float64]:
    """Returns the argument `name` as an array of finite real numbers.

    Parameters
    ----------
    name : str
        The function's name for the argument.
    value : array_like
        Numbers; booleans, complex numbers, strings and objects are a TypeError.
    minimum, maximum : float, optional
        Inclusive bounds.
    positive : bool
        Whether the numbers must be above zero.
    unit : str
        Unit of the bounds in the message.

    Returns
    -------
    numpy.ndarray of float64
        `value` itself, not a copy, where it is such an array.
    """
    try:
        array = np.asarray(value)
    except (ValueError, OverflowError, RecursionError) as e:
        raise TypeError(f"{name}: expected an array of real numbers, got a ragged {type(value).__name__}") from e
    _refuse_axes(name, array)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, got {_described(value, array)}")
    _refuse_masked(name, value)
    array = array.astype(np.float64, copy=False)
    suffix = f" {unit}" if unit else ""
    good = np.isfinite(array)
    if not good.all():
        raise Error(f"{name}: expected finite numbers, got {array[~good].flat[0]}{_where(~good)}")
    for wrong, bound in ((minimum is not None and array < (minimum if minimum is not None else 0), f"at least {minimum}{suffix}"),
                         (maximum is not None and array > (maximum if maximum is not None else 0), f"at most {maximum}{suffix}"),
                         (positive and array <= 0, f"positive numbers{' in' + suffix if unit else ''}")):
        if np.any(wrong):
            raise Error(f"{name}: expected {bound}, got {array[wrong].flat[0]:g}{_where(np.asarray(wrong))}")
    return array


def complex_numbers(name: str, value: Any) -> npt.NDArray[np.complex128]:
    """Returns the argument `name` as an array of finite real or complex numbers."""
    try:
        array = np.asarray(value)
    except (ValueError, OverflowError, RecursionError) as e:
        raise TypeError(f"{name}: expected an array of numbers, got a ragged {type(value).__name__}") from e
    _refuse_axes(name, array)
    if array.dtype.kind not in "fiuc":
        raise TypeError(f"{name}: expected real or complex numbers, got {_described(value, array)}")
    _refuse_masked(name, value)
    array = array.astype(np.complex128, copy=False)
    good = np.isfinite(array)
    if not good.all():
        raise Error(f"{name}: expected finite numbers, got {array[~good].flat[0]}{_where(~good)}")
    return array


def scalar(name: str, value: Any, **limits: Any) -> float:
    """Returns the argument `name` as one finite real number; `limits` as in `real`."""
    array = real(name, value, **limits)
    if array.size != 1:
        raise Error(f"{name}: expected one number, got an array of shape {array.shape}")
    return float(array.reshape(())[()])


def integer(name: str, value: Any, *, minimum: Optional[int] = None, maximum: Optional[int] = None) -> int:
    """Returns the argument `name` as one integer."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        got = f"an array of {value.dtype}" if isinstance(value, np.ndarray) else f"{type(value).__name__} {shown(value)}"
        raise TypeError(f"{name}: expected an integer, got {got}")
    if minimum is not None and value < minimum:
        raise Error(f"{name}: expected at least {minimum}, got {shown(value)}")
    if maximum is not None and value > maximum:
        raise Error(f"{name}: expected at most {maximum}, got {shown(value)}")
    return int(value)


def flag(name: str, value: Any) -> bool:
    """Returns the argument `name` as True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: expected True or False, got {type(value).__name__} {shown(value)}")
    return bool(value)


def text(name: str, value: Any) -> str:
    """Returns the argument `name` as a string that can be written as UTF-8."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a string, got {type(value).__name__}")
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        raise Error(f"{name}: expected valid Unicode, got {shown(value)}") from None
    return value


def file_path(name: str, value: Any) -> str:
    """Returns the argument `name` as the path of a file."""
    try:
        path = os.fsdecode(value)
        os.fsencode(path)
    except TypeError:
        raise TypeError(f"{name}: expected a path (a string or os.PathLike), got {type(value).__name__}") from None
    except UnicodeError:
        raise Error(f"{name}: expected a path in valid Unicode, got {shown(value)}") from None
    if not path:
        raise Error(f"{name}: expected a path, got an empty string")
    if "\0" in path:
        raise Error(f"{name}: expected a path without null characters, got {shown(path)}")
    return path


def shown(value: Any) -> str:
    """Returns a value as text for an error message; a long text is cut, and repr() may raise."""
    try:
        written = repr(value)
    except Exception:  # nesting too deep, too many digits, or an exception of the object's own
        return "that cannot be shown"
    return written if len(written) < 60 else f"{written[:57]}..."


def _refuse_axes(name: str, array: npt.NDArray[Any]) -> None:
    if array.ndim > 16:  # bound of dimensions, since numpy's own limit is 32 in some versions and 64 in others
        raise Error(f"{name}: expected at most 16 axes, got {array.ndim}")


def _refuse_masked(name: str, value: Any) -> None:
    if np.ma.is_masked(value):
        raise TypeError(f"{name}: expected an array without masked elements: fill or drop them first")


def _described(value: Any, array: npt.NDArray[Any]) -> str:
    if isinstance(value, np.ndarray) or array.ndim > 0:
        return f"an array of {array.dtype}"
    return f"{type(value).__name__} {shown(value)}"


def _where(wrong: npt.NDArray[np.bool_]) -> str:
    if wrong.ndim == 0:
        return ""
    index = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
    return f" at index {tuple(int(i) for i in index)}" if len(index) > 1 else f" at index {int(index[0])}"
