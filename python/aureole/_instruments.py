# SPDX-License-Identifier: Apache-2.0
"""`layer` and `medium`: figures of a BSDF and of a medium by wavelength, as the command line prints them."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, Mapping, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, integer, real, scalar, shown, text
from ._bars import LoadBar
from ._errors import Error
from ._instrument_support import Angle, Length, Words, axes_or_new, defines_of, tell
from ._results import Table
from ._units import angle_deg, length_m

Reals = npt.NDArray[np.float64]

_LAYER_COLUMNS = {
    "direct_transmission": "direct_transmission",
    "diffuse_transmission_near": "near_transmission",
    "diffuse_transmission_far": "far_transmission",
    "total_transmission": "total_transmission",
    "direct_reflection": "direct_reflection",
    "diffuse_reflection": "diffuse_reflection",
    "total_reflection": "total_reflection",
    "lost": "lost",
}


@dataclass(frozen=True, eq=False)
class LayerData(Table):
    """Result of `layer`: fractions of the light that arrives, arrays over wavelengths.

    Attributes
    ----------
    wavelength : numpy.ndarray
        In nm.
    direct_transmission, near_transmission, far_transmission, total_transmission : numpy.ndarray
        Transmitted in the regular direction, scattered within the haze angle of it, beyond; their sum.
    direct_reflection, diffuse_reflection, total_reflection : numpy.ndarray
    lost : numpy.ndarray
        What is left: absorbed.
    xyz : dict of str to numpy.ndarray
        X, Y, Z of each of these for the illuminant, relative to its Y; empty where nothing is visible.
    haze : float
        Part of the transmitted light beyond the haze angle, for the CIE observer; NaN where nothing is visible.
    """

    wavelength: Reals
    direct_transmission: Reals
    near_transmission: Reals
    far_transmission: Reals
    total_transmission: Reals
    direct_reflection: Reals
    diffuse_reflection: Reals
    total_reflection: Reals
    lost: Reals
    xyz: Dict[str, Reals]
    haze: float

    def columns(self) -> Dict[str, Any]:
        """Wavelength in nm and the fractions."""
        return {"wavelength_nm": self.wavelength, **{name: getattr(self, name) for name in _LAYER_COLUMNS.values()}}

    def plot(self, ax: Any = None) -> Any:
        """Fractions over the wavelength.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        for name in ("direct_transmission", "near_transmission", "far_transmission", "direct_reflection", "diffuse_reflection", "lost"):
            if np.any(getattr(self, name) > 0):
                axes.plot(self.wavelength, getattr(self, name), label=name.replace("_", " "))
        axes.set(xlabel="wavelength [nm]", ylabel="fraction of the light", ylim=(0, None))
        axes.legend()
        return axes

    def _title(self) -> str:
        return f"haze {100 * self.haze:.2f} %" if np.isfinite(self.haze) else ""

    def __repr__(self) -> str:
        return (
            f"<aureole.LayerData {len(self.wavelength)} wavelengths, transmission {np.mean(self.total_transmission):.4f}, reflection "
            f"{np.mean(self.total_reflection):.4f}, haze {self.haze:.4f}>"
        )


