# SPDX-License-Identifier: Apache-2.0
"""`check`: tests whether a BSDF is correct, with numbers, a readable report, and plots of the results."""
from __future__ import annotations

import html
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import flag, integer, real, scalar, shown, text
from ._errors import Error
from ._vectorised import choice
from ._plot_support import as_bsdf, p_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = npt.NDArray[np.float64]

# The tests in the order of the report: kind, statement, name of the worst figure.
_KINDS: Tuple[Tuple[str, str, str], ...] = (
    ("finite", "valid numbers everywhere, at grazing and at the ends of random numbers, too", "invalid"),
    ("sample", "sample returns unit directions and the numbers of eval and pdf", "deviation"),
    ("chi_square", "samples follow the density (chi-square)", "p"),
    ("density_integral", "densities, masses of delta lobes and failures add up to one", "difference"),
    ("delta_lobes", "delta lobes occur as often as their mass says", "p"),
    ("energy", "no energy is gained (furnace)", "energy"),
    ("sample_energy", "samples carry the energy that eval has", "p"),
    ("reciprocity", "f / n^2 is the same with the directions exchanged", "deviation"),
    ("modes", "light and importance are transported alike", "deviation"),
    ("wavelengths", "wavelengths agree about each other, whichever leads", "deviation"),
    ("black", "black from below", "samples"),
)
_ENERGY_ANGLES = (0.0, 10.0, 30.0, 40.0, 50.0, 70.0, 80.0)


@dataclass(frozen=True)
class CheckRecord:
    """Result of one test, for one direction and wavelength where it depends on them.

    Attributes
    ----------
    kind : str
        ``"finite"``, ``"sample"``, ``"chi_square"``, ``"density_integral"``, ``"delta_lobes"``, ``"energy"``,
        ``"sample_energy"``, ``"reciprocity"``, ``"modes"``, ``"wavelengths"`` or ``"black"``.
    passed : bool
    figure, expected : float
        The measured and the expected number: chi-square and degrees of freedom, frequency and mass of a delta lobe,
        integral of the density, energy and its bound; else the largest relative deviation, or the number of invalid
        values, and 0.
    p_value : float or None
        Probability of such a figure for a correct BSDF; None where the test is not statistical.
    limit : float
        The least p-value that passes, or else the largest difference between `figure` and `expected`.
    direction : tuple of 3 floats or None
        Direction of incidence wi; None for a test over many directions.
    wavelength : float or None
        In nm; None for a test over all wavelengths.
    message : str
        A sentence about the failure, if the test failed.
    """

    kind: str
    passed: bool
    figure: float
    expected: float
    p_value: Optional[float]
    limit: float
    direction: Optional[Tuple[float, float, float]]
    wavelength: Optional[float]
    message: str

    @property
    def severity(self) -> float:
        """How near the record is to failing: above 1 where it failed."""
        if self.p_value is not None:
            # The severity counts decades, so that 0.02 and 1e-300 can be told apart.
            return float(np.log(max(self.p_value, 1e-300)) / np.log(self.limit))
        if np.isnan(self.figure):
            return float("inf")
        difference = self.figure - self.expected
        difference = max(difference, 0.0) if self.kind == "energy" and self.passed else abs(difference)
        return difference / self.limit if self.limit > 0 else (0.0 if self.passed else float("inf"))


@dataclass(frozen=True, eq=False)
class Histogram:
    """Samples counted in bins over the sphere, beside the expected numbers by the pdf.

    Attributes
    ----------
    direction : tuple of 3 floats
        The given direction wi.
    wavelength : float
        Wavelength of the density in nm.
    samples : int
        Number of samples.
    centers : numpy.ndarray (n, 3)
        Directions of the bins, which are smaller where the density is larger.
    sizes : numpy.ndarray (n,)
        Approximate sizes of the bins in rad.
    expected, found : numpy.ndarray (n,)
        Numbers of samples.
    chi_square, p_value : float
        Result of the test over `pools` groups of neighbouring bins.
    """

    direction: Tuple[float, float, float]
    wavelength: float
    samples: int
    centers: Array
    sizes: Array
    expected: Array
    found: Array
    chi_square: float
    p_value: float
    pools: int


