# SPDX-License-Identifier: Apache-2.0
"""Observer, illuminants, colours and refractive indices: the renderer's tables and conversions on arrays.

Wavelengths are in nm and in vacuum. Spectra are piecewise linear between their wavelengths.
"""
from __future__ import annotations

from typing import Any, List, NamedTuple, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._apertures import _flag
from ._arrays import real
from ._errors import Error
from ._vectorised import broadcast, choice, last_axis, limit_results, shaped

__all__ = ["Material", "blackbody", "illuminant", "illuminants", "material", "materials", "observer",
           "refractive_index", "srgb_decode", "srgb_encode", "to_srgb", "to_xyz", "upsample", "xyz_to_srgb"]

Reals = npt.NDArray[np.float64]


class Material(NamedTuple):
    """Result of `material`.

    Attributes
    ----------
    name : str
    minimum, maximum : float
        Range of the data in nm; 0 and infinity for a constant.
    dispersive : bool
        The index depends on the wavelength.
    absorbing : bool
        The index is complex.
    source : str
        Where the numbers come from.
    """

    name: str
    minimum: float
    maximum: float
    dispersive: bool
    absorbing: bool
    source: str


def observer(wavelength: npt.ArrayLike) -> Reals:
    """Colour matching functions of the CIE 1931 standard observer (2 degrees).

    Parameters
    ----------
    wavelength : array_like
        In nm.

    Returns
    -------
    numpy.ndarray, shape ``wavelength.shape + (3,)``
        xbar, ybar, zbar as published (CIE 018:2019), 360-830 nm every 1 nm, linear between, 0 outside. The integral of
        ybar is 106.8569 nm.

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.observer(555).round(4)
    array([0.5121, 1.    , 0.0057])
    """
    nm = _wavelengths("wavelength", wavelength)
    limit_results("wavelength", nm.shape, (3,))
    at, *values = _aureole.observer_table()
    return np.stack([np.interp(nm, at, v, left=0.0, right=0.0) for v in values], axis=-1)


def illuminants() -> List[str]:
    """Names of the illuminants that `illuminant` knows."""
    return list(_aureole.illuminant_names())


def illuminant(name: str, wavelength: npt.ArrayLike, *, normalize: str = "luminance", outside: str = "error") -> Reals:
    """A CIE illuminant.

    Parameters
    ----------
    name : str
        A, B, C, D50, D55, D65, D75, E, FL1 ... (F1 ... for short) and the other lamps of the CIE's tables; case is
        ignored. `illuminants` lists them.
    wavelength : array_like
        In nm.
    normalize : {"luminance", "table"}
        "luminance" scales to the luminance of a constant spectrum of 1, as the renderer does: S ybar and ybar have
        equal integrals. "table" keeps the published values, which for A and the D series are 100 at 560 nm.
    outside : {"error", "zero"}
        Whether wavelengths outside of the table raise an error or give 0, as in the renderer.

    Returns
    -------
    numpy.ndarray
        Relative spectral power of the shape of `wavelength`.

    References
    ----------
    CIE 15:2004 and CIE 015:2018, Colorimetry.

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.illuminant("D65", [460, 560], normalize="table")
    array([117.812, 100.   ])
    """
    nm = _wavelengths("wavelength", wavelength)
    at, values, scale = _illuminant("name", name)
    choice("normalize", normalize, "luminance", "table")
    if choice("outside", outside, "error", "zero") == "error":
        _require_range("wavelength", nm, at[0], at[-1], f"illuminant {name}")
    result = np.interp(nm, at, values, left=0.0, right=0.0)
    return np.asarray(result * scale if normalize == "luminance" else result)[()]


def blackbody(temperature: npt.ArrayLike, wavelength: npt.ArrayLike) -> Reals:
    """Spectral radiance of a black body (Planck's law).

    Parameters
    ----------
    temperature : array_like
        In K.
    wavelength : array_like
        In nm.

    Returns
    -------
    numpy.ndarray
        In W/(m^2 sr nm), of the shape that the arguments broadcast to.

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.blackbody([2856, 6504], 560).round(0)
    array([  268., 42448.])
    """
    kelvin = real("temperature", temperature, positive=True, maximum=1e12, unit="K")
    shape, (t, nm) = broadcast(temperature=kelvin, wavelength=_wavelengths("wavelength", wavelength))
    # Exact by the definition of the SI units (2019).
    planck, light, boltzmann = 6.62607015e-34, 299792458.0, 1.380649e-23
    metres = nm * 1e-9
    with np.errstate(over="ignore", divide="ignore"):
        result = 1e-9 * 2 * planck * light**2 / (metres**5 * np.expm1(planck * light / (metres * boltzmann * t)))
    return shaped(result, shape)  # type: ignore[no-any-return]


