// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/measured_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/integrator/dvr/error_probe.h"

namespace aureole {

namespace {

using enum DvrSettings::Method;

std::string percent(double part) {
  return part < 1e-5 ? "less than 0.001 %" : fmt::format("{:.2g} %", 100 * part);
}

/// Settings by which the integral along a ray is found more exactly.
DvrSettings finer(const DvrSettings& s, float spacing, bool can_preintegrate) {
  DvrSettings fine = s;
  if (s.method == emission_absorption) {
    fine.tolerance = std::max(1e-6f, 0.1f * s.tolerance), fine.termination = 0;
    return fine;
  }
  fine.step = std::min(0.25f * s.step, 0.25f * spacing);
  fine.steps = DvrSettings::Steps::fixed;
  fine.form = DvrSettings::Form::opacity_weighted, fine.alpha = DvrSettings::Alpha::exponential;
  fine.order = DvrSettings::Order::front_to_back;
  fine.jitter = s.method == single_scattering;
  fine.preintegrated = can_preintegrate;
  fine.termination = std::min(s.termination, 1e-6f);
  if (s.method == splatting) fine.method = composite;
  return fine;
}

}  // namespace

std::vector<ApproximationError> measured_errors(const Scene& scene,
                                                std::span<const ClassifiedMedium* const> media,
                                                const DvrSettings& settings, const SampledSpectrum& d65,
                                                double samples, int threads) {
  const DvrSettings& s = settings;
  float spacing = kInfinity, range = 0;
  bool can_preintegrate = true;
  for (const ClassifiedMedium* medium : media) {
    spacing = std::min(spacing, medium->field().spacing());
    range = std::max(range, medium->field().maximum() - medium->field().minimum());
    can_preintegrate &= !medium->classification().plane_parameter();
  }
  const DvrSettings fine = finer(s, spacing, can_preintegrate);
  const bool has_steps = s.method != isosurface;
  double cost = 4;  // in rays of the picture
  if (has_steps) cost += s.method == emission_absorption ? 8 : double(s.step) / double(fine.step);
  if (s.shadows || s.occlusion_samples > 0 || s.method == single_scattering)
    cost *= double(s.step) / double(fine.step);
  const ErrorProbe probe(scene, media, d65, ErrorProbe::count_of(samples, cost), threads);
  std::vector<ApproximationError> errors;
  if (probe.count() == 0) return errors;

  const std::vector<VolumeResult> found = probe.follow(s);
  const std::vector<VolumeResult> exact = has_steps ? probe.follow(fine, 1) : found;
  double brightest = 0;
  for (const VolumeResult& r : exact) brightest = std::max(brightest, double(mean(r.radiance)));
  const auto shown = [&](const RayDifferences& d) {
    const std::string opacity = s.method == xray
                                    ? ""
                                    : fmt::format("{}opacity by {} and {}", brightest > 0 ? "; " : "",
                                                  percent(d.opacity), percent(d.largest_opacity));
    return (brightest > 0 ? fmt::format("light by {} on average and {} at most", percent(d.light),
                                        percent(d.largest_light))
                          : "") +
           opacity;
  };
  const auto add = [&](const std::string& name, const RayDifferences& d, const std::string& rest) {
    errors.push_back({fmt::format("{}: {}{}", name, shown(d), rest), brightest > 0 ? d.light : d.opacity,
                      brightest > 0 ? d.largest_light : d.largest_opacity});
  };
  /// Measures what remains of the picture if one setting is the exact one.
  const auto compare = [&](const std::string& name, const auto& change, const std::string& rest = "") {
    DvrSettings other = s;
    change(other);
    add(name, RayDifferences::of(found, probe.follow(other), brightest), rest);
  };
  const auto voxels = [&](float length) { return fmt::format("{:.3g} voxels", length / spacing); };
  const std::string of_rays =
      fmt::format(" ({} rays{})", probe.count(), brightest > 0 ? ", in per cent of the brightest" : "");
  const bool is_random = s.jitter || s.occlusion_samples > 0 || s.method == single_scattering ||
                         (s.gradient_lighting && !VolumeLighting::samples_all_lights(scene));
  if (has_steps) {
    const RayDifferences d = RayDifferences::of(found, exact, brightest);
    const std::string reference = fmt::format("steps of {}", voxels(fine.step));
    std::string name, rest = of_rays;
    switch (s.method) {
      case emission_absorption:
        name = fmt::format("a tolerance of {:g} against {:g}", s.tolerance, fine.tolerance);
        break;
      case splatting:
        name = fmt::format("splatting against ray casting by {}", reference);
        break;
      case mip:
      case average:
        rest = fmt::format("; number by {} of the volume's range{}",
                           percent(range > 0 ? d.number / double(range) : 0), of_rays);
        [[fallthrough]];
      default:
        name = s.steps == DvrSettings::Steps::adaptive
                   ? fmt::format("adaptive steps, tolerance {:g},", s.tolerance)
               : s.steps == DvrSettings::Steps::by_opacity
                   ? fmt::format("steps by_opacity {:g} from {}", s.step_opacity, voxels(s.step))
                   : fmt::format("steps of {}", voxels(s.step));
        name += " against " + reference;
    }
    if (is_random)
      rest = fmt::format(
          "; one sample, with the noise of its random numbers: all rays together by {:+.2g} +- {:.2g} %{}",
          100 * d.shift, 100 * d.shift_error, rest);
    add(name, d, rest);
  }
  const bool may_end = s.method != mip && s.method != average && s.method != xray;
  if (may_end && s.termination > 0)
    compare(fmt::format("rays that end below a transmittance of {:g}, at most {} of the light behind",
                        s.termination, percent(double(s.termination))),
            [](DvrSettings& o) { o.termination = 0; });
  const bool composites = s.method == composite || s.method == xray;
  if (s.alpha == DvrSettings::Alpha::taylor)
    compare("alpha \"taylor\" against \"exponential\"",
            [](DvrSettings& o) { o.alpha = DvrSettings::Alpha::exponential; });
  if (s.form == DvrSettings::Form::premultiplied)
    compare("form \"premultiplied\" against \"opacity_weighted\"",
            [](DvrSettings& o) { o.form = DvrSettings::Form::opacity_weighted; });
  if (composites && !s.preintegrated && can_preintegrate && has_steps)
    compare("classification \"post\" against \"preintegrated\"",
            [](DvrSettings& o) { o.preintegrated = true; });
  return errors;
}

}  // namespace aureole
