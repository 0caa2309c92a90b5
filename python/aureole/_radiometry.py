# SPDX-License-Identifier: Apache-2.0
"""Solid angles, conversions of radiometric quantities, glare and mesopic vision."""

from __future__ import annotations

from typing import Any, List, Mapping, NamedTuple, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import integer, real
from ._errors import Error
from ._instrument_support import Words
from ._scene import Scene, load_dict
from ._vectorised import broadcast, last_axis, limit_results, shaped

Reals = npt.NDArray[np.float64]

#: Planck's constant [J s] and the speed of light [m/s], exact in the SI.
_PLANCK, _LIGHT = 6.62607015e-34, 299792458.0


class SolidAngle(NamedTuple):
    """Result of the functions of solid angles: arrays of one shape, in sr.

    Attributes
    ----------
    solid_angle : numpy.ndarray
    projected : numpy.ndarray
        The integral of the cosine with the normal over the directions above its plane; NaN without a normal.
    error, projected_error : numpy.ndarray
        Standard errors; 0 for closed forms.
    """

    solid_angle: Any
    projected: Any
    error: Any
    projected_error: Any


class MesopicLuminance(NamedTuple):
    """Result of `mesopic_luminance`: luminance in cd/m^2, and the coefficient m of the adaptation."""

    luminance: Any
    m: Any


def sphere_solid_angle(center: npt.ArrayLike, radius: npt.ArrayLike, point: npt.ArrayLike = (0, 0, 0), normal: Any = None) -> SolidAngle:
    """A sphere from a point. Within it, the solid angle is 4 pi.

    Parameters
    ----------
    center, point : array_like of shape (..., 3)
    radius : array_like
    normal : array_like of shape (..., 3), optional
        Of a receiver at the point.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.sphere_solid_angle([0, 0, 2], 1, normal=[0, 0, 1]).projected.round(6))  # pi/4
    0.785398
    """
    to, normals = _to(center, point), _normals(normal)
    sizes = real("radius", radius, positive=True)[..., None]
    rows, shape = _rows(center=to, radius=sizes, normal=normals)
    return _closed(_aureole.sphere_solid_angles, rows, shape, normal)


def disc_solid_angle(
    center: npt.ArrayLike, axis: npt.ArrayLike, radius: npt.ArrayLike, point: npt.ArrayLike = (0, 0, 0), normal: Any = None
) -> SolidAngle:
    """A flat disc from a point, seen from either side.

    Parameters
    ----------
    center, axis, point : array_like of shape (..., 3)
        Centre, a vector perpendicular to the disc, and the point.
    radius : array_like
    normal : array_like of shape (..., 3), optional
        Of a receiver at the point.

    Examples
    --------
    >>> from aureole import optics
    >>> seen = optics.disc_solid_angle([0, 0, 2], [0, 0, 1], 1, normal=[0, 0, 1])
    >>> round(1000 * float(seen.projected), 4)  # illuminance of a disc of 1000 cd/m^2
    628.3185
    """
    to, normals = _to(center, point), _normals(normal)
    axes = _points("axis", axis)
    if not np.all(np.any(axes != 0, axis=-1)):
        raise Error("axis: expected vectors that are not zero")
    sizes = real("radius", radius, positive=True)[..., None]
    rows, shape = _rows(center=to, axis=axes, radius=sizes, normal=normals)
    return _closed(_aureole.disc_solid_angles, rows, shape, normal)