@dataclass(frozen=True, repr=False, eq=False)
class CheckReport:
    """Result of `check`.

    Attributes
    ----------
    name : str
        Name of the object that was checked.
    checks : list of CheckRecord
        All tests.
    angles : numpy.ndarray (n,)
        Angles of incidence in degrees from the normal, above 90 from below, ascending, of `albedo`.
    wavelengths : numpy.ndarray (m,)
        In nm, of `albedo`.
    albedo : numpy.ndarray (n, m)
        Fraction of the light that is reflected or transmitted.
    bound : float
        What `albedo` may be at most, and by how much it may be missed: `tolerance`.
    histograms : list of Histogram
        Of the chi-square tests.
    pairs : dict
        ``wi``, ``wo`` (n, 3), ``forward``, ``backward`` (n,): f / n^2 of random pairs of directions both ways at
        ``wavelength`` nm. Empty arrays where reciprocity was not tested.
    """

    name: str
    checks: List[CheckRecord]
    angles: Array
    wavelengths: Array
    albedo: Array
    bound: float
    tolerance: float
    histograms: List[Histogram]
    pairs: Dict[str, Any]
    samples: int
    significance: float
    statistical_tests: int
    notes: List[str] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        """True where every test passed."""
        return all(c.passed for c in self.checks)

    @property
    def problems(self) -> List[str]:
        """A sentence for each test that did not pass."""
        return [c.message for c in self.checks if not c.passed]

    def raise_if_failed(self) -> "CheckReport":
        """Returns the report itself, or raises an `AssertionError` with the problems, for your own tests."""
        if not self.passed:
            raise AssertionError(str(self))
        return self

    def failed(self) -> List[str]:
        """The kinds of tests that did not pass, in the order of the report."""
        return [kind for kind, *_ in _KINDS if any(c.kind == kind and not c.passed for c in self.checks)]

    def worst(self, kind: str) -> Optional[CheckRecord]:
        """Returns the record of `kind` that is nearest to failing or failed most; None where no test of that kind was made."""
        text("kind", kind)
        records = [c for c in self.checks if c.kind == kind]
        return max(records, key=lambda c: (not c.passed, c.severity)) if records else None

    def _rows(self) -> List[Tuple[str, str, str, str, str]]:
        rows = []
        for kind, meaning, unit in _KINDS:
            worst = self.worst(kind)
            if worst is None:
                continue
            records = [c for c in self.checks if c.kind == kind]
            wrong = sum(not c.passed for c in records)
            if unit == "p":
                figure = f"p {p_text(worst.p_value)} (least {worst.limit:.1g})"
            elif unit == "energy":
                gain = worst.passed or worst.figure > worst.expected
                figure = f"{worst.figure:.5g} ({'bound' if gain else 'lossless:'} {worst.expected:g})"
            elif unit in ("invalid", "samples"):
                figure = f"{sum(c.figure for c in records):.0f} {unit}" if unit == "invalid" else ""
            elif unit == "difference":
                figure = f"{worst.figure:.5f} for {worst.expected:.5f}"
            else:
                figure = f"{worst.figure:.1e} (most {worst.limit:.0e})"
            place = ""
            if worst.direction is not None and worst.severity > 0:
                place = f"{np.degrees(np.arccos(np.clip(worst.direction[2], -1, 1))):.0f} deg"
            if worst.wavelength is not None and worst.severity > 0:
                place += f"{', ' if place else ''}{worst.wavelength:.0f} nm"
            verdict = "ok" if not wrong else f"FAILED {wrong} of {len(records)}"
            rows.append((kind, verdict, figure, place, meaning))
        return rows

    def _headline(self) -> str:
        return f"{self.name}: " + ("passed" if self.passed else f"FAILED ({', '.join(self.failed())})")

    def _footer(self) -> str:
        return (f"{len(self.checks)} tests, {self.statistical_tests} of them statistical "
                f"({self.significance:g} false alarms per report); "
                f"{self.samples:,} samples per direction and wavelength")

    def __str__(self) -> str:
        rows = [("check", "verdict", "worst figure", "at", "what it says"), *self._rows()]
        widths = [max(len(r[k]) for r in rows) for k in range(4)]
        lines = [self._headline(), ""]
        for i, row in enumerate(rows):
            lines.append("  ".join([cell.ljust(w) for cell, w in zip(row, widths)] + [row[4]]).rstrip())
            if i == 0:
                lines.append("-" * len(lines[-1]))
        if not self.passed:
            lines += ["", "problems:"] + [f"  {p}" for p in self.problems[:12]]
            if len(self.problems) > 12:
                lines.append(f"  ... and {len(self.problems) - 12} more (`report.problems`)")
        lines += [""] + [f"note: {n}" for n in self.notes] + [self._footer()]
        return "\n".join(lines)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        colour = {True: "#1a7f37", False: "#b3261e"}
        cells = "".join(
            "<tr>" + f"<td style='text-align:left'><code>{kind}</code></td>"
            + f"<td style='text-align:left;color:{colour[verdict == 'ok']};font-weight:bold'>{verdict}</td>"
            + "".join(f"<td style='text-align:left'>{html.escape(c)}</td>" for c in rest) + "</tr>"
            for kind, verdict, *rest in self._rows())
        text = (f"<div><p><b style='color:{colour[self.passed]}'>{html.escape(self._headline())}</b></p>"
                "<table><thead><tr>"
                + "".join(f"<th style='text-align:left'>{h}</th>"
                          for h in ("check", "verdict", "worst figure", "at", "what it says"))
                + f"</tr></thead><tbody>{cells}</tbody></table>")
        if not self.passed:
            text += "<ul>" + "".join(f"<li>{html.escape(p)}</li>" for p in self.problems[:12]) + "</ul>"
        return text + "".join(f"<p><small>{html.escape(n)}</small></p>"
                              for n in [*self.notes, self._footer()]) + "</div>"

    def plot(self, axes: "Optional[Sequence[Axes]]" = None) -> "npt.NDArray[Any]":
        """Three plots: albedo over angle, samples against density for the worst direction, reciprocity.

        Parameters
        ----------
        axes : sequence of 3 matplotlib Axes, optional
            Where to draw; a new figure if not given.

        Returns
        -------
        numpy.ndarray of 3 matplotlib Axes
        """
        from . import plot

        return plot.check_report(self, axes)


