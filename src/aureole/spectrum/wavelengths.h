// SPDX-License-Identifier: Apache-2.0
// The wavelengths of a path, the grid on which every spectrum of a scene is tabulated, and the pdf from which
// wavelengths are drawn.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// Equidistant nodes over the wavelength range of a sensor, in nm. Every tabulated spectrum of a scene has
/// one value per node. So a look-up is an index that a path computes once (`Wavelengths::cell`), not a
/// search.
struct SpectralGrid {
  double min_nm = 360, max_nm = 830;
  int cells = 470;  ///< number of cells, one less than the nodes

  /// Returns the grid over [min_nm, max_nm]: cells of 1 nm where 64 to 2000 of them suffice, else 64 narrower
  /// or 2000 wider cells.
  static SpectralGrid over(double min_nm, double max_nm);
  double step() const { return (max_nm - min_nm) / cells; }
  double node(int i) const { return min_nm + step() * i; }
  bool operator==(const SpectralGrid&) const = default;
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.min_nm, self.max_nm, self.cells);
  }
};

/// An interval of wavelengths, initially empty.
struct WavelengthRange {
  double min_nm = std::numeric_limits<double>::infinity(), max_nm = 0;

  void extend(double nm) { min_nm = std::min(min_nm, nm), max_nm = std::max(max_nm, nm); }
  void extend(const WavelengthRange& r) {
    min_nm = std::min(min_nm, r.min_nm), max_nm = std::max(max_nm, r.max_nm);
  }
  /// Whether the interval holds more than one wavelength and all of them are positive.
  bool is_proper() const { return min_nm > 0 && min_nm < max_nm; }
};

/// The N wavelengths of a path with their pdfs p_lambda [1/nm], index 0 being the hero, and the time of the path. Neither
/// changes along a path: scattering is elastic, and light passes the scene in an instant.
struct Wavelengths {
  Spectrum nm;
  Spectrum pdf;
  SpectrumMask cell{};  ///< index of the grid cell that contains each wavelength
  Spectrum fraction;    ///< position within the cell, in [0, 1]
  float time = 0;       ///< [s], sampled during the exposure where the scene changes; else 0
  /// Even pdf of times over the one of this time, for numbers that no `pdf` divides. `pdf` is that of wavelength and time,
  /// relative to even times.
  float time_weight = 1;

  /// Wavelengths given directly (tests, instruments); pdf is set to `pdf_per_nm`.
  static Wavelengths at(const SpectralGrid& grid, const Spectrum& nm, float pdf_per_nm = 1);

  /// The hero in the place of every wavelength: estimates of all of them, each over the sum of their pdfs, are those of the
  /// hero alone. For paths whose first ray holds for one wavelength.
  Wavelengths of_hero() const {
    Wavelengths w = *this;
    for (int i = 1; i < kWavelengths; ++i)
      w.nm[i] = nm[0], w.pdf[i] = pdf[0], w.cell[i] = cell[0], w.fraction[i] = fraction[0];
    return w;
  }
};

/// The value of a spectrum at wavelengths outside its points.
enum class SpectrumEnds {
  zero,  ///< zero, for emission and responses, whose points state where there is light or a signal at all
  held   ///< the value at the nearer end, for properties of matter, which exist at every wavelength
};

/// A spectrum tabulated on a grid's nodes, piecewise linear between them.
class SampledSpectrum {
public:
  SampledSpectrum() = default;
  SampledSpectrum(const SpectralGrid& grid, std::vector<float> node_values);

  static SampledSpectrum constant(const SpectralGrid& grid, float value);

  /// Tabulates the piecewise linear function through (nm, value), continued according to `ends` outside
  /// [nm.front(), nm.back()]. Its integral over the grid's range is kept, so that a line narrower than a cell
  /// keeps its power. Node values are hat-weighted means, integral(s hat_i) / integral(hat_i). They leave
  /// linear functions unchanged, except at the first and last node: their hats are one-sided, so that they
  /// return the value a third of a cell inside.
  static SampledSpectrum from_points(const SpectralGrid& grid, std::span<const double> nm,
                                     std::span<const double> values, SpectrumEnds ends = SpectrumEnds::zero);

