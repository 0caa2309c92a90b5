# SPDX-License-Identifier: Apache-2.0
"""Paints by Kubelka and Munk: K and S from measurements, mixtures, recipes for a colour (docs/pigments.md).

Reflectances are fractions. "Inner" reflectances belong to the pigmented layer within its binder, "outer"
reflectances are measured through the interface to air. Wavelengths are in nm. Functions of numbers broadcast as numpy does.
"""
from __future__ import annotations

import contextlib
import csv
import functools
import math
import os
import tempfile
import warnings
from dataclasses import astuple, dataclass, field
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import complex_numbers, flag, real, scalar, text as checked_text
from ._errors import Error
from ._vectorised import broadcast, choice, last_axis, shaped

__all__ = ["Colour", "Comparison", "Fluxes", "HeldOut", "JointFit", "Layer", "Match", "Paint", "Palette", "Residuals", "Specimen", "Streams", "Surface",
           "TheoryFit", "TwoFluxError",
           "ciede2000", "coefficients", "coefficients_of_transport", "colour", "compare", "difference", "fit", "fluxes_within", "grain_index",
           "grain_names", "joint_fit", "k_over_s", "lab", "layer", "opaque_reflectance", "paint_of_grains", "saunderson", "surface",
           "two_flux_error"]

Reals = npt.NDArray[np.float64]


class Layer(NamedTuple):
    """Reflectance and transmittance of a layer alone."""

    reflectance: Reals
    transmittance: Reals


def layer(k: npt.ArrayLike, s: npt.ArrayLike, thickness: npt.ArrayLike) -> Layer:
    """A layer that absorbs `k` and scatters `s` of diffuse light per length (Kubelka 1948).

    Parameters
    ----------
    k, s : array_like
        At least 0, in the inverse of the unit of thickness.
    thickness : array_like
        At least 0.

    Returns
    -------
    Layer
        Inner reflectance and transmittance.

    Examples
    --------
    >>> from aureole import pigment
    >>> float(round(pigment.layer(0, 3, 2).reflectance, 6))  # S X/(1 + S X)
    0.857143
    """
    shape, (k_, s_, x) = broadcast(k=real("k", k, minimum=0), s=real("s", s, minimum=0),
                                   thickness=real("thickness", thickness, minimum=0))
    result = np.empty((2, k_.size))
    _aureole.pigment_layer(k_, s_, x, result)
    return Layer(shaped(result[0], shape), shaped(result[1], shape))


class Fluxes(NamedTuple):
    """Diffuse light within a layer, for an incident flux of one."""

    down: Reals
    up: Reals


def fluxes_within(k: npt.ArrayLike, s: npt.ArrayLike, thickness: npt.ArrayLike, substrate: npt.ArrayLike,
                  depth: npt.ArrayLike) -> Fluxes:
    """Downward and upward flux at a depth of a layer over a substrate (Kubelka 1948).

    Parameters
    ----------
    k, s : array_like
        Absorption and scattering of diffuse light per length, at least 0, in the inverse of the unit of thickness.
    thickness : array_like
        At least 0.
    substrate : array_like
        Diffuse reflectance below the layer, in [0, 1].
    depth : array_like
        Below the surface, in [0, thickness].

    Returns
    -------
    Fluxes
        At depth 0 `down` is 1 and `up` the inner reflectance of layer and substrate.

    Examples
    --------
    >>> from aureole import pigment
    >>> pigment.fluxes_within(0, 1, 1, 0, [0, 0.5, 1]).down.round(6)  # linear where nothing absorbs
    array([1.  , 0.75, 0.5 ])
    """
    shape, (k_, s_, x, below, at) = broadcast(
        k=real("k", k, minimum=0), s=real("s", s, minimum=0), thickness=real("thickness", thickness, minimum=0),
        substrate=real("substrate", substrate, minimum=0, maximum=1), depth=real("depth", depth, minimum=0))
    if np.any(at > x):
        raise Error(f"depth: expected at most the thickness, got {at[at > x][0]:g} in a layer of {x[at > x][0]:g}")
    result = np.empty((2, k_.size))
    _aureole.pigment_fluxes(k_, s_, x, below, at, result)
    return Fluxes(shaped(result[0], shape), shaped(result[1], shape))


def coefficients_of_transport(sigma_a: npt.ArrayLike, sigma_s: npt.ArrayLike, g: npt.ArrayLike = 0, *,
                              convention: str = "three_quarters") -> Tuple[Reals, Reals]:
    """K and S from the coefficients of radiative transfer, by one of the conventions in use (docs/pigments.md).

    Parameters
    ----------
    sigma_a, sigma_s : array_like
        Absorption and scattering coefficient per length, at least 0.
    g : array_like
        Mean cosine of the phase function, in [-1, 1].
    convention : str
        "three_quarters", "diffusion" (S is negative for strong absorbers) or "double_gauss". K = 2 sigma_a in each.

    Examples
    --------
    >>> from aureole import pigment
    >>> [float(x) for x in pigment.coefficients_of_transport(1, 100, 0.2)]
    [2.0, 60.0]
    """
    choice("convention", convention, *_aureole.pigment_conventions())
    shape, (absorbed, scattered, mean) = broadcast(
        sigma_a=real("sigma_a", sigma_a, minimum=0), sigma_s=real("sigma_s", sigma_s, minimum=0),
        g=real("g", g, minimum=-1, maximum=1))
    result = np.empty((2, absorbed.size))
    _aureole.pigment_transport(absorbed, scattered, mean, convention, result)
    return shaped(result[0], shape), shaped(result[1], shape)


