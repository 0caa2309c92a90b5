# SPDX-License-Identifier: Apache-2.0
"""Palettes of paints, mixtures, recipes for a colour, and paints from grains. For pigment.py."""
from __future__ import annotations

import functools
import math
import os
from dataclasses import astuple, dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import complex_numbers, flag, real, scalar, text as checked_text
from ._errors import Error
from ._paint_colours import lab
from ._paint_layers import Layer, Reals, Surface, layer, opaque_reflectance
from ._vectorised import choice, shaped


@dataclass(frozen=True)
class Streams:
    """The theory by streams to which K = 2 sigma_a and S = 3/4 sigma_s (1 - g) of a palette belong.

    The interface of a binder of `index` is seen by an instrument of `geometry` with its gloss `specular`; `g` is the mean
    cosine of scattering in paints that have none of their own.
    """

    index: float
    g: float
    geometry: str
    specular: str


@functools.lru_cache(maxsize=8)
def _theory(streams: Streams, varies_g: bool) -> Any:
    """The tabulated theory, some 0.5 s; with mean cosines that vary several times as much."""
    return _aureole.pigment_streams_theory(streams.index, streams.g, streams.geometry, streams.specular, varies_g)


@dataclass(frozen=True)
class Paint:
    """A mixture of a palette's paints: K and S over its wavelengths.

    Its reflectances are those of two fluxes under `surface`, or, where `streams` are given, of streams, in which layers have
    the mean cosine g with ln((1 - g)/(1 - streams.g)) = `g_shift` at each wavelength (empty: 0).
    """

    nm: Reals
    k: Reals
    s: Reals
    surface: Surface
    streams: Optional[Streams] = None
    g_shift: Reals = field(default_factory=lambda: np.array([]))

    def reflectance(self, thickness: float = math.inf, substrate: npt.ArrayLike = 0.0) -> Reals:
        """Outer reflectance: opaque, or of a thickness (in the inverse unit of K and S) over a substrate of that inner reflectance."""
        if self.streams is not None:
            depth = thickness if math.isinf(thickness) else scalar("thickness", thickness, positive=True)
            below = np.ascontiguousarray(np.broadcast_to(real("substrate", substrate, minimum=0, maximum=1), self.nm.shape))
            seen = np.empty(self.nm.size)
            shift = np.ascontiguousarray(self.g_shift) if self.g_shift.size else np.zeros(self.nm.size)
            _aureole.pigment_streams_reflectance(_theory(self.streams, self.g_shift.size > 0), np.ascontiguousarray(self.k),
                                                 np.ascontiguousarray(self.s), shift, float(depth), below, seen)
            return seen
        if math.isinf(thickness):
            ratio = np.divide(self.k, self.s, out=np.zeros_like(self.k), where=self.s > 0)
            inner = np.where(self.s > 0, opaque_reflectance(ratio), 0.0)
        else:
            free = layer(self.k, self.s, scalar("thickness", thickness, positive=True))
            below = real("substrate", substrate, minimum=0, maximum=1)
            inner = free.reflectance + free.transmittance**2 * below / (1 - free.reflectance * below)
        return np.asarray(self.surface.outer(np.minimum(inner, 1.0)))

    def free_film(self, thickness: float) -> Layer:
        """Reflectance and transmittance of a free film of this thickness, with an interface on each side, as the instrument of
        the measurements has them. Transmittance is that of all light.

        Examples
        --------
        >>> import numpy as np
        >>> from aureole import pigment
        >>> chalk = pigment.Paint(np.array([400.0, 700.0]), np.zeros(2), np.full(2, 1e5), pigment.Surface())
        >>> free = chalk.free_film(1e-5)  # S X = 1
        >>> round(float(free.reflectance[0]), 9), round(float(free.transmittance[0]), 9)
        (0.5, 0.5)
        """
        depth = scalar("thickness", thickness, positive=True)
        k, s = np.ascontiguousarray(self.k), np.ascontiguousarray(self.s)
        film = np.empty((2, self.nm.size))
        if self.streams is not None:
            shift = np.ascontiguousarray(self.g_shift) if self.g_shift.size else np.zeros(self.nm.size)
            _aureole.pigment_streams_free_film(_theory(self.streams, self.g_shift.size > 0), k, s, shift, float(depth), film)
        else:
            k1, k2, specular = self.surface
            _aureole.pigment_free_film(k, s, float(depth), (k1, k2, specular), film)
        return Layer(film[0], film[1])

    def contrast_ratio(self, thickness: float, *, black: float = 0.0, white: float = 0.8, illuminant: str = "D65") -> float:
        """Luminous reflectance over a black substrate divided by the one over a white substrate, given by their inner
        reflectances."""
        dark, bright = scalar("black", black, minimum=0, maximum=1), scalar("white", white, minimum=0, maximum=1)
        if not bright > dark:
            raise Error("white: must reflect more than black")
        layers = np.stack([self.reflectance(thickness, dark), self.reflectance(thickness, bright)])
        lightness = lab(self.nm, layers, illuminant)[:, 0]
        over_black, over_white = np.where(lightness > 8, ((lightness + 16) / 116) ** 3, lightness * 27 / 24389)
        return float(over_black / over_white) if over_white > 0 else 1.0

    def hiding_thickness(self, *, ratio: float = 0.98, black: float = 0.0, white: float = 0.8, illuminant: str = "D65") -> float:
        """The thickness from which the contrast ratio is at least `ratio`; infinite where it never is. As `aureole pigment hide`.

        Examples
        --------
        >>> import numpy as np
        >>> from aureole import pigment
        >>> chalk = pigment.Paint(np.array([400.0, 700.0]), np.zeros(2), np.full(2, 1e5), pigment.Surface())
        >>> round(1e6 * chalk.hiding_thickness(white=1), 3)  # S X = 49
        490.0
        """
        wanted = scalar("ratio", ratio, minimum=0.01, maximum=0.9999)
        rate = float((self.k + self.s).max())
        if not rate > 0:
            return math.inf
        return float(_aureole.pigment_hiding_thickness(
            lambda x: self.contrast_ratio(x, black=black, white=white, illuminant=illuminant), 1 / rate, wanted))


    def spreading_rate(self, solids: float, *, ratio: float = 0.98, black: float = 0.0, white: float = 0.8, illuminant: str = "D65") -> float:
        """Area that a litre of wet paint hides [m^2], at this contrast ratio; for a paint with K and S in 1/m.

        `solids` is the volume of the dry film per volume of wet paint, in (0, 1].
        """
        dry = scalar("solids", solids, positive=True, maximum=1)
        return 1e-3 * dry / self.hiding_thickness(ratio=ratio, black=black, white=white, illuminant=illuminant)


