// SPDX-License-Identifier: Apache-2.0
// A check in progress: the function under test, and the findings so far.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"
#include "aureole/instrument/check/delta_lobes.h"
#include "aureole/instrument/check/deviation.h"
#include "aureole/instrument/check/scattering_function.h"
#include "aureole/math/significance.h"

namespace aureole::check {

using MaybeSample = std::optional<BsdfSample>;

constexpr float kAngles[] = {
    20.f, 60.f, 85.f};  ///< angles of wi from the normal, each above and below the surface [degrees]
constexpr int kIncidences = 6;
constexpr int kHeroes = 2;  ///< hero wavelengths of the tests that need many samples

/// Unit vector at an angle from the normal (or its opposite), with an azimuth that depends on the angle.
Vec3 direction_at(double degrees, bool below);

class CheckRun {
public:
  /// Throws Error if the options are invalid.
  CheckRun(const ScatteringFunction& function, const CheckOptions& options);

  const ScatteringFunction& function() const { return function_; }
  const CheckOptions& options() const { return options_; }
  CheckResult& result() { return result_; }
  double level() const { return result_.level; }
  std::size_t failures() const { return failures_; }

  CheckQuery query(int hero) const { return {hero, options_.mode}; }
  /// Wavelength number `hero` [nm].
  float nm(int hero) const { return function_.wavelengths(hero).nm[0]; }
  /// The index of refraction on the side of w at wavelength number `hero`.
  double index(const Vec3& w, int hero) const;

  void add(CheckFinding finding);
  /// Adds a failed finding whose message is the concatenation of `parts`.
  template <class... Parts>
  void fail(CheckFinding finding, const Parts&... parts) {
    finding.passed = false;
    finding.message = sentence(parts...);
    add(std::move(finding));
  }

  // The function's methods, called in chunks; `options().progress` is called in between.
  void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                std::vector<BsdfEval>& found);
  void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
            std::vector<Spectrum>& found);
  void sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2, CheckQuery query,
              std::vector<MaybeSample>& found);

  /// Calls `use(samples)` with `count` random samples, in chunks; a sample without a direction is null. Stops
  /// if `use` returns false.
  template <class F>
  void draw(const Vec3& wi, CheckQuery query, std::size_t count, SeededRandom& random, F&& use) {
    const std::vector<Vec3> same(std::min(count, kAtOnce), wi);
    std::vector<float> u1(same.size());
    std::vector<Vec2> u2(same.size());
    for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
      const std::size_t n = std::min(kAtOnce, count - begin);
      for (std::size_t i = 0; i < n; ++i) u1[i] = random.next(), u2[i] = random.next2();
      sample(std::span(same).first(n), std::span(u1).first(n), std::span(u2).first(n), query, samples_);
      if (!use(std::span<const MaybeSample>(samples_))) return;
    }
  }

  /// The delta lobes found by many stratified random numbers.
  std::vector<DeltaLobe> delta_lobes(const Vec3& wi, CheckQuery query);

  /// Reports completion to `progress` and returns the result.
  CheckResult finish();

private:
  /// Directions per call of a function that takes arrays. The Python arrays for them, with a row for each
  /// wavelength, then stay in the cache and reuse memory; larger arrays would be mapped anew for each
  /// operation.
  static constexpr std::size_t kAtOnce = 512;
  static constexpr std::size_t kBetweenLooks = 4096;  ///< number of calls between two calls of `progress`

  template <class F>
  void in_parts(std::size_t count, F&& f);
  void find_indices();
  std::vector<MaybeSample> stratified_samples(const Vec3& wi, CheckQuery query);

  const ScatteringFunction& function_;
  const CheckOptions& options_;
  CheckResult result_;
  std::array<double, kWavelengths> ratios_{};  // ratios of the indices of refraction, taken from samples
  std::size_t failures_ = 0;
  double calls_ = 0, expected_calls_ = 1;
  std::size_t calls_since_ = 0;       // calls since the last call of `progress`
  std::vector<MaybeSample> samples_;  // reused between calls
};

}  // namespace aureole::check