def check(bsdf: Any, *, lossless: Optional[bool] = None, reciprocal: bool = True, samples: Optional[int] = None,
          significance: float = 0.01, wavelengths: Any = (360, 830), seed: int = 1,
          progress: Optional[Callable[[float], Any]] = None, two_sided: Optional[bool] = None, may_fail: bool = True,
          index_ratio: Optional[float] = None, largest_energy: float = 1, tolerance: float = 2e-3,
          mode: str = "importance") -> CheckReport:
    """Checks numerically that a BSDF is consistent.

    For directions of incidence at 20, 60 and 85 degrees above and below the surface: samples follow the density
    (chi-square), densities integrate to one, no energy is gained, samples carry the energy that `eval` has. For random
    pairs of directions: reciprocity, and that light and importance are transported alike. At grazing directions and at
    the ends of the random numbers: valid numbers.

    Parameters
    ----------
    bsdf : aureole.Bsdf, or an object with ``eval``, ``sample`` and ``pdf``
        A plug-in's instance, or an instance of a class written in Python.
    lossless : bool, optional
        True: losing light is an error, too.
    reciprocal : bool
        False: reciprocity is not tested, for models that are known to lack it.
    samples : int, optional
        For each direction and each of two wavelengths; at least 1000. Fewer are faster and find less. None: 300,000, or
        30,000 for a BSDF written in Python.
    significance : float
        Probability that a correct BSDF fails in one of the statistical tests; shared among them (Sidak).
    wavelengths : (float, float) or None
        Range in nm, within the range for which the BSDF was made; None: all of it.
    seed : int
        Seed of the random numbers; equal seeds give equal reports.
    progress : callable, optional
        Called with the completed fraction, in [0, 1].
    two_sided : bool, optional
        True: it must reflect or transmit light from below, too; False: it must be black from below; None: either.
    may_fail : bool
        `sample` may return nothing; the density must then integrate to the part that is sampled. False: that is an
        error.
    index_ratio : float, optional
        Index of refraction below the surface over the index above. f of the two directions differs by its square.
        None: it is taken from samples of the BSDF.
    largest_energy : float
        More than 1 where a model is known to reflect more light than it receives.
    tolerance : float
        Tolerance of energies and integrals of densities.
    mode : {"importance", "radiance"}
        Mode of transport in which samples and energies are tested.

    Returns
    -------
    CheckReport
        Print it, or look at its attributes; ``report.plot()`` draws, ``report.raise_if_failed()`` is for tests.

    Examples
    --------
    >>> report = aureole.check(aureole.load_dict({"type": "roughconductor", "alpha": 0.1}))  # doctest: +SKIP
    >>> print(report)  # doctest: +SKIP
    """
    instance = as_bsdf(bsdf)
    in_python = instance.type == "python"
    notes = []
    if samples is None:
        if in_python:
            notes.append("written in Python: 30,000 samples instead of 300,000 (`samples`)")
        samples = 30_000 if in_python else 300_000
    samples = integer("samples", samples, minimum=1000, maximum=1_000_000_000)
    significance = scalar("significance", significance, positive=True, maximum=0.5)
    tolerance = scalar("tolerance", tolerance, positive=True, maximum=1)
    largest_energy = scalar("largest_energy", largest_energy, minimum=1)
    seed = integer("seed", seed, minimum=0, maximum=2**64 - 1)
    if index_ratio is not None:
        index_ratio = scalar("index_ratio", index_ratio, positive=True)
    for name, value in (("lossless", lossless), ("two_sided", two_sided)):
        if value is not None and not isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{name}: expected True, False or None, got {type(value).__name__} {shown(value)}")
    for name, value in (("reciprocal", reciprocal), ("may_fail", may_fail)):
        flag(name, value)
    choice("mode", mode, "importance", "radiance")
    if progress is not None and not callable(progress):
        raise TypeError(f"progress: expected a function of one number, got {type(progress).__name__}")
    ends = np.zeros(2) if wavelengths is None else real("wavelengths", wavelengths, positive=True, unit="nm")
    if wavelengths is not None and (ends.shape != (2,) or not ends[0] < ends[1]):
        raise Error(f"wavelengths: expected two numbers in nm, the lower one first, got {wavelengths!r}")

    data = _aureole.check_bsdf(
        instance, lossless=bool(lossless), reciprocal=bool(reciprocal),
        black_below=None if two_sided is None else not two_sided, may_fail=bool(may_fail), radiance=mode == "radiance",
        samples=samples, significance=significance, tolerance=tolerance, largest_energy=largest_energy,
        min_nm=float(ends[0]), max_nm=float(ends[1]), index_ratio=index_ratio, angles=list(_ENERGY_ANGLES),
        most_bins=40_000 if in_python else 1_000_000, seed=seed, progress=progress)
    return _report(_name_of(bsdf), data, samples, significance, largest_energy, tolerance, notes)


