// SPDX-License-Identifier: Apache-2.0
// The diffusion dipole: P(r) = alpha/(4 pi) sum over the source and its image of z (s + 1/d) exp(-s d)/d^2,
// with d^2 = r^2 + z^2 and s = sqrt(3 sigma_a sigma_tr) (optics/medium/diffusion_dipole.h). Since z (s + 1/d)
// exp(-s d)/d is minus the derivative of z exp(-s d)/d, each term's fraction of light beyond a distance is
// (z/d) exp(-s (d - z)), which is inverted to sample distances. Singly scattered light is a sum of
// exponentials over 2 pi r (optics/medium/single_scattering.h), one of which is chosen.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "aureole/bssrdf/bssrdf.h"
#include "aureole/bssrdf/matter/matter.h"
#include "aureole/math/warp.h"
#include "aureole/optics/medium/diffusion_dipole.h"
#include "aureole/optics/medium/single_scattering.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class DipoleBssrdf final : public Bssrdf {
public:
  explicit DipoleBssrdf(const Properties& p) : Bssrdf(p) {
    const SpectralGrid& grid = p.context().grid;
    const Matter matter = is_shown_matter(p) ? inverted(p) : read_matter(p);
    std::vector<float> source, image, effective, half_albedo, extinction, albedo;
    double asymmetry = 0;
    for (std::size_t i = 0; i < matter.size(); ++i) {
      const optics::Dipole d(
          optics::diffusion_coefficients(matter.absorption[i], matter.scattering[i], matter.asymmetry[i]),
          double(relative_index().nodes()[i]));
      source.push_back(float(d.source_depth())), image.push_back(float(d.image_height()));
      effective.push_back(float(d.effective())), half_albedo.push_back(float(d.albedo() / 2));
      extinction.push_back(float(matter.extinction(i)));
      albedo.push_back(float(matter.scattering[i] / matter.extinction(i)));
      asymmetry += matter.asymmetry[i] / double(matter.size());
    }
    source_ = SampledSpectrum(grid, std::move(source)), image_ = SampledSpectrum(grid, std::move(image));
    effective_ = SampledSpectrum(grid, std::move(effective));
    half_albedo_ = SampledSpectrum(grid, std::move(half_albedo));
    if (!p.get_bool("single_scattering", false)) return;
    extinction_ = SampledSpectrum(grid, std::move(extinction)),
    albedo_ = SampledSpectrum(grid, std::move(albedo));
    constexpr double kMaxAsymmetry = 0.999;  // upper bound of |g|, above which nothing is scattered back
    single_.emplace(std::clamp(asymmetry, -kMaxAsymmetry, kMaxAsymmetry), relative_index().average());
    single_total_ = float(single_->total());
  }

  BssrdfEval eval_pdf(float r, const BssrdfContext& ctx) const override {
    const Terms t(*this, ctx.wavelengths);
    Spectrum value = (term(r, t.source, t.effective) + term(r, t.image, t.effective)) * t.half_albedo;
    if (single_) value += scattered_once(r, t);
    value *= 0.5f / kPi;
    return {value, safe_divide(value, t.total())};
  }

  float sample_distance(float u, const BssrdfContext& ctx) const override {
    const Terms t(*this, ctx.wavelengths);
    const float s = t.effective[0], once = t.single[0] / t.total()[0];
    if (u < once) return single_distance(remap_below(u, once), t.extinction[0]);
    if (once > 0) u = remap_above(u, once);
    const float p = t.left_source[0] / (t.left_source[0] + t.left_image[0]);
    return u < p ? invert(remap_below(u, p), t.source[0], s) : invert(remap_above(u, p), t.image[0], s);
  }

  float reach(const BssrdfContext& ctx) const override {
    const Terms t(*this, ctx.wavelengths);
    // Fraction of the light within the reach, which is set by the image's term, since that has the largest
    // extent.
    constexpr float kNearlyAll = 0.999f;
    float r = 0;
    for (int i = 0; i < kWavelengths; ++i) r = std::max(r, invert(kNearlyAll, t.image[i], t.effective[i]));
    return r;
  }