def coefficients(reflectance: npt.ArrayLike, transmittance: npt.ArrayLike,
                 thickness: npt.ArrayLike) -> Tuple[Reals, Reals]:
    """K and S of a layer from its reflectance and transmittance: the inverse of `layer`."""
    shape, (r, t, x) = broadcast(reflectance=real("reflectance", reflectance, minimum=0, maximum=1),
                                 transmittance=real("transmittance", transmittance, positive=True, maximum=1),
                                 thickness=real("thickness", thickness, positive=True))
    result = np.empty((2, r.size))
    _aureole.pigment_coefficients(r, t, x, result)
    return shaped(result[0], shape), shaped(result[1], shape)


def _mapped(function: Any, values: Reals, *before: Any) -> Any:
    flat = np.ascontiguousarray(values).reshape(-1)
    result = np.empty(flat.size)
    function(*before, flat, result)
    return shaped(result, values.shape)


def opaque_reflectance(k_over_s: npt.ArrayLike) -> Any:
    """Inner reflectance of an opaque layer with a given K/S >= 0.

    Examples
    --------
    >>> from aureole import pigment
    >>> float(round(pigment.opaque_reflectance(0.5), 6))
    0.381966
    """
    return _mapped(_aureole.pigment_opaque_reflectance, real("k_over_s", k_over_s, minimum=0))


def k_over_s(reflectance: npt.ArrayLike) -> Any:
    """K/S of an opaque layer, (1 - R)^2/(2 R), from its inner reflectance in (0, 1]."""
    return _mapped(_aureole.pigment_k_over_s, real("reflectance", reflectance, positive=True, maximum=1))


class Surface(NamedTuple):
    """The interface between binder and air: outer R = seen + through R/(1 - k2 R). The default is none."""

    seen: float = 0.0
    through: float = 1.0
    k2: float = 0.0

    def outer(self, inner: npt.ArrayLike) -> Any:
        """Outer reflectance of inner ones."""
        return _mapped(_aureole.pigment_outer, real("inner", inner, minimum=0, maximum=1), tuple(self))

    def inner(self, outer: npt.ArrayLike) -> Any:
        """Inner reflectance of outer ones; an Error where no layer has them."""
        return _mapped(_aureole.pigment_inner, real("outer", outer, minimum=0), tuple(self))


def surface(geometry: str = "diffuse", *, index: float = 1.5, specular: str = "excluded", alpha: float = 0) -> Surface:
    """Returns the interface to a binder of this index.

    Parameters
    ----------
    geometry : str
        "diffuse" (irradiated and viewed from all directions), "d8" (a sphere instrument) or "45_0".
    index : float
        Of the binder, at least 1.
    specular : str
        "included" or "excluded": whether light that the interface reflects is counted.
    alpha : float
        Roughness (GGX) in [0, 1], for "diffuse".
    """
    choice("geometry", geometry, "diffuse", "d8", "45_0")
    choice("specular", specular, "included", "excluded")
    rough = scalar("alpha", alpha, minimum=0, maximum=1)
    if rough > 0 and geometry != "diffuse":
        raise Error('alpha: a rough interface needs the geometry "diffuse"')
    return Surface(*_aureole.pigment_interface(geometry, specular, scalar("index", index, minimum=1), rough))


def saunderson(k1: float, k2: float, *, specular: str = "included") -> Surface:
    """Saunderson's interface by its reflectance from outside, k1, and from within, k2."""
    choice("specular", specular, "included", "excluded")
    return Surface(*_aureole.pigment_saunderson(scalar("k1", k1), scalar("k2", k2), specular))


class TwoFluxError(NamedTuple):
    """R and L* of layers by transport, and the differences of Kubelka and Munk's results from them; NaN where S is
    negative."""

    reflectance: Reals
    error: Reals
    lightness: Reals
    lightness_error: Reals


def two_flux_error(albedo: npt.ArrayLike, thickness: npt.ArrayLike, g: npt.ArrayLike = 0, *, index: float = 1.5,
                   substrate: float = 0, convention: str = "three_quarters") -> TwoFluxError:
    """How far Kubelka and Munk are from radiative transfer, for layers in diffuse light; as `aureole pigment error`.

    Parameters
    ----------
    albedo : array_like
        Scattering over extinction, in [1e-6, 1].
    thickness : array_like
        In transport lengths, 1/(sigma_s (1 - g)), in [1e-6, 1e6].
    g : array_like
        Mean cosine of Henyey and Greenstein's phase function, in [-0.99, 0.99].
    index : float
        Of the layer, in [1, 10]; 1: no interface. Kubelka and Munk's results include it by Saunderson's correction.
    substrate : float
        Reflectance of the Lambertian surface below, in [0, 1].
    convention : str
        How S follows from sigma_s and g: "three_quarters", "diffusion" or "double_gauss" (docs/pigments.md).

    Examples
    --------
    >>> from aureole import pigment
    >>> error = pigment.two_flux_error([0.9, 1], 10, index=1)
    >>> [float(e) for e in error.error.round(3)]
    [-0.007, -0.001]
    """
    choice("convention", convention, *_aureole.pigment_conventions())
    shape, (a, x, mean) = broadcast(albedo=real("albedo", albedo, minimum=1e-6, maximum=1),
                                    thickness=real("thickness", thickness, minimum=1e-6, maximum=1e6),
                                    g=real("g", g, minimum=-0.99, maximum=0.99))
    result = np.empty((4, a.size))
    _aureole.pigment_two_flux_error(a, x, mean, scalar("index", index, minimum=1, maximum=10),
                                    scalar("substrate", substrate, minimum=0, maximum=1), convention, result)
    return TwoFluxError(*(shaped(row, shape) for row in result))