def to_xyz(wavelengths: npt.ArrayLike, values: npt.ArrayLike, illuminant: Optional[Union[str, npt.ArrayLike]] = None, *,
           outside: str = "zero") -> Reals:
    """Tristimulus values of spectra, CIE 1931.

    Parameters
    ----------
    wavelengths : array_like, shape (n,)
        Increasing, in nm, with a part in 360-830 nm.
    values : array_like, shape (..., n)
        Spectra; linear between wavelengths.
    illuminant : str or array_like of shape (n,), optional
        None: `values` are radiances, and a flat spectrum of one has Y = 1 (683.002 lm/W times 106.8569 nm times Y is
        the luminance in photometric units). Otherwise they are reflectances under a light, by name or by values at
        `wavelengths`, and a reflectance of one has Y = 1.
    outside : {"zero", "nearest"}
        How spectra continue beyond their first and last wavelength: as 0, which is the renderer's rule, or as their
        value there, which is better for reflectances measured over a part of the visible.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        X, Y, Z: integrals of piecewise linear functions without further error, as the film takes them. However fine the
        wavelengths, no line is missed.

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.to_xyz([360, 830], [1, 1], "D65").round(4)
    array([0.9505, 1.    , 1.0888])
    """
    nm, spectra = _wavelengths("wavelengths", wavelengths), real("values", values, minimum=-1e28, maximum=1e28)
    if nm.ndim != 1 or nm.size < 2 or np.any(np.diff(nm) <= 0):
        raise Error(f"wavelengths: expected two or more increasing numbers on one axis, got shape {nm.shape}")
    last_axis("values", spectra, nm.size)
    limit_results("wavelengths", nm.shape, (3,))
    limit_results("values", spectra.shape[:-1], (3,))
    if nm[-1] <= 360 or nm[0] >= 830:
        raise Error(f"wavelengths: expected a part in the visible, 360-830 nm, got {nm[0]:g}-{nm[-1]:g} nm")
    weights = _weights(nm, illuminant, choice("outside", outside, "zero", "nearest") == "nearest")
    return spectra @ weights


def to_srgb(wavelengths: npt.ArrayLike, values: npt.ArrayLike, illuminant: Optional[Union[str, npt.ArrayLike]] = None,
            *, encoded: bool = True, outside: str = "zero") -> Reals:
    """Colours of spectra in sRGB, whose white is D65.

    Parameters
    ----------
    wavelengths, values, illuminant, outside
        As in `to_xyz`. There is no adaptation: a white under illuminant A is orange.
    encoded : bool
        For display, cut to [0, 1] and encoded; otherwise linear, with negative components for colours that sRGB does
        not have.

    Returns
    -------
    numpy.ndarray, shape (..., 3)

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.to_srgb([360, 830], [[1, 1], [0.2, 0.2]], "D65").round(3)
    array([[1.   , 1.   , 1.   ],
           [0.485, 0.485, 0.485]])
    """
    linear = xyz_to_srgb(to_xyz(wavelengths, values, illuminant, outside=outside))
    return srgb_encode(np.clip(linear, 0, 1)) if _flag("encoded", encoded) else linear


