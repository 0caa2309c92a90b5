# SPDX-License-Identifier: Apache-2.0
"""Absorption in the quantities of several sciences (IUPAC's terms), phase functions, and scattering of air, water and dipoles in closed form."""
from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import real
from ._vectorised import broadcast, shaped

Reals = npt.NDArray[np.float64]


def _mapped(function: Any, **arrays: npt.NDArray[Any]) -> Any:
    """A compiled function of one or two numbers, for the named arrays broadcast against each other."""
    shape, flat = broadcast(**arrays)
    result = np.empty(flat[0].size)
    function(*flat, result)
    return shaped(result, shape)


def transmittance(absorption: npt.ArrayLike, distance: npt.ArrayLike) -> Any:
    """Transmitted fraction exp(-sigma_a s) of light over a distance (Bouguer, Lambert, Beer).

    Parameters
    ----------
    absorption : array_like
        Absorption coefficient sigma_a [1/m], at least 0; the extinction coefficient for light that is neither absorbed
        nor scattered.
    distance : array_like
        In m, at least 0.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.transmittance(100, 0.01).round(6))  # 1 cm of 1/cm
    0.367879
    """
    return _mapped(_aureole.transmittance, absorption=real("absorption", absorption, minimum=0),
                   distance=real("distance", distance, minimum=0))


def absorptance(absorption: npt.ArrayLike, distance: npt.ArrayLike) -> Any:
    """Absorbed fraction 1 - exp(-sigma_a s), without cancellation where it is small. Arguments as for `transmittance`."""
    return _mapped(_aureole.absorptance, absorption=real("absorption", absorption, minimum=0),
                   distance=real("distance", distance, minimum=0))


def napierian_absorbance(transmittance: npt.ArrayLike) -> Any:
    """Napierian absorbance -ln T of a transmittance in (0, 1]."""
    return _mapped(_aureole.napierian_absorbance, transmittance=real("transmittance", transmittance, positive=True, maximum=1))


def decadic_absorbance(transmittance: npt.ArrayLike) -> Any:
    """Decadic absorbance -lg T, the optical density, of a transmittance in (0, 1].

    Examples
    --------
    >>> from aureole import optics
    >>> optics.decadic_absorbance([1, 0.1, 0.01]).tolist()
    [0.0, 1.0, 2.0]
    """
    return _mapped(_aureole.decadic_absorbance, transmittance=real("transmittance", transmittance, positive=True, maximum=1))


def transmittance_of_napierian(absorbance: npt.ArrayLike) -> Any:
    """Transmittance exp(-A) of a Napierian absorbance, at least 0."""
    return _mapped(_aureole.transmittance_of_napierian, absorbance=real("absorbance", absorbance, minimum=0))


def transmittance_of_decadic(absorbance: npt.ArrayLike) -> Any:
    """Transmittance 10^-A of a decadic absorbance, at least 0."""
    return _mapped(_aureole.transmittance_of_decadic, absorbance=real("absorbance", absorbance, minimum=0))


def absorption_of_napierian(absorbance: npt.ArrayLike, distance: npt.ArrayLike) -> Any:
    """Absorption coefficient sigma_a [1/m] of a Napierian absorbance over a distance in m."""
    return _mapped(_aureole.absorption_of_napierian, absorbance=real("absorbance", absorbance, minimum=0),
                   distance=real("distance", distance, positive=True))


def absorption_of_decadic(absorbance: npt.ArrayLike, distance: npt.ArrayLike) -> Any:
    """Absorption coefficient sigma_a [1/m] of a decadic absorbance over a distance in m.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.absorption_of_decadic(1, 0.01).round(3))  # a cell of 1 cm with absorbance 1
    230.259
    """
    return _mapped(_aureole.absorption_of_decadic, absorbance=real("absorbance", absorbance, minimum=0),
                   distance=real("distance", distance, positive=True))


