// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/layer_substrate.h"

namespace aureole {

LayerSubstrate LayerSubstrate::from(const Properties& p) {
  LayerSubstrate s;
  const std::string kind = p.get_choice("substrate", "none", {"none", "dielectric", "thindielectric"});
  s.kind_ = kind == "none" ? Kind::none : kind == "dielectric" ? Kind::interface : Kind::pane;
  s.exterior_ = Ior::from(p, "ext_ior", "air");
  s.interior_ = s.is_none() ? s.exterior_ : Ior::from(p, "int_ior", "bk7");
  s.dispersive_ = s.exterior_.is_dispersive() || s.interior_.is_dispersive();
  return s;
}

std::optional<BsdfSample> LayerSubstrate::sample(const Vec3& wi, float u1, float weight, float mass,
                                                 const BsdfContext& ctx) const {
  if (is_none()) return BsdfSample{-wi, weight, mass, kNullLobe};
  const Indices n = indices(wi.z, ctx.wavelengths);
  const Spectrum r = reflectance(std::abs(wi.z), n);
  Spectrum t = Spectrum(1.f) - r;
  if (kind_ == Kind::pane) {
    const float share = mean(r);  // the mass of a null lobe must not depend on the wavelength
    if (u1 < share) return BsdfSample{reflect(wi), r * weight, share * mass, Lobe::delta | Lobe::reflect};
    return BsdfSample{-wi, t * weight, (1 - share) * mass, kNullLobe};
  }
  if (u1 < r[0]) return BsdfSample{reflect(wi), r * weight, r * mass, Lobe::delta | Lobe::reflect};
  // Wavelengths with another index are refracted into other directions and have value 0 in this one.
  const Spectrum etas = n.beyond / n.here;
  const float eta = etas[0], cos_t = fresnel_dielectric(std::abs(wi.z), eta).cos_t;
  t = select(etas.v == Spectrum(eta).v, t, 0.f);
  if (!(t[0] > 0) || !(cos_t > 0)) return {};
  const Vec3 wo{-wi.x / eta, -wi.y / eta, wi.z > 0 ? -cos_t : cos_t};
  BsdfSample s{wo, t * weight, t * mass, Lobe::delta | Lobe::transmit, eta};
  if (ctx.mode == TransportMode::radiance) s.value *= 1 / (eta * eta);
  return s;
}

Spectrum LayerSubstrate::straight(const Vec3& wi, const BsdfContext& ctx) const {
  if (is_none()) return 1.f;
  if (kind_ == Kind::interface) return 0.f;
  return Spectrum(1.f) - reflectance(std::abs(wi.z), indices(wi.z, ctx.wavelengths));
}

}  // namespace aureole
