# SPDX-License-Identifier: Apache-2.0
"""`goniophotometer`: luminous intensities of a luminaire, modelled or by its file."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, integer, real, scalar, text
from ._errors import Error
from ._image import Image
from ._instrument_support import Words, defines_of, tell
from ._bars import Report
from ._render import render
from ._results import Table
from ._scene import Scene

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LuminaireData(Table):
    """Result of `goniophotometer`.

    Attributes
    ----------
    name : str
        The target.
    standard, type, symmetry : str
        Of the file, such as "LM-63-2002" and "C"; symmetry in words.
    azimuths, polar_angles : numpy.ndarray
        In degrees (C and gamma of type C); a single azimuth means symmetry about the axis.
    candela : numpy.ndarray of shape (azimuths, polar_angles)
        In the half-planes of the target's format: C = 0 is along the luminaire for LM-63 and scenes, and across it for EULUMDAT
        (docs/light.md).
    flux, downward_flux : float
        Integral of the intensities, and of the part below 90 degrees, in lm.
    lamp_flux : float
        In lm; 0 where it is unknown or the photometry is absolute.
    peak : float
        Largest intensity in cd, at `peak_direction` (azimuth, polar angle).
    beam : (float, float)
        Full width in degrees at half of the intensity at gamma = 0, in C 0-180 and C 90-270; 0 where it does not fall so far.
    opening : (float, float, float)
        Luminous opening in m: along, across, high.
    balance : str
        The flux beside what the file states, in words.
    keywords : dict
    image : Image or None
        The picture that was rendered.
    """

    name: str
    standard: str
    type: str
    symmetry: str
    azimuths: Reals
    polar_angles: Reals
    candela: Reals = field(repr=False)
    flux: float
    downward_flux: float
    lamp_flux: float
    peak: float
    peak_direction: Tuple[float, float]
    beam: Tuple[float, float]
    opening: Tuple[float, float, float]
    balance: str = field(repr=False)
    keywords: Dict[str, str] = field(repr=False)
    image: Optional[Image] = field(repr=False)
    _texts: Mapping[str, Tuple[str, str]] = field(repr=False)

    def text(self, format: str) -> str:
        """The content of a file of the luminaire.

        Parameters
        ----------
        format : {"ies", "ldt"}
            LM-63-2019 or EULUMDAT.

        Returns
        -------
        str
        """
        if text("format", format) not in ("ies", "ldt"):
            raise Error(f'format: expected "ies" or "ldt", got {format!r}')
        written, problem = self._texts[format]
        if problem:
            raise Error(problem)
        return written

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes an .ies or .ldt file, atomically."""
        name = file_path("path", path)
        ending = os.path.splitext(name)[1].lower()
        if ending not in (".ies", ".ldt"):
            raise Error(f'path: expected a name that ends with ".ies" or ".ldt", got {name!r}')
        _aureole.write_file(name, self.text(ending[1:]).encode())

    def columns(self) -> Dict[str, Any]:
        """A row for each direction."""
        azimuth, polar = np.meshgrid(self.azimuths, self.polar_angles, indexing="ij")
        return {"azimuth_deg": azimuth.ravel(), "polar_angle_deg": polar.ravel(), "intensity_cd": self.candela.ravel()}

    def plot(self, ax: Any = None) -> Any:
        """Polar curves of the intensity in the planes C 0-180 and C 90-270, gamma = 0 downwards.

        Parameters
        ----------
        ax : matplotlib PolarAxes, optional

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for

        axes = axes_for(ax, polar=True)
        axes.set_theta_zero_location("S")
        for plane, style in ((0.0, "-"), (90.0, "--")):
            sides = [self._half_plane(plane), self._half_plane(plane + 180)]
            angles = np.concatenate([-self.polar_angles[::-1], self.polar_angles])
            axes.plot(np.radians(angles), np.concatenate([sides[1][::-1], sides[0]]), style, label=f"C {plane:g}-{plane + 180:g}")
            if len(self.azimuths) == 1:
                break
        axes.set_title(f"{self.flux:.5g} lm, largest {self.peak:.5g} cd")
        axes.legend()
        return axes

    def _half_plane(self, azimuth: float) -> Reals:
        if len(self.azimuths) == 1:
            return np.array(self.candela[0])
        return np.array([np.interp(azimuth % 360, self.azimuths, column, 0, 0) for column in self.candela.T])

    def _title(self) -> str:
        return f"{self.name}: {self.standard}, type {self.type}\n{self.balance}\nlargest intensity {self.peak:.6g} cd"


def is_luminaire_file(target: "str | os.PathLike[str]") -> bool:
    """Whether the name of a file ends with .ies or .ldt."""
    return os.path.splitext(file_path("target", target))[1].lower() in (".ies", ".ldt")


def goniophotometer(
    target: "str | os.PathLike[str]",
    spp: Optional[int] = None,
    *,
    c_step: float = 15.0,
    gamma_step: float = 5.0,
    symmetry: str = "none",
    down: Sequence[float] = (0.0, 0.0, -1.0),
    along: Optional[Sequence[float]] = None,
    flux: float = 0.0,
    lamp_flux: float = 0.0,
    lamp_set: int = 0,
    watts: float = 0.0,
    opening: Optional[Sequence[float]] = None,
    name: str = "",
    maker: str = "",
    integrator: str = "",
    seed: Optional[int] = None,
    threads: int = 0,
    defines: Optional[Mapping[str, Any]] = None,
    progress: Union[bool, Report] = True,
) -> LuminaireData:
    """Luminous intensities of a modelled luminaire in the far field, or of an IES or EULUMDAT file: `aureole goniophotometer`.

    Parameters
    ----------
    target : str or path
        Scene (.xml) with a luminaire alone, which is measured; or an .ies or .ldt file.
    spp : int, optional
        Samples per direction, by default 256.
    c_step, gamma_step : float
        Steps of the angles in degrees.
    symmetry : {"none", "rotational", "c0", "c90", "quadrants"}
        Half-planes to average.
    down, along : (float, float, float)
        Directions in the scene: gamma = 0, and C = 0 along the luminaire (by default x).
    flux, lamp_flux : float
        In lm: scale to this flux of the luminaire; make a measurement relative to that of the lamps, and scale the intensities
        of a file to it. 0: neither.
    lamp_set : int
        Which of the alternative sets of lamps of an EULUMDAT file, from 0.
    watts : float
        Electrical power for the file.
    opening : (float, float, float)
        Luminous opening along, across and high in m, of a measurement or in the place of a file's; zeros are a point. By default
        a point, or that of the file.
    name, maker : str
        For the file.
    integrator : str
        By default "ptracer".
    seed, threads, progress
        As for `render`.
    defines : dict, optional
        Values of the $names of the scene.

    Returns
    -------
    LuminaireData
    """
    file = file_path("target", target)
    is_file = is_luminaire_file(file)
    samples = integer("spp", 256 if spp is None else spp, minimum=1, maximum=2**32)
    set_of_lamps = integer("lamp_set", lamp_set, minimum=0, maximum=1000)
    steps = tuple(scalar(n, v, positive=True, maximum=360, unit="degrees") for n, v in (("c_step", c_step), ("gamma_step", gamma_step)))
    vectors = {}
    for argument, value in (("down", down), ("along", along), ("opening", opening)):
        numbers = real(argument, [] if value is None else value, minimum=-1e12, maximum=1e12)
        if value is not None and numbers.shape != (3,):
            raise Error(f"{argument}: expected three numbers, got an array of shape {numbers.shape}")
        vectors[argument] = numbers.ravel().tolist()
    fluxes = tuple(scalar(n, v, minimum=0, maximum=1e15) for n, v in (("flux", flux), ("lamp_flux", lamp_flux), ("watts", watts)))
    kind = text("symmetry", symmetry)
    if kind not in ("none", "rotational", "c0", "c90", "quadrants"):
        raise Error(f'symmetry: expected "none", "rotational", "c0", "c90" or "quadrants", got {symmetry!r}')
    size = vectors["opening"] or None
    if size and (min(size) < 0 or max(size) >= 1e4):
        raise Error("opening: expected sizes from 0 to 10000 m")
    labels = text("name", name), text("maker", maker)
    for argument, label in (("name", labels[0]), ("maker", labels[1])):
        if "\n" in label or "\r" in label:
            raise Error(f"{argument}: has more than one line, of which the files hold one")
    if is_file:
        given = {"spp": spp is not None, "c_step": c_step != 15, "gamma_step": gamma_step != 5, "symmetry": kind != "none",
                 "down": vectors["down"] != [0, 0, -1], "along": along is not None, "integrator": integrator != "", "seed": seed is not None,
                 "threads": threads != 0, "defines": defines is not None}
        for argument, wrong in given.items():
            if wrong:
                raise Error(f"{argument}: is for a scene, which is measured; a file has its intensities")
        keywords = [pair for label, words in zip(labels, (("LUMINAIRE", "LUMCAT"), ("MANUFAC",))) if label for pair in [(word, label) for word in words]]
        with Words():
            found = _aureole.luminaire_of_file(file, set_of_lamps, fluxes, size, keywords)
        tell(found["notes"])
        return _data(file, found, None)
    if set_of_lamps:
        raise Error("lamp_set: is for an EULUMDAT file; the lamps of a scene are in the scene")
    with Words():
        scene = Scene(
            _aureole.load_goniophotometer(
                file, defines_of(defines), text("integrator", integrator), samples, steps, vectors["down"], vectors["along"]
            )
        )
    tell(scene.notes)
    image = render(scene, seed=seed, threads=threads, progress=progress)
    if not image.complete:
        raise Error("the render was interrupted before all samples were done")
    with Words():
        found = _aureole.measured_luminaire(image._picture, file, *labels, samples, kind, fluxes, size)
    found["symmetry"] = kind
    return _data(file, found, image)


def _data(name: str, d: Mapping[str, Any], image: Optional[Image]) -> LuminaireData:
    keywords: List[Tuple[str, str]] = d["keywords"]
    return LuminaireData(
        name,
        d["standard"],
        d["type"],
        d["symmetry"],
        np.array(d["azimuths"]),
        np.array(d["polar_angles"]),
        np.array(d["candela"]),
        d["flux"],
        d["downward_flux"],
        d["lamp_flux"],
        d["peak"],
        tuple(d["peak_direction"]),
        tuple(d["beam"]),
        tuple(d["opening"]),
        d["balance"],
        dict(keywords),
        image,
        {"ies": tuple(d["ies"]), "ldt": tuple(d["ldt"])},
    )


__all__ = ["LuminaireData", "goniophotometer"]
