# SPDX-License-Identifier: Apache-2.0
"""`spectrophotometer`, `spectroradiometer` and `convert_bsdf`: materials and lamps as instruments measure them, and files of them."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, flag, integer, real, scalar, text
from ._errors import Error
from ._instrument_support import Length, Words, axes_or_new, defines_of, tell
from ._results import Table
from ._units import length_m

Reals = npt.NDArray[np.float64]
_MOST_PATHS = 1 << 40


def target_of(target: Any) -> Any:
    """A BSDF, or the text scene.xml#id."""
    if isinstance(target, (str, os.PathLike)):
        return file_path("target", target)
    from ._plot_support import as_bsdf

    return as_bsdf(target)


def numbers_of(name: str, value: Any, count: Optional[int] = None, **limits: Any) -> List[float]:
    """The argument `name` as a list of numbers, of `count` where that is stated; None is an empty one."""
    if value is None:
        return []
    array = real(name, value, **limits)
    if array.ndim > 1 or (count is not None and array.size != count) or array.size > 100000:
        expected = f"{count} numbers" if count is not None else "a list of numbers"
        raise Error(f"{name}: expected {expected}, got an array of shape {array.shape}")
    return [float(v) for v in np.ravel(array)]


def trace_options(paths: Any, seed: Any, threads: Any) -> Dict[str, Any]:
    return {
        "paths": integer("paths", paths, minimum=1, maximum=_MOST_PATHS),
        "seed": integer("seed", seed, minimum=0, maximum=2**63 - 1),
        "threads": integer("threads", threads, minimum=0, maximum=4096),
    }


def band_options(wavelengths: Any, step: Any, bandwidth: Any) -> Dict[str, Any]:
    return {
        "range": numbers_of("range", wavelengths, 2, positive=True, unit="nm"),
        "step": scalar("step", step, minimum=0, maximum=1e9, unit="nm"),
        "bandwidth": scalar("bandwidth", bandwidth, minimum=0, maximum=1e9, unit="nm"),
    }


@dataclass(frozen=True, eq=False)
class MeasuredSpectrum(Table):
    """Result of `spectrophotometer`, arrays over wavelengths.

    Attributes
    ----------
    wavelength : numpy.ndarray
        In nm.
    values : numpy.ndarray
        Reflectance factor, or transmittance.
    uncertainty : numpy.ndarray
        Standard uncertainty of the values, all causes together.
    causes : dict of str to numpy.ndarray
        Standard uncertainties by cause: "tracing", "detector", "standard", "wavelength".
    geometry : str
        Name of CIE 15, such as "de:8".
    transmission : bool
        Whether the values are transmittances.
    name : str
        Of the material.
    edge_loss : numpy.ndarray or None
        Part of the light that a wide port would read which is lost beside the lit area, as diffusion predicts it; None unless a
        slab of a homogeneous medium was measured in reflection.
    """

    wavelength: Reals
    values: Reals
    uncertainty: Reals
    causes: Dict[str, Reals] = field(repr=False)
    geometry: str
    transmission: bool
    name: str
    edge_loss: Optional[Reals]

    def columns(self) -> Dict[str, Any]:
        """Wavelength in nm, the values, their standard uncertainty and its causes."""
        causes = {f"u_{name}": errors for name, errors in self.causes.items()}
        return {"wavelength_nm": self.wavelength, "value": self.values, "uncertainty": self.uncertainty, **causes}

    def plot(self, ax: Any = None) -> Any:
        """The spectrum with two standard uncertainties.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        (line,) = axes.plot(self.wavelength, self.values, label=f"{self.name}, {self.geometry}")
        low, high = self.values - 2 * self.uncertainty, self.values + 2 * self.uncertainty
        axes.fill_between(self.wavelength, low, high, color=line.get_color(), alpha=0.25)
        axes.set(xlabel="wavelength [nm]", ylabel="transmittance" if self.transmission else "reflectance factor")
        axes.legend()
        return axes

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes a file that `pigment` and `color` read.

        Parameters
        ----------
        path : path-like
            Ending .csv, .cxf (CxF 3) or .cgats (CGATS.17).
        """
        with Words():
            _aureole.spectrum_file(
                file_path("path", path), self.wavelength.tolist(), self.values.tolist(), self.name, self.transmission, self.geometry
            )

    def _title(self) -> str:
        return f"{self.name}: {'transmittance' if self.transmission else 'reflectance factor'} at {self.geometry}"


