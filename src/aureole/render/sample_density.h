// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling: the number of samples of each pixel per sample per pixel of the picture. It is estimated
// from a pilot, the first samples of all pixels, and fixed before the picture begins. So partial renderings,
// checkpoints and merges work as they do without adaptive sampling. A pixel's density depends on its
// neighbours' samples and not on its own, so that the picture stays unbiased. Window and bounds may change.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aureole/sampler/sampler.h"

namespace aureole {

/// Densities are powers of two, so that each pixel always gets whole nets of its sampler.
inline constexpr int kMinDensityExponent = -1, kMaxDensityExponent = 2;

/// Samples per pixel of the pilot, at most as many as every pixel has in a whole block.
inline constexpr int kPilotSamples = 8;

/// Statistics of a pixel's own samples, in linear sRGB, averaged over the three channels.
struct PixelNoise {
  float mean = 0;
  float variance = 0;  ///< variance of one sample
};

/// Number of samples that a pixel of density 2^exponent has among the first `n` samples per pixel of the
/// picture; 0 only for n = 0. It is exact for whole blocks, and up to one sample more within a block.
constexpr std::int64_t samples_up_to(std::int64_t n, int exponent) {
  return exponent >= 0 ? n << exponent : (n + (std::int64_t(1) << -exponent) - 1) >> -exponent;
}

/// Returns the exponents of the densities of all pixels, row by row. A pixel's density is proportional to
/// variance^0.4, in the units of `error`: for a given number of samples this minimises the sum of squared
/// errors that fall as n^-1.5. Densities are rounded to powers of two and average to at most one. Noise and
/// brightness are means over the surrounding 7 x 7 pixels, without the pixel itself.
std::vector<std::int8_t> sample_densities(int width, int height, std::span<const PixelNoise> pixels,
                                          AdaptiveTarget error);

/// Bytes of temporary memory that `sample_densities` needs.
constexpr double density_bytes(double pixels) { return 40 * pixels; }

/// The mean density; 1 for an empty list.
double mean_density(std::span<const std::int8_t> exponents);

}  // namespace aureole