def xyz_to_srgb(xyz: npt.ArrayLike) -> Reals:
    """Linear sRGB (IEC 61966-2-1) of tristimulus values.

    Parameters
    ----------
    xyz : array_like, shape (..., 3)
        Y = 1 for white.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        To single precision, as in the renderer.
    """
    values = real("xyz", xyz, minimum=-1e30, maximum=1e30)
    last_axis("xyz", values, 3)
    limit_results("xyz", values.shape)
    result = np.empty((values.size // 3, 3))
    _aureole.xyz_to_srgb(np.ascontiguousarray(values).reshape(-1, 3), result)
    return result.reshape(values.shape)


def srgb_encode(linear: npt.ArrayLike) -> Reals:
    """The transfer function of sRGB (IEC 61966-2-1), from linear values to encoded ones, to single precision."""
    return _curve("linear", linear, _aureole.srgb_encode, 1e30)


def srgb_decode(encoded: npt.ArrayLike) -> Reals:
    """The inverse of `srgb_encode`."""
    return _curve("encoded", encoded, _aureole.srgb_decode, 1e15)


def upsample(rgb: npt.ArrayLike, wavelength: npt.ArrayLike, *, unbounded: bool = False, method: str = "fit") -> Reals:
    """Smooth spectra that have given colours under D65, as the renderer makes them.

    Parameters
    ----------
    rgb : array_like, shape (..., 3)
        Linear sRGB, in [0, 1]; not negative and up to 1e30 with `unbounded`.
    wavelength : array_like
        In nm; outside of 360-830 nm the spectrum keeps its value at the end.
    unbounded : bool
        The spectrum is scaled to the colour's largest component, as for an emitter, whose spectrum is multiplied by
        D65.
    method : {"fit", "table"}
        "fit" is used for colours in scene files, with a Delta E (CIE 1976) below 0.002 and some 20 us for each;
        "table" for textures, with a Delta E below 0.25.

    Returns
    -------
    numpy.ndarray, shape ``rgb.shape[:-1] + wavelength.shape``
        Reflectances in [0, 1], nearly flat where all components are near 1, or a factor of the illuminant if
        `unbounded`.

    References
    ----------
    Jakob & Hanika, "A low-dimensional function space for efficient spectral upsampling", 2019.

    Examples
    --------
    >>> import numpy as np
    >>> from aureole import spectrum
    >>> nm = np.arange(360, 831)
    >>> red = spectrum.upsample([0.6, 0.1, 0.1], nm)
    >>> spectrum.to_srgb(nm, red, "D65", encoded=False).round(3)
    array([0.6, 0.1, 0.1])
    """
    if _flag("unbounded", unbounded):
        colors = real("rgb", rgb, minimum=0, maximum=1e30)
    else:
        colors = real("rgb", rgb, minimum=0, maximum=1)
    last_axis("rgb", colors, 3)
    nm = _wavelengths("wavelength", wavelength)
    table = choice("method", method, "fit", "table") == "table"
    limit_results("rgb and wavelength", colors.shape[:-1], nm.shape)
    result = np.empty((colors.size // 3, nm.size))
    _aureole.upsample(np.ascontiguousarray(colors).reshape(-1, 3), np.ascontiguousarray(nm).reshape(-1), table,
                      bool(unbounded), result)
    return shaped(result, colors.shape[:-1] + nm.shape)  # type: ignore[no-any-return]


def materials() -> List[str]:
    """Names of the materials that `refractive_index` knows, aliases included."""
    return list(_aureole.material_names())


def material(name: str, *, dispersion: bool = True) -> Material:
    """Range and source of a material's refractive index.

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.material("bk7").source
    'Schott N-BK7 data sheet'
    """
    text = _text("name", name)
    return Material(text, *_aureole.material(text, _flag("dispersion", dispersion)))


def refractive_index(name: str, wavelength: npt.ArrayLike, *, dispersion: bool = True) -> npt.NDArray[Any]:
    """Refractive index of a material.

    Parameters
    ----------
    name : str
        Such as "bk7", "water" or "Au"; case is ignored. `materials` lists them.
    wavelength : array_like
        In nm, in vacuum; within the range of the data, which the error states and `material` returns.
    dispersion : bool
        False: dielectrics have the constant index that Mitsuba has under the name, or else the index at 589.3 nm.

    Returns
    -------
    numpy.ndarray of float64 or complex128
        n, or n + i k (k >= 0) where the material absorbs, of the shape of `wavelength`. The renderer clamps wavelengths
        to the range instead.

    Examples
    --------
    >>> from aureole import spectrum
    >>> spectrum.refractive_index("bk7", [486.1, 587.6, 656.3]).round(4)
    array([1.5224, 1.5168, 1.5143])
    >>> spectrum.refractive_index("Au", [500, 600]).round(2)
    array([0.85+1.89j, 0.22+3.j  ])
    """
    found = material(name, dispersion=dispersion)
    nm = _wavelengths("wavelength", wavelength)
    _require_range("wavelength", nm, found.minimum, found.maximum, found.name)
    limit_results("wavelength", nm.shape)
    result = np.empty(nm.size, np.complex128)
    _aureole.refractive_index(found.name, bool(dispersion), np.ascontiguousarray(nm).reshape(-1), result)
    return shaped(result if found.absorbing else result.real.copy(), nm.shape)  # type: ignore[no-any-return]


def _wavelengths(name: str, value: Any) -> Reals:
    return real(name, value, minimum=1e-3, maximum=1e12, unit="nm")


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a string, got {type(value).__name__}")
    return value.encode("utf-8", "replace").decode()


def _illuminant(argument: str, name: Any) -> Tuple[Reals, Reals, float]:
    try:
        at, values, scale = _aureole.illuminant_table(_text(argument, name))
    except Error as e:
        raise Error(str(e).replace("name:", argument + ":", 1)) from None
    return at, values, scale


def _require_range(argument: str, nm: Reals, low: float, high: float, what: str) -> None:
    wrong = (nm < low) | (nm > high)
    if np.any(wrong):
        raise Error(f"{argument}: expected {low:g} to {high:g} nm, the range of the data of {what}, got "
                    f"{nm[wrong].flat[0]:g}")


def _curve(name: str, value: Any, function: Any, largest: float) -> Reals:
    values = real(name, value, minimum=-largest, maximum=largest)
    limit_results(name, values.shape)
    result = np.empty(values.size)
    function(np.ascontiguousarray(values).reshape(-1), result)
    return shaped(result, values.shape)  # type: ignore[no-any-return]


def _weights(nm: Reals, light: Any, nearest: bool) -> Reals:
    """Matrix (n, 3) that takes values at `nm` to X, Y, Z.

    Value times light times observer is cubic between any two neighbours of all their wavelengths, and Simpson's rule
    exact.
    """
    at, *curves = _aureole.observer_table()
    places = [at, nm]
    if light is None:
        light_at, light_values = np.array([360.0, 830.0]), np.ones(2)
    elif isinstance(light, str):
        light_at, light_values, _ = _illuminant("illuminant", light)
        places.append(light_at)
    else:
        light_at, light_values = nm, real("illuminant", light, minimum=0, maximum=1e28)
        if light_values.shape != nm.shape:
            raise Error(f"illuminant: expected a name or an array of the shape of wavelengths, {nm.shape}, got "
                        f"{light_values.shape}")
    edges = np.unique(np.clip(np.concatenate(places), 360.0, 830.0))
    low, high = edges[:-1], edges[1:]
    total = np.zeros(3)
    weights: Reals = np.zeros((nm.size, 3))
    middles = 0.5 * (low + high)
    # The neighbours in `nm` of each piece. Beyond the ends of `nm` both are the end.
    right = np.searchsorted(nm, middles)
    outside = (right == 0) | (right == nm.size)
    left = np.clip(right - 1, 0, nm.size - 1)
    right = np.minimum(right, nm.size - 1)
    distance = np.where(outside, 1.0, nm[right] - nm[left])
    for x, share in ((low, 1.0), (middles, 4.0), (high, 1.0)):
        # A named light is 0 beyond its table; a light given by values continues like the spectra. The ends of the
        # light, where it may jump to 0, are ends of pieces, so that the middle of a piece decides on which side it
        # lies.
        power = np.interp(x, light_at, light_values)
        if light is not None and not (nearest and not isinstance(light, str)):
            power = np.where((middles < light_at[0]) | (middles > light_at[-1]), 0.0, power)
        step = share * (high - low) / 6 * power
        part = np.where(outside, 0.0, (x - nm[left]) / distance)
        for c, curve in enumerate(curves):
            w = step * np.interp(x, at, curve)
            total[c] += w.sum()
            if not nearest:
                w = np.where(outside, 0.0, w)
            np.add.at(weights[:, c], left, (1 - part) * w)
            np.add.at(weights[:, c], right, part * w)
    if not total[1] > 0:
        raise Error("illuminant: expected one with a luminance above 0")
    weights /= total[1]
    return weights
