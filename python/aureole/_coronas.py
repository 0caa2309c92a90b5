# SPDX-License-Identifier: Apache-2.0
"""`rings` and `droplet_size`: coronas around a light source in pictures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import flag, real, scalar, text
from ._errors import Error
from ._instrument_support import Angle, Length, Picture, Words, axes_or_new, picture_of, tell
from ._microstructure import Estimate
from ._results import Table
from ._units import optional_angle, optional_length
from ._wording import python_names

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rings(Table):
    """Result of `rings`. Angles from the source in degrees; rows of arrays are R, G, B.

    Attributes
    ----------
    at : (float, float)
        Pixel of the source.
    first_maximum, next_minimum : numpy.ndarray, shape (3, 2)
        Measured and predicted; NaN where there is none.
    complete : bool
        All of them were found.
    angles : numpy.ndarray
        Of the profiles.
    measured, predicted : numpy.ndarray, shape (angles, 3)
        Means over the azimuths; NaN where there are no pixels.
    """

    at: Tuple[float, float]
    first_maximum: Reals
    next_minimum: Reals
    complete: bool
    angles: Reals = field(repr=False)
    measured: Reals = field(repr=False)
    predicted: Reals = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """The rings of each colour, angles in degrees."""
        with np.errstate(invalid="ignore", divide="ignore"):
            difference = [100 * (a[:, 0] / a[:, 1] - 1) for a in (self.first_maximum, self.next_minimum)]
        return {
            "channel": ["R", "G", "B"],
            "first_maximum_deg": self.first_maximum[:, 0],
            "predicted_maximum_deg": self.first_maximum[:, 1],
            "differ_percent": difference[0],
            "next_minimum_deg": self.next_minimum[:, 0],
            "predicted_minimum_deg": self.next_minimum[:, 1],
            "minima_differ_percent": difference[1],
        }

    def plot(self, ax: Any = None) -> Any:
        """The measured and the predicted profile; the prediction has the measured brightness around the first maximum.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        axes = axes_or_new(ax)
        for c, colour in enumerate(("#c03020", "#208030", "#2050c0")):
            near = np.abs(self.angles - self.first_maximum[c, 1]) < 0.5
            both = near & np.isfinite(self.measured[:, c]) & np.isfinite(self.predicted[:, c])
            scale = np.sum(self.measured[both, c]) / np.sum(self.predicted[both, c]) if np.any(both) else 1.0
            axes.plot(self.angles, self.measured[:, c], ".", ms=3, color=colour)
            axes.plot(self.angles, scale * self.predicted[:, c], color=colour, lw=1, label="RGB"[c])
        axes.set(xlabel="angle from the source [degrees]", ylabel="light", yscale="log")
        axes.legend()
        return axes


def _numbers(name: str, value: Any, count: int) -> List[float]:
    """`count` numbers, or none for None."""
    if value is None:
        return []
    numbers = real(name, value, minimum=-1e9, maximum=1e9)
    if numbers.shape != (count,):
        raise Error(f"{name}: expected {count} numbers, got an array of shape {numbers.shape}")
    return [float(v) for v in numbers]


def _masks(value: Any) -> List[float]:
    if value is None or (isinstance(value, (list, tuple)) and not value):
        return []
    numbers = np.atleast_2d(real("masks", value, minimum=-1e9, maximum=1e9))
    if numbers.ndim != 2 or numbers.shape[1] != 3:
        raise Error(f"masks: expected rows of x, y and radius, got an array of shape {numbers.shape}")
    return [float(v) for v in numbers.reshape(-1)]


