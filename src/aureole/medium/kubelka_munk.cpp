// SPDX-License-Identifier: Apache-2.0
// A medium given by Kubelka and Munk's K and S, which are converted to absorption and scattering
// coefficients. It works in path tracing and as a layer of the BSDF `layered`.
#include <algorithm>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/medium/content/extinction_limit.h"
#include "aureole/medium/medium.h"
#include "aureole/parameter/palette_file.h"
#include "aureole/phase/mean_cosine.h"
#include "aureole/pigment/transport_coefficients.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class KubelkaMunk final : public Medium {
public:
  explicit KubelkaMunk(const Properties& p) : Medium(p) {
    phase_ = only_phase(p);
    if (!phase_->is_isotropic_medium())
      throw Error(phase_->properties().where(),
                  "K and S are those of a medium that scatters alike for all directions of the light");
    if (!phase_->is_uniform())
      throw Error(phase_->properties().where(), "K and S are those of a medium that is the same everywhere");
    const SampledPaint paint = read_paint(p);
    const pigment::Convention convention =
        pigment::convention_named(p.get_choice("convention", "three_quarters", pigment::convention_names()));
    // Null in a scene with errors, where the phase function may lack its own tables.
    const auto coefficients =
        p.shared_model<Coefficients>([&] { return convert(p, paint, convention, *phase_); });
    if (coefficients) coefficients_ = *coefficients;
  }

  void eval(const Vec3&, const Vec3&, const Wavelengths& w, MediumCoefficients& out) const override {
    out.sigma_s = coefficients_.scattering.eval(w);
    out.sigma_t = out.sigma_s + coefficients_.absorption.eval(w);
    out.emission = 0.f;
  }
  Spectrum majorant(const Vec3&, const Wavelengths& w) const override {
    return coefficients_.scattering.eval(w) + coefficients_.absorption.eval(w);
  }
  const PhaseFunction& phase() const override { return *phase_; }
  bool is_uniform() const override { return true; }
  bool has_uniform_emission() const override { return true; }
  bool emits() const override { return false; }
  bool scatters() const override { return coefficients_.scattering.maximum() > 0; }

private:
  struct Coefficients {
    SampledSpectrum absorption, scattering;

    static constexpr TableKind kTable{"coefficients of a paint", 1};
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.absorption, self.scattering);
    }
  };

  /// Returns K and S per unit of length of the scene.
  static SampledPaint read_paint(const Properties& p) {
    const SpectralGrid& grid = p.context().grid;
    const double scale = p.get_float("scale", 1, Range::positive());
    if (p.has("recipe")) return read_recipe(p, grid, scale);
    for (const char* name : {"palette", "by_volume"})
      if (p.has(name)) throw p.error(name, "belongs to a \"recipe\", which is missing");
    SampledPaint paint;
    for (const auto& [name, table] : {std::pair{"k", &paint.k}, {"s", &paint.s}}) {
      const TexturePtr given = get_optional_texture(p, name, SpectrumRole::unbounded);
      if (!given)
        throw p.error(name,
                      "give \"k\" and \"s\", per unit of length, or a \"recipe\" of paints of a palette");
      if (!given->is_constant()) throw p.error(name, "must not vary in space");
      const SampledSpectrum values = given->average();
      *table = SampledSpectrum::from_function(grid, [&](double nm) {
        return scale * double(values.eval(Wavelengths::at(grid, Spectrum(float(nm))))[0]);
      });
    }
    return paint;
  }

  static SampledPaint read_recipe(const Properties& p, const SpectralGrid& grid, double scale) {
    for (const char* name : {"k", "s"})
      if (p.has(name)) throw p.error(name, "a recipe has its own K and S");
    pigment::Palette palette;
    try {
      palette = read_palette_file(p.has("palette") ? p.get_file("palette").string() : kMeasuredPaints);
    } catch (const Error& e) {
      throw p.error("palette", e.what());
    }
    if (palette.relative && !p.has("scale"))
      throw p.error(
          "scale",
          "the parameter \"scale\" is required for this palette, whose K and S are relative: S of its white, per unit of length");
    note_palette_range(p, p.has("palette") ? "palette" : "recipe", palette);
    if (const int count = pigment::clamp_negative(palette))
      p.note("palette", std::to_string(count) + " negative values of K and S count as zero");
    try {
      const auto fractions =
          recipe_fractions(palette, p.get_string("recipe"), p.get_bool("by_volume", false), "recipe");
      return sampled_paint(grid, palette, fractions,
                           palette.relative ? scale : scale * p.context().length_unit_m);
    } catch (const Error& e) {
      throw p.error("recipe", e.message());
    }
  }

  static std::shared_ptr<const Coefficients> convert(const Properties& p, const SampledPaint& paint,
                                                     pigment::Convention convention,
                                                     const PhaseFunction& phase) {
    const SpectralGrid& grid = p.context().grid;
    const char* stated = p.has("recipe") ? "recipe" : "s";
    std::vector<double> nm, absorption, scattering;
    for (int first = 0; first <= grid.cells; first += kWavelengths) {
      const auto node = [&](int i) { return float(grid.node(std::min(first + i, grid.cells))); };
      const Wavelengths w = Wavelengths::at(grid, make_spectrum(node));
      const auto g = mean_cosine(phase, {}, {}, w);
      const Spectrum k = paint.k.eval(w), s = paint.s.eval(w);
      for (int i = 0; i < kWavelengths && first + i <= grid.cells; ++i) try {
          const auto c =
              pigment::transport_of_coefficients({double(k[i]), double(s[i])}, g[std::size_t(i)], convention);
          require_computable_extinction(p, stated, c.sigma_a + c.sigma_s);
          nm.push_back(grid.node(first + i));
          absorption.push_back(c.sigma_a), scattering.push_back(c.sigma_s);
        } catch (const std::domain_error& e) {
          throw p.error(stated, e.what());
        }
    }
    return std::make_shared<const Coefficients>(
        Coefficients{SampledSpectrum::from_points(grid, nm, absorption),
                     SampledSpectrum::from_points(grid, nm, scattering)});
  }

  Coefficients coefficients_;
  PhaseFunctionPtr phase_;
};