def difference(a: npt.ArrayLike, b: npt.ArrayLike, formula: str = "ciede2000", *, cmc: Tuple[float, float] = (2, 1)) -> Any:
    """Colour differences of samples `b` from standards `a`, arrays (..., 3) of L*, a*, b*.

    Parameters
    ----------
    a, b : array_like
        CMC and CIE94 take their weights from `a`, the standard.
    formula : str
        "cie1976" (Delta E*ab), "cmc", "cie94", "cie94_textiles", "ciede2000" or "din99o".
    cmc : tuple of float
        l and c of CMC(l:c).

    Examples
    --------
    >>> from aureole import pigment
    >>> float(pigment.difference([50, 0, 0], [50, 3, 4], "cie1976"))
    5.0
    """
    choice("formula", formula, "cie1976", "cmc", "cie94", "cie94_textiles", "ciede2000", "din99o")
    first, second = real("a", a), real("b", b)
    last_axis("a", first, 3)
    last_axis("b", second, 3)
    shape, (p, q) = broadcast(a=first, b=second)
    result = np.empty(p.size // 3)
    lightness, chroma = (scalar("cmc", v, positive=True) for v in cmc)
    _aureole.pigment_difference(p.reshape(-1, 3), q.reshape(-1, 3), formula, lightness, chroma, result)
    return shaped(result, shape[:-1])


def ciede2000(a: npt.ArrayLike, b: npt.ArrayLike) -> Any:
    """CIEDE2000 difference of colours (..., 3) of L*, a*, b* (Sharma, Wu & Dalal 2005)."""
    return difference(a, b)


def lab(nm: npt.ArrayLike, reflectance: npt.ArrayLike, illuminant: str = "D65") -> Reals:
    """L*, a*, b* of outer reflectances (..., len(nm)) under an illuminant.

    `illuminant` is a name of the CIE ("D65", "F11", "LED-B3"), or a file of a measured lamp (wavelength, power), with
    "/10" for the CIE 1964 observer of 10 degrees; without it the CIE 1931 observer is used.
    """
    wavelengths, r = real("nm", nm, positive=True), real("reflectance", reflectance, minimum=0)
    last_axis("reflectance", r, wavelengths.size)
    rows = _aureole.pigment_lab(wavelengths.tolist(), r.reshape(-1, wavelengths.size).tolist(), illuminant)
    return np.array(rows).reshape(r.shape[:-1] + (3,))


class Colour(NamedTuple):
    """Figures of one reflectance.

    X, Y, Z (Y = 100: a perfect diffuser); L*, a*, b*; CIE whiteness and tint (under D65, else NaN) and whether the sample
    is a white, for which they hold; yellowness of ASTM E313 (under C and D65, else NaN).
    """

    xyz: Reals
    lab: Reals
    whiteness: float
    tint: float
    is_white: bool
    yellowness: float


def colour(nm: npt.ArrayLike, reflectance: npt.ArrayLike, illuminant: str = "D65") -> Colour:
    """Colour, whiteness and yellowness of one outer reflectance; `illuminant` as for `lab`.

    Examples
    --------
    >>> from aureole import pigment
    >>> round(pigment.colour([380, 780], [0.9, 0.9], "D65/10").whiteness, 6)
    90.0
    """
    wavelengths, r = real("nm", nm, positive=True), real("reflectance", reflectance, minimum=0)
    figures, white = _aureole.pigment_figures(wavelengths.tolist(), r.tolist(), checked_text("illuminant", illuminant))
    return Colour(np.array(figures[:3]), np.array(figures[3:6]), figures[6], figures[7], white, figures[8])


class Comparison(NamedTuple):
    """A sample against a standard, sample minus standard.

    Attributes
    ----------
    lab, chroma, hue : numpy.ndarray, float, float
        Differences in L*, a*, b*, in chroma and in hue (Delta H*).
    cie1976, cmc, cie94, ciede2000, din99o : float
        Colour differences.
    strength, strength_nm, strength_summed, strength_weighted : float
        Ratio of K/S at the standard's maximum of absorption, this wavelength, and ratios of sums of K/S, plain and weighted
        by observer and illuminant; NaN where K/S cannot be told (`no_strength` says why).
    tone : numpy.ndarray
        Differences in L*, C*, H* that remain at equal strength: the tint tone; `tone_ciede2000` is their CIEDE2000.
    metamerism : dict
        Special metamerism index (Delta E*ab), by illuminant or observer.
    """

    lab: Reals
    chroma: float
    hue: float
    cie1976: float
    cmc: float
    cie94: float
    ciede2000: float
    din99o: float
    strength: float
    strength_nm: float
    strength_summed: float
    strength_weighted: float
    tone: Reals
    tone_ciede2000: float
    metamerism: Dict[str, float]
    no_strength: str


def compare(nm: npt.ArrayLike, standard: npt.ArrayLike, sample: npt.ArrayLike, *, illuminant: str = "D65",
            others: Sequence[str] = ("A", "F11"), cmc: Tuple[float, float] = (2, 1), textiles: bool = False,
            white: Union[npt.ArrayLike, None] = None, surface: Surface = Surface()) -> Comparison:
    """The common figures of the paint trade for a measured sample and its standard, as `aureole pigment colour`
    prints them.

    Parameters
    ----------
    nm, standard, sample : array_like
        Wavelengths, and outer reflectances at them.
    illuminant : str
        As for `lab`: "D65/10" is the norm of paints.
    others : sequence of str
        Illuminants and observers of the metamerism indices: "A/10", or "D65/2" for a change of observer.
    cmc : tuple of float
        l and c of CMC(l:c).
    textiles : bool
        CIE94 with the factors of textiles instead of the factors of graphic arts.
    white : array_like, optional
        Reflectance without colorant, whose K/S is subtracted for the strength.
    surface : Surface
        The interface through which all were measured; K/S belongs to the reflectance below it.

    Examples
    --------
    >>> from aureole import pigment
    >>> twice = pigment.compare([400, 700], pigment.opaque_reflectance([0.5, 0.5]), pigment.opaque_reflectance([1, 1]))
    >>> round(twice.strength, 9), round(twice.tone_ciede2000, 9)
    (2.0, 0.0)
    """
    wavelengths = real("nm", nm, positive=True)
    first, second = real("standard", standard, minimum=0), real("sample", sample, minimum=0)
    base = np.array([]) if white is None else real("white", white, minimum=0)
    for name, values in (("standard", first), ("sample", second)) + ((("white", base),) if white is not None else ()):
        if values.shape != wavelengths.shape:
            raise Error(f"{name}: expected {wavelengths.size} values, one for each wavelength, got shape {values.shape}")
    names = list(others)
    lightness, chroma = (scalar("cmc", v, positive=True) for v in cmc)
    figures, indices, reason = _aureole.pigment_compare(
        wavelengths.tolist(), first.tolist(), second.tolist(), checked_text("illuminant", illuminant), names, lightness, chroma,
        flag("textiles", textiles), base.tolist(), (surface.seen, surface.through, surface.k2))
    f = figures
    return Comparison(np.array(f[:3]), f[3], f[4], f[5], f[6], f[7], f[8], f[9], f[10], f[11], f[12], f[13], np.array(f[14:17]), f[17],
                      dict(zip(names, indices)), reason)


@dataclass(frozen=True)
class Streams:
    """The theory by streams to which K = 2 sigma_a and S = 3/4 sigma_s (1 - g) of a palette belong.

    The interface of a binder of `index` is seen by an instrument of `geometry` with its gloss `specular`; `g` is the mean
    cosine of scattering in paints that have none of their own.
    """

    index: float
    g: float
    geometry: str
    specular: str


@functools.lru_cache(maxsize=8)
def _theory(streams: Streams, varies_g: bool) -> Any:
    """The tabulated theory, some 0.5 s; with mean cosines that vary several times as much."""
    return _aureole.pigment_streams_theory(streams.index, streams.g, streams.geometry, streams.specular, varies_g)


@dataclass(frozen=True)
class Paint:
    """A mixture of a palette's paints: K and S over its wavelengths.

    Its reflectances are those of two fluxes under `surface`, or, where `streams` are given, of streams, in which layers have
    the mean cosine g with ln((1 - g)/(1 - streams.g)) = `g_shift` at each wavelength (empty: 0).
    """

    nm: Reals
    k: Reals
    s: Reals
    surface: Surface
    streams: Optional[Streams] = None
    g_shift: Reals = field(default_factory=lambda: np.array([]))

    def reflectance(self, thickness: float = math.inf, substrate: npt.ArrayLike = 0.0) -> Reals:
        """Outer reflectance: opaque, or of a thickness (in the inverse unit of K and S) over a substrate of that inner reflectance."""
        if self.streams is not None:
            depth = thickness if math.isinf(thickness) else scalar("thickness", thickness, positive=True)
            below = np.ascontiguousarray(np.broadcast_to(real("substrate", substrate, minimum=0, maximum=1), self.nm.shape))
            seen = np.empty(self.nm.size)
            shift = np.ascontiguousarray(self.g_shift) if self.g_shift.size else np.zeros(self.nm.size)
            _aureole.pigment_streams_reflectance(_theory(self.streams, self.g_shift.size > 0), np.ascontiguousarray(self.k),
                                                 np.ascontiguousarray(self.s), shift, float(depth), below, seen)
            return seen
        if math.isinf(thickness):
            ratio = np.divide(self.k, self.s, out=np.zeros_like(self.k), where=self.s > 0)
            inner = np.where(self.s > 0, opaque_reflectance(ratio), 0.0)
        else:
            free = layer(self.k, self.s, scalar("thickness", thickness, positive=True))
            below = real("substrate", substrate, minimum=0, maximum=1)
            inner = free.reflectance + free.transmittance**2 * below / (1 - free.reflectance * below)
        return np.asarray(self.surface.outer(np.minimum(inner, 1.0)))

    def contrast_ratio(self, thickness: float, *, black: float = 0.0, white: float = 0.8, illuminant: str = "D65") -> float:
        """Luminous reflectance over a black substrate divided by the one over a white substrate, given by their inner
        reflectances."""
        dark, bright = scalar("black", black, minimum=0, maximum=1), scalar("white", white, minimum=0, maximum=1)
        if not bright > dark:
            raise Error("white: must reflect more than black")
        layers = np.stack([self.reflectance(thickness, dark), self.reflectance(thickness, bright)])
        lightness = lab(self.nm, layers, illuminant)[:, 0]
        over_black, over_white = np.where(lightness > 8, ((lightness + 16) / 116) ** 3, lightness * 27 / 24389)
        return float(over_black / over_white) if over_white > 0 else 1.0

    def hiding_thickness(self, *, ratio: float = 0.98, black: float = 0.0, white: float = 0.8, illuminant: str = "D65") -> float:
        """The thickness from which the contrast ratio is at least `ratio`; infinite where it never is. As `aureole pigment hide`.

        Examples
        --------
        >>> import numpy as np
        >>> from aureole import pigment
        >>> chalk = pigment.Paint(np.array([400.0, 700.0]), np.zeros(2), np.full(2, 1e5), pigment.Surface())
        >>> round(1e6 * chalk.hiding_thickness(white=1), 3)  # S X = 49
        490.0
        """
        wanted = scalar("ratio", ratio, minimum=0.01, maximum=0.9999)
        rate = float((self.k + self.s).max())
        if not rate > 0:
            return math.inf
        return float(_aureole.pigment_hiding_thickness(
            lambda x: self.contrast_ratio(x, black=black, white=white, illuminant=illuminant), 1 / rate, wanted))


    def spreading_rate(self, solids: float, *, ratio: float = 0.98, black: float = 0.0, white: float = 0.8, illuminant: str = "D65") -> float:
        """Area that a litre of wet paint hides [m^2], at this contrast ratio; for a paint with K and S in 1/m.

        `solids` is the volume of the dry film per volume of wet paint, in (0, 1].
        """
        dry = scalar("solids", solids, positive=True, maximum=1)
        return 1e-3 * dry / self.hiding_thickness(ratio=ratio, black=black, white=white, illuminant=illuminant)


def grain_names() -> List[str]:
    """Names that `grain_index` and `paint_of_grains` know: materials, then trade names."""
    return list(_aureole.pigment_grain_names())


def grain_index(material: str, nm: npt.ArrayLike) -> npt.NDArray[np.complex128]:
    """Index n + i k of a pigment or filler by name, such as "rutile"; for crystals the mean over directions.

    Parameters
    ----------
    material : str
        One of `grain_names`; case is ignored.
    nm : array_like
        Wavelength in vacuum. Outside the range of the source the value at its limit is returned.

    Examples
    --------
    >>> from aureole import pigment
    >>> complex(pigment.grain_index("calcite", 589.3).round(3))
    (1.601+0j)
    """
    wavelengths = real("nm", nm, positive=True)
    result = np.empty(wavelengths.size, np.complex128)
    _aureole.pigment_grain_index(checked_text("material", material), np.ascontiguousarray(wavelengths).reshape(-1), result)
    return shaped(result, wavelengths.shape)  # type: ignore[no-any-return]


def paint_of_grains(nm: npt.ArrayLike, index: Union[str, npt.ArrayLike], radius: float, *, fraction: float,
                    binder: npt.ArrayLike = 1.5, spread: float = 0.0, weighting: str = "number", hard_spheres: bool = False,
                    convention: str = "three_quarters", surface: Surface = Surface()) -> Paint:
    """Paint from its microstructure: K and S [1/m] of spheres in a binder, by Mie's theory and a convention.

    K and S of several kinds of grains in one binder add.

    Parameters
    ----------
    nm : array_like
        Increasing wavelengths in vacuum.
    index : str or array_like
        Index of the grains: a name of `grain_names`, or n + i k, one for all or one for each wavelength.
    radius : float
        Radius in m; the median where there is a spread.
    fraction : float
        Fraction of the volume that the grains fill, in (0, 0.74], or (0, 0.6] with `hard_spheres`.
    binder : array_like
        Real index of the binder, one for all or one for each wavelength.
    spread : float
        Standard deviation of ln(radius), in [0, 1.5]; 0: one radius.
    weighting : str
        "number" or "volume": by which the median is stated.
    hard_spheres : bool
        Whether neighbours keep their distance, so that a dense paint scatters less than the sum of its grains. Without
        it S is too large above some 5 % of the volume.
    convention : str
        As for `coefficients_of_transport`; negative S is set to 0.
    surface : Surface
        The interface of the paint to air.

    Examples
    --------
    >>> from aureole import pigment
    >>> white = pigment.paint_of_grains([450, 550, 650], "rutile", 0.11e-6, fraction=0.1)
    >>> bool((white.s > 3e5).all()), float(white.k[1])
    (True, 0.0)
    """
    choice("convention", convention, *_aureole.pigment_conventions())
    choice("weighting", weighting, "number", "volume")
    wavelengths = real("nm", nm, positive=True)
    if wavelengths.ndim != 1 or wavelengths.size == 0 or not (np.diff(wavelengths) > 0).all():
        raise Error("nm: expected increasing wavelengths in nm")
    grains = grain_index(index, wavelengths) if isinstance(index, str) else complex_numbers("index", index)
    if not ((grains.real > 0) & (grains.imag >= 0)).all():
        raise Error("index: expected n + i k with n > 0 and k >= 0")

    def each(name: str, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        if values.shape not in ((), wavelengths.shape):
            raise Error(f"{name}: expected one number or {wavelengths.size}, one for each wavelength, got shape {values.shape}")
        return np.ascontiguousarray(np.broadcast_to(values, wavelengths.shape))

    dense = flag("hard_spheres", hard_spheres)
    result = np.empty((2, wavelengths.size))
    _aureole.pigment_grains(np.ascontiguousarray(wavelengths), each("index", grains),
                            each("binder", real("binder", binder, minimum=1, maximum=10)),
                            scalar("radius", radius, positive=True, unit="m"), scalar("spread", spread, minimum=0, maximum=1.5), weighting == "volume",
                            scalar("fraction", fraction, positive=True, maximum=0.6 if dense else 0.74), dense, convention, result)
    return Paint(wavelengths, result[0], result[1], surface)


@dataclass(frozen=True)
class Match:
    """A recipe for a colour.

    Attributes
    ----------
    recipe : dict
        Share of each paint by mass.
    difference : float
        CIEDE2000 to the target under the illuminant.
    metamerism : dict
        CIEDE2000 under the other illuminants, if the target is a reflectance.
    rms : float
        Rms of the difference in reflectance, if the target is a reflectance.
    reflectance : numpy.ndarray
    cost : float
        Per mass of the mixture; 0 without prices.
    contrast : float
        Contrast ratio over black and white at the thickness; 1 for opaque layers.
    dosing : dict
        For each paint the CIEDE2000 if its share is 1 % too large; `dosing_error` is the CIEDE2000 for independent
        errors of 1 % of all paints.
    """

    recipe: Dict[str, float]
    difference: float
    metamerism: Dict[str, float]
    rms: float
    reflectance: Reals
    cost: float = 0.0
    contrast: float = 1.0
    dosing: Dict[str, float] = field(default_factory=dict)
    dosing_error: float = 0.0


@dataclass(frozen=True)
class Palette:
    """Paints that can be mixed.

    Attributes
    ----------
    nm : numpy.ndarray
        Wavelengths.
    names : tuple of str
    k, s : numpy.ndarray
        (paints, wavelengths), as fitted: negative values count as zero in mixtures.
    k_error, s_error : numpy.ndarray
        Standard errors, NaN where not known.
    relative : bool
        K and S have no unit of length: they are relative to S of the white, or per film (`joint_fit`). Else per metre.
    surface : Surface
        Interface through which the paints were measured.
    density : numpy.ndarray
        Mass per volume of each paint, relative; empty where K and S add up by mass rather than by volume.
    streams : Streams or None
        The theory of K and S that were fitted by streams, by which mixtures and recipes are then predicted.
    g : numpy.ndarray
        Mean cosine of scattering in each paint where streams were fitted with one for each; else empty.
    """

    nm: Reals
    names: Tuple[str, ...]
    k: Reals
    s: Reals
    k_error: Reals
    s_error: Reals
    relative: bool
    surface: Surface
    density: Reals = field(default_factory=lambda: np.array([]))
    streams: Optional[Streams] = None
    g: Reals = field(default_factory=lambda: np.array([]))

    @staticmethod
    def _of(parts: Any) -> "Palette":
        nm, names, k, s, k_error, s_error, relative, interface, density, streams, g = parts

        def errors(rows: List[List[float]]) -> Reals:
            return np.array([row or [math.nan] * len(nm) for row in rows])

        return Palette(np.array(nm), tuple(names), np.array(k), np.array(s), errors(k_error), errors(s_error), relative,
                       Surface(*interface), np.array(density), None if streams is None else Streams(*streams), np.array(g))

    @staticmethod
    def load(file: Union[str, "os.PathLike[str]"]) -> "Palette":
        """A palette as `aureole pigment fit` writes it; "kimera": 13 measured acrylics, by miciwan, CC BY 4.0."""
        return Palette._of(_aureole.pigment_palette(os.fspath(file)))

    def _parts(self) -> Any:
        return (self.nm.tolist(), list(self.names), self.k.tolist(), self.s.tolist(), [], [], self.relative, tuple(self.surface),
                self.density.tolist(), None if self.streams is None else astuple(self.streams), self.g.tolist())

    def fractions(self, recipe: Union[str, Mapping[str, float]]) -> Reals:
        """Mass fractions, one for each paint, of "red: 1 + white: 3" or {"red": 1, "white": 3}."""
        if not isinstance(recipe, str):
            recipe = " + ".join(f"{name}: {scalar(f'recipe[{name!r}]', amount):.17g}" for name, amount in recipe.items())
        return np.array(_aureole.pigment_recipe(self._parts(), recipe))

    def mix(self, recipe: Union[str, Mapping[str, float]]) -> Paint:
        """A mixture by mass."""
        fractions = self.fractions(recipe)
        if self.density.size:
            fractions = fractions / self.density
            fractions /= fractions.sum()
        k, s = fractions @ np.maximum(self.k, 0), fractions @ np.maximum(self.s, 0)
        if self.streams is None or not self.g.size:
            return Paint(self.nm, k, s, self.surface, self.streams)
        # sigma_s, proportional to S/(1 - g), add up like S.
        scattering = (fractions * (1 - self.streams.g) / (1 - self.g)) @ np.maximum(self.s, 0)
        ratio = np.divide(s, scattering, out=np.ones_like(s), where=(s > 0) & (scattering > 0))
        return Paint(self.nm, k, s, self.surface, self.streams, np.log(ratio))

    def match(self, target: npt.ArrayLike, *, paints: int = 3, solutions: int = 5, illuminant: str = "D65",
              others: Sequence[str] = ("A", "F11"), least: Mapping[str, float] = {}, most: Mapping[str, float] = {},
              by: str = "colour", prices: Mapping[str, float] = {}, apart: Sequence[Tuple[str, str]] = (), smallest: float = 1e-4,
              thickness: float = math.inf, substrate: npt.ArrayLike = 1.0, opacity: float = 0.0, trade_offs: bool = False,
              within: float = 1.0) -> List[Match]:
        """Recipes of at most `paints` paints, best first.

        Parameters
        ----------
        target : array_like
            Three numbers: L*, a*, b* under `illuminant`. As many as wavelengths: an outer reflectance, which is also
            compared under `others`.
        paints, solutions : int
            Largest number of paints of a recipe, 1 to 6, and of recipes.
        least, most : mapping of str to float
            Bounds of a paint's share.
        by : str
            What recipes minimise: "colour" (under the illuminant), "lamps" (under all of them) or "spectrum" (rms).
        prices : mapping of str to float
            Price of every paint that may be used, per mass.
        apart : sequence of pairs of str
            Paints that no recipe has together.
        smallest : float
            Smallest share of a paint that can be dosed.
        thickness : float
            Of the layer, in the inverse unit of K and S; opaque by default.
        substrate : array_like
            Inner reflectance below such a layer.
        opacity : float
            Least contrast ratio over black and white (0.8) at that thickness.
        trade_offs : bool
            Return recipes with a difference of at most `within` that no other recipe surpasses in colour, cost and
            metamerism at once.
        """
        wanted = real("target", target)
        if wanted.shape not in ((3,), self.nm.shape):
            raise Error(f"target: expected 3 numbers (L*, a*, b*) or {self.nm.size} (a reflectance), got shape {wanted.shape}")
        spectral = wanted.shape == self.nm.shape
        choice("by", by, "colour", "lamps", "spectrum")

        def index(name: str, paint: str) -> int:
            if paint not in self.names:
                raise Error(f"{name}: unknown paint {paint!r}; there are {', '.join(self.names)}")
            return self.names.index(paint)

        bounds = []
        for name, given, default in (("least", least, 0.0), ("most", most, 1.0)):
            values = [default] * len(self.names)
            for paint, share in given.items():
                values[index(name, paint)] = scalar(name, share, minimum=0, maximum=1)
            bounds.append(values)
        costs: List[float] = []
        if prices:
            for paint in prices:
                index("prices", paint)
            missing = [paint for paint, most_ in zip(self.names, bounds[1]) if most_ > 0 and paint not in prices]
            if missing:
                raise Error(f"prices: there is no price of {missing[0]!r}")
            costs = [scalar("prices", prices.get(paint, 0.0), minimum=0) for paint in self.names]
        pairs = [(index("apart", one), index("apart", other)) for one, other in apart]
        depth = math.inf if math.isinf(thickness) else scalar("thickness", thickness, positive=True)
        below = np.atleast_1d(real("substrate", substrate, minimum=0, maximum=1))
        found = _aureole.pigment_match(self._parts(), [] if spectral else wanted.tolist(), wanted.tolist() if spectral else [],
                                       paints, solutions, illuminant, list(others), bounds[0], bounds[1], by, costs, pairs,
                                       scalar("smallest", smallest, minimum=0), depth, below.tolist(),
                                       scalar("opacity", opacity, minimum=0), flag("trade_offs", trade_offs),
                                       scalar("within", within, positive=True),
                                       None if self.streams is None else _theory(self.streams, self.g.size > 0))
        return [Match({n: f for n, f in zip(self.names, fractions) if f > 0}, difference, dict(zip(others, differences)), rms,
                      np.array(reflectance), cost, contrast, {n: d for n, f, d in zip(self.names, fractions, dosing) if f > 0}, total)
                for fractions, difference, differences, rms, reflectance, cost, contrast, dosing, total in found]


@contextlib.contextmanager
def _table(file: Union[str, "os.PathLike[str]"]) -> Iterator[str]:
    """Yields the name of the file; for a spreadsheet the name of a temporary text file with its first sheet."""
    name = os.fspath(file)
    if os.path.splitext(name)[1].lower() not in (".xlsx", ".xlsm", ".xls", ".xlsb", ".ods"):
        yield name
        return
    try:
        import python_calamine  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError as error:
        raise Error(f"{name}: spreadsheets need the package python-calamine; or save the sheet as text (.csv)") from error
    rows = python_calamine.CalamineWorkbook.from_path(name).get_sheet_by_index(0).to_python()
    with tempfile.TemporaryDirectory() as folder:
        text = os.path.join(folder, "sheet.csv")
        with open(text, "w", newline="", encoding="utf-8") as out:
            csv.writer(out).writerows(
                [int(cell) if isinstance(cell, float) and cell.is_integer() else cell for cell in row] for row in rows)
        try:
            yield text
        except Error as error:
            raise Error(str(error).replace(text, name)) from None


Files = Union[str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]]]