def layer(
    target: Any,
    *,
    angle: Angle = 0.0,
    azimuth: float = 0.0,
    step: float = 0.0,
    illuminant: str = "D65",
    haze_angle: float = 2.5,
    samples: int = 65536,
    at: Sequence[float] = (0.5, 0.5),
    defines: Optional[Mapping[str, Any]] = None,
) -> LayerData:
    """Transmission, reflection and haze of a layer, by wavelength and for the CIE observer: `aureole layer`.

    Parameters
    ----------
    target : Bsdf, or str or path
        A BSDF, or "scene.xml#id" with the id of a BSDF or a shape; the file needs no sensor.
    angle : float or str
        Of incidence in degrees, above 90 from below; or with its unit.
    azimuth : float
        Of the incident light in degrees from the u axis.
    step : float
        Largest step between wavelengths in nm; 0: 20, or a hundredth of the range where that is more.
    illuminant : str
        Of the CIE values.
    haze_angle : float
        In degrees, above which light counts as haze (ASTM D1003: 2.5).
    samples : int
        Per wavelength.
    at : (float, float)
        u and v of the point on the surface, for textured layers.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    LayerData
    """
    degrees = (
        scalar("angle", angle, minimum=0, maximum=180, unit="degrees")
        if not isinstance(angle, str)
        else angle_deg("angle", angle, maximum=180, example="45deg")
    )
    uv = real("at", at)
    if uv.shape != (2,):
        raise Error(f"at: expected two numbers, u and v, got {shown(at)}")
    numbers = (
        degrees,
        scalar("azimuth", azimuth, minimum=-36000, maximum=36000),
        scalar("step", step, minimum=0, maximum=1e9, unit="nm"),
        text("illuminant", illuminant),
        scalar("haze_angle", haze_angle, minimum=0.01, maximum=90, unit="degrees"),
        integer("samples", samples, minimum=64, maximum=1 << 26),
        tuple(uv.tolist()),
    )
    with Words():
        if isinstance(target, (str, os.PathLike)):
            with LoadBar(os.path.basename(target)):
                found = _aureole.layer_of_file(file_path("target", target), defines_of(defines), *numbers)
        else:
            from ._plot_support import as_bsdf

            found = _aureole.layer(as_bsdf(target), *numbers)
    tell(found["notes"])
    return LayerData(
        np.array(found["nm"]),
        **{name: np.array(found[key]) for key, name in _LAYER_COLUMNS.items()},
        xyz={_LAYER_COLUMNS[key]: np.array(v) for key, v in found["xyz"].items()},
        haze=found["haze"],
    )


@dataclass(frozen=True, eq=False)
class MediumData(Table):
    """Result of `medium`, in SI units: arrays over wavelengths.

    Attributes
    ----------
    wavelength : numpy.ndarray
        In nm.
    absorption, scattering : numpy.ndarray
        Coefficients sigma_a and sigma_s in 1/m.
    asymmetry : numpy.ndarray
        Mean cosine g of the scattering angle.
    transmittance, absorbance, optical_density : numpy.ndarray
        Of `length`: the part that is neither absorbed nor scattered, and lg(1/T) by absorption alone and by extinction.
    length : float
        In m.
    xyz_unscattered, xyz_not_absorbed : numpy.ndarray
        X, Y, Z of D65 (Y = 1) behind that length.
    angles : numpy.ndarray
        Scattering angles in rad, for `phase`.
    phase : numpy.ndarray, shape (3, angles)
        The phase function in 1/sr at a quarter, half and three quarters of the range of wavelengths.
    phase_wavelength : numpy.ndarray
        These wavelengths in nm.
    """

    wavelength: Reals
    absorption: Reals
    scattering: Reals
    asymmetry: Reals
    transmittance: Reals
    absorbance: Reals
    optical_density: Reals
    length: float
    xyz_unscattered: Reals
    xyz_not_absorbed: Reals
    angles: Reals = field(repr=False)
    phase: Reals = field(repr=False)
    phase_wavelength: Reals = field(repr=False)

    @property
    def extinction(self) -> Reals:
        """sigma_t in 1/m."""
        return self.absorption + self.scattering

    @property
    def albedo(self) -> Reals:
        """sigma_s over sigma_t; 0 without extinction."""
        return np.divide(self.scattering, self.extinction, out=np.zeros_like(self.scattering), where=self.extinction > 0)

    @property
    def mean_free_path(self) -> Reals:
        """In m; infinite without extinction."""
        return np.divide(1.0, self.extinction, out=np.full_like(self.scattering, np.inf), where=self.extinction > 0)

    def columns(self) -> Dict[str, Any]:
        """Wavelength in nm, coefficients in 1/m, and what follows of them."""
        return {
            "wavelength_nm": self.wavelength,
            "absorption_per_m": self.absorption,
            "scattering_per_m": self.scattering,
            "extinction_per_m": self.extinction,
            "albedo": self.albedo,
            "g": self.asymmetry,
            "mean_free_path_m": self.mean_free_path,
            "transmittance": self.transmittance,
            "absorbance": self.absorbance,
            "optical_density": self.optical_density,
        }

    def plot(self, axes: Any = None) -> Any:
        """Coefficients over the wavelength, and the phase function over the scattering angle.

        Parameters
        ----------
        axes : two matplotlib Axes, optional

        Returns
        -------
        numpy.ndarray of 2 matplotlib Axes
        """
        from ._plot_support import colour_of, matplotlib

        if axes is None:
            axes = matplotlib().pyplot.subplots(1, 2, figsize=(9, 3.6), layout="constrained")[1]
        targets = [axes_or_new(a) for a in np.ravel(np.asarray(axes, object))]
        if len(targets) != 2:
            raise Error(f"axes: expected two, got {len(targets)}")
        targets[0].plot(self.wavelength, self.absorption, label="absorption")
        targets[0].plot(self.wavelength, self.scattering, label="scattering")
        targets[0].set(xlabel="wavelength [nm]", ylabel="coefficient [1/m]")
        targets[0].legend()
        for nm, values in zip(self.phase_wavelength, self.phase):
            targets[1].semilogy(np.degrees(self.angles), values, color=colour_of(nm), label=f"{nm:.4g} nm")
        targets[1].set(xlabel="scattering angle [degrees]", ylabel="phase function [1/sr]")
        targets[1].legend()
        result = np.empty(2, object)
        result[:] = targets
        return result


