# SPDX-License-Identifier: Apache-2.0
"""`microstructure`: scatterers found in microscope pictures, their statistics, and the material they make."""
from __future__ import annotations

import dataclasses
import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import integer, real, scalar
from ._correlations import PairCorrelation, PointStructureFactor
from ._dict import plugins
from ._errors import Error
from ._image import Image
from ._results import Table
from ._units import length_m
from ._wording import python_names
from .spectrum import srgb_decode

Reals = npt.NDArray[np.float64]


class Estimate(NamedTuple):
    """A number with the ends of its 95 % confidence interval. ``float(estimate)`` is the number."""

    value: float
    low: float
    high: float

    def __float__(self) -> float:
        return self.value

    def __format__(self, spec: str) -> str:
        return f"{self.value:{spec or '.4g'}} [{self.low:{spec or '.4g'}}, {self.high:{spec or '.4g'}}]"

    def __repr__(self) -> str:
        return format(self, "")

    def __str__(self) -> str:
        return format(self, "")


@dataclasses.dataclass(frozen=True)
class Particles(Table):
    """A table with a row for each particle: arrays of shape (n,). Lengths in m, x to the right and y down from the
    picture's upper left corner.

    Attributes
    ----------
    field : numpy.ndarray of int
        Index of the picture.
    x, y : numpy.ndarray
        Centroid.
    radius, area : numpy.ndarray
        The area in m^2, and the radius of the circle that has it.
    circularity : numpy.ndarray
        4 pi area/perimeter^2 of the outline; 1 for a circle.
    aspect, angle : numpy.ndarray
        Of the ellipse with the same second moments: long over short axis, and the angle of the long axis from x
        towards y in degrees.
    cut, touching : numpy.ndarray of bool
        Whether the frame cuts the particle, and whether it shares a boundary with another particle.
    weight : numpy.ndarray
        Weight in statistics of sizes; 0 for cut particles. The weights sum to 1.
    outline : list of numpy.ndarray, shape (k, 2)
        Corners of the outline; empty for cut particles.
    """

    field: npt.NDArray[np.int64]
    x: Reals
    y: Reals
    radius: Reals
    area: Reals
    circularity: Reals
    aspect: Reals
    angle: Reals
    cut: npt.NDArray[np.bool_]
    touching: npt.NDArray[np.bool_]
    weight: Reals
    outline: List[Reals] = dataclasses.field(repr=False)

    def __len__(self) -> int:
        return len(self.x)

    def columns(self) -> Dict[str, Any]:
        """A row for each particle, without its outline."""
        units = {"x": "_m", "y": "_m", "radius": "_m", "area": "_m2", "angle": "_deg"}
        return {f.name + units.get(f.name, ""): getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "outline"}


