// SPDX-License-Identifier: Apache-2.0
// Statistical comparison of pictures: error measures, and a z-test per pixel where variances of the means are
// stored.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

// Limits of the z-test: mean of z^2, the share of values outside at family-wise significance .01, the image
// mean.
inline constexpr double kZMeanSquareMin = 0.7, kZMeanSquareMax = 1.3;
inline constexpr double kZOutsideMax = 0.0025;
inline constexpr double kZMeanStandardErrors = 3, kZMeanRelative = 0.002;

struct ZTest {
  double mean_square = 0;  ///< mean of z^2 over the values whose noise exceeds rounding; 1 if there are none
  double outside = 0;      ///< share with |z| beyond the family-wise (Sidak) bound at .01
  double mean_difference = 0;  ///< of the image means, in standard errors
  double mean_relative = 0;    ///< of the image means, relative
  std::size_t count = 0;
  bool passes = false;
};

struct Comparison {
  std::vector<std::string> channels;
  double mean_a = 0, mean_b = 0, rmse = 0;
  double relative_mse = 0;  ///< mean of (a - b)^2 / (b^2 + 1e-2 mean(b)^2)
  double max = 0;
  int max_x = 0, max_y = 0;
  std::size_t not_finite = 0;  ///< values that are NaN or infinite in either picture; left out of all else
  std::optional<ZTest> z;      ///< where at least one picture has variances ("variance.R")
  Image z_map;                 ///< one channel, the z of largest magnitude per pixel
};

/// Compares the colour channels that both pictures have. Throws Error where sizes differ or nothing is
/// common. Values whose variance is zero in both are tested by equality within `rounding`: the relative
/// difference (of the value, at least 1 % of the mean) that storage and tabulated spectra explain without
/// noise; it adds to the standard deviation.
Comparison compare_images(const Image& a, const Image& b, double rounding = 2e-4);

/// A diverging colour map of the z-values as PNG.
void write_z_map(const Comparison& c, const std::filesystem::path& file);

}  // namespace aureole
