# SPDX-License-Identifier: Apache-2.0
"""The physics of the renderer as functions of arrays: spheres, interfaces, openings, positions of scatterers, diffraction, layers.

All functions broadcast as numpy does, take anything that `numpy.asarray` takes, compute in double precision on all
cores and can be interrupted. Wrong arguments are an `aureole.Error` or a TypeError that names them. Angles are given
by their cosines; lengths of openings are in metres, lengths of points are in the caller's unit.
"""
from __future__ import annotations

from typing import Any, NamedTuple, Tuple

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._apertures import annulus, circle, ellipse, mask, ngon, polygon, rectangle, star
from ._arrays import complex_numbers, real
from ._aureole import ApertureShape
from ._correlations import (HardDiscs, PairCorrelation, PointStructureFactor, StructureFactor,
                            hard_disc_pair_correlation, hard_discs, pair_correlation, point_structure_factor,
                            structure_factor)
from ._diffraction import (RadioMaterial, faddeeva, fraunhofer, fresnel_integral, keller_coefficient, kirchhoff, knife_edge,
                           plane_wave_distance, plane_wave_spreading, point_source_distance, point_source_spreading,
                           radio_materials, radio_permittivity, rayleigh_sommerfeld, transition_function, utd_coefficient,
                           utd_field)
from ._edge_kernels import (diffracted_intensity, drawn_edge_kernels, mean_edge_kernel, mean_edge_powers, straight_edge_corrections,
                            straight_edge_kernels, straight_edge_power, straight_edge_power_correction, straight_edge_weights)
from ._edge_waves import (AmplitudeMoments, EdgeConstants, EdgeWaves, amplitude_moments, edge_alpha1, edge_alpha2, edge_constants,
                          gaussian_beam_power, interfering_power, mean_edge_sigma, triangle_power, triangle_transform,
                          zeroth_order_power)
from ._errors import Error
from ._media import (absorptance, absorption_of_decadic, absorption_of_index, absorption_of_mass,
                     absorption_of_molar, absorption_of_napierian, absorption_of_number, air_cross_section,
                     air_depolarization, air_refractivity, cross_section_of_molar, decadic_absorbance, dipole_albedo,
                     dipole_reflectance, hard_sphere_structure_factor, henyey_greenstein, index_of_absorption,
                     napierian_absorbance, rayleigh_phase, transmittance, transmittance_of_decadic,
                     transmittance_of_napierian, water_scattering)
from ._radiometry import (MesopicLuminance, SolidAngle, disc_solid_angle, etendue, exitance_of_radiance, flux_of_intensity,
                         intensity_of_radiance, irradiance_of_intensity, irradiance_of_radiance, mesopic_luminance,
                         photon_energy, photons, polygon_solid_angle, radiance_of_exitance, radiance_of_intensity,
                         radiance_of_irradiance, solid_angle, sphere_solid_angle, unified_glare_rating)
from ._sizes import SizeDistribution, size_distribution
from ._stack import PlaneStack, StackFields, StackFluxes, StackLayer
from ._vectorised import broadcast, limit_results, shaped

__all__ = ["AmplitudeMoments", "ApertureShape", "EdgeConstants", "EdgeWaves", "Fresnel", "HardDiscs",
           "MesopicLuminance", "Mie", "PairCorrelation", "PlaneStack", "PointStructureFactor", "RadioMaterial",
           "SizeDistribution", "SlabPowers", "SolidAngle", "StackFields", "StackFluxes", "StackLayer",
           "StructureFactor", "absorptance", "absorption_of_decadic", "absorption_of_index", "absorption_of_mass",
           "absorption_of_molar", "absorption_of_napierian", "absorption_of_number", "air_cross_section",
           "air_depolarization", "air_refractivity", "amplitude_moments", "annulus", "circle",
           "cross_section_of_molar", "decadic_absorbance", "diffracted_intensity", "dipole_albedo",
           "dipole_reflectance", "disc_solid_angle", "drawn_edge_kernels", "edge_alpha1", "edge_alpha2",
           "edge_constants", "ellipse", "etendue", "exitance_of_radiance", "faddeeva", "flux_of_intensity",
           "fraunhofer", "fresnel", "fresnel_diffuse_reflectance", "fresnel_integral", "gaussian_beam_power",
           "hard_disc_pair_correlation", "hard_discs", "hard_sphere_structure_factor", "henyey_greenstein",
           "index_of_absorption", "intensity_of_radiance", "interfering_power", "irradiance_of_intensity",
           "irradiance_of_radiance", "keller_coefficient", "kirchhoff", "knife_edge", "mask", "mean_edge_kernel",
           "mean_edge_powers", "mean_edge_sigma", "mesopic_luminance", "mie", "mie_amplitudes", "mie_phase_function",
           "napierian_absorbance", "ngon", "pair_correlation", "photon_energy", "photons", "plane_wave_distance",
           "plane_wave_spreading", "point_source_distance", "point_source_spreading", "point_structure_factor",
           "polygon", "polygon_solid_angle", "radiance_of_exitance", "radiance_of_intensity",
           "radiance_of_irradiance", "radio_materials", "radio_permittivity", "rayleigh_phase",
           "rayleigh_sommerfeld", "rectangle", "size_distribution", "slab_powers", "solid_angle",
           "sphere_solid_angle", "star", "straight_edge_corrections", "straight_edge_kernels", "straight_edge_power",
           "straight_edge_power_correction", "straight_edge_weights", "structure_factor", "thin_slab_reflectance",
           "transition_function", "transmittance", "transmittance_of_decadic", "transmittance_of_napierian",
           "triangle_power", "triangle_transform", "unified_glare_rating", "utd_coefficient", "utd_field",
           "water_scattering", "zeroth_order_power"]

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


