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
  // Vectors of wavelengths may reach beyond the last node.
  spectra_.resize(nodes_.count() * area * stride_ + std::size_t(kWavelengths));
  // The file stores an array for each channel; the table keeps all channels of a node together.
  for_ranges(
      nodes_.count() * std::size_t(height_),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          const std::size_t slice = row / std::size_t(height_), y = row % std::size_t(height_);
          for (std::size_t c = 0; c < stride_; ++c) {
            const std::size_t channel = is_spectral_ ? wavelengths_.source(c) : c;
            const float* from =
                file.spectra.data() + (slice * channels + channel) * area + y * std::size_t(width_);
            float* to = spectra_.data() + row * std::size_t(width_) * stride_ + c;
            for (int x = 0; x < width_; ++x) to[std::size_t(x) * stride_] = from[x];
          }
        }
      },
      8);
}

RglTable::Incidence RglTable::incidence(const Vec3& wi) const {
  Incidence i;
  i.wi = wi;
  if (symmetry_ >= 2) {
    // Moves wi into the measured azimuths, which begin at -180 degrees: y is negative, and x is negative as
    // well where a quarter of the circle was measured.
    i.sign_y = wi.y >= 0 ? -1.f : 1.f;
    i.sign_x = symmetry_ == 4 ? (wi.x >= 0 ? -1.f : 1.f) : i.sign_y;
    i.wi.x *= i.sign_x, i.wi.y *= i.sign_y;
  }
  const float sine = std::sqrt(i.wi.x * i.wi.x + i.wi.y * i.wi.y);
  const float theta = angle_above_axis(sine, wi.z);
  i.cos_phi = sine > 0 ? i.wi.x / sine : 1.f, i.sin_phi = sine > 0 ? i.wi.y / sine : 0.f;
  // A table with one azimuth holds for all azimuths.
  const float phi = nodes_.first.size() > 1 ? azimuth_of(i.wi) : 0.f;
  i.square = {std::sqrt(theta * (2 * kInvPi)), phi * (0.5f * kInvPi) + 0.5f};
  i.blend = nodes_.at(phi, theta);
  return i;
}

RglTable::HalfVector RglTable::half_vector(const Incidence& i, const Vec3& wo) const {
  const Vec3 out{wo.x * i.sign_x, wo.y * i.sign_y, wo.z};
  Vec3 m = normalize(i.wi + out);
  const float cosine = dot(i.wi, m), sine = std::sqrt(m.x * m.x + m.y * m.y);
  if (is_isotropic_) m = {m.x * i.cos_phi + m.y * i.sin_phi, m.y * i.cos_phi - m.x * i.sin_phi, m.z};
  HalfVector h;
  h.square = half_vector_to_square(m);
  const BilinearWarp::Point p = vndf_.invert(h.square, i.blend);
  h.uniform = p.p;
  h.pdf = p.pdf;
  h.area = half_vector_area(h.square.x, sine) * 4 * cosine;
  return h;
}

float RglTable::factor(const Incidence& i, const HalfVector& h) const {
  if (!is_relative_) return 1;
  const float sigma = sigma_.at(i.square);
  return sigma > 0 ? ndf_.at(h.square) / (4 * sigma) : 0.f;
}

float RglTable::density(const Incidence& i, const HalfVector& h) const {
  const float area = h.area;
  return area > 0 ? h.pdf * luminance_.pdf(h.uniform, i.blend) / area : 0.f;
}

