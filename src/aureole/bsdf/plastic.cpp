// SPDX-License-Identifier: Apache-2.0
// A diffuse base under a smooth dielectric coating: a delta lobe of the coating, and light that enters, is
// scattered diffusely (any number of times, by internal reflection at the coating) and leaves:
//     f = (1 - F_i) (1 - F_o) / (pi eta^2) * rho / (1 - rho' F_int),
// with F_int the internal diffuse reflectance and rho' = rho if `nonlinear`, else 1.
#include <cmath>

#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/math/warp.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Plastic final : public Bsdf, public MirrorReflection {
public:
  explicit Plastic(const Properties& properties)
      : Bsdf(properties),
        interior_(Ior::from(properties, "int_ior", "polypropylene")),
        exterior_(Ior::from(properties, "ext_ior", "air")),
        dispersive_(interior_.is_dispersive() || exterior_.is_dispersive()),
        nonlinear_(properties.get_bool("nonlinear", false)),
        diffuse_(get_texture(properties, "diffuse_reflectance", 0.5, SpectrumRole::reflectance)),
        specular_(get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)) {
    constant_ = Coating::of(interior_.at_sodium_d() / double(exterior_.at_sodium_d()));
    if (dispersive_) tabulate_coating(properties.context().grid);
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return diffuse_lobe(State(*this, wi.z, ctx), wo);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const State state(*this, wi.z, ctx);
    if (u1 < state.specular_probability)
      return BsdfSample{reflect(wi), state.specular, state.specular_probability, Lobe::delta | Lobe::reflect};
    if (!(state.specular_probability < 1)) return {};
    const Vec3 wo = square_to_cosine_hemisphere(u2);
    const BsdfEval e = diffuse_lobe(state, wo);
    return BsdfSample{wo, e.value, e.pdf, Lobe::diffuse | Lobe::reflect};
  }

  Amplitudes reflection_amplitudes(float cos_i, const BsdfContext& ctx) const override {
    Amplitudes reflected = dielectric_amplitudes(
        cos_i, dispersive_ ? interior_.eval(ctx.wavelengths) / exterior_.eval(ctx.wavelengths)
                           : Spectrum(constant_.eta));
    if (specular_) reflected.scale(specular_->eval(ctx.point, ctx.wavelengths));
    return reflected;
  }

  bool needs_tangent() const override { return false; }
  Spectrum diffuse_reflectance(const Vec3&, const BsdfContext& ctx) const override {
    return diffuse_->eval(ctx.point, ctx.wavelengths);
  }

  Lobe lobes() const override { return Lobe::diffuse | Lobe::delta | Lobe::reflect; }

private:
  struct Coating {
    float eta = 1, inverse_eta2 = 1, f_int = 0;

    static Coating of(double eta) {
      return {float(eta), float(1 / (eta * eta)), float(optics::fresnel_diffuse_reflectance(1 / eta))};
    }
  };

  /// Quantities that depend only on wi and the wavelengths.
  struct State {
    Spectrum eta, f_i, specular, base;
    float specular_probability;
    bool flat;  ///< whether one index holds for all wavelengths

    State(const Plastic& p, float cos_i, const BsdfContext& ctx) : flat(!p.dispersive_) {
      Spectrum inverse_eta2, f_int;
      if (flat) {
        eta = p.constant_.eta;
        inverse_eta2 = p.constant_.inverse_eta2;
        f_int = p.constant_.f_int;
        f_i = fresnel_dielectric(cos_i, p.constant_.eta).reflectance;
      } else {
        eta = p.interior_.eval(ctx.wavelengths) / p.exterior_.eval(ctx.wavelengths);
        inverse_eta2 = Spectrum(1.f) / (eta * eta);
        f_int = p.f_int_.eval(ctx.wavelengths);
        f_i = fresnel_dielectric(cos_i, eta);
      }
      specular = f_i;
      if (p.specular_) specular *= p.specular_->eval(ctx.point, ctx.wavelengths);
      const Spectrum rho = p.diffuse_->eval(ctx.point, ctx.wavelengths);
      const Spectrum entered =
          (Spectrum(1.f) - f_i) * rho / (Spectrum(1.f) - (p.nonlinear_ ? rho * f_int : f_int));
      base = entered * inverse_eta2;
      // Lobes are chosen by their energy, averaged over the path's wavelengths, so that the probabilities do
      // not depend on the hero. The fraction 1 - F_int of `entered` leaves.
      const float s = mean(specular), d = mean(entered * (Spectrum(1.f) - f_int));
      specular_probability = s + d > 0 ? s / (s + d) : 1;
    }
  };

  static BsdfEval diffuse_lobe(const State& s, const Vec3& wo) {
    const Spectrum f_o =
        s.flat ? Spectrum(fresnel_dielectric(wo.z, s.eta[0]).reflectance) : fresnel_dielectric(wo.z, s.eta);
    const float pdf = cosine_hemisphere_pdf(wo.z);
    return {s.base * (Spectrum(1.f) - f_o) * pdf, (1 - s.specular_probability) * pdf};
  }

  void tabulate_coating(const SpectralGrid& grid) {
    // Few nodes with linear interpolation suffice, since the function is smooth, and its quadrature is
    // costly.
    constexpr int kNodes = 129;
    std::vector<double> nm(kNodes), values(kNodes);
    for (int i = 0; i < kNodes; ++i) {
      nm[i] = grid.min_nm + (grid.max_nm - grid.min_nm) * i / (kNodes - 1);
      const Wavelengths w = Wavelengths::at(grid, float(nm[i]));
      values[i] = optics::fresnel_diffuse_reflectance(exterior_.eval(w)[0] / double(interior_.eval(w)[0]));
    }
    f_int_ = SampledSpectrum::from_points(grid, nm, values);
  }

  Ior interior_, exterior_;
  bool dispersive_, nonlinear_;
  Coating constant_;
  SampledSpectrum f_int_;  // internal diffuse reflectance of a dispersive coating
  TexturePtr diffuse_, specular_;
};

AUREOLE_PLUGIN(
    Plastic, "bsdf", "plastic",
    PluginDoc{
        "A diffuse base under a smooth transparent coating: a sharp highlight over a diffuse colour, "
        "with the interreflections between the base and the coating. It reflects on the side of its "
        "normal and is black on the other; `twosided` makes both sides alike.",
        "Fresnel: M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 1.5.2; "
        "interreflections: J. L. Saunderson, "
        "Calculation of the color of pigmented plastics, J. Opt. Soc. Am. 32, 1942, as used in Mitsuba",
        {{"diffuse_reflectance", "texture", "", "0.5", "reflectance of the base"},
         {"nonlinear", "boolean", "", "false",
          "whether the base absorbs at each internal reflection, which shifts saturated colours "
          "(false: only once)"},
         {"int_ior", "float or string", "", "polypropylene",
          "index of refraction of the coating, as a number or a material's name"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction outside, as a number or a material's name"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"specular_reflectance", "texture", "", "1",
          "factor of the specular reflection; leave at 1 for a real coating"}},
        {R"(<bsdf type="plastic">
    <rgb name="diffuse_reflectance" value="0.1, 0.27, 0.36"/>
    <float name="int_ior" value="1.9"/>
</bsdf>)",
         R"(<bsdf type="plastic">
    <rgb name="diffuse_reflectance" value="0.7, 0.1, 0.1"/>
    <boolean name="nonlinear" value="true"/>
    <string name="int_ior" value="polystyrene"/>
    <string name="ext_ior" value="water"/>
    <boolean name="dispersion" value="true"/>
    <float name="specular_reflectance" value="0.5"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
