// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/suspension_model.h"

#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "aureole/optics/constants.h"
#include "aureole/optics/particle/hard_spheres.h"
#include "aureole/optics/particle/rayleigh_scattering.h"

namespace aureole::optics {
namespace {

/// The molecules of a medium as particles: the coefficient in 1/m is the cross section in m^2 at one particle
/// per m^3.
class Molecules final : public ParticleKind {
public:
  explicit Molecules(const ClearMedium& medium)
      : scattering_(medium.scattering), depolarization_(medium.depolarization) {}

  std::unique_ptr<const Particle> make(double, double lambda_nm, double) const override {
    return std::make_unique<One>(scattering_(lambda_nm), depolarization_ ? depolarization_(lambda_nm) : 0);
  }

private:
  class One final : public Particle {
  public:
    One(double scattering, double rho) : scattering_(scattering), rho_(rho) {}
    double extinction() const override { return scattering_; }
    double scattering() const override { return scattering_; }
    double geometric() const override { return scattering_; }
    double asymmetry() const override { return 0; }
    void differential(std::span<const double> mu, std::span<double> at,
                      std::span<double> mirrored) const override {
      for (std::size_t i = 0; i < mu.size(); ++i) {
        at[i] = scattering_ * rayleigh_phase(mu[i], rho_);
        if (!mirrored.empty()) mirrored[i] = at[i];
      }
    }

  private:
    double scattering_, rho_;
  };
  SpectralFunction scattering_, depolarization_;
};

[[noreturn]] void fail(const std::string& what, double value) {
  std::ostringstream text;
  text << what << ", got " << value;
  throw std::domain_error(text.str());
}

}  // namespace

Suspension::Suspension(ClearMedium host, std::vector<Ingredient> ingredients)
    : host_(std::move(host)), ingredients_(std::move(ingredients)) {
  if (!host_.index) throw std::domain_error("the medium around particles needs a refractive index");
  // Volume fractions f = w rho/rho_particles of ingredients by mass depend on the total density rho. The
  // total density solves rho = sum over the other ingredients of f rho_particles + rho sum w + (1 - sum f)
  // rho_host.
  double by_mass = 0, specific_volume = 0, others = 0, others_mass = 0;
  for (const Ingredient& i : ingredients_) {
    const std::string name = i.name.empty() ? "particles" : i.name;
    if (!i.particles) throw std::domain_error("the ingredient " + name + " has no particles");
    const double value = i.amount.value;
    if (!(value >= 0 && std::isfinite(value))) fail("amount of " + name + " must not be negative", value);
    if (i.amount.kind == Amount::Kind::mass) {
      if (value > 1) fail("mass fraction of " + name + " must be in [0, 1]", value);
      if (!(i.density > 0))
        throw std::domain_error("a mass fraction of " + name + " needs the density of its material");
      if (!(host_.density > 0))
        throw std::domain_error("a mass fraction of " + name + " needs the density of the medium");
      by_mass += value, specific_volume += value / i.density;
    } else {
      const double f = i.amount.kind == Amount::Kind::volume ? value : value * i.radii.mean_volume();
      others += f, others_mass += f * i.density;
    }
  }
  if (by_mass > 1) fail("mass fractions must sum to at most 1", by_mass);
  double density = 0;
  if (by_mass > 0) {
    for (const Ingredient& i : ingredients_)
      if (i.amount.kind != Amount::Kind::mass && !(i.density > 0))
        throw std::domain_error("mass fractions beside " + i.name + " need the density of its material");
    density = (others_mass + (1 - others) * host_.density) / (1 - by_mass + host_.density * specific_volume);
  }
  double total = 0;
  for (const Ingredient& i : ingredients_) {
    const double volume = i.radii.mean_volume(), value = i.amount.value;
    const double number = i.amount.kind == Amount::Kind::number   ? value
                          : i.amount.kind == Amount::Kind::volume ? value / volume
                                                                  : value * density / i.density / volume;
    const double fraction = number * volume;
    if (i.hard_spheres && fraction > kMaxHardSphereFraction)
      fail("hard spheres of " + i.name + " must fill at most 0.6 of the volume", fraction);
    total += fraction;
    if (!(total <= kClosestSpherePacking))
      fail("more particles than fit: " + i.name +
               " must leave the volume below the closest packing of spheres, 0.74",
           total);
    populations_.push_back({i.particles, i.radii, number, i.hard_spheres});
  }
}

double Suspension::volume_fraction() const {
  double sum = 0;
  for (const ParticlePopulation& p : populations_) sum += p.volume_fraction();
  return sum;
}

double Suspension::density() const {
  if (!(host_.density > 0)) return 0;
  double sum = (1 - volume_fraction()) * host_.density;
  for (std::size_t i = 0; i < ingredients_.size(); ++i) {
    if (!(ingredients_[i].density > 0)) return 0;
    sum += volume_fraction(i) * ingredients_[i].density;
  }
  return sum;
}

double Suspension::straight_absorption(double lambda_nm) const {
  double sum = 0;
  for (const ParticlePopulation& p : populations_) {
    const double radius = p.radii.effective_radius();
    sum += p.volume_fraction() / (4 * kPi / 3 * radius * radius * radius) *
           p.kind->straight_absorption(radius, lambda_nm);
  }
  return sum;
}

MediumSpectrum Suspension::spectrum(const std::vector<double>& lambda_nm, bool with_phases,
                                    const EnsembleAccuracy& accuracy, const ParallelFor& parallel_for,
                                    const TellProgress& progress) const {
  const double left = 1 - volume_fraction();
  std::vector<ParticlePopulation> all = populations_;
  if (host_.scattering)
    all.push_back({std::make_shared<Molecules>(host_), RadiusDistribution::monodisperse(1e-10), left});
  const Ensemble ensemble(std::move(all), lambda_nm, host_.index, accuracy, parallel_for);
  MediumSpectrum result;
  result.coefficients = ensemble.coefficients();
  bool scatters = !lambda_nm.empty();
  for (EnsembleCoefficients& c : result.coefficients) {
    if (host_.absorption) c.absorption += left * host_.absorption(c.lambda_nm);
    scatters = scatters && c.scattering > 0;
  }
  if (with_phases && scatters) result.phases = ensemble.phases(parallel_for, progress);
  return result;
}

std::optional<DependentScattering> Suspension::dependence(std::size_t ingredient, double lambda_nm,
                                                          const EnsembleAccuracy& accuracy,
                                                          const ParallelFor& parallel_for) const {
  if (volume_fraction(ingredient) > kMaxHardSphereFraction) return std::nullopt;
  return dependent_scattering(populations_[ingredient], lambda_nm, host_.index(lambda_nm), accuracy,
                              parallel_for);
}

}  // namespace aureole::optics
