# SPDX-License-Identifier: Apache-2.0
"""Positions of scatterers, their structure factor and pair correlation. See `aureole.optics`."""
from __future__ import annotations

from typing import Any, NamedTuple, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._apertures import _flag
from ._arrays import integer, real, scalar
from ._errors import Error
from ._vectorised import broadcast, choice, last_axis, limit_results, shaped

Reals = npt.NDArray[np.float64]
_MOST_QA = 1e4  # upper bound of |q| a: time and memory of means over rings of anisotropic patterns grow with it


class HardDiscs(NamedTuple):
    """Result of `hard_discs`.

    Attributes
    ----------
    positions : numpy.ndarray, shape (n, 2) or (snapshots, n, 2)
        Centres, in [0, box).
    radius : numpy.ndarray, shape (n,)
    box : numpy.ndarray, shape (2,)
        Sides of the periodic box.
    pressure : float
        Relative to the pressure of an ideal gas, averaged from the first snapshot to the last; nan for one snapshot.
    """

    positions: Reals
    radius: Reals
    box: Reals
    pressure: float


class PairCorrelation(NamedTuple):
    """Result of `pair_correlation`: arrays with one element for each bin.

    Attributes
    ----------
    r : numpy.ndarray
        Middles of the bins.
    g : numpy.ndarray
        Density of pairs relative to independent points.
    error : numpy.ndarray
        Standard error of `g`.
    low, high : numpy.ndarray
        Ends of the 95 % confidence interval.
    """

    r: Reals
    g: Reals
    error: Reals
    low: Reals
    high: Reals


class PointStructureFactor(NamedTuple):
    """Result of `point_structure_factor`: arrays with one element for each ring of wave vectors.

    Attributes
    ----------
    q : numpy.ndarray
        Mean length of the wave vectors, rad per unit of the positions.
    s : numpy.ndarray
        Structure factor without its delta at q = 0.
    error : numpy.ndarray
        Standard error of `s`.
    low, high : numpy.ndarray
        Ends of the 95 % confidence interval.
    """

    q: Reals
    s: Reals
    error: Reals
    low: Reals
    high: Reals