@dataclasses.dataclass(frozen=True, repr=False)
class Microstructure(Table):
    """Result of `microstructure`. Lengths in m.

    Attributes
    ----------
    area_fraction : Estimate
        Part of the plane that discs of `correlation_radius` would cover: the parameter of ``correlated_scatterers``.
    covered_fraction : Estimate
        Part of the plane that the particles cover.
    density : Estimate
        Number per m^2.
    correlation_radius : Estimate
        Half the smallest distance of two centres.
    mean_radius, radius_deviation, log_deviation : Estimate
        Mean and standard deviation of radii, and standard deviation of their logarithm.
    radius_quantiles : dict of float to Estimate
    round : bool
        The particles are circles as far as the pictures show; `circularity` and `aspect` are medians.
    particles : Particles
    pair_correlation : optics.PairCorrelation
        g over r in m.
    structure_factor : optics.PointStructureFactor
        S over q in rad/m; empty arrays where the pictures are too small for one.
    overlays : list of Image
        The pictures with outlines (green whole, orange cut) and centres.
    fields : list of dict
        Properties of each picture: pixel_size, seen (area in m^2), whole, cut, too_small, bright, noise, blur (in
        pixels).
    choices : list of str
        Polarity and scatterers of the material where they were chosen automatically, with the reasons.
    notes : list of str
        Doubts about the result.
    scene_text : str
        The material as a scene file; the files that it names are written by `save`.
    """

    area_fraction: Estimate
    covered_fraction: Estimate
    density: Estimate
    correlation_radius: Estimate
    mean_radius: Estimate
    radius_deviation: Estimate
    log_deviation: Estimate
    radius_quantiles: Dict[float, Estimate]
    round: bool
    circularity: float
    aspect: float
    particles: Particles
    pair_correlation: PairCorrelation
    structure_factor: PointStructureFactor
    overlays: List[Image]
    fields: List[Dict[str, Any]]
    choices: List[str]
    notes: List[str]
    scene_text: str
    _result: Any

    def columns(self) -> Dict[str, Any]:
        """A row for each measured quantity, with its unit and its 95 % confidence interval; `particles` has a table of its own."""
        units = {"area_fraction": "1", "covered_fraction": "1", "density": "1/m^2", "correlation_radius": "m", "mean_radius": "m",
                 "radius_deviation": "m", "log_deviation": "1"}
        rows = [(name, unit, getattr(self, name)) for name, unit in units.items()]
        rows += [(f"radius_quantile_{part:g}", "m", estimate) for part, estimate in self.radius_quantiles.items()]
        return {"quantity": [name for name, _, _ in rows], "unit": [unit for _, unit, _ in rows],
                **{end: [getattr(estimate, end) for _, _, estimate in rows] for end in Estimate._fields}}

    def _title(self) -> str:
        return str(self)

    def material(self, folder: "str | os.PathLike[str] | None" = None) -> Dict[str, Any]:
        """The measured layer as a dict for `load_dict`.

        Parameters
        ----------
        folder : path-like, optional
            Folder that `save` wrote. Shapes that are not round need it, since their outline is a file there. Without
            it, sizes of circles are given as a mixture.

        Returns
        -------
        dict
            Of type "correlated_scatterers", or "correlated_spheres" for spheres.
        """
        root = ElementTree.fromstring(self.scene_text).find("bsdf")
        assert root is not None
        return self._dict_of(root, Path(os.fspath(folder)).resolve() if folder is not None else None)

    def _dict_of(self, element: ElementTree.Element, folder: Optional[Path]) -> Dict[str, Any]:
        result: Dict[str, Any] = {"type": element.attrib["type"]}
        parameters = plugins()[element.tag, element.attrib["type"]].parameters
        for child in element:
            name, text = child.attrib.get("name", ""), child.attrib.get("value", "")
            if child.tag == "aperture":
                if folder is None and child.attrib["type"] == "circle":
                    result.update(self._circles())
                else:
                    result["aperture"] = self._dict_of(child, folder)
            elif name in parameters and parameters[name][0] == "file":
                if folder is None:
                    raise Error("folder: these particles are not round, and their outline is a file: expected the "
                                "folder that save() wrote")
                result[name] = str(folder / text)
            else:
                numbers = {"float": float, "boolean": lambda t: t == "true"}
                result[name] = numbers.get(child.tag, str)(text)
        return result

    def _circles(self) -> Dict[str, Any]:
        """A circle for each class of sizes."""
        rows = [line.split() for line in self._result.size_histogram.splitlines() if not line.startswith("#")]
        sizes, counts = np.array(rows, dtype=np.float64).T
        parts = counts / counts.sum()
        radii = sizes * self.mean_radius.value * 1e6
        return {f"size_{k}": {"type": "circle", "radius": f"{radius:.7g}um", "fraction": float(part)}
                for k, (radius, part) in enumerate(zip(radii, parts))}

    def save(self, folder: "str | os.PathLike[str]") -> None:
        """Writes what the command ``aureole microstructure`` writes: result.json, scene.xml, particles.csv, plots."""
        self._result.save(os.fspath(folder))

    def plot(self, axes: "Any" = None) -> "npt.NDArray[Any]":
        """Three plots: radii, g(r), S(q), each with its error.

        Parameters
        ----------
        axes : sequence of 3 matplotlib Axes, optional
            Where to draw; a new figure if not given.

        Returns
        -------
        numpy.ndarray of 3 matplotlib Axes
        """
        from . import plot
        from ._plot_support import axes_for, matplotlib

        if axes is None:
            axes = matplotlib().pyplot.subplots(1, 3, figsize=(13, 3.8), layout="constrained")[1]
        targets = [axes_for(a) for a in np.ravel(np.asarray(axes, object))]
        if len(targets) != 3:
            raise Error(f"axes: expected three, got {len(targets)}")
        whole = self.particles.weight > 0
        radii, weights = self.particles.radius[whole] * 1e6, self.particles.weight[whole]
        targets[0].hist(radii, bins=int(np.clip(np.sqrt(len(radii)), 4, 24)), weights=weights, color="#4a6fa5")
        targets[0].axvline(self.mean_radius.value * 1e6, color="0.2", lw=1, ls="--")
        targets[0].set(xlabel="radius [um]", ylabel="part of the particles")
        a = self.correlation_radius.value
        g, s = self.pair_correlation, self.structure_factor
        plot.pair_correlation(g.r * 1e6, g.g, g.error, unit="um", ax=targets[1])
        targets[1].axvline(2e6 * a, color="0.2", lw=1, ls="--")
        if s.q.size:
            plot.structure_factor(s.q * 1e-6, s.s, s.error, unit="rad/um", ax=targets[2])
        result = np.empty(3, object)
        result[:] = targets
        return result

    def __repr__(self) -> str:
        lengths = (self.correlation_radius, self.mean_radius, self.radius_deviation)
        um = [Estimate(*(v * 1e6 for v in e)) for e in lengths]
        whole, cut = (sum(f[key] for f in self.fields) for key in ("whole", "cut"))
        shape = f"{'' if self.round else 'not '}round (circularity {self.circularity:.3f}, aspect {self.aspect:.3f})"
        pictures = f"{len(self.fields)} picture{'s' if len(self.fields) > 1 else ''}"
        rows = [("particles", f"{whole} whole, {cut} cut, in {pictures}"),
                ("area fraction", f"{self.area_fraction}"), ("covered fraction", f"{self.covered_fraction}"),
                ("correlation radius", f"{um[0]} um"), ("mean radius", f"{um[1]} um"),
                ("deviation of radii", f"{um[2]} um"), ("shape", shape)]
        rows += [("choice", c) for c in self.choices] + [("note", n) for n in self.notes]
        return "\n".join(f"{name:20}{text}" for name, text in rows)


