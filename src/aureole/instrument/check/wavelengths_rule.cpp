// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/instrument/check/rules.h"
#include "aureole/math/warp.h"

namespace aureole::check {

namespace {

/// Directions over the sphere, every second one replaced by a sampled direction if there is one.
std::vector<Vec3> directions_to_compare(CheckRun& run, const Vec3& wi, std::size_t count) {
  SeededRandom random(run.options().seed + 5);
  std::vector<Vec3> wo;
  std::vector<float> u1;
  std::vector<Vec2> u2;
  for (std::size_t k = 0; k < count; ++k) {
    wo.push_back(square_to_uniform_sphere(random.next2()));
    if (k % 2) u1.push_back(random.next()), u2.push_back(random.next2());
  }
  std::vector<MaybeSample> drawn;
  run.sample(std::vector<Vec3>(u1.size(), wi), u1, u2, run.query(0), drawn);
  for (std::size_t k = 0; k < drawn.size(); ++k)
    if (drawn[k] && !drawn[k]->is_delta()) wo[2 * k + 1] = drawn[k]->wo;
  return wo;
}

/// Compares values and pdfs of directions. Returns false after adding a failed finding.
bool compare_values(CheckRun& run, const Vec3& wi, CheckFinding& finding) {
  constexpr std::size_t kDirections = 100;
  const std::vector<Vec3> wo = directions_to_compare(run, wi, kDirections), same(kDirections, wi);
  std::vector<BsdfEval> first, other;
  run.eval_pdf(same, wo, run.query(0), first);
  for (int j = 1; j < kWavelengths; ++j) {
    run.eval_pdf(same, wo, run.query(j), other);
    for (std::size_t k = 0; k < kDirections; ++k)
      for (int i = 0; i < kWavelengths; ++i) {
        const int original = (i + j) % kWavelengths;
        for (const bool density : {true, false}) {
          const double a = density ? first[k].pdf[original] : first[k].value[original];
          const double b = density ? other[k].pdf[i] : other[k].value[i];
          const double d = deviation(a, b, 1e-7);
          finding.figure = std::max(finding.figure, d);
          if (d <= finding.limit) continue;
          finding.nm = run.nm(original);
          run.fail(finding, density ? "density" : "value", " of wavelength ", original, " (", finding.nm,
                   " nm) is ", a, ", but ", b, " with hero ", j, " for wi = ", to_text(wi),
                   ", wo = ", to_text(wo[k]));
          return false;
        }
      }
  }
  return true;
}

/// Compares delta lobes: the mass given for wavelength j is the probability that j, as hero, is scattered in
/// that direction. Returns false after adding a failed finding.
bool compare_deltas(CheckRun& run, const Vec3& wi, CheckFinding& finding) {
  const std::vector<DeltaLobe> mirrors = run.delta_lobes(wi, run.query(0));
  for (int j = 1; j < kWavelengths && !mirrors.empty(); ++j) {
    const std::vector<DeltaLobe> as_hero = run.delta_lobes(wi, run.query(j));
    for (const DeltaLobe& l : mirrors) {
      const auto here = [&](const DeltaLobe& d) { return d.lobe == l.lobe && length(d.wo - l.wo) < 1e-7f; };
      double mass = 0, value = 0, expected_mass = 0, expected_value = 0;
      for (const DeltaLobe& d : mirrors)
        if (here(d)) expected_mass += d.mass[j], expected_value += d.value[j];
      for (const DeltaLobe& o : as_hero)
        if (here(o)) mass += o.mass[0], value += o.value[0];
      const double of_mass = deviation(mass, expected_mass, 1e-6);
      const double of_value = deviation(value, expected_value, 1e-6);
      finding.figure = std::max({finding.figure, of_mass, of_value});
      if (of_mass <= finding.limit && of_value <= finding.limit) continue;
      finding.nm = run.nm(j);
      run.fail(finding, "wavelength ", j, " (", finding.nm, " nm) has mass ", expected_mass, " and value ",
               expected_value, " in the hero's delta lobe towards ", to_text(l.wo), ", but as hero ", mass,
               " and ", value);
      return false;
    }
  }
  return true;
}

}  // namespace

void check_wavelengths(CheckRun& run, const Vec3& wi) {
  CheckFinding finding{CheckRule::wavelengths, wi};
  finding.limit = 1e-3;
  if (compare_values(run, wi, finding) && compare_deltas(run, wi, finding)) run.add(std::move(finding));
}

}  // namespace aureole::check
