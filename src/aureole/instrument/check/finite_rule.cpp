// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "aureole/instrument/check/rules.h"
#include "aureole/math/warp.h"

namespace aureole::check {

namespace {

constexpr float kUnitEdges[] = {0.f, 0.5f, kOneMinusEpsilon};

/// Directions at the normal and its opposite, at 60 degrees, and ever closer to the horizon.
std::vector<Vec3> extreme_directions() {
  std::vector<Vec3> directions;
  for (const float z : {1.f, 0.5f, 1e-3f, 1e-7f, 1e-20f, 0.f})
    for (const float sign : {1.f, -1.f})
      for (const float phi : {0.f, 1.1f}) {
        const float r = std::sqrt((1 - z) * (1 + z));
        directions.push_back({r * std::cos(phi), r * std::sin(phi), sign * z});
      }
  return directions;
}

}  // namespace

std::string invalid_eval(const BsdfEval& e, const Vec3& wi, const Vec3& wo) {
  return sentence("eval_pdf gives the value ", invalid_in(e.value), " and the density ", invalid_in(e.pdf),
                  " for wi = ", to_text(wi), ", wo = ", to_text(wo));
}

void check_finite(CheckRun& run) {
  const std::vector<Vec3> directions = extreme_directions();
  std::vector<float> u1;
  std::vector<Vec2> u2;
  for (const float a : kUnitEdges)
    for (const float x : kUnitEdges)
      for (const float y : kUnitEdges) u1.push_back(a), u2.push_back({x, y});

  CheckFinding finding{CheckRule::finite};
  std::vector<BsdfEval> evals;
  std::vector<MaybeSample> samples;
  const auto found = [&](const Vec3& wi, const std::string& message) {
    finding.figure += 1;
    if (finding.message.empty()) finding.wi = wi, finding.message = message;
  };
  for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance})
    for (const Vec3& wi : directions) {
      run.eval_pdf(std::vector<Vec3>(directions.size(), wi), directions, {0, mode}, evals);
      for (std::size_t k = 0; k < evals.size(); ++k)
        if (!is_valid_radiance(evals[k].value) || !is_valid_radiance(evals[k].pdf))
          found(wi, invalid_eval(evals[k], wi, directions[k]));
      run.sample(std::vector<Vec3>(u1.size(), wi), u1, u2, {0, mode}, samples);
      for (std::size_t k = 0; k < samples.size(); ++k) {
        double unused = 0;
        const auto one = std::span<const MaybeSample>(samples).subspan(k, 1);
        const std::string wrong = judge_samples(run, wi, one, {0, mode}, unused).message;
        if (!wrong.empty()) found(wi, sentence(wrong, ", with u = ", u1[k], ", ", u2[k].x, ", ", u2[k].y));
      }
    }
  finding.passed = finding.figure == 0;
  if (finding.figure > 1) finding.message += sentence(" (the first of ", finding.figure, ")");
  run.add(std::move(finding));
}

}  // namespace aureole::check