class Mie(NamedTuple):
    """Result of `mie`: arrays of one shape. Efficiencies are cross sections over pi radius^2.

    Attributes
    ----------
    qext, qsca, qabs : numpy.ndarray
        Extinction, scattering, and absorption, which is their difference.
    qback : numpy.ndarray
        Backscattering as in radar: 4 pi times the differential efficiency.
    g : numpy.ndarray
        Mean cosine of the scattering angle.
    """

    qext: Reals
    qsca: Reals
    qabs: Reals
    qback: Reals
    g: Reals


class Fresnel(NamedTuple):
    """Result of `fresnel`: arrays of one shape.

    Attributes
    ----------
    rs, rp, ts, tp : numpy.ndarray of complex128
        Ratios of amplitudes of the electric field, reflected and transmitted, for the polarisations perpendicular (s)
        and parallel (p) to the plane of incidence.
    cos_t : numpy.ndarray of complex128
        Cosine of the refracted direction, complex where the wave decays.
    reflectance, transmittance : numpy.ndarray of float64
        Fractions of the power of unpolarised light that the interface reflects and transmits; their sum is 1.
    """

    rs: Complexes
    rp: Complexes
    ts: Complexes
    tp: Complexes
    cos_t: Complexes
    reflectance: Reals
    transmittance: Reals


def mie(x: npt.ArrayLike, m: npt.ArrayLike) -> Mie:
    """Efficiencies and asymmetry of homogeneous spheres (Mie's theory).

    Parameters
    ----------
    x : array_like
        Size parameter 2 pi radius n_medium/wavelength (wavelength in vacuum), in [1e-6, 1e5].
    m : array_like of real or complex numbers
        Index of the sphere over that of the medium, n + i k with k >= 0 where the sphere absorbs (time dependence
        exp(-i omega t)). Values n - i k of the other convention are refused: take `numpy.conj` of them. Re m > 0,
        |m| in [1e-6, 100].

    Returns
    -------
    Mie
        Of the shape that `x` and `m` broadcast to.

    Notes
    -----
    Time and memory grow with x, time with |m| x, too: some 2 us at x = 10, 10 ms at x = 1e5.

    References
    ----------
    Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, chapter 4; number of terms:
    Wiscombe, "Improved Mie scattering algorithms", 1980.

    Examples
    --------
    >>> from aureole import optics
    >>> drop = optics.mie([1, 10, 100], 1.33 + 1e-5j)
    >>> drop.qext.round(4)
    array([0.094 , 2.2066, 2.1013])
    """
    shape, (size, index) = _spheres(x, m)
    result = np.empty((4, size.size))
    _aureole.mie(size, index, result)
    qext, qsca, qback, g = (shaped(row, shape) for row in result)
    return Mie(qext, qsca, qext - qsca, qback, g)


def mie_amplitudes(x: npt.ArrayLike, m: npt.ArrayLike, mu: npt.ArrayLike) -> Tuple[Complexes, Complexes]:
    """Scattering amplitudes S1, S2 of homogeneous spheres.

    Parameters
    ----------
    x, m : array_like
        As in `mie`.
    mu : array_like
        Cosine of the angle between the directions before and after, in [-1, 1]. Every sphere is evaluated at every
        `mu`, from one set of coefficients.

    Returns
    -------
    s1, s2 : numpy.ndarray of complex128, shape ``broadcast(x, m).shape + mu.shape``
        For light polarised across (s1) and in (s2) the plane of scattering, in the convention of Bohren & Huffman:
        the differential cross section of unpolarised light is (|s1|^2 + |s2|^2)/(2 k^2) with k = 2 pi
        n_medium/wavelength, and qext = 4/x^2 Re s1(mu = 1).

    References
    ----------
    Bohren & Huffman 1983, equation 4.74.

    Examples
    --------
    >>> import numpy as np
    >>> from aureole import optics
    >>> s1, s2 = optics.mie_amplitudes([1, 5], 1.5, np.linspace(-1, 1, 181))
    >>> s1.shape
    (2, 181)
    """
    shape, (size, index) = _spheres(x, m)
    cosine = real("mu", mu, minimum=-1, maximum=1)
    limit_results("x, m and mu", shape, cosine.shape)
    count = size.size * cosine.size
    s1, s2 = np.empty(count, np.complex128), np.empty(count, np.complex128)
    _aureole.mie_amplitudes(size, index, np.ascontiguousarray(cosine).reshape(-1), s1, s2)
    return shaped(s1, shape + cosine.shape), shaped(s2, shape + cosine.shape)


