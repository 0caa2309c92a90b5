# SPDX-License-Identifier: Apache-2.0
"""`goniometer`: scattering by direction as a traced goniometer measures it, fits of analytic models, reflectances, plots."""

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
from ._laboratory import band_options, numbers_of, target_of, thickness_of, trace_options
from ._results import Table
from ._units import length_m

Reals = npt.NDArray[np.float64]
Value = Tuple[float, float]


@dataclass(frozen=True, eq=False)
class BrdfFit(Table):
    """An analytic model fitted to a goniometer's readings.

    Attributes
    ----------
    model : str
        Such as "ggx"; all are in `GoniometerData.models()`.
    parameters : dict of str to (float, float, float)
        Value and confidence interval of 95 %; a parameter at its bound has none.
    aic : float
        Akaike's criterion, chi^2 + 2 k: the best model has the least.
    chi_squared : float
        Sum of squares of residuals over uncertainties.
    readings : int
    rms, largest : float
        Root of the mean square of the residuals, and the largest one, in 1/sr.
    bsdf : str
        The model as a <bsdf> element, for `load_string` and scene files.
    """

    model: str
    parameters: Dict[str, Tuple[float, float, float]]
    aic: float
    chi_squared: float
    readings: int
    rms: float
    largest: float
    bsdf: str = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """A row for each parameter."""
        rows = [(name, *values) for name, values in self.parameters.items()]
        return {name: [row[k] for row in rows] for k, name in enumerate(("parameter", "value", "low", "high"))}

    def _title(self) -> str:
        return f"{self.model}: AIC {self.aic:.6g}, chi^2/n {self.chi_squared / max(self.readings, 1):.4g}, rms {self.rms:.4g} 1/sr"


