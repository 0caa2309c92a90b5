# SPDX-License-Identifier: Apache-2.0
"""K and S of paints from files of measured samples. For pigment.py."""
from __future__ import annotations

import contextlib
import csv
import os
import tempfile
import warnings
from dataclasses import dataclass
from typing import Dict, Iterator, List, NamedTuple, Sequence, Tuple, Union

import numpy as np

from . import _aureole
from ._arrays import scalar
from ._errors import Error
from ._paint_colours import ciede2000, lab
from ._paint_layers import Reals, Surface
from ._paint_palettes import Palette
from ._vectorised import choice


@contextlib.contextmanager
def _table(file: Union[str, "os.PathLike[str]"]) -> Iterator[str]:
    """Yields the name of the file; for a spreadsheet the name of a temporary text file with its first sheet."""
    name = os.fspath(file)
    if os.path.splitext(name)[1].lower() not in (".xlsx", ".xlsm", ".xls", ".xlsb", ".ods"):
        yield name
        return
    try:
        import python_calamine  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError as error:
        raise Error(f"{name}: spreadsheets need the package python-calamine; or save the sheet as text (.csv)") from error
    rows = python_calamine.CalamineWorkbook.from_path(name).get_sheet_by_index(0).to_python()
    with tempfile.TemporaryDirectory() as folder:
        text = os.path.join(folder, "sheet.csv")
        with open(text, "w", newline="", encoding="utf-8") as out:
            csv.writer(out).writerows(
                [int(cell) if isinstance(cell, float) and cell.is_integer() else cell for cell in row] for row in rows)
        try:
            yield text
        except Error as error:
            raise Error(str(error).replace(text, name)) from None


Files = Union[str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]]]


def _names(files: Files) -> List[str]:
    one = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not one:
        raise Error("file: expected at least one file")
    return [os.fspath(name) for name in one]


def _note(file: Union[str, "os.PathLike[str]"], notes: Sequence[str]) -> None:
    for note in notes:
        warnings.warn(f"{os.fspath(file)}: {note}", stacklevel=3)


def fit(file: Files, *, white: str = "white", surface: Union[Surface, None] = None) -> Palette:
    """K and S of the paints of a table of measured samples, .csv, CGATS.17, .cxf, .json or a spreadsheet (docs/pigments.md).

    Parameters
    ----------
    file : str or path, or a sequence of them
        "kimera": 13 measured acrylics, by miciwan, CC BY 4.0. Several files make one table. Spreadsheets
        need the package python-calamine. Assumptions about the file, such as per cent without a unit, are warnings.
    white : str
        The paint that tints are made with.
    surface : Surface, optional
        Interface through which the paints were measured. By default it follows from the geometry that the file
        states (CxF, CGATS), with an index of 1.5; without a stated geometry there is none.
    """
    names = _names(file)
    if surface is None and names == ["kimera"]:
        surface = Surface(*_aureole.pigment_kimera_surface())
    with contextlib.ExitStack() as stack:
        tables = [stack.enter_context(_table(name)) for name in names]
        parts, notes = _aureole.pigment_fit(tables, white, None if surface is None else (surface.seen, surface.through, surface.k2))
    _note(", ".join(names), notes)
    return Palette._of(parts)


@dataclass(frozen=True)
class Specimen:
    """How a layer of paint agrees with a joint fit.

    Attributes
    ----------
    name : str
    rms : float
        Rms of fitted minus measured reflectance; from 0.005 on the specimen is an outlier.
    weight : float
        Weight in the fit; below 1: down-weighted.
    thickness, thickness_error : float
        Fitted over stated, or over the common thickness.
    amounts : dict
        Fitted over stated amount of each paint of a mixture, and its standard error.
    """

    name: str
    rms: float
    weight: float
    thickness: float
    thickness_error: float
    amounts: Dict[str, Tuple[float, float]]


@dataclass(frozen=True)
class HeldOut:
    """A specimen that was kept back: measured and predicted reflectance (samples, wavelengths), standard deviation, CIEDE2000 (D65)."""

    specimen: str
    samples: Tuple[str, ...]
    measured: Reals
    predicted: Reals
    error: Reals
    difference: float


class TheoryFit(NamedTuple):
    """The fit of a table by one theory.

    Attributes
    ----------
    name : str
        "two fluxes" or "streams".
    cost : float
        The weighted sum of squares.
    median_rms, largest_rms : float
        Of the specimens' fitted minus measured reflectances.
    difference, coverage : float
        Mean CIEDE2000 (D65) of specimens that were kept back, and the fraction of their reflectances within the 90 % intervals
        of their predictions; NaN without such specimens.
    is_kept : bool
        Whether the palette is this theory's.
    """

    name: str
    cost: float
    median_rms: float
    largest_rms: float
    difference: float
    coverage: float
    is_kept: bool


class Residuals(NamedTuple):
    """How residuals compare with the stated noise, by which errors of K and S are stated.

    Attributes
    ----------
    relative : float
        Their rms over the degrees of freedom, in units of the stated noise; 0 where there are too few of them.
    degrees_of_freedom, values : float
        Measured values less what the unknowns take up, and their number.
    k_error, s_error, ratio_error : numpy.ndarray
        Standard errors of ln K, ln S and ln(K/S) (paints, wavelengths) by the residuals: right where the theory is exact, while
        those of the palette have the error of the theory in them. Empty where there are too few degrees of freedom.
    """

    relative: float
    degrees_of_freedom: float
    values: float
    k_error: Reals
    s_error: Reals
    ratio_error: Reals