def polygon_solid_angle(corners: npt.ArrayLike, point: npt.ArrayLike = (0, 0, 0), normal: Any = None) -> SolidAngle:
    """A flat polygon from points, seen from either side.

    Parameters
    ----------
    corners : array_like of shape (corners, 3)
        In order; sides must not cross.
    point : array_like of shape (..., 3)
    normal : array_like of shape (..., 3), optional
        Of a receiver at the point.

    Examples
    --------
    >>> from aureole import optics
    >>> roof = [[-2, -2, 3], [2, -2, 3], [2, 2, 3], [-2, 2, 3]]
    >>> round(float(optics.polygon_solid_angle(roof, normal=[0, 0, 1]).projected) / np.pi, 6)
    0.357685
    """
    edges = _points("corners", corners)
    if edges.ndim != 2 or len(edges) < 3:
        raise Error(f"corners: expected shape (corners, 3) with three corners or more, got {edges.shape}")
    rows, shape = _rows(point=_points("point", point), normal=_normals(normal))
    limit_results("corners and point", shape, edges.shape)
    return _closed(lambda r, out: _aureole.polygon_solid_angles(np.ascontiguousarray(edges), r, out), rows, shape, normal)


def solid_angle(shape: Any, point: npt.ArrayLike = (0, 0, 0), normal: Any = None, *, samples: int = 65536) -> SolidAngle:
    """Any shape from points, by rays: the directions in which it is hit, whatever its material.

    Parameters
    ----------
    shape : dict or Scene
        A shape as in `load_dict` ("sphere", "mesh", "ply", ...); of a Scene, all its shapes together.
    point : array_like of shape (..., 3)
        Of a Scene in its units.
    normal : array_like of shape (..., 3), optional
        Of a receiver at the point.
    samples : int
        Rays for each point.

    Examples
    --------
    >>> from aureole import optics
    >>> ball = optics.solid_angle({"type": "sphere", "center": [0, 0, 2]}, normal=[0, 0, 1])
    >>> bool(abs(ball.projected - np.pi / 4) < 4 * ball.projected_error + 1e-3)
    True
    """
    count = integer("samples", samples, minimum=16, maximum=2**28)
    if isinstance(shape, Scene):
        scene = shape
    elif isinstance(shape, Mapping):
        film = {"type": "hdrfilm", "width": 1, "height": 1}
        scene = load_dict({"type": "scene", "sensor": {"type": "perspective", "film": film}, "shape": shape})
    else:
        raise TypeError(f"shape: expected a dict or a Scene, got {type(shape).__name__}")
    rows, outer = _rows(point=_points("point", point), normal=_normals(normal))
    limit_results("point", outer)
    with Words():
        found = np.array([_aureole.traced_solid_angle(scene._open, row[:3].tolist(), row[3:].tolist(), count) for row in rows])
    values: List[Any] = [shaped(column, outer) for column in found.reshape(-1, 4).T]
    if normal is None:
        values[1], values[3] = values[1] * np.nan, values[3] * np.nan
    return SolidAngle(values[0], values[1], values[2], values[3])


def photon_energy(wavelength: npt.ArrayLike) -> Any:
    """Energy of a photon, h c/lambda, in J.

    Parameters
    ----------
    wavelength : array_like
        In nm, in vacuum.
    """
    return _PLANCK * _LIGHT / (real("wavelength", wavelength, positive=True, unit="nm") * 1e-9)


def photons(energy: npt.ArrayLike, wavelength: npt.ArrayLike) -> Any:
    """Number of photons of an energy in J; of a power in W, photons per second. `wavelength` is in nm."""
    joule, nm = real("energy", energy), real("wavelength", wavelength, positive=True, unit="nm")
    _, _ = broadcast(energy=joule, wavelength=nm)
    return joule / photon_energy(nm)


def irradiance_of_radiance(radiance: npt.ArrayLike, projected_solid_angle: npt.ArrayLike) -> Any:
    """Irradiance of a surface by light of one radiance from a projected solid angle: E = L Omega_p. Photometric quantities
    (illuminance and luminance) alike."""
    return _product(radiance=radiance, projected_solid_angle=projected_solid_angle)