def mie_phase_function(x: npt.ArrayLike, m: npt.ArrayLike, mu: npt.ArrayLike) -> Reals:
    """Phase function of homogeneous spheres for unpolarised light.

    Parameters
    ----------
    x, m, mu : array_like
        As in `mie_amplitudes`. Spheres of m = 1 (to 1e-10), which scatter nothing, are an error.

    Returns
    -------
    numpy.ndarray, shape ``broadcast(x, m).shape + mu.shape``
        In 1/sr, such that its integral over all directions is 1: 2 pi times the integral over mu in [-1, 1].
        (|S1|^2 + |S2|^2)/(2 pi x^2 qsca), Bohren & Huffman 1983, sections 3.4 and 4.4.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.mie_phase_function(1e-3, 1.5, [0, 1]).round(4)  # Rayleigh: 3/(16 pi) (1 + mu^2)
    array([0.0597, 0.1194])
    """
    shape, (size, index) = _spheres(x, m)
    _refuse("m", index, abs(index - 1) < 1e-10, "a sphere that scatters")
    cosine = real("mu", mu, minimum=-1, maximum=1)
    limit_results("x, m and mu", shape, cosine.shape)
    result = np.empty(size.size * cosine.size)
    _aureole.mie_phase_function(size, index, np.ascontiguousarray(cosine).reshape(-1), result)
    return shaped(result, shape + cosine.shape)  # type: ignore[no-any-return]


def fresnel(cos_theta: npt.ArrayLike, eta: npt.ArrayLike) -> Fresnel:
    """Reflection and refraction of a plane wave at a flat interface, of dielectrics and conductors.

    Parameters
    ----------
    cos_theta : array_like
        Cosine of the angle of incidence, in [0, 1]; rounding errors beyond, up to 1e-6, are clamped.
    eta : array_like of real or complex numbers
        Index behind the interface over that in front of it, n + i k with k >= 0 (time dependence exp(-i omega t); take
        `numpy.conj` of n - i k). Real: a dielectric; below 1 the light comes from the denser side, with total
        reflection beyond the critical angle. Complex: a conductor. n >= 0, |eta| in [1e-6, 1e6].

    Returns
    -------
    Fresnel
        The p axes are such that rp = -rs and tp = ts at normal incidence. The parts of power that pass are
        Re(eta cos_t) |ts|^2/cos_theta and Re(eta conj(cos_t)) |tp|^2/cos_theta.

    References
    ----------
    Born & Wolf, Principles of Optics, 7th ed. 1999, 1.5.2 equations 20 and 21; 1.5.4; 14.2.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.fresnel([1, 0.5], 1.5).reflectance.round(4)
    array([0.04  , 0.0892])
    >>> optics.fresnel([1, 0.5], 0.2 + 3.4j).reflectance.round(3)  # a metal
    array([0.938, 0.933])
    """
    cosine = real("cos_theta", cos_theta, minimum=-1e-6, maximum=1 + 1e-6)
    index = _refractive("eta", eta)
    shape, (flat_cosine, flat_index) = broadcast(cos_theta=cosine, eta=index)
    amplitudes, power = np.empty((5, flat_cosine.size), np.complex128), np.empty((2, flat_cosine.size))
    _aureole.fresnel(flat_cosine, flat_index, amplitudes, power)
    return Fresnel(*(shaped(row, shape) for row in amplitudes), *(shaped(row, shape) for row in power))


class SlabPowers(NamedTuple):
    """Result of `slab_powers`: fractions of the incident power, arrays of one shape whose sum is 1.

    Attributes
    ----------
    reflected, transmitted, absorbed : numpy.ndarray
    """

    reflected: Reals
    transmitted: Reals
    absorbed: Reals