def _names(files: Files) -> List[str]:
    one = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not one:
        raise Error("file: expected at least one file")
    return [os.fspath(name) for name in one]


def _note(file: Union[str, "os.PathLike[str]"], notes: Sequence[str]) -> None:
    for note in notes:
        warnings.warn(f"{os.fspath(file)}: {note}", stacklevel=3)


def fit(file: Files, *, white: str = "white", surface: Union[Surface, None] = None) -> Palette:
    """K and S of the paints of a table of measured samples, .csv, CGATS.17, .cxf, .json or a spreadsheet (docs/pigments.md).

    Parameters
    ----------
    file : str or path, or a sequence of them
        "kimera": 13 measured acrylics, by miciwan, CC BY 4.0. Several files make one table. Spreadsheets
        need the package python-calamine. Assumptions about the file, such as per cent without a unit, are warnings.
    white : str
        The paint that tints are made with.
    surface : Surface, optional
        Interface through which the paints were measured. By default it follows from the geometry that the file
        states (CxF, CGATS), with an index of 1.5; without a stated geometry there is none.
    """
    names = _names(file)
    if surface is None and names == ["kimera"]:
        surface = Surface(*_aureole.pigment_kimera_surface())
    with contextlib.ExitStack() as stack:
        tables = [stack.enter_context(_table(name)) for name in names]
        parts, notes = _aureole.pigment_fit(tables, white, None if surface is None else (surface.seen, surface.through, surface.k2))
    _note(", ".join(names), notes)
    return Palette._of(parts)


