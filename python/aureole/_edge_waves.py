# SPDX-License-Identifier: Apache-2.0
"""Edge-diffracted waves. See `aureole.optics`."""
from __future__ import annotations

import math
from typing import Any, NamedTuple, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import complex_numbers, integer, real, scalar
from ._errors import Error
from ._vectorised import choice, last_axis, limit_results, shaped

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


class EdgeConstants(NamedTuple):
    """Result of `edge_constants`: integrals of (1 - chi) alpha_1^2 and (1 - chi) alpha_2^2 over the plane."""

    alpha1: float
    alpha2: float


class EdgeWaves:
    """The far field of a lit region as a sum of waves from its edges.

    Lengths are in any one unit, wave vectors q in rad per that unit: 2 pi/wavelength times the change of direction.

    Parameters
    ----------
    edges : array_like, shape (n, 2, 2)
        Start and end of each edge in the plane across the light, x and y; the region lies to the left.
    amplitudes : array_like of real or complex numbers
        Amplitude of the light at both ends, shape (n, 2), linear between; or one number for all.
    zeroth_order : {'beam', 'edge', 'none'}
        Which light straight ahead is removed. 'beam': the power is multiplied by 1 - chi(q), chi a Gaussian of standard
        deviation `sigma` (1/(2 s) for a Gaussian beam whose intensity has the standard deviation s), so that results do
        not depend on how edges are cut. 'edge': chi of sqrt(3)/length for each edge, as published. 'none': nothing.
    sigma : float, optional
        Of 'beam', in rad per unit of length.

    References
    ----------
    Steinberg, Ramamoorthi, Bitterli, Mollazainali, d'Eon & Pharr 2024, "A free-space diffraction BSDF", ACM Trans.
    Graph. 43(4), supplemental sections S2 and S3.

    Examples
    --------
    >>> from aureole import optics
    >>> square = [(0, 0), (10, 0), (10, 10), (0, 10)]
    >>> waves = optics.EdgeWaves.polygon(square, sigma=0.1)
    >>> round(waves.power(), 2)  # of 100
    86.41
    """

    def __init__(self, edges: npt.ArrayLike, amplitudes: npt.ArrayLike = 1.0, *, zeroth_order: str = "beam",
                 sigma: Optional[float] = None) -> None:
        ends = real("edges", edges)
        if ends.ndim != 3 or ends.shape[1:] != (2, 2) or not len(ends):
            raise Error(f"edges: expected an array of shape (n, 2, 2), n > 0, got shape {ends.shape}")
        if np.any(np.all(ends[:, 0] == ends[:, 1], axis=-1)):
            raise Error("edges: expected positive lengths, got an edge that ends where it begins")
        values = complex_numbers("amplitudes", amplitudes)
        if values.ndim != 0 and values.shape != (len(ends), 2):
            raise Error(f"amplitudes: expected one number or an array of shape ({len(ends)}, 2), got shape {values.shape}")
        removal = choice("zeroth_order", zeroth_order, "beam", "edge", "none")
        if (removal == "beam") != (sigma is not None):
            raise Error("sigma: expected a standard deviation with zeroth_order='beam', and with no other")
        self._sigma = 0.0 if sigma is None else scalar("sigma", sigma, positive=True)
        self._removal = removal
        self._ends = np.ascontiguousarray(ends)
        self._amplitudes = np.ascontiguousarray(np.broadcast_to(values, (len(ends), 2)))
        self._edges = _aureole.DiffractingEdges(self._ends.reshape(-1), self._amplitudes.reshape(-1), removal, self._sigma)

    @classmethod
    def polygon(cls, vertices: npt.ArrayLike, amplitude: complex = 1.0, *, zeroth_order: str = "beam",
                sigma: Optional[float] = None) -> EdgeWaves:
        """The edges of a closed polygon, vertices counter-clockwise, lit evenly."""
        ring, even = _ring("vertices", vertices), complex_numbers("amplitude", amplitude)
        if even.ndim:
            raise Error(f"amplitude: expected one number, got an array of shape {even.shape}")
        return cls(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1), even, zeroth_order=zeroth_order, sigma=sigma)

    @property
    def edges(self) -> Reals:
        """Ends of the edges, shape (n, 2, 2)."""
        return self._ends.copy()

    @property
    def amplitudes(self) -> Complexes:
        """Amplitudes at the ends, shape (n, 2)."""
        return self._amplitudes.copy()

    def field(self, q: npt.ArrayLike) -> Complexes:
        """F(q) = integral of amplitude(x) exp(-i q.x) d2x over the region, the 0th order removed; q of shape (..., 2)."""
        return _at(q, np.complex128, self._edges.field)  # type: ignore[no-any-return]

    def intensity(self, q: npt.ArrayLike, k: float = 1.0) -> Reals:
        """Power per steradian, (k/2 pi)^2 |F|^2, with the wave number k; with k = 1 power per d2q."""
        return (scalar("k", k, positive=True) / (2 * math.pi)) ** 2 * np.abs(self.field(q)) ** 2

    def power(self, q_max: Optional[float] = None) -> float:
        """Power that all edges diffract together to |q| < q_max, by quadrature; without a limit to all q, in closed
        form (zeroth_order='beam' only). All real directions are q_max = 2 k."""
        if q_max is None:
            if self._removal != "beam":
                raise Error("q_max: expected a limit, zeroth_order is not 'beam'")
            return self._edges.power(0.0)
        return self._edges.power(scalar("q_max", q_max, positive=True))

    def powers(self) -> Reals:
        """Power of each edge alone; infinite where the 0th order is kept and the mean amplitude is not 0."""
        return np.array(self._edges.powers())

    def quality(self, q_max: Optional[float] = None) -> float:
        """Power together over the sum of the powers alone: how well `pdf` fits the field (S3.2)."""
        return float(self.power(q_max) / self.powers().sum())

    def pdf(self, q: npt.ArrayLike) -> Reals:
        """Density of `sample` per d2q, a mixture of what single edges diffract; its integral is 1."""
        return _at(q, np.float64, self._edges.pdf)  # type: ignore[no-any-return]

    def sample(self, n: int, seed: int = 0) -> Reals:
        """`n` wave vectors, shape (n, 2), drawn from `pdf`."""
        result = np.empty(2 * integer("n", n, minimum=1, maximum=2**27))
        self._edges.sample(integer("seed", seed, minimum=0, maximum=2**64 - 1), result)
        return result.reshape(-1, 2)

    def balanced(self, q_max: Optional[float] = None, most_edges: int = 4096) -> EdgeWaves:
        """Edges for sampling, long ones cut and short ones joined until the quality is in [0.5, 2] where that can be had.

        Joined edges have another field: draw from the result, weight with the field of this."""
        points, amplitudes = self._edges.balanced(self.power(q_max), integer("most_edges", most_edges, minimum=1, maximum=10**5))
        return EdgeWaves(np.reshape(points, (-1, 2, 2)), np.reshape(amplitudes, (-1, 2)), zeroth_order=self._removal,
                         sigma=self._sigma if self._removal == "beam" else None)