class StructureFactor:
    """A structure factor S'(q a) without its delta at q = 0, a the correlation radius.

    Made by the class methods; called with values of q a, it returns S'.

    Examples
    --------
    >>> from aureole.optics import StructureFactor
    >>> fluid = StructureFactor.percus_yevick(0.5)
    >>> fluid([0, 3.3, 100]).round(3)
    array([0.083, 1.393, 1.002])
    """

    def __init__(self, compiled: Any) -> None:
        if not isinstance(compiled, _aureole.StructureFactor):
            raise TypeError("StructureFactor: made by its class methods, such as StructureFactor.percus_yevick(0.5)")
        self._compiled = compiled

    @property
    def is_isotropic(self) -> bool:
        """Whether S' depends on |q| alone."""
        return self._compiled.is_isotropic

    def __call__(self, qa: npt.ArrayLike) -> Reals:
        """S' at |q| a (rad, up to 1e4); of an anisotropic arrangement the mean over directions."""
        u = real("qa", qa, minimum=-_MOST_QA, maximum=_MOST_QA)
        limit_results("qa", u.shape)
        result = np.empty(u.size)
        self._compiled.evaluate(np.ascontiguousarray(u).reshape(-1), False, result)
        return shaped(result, u.shape)  # type: ignore[no-any-return]

    def at(self, qa: npt.ArrayLike) -> Reals:
        """S' at vectors q a of shape (..., 2), rad, up to 1e4."""
        u = real("qa", qa, minimum=-_MOST_QA, maximum=_MOST_QA)
        last_axis("qa", u, 2)
        limit_results("qa", u.shape)
        result = np.empty(u.size // 2)
        self._compiled.evaluate(np.ascontiguousarray(u).reshape(-1), True, result)
        return shaped(result, u.shape[:-1])  # type: ignore[no-any-return]

    @classmethod
    def poisson(cls) -> "StructureFactor":
        """Independent positions: 1."""
        return cls(_aureole.poisson_factor())

    @classmethod
    def percus_yevick(cls, area_fraction: float) -> "StructureFactor":
        """Fluid of equal hard discs in closed form, as `structure_factor`."""
        return cls(_aureole.percus_yevick_factor(_fraction(area_fraction, 0.7)))

    @classmethod
    def simulated(cls, area_fraction: float, *, discs: int = 1500, snapshots: int = 1200,
                  seed: int = 0) -> "StructureFactor":
        """Fluid of equal hard discs, measured in eight simulations and smoothed with the help of theory.

        Parameters
        ----------
        area_fraction : float
            In [0, 0.68]. Below 0.03 the theoretical correlation is returned.
        discs : int
            In each simulation, 200 to 5000.
        snapshots : int
            Of all simulations together, from 16; discs times snapshots is at most 4e6.
        seed : int
            The same seed gives the same result on any number of cores.

        Notes
        -----
        Takes seconds (3 on two cores by default, longer above 0.6). Ctrl-C returns at once, while the simulations end
        in the background.
        """
        count, taken = integer("discs", discs, minimum=200, maximum=5000), integer("snapshots", snapshots, minimum=16)
        if count * taken > 4_000_000:
            raise Error(f"snapshots: expected at most {4_000_000 // count} for {count} discs, got {taken}")
        return cls(_aureole.simulated_factor(_fraction(area_fraction, 0.68), count, taken, _seed(seed)))

    @classmethod
    def lattice(cls, area_fraction: float, *, kind: str = "hexagonal", jitter: float = 0.1, domain: float = 4.0,
                angle: float = 0.0, random_orientation: bool = True) -> "StructureFactor":
        """A lattice whose order decays with distance.

        Parameters
        ----------
        area_fraction : float
            pi a^2 times the density, above 0, up to pi/sqrt(12) (hexagonal) or pi/4 (square), where discs of radius a
            touch.
        kind : {"hexagonal", "square"}
        jitter : float
            Standard deviation of independent displacements along each axis, in lattice spacings, in [0, 1].
        domain : float
            Order of pairs at a distance r decays as exp(-r^2/(2 domain^2)); in lattice spacings, at least 0.5, at
            most 25 a.
        angle : float
            From x to a lattice vector, rad.
        random_orientation : bool
            Whether the result is the mean over domains of all orientations.

        References
        ----------
        Guinier, X-ray Diffraction, 1963, chapter 7.
        """
        choice("kind", kind, "hexagonal", "square")
        fraction = scalar("area_fraction", area_fraction, positive=True, maximum=1)
        return cls(_aureole.lattice_factor(kind == "hexagonal", fraction,
                                           scalar("jitter", jitter, minimum=0, maximum=1),
                                           scalar("domain", domain, minimum=0.5),
                                           scalar("angle", angle, minimum=-1e3, maximum=1e3),
                                           _flag("random_orientation", random_orientation)))

    @classmethod
    def table(cls, qa: npt.ArrayLike, s: npt.ArrayLike) -> "StructureFactor":
        """Values `s` at increasing `qa`, linear in between, constant below the first, and 1 beyond the last."""
        return cls(_aureole.tabulated_factor(*_columns("qa", qa, "s", s)))

    @classmethod
    def from_pair_correlation(cls, ra: npt.ArrayLike, g: npt.ArrayLike, area_fraction: float) -> "StructureFactor":
        """The transform of a table of g(r/a), tapered to 1 at its end, which is between 4 and 200.

        `area_fraction` is pi a^2 times the density, in [0, 1].
        """
        fraction = scalar("area_fraction", area_fraction, minimum=0, maximum=1)
        return cls(_aureole.factor_of_pair_correlation(*_columns("ra", ra, "g", g), fraction))


def structure_factor(qa: npt.ArrayLike, area_fraction: npt.ArrayLike, *, model: str = "percus_yevick") -> Reals:
    """Structure factor, without its delta at q = 0, of a fluid of equal hard discs.

    Parameters
    ----------
    qa : array_like
        |q| a in rad, a the radius of the discs; up to 1e9.
    area_fraction : array_like
        Covered part of the plane, in [0, 0.7].
    model : {"percus_yevick", "poisson"}
        Percus-Yevick form of Rosenfeld ("Free-energy model for the inhomogeneous hard-sphere fluid in D dimensions",
        1990, equations 4.4-4.6), or independent positions, 1. `StructureFactor` has more models.

    Returns
    -------
    numpy.ndarray
        Of the shape that `qa` and `area_fraction` broadcast to; positive.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.structure_factor(0, [0, 0.1, 0.5]).round(4)  # (1 - Fa)^3/(1 + Fa)
    array([1.    , 0.6627, 0.0833])
    """
    u, fraction = real("qa", qa, minimum=-1e9, maximum=1e9), _fractions(area_fraction)
    choice("model", model, "percus_yevick", "poisson")
    shape, (flat_u, flat_fraction) = broadcast(qa=u, area_fraction=fraction)
    result = np.ones(flat_u.size)
    if model == "percus_yevick":
        _aureole.hard_disc_structure_factor(flat_u, flat_fraction, result)
    return shaped(result, shape)  # type: ignore[no-any-return]


def hard_disc_pair_correlation(ra: npt.ArrayLike, area_fraction: npt.ArrayLike) -> Reals:
    """Pair correlation g(r) of a fluid of equal hard discs, the transform of `structure_factor`.

    Parameters
    ----------
    ra : array_like
        r/a, a the radius of the discs, in [0, 200]; discs touch at 2.
    area_fraction : array_like
        Covered part of the plane, in [0, 0.7].

    Returns
    -------
    numpy.ndarray
        Of the shape that `ra` and `area_fraction` broadcast to. Numerically exact to 1e-5 from contact on. In two
        dimensions the model is an approximation that keeps discs apart only roughly: just inside of contact it is not 0
        (0.7 at an area fraction of 0.5), and at contact it is too small (2.78 there, 3.13 by Henderson's equation).

    Examples
    --------
    >>> from aureole import optics
    >>> optics.hard_disc_pair_correlation([2, 3, 4, 20], 0.5).round(2)
    array([2.78, 0.89, 0.95, 1.  ])
    """
    r, fraction = real("ra", ra, minimum=0, maximum=200), _fractions(area_fraction)
    shape, (flat_r, flat_fraction) = broadcast(ra=r, area_fraction=fraction)
    result = np.empty(flat_r.size)
    _aureole.hard_disc_pair_correlation(flat_r, flat_fraction, result)
    return shaped(result, shape)  # type: ignore[no-any-return]


def hard_discs(n: int, area_fraction: float, seed: int = 0, *, radius: npt.ArrayLike = 1.0,
               snapshots: Optional[int] = None, sweeps: Optional[float] = None) -> HardDiscs:
    """Hard discs in equilibrium in a periodic square box, by event-chain Monte Carlo.

    Parameters
    ----------
    n : int
        Number of discs, up to 1e6; the box must be at least four times as wide as the largest disc.
    area_fraction : float
        Covered part of the plane, in [1e-6, 0.68].
    seed : int
        The same seed gives the same discs, bit by bit.
    radius : array_like, shape () or (n,)
        Radius of all discs, or a radius for each disc of a mixture of up to 20000 discs, whose radii differ by a
        factor of 100 at most.
    snapshots : int, optional
        Number of configurations of one simulation that are returned. They are far enough apart for each to add
        information, but not independent. All together at most 2^27 positions.
    sweeps : float, optional
        Collisions per disc before the first snapshot. By default enough for the initial lattice to vanish: some 200
        for up to 1500 discs, more for larger numbers. 10^4 discs take about a second, 10^5 discs minutes.

    Returns
    -------
    HardDiscs

    References
    ----------
    Bernard, Krauth & Wilson, "Event-chain Monte Carlo algorithms for hard-sphere systems", 2009.

    Examples
    --------
    >>> from aureole import optics
    >>> discs = optics.hard_discs(400, 0.5, seed=1)
    >>> discs.positions.shape, discs.box.round(3)
    ((400, 2), array([50.133, 50.133]))
    """
    count = integer("n", n, minimum=1, maximum=10**6)
    fraction = scalar("area_fraction", area_fraction, minimum=1e-6, maximum=0.68)
    radii = real("radius", radius, positive=True, minimum=1e-100, maximum=1e100)
    if radii.shape not in ((), (count,)):
        raise Error(f"radius: expected one number or an array of shape ({count},), got shape {radii.shape}")
    mixed = radii.ndim == 1 and bool(np.any(radii != radii[0]))
    unit = float(np.max(radii))
    if mixed and (count > 20000 or unit > 100 * float(np.min(radii))):
        raise Error("radius: expected equal radii, or at most 20000 that differ by a factor of 100 at most")
    taken = 1 if snapshots is None else integer("snapshots", snapshots, minimum=1)
    if taken * count > 2**27:
        raise Error(f"snapshots: expected at most 2^27 positions in all, got {taken} x {count}")
    first = -1.0 if sweeps is None else scalar("sweeps", sweeps, minimum=0, maximum=1e9)
    relative = np.broadcast_to(radii / unit, (count,))
    positions = np.empty((taken, count, 2))
    box, pressure = _aureole.hard_discs(np.ascontiguousarray(relative), fraction, _seed(seed), first, -1.0, positions)
    positions *= unit
    taken_out = positions[0] if snapshots is None else positions
    return HardDiscs(taken_out, unit * relative, np.full(2, unit * box), pressure)


def pair_correlation(positions: npt.ArrayLike, box: npt.ArrayLike, *, r_max: Optional[float] = None, bins: int = 60,
                     edges: Optional[npt.ArrayLike] = None, periodic: bool = True, tiles: int = 4) -> PairCorrelation:
    """Pair correlation g(r) of points, with confidence intervals.

    Parameters
    ----------
    positions : array_like, shape (n, 2) or (snapshots, n, 2)
        Points in [0, box], of one field or of several independent ones.
    box : array_like, shape () or (2,)
        Sides of the field in the unit of the positions.
    r_max : float, optional
        End of the equal bins from 0, at most half of the shorter side; by default that or five mean distances,
        whichever is smaller.
    bins : int
        Number of equal bins, up to 10000.
    edges : array_like, optional
        Increasing edges of bins in place of `r_max` and `bins`.
    periodic : bool
        The box repeats (simulations). Otherwise it is a window on a larger pattern (micrographs), and pairs count with
        the translational edge correction of Ohser & Stoyan ("On the second-order and orientation analysis of planar
        stationary point processes", 1981).
    tiles : int
        3 to 32. The error is estimated from the differences between tiles x tiles parts of each field, each of which
        has the first points of its pairs (after Loh, "A valid and fast spatial bootstrap for correlation functions",
        2008). Differences that the numbers of points explain are removed before. For distances near to the size of a
        part it is some 40 % too large, where points are independent.

    Returns
    -------
    PairCorrelation
        Intervals are Student's; where a bin has no pair, `high` is the value at which it would be empty with a
        probability of 2.5 %.

    Examples
    --------
    >>> from aureole import optics
    >>> discs = optics.hard_discs(2000, 0.4, seed=3)
    >>> g = optics.pair_correlation(discs.positions, discs.box, edges=[0, 2, 2.1])
    >>> g.g.round(1)
    array([0., 2.])
    """
    points, sides = _points(positions, box, _flag("periodic", periodic))
    count = points.shape[1]
    half = float(sides.min()) / 2
    if edges is not None:
        bounds = real("edges", edges, minimum=0, maximum=half * (1 + 1e-9))
        if bounds.ndim != 1 or bounds.size < 2 or bounds.size > 10001 or np.any(np.diff(bounds) <= 0):
            raise Error("edges: expected 2 to 10001 increasing numbers")
    else:
        end = min(half, 5 * float(np.sqrt(sides[0] * sides[1] / count))) if r_max is None else scalar(
            "r_max", r_max, positive=True, maximum=half * (1 + 1e-9))
        bounds = np.linspace(0, end, integer("bins", bins, minimum=1, maximum=10000) + 1)
        if not np.all(np.diff(bounds) > 0):
            raise Error(f"r_max: expected bins that can be told apart, got {end:g}")
    side = integer("tiles", tiles, minimum=3, maximum=32)
    limit_results("positions, tiles and bins", (max(64, len(points)), side * side, bounds.size - 1))
    sums, members = np.empty((len(points), side * side, bounds.size - 1)), np.empty((len(points), side * side))
    area = float(sides[0] * sides[1])
    for field, pairs, number in zip(points, sums, members):
        _aureole.count_pairs(field, sides[0], sides[1], bool(periodic), np.ascontiguousarray(bounds), side, pairs)
        tile = np.clip((field / sides * side).astype(int), 0, side - 1)
        number[:] = np.bincount(tile[:, 1] * side + tile[:, 0], minlength=side * side)
    ring = np.pi * np.diff(bounds**2)
    parts, number = sums.reshape(-1, ring.size), members.reshape(-1)
    expected = number.sum() * (count - 1) / area**2 * ring
    all_pairs = parts.sum(axis=0)
    g = all_pairs / expected
    # Influence of each part of the window on g, regressed on the part's number of points: parts with more points have
    # more pairs, but the total number of points is given.
    influence = parts / expected - g / len(number)
    excess = (number - number.mean())[:, None]
    if np.any(excess):
        influence = influence - excess * (excess * influence).sum(axis=0) / (excess**2).sum()
    freedom = len(number) - 2
    error = np.sqrt(len(number) / freedom * (influence**2).sum(axis=0))
    reach = _student(freedom) * error
    empty = 3.69 / (0.5 * expected * area)  # limit at which the probability exp(-3.69) of an empty bin is 0.025
    high = np.where(g > 0, g + reach, empty)
    return PairCorrelation(0.5 * (bounds[1:] + bounds[:-1]), g, error, np.maximum(g - reach, 0.0), high)


def point_structure_factor(positions: npt.ArrayLike, box: npt.ArrayLike, *, q_max: Optional[float] = None,
                           rings: int = 60, edges: Optional[npt.ArrayLike] = None, periodic: bool = True,
                           per_ring: int = 200) -> PointStructureFactor:
    """Structure factor of points, mean over directions, with confidence intervals.

    Parameters
    ----------
    positions : array_like, shape (n, 2) or (snapshots, n, 2)
        Points in [0, box], of one field or of several independent ones.
    box : array_like, shape () or (2,)
        Sides of the field in the unit of the positions.
    q_max : float, optional
        End of equal rings of wave vectors, rad per unit; by default 20 over the mean distance of points. At most 1024
        waves per side.
    rings : int
        Number of equal rings, up to 2000. Rings without a wave vector of a periodic box are left out.
    edges : array_like, optional
        Increasing edges of rings in place of `q_max` and `rings`.
    periodic : bool
        The box repeats: S is evaluated at its own wave vectors. Otherwise it is a window on a larger pattern: points
        are weighted by a taper (Hann) against side lobes, which limits the resolution of S to about 12/side, and S is
        evaluated at the middles of rings, from 4 pi/(shorter side) on.
    per_ring : int
        Upper bound of the number of wave vectors in a ring of a periodic box.

    Returns
    -------
    PointStructureFactor
        Errors follow from the number of independent wave vectors, whose power has a standard deviation equal to its
        mean.

    Examples
    --------
    >>> import numpy as np
    >>> from aureole import optics
    >>> points = np.random.default_rng(1).uniform(0, 100, (5000, 2))
    >>> s = optics.point_structure_factor(points, 100, edges=[0.5, 1, 2, 4])
    >>> bool(np.all((s.low < 1) & (1 < s.high)))
    True
    """
    points, sides = _points(positions, box, _flag("periodic", periodic))
    count = points.shape[1]
    end = 1024 * 2 * np.pi / float(sides.max())
    start = 0.0 if periodic else 4 * np.pi / float(sides.min())
    if edges is not None:
        bounds = real("edges", edges, minimum=0, maximum=end)
        if bounds.ndim != 1 or bounds.size < 2 or bounds.size > 2001 or np.any(np.diff(bounds) <= 0):
            raise Error("edges: expected 2 to 2001 increasing numbers")
        if not periodic and bounds[0] + bounds[1] < 2 * start * (1 - 1e-9):
            raise Error(f"edges: expected middles of at least 4 pi/(shorter side) = {start:g} for a window")
    else:
        last = min(end, 20 * float(np.sqrt(count / (sides[0] * sides[1])))) if q_max is None else scalar(
            "q_max", q_max, positive=True, maximum=end)
        if not last > start * 1.01:
            raise Error(f"q_max: expected more than 4 pi/(shorter side) = {start:g} for a window, got {last:g}")
        bounds = np.linspace(start, last, integer("rings", rings, minimum=1, maximum=2000) + 1)
    wanted = integer("per_ring", per_ring, minimum=1, maximum=10**6)
    if not periodic:
        q = 0.5 * (bounds[1:] + bounds[:-1])
        s, error = result = np.empty((2, q.size))
        _aureole.window_structure_factor(points, sides[0], sides[1], q, result)
        return PointStructureFactor(q, s, error, np.maximum(s - 1.96 * error, 0.0), s + 1.96 * error)
    # The work of a snapshot is limited, since it cannot be interrupted: it takes about a nanosecond per point and vector.
    vectors = min(wanted * (bounds.size - 1.0), bounds[-1] ** 2 * sides[0] * sides[1] / (8 * np.pi) + 4 * 1024)
    if vectors * count > 2**34:
        raise Error(f"per_ring: expected at most 2^34 for points times wave vectors, got {count} x {vectors:.0f}")
    found = np.empty((3, bounds.size - 1))
    filled = _aureole.ring_structure_factor(points, sides[0], sides[1], np.ascontiguousarray(bounds), wanted, found)
    q, s, seen = found[:, :filled]
    # Effective degrees of freedom of means of exponentially distributed powers; quantiles of chi^2 by Wilson
    # & Hilferty (1931).
    freedom = 2 * seen * len(points)
    low, high = (s / (1 - 2 / (9 * freedom) + z * np.sqrt(2 / (9 * freedom))) ** 3 for z in (1.96, -1.96))
    return PointStructureFactor(q, s, s / np.sqrt(0.5 * freedom), low, high)


def _fraction(value: Any, maximum: float) -> float:
    return scalar("area_fraction", value, minimum=0, maximum=maximum)


def _fractions(value: Any) -> Reals:
    return real("area_fraction", value, minimum=0, maximum=0.7)


def _seed(seed: Any) -> int:
    return integer("seed", seed, minimum=0, maximum=2**64 - 1)


def _columns(first: str, a: Any, second: str, b: Any) -> Tuple[Reals, Reals]:
    x, y = real(first, a, minimum=0), real(second, b, minimum=0)
    if x.ndim != 1 or y.shape != x.shape:
        raise Error(f"{second}: expected the shape of {first}, one axis, got {y.shape} and {x.shape}")
    if x.size > 100000:
        raise Error(f"{first}: expected at most 100000 values, got {x.size}")
    return np.ascontiguousarray(x), np.ascontiguousarray(y)


def _student(freedom: int) -> float:
    """Returns the 97.5 % quantile of Student's t, by its expansion about the normal one (Abramowitz & Stegun 26.7.5)."""
    z = 1.959964
    return z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)