@dataclass(frozen=True)
class Specimen:
    """How a layer of paint agrees with a joint fit.

    Attributes
    ----------
    name : str
    rms : float
        Rms of fitted minus measured reflectance; from 0.005 on the specimen is an outlier.
    weight : float
        Weight in the fit; below 1: down-weighted.
    thickness, thickness_error : float
        Fitted over stated, or over the common thickness.
    amounts : dict
        Fitted over stated amount of each paint of a mixture, and its standard error.
    """

    name: str
    rms: float
    weight: float
    thickness: float
    thickness_error: float
    amounts: Dict[str, Tuple[float, float]]


@dataclass(frozen=True)
class HeldOut:
    """A specimen that was kept back: measured and predicted reflectance (samples, wavelengths), standard deviation, CIEDE2000 (D65)."""

    specimen: str
    samples: Tuple[str, ...]
    measured: Reals
    predicted: Reals
    error: Reals
    difference: float


class TheoryFit(NamedTuple):
    """The fit of a table by one theory.

    Attributes
    ----------
    name : str
        "two fluxes" or "streams".
    cost : float
        The weighted sum of squares.
    median_rms, largest_rms : float
        Of the specimens' fitted minus measured reflectances.
    difference, coverage : float
        Mean CIEDE2000 (D65) of specimens that were kept back, and the fraction of their reflectances within the 90 % intervals
        of their predictions; NaN without such specimens.
    is_kept : bool
        Whether the palette is this theory's.
    """

    name: str
    cost: float
    median_rms: float
    largest_rms: float
    difference: float
    coverage: float
    is_kept: bool