def absorption_of_index(k: npt.ArrayLike, nm: npt.ArrayLike) -> Any:
    """Absorption coefficient sigma_a = 4 pi k/lambda [1/m] of the index n + i k; `nm` is the wavelength in vacuum."""
    return _mapped(_aureole.absorption_of_index, k=real("k", k, minimum=0), nm=real("nm", nm, positive=True))


def index_of_absorption(absorption: npt.ArrayLike, nm: npt.ArrayLike) -> Any:
    """k of the index n + i k from the absorption coefficient [1/m]: the inverse of `absorption_of_index`."""
    return _mapped(_aureole.index_of_absorption, absorption=real("absorption", absorption, minimum=0),
                   nm=real("nm", nm, positive=True))


def absorption_of_molar(molar: npt.ArrayLike, concentration: npt.ArrayLike) -> Any:
    """Absorption coefficient sigma_a [1/m] of a solution: ln 10 x 100 epsilon c.

    Parameters
    ----------
    molar : array_like
        Molar (decadic) absorption coefficient epsilon [L/(mol cm)], as chemists tabulate it.
    concentration : array_like
        In mol/L. Absorption coefficients of several substances add.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.absorption_of_molar(10000, 1e-4).round(3))  # absorbance 1 in a cell of 1 cm
    230.259
    """
    return _mapped(_aureole.absorption_of_molar, molar=real("molar", molar, minimum=0),
                   concentration=real("concentration", concentration, minimum=0))


def cross_section_of_molar(molar: npt.ArrayLike) -> Any:
    """Absorption cross section of a molecule [m^2] from its molar absorption coefficient [L/(mol cm)]."""
    return _mapped(_aureole.cross_section_of_molar, molar=real("molar", molar, minimum=0))


def absorption_of_mass(specific: npt.ArrayLike, concentration: npt.ArrayLike) -> Any:
    """Absorption coefficient sigma_a [1/m] from a mass-specific one (Napierian, m^2/kg) and a concentration [kg/m^3]."""
    return _mapped(_aureole.absorption_of_mass, specific=real("specific", specific, minimum=0),
                   concentration=real("concentration", concentration, minimum=0))


def absorption_of_number(cross_section: npt.ArrayLike, number_density: npt.ArrayLike) -> Any:
    """Absorption coefficient sigma_a [1/m] of particles from their cross section [m^2] and their number per m^3."""
    return _mapped(_aureole.absorption_of_number, cross_section=real("cross_section", cross_section, minimum=0),
                   number_density=real("number_density", number_density, minimum=0))


def henyey_greenstein(mu: npt.ArrayLike, g: npt.ArrayLike) -> Any:
    """Henyey and Greenstein's phase function [1/sr], with integral 1 over the sphere.

    Parameters
    ----------
    mu : array_like
        Cosine of the scattering angle, in [-1, 1].
    g : array_like
        Mean cosine, in [-0.9999, 0.9999].

    References
    ----------
    Henyey & Greenstein, Astrophys. J. 93 (1941) 70.
    """
    return _mapped(_aureole.henyey_greenstein, mu=real("mu", mu, minimum=-1, maximum=1),
                   g=real("g", g, minimum=-0.9999, maximum=0.9999))


def rayleigh_phase(mu: npt.ArrayLike, depolarization: npt.ArrayLike = 0) -> Any:
    """Rayleigh's phase function [1/sr] of unpolarised light, with integral 1 over the sphere.

    Parameters
    ----------
    mu : array_like
        Cosine of the scattering angle, in [-1, 1].
    depolarization : array_like
        Depolarisation factor at a right angle, in [0, 0.85]: 0 for isotropic molecules.

    References
    ----------
    Chandrasekhar, Radiative Transfer, 1960, section 18.
    """
    return _mapped(_aureole.rayleigh_phase, mu=real("mu", mu, minimum=-1, maximum=1),
                   depolarization=real("depolarization", depolarization, minimum=0, maximum=0.85))


