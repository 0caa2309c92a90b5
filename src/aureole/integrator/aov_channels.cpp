// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/aov_channels.h"

#include <algorithm>
#include <set>

#include "aureole/spectrum/path_density.h"

namespace aureole {

std::vector<NestedIntegrator> nested_integrators(const Properties& p, std::string_view documented_name) {
  std::vector<NestedIntegrator> nested;
  const auto children = p.get_children<Integrator>(documented_name);
  int unnamed = 0;
  for (const Properties::Entry& e : p.entries()) {
    const auto* object = std::get_if<ObjectPtr>(&e.value);
    if (!object) continue;
    auto integrator = std::dynamic_pointer_cast<const Integrator>(*object);
    if (!integrator) continue;
    if (integrator->leaves() != Integrator::Leaves::pixel) {
      // A scene that is loaded for denoising has "colors" (loading/overrides.cpp), and its author wrote no outer integrator.
      const bool for_denoising =
          std::ranges::any_of(p.entries(), [](const auto& at) { return at.name == "colors"; });
      throw Error(
          e.where,
          "\"" + (*object)->properties().type() + "\" follows light paths, which belong to no pixel: " +
              (for_denoising
                   ? "it has no features for denoising; render without that, with a box filter and replicates, "
                     "then \"aureole denoise\" the picture with its scene"
                   : "it can't be nested in \"" + p.type() + "\""));
    }
    std::vector<std::string> channels = integrator->aov_names(), meanings = integrator->aov_meanings();
    nested.push_back({e.name.empty() ? "_arg_" + std::to_string(unnamed++) : e.name, std::move(integrator),
                      std::move(channels), std::move(meanings)});
  }
  return nested;
}

void append_channels(const std::vector<NestedIntegrator>& nested, std::size_t colors,
                     std::vector<std::string>& names, std::vector<std::string>& meanings) {
  for (std::size_t k = 0; k < colors; ++k)
    for (const char* c : {".R", ".G", ".B", ".A"}) {
      names.push_back(nested[k].name + c);
      meanings.push_back((c[1] == 'A' ? "alpha" : "colour in linear sRGB") +
                         (" of the integrator " + nested[k].name));
    }
  for (const NestedIntegrator& n : nested)
    for (std::size_t i = 0; i < n.channels.size(); ++i) {
      names.push_back(n.name + "." + n.channels[i]);
      meanings.push_back(n.meanings[i]);
    }
}

SceneNeeds nested_needs(const std::vector<NestedIntegrator>& nested) {
  SceneNeeds all;
  bool adds_media = !nested.empty();
  for (const NestedIntegrator& n : nested) {
    const SceneNeeds needs = n.integrator->needs();
    adds_media &= needs.adds_media;
    if (!needs.may_diffract) continue;
    if (all.may_diffract && !(needs.diffraction == all.diffraction))
      throw n.integrator->properties().error(
          "diffraction",
          "all nested integrators diffract light in one manner: give them the same \"diffraction\", "
          "\"diffraction_model\" and \"beam_width\"");
    all = needs;
  }
  all.adds_media = adds_media;
  return all;
}

void require_distinct(const Properties& p, std::string_view parameter,
                      const std::vector<std::string>& channels) {
  std::set<std::string> seen;
  for (const std::string& name : channels)
    if (!seen.insert(name).second)
      throw p.error(parameter, "two channels would be named \"" + name + "\"; choose other names");
}

ColourMeter::ColourMeter(const SpectralGrid& grid)
    : range_nm_(float(grid.max_nm - grid.min_nm)),
      observer_(observer_xyz(grid)),
      d65_(d65_spectrum(grid, 1)) {
  visible_ = observer_[1].integral() > 1e-3;
  const double first = visible_ ? std::max(grid.min_nm, 420.0) : grid.min_nm;
  const double last = visible_ ? std::min(grid.max_nm, 680.0) : grid.max_nm;
  fixed_ = Wavelengths::at(
      grid, make_spectrum([&](int i) { return float(first + (last - first) * (i + 0.5) / kWavelengths); }));
}

void ColourMeter::xyz(const Spectrum& estimate, const Wavelengths& w, double out[3]) const {
  for (size_t c = 0; c < 3; ++c)
    out[c] = visible_ ? sum(estimate * observer_[c].eval(w)) : sum(estimate) / range_nm_;
}

void ColourMeter::rgb(const Spectrum& estimate, const Wavelengths& w, float out[3]) const {
  double v[3];
  xyz(estimate, w, v);
  if (visible_)
    xyz_to_srgb(v, out);
  else
    for (int c = 0; c < 3; ++c) out[c] = float(v[c]);
}

void ColourMeter::reflectance_rgb(const Spectrum& reflectance, const Wavelengths& w,
                                  const Spectrum& somewhere, float out[3]) const {
  const float control = mean(somewhere);
  const Spectrum rest = reflectance - control;
  rgb(single_estimate(visible_ ? rest * d65_.eval(w) : rest, w), w, out);
  for (int c = 0; c < 3; ++c) out[c] += control;
}

NestingIntegrator::NestingIntegrator(const Properties& p)
    : Integrator(p), nested_(nested_integrators(p, "integrator")), meter_(p.context().grid) {}

void NestingIntegrator::require_scene(const Scene& scene) const {
  for (const NestedIntegrator& n : nested_) n.integrator->require_scene(scene);
}

std::vector<std::string> NestingIntegrator::scene_notes(const Scene& scene) const {
  std::vector<std::string> all;
  for (const NestedIntegrator& n : nested_)
    for (std::string& note : n.integrator->scene_notes(scene)) all.push_back(std::move(note));
  return all;
}

std::vector<ApproximationError> NestingIntegrator::approximation_errors(const Scene& scene, double samples,
                                                                        int threads) const {
  std::vector<ApproximationError> all;
  for (const NestedIntegrator& n : nested_)
    for (ApproximationError& error : n.integrator->approximation_errors(scene, samples, threads))
      all.push_back(std::move(error));
  return all;
}

}  // namespace aureole
