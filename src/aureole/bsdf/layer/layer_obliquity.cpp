// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/layer_obliquity.h"

#include <algorithm>
#include <cmath>

namespace aureole {

namespace {

constexpr float kSmallestCosine = 1e-5f;

}  // namespace

LayerObliquity LayerObliquity::from(const Properties& p) {
  const std::string kind = p.get_choice("obliquity", "reciprocal", {"reciprocal", "fraunhofer", "kirchhoff"});
  LayerObliquity o;
  o.kind_ = kind == "reciprocal"   ? Kind::reciprocal
            : kind == "fraunhofer" ? Kind::fraunhofer
                                   : Kind::kirchhoff;
  return o;
}

Spectrum LayerObliquity::factor(const Vec3& wi, const Vec3& wo, const Spectrum& n_i, const Spectrum& n_o,
                                TransportMode mode) const {
  const bool radiance = mode == TransportMode::radiance;
  const Vec3& arrives = radiance ? wo : wi;
  const Vec3& leaves = radiance ? wi : wo;
  const Spectrum ratio = radiance ? n_o / n_i : n_i / n_o;
  // 1 - (ratio sin)^2, written so that it stays accurate at grazing angles.
  const Spectrum c2 =
      Spectrum(arrives.z * arrives.z) * ratio * ratio + (Spectrum(1.f) - ratio) * (Spectrum(1.f) + ratio);
  const SpectrumMask exists = c2.v > Spectrum(0.f).v;
  const Spectrum cos_s = sqrt(select(exists, c2, 1.f)), cos_l = std::max(std::abs(leaves.z), kSmallestCosine);
  const Spectrum mean_cosine = (cos_s + cos_l) * 0.5f;
  const Spectrum o = kind_ == Kind::fraunhofer
                         ? cos_s / cos_l
                         : mean_cosine * mean_cosine / (max(cos_s, kSmallestCosine) * cos_l);
  return select(exists, o, 0.f);
}

}  // namespace aureole
