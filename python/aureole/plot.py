# SPDX-License-Identifier: Apache-2.0
"""Plots with matplotlib: lobes, spectra in their colours, phase functions, efficiencies, coronas, pair statistics.

Every function takes axes to draw on, makes new ones where `ax` is None, and returns them. matplotlib is needed only
when a function is called: ``pip install aureole[plot]``.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
import numpy.typing as npt

from . import _corona
from ._arrays import integer, scalar, text
from ._errors import Error
from ._plot_check import check_report
from ._plot_particles import efficiency, phase_function
from ._plot_support import as_bsdf, axes_for, colour_of, curve, flag, incident, matplotlib, wavelengths_of
from ._vectorised import choice

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["check_report", "corona", "corona_profile", "efficiency", "lobe_map", "lobe_polar", "pair_correlation",
           "phase_function", "spectrum", "structure_factor"]

_VISIBLE = np.arange(380.0, 781.0, 5.0)


def lobe_polar(bsdf: Any, theta_i: float, wavelength: npt.ArrayLike = 550, *, log: bool = False, decades: float = 4,
               cosine: bool = True, samples: int = 2881, ax: "Optional[Axes]" = None) -> "Axes":
    """Polar plot of a BSDF in the plane of incidence, reflection above and transmission below.

    Delta lobes (mirrors, light that passes straight through) have no density and are not shown.

    Parameters
    ----------
    bsdf : aureole.Bsdf, or an object with ``eval``, ``sample`` and ``pdf``
    theta_i : float
        Angle of incidence from the normal in degrees, beyond 90 from below.
    wavelength : float or array_like of shape (n,)
        In nm; each has a curve in its colour.
    log : bool
        Logarithmic radius over `decades` below the largest value.
    decades : float
        Range of a logarithmic radius.
    cosine : bool
        True: what `eval` gives, f cos(theta_o); False: f.
    samples : int
        Directions around the circle.
    ax : matplotlib polar Axes, optional

    Returns
    -------
    matplotlib polar Axes
        Angles of outgoing directions are in rad clockwise from the normal; mirror reflection is at ``theta_i``.

    Examples
    --------
    >>> ax = aureole.plot.lobe_polar(bsdf, 45, [450, 550, 650])  # doctest: +SKIP
    """
    instance = as_bsdf(bsdf)
    degrees, wi = incident(theta_i)
    nm = wavelengths_of("wavelength", wavelength)
    count = integer("samples", samples, minimum=8, maximum=10_000_000)
    span = scalar("decades", decades, positive=True, maximum=30)
    logarithmic, with_cosine = flag("log", log), flag("cosine", cosine)
    ax = axes_for(ax, polar=True)
    angles = np.linspace(-math.pi, math.pi, count)
    wo = np.stack([np.sin(angles), np.zeros(count), np.cos(angles)], -1)
    values = np.asarray(instance.eval(wi, wo[:, None, :], nm), np.float64)
    if not with_cosine:
        values = values / np.maximum(np.abs(wo[:, 2:]), 1e-6)
    peak = float(np.nanmax(values)) if np.any(values > 0) else 1.0
    floor = peak * 10**-span
    for k, wave in enumerate(nm):
        radius = np.maximum(values[:, k], floor) if logarithmic else values[:, k]
        ax.plot(angles, radius, color=colour_of(wave), lw=1.6, label=f"{wave:g} nm")
    polar: Any = ax
    polar.set_theta_zero_location("N")
    polar.set_theta_direction(-1)
    polar.set_thetagrids(range(0, 360, 30), [f"{min(a, 360 - a)}°" for a in range(0, 360, 30)])
    if logarithmic:
        polar.set_rscale("log")
        polar.set_rlim(floor, peak * 1.3)
    else:
        polar.set_rlim(0, peak * 1.05)
        polar.yaxis.set_major_locator(matplotlib().ticker.MaxNLocator(4))
    polar.set_rlabel_position(75)
    polar.tick_params(axis="y", labelsize="x-small", colors="0.35")
    polar.grid(alpha=0.35)
    # The surface, and the ray that arrives.
    top = polar.get_ylim()[1]
    for side in (-0.5, 0.5):
        ax.plot([side * math.pi] * 2, [polar.get_ylim()[0], top], color="0.25", lw=1.2)
    ax.annotate("", xy=(0.5, 0.5), xytext=(0.5 + 0.5 * wi[0], 0.5 + 0.5 * wi[2]), xycoords="axes fraction",
                textcoords="axes fraction",
                arrowprops={"arrowstyle": "->", "color": "0.25", "lw": 1.3, "linestyle": "--"})
    what = r"$f\,|\cos\theta_o|$" if with_cosine else "$f$"
    ax.set_title(f"{what} [1/sr] at {degrees:g}° incidence" + (", log" if logarithmic else ""), fontsize="medium")
    ax.legend(loc="lower left", bbox_to_anchor=(-0.12, -0.1), fontsize="small", frameon=False)
    return ax


def lobe_map(bsdf: Any, theta_i: float, wavelength: float = 550, *, side: str = "reflection", log: bool = True,
             decades: float = 4, cosine: bool = True, phi_i: float = 180, resolution: int = 400, cmap: str = "magma",
             ax: "Optional[Axes]" = None) -> "Axes":
    """A BSDF over the hemisphere of outgoing directions, projected onto the surface.

    Parameters
    ----------
    bsdf : aureole.Bsdf, or an object with ``eval``, ``sample`` and ``pdf``
    theta_i, phi_i : float
        Direction of incidence in degrees: from the normal (beyond 90 from below), and around it from the x axis.
    wavelength : float
        In nm.
    side : {"reflection", "transmission"}
        The hemisphere that is shown.
    log : bool
        Logarithmic colours over `decades` below the largest value.
    decades : float
        Range of logarithmic colours.
    cosine : bool
        True: what `eval` gives, f cos(theta_o); False: f.
    resolution : int
        Pixels across the disc.
    cmap : str
        Colour map of matplotlib.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes
        x and y are components of the outgoing unit vector; circles are 30 and 60 degrees from the normal, the cross is
        the mirror direction (or the one straight through).
    """
    instance = as_bsdf(bsdf)
    degrees, _ = incident(theta_i)
    phi = math.radians(scalar("phi_i", phi_i))
    theta = math.radians(degrees)
    wi = np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])
    nm = scalar("wavelength", wavelength, positive=True, unit="nm")
    n = integer("resolution", resolution, minimum=2, maximum=8192)
    span = scalar("decades", decades, positive=True, maximum=30)
    logarithmic, with_cosine = flag("log", log), flag("cosine", cosine)
    choice("side", side, "reflection", "transmission")
    ax = axes_for(ax)
    at = (np.arange(n) + 0.5) * 2 / n - 1
    x, y = np.meshgrid(at, at)
    inside = x**2 + y**2 < 1
    above = (wi[2] >= 0) == (side == "reflection")
    z = np.sqrt(1 - x[inside] ** 2 - y[inside] ** 2) * (1 if above else -1)
    image = np.full((n, n), np.nan)
    image[inside] = instance.eval(wi, np.stack([x[inside], y[inside], z], -1), nm)
    if not with_cosine:
        image[inside] /= np.maximum(np.abs(z), 1e-6)
    colors = matplotlib().colors
    peak = float(np.nanmax(image)) if np.any(image[inside] > 0) else 1.0
    norm = colors.LogNorm(peak * 10**-span, peak, clip=True) if logarithmic else colors.Normalize(0, peak)
    artist = ax.imshow(image, origin="lower", extent=(-1, 1, -1, 1), norm=norm, cmap=cmap, interpolation="nearest")
    turn = np.linspace(0, 2 * math.pi, 361)
    for circle in (30, 60, 90):
        r = math.sin(math.radians(circle))
        ax.plot(r * np.cos(turn), r * np.sin(turn), color="0.35" if circle == 90 else "0.7", lw=1.2 if circle == 90
                else 0.6,
                alpha=1 if circle == 90 else 0.7)
        if circle < 90:
            ax.annotate(f"{circle}°", (r * math.cos(0.9), r * math.sin(0.9)), color="0.85", fontsize="x-small",
                        ha="center", va="center")
    ax.plot([-wi[0]], [-wi[1]], marker="x", ms=7, mew=1.4, color="#35c8ff", ls="none")
    ax.set_aspect("equal")
    ax.set(xlim=(-1.03, 1.03), ylim=(-1.03, 1.03), xticks=[-1, 0, 1], yticks=[-1, 0, 1], xlabel=r"$\omega_x$",
           ylabel=r"$\omega_y$")
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.set_title(f"{side} of light at {degrees:g}°, {nm:g} nm", fontsize="medium")
    bar = ax.figure.colorbar(artist, ax=ax, shrink=0.85, extend="min" if logarithmic else "neither")
    bar.set_label((r"$f\,|\cos\theta_o|$" if with_cosine else "$f$") + " [1/sr]")
    return ax


def spectrum(wavelength: npt.ArrayLike, values: npt.ArrayLike, *, label: Optional[str] = None, fill: bool = True,
             unit: str = "", ax: "Optional[Axes]" = None) -> "Axes":
    """A spectrum over the colours of its wavelengths.

    Parameters
    ----------
    wavelength : array_like, shape (n,)
        Increasing, in nm.
    values : array_like, shape (n,)
    label : str, optional
        For the legend.
    fill : bool
        Colours under the curve; otherwise, as where several curves share axes, in a strip along the bottom.
    unit : str
        Of the values, for the label of the y axis.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes
    """
    nm, y, _ = curve("wavelength", wavelength, "values", values)
    if nm.size < 2 or np.any(np.diff(nm) <= 0) or nm[0] <= 0:
        raise Error("wavelength: expected two or more increasing numbers in nm")
    filled = flag("fill", fill)
    ax = axes_for(ax)
    ends_before = ax.get_xlim() if ax.lines else (nm[0], nm[-1])
    ax.plot(nm, y, color="0.15" if filled else None, lw=1.3, label=label)
    shown = np.arange(max(nm[0], 380.0), min(nm[-1], 780.0) + 0.5)
    if shown.size > 1:
        colours = colour_of(shown)[None, :, :]
        extent = (shown[0], shown[-1])
        if filled:
            low, high = min(0.0, float(y.min())), max(0.0, float(y.max()))
            image = ax.imshow(colours, extent=(*extent, low, high if high > low else low + 1), aspect="auto",
                              zorder=0.5, interpolation="bilinear")
            points = np.concatenate([[[nm[0], 0.0]], np.stack([nm, y], -1), [[nm[-1], 0.0]]])
            image.set_clip_path(matplotlib().patches.Polygon(points, transform=ax.transData))
        elif not any(child.get_gid() == "visible" for child in ax.child_axes):
            strip = ax.inset_axes((0, 0, 1, 0.035), sharex=ax, zorder=0.5)
            strip.set_gid("visible")
            strip.imshow(colours, extent=(*extent, 0, 1), aspect="auto", interpolation="bilinear")
            strip.axis("off")
    ax.set_xlim(min(nm[0], ends_before[0]), max(nm[-1], ends_before[1]))
    every = np.concatenate([np.asarray(one.get_ydata(), np.float64) for one in ax.lines])
    low, high = min(0.0, float(every.min())), float(every.max())
    ax.set_ylim(low * 1.05, high * 1.05 if high > 0 else low * -0.05 + 1e-30 if low < 0 else 1)
    ax.set_xlabel("wavelength [nm]")
    if text("unit", unit):
        ax.set_ylabel(f"[{unit}]")
    ax.grid(alpha=0.25)
    if label is not None:
        ax.legend(frameon=False)
    return ax


def corona(bsdf: Any = None, *, radius: Any = None, area_fraction: Optional[float] = None,
           correlation: Optional[str] = None, scatterer: Optional[str] = None, lamp: Any = "D65",
           lamp_diameter: float = 0.5, field: Optional[float] = None, exposure: float = 0, resolution: int = 301,
           wavelengths: npt.ArrayLike = _VISIBLE, ax: "Optional[Axes]" = None) -> "Axes":
    """The corona of a light behind a layer of scatterers, in true colours.

    The lamp is far away and the layer square to the line of sight. Directions are those of the picture; light that
    passes the layer without being diffracted, the lamp itself, is not shown.

    Parameters
    ----------
    bsdf : aureole.Bsdf, optional
        The layer, such as ``correlated_scatterers``, or an object with ``eval``, ``sample`` and ``pdf``; without it
        the next four parameters describe the layer.
    radius : str or float
        Radius of the scatterers: with its unit ("5um"), or in m.
    area_fraction : float
        Part of the plane that they cover.
    correlation : str, optional
        Correlation of their positions: "percus_yevick" (default) or "poisson".
    scatterer : str, optional
        "apertures" (default) or "discs".
    lamp : str, float or (array_like, array_like)
        An illuminant of the CIE, one wavelength in nm, or wavelengths in nm with relative powers.
    lamp_diameter : float
        In degrees; 0 for a point. The sun's and the moon's is 0.5.
    field : float, optional
        Half the width of the picture in degrees; by default it shows three rings where the radius is known.
    exposure : float
        In stops, relative to a picture whose rings are well exposed.
    resolution : int
        Pixels in each direction.
    wavelengths : array_like
        Wavelengths at which the layer is computed, increasing in nm.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes
        Axes are angles from the lamp in degrees.

    Examples
    --------
    >>> ax = aureole.plot.corona(radius="8um", area_fraction=0.5)  # doctest: +SKIP
    """
    instance, metres = _corona.layer(bsdf, radius, area_fraction, correlation, scatterer)
    half = _corona.field_of(metres) if field is None else scalar("field", field, minimum=1e-6, maximum=89,
                                                                 unit="degrees")
    diameter = scalar("lamp_diameter", lamp_diameter, minimum=0, maximum=10, unit="degrees")
    stops = scalar("exposure", exposure, minimum=-60, maximum=60)
    n = integer("resolution", resolution, minimum=8, maximum=4096)
    nm = _increasing(wavelengths)
    ax = axes_for(ax)
    linear = _corona.picture(instance, lamp, diameter, half, n, nm)
    at = (np.arange(n) - 0.5 * (n - 1)) * 2 * half / n
    # White is six times the mean luminance of the outer three quarters, where the rings are.
    rings = np.hypot(at[:, None], at) > 0.25 * half
    luminance = linear @ np.array([0.2126, 0.7152, 0.0722])
    white = 6 * float(luminance[rings].mean())
    scaled = linear * (2**stops / white if white > 0 else 0)
    ax.imshow(_corona.display(scaled), extent=(-half, half, -half, half), interpolation="bilinear")
    ax.set(xlabel="angle from the lamp [degrees]", ylabel="[degrees]")
    ax.set_aspect("equal")
    return ax


def corona_profile(bsdf: Any = None, *, radius: Any = None, area_fraction: Optional[float] = None,
                   correlation: Optional[str] = None, scatterer: Optional[str] = None,
                   wavelength: npt.ArrayLike = (450, 550, 650), field: Optional[float] = None, azimuth: float = 0,
                   log: bool = True, samples: int = 2000, ax: "Optional[Axes]" = None) -> "Axes":
    """Radiance of a corona over the angle from the lamp, for single wavelengths.

    Parameters
    ----------
    bsdf, radius, area_fraction, correlation, scatterer, field
        As in `corona`.
    wavelength : float or array_like of shape (n,)
        In nm; each has a curve in its colour.
    azimuth : float
        Direction from the lamp, in degrees counter-clockwise from the right; for layers without circular symmetry.
    log : bool
        Logarithmic radiance.
    samples : int
        Points of a curve.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes
        Radiance in 1/sr, where the lamp is a point that gives unit irradiance behind the layer.
    """
    instance, metres = _corona.layer(bsdf, radius, area_fraction, correlation, scatterer)
    half = _corona.field_of(metres) if field is None else scalar("field", field, minimum=1e-6, maximum=89,
                                                                 unit="degrees")
    nm = wavelengths_of("wavelength", wavelength)
    turn = math.radians(scalar("azimuth", azimuth))
    count = integer("samples", samples, minimum=2, maximum=10_000_000)
    logarithmic = flag("log", log)
    ax = axes_for(ax)
    angles = np.linspace(0, half, count)
    values = _corona.radiance(instance, angles * math.cos(turn), angles * math.sin(turn), nm)
    for k, wave in enumerate(nm):
        ax.plot(angles, values[:, k], color=colour_of(wave), lw=1.5, label=f"{wave:g} nm")
    ax.set(xlim=(0, half), xlabel="angle from the lamp [degrees]", ylabel="radiance / irradiance [1/sr]",
           yscale="log" if logarithmic else "linear")
    if logarithmic and np.any(values > 0):
        peak = float(values.max())
        ax.set_ylim(max(float(values[values > 0].min()), peak * 1e-6) * 0.7, peak * 1.5)
    ax.grid(alpha=0.3)
    ax.legend(frameon=False)
    return ax


def pair_correlation(r: npt.ArrayLike, g: npt.ArrayLike, error: Optional[npt.ArrayLike] = None, *,
                     label: Optional[str] = None, unit: str = "", color: Any = None,
                     ax: "Optional[Axes]" = None) -> "Axes":
    """The pair correlation function g(r) with its error band.

    Parameters
    ----------
    r, g : array_like, shape (n,)
        Distances of pairs, and their density relative to independent positions.
    error : float or array_like of shape (n,), optional
        Standard error of g; the band is one of them to either side.
    label : str, optional
        For the legend.
    unit : str
        Of `r`, for the label of the axis.
    color : optional
        As matplotlib has it.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes
    """
    return _with_band("r", r, "g", g, error, f"distance r [{unit}]" if text("unit", unit) else "distance r", "g(r)", label, color, ax)


def structure_factor(q: npt.ArrayLike, s: npt.ArrayLike, error: Optional[npt.ArrayLike] = None, *,
                     label: Optional[str] = None, unit: str = "", color: Any = None,
                     ax: "Optional[Axes]" = None) -> "Axes":
    """The structure factor S(q) with its error band.

    Parameters
    ----------
    q, s : array_like, shape (n,)
        Wave numbers and values.
    error : float or array_like of shape (n,), optional
        Standard error of s; the band is one of them to either side.
    label, color, ax
        As in `pair_correlation`.
    unit : str
        Of `q`, for the label of the axis.

    Returns
    -------
    matplotlib Axes
    """
    return _with_band("q", q, "s", s, error, f"wave number q [{unit}]" if text("unit", unit) else "wave number q", "S(q)", label,
                      color, ax)


def _with_band(x_name: str, x: Any, y_name: str, y: Any, error: Any, x_label: str, y_label: str, label: Optional[str],
               color: Any, ax: "Optional[Axes]") -> "Axes":
    xs, ys, errors = curve(x_name, x, y_name, y, error)
    ax = axes_for(ax)
    first = not ax.lines
    line, = ax.plot(xs, ys, lw=1.4, label=label, color=color)
    if errors is not None:
        ax.fill_between(xs, ys - errors, ys + errors, color=line.get_color(), alpha=0.25, lw=0,
                        zorder=line.get_zorder() - 0.1)
    if first:
        ax.axhline(1, color="0.5", lw=0.8, ls="--", zorder=1)
        ax.grid(alpha=0.25)
    ax.set(xlabel=x_label, ylabel=y_label)
    ax.set_xlim(left=min(0.0, float(xs.min())))
    ax.set_ylim(bottom=min(0.0, float(ys.min())))
    if label is not None:
        ax.legend(frameon=False)
    return ax


def _increasing(wavelengths: Any) -> npt.NDArray[np.float64]:
    nm = wavelengths_of("wavelengths", wavelengths)
    if nm.size < 2 or np.any(np.diff(nm) <= 0) or nm[-1] <= 360 or nm[0] >= 830:
        raise Error("wavelengths: expected two or more increasing numbers in nm with a part in the visible, 360-830 nm")
    return nm