def grain_names() -> List[str]:
    """Names that `grain_index` and `paint_of_grains` know: materials, then trade names."""
    return list(_aureole.pigment_grain_names())


def grain_index(material: str, nm: npt.ArrayLike) -> npt.NDArray[np.complex128]:
    """Index n + i k of a pigment or filler by name, such as "rutile"; for crystals the mean over directions.

    Parameters
    ----------
    material : str
        One of `grain_names`; case is ignored.
    nm : array_like
        Wavelength in vacuum. Outside the range of the source the value at its limit is returned.

    Examples
    --------
    >>> from aureole import pigment
    >>> complex(pigment.grain_index("calcite", 589.3).round(3))
    (1.601+0j)
    """
    wavelengths = real("nm", nm, positive=True)
    result = np.empty(wavelengths.size, np.complex128)
    _aureole.pigment_grain_index(checked_text("material", material), np.ascontiguousarray(wavelengths).reshape(-1), result)
    return shaped(result, wavelengths.shape)  # type: ignore[no-any-return]


def paint_of_grains(nm: npt.ArrayLike, index: Union[str, npt.ArrayLike], radius: float, *, fraction: float,
                    binder: npt.ArrayLike = 1.5, spread: float = 0.0, weighting: str = "number", hard_spheres: bool = False,
                    convention: str = "three_quarters", surface: Surface = Surface()) -> Paint:
    """Paint from its microstructure: K and S [1/m] of spheres in a binder, by Mie's theory and a convention.

    K and S of several kinds of grains in one binder add.

    Parameters
    ----------
    nm : array_like
        Increasing wavelengths in vacuum.
    index : str or array_like
        Index of the grains: a name of `grain_names`, or n + i k, one for all or one for each wavelength.
    radius : float
        Radius in m; the median where there is a spread.
    fraction : float
        Fraction of the volume that the grains fill, in (0, 0.74], or (0, 0.6] with `hard_spheres`.
    binder : array_like
        Real index of the binder, one for all or one for each wavelength.
    spread : float
        Standard deviation of ln(radius), in [0, 1.5]; 0: one radius.
    weighting : str
        "number" or "volume": by which the median is stated.
    hard_spheres : bool
        Whether neighbours keep their distance, so that a dense paint scatters less than the sum of its grains. Without
        it S is too large above some 5 % of the volume.
    convention : str
        As for `coefficients_of_transport`; negative S is set to 0.
    surface : Surface
        The interface of the paint to air.

    Examples
    --------
    >>> from aureole import pigment
    >>> white = pigment.paint_of_grains([450, 550, 650], "rutile", 0.11e-6, fraction=0.1)
    >>> bool((white.s > 3e5).all()), float(white.k[1])
    (True, 0.0)
    """
    choice("convention", convention, *_aureole.pigment_conventions())
    choice("weighting", weighting, "number", "volume")
    wavelengths = real("nm", nm, positive=True)
    if wavelengths.ndim != 1 or wavelengths.size == 0 or not (np.diff(wavelengths) > 0).all():
        raise Error("nm: expected increasing wavelengths in nm")
    grains = grain_index(index, wavelengths) if isinstance(index, str) else complex_numbers("index", index)
    if not ((grains.real > 0) & (grains.imag >= 0)).all():
        raise Error("index: expected n + i k with n > 0 and k >= 0")

    def each(name: str, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        if values.shape not in ((), wavelengths.shape):
            raise Error(f"{name}: expected one number or {wavelengths.size}, one for each wavelength, got shape {values.shape}")
        return np.ascontiguousarray(np.broadcast_to(values, wavelengths.shape))

    dense = flag("hard_spheres", hard_spheres)
    result = np.empty((2, wavelengths.size))
    _aureole.pigment_grains(np.ascontiguousarray(wavelengths), each("index", grains),
                            each("binder", real("binder", binder, minimum=1, maximum=10)),
                            scalar("radius", radius, positive=True, unit="m"), scalar("spread", spread, minimum=0, maximum=1.5), weighting == "volume",
                            scalar("fraction", fraction, positive=True, maximum=0.6 if dense else 0.74), dense, convention, result)
    return Paint(wavelengths, result[0], result[1], surface)


@dataclass(frozen=True)
class Match:
    """A recipe for a colour.

    Attributes
    ----------
    recipe : dict
        Share of each paint by mass.
    difference : float
        CIEDE2000 to the target under the illuminant.
    metamerism : dict
        CIEDE2000 under the other illuminants, if the target is a reflectance.
    rms : float
        Rms of the difference in reflectance, if the target is a reflectance.
    reflectance : numpy.ndarray
    cost : float
        Per mass of the mixture; 0 without prices.
    contrast : float
        Contrast ratio over black and white at the thickness; 1 for opaque layers.
    dosing : dict
        For each paint the CIEDE2000 if its share is 1 % too large; `dosing_error` is the CIEDE2000 for independent
        errors of 1 % of all paints.
    """

    recipe: Dict[str, float]
    difference: float
    metamerism: Dict[str, float]
    rms: float
    reflectance: Reals
    cost: float = 0.0
    contrast: float = 1.0
    dosing: Dict[str, float] = field(default_factory=dict)
    dosing_error: float = 0.0


@dataclass(frozen=True)
class Palette:
    """Paints that can be mixed.

    Attributes
    ----------
    nm : numpy.ndarray
        Wavelengths.
    names : tuple of str
    k, s : numpy.ndarray
        (paints, wavelengths), as fitted: negative values count as zero in mixtures.
    k_error, s_error : numpy.ndarray
        Standard errors, NaN where not known.
    relative : bool
        K and S have no unit of length: they are relative to S of the white, or per film (`joint_fit`). Else per metre.
    surface : Surface
        Interface through which the paints were measured.
    density : numpy.ndarray
        Mass per volume of each paint, relative; empty where K and S add up by mass rather than by volume.
    streams : Streams or None
        The theory of K and S that were fitted by streams, by which mixtures and recipes are then predicted.
    g : numpy.ndarray
        Mean cosine of scattering in each paint where streams were fitted with one for each; else empty.
    """

    nm: Reals
    names: Tuple[str, ...]
    k: Reals
    s: Reals
    k_error: Reals
    s_error: Reals
    relative: bool
    surface: Surface
    density: Reals = field(default_factory=lambda: np.array([]))
    streams: Optional[Streams] = None
    g: Reals = field(default_factory=lambda: np.array([]))

    @staticmethod
    def _of(parts: Any) -> "Palette":
        nm, names, k, s, k_error, s_error, relative, interface, density, streams, g = parts

        def errors(rows: List[List[float]]) -> Reals:
            return np.array([row or [math.nan] * len(nm) for row in rows])

        return Palette(np.array(nm), tuple(names), np.array(k), np.array(s), errors(k_error), errors(s_error), relative,
                       Surface(*interface), np.array(density), None if streams is None else Streams(*streams), np.array(g))

    @staticmethod
    def load(file: Union[str, "os.PathLike[str]"]) -> "Palette":
        """A palette as `aureole pigment fit` writes it; "kimera": 13 measured acrylics, by miciwan, CC BY 4.0."""
        return Palette._of(_aureole.pigment_palette(os.fspath(file)))

    def _parts(self) -> Any:
        return (self.nm.tolist(), list(self.names), self.k.tolist(), self.s.tolist(), [], [], self.relative, tuple(self.surface),
                self.density.tolist(), None if self.streams is None else astuple(self.streams), self.g.tolist())

    def fractions(self, recipe: Union[str, Mapping[str, float]]) -> Reals:
        """Mass fractions, one for each paint, of "red: 1 + white: 3" or {"red": 1, "white": 3}."""
        if not isinstance(recipe, str):
            recipe = " + ".join(f"{name}: {scalar(f'recipe[{name!r}]', amount):.17g}" for name, amount in recipe.items())
        return np.array(_aureole.pigment_recipe(self._parts(), recipe))

    def mix(self, recipe: Union[str, Mapping[str, float]]) -> Paint:
        """A mixture by mass."""
        fractions = self.fractions(recipe)
        if self.density.size:
            fractions = fractions / self.density
            fractions /= fractions.sum()
        k, s = fractions @ np.maximum(self.k, 0), fractions @ np.maximum(self.s, 0)
        if self.streams is None or not self.g.size:
            return Paint(self.nm, k, s, self.surface, self.streams)
        # sigma_s, proportional to S/(1 - g), add up like S.
        scattering = (fractions * (1 - self.streams.g) / (1 - self.g)) @ np.maximum(self.s, 0)
        ratio = np.divide(s, scattering, out=np.ones_like(s), where=(s > 0) & (scattering > 0))
        return Paint(self.nm, k, s, self.surface, self.streams, np.log(ratio))

    def match(self, target: npt.ArrayLike, *, paints: int = 3, solutions: int = 5, illuminant: str = "D65",
              others: Sequence[str] = ("A", "F11"), least: Mapping[str, float] = {}, most: Mapping[str, float] = {},
              by: str = "colour", prices: Mapping[str, float] = {}, apart: Sequence[Tuple[str, str]] = (), smallest: float = 1e-4,
              thickness: float = math.inf, substrate: npt.ArrayLike = 1.0, opacity: float = 0.0, trade_offs: bool = False,
              within: float = 1.0) -> List[Match]:
        """Recipes of at most `paints` paints, best first.

        Parameters
        ----------
        target : array_like
            Three numbers: L*, a*, b* under `illuminant`. As many as wavelengths: an outer reflectance, which is also
            compared under `others`.
        paints, solutions : int
            Largest number of paints of a recipe, 1 to 6, and of recipes.
        least, most : mapping of str to float
            Bounds of a paint's share.
        by : str
            What recipes minimise: "colour" (under the illuminant), "lamps" (under all of them) or "spectrum" (rms).
        prices : mapping of str to float
            Price of every paint that may be used, per mass.
        apart : sequence of pairs of str
            Paints that no recipe has together.
        smallest : float
            Smallest share of a paint that can be dosed.
        thickness : float
            Of the layer, in the inverse unit of K and S; opaque by default.
        substrate : array_like
            Inner reflectance below such a layer.
        opacity : float
            Least contrast ratio over black and white (0.8) at that thickness.
        trade_offs : bool
            Return recipes with a difference of at most `within` that no other recipe surpasses in colour, cost and
            metamerism at once.
        """
        wanted = real("target", target)
        if wanted.shape not in ((3,), self.nm.shape):
            raise Error(f"target: expected 3 numbers (L*, a*, b*) or {self.nm.size} (a reflectance), got shape {wanted.shape}")
        spectral = wanted.shape == self.nm.shape
        choice("by", by, "colour", "lamps", "spectrum")

        def index(name: str, paint: str) -> int:
            if paint not in self.names:
                raise Error(f"{name}: unknown paint {paint!r}; there are {', '.join(self.names)}")
            return self.names.index(paint)

        bounds = []
        for name, given, default in (("least", least, 0.0), ("most", most, 1.0)):
            values = [default] * len(self.names)
            for paint, share in given.items():
                values[index(name, paint)] = scalar(name, share, minimum=0, maximum=1)
            bounds.append(values)
        costs: List[float] = []
        if prices:
            for paint in prices:
                index("prices", paint)
            missing = [paint for paint, most_ in zip(self.names, bounds[1]) if most_ > 0 and paint not in prices]
            if missing:
                raise Error(f"prices: there is no price of {missing[0]!r}")
            costs = [scalar("prices", prices.get(paint, 0.0), minimum=0) for paint in self.names]
        pairs = [(index("apart", one), index("apart", other)) for one, other in apart]
        depth = math.inf if math.isinf(thickness) else scalar("thickness", thickness, positive=True)
        below = np.atleast_1d(real("substrate", substrate, minimum=0, maximum=1))
        found = _aureole.pigment_match(self._parts(), [] if spectral else wanted.tolist(), wanted.tolist() if spectral else [],
                                       paints, solutions, illuminant, list(others), bounds[0], bounds[1], by, costs, pairs,
                                       scalar("smallest", smallest, minimum=0), depth, below.tolist(),
                                       scalar("opacity", opacity, minimum=0), flag("trade_offs", trade_offs),
                                       scalar("within", within, positive=True),
                                       None if self.streams is None else _theory(self.streams, self.g.size > 0))
        return [Match({n: f for n, f in zip(self.names, fractions) if f > 0}, difference, dict(zip(others, differences)), rms,
                      np.array(reflectance), cost, contrast, {n: d for n, f, d in zip(self.names, fractions, dosing) if f > 0}, total)
                for fractions, difference, differences, rms, reflectance, cost, contrast, dosing, total in found]
