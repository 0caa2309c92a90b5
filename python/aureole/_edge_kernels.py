# SPDX-License-Identifier: Apache-2.0
"""Edges as scatterers of light. See `aureole.optics`."""
from __future__ import annotations

from typing import Any, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import complex_numbers, integer, real, scalar
from ._errors import Error
from ._vectorised import broadcast, last_axis, of_rows, shaped

Reals = npt.NDArray[np.float64]


def mean_edge_kernel(edges: npt.ArrayLike, index: int, at: npt.ArrayLike, q: npt.ArrayLike, k: float, sigma: float) -> Reals:
    """Intensity per length of edge and steradian that points of an edge scatter from uniform light of irradiance 1. The
    light consists of Gaussian beams with centres everywhere; its coherence is exp(-r^2/(8 sigma^2)).

    Parameters
    ----------
    edges : array_like, shape (n, 2, 2)
        All edges nearby, as in `EdgeWaves`, in the plane across the sum of the directions before and after.
    index : int
        Which edge the points are on.
    at : array_like
        Fractions of its length, in [0, 1].
    q : array_like, shape (2,)
    k : float
        Wave number 2 pi/wavelength.
    sigma : float
        Standard deviation of the beams' intensity.

    Returns
    -------
    numpy.ndarray, shape of `at`
        In length/sr. Integrated over the directions along a straight edge, it is wavelength/(4 pi^2 theta^2) per
        radian in the shadow.
    """
    rows, chosen = _projected(edges, index, None)
    wave = real("q", q)
    if wave.shape != (2,):
        raise Error(f"q: expected an array of shape (2,), got shape {wave.shape}")
    return of_rows(lambda arguments, result: _aureole.mean_edge_kernel(rows, chosen, arguments, result),  # type: ignore[no-any-return]
                   at=real("at", at, minimum=0, maximum=1), q_x=wave[0], q_y=wave[1],
                   k=np.asarray(scalar("k", k, positive=True)), sigma=np.asarray(scalar("sigma", sigma, positive=True)))


def mean_edge_powers(edges: npt.ArrayLike, index: int, at: npt.ArrayLike, k: npt.ArrayLike, sigma: npt.ArrayLike, *,
                     lengths: Optional[npt.ArrayLike] = None) -> Reals:
    """Power per length of edge that points of an edge scatter from uniform light of irradiance 1 into all directions: S, the integral
    of `mean_edge_kernel` over them, for beams of more than some 5 wavelengths.

    Parameters
    ----------
    edges : array_like, shape (n, 2, 2)
        All edges nearby, as in `EdgeWaves`, in the plane across the light that arrives.
    index : int
        Which edge the points are on.
    at, k, sigma : array_like
        Fractions of its length in [0, 1], wave numbers, and standard deviations of the beams' intensity; they broadcast.
    lengths : array_like, shape (n,), optional
        Of the edges in space, where they are not perpendicular to the light.

    Returns
    -------
    numpy.ndarray
        In units of length. A closed form except for a quadrature along the edges, with errors of some 0.2 % in beams
        of 25 wavelengths and 2.5 % in beams of 5 (docs/optics.md).

    Examples
    --------
    A straight edge has sigma (ln(1 + 2^(1/2)) + 2^(1/2) - 1)/(2 pi)^(1/2):

    >>> import math
    >>> from aureole import optics
    >>> round(float(optics.mean_edge_powers([[(0, -50), (0, 50)]], 0, 0.5, 2 * math.pi, 2.0) / 2.0), 3)
    0.517
    """
    rows, chosen = _projected(edges, index, lengths)
    return of_rows(lambda arguments, result: _aureole.mean_edge_powers(rows, chosen, arguments, result),  # type: ignore[no-any-return]
                   at=real("at", at, minimum=0, maximum=1), k=_scale("k", k), sigma=_scale("sigma", sigma))