def medium(
    target: Any,
    *,
    length: Length = "1cm",
    step: float = 0.0,
    at: Sequence[float] = (0, 0, 0),
    along: Sequence[float] = (0, 0, 1),
    defines: Optional[Mapping[str, Any]] = None,
) -> MediumData:
    """Absorption and scattering of a medium by wavelength, and its colour: `aureole medium`.

    Parameters
    ----------
    target : Medium, or str or path
        A medium, or "scene.xml#id" with the id of one; without an id the only one of the file.
    length : float or str
        Path length of the transmittance, absorbances and colours, in m or with its unit.
    step : float
        Largest step between wavelengths in nm; 0: 25, or a hundredth of the range where that is more.
    at : (float, float, float)
        The point, for spatially varying media.
    along : (float, float, float)
        Direction of the light, for oriented particles.
    defines : dict, optional
        Values of the $names of the file.

    Returns
    -------
    MediumData
    """
    metres = length_m("length", length, example="1cm")
    if not metres > 0:
        raise Error(f"length: expected a positive length, got {shown(length)}")
    point, direction = real("at", at, minimum=-1e30, maximum=1e30), real("along", along, minimum=-1e15, maximum=1e15)
    for name, numbers in (("at", point), ("along", direction)):
        if numbers.shape != (3,):
            raise Error(f"{name}: expected three numbers, got an array of shape {numbers.shape}")
    options = (scalar("step", step, minimum=0, maximum=1e9, unit="nm"), metres, tuple(point.tolist()), tuple(direction.tolist()))
    with Words():
        if isinstance(target, (str, os.PathLike)):
            with LoadBar(os.path.basename(target)):
                found = _aureole.medium_of_file(file_path("target", target), defines_of(defines), *options)
        elif isinstance(target, _aureole.Medium):
            found = _aureole.medium(target, *options)
        else:
            raise TypeError(f'target: expected a Medium or "scene.xml#id", got {type(target).__name__}')
    tell(found["notes"])
    arrays = {
        name: np.array(found[name])
        for name in (
            "absorption",
            "scattering",
            "asymmetry",
            "transmittance",
            "absorbance",
            "optical_density",
            "xyz_unscattered",
            "xyz_not_absorbed",
            "angles",
            "phase",
        )
    }
    return MediumData(np.array(found["nm"]), **arrays, length=metres, phase_wavelength=np.array(found["phase_nm"]))


__all__ = ["LayerData", "MediumData", "layer", "medium"]