def irradiance_of_intensity(intensity: npt.ArrayLike, distance: npt.ArrayLike, cosine: npt.ArrayLike = 1.0) -> Any:
    """Irradiance by a point of an intensity: E = I cos(theta)/d^2, the law of inverse squares.

    Parameters
    ----------
    intensity : array_like
        In W/sr or cd.
    distance : array_like
        In m.
    cosine : array_like
        Of the angle of incidence; 0 is returned for negative ones.
    """
    far = real("distance", distance, positive=True, unit="m")
    return _product(intensity=intensity, inverse_square=1 / far**2, cosine=np.maximum(real("cosine", cosine, minimum=-1, maximum=1), 0))


def intensity_of_radiance(radiance: npt.ArrayLike, area: npt.ArrayLike, cosine: npt.ArrayLike = 1.0) -> Any:
    """Intensity of a flat surface of one radiance: I = L A cos(theta), Lambert's cosine law. `area` is in m^2."""
    return _product(
        radiance=radiance, area=real("area", area, minimum=0), cosine=np.maximum(real("cosine", cosine, minimum=-1, maximum=1), 0)
    )


def radiance_of_intensity(intensity: npt.ArrayLike, area: npt.ArrayLike, cosine: npt.ArrayLike = 1.0) -> Any:
    """Mean radiance of a flat surface by its intensity: L = I/(A cos(theta)). `area` is in m^2."""
    seen = real("area", area, positive=True), real("cosine", cosine, positive=True, maximum=1)
    return _product(intensity=intensity, inverse_area=1 / seen[0], inverse_cosine=1 / seen[1])


def exitance_of_radiance(radiance: npt.ArrayLike) -> Any:
    """Exitance of a Lambertian surface, M = pi L."""
    return np.pi * real("radiance", radiance)


def radiance_of_exitance(exitance: npt.ArrayLike) -> Any:
    """Radiance of a Lambertian surface, L = M/pi."""
    return real("exitance", exitance) / np.pi


def radiance_of_irradiance(irradiance: npt.ArrayLike, reflectance: npt.ArrayLike = 1.0) -> Any:
    """Radiance that a Lambertian surface of a reflectance scatters, L = rho E/pi."""
    return _product(irradiance=irradiance, reflectance=real("reflectance", reflectance, minimum=0, maximum=1)) / np.pi


def flux_of_intensity(intensity: npt.ArrayLike, solid_angle: npt.ArrayLike = 4 * np.pi) -> Any:
    """Flux of one intensity into a solid angle in sr, Phi = I Omega; by default into all directions."""
    return _product(intensity=intensity, solid_angle=real("solid_angle", solid_angle, minimum=0, maximum=4 * np.pi))


def etendue(area: npt.ArrayLike, projected_solid_angle: npt.ArrayLike, index: npt.ArrayLike = 1.0) -> Any:
    """Etendue n^2 A Omega_p in m^2 sr, which times the basic radiance L/n^2 is the flux of a beam."""
    n = real("index", index, positive=True)
    return _product(
        area=real("area", area, minimum=0), projected_solid_angle=real("projected_solid_angle", projected_solid_angle, minimum=0), square=n * n
    )


def mesopic_luminance(photopic: npt.ArrayLike, scotopic_to_photopic: npt.ArrayLike) -> MesopicLuminance:
    """Mesopic luminance by CIE 191:2010 (MES2), of an eye that is adapted to it.

    Parameters
    ----------
    photopic : array_like
        Photopic luminance in cd/m^2.
    scotopic_to_photopic : array_like
        Ratio S/P of the scotopic to the photopic luminance.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.mesopic_luminance(0.1, 2).luminance.round(5))
    0.13096
    """
    shape, flat = broadcast(
        photopic=real("photopic", photopic, positive=True, maximum=1e15),
        scotopic_to_photopic=real("scotopic_to_photopic", scotopic_to_photopic, minimum=0, maximum=1e15),
    )
    result = np.empty((flat[0].size, 2))
    _aureole.mesopic_luminances(flat[0], flat[1], result)
    return MesopicLuminance(shaped(result[:, 0], shape), shaped(result[:, 1], shape))


