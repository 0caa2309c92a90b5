# SPDX-License-Identifier: Apache-2.0
"""Return types of functions of plug-in objects."""
from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


class Lobe(enum.IntFlag):
    """Kind of a lobe of a BSDF; flags that can be combined."""

    none = 0
    diffuse = 1
    glossy = 2
    delta = 4  #: all light goes into one direction
    reflect = 8
    transmit = 16
    through = 32  #: leaves the direction unchanged
    null = 64  #: as if nothing were there


@dataclass(frozen=True)
class BsdfSample:
    """Directions drawn by ``Bsdf.sample``, or by the ``sample`` of a BSDF that is written in Python.

    Attributes
    ----------
    wo : ndarray of float64, shape (..., 3)
        Sampled directions; zeros where `valid` is false.
    value : ndarray of float64, shape (...)
        f |cos theta_o| [1/sr] of all lobes except delta lobes. Where a delta lobe was sampled, its factor, a mass
        without a unit.
    pdf : ndarray of float64, shape (...)
        Density [1/sr] of wo, or where a delta lobe was drawn its probability. ``value / pdf`` is the weight of the sample.
    valid : ndarray of bool, shape (...), or None
        False where there is no direction: the sample counts as zero. None: valid where ``pdf > 0``.
    lobe : ndarray of uint32, shape (...), or None
        The lobe that was drawn: a union of `aureole.Lobe` flags. None: the BSDF's own `lobes`.
    eta : ndarray of float64, shape (...), or None
        Refractive index on wo's side over that on wi's side. None: 1.
    """

    wo: FloatArray
    value: FloatArray
    pdf: FloatArray
    valid: Optional[npt.NDArray[np.bool_]] = None
    lobe: Optional[npt.NDArray[np.uint32]] = None
    eta: Optional[FloatArray] = None

    @property
    def is_delta(self) -> npt.NDArray[np.bool_]:
        """True where a delta lobe was drawn, shape (...)."""
        if self.lobe is None:
            return np.zeros(np.shape(self.pdf), np.bool_)
        return np.asarray((np.asarray(self.lobe) & int(Lobe.delta)) != 0)

    @property
    def weight(self) -> Any:
        """``value / pdf``, zero where not valid, shape (...)."""
        pdf = np.asarray(self.pdf)
        good = pdf > 0 if self.valid is None else np.asarray(self.valid)
        return (np.where(good, self.value, 0) / np.where(good, pdf, 1))[()]


@dataclass(frozen=True)
class EmitterSample:
    """Directions towards an emitter, drawn by ``Emitter.sample_direct``.

    Attributes
    ----------
    wo : ndarray of float64, shape (..., 3)
        Unit directions from the reference towards the emitter; zeros where `valid` is false.
    radiance : ndarray of float64, shape (...)
        Spectral radiance that arrives along -wo [W/(m^2 sr nm)]. Of an emitter that is a point or shines into one direction
        (`is_delta`) the irradiance across wo [W/(m^2 nm)].
    pdf : ndarray of float64, shape (...)
        Density [1/sr] of wo, or 1 where `is_delta`.
    distance : ndarray of float64, shape (...)
        Distance of the emitter in scene units; inf for an emitter at infinity.
    valid : ndarray of bool, shape (...)
        False where no light of the emitter reaches the reference.
    is_delta : bool
        The emitter is a point or shines into one direction, which no ray hits by chance.
    """

    wo: FloatArray
    radiance: FloatArray
    pdf: FloatArray
    distance: FloatArray
    valid: npt.NDArray[np.bool_]
    is_delta: bool


@dataclass(frozen=True)
class PhaseSample:
    """Directions drawn by ``Phase.sample``.

    Attributes
    ----------
    wo : ndarray of float64, shape (..., 3)
        Sampled directions; zeros where `valid` is false.
    value : ndarray of float64, shape (...)
        Value of the phase function [1/sr].
    pdf : ndarray of float64, shape (...)
        Density [1/sr] of wo.
    valid : ndarray of bool, shape (...)
        False where there is no direction.
    """

    wo: FloatArray
    value: FloatArray
    pdf: FloatArray
    valid: npt.NDArray[np.bool_]


@dataclass(frozen=True)
class MediumCoefficients:
    """Result of ``Medium.coefficients``. Lengths are in units of the scene.

    Attributes
    ----------
    sigma_t : ndarray of float64, shape (...)
        Extinction [1/length].
    sigma_s : ndarray of float64, shape (...)
        Scattering [1/length].
    emission : ndarray of float64, shape (...)
        Radiance emitted per length [W/(m^2 sr nm) per length].
    """

    sigma_t: FloatArray
    sigma_s: FloatArray
    emission: FloatArray

    @property
    def sigma_a(self) -> Any:
        """Absorption [1/length], shape (...)."""
        return np.subtract(self.sigma_t, self.sigma_s)[()]

    @property
    def albedo(self) -> Any:
        """The part of the extinction that scatters, 0 where there is none, shape (...)."""
        total = np.asarray(self.sigma_t)
        return (np.asarray(self.sigma_s) / np.where(total > 0, total, 1))[()]
