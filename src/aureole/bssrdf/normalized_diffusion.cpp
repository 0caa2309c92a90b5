// SPDX-License-Identifier: Apache-2.0
// Two exponentials of the distance, fitted to Monte Carlo transport:
//     P(r) = A (exp(-r/d) + exp(-r/(3 d)))/(8 pi d r),
// whose integral is A for any d. A is the reflectance of the half-space, computed from the coefficients by
// radiative transfer (optics/medium/half_space.h). d = l/s, with the reduced mean free path l and the scale s
// (optics/medium/diffusion_width.h). The fraction (exp(-r/d) + 3 exp(-r/(3 d)))/4 of the light exits beyond
// r. With x = exp(-r/(3 d)) this is the cubic x^3 + 3 x = 4 (1 - u), whose only real root is x = 2
// sinh(asinh(2 (1 - u))/3).
#include <cmath>
#include <vector>

#include "aureole/bssrdf/bssrdf.h"
#include "aureole/bssrdf/matter/matter.h"
#include "aureole/optics/medium/diffusion_width.h"
#include "aureole/optics/medium/half_space.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class NormalizedDiffusion final : public Bssrdf {
public:
  explicit NormalizedDiffusion(const Properties& p) : Bssrdf(p) {
    const auto illumination = p.get_choice("illumination", "normal", {"normal", "diffuse"}) == "diffuse"
                                  ? optics::Illumination::diffuse
                                  : optics::Illumination::normal;
    tabulate_scale(illumination,
                   p.get_choice("width", "transport", {"transport", "published"}) == "published");
    if (is_shown_matter(p)) {
      ShownMatter shown = read_shown_matter(p);
      mean_free_path_ = std::move(shown.mean_free_path);
      if (shown.reflectance->is_constant())
        constant_reflectance_ = shown.reflectance->average();
      else
        reflectance_ = shown.reflectance;
      return;
    }
    const Matter matter = read_matter(p);
    std::vector<float> path, reflectance;
    double known_albedo = -1, known_index = 0, known = 0;
    for (std::size_t i = 0; i < matter.size(); ++i) {
      const double albedo = matter.reduced_scattering(i) / matter.transport(i),
                   n = double(relative_index().nodes()[i]);
      // Values are reused where neighbouring nodes are equal, as in many materials.
      if (albedo != known_albedo || n != known_index) {
        known_albedo = albedo, known_index = n;
        known = optics::half_space_reflectance(albedo, n, illumination);
      }
      path.push_back(float(1 / matter.transport(i))), reflectance.push_back(float(known));
    }
    mean_free_path_ = SampledSpectrum(p.context().grid, std::move(path));
    constant_reflectance_ = SampledSpectrum(p.context().grid, std::move(reflectance));
  }

  BssrdfEval eval_pdf(float r, const BssrdfContext& ctx) const override {
    const Spectrum a = reflectance(ctx), d = width(a, ctx);
    // The density has a pole at distance 0, which samples reach only by underflow.
    const float distance = std::max(r, 1e-30f);
    const Spectrum pdf = make_spectrum([&](int i) {
                           const float x = std::exp(-distance / (3 * d[i]));
                           return x * x * x + x;
                         }) /
                         (d * (8 * kPi * distance));
    return {a * pdf, pdf};
  }

  float sample_distance(float u, const BssrdfContext& ctx) const override {
    return quantile(u, width(reflectance(ctx), ctx)[0]);
  }

  float reach(const BssrdfContext& ctx) const override {
    constexpr float kNearlyAll = 0.999f;
    return quantile(kNearlyAll, max_component(width(reflectance(ctx), ctx)));
  }

