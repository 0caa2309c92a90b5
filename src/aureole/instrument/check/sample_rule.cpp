// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

namespace {

/// Checks one sample: a unit direction, valid numbers, and a lobe that the function has and that fits the
/// direction's side.
SampleFault judge_alone(const CheckRun& run, const Vec3& wi, const BsdfSample& s) {
  const auto where = [&] { return " for wi = " + to_text(wi) + ", wo = " + to_text(s.wo); };
  if (!is_finite(s.wo)) return {"sample returns a direction that is not finite" + where(), CheckRule::finite};
  if (!(std::abs(length(s.wo) - 1) < 1e-4f)) return {"wo is not a unit vector" + where()};
  if (!is_valid_radiance(s.value))
    return {sentence("sample returns the invalid value ", invalid_in(s.value), where()), CheckRule::finite};
  if (!is_valid_radiance(s.pdf))
    return {sentence("sample returns the invalid density ", invalid_in(s.pdf), where()), CheckRule::finite};
  if (!(s.pdf[0] > 0)) return {"sample returns a direction of density 0" + where()};
  if ((s.lobe & run.function().lobes()) != s.lobe) return {"a sample's lobe is not among lobes()"};
  const bool through = (s.wo.z > 0) != (wi.z > 0);
  if (run.function().is_on_surface() && s.wo.z != 0 && wi.z != 0 &&
      has(s.lobe, through ? Lobe::reflect : Lobe::transmit))
    return {"a sample's lobe and its side disagree" + where()};
  if (s.is_delta() && max_component(s.pdf) > 1 + 1e-5f)
    return {sentence("a probability of ", max_component(s.pdf), where())};
  return {};
}

}  // namespace

SampleFault judge_samples(CheckRun& run, const Vec3& wi, std::span<const MaybeSample> samples,
                          CheckQuery query, double& worst) {
  std::vector<Vec3> wo;
  for (const MaybeSample& s : samples)
    if (s && !s->is_delta()) wo.push_back(s->wo);
  std::vector<BsdfEval> evals;
  run.eval_pdf(std::vector<Vec3>(wo.size(), wi), wo, query, evals);
  std::size_t smooth = 0;
  for (const MaybeSample& s : samples) {
    if (!s) continue;
    SampleFault fault = judge_alone(run, wi, *s);
    if (!fault.message.empty()) return fault;
    if (s->is_delta()) continue;
    const BsdfEval& e = evals[smooth++];
    const auto where = [&] { return " for wi = " + to_text(wi) + ", wo = " + to_text(s->wo); };
    for (int j = 0; j < kWavelengths; ++j) {
      const double of_pdf = deviation(e.pdf[j], s->pdf[j], 1e-6);
      const double of_value = deviation(e.value[j], s->value[j], 1e-6);
      worst = std::max({worst, of_pdf, of_value});
      if (!(of_pdf <= 1e-3))
        return {sentence("sample's density ", s->pdf[j], " is not eval_pdf's ", e.pdf[j], where())};
      if (!(of_value <= 1e-3))
        return {sentence("sample's value ", s->value[j], " is not eval_pdf's ", e.value[j], where())};
    }
  }
  return {};
}

}  // namespace aureole::check