def microstructure(images: Any, pixel_size: "Union[float, str, None]" = None, *, mask: Any = None,
                   polarity: str = "auto", background: str = "auto", background_scale: float = 0,
                   denoise: str = "auto", smooth: float = 0, fill_holes: bool = False, min_radius: float = 2,
                   correlation_radius: "Union[float, str, None]" = None, encoding: str = "linear",
                   resamples: int = 300, seed: int = 1, overlays: bool = True, scatterer: str = "auto",
                   int_ior: "Union[float, str, None]" = None) -> Microstructure:
    """Finds the scatterers in pictures of one sample and measures the parameters of a layer of them.

    Uneven illumination is corrected, touching particles are divided, and particles that the frame cuts are accounted
    for. See "From pictures to a material" in the documentation for the rules.

    Parameters
    ----------
    images : array_like (height, width) or (height, width, 3), Image, path-like, or a list of these
        Grey values proportional to the light.
    pixel_size : float or str, optional
        Side of a pixel in m, or with its unit ("0.2um"). Required unless the file states it (TIFF).
    mask : array_like of bool (height, width), or a list of them
        True where a picture counts; one for all, or one for each.
    polarity : {"auto", "dark", "bright"}
        Polarity of the particles relative to the ground.
    background : {"auto", "morphology", "none"}
        How uneven illumination is estimated: smooth levels of particles and of ground; opening and closing over
        `background_scale` pixels; not at all.
    background_scale : float
        In pixels, larger than particles; 0: chosen by their size.
    denoise : {"auto", "none", "gaussian", "median"}
    smooth : float
        Standard deviation in pixels of the Gaussian that is applied before outlines are found; 0: chosen by the
        noise.
    fill_holes : bool
        Whether particles with a centre as bright as the ground are filled.
    min_radius : float
        In pixels; smaller particles count as dirt.
    correlation_radius : float or str, optional
        Half the smallest distance of two centres, where it is known; by default it is fitted to g(r).
    encoding : {"linear", "srgb"}
        Encoding of the grey values.
    resamples, seed : int
        Number of resamples and seed of the bootstrap for the intervals.
    overlays : bool
        Whether pictures of the result are made.
    scatterer : {"auto", "apertures", "discs", "spheres"}
        Scatterers of the material: openings in an opaque sheet, opaque discs, transparent spheres; "auto": discs for
        dark particles, apertures for bright ones, with a note.
    int_ior : float or str, optional
        Index of refraction of spheres, which need it: a number or a material, such as "water".

    Returns
    -------
    Microstructure
        Print it; ``plot()`` draws it, ``material()`` is the layer for a scene.

    Examples
    --------
    >>> found = aureole.microstructure("slide.png", "0.2um")  # doctest: +SKIP
    >>> scene["glass.bsdf"] = found.material()  # doctest: +SKIP
    """
    given = list(images) if isinstance(images, (list, tuple)) and not _is_grey(images) else [images]
    if not given:
        raise Error("images: expected one or more pictures, got an empty list")
    pixel = 0.0 if pixel_size is None else _length("pixel_size", pixel_size)
    radius = 0.0 if correlation_radius is None else _length("correlation_radius", correlation_radius)
    srgb = _choice("encoding", encoding, ("linear", "srgb")) == 1
    masks = list(mask) if isinstance(mask, (list, tuple)) else [mask] * len(given)
    if len(masks) != len(given):
        raise Error(f"mask: expected one mask, or one for each of {len(given)} pictures, got {len(masks)}")
    scale = scalar("background_scale", background_scale, minimum=0, maximum=1e5, unit="pixels")
    way = _choice("background", background, ("auto", "morphology", "none"))
    if way == 1 and scale == 0:
        raise Error('background_scale: expected a length in pixels larger than the particles for '
                    'background="morphology", got 0')
    for name, flag in (("fill_holes", fill_holes), ("overlays", overlays)):
        if not isinstance(flag, (bool, np.bool_)):
            raise TypeError(f"{name}: expected True or False, got {flag!r}")
    names = [f"images[{k}]" if len(given) > 1 else "images" for k in range(len(given))]
    fields = [_field(name, one, pixel, its_mask, srgb) for name, one, its_mask in zip(names, given, masks)]
    try:
        result = _aureole.analyse_microstructure(
            fields, _choice("polarity", polarity, ("auto", "dark", "bright")), way, scale,
            _choice("denoise", denoise, ("auto", "none", "gaussian", "median")),
            scalar("smooth", smooth, minimum=0, maximum=20, unit="pixels"), bool(fill_holes),
            scalar("min_radius", min_radius, minimum=0.5, maximum=1e4, unit="pixels"), radius,
            integer("resamples", resamples, minimum=20, maximum=100_000),
            integer("seed", seed, minimum=0, maximum=2**64 - 1), srgb, bool(overlays),
            _choice("scatterer", scatterer, ("auto", "apertures", "discs", "spheres")),
            "" if int_ior is None else str(int_ior))
    except Error as e:
        raise type(e)(python_names(str(e))) from None
    return _described(result)