class Residuals(NamedTuple):
    """How residuals compare with the stated noise, by which errors of K and S are stated.

    Attributes
    ----------
    relative : float
        Their rms over the degrees of freedom, in units of the stated noise; 0 where there are too few of them.
    degrees_of_freedom, values : float
        Measured values less what the unknowns take up, and their number.
    k_error, s_error, ratio_error : numpy.ndarray
        Standard errors of ln K, ln S and ln(K/S) (paints, wavelengths) by the residuals: right where the theory is exact, while
        those of the palette have the error of the theory in them. Empty where there are too few degrees of freedom.
    """

    relative: float
    degrees_of_freedom: float
    values: float
    k_error: Reals
    s_error: Reals
    ratio_error: Reals


class JointFit(NamedTuple):
    """A fit of all measurements of a table.

    Attributes
    ----------
    palette : Palette
    ratio_error : array
        Standard deviations of ln(K/S) (paints, wavelengths).
    specimens, held_out : list
        Specimens of the fit, and those that were kept back and predicted.
    g, g_error : array
        Mean cosine of scattering in each paint and its standard error, in fits by streams with `g_error`; else empty.
    theories : list
        The theories that were fitted.
    residuals : Residuals
    """

    palette: Palette
    ratio_error: Reals
    specimens: List[Specimen]
    held_out: List[HeldOut]
    g: Reals
    g_error: Reals
    theories: List[TheoryFit]
    residuals: Residuals


