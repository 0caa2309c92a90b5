// SPDX-License-Identifier: Apache-2.0
// Equations of J. Dupuy and W. Jakob, "An adaptive parameterization for efficient material acquisition and rendering",
// ACM TOG 37(6), 2018: a uniform point is moved by the luminance (section 4.3), then by the distribution of visible
// normals, to a half vector in the square; f |cos theta_o| = spectrum D(m) / (4 sigma(wi)) (equation 5). Azimuths of
// isotropic materials are those of the half vector relative to the direction of incidence.
#include "aureole/bsdf/measured/rgl_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/bsdf/measured/half_vector_square.h"
#include "aureole/core/parallel.h"
#include "aureole/spectrum/rgb_primaries.h"

namespace aureole {
namespace {

/// Tables of up to this number of channels are interpolated in registers.
constexpr std::size_t kFew = 32;

float largest_magnitude(const std::vector<float>& values) {
  float largest = 0;
  for (const float v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

Spectrum load(const float* values) {
  Spectrum s;
  std::memcpy(s.data(), values, sizeof(float) * std::size_t(kWavelengths));
  return s;
}

Four load_four(const float* values) {
  Four four;
  std::memcpy(&four, values, sizeof four);
  return four;
}

}  // namespace

RglTable::RglTable(const RglFile& file, const SpectralGrid& grid)
    : is_isotropic_(file.is_isotropic()),
      is_relative_(file.is_relative),
      is_spectral_(!file.nm.empty()),
      nodes_{file.phi_i, file.theta_i},
      ndf_(int(file.ndf.width), int(file.ndf.height), file.ndf.values),
      sigma_(int(file.sigma.width), int(file.sigma.height), file.sigma.values),
      vndf_(int(file.vndf.width), int(file.vndf.height), nodes_.count(), file.vndf.values),
      luminance_(int(file.luminance.width), int(file.luminance.height), nodes_.count(),
                 file.luminance.values),
      width_(int(file.luminance.width)),
      height_(int(file.luminance.height)) {
  if (!is_isotropic_) {
    const double span = double(file.phi_i.back()) - double(file.phi_i.front());
    symmetry_ = int(std::lround(2 * kPiD / span));
    const bool is_known = symmetry_ == 1 || symmetry_ == 2 || symmetry_ == 4;
    if (!is_known || std::abs(span * symmetry_ - 2 * kPiD) > 0.1)
      throw Error(fmt::format(
          "\"phi_i\" spans {:.4g} degrees; an anisotropic material is measured over 360, 180 or 90",
          span / kDegree));
    if (symmetry_ > 1 && double(file.phi_i.front()) > -3)
      throw Error(fmt::format("\"phi_i\" begins at {:.4g} degrees; a range of 180 or 90 begins at -180",
                              double(file.phi_i.front()) / kDegree));
  }
  const std::size_t channels = file.channels(), area = std::size_t(width_) * std::size_t(height_);
  if (is_spectral_)
    wavelengths_ = SpectralNodes(grid, file.nm);
  else
    primaries_ = rgb_primaries(grid);
  stride_ = is_spectral_ ? wavelengths_.count() : 3;
  // Slices whose distance is no multiple of the size of a page do not compete for the same lines of the caches.
  slice_rows_ = area + 3;
  if (stride_ > kFew) {
    rows_ = SpectralRows(grid, wavelengths_, nodes_.count() * slice_rows_, largest_magnitude(file.spectra));
  } else {
    // Vectors of wavelengths may reach beyond the last node.
    spectra_.resize(nodes_.count() * area * stride_ + std::size_t(kWavelengths));
  }
  // The file stores an array for each channel; the table keeps all channels of a node together.
  for_ranges(
      nodes_.count() * std::size_t(height_),
      [&](std::size_t begin, std::size_t end) {
        std::vector<float> row(std::size_t(width_) * stride_);
        for (std::size_t r = begin; r < end; ++r) {
          const std::size_t slice = r / std::size_t(height_), y = r % std::size_t(height_);
          for (std::size_t c = 0; c < stride_; ++c) {
            const std::size_t channel = is_spectral_ ? wavelengths_.source(c) : c;
            const float* from =
                file.spectra.data() + (slice * channels + channel) * area + y * std::size_t(width_);
            for (std::size_t x = 0; x < std::size_t(width_); ++x) row[x * stride_ + c] = from[x];
          }
          const std::size_t node = r * std::size_t(width_);
          if (stride_ > kFew)
            for (std::size_t x = 0; x < std::size_t(width_); ++x)
              rows_.set(slice * slice_rows_ + y * std::size_t(width_) + x,
                        std::span(row).subspan(x * stride_, stride_));
          else
            std::copy(row.begin(), row.end(), spectra_.begin() + std::ptrdiff_t(node * stride_));
        }
      },
      8);
}

[[gnu::always_inline]] inline RglTable::Incidence RglTable::incidence(const Vec3& wi) const {
  Vec3 w = wi;
  float sign_x = 1, sign_y = 1;
  if (symmetry_ >= 2) {
    // Moves wi into the measured azimuths, which begin at -180 degrees: y is negative, and x is negative as
    // well where a quarter of the circle was measured.
    sign_y = wi.y >= 0 ? -1.f : 1.f;
    sign_x = symmetry_ == 4 ? (wi.x >= 0 ? -1.f : 1.f) : sign_y;
    w.x *= sign_x, w.y *= sign_y;
  }
  const Angles angles = angles_of(w);
  // A table with one azimuth holds for all azimuths.
  const float phi = nodes_.first.size() > 1 ? angles.phi : 0.f;
  return {w, sign_x, sign_y, square_of({angles.theta, phi}), nodes_.at(phi, angles.theta)};
}

[[gnu::always_inline]] inline RglTable::HalfVector RglTable::half_vector(const Incidence& i,
                                                                         const Vec3& wo) const {
  const Vec3 sum = i.wi + Vec3{wo.x * i.sign_x, wo.y * i.sign_y, wo.z};
  // The azimuth is relative to wi in isotropic tables; lengths do not matter to it.
  Vec3 turned = sum;
  if (const Vec2 axis = azimuth_axis(i.wi); is_isotropic_)
    turned.x = sum.x * axis.x + sum.y * axis.y, turned.y = sum.y * axis.x - sum.x * axis.y;
  const float across = std::sqrt(sum.x * sum.x + sum.y * sum.y);
  const Four angles = angles_above_axis(Four{across, std::abs(turned.y), 0, 0}, Four{sum.z, turned.x, 0, 0});
  HalfVector h;
  h.square = square_of({angles[0], std::copysign(angles[1], turned.y)});
  const float inverse = 1 / length(sum);
  h.area = half_vector_area(h.square.x, across * inverse) * 4 * (dot(i.wi, sum) * inverse);
  return h;
}

inline float RglTable::factor(const Incidence& i, const HalfVector& h) const {
  if (!is_relative_) return 1;
  const float sigma = sigma_.at(i.square);
  return sigma > 0 ? ndf_.at(h.square) / (4 * sigma) : 0.f;
}

/// The pdf of wo, by the pdf `vndf` of the half vector and the cell of the luminance.
inline float RglTable::density(const Incidence& i, const HalfVector& h, float vndf,
                               const SquareCell& cell) const {
  return h.area > 0 ? vndf * luminance_.pdf(cell, i.blend) / h.area : 0.f;
}

inline Spectrum RglTable::spectrum(const SliceBlend& blend, const SquareCell& cell,
                                   const Wavelengths& w) const {
  if (!is_spectral_) {
    const std::array<float, 3> c = channels(blend, cell);
    return primaries_[0].eval(w) * c[0] + primaries_[1].eval(w) * c[1] + primaries_[2].eval(w) * c[2];
  }
  const SpectralNodes::Place place = wavelengths_.at(w);
  if (stride_ > kFew) {
    std::array<std::uint32_t, 4> rows;
    for (std::size_t k = 0; k < 4; ++k) rows[k] = std::uint32_t(blend.slice[k] * slice_rows_ + cell.node);
    const SpectralRows::Corners corners{std::size_t(width_), cell.s, cell.t};
    const float* const weight = blend.weight.data();
    return max(blend.count == 4   ? rows_.sum<4>(rows.data(), weight, corners, place)
               : blend.count == 2 ? rows_.sum<2>(rows.data(), weight, corners, place)
                                  : rows_.sum<1>(rows.data(), weight, corners, place),
               0.f);
  }
  const std::size_t slice_size = std::size_t(width_) * std::size_t(height_) * stride_,
                    row_size = std::size_t(width_) * stride_;
  const float* const base = spectra_.data() + cell.node * stride_;
  const float low = 1 - cell.t, high = cell.t, left = 1 - cell.s, right = cell.s;
  // All wavelengths of the table at once, which lie together in memory, then those of the path.
  RegisterSum sum(place);
  for (int c = 0; c < int(stride_); c += kWavelengths) {
    Spectrum all(0.f);
    for (int k = 0; k < blend.count; ++k) {
      const float* const node = base + blend.slice[std::size_t(k)] * slice_size + c;
      const float* const above = node + row_size;
      all += ((load(node) * left + load(node + stride_) * right) * low +
              (load(above) * left + load(above + stride_) * right) * high) *
             blend.weight[std::size_t(k)];
    }
    sum.add(all, c);
  }
  return max(sum.value(), 0.f);
}

inline std::array<float, 3> RglTable::channels(const SliceBlend& blend, const SquareCell& cell) const {
  // Each node has three numbers; those of the next one are loaded with them.
  const std::size_t slice_size = std::size_t(width_) * std::size_t(height_) * 3,
                    row_size = std::size_t(width_) * 3;
  const float* const base = spectra_.data() + cell.node * 3;
  const float low = 1 - cell.t, high = cell.t, left = 1 - cell.s, right = cell.s;
  Four sum{};
  for (int k = 0; k < blend.count; ++k) {
    const float* const node = base + blend.slice[std::size_t(k)] * slice_size;
    const float* const above = node + row_size;
    sum += ((load_four(node) * left + load_four(node + 3) * right) * low +
            (load_four(above) * left + load_four(above + 3) * right) * high) *
           blend.weight[std::size_t(k)];
  }
  sum = sum > 0 ? sum : Four{};
  return {sum[0], sum[1], sum[2]};
}

Spectrum RglTable::value(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  const BilinearWarp::Point uniform = vndf_.invert(h.square, i.blend);
  return spectrum(i.blend, {uniform.p, width_, height_}, w) * factor(i, h);
}

std::array<float, 3> RglTable::rgb(const Vec3& wi, const Vec3& wo) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  std::array<float, 3> c = channels(i.blend, {vndf_.invert(h.square, i.blend).p, width_, height_});
  for (float& x : c) x *= factor(i, h);
  return c;
}

float RglTable::pdf(const Vec3& wi, const Vec3& wo) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  const BilinearWarp::Point uniform = vndf_.invert(h.square, i.blend);
  return density(i, h, uniform.pdf, {uniform.p, width_, height_});
}

BsdfEval RglTable::eval_pdf(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  const BilinearWarp::Point uniform = vndf_.invert(h.square, i.blend);
  const SquareCell cell(uniform.p, width_, height_);
  return {spectrum(i.blend, cell, w) * factor(i, h), density(i, h, uniform.pdf, cell)};
}

Vec3 RglTable::sample(const Vec3& wi, Vec2 u) const {
  const Incidence i = incidence(wi);
  const Vec2 uniform = luminance_.sample(u, i.blend).p, square = vndf_.sample(uniform, i.blend).p;
  Vec3 m = square_to_half_vector(square);
  if (is_isotropic_) {
    const Vec2 axis = azimuth_axis(i.wi);
    const float inverse = 1 / std::sqrt(axis.x * axis.x + axis.y * axis.y), c = axis.x * inverse,
                s = axis.y * inverse;
    m = {m.x * c - m.y * s, m.y * c + m.x * s, m.z};
  }
  const Vec3 wo = 2 * dot(m, i.wi) * m - i.wi;
  return {wo.x * i.sign_x, wo.y * i.sign_y, wo.z};
}

std::size_t RglTable::bytes() const {
  return vndf_.bytes() + luminance_.bytes() + spectra_.size() * sizeof(float) + rows_.bytes();
}

}  // namespace aureole