def _described(result: Any) -> Microstructure:
    numbers = result.numbers
    estimates = {name: Estimate(*value) for name, value in numbers.items()
                 if isinstance(value, tuple) and isinstance(value[0], float)}
    a = estimates["correlation_radius"].value
    r, g, g_error = (np.array(v, dtype=np.float64) for v in numbers["pair_correlation"])
    u, s, s_error = (np.array(v, dtype=np.float64) for v in numbers["structure_factor"])
    table = {name: np.array(values) for name, values in result.particles.items() if name != "outline"}
    outlines = [np.array(line, dtype=np.float64).reshape(-1, 2) for line in result.particles["outline"]]
    return Microstructure(
        **estimates, radius_quantiles={q: Estimate(*v) for q, v in numbers["radius_quantiles"].items()},
        round=numbers["round"], circularity=numbers["circularity"], aspect=numbers["aspect"],
        particles=Particles(**table, outline=outlines),
        pair_correlation=PairCorrelation(r * a, g, g_error, np.maximum(g - 1.96 * g_error, 0), g + 1.96 * g_error),
        structure_factor=PointStructureFactor(u / a, s, s_error, np.maximum(s - 1.96 * s_error, 0), s + 1.96 * s_error),
        overlays=[Image._of(p) for p in result.overlays], fields=numbers["fields"],
        choices=[python_names(c) for c in numbers["choices"]], notes=[python_names(n) for n in numbers["notes"]],
        scene_text=result.scene_text, _result=result)