def _points(positions: Any, box: Any, periodic: bool) -> Tuple[Reals, Reals]:
    """Returns positions (fields, n, 2) within the box, and the sides of the box."""
    sides = real("box", box, positive=True, minimum=1e-100, maximum=1e100)
    if sides.shape not in ((), (2,)):
        raise Error(f"box: expected one number or two, got shape {sides.shape}")
    sides = np.ascontiguousarray(np.broadcast_to(sides, (2,)))
    if sides.max() > 1e6 * sides.min():
        raise Error(f"box: expected sides that differ by a factor of 10^6 at most, got {sides[0]:g} x {sides[1]:g}")
    points = real("positions", positions)
    last_axis("positions", points, 2)
    if points.ndim not in (2, 3) or points.shape[-2] < 2 or points.size == 0:
        raise Error(f"positions: expected an array of shape (n, 2) or (snapshots, n, 2) with n of 2 or more, got shape "
                    f"{points.shape}")
    if points.shape[-2] > 10**7:
        raise Error(f"positions: expected at most 10^7 points in a field, got {points.shape[-2]}")
    if np.any((points < 0) | (points > sides)):
        outside = points[np.any((points < 0) | (points > sides), axis=-1)][0]
        raise Error(f"positions: expected points in [0, {sides[0]:g}] x [0, {sides[1]:g}], got ({outside[0]:g}, "
                    f"{outside[1]:g}); numpy.mod brings points into a periodic box")
    if periodic:
        points = np.where(points >= sides, 0.0, points)
    return np.ascontiguousarray(points.reshape((-1,) + points.shape[-2:])), sides
