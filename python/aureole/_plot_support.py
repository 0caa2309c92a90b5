# SPDX-License-Identifier: Apache-2.0
"""Shared by the plots: matplotlib where it is installed, axes, colours of wavelengths."""
from __future__ import annotations

import math
from typing import Any, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole, spectrum
from ._arrays import real, scalar
from ._errors import Error

Array = npt.NDArray[np.float64]


def matplotlib() -> Any:
    """The package, with pyplot loaded."""
    try:
        import matplotlib.pyplot
    except ImportError as e:
        raise ImportError("plots need matplotlib: pip install aureole[plot]") from e
    return matplotlib


def axes_for(ax: Any, *, polar: bool = False) -> Any:
    """The caller's axes, checked, or those of a new figure."""
    mpl = matplotlib()
    if ax is None:
        return mpl.pyplot.subplots(subplot_kw={"projection": "polar"} if polar else {}, layout="constrained")[1]
    if not isinstance(ax, mpl.axes.Axes):
        raise TypeError(f"ax: expected axes of matplotlib, got {type(ax).__name__}")
    if (ax.name == "polar") != polar:
        expected = "polar axes (subplot_kw={'projection': 'polar'})" if polar else "rectilinear axes"
        raise Error(f"ax: expected {expected}, got {ax.name} ones")
    return ax


def colour_of(wavelength: npt.ArrayLike) -> Array:
    """sRGB colours (..., 3) of light of single wavelengths in nm, as near as a screen comes to them (all lie outside of
    sRGB); the ends of the visible fade to grey, which represents the invisible."""
    nm = np.asarray(wavelength, np.float64)
    linear = spectrum.xyz_to_srgb(spectrum.observer(nm))
    linear = np.maximum(linear, 0)
    peak = linear.max(-1, keepdims=True)
    pure = linear / np.where(peak > 0, peak, 1)
    # Visibility of the colour to the eye; above 0.9 between 410 and 690 nm.
    seen = 1 - np.exp(-peak / 0.02)
    return spectrum.srgb_encode(np.clip(0.85 * (pure * seen + 0.12 * (1 - seen)), 0, 1))


def wavelengths_of(name: str, value: Any) -> Array:
    """One or several wavelengths as an array (n,)."""
    nm = np.atleast_1d(real(name, value, positive=True, unit="nm"))
    if nm.ndim != 1 or not 0 < nm.size <= 1000:
        raise Error(f"{name}: expected one number or a list of up to 1000 in nm, got an array of shape {nm.shape}")
    return nm


def incident(theta_i: Any) -> Tuple[float, Array]:
    """The angle of incidence in degrees and its direction, in the plane of x and z and on the side of -x."""
    degrees = scalar("theta_i", theta_i, minimum=0, maximum=180, unit="degrees")
    radians = math.radians(degrees)
    return degrees, np.array([-math.sin(radians), 0.0, math.cos(radians)])


def as_bsdf(bsdf: Any) -> Any:
    """An object with methods over arrays: a BSDF of aureole, or one written in Python."""
    if isinstance(bsdf, _aureole.Bsdf):
        return bsdf
    if isinstance(bsdf, type) or not all(callable(getattr(bsdf, name, None)) for name in ("eval", "sample", "pdf")):
        got = f"the class {bsdf.__name__}" if isinstance(bsdf, type) else type(bsdf).__name__
        raise TypeError("bsdf: expected a BSDF of aureole or an instance of a class with eval, sample and pdf, "
                        f"got {got}")
    return _aureole.python_bsdf(bsdf)


def curve(x_name: str, x: Any, y_name: str, y: Any, error: Any = None) -> Tuple[Array, Array, Optional[Array]]:
    """Checked arguments of a curve with an error band: (n,), (n,) and (n,) or None."""
    xs = np.atleast_1d(real(x_name, x))
    ys = np.atleast_1d(real(y_name, y))
    if xs.ndim != 1 or not xs.size:
        raise Error(f"{x_name}: expected numbers on one axis, got an array of shape {xs.shape}")
    if ys.shape != xs.shape:
        raise Error(f"{y_name}: expected the shape of {x_name}, {xs.shape}, got {ys.shape}")
    if error is None:
        return xs, ys, None
    errors = real("error", error, minimum=0)
    if errors.shape not in ((), xs.shape):
        raise Error(f"error: expected one number or the shape of {x_name}, {xs.shape}, got {errors.shape}")
    return xs, ys, np.broadcast_to(errors, xs.shape)


def flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: expected True or False, got {value!r}")
    return bool(value)


def p_text(p_value: Optional[float]) -> str:
    """``= 0.012``, or that it is too small for a number."""
    return "< 1e-300" if p_value is not None and p_value < 1e-300 else f"= {p_value:.2g}"
