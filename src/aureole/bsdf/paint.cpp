// SPDX-License-Identifier: Apache-2.0
// A layer of paint under its own interface: Kubelka and Munk's reflectance of a mixture of pigments over a
// substrate, with Saunderson's correction for the interface between binder and air, smooth or rough:
//     f = f_interface + T(i) T(o) / (pi eta^2) * R / (1 - k2 R).
// R = R(K, S, thickness, substrate) is the reflectance within the binder, T the interface's directional
// transmittance, and k2 its reflectance for diffuse light from inside. The interface is lossless. For a palette that was
// fitted by streams, R is the reflectance with which the coat has the colour that streams predict for the instrument of the
// palette's measurements.
#include <algorithm>
#include <cmath>
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/rough_coating.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/core/parallel.h"
#include "aureole/math/warp.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/parameter/palette_file.h"
#include "aureole/pigment/streams_mixture.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Paint final : public Bsdf {
public:
  explicit Paint(const Properties& properties)
      : Bsdf(properties),
        thickness_factor_(ScalarTexture::from(properties, "thickness_factor", 1, Range::non_negative())),
        blend_(ScalarTexture::from(properties, "blend", 0, Range::unit())) {
    read_interface(properties);
    read_layer(properties);
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return at(State(*this, wi.z, ctx), wi, wo);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const State state(*this, wi.z, ctx);
    const bool specular = u1 < state.specular_probability;
    if (specular && !coating_)
      return BsdfSample{reflect(wi), 1 - state.t_i, state.specular_probability, Lobe::delta | Lobe::reflect};
    Vec3 wo;
    if (specular) {
      const Microfacets& facets = roughness_->constant();
      const Vec3 m = roughness_->visible() ? facets.sample_visible(wi, u2) : facets.sample_all(u2);
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
    return bounced_within(ctx) * (leaving_ * (1 - seen_diffusely_));
  }

  bool needs_tangent() const override { return substrate_bsdf_ && substrate_bsdf_->needs_tangent(); }
  Lobe lobes() const override {
    const Lobe base = Lobe::diffuse | Lobe::reflect;
    return coating_ ? base | Lobe::glossy : eta_ != 1 ? base | Lobe::delta : base;
  }

private:
  /// Quantities that depend only on wi.z, the point and the wavelengths.
  struct State {
    float t_i, specular_probability;
    Spectrum base;

    State(const Paint& p, float cos_i, const BsdfContext& ctx) : t_i(p.transmittance(cos_i)) {
      const Spectrum entered = p.bounced_within(ctx) * t_i;
      base = entered * (1 / (p.eta_ * p.eta_));
      // Lobes are chosen by their energy, averaged over the path's wavelengths, so that the probabilities do
      // not depend on the hero.
      const float s = 1 - t_i, d = mean(entered) * p.leaving_;
      specular_probability = s + d > 0 ? s / (s + d) : 1;
    }
  };

  /// Returns the transmittance of the interface from outside.
  float transmittance(float cosine) const {
    if (coating_) return coating_->at(cosine);
    return eta_ == 1 ? 1 : 1 - fresnel_dielectric(cosine, eta_).reflectance;
  }

  BsdfEval at(const State& s, const Vec3& wi, const Vec3& wo) const {
    const float cosine = cosine_hemisphere_pdf(wo.z);
    BsdfEval e{s.base * (transmittance(wo.z) * cosine), (1 - s.specular_probability) * cosine};
    if (!coating_) return e;
    const Vec3 sum = wi + wo;
    const float size = length(sum), cos_im = std::min(0.5f * size, 1.f);
    if (!(size > 0)) return {};
    const Microfacets& facets = roughness_->constant();
    const Vec3 m = sum / size;
    const float density = facets.density(m), seen = 0.25f * density * facets.masking_over_cos(wi);
    e.value += fresnel_dielectric(cos_im, eta_).reflectance * seen * facets.masking(wo);
    e.pdf += s.specular_probability * (roughness_->visible() ? seen : 0.25f * density * m.z / cos_im);
    return e;
  }

  /// A reflectance as a fraction, which saves divisions of intermediate results.
  struct Ratio {
    Spectrum numerator, denominator;
  };

  /// Returns R/(1 - k2 R), with the reflectance R of the layer over its substrate: the diffuse light that
  /// reaches the interface from inside, as a fraction of the light transmitted into the layer.
  Spectrum bounced_within(const BsdfContext& ctx) const {
    const Ratio r = inner_reflectance(ctx);
    const Spectrum numerator = min(r.numerator, r.denominator);
    return safe_divide(numerator, r.denominator - numerator * (1 - leaving_));
  }

  /// Returns Kubelka and Munk's reflectance of the layer over its substrate.
  Ratio inner_reflectance(const BsdfContext& ctx) const {
    const Wavelengths& w = ctx.wavelengths;
    Spectrum below(0.f);
    if (!opaque_)
      below = substrate_bsdf_ ? min(substrate_bsdf_->diffuse_reflectance({0, 0, 1}, ctx), 1.f)
                              : substrate_->eval(ctx.point, w);
    if (!uniform_) {
      const Coefficients c = coefficients(ctx);
      return opaque_ ? opaque(c) : film(c, thickness_factor_.eval(ctx), below);
    }
    const Spectrum r = uniform_->r.eval(w);
    if (opaque_) return {r, 1.f};
    const Spectrum back = uniform_->back ? uniform_->back->eval(w) : r,
                   denominator = max(Spectrum(1.f) - back * below, 1e-7f);
    return {r * denominator + uniform_->t2.eval(w) * below, denominator};
  }

  struct Coefficients {
    Spectrum k, s, gamma, inverse_gamma;
  };
  Coefficients coefficients(const BsdfContext& ctx) const {
    const Wavelengths& w = ctx.wavelengths;
    Spectrum k = first_->k.eval(w), s = first_->s.eval(w);
    if (second_) {
      const float t = blend_.eval(ctx);
      k = lerp(k, second_->k.eval(w), t), s = lerp(s, second_->s.eval(w), t);
    }
    const Spectrum gamma = sqrt(min(k * (k + s * 2.f), 1e37f));
    // The inverse is computed while the exponential of gamma is pending, so that no operation waits for the
    // quotient.
    return {k, s, gamma, Spectrum(1.f) / max(gamma, 1e-18f)};
  }

  // These formulas are also in pigment/kubelka_munk_layer.cpp, in double precision.

  static Ratio opaque(const Coefficients& c) { return {c.s, c.k + c.s + c.gamma}; }

  /// Reflectance and transmittance of the layer alone: with d = exp(-2 gamma x), q = (1 - d)/gamma and D = K
  /// q + S q + 1 + d the reflectance is S q/D, the transmittance squared 4 d/D^2.
  struct Film {
    Spectrum kq, sq, decay;
    Film(const Coefficients& c, float x) {
      const Spectrum path = c.gamma * (2 * x);
      decay = exp_of_negative(path * -1.f);
      // The series avoids visible rounding errors.
      const Spectrum series =
          (Spectrum(1.f) - path * (Spectrum(0.5f) - path * (1 / 6.f - path * (1 / 24.f)))) * (2 * x);
      const Spectrum q =
          select(path.v > Spectrum(0.02f).v, (Spectrum(1.f) - decay) * c.inverse_gamma, series);
      kq = c.k * q, sq = min(c.s * q, 1e15f);  // upper bound, where the layer is white; its square is a float
    }
    Spectrum sum() const { return kq + sq + (decay + 1.f); }
  };
  /// Returns the reflectance over a substrate of reflectance `below`; all terms are positive, without
  /// cancellation.
  static Ratio film(const Coefficients& c, float x, const Spectrum& below) {
    const Film f(c, x);
    const Spectrum rest = f.kq + f.sq * (Spectrum(1.f) - below) + (f.decay + 1.f);
    return {f.sq * rest + f.decay * below * 4.f, f.sum() * rest};
  }

  /// Tabulates the layer if neither amounts nor thickness vary; the substrate may vary.
  void tabulate_uniform(const SpectralGrid& grid) {
    if (varies()) return;
    const auto table = [&](const auto& value) {
      return SampledSpectrum::from_function(grid, [&](double nm) {
        const Wavelengths w = Wavelengths::at(grid, Spectrum(float(nm)));
        const SurfacePoint point;
        const BsdfContext ctx{w, point};
        return double(value(coefficients(ctx), thickness_factor_.eval(ctx))[0]);
      });
    };
    uniform_ = {table([&](const Coefficients& c, float x) {
                  if (opaque_) return safe_divide(opaque(c).numerator, opaque(c).denominator);
                  const Film f(c, x);
                  return f.sq / f.sum();
                }),
                opaque_ ? SampledSpectrum() : table([&](const Coefficients& c, float x) {
                  const Film f(c, x);
                  return f.decay * 4.f / (f.sum() * f.sum());
                }),
                {}};
  }

  /// Whether amounts or thickness vary over the surface.
  bool varies() const {
    return thickness_factor_.minimum() < thickness_factor_.maximum() || blend_.minimum() < blend_.maximum();
  }

  /// The tables of a theory by streams, which do not depend on a palette.
  struct FilmTables {
    pigment::StreamsTables streams;

    static constexpr TableKind kTable{"film by streams", 1};
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.streams);
    }
  };

  /// Tabulates a uniform layer as streams predict it, within the smooth interface of the palette's measurements.
  void tabulate_by_streams(const Properties& properties, const pigment::Palette& palette,
                           const std::vector<double>& fractions, double thickness) {
    pigment::Palette measured = palette;
    pigment::PaletteStreams& by = *measured.streams;
    by.specular = pigment::Specular::excluded;
    const bool has_g = std::any_of(palette.pigments.begin(), palette.pigments.end(),
                                   [](const pigment::Pigment& p) { return p.g.has_value(); });
    const pigment::StreamsSettings settings = pigment::streams_settings(measured);
    const auto tables =
        properties.shared_model<FilmTables>({by.index, by.g, double(by.geometry), double(has_g)}, [&] {
          return std::make_shared<const FilmTables>(
              FilmTables{pigment::streams_tables(settings, for_ranges)});
        });
    if (!tables) return;
    const auto theory = pigment::streams_theory(settings, tables->streams);
    const pigment::Surface surface =
        by.index > 1 ? pigment::smooth_surface(by.index, by.geometry, by.specular) : pigment::Surface();
    const pigment::Paint paint = pigment::mix(palette, fractions);
    const std::vector<double> shifts = pigment::g_shifts(palette, fractions);
    std::vector<pigment::InnerFilm> films;
    for (std::size_t i = 0; i < paint.size(); ++i)
      films.push_back(
          pigment::inner_film(pigment::light_of(*theory, paint[i], shifts[i], thickness), surface));
    const auto table = [&](double pigment::InnerFilm::*of) {
      return sampled_values(properties.context().grid, palette.nm,
                            [&, of](std::size_t i) { return films[i].*of; });
    };
    uniform_ = {table(&pigment::InnerFilm::reflectance), table(&pigment::InnerFilm::transmittance2),
                table(&pigment::InnerFilm::back)};
  }

  void read_interface(const Properties& properties) {
    const Ior interior = Ior::from(properties, "int_ior", "polypropylene"),
              exterior = Ior::from(properties, "ext_ior", "air");
    eta_ = interior.at_sodium_d() / exterior.at_sodium_d();
    if (!(eta_ >= 1)) throw properties.error("int_ior", "the binder's index must not be below that outside");
    if (properties.has("alpha")) {
      if (eta_ == 1)
        throw properties.error("alpha",
                               "the index is the same on both sides: there is no interface to be rough");
      roughness_.emplace(properties, false);
      std::vector<double> key = roughness_->table_key();
      key.push_back(double(eta_));
      coating_ = properties.shared_model<RoughCoating>(key, [&] {
        return std::make_shared<const RoughCoating>(roughness_->constant(), double(eta_), true);
      });
      if (coating_) leaving_ = coating_->leaving;
    } else {
      for (const char* name : {"distribution", "sample_visible"})
        if (properties.has(name))
          throw properties.error(name, "a smooth surface has no facets; give \"alpha\"");
      leaving_ = float(1 - optics::fresnel_diffuse_reflectance(1 / double(eta_)));
    }
    seen_diffusely_ = 1 - leaving_ * eta_ * eta_;
  }

  void read_layer(const Properties& properties) {
    const std::string file =
        properties.has("palette") ? properties.get_file("palette").string() : kMeasuredPaints;
    pigment::Palette palette;
    try {
      palette = read_palette_file(file);
    } catch (const Error& e) {
      throw properties.error("palette", e.what());
    }
    note_palette_range(properties, properties.has("palette") ? "palette" : "recipe", palette);
    if (const std::string note = pigment::theory_note(palette); !note.empty() && varies())
      properties.note("palette",
                      note + "; paints whose amounts and thickness are constant are predicted by streams");
    if (const int count = pigment::clamp_negative(palette))
      properties.note("palette", std::to_string(count) + " negative values of K and S count as zero");
    opaque_ = !properties.has("thickness");
    double thickness = 1;
    if (!opaque_ && palette.relative)
      thickness = properties.get_float("thickness", Range::positive());
    else if (!opaque_)
      thickness = properties.get_length_m("thickness", 0);
    std::vector<double> recipe;
    const auto read = [&](const char* name) {
      try {
        const auto fractions = recipe_fractions(palette, properties.get_string(name),
                                                properties.get_bool("by_volume", false), name);
        const double share = recipe.empty() ? 1 : double(blend_.minimum());  // of the second recipe
        recipe.resize(fractions.size());
        for (std::size_t p = 0; p < recipe.size(); ++p) recipe[p] += share * (fractions[p] - recipe[p]);
        return sampled_paint(properties.context().grid, palette, fractions, thickness);
      } catch (const Error& e) {
        throw properties.error(name, e.message());
      }
    };
    first_ = read("recipe");
    if (properties.has("second_recipe"))
      second_ = read("second_recipe");
    else if (properties.has("blend"))
      throw properties.error("blend", "blends two recipes; give \"second_recipe\"");

    const auto nested = properties.get_children<Bsdf>("bsdf");
    if (nested.size() > 1)
      throw Error(properties.where(),
                  "\"paint\" lies on one nested BSDF, got " + std::to_string(nested.size()));
    substrate_ = get_texture(properties, "substrate", 0, SpectrumRole::reflectance);
    if (!nested.empty()) substrate_bsdf_ = nested[0];
    if (substrate_bsdf_ && properties.has("substrate"))
      throw properties.error("substrate", "give a nested BSDF or \"substrate\", not both");
    for (const char* name : {"thickness_factor", "substrate", "bsdf"})
      if (opaque_ && (properties.has(name) || (substrate_bsdf_ && name == std::string_view("bsdf"))))
        properties.note(name, "has no effect: without a thickness the paint is opaque");
    if (palette.streams && !varies())
      tabulate_by_streams(properties, palette, recipe,
                          opaque_ ? INFINITY : thickness * double(thickness_factor_.minimum()));
    else
      tabulate_uniform(properties.context().grid);
  }

  ScalarTexture thickness_factor_, blend_;
  std::optional<SampledPaint> first_, second_;
  struct UniformLayer {
    SampledSpectrum r, t2;
    std::optional<SampledSpectrum> back;  ///< reflectance from below, where it is not `r`
  };
  std::optional<UniformLayer> uniform_;
  bool opaque_ = true;
  TexturePtr substrate_;
  std::shared_ptr<const Bsdf> substrate_bsdf_;
  std::optional<Roughness> roughness_;  // roughness of the interface; empty: smooth
  /// coating of a rough interface; null: the interface is smooth
  std::shared_ptr<const RoughCoating> coating_;
  float eta_ = 1;             // index of the binder over the index outside
  float leaving_ = 1;         // fraction 1 - k2 of diffuse light from inside that leaves
  float seen_diffusely_ = 0;  // k1, the interface's reflectance for diffuse light from outside
};