def triangle_transform(corners: npt.ArrayLike, values: npt.ArrayLike, q: npt.ArrayLike) -> Complexes:
    """Exact Fourier transform of amplitudes that are linear over triangles, summed over the triangles.

    Parameters
    ----------
    corners : array_like, shape (n, 3, 2) or (3, 2)
    values : array_like of real or complex numbers, shape (n, 3) or (3,)
        Amplitudes at the corners.
    q : array_like, shape (..., 2)
        In rad per unit of length.

    Returns
    -------
    numpy.ndarray of complex128, shape q.shape[:-1]
        Integral of amplitude(x) exp(-i q.x) d2x.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.triangle_transform([(0, 0), (1, 0), (0, 1)], [1, 1, 1], [[0, 0]])
    array([0.5+0.j])
    """
    triangles, amplitudes = real("corners", corners), complex_numbers("values", values)
    if triangles.ndim < 2 or triangles.ndim > 3 or triangles.shape[-2:] != (3, 2) or amplitudes.shape != triangles.shape[:-1]:
        raise Error("corners and values: expected arrays of shape (n, 3, 2) and (n, 3), "
                    f"got shapes {triangles.shape} and {amplitudes.shape}")
    flat, flat_values = np.ascontiguousarray(triangles).reshape(-1), np.ascontiguousarray(amplitudes).reshape(-1)
    return _at(q, np.complex128, lambda at, to: _aureole.triangle_transform(flat, flat_values, at, to))  # type: ignore[no-any-return]