@dataclass(frozen=True, eq=False)
class GlossAndHaze(Table):
    """Result of `spectrophotometer` with `gloss` or `haze`.

    Attributes
    ----------
    gloss : dict of float to (float, float)
        Gloss units and their standard error by the angle in degrees; black glass of index 1.567 has 100.
    total_transmittance, haze : (float, float) or None
        With their standard errors; haze is the part of the transmitted light beyond `haze_angle`.
    haze_angle : float
        In degrees.
    """

    gloss: Dict[float, Tuple[float, float]]
    total_transmittance: Optional[Tuple[float, float]]
    haze: Optional[Tuple[float, float]]
    haze_angle: float

    def columns(self) -> Dict[str, Any]:
        """A row for each figure with its standard error."""
        rows = [(f"gloss at {angle:g} degrees", *g) for angle, g in self.gloss.items()]
        if self.haze is not None and self.total_transmittance is not None:
            rows += [("total transmittance", *self.total_transmittance), (f"haze beyond {self.haze_angle:g} degrees", *self.haze)]
        return {name: [row[k] for row in rows] for k, name in enumerate(("figure", "value", "error"))}

    def plot(self, ax: Any = None) -> Any:
        """The figures as bars with two standard errors.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        c = self.columns()
        axes.bar(c["figure"], c["value"], yerr=2 * np.asarray(c["error"]))
        axes.set(ylabel="gloss units, fractions")
        return axes


def spectrophotometer(
    target: Any,
    geometry: str = "45a:0",
    *,
    transmission: bool = False,
    method: str = "comparison",
    theory: bool = False,
    pooled: bool = False,
    range: Sequence[float] = (400, 700),
    step: float = 10,
    bandwidth: float = 0,
    correct_bandwidth: bool = False,
    aperture: Optional[Length] = None,
    lit: Optional[Length] = None,
    sample_size: Length = "60mm",
    thickness: Optional[Length] = None,
    sphere: Length = "150mm",
    port: Length = "25mm",
    wall: float = 0.97,
    specular_port: float = 0,
    lamp_angle: Optional[float] = None,
    detector_angle: float = 2,
    azimuth: float = 0,
    standard: float = 0.99,
    standard_error: float = 0,
    noise: float = 0,
    dark_noise: float = 0,
    wavelength_error: float = 0,
    haze: float = 0,
    gloss: Sequence[float] = (),
    paths: int = 65536,
    seed: int = 0,
    threads: int = 0,
    name: str = "",
    defines: Optional[Mapping[str, Any]] = None,
) -> "Union[MeasuredSpectrum, GlossAndHaze]":
    """Reflectance factor, transmittance, haze and gloss as a traced instrument measures them: `aureole spectrophotometer`.

    Parameters
    ----------
    target : Bsdf, or str or path
        A BSDF, or "scene.xml#id" with the id of a BSDF or of a shape, whose medium becomes a slab.
    geometry : str
        Of CIE 15: 45a:0 45x:0 0:45a 0:45x di:8 de:8 8:di 8:de d:0 d:d; with `transmission` 0:0 di:0 de:0 0:di 0:de d:d.
    transmission : bool
    method : {"comparison", "substitution", "absolute"}
        How a reading becomes a reflectance (docs/laboratory.md).
    theory : bool
        The sphere in closed form: faster, without its uneven light.
    pooled : bool
        The departure of a traced sphere from theory is fitted over the wavelengths: less noise.
    range : (float, float)
        First and last wavelength in nm.
    step, bandwidth : float
        In nm; a bandwidth of 0 is the step.
    correct_bandwidth : bool
        Subtract the effect of the bandwidth (Stearns and Stearns 1988).
    aperture, lit : float or str, optional
        Diameters of the viewed area (by default 8 mm) and of the lit one (by default 4 mm more), in m or with their unit. Of `haze`
        both are 2 mm where neither is stated.
    sample_size, sphere, port : float or str
        Extent of the sample, diameters of the sphere and of the sample's port, in m or with their unit.
    thickness : float or str, optional
        Of the slab; by default the shape's smallest extent.
    wall, standard : float
        Reflectances of the sphere's wall and of the Lambertian standard.
    specular_port : float
        Half-angle in degrees; 0: as the mirrored beam needs.
    lamp_angle, detector_angle : float
        Half of the angles under which the sample sees lamp (by default 3.5, of `haze` 0.1) and detector, in degrees.
    azimuth : float
        Of the lamp or detector of 45x, in degrees.
    standard_error, noise, dark_noise, wavelength_error : float
        Standard uncertainties: of the standard (relative), of the detector at the standard's signal and without light (relative to
        it), of the wavelengths in nm.
    haze : float
        Not 0: measure total transmittance and haze beyond this angle in degrees (ASTM D1003: 2.5) instead.
    gloss : list of float
        Not empty: measure gloss units at these of 20, 60 and 85 degrees (ISO 2813) instead.
    paths, seed, threads : int
        Paths for each detector, seed of paths and noise, threads (0: all cores).
    name : str
        Of the sample; by default the id.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    MeasuredSpectrum or GlossAndHaze
    """
    options: Dict[str, Any] = {
        "geometry": text("geometry", geometry),
        "transmission": flag("transmission", transmission),
        "method": text("method", method),
        "theory": flag("theory", theory),
        "pooled": flag("pooled", pooled),
        "correct_bandwidth": flag("correct_bandwidth", correct_bandwidth),
        "aperture": np.nan if aperture is None else length_m("aperture", aperture, example="8mm"),
        "lit": np.nan if lit is None else length_m("lit", lit, example="12mm"),
        "sample_size": length_m("sample_size", sample_size, example="60mm"),
        "thickness": thickness_of(thickness),
        "sphere": length_m("sphere", sphere, example="150mm"),
        "port": length_m("port", port, example="25mm"),
        "specular_port": scalar("specular_port", specular_port, minimum=0, maximum=20, unit="degrees"),
        "haze": scalar("haze", haze, minimum=0, maximum=10, unit="degrees"),
        "gloss": numbers_of("gloss", gloss),
        **trace_options(paths, seed, threads),
        **band_options(range, step, bandwidth),
    }
    for key, value in (
        ("wall", wall),
        ("detector_angle", detector_angle),
        ("azimuth", azimuth),
        ("standard", standard),
        ("standard_error", standard_error),
        ("noise", noise),
        ("dark_noise", dark_noise),
        ("wavelength_error", wavelength_error),
    ):
        options[key] = scalar(key, value, minimum=-36000, maximum=36000)
    options["lamp_angle"] = np.nan if lamp_angle is None else scalar("lamp_angle", lamp_angle, minimum=-36000, maximum=36000)
    called = text("name", name)
    where = target_of(target)
    with Words():
        found = _aureole.spectrophotometer(where, defines_of(defines), options)
    tell(found["notes"])
    if options["haze"] > 0 or options["gloss"]:
        total, total_error, part, part_error = found["haze"]
        return GlossAndHaze(
            {angle: (units, error) for angle, units, error in found["gloss"]},
            (total, total_error) if options["haze"] > 0 else None,
            (part, part_error) if options["haze"] > 0 else None,
            options["haze"],
        )
    causes = {cause: np.array(errors) for cause, errors in found["uncertainty"].items()}
    return MeasuredSpectrum(
        np.array(found["nm"]),
        np.array(found["values"]),
        np.sqrt(sum((errors**2 for errors in causes.values()), np.zeros(len(found["nm"])))),
        causes,
        options["geometry"],
        options["transmission"],
        called or (where.rpartition("#")[2] if isinstance(where, str) else type(where).__name__),
        np.array(found["edge_loss"]) if found["edge_loss"] else None,
    )


def thickness_of(thickness: Optional[Length]) -> float:
    if thickness is None:
        return 0.0
    metres = length_m("thickness", thickness, example="2mm")
    if not metres > 0:
        raise Error("thickness: expected a positive length")
    return metres


@dataclass(frozen=True, eq=False)
class RadiometerReading(Table):
    """Result of `spectroradiometer`, arrays over the pixels of the array.

    Attributes
    ----------
    wavelength : numpy.ndarray
        By the calibrated scale, in nm.
    values, truth : numpy.ndarray
        What is read, and the spectrum itself at these wavelengths, in the unit of the lamp or the picture.
    xy, true_xy : (float, float)
        CIE 1931 chromaticities of both.
    scale_residual : float
        Root of the mean square of the deviations of the calibration lines, in nm.
    mean_deviation : float
        Mean of |values - truth| over the mean of `truth`.
    """

    wavelength: Reals
    values: Reals
    truth: Reals
    xy: Tuple[float, float]
    true_xy: Tuple[float, float]
    scale_residual: float
    mean_deviation: float

    def columns(self) -> Dict[str, Any]:
        """Wavelength in nm, what is read, and the spectrum itself."""
        return {"wavelength_nm": self.wavelength, "value": self.values, "truth": self.truth}

    def plot(self, ax: Any = None) -> Any:
        """Both spectra.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        axes.plot(self.wavelength, self.truth, color="0.6", label="the spectrum itself")
        axes.plot(self.wavelength, self.values, label="read")
        axes.set(xlabel="wavelength [nm]", ylabel="spectral power")
        axes.legend()
        return axes

    def _title(self) -> str:
        return f"x {self.xy[0]:.5f}, y {self.xy[1]:.5f}; the spectrum itself x {self.true_xy[0]:.5f}, y {self.true_xy[1]:.5f}"