@dataclass(frozen=True, eq=False)
class GoniometerData(Table):
    """Result of `goniometer`, arrays over pairs of directions.

    Attributes
    ----------
    wavelength : numpy.ndarray, shape (bands,)
        In nm.
    theta_i, phi_i, theta_o, phi_o : numpy.ndarray, shape (pairs,)
        Angles in degrees from the normal and from dp/du; theta_o above 90 is transmitted.
    f, uncertainty : numpy.ndarray, shape (pairs, bands)
        BRDF or BTDF in 1/sr, and its standard uncertainty.
    lamp_angle, detector_angle : float
        Half-angles of the cones in degrees, over which fits average their models.
    aperture : float
        Diameter of the viewed area in m, over which they average them, too.
    """

    wavelength: Reals
    theta_i: Reals
    phi_i: Reals
    theta_o: Reals
    phi_o: Reals
    f: Reals = field(repr=False)
    uncertainty: Reals = field(repr=False)
    lamp_angle: float
    detector_angle: float
    aperture: float = 0

    def columns(self) -> Dict[str, Any]:
        """Angles in degrees, f by wavelength in 1/sr, and its standard uncertainty, as the BSDF `tabulated` reads them."""
        names = [f"{nm:.10g}nm" for nm in self.wavelength]
        return {
            "theta_i": self.theta_i,
            "phi_i": self.phi_i,
            "theta_o": self.theta_o,
            "phi_o": self.phi_o,
            **{name: self.f[:, k] for k, name in enumerate(names)},
            **{f"u({name})": self.uncertainty[:, k] for k, name in enumerate(names)},
        }

    @staticmethod
    def models() -> List[str]:
        """Names of the models that `fit` knows."""
        return list(_aureole.brdf_models())

    def fit(self, models: Optional[Sequence[str]] = None) -> List[BrdfFit]:
        """Fits analytic models (Marquardt 1963), in the order of Akaike's criterion (Akaike 1974).

        Parameters
        ----------
        models : list of str, optional
            By default all of `models()`.

        Returns
        -------
        list of BrdfFit
        """
        if isinstance(models, str):
            raise TypeError("models: expected a list of strings, got a string")
        names = [text("models", name) for name in ([] if models is None else models)]
        options = {
            **{name: getattr(self, name).tolist() for name in ("theta_i", "phi_i", "theta_o", "phi_o")},
            "nm": self.wavelength.tolist(),
            "f": self.f.ravel().tolist(),
            "error": self.uncertainty.ravel().tolist(),
            "models": names,
            "lamp_angle": self.lamp_angle,
            "detector_angle": self.detector_angle,
            "aperture": self.aperture,
        }
        with Words():
            found = _aureole.goniometer_fits(options)
        return [
            BrdfFit(f["model"], f["parameters"], f["aic"], f["chi_squared"], f["readings"], f["rms"], f["largest"], f["bsdf"]) for f in found
        ]

    def _mean(self, wavelength: Optional[float]) -> Reals:
        if wavelength is None:
            return np.asarray(self.f.mean(axis=1))
        nm = scalar("wavelength", wavelength, positive=True, unit="nm")
        return np.asarray(self.f[:, int(np.argmin(np.abs(self.wavelength - nm)))])

    def _in_plane(self, incidence: float) -> Tuple[Reals, "npt.NDArray[np.bool_]"]:
        """Angles in the plane of incidence, negative on the lamp's side, and which pairs lie in it."""
        relative = (self.phi_o - self.phi_i) % 360
        near = (relative < 0.5) | (relative > 359.5)
        far = np.abs(relative - 180) < 0.5
        at_normal = (self.theta_o == 0) | (self.theta_o == 180)
        chosen = (near | far | at_normal) & (self.theta_i == incidence) & (self.phi_i == self.phi_i[0])
        return np.where(near & ~at_normal, -self.theta_o, self.theta_o), chosen

    def plot(
        self,
        ax: Any = None,
        *,
        kind: str = "slice",
        incidence: Optional[float] = None,
        wavelength: Optional[float] = None,
        log: bool = False,
    ) -> Any:
        """Lobes: over the angle in the plane of incidence, as polar curves, or as surfaces.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Polar ones for "polar", three-dimensional ones for "3d".
        kind : {"slice", "polar", "3d", "map"}
            f over the angle with two standard uncertainties; f as the distance from the origin in the plane of incidence; all
            directions of one incidence, at the distance f; f in colours over the disc of projected directions.
        incidence : float, optional
            Angle of incidence in degrees, one that was measured; by default all ("3d" and "map": the middle one).
        wavelength : float, optional
            In nm, the nearest band; by default the mean of all.
        log : bool
            "slice" and "map": f on a logarithmic scale; "polar" and "3d": distances grow with the cube root of f.

        Returns
        -------
        matplotlib Axes
        """
        if text("kind", kind) not in ("slice", "polar", "3d", "map"):
            raise Error(f'kind: expected "slice", "polar", "3d" or "map", got {kind!r}')
        logarithmic = flag("log", log)
        measured = np.unique(self.theta_i)
        if not measured.size:
            raise Error("the table has no readings")
        if incidence is not None:
            angle = scalar("incidence", incidence, unit="degrees")
            nearest = measured[np.argmin(np.abs(measured - angle))]
            if abs(nearest - angle) > 1e-6:
                shown = ", ".join(f"{a:g}" for a in measured)
                raise Error(f"incidence: {angle:g} degrees were not measured; there are {shown}")
            measured = np.array([nearest])
        f = self._mean(wavelength)
        if kind in ("3d", "map"):
            return self._whole(ax, kind, float(measured[len(measured) // 2]), f, logarithmic)
        axes = _axes(ax, "polar" if kind == "polar" else "")
        error = np.sqrt(np.mean(self.uncertainty**2, axis=1))
        for i in measured:
            angles, chosen = self._in_plane(float(i))
            order = np.argsort(angles[chosen])
            x, y, e = angles[chosen][order], f[chosen][order], error[chosen][order]
            label = f"incidence {i:g} degrees"
            if kind == "polar":
                (line,) = axes.plot(np.radians(x), np.cbrt(y) if logarithmic else y, label=label)
                axes.axvline(-np.radians(i), color=line.get_color(), linestyle=":")
            else:
                (line,) = axes.plot(x, y, label=label)
                axes.fill_between(x, y - 2 * e, y + 2 * e, color=line.get_color(), alpha=0.25)
        if kind == "polar":
            axes.set_theta_zero_location("N")
            axes.set_theta_direction(-1)
            if np.all(self.theta_o <= 90):
                axes.set_thetalim(-np.pi / 2, np.pi / 2)
            axes.set_rticks(np.linspace(0, axes.get_rmax(), 4)[1:].round(2))
            axes.set_title("f [1/sr]" + (", cube root" if logarithmic else ""))
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.02), fontsize="small", ncols=2)
            return axes
        axes.set(xlabel="angle in the plane of incidence [degrees]", ylabel="f [1/sr]")
        if logarithmic:
            axes.set_yscale("log")
        axes.legend()
        return axes

    def _whole(self, ax: Any, kind: str, incidence: float, f: Reals, logarithmic: bool) -> Any:
        chosen = (self.theta_i == incidence) & (self.phi_i == self.phi_i[0])
        reflected = chosen & (self.theta_o <= 90)
        if np.count_nonzero(reflected) < 4:
            raise Error(f"{kind}: expected at least 4 directions of reflection; a hemispherical plan has them")
        theta, phi = np.radians(self.theta_o[reflected]), np.radians(self.phi_o[reflected])
        values = np.maximum(f[reflected], 0)
        if kind == "map":
            axes = _axes(ax, "")
            x, y = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
            shown = np.log10(np.maximum(values, 1e-9 * max(values.max(), 1e-30))) if logarithmic else values
            if np.ptp(y) < 1e-9 or np.ptp(x) < 1e-9:
                raise Error("map: expected directions outside of one plane; a hemispherical plan has them")
            drawn = axes.tricontourf(x, y, shown, levels=32)
            axes.figure.colorbar(drawn, ax=axes, label="log10 f [1/sr]" if logarithmic else "f [1/sr]")
            at = np.radians(self.phi_i[reflected][0])
            axes.plot(np.sin(np.radians(incidence)) * np.cos(at), np.sin(np.radians(incidence)) * np.sin(at), "w+")
            axes.set(xlabel="x of the direction", ylabel="y of the direction", title=f"incidence {incidence:g} degrees", aspect="equal")
            return axes
        axes = _axes(ax, "3d")
        r = np.cbrt(values) if logarithmic else values
        x, y, z = r * np.sin(theta) * np.cos(phi), r * np.sin(theta) * np.sin(phi), r * np.cos(theta)
        from matplotlib.tri import Triangulation

        # Triangles of the directions, projected to the disc.
        triangles = Triangulation(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)).triangles
        axes.plot_trisurf(x, y, z, triangles=triangles, cmap="viridis", linewidth=0.1, edgecolor="0.4")
        top, at = float(r.max()), np.radians(self.phi_i[reflected][0])
        i = np.radians(incidence)
        axes.plot([0, top * np.sin(i) * np.cos(at)], [0, top * np.sin(i) * np.sin(at)], [0, top * np.cos(i)], color="r", label="light")
        axes.set(xlabel="x", ylabel="y", zlabel="f [1/sr]" + (", cube root" if logarithmic else ""), title=f"incidence {incidence:g} degrees")
        axes.set_box_aspect((np.ptp(x) or 1, np.ptp(y) or 1, np.ptp(z) or 1))
        axes.legend()
        return axes

    def _title(self) -> str:
        return f"{len(self.theta_i)} pairs of directions, {len(self.wavelength)} wavelengths"


