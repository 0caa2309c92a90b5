// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/streams_mixture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aureole::pigment {
namespace {

/// ln K and ln S of layers above which the tables of the theory end; such layers are opaque.
constexpr double kOpaqueK = 5, kOpaqueS = 7;
/// Least K and S of a layer.
constexpr double kLeastOfLayer = 1e-12;

}  // namespace

StreamsSettings streams_settings(const Palette& palette) {
  if (!palette.streams) throw std::domain_error("the palette was not fitted by streams");
  const PaletteStreams& s = *palette.streams;
  const bool varies = std::any_of(palette.pigments.begin(), palette.pigments.end(),
                                  [](const Pigment& p) { return p.g.has_value(); });
  return {.index = s.index, .g = s.g, .geometry = s.geometry, .specular = s.specular, .varies_g = varies};
}

std::shared_ptr<const FilmTheory> theory_of(const Palette& palette, const ParallelFor& threads) {
  return streams_theory(streams_settings(palette), threads);
}

std::vector<double> g_shifts(const Palette& palette, std::span<const double> fractions) {
  const std::vector<double> shares = mixing_fractions(palette, fractions);
  std::vector<double> shifts;
  for (std::size_t i = 0; i < palette.nm.size(); ++i) {
    double scattering = 0, s = 0;  // sigma_s relative to that of the theory's own g, and S
    for (std::size_t p = 0; p < shares.size(); ++p) {
      const Pigment& one = palette.pigments[p];
      s += shares[p] * one.s[i];
      scattering += shares[p] * one.s[i] * (one.g ? (1 - palette.streams->g) / (1 - *one.g) : 1);
    }
    shifts.push_back(scattering > 0 && s > 0 ? -std::log(scattering / s) : 0);
  }
  return shifts;
}

FilmLight light_of(const FilmTheory& theory, const Coefficients& c, double g_shift, double thickness) {
  const double depth = std::isinf(thickness) ? 1 : thickness;
  const FilmLayer layer{std::log(std::max(c.k * depth, kLeastOfLayer)),
                        std::log(std::max(c.s * depth, kLeastOfLayer)), g_shift};
  if (std::isinf(thickness) || layer.ln_k > kOpaqueK || layer.ln_s > kOpaqueS)
    return {theory.opaque_value(layer), 0, 0};
  return theory.light(layer);
}

LayerTransfer free_film_of(const FilmTheory& theory, const Coefficients& c, double g_shift,
                           double thickness) {
  const FilmLayer layer{std::log(std::max(c.k * thickness, kLeastOfLayer)),
                        std::log(std::max(c.s * thickness, kLeastOfLayer)), g_shift};
  if (layer.ln_k > kOpaqueK || layer.ln_s > kOpaqueS) return {theory.opaque_value(layer), 0};
  return {theory.free_reflectance(layer).value, theory.free_transmittance(layer).value};
}

StreamsMixture::StreamsMixture(Palette palette, const ParallelFor& threads)
    : palette_(std::move(palette)), theory_(theory_of(palette_, threads)) {}

std::vector<FilmLight> StreamsMixture::light(std::span<const double> fractions, double thickness) const {
  const Paint paint = mix(palette_, fractions);
  const std::vector<double> shifts = g_shifts(palette_, fractions);
  std::vector<FilmLight> all;
  for (std::size_t i = 0; i < paint.size(); ++i)
    all.push_back(light_of(*theory_, paint[i], shifts[i], thickness));
  return all;
}

std::vector<LayerTransfer> StreamsMixture::free_film(std::span<const double> fractions,
                                                     double thickness) const {
  const Paint paint = mix(palette_, fractions);
  const std::vector<double> shifts = g_shifts(palette_, fractions);
  std::vector<LayerTransfer> all;
  for (std::size_t i = 0; i < paint.size(); ++i)
    all.push_back(free_film_of(*theory_, paint[i], shifts[i], thickness));
  return all;
}

std::vector<double> StreamsMixture::reflectance(std::span<const double> fractions, double thickness,
                                                Substrate substrate) const {
  const std::vector<FilmLight> layers = light(fractions, thickness);
  if (!std::isinf(thickness) && substrate.size() != 1 && substrate.size() != layers.size())
    throw std::domain_error("a substrate needs one reflectance, or one for each wavelength");
  std::vector<double> values;
  for (std::size_t i = 0; i < layers.size(); ++i)
    values.push_back(std::isinf(thickness)
                         ? layers[i].seen
                         : layers[i].over(substrate.size() == 1 ? substrate[0] : substrate[i]));
  return values;
}

}  // namespace aureole::pigment