AUREOLE_PLUGIN(
    KubelkaMunk, "medium", "kubelka_munk",
    PluginDoc{
        "A medium given by Kubelka and Munk's K and S, or by a recipe of paints. Absorption is sigma_a = "
        "K/2; sigma_s follows from S by a convention, since a two-flux model leaves the angular "
        "distribution open (docs/pigments.md has the error of each). It works as a layer of `layered` or "
        "between surfaces.",
        "P. Kubelka & F. Munk, Ein Beitrag zur Optik der Farbanstriche, Z. techn. Physik 12, 1931; conventions: pigment/transport_coefficients.h",
        {{"k", "spectrum", "1/length", "required",
          "absorption coefficient of diffuse light, or give a `recipe`"},
         {"s", "spectrum", "1/length", "required",
          "coefficient of backward scattering of diffuse light, or give a `recipe`"},
         {"recipe", "string", "", "none", "paints and their proportions by mass, \"red: 1 + white: 3\""},
         {"palette", "file", "", "none",
          "file of K and S of paints; default: the measured acrylics, as in the BSDF `paint`"},
         {"by_volume", "boolean", "", "false", "proportions are by volume; the palette needs densities"},
         {"scale", "float", "", "1",
          "factor of K and S; required if K and S of the palette are relative (as for the measured "
          "acrylics): S of its white, per unit of length"},
         {"convention", "string", "", "three_quarters",
          "S = 3/4 sigma_s (1 - g): `three_quarters`; S = 3/4 sigma_s (1 - g) - sigma_a/4: `diffusion`; S = sigma_s (1 - 3/4 g): "
          "`double_gauss`"},
         {"phase", "phase", "", "isotropic", "phase function; g is its mean cosine"}},
        {R"(<medium type="kubelka_munk">
    <spectrum name="k" value="400:9e4, 500:4e4, 600:5e3, 700:1e3"/> <float name="s" value="5e4"/>
    <string name="convention" value="double_gauss"/>
    <phase type="hg"> <float name="g" value="0.5"/> </phase>
</medium>)",
         R"(<medium type="kubelka_munk">
    <string name="recipe" value="red: 1 + white: 3"/> <boolean name="by_volume" value="false"/>
    <float name="scale" value="1e5"/>
</medium>)",
         R"(<medium type="kubelka_munk">
    <string name="palette" value="two_paints.csv"/> <string name="recipe" value="blue: 1 + white: 5"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
