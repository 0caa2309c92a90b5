// SPDX-License-Identifier: Apache-2.0
// Statistical comparison of pictures: error measures, and a z-test per pixel if variances of the means are
// stored.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

// Limits of the z-test for the mean of z^2, for the fraction of values beyond the family-wise significance
// level 0.01, and for the difference of the image means.
inline constexpr double kZMeanSquareMin = 0.7, kZMeanSquareMax = 1.3;
inline constexpr double kZOutsideMax = 0.0025;
inline constexpr double kZMeanStandardErrors = 3, kZMeanRelative = 0.002;

/// The relative difference that storage and tabulated spectra explain without noise.
inline constexpr double kStorageRounding = 2e-4;

struct ZTest {
  double mean_square = 0;  ///< mean of z^2 over the values whose noise exceeds rounding; 1 if there are none
  double outside = 0;      ///< fraction with |z| above the family-wise (Sidak) bound at 0.01
  double mean_difference = 0;  ///< difference of the image means, in standard errors
  double mean_relative = 0;    ///< relative difference of the image means
  std::size_t count = 0;
  /// The fewest degrees of freedom of a channel's variances, infinite if these are known.
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  bool passes = false;

  /// Whether there are too few replicates for any verdict, or for a verdict on single values: the noise of
  /// pixels is not normal, and all of a few replicates often miss the tail of its distribution.
  bool has_too_few_replicates() const { return degrees_of_freedom < 1.9; }
  bool judges_values() const { return degrees_of_freedom >= 4; }

  /// Whether the test fails only because the differences are too small for independent noise.
  bool shares_noise() const {
    return !passes && !has_too_few_replicates() && is_within && mean_square < kZMeanSquareMin;
  }
  bool is_within = false;  ///< whether no value and no mean is off by more than noise
};

struct Comparison {
  std::vector<std::string> channels;
  double mean_a = 0, mean_b = 0, rmse = 0;
  double relative_mse = 0;  ///< mean of (a - b)^2 / (b^2 + 1e-2 mean(b)^2)
  double max = 0;
  int max_x = 0, max_y = 0;
  std::size_t not_finite = 0;  ///< NaN or infinite values in either picture; excluded from everything else
  std::optional<ZTest> z;      ///< if at least one picture has variances ("variance.R")
  Image z_map;                 ///< one channel: the z of largest magnitude per pixel
};

/// Numbers of replicates from which the variances of two pictures were estimated; 0: so many that they count
/// as known.
struct Replicates {
  int a = 0, b = 0;
};

/// Compares the colour channels that both pictures have. Throws Error if sizes differ or no channel is
/// common. `rounding` is the relative difference (of the value, or of 1 % of the mean if that is larger) that
/// storage and tabulated spectra explain without noise. It is added to the standard deviation; values whose
/// variance is zero in both pictures are tested with it alone. Differences over estimated variances have
/// Student's distribution; they are mapped to normal values z of equal probability.
Comparison compare_images(const Image& a, const Image& b, double rounding = kStorageRounding,
                          Replicates replicates = {});

/// Names of the layers that both pictures have: channels are grouped by their names before the last dot; R, G,
/// B and Y without a dot are the layer "", any other channel is its own. Alpha and variances are no layers.
std::vector<std::string> common_layers(const Image& a, const Image& b);
/// The channels of one layer and their variances.
Image layer_of(const Image& image, const std::string& layer);

/// Writes the z-values as a PNG with a diverging colour map.
void write_z_map(const Comparison& c, const std::filesystem::path& file);

}  // namespace aureole
