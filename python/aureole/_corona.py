# SPDX-License-Identifier: Apache-2.0
"""Coronas around a lamp that is seen through a layer of scatterers, from a BSDF's values."""
from __future__ import annotations

import math
from typing import Any, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole, spectrum
from ._arrays import real, scalar
from ._bars import LoadBar
from ._dict import quoteattr
from ._errors import Error
from ._plot_support import as_bsdf

Array = npt.NDArray[np.float64]
Lamp = Union[str, float, Tuple[npt.ArrayLike, npt.ArrayLike]]


def layer(bsdf: Any, radius: Any, area_fraction: Any, correlation: Any, scatterer: Any) -> Tuple[Any, Optional[float]]:
    """Returns the layer that the arguments describe, and the radius in m where it is known."""
    if bsdf is not None:
        for name, value in (("radius", radius), ("area_fraction", area_fraction), ("correlation", correlation),
                            ("scatterer", scatterer)):
            if value is not None:
                raise Error(f"{name}: expected either a bsdf or a description of the layer, got both")
        return as_bsdf(bsdf), None
    if radius is None or area_fraction is None:
        raise Error(f"{'radius' if radius is None else 'area_fraction'}: expected a value, or a bsdf instead, got None")
    parts: List[Tuple[str, str, str]] = []
    metres: Optional[float] = None
    if isinstance(radius, str):
        parts.append(("string", "radius", radius))
    else:
        metres = scalar("radius", radius, minimum=1e-8, maximum=1e-2,
                        unit='m (or a string with its unit, such as "5um")')
        parts.append(("string", "radius", f"{metres!r}m"))
    fraction = scalar("area_fraction", area_fraction, positive=True, maximum=0.9069)
    parts.append(("float", "area_fraction", repr(fraction)))
    for name, value in (("correlation", correlation), ("scatterer", scatterer)):
        if value is not None and not isinstance(value, str):
            raise TypeError(f"{name}: expected a string, got {type(value).__name__}")
    if scatterer is not None:
        parts.append(("string", "scatterer", scatterer))
    lines = [f"<{tag} name={quoteattr(name)} value={quoteattr(value)}/>" for tag, name, value in parts]
    if correlation is not None:
        lines.append(f"<correlation type={quoteattr(correlation)}/>")
    text = f'<scene version="3.0.0"><bsdf type="correlated_scatterers">{"".join(lines)}</bsdf></scene>'
    with LoadBar("the layer", shows_time=False):
        made = _aureole.load_object(text, "<layer>", 360.0, 830.0, {})
    if isinstance(radius, str):
        units = {"nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0}
        number = radius.strip()
        for unit in units:
            if number.endswith(unit):
                try:
                    metres = float(number[:-len(unit)]) * units[unit]
                    break
                except ValueError:
                    pass
    return made, metres


def field_of(radius: Optional[float]) -> float:
    """Returns half the field of view in degrees that contains three rings in red light."""
    if radius is None:
        return 6.0
    return math.degrees(math.asin(min(0.7, 3.24 * 0.5 * 650e-9 / radius)))


def radiance(bsdf: Any, x: Array, y: Array, wavelengths: Array) -> Array:
    """Radiance (..., n) seen `x` to the right of and `y` above a lamp (degrees) that gives unit irradiance, behind the
    layer and square to it."""
    angle = np.radians(np.hypot(x, y))
    along = -np.sinc(angle / np.pi) * math.pi / 180
    # Directions from the layer to the eye, opposite to the view direction, and from the layer to the lamp.
    wi = np.stack([along * x, along * y, np.cos(angle)], -1)
    values = bsdf.eval(wi[..., None, :], np.array([0.0, 0.0, -1.0]), wavelengths)
    return np.asarray(values, np.float64)


def lamp_colours(lamp: Any, wavelengths: Array) -> Tuple[Array, Array]:
    """Returns wavelengths at which the layer is evaluated, and the matrix (n, 3) that takes values there to linear sRGB; the lamp
    has Y = 1."""
    if isinstance(lamp, str):
        identity = spectrum.to_xyz(wavelengths, np.eye(wavelengths.size), lamp, outside="nearest")
        return wavelengths, spectrum.xyz_to_srgb(identity)
    if isinstance(lamp, (int, float, np.number)) and not isinstance(lamp, bool):
        nm = scalar("lamp", lamp, minimum=380, maximum=780, unit="nm")
        xyz = spectrum.observer(nm)
        return np.array([nm]), spectrum.xyz_to_srgb(xyz / xyz[1])[None, :]
    if not isinstance(lamp, (tuple, list)) or len(lamp) != 2:
        raise TypeError("lamp: expected an illuminant's name, a wavelength in nm, or a pair of wavelengths and powers, "
                        f"got {type(lamp).__name__}")
    at, power = real("lamp", lamp[0], positive=True, unit="nm"), real("lamp", lamp[1], minimum=0)
    if at.ndim != 1 or at.size < 2 or np.any(np.diff(at) <= 0) or power.shape != at.shape:
        raise Error("lamp: expected increasing wavelengths and as many powers, "
                    f"got shapes {at.shape} and {power.shape}")
    # The light's own wavelengths are included, since its spectrum may have lines.
    inside = at[(at > wavelengths[0]) & (at < wavelengths[-1])]
    both = np.unique(np.concatenate([wavelengths, inside]))
    if both.size > 2000:
        raise Error(f"lamp: expected up to 2000 wavelengths, got {at.size}")
    light = np.interp(both, at, power, left=0.0, right=0.0)
    if not np.any(light > 0):
        raise Error("lamp: expected some power between 380 and 780 nm, got none")
    identity = spectrum.to_xyz(both, np.eye(both.size), light, outside="nearest")
    return both, spectrum.xyz_to_srgb(identity)


def picture(bsdf: Any, lamp: Lamp, lamp_diameter: float, field: float, resolution: int, wavelengths: Array) -> Array:
    """Linear sRGB (resolution, resolution, 3) of the light around the lamp, first row on top, where the lamp gives unit
    illuminance."""
    nm, to_rgb = lamp_colours(lamp, wavelengths)
    pixel = 2 * field / resolution
    # The margin holds pixels beyond the edges, whose light spreads into the picture where the lamp is not a
    # point.
    margin = math.ceil(0.5 * lamp_diameter / pixel) if lamp_diameter > 0.5 * pixel else 0
    n = resolution + 2 * margin
    at: Array = (np.arange(n, dtype=np.float64) - 0.5 * (n - 1)) * pixel
    rgb = np.empty((n, n, 3))
    for row in range(n):
        rgb[row] = radiance(bsdf, at, np.full(n, -at[row]), nm) @ to_rgb
    if margin:
        kernel = disc(margin, 0.5 * lamp_diameter / pixel)
        size = n + 2 * margin
        transform = np.fft.rfft2(kernel, (size, size))[..., None]
        rgb = np.fft.irfft2(np.fft.rfft2(rgb, (size, size), axes=(0, 1)) * transform, (size, size), axes=(0, 1))
        rgb = rgb[2 * margin:2 * margin + resolution, 2 * margin:2 * margin + resolution]
    return np.asarray(rgb)


def disc(half: int, radius: float) -> Array:
    """Returns weights (2 half + 1, 2 half + 1), of sum one, of the pixels of a disc whose radius is `radius` pixels."""
    over = 8
    at = (np.arange((2 * half + 1) * over) + 0.5) / over - half - 0.5
    inside = (at[:, None] ** 2 + at[None, :] ** 2 <= radius**2).astype(np.float64)
    weights = inside.reshape(2 * half + 1, over, 2 * half + 1, over).mean((1, 3))
    return np.asarray(weights / weights.sum())


def display(linear: Array) -> Array:
    """sRGB for the screen of linear values. Colours outside of its gamut are mixed with grey of the same luminance, as little as
    is needed: hues do not change, and colours that are too bright become paler, up to white."""
    grey = np.clip(linear @ np.array([0.2126, 0.7152, 0.0722]), 0, 1)[..., None]
    away = linear - grey
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(away > 0, (1 - grey) / away, np.where(away < 0, -grey / away, 1.0))
    share = np.clip(room.min(-1, keepdims=True), 0, 1)
    return spectrum.srgb_encode(np.clip(grey + share * away, 0, 1))
