// SPDX-License-Identifier: Apache-2.0
// A slab with parallel faces as one surface, with interference and absorption: a wall for radio waves, a soap
// film, a semi-transparent metal foil.
#include <algorithm>
#include <cmath>
#include <complex>

#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/parameter/complex_index.h"
#include "aureole/parameter/ior.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Slab final : public Bsdf, public MirrorReflection {
  static constexpr double kThickest_m = 1e6, kLargestIndex = 1e6;

public:
  explicit Slab(const Properties& p)
      : Bsdf(p),
        exterior_(Ior::from(p, "ext_ior", "air")),
        thickness_nm_(p.get_length_m("thickness", 0, {0, kThickest_m, true}) * 1e9),
        reflectance_(get_optional_texture(p, "specular_reflectance", SpectrumRole::reflectance)),
        transmittance_(get_optional_texture(p, "specular_transmittance", SpectrumRole::reflectance)) {
    if (!p.has("thickness"))
      throw p.error("thickness",
                    "the parameter \"thickness\" is required, a length such as \"0.1m\" or \"300nm\"");
    if (!p.has("int_ior"))
      throw p.error("int_ior", "the parameter \"int_ior\" is required, a number or a material's name");
    const auto k = get_optional_spectrum(p, "k", SpectrumRole::unbounded);
    const auto index = read_complex_index(p, "int_ior", "", k);
    const SpectralGrid& grid = p.context().grid;
    for (int i = 0; i <= grid.cells; ++i)
      if (!(std::abs(index(grid.node(i))) <= kLargestIndex))
        throw p.error("int_ior", "the index of refraction, with \"k\", must be at most 1e6");
    eta_ = SampledSpectrum::from_function(grid, [&](double nm) { return index(nm).real(); });
    k_ = SampledSpectrum::from_function(grid, [&](double nm) { return index(nm).imag(); });
    // The transmittance below which the slab counts as opaque. At normal incidence the path through the slab
    // is shortest, so that absorption is least.
    constexpr double kOpaque = 1e-12;
    for (int i = 0; i <= grid.cells; ++i)
      passes_ |= std::exp(-4 * kPiD * index(grid.node(i)).imag() * thickness_nm_ / grid.node(i)) > kOpaque;
  }

  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override { return {}; }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2, const BsdfContext& ctx) const override {
    const float cos_i = std::min(std::abs(wi.z), 1.f);
    if (!(cos_i > 0)) return {};
    const Powers part = powers(cos_i, ctx);
    // The probability of a null lobe must not depend on the wavelength.
    const float reflected = mean(part.reflected), all = reflected + mean(part.transmitted);
    if (!(all > 0)) return {};
    const float mass = reflected / all;
    if (u1 < mass) return BsdfSample{reflect(wi), part.reflected, mass, Lobe::delta | Lobe::reflect};
    if (!passes_) return {};
    return BsdfSample{-wi, part.transmitted, 1 - mass, kNullLobe};
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    const float cos_i = std::min(std::abs(wi.z), 1.f);
    return cos_i > 0 && passes_ ? powers(cos_i, ctx).transmitted : Spectrum(0.f);
  }

  Amplitudes reflection_amplitudes(float cos_i, const BsdfContext& ctx) const override {
    Amplitudes reflected;
    for_each_wavelength(cos_i, ctx, [&](int i, const optics::SlabAmplitudes& at) {
      reflected.s[std::size_t(i)] = at.r_s, reflected.p[std::size_t(i)] = at.r_p;
    });
    if (reflectance_) reflected.scale(reflectance_->eval(ctx.point, ctx.wavelengths));
    return reflected;
  }

  bool needs_tangent() const override { return false; }
  Lobe lobes() const override {
    const Lobe reflection = Lobe::delta | Lobe::reflect;
    return passes_ ? kNullLobe | reflection | Lobe::through : reflection;
  }

private:
  /// Calls use(i, amplitudes) for each wavelength i.
  template <class Use>
  void for_each_wavelength(float cos_i, const BsdfContext& ctx, const Use& use) const {
    const Spectrum eta = eta_.eval(ctx.wavelengths), k = k_.eval(ctx.wavelengths);
    const Spectrum outside = ctx.eval_exterior(exterior_), nm = ctx.wavelengths.nm;
    for (int i = 0; i < kWavelengths; ++i)
      use(i, optics::slab_amplitudes(double(cos_i), double(outside[i]), {double(eta[i]), double(k[i])},
                                     thickness_nm_ / double(nm[i])));
  }

  struct Powers {
    Spectrum reflected, transmitted;
  };
  Powers powers(float cos_i, const BsdfContext& ctx) const {
    Powers part;
    for_each_wavelength(cos_i, ctx, [&](int i, const optics::SlabAmplitudes& at) {
      const optics::SlabPowers both = optics::slab_powers(at);
      part.reflected.v[i] = float(both.reflected);
      part.transmitted.v[i] = passes_ ? float(both.transmitted) : 0.f;
    });
    if (reflectance_) part.reflected *= reflectance_->eval(ctx.point, ctx.wavelengths);
    if (transmittance_) part.transmitted *= transmittance_->eval(ctx.point, ctx.wavelengths);
    return part;
  }

  SampledSpectrum eta_, k_;
  Ior exterior_;
  double thickness_nm_;
  bool passes_ = false;  ///< whether the transmittance is at least 1e-12 at some wavelength
  TexturePtr reflectance_, transmittance_;
};

AUREOLE_PLUGIN(
    Slab, "bsdf", "slab",
    PluginDoc{
        "A slab with parallel faces as one surface: reflection and transmission with interference of all reflections "
        "within it, and absorption. For walls at radio wavelengths, soap films, and leaves of metal so thin that light "
        "passes. It looks alike from both sides. Transmitted light keeps its direction, without the displacement of a thick slab: light sampling "
        "passes through, and crossing it is no path vertex, as for `thindielectric`, which adds powers instead of "
        "fields and suits panes thicker than the coherence length. Polarisations are averaged.",
        "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, sections 1.6.4 and 14.4; Recommendation ITU-R P.2040-3, "
        "section 2.2.2",
        {{"int_ior", "float or string", "", "required",
          "index of refraction of the slab: a number, a dielectric, a metal, or a building material at radio "
          "frequencies, such as itu_concrete (ITU-R P.2040-3)"},
         {"k", "spectrum", "", "0", "extinction coefficient: imaginary part of the index of dielectrics"},
         {"thickness", "length", "m", "required", "thickness of the slab, such as \"0.1m\" or \"300nm\""},
         {"ext_ior", "float or string", "", "air",
          "index of refraction on both sides, as a number or the name of a material"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"specular_reflectance", "texture", "", "1",
          "factor of the reflected light; leave at 1 for a real slab"},
         {"specular_transmittance", "texture", "", "1",
          "factor of the transmitted light; leave at 1 for a real slab"}},
        {R"(<bsdf type="slab">
    <string name="int_ior" value="water"/>
    <string name="ext_ior" value="air"/>
    <string name="thickness" value="400nm"/>
    <boolean name="dispersion" value="true"/>
</bsdf>)",
         R"(<bsdf type="slab">
    <float name="int_ior" value="1.5"/>
    <spectrum name="k" value="0.01"/>
    <string name="thickness" value="2um"/>
    <float name="specular_reflectance" value="0.9"/>
    <float name="specular_transmittance" value="0.9"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