def _name_of(bsdf: Any) -> str:
    if isinstance(bsdf, _aureole.Bsdf):
        return f"{bsdf.type} ({bsdf.id})" if bsdf.id else bsdf.type
    return type(bsdf).__name__


def _report(name: str, data: Dict[str, Any], samples: int, significance: float, bound: float, tolerance: float,
            notes: List[str]) -> CheckReport:
    checks = [
        CheckRecord(kind=f["kind"], passed=f["passed"], figure=f["figure"], expected=f["expected"],
                    p_value=f["p_value"] if f["p_value"] >= 0 else None, limit=f["limit"],
                    direction=f["direction"] if any(f["direction"]) else None, wavelength=f["wavelength"] or None,
                    message=f["message"])
        for f in data["findings"]
    ]
    angles, wavelengths, albedo = _albedo(data)
    notes = list(notes)
    if data["black_below"]:
        notes.append("black from below")
    if data["largest_failure"] > 0:
        notes.append(f"up to {data['largest_failure']:.3g} of the samples have no direction (which the densities know)")
    return CheckReport(
        name=name, checks=checks, angles=angles, wavelengths=wavelengths, albedo=albedo, bound=bound,
        tolerance=tolerance,
        histograms=[Histogram(**h) for h in data["histograms"]],
        pairs={"wi": data["pair_wi"], "wo": data["pair_wo"], "forward": data["pair_forward"],
               "backward": data["pair_backward"],
               "wavelength": data["pair_wavelength"]},
        samples=samples, significance=significance, statistical_tests=data["statistical_tests"], notes=notes)


def _albedo(data: Dict[str, Any]) -> Tuple[Array, Array, Array]:
    """Returns angles and wavelengths, each once, and the energies sorted by both."""
    directions, nm, energies = data["energy_directions"], data["energy_wavelengths"], data["energies"]
    if not len(directions):
        return np.empty(0), np.empty(0), np.empty((0, 0))
    columns = np.argsort(nm, axis=1)
    nm, energies = np.take_along_axis(nm, columns, 1), np.take_along_axis(energies, columns, 1)
    angles = np.degrees(np.arccos(np.clip(directions[:, 2], -1, 1))).round(3)
    angles, rows = np.unique(angles, return_index=True)
    return angles, nm[0], energies[rows]