  /// Tabulates a smooth function of the wavelength in nm by its values at the nodes.
  static SampledSpectrum from_function(const SpectralGrid& grid, const std::function<double(double)>& f);

  Spectrum eval(const Wavelengths& w) const {
#ifdef __AVX2__
    if constexpr (kWavelengths == 8) {
      // Both nodes of a cell are loaded at once, which costs less than gathering each.
      const float* const table = table_.data();
      const auto nodes_of = [&](int i) {
        long long two;
        std::memcpy(&two, table + w.cell[i], sizeof two);
        return two;
      };
      const auto pair = [&](int i) { return _mm_castsi128_ps(_mm_set_epi64x(nodes_of(i + 1), nodes_of(i))); };
      const __m256 low = _mm256_set_m128(pair(4), pair(0)), high = _mm256_set_m128(pair(6), pair(2));
      const __m256 a = _mm256_shuffle_ps(low, high, _MM_SHUFFLE(2, 0, 2, 0));
      const __m256 b = _mm256_shuffle_ps(low, high, _MM_SHUFFLE(3, 1, 3, 1));
      const __m256 t = reinterpret_cast<const __m256&>(w.fraction.v);
      const __m256 r = _mm256_fmadd_ps(_mm256_sub_ps(b, a), t, a);
      return Spectrum(reinterpret_cast<const SpectrumVector&>(r));
    }
#endif
    return make_spectrum([&](int i) {
      const float a = table_[w.cell[i]], b = table_[w.cell[i] + 1];
      return a + (b - a) * w.fraction.v[i];
    });
  }

  double integral() const;  ///< integral over the grid's range [value * nm]
  float maximum() const;
  float minimum() const;
  double average() const { return integral() / (grid_.max_nm - grid_.min_nm); }
  std::span<const float> nodes() const { return table_; }
  const SpectralGrid& grid() const { return grid_; }
  void scale(float s);

  /// For tables that are kept (core/table_fields.h), as are the functions of this name in other classes.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.grid_, self.table_);
  }

private:
  SpectralGrid grid_;
  std::vector<float> table_;
};

/// Returns the product node by node; both spectra are on one grid.
SampledSpectrum product(const SampledSpectrum& a, const SampledSpectrum& b);
/// Returns the sum over the nodes of the product of both spectra, times the step [nm], in double precision so
/// that strong lights do not overflow: the response of a film to a light.
double overlap(const SampledSpectrum& a, const SampledSpectrum& b);

/// p_lambda: a piecewise constant pdf over the grid's range, given by a table of its inverse CDF, which is
/// piecewise linear in u. It is positive over the whole range.
class WavelengthDistribution {
public:
  /// Density proportional to the mixture of `densities` (node values on the grid, each normalised to unit
  /// integral first; all-zero ones are skipped), with a uniform part of 2 % so that no wavelength is missed.
  WavelengthDistribution(const SpectralGrid& grid, std::span<const SampledSpectrum> densities,
                         std::span<const float> weights);

  /// Returns N wavelengths lambda_j = CDF^-1(frac(u + j/N)) (Wilkie et al. 2014, "Hero wavelength spectral
  /// sampling").
  Wavelengths sample(float u) const;
  /// Samples with u = (k + offset) / N, k = floor(N hero). The set of wavelengths depends on `offset` alone,
  /// which repeats N times over u. A sequence that is stratified in `offset` is stratified in the set; one
  /// that is stratified in u is not.
  Wavelengths sample(float offset, float hero) const {
    const int k = int(hero * kWavelengths);
    return sample((float(k) + offset) * (1.f / kWavelengths));
  }
  float pdf(float nm) const;
  const SpectralGrid& grid() const { return grid_; }

private:
  static constexpr int kPieces = 2048;
  SpectralGrid grid_;
  std::vector<float> inverse_cdf_;  ///< inverse CDF: kPieces + 1 wavelengths [nm]
  /// Density of each of the kPieces intervals. It is stored, since the rounding of the wavelengths may make a
  /// narrow interval empty.
  std::vector<float> density_;
};

}  // namespace aureole