def drawn_edge_kernels(edges: npt.ArrayLike, index: int, normal: npt.ArrayLike, turn: npt.ArrayLike, k: npt.ArrayLike,
                       sigma: npt.ArrayLike, *, lengths: Optional[npt.ArrayLike] = None) -> Reals:
    """Kernels of an edge of a group for sampled wave vectors. They are never negative, and the time grows with the
    number of edges instead of the number of pairs of edges. Summed over the edges, weighted by their lengths, and
    averaged over normal numbers, they agree with `mean_edge_kernel`.

    Parameters
    ----------
    edges : array_like, shape (n, 2, 2)
        The group, as in `EdgeWaves`, in the plane across the sum of the directions before and after, the difference of both along x.
    index : int
        Of the edge.
    normal : array_like, shape (..., 2)
        Independent numbers of the standard normal distribution: wave vectors times 2 sigma.
    turn, k, sigma : array_like
        Length of the difference of the two directions, in (0, 2], wave numbers, and standard deviations of the beams' intensity. They
        broadcast with each other and with the first axes of `normal`.
    lengths : array_like, shape (n,), optional
        Of the edges in space, where they are not perpendicular to the sum of the directions.

    Returns
    -------
    numpy.ndarray
        Intensity per length of edge and steradian under an irradiance of 1, in length/sr.
    """
    rows, chosen = _projected(edges, index, lengths)
    numbers = real("normal", normal)
    last_axis("normal", numbers, 2)
    return of_rows(lambda arguments, result: _aureole.drawn_edge_kernels(rows, chosen, arguments, result),  # type: ignore[no-any-return]
                   normal_x=numbers[..., 0], normal_y=numbers[..., 1], turn=real("turn", turn, positive=True, maximum=2),
                   k=_scale("k", k), sigma=_scale("sigma", sigma))


def straight_edge_kernels(across: npt.ArrayLike, along: npt.ArrayLike, k: npt.ArrayLike, sigma: npt.ArrayLike, *,
                          shown: npt.ArrayLike = 1.0) -> Reals:
    """Intensity per length and steradian that a straight edge far from all others scatters from uniform light of irradiance 1, the
    gradient of the amplitude along it included.

    Parameters
    ----------
    across, along : array_like
        Components of the difference of the directions before and after (unit vectors), across and along the edge as
        projected along the sum of the directions.
    k, sigma : array_like
        Wave numbers, and standard deviations of the beams' intensity.
    shown : array_like
        Length of the projected edge over its length, in [0, 1].

    Returns
    -------
    numpy.ndarray
        In length/sr; 0 where `across` is 0. Integrated over the directions along the edge, it is wavelength/(4 pi^2
        theta^2) per radian, as by Keller's coefficient, within 1 % from theta = 3/(2 k sigma) on.
    """
    return of_rows(_aureole.straight_edge_kernels,  # type: ignore[no-any-return]
                   across=_turn("across", across), along=_turn("along", along), shown=real("shown", shown, minimum=0, maximum=1),
                   k=_scale("k", k), sigma=_scale("sigma", sigma))


def straight_edge_power(cosine: npt.ArrayLike, k: npt.ArrayLike, sigma: npt.ArrayLike) -> Reals:
    """Integral of `straight_edge_kernels` over all directions, in units of length; `cosine` of the angle between light and edge.

    Examples
    --------
    >>> import math
    >>> from aureole import optics
    >>> round(float(optics.straight_edge_power(0.0, 2 * math.pi, 2.0) / 2.0), 3)
    0.512
    """
    return of_rows(_aureole.straight_edge_power,  # type: ignore[no-any-return]
                   cosine=real("cosine", cosine, minimum=-1, maximum=1), k=_scale("k", k), sigma=_scale("sigma", sigma))


def straight_edge_corrections(across: npt.ArrayLike, along: npt.ArrayLike, k: npt.ArrayLike, sigma: npt.ArrayLike, *,
                              shown: npt.ArrayLike = 1.0, weight: npt.ArrayLike = 1.0) -> Reals:
    """Excess of `straight_edge_kernels` over `mean_edge_kernel` on an endless straight edge, times `weight`.

    Pictures add it to the mean kernel near corners and other edges, with the weight of `straight_edge_weights`.

    Parameters
    ----------
    across, along, k, sigma, shown : array_like
        As in `straight_edge_kernels`.
    weight : array_like
        In [0, 1].

    Returns
    -------
    numpy.ndarray
        In length/sr.
    """
    return of_rows(_aureole.straight_edge_corrections,  # type: ignore[no-any-return]
                   across=_turn("across", across), along=_turn("along", along), shown=real("shown", shown, minimum=0, maximum=1),
                   weight=real("weight", weight, minimum=0, maximum=1), k=_scale("k", k), sigma=_scale("sigma", sigma))


def straight_edge_power_correction(cosine: npt.ArrayLike, sigma: npt.ArrayLike) -> Reals:
    """Integral of `straight_edge_corrections` of weight 1 over all directions, in units of length; `cosine` of the angle between
    light and edge."""
    return of_rows(_aureole.straight_edge_power_correction,  # type: ignore[no-any-return]
                   cosine=real("cosine", cosine, minimum=-1, maximum=1), sigma=_scale("sigma", sigma))


