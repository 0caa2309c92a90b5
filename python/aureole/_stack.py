# SPDX-License-Identifier: Apache-2.0
"""Stacks of plane layers by discrete ordinates."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import flag, real, scalar
from ._errors import Error
from ._vectorised import choice, limit_results

Reals = npt.NDArray[np.float64]
_KINDS = ("smooth", "beckmann", "ggx")


@dataclass(frozen=True, eq=False)
class StackLayer:
    """A layer of a `PlaneStack`. Numbers may be arrays, over wavelengths for instance; all numbers of a stack
    broadcast.

    Attributes
    ----------
    thickness : array_like
        In any unit of length; not negative; infinite for half-spaces. 0 with an `index` is a clear slide.
    absorption, scattering : array_like
        Coefficients sigma_a and sigma_s in 1/length.
    g : array_like
        Mean cosine of Henyey and Greenstein's phase function, in (-1, 1), where neither `moments` nor `table` is
        given.
    moments : array_like, shape (..., L), optional
        Means of Legendre's polynomials P_0 (which is 1) to P_(L-1) over the phase function.
    table : (mu, p), optional
        Cosines of the scattering angle that increase from -1 to 1, and the phase function there, in any unit. One for all
        wavelengths.
    index : array_like
        Index of refraction.
    interface : str
        At the top of the layer, where the index changes: "smooth", "beckmann" or "ggx".
    alpha : array_like
        Roughness of that interface, in [0.05, 1].
    """

    thickness: npt.ArrayLike
    absorption: npt.ArrayLike = 0.0
    scattering: npt.ArrayLike = 0.0
    g: npt.ArrayLike = 0.0
    moments: Optional[npt.ArrayLike] = None
    table: Optional[Tuple[npt.ArrayLike, npt.ArrayLike]] = None
    index: npt.ArrayLike = 1.0
    interface: str = "smooth"
    alpha: npt.ArrayLike = 0.1


class StackFluxes(NamedTuple):
    """Result of `PlaneStack.fluxes`: parts of the incident flux.

    Attributes
    ----------
    reflectance, transmittance : numpy.ndarray
        All light; the light that enters a substrate is absorbed there.
    unscattered_reflectance, unscattered_transmittance : numpy.ndarray
        Light that no layer has scattered, as a part of the above.
    absorptance : numpy.ndarray
        Fraction that the layers absorb.
    """

    reflectance: Reals
    transmittance: Reals
    unscattered_reflectance: Reals
    unscattered_transmittance: Reals
    absorptance: Reals


class StackFields(NamedTuple):
    """Result of `PlaneStack.fields`, by position (last axis), of irradiance 1 on the stack.

    Attributes
    ----------
    flux_down, flux_up : numpy.ndarray
        Irradiances, unscattered light included.
    fluence_down, fluence_up : numpy.ndarray
        Radiance integrated over the downward and over the upward directions.
    unscattered_flux_down, unscattered_flux_up : numpy.ndarray
        Parts of the fluxes.
    absorption_down, absorption_up, backscatter_down, backscatter_up : numpy.ndarray
        K and S of light that goes down or up, in 1/length: with them the equations of Kubelka and Munk are exact there.
    """

    flux_down: Reals
    flux_up: Reals
    fluence_down: Reals
    fluence_up: Reals
    unscattered_flux_down: Reals
    unscattered_flux_up: Reals
    absorption_down: Reals
    absorption_up: Reals
    backscatter_down: Reals
    backscatter_up: Reals


class PlaneStack:
    """Plane layers with interfaces and a substrate: the light that they reflect and transmit, and the light within
    them, by discrete ordinates.

    Unpolarised light, solved by adding and doubling; at albedo 1 energy is conserved to rounding errors.

    Parameters
    ----------
    layers : sequence of StackLayer
        From the top.
    substrate : array_like, optional
        Reflectance, in [0, 1], of a Lambertian surface that ends the last layer; 0 is black. Without it there is a medium below.
    index_above, index_below : array_like
        Indices of refraction around the stack.
    bottom_interface, bottom_alpha
        At the bottom of the last layer, where there is no substrate: as `StackLayer.interface` and `alpha`.
    streams : int
        Directions in which light is followed, an even number in [2, 512]; half of them go down. 2 is a two-flux theory.
    delta_m : bool
        Whether forward peaks that so few directions cannot resolve count as unscattered light (Wiscombe 1977), and
        light of beams that was scattered once is computed with the whole phase function (Nakajima & Tanaka 1988).

    References
    ----------
    Chandrasekhar, Radiative Transfer, 1960; van de Hulst, Multiple Light Scattering, 1980. Rough interfaces: Walter, Marschner,
    Li & Torrance, "Microfacet models for refraction through rough surfaces", 2007; Kulla & Conty 2017.

    Examples
    --------
    >>> from aureole import optics
    >>> paint = optics.PlaneStack([optics.StackLayer(1, absorption=[0.2, 1], scattering=1.8, g=0.75)], streams=64)
    >>> paint.fluxes(cosine=1).reflectance.round(4)  # of a normal beam, at two wavelengths
    array([0.0974, 0.0347])
    """

    def __init__(self, layers: Sequence[StackLayer], *, substrate: Optional[npt.ArrayLike] = None,
                 index_above: npt.ArrayLike = 1.0, index_below: npt.ArrayLike = 1.0, bottom_interface: str = "smooth",
                 bottom_alpha: npt.ArrayLike = 0.1, streams: int = 32, delta_m: bool = True) -> None:
        if not isinstance(layers, (list, tuple)):
            raise TypeError(f"layers: expected a list of StackLayer, got {type(layers).__name__}")
        for i, layer in enumerate(layers):
            if not isinstance(layer, StackLayer):
                raise TypeError(f"layers: expected StackLayer, got {type(layer).__name__} (layer {i})")
        if not layers:
            raise Error("layers: expected at least one")
        if isinstance(streams, bool) or not isinstance(streams, (int, np.integer)):
            raise TypeError(f"streams: expected an integer, got {type(streams).__name__}")
        if not 2 <= streams <= 512 or streams % 2:
            raise Error(f"streams: expected an even number in [2, 512], got {streams}")

        numbers: List[Reals] = []
        for i, layer in enumerate(layers):
            at = f"layers[{i}]."
            numbers += [real(at + "absorption", layer.absorption, minimum=0), real(at + "scattering", layer.scattering, minimum=0),
                        _thickness(at + "thickness", layer.thickness), real(at + "g", layer.g, minimum=-1, maximum=1),
                        real(at + "index", layer.index, positive=True), real(at + "alpha", layer.alpha, positive=True)]
        ground = np.array(np.nan) if substrate is None else real("substrate", substrate, minimum=0, maximum=1)
        around = [real("index_above", index_above, positive=True), real("index_below", index_below, positive=True), ground,
                  real("bottom_alpha", bottom_alpha, positive=True)]
        series = [None if layer.moments is None else real(f"layers[{i}].moments", layer.moments) for i, layer in enumerate(layers)]
        for i, chi in enumerate(series):
            if chi is not None and chi.ndim == 0:
                raise Error(f"layers[{i}].moments: expected an array of shape (..., L), got a number")
            if chi is not None and layers[i].table is not None:
                raise Error(f"layers[{i}]: give either moments or table")
        try:
            self._shape = np.broadcast_shapes(*(a.shape for a in numbers + around), *(c.shape[:-1] for c in series if c is not None))
        except ValueError:
            raise Error("layers: expected numbers of shapes that fit together by numpy's broadcasting") from None
        count = int(np.prod(self._shape, dtype=np.int64))
        terms = max([1] + [c.shape[-1] for c in series if c is not None])
        limit_results("layers", (count, len(layers), terms + 6))

        def flat(arrays: Sequence[Reals]) -> Reals:
            return np.stack([np.broadcast_to(a, self._shape).reshape(-1) for a in arrays], axis=-1)

        moments = np.zeros((count, len(layers), terms))
        table_mu: List[List[float]] = [[] for _ in layers]
        table_p: List[List[float]] = [[] for _ in layers]
        phases = []
        for i, (layer, chi) in enumerate(zip(layers, series)):
            phases.append(1 if chi is not None else 2 if layer.table is not None else 0)
            if chi is not None:
                moments[:, i, :chi.shape[-1]] = np.broadcast_to(chi, (*self._shape, chi.shape[-1])).reshape(count, -1)
            if layer.table is not None:
                try:
                    mu, p = layer.table
                except (TypeError, ValueError):
                    raise TypeError(f"layers[{i}].table: expected a pair of arrays, mu and p") from None
                table_mu[i] = real(f"layers[{i}].table", mu).reshape(-1).tolist()
                table_p[i] = real(f"layers[{i}].table", p).reshape(-1).tolist()
        kinds = [_KINDS.index(choice(f"layers[{i}].interface", layer.interface, *_KINDS)) for i, layer in enumerate(layers)]
        kinds.append(_KINDS.index(choice("bottom_interface", bottom_interface, *_KINDS)))
        self._layers = len(layers)
        self._stacks = _aureole.PlaneStacks(np.ascontiguousarray(flat(numbers).reshape(count, len(layers), 6)), np.ascontiguousarray(flat(around)),
                                            kinds, phases, moments, table_mu, table_p, int(streams), bool(delta_m))

    @property
    def shape(self) -> Tuple[int, ...]:
        """The shape of all results, before the axes of directions or positions."""
        return self._shape

    @property
    def _count(self) -> int:
        return int(np.prod(self._shape, dtype=np.int64))

    def fluxes(self, cosine: Optional[float] = None, *, from_below: bool = False) -> StackFluxes:
        """Reflectance and transmittance.

        Parameters
        ----------
        cosine : float, optional
            Cosine of the beam's direction of incidence, in (0, 1]; without it the light is diffuse (equal radiance
            from all directions).
        from_below : bool
            Whether the light comes from below; the reflectance is then the fraction that returns below.

        Returns
        -------
        StackFluxes
            Arrays of the stack's shape.
        """
        result = np.empty((self._count, 4))
        self._stacks.fluxes(_beam(cosine), flag("from_below", from_below), result)
        r, t, ur, ut = (result[:, k].reshape(self._shape)[()] for k in range(4))
        return StackFluxes(r, t, ur, ut, 1 - r - t)

    def radiance(self, cosines: npt.ArrayLike, azimuths: npt.ArrayLike = 0.0, *, cosine: Optional[float] = None,
                 from_below: bool = False, layer: Optional[int] = None, depth: npt.ArrayLike = 0.0) -> Reals:
        """Radiance per irradiance on the stack, in 1/sr; for beams these are the BRDF and the BTDF.

        Parameters
        ----------
        cosines : array_like
            Cosines of the directions of propagation: positive up, negative down.
        azimuths : array_like
            In radians; 0 is the half-plane into which the beam goes, and its mirror image.
        cosine, from_below
            The light, as in `fluxes`. Unscattered light of beams, a delta, is left out.
        layer : int, optional
            Layer within which the radiance is computed; by default the result is the light that leaves the stack,
            above it for positive cosines.
        depth : array_like
            Depth in that layer, from its top, in its unit of length.

        Returns
        -------
        numpy.ndarray
            Of shape ``stack.shape + cosines.shape + azimuths.shape``.
        """
        mu, phi = real("cosines", cosines, minimum=-1, maximum=1), real("azimuths", azimuths)
        limit_results("cosines and azimuths", self._shape, mu.shape, phi.shape)
        if mu.size > 4096:
            raise Error(f"cosines: expected at most 4096 directions, got {mu.size}: call it for parts")
        try:
            depths = np.ascontiguousarray(np.broadcast_to(real("depth", depth, minimum=0), self._shape))
        except ValueError:
            raise Error(f"depth: expected a shape that fits that of the stack, {self._shape}") from None
        result = np.empty((self._count, mu.size, phi.size))
        self._stacks.radiance(_beam(cosine), flag("from_below", from_below), -1 if layer is None else self._layer("layer", layer), depths.reshape(-1),
                              np.ascontiguousarray(mu).reshape(-1), np.ascontiguousarray(phi).reshape(-1), result)
        return result.reshape(self._shape + mu.shape + phi.shape)[()]

    def fields(self, layer: int, depths: npt.ArrayLike, *, cosine: Optional[float] = None, from_below: bool = False) -> StackFields:
        """Light inside of a layer.

        Parameters
        ----------
        layer : int
            From the top, beginning at 0.
        depths : array_like, shape (P,) or a number
            From the top of the layer, in its unit of length.
        cosine, from_below
            The light, as in `fluxes`.

        Returns
        -------
        StackFields
            Arrays of shape ``stack.shape + depths.shape``.
        """
        at = real("depths", depths, minimum=0)
        if at.ndim > 1:
            raise Error(f"depths: expected a number or one axis, got shape {at.shape}")
        limit_results("depths", self._shape, at.shape, (10,))
        every = np.ascontiguousarray(np.broadcast_to(at.reshape(-1), (self._count, at.size)))
        result = np.empty((self._count, at.size, 10))
        self._stacks.fields(_beam(cosine), flag("from_below", from_below), [self._layer("layer", layer)] * at.size, every, result)
        return StackFields(*(result[..., k].reshape(self._shape + at.shape)[()] for k in range(10)))

    def _layer(self, name: str, value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
            raise TypeError(f"{name}: expected an integer, got {type(value).__name__}")
        if not 0 <= value < self._layers:
            raise Error(f"{name}: expected one of 0 to {self._layers - 1}, got {value}")
        return int(value)


def _thickness(name: str, value: Any) -> Reals:
    try:
        value = np.where(np.isposinf(value), 1e300, value)  # so thick that no light passes
    except (TypeError, ValueError):
        pass  # `real` says what is wrong
    return real(name, value, minimum=0)


def _beam(cosine: Any) -> float:
    if cosine is None:
        return float("nan")
    value = scalar("cosine", cosine, maximum=1)
    if not value > 0:
        raise Error(f"cosine: expected a number in (0, 1], got {value:g}")
    return value