def rings(
    picture: Picture,
    *,
    at: Optional[Sequence[float]] = None,
    azimuths: Sequence[float] = (0, 360),
    masks: Any = (),
    fov: float = 30.0,
    illuminant: str = "LED-B3",
    radius: Length = "5um",
    correlation_radius: Optional[Length] = None,
    area_fraction: float = 0.5,
    pane_distance: Length = "0.5m",
    lamp_distance: Length = "14m",
    lamp_diameter: Length = "36mm",
    smooth: float = 0.25,
) -> Rings:
    """Measures the rings of a corona in a picture and compares them with theory: `aureole rings`.

    Parameters
    ----------
    picture : Image or path
        With the channels R, G and B; the source must not be clipped.
    at : (float, float), optional
        Pixel of the source; by default the brightest white one.
    azimuths : (float, float)
        Around the source from one to another in degrees, 0 right, 90 up; (300, 60) is through 0.
    masks : rows of (float, float, float)
        Discs that are left out: x, y and radius in pixels.
    fov : float
        Horizontal field of view in degrees.
    illuminant : str
        CIE name of the source's spectrum.
    radius, correlation_radius : float or str
        Of the circular scatterers and of the hard discs (by default as `radius`), in m or with their unit.
    area_fraction : float
        Of the plane that the hard discs cover.
    pane_distance, lamp_distance, lamp_diameter : float or str
        Distances along the camera's axis and diameter of the source, in m or with their unit.
    smooth : float
        Half-width in degrees of the window of the fits to extrema.

    Returns
    -------
    Rings
    """
    image, name = picture_of("picture", picture)
    with Words():
        found = _aureole.measure_rings(
            image._picture,
            name,
            _numbers("at", at, 2),
            _numbers("azimuths", azimuths, 2),
            _masks(masks),
            scalar("fov", fov),
            text("illuminant", illuminant),
            optional_length("radius", radius, "5um"),
            optional_length("correlation_radius", correlation_radius, "8um"),
            scalar("area_fraction", area_fraction, minimum=0, maximum=1),
            optional_length("pane_distance", pane_distance, "0.5m"),
            optional_length("lamp_distance", lamp_distance, "20m"),
            optional_length("lamp_diameter", lamp_diameter, "5cm"),
            scalar("smooth", smooth, minimum=0.01, maximum=5),
        )
    pairs = np.array([found["measured_rings"], found["predicted_rings"]])  # measured or predicted, colour, extremum
    x, y = found["at"]
    return Rings(
        (x, y),
        pairs[:, :, 0].T,
        pairs[:, :, 1].T,
        found["is_complete"],
        np.array(found["angles"]),
        np.array(found["measured"]),
        np.array(found["predicted"]),
    )


