# SPDX-License-Identifier: Apache-2.0
"""Distributions of the radii of particles."""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import real
from ._errors import Error
from ._vectorised import choice


class SizeDistribution(NamedTuple):
    """Result of `size_distribution`: radii with their weights, and means of them all.

    Attributes
    ----------
    radius : numpy.ndarray
        Increasing, in m.
    weight : numpy.ndarray
        Shares of the number of particles; their sum is 1. ``(weight * f(radius)).sum()`` is the mean of f.
    effective_radius : float
        Mean of r^3 over that of r^2, in m.
    effective_variance : float
        Variance of r about the effective radius, weighted by area, over the square of the effective radius.
    mean_area, mean_volume : float
        Means of pi r^2 and 4/3 pi r^3, in m^2 and m^3.
    """

    radius: npt.NDArray[np.float64]
    weight: npt.NDArray[np.float64]
    effective_radius: float
    effective_variance: float
    mean_area: float
    mean_volume: float


def _number(name: str, value: Any, **bounds: Any) -> float:
    array = real(name, value, **bounds)
    if array.shape != ():
        raise Error(f"{name}: expected one number, got an array of shape {array.shape}")
    return float(array)


def size_distribution(kind: str, radius: float, *, spread: float = 0, weighting: str = "number",
                      effective_variance: float = 0.1, alpha: float = 6, gamma: float = 1,
                      steps: float = 64) -> SizeDistribution:
    """Distribution of the radii of particles: nodes and weights for averages, and common means.

    Parameters
    ----------
    kind : str
        "log_normal", "gamma" (Hansen) or "modified_gamma" (Deirmendjian): with the parameters of the phase function
        `mie` and of the ingredient `spheres`.
    radius : float
        In m: the median of a log-normal distribution, the effective radius of gamma, the most frequent radius of
        modified_gamma.
    spread : float
        For a log-normal distribution the standard deviation of ln(radius), in [0, 1.5]; 0: one radius.
    weighting : str
        "number" or "volume": by which the log-normal distribution is stated.
    effective_variance : float
        For gamma, in (0, 0.5).
    alpha, gamma : float
        For modified_gamma: r^alpha exp(-(alpha/gamma) (r/radius)^gamma).
    steps : float
        Nodes for each factor e of the radius.

    Returns
    -------
    SizeDistribution

    References
    ----------
    Hansen, J. Atmos. Sci. 28 (1971) 1400; Deirmendjian, Electromagnetic Scattering on Spherical Polydispersions, 1969.

    Examples
    --------
    >>> from aureole import optics
    >>> cloud = optics.size_distribution("modified_gamma", 4e-6, alpha=6, gamma=1)
    >>> round(cloud.effective_radius * 1e6, 3)
    6.0
    """
    choice("kind", kind, "log_normal", "gamma", "modified_gamma")
    choice("weighting", weighting, "number", "volume")
    first, second = {"log_normal": (_number("spread", spread, minimum=0, maximum=1.5), 0.0),
                     "gamma": (_number("effective_variance", effective_variance, positive=True), 0.0),
                     "modified_gamma": (_number("alpha", alpha, positive=True), _number("gamma", gamma, positive=True))}[kind]
    radii, weights, means = _aureole.size_distribution(kind, _number("radius", radius, positive=True), first, second,
                                                       weighting == "volume", _number("steps", steps, minimum=1, maximum=10000))
    return SizeDistribution(np.array(radii), np.array(weights), *means)
