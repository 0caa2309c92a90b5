# SPDX-License-Identifier: Apache-2.0
"""Colours of measured reflectances, differences between them, and the figures of the paint trade. For pigment.py."""
from __future__ import annotations

from typing import Any, Dict, NamedTuple, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import flag, real, scalar, text as checked_text
from ._errors import Error
from ._paint_layers import Reals, Surface
from ._vectorised import broadcast, choice, last_axis, shaped


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