def _is_grey(value: Any) -> bool:
    """A nested list of numbers, in place of an array."""
    while isinstance(value, (list, tuple)) and value:
        value = value[0]
    return isinstance(value, (int, float, np.number))


def _field(name: str, value: Any, pixel: float, mask: Any, srgb: bool) -> Any:
    seen = None
    if mask is not None:
        seen = np.asarray(mask)
        if seen.ndim != 2 or seen.dtype.kind not in "b":
            raise TypeError(f"mask: expected booleans of shape (height, width), got an array of {seen.dtype} of shape "
                            f"{seen.shape}")
        seen = np.ascontiguousarray(seen, dtype=np.uint8)
    if isinstance(value, (str, os.PathLike)):
        return _aureole.MicrographField.file(os.fspath(value), pixel, seen)
    if pixel == 0:
        raise Error(f'pixel_size: expected the side of a pixel in m, or with its unit such as "0.2um", for {name}, '
                    "which is no file")
    numbers = np.asarray(value)
    # Booleans are a picture that is segmented already.
    grey = real(name, numbers.astype(np.float64) if numbers.dtype.kind == "b" else numbers)
    if grey.ndim == 3 and grey.shape[2] in (1, 2, 3, 4):
        grey = grey[..., : 3 if grey.shape[2] >= 3 else 1]
        grey = np.mean(srgb_decode(np.clip(grey, 0, 1)) if srgb else grey, axis=2)
    elif grey.ndim == 2:
        grey = np.asarray(srgb_decode(np.clip(grey, 0, 1))) if srgb else grey
    else:
        raise Error(f"{name}: expected shape (height, width) or (height, width, channels), got {grey.shape}")
    if seen is not None and seen.shape != grey.shape:
        raise Error(f"mask: expected the shape of {name}, {grey.shape}, got {seen.shape}")
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(grey, dtype=np.float32)
    if not np.isfinite(single).all():
        raise Error(f"{name}: expected numbers that fit into single precision")
    return _aureole.MicrographField.array(name, single, pixel, seen)


def _length(name: str, value: Any) -> float:
    return length_m(name, value, minimum=1e-10, maximum=1)


def _choice(name: str, value: Any, names: Tuple[str, ...]) -> int:
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a string, got {type(value).__name__}")
    if value not in names:
        raise Error(f"{name}: expected one of {', '.join(names)}, got {value!r}")
    return names.index(value)


__all__ = ["Estimate", "Microstructure", "Particles", "microstructure"]
