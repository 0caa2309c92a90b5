// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/content/mixture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "aureole/core/parallel.h"
#include "aureole/medium/content/extinction_limit.h"
#include "aureole/medium/content/volume_majorants.h"
#include "aureole/parameter/data_range.h"
#include "aureole/parameter/ior.h"
#include "aureole/phase/mie_tables.h"
#include "aureole/phase/tabulated_phase_function.h"
#include "aureole/plugin/table_progress.h"

namespace aureole {

namespace {

/// The coefficients of a mixture [1/length] and its phase function.
struct MixtureTables {
  SampledSpectrum extinction, scattering;
  /// phase function of the mixture; null: the default phase function
  std::shared_ptr<const TabulatedPhase> phase;
  /// Largest estimated error over the wavelengths of the absorption by particles, relative to that absorption
  /// or to 1e-4 of the extinction, whichever is larger.
  double absorption_error = 0;

  static constexpr TableKind kTable{"mixture of particles", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.extinction, self.scattering, self.phase, self.absorption_error);
  }
};

MixtureTables tabulate_mixture(const optics::Suspension& content, const SpectralGrid& grid, double unit,
                               const optics::TellProgress& progress) {
  MixtureTables made;
  // The host's absorption may vary strongly with the wavelength but is cheap to evaluate, so it is added at
  // each node of the grid.
  optics::ClearMedium host = content.host();
  const optics::SpectralFunction host_absorption = std::exchange(host.absorption, nullptr);
  const double left = 1 - content.volume_fraction();
  const auto of_host = [&](double nm) { return host_absorption ? left * host_absorption(nm) : 0; };
  if (content.ingredients().empty() && !host.scattering) {
    made.scattering = SampledSpectrum::constant(grid, 0);
    made.extinction = SampledSpectrum::from_function(grid, [&](double nm) { return unit * of_host(nm); });
    return made;
  }
  std::vector<optics::RadiusDistribution> radii;
  for (const optics::Ingredient& i : content.ingredients()) radii.push_back(i.radii);
  const double index = host.index(grid.min_nm);
  optics::EnsembleAccuracy accuracy = mie_accuracy(radii, index, grid.min_nm);
  const optics::Suspension particles(host, content.ingredients());
  const MieSpectrum spectrum = mie_spectrum(
      grid, radii, index,
      [&](const std::vector<double>& at) {
        return particles.spectrum(at, false, accuracy, for_ranges).coefficients;
      },
      [particles](double nm) { return particles.straight_absorption(nm); });
  for (const optics::EnsembleCoefficients& c : spectrum.coefficients) {
    const double absorbed = std::max(c.absorption, 1e-4 * c.extinction());
    if (absorbed > 0) made.absorption_error = std::max(made.absorption_error, c.absorption_error / absorbed);
  }
  made.scattering =
      SampledSpectrum::from_function(grid, [&](double l) { return unit * spectrum.scattering(l); });
  made.extinction = SampledSpectrum::from_function(
      grid, [&](double l) { return unit * (spectrum.scattering(l) + spectrum.absorption(l) + of_host(l)); });
  accuracy.most_coefficient_radii = 0;
  const optics::PhaseTables phases =
      particles.spectrum(spectrum.phase_nm, true, accuracy, for_ranges, progress).phases;
  if (!phases.tables.empty())
    made.phase = std::make_shared<const TabulatedPhase>(tabulate(phases, spectrum.phase_nm, grid));
  return made;
}

/// Notes where the film's range exceeds the data of the host and of the particles of a recipe.
void note_ranges(const Properties& p, const optics::Suspension& content) {
  const char* host = p.has("recipe")                               ? "recipe"
                     : p.plugin() && p.plugin()->documents("host") ? "host"
                                                                   : "solvent";
  if (content.host().absorption)
    note_data_range(p, host, "the absorption of the liquid",
                    {content.host().data.min_nm, content.host().data.max_nm});
  for (const optics::Ingredient& i : content.ingredients())
    note_data_range(p, host, "the index of " + i.name, {i.data.min_nm, i.data.max_nm});
}

}  // namespace

