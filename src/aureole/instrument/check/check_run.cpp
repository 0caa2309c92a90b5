// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/check_run.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/math/warp.h"

namespace aureole::check {

namespace {

// upper bound of the tests per run: chi-square, energy, and up to eight delta lobes
constexpr int kTestsPerRun = 10;

}  // namespace

Vec3 direction_at(double degrees, bool below) {
  const float theta = float(degrees) * kPi / 180, phi = 0.4f + 0.05f * float(degrees);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
          below ? -std::cos(theta) : std::cos(theta)};
}

CheckRun::CheckRun(const ScatteringFunction& function, const CheckOptions& options)
    : function_(function), options_(options) {
  if (options.samples < 1000) throw Error(sentence("samples: expected at least 1000, got ", options.samples));
  result_.level = sidak_level(options.significance,
                              options.family_size * std::size_t(kIncidences * kHeroes * kTestsPerRun));
  // The progress assumes that quadrature needs about as many calls as sampling.
  expected_calls_ = double(options.samples) * 2.2 * kIncidences * kHeroes +
                    double(options.samples) * 1.1 * 2 * double(options.energy_angles.size()) + 1e5;
  find_indices();
}

double CheckRun::index(const Vec3& w, int hero) const {
  if (options_.indices_from_samples) return w.z > 0 ? 1 : ratios_[std::size_t(hero)];
  const auto& n = w.z > 0 ? options_.n_above : options_.n_below;
  return n ? n(nm(hero)) : 1;
}

void CheckRun::find_indices() {
  ratios_.fill(1);
  if (!options_.indices_from_samples) return;
  for (int j = 0; j < kWavelengths; ++j)
    for (const MaybeSample& s : stratified_samples(direction_at(20, false), query(j)))
      if (s && s->wo.z < 0 && !has(s->lobe, Lobe::null) && s->eta > 0) {
        ratios_[std::size_t(j)] = s->eta;
        break;
      }
}

void CheckRun::add(CheckFinding finding) {
  if (finding.p_value >= 0) {
    result_.smallest_p = std::min(result_.smallest_p, finding.p_value);
    ++result_.statistical_tests;
  }
  if (!finding.passed) ++failures_;
  result_.findings.push_back(std::move(finding));
}

template <class F>
void CheckRun::in_parts(std::size_t count, F&& f) {
  for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
    const std::size_t n = std::min(kAtOnce, count - begin);
    f(begin, n);
    calls_ += double(n);
    calls_since_ += n;
    if (calls_since_ < kBetweenLooks || !options_.progress) continue;
    calls_since_ = 0;
    options_.progress(std::min(calls_ / expected_calls_, 0.99));
  }
}

void CheckRun::eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                        std::vector<BsdfEval>& found) {
  found.assign(wo.size(), {});
  in_parts(wo.size(), [&](std::size_t begin, std::size_t n) {
    function_.eval_pdf(wi.subspan(begin, n), wo.subspan(begin, n), query, std::span(found).subspan(begin, n));
  });
}

void CheckRun::eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                    std::vector<Spectrum>& found) {
  found.assign(wo.size(), {});
  in_parts(wo.size(), [&](std::size_t begin, std::size_t n) {
    function_.eval(wi.subspan(begin, n), wo.subspan(begin, n), query, std::span(found).subspan(begin, n));
  });
}

void CheckRun::sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                      CheckQuery query, std::vector<MaybeSample>& found) {
  found.assign(wi.size(), {});
  in_parts(wi.size(), [&](std::size_t begin, std::size_t n) {
    function_.sample(wi.subspan(begin, n), u1.subspan(begin, n), u2.subspan(begin, n), query,
                     std::span(found).subspan(begin, n));
  });
}

/// Many stratified random numbers including the extreme ones, which find delta lobes of any small mass.
std::vector<MaybeSample> CheckRun::stratified_samples(const Vec3& wi, CheckQuery query) {
  SeededRandom random(options_.seed + 77);
  std::vector<float> u1;
  std::vector<Vec2> u2;
  for (int k = -1; k <= 512; ++k) {
    u1.push_back(std::clamp((float(k) + 0.5f) / 512, 0.f, kOneMinusEpsilon));
    u2.push_back(random.next2());
  }
  std::vector<MaybeSample> found;
  sample(std::vector<Vec3>(u1.size(), wi), u1, u2, query, found);
  return found;
}

std::vector<DeltaLobe> CheckRun::delta_lobes(const Vec3& wi, CheckQuery query) {
  std::vector<DeltaLobe> lobes;
  if (!has(function_.lobes(), Lobe::delta)) return lobes;
  for (const MaybeSample& s : stratified_samples(wi, query))
    if (s && s->is_delta()) gather(lobes, *s);
  return lobes;
}

CheckResult CheckRun::finish() {
  if (options_.progress) options_.progress(1);
  return std::move(result_);
}

}  // namespace aureole::check