def spectroradiometer(
    target: "str | os.PathLike[str]",
    *,
    pixel: Optional[Sequence[int]] = None,
    region: Optional[Sequence[int]] = None,
    range: Sequence[float] = (350, 850),
    pixels: int = 512,
    slit: float = 4,
    curvature: float = 4,
    scattered: float = 3e-3,
    halo: float = 3e-3,
    electrons: float = 1e6,
    read_noise: float = 10,
    lines: Optional[Sequence[float]] = None,
    keep_stray: bool = False,
    deconvolve: int = 0,
    seed: int = 0,
) -> RadiometerReading:
    """A lamp or pixels of a spectral picture as an array spectroradiometer reads them: `aureole spectroradiometer`.

    Parameters
    ----------
    target : str or path
        An illuminant ("A", "FL11"), a lamp's file of wavelengths and powers, or a spectral picture (.exr).
    pixel : (int, int), optional
        x and y of one pixel of the picture.
    region : (int, int, int, int), optional
        x, y, width and height of a part of the picture; by default all of it.
    range : (float, float)
        Wavelengths of the first and the last pixel of the array in nm.
    pixels : int
        Of the array.
    slit, curvature : float
        Full width of the slit function at half maximum, and how far the middle pixel is off a linear scale, in nm.
    scattered, halo : float
        Fractions of the light that are scattered evenly over the array, and into a halo of 40 nm.
    electrons, read_noise : float
        Signal of the brightest pixel (0: no noise), and noise of reading a pixel, in electrons.
    lines : list of float, optional
        Wavelengths of the calibration lamp in nm; by default those of mercury and argon.
    keep_stray : bool
        Do not correct stray light.
    deconvolve : int
        Iterations of Richardson and Lucy against the slit function.
    seed : int
        Of the noise.

    Returns
    -------
    RadiometerReading
    """
    options: Dict[str, Any] = {
        "target": file_path("target", target),
        "pixel": numbers_of("pixel", pixel, 2, minimum=0, maximum=1e8),
        "region": numbers_of("region", region, 4, minimum=0, maximum=1e8),
        "range": numbers_of("range", range, 2, positive=True, unit="nm"),
        "lines": numbers_of("lines", lines, positive=True, maximum=1e7, unit="nm"),
        "pixels": integer("pixels", pixels, minimum=8, maximum=4096),
        "keep_stray": flag("keep_stray", keep_stray),
        "deconvolve": integer("deconvolve", deconvolve, minimum=0, maximum=10000),
        "seed": integer("seed", seed, minimum=0, maximum=2**63 - 1),
    }
    for key, value in (
        ("slit", slit),
        ("curvature", curvature),
        ("scattered", scattered),
        ("halo", halo),
        ("electrons", electrons),
        ("read_noise", read_noise),
    ):
        options[key] = scalar(key, value, minimum=-1e15, maximum=1e15)
    with Words():
        found = _aureole.spectroradiometer(options)
    tell(found["notes"])
    return RadiometerReading(
        np.array(found["nm"]),
        np.array(found["values"]),
        np.array(found["truth"]),
        (found["xy"][0], found["xy"][1]),
        (found["true_xy"][0], found["true_xy"][1]),
        found["residual"],
        found["deviation"],
    )