Mixture::Mixture(const Properties& p, const optics::Suspension& content) : Medium(p) {
  note_ranges(p, content);
  const auto tables = p.shared_model<MixtureTables>([&] {
    try {
      return std::make_shared<const MixtureTables>(
          tabulate_mixture(content, p.context().grid, p.context().length_unit_m, progress_of(p)));
    } catch (const std::domain_error& e) {
      throw Error(p.where(), e.what());
    }
  });
  if (tables) {
    tables_ = tables;
    scattering_ = tables->scattering, extinction_ = tables->extinction;
    constexpr double kWorthANote = 0.01;
    if (tables->absorption_error > kWorthANote)
      p.note("ingredient",
             fmt::format("absorption by the particles is known to {:.1g} % only: they absorb so little that "
                         "they do it in resonances narrower than the steps between their radii",
                         100 * tables->absorption_error));
    if (tables->phase) phase_ = std::make_shared<TabulatedPhaseFunction>(p, tables->phase);
  }
  if (!phase_) phase_ = make_default<PhaseFunction>(p, "phase");
  density_ = get_optional_volume(p, "density", SpectrumRole::unbounded);
  if (density_ && !density_->is_constant()) grid_ = majorants_of(*density_);
  if (tables) {
    const double extinction = extinction_.maximum(), densest = density_ ? double(density_->maximum()) : 1.0;
    require_computable_extinction(p, density_ ? "density" : "", extinction * densest);
    if (grid_) require_computable_extinction(p, "density", *grid_, density_->minimum(), extinction);
  }
}

ParameterDoc Mixture::density_row() {
  return {"density", "volume", "", "1",
          "relative density of the medium, a factor of all coefficients; a grid makes it vary in space"};
}

void Mixture::eval(const Vec3& p, const Vec3&, const Wavelengths& w, MediumCoefficients& out) const {
  if (grid_ && grid_->at(p) == 0) {
    out = {};  // outside of the density's box the medium is empty
    return;
  }
  out.sigma_t = extinction_.eval(w);
  out.sigma_s = min(scattering_.eval(w), out.sigma_t);
  out.emission = 0.f;
  if (!density_) return;
  const Spectrum density = density_->eval(p, w);
  out.sigma_t *= density, out.sigma_s *= density;
}

Spectrum Mixture::majorant(const Vec3&, const Wavelengths& w) const {
  const Spectrum extinction = extinction_.eval(w);
  return density_ ? extinction * density_->envelope(w) : extinction;
}

optics::ClearMedium read_clear_medium(const Properties& p, std::string_view name) {
  const Properties::Entry* e = p.find(name);
  const auto* material = e ? std::get_if<std::string>(&e->value) : nullptr;
  // The parameters of the index are read in any case, so that a scene may state "dispersion" for a host that
  // does not need it.
  const Ior ior = material && *material == "vacuum" ? Ior() : Ior::from(p, name, "water");
  if (!e || (material && *material == "water")) return optics::water();
  if (material && *material == "air") return optics::air();
  if (material && *material == "vacuum") return optics::vacuum();
  return {.index = [ior, grid = p.context().grid](double nm) {
    return double(ior.eval(Wavelengths::at(grid, float(nm)))[0]);
  }};
}

std::vector<IngredientPtr> read_ingredients(const Properties& p) {
  std::vector<IngredientPtr> all;
  for (const auto& i : p.get_children<Ingredient>("ingredient")) all.push_back(i);
  return all;
}

optics::Suspension mix(const Properties& p, const optics::Suspension& base,
                       const std::vector<IngredientPtr>& ingredients, bool dependent_scattering) {
  optics::ClearMedium host = base.host();
  std::vector<optics::Ingredient> particles = base.ingredients();
  for (const IngredientPtr& ingredient : ingredients) try {
      IngredientList list;
      ingredient->add_to(list);
      host = optics::Solution(host, list.dyes).medium();
      for (optics::Ingredient& i : list.particles) i.hard_spheres = dependent_scattering;
      optics::Suspension(host, list.particles);
      particles.insert(particles.end(), list.particles.begin(), list.particles.end());
    } catch (const std::domain_error& e) {
      throw Error(ingredient->properties().where(), e.what());
    }
  try {
    return optics::Suspension(host, std::move(particles));
  } catch (const std::domain_error& e) {
    throw Error(p.where(), e.what());
  }
}

}  // namespace aureole
