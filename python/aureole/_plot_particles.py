# SPDX-License-Identifier: Apache-2.0
"""Plots of particles: efficiencies and phase functions."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _aureole, optics
from ._arrays import real, scalar
from ._errors import Error
from ._plot_support import axes_for, curve, flag
from ._vectorised import choice

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_EFFICIENCIES = {"qext": ("extinction", "-"), "qsca": ("scattering", "--"), "qabs": ("absorption", ":")}


def efficiency(m: complex, radius: Optional[npt.ArrayLike] = None, *, wavelength: float = 500, medium: float = 1,
               x: Optional[npt.ArrayLike] = None, quantity: Union[str, Sequence[str]] = ("qext", "qsca", "qabs"),
               label: Optional[str] = None, color: Any = None, ax: "Optional[Axes]" = None) -> "Axes":
    """Efficiencies of spheres over their size: cross sections in units of the shadow's area, by Mie's theory.

    Parameters
    ----------
    m : complex
        Refractive index of the spheres over that of what is around them (`optics.mie`).
    radius : array_like, shape (n,)
        Radii in m, along the axis in um. By default, without `x`, 1000 radii from 1 nm to 100 um.
    wavelength : float
        In vacuum, in nm.
    medium : float
        Index of the medium around the spheres.
    x : array_like, shape (n,)
        Instead of `radius`, `wavelength` and `medium`: size parameters, which become the axis.
    quantity : {"qext", "qsca", "qabs"}, or several of them
        Extinction, scattering, absorption: solid, dashed and dotted lines; one alone is solid.
    label : str, optional
        For the legend; without it the curves have the names of the efficiencies.
    color : optional
        Colour of the curves, for matplotlib.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    References
    ----------
    Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, chapter 4.

    Examples
    --------
    >>> ax = aureole.plot.efficiency(1.33 + 0.01j)  # doctest: +SKIP
    """
    asked = quantity if isinstance(quantity, (list, tuple)) else [quantity]
    names = [choice("quantity", q, *_EFFICIENCIES) for q in asked]
    if not names:
        raise Error("quantity: expected one or more of qext, qsca and qabs, got none")
    if x is not None and radius is not None:
        raise Error("x: expected either x or radius, got both")
    if x is not None:
        along = np.atleast_1d(real("x", x, positive=True))
        size = along
    else:
        radii = np.geomspace(1e-9, 1e-4, 1000)
        if radius is not None:
            radii = np.atleast_1d(real("radius", radius, positive=True, unit="m"))
        nm = scalar("wavelength", wavelength, positive=True, unit="nm")
        along = radii * 1e6
        size = 2 * math.pi * radii * scalar("medium", medium, positive=True) / (nm * 1e-9)
    spheres = optics.mie(size, m)
    ax = axes_for(ax)
    first = not ax.lines
    for name in names:
        values = getattr(spheres, name)
        word, style = _EFFICIENCIES[name]
        horizontal, vertical, _ = curve("x" if x is not None else "radius", along, name, values)
        text = label if len(names) == 1 and label is not None else word if label is None else f"{label}, {word}"
        line, = ax.plot(horizontal, vertical, style if len(names) > 1 else "-", lw=1.3, color=color, label=text)
        color = line.get_color()
    if first:
        ax.set_xscale("log")
        ax.grid(alpha=0.25)
    ax.set(xlabel="size parameter" if x is not None else "radius [um]", ylabel="efficiency")
    ax.set_ylim(0, 1.05 * max(float(np.max(line.get_ydata())) for line in ax.lines))
    ax.legend(frameon=False, fontsize="small")
    return ax


def _angles(theta: Optional[npt.ArrayLike], count: int) -> npt.NDArray[np.float64]:
    """Given angles in degrees, checked, or `count` of them."""
    if theta is None:
        return np.linspace(0, 180, count)
    return np.atleast_1d(real("theta", theta, minimum=0, maximum=180, unit="degrees"))


def phase_function(theta: Optional[npt.ArrayLike] = None, values: Optional[npt.ArrayLike] = None, *,
                   x: Optional[float] = None, m: Optional[complex] = None, phase: "Optional[_aureole.Phase]" = None,
                   wavelength: float = 550, polar: bool = True, log: bool = True,
                   decades: float = 6, label: Optional[str] = None, color: Any = None,
                   ax: "Optional[Axes]" = None) -> "Axes":
    """A phase function over the angle of scattering: given values, or the phase function of spheres or of a plug-in.

    Parameters
    ----------
    theta : array_like, shape (n,)
        Angles in degrees, 0 forward, in [0, 180]. Needed for `values` only.
    values : array_like, shape (n,)
        The phase function in 1/sr.
    x, m : float and complex
        Instead of values: spheres of this size parameter and relative refractive index, unpolarised light
        (`optics.mie_phase_function`).
    phase : aureole.Phase
        Instead of values: a phase function of a scene or medium. Oriented ones (`sggx`) are shown for light along +z
        that is turned in the plane of x and z.
    wavelength : float
        Of `phase`, in nm.
    polar : bool
        Polar axes, mirrored to the full circle, with 0 to the right; otherwise the angle is the x axis.
    log : bool
        Logarithmic values, in polar axes over `decades` below the largest.
    decades : float
    label : str, optional
        For the legend.
    color : optional
        Colour of the curve, for matplotlib.
    ax : matplotlib Axes, optional
        Polar ones for ``polar=True``.

    Returns
    -------
    matplotlib Axes
    """
    if (x is None) != (m is None):
        raise Error(f"{'x' if x is None else 'm'}: expected a value, since {'m' if x is None else 'x'} is given")
    if sum(given is not None for given in (values, x, phase)) > 1:
        raise Error("values: expected one of values, spheres (x and m) and phase, got more")
    if x is not None:
        size = scalar("x", x, positive=True)
        # Oscillations are 180/x degrees wide.
        angles = _angles(theta, int(min(max(721, 40 * size), 40_001)))
        theta = angles
        values = optics.mie_phase_function(size, m, np.cos(np.radians(angles))).reshape(-1)  # type: ignore[arg-type]
    elif phase is not None:
        if not isinstance(phase, _aureole.Phase):
            raise TypeError(f"phase: expected a phase function of aureole, got {type(phase).__name__}")
        angles = _angles(theta, 3601)
        wo = np.stack([np.sin(np.radians(angles)), 0 * angles, np.cos(np.radians(angles))], -1)
        theta, values = angles, phase.eval([0, 0, -1], wo, scalar("wavelength", wavelength, positive=True, unit="nm"))
    elif theta is None or values is None:
        raise Error(f"{'theta' if theta is None else 'values'}: expected an array, or spheres by x and m, or a phase")
    degrees, p, _ = curve("theta", real("theta", theta, minimum=0, maximum=180, unit="degrees"), "values",
                          real("values", values, minimum=0))
    span = scalar("decades", decades, positive=True, maximum=300)
    logarithmic = flag("log", log)
    new = ax is None
    ax = axes_for(ax, polar=flag("polar", polar))
    if polar:
        angles = np.radians(np.concatenate([-degrees[::-1], degrees]))
        p = np.concatenate([p[::-1], p])
        view: Any = ax
        if logarithmic and np.any(p > 0):
            peak = float(p.max())
            floor = peak * 10**-span
            if not new and ax.lines and view.get_yscale() == "log":
                floor, top = min(floor, view.get_rmin()), max(peak * 2, view.get_rmax())
            else:
                top = peak * 2
            p = np.maximum(p, floor)
            ax.plot(angles, p, label=label, color=color, lw=1.4)
            view.set_rscale("log")
            view.set_rlim(floor, top)
            every = max(1, math.ceil(math.log10(top / floor) / 5))
            view.set_rticks([10.0**k for k in range(math.ceil(math.log10(floor)), math.floor(math.log10(top)) + 1,
                                                    every)])
        else:
            ax.plot(angles, p, label=label, color=color, lw=1.4)
        view.set_thetagrids(range(0, 360, 30), [f"{min(a, 360 - a)}°" for a in range(0, 360, 30)])
        view.set_rlabel_position(100)
        view.tick_params(axis="y", labelsize="x-small", colors="0.35")
        ax.set_title("phase function [1/sr]", fontsize="medium")
    else:
        ax.plot(degrees, p, label=label, color=color, lw=1.4)
        ax.set(xlim=(0, 180), xticks=range(0, 181, 30), xlabel="scattering angle [degrees]",
               ylabel="phase function [1/sr]",
               yscale="log" if logarithmic else "linear")
    ax.grid(alpha=0.35)
    if label is not None:
        ax.legend(frameon=False, fontsize="small", loc="lower left" if polar else "best",
                  bbox_to_anchor=(-0.12, -0.1) if polar else None)
    return ax