Spectrum RglTable::spectrum(const Incidence& i, Vec2 uniform, const Wavelengths& w) const {
  if (!is_spectral_) {
    const std::array<float, 3> c = channels(i, uniform);
    return primaries_[0].eval(w) * c[0] + primaries_[1].eval(w) * c[1] + primaries_[2].eval(w) * c[2];
  }
  const GridCell x(uniform.x, width_), y(uniform.y, height_);
  const SpectralNodes::Place place = wavelengths_.at(w);
  const std::size_t slice_size = std::size_t(width_) * std::size_t(height_) * stride_;
  const float* const base =
      spectra_.data() + (std::size_t(y.index) * std::size_t(width_) + std::size_t(x.index)) * stride_;
  SpectralSum sum(place);
  if (constexpr std::size_t kFew = 32; stride_ <= kFew) {
    // All wavelengths of the table at once, which lie together in memory, then those of the path.
    constexpr std::size_t kWidth = std::size_t(kWavelengths);
    alignas(64) float row[kFew + kWidth + 1];
    for (std::size_t c = 0; c < stride_; c += kWidth) {
      Spectrum all(0.f);
      const auto add = [&](const float* from, float weight) {
        Spectrum values;
        std::memcpy(values.data(), from + c, sizeof(float) * kWidth);
        all = all + values * weight;
      };
      for (int k = 0; k < i.blend.count; ++k) {
        const float* const node = base + i.blend.slice[std::size_t(k)] * slice_size;
        const float* const above = node + std::size_t(width_) * stride_;
        const float weight = i.blend.weight[std::size_t(k)], low = weight * (1 - y.fraction),
                    high = weight * y.fraction;
        add(node, low * (1 - x.fraction)), add(node + stride_, low * x.fraction);
        add(above, high * (1 - x.fraction)), add(above + stride_, high * x.fraction);
      }
      std::memcpy(row + c, all.data(), sizeof(float) * kWidth);
    }
    sum.add(row, 1);
    return sum.value();
  }
  for (int k = 0; k < i.blend.count; ++k) {
    const float* const node = base + i.blend.slice[std::size_t(k)] * slice_size;
    const float* const above = node + std::size_t(width_) * stride_;
    const float weight = i.blend.weight[std::size_t(k)], low = weight * (1 - y.fraction),
                high = weight * y.fraction;
    sum.add(node, low * (1 - x.fraction)), sum.add(node + stride_, low * x.fraction);
    sum.add(above, high * (1 - x.fraction)), sum.add(above + stride_, high * x.fraction);
  }
  return sum.value();
}

std::array<float, 3> RglTable::channels(const Incidence& i, Vec2 uniform) const {
  const GridCell x(uniform.x, width_), y(uniform.y, height_);
  std::array<float, 3> sum{};
  for (int k = 0; k < i.blend.count; ++k)
    for (int corner = 0; corner < 4; ++corner) {
      const float factor = i.blend.weight[std::size_t(k)] * (corner & 1 ? x.fraction : 1 - x.fraction) *
                           (corner & 2 ? y.fraction : 1 - y.fraction);
      const std::size_t row = std::size_t(y.index + (corner >> 1)),
                        column = std::size_t(x.index + (corner & 1));
      const float* node =
          spectra_.data() +
          ((i.blend.slice[std::size_t(k)] * std::size_t(height_) + row) * std::size_t(width_) + column) *
              stride_;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += factor * node[c];
    }
  return sum;
}

Spectrum RglTable::value(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  return spectrum(i, h.uniform, w) * factor(i, h);
}

std::array<float, 3> RglTable::rgb(const Vec3& wi, const Vec3& wo) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  std::array<float, 3> c = channels(i, h.uniform);
  for (float& x : c) x *= factor(i, h);
  return c;
}

float RglTable::pdf(const Vec3& wi, const Vec3& wo) const {
  const Incidence i = incidence(wi);
  return density(i, half_vector(i, wo));
}

BsdfEval RglTable::eval_pdf(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const {
  const Incidence i = incidence(wi);
  const HalfVector h = half_vector(i, wo);
  return {spectrum(i, h.uniform, w) * factor(i, h), density(i, h)};
}

Vec3 RglTable::sample(const Vec3& wi, Vec2 u) const {
  const Incidence i = incidence(wi);
  const Vec2 uniform = luminance_.sample(u, i.blend).p, square = vndf_.sample(uniform, i.blend).p;
  Vec3 m = square_to_half_vector(square);
  if (is_isotropic_) m = {m.x * i.cos_phi - m.y * i.sin_phi, m.y * i.cos_phi + m.x * i.sin_phi, m.z};
  const Vec3 wo = 2 * dot(m, i.wi) * m - i.wi;
  return {wo.x * i.sign_x, wo.y * i.sign_y, wo.z};
}

std::size_t RglTable::bytes() const {
  return vndf_.bytes() + luminance_.bytes() + spectra_.size() * sizeof(float);
}

}  // namespace aureole