AUREOLE_PLUGIN(
    Paint, "bsdf", "paint",
    PluginDoc{
        "A layer of paint, mixed from the pigments of a palette: opaque, or with a thickness over a "
        "substrate that shows through, under its own smooth or rough interface. K and S come from a file "
        "written by `aureole pigment fit`, or are those of 13 measured acrylics (by miciwan, CC BY 4.0). It "
        "reflects on the side of its normal and is black on the other; `twosided` makes both sides alike.",
        "P. Kubelka, New contributions to the optics of intensely light-scattering materials, J. Opt. Soc. Am. 38, 1948; J. L. "
        "Saunderson, Calculation of the color of pigmented plastics, J. Opt. Soc. Am. 32, 1942",
        {{"recipe", "string", "", "required",
          "paints and their proportions by mass, \"red: 1 + white: 3\", or per cent, \"red: 25% + white: "
          "75%\""},
         {"palette", "file", "", "none",
          "file of K and S of paints (docs/pigments.md); default: the measured acrylics white, cold yellow, "
          "warm yellow, yellow oxide, orange, red, red oxide, magenta, violet, blue red shade, blue green "
          "shade, green, black"},
         {"by_volume", "boolean", "", "false", "proportions are by volume; the palette needs densities"},
         {"second_recipe", "string", "", "none", "a second recipe, mixed with the first by `blend`"},
         {"blend", "texture", "", "0",
          "mass fraction of the second recipe, in [0, 1]; one number for all wavelengths"},
         {"thickness", "float or string", "", "none",
          "thickness of the layer, \"20um\"; for relative palettes (such as the measured acrylics) a number "
          "in units of 1/S of the white. Without it the paint is opaque"},
         {"thickness_factor", "texture", "", "1", "factor of the thickness; one number for all wavelengths"},
         {"bsdf", "bsdf", "", "none",
          "BSDF below the paint, of which the diffuse reflectance along the normal is used"},
         {"substrate", "texture", "", "0", "diffuse reflectance below the paint, instead of a BSDF"},
         {"int_ior", "float or string", "", "polypropylene",
          "index of refraction of the binder at 589 nm, as a number or a material's name; if equal to "
          "ext_ior there is no interface"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction outside, as a number or a material's name"},
         {"dispersion", "boolean", "", "true",
          "without effect on a paint, whose interface has the index at 589 nm"},
         {"alpha", "float", "", "none", "roughness of the interface; without it the interface is smooth"},
         {"distribution", "string", "", "beckmann",
          "distribution of the microfacet normals: beckmann or ggx"},
         {"sample_visible", "boolean", "", "true", "sample visible normals (less noise), not all normals"}},
        {R"(<bsdf type="paint">
    <string name="recipe" value="blue green shade: 1 + cold yellow: 2 + white: 10"/>
    <float name="alpha" value="0.2"/> <string name="distribution" value="ggx"/>
</bsdf>)",
         R"(<bsdf type="paint">
    <string name="palette" value="two_paints.csv"/>
    <string name="recipe" value="white: 1"/>
    <string name="second_recipe" value="blue: 1 + white: 20"/>
    <boolean name="by_volume" value="true"/>
    <texture name="blend" type="checkerboard"> <float name="color0" value="0"/> <float name="color1" value="0.5"/> </texture>
    <string name="thickness" value="15um"/>
    <float name="thickness_factor" value="0.8"/>
    <float name="substrate" value="0.1"/>
    <string name="int_ior" value="bk7"/> <float name="ext_ior" value="1.1"/>
    <boolean name="dispersion" value="false"/>
    <float name="alpha" value="0.1"/> <boolean name="sample_visible" value="false"/>
</bsdf>)",
         R"(<bsdf type="paint">
    <string name="recipe" value="magenta"/>
    <float name="thickness" value="0.7"/>
    <bsdf type="diffuse"> <float name="reflectance" value="0.9"/> </bsdf>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
