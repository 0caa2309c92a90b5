// SPDX-License-Identifier: Apache-2.0
// Reflection and refraction of a plane wave at a flat interface (Born & Wolf, Principles of Optics, 7th ed.
// 1999, sections 1.5.2, 1.5.4 and 14.2).
//
// Conventions. Time dependence exp(-i omega t), so an absorbing medium has n = eta + i k with k >= 0. The
// wave comes from a lossless medium n_i. All cosines are between a direction and the normal on its own side,
// in [0, 1]; values less than 1e-6 outside count as rounding errors and are clamped. Indices are
// dimensionless. Every function throws std::domain_error, with the value, for a cosine or an index out of its
// range.
#pragma once

#include <complex>

namespace aureole::optics {

/// Ratios of complex electric-field amplitudes to the incident amplitude, for polarisation perpendicular (s)
/// and parallel (p) to the plane of incidence, and the complex cosine of the transmitted wave.
struct FresnelAmplitudes {
  std::complex<double> r_s, r_p, t_s, t_p;
  std::complex<double> cos_t;
};

/// Fresnel's formulae (Born & Wolf 1999, 1.5.2 equations 20 and 21), with the p axes such that at normal
/// incidence r_p = -r_s and t_p = t_s. `n_t` is real (k = 0) for a dielectric and complex for a conductor.
/// Beyond the critical angle the amplitudes of reflection have modulus 1 and the phases of total internal
/// reflection, and cos_t is on the branch of a wave that decays away from the interface. The transmitted
/// fractions of power are Re(n_t cos_t) |t_s|^2 / (n_i cos_i) and Re(n_t conj(cos_t)) |t_p|^2 / (n_i cos_i).
FresnelAmplitudes fresnel_amplitudes(double cos_i, double n_i, std::complex<double> n_t);

/// Returns the reflected fraction of unpolarised power at a dielectric interface, (|r_s|^2 + |r_p|^2)/2; 1
/// beyond the critical angle.
double fresnel_reflectance(double cos_i, double n_i, double n_t);

/// Returns the reflected fraction of unpolarised power at a conductor of index n_t = eta + i k.
double fresnel_reflectance_conductor(double cos_i, double n_i, std::complex<double> n_t);

/// Returns the reflected fraction of unpolarised power of a lossless thin slab, with all interreflections
/// added incoherently: R + T^2 R/(1 - R^2) = 2R/(1 + R). R is the reflectance of one face for unpolarised
/// light and T = 1 - R. The slab is thicker than the coherence length and thin compared to everything else.
/// The model is that of `thindielectric` in Mitsuba 3 (Jakob et al. 2022), which does not follow the two
/// polarisations through the slab either. `n_ext` is the index outside, `n_int` the slab's.
double thin_slab_reflectance(double cos_i, double n_ext, double n_int);

/// Ratios of the complex electric-field amplitudes that a slab reflects and transmits to the incident one; axes as for
/// FresnelAmplitudes.
struct SlabAmplitudes {
  std::complex<double> r_s, r_p, t_s, t_p;
};

/// Returns the amplitudes of a slab with parallel faces, with interference of all reflections within it (Born & Wolf 1999, 1.6.4
/// equations 57 to 60 and 14.4), both measured at the face that each wave leaves. Arguments and errors are those of `slab_powers`.
SlabAmplitudes slab_amplitudes(double cos_i, double n_ext, std::complex<double> n_slab, double thickness);

/// Fractions of the power of a plane wave that a slab reflects and transmits. The rest is absorbed.
struct SlabPowers {
  double reflected = 0, transmitted = 0;
};

/// Returns the fractions of unpolarised power that a slab with parallel faces reflects and transmits, with interference
/// of all reflections within it (Born & Wolf 1999, 1.6.4 equations 57 to 60 and 14.4; Recommendation ITU-R P.2040-3,
/// section 2.2.2, a single layer). The result is the mean over both polarisations. `n_ext` is the index on
/// both sides, `n_slab` = eta + i k the index of the slab, `thickness` is a multiple of the wavelength in
/// vacuum. Throws std::domain_error, also for a thickness that is not positive and finite.
SlabPowers slab_powers(double cos_i, double n_ext, std::complex<double> n_slab, double thickness);
/// Returns the fractions of unpolarised power from the amplitudes of both polarisations.
SlabPowers slab_powers(const SlabAmplitudes& amplitudes);

/// Returns the reflectance for ideally diffuse unpolarised light, the integral of 2 R(mu) mu over mu in [0,
/// 1]. `eta` is the index beyond the interface over the index on the incident side: eta > 1 is the "external"
/// and eta < 1 the "internal" diffuse reflectance. The quadrature error is below 1e-9.
double fresnel_diffuse_reflectance(double eta);

}  // namespace aureole::optics