def joint_fit(file: Files, *, theory: str = "best", surface: Union[Surface, None] = None, index: float = 1.5,
              g: float = 0.8, g_error: float = 0, geometry: Union[str, None] = None, specular: Union[str, None] = None,
              noise: float = 0.01, relative_noise: float = 0.05, thickness_error: float = 0.15, amount_error: float = 0.1,
              hold_out: Union[str, int, Sequence[str], None] = None) -> JointFit:
    """K and S of all paints of a table from all measurements at once, as `aureole pigment fit --joint` (docs/pigments.md).

    Parameters
    ----------
    file : str or path, or a sequence of them
        As for `fit`; films over cards need no thickness.
    theory : str
        "two-flux", "streams" with the mean cosine `g`, or "best": both are fitted, and the result is that of the theory which
        predicts specimens of `hold_out` better, without them that of two fluxes. Both in a binder of `index`, seen by an
        instrument of `geometry` ("d8", "diffuse", "45_0") with its gloss `specular` ("included" or "excluded"); two fluxes also
        through any `surface`, beside which streams are those of d8 and `index`. K and S of streams are 2 sigma_a and
        3/4 sigma_s (1 - g). Where neither `geometry` nor `surface` is given, the geometry that the file states (CxF, CGATS) is
        taken, and without one no interface is taken off; a warning says so.
    g_error : float
        Relative error of 1 - g of each paint, which is then an unknown; with 0 `g` holds for all paints.
    noise, relative_noise : float
        Error of a reflectance R, the theory's own error included: `noise` and `relative_noise` times R, added in squares.
        Repeats of a specimen over one card add their own standard deviation.
    thickness_error, amount_error : float
        Relative errors of a film's thickness that is not stated, and of the amounts in mixtures.
    hold_out : str, int or sequence of str, optional
        Specimens to keep back together; a number of groups that are kept back in turn; or "each": every mixture.
    """
    choice("theory", theory, "best", "two-flux", "streams")
    if surface is not None and theory == "streams":
        raise Error('surface: is for the theory "two-flux"; "streams" takes index, geometry and specular')
    if surface is not None and not (geometry is None and specular is None):
        raise Error("surface: stands for an interface by itself; leave out geometry and specular")
    if g_error and theory == "two-flux":
        raise Error('g_error: is for the theory "streams"; two fluxes have no directions')
    if geometry is not None:
        choice("geometry", geometry, "diffuse", "d8", "45_0")
    if specular is not None:
        choice("specular", specular, "included", "excluded")
    words = [] if hold_out is None else [str(hold_out)] if isinstance(hold_out, (str, int)) else list(hold_out)
    files = _names(file)
    with contextlib.ExitStack() as stack:
        tables = [stack.enter_context(_table(name)) for name in files]
        parts, ratios, cosines, specimens, held, notes, theories, residuals = _aureole.pigment_joint_fit(
            tables, None if surface is None else (surface.seen, surface.through, surface.k2), theory, scalar("index", index, minimum=1, maximum=4),
            scalar("g", g, minimum=-0.95, maximum=0.95), scalar("g_error", g_error, minimum=0, maximum=3), geometry or "", specular or "",
            scalar("noise", noise, minimum=1e-5, maximum=0.2), scalar("relative_noise", relative_noise, minimum=0, maximum=1),
            scalar("thickness_error", thickness_error, minimum=0, maximum=3), scalar("amount_error", amount_error, minimum=0, maximum=3),
            words)
    _note(", ".join(files), notes)
    palette = Palette._of(parts)
    predictions = []
    for name, samples, measured, predicted, error, reason in held:
        if reason:
            raise Error(f"{', '.join(files)}: {name}: {reason}")
        seen, told = np.array(measured), np.array(predicted)
        difference = float(ciede2000(lab(palette.nm, seen), lab(palette.nm, np.maximum(told, 0))).mean())
        predictions.append(HeldOut(name, tuple(samples), seen, told, np.array(error), difference))
    return JointFit(palette, np.array(ratios),
                    [Specimen(one, rms, weight, thickness, spread, {paint: (factor, error) for paint, factor, error in amounts})
                     for one, rms, weight, thickness, spread, amounts in specimens], predictions,
                    np.array([one for one, _ in cosines]), np.array([error for _, error in cosines]),
                    [TheoryFit(*one) for one in theories], Residuals(*residuals[:3], *(np.array(rows) for rows in residuals[3:])))