def hard_sphere_structure_factor(u: npt.ArrayLike, fraction: npt.ArrayLike) -> Any:
    """Structure factor S(q) of hard spheres of radius a in a fluid, by the Percus-Yevick equation.

    Parameters
    ----------
    u : array_like
        q a, at least 0.
    fraction : array_like
        Fraction of the volume that the spheres fill, in [0, 0.6].

    References
    ----------
    Wertheim, Phys. Rev. Lett. 10 (1963) 321; Kinning & Thomas, Macromolecules 17 (1984) 1712.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.hard_sphere_structure_factor(0, 0.4).round(6))  # (1 - f)^4/(1 + 2 f)^2
    0.04
    """
    return _mapped(_aureole.hard_sphere_structure_factor, u=real("u", u, minimum=0),
                   fraction=real("fraction", fraction, minimum=0, maximum=0.6))


def air_refractivity(nm: npt.ArrayLike) -> Any:
    """n - 1 of dry air at 15 C and 1013.25 hPa, for wavelengths from 185 to 1700 nm (Peck & Reeder, J. Opt. Soc. Am. 62 (1972) 958)."""
    return _mapped(_aureole.air_refractivity, nm=real("nm", nm, minimum=185, maximum=1700, unit="nm"))


def air_cross_section(nm: npt.ArrayLike) -> Any:
    """Scattering cross section of a molecule of dry air [m^2] (Bodhaine et al., J. Atmos. Oceanic Technol. 16 (1999) 1854).

    The phase function is `rayleigh_phase` with `air_depolarization`; a cubic metre at 15 C and 1013.25 hPa has 2.546899e25.

    Parameters
    ----------
    nm : array_like
        Wavelength, from 185 to 1700 nm.
    """
    return _mapped(_aureole.air_cross_section, nm=real("nm", nm, minimum=185, maximum=1700, unit="nm"))


def air_depolarization(nm: npt.ArrayLike) -> Any:
    """Depolarisation factor of dry air at a right angle, for wavelengths from 185 to 1700 nm (Bates, Planet. Space Sci. 32 (1984) 785)."""
    return _mapped(_aureole.air_depolarization, nm=real("nm", nm, minimum=185, maximum=1700, unit="nm"))


def water_scattering(nm: npt.ArrayLike) -> Any:
    """Scattering coefficient of pure water by density fluctuations [1/m] (Morel 1974); measured from 350 to 700 nm.

    The phase function is `rayleigh_phase` with a depolarisation factor of 0.09.

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.water_scattering(550).round(5))
    0.00149
    """
    return _mapped(_aureole.water_scattering, nm=real("nm", nm, positive=True, unit="nm"))


def dipole_reflectance(reduced_albedo: npt.ArrayLike, index: npt.ArrayLike = 1.0) -> Any:
    """Diffuse reflectance of a half-space by the dipole of diffusion theory.

    Parameters
    ----------
    reduced_albedo : array_like
        sigma_s'/(sigma_a + sigma_s') with sigma_s' = sigma_s (1 - g), in [0, 1].
    index : array_like
        Index of the half-space over that outside, in [0.1, 10].

    References
    ----------
    Jensen, Marschner, Levoy & Hanrahan, A Practical Model for Subsurface Light Transport, 2001, section 4.2.
    """
    return _mapped(_aureole.dipole_reflectance, reduced_albedo=real("reduced_albedo", reduced_albedo, minimum=0, maximum=1),
                   index=real("index", index, minimum=0.1, maximum=10))


def dipole_albedo(reflectance: npt.ArrayLike, index: npt.ArrayLike = 1.0) -> Any:
    """Reduced albedo at which `dipole_reflectance` is `reflectance`, in [0, 1]: its inverse."""
    return _mapped(_aureole.dipole_albedo, reflectance=real("reflectance", reflectance, minimum=0, maximum=1),
                   index=real("index", index, minimum=0.1, maximum=10))