@dataclass(frozen=True, eq=False)
class ConvertedBsdf(Table):
    """Result of `convert_bsdf`: what was written, and the faults of the material as a table.

    Attributes
    ----------
    path, format : str
        The file, and its format: "rgl", "klems", "tensor_tree", "csv" or "zemax".
    type : str
        Plug-in of the BSDF.
    bytes : int
        Size of the file.
    angle : numpy.ndarray
        Angles of incidence in degrees.
    reflected, transmitted : numpy.ndarray
        Fractions of the light, the largest over the wavelengths.
    mean_asymmetry, largest_asymmetry : float
        Of |f(i, o) - f(o, i)| / (f(i, o) + f(o, i)).
    is_isotropic : bool
    """

    path: str
    format: str
    type: str
    bytes: int
    angle: Reals
    reflected: Reals
    transmitted: Reals
    mean_asymmetry: float
    largest_asymmetry: float
    is_isotropic: bool

    def columns(self) -> Dict[str, Any]:
        """Angle of incidence in degrees and fractions of the light."""
        return {"angle_deg": self.angle, "reflected": self.reflected, "transmitted": self.transmitted}

    def plot(self, ax: Any = None) -> Any:
        """Energy over the angle of incidence.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        axes.plot(self.angle, self.reflected, label="reflected")
        axes.plot(self.angle, self.transmitted, label="transmitted")
        axes.set(xlabel="angle of incidence [degrees]", ylabel="fraction of the light", ylim=(0, None))
        axes.legend()
        return axes

    def _title(self) -> str:
        return f"{self.path} ({self.format}, {self.bytes} bytes): asymmetry {100 * self.mean_asymmetry:.2f} % on average"


def convert_bsdf(
    target: Any,
    path: "str | os.PathLike[str]",
    *,
    format: str = "",
    range: Optional[Sequence[float]] = None,
    step: float = 0,
    angles: int = 0,
    azimuths: int = 0,
    resolution: int = 0,
    normals: int = 128,
    basis: str = "full",
    samples: int = 0,
    tolerance: float = 0.05,
    description: str = "",
    make_reciprocal: bool = False,
    defines: Optional[Mapping[str, Any]] = None,
) -> ConvertedBsdf:
    """Writes a material or a measured file in a format of measured BSDFs: `aureole convert-bsdf`.

    Parameters
    ----------
    target : Bsdf, or str or path
        A BSDF, "scene.xml#id", or a measured file: .bsdf, .binary (MERL), .xml (WINDOW, Radiance), .csv.
    path : str or path
        File to write: .bsdf (RGL), .xml (Klems, or a tensor tree) or .csv (directions).
    format : {"", "rgl", "klems", "tensor_tree", "csv", "zemax"}
        By default as the ending says.
    range : (float, float), optional
        First and last wavelength in nm; by default the material's.
    step : float
        Largest step between wavelengths in nm; 0: 20.
    angles, azimuths : int
        Of incidence; 0: as format and material need.
    resolution, normals : int
        Rows and columns of spectra of .bsdf (0: 32), or cells along each axis of a tree (0: 64, anisotropic 16); nodes of the
        distribution of normals of .bsdf.
    basis : {"full", "half", "quarter"}
        Klems' angle basis.
    samples : int
        For each incident patch; 0: 1024, of trees 4096.
    tolerance : float
        Cells of a tree that differ by less are merged.
    description : str
        Name of the material in the file.
    make_reciprocal : bool
        Write the mean of both directions of light.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    ConvertedBsdf
    """
    options: Dict[str, Any] = {
        "format": text("format", format),
        "range": numbers_of("range", range, 2, positive=True, unit="nm"),
        "step": scalar("step", step, minimum=0, maximum=1e9, unit="nm"),
        "angles": integer("angles", angles, minimum=0, maximum=90),
        "azimuths": integer("azimuths", azimuths, minimum=0, maximum=73),
        "resolution": integer("resolution", resolution, minimum=0, maximum=256),
        "normals": integer("normals", normals, minimum=16, maximum=1024),
        "basis": text("basis", basis),
        "samples": integer("samples", samples, minimum=0, maximum=1 << 22),
        "tolerance": scalar("tolerance", tolerance, minimum=0, maximum=10),
        "description": text("description", description),
        "make_reciprocal": flag("make_reciprocal", make_reciprocal),
    }
    for name, least in (("angles", 3), ("resolution", 4), ("samples", 16)):
        if 0 < options[name] < least:
            raise Error(f"{name}: expected 0 or at least {least}, got {options[name]}")
    if options["basis"] not in ("full", "half", "quarter"):
        raise Error(f'basis: expected "full", "half" or "quarter", got {basis!r}')
    output = file_path("path", path)
    where = target_of(target)
    with Words():
        found = _aureole.convert_bsdf(where, output, defines_of(defines), options)
    tell(found["notes"])
    return ConvertedBsdf(
        output,
        found["format"],
        found["type"],
        found["bytes"],
        np.array(found["angle"]),
        np.array(found["reflected"]),
        np.array(found["transmitted"]),
        found["mean_asymmetry"],
        found["largest_asymmetry"],
        found["is_isotropic"],
    )


__all__ = ["ConvertedBsdf", "GlossAndHaze", "MeasuredSpectrum", "RadiometerReading", "convert_bsdf", "spectrophotometer", "spectroradiometer"]
