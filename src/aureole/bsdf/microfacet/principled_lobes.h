// SPDX-License-Identifier: Apache-2.0
// Functions that the two principled BSDFs share (B. Burley, Physically based shading at Disney, SIGGRAPH 2012
// course notes; Extending the Disney BRDF to a BSDF with integrated subsurface scattering, SIGGRAPH 2015
// course notes; constants as in Mitsuba 3.9).
#pragma once

#include <array>
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/ggx.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/spectrum/observer.h"
#include "aureole/texture/texture.h"

namespace aureole::principled {

/// Schlick's weight (1 - cos)^5.
inline float schlick_weight(float cos_theta) {
  const float m = std::clamp(1 - cos_theta, 0.f, 1.f), m2 = m * m;
  return m2 * m2 * m;
}

/// Schlick's approximation from the reflectance at normal incidence; `eta` is the index beyond over the index
/// on the side of the light. Towards a medium of lower index it uses the cosine there, which is 0 beyond the
/// critical angle.
inline Spectrum schlick(const Spectrum& r0, float cos_i, float eta) {
  float c = cos_i;
  if (!(eta > 1)) {
    const float sin_t2 = (1 - cos_i) * (1 + cos_i) / (eta * eta);
    c = std::sqrt(std::max(1 - sin_t2, 0.f));
  }
  return lerp(r0, 1.f, schlick_weight(c));
}

inline float normal_reflectance(float eta) {
  const float r = (eta - 1) / (eta + 1);
  return r * r;
}

/// Reads a parameter in [0, 1].
inline ScalarTexture unit(const Properties& properties, const char* name, double fallback) {
  return ScalarTexture::from(properties, name, fallback, Range::unit());
}
/// Reads a lobe's relative number of samples.
inline float rate(const Properties& properties, const char* name) {
  return float(properties.get_float(name, 1, Range::non_negative()));
}

struct Half {
  Vec3 h;
  float c = 0;  ///< cosine between h and either direction; 0 if there is no half vector
};
inline Half half_vector(const Vec3& a, const Vec3& b) {
  const Vec3 h = a + b;
  const float length2 = length_squared(h);
  if (!(length2 > 1e-30f)) return {};
  const float inverse = 1 / std::sqrt(length2);
  return {h * inverse, std::min(0.5f * length2 * inverse, 1.f)};
}

/// GGX distribution with alpha = roughness^2, stretched along the tangent (Burley 2012).
inline Ggx distribution(float roughness, float anisotropic) {
  const float alpha = roughness * roughness, aspect = std::sqrt(1 - 0.9f * anisotropic);
  return {std::max(0.001f, alpha / aspect), std::max(0.001f, alpha * aspect)};
}

/// Returns pi f / base_color of diffuse reflection with retro-reflection at grazing angles (Burley 2015).
/// `flatness` blends it with an approximation of subsurface scattering (Burley 2012, after Hanrahan & Krueger
/// 1993). `cos_d` is the cosine between a direction and the half vector.
inline float diffuse(float cos_i, float cos_o, float cos_d, float roughness, float flatness) {
  const float fi = schlick_weight(cos_i), fo = schlick_weight(cos_o), rr = 2 * roughness * cos_d * cos_d;
  const float lambert = (1 - 0.5f * fi) * (1 - 0.5f * fo), retro = rr * (fo + fi + fo * fi * (rr - 1));
  if (flatness == 0) return lambert + retro;
  const float fss90 = 0.5f * rr, fss = (1 + (fss90 - 1) * fo) * (1 + (fss90 - 1) * fi);
  const float subsurface = 1.25f * (fss * (1 / (cos_i + cos_o) - 0.5f) + 0.5f);
  return lambert + retro + flatness * (subsurface - lambert - retro);
}

/// The colour of the material, and its tint: the colour divided by its luminance under D65, so that a grey
/// has no tint.
class BaseColor {
public:
  explicit BaseColor(const Properties& properties)
      : texture_(get_texture(properties, "base_color", 0.5, SpectrumRole::reflectance)) {
    const SpectralGrid& grid = properties.context().grid;
    const SampledSpectrum sensitivity = product(observer_xyz(grid)[1], d65_spectrum(grid, 1));
    // For a sensor outside the visible range, the luminance is replaced by the mean over its range.
    const bool visible = sensitivity.integral() > 1e-6;
    std::vector<double> mass(grid.cells + 1);
    double total = 0;
    for (int i = 0; i <= grid.cells; ++i) {
      mass[i] = (visible ? double(sensitivity.nodes()[i]) : 1) * (i == 0 || i == grid.cells ? 0.5 : 1);
      total += mass[i];
    }
    if (texture_->is_constant()) {
      const SampledSpectrum color = texture_->average();
      double sum = 0;
      for (int i = 0; i <= grid.cells; ++i) sum += mass[i] * double(color.nodes()[i]);
      luminance_ = float(sum / total);
      return;
    }
    // A texture is evaluated at the centroids of kNodes intervals of equal sensitivity.
    std::array<double, kNodes> centroid{};
    double room = 1;
    for (int i = 0, part = 0; i <= grid.cells; ++i)
      for (double m = mass[i] / total * kNodes; m > 0;) {
        const double taken = part == kNodes - 1 ? m : std::min(m, room);
        centroid[part] += taken * grid.node(i);
        m -= taken, room -= taken;
        if (room <= 1e-12 && part < kNodes - 1) ++part, room = 1;
      }
    for (int b = 0; b < kNodes / kWavelengths; ++b)
      nodes_[b] =
          Wavelengths::at(grid, make_spectrum([&](int j) { return float(centroid[b * kWavelengths + j]); }));
  }

  Spectrum eval(const BsdfContext& ctx) const { return texture_->eval(ctx.point, ctx.wavelengths); }

  /// `color` is the result of `eval`.
  Spectrum tint(const Spectrum& color, const BsdfContext& ctx) const {
    float luminance = luminance_;
    if (!texture_->is_constant()) {
      luminance = 0;
      for (const Wavelengths& w : nodes_) luminance += sum(texture_->eval(ctx.point, w));
      luminance *= 1.f / kNodes;
    }
    return luminance > 0 ? color * (1 / luminance) : Spectrum(1.f);
  }

private:
  static constexpr int kNodes = 16;
  TexturePtr texture_;
  float luminance_ = 0;  // luminance of a constant texture
  std::array<Wavelengths, kNodes / kWavelengths> nodes_;
};

}  // namespace aureole::principled