@dataclass(frozen=True, eq=False)
class DropletSize(Table):
    """Result of `droplet_size`. Lengths in m; intervals hold the truth with a probability of 95 % where the model is right.

    Attributes
    ----------
    radius, area_fraction : Estimate
    spread : Estimate or None
        Standard deviation of the logarithm of the radius, with ``spread=True``.
    second_radius, second_share : Estimate or None
        With ``second_size=True``; the share is of the covered area.
    correlation : float
        Of the errors of radius and area fraction.
    residual : float
        Root of the mean square of what the fit leaves, over the rings' range; good fits of a photo leave 0.015.
    center : (float, float)
        Pixel of the source.
    notes : list of str
        Doubts about the result.
    angles : numpy.ndarray
        Of the rings of pixels in degrees; empty where angles were fitted.
    measured, error, fitted : numpy.ndarray, shape (angles, 3)
        R, G, B: means over rings of pixels, their standard errors, and the fit.
    """

    radius: Estimate
    area_fraction: Estimate
    spread: Optional[Estimate]
    second_radius: Optional[Estimate]
    second_share: Optional[Estimate]
    correlation: float
    residual: float
    center: Tuple[float, float]
    notes: List[str]
    angles: Reals = field(repr=False)
    measured: Reals = field(repr=False)
    error: Reals = field(repr=False)
    fitted: Reals = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """The fitted quantities with the ends of the intervals."""
        rows = [
            ("radius_m", self.radius),
            ("area_fraction", self.area_fraction),
            ("spread", self.spread),
            ("second_radius_m", self.second_radius),
            ("second_share", self.second_share),
        ]
        known = [(name, e) for name, e in rows if e is not None]
        return {
            "quantity": [name for name, _ in known],
            "value": [e.value for _, e in known],
            "low": [e.low for _, e in known],
            "high": [e.high for _, e in known],
        }

    def plot(self, ax: Any = None) -> Any:
        """The measured and the fitted profile.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        if not len(self.angles):
            raise Error("angles alone have no profile: a plot needs a photo")
        axes = axes_or_new(ax)
        for c, colour in enumerate(("#c03020", "#208030", "#2050c0")):
            axes.errorbar(self.angles, self.measured[:, c], 1.96 * self.error[:, c], fmt=".", ms=3, lw=0.6, color=colour)
            axes.plot(self.angles, self.fitted[:, c], color=colour, lw=1, label="RGB"[c])
        axes.set(xlabel="angle from the source [degrees]", ylabel="light")
        axes.legend()
        return axes

    def _title(self) -> str:
        return "\n".join(self.notes)


def droplet_size(
    photo: Optional[Picture] = None,
    *,
    pixel_angle: Optional[Angle] = None,
    fov: float = 0.0,
    center: Optional[Sequence[float]] = None,
    lamp: str = "D65",
    lamp_angle: Optional[Angle] = None,
    lamp_distance: Optional[Length] = None,
    pane_distance: Optional[Length] = None,
    substrate: str = "none",
    index: float = 1.5,
    inner: Optional[Angle] = None,
    azimuths: Sequence[float] = (0, 360),
    masks: Any = (),
    angles: str = "",
    angle_error: Angle = "0.05deg",
    area_fraction: Optional[float] = None,
    correlation: str = "simulated",
    spread: bool = False,
    second_size: bool = False,
) -> DropletSize:
    """Fits radius and area fraction of droplets on a pane to the rings around a light source: `aureole droplet-size`.

    Parameters
    ----------
    photo : Image or path, optional
        With the light source; 8-bit files are sRGB. Without it `angles` are fitted.
    pixel_angle : float or str, optional
        Angle of a pixel at the picture's centre, in degrees or with its unit ("0.01deg").
    fov : float
        Horizontal field of view in degrees, instead of `pixel_angle`.
    center : (float, float), optional
        Pixel of the source.
    lamp : str
        Its spectrum: a CIE name, a file of wavelengths and powers, or a wavelength such as "589nm".
    lamp_angle : float or str, optional
        Angular diameter of the source; by default a point.
    lamp_distance, pane_distance : float or str, optional
        Along the camera's axis, in m or with their unit; by default infinite and 0.
    substrate : {"none", "thindielectric"}
        Corrects for the reflection of a pane of that `index`.
    inner : float or str, optional
        Inner angle of the corona that is used.
    azimuths, masks
        As for `rings`.
    angles : str
        Instead of a photo: angles of extrema, such as "2.79:max:G,4.2deg:min:G" (colours R, G, B, Y).
    angle_error : float or str
        Standard error of those angles.
    area_fraction : float, optional
        Fixed area fraction, with `angles`.
    correlation : {"simulated", "percus_yevick"}
        Positions of the scatterers: hard discs in equilibrium, or the theory by which scenes place them by default.
    spread, second_size : bool
        Fit the spread of sizes, or scatterers of two sizes.

    Returns
    -------
    DropletSize
    """
    image, name = (None, "") if photo is None else picture_of("photo", photo)
    options = {
        "pixel_angle": optional_angle("pixel_angle", pixel_angle, "0.01deg"),
        "lamp": text("lamp", lamp),
        "angles": text("angles", angles),
        "angle_error": optional_angle("angle_error", angle_error, "0.01deg"),
        "substrate": text("substrate", substrate),
        "pane_distance": optional_length("pane_distance", pane_distance, "0.5m"),
        "lamp_distance": optional_length("lamp_distance", lamp_distance, "20m"),
        "lamp_angle": optional_angle("lamp_angle", lamp_angle, "0.5deg"),
        "inner": optional_angle("inner", inner, "0.5deg"),
        "correlation": text("correlation", correlation),
        "fov": scalar("fov", fov, minimum=0, maximum=180),
        "area_fraction": -1.0 if area_fraction is None else scalar("area_fraction", area_fraction, minimum=0, maximum=1),
        "index": scalar("index", index),
        "spread": flag("spread", spread),
        "second_size": flag("second_size", second_size),
        "center": _numbers("center", center, 2),
        "azimuths": _numbers("azimuths", azimuths, 2),
        "masks": _masks(masks),
    }
    with Words():
        found = _aureole.measure_droplets(None if image is None else image._picture, name, options)

    def estimate(key: str, most: float = np.inf) -> Estimate:
        value, error = found[key]
        return Estimate(value, max(value - 1.96 * error, 0.0), min(value + 1.96 * error, most))

    fraction = estimate("area_fraction", 1.0)
    if found["fraction_is_given"]:
        fraction = Estimate(fraction.value, fraction.value, fraction.value)
    x, y = found["center"]
    notes = [python_names(note) for note in found["notes"]]
    tell(notes)
    return DropletSize(
        estimate("radius"),
        fraction,
        estimate("spread") if spread else None,
        estimate("second_radius") if second_size else None,
        estimate("second_share", 1.0) if second_size else None,
        found["correlation"],
        found["residual"],
        (x, y),
        notes,
        np.array(found["angles"]),
        *(np.array(found[key]).reshape(-1, 3) for key in ("measured", "error", "fitted")),
    )


__all__ = ["DropletSize", "Rings", "droplet_size", "rings"]
