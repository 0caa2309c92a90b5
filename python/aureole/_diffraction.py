# SPDX-License-Identifier: Apache-2.0
"""Knife edges, the uniform theory of diffraction, diffraction integrals, radio materials. See `aureole.optics`."""
from __future__ import annotations

import math
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import complex_numbers, real, scalar, shown, text
from ._edge_waves import _ring
from ._errors import Error
from ._vectorised import broadcast, choice, last_axis, of_rows, shaped

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


class RadioMaterial(NamedTuple):
    """A row of ITU-R P.2040-3: permittivity a f^b, conductivity c f^d in S/m, f in GHz, between frequencies in Hz."""

    a: float
    b: float
    c: float
    d: float
    min_frequency: float
    max_frequency: float


def faddeeva(z: npt.ArrayLike) -> Complexes:
    """w(z) = exp(-z^2) erfc(-i z), the error function of complex numbers, by libcerf, with relative errors near 1e-13; infinite
    where it overflows, far below the real axis.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.faddeeva([0, 1j]).round(6)
    array([1.      +0.j, 0.427584+0.j])
    """
    array = complex_numbers("z", z)
    result = np.empty(array.size, np.complex128)
    _aureole.faddeeva(np.ascontiguousarray(array).reshape(-1), result)
    return shaped(result, array.shape)  # type: ignore[no-any-return]


def fresnel_integral(v: npt.ArrayLike) -> Complexes:
    """C(v) + i S(v), the integral from 0 to v of exp(i pi t^2/2) dt (Abramowitz & Stegun 1964, 7.3)."""
    return _of_real("v", v, _aureole.fresnel_integral)


def knife_edge(v: npt.ArrayLike) -> Complexes:
    """Returns the field behind an opaque half plane over the field without it, in Fresnel's approximation.

    Parameters
    ----------
    v : array_like
        Fresnel's number, negative in the shadow: v = -h sqrt(2 (1/d1 + 1/d2)/wavelength), with the edge at a height h
        above the straight line, at the distance d1 from the source and d2 from the observer.

    References
    ----------
    Born & Wolf, Principles of Optics, 7th ed. 1999, 8.7.3.

    Examples
    --------
    >>> from aureole import optics
    >>> (abs(optics.knife_edge([-1, 0, 1.2172, 1.8725])) ** 2).round(6)
    array([0.041076, 0.25    , 1.370443, 0.778251])
    """
    return _of_real("v", v, _aureole.knife_edge)


def transition_function(x: npt.ArrayLike) -> Complexes:
    """F(x) of the uniform theory, x >= 0, time dependence exp(-i omega t): the conjugate of Kouyoumjian & Pathak 1974, (26)."""
    return _of_real("x", x, _aureole.transition_function, minimum=0)


def utd_coefficient(phi: npt.ArrayLike, phi_i: npt.ArrayLike, k: npt.ArrayLike, distance: npt.ArrayLike, *, n: float = 2.0,
                    sin_beta: npt.ArrayLike = 1.0, polarisation: str = "soft",
                    faces: Optional[Tuple[complex, complex]] = None) -> Complexes:
    """Diffraction coefficient D of a wedge, in sqrt(length): the diffracted field at the distance s is the field at the
    edge times D, the spreading (1/sqrt(s) for plane waves, sqrt(s_i/(s (s + s_i))) from a point) and exp(i k s).

    Parameters
    ----------
    phi, phi_i : array_like
        Angles of the observer and the source from the o-face, in [0, n pi] rad.
    k : array_like
        Wave number.
    distance : array_like
        s sin^2(beta) for plane waves, s s_i sin^2(beta)/(s + s_i) for a point source.
    n : float
        Angle outside the wedge over pi, in (1, 2]; 2 is a half plane.
    sin_beta : array_like
        Sine of the angle between ray and edge.
    polarisation : {'soft', 'hard'}
        For metal, with the electric ('soft') or the magnetic field ('hard') along the edge.
    faces : (complex, complex), optional
        Reflection coefficients of the o- and the n-face, which replace the polarisation (Luebbers 1984); (0, 0) for
        absorbing faces.

    References
    ----------
    Kouyoumjian & Pathak 1974, Proc. IEEE 62(11), equation 25, conjugate.

    Examples
    --------
    >>> import math
    >>> from aureole import optics
    >>> abs(optics.utd_coefficient([0.5], 1.0, 2 * math.pi, 1e6)).round(4)  # far: Keller's
    array([0.0266])
    """
    return _wedge(n, (k, distance, sin_beta, phi, phi_i), polarisation, faces, False)


