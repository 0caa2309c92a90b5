// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/particle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/particle/coated_mie.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "aureole/optics/particle/rayleigh_scattering.h"

namespace aureole::optics {
namespace {

/// Below this size parameter 2 pi radius n/lambda two terms of the Rayleigh series have errors below 1e-8.
constexpr double kSmall = 1e-3;

/// Adapts the series of a sphere to the interface `Particle`, with cross sections in m^2.
template <class Series>
class SphereParticle final : public Particle {
public:
  SphereParticle(Series series, double radius)
      : series_(std::move(series)),
        geometric_(kPi * radius * radius),
        per_steradian_(radius * radius / (series_.size() * series_.size())) {}

  double extinction() const override { return series_.extinction() * geometric_; }
  double scattering() const override { return series_.scattering() * geometric_; }
  double geometric() const override { return geometric_; }
  double mean_absorption(const Particle& below, const Particle& above, double half_width) const override {
    const auto *smaller = dynamic_cast<const SphereParticle*>(&below),
               *larger = dynamic_cast<const SphereParticle*>(&above);
    if (!smaller || !larger) return absorption();
    return series_.mean_absorption(smaller->series_, larger->series_, half_width * series_.size()) *
           geometric_;
  }
  double asymmetry() const override { return series_.asymmetry(); }
  void differential(std::span<const double> mu, std::span<double> at,
                    std::span<double> mirrored) const override {
    series_.intensities(mu, at, mirrored);
    for (double& v : at) v *= per_steradian_;
    for (double& v : mirrored) v *= per_steradian_;
  }

private:
  Series series_;
  double geometric_, per_steradian_;
};

/// Returns the fraction of light that a sphere absorbs along its mean chord, 4/3 radius, times its projected area. `k`
/// is the mean imaginary part of its index.
double absorbed_on_mean_chord(double radius, double k, double lambda_nm) {
  const double absorption = 4 * kPi * k / (lambda_nm * 1e-9);  // 1/m
  return -kPi * radius * radius * std::expm1(-absorption * 4 / 3 * radius);
}

double size_parameter(double radius, double lambda_nm, double host) {
  if (!(lambda_nm > 0 && std::isfinite(lambda_nm)))
    throw std::domain_error("wavelength must be positive and finite, got " + std::to_string(lambda_nm) +
                            " nm");
  if (!(host > 0 && std::isfinite(host)))
    throw std::domain_error("index of the medium around particles must be positive, got " +
                            std::to_string(host));
  return 2 * kPi * radius * host / (lambda_nm * 1e-9);
}

class SphereKind final : public ParticleKind {
public:
  explicit SphereKind(IndexFunction index) : index_(std::move(index)) {}
  std::unique_ptr<const Particle> make(double radius, double lambda_nm, double host) const override {
    const double x = size_parameter(radius, lambda_nm, host);
    const std::complex<double> n = index_(lambda_nm);
    if (x < kSmall && std::abs(n / host) < 10)
      return std::make_unique<RayleighSphere>(radius, lambda_nm, n, host);
    return std::make_unique<SphereParticle<Mie>>(Mie(x, n / host), radius);
  }
  double straight_absorption(double radius, double lambda_nm) const override {
    return absorbed_on_mean_chord(radius, index_(lambda_nm).imag(), lambda_nm);
  }

private:
  IndexFunction index_;
};

class CoatedSphereKind final : public ParticleKind {
public:
  CoatedSphereKind(IndexFunction core, IndexFunction coat, std::function<double(double)> core_radius)
      : core_(std::move(core)), coat_(std::move(coat)), core_radius_(std::move(core_radius)) {}
  std::unique_ptr<const Particle> make(double radius, double lambda_nm, double host) const override {
    const double x = size_parameter(radius, lambda_nm, host), core = core_radius_(radius);
    const std::complex<double> coat = coat_(lambda_nm) / host;
    if (!(core > 0)) return std::make_unique<SphereParticle<Mie>>(Mie(x, coat), radius);
    return std::make_unique<SphereParticle<CoatedMie>>(
        CoatedMie(x * core / radius, x, core_(lambda_nm) / host, coat), radius);
  }
  double straight_absorption(double radius, double lambda_nm) const override {
    const double part = std::pow(std::max(core_radius_(radius) / radius, 0.0), 3);
    return absorbed_on_mean_chord(radius, std::lerp(coat_(lambda_nm).imag(), core_(lambda_nm).imag(), part),
                                  lambda_nm);
  }

private:
  IndexFunction core_, coat_;
  std::function<double(double)> core_radius_;
};

class RayleighKind final : public ParticleKind {
public:
  RayleighKind(IndexFunction index, double rho) : index_(std::move(index)), rho_(rho) { king_factor(rho); }
  std::unique_ptr<const Particle> make(double radius, double lambda_nm, double host) const override {
    return std::make_unique<RayleighSphere>(radius, lambda_nm, index_(lambda_nm), host, rho_);
  }
  double straight_absorption(double radius, double lambda_nm) const override {
    return absorbed_on_mean_chord(radius, index_(lambda_nm).imag(), lambda_nm);
  }

private:
  IndexFunction index_;
  double rho_;
};

}  // namespace

std::shared_ptr<const ParticleKind> sphere_kind(IndexFunction index) {
  return std::make_shared<SphereKind>(std::move(index));
}

std::shared_ptr<const ParticleKind> coated_sphere_kind(IndexFunction core, IndexFunction coat,
                                                       double core_fraction) {
  if (!(core_fraction > 0 && core_fraction < 1))
    throw std::domain_error("radius of the core over that of the whole must be in (0, 1), got " +
                            std::to_string(core_fraction));
  return std::make_shared<CoatedSphereKind>(std::move(core), std::move(coat),
                                            [=](double radius) { return core_fraction * radius; });
}

std::shared_ptr<const ParticleKind> thin_coated_sphere_kind(IndexFunction core, IndexFunction coat,
                                                            double thickness) {
  if (!(thickness > 0 && std::isfinite(thickness)))
    throw std::domain_error("thickness of a coat must be positive, got " + std::to_string(thickness) + " m");
  return std::make_shared<CoatedSphereKind>(std::move(core), std::move(coat),
                                            [=](double radius) { return radius - thickness; });
}

std::shared_ptr<const ParticleKind> rayleigh_kind(IndexFunction index, double depolarization) {
  return std::make_shared<RayleighKind>(std::move(index), depolarization);
}

}  // namespace aureole::optics
