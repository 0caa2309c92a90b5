// SPDX-License-Identifier: Apache-2.0
// A diffuse base under a rough dielectric coating: `plastic` with microfacets. The coating reflects as
// `roughdielectric`; its transmission is described by its tabulated directional transmittance T:
//     f = F D G / (4 cos_i cos_o) + T(i) T(o) / (pi eta^2) * rho / (1 - rho' F_int),
// with F_int the reflectance from below for diffuse light and rho' = rho if `nonlinear`, else 1. T and F_int
// include single scattering by the coating. With `energy_preserving` all light that is not reflected is
// transmitted, T = 1 - R and F_int = 1 - (mean of T)/eta^2, and a white base loses nothing.
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/microfacet.h"
#include "aureole/bsdf/microfacet/microfacet_energy.h"
#include "aureole/bsdf/microfacet/rough_coating.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class RoughPlastic final : public Bsdf {
public:
  explicit RoughPlastic(const Properties& properties)
      : Bsdf(properties),
        interior_(Ior::from(properties, "int_ior", "polypropylene")),
        exterior_(Ior::from(properties, "ext_ior", "air")),
        dispersive_(interior_.is_dispersive() || exterior_.is_dispersive()),
        nonlinear_(properties.get_bool("nonlinear", false)),
        diffuse_(get_texture(properties, "diffuse_reflectance", 0.5, SpectrumRole::reflectance)),
        specular_(get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)),
        roughness_(properties, false),
        facets_(roughness_.constant()) {
    const bool preserving = read_energy_preserving(properties);
    low_ = high_ = interior_.at_sodium_d() / exterior_.at_sodium_d();
    if (dispersive_) find_range(properties.context().grid);
    if (low_ == 1 && high_ == 1)
      throw properties.error("int_ior", "the index is the same on both sides, which is no coating");
    std::vector<double> key = roughness_.table_key();
    key.insert(key.end(), {double(low_), double(high_), double(preserving)});
    coatings_ = properties.shared_model<RoughCoatings>(key, [&] {
      auto made = std::make_shared<RoughCoatings>();
      made->by_index.emplace_back(facets_, low_, preserving);
      if (high_ > low_) made->by_index.emplace_back(facets_, high_, preserving);
      return made;
    });
    if (coatings_) first_ = &coatings_->by_index.front(), last_ = &coatings_->by_index.back();
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return at(State(*this, wi.z, ctx), wi, wo);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const State state(*this, wi.z, ctx);
    Vec3 wo;
    const bool specular = u1 < state.specular_probability;
    if (specular) {
      const Vec3 m = roughness_.visible() ? facets_.sample_visible(wi, u2) : facets_.sample_all(u2);
      wo = normalize(2 * dot(wi, m) * m - wi);
    } else {
      wo = square_to_cosine_hemisphere(u2);
    }
    if (!(wo.z > 0)) return {};
    const BsdfEval e = at(state, wi, wo);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, Lobe::reflect | (specular ? Lobe::glossy : Lobe::diffuse)};
  }

  Spectrum diffuse_reflectance(const Vec3&, const BsdfContext& ctx) const override {
    return diffuse_->eval(ctx.point, ctx.wavelengths);
  }

  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::glossy | Lobe::reflect; }

