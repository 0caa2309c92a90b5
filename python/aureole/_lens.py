# SPDX-License-Identifier: Apache-2.0
"""`lens`: focal length, pupils, chromatic focus, spots and vignetting of a lens by its elements."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, integer, real, scalar
from ._errors import Error
from ._instrument_support import Length, Words, tell
from ._results import Table
from ._units import length_m

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LensData(Table):
    """Result of `lens`. Lengths along the axis and heights are in mm.

    Attributes
    ----------
    name : str
    surfaces, stop : int
        Number of surfaces, and the stop among them, from 1.
    focal_length, f_number, back_focus : float
        At the helium line d; the last is the rear focal point behind the last vertex.
    entrance_pupil, entrance_diameter, exit_pupil, exit_diameter : float
        Position behind the first vertex and diameter; distance before the film and diameter.
    film : float
        Position of the film behind the last vertex, at the best focus of the line d.
    wavelength : numpy.ndarray of shape (wavelengths,)
        In nm.
    focal_lengths, paraxial_focus, best_focus : numpy.ndarray of shape (wavelengths,)
        Of each wavelength; positions behind the last vertex.
    angle : numpy.ndarray of shape (fields,)
        From the axis in degrees.
    height, rms_radius, open, transmittance : numpy.ndarray of shape (fields, wavelengths)
        Of the spots of points at the distance of the object: centroid in mm, root mean square radius in um, rays that arrive over those on the
        axis, their mean transmittance. NaN where no light arrives.
    spots : list of lists of numpy.ndarray of shape (rays, 2)
        Rays in the plane of the film from the centroid, in um: `spots[field][wavelength]`.
    cutoff, airy_radius : float
        Of diffraction at the line d, in cycles per mm and in um.
    """

    name: str
    surfaces: int
    stop: int
    focal_length: float
    f_number: float
    back_focus: float
    entrance_pupil: float
    entrance_diameter: float
    exit_pupil: float
    exit_diameter: float
    film: float
    wavelength: Reals
    focal_lengths: Reals
    paraxial_focus: Reals
    best_focus: Reals
    angle: Reals
    height: Reals
    rms_radius: Reals
    open: Reals
    transmittance: Reals
    spots: List[List[Reals]] = field(repr=False)
    cutoff: float
    airy_radius: float

    def columns(self) -> Dict[str, Any]:
        """A row for each spot."""
        angle, nm = np.meshgrid(self.angle, self.wavelength, indexing="ij")
        columns = {
            "angle_deg": angle,
            "wavelength_nm": nm,
            "height_mm": self.height,
            "rms_radius_um": self.rms_radius,
            "open": self.open,
            "transmittance": self.transmittance,
        }
        return {name: np.reshape(values, -1) for name, values in columns.items()}

    def plot(self, ax: Any = None) -> Any:
        """Spot diagrams, a field beside the other.

        Parameters
        ----------
        ax : matplotlib Axes, optional

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for, colour_of

        axes = axes_for(ax)
        finite = self.rms_radius[np.isfinite(self.rms_radius)]
        step = 8 * float(finite.max()) if finite.size else 1.0
        for i, spots in enumerate(self.spots):
            for nm, spot in zip(self.wavelength, spots):
                drawn = spot[:: max(1, len(spot) // 2000)]
                axes.plot(drawn[:, 0] + i * step, drawn[:, 1], ".", ms=1, color=colour_of(nm), label=f"{nm:g} nm" if i == 0 else None)
        axes.set_xticks([i * step for i in range(len(self.angle))], [f"{a:g}°" for a in self.angle])
        axes.set(xlabel="field", ylabel="from the centroid [um]", title=self._title().splitlines()[0], aspect="equal")
        axes.legend(markerscale=8)
        return axes

    def _title(self) -> str:
        name = f"{self.name}: " if self.name else ""
        return f"{name}{self.focal_length:.4g} mm, f/{self.f_number:.3g}, {self.surfaces} surfaces"


def lens(
    path: "str | os.PathLike[str]",
    *,
    f_number: Optional[float] = None,
    distance: Optional[Length] = None,
    fields: npt.ArrayLike = (0.0, 10.0, 20.0),
    wavelengths: npt.ArrayLike = (486.1327, 587.5618, 656.2725),
    rays: int = 200,
) -> LensData:
    """Focal length, pupils, chromatic focus, spots and vignetting of a lens by its elements: `aureole lens`.

    Parameters
    ----------
    path : str or path
        A prescription: a table (radius, thickness, glass, diameter) or .zmx.
    f_number : float, optional
        Stops the lens down; by default it is wide open.
    distance : float or str, optional
        Of the object in focus, in m or with its unit; by default infinite.
    fields : array_like
        Angles from the axis in degrees.
    wavelengths : array_like
        In nm.
    rays : int
        Across the entrance pupil.

    Returns
    -------
    LensData
    """
    angles = np.atleast_1d(real("fields", fields, minimum=-89.9, maximum=89.9, unit="degrees"))
    nm = np.atleast_1d(real("wavelengths", wavelengths, positive=True, maximum=1e6, unit="nm"))
    for name, values in (("fields", angles), ("wavelengths", nm)):
        if values.ndim != 1 or not 1 <= values.size <= 1000:
            raise Error(f"{name}: expected one to 1000 numbers, got an array of shape {values.shape}")
    metres = float("inf") if distance is None else length_m("distance", distance, example="1.5m")
    if not metres > 0:
        raise Error("distance: expected a positive length")
    number = None if f_number is None else scalar("f_number", f_number, positive=True)
    with Words():
        d = _aureole.lens_figures(
            file_path("path", path), number, 1000 * metres, angles.tolist(), nm.tolist(), integer("rays", rays, minimum=2, maximum=1000)
        )
    tell(d["notes"])
    foci = np.array(d["foci"], dtype=np.float64).reshape(-1, 4)
    shape = (angles.size, nm.size)
    numbers = np.array([spot[2:6] if len(spot[6]) else (np.nan,) * 4 for spot in d["spots"]], dtype=np.float64)
    height, rms, opened, transmittance = (numbers[:, i].reshape(shape) for i in range(4))
    points = [np.array(spot[6]) for spot in d["spots"]]
    return LensData(
        name=d["name"],
        surfaces=d["surfaces"],
        stop=d["stop"],
        focal_length=d["focal_length"],
        f_number=d["f_number"],
        back_focus=d["back_focus"],
        entrance_pupil=d["entrance_pupil"],
        entrance_diameter=d["entrance_diameter"],
        exit_pupil=d["exit_pupil"],
        exit_diameter=d["exit_diameter"],
        film=d["film"],
        wavelength=nm,
        focal_lengths=foci[:, 1],
        paraxial_focus=foci[:, 2],
        best_focus=foci[:, 3],
        angle=angles,
        height=height,
        rms_radius=rms,
        open=opened,
        transmittance=transmittance,
        spots=[points[i * nm.size : (i + 1) * nm.size] for i in range(angles.size)],
        cutoff=d["cutoff"],
        airy_radius=d["airy_radius"],
    )


__all__ = ["LensData", "lens"]
