# SPDX-License-Identifier: Apache-2.0
"""`color`, and, through colour-science, colour appearance (CAM16) and colour rendering (CRI, TM-30) of lamps."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, real, scalar, text
from ._errors import Error
from ._instrument_support import Words, axes_or_new, tell
from ._laboratory import MeasuredSpectrum, RadiometerReading
from ._results import Table

Reals = npt.NDArray[np.float64]
Triple = Tuple[float, float, float]


def colour_science() -> Any:
    """The package, without its own warning that plots are missing."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import colour
    except ImportError as e:
        raise ImportError("colour appearance and rendering need colour-science: pip install aureole[colour]") from e
    return colour


@dataclass(frozen=True, eq=False)
class ColorData:
    """One colour of `color`.

    Attributes
    ----------
    name : str
    xyz : (float, float, float)
        Y = 100 for a perfect diffuser.
    white : (float, float, float)
        Of the illuminant, Y = 100.
    xy, uv : (float, float)
        Chromaticities x, y and u', v'.
    lab, luv : (float, float, float)
        CIELAB and CIELUV.
    screen : str
        "#rrggbb", adapted to the screen's white.
    dominant_wavelength : float or None
        In nm, negative for the complementary wavelength of purples; None without hue.
    purity : float or None
        Excitation purity.
    whiteness, tint : float or None
        CIE whiteness under D65; None where the formulas do not hold.
    yellowness : float or None
        ASTM E313, under C and D65.
    difference : dict of str to float
        To the standard: "dL", "da", "db", "dC", "dH", "cie1976", "ciede2000", "cmc", "cie94", "din99o"; empty without one.
    metamerism : dict of str to float
        Special indices (Delta E*ab) by illuminant, where both have spectra.
    wavelength, values : numpy.ndarray
        The spectrum, where there is one: nm and reflectances.
    """

    name: str
    xyz: Triple
    white: Triple
    xy: Tuple[float, float]
    uv: Tuple[float, float]
    lab: Triple
    luv: Triple
    screen: str
    dominant_wavelength: Optional[float]
    purity: Optional[float]
    whiteness: Optional[float]
    tint: Optional[float]
    yellowness: Optional[float]
    difference: Dict[str, float]
    metamerism: Dict[str, float]
    wavelength: Reals = field(repr=False)
    values: Reals = field(repr=False)

    def cam16(
        self, *, adapting_luminance: float = 318.31 / 5, background: float = 20, surround: str = "average"
    ) -> "AppearanceData":
        """Appearance by CAM16 (Li and others 2017), with colour-science.

        Parameters
        ----------
        adapting_luminance : float
            Of the field, in cd/m^2.
        background : float
            Luminance factor in percent.
        surround : {"average", "dim", "dark"}

        Returns
        -------
        AppearanceData
        """
        return cam16(self.xyz, self.white, adapting_luminance=adapting_luminance, background=background, surround=surround)


