// SPDX-License-Identifier: Apache-2.0
// A BRDF of RGL's material database, ready to be evaluated and sampled.
#pragma once

#include <array>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/bilinear_warp.h"
#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/bsdf/measured/spectral_nodes.h"
#include "aureole/bsdf/measured/spectral_rows.h"

namespace aureole {

/// Directions are in the local frame. The table's direction of incidence is `wi`; the light may travel either way, since
/// the measured surfaces are reciprocal but for errors of measurement.
class RglTable {
public:
  /// Throws Error without a location for a range of azimuths that is neither the circle, half of it nor a quarter.
  RglTable(const RglFile& file, const SpectralGrid& grid);

  /// f |cos theta_o| of light between wi and wo, both above the surface. Interpolated values below zero count as zero, as in the
  /// program of RGL's database (powitacq): measured values may be negative by noise, or outside of sRGB's gamut.
  Spectrum value(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const;
  /// f |cos theta_o| of the three channels of a file in linear sRGB.
  std::array<float, 3> rgb(const Vec3& wi, const Vec3& wo) const;
  /// The pdf [1/sr] with which `sample` chooses wo.
  float pdf(const Vec3& wi, const Vec3& wo) const;
  /// Returns value and pdf together, with the value of `value`.
  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const;
  /// Samples a direction; it may lie below the surface.
  Vec3 sample(const Vec3& wi, Vec2 u) const;
  /// Whether values change when both directions are rotated about the normal.
  bool depends_on_azimuth() const { return nodes_.first.size() > 1; }
  std::size_t bytes() const;

private:
  /// A direction of incidence moved into the measured range of azimuths by the signs of x and y.
  struct Incidence {
    Vec3 wi;
    float sign_x = 1, sign_y = 1;
    Vec2 square;  ///< coordinates in the unit square
    SliceBlend blend;
  };
  /// The half vector of two directions.
  struct HalfVector {
    Vec2 square;  ///< coordinates in the unit square
    float area;   ///< 4 (wi.m) dm / d(square): solid angle of wo per area of the square
  };
  Incidence incidence(const Vec3& wi) const;
  HalfVector half_vector(const Incidence& i, const Vec3& wo) const;
  float factor(const Incidence& i, const HalfVector& h) const;
  float density(const Incidence& i, const HalfVector& h, float vndf, const SquareCell& cell) const;
  Spectrum spectrum(const SliceBlend& blend, const SquareCell& cell, const Wavelengths& w) const;
  std::array<float, 3> channels(const SliceBlend& blend, const SquareCell& cell) const;

  bool is_isotropic_ = true, is_relative_ = true, is_spectral_ = false;
  /// divisor of the circle that was measured: 1 all azimuths, 2 half of them, 4 a quarter
  int symmetry_ = 1;
  SliceNodes nodes_;
  BilinearTable ndf_, sigma_;
  BilinearWarp vndf_, luminance_;
  int width_ = 0, height_ = 0;
  std::size_t slice_rows_ = 0;  ///< distance of two slices in `rows_`
  std::size_t stride_ = 0;      ///< number of values of `spectra_` for each node of the square
  SpectralNodes wavelengths_;
  std::array<SampledSpectrum, 3> primaries_;  ///< primaries of files in linear sRGB
  std::vector<float> spectra_;  ///< values by slice, row, column and channel, of tables with few channels
  SpectralRows rows_;           ///< values by slice, row and column, of tables with many wavelengths
};

}  // namespace aureole