def keller_coefficient(phi: npt.ArrayLike, phi_i: npt.ArrayLike, k: npt.ArrayLike, *, n: float = 2.0, sin_beta: npt.ArrayLike = 1.0,
                       polarisation: str = "soft") -> Complexes:
    """Diffraction coefficient of a wedge of metal without transition functions, in sqrt(length): the limit of `utd_coefficient` far
    from the boundaries of shadow and reflection, where it is infinite. Arguments as there.

    References
    ----------
    Keller 1962, "Geometrical theory of diffraction", J. Opt. Soc. Am. 52(2); time dependence exp(-i omega t).

    Examples
    --------
    >>> import math
    >>> from aureole import optics
    >>> abs(optics.keller_coefficient([0.5], 1.0, 2 * math.pi)).round(4)
    array([0.0266])
    """
    corner, hard = math.pi * scalar("n", n), choice("polarisation", polarisation, "soft", "hard") == "hard"
    return of_rows(lambda rows, result: _aureole.keller_coefficient(scalar("n", n), rows, hard, result), np.complex128,  # type: ignore[no-any-return]
                   k=real("k", k, positive=True), sin_beta=_sine(sin_beta), phi=real("phi", phi, minimum=0, maximum=corner + 1e-12),
                   phi_i=real("phi_i", phi_i, minimum=0, maximum=corner + 1e-12))


def plane_wave_distance(s: npt.ArrayLike, sin_beta: npt.ArrayLike = 1.0) -> Reals:
    """`distance` of `utd_coefficient` for a plane wave: s sin^2(beta), the observer s behind the edge."""
    return of_rows(_aureole.plane_wave_distance, s=real("s", s, positive=True), sin_beta=_sine(sin_beta))  # type: ignore[no-any-return]


def point_source_distance(s_i: npt.ArrayLike, s: npt.ArrayLike, sin_beta: npt.ArrayLike = 1.0) -> Reals:
    """`distance` of `utd_coefficient` for a point source s_i before the edge and an observer s behind it:
    s_i s sin^2(beta)/(s_i + s), in their unit of length (Kouyoumjian & Pathak 1974).

    Examples
    --------
    >>> from aureole import optics
    >>> optics.point_source_distance([1.0, 1e9], 1.0).round(6)
    array([0.5, 1. ])
    """
    return of_rows(_aureole.point_source_distance, s_i=real("s_i", s_i, positive=True), s=real("s", s, positive=True),  # type: ignore[no-any-return]
                   sin_beta=_sine(sin_beta))


def plane_wave_spreading(s: npt.ArrayLike) -> Reals:
    """Returns the spreading factor of a plane wave, 1/sqrt(s). The diffracted field at the distance s from the edge is
    the field at the edge times D times this factor."""
    return of_rows(_aureole.plane_wave_spreading, s=real("s", s, positive=True))  # type: ignore[no-any-return]


def point_source_spreading(s_i: npt.ArrayLike, s: npt.ArrayLike) -> Reals:
    """Returns the spreading factor of a wave from a point at the distance s_i from the edge, sqrt(s_i/(s (s + s_i))) in
    1/sqrt(length). The diffracted field at the distance s is the field at the edge times D times this factor."""
    return of_rows(_aureole.point_source_spreading, s_i=real("s_i", s_i, positive=True), s=real("s", s, positive=True))  # type: ignore[no-any-return]


def utd_field(phi: npt.ArrayLike, phi_i: npt.ArrayLike, k: npt.ArrayLike, rho: npt.ArrayLike, *, n: float = 2.0,
              polarisation: str = "soft", faces: Optional[Tuple[complex, complex]] = None) -> Complexes:
    """Field at the distance rho from a wedge in a plane wave across its edge, of amplitude 1 and phase 0 there: direct,
    reflected and diffracted. The field is exact for a half plane of metal. Arguments as in `utd_coefficient`."""
    return _wedge(n, (k, rho, 1.0, phi, phi_i), polarisation, faces, True)


def rayleigh_sommerfeld(points: npt.ArrayLike, k: float, *, radius: Optional[float] = None, inner_radius: float = 0.0,
                        polygons: Optional[Sequence[npt.ArrayLike]] = None,
                        direction: Optional[npt.ArrayLike] = None, source: Optional[npt.ArrayLike] = None) -> Complexes:
    """Field behind an opening in an opaque screen, Rayleigh and Sommerfeld's first integral by quadrature.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        z > 0; the screen is z = 0.
    k : float
        Wave number.
    radius, inner_radius : float
        The opening is a disc, or a ring, about the origin.
    polygons : sequence of array_like, shape (n, 2)
        Or the opening is the region that an odd number of these polygons surround.
    direction : array_like, shape (3,), optional
        The light is a plane wave exp(i k d.x); by default (0, 0, 1).
    source : array_like, shape (3,), optional
        Or a spherical wave exp(i k r)/r from this point, z < 0.

    References
    ----------
    Goodman, Introduction to Fourier Optics, 4th ed. 2017, 3.5.

    Examples
    --------
    >>> import math
    >>> from aureole import optics
    >>> abs(optics.rayleigh_sommerfeld([[0, 0, 100]], 2 * math.pi, radius=10)).round(3)  # the first Fresnel zone
    array([1.995])
    """
    return _integral("rayleigh_sommerfeld", "points", points, 3, k, radius, inner_radius, polygons, direction, source)