class ColorTable(Table, List[ColorData]):
    """Result of `color`: a list of ColorData that is shown as a table."""

    def columns(self) -> Dict[str, Any]:
        """A row for each colour."""
        names = ("X", "Y", "Z", "x", "y", "u'", "v'", "L*", "a*", "b*", "u*", "v*")
        rows = [(*c.xyz, *c.xy, *c.uv, *c.lab, *c.luv[1:]) for c in self]
        columns: Dict[str, Any] = {"name": [c.name for c in self], **{n: [row[k] for row in rows] for k, n in enumerate(names)}}
        columns["screen"] = [c.screen for c in self]
        for key in ("dominant_wavelength", "purity", "whiteness", "tint", "yellowness"):
            columns[key] = ["" if getattr(c, key) is None else getattr(c, key) for c in self]
        for part in ("difference", "metamerism"):
            for key in dict.fromkeys(key for c in self for key in getattr(c, part)):
                columns[key if part == "difference" else f"metamerism {key}"] = [getattr(c, part).get(key, "") for c in self]
        return columns

    def plot(self, ax: Any = None) -> Any:
        """Chromaticities x, y on the spectrum locus, in the colours themselves.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        from . import spectrum

        axes = axes_or_new(ax)
        nm = np.arange(400.0, 701.0)
        xyz = spectrum.observer(nm)
        locus = xyz[:, :2] / xyz.sum(axis=1, keepdims=True)
        axes.fill(locus[:, 0], locus[:, 1], facecolor="none", edgecolor="0.5")
        for c in self:
            axes.plot(*c.xy, "o", color=c.screen, markeredgecolor="k")
            axes.annotate(c.name, c.xy, textcoords="offset points", xytext=(5, 3))
        axes.set(xlabel="x", ylabel="y", aspect="equal")
        return axes


def color(
    *colors: Any,
    illuminant: str = "D65",
    observer: int = 2,
    standard: Any = None,
    others: Sequence[str] = ("A", "F11"),
    cmc: Tuple[float, float] = (2, 1),
) -> ColorTable:
    """Colour of spectra and of stated colours, and differences: `aureole color`.

    Parameters
    ----------
    *colors : str, path or MeasuredSpectrum
        Files of spectra (.csv, .cxf, .cgats), FILE#SAMPLE, "#rrggbb", names of HTML, "lab(L, a, b)", or results of
        `spectrophotometer`.
    illuminant : str
        A CIE illuminant or a lamp's file.
    observer : {2, 10}
        Field in degrees: CIE 1931 or CIE 1964.
    standard : str, path or MeasuredSpectrum, optional
        The colour to compare with.
    others : list of str
        Illuminants of the metamerism indices.
    cmc : (float, float)
        l and c of the CMC difference.

    Returns
    -------
    list of ColorData
    """
    import tempfile
    from pathlib import Path

    if not colors:
        raise Error("colors: expected at least one colour")
    degrees = _observer_field(observer)
    pair = real("cmc", cmc, positive=True)
    if pair.shape != (2,):
        raise Error(f"cmc: expected l and c, got an array of shape {pair.shape}")
    if isinstance(others, str):
        raise TypeError("others: expected a list of strings, got a string")
    viewing = _aureole.viewed_at(text("illuminant", illuminant), degrees)
    tests = [_aureole.viewed_at(text("others", name), degrees) for name in others]
    with tempfile.TemporaryDirectory() as folder:

        def named(what: str, value: Any, number: int) -> str:
            if isinstance(value, MeasuredSpectrum):
                written = Path(folder) / f"{number}.csv"
                value.save(written)
                return str(written)
            return text(what, value) if isinstance(value, str) else file_path(what, value)

        texts = [named("colors", value, k) for k, value in enumerate(colors)]
        of_standard = "" if standard is None else named("standard", standard, len(colors))
        with Words():
            found = _aureole.colours(texts, of_standard, viewing, [t for t in tests if t != viewing], tuple(pair.tolist()))
    tell(found["notes"])
    return ColorTable(_color_data(one) for one in found["colours"])


def _observer_field(observer: Any) -> str:
    if observer not in (2, 10) or isinstance(observer, (bool, np.bool_)):
        raise Error("observer: expected 2 or 10 degrees")
    return f"{int(observer)}"


def _color_data(one: Dict[str, Any]) -> ColorData:
    dominant, whiteness = one["dominant"], one["whiteness"]
    d = one.get("difference")
    difference = {}
    if d is not None:
        difference = {"dL": d["lab"][0], "da": d["lab"][1], "db": d["lab"][2], "dC": d["chroma"], "dH": d["hue"]}
        difference.update({key: d[key] for key in ("cie1976", "ciede2000", "cmc", "cie94", "din99o")})
    valid = whiteness is not None and whiteness[2]
    return ColorData(
        one["name"],
        tuple(one["xyz"]),
        tuple(100 * v for v in one["white"]),
        tuple(one["xy"]),
        tuple(one["uv"]),
        tuple(one["lab"]),
        tuple(one["luv"]),
        one["screen"],
        None if dominant is None else -dominant[0] if dominant[1] else dominant[0],
        None if dominant is None else dominant[2],
        whiteness[0] if valid else None,
        whiteness[1] if valid else None,
        one["yellowness"],
        difference,
        {} if d is None else dict(d["metamerism"]),
        np.array(one["nm"]),
        np.array(one["values"]),
    )


@dataclass(frozen=True)
class AppearanceData:
    """Correlates of CAM16 (Li and others, Color Res. Appl. 42(6), 2017).

    Attributes
    ----------
    lightness, chroma, hue, saturation, brightness, colourfulness : float
        J, C, h in degrees, s, Q, M.
    hue_composition : float
        H, from 0 (red) over 100 (yellow), 200 (green) and 300 (blue) to 400.
    ucs : (float, float, float)
        J', a', b' of CAM16-UCS, in which distances are differences.
    """

    lightness: float
    chroma: float
    hue: float
    saturation: float
    brightness: float
    colourfulness: float
    hue_composition: float
    ucs: Triple

    def difference(self, other: "AppearanceData") -> float:
        """The distance in CAM16-UCS.

        Parameters
        ----------
        other : AppearanceData

        Returns
        -------
        float
        """
        if not isinstance(other, AppearanceData):
            raise TypeError(f"other: expected an AppearanceData, got {type(other).__name__}")
        return float(np.linalg.norm(np.subtract(self.ucs, other.ucs)))


_SURROUNDS = {"average": "Average", "dim": "Dim", "dark": "Dark"}


def cam16(
    xyz: npt.ArrayLike,
    white: npt.ArrayLike,
    *,
    adapting_luminance: float = 318.31 / 5,
    background: float = 20,
    surround: str = "average",
) -> AppearanceData:
    """Appearance of a colour by CAM16, computed by colour-science.

    Parameters
    ----------
    xyz, white : (float, float, float)
        Tristimulus values of the colour and of the white, Y = 100 for the white.
    adapting_luminance : float
        Of the field, in cd/m^2.
    background : float
        Luminance factor in percent.
    surround : {"average", "dim", "dark"}

    Returns
    -------
    AppearanceData
    """
    values, of_white = real("xyz", xyz, minimum=0, maximum=1e6), real("white", white, positive=True, maximum=1e6)
    for name, array in (("xyz", values), ("white", of_white)):
        if array.shape != (3,):
            raise Error(f"{name}: expected X, Y and Z, got an array of shape {array.shape}")
    luminance = scalar("adapting_luminance", adapting_luminance, positive=True, maximum=1e9, unit="cd/m^2")
    factor = scalar("background", background, positive=True, maximum=100)
    if text("surround", surround) not in _SURROUNDS:
        raise Error(f'surround: expected "average", "dim" or "dark", got {surround!r}')
    colour = colour_science()
    condition = colour.VIEWING_CONDITIONS_CAM16[_SURROUNDS[surround]]
    with np.errstate(all="ignore"):
        c = colour.XYZ_to_CAM16(values, of_white, luminance, factor, condition)
        ucs = colour.JMh_CAM16_to_CAM16UCS([c.J, c.M, c.h])
    j, chroma, h, saturation, q, m, composition = (float(getattr(c, name)) for name in ("J", "C", "h", "s", "Q", "M", "H"))
    return AppearanceData(j, chroma, h, saturation, q, m, composition, (float(ucs[0]), float(ucs[1]), float(ucs[2])))


@dataclass(frozen=True, eq=False)
class ColorRendering(Table):
    """Result of `color_rendering`.

    Attributes
    ----------
    cct, duv : float
        Correlated colour temperature in K, and distance from Planck's locus.
    cri : float
        General colour rendering index R_a (CIE 13.3).
    special : dict of int to float
        R_1 to R_14.
    fidelity, gamut : float
        R_f and R_g of ANSI/IES TM-30-18.
    hue_fidelity, chroma_shift, hue_shift : numpy.ndarray, shape (16,)
        R_f,h, R_cs,h in percent and R_hs,h in rad of TM-30's hue bins.
    """

    cct: float
    duv: float
    cri: float
    special: Dict[int, float]
    fidelity: float
    gamut: float
    hue_fidelity: Reals = field(repr=False)
    chroma_shift: Reals = field(repr=False)
    hue_shift: Reals = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """A row for each hue bin of TM-30."""
        return {
            "hue_bin": np.arange(1, 17),
            "R_f": self.hue_fidelity,
            "chroma_shift_percent": self.chroma_shift,
            "hue_shift_rad": self.hue_shift,
        }

    def plot(self, ax: Any = None) -> Any:
        """TM-30's colour vector graphic: chroma and hue shift of each hue bin about the circle of the reference.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        t = np.linspace(0, 2 * np.pi, 200)
        axes.plot(np.cos(t), np.sin(t), color="0.5", label="reference")
        at = (np.arange(16) + 0.5) * np.pi / 8
        radius, angle = 1 + 0.01 * self.chroma_shift, at + self.hue_shift
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        axes.plot(np.append(x, x[0]), np.append(y, y[0]), color="#c03020", label=f"R_f {self.fidelity:.1f}, R_g {self.gamut:.1f}")
        for a, px, py in zip(at, x, y):
            axes.annotate("", (px, py), (np.cos(a), np.sin(a)), arrowprops={"arrowstyle": "->", "color": "0.3"})
        axes.set(aspect="equal", title=f"R_a {self.cri:.1f}, {self.cct:.0f} K")
        axes.legend()
        return axes

    def _title(self) -> str:
        return f"{self.cct:.0f} K, R_a {self.cri:.1f}, R_f {self.fidelity:.1f}, R_g {self.gamut:.1f}"