private:
  /// Quantities that depend only on wi.z, the point and the wavelengths.
  struct State {
    Spectrum eta, position, tint{1.f}, base;  ///< relative index, and its `position` between the two coatings
    float specular_probability;

    State(const RoughPlastic& p, float cos_i, const BsdfContext& ctx) : eta(p.low_) {
      if (p.dispersive_) {
        eta = p.interior_.eval(ctx.wavelengths) / p.exterior_.eval(ctx.wavelengths);
        if (p.high_ > p.low_) position = (eta - p.low_) * (1 / (p.high_ - p.low_));
      }
      if (p.specular_) tint = p.specular_->eval(ctx.point, ctx.wavelengths);
      const Spectrum rho = p.diffuse_->eval(ctx.point, ctx.wavelengths);
      const Spectrum t_i = p.interpolate(*this, [&](const RoughCoating& c) { return c.at(cos_i); });
      const Spectrum f_int = p.interpolate(*this, [](const RoughCoating& c) { return c.f_int; });
      const Spectrum leaving = p.interpolate(*this, [](const RoughCoating& c) { return c.leaving; });
      const Spectrum entered = t_i * rho / (Spectrum(1.f) - (p.nonlinear_ ? rho * f_int : f_int));
      base = entered / (eta * eta);
      // Lobes are chosen by their energy, averaged over the path's wavelengths, so that the probabilities do
      // not depend on the hero.
      const float s = mean(tint * (Spectrum(1.f) - t_i)), d = mean(entered * leaving);
      specular_probability = s + d > 0 ? s / (s + d) : 1;
    }
  };

  BsdfEval at(const State& s, const Vec3& wi, const Vec3& wo) const {
    const Vec3 sum = wi + wo;
    const float size = length(sum), cos_im = std::min(0.5f * size, 1.f);
    if (!(size > 0)) return {};
    const Vec3 m = sum / size;
    const float density = facets_.density(m), seen = 0.25f * density * facets_.masking_over_cos(wi);
    const Spectrum f = dispersive_ ? fresnel_dielectric(Spectrum(cos_im), s.eta)
                                   : Spectrum(fresnel_dielectric(cos_im, low_).reflectance);
    const float pdf = roughness_.visible() ? seen : 0.25f * density * m.z / cos_im;
    const float cosine = cosine_hemisphere_pdf(wo.z);
    const Spectrum t_o = interpolate(s, [&](const RoughCoating& c) { return c.at(wo.z); });
    return {f * s.tint * (seen * facets_.masking(wo)) + s.base * t_o * cosine,
            s.specular_probability * pdf + (1 - s.specular_probability) * cosine};
  }

  /// Interpolates between the coatings of the smallest and the largest index: T is nearly linear in so small
  /// a range.
  template <class F>
  Spectrum interpolate(const State& s, F&& f) const {
    const float first = f(*first_);
    return first_ == last_ ? Spectrum(first) : s.position * (f(*last_) - first) + first;
  }

  void find_range(const SpectralGrid& grid) {
    low_ = kInfinity, high_ = 0;
    for (int i = 0; i <= grid.cells; ++i) {
      const Wavelengths w = Wavelengths::at(grid, float(grid.node(i)));
      const float eta = interior_.eval(w)[0] / exterior_.eval(w)[0];
      low_ = std::min(low_, eta), high_ = std::max(high_, eta);
    }
  }

  Ior interior_, exterior_;
  bool dispersive_, nonlinear_;
  TexturePtr diffuse_, specular_;
  Roughness roughness_;
  Microfacets facets_;
  float low_ = 1, high_ = 1;  // smallest and largest index, interior over exterior
  std::shared_ptr<const RoughCoatings> coatings_;
  const RoughCoating *first_ = nullptr,
                     *last_ = nullptr;  ///< coatings of the smallest and of the largest index
};

AUREOLE_PLUGIN(
    RoughPlastic, "bsdf", "roughplastic",
    PluginDoc{
        "A diffuse base under a rough transparent coating: a broad highlight over a diffuse colour, with "
        "the interreflections between the base and the coating. Single scattering by the coating makes very "
        "rough plastics dark; with `energy_preserving` a white base loses no light. It reflects on the side "
        "of its normal and is black on the other; `twosided` makes both sides alike.",
        "B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet models for refraction through rough "
        "surfaces, EGSR 2007; interreflections: J. L. Saunderson, Calculation of the color of pigmented "
        "plastics, J. Opt. Soc. Am. 32, 1942, as used in Mitsuba",
        {{"diffuse_reflectance", "texture", "", "0.5", "reflectance of the base"},
         {"nonlinear", "boolean", "", "false",
          "whether the base absorbs at each internal reflection, which shifts saturated colours (false: "
          "only once)"},
         {"int_ior", "float or string", "", "polypropylene",
          "index of refraction of the coating, as a number or a material's name"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction outside, as a number or a material's name"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"specular_reflectance", "texture", "", "1",
          "factor of the specular reflection; leave at 1 for a real coating"},
         {"distribution", "string", "", "beckmann",
          "distribution of the microfacet normals: beckmann or ggx"},
         {"alpha", "float", "", "0.1", "roughness; for beckmann sqrt(2) times the RMS slope"},
         {"sample_visible", "boolean", "", "true", "sample visible normals (less noise), not all normals"},
         {"energy_preserving", "boolean", "", "the scene's, else false",
          "transmit all light that the coating does not reflect, some of which Mitsuba loses"}},
        {R"(<bsdf type="roughplastic">
    <rgb name="diffuse_reflectance" value="0.1, 0.27, 0.36"/>
    <float name="int_ior" value="1.9"/>
    <string name="distribution" value="ggx"/>
    <float name="alpha" value="0.2"/>
</bsdf>)",
         R"(<bsdf type="roughplastic">
    <rgb name="diffuse_reflectance" value="0.7, 0.1, 0.1"/>
    <boolean name="nonlinear" value="true"/>
    <string name="int_ior" value="polystyrene"/>
    <string name="ext_ior" value="water"/>
    <boolean name="dispersion" value="true"/>
    <float name="specular_reflectance" value="0.5"/>
    <float name="alpha" value="0.3"/>
    <boolean name="sample_visible" value="false"/>
    <boolean name="energy_preserving" value="true"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