def _axes(ax: Any, projection: str) -> Any:
    from ._plot_support import matplotlib

    if projection != "3d":
        from ._plot_support import axes_for

        return axes_for(ax, polar=projection == "polar") if projection else axes_or_new(ax)
    mpl = matplotlib()
    if ax is None:
        return mpl.pyplot.subplots(subplot_kw={"projection": "3d"}, layout="constrained")[1]
    if not isinstance(ax, mpl.axes.Axes):
        raise TypeError(f"ax: expected axes of matplotlib, got {type(ax).__name__}")
    if ax.name != "3d":
        raise Error(f"ax: expected three-dimensional axes (subplot_kw={{'projection': '3d'}}), got {ax.name} ones")
    return ax


@dataclass(frozen=True, eq=False)
class Reflectances(Table):
    """Result of `goniometer_report`. Pairs (value, standard error).

    Attributes
    ----------
    angle : numpy.ndarray
        In degrees.
    rho_dh, rho_hd : numpy.ndarray, shape (angles, 2)
        Directional-hemispherical and hemispherical-directional reflectance.
    rho_hh : (float, float)
        Hemispherical-hemispherical (bihemispherical) reflectance.
    reciprocity : list of (float, float, (float, float), (float, float))
        Two angles in degrees, f(i, o) and f(o, i) in 1/sr.
    turns : numpy.ndarray, shape (turns, 3)
        Azimuth of the sample in degrees, f and its standard error.
    anisotropy : float
        Largest difference of f over its mean when the sample turns.
    is_isotropic : bool
        Whether this is within the errors.
    of_light : (float, float) or None
        Part of the light of the stated distribution that is scattered, E_o/E_i.
    cones : list of (float, float, float, float, (float, float), float)
        theta_i, half_i, theta_o, half_o in degrees, the biconical reflectance, and the reflectance factor.
    """

    angle: Reals
    rho_dh: Reals
    rho_hd: Reals
    rho_hh: Value
    reciprocity: List[Tuple[float, float, Value, Value]]
    turns: Reals
    anisotropy: float
    is_isotropic: bool
    of_light: Optional[Value]
    cones: List[Tuple[float, float, float, float, Value, float]]

    def columns(self) -> Dict[str, Any]:
        """Reflectances by angle with their standard errors."""
        return {
            "angle_deg": self.angle,
            "rho_dh": self.rho_dh[:, 0],
            "u_rho_dh": self.rho_dh[:, 1],
            "rho_hd": self.rho_hd[:, 0],
            "u_rho_hd": self.rho_hd[:, 1],
        }

    def plot(self, ax: Any = None) -> Any:
        """Reflectances over the angle with two standard errors.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        axes.errorbar(self.angle, self.rho_dh[:, 0], 2 * self.rho_dh[:, 1], label="directional-hemispherical")
        axes.errorbar(self.angle, self.rho_hd[:, 0], 2 * self.rho_hd[:, 1], label="hemispherical-directional")
        axes.axhline(self.rho_hh[0], color="0.5", linestyle=":", label="hemispherical-hemispherical")
        axes.set(xlabel="angle [degrees]", ylabel="reflectance")
        axes.legend()
        return axes

    def _title(self) -> str:
        turned = "isotropic within the errors" if self.is_isotropic else "anisotropic"
        return f"rho_hh {self.rho_hh[0]:.5f} +- {self.rho_hh[1]:.5f}; turning changes f by {100 * self.anisotropy:.2f} %: {turned}"


def _options(
    lamp_angle: Any,
    detector_angle: Any,
    aperture: Any,
    lit: Any,
    sample_size: Any,
    thickness: Any,
    range: Any,
    step: Any,
    bandwidth: Any,
    paths: Any,
    seed: Any,
    threads: Any,
    reference: Any = False,
    **numbers: Any,
) -> Dict[str, Any]:
    viewed = length_m("aperture", aperture, example="10mm")
    options: Dict[str, Any] = {
        "aperture": viewed,
        "lit": 2 * viewed if lit is None else length_m("lit", lit, example="20mm"),
        "sample_size": length_m("sample_size", sample_size, example="60mm"),
        "thickness": thickness_of(thickness),
        "reference": flag("reference", reference),
        **trace_options(paths, seed, threads),
        **band_options(range, step, bandwidth),
    }
    values = {"lamp_angle": lamp_angle, "detector_angle": detector_angle, "standard": 0.99, "noise": 0, "dark_noise": 0, "angle_error": 0}
    for name, value in {**values, **numbers}.items():
        options[name] = scalar(name, value, minimum=0, maximum=1e9)
    return options


def goniometer(
    target: Any,
    *,
    plan: str = "hemispherical",
    incident: Sequence[float] = (0, 15, 30, 45, 60, 75),
    azimuths: Sequence[float] = (0,),
    directions: int = 200,
    transmission: bool = False,
    reference: bool = False,
    standard: float = 0.99,
    lamp_angle: Optional[float] = None,
    detector_angle: Optional[float] = None,
    aperture: Optional[Length] = None,
    lit: Optional[Length] = None,
    sample_size: Length = "60mm",
    thickness: Optional[Length] = None,
    noise: float = 0,
    dark_noise: float = 0,
    angle_error: float = 0,
    range: Sequence[float] = (400, 700),
    step: float = 20,
    bandwidth: float = 0,
    paths: int = 512,
    seed: int = 0,
    threads: int = 0,
    defines: Optional[Mapping[str, Any]] = None,
) -> GoniometerData:
    """Scattering by direction as a traced goniometer measures it: `aureole goniometer`.

    Parameters
    ----------
    target : Bsdf, or str or path
        A BSDF, "scene.xml#id" with the id of a BSDF or a shape, or a table (.csv) of a goniometer.
    plan : {"hemispherical", "in_plane", "adaptive"}
    incident, azimuths : list of float
        Angles and azimuths of incidence in degrees; several azimuths turn the sample.
    directions : int
        Detectors for each direction of incidence and side.
    transmission : bool
        Also measure below the sample.
    reference : bool
        Compare with a Lambertian standard of reflectance `standard`; else the irradiance is measured.
    lamp_angle, detector_angle : float, optional
        Half of the angles under which the sample sees them, in degrees: 0.5; those of a table, over which fits average: 0.
    aperture, lit, sample_size : float or str
        Diameters of the viewed and the lit area (by default twice as large), and extent of the sample, in m or with their unit.
    thickness : float or str, optional
        Of the slab; by default the shape's smallest extent.
    noise, dark_noise, angle_error : float
        Of the detector relative to the signal, without light in 1/sr, and standard deviation of the polar angles in degrees.
    range, step, bandwidth : (float, float), float, float
        Wavelengths in nm.
    paths, seed, threads : int
        Paths for each pair of directions, seed of paths and noise, threads (0: all cores).
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    GoniometerData
    """
    stated = (lamp_angle, detector_angle, aperture)
    options = _options(
        0.5 if lamp_angle is None else lamp_angle,
        0.5 if detector_angle is None else detector_angle,
        "10mm" if aperture is None else aperture,
        lit,
        sample_size,
        thickness,
        range,
        step,
        bandwidth,
        paths,
        seed,
        threads,
        reference,
        standard=standard,
        noise=noise,
        dark_noise=dark_noise,
        angle_error=angle_error,
    )
    options["plan"] = text("plan", plan)
    options["incident"] = numbers_of("incident", incident)
    options["azimuths"] = numbers_of("azimuths", azimuths)
    options["directions"] = integer("directions", directions, minimum=1, maximum=100000)
    options["transmission"] = flag("transmission", transmission)
    where = target_of(target)
    is_table = isinstance(where, str) and "#" not in where and where.lower().endswith(".csv")
    with Words():
        found = _aureole.goniometer_table(where) if is_table else _aureole.goniometer(where, defines_of(defines), options)
    tell(found["notes"])
    nm = np.array(found["nm"])
    return GoniometerData(
        nm,
        np.array(found["theta_i"]),
        np.array(found["phi_i"]),
        np.array(found["theta_o"]),
        np.array(found["phi_o"]),
        np.array(found["f"]).reshape(-1, len(nm)),
        np.array(found["error"]).reshape(-1, len(nm)),
        # A table does not state its cones and its viewed area: they are those of the arguments, or a point.
        *(
            0.0 if is_table and value is None else options[name]
            for name, value in zip(("lamp_angle", "detector_angle", "aperture"), stated)
        ),
    )


def goniometer_report(
    target: Any,
    *,
    lamp_angle: float = 0.5,
    detector_angle: float = 0.5,
    aperture: Length = "10mm",
    lit: Optional[Length] = None,
    sample_size: Length = "60mm",
    thickness: Optional[Length] = None,
    range: Sequence[float] = (400, 700),
    step: float = 20,
    bandwidth: float = 0,
    paths: int = 32768,
    seed: int = 0,
    threads: int = 0,
    incident_light: "Union[str, os.PathLike[str], Sequence[Tuple[float, float]]]" = "",
    cones: Sequence[Sequence[float]] = (),
    defines: Optional[Mapping[str, Any]] = None,
) -> Reflectances:
    """Reflectances by traced instruments, reciprocity and isotropy: `aureole goniometer --report`.

    Parameters
    ----------
    target : Bsdf, or str or path
        A BSDF, or "scene.xml#id" with the id of a BSDF or a shape.
    lamp_angle, detector_angle, aperture, lit, sample_size, thickness, range, step, bandwidth, paths, seed, threads, defines
        As for `goniometer`.
    incident_light : list of (float, float), or path
        Light of which the scattered part is told: pairs of an angle from the normal in degrees and a radiance, linear between
        them; or a picture in latitude and longitude (.exr, .hdr), whose upper half is above the sample.
    cones : rows of (float, float, float, float)
        theta_i, half_i, theta_o, half_o in degrees: light of a cone that is scattered into a cone.

    Returns
    -------
    Reflectances
    """
    options = _options(lamp_angle, detector_angle, aperture, lit, sample_size, thickness, range, step, bandwidth, paths, seed, threads)
    if isinstance(incident_light, (str, os.PathLike)):
        options["incident_light"] = file_path("incident_light", incident_light) if incident_light != "" else ""
    else:
        pairs = real("incident_light", incident_light, minimum=0, maximum=1e6)
        if pairs.ndim != 2 or pairs.shape[1] != 2:
            raise Error(f"incident_light: expected pairs of an angle and a radiance, got an array of shape {pairs.shape}")
        options["incident_light"] = ",".join(f"{angle:.9g}:{radiance:.9g}" for angle, radiance in pairs.tolist())
    rows = real("cones", cones, minimum=0, maximum=90) if np.size(cones) else np.empty((0, 4))
    if rows.ndim != 2 or rows.shape[1] != 4:
        raise Error(f"cones: expected rows of four numbers, got an array of shape {rows.shape}")
    options["cones"] = [float(v) for v in np.ravel(rows)]
    with Words():
        found = _aureole.goniometer_report(target_of(target), defines_of(defines), options)
    tell(found["notes"])
    angles = found["angles"]
    return Reflectances(
        np.array([a[0] for a in angles]),
        np.array([a[1] for a in angles]),
        np.array([a[2] for a in angles]),
        found["rho_hh"],
        found["pairs"],
        np.array(found["turns"]),
        found["anisotropy"],
        found["is_isotropic"],
        found["of_light"],
        found["cones"],
    )


@dataclass(frozen=True, eq=False)
class LateralSpread(Table):
    """Result of `lateral_spread`: light that leaves a slab beside a spot, for one unit that arrives.

    Attributes
    ----------
    distance : numpy.ndarray, shape (distances,)
        From the spot or the line, in m.
    wavelength : numpy.ndarray, shape (bands,)
        In nm.
    values, uncertainty : numpy.ndarray, shape (distances, bands)
        Traced: per area in 1/m^2, or per length across a line in 1/m; and the standard errors.
    predicted : numpy.ndarray or None
        By diffusion (Contini and others 1997); None where the slab is no homogeneous medium.
    line : bool
    """

    distance: Reals
    wavelength: Reals
    values: Reals
    uncertainty: Reals
    predicted: Optional[Reals]
    line: bool

    def columns(self) -> Dict[str, Any]:
        """Distance in m, values, standard errors and predictions by wavelength."""
        columns: Dict[str, Any] = {"distance_m": self.distance}
        for k, nm in enumerate(self.wavelength):
            columns[f"{nm:.10g}nm"], columns[f"u({nm:.10g}nm)"] = self.values[:, k], self.uncertainty[:, k]
            if self.predicted is not None:
                columns[f"diffusion({nm:.10g}nm)"] = self.predicted[:, k]
        return columns

    def plot(self, ax: Any = None) -> Any:
        """Values with two standard errors over the distance, and the prediction.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import colour_of

        axes = axes_or_new(ax)
        for k, nm in enumerate(self.wavelength):
            color = colour_of(nm)
            axes.errorbar(1e3 * self.distance, self.values[:, k], 2 * self.uncertainty[:, k], fmt="o", color=color, label=f"{nm:g} nm")
            if self.predicted is not None:
                axes.plot(1e3 * self.distance, self.predicted[:, k], color=color)
        axes.set(xlabel="distance [mm]", ylabel="1/m" if self.line else "1/m$^2$", yscale="log")
        axes.legend()
        return axes


