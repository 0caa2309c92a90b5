// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/streams_mixture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aureole::pigment {
namespace {

/// ln K and ln S of layers above which the tables of the theory end; such layers are opaque.
constexpr double kOpaqueK = 5, kOpaqueS = 7;

}  // namespace

StreamsMixture::StreamsMixture(Palette palette, const ParallelFor& threads) : palette_(std::move(palette)) {
  if (!palette_.streams) throw std::domain_error("the palette was not fitted by streams");
  const PaletteStreams& s = *palette_.streams;
  const bool varies = std::any_of(palette_.pigments.begin(), palette_.pigments.end(),
                                  [](const Pigment& p) { return p.g.has_value(); });
  theory_ = streams_theory(
      {.index = s.index, .g = s.g, .geometry = s.geometry, .specular = s.specular, .varies_g = varies},
      threads);
}

std::vector<double> StreamsMixture::reflectance(std::span<const double> fractions, double thickness,
                                                Substrate substrate) const {
  const bool is_opaque = std::isinf(thickness);
  const Paint paint = mix(palette_, fractions);
  if (!is_opaque && substrate.size() != 1 && substrate.size() != paint.size())
    throw std::domain_error("a substrate needs one reflectance, or one for each wavelength");
  const std::vector<double> shares = mixing_fractions(palette_, fractions);
  constexpr double kLeast = 1e-12;
  std::vector<double> values;
  for (std::size_t i = 0; i < paint.size(); ++i) {
    const double depth = is_opaque ? 1 : thickness;
    FilmLayer layer{std::log(std::max(paint[i].k * depth, kLeast)),
                    std::log(std::max(paint[i].s * depth, kLeast))};
    // a quantity proportional to sigma_s, relative to a paint with the theory's mean cosine
    double scattering = 0;
    for (std::size_t p = 0; p < shares.size(); ++p) {
      const Pigment& one = palette_.pigments[p];
      scattering += shares[p] * one.s[i] * (one.g ? (1 - palette_.streams->g) / (1 - *one.g) : 1);
    }
    if (scattering > 0 && paint[i].s > 0) layer.g_shift = -std::log(scattering / paint[i].s);
    values.push_back(is_opaque || layer.ln_k > kOpaqueK || layer.ln_s > kOpaqueS
                         ? theory_->opaque(layer).value
                         : theory_->over(layer, substrate.size() == 1 ? substrate[0] : substrate[i]).value);
  }
  return values;
}

}  // namespace aureole::pigment
