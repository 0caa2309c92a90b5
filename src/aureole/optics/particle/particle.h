// SPDX-License-Identifier: Apache-2.0
// Optical properties of particles of any kind: cross sections and differential scattering. `Particle` is one
// particle at one wavelength; `ParticleKind` makes it for a radius.
//
// The surrounding medium is treated as lossless: only its real index enters. (In an absorbing medium the far
// field of a particle has no cross sections that add; Mishchenko, Optics Express 15 (2007) 13188.) The
// medium's own absorption is added to the coefficients of the whole. This is accurate if the medium absorbs
// little over the size of a particle.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <span>

namespace aureole::optics {

/// A quantity that depends on the wavelength in vacuum, in nm.
using SpectralFunction = std::function<double(double lambda_nm)>;
/// Refractive index n + i k of a material, k >= 0 where it absorbs.
using IndexFunction = std::function<std::complex<double>(double lambda_nm)>;

class Particle {
public:
  virtual ~Particle() = default;

  virtual double extinction() const = 0;  ///< extinction cross section [m^2]
  virtual double scattering() const = 0;  ///< scattering cross section [m^2]
  double absorption() const { return extinction() - scattering(); }
  virtual double geometric() const = 0;  ///< geometric cross section, m^2
  /// Returns the absorption cross section, m^2, averaged over radii that differ from this one by up to the
  /// fraction `half_width`; narrow resonances within that range are included. `below` and `above` are
  /// particles of the same kind whose radii differ by the same small fraction, such as 1e-5.
  virtual double mean_absorption(const Particle& /*below*/, const Particle& /*above*/,
                                 double /*half_width*/) const {
    return absorption();
  }
  double albedo() const { return extinction() > 0 ? scattering() / extinction() : 1; }
  /// Mean cosine of the scattering angle.
  virtual double asymmetry() const = 0;

  // Efficiencies: cross sections over the geometric cross section.
  double extinction_efficiency() const { return extinction() / geometric(); }
  double scattering_efficiency() const { return scattering() / geometric(); }
  double absorption_efficiency() const { return absorption() / geometric(); }

  /// Computes the differential scattering cross section of unpolarised light, m^2/sr, at cosines of the
  /// scattering angle and, unless `mirrored` is empty, at their negatives. Its integral over the sphere is
  /// `scattering()`. All spans have one size.
  virtual void differential(std::span<const double> mu, std::span<double> at,
                            std::span<double> mirrored = {}) const = 0;
  double differential(double mu) const {
    double value;
    differential(std::span(&mu, 1), std::span(&value, 1));
    return value;
  }
};

class ParticleKind {
public:
  virtual ~ParticleKind() = default;
  /// Makes a particle of the outer `radius` (m) in a medium of real index `host`. Throws std::domain_error
  /// outside the range of the theory.
  virtual std::unique_ptr<const Particle> make(double radius, double lambda_nm, double host) const = 0;
  /// Estimates the absorption cross section, m^2, of a particle of the outer `radius` (m): rays pass it
  /// straight, without refraction, on its mean chord. The ratio of absorption to this estimate varies less
  /// with the wavelength than absorption alone, since both follow the absorption of the material.
  virtual double straight_absorption(double /*radius*/, double /*lambda_nm*/) const { return 0; }
};

/// Makes homogeneous spheres (Mie theory).
std::shared_ptr<const ParticleKind> sphere_kind(IndexFunction index);

/// Makes spheres with a coat; the core's radius is `core_fraction` in (0, 1) times the outer radius.
std::shared_ptr<const ParticleKind> coated_sphere_kind(IndexFunction core, IndexFunction coat,
                                                       double core_fraction);
/// Makes spheres with a coat of fixed `thickness` in m; particles not larger than that consist of coat alone.
std::shared_ptr<const ParticleKind> thin_coated_sphere_kind(IndexFunction core, IndexFunction coat,
                                                            double thickness);

/// Makes spheres much smaller than the wavelength (`RayleighSphere`), whatever their size.
std::shared_ptr<const ParticleKind> rayleigh_kind(IndexFunction index, double depolarization = 0);

}  // namespace aureole::optics