def edge_constants(sigma: float) -> EdgeConstants:
    """Powers of the two waves of an edge of length 1, in closed form, chi of the standard deviation `sigma` removed.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.edge_constants(3**0.5)
    EdgeConstants(alpha1=0.00461265..., alpha2=0.12458996...)
    """
    return EdgeConstants(*_aureole.edge_constants(scalar("sigma", sigma, minimum=0, maximum=1e100)))


def gaussian_beam_power(polygon: npt.ArrayLike, sigma: float) -> float:
    """Part of a Gaussian beam about the origin that falls into a polygon, vertices (n, 2) counter-clockwise; the
    intensity has the standard deviation `sigma` along each axis (Owen 1956)."""
    ring = np.ascontiguousarray(_ring("polygon", polygon)).reshape(-1)
    return _aureole.gaussian_beam_power(scalar("sigma", sigma, positive=True), ring)


def mean_edge_kernel(edges: npt.ArrayLike, index: int, at: npt.ArrayLike, q: npt.ArrayLike, k: float, sigma: float) -> Reals:
    """Intensity per length of edge and steradian that points of an edge scatter of even light of irradiance 1, whose
    coherence is that of Gaussian beams with centres everywhere, exp(-r^2/(8 sigma^2)).

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
        In length/sr; over all directions along a straight edge wavelength/(4 pi^2 theta^2) per radian in its shadow.
    """
    ends = real("edges", edges)
    if ends.ndim != 3 or ends.shape[1:] != (2, 2) or not len(ends):
        raise Error(f"edges: expected an array of shape (n, 2, 2), n > 0, got shape {ends.shape}")
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    chosen = integer("index", index, minimum=0, maximum=len(ends) - 1)
    if not lengths[chosen] > 0:
        raise Error("index: expected an edge of positive length")
    where, wave = real("at", at, minimum=0, maximum=1), real("q", q)
    if wave.shape != (2,):
        raise Error(f"q: expected an array of shape (2,), got shape {wave.shape}")
    rows = np.concatenate([ends.reshape(-1, 4), lengths[:, None]], axis=1)
    result = np.empty(where.size)
    _aureole.mean_edge_kernel(np.ascontiguousarray(rows).reshape(-1), np.full(where.size, chosen, np.int64), where.reshape(-1),
                              np.tile(wave, where.size), scalar("k", k, positive=True), scalar("sigma", sigma, positive=True), result)
    return shaped(result, where.shape)  # type: ignore[no-any-return]


def _ring(name: str, vertices: Any) -> Reals:
    ring = real(name, vertices)
    if ring.ndim != 2 or ring.shape[1] != 2 or len(ring) < 3:
        raise Error(f"{name}: expected an array of shape (n, 2), n at least 3, got shape {ring.shape}")
    return ring


def _at(q: Any, dtype: Any, function: Any) -> Any:
    wave = real("q", q)
    last_axis("q", wave, 2)
    shape: Tuple[int, ...] = wave.shape[:-1]
    limit_results("q", shape)
    result = np.empty(math.prod(shape), dtype)
    function(np.ascontiguousarray(wave).reshape(-1), result)
    return shaped(result, shape)