class JointFit(NamedTuple):
    """A fit of all measurements of a table.

    Attributes
    ----------
    palette : Palette
    ratio_error : array
        Standard deviations of ln(K/S) (paints, wavelengths).
    specimens, held_out : list
        Specimens of the fit, and those that were kept back and predicted.
    g, g_error : array
        Mean cosine of scattering in each paint and its standard error, in fits by streams with `g_error`; else empty.
    theories : list
        The theories that were fitted.
    residuals : Residuals
    """

    palette: Palette
    ratio_error: Reals
    specimens: List[Specimen]
    held_out: List[HeldOut]
    g: Reals
    g_error: Reals
    theories: List[TheoryFit]
    residuals: Residuals


def joint_fit(file: Files, *, theory: str = "best", surface: Union[Surface, None] = None, index: float = 1.5,
              g: float = 0.8, g_error: float = 0, geometry: Union[str, None] = None, specular: Union[str, None] = None,
              noise: float = 0.01, relative_noise: float = 0.05, thickness_error: float = 0.15, amount_error: float = 0.1,
              hold_out: Union[str, int, Sequence[str], None] = None) -> JointFit:
    """K and S of all paints of a table from all measurements at once, as `aureole pigment fit --joint` (docs/pigments.md).

    Parameters
    ----------
    file : str or path, or a sequence of them
        As for `fit`; films over cards need no thickness.
    theory : str
        "two-flux", "streams" with the mean cosine `g`, or "best": both are fitted, and the result is that of the theory which
        predicts specimens of `hold_out` better, without them that of two fluxes. Both in a binder of `index`, seen by an
        instrument of `geometry` ("d8", "diffuse", "45_0") with its gloss `specular` ("included" or "excluded"); two fluxes also
        through any `surface`, beside which streams are those of d8 and `index`. K and S of streams are 2 sigma_a and
        3/4 sigma_s (1 - g). Where neither `geometry` nor `surface` is given, the geometry that the file states (CxF, CGATS) is
        taken, and without one no interface is taken off; a warning says so.
    g_error : float
        Relative error of 1 - g of each paint, which is then an unknown; with 0 `g` holds for all paints.
    noise, relative_noise : float
        Error of a reflectance R, the theory's own error included: `noise` and `relative_noise` times R, added in squares.
        Repeats of a specimen over one card add their own standard deviation.
    thickness_error, amount_error : float
        Relative errors of a film's thickness that is not stated, and of the amounts in mixtures.
    hold_out : str, int or sequence of str, optional
        Specimens to keep back together; a number of groups that are kept back in turn; or "each": every mixture.
    """
    choice("theory", theory, "best", "two-flux", "streams")
    if surface is not None and theory == "streams":
        raise Error('surface: is for the theory "two-flux"; "streams" takes index, geometry and specular')
    if surface is not None and not (geometry is None and specular is None):
        raise Error("surface: stands for an interface by itself; leave out geometry and specular")
    if g_error and theory == "two-flux":
        raise Error('g_error: is for the theory "streams"; two fluxes have no directions')
    if geometry is not None:
        choice("geometry", geometry, "diffuse", "d8", "45_0")
    if specular is not None:
        choice("specular", specular, "included", "excluded")
    words = [] if hold_out is None else [str(hold_out)] if isinstance(hold_out, (str, int)) else list(hold_out)
    files = _names(file)
    with contextlib.ExitStack() as stack:
        tables = [stack.enter_context(_table(name)) for name in files]
        parts, ratios, cosines, specimens, held, notes, theories, residuals = _aureole.pigment_joint_fit(
            tables, None if surface is None else (surface.seen, surface.through, surface.k2), theory, scalar("index", index, minimum=1, maximum=4),
            scalar("g", g, minimum=-0.95, maximum=0.95), scalar("g_error", g_error, minimum=0, maximum=3), geometry or "", specular or "",
            scalar("noise", noise, minimum=1e-5, maximum=0.2), scalar("relative_noise", relative_noise, minimum=0, maximum=1),
            scalar("thickness_error", thickness_error, minimum=0, maximum=3), scalar("amount_error", amount_error, minimum=0, maximum=3),
            words)
    _note(", ".join(files), notes)
    palette = Palette._of(parts)
    predictions = []
    for name, samples, measured, predicted, error, reason in held:
        if reason:
            raise Error(f"{', '.join(files)}: {name}: {reason}")
        seen, told = np.array(measured), np.array(predicted)
        difference = float(ciede2000(lab(palette.nm, seen), lab(palette.nm, np.maximum(told, 0))).mean())
        predictions.append(HeldOut(name, tuple(samples), seen, told, np.array(error), difference))
    return JointFit(palette, np.array(ratios),
                    [Specimen(one, rms, weight, thickness, spread, {paint: (factor, error) for paint, factor, error in amounts})
                     for one, rms, weight, thickness, spread, amounts in specimens], predictions,
                    np.array([one for one, _ in cosines]), np.array([error for _, error in cosines]),
                    [TheoryFit(*one) for one in theories], Residuals(*residuals[:3], *(np.array(rows) for rows in residuals[3:])))