def unified_glare_rating(
    background: float, luminance: npt.ArrayLike, solid_angle: npt.ArrayLike, position_index: npt.ArrayLike = 1.0
) -> float:
    """Unified glare rating of CIE 117, 8 lg((0.25/L_b) sum L^2 omega/p^2); -inf without sources.

    Parameters
    ----------
    background : float
        Luminance L_b of the background in cd/m^2.
    luminance, solid_angle, position_index : array_like
        Of each source: L in cd/m^2, omega in sr, and Guth's p.

    Examples
    --------
    >>> from aureole import optics
    >>> round(optics.unified_glare_rating(50, 1e4, 0.01), 4)
    29.5918
    """
    around = real("background", background, positive=True, unit="cd/m^2")
    if around.size != 1:
        raise Error(f"background: expected one number, got an array of shape {around.shape}")
    _, flat = broadcast(
        luminance=real("luminance", luminance, minimum=0),
        solid_angle=real("solid_angle", solid_angle, minimum=0),
        position_index=real("position_index", position_index, positive=True),
    )
    return float(_aureole.unified_glare_rating(float(around.reshape(())[()]), np.ascontiguousarray(np.stack(flat, -1))))


def _product(**factors: Any) -> Any:
    arrays = {name: real(name, value) for name, value in factors.items()}
    shape, flat = broadcast(**arrays)
    return shaped(np.prod(np.stack(flat), axis=0), shape)


def _points(name: str, value: Any) -> Reals:
    array = real(name, value, minimum=-1e30, maximum=1e30)
    last_axis(name, array, 3)
    return array


def _to(center: Any, point: Any) -> Reals:
    a, b = _points("center", center), _points("point", point)
    broadcast(center=a, point=b)
    return a - b


def _normals(normal: Any) -> Reals:
    if normal is None:
        return np.zeros(3)
    found = _points("normal", normal)
    if not np.all(np.any(found != 0, axis=-1)):
        raise Error("normal: expected vectors that are not zero")
    return found


def _rows(**parts: Reals) -> Tuple[Reals, Tuple[int, ...]]:
    """The named arrays of shape (..., n), broadcast against each other, side by side as rows; and the shape of the rest."""
    names = " and ".join(parts)
    try:
        shape = np.broadcast_shapes(*(a.shape[:-1] for a in parts.values()))
    except ValueError:
        raise Error(f"{names}: expected shapes that fit together by numpy's broadcasting") from None
    limit_results(names, shape)
    columns = [np.broadcast_to(a, shape + a.shape[-1:]).reshape(-1, a.shape[-1]) for a in parts.values()]
    return np.ascontiguousarray(np.concatenate(columns, axis=1)), shape


def _closed(function: Any, rows: Reals, shape: Tuple[int, ...], normal: Any) -> SolidAngle:
    result = np.empty((len(rows), 2))
    function(rows, result)
    zero = shaped(np.zeros(len(rows)), shape)
    nothing = shaped(np.full(len(rows), np.nan), shape)
    if normal is None:
        return SolidAngle(shaped(result[:, 0].copy(), shape), nothing, zero, nothing)
    return SolidAngle(shaped(result[:, 0].copy(), shape), shaped(result[:, 1].copy(), shape), zero, zero)


__all__ = [
    "MesopicLuminance",
    "SolidAngle",
    "disc_solid_angle",
    "etendue",
    "exitance_of_radiance",
    "flux_of_intensity",
    "intensity_of_radiance",
    "irradiance_of_intensity",
    "irradiance_of_radiance",
    "mesopic_luminance",
    "photon_energy",
    "photons",
    "polygon_solid_angle",
    "radiance_of_exitance",
    "radiance_of_intensity",
    "radiance_of_irradiance",
    "solid_angle",
    "sphere_solid_angle",
    "unified_glare_rating",
]
