// SPDX-License-Identifier: Apache-2.0
// Mixtures of paints whose K and S were fitted by streams, predicted by streams as well.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "aureole/pigment/film_theory.h"
#include "aureole/pigment/paints.h"

namespace aureole::pigment {

/// Returns the settings of the theory by which a palette was fitted. Throws std::domain_error if it was not fitted by streams.
StreamsSettings streams_settings(const Palette& palette);

/// Tabulates the theory by which a palette's K and S were fitted (`streams_theory`, some 0.5 s on one core). Throws
/// std::domain_error for a palette that was not fitted by streams.
std::shared_ptr<const FilmTheory> theory_of(const Palette& palette, const ParallelFor& threads = serial_for);

/// ln((1 - g)/(1 - g0)) of a mixture at each wavelength, with g0 the mean cosine of the palette's streams and fractions by
/// mass that sum to one. K and S add up as in `mix`, and so do sigma_s, proportional to S/(1 - g), of paints with mean
/// cosines of their own.
std::vector<double> g_shifts(const Palette& palette, std::span<const double> fractions);

/// The light of a layer with these K and S and `g_shift` (`FilmLayer`). `thickness` is in the inverse unit of K and S and may
/// be infinite. Layers beyond the tables of the theory are opaque; K and S below 1e-12 per layer count as 1e-12.
FilmLight light_of(const FilmTheory& theory, const Coefficients& coefficients, double g_shift,
                   double thickness);

/// Reflectance and transmittance of a free film with these K and S and `g_shift`, as `light_of`. `thickness` must be finite.
LayerTransfer free_film_of(const FilmTheory& theory, const Coefficients& coefficients, double g_shift,
                           double thickness);

/// A palette and the theory by streams that its K and S belong to.
class StreamsMixture {
public:
  /// Tabulates the theory (`theory_of`).
  explicit StreamsMixture(Palette palette, const ParallelFor& threads = serial_for);

  /// Light of a layer of a mixture at each wavelength, by mass fractions that sum to one. `thickness` is in the inverse unit
  /// of K and S and may be infinite. Throws std::domain_error as `mix` does.
  std::vector<FilmLight> light(std::span<const double> fractions, double thickness) const;
  /// Outer reflectance of a layer, as the instrument of `Palette::streams` measures it. The substrate below an opaque layer is
  /// ignored.
  std::vector<double> reflectance(std::span<const double> fractions, double thickness,
                                  Substrate substrate) const;
  /// Reflectance and transmittance of a free film at each wavelength, with an interface on each side, as the instrument of
  /// `Palette::streams` measures them (`FilmTheory::free_reflectance`). `thickness` must be finite. The first call makes tables of
  /// free films (some 0.5 s).
  std::vector<LayerTransfer> free_film(std::span<const double> fractions, double thickness) const;
  const std::shared_ptr<const FilmTheory>& theory() const { return theory_; }

private:
  Palette palette_;
  std::shared_ptr<const FilmTheory> theory_;
};

}  // namespace aureole::pigment
