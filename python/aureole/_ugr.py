# SPDX-License-Identifier: Apache-2.0
"""`ugr`: the table of the unified glare rating of a luminaire in the standard rooms of the CIE."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import flag, real, scalar, text
from ._errors import Error
from ._goniophotometer import LuminaireData, goniophotometer, is_luminaire_file
from ._instrument_support import Words, tell
from ._results import Table

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class UgrVariation:
    """Ratings from other positions among luminaires that are farther apart, in the room of 4 H by 8 H with 0.7, 0.5 and 0.2.

    Attributes
    ----------
    spacing : float
        In units of H.
    crosswise, endwise : (float, float)
        Lowest and highest rating less that of the table.
    """

    spacing: float
    crosswise: Tuple[float, float]
    endwise: Tuple[float, float]


@dataclass(frozen=True, eq=False)
class UgrData(Table):
    """Result of `ugr`.

    Attributes
    ----------
    name : str
        The target.
    spacing : float
        Distance of neighbouring luminaires in units of their height H above the eye.
    flux : float
        Luminous flux in lm for which `crosswise` and `endwise` hold: of the lamps, or of the luminaire where `is_of_lamps` is false.
    is_of_lamps : bool
    correction : float
        8 lg(flux/1000 lm): ratings less this hold for 1000 lm.
    rooms : numpy.ndarray of shape (19, 2)
        Across and along the line of sight, in units of H.
    reflectances : numpy.ndarray of shape (5, 3)
        Ceiling, walls, and plane at the height of the eye.
    crosswise, endwise : numpy.ndarray of shape (19, 5)
        Ratings by room and reflectances, seen across and along the luminaire's axis; -inf where no light reaches the eye.
    background : numpy.ndarray of shape (2, 19, 5)
        Background luminance in cd/m^2, crosswise and endwise.
    variations : list of UgrVariation
    """

    name: str
    spacing: float
    flux: float
    is_of_lamps: bool
    correction: float
    rooms: Reals = field(repr=False)
    reflectances: Reals = field(repr=False)
    crosswise: Reals = field(repr=False)
    endwise: Reals = field(repr=False)
    background: Reals = field(repr=False)
    variations: List[UgrVariation] = field(repr=False)
    _columns: List[str] = field(repr=False)

    def columns(self) -> Dict[str, Any]:
        """A row for each room, a column for each view and set of reflectances."""
        both = np.concatenate([self.crosswise, self.endwise], axis=1)
        return {"x_H": self.rooms[:, 0], "y_H": self.rooms[:, 1], **dict(zip(self._columns, both.T))}

    def plot(self, ax: Any = None, *, reflectances: int = 0) -> Any:
        """Ratings over the length of the room, a curve for each width: crosswise solid, endwise dashed.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        reflectances : int
            Which row of `reflectances`.

        Returns
        -------
        matplotlib Axes
        """
        from ._arrays import integer
        from ._plot_support import axes_for

        row = integer("reflectances", reflectances, minimum=0, maximum=len(self.reflectances) - 1)
        axes = axes_for(ax)
        for i, width in enumerate(np.unique(self.rooms[:, 0])):
            rooms = self.rooms[:, 0] == width
            for values, style, name in ((self.crosswise, "-", "crosswise"), (self.endwise, "--", "endwise")):
                axes.plot(self.rooms[rooms, 1], values[rooms, row], style, marker="o", markersize=3, color=f"C{i}", label=f"{width:g} H wide, {name}")
        axes.set_xlabel("length of the room along the line of sight, H")
        axes.set_ylabel("UGR")
        axes.set_title(" / ".join(f"{v:g}" for v in self.reflectances[row]))
        axes.legend(fontsize="small")
        return axes

    def _title(self) -> str:
        of = "of the lamps" if self.is_of_lamps else "of the luminaire"
        return f"{self.name}: UGR for {self.flux:.6g} lm {of} ({self.correction:+.1f} against 1000 lm), luminaires every {self.spacing:g} H"


def ugr(
    target: "Union[LuminaireData, str, os.PathLike[str]]",
    *,
    spacing: float = 0.25,
    background: str = "uniform",
    uncorrected: bool = False,
    **luminaire: Any,
) -> UgrData:
    """The table of the unified glare rating (CIE 117, CIE 190) of a luminaire in 19 standard rooms: `aureole ugr`.

    Parameters
    ----------
    target : LuminaireData, str or path
        Result of `goniophotometer`; or what it takes: an .ies or .ldt file, or a scene with a luminaire alone.
    spacing : float
        Distance of neighbouring luminaires in units of their height H above the eye: 0.25 in data sheets, 1 in CIE 190.
    background : {"uniform", "patches"}
        Interreflection between uniform surfaces, as CIE 190 assumes, or between patches, the radiosity of the box.
    uncorrected : bool
        Ratings for 1000 lm instead of the luminaire's own flux.
    **luminaire
        Arguments of `goniophotometer`, such as `opening` for a file without a luminous area.

    Returns
    -------
    UgrData
    """
    distance = scalar("spacing", spacing, positive=True, maximum=1, unit="H")
    kind, for_kilolumen = text("background", background), flag("uncorrected", uncorrected)
    if kind not in ("uniform", "patches"):
        raise Error(f'background: expected "uniform" or "patches", got {background!r}')
    with Words():
        _aureole.require_ugr_spacing(distance)
    for argument in ("watts", "name", "maker"):
        if argument in luminaire:
            raise Error(f"{argument}: is for the file of a luminaire, which goniophotometer makes")
    if isinstance(target, LuminaireData):
        if luminaire:
            raise Error(f"{next(iter(luminaire))}: is for a file or a scene; the target has been measured or read")
        data = target
    else:
        if not is_luminaire_file(target):
            if luminaire.get("opening") is None:
                raise Error("opening: is needed for a scene: the size of the luminous opening, by which the luminance is reckoned")
            opening = real("opening", luminaire["opening"])
            if opening.shape == (3,):  # goniophotometer refuses others
                with Words():
                    _aureole.require_luminous_area(opening.tolist())
        data = goniophotometer(target, **luminaire)
    if data.type != "C":
        raise Error("a table of UGR is that of a luminaire of type C, which hangs in a room")
    with Words():
        try:
            found = _aureole.ugr_table(data.text("ies"), data.name, distance, kind == "patches")
        except Error as e:
            raise e if str(e).startswith("--") else Error(f"{data.name}: {e}") from None
    tell(found["notes"])
    less = found["correction"] if for_kilolumen else 0.0
    return UgrData(
        data.name,
        distance,
        1000.0 if for_kilolumen else found["flux"],
        found["is_of_lamps"],
        0.0 if for_kilolumen else found["correction"],
        np.array(found["rooms"]),
        np.array(found["reflectances"]),
        found["ratings"][0] - less,
        found["ratings"][1] - less,
        np.array(found["backgrounds"]) * (1000 / found["flux"] if for_kilolumen else 1),
        [UgrVariation(s, tuple(cross), tuple(end)) for s, cross, end in found["variations"]],
        found["columns"],
    )


__all__ = ["UgrData", "UgrVariation", "ugr"]