private:
  struct Terms {
    Spectrum source, image, effective, half_albedo;
    Spectrum left_source, left_image;     ///< integrals exp(-s z) of the two terms
    Spectrum extinction, albedo, single;  ///< coefficients of single scattering; `single` is its integral

    Terms(const DipoleBssrdf& d, const Wavelengths& w)
        : source(d.source_.eval(w)),
          image(d.image_.eval(w)),
          effective(d.effective_.eval(w)),
          half_albedo(d.half_albedo_.eval(w)) {
      // Exponents are at most 1.7 for the source, and 14 for the image at a relative index of 2.
      left_source = make_spectrum([&](int i) { return std::exp(-effective[i] * source[i]); });
      left_image = make_spectrum([&](int i) { return std::exp(-effective[i] * image[i]); });
      if (!d.single_) return;
      extinction = d.extinction_.eval(w), albedo = d.albedo_.eval(w);
      single = albedo * d.single_total_;
    }
    /// Returns the fraction of the light that exits. Without scattering it is a small positive number, so
    /// that distances can still be sampled.
    Spectrum total() const { return max(half_albedo, 1e-6f) * (left_source + left_image) + single; }
  };

  /// Returns 2 pi times the profile of singly scattered light.
  Spectrum scattered_once(float r, const Terms& t) const {
    Spectrum sum = 0.f;
    for (std::size_t k = 0; k < single_->rates.size(); ++k) {
      const float rate = float(single_->rates[k]) * r;
      sum += make_spectrum([&](int i) { return std::exp(-rate * t.extinction[i]); }) *
             float(single_->weights[k]);
    }
    return sum * t.albedo * t.extinction * (1 / std::max(r, 1e-30f));
  }

  float single_distance(float u, float extinction) const {
    const auto& s = *single_;
    std::size_t k = 0;
    float p = float(s.weights[0] / s.rates[0]) / single_total_;
    while (k + 1 < s.rates.size() && !(u < p)) {
      u -= p;
      ++k;
      p = float(s.weights[k] / s.rates[k]) / single_total_;
    }
    return -std::log1p(-remap_below(u, p)) / (float(s.rates[k]) * extinction);
  }

  static Spectrum term(float r, const Spectrum& z, const Spectrum& s) {
    const Spectrum d = sqrt(z * z + r * r);
    const Spectrum decay = make_spectrum([&](int i) { return std::exp(-s[i] * d[i]); });
    return z * (s * d + 1.f) * decay / (d * d * d);
  }

  /// Returns the distance beyond which the fraction 1 - u of a term's light exits. With y = ln(d/z) it is the
  /// root of y + s z (exp(y) - 1) = -ln(1 - u). The left side is convex and increasing, so that Newton's
  /// method converges from above.
  static float invert(float u, float z, float s) {
    const float target = -std::log1p(-u), depth = s * z;
    float y = std::min(target, depth > 0 ? std::log1p(target / depth) : target);
    for (int i = 0; i < 20; ++i) {
      const float grown = depth * std::exp(y);
      const float step = (y + grown - depth - target) / (1 + grown);
      y -= step;
      if (!(std::abs(step) > 1e-6f * y)) break;
    }
    // Distance r = sqrt(d^2 - z^2) with d = z exp(y).
    return z * std::sqrt(std::max(std::expm1(2 * y), 0.f));
  }

  /// Returns the medium whose dipole has a given reflectance.
  Matter inverted(const Properties& p) const {
    const ShownMatter shown = read_shown_matter(p);
    if (!shown.reflectance->is_constant())
      throw p.error("reflectance",
                    "varies over the surface, which \"dipole\" cannot follow; \"normalized_diffusion\" can");
    const SampledSpectrum colour = shown.reflectance->average();
    Matter m;
    for (std::size_t i = 0; i < colour.nodes().size(); ++i) {
      const double albedo = optics::dipole_albedo(std::min(double(colour.nodes()[i]), 1.0),
                                                  double(relative_index().nodes()[i]));
      const double transport = 1 / double(shown.mean_free_path.nodes()[i]);
      m.absorption.push_back((1 - albedo) * transport), m.scattering.push_back(albedo * transport);
      m.asymmetry.push_back(0);
    }
    return m;
  }

  SampledSpectrum source_, image_, effective_, half_albedo_;
  std::optional<optics::SingleScattering> single_;
  SampledSpectrum extinction_, albedo_;
  float single_total_ = 0;
};

std::vector<ParameterDoc> dipole_rows() {
  std::vector<ParameterDoc> all = matter_rows();
  all.push_back(
      {"single_scattering", "boolean", "", "false",
       "add singly scattered light (Henyey & Greenstein's phase function), as for a beam along the normal"});
  return all;
}

AUREOLE_PLUGIN(
    DipoleBssrdf, "bssrdf", "dipole",
    PluginDoc{
        "Subsurface scattering of a flat half-space in the diffusion approximation (multiple scattering). "
        "Accurate for low absorption and beyond a few reduced mean free paths from the entry; too dark near "
        "it and for absorbing bodies (docs/subsurface.md has figures; \"normalized_diffusion\" is closer). "
        "The boundary's transmittance for exiting light is divided by its mean, which the original model "
        "omits.",
        "H. W. Jensen, S. R. Marschner, M. Levoy, P. Hanrahan, A practical model for subsurface light "
        "transport, SIGGRAPH 2001, equations 4 and 5, with the exact diffuse Fresnel reflectance; exits: "
        "A. King, C. Kulla, A. Conty, M. Fajardo, BSSRDF importance sampling, SIGGRAPH talks 2013",
        dipole_rows(),
        {R"(<bssrdf type="dipole">
    <rgb name="sigma_a" value="0.2, 1, 2"/>
    <float name="sigma_s" value="80"/>
    <float name="g" value="0.6"/>
    <float name="scale" value="2"/>
    <float name="int_ior" value="1.4"/>
    <string name="ext_ior" value="air"/>
    <boolean name="dispersion" value="true"/>
    <boolean name="single_scattering" value="true"/>
</bssrdf>)",
         R"(<bssrdf type="dipole">
    <float name="sigma_t" value="50"/>
    <rgb name="albedo" value="0.99, 0.98, 0.9"/>
</bssrdf>)",
         R"(<bssrdf type="dipole">
    <bsdf type="roughdielectric"><float name="int_ior" value="1.5"/><float name="alpha" value="0.2"/></bsdf>
    <medium type="homogeneous">
        <float name="sigma_t" value="100"/>
        <float name="albedo" value="0.995"/>
        <phase type="hg"><float name="g" value="0.8"/></phase>
    </medium>
</bssrdf>)",
         R"(<bssrdf type="dipole">
    <rgb name="reflectance" value="0.8, 0.6, 0.5"/>
    <float name="mean_free_path" value="0.02"/>
</bssrdf>)"}});

}  // namespace
}  // namespace aureole
