// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling: how many samples each pixel takes for every sample per pixel of the picture. The numbers
// come from a pilot, the first samples of all pixels, and are fixed before the picture begins, so that parts,
// checkpoints and merges work as they do without. A pixel's number depends on its neighbours' samples and not
// on its own, so that the picture stays unbiased. May change: the window, the bounds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aureole/sampler/sampler.h"

namespace aureole {

/// Densities are powers of two, so that a pixel always has whole nets of its sampler.
inline constexpr int kMinDensityExponent = -1, kMaxDensityExponent = 2;

/// Samples per pixel of the pilot: no more than every pixel has in a whole block.
inline constexpr int kPilotSamples = 8;

/// Statistics of a pixel's own samples, in linear sRGB, averaged over the three channels.
struct PixelNoise {
  float mean = 0;
  float variance = 0;  ///< of one sample
};

/// Samples of a pixel of density 2^exponent among the first `n` samples per pixel of the picture. Never 0
/// but for n = 0.
/// Whole blocks are exact; of a part of one a pixel has up to one sample more.
constexpr std::int64_t samples_up_to(std::int64_t n, int exponent) {
  return exponent >= 0 ? n << exponent : (n + (std::int64_t(1) << -exponent) - 1) >> -exponent;
}

/// Exponents of the densities of all pixels, row by row. A pixel's density is proportional to variance^.4, in
/// the units of `error`, which makes the sum of squared errors that fall as n^-1.5 least for a number of
/// samples; then rounded to a power of two. They add up to at most one per pixel. Noise and brightness are
/// averages over the 7 x 7 pixels around, without the pixel itself.
std::vector<std::int8_t> sample_densities(int width, int height, std::span<const PixelNoise> pixels,
                                          AdaptiveTarget error);

/// Bytes of temporary memory that it needs.
constexpr double density_bytes(double pixels) { return 40 * pixels; }

/// The mean density; 1 for an empty list.
double mean_density(std::span<const std::int8_t> exponents);

}  // namespace aureole
