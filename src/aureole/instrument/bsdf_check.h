// SPDX-License-Identifier: Apache-2.0
// What every BSDF has to fulfil, checked by numbers: samples follow the density (chi-square), densities add
// up to one, no energy is gained, reciprocity, wavelengths that agree about each other, finite values at
// grazing and at the ends of the random numbers.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// A BSDF that prefers to be asked about many directions at once, such as one written in another language,
/// where every call is dear. A class derives from `Bsdf` and from this; `check_bsdf` then uses these.
class ArrayBsdf {
public:
  virtual ~ArrayBsdf() = default;
  /// found[i] = eval_pdf(wi[i], wo[i], ctx).
  virtual void eval_pdf_all(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
                            std::span<BsdfEval> found) const = 0;
  /// found[i] = sample(wi[i], u1[i], u2[i], ctx).
  virtual void sample_all(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                          const BsdfContext& ctx, std::span<std::optional<BsdfSample>> found) const = 0;
};

struct BsdfCheckOptions {
  /// Nothing is absorbed and nothing fails, for wi above the surface (and below, if it transmits or is
  /// two-sided).
  bool lossless = false;
  bool black_below = false;         ///< wi.z < 0 gives no sample and no value
  bool may_be_black_below = false;  ///< where wi.z < 0 gives neither, that is all right
  bool may_fail = false;      ///< `sample` may return nothing; the densities then integrate to less than one
  bool reciprocal = true;     ///< f / n_o^2 is the same both ways
  double largest_energy = 1;  ///< more than 1 where a model is known to reflect more light than it receives
  /// In which mode samples and energies are tested; in the other one a BSDF that is not reciprocal may gain
  /// energy.
  TransportMode mode = TransportMode::importance;
  std::function<float(float nm)> n_above, n_below;  ///< indices on the two sides; 1 where not given
  bool indices_from_samples = false;                ///< the ratio of the two is what samples say (`eta`)
  /// Directions around which lobes are narrow, for a given wi, and how wide bins may be there [rad].
  std::function<std::vector<Vec3>(const Vec3& wi)> focus;
  double focus_angle = 0.02;
  double min_nm = 0, max_nm = 0;    ///< wavelengths; both zero: all that the BSDF is tabulated for
  std::size_t samples = 300000;     ///< for each of 6 directions and 2 wavelengths
  double tolerance = 2e-3;          ///< of energies and masses by quadrature
  std::size_t most_bins = 1000000;  ///< where quadrature gives up
  double significance =
      0.01;  ///< probability that a right BSDF of the family fails one of its statistical tests
  std::size_t family_size = 1;  ///< BSDFs that are checked together; the tests of one are counted in
  std::uint64_t seed = 1;
  /// Further angles [degrees] at which energies are computed and bounded, beside those of the samples.
  std::vector<double> energy_angles;
  /// Called often with the part that is done, in [0, 1]; may throw to end the check.
  std::function<void(double)> progress;
};

enum class BsdfRule {
  sample,            ///< `sample` returns what `eval_pdf` says
  chi_square,        ///< samples follow the density
  delta_lobes,       ///< delta lobes occur as often as their mass says
  density_integral,  ///< densities, masses and failures add up to one
  energy,            ///< no energy is gained, and none lost where the options say so
  sample_energy,     ///< samples carry the energy that `eval` has
  black,             ///< from below, where that is asked for
  wavelengths,       ///< rotating which wavelength is the hero rotates values and densities
  modes,             ///< importance mode is radiance mode with the directions exchanged
  reciprocity,
  finite,  ///< valid numbers everywhere, at grazing and at the ends of the random numbers, too
};
const char* name_of(BsdfRule rule);

/// One thing that was tested, for one direction and hero where it depends on them.
struct BsdfFinding {
  BsdfRule rule = BsdfRule::sample;
  Vec3 wi = {};   ///< zero: many directions
  double nm = 0;  ///< zero: all wavelengths
  /// What was measured: chi-square, frequency, integral, energy, or else the largest relative deviation.
  double figure = 0;
  double expected = 0;
  double p_value = -1;  ///< of a statistical test; else negative
  double limit = 0;     ///< least p-value, or else the largest difference between figure and expectation
  bool passed = true;
  std::string message = {};  ///< a sentence, where it did not pass
};

struct BsdfCheckResult {
  struct Energy {
    Vec3 wi;
    std::array<double, kWavelengths> nm{}, energy{};
    bool bounded = true;  ///< `largest_energy` is its bound
  };
  struct Bin {
    Vec3 center;
    float size = 0, expected = 0, found = 0;
  };
  struct Histogram {
    Vec3 wi;
    double nm = 0;
    int hero = 0;
    std::size_t samples = 0;
    double p_value = 1, chi_square = 0;
    std::size_t pools = 0;  ///< bins of the test, made of these bins
    std::vector<Bin> bins;
  };
  /// f / n_o^2 in radiance mode for light that arrives from wo, and the same with the directions exchanged.
  struct Pair {
    Vec3 wi, wo;
    double nm = 0, forward = 0, backward = 0;
  };

  std::vector<BsdfFinding> findings;
  std::vector<Energy> energies;
  std::vector<Histogram> histograms;
  std::vector<Pair> pairs;
  double level = 0;  ///< least p-value of a single test
  std::size_t statistical_tests = 0;
  double smallest_p = 1, largest_energy = 0, smallest_energy = 1, largest_mass_error = 0;
  double largest_failure = 0;  ///< part of the samples that had no direction, at most
  bool black_below = false;    ///< as found

  bool passed() const;
  std::vector<std::string> problems() const;  ///< sentences; empty where all is well
};

/// Throws Error where the options make no sense for the BSDF, and whatever `progress` throws.
BsdfCheckResult check_bsdf(const Bsdf& bsdf, const BsdfCheckOptions& options);

}  // namespace aureole
