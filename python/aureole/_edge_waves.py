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
from ._vectorised import choice, last_axis, limit_results, of_rows, shaped

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


class EdgeConstants(NamedTuple):
    """Result of `edge_constants`: integrals of (1 - chi) alpha_1^2 and (1 - chi) alpha_2^2 over the plane."""

    alpha1: float
    alpha2: float


class AmplitudeMoments(NamedTuple):
    """Result of `amplitude_moments`: integrals of amplitude x^a y^b over the plane, complex."""

    total: complex
    x: complex
    y: complex
    xx: complex
    xy: complex
    yy: complex


class EdgeWaves:
    """The far field of an irradiated region as a sum of waves from its edges.

    Lengths are in any one unit, wave vectors q in rad per that unit: 2 pi/wavelength times the change of direction.

    Parameters
    ----------
    edges : array_like, shape (n, 2, 2)
        Start and end of each edge in the plane across the light, x and y; the region lies to the left.
    amplitudes : array_like of real or complex numbers
        Amplitude of the light at both ends, shape (n, 2), linear between; or one number for all.
    zeroth_order : {'beam', 'edge', 'none'}
        How the undiffracted beam is removed. 'beam': the power is multiplied by 1 - chi(q), chi a Gaussian of standard
        deviation `sigma` (1/(2 s) for a Gaussian beam whose intensity has the standard deviation s), so that results do
        not depend on how edges are cut. 'edge': a chi of standard deviation sqrt(3)/length for each edge, as
        published. 'none': it is not removed.
    sigma : float, optional
        Standard deviation of chi for 'beam', in rad per unit of length.

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
        """The edges of a closed polygon, vertices counter-clockwise, evenly irradiated."""
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
        """Density of `sample` per d2q, a mixture of the densities of single edges; its integral is 1."""
        return _at(q, np.float64, self._edges.pdf)  # type: ignore[no-any-return]

    def sample(self, n: int, seed: int = 0) -> Reals:
        """`n` wave vectors, shape (n, 2), drawn from `pdf`."""
        result = np.empty(2 * integer("n", n, minimum=1, maximum=2**27))
        self._edges.sample(integer("seed", seed, minimum=0, maximum=2**64 - 1), result)
        return result.reshape(-1, 2)

    def balanced(self, q_max: Optional[float] = None, most_edges: int = 4096) -> EdgeWaves:
        """Edges for sampling, long ones cut and short ones joined until the quality is in [0.5, 2] where that is
        possible. Joined edges have another field: sample from the result, and weight the samples with the field of
        this object."""
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
    flat, flat_values = _triangles(corners, values)
    return _at(q, np.complex128, lambda at, to: _aureole.triangle_transform(flat, flat_values, at, to))  # type: ignore[no-any-return]


def triangle_power(corners: npt.ArrayLike, values: npt.ArrayLike) -> float:
    """Integral of |amplitude|^2 over triangles that do not overlap, arguments as in `triangle_transform`.

    Examples
    --------
    >>> from aureole import optics
    >>> round(optics.triangle_power([(0, 0), (1, 0), (0, 1)], [1, 0, 0]), 6)  # 1/12
    0.083333
    """
    return _aureole.triangle_power(*_triangles(corners, values))


def amplitude_moments(corners: npt.ArrayLike, values: npt.ArrayLike) -> AmplitudeMoments:
    """Integrals of the amplitude times 1, x, y, x^2, x y and y^2 over triangles, arguments as in `triangle_transform`.

    They are the field straight ahead and its first two derivatives: F(q) = total - i (x q_x + y q_y) - ... in the centre.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.amplitude_moments([(0, 0), (1, 0), (0, 1)], [1, 1, 1]).total
    (0.5+0j)
    """
    return AmplitudeMoments(*_aureole.amplitude_moments(*_triangles(corners, values)))


def zeroth_order_power(corners: npt.ArrayLike, values: npt.ArrayLike, sigma: float) -> float:
    """Power in the undiffracted beam, by the height and the curvature of its peak.

    The peak is approximated by a Gaussian, 2 pi |F(0)|^2/(4 pi^2) det(H + 1/sigma^2)^(-1/2), H the curvature of -ln
    |F|^2.

    Parameters
    ----------
    corners, values : array_like
        Triangles and amplitudes as in `triangle_transform`.
    sigma : float
        Standard deviation of chi, the Gaussian of the 0th order, in rad per unit of length.

    Returns
    -------
    float
        In amplitude^2 times area, as `EdgeWaves.power`.

    References
    ----------
    Steinberg et al. 2024, supplemental, B.16.
    """
    return _aureole.zeroth_order_power(*_triangles(corners, values), scalar("sigma", sigma, minimum=1e-100, maximum=1e100))


def edge_alpha1(along: npt.ArrayLike, across: npt.ArrayLike) -> Reals:
    """Wave of an amplitude that changes along an edge of length 1, S2.20 of Steinberg et al. 2024.

    Parameters
    ----------
    along, across : array_like
        q.e and q.m without units, e the vector from one end of the edge to the other, m its outward normal of the same length.
        Both broadcast; they must not both be 0, where the wave has no limit.

    Returns
    -------
    numpy.ndarray
        (across/|(along, across)|^2) (cos(h) - sinc(h))/(4 pi h), h half of `along`.
    """
    return _alpha(along, across, _aureole.edge_alpha1)  # type: ignore[no-any-return]


def edge_alpha2(along: npt.ArrayLike, across: npt.ArrayLike) -> Reals:
    """Wave of a constant amplitude along an edge of length 1, S2.21: (across/|(along, across)|^2) sinc(along/2)/(2 pi);
    arguments as in `edge_alpha1`.

    Examples
    --------
    >>> import math
    >>> from aureole import optics
    >>> float(optics.edge_alpha2(0.0, 2.0) * 4 * math.pi)
    1.0
    """
    return _alpha(along, across, _aureole.edge_alpha2)  # type: ignore[no-any-return]


def interfering_power(edges: npt.ArrayLike, amplitudes: npt.ArrayLike = 1.0, *, sigma: float, nodes: int = 4) -> float:
    """Power that edges diffract together to all q, one chi of standard deviation `sigma` removed: `EdgeWaves.power()`
    with a choice of the nodes along the edges.

    Parameters
    ----------
    edges, amplitudes : array_like
        As in `EdgeWaves`.
    sigma : float
        Standard deviation of chi, in rad per unit of length.
    nodes : {2, 4, 8}
        Number of nodes of Gauss's rule for each 1/sigma of an edge: errors of some 1 % with 2 and below 1e-4 with 8,
        for edges that are no closer to one another than the nodes are.

    Returns
    -------
    float
        In amplitude^2 times area.
    """
    if integer("nodes", nodes) not in (2, 4, 8):
        raise Error(f"nodes: expected 2, 4 or 8, got {nodes}")
    return EdgeWaves(edges, amplitudes, sigma=sigma)._edges.interfering_power(nodes)


def mean_edge_sigma(edges: npt.ArrayLike, amplitudes: npt.ArrayLike = 1.0) -> float:
    """Standard deviation that replaces the chi of all edges where each has its own: sqrt(3) over their mean length, weighted by
    the power of each alone (Steinberg et al. 2024, B.15); edges and amplitudes as in `EdgeWaves`, the result in rad per unit of length.

    Examples
    --------
    >>> from aureole import optics
    >>> round(optics.mean_edge_sigma([[(0, 0), (2, 0)]]), 6)  # sqrt(3)/2
    0.866025
    """
    return EdgeWaves(edges, amplitudes, zeroth_order="edge")._edges.mean_sigma()


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


def _triangles(corners: Any, values: Any) -> Tuple[Reals, Complexes]:
    triangles, amplitudes = real("corners", corners), complex_numbers("values", values)
    if triangles.ndim < 2 or triangles.ndim > 3 or triangles.shape[-2:] != (3, 2) or amplitudes.shape != triangles.shape[:-1]:
        raise Error("corners and values: expected arrays of shape (n, 3, 2) and (n, 3), "
                    f"got shapes {triangles.shape} and {amplitudes.shape}")
    return np.ascontiguousarray(triangles).reshape(-1), np.ascontiguousarray(amplitudes).reshape(-1)


def _alpha(along: Any, across: Any, function: Any) -> Any:
    arguments = {"along": real("along", along), "across": real("across", across)}
    result = of_rows(function, **arguments)
    if not np.all(np.isfinite(result)):
        raise Error("along and across: expected finite waves, got both 0 or too large")
    return result


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