def lateral_spread(
    target: Any,
    distances: npt.ArrayLike,
    *,
    line: bool = False,
    aperture: Length = "0.5mm",
    lit: Optional[Length] = None,
    lamp_angle: float = 1,
    sample_size: Length = "60mm",
    thickness: Optional[Length] = None,
    range: Sequence[float] = (550, 550),
    step: float = 50,
    bandwidth: float = 0,
    paths: int = 65536,
    seed: int = 0,
    threads: int = 0,
    defines: Optional[Mapping[str, Any]] = None,
) -> LateralSpread:
    """Point or line spread of a translucent slab: `aureole goniometer --spread`.

    Parameters
    ----------
    target : str or path
        "scene.xml#id" with the id of a shape that has a medium inside or a BSSRDF.
    distances : array_like
        Of the receivers from the spot, in m, increasing.
    line : bool
        A line of light instead of a point.
    aperture, lit : float or str
        Diameters (for a line: widths) of receiver and spot, in m or with their unit; by default equal.
    lamp_angle : float
        Half of the angle under which the sample sees the lamp, in degrees.
    sample_size, thickness, range, step, bandwidth, paths, seed, threads, defines
        As for `goniometer`.

    Returns
    -------
    LateralSpread
    """
    options = _options(lamp_angle, 0.5, aperture, lit or aperture, sample_size, thickness, range, step, bandwidth, paths, seed, threads)
    options["line"] = flag("line", line)
    options["distances"] = numbers_of("distances", distances, minimum=0, maximum=1e6)
    with Words():
        found = _aureole.lateral_spread(target_of(target), defines_of(defines), options)
    tell(found["notes"])
    nm = np.array(found["nm"])
    return LateralSpread(
        np.array(options["distances"]),
        nm,
        np.array(found["values"]).reshape(-1, len(nm)),
        np.array(found["errors"]).reshape(-1, len(nm)),
        np.array(found["predicted"]).reshape(-1, len(nm)) if found["predicted"] else None,
        options["line"],
    )


__all__ = ["BrdfFit", "GoniometerData", "Reflectances", "LateralSpread", "goniometer", "goniometer_report", "lateral_spread"]