def color_rendering(lamp: "Union[str, RadiometerReading, Tuple[npt.ArrayLike, npt.ArrayLike]]") -> ColorRendering:
    """Colour rendering of a lamp: CRI (CIE 13.3-1995) and TM-30 (ANSI/IES TM-30-18), computed by colour-science.

    Parameters
    ----------
    lamp : str, RadiometerReading, or (wavelengths, powers)
        An illuminant ("FL2", "A"), a reading of `spectroradiometer`, or wavelengths in nm with spectral powers. It is
        interpolated at steps of 1 nm from 380 to 780 nm and has to cover that range.

    Returns
    -------
    ColorRendering
    """
    nm = np.arange(380.0, 781.0)
    if isinstance(lamp, str):
        from . import spectrum

        power = np.asarray(spectrum.illuminant(text("lamp", lamp), nm))
    else:
        if isinstance(lamp, RadiometerReading):
            known, values = lamp.wavelength, np.maximum(lamp.values, 0)
        elif isinstance(lamp, tuple) and len(lamp) == 2:
            known, values = real("lamp", lamp[0], positive=True, unit="nm"), real("lamp", lamp[1], minimum=0)
        else:
            raise TypeError(f"lamp: expected a string, a RadiometerReading or two arrays, got {type(lamp).__name__}")
        if known.ndim != 1 or known.shape != values.shape or known.size < 2 or np.any(np.diff(known) <= 0):
            raise Error("lamp: expected increasing wavelengths and as many powers")
        if known[0] > 380 or known[-1] < 780:
            raise Error(f"lamp: expected wavelengths from 380 to 780 nm, got {known[0]:g} to {known[-1]:g}")
        power = np.interp(nm, known, values)
    if not np.any(power > 0):
        raise Error("lamp: expected some power from 380 to 780 nm")
    # colour-science divides by the power; its scale changes nothing.
    power = power / power.max()
    colour = colour_science()
    sd = colour.SpectralDistribution(dict(zip(nm.tolist(), power.tolist())), name="lamp")
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        cri = colour.colour_rendering_index(sd, additional_data=True)
        tm30 = colour.colour_fidelity_index(sd, additional_data=True, method="ANSI/IES TM-30-18")
    return ColorRendering(
        float(tm30.CCT),
        float(tm30.D_uv),
        float(cri.Q_a),
        {k: float(q.Q_a) for k, q in cri.Q_as.items()},
        float(tm30.R_f),
        float(tm30.R_g),
        np.asarray(tm30.R_fs, np.float64),
        np.asarray(tm30.R_cs, np.float64),
        np.asarray(tm30.R_hs, np.float64),
    )


__all__ = ["AppearanceData", "ColorData", "ColorRendering", "ColorTable", "cam16", "color", "color_rendering"]