def straight_edge_weights(place: npt.ArrayLike, before: npt.ArrayLike, after: npt.ArrayLike, others: npt.ArrayLike,
                          sigma: npt.ArrayLike) -> Reals:
    """The fraction of the coherent light about a point on an edge that belongs to the edge's straight line alone.

    Parameters
    ----------
    place : array_like, shape (2,)
        In the plane across the light.
    before, after : array_like
        Distances from the place to the ends of the line, as they are seen.
    others : array_like, shape (n, 2, 2)
        The ends of all other edges nearby, in that plane; empty where there are none.
    sigma : array_like
        Standard deviation of the beams' intensity.

    Returns
    -------
    numpy.ndarray
        In [0, 1]; `before`, `after` and `sigma` broadcast.

    Examples
    --------
    At the end of a line half of the light belongs to it:

    >>> from aureole import optics
    >>> round(float(optics.straight_edge_weights((0, 0), 50.0, 0.0, [], 1.0)), 3)
    0.5
    """
    point = real("place", place)
    if point.shape != (2,):
        raise Error(f"place: expected an array of shape (2,), got shape {point.shape}")
    rows = np.zeros(0) if np.size(others) == 0 else _projected(others, 0, None)[0]
    return of_rows(lambda arguments, result: _aureole.straight_edge_weights(rows, arguments, result),  # type: ignore[no-any-return]
                   x=point[0], y=point[1], before=real("before", before, minimum=0), after=real("after", after, minimum=0),
                   sigma=_scale("sigma", sigma))


def diffracted_intensity(field: npt.ArrayLike, q: npt.ArrayLike, k: npt.ArrayLike, sigma: Optional[npt.ArrayLike] = None) -> Reals:
    """Power per steradian of a field, (k/2 pi)^2 (1 - chi) |F|^2, from which the 0th order is removed here.

    Parameters
    ----------
    field : array_like of real or complex numbers
        F(q) with its 0th order, as of `EdgeWaves` with zeroth_order='none' or `triangle_transform`.
    q : array_like, shape (..., 2)
        In rad per unit of length.
    k : array_like
        Wave number.
    sigma : array_like, optional
        Standard deviation of chi, 1/(2 s) for a Gaussian beam whose intensity has the standard deviation s; nothing is removed
        where it is missing.

    Returns
    -------
    numpy.ndarray
        All arguments broadcast, q by its first axes.
    """
    wave = real("q", q)
    last_axis("q", wave, 2)
    chi = np.zeros(()) if sigma is None else _scale("sigma", sigma)
    shape, (flat, *rows) = broadcast(field=complex_numbers("field", field), q_x=wave[..., 0], q_y=wave[..., 1],
                                     k=_scale("k", k), sigma=chi)
    result = np.empty(flat.size)
    _aureole.diffracted_intensity(flat, np.stack(rows, axis=-1).reshape(-1), result)
    return shaped(result, shape)  # type: ignore[no-any-return]


def _scale(name: str, value: Any) -> Reals:
    return real(name, value, minimum=1e-100, maximum=1e100)


def _turn(name: str, value: Any) -> Reals:
    return real(name, value, minimum=-2, maximum=2)


def _projected(edges: Any, index: Any, lengths: Any) -> Tuple[Reals, int]:
    """Returns the checked edges as rows of their ends and lengths, and the checked index of an edge of positive
    length."""
    ends = real("edges", edges, minimum=-1e100, maximum=1e100)
    if ends.ndim != 3 or ends.shape[1:] != (2, 2) or not len(ends):
        raise Error(f"edges: expected an array of shape (n, 2, 2), n > 0, got shape {ends.shape}")
    seen = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    own = seen if lengths is None else real("lengths", lengths, maximum=1e100)
    if own.shape != seen.shape:
        raise Error(f"lengths: expected an array of shape ({len(seen)},), got shape {own.shape}")
    if np.any(own < seen * (1 - 1e-9)):
        raise Error("lengths: expected none below those in the plane")
    chosen = integer("index", index, minimum=0, maximum=len(ends) - 1)
    if not seen[chosen] > 0:
        raise Error("index: expected an edge of positive length")
    return np.ascontiguousarray(np.concatenate([ends.reshape(-1, 4), own[:, None]], axis=1)).reshape(-1), chosen
