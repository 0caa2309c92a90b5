# SPDX-License-Identifier: Apache-2.0
"""Layers of paint by Kubelka and Munk, their interfaces, and their difference from transport. For pigment.py."""
from __future__ import annotations

from typing import Any, NamedTuple, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import real, scalar
from ._errors import Error
from ._vectorised import broadcast, choice, shaped

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