def slab_powers(cos_theta: npt.ArrayLike, index: npt.ArrayLike, thickness: npt.ArrayLike, *,
                outside: npt.ArrayLike = 1.0) -> SlabPowers:
    """Unpolarised power that a slab with parallel faces reflects and transmits, with interference of all reflections in it.

    Parameters
    ----------
    cos_theta : array_like
        Cosine of the angle of incidence, in [0, 1]; rounding errors beyond, up to 1e-6, are clamped.
    index : array_like of real or complex numbers
        Index of the slab, n + i k with k >= 0 (time dependence exp(-i omega t)); n >= 0, modulus in [1e-6, 1e6].
    thickness : array_like
        Of the slab, in wavelengths in vacuum; positive.
    outside : array_like
        Index on both sides of the slab, in [1e-3, 1e3].

    Returns
    -------
    SlabPowers

    References
    ----------
    Born & Wolf, Principles of Optics, 7th ed. 1999, 1.6.4 and 14.4; Recommendation ITU-R P.2040-3, 2.2.2.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.slab_powers(1, 1.5, [0.5 / 3, 1 / 3]).reflected.round(4)  # a quarter and half of a wavelength within the slab
    array([0.1479, 0.    ])
    """
    cosine = real("cos_theta", cos_theta, minimum=-1e-6, maximum=1 + 1e-6)
    slab = _refractive("index", index)
    shape, (flat_cosine, flat_slab, flat_thickness, flat_outside) = broadcast(
        cos_theta=cosine, index=slab, thickness=real("thickness", thickness, positive=True),
        outside=real("outside", outside, minimum=1e-3, maximum=1e3))
    power = np.empty((2, flat_cosine.size))
    _aureole.slab_powers(flat_cosine, flat_slab, flat_thickness, flat_outside, power)
    return SlabPowers(*(shaped(row, shape) for row in (*power, np.maximum(1 - power[0] - power[1], 0.0))))


def thin_slab_reflectance(cos_theta: npt.ArrayLike, eta: npt.ArrayLike) -> Reals:
    """Unpolarised power that a lossless slab reflects, all interreflections added as powers: 2 R/(1 + R) with R of
    one face.

    The slab is thicker than the coherence length of the light; `slab_powers` has interference.

    Parameters
    ----------
    cos_theta : array_like
        Cosine of the angle of incidence, in [0, 1]; rounding errors beyond, up to 1e-6, are clamped.
    eta : array_like
        Index of the slab over the index outside, in [1e-3, 1e3].

    Examples
    --------
    >>> from aureole import optics
    >>> float(optics.thin_slab_reflectance(1, 1.5).round(4))
    0.0769
    """
    shape, (cosine, index) = broadcast(cos_theta=real("cos_theta", cos_theta, minimum=-1e-6, maximum=1 + 1e-6),
                                       eta=real("eta", eta, minimum=1e-3, maximum=1e3))
    result = np.empty(cosine.size)
    _aureole.thin_slab_reflectance(cosine, index, result)
    return shaped(result, shape)  # type: ignore[no-any-return]


def fresnel_diffuse_reflectance(eta: npt.ArrayLike) -> Reals:
    """Reflected part of ideally diffuse unpolarised light at the interface of dielectrics.

    Parameters
    ----------
    eta : array_like
        Index behind the interface over that in front of it, in [1e-3, 1e3].

    Returns
    -------
    numpy.ndarray
        Integral of 2 mu R(mu) over mu in [0, 1], by quadrature with an error below 1e-9.

    Examples
    --------
    >>> from aureole import optics
    >>> optics.fresnel_diffuse_reflectance([1.5, 1 / 1.5]).round(4)
    array([0.0918, 0.5963])
    """
    index = real("eta", eta, minimum=1e-3, maximum=1e3)
    shape, (flat,) = broadcast(eta=index)
    result = np.empty(flat.size)
    _aureole.fresnel_diffuse_reflectance(flat, result)
    return shaped(result, shape)  # type: ignore[no-any-return]


def _refractive(name: str, value: Any) -> Complexes:
    index = complex_numbers(name, value)
    modulus = np.abs(index)
    wrong = (index.real < 0) | (index.imag < 0) | (modulus < 1e-6) | (modulus > 1e6)
    _refuse(name, index, wrong, "n + i k with n >= 0, k >= 0 and a modulus in [1e-6, 1e6]")
    return index


def _spheres(x: Any, m: Any) -> Tuple[Tuple[int, ...], Tuple[npt.NDArray[Any], ...]]:
    size = real("x", x, minimum=1e-6, maximum=1e5)
    index = complex_numbers("m", m)
    _refuse("m", index, index.imag < 0, "n + i k with k >= 0 (time dependence exp(-i omega t); numpy.conj turns the "
                                        "other convention into this one)")
    _refuse("m", index, ~(index.real > 0) | (np.abs(index) < 1e-6) | (np.abs(index) > 100),
            "a positive real part and a modulus in [1e-6, 100]")
    return broadcast(x=size, m=index)


def _refuse(name: str, values: npt.NDArray[Any], wrong: npt.NDArray[np.bool_], expected: str) -> None:
    if np.any(wrong):
        raise Error(f"{name}: expected {expected}, got {values[wrong].flat[0]}")
