# SPDX-License-Identifier: Apache-2.0
"""Arguments with units: numbers in SI units, or strings that state their unit."""
from __future__ import annotations

import re
from typing import Any, Dict, Optional

from ._arrays import scalar, shown, text
from ._errors import Error

_LENGTHS = {"nm": 1e-9, "um": 1e-6, "µm": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3}
_ANGLES = {"deg": 1.0, "mrad": 1e-3 * 180 / 3.141592653589793, "rad": 180 / 3.141592653589793}


def length_m(name: str, value: Any, *, minimum: float = 0.0, maximum: float = 1e9, example: str = "0.2um") -> float:
    """The argument `name`, a length in m or a string such as "0.2um", in m."""
    if not isinstance(value, str):
        return scalar(name, value, minimum=minimum, maximum=maximum, unit=f'm (or a string with its unit, such as "{example}")')
    return scalar(name, _with_unit(name, value, _LENGTHS, "length", example), minimum=minimum, maximum=maximum, unit="m")


def angle_deg(name: str, value: Any, *, maximum: float = 90.0, example: str = "0.01deg") -> float:
    """The argument `name`, an angle in degrees or a string such as "5mrad", in degrees."""
    if not isinstance(value, str):
        return scalar(name, value, positive=True, maximum=maximum, unit="degrees")
    return scalar(name, _with_unit(name, value, _ANGLES, "angle", example), positive=True, maximum=maximum, unit="degrees")


def optional_length(name: str, value: Any, example: str) -> str:
    """A length for the compiled module, in m with its unit; an empty string for None. Errors show `example`."""
    return "" if value is None else f"{length_m(name, value, example=example):.17g}m"


def optional_angle(name: str, value: Any, example: str) -> str:
    """An angle for the compiled module, in degrees with its unit; an empty string for None. Errors show `example`."""
    return "" if value is None else f"{angle_deg(name, value, example=example):.17g}deg"


def _with_unit(name: str, value: str, units: Dict[str, float], what: str, example: str) -> float:
    m: Optional["re.Match[str]"] = re.fullmatch(r"\s*([0-9.eE+-]+?)\s*([a-zµ]+)\s*", text(name, value))
    try:
        if m is None or m[2] not in units:
            raise ValueError
        return float(m[1]) * units[m[2]]
    except ValueError:
        raise Error(f'{name}: expected {_article(what)} {what} with its unit, such as "{example}", got {shown(value)}') from None


def _article(word: str) -> str:
    return "an" if word[0] in "aeiou" else "a"