def kirchhoff(points: npt.ArrayLike, k: float, *, radius: Optional[float] = None, inner_radius: float = 0.0,
              polygons: Optional[Sequence[npt.ArrayLike]] = None, direction: Optional[npt.ArrayLike] = None,
              source: Optional[npt.ArrayLike] = None) -> Complexes:
    """The diffracted field by Kirchhoff's integral (Goodman 2017, 3.4). Arguments as in `rayleigh_sommerfeld`."""
    return _integral("kirchhoff", "points", points, 3, k, radius, inner_radius, polygons, direction, source)


def fraunhofer(q: npt.ArrayLike, *, radius: Optional[float] = None, inner_radius: float = 0.0,
               polygons: Optional[Sequence[npt.ArrayLike]] = None) -> Complexes:
    """Integral of exp(-i q.x) over an opening by quadrature, q of shape (..., 2): the far field. Openings as in
    `rayleigh_sommerfeld`."""
    return _integral("fraunhofer", "q", q, 2, 1.0, radius, inner_radius, polygons, None, None)


def radio_permittivity(material: str, frequency: npt.ArrayLike) -> Complexes:
    """Relative permittivity of a building material, eps' + i sigma/(omega eps_0); its square root is the index n + i k.

    Parameters
    ----------
    material : str
        A name of `radio_materials`.
    frequency : array_like
        In Hz, within the limits of the material.

    References
    ----------
    Recommendation ITU-R P.2040-3, 2023, table 3.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.radio_permittivity("concrete", [3.5e9]).round(3)
    array([5.24+0.632j])
    """
    return _of_real("frequency", frequency, lambda at, to: _aureole.radio_permittivity(text("material", material), at, to), positive=True)


def radio_materials() -> Dict[str, List[RadioMaterial]]:
    """Returns the rows of ITU-R P.2040-3, table 3, by name; some materials have two ranges."""
    table: Dict[str, List[RadioMaterial]] = {}
    for name, (a, b, c, d), low, high in _aureole.radio_materials():
        table.setdefault(name, []).append(RadioMaterial(a, b, c, d, low, high))
    return table


def _of_real(name: str, value: Any, function: Any, **limits: Any) -> Complexes:
    array = real(name, value, **limits)
    result = np.empty(array.size, np.complex128)
    function(np.ascontiguousarray(array).reshape(-1), result)
    return shaped(result, array.shape)  # type: ignore[no-any-return]


def _sine(sin_beta: Any) -> Reals:
    return real("sin_beta", sin_beta, positive=True, maximum=1)


def _wedge(n: Any, arguments: Tuple[Any, ...], polarisation: Any, faces: Any, is_field: bool) -> Complexes:
    names = ("k", "rho" if is_field else "distance", "sin_beta", "phi", "phi_i")
    shape, flat = broadcast(**{name: real(name, value) for name, value in zip(names, arguments)})
    sign = -1 if choice("polarisation", polarisation, "soft", "hard") == "soft" else 1
    pair = np.array([sign, sign], complex) if faces is None else complex_numbers("faces", faces)
    if pair.shape != (2,):
        raise Error(f"faces: expected two numbers, got shape {pair.shape}")
    result = np.empty(flat[0].size, np.complex128)
    _aureole.wedge(scalar("n", n), np.stack(flat, axis=-1).reshape(-1), np.tile(pair, result.size), is_field, result)
    return shaped(result, shape)  # type: ignore[no-any-return]


def _integral(kind: str, name: str, points: Any, columns: int, k: Any, radius: Any, inner_radius: Any, polygons: Any, direction: Any,
              source: Any) -> Complexes:
    at = real(name, points)
    last_axis(name, at, columns)
    if (radius is None) == (polygons is None):
        raise Error("radius or polygons: expected one of them")
    if direction is not None and source is not None:
        raise Error("direction or source: expected one of them")
    if polygons is None:
        rings, sizes = np.empty(0), np.empty(0, np.int64)
        outer, inner = scalar("radius", radius, positive=True), scalar("inner_radius", inner_radius, minimum=0)
    else:
        if not isinstance(polygons, (list, tuple, np.ndarray)):
            raise TypeError(f"polygons: expected a sequence of arrays of shape (n, 2), got {type(polygons).__name__} {shown(polygons)}")
        every = [_ring("polygons", p) for p in polygons]
        if not every:
            raise Error("polygons: expected at least one")
        rings, sizes = np.concatenate(every).reshape(-1), np.array([len(p) for p in every], np.int64)
        outer, inner = 1.0, 0.0
    light = real("source", source) if source is not None else real("direction", (0, 0, 1) if direction is None else direction)
    if light.shape != (3,):
        raise Error(f"{'direction' if source is None else 'source'}: expected an array of shape (3,), got shape {light.shape}")
    result = np.empty(math.prod(at.shape[:-1]), np.complex128)
    _aureole.diffraction_integral(kind, rings, sizes, outer, inner, source is not None, [float(x) for x in light],
                                  scalar("k", k, positive=True), np.ascontiguousarray(at).reshape(-1), result)
    return shaped(result, at.shape[:-1])  # type: ignore[no-any-return]
