# SPDX-License-Identifier: Apache-2.0
"""The plots of a report of `aureole.check`."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from ._errors import Error
from ._plot_support import axes_for, colour_of, matplotlib, p_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._check import CheckReport, Histogram

_GOOD, _BAD = "#4a6fa5", "#c62828"
Array = npt.NDArray[np.float64]


def check_report(report: "CheckReport", axes: "Optional[Sequence[Axes]]" = None) -> "npt.NDArray[Any]":
    """Three plots of what `aureole.check` found: albedo, samples against density, reciprocity.

    Parameters
    ----------
    report : CheckReport
    axes : sequence of 3 matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    numpy.ndarray of 3 matplotlib Axes
    """
    from ._check import CheckReport

    if not isinstance(report, CheckReport):
        raise TypeError(f"report: expected a CheckReport (from aureole.check), got {type(report).__name__}")
    mpl = matplotlib()
    if axes is None:
        figure, made = mpl.pyplot.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
        figure.suptitle(report._headline(), color="black" if report.passed else _BAD)
        targets = list(made)
    else:
        targets = [axes_for(a) for a in np.ravel(np.asarray(axes, object))]
        if len(targets) != 3:
            raise Error(f"axes: expected three, got {len(targets)}")
    _albedo(report, targets[0])
    _samples(report, targets[1])
    _reciprocity(report, targets[2])
    result = np.empty(3, object)
    result[:] = targets
    return result


def _albedo(report: "CheckReport", ax: "Axes") -> None:
    below = bool(np.any(report.albedo[report.angles > 90] > 0)) if report.albedo.size else False
    shown = report.angles <= (180 if below else 90)
    for k, nm in enumerate(report.wavelengths):
        ax.plot(report.angles[shown], report.albedo[shown, k], ".-", ms=4, lw=1.1, color=colour_of(nm),
                label=f"{nm:.0f} nm")
    ax.axhline(report.bound, color=_BAD, lw=1, ls="--")
    ax.axhspan(report.bound + report.tolerance, 1e30, color=_BAD, alpha=0.08, lw=0)
    top = float(np.nanmax(report.albedo[shown])) if report.albedo.size else 0.0
    ax.set(xlim=(0, 180 if below else 90), ylim=(0, 1.12 * max(top, report.bound)),
           xlabel="angle of incidence [degrees]",
           ylabel="albedo", title="energy (furnace)")
    if below:
        ax.axvline(90, color="0.6", lw=0.8)
    ax.set_xticks(range(0, 181, 30) if below else range(0, 91, 15))
    ax.grid(alpha=0.25)
    ax.legend(fontsize="x-small", frameon=False, ncol=2, loc="lower left")


def pools(histogram: "Histogram") -> Tuple[Array, Array]:
    """Expected and found numbers of samples in the groups of bins over which chi-square is summed."""
    least = max(5.0, histogram.samples / 2000)
    expected, found = [0.0], [0.0]
    for e, f in zip(histogram.expected, histogram.found):
        if expected[-1] >= least:
            expected.append(0.0)
            found.append(0.0)
        expected[-1] += e
        found[-1] += f
    if len(expected) > 1 and expected[-1] < least:
        e, f = expected.pop(), found.pop()
        expected[-1] += e
        found[-1] += f
    return np.array(expected), np.array(found)


def _samples(report: "CheckReport", ax: "Axes") -> None:
    ax.set(title="samples against density")
    if not report.histograms:
        _say(ax, "no samples of a density")
        return
    worst = min(report.histograms, key=lambda h: h.p_value)
    expected, found = pools(worst)
    z = (found - expected) / np.sqrt(np.maximum(expected, 1e-3))
    wrong = np.abs(z) > 4
    # The place of a pool says less than how far off it is.
    low, high = max(expected.min(), 1.0) * 0.7, max(expected.max(), found.max(), 2.0) * 1.3
    line = np.geomspace(low, high, 200)
    ax.fill_between(line, np.maximum(line - 3 * np.sqrt(line), low * 0.1), line + 3 * np.sqrt(line), color="0.85", lw=0,
                    label="3 sigma")
    ax.plot(line, line, color="0.4", lw=0.8)
    ax.scatter(expected[~wrong], np.maximum(found[~wrong], low), s=9, color=_GOOD, lw=0, alpha=0.7,
               label=f"{expected.size} groups of bins")
    if wrong.any():
        ax.scatter(expected[wrong], np.maximum(found[wrong], low), s=12, color=_BAD, lw=0,
                   label=f"{int(wrong.sum())} beyond 4 sigma")
    degrees = np.degrees(np.arccos(np.clip(worst.direction[2], -1, 1)))
    ax.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high), xlabel="samples expected",
           ylabel="samples found",
           title=f"samples against density, worst of {len(report.histograms)}:\n"
                 f"{degrees:.0f}° incidence, {worst.wavelength:.0f} nm, p {p_text(worst.p_value)}")
    ticker = matplotlib().ticker
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))
        axis.set_minor_formatter(ticker.NullFormatter())
    ax.grid(alpha=0.25)
    ax.legend(fontsize="x-small", frameon=False, loc="upper left")


def _reciprocity(report: "CheckReport", ax: "Axes") -> None:
    ax.set(title="reciprocity")
    forward, backward = report.pairs["forward"], report.pairs["backward"]
    seen = (forward > 0) & (backward > 0)
    lost = (forward > 0) != (backward > 0)
    if not len(forward):
        _say(ax, "not tested")
        return
    if not seen.any() and not lost.any():
        _say(ax, "no light between the pairs")
        return
    a, b = forward[seen], backward[seen]
    wrong = np.abs(a - b) > 2e-3 * np.maximum(a, b) + 1e-6
    if seen.any():
        low, high = max(min(a.min(), b.min()), max(a.max(), b.max()) * 1e-8) * 0.6, max(a.max(), b.max()) * 1.7
    else:
        low, high = 1e-6, max(forward.max(), backward.max()) * 1.7
    ax.plot([low, high], [low, high], color="0.4", lw=0.8)
    ax.scatter(a[~wrong], b[~wrong], s=6, color=_GOOD, lw=0, alpha=0.5, label=f"{int((~wrong).sum())} pairs agree")
    bad = np.concatenate([a[wrong], np.maximum(forward[lost], low)]), np.concatenate([b[wrong],
                                                                                      np.maximum(backward[lost], low)])
    if len(bad[0]):
        ax.scatter(*bad, s=7, color=_BAD, lw=0, alpha=0.6, label=f"{len(bad[0])} do not")
    ax.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high),
           xlabel=r"$f(\omega_i, \omega_o)\,/\,n_i^2$ [1/sr]",
           ylabel=r"$f(\omega_o, \omega_i)\,/\,n_o^2$ [1/sr]",
           title=f"reciprocity, {report.pairs['wavelength']:.0f} nm")
    ax.grid(alpha=0.25)
    ax.legend(fontsize="x-small", framealpha=0.8, edgecolor="none", loc="upper left")


def _say(ax: "Axes", text: str) -> None:
    ax.text(0.5, 0.5, text, ha="center", va="center", transform=ax.transAxes, color="0.4")
    ax.set(xticks=[], yticks=[])