private:
  static float quantile(float u, float d) {
    return -3 * d * std::log(std::min(2 * std::sinh(std::asinh(2 * (1 - u)) / 3), 1.f));
  }

  Spectrum reflectance(const BssrdfContext& ctx) const {
    return reflectance_ ? min(reflectance_->eval(ctx.point, ctx.wavelengths), 1.f)
                        : constant_reflectance_.eval(ctx.wavelengths);
  }
  Spectrum width(const Spectrum& a, const BssrdfContext& ctx) const {
    return mean_free_path_.eval(ctx.wavelengths) / scale_at(a);
  }
  Spectrum scale_at(const Spectrum& a) const {
    return make_spectrum([&](int i) {
      const float x = std::min(a[i], 1.f) * kCells;
      const int cell = std::min(int(x), kCells - 1);
      return std::lerp(scale_[std::size_t(cell)], scale_[std::size_t(cell) + 1], x - float(cell));
    });
  }

  /// Tabulates s at the mean index of refraction over the sensor's range, since s depends weakly on the
  /// index.
  void tabulate_scale(optics::Illumination illumination, bool published) {
    const optics::DiffusionWidth fitted(relative_index().average(), illumination);
    for (int i = 0; i <= kCells; ++i) {
      const double a = double(i) / kCells;
      scale_.push_back(
          float(published ? optics::published_diffusion_scale(a, illumination) : fitted.scale(a)));
    }
  }

  static constexpr int kCells = 128;
  std::vector<float> scale_;  ///< scale s at equal steps of the reflectance
  TexturePtr reflectance_;    ///< reflectance that varies over the surface, else null
  SampledSpectrum constant_reflectance_, mean_free_path_;
};

std::vector<ParameterDoc> diffusion_rows() {
  std::vector<ParameterDoc> all = matter_rows();
  all.push_back({"illumination", "string", "", "normal",
                 "illumination for which the total reflectance is exact, or is given: normal (along the "
                 "normal) or diffuse (a uniform sky)"});
  all.push_back({"width", "string", "", "transport",
                 "width of the profile: transport (fitted to transport at the body's index) or published "
                 "(the formula of the source, for equal indices inside and outside)"});
  return all;
}

AUREOLE_PLUGIN(
    NormalizedDiffusion, "bssrdf", "normalized_diffusion",
    PluginDoc{
        "Subsurface scattering, including single scattering, by two exponentials fitted to transport in a "
        "half-space. The total reflectance along the normal is exact for isotropic scattering; it may be a "
        "texture. docs/subsurface.md has errors of the profile.",
        "P. H. Christensen, B. Burley, Approximate reflectance profiles for efficient subsurface "
        "scattering, Pixar Technical Memo 15-04, 2015; S. Chandrasekhar, Radiative Transfer, 1950, section "
        "38",
        diffusion_rows(),
        {R"(<bssrdf type="normalized_diffusion">
    <rgb name="reflectance" value="0.8, 0.6, 0.5"/>
    <rgb name="mean_free_path" value="0.05, 0.02, 0.01"/>
    <float name="int_ior" value="1.4"/>
    <string name="ext_ior" value="air"/>
    <boolean name="dispersion" value="true"/>
    <string name="illumination" value="diffuse"/>
    <string name="width" value="published"/>
    <float name="scale" value="2"/>
</bssrdf>)",
         R"(<bssrdf type="normalized_diffusion">
    <rgb name="sigma_a" value="0.2, 1, 2"/>
    <float name="sigma_s" value="80"/>
    <float name="g" value="0.6"/>
</bssrdf>)",
         R"(<bssrdf type="normalized_diffusion">
    <float name="sigma_t" value="50"/>
    <rgb name="albedo" value="0.99, 0.98, 0.9"/>
</bssrdf>)",
         R"(<bssrdf type="normalized_diffusion">
    <bsdf type="roughdielectric"><float name="int_ior" value="1.5"/><float name="alpha" value="0.2"/></bsdf>
    <medium type="homogeneous"><float name="sigma_t" value="100"/><float name="albedo" value="0.995"/></medium>
</bssrdf>)"}});

}  // namespace
}  // namespace aureole
