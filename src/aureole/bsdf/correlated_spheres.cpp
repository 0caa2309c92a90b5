// SPDX-License-Identifier: Apache-2.0
// A layer of many small spheres, such as droplets, that do not overlap, above a plane in one medium. Model:
// Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers", 2025, section 6.2: each
// sphere scatters by Mie's theory, and the structure factor of their positions correlates them. The coherent
// part follows Garcia-Valenzuela, Gutierrez-Reyes & Barrera 2012 (optics/layer/coherent_layer.h).
//
// Lobes. The fractions |t|^2 and |r|^2 of unpolarised light are delta lobes. The remainder times the albedo
// of a sphere is scattered into all directions in proportion to (|S1|^2 + |S2|^2)/2 S'(q), where q is the
// change of the transverse wave vector. A factor for either direction makes the albedo correct at each angle
// (sphere_tables.h). The layer is equal from both sides, and reciprocal.
#include <cmath>
#include <complex>
#include <optional>
#include <stdexcept>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/spheres/sphere_tables.h"
#include "aureole/correlation/correlation.h"
#include "aureole/parameter/complex_index.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class CorrelatedSpheres final : public Bsdf, public TableHolder {
public:
  explicit CorrelatedSpheres(const Properties& p) : Bsdf(p) {
    const SpectralGrid grid = p.context().grid;
    SphereLayer layer;
    if (!p.has("radius"))
      throw p.error("radius", "the parameter \"radius\" is required, a length such as \"5um\"");
    layer.radius_nm = p.get_length_m("radius", 0) * 1e9;
    layer.area_fraction = p.get_float("area_fraction", Range{0, optics::kMaxAreaFraction, true});
    layer.spread = p.get_float("size_spread", 0, Range{0, optics::SizeDistribution::kMaxSpread});
    layer.sizes = optics::SizeDistribution::log_normal(layer.spread);

    const Ior medium = Ior::from(p, "ext_ior", "air");
    layer.medium = [=](double nm) { return double(medium.eval(Wavelengths::at(grid, float(nm)))[0]); };
    const auto k = get_optional_spectrum(p, "k", SpectrumRole::unbounded);
    layer.relative_index = [around = layer.medium, inside = read_complex_index(p, "int_ior", "water", k)](
                               double nm) { return inside(nm) / around(nm); };
    for (int i = 0; i <= grid.cells; ++i)
      if (const auto m = layer.relative_index(grid.node(i)); !(std::abs(m) <= kLargestIndex && m.real() > 0))
        throw p.error("int_ior", "the index of the spheres over that of the medium is " +
                                     std::to_string(m.real()) + " + " + std::to_string(m.imag()) +
                                     "i; its modulus must not exceed 20");
    check_size(p, layer, grid);

    try {
      layer.structure = get_correlation(p)->structure_factor(layer.area_fraction);
    } catch (const std::domain_error& e) {
      throw p.error("area_fraction", e.what());
    }
    if (!layer.structure->is_isotropic())
      p.note("correlation",
             "domains of all orientations are taken: spheres scatter by the mean over the ring");
    tables_ = p.shared_model<SphereTables>([&] { return std::make_shared<const SphereTables>(layer, grid); });
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0 && std::abs(wo.z) > 0)) return {};
    const SphereTables::Eval e = tables_->eval(wi, wo, ctx.wavelengths.nm);
    return {e.value, e.pdf * Masses(tables_->shares(std::abs(wi.z), ctx.wavelengths.nm)).rest};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0)) return {};
    const SphereTables::Shares s = tables_->shares(std::abs(wi.z), ctx.wavelengths.nm);
    const Masses m(s);
    const float reflected = s.reflected[0] * m.rest[0], lost = s.lost[0] * m.rest[0];
    // The delta lobes take both ends of the range of u1, so that samples find them even if they are very
    // improbable.
    if (u1 < reflected || !(lost > 0 || m.transmitted > 0))
      return BsdfSample{reflect(wi), s.reflected, s.reflected * m.rest, Lobe::delta | Lobe::reflect};
    if (u1 >= reflected + lost || !(lost > 0))
      return BsdfSample{-wi, s.transmitted, m.transmitted, kNullLobe};
    const Vec3 wo = tables_->sample(wi, u2, ctx.wavelengths.nm[0]);
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf,
                      Lobe::glossy | ((wi.z > 0) == (wo.z > 0) ? Lobe::reflect : Lobe::transmit)};
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    return std::abs(wi.z) > 0 ? tables_->shares(std::abs(wi.z), ctx.wavelengths.nm).transmitted : 0.f;
  }

  Lobe lobes() const override {
    return kNullLobe | Lobe::glossy | Lobe::reflect | Lobe::transmit | Lobe::through;
  }
  bool needs_tangent() const override { return false; }
  Tables tables() const override { return {tables_.get(), tables_ ? tables_->bytes() : 0}; }

private:
  static constexpr double kLargestIndex = 20;

  /// Probabilities of `sample`. The probability of passing undeflected must not depend on the wavelength, so
  /// that it is the mean of the fractions; `rest` is the factor of all other fractions.
  struct Masses {
    float transmitted;
    Spectrum rest;

    explicit Masses(const SphereTables::Shares& s)
        : transmitted(mean(s.transmitted)),
          rest(safe_divide(Spectrum(1 - transmitted), s.reflected + s.lost)) {}
  };

  static void check_size(const Properties& p, const SphereLayer& layer, const SpectralGrid& grid) {
    const auto size = [&](double nm) { return 2 * M_PI * layer.radius_nm * layer.medium(nm) / nm; };
    const double least = std::min(size(grid.min_nm), size(grid.max_nm)),
                 most = std::max(size(grid.min_nm), size(grid.max_nm)) * layer.sizes.largest();
    if (!(least >= SphereTables::kMinSize))
      throw p.error("radius",
                    "the spheres are too small for the wavelengths: 2 pi n radius/lambda must be at "
                    "least 0.01");
    if (!(most <= SphereTables::kMaxSize))
      throw p.error("radius",
                    "the spheres are too large for the wavelengths: 2 pi n radius/lambda of the largest "
                    "must not exceed 5000; discs of \"correlated_scatterers\" diffract alike");
  }

  std::shared_ptr<const SphereTables> tables_;
};

AUREOLE_PLUGIN(
    CorrelatedSpheres, "bsdf", "correlated_spheres",
    PluginDoc{
        "A layer of many small spheres, such as droplets, that do not overlap: halos and coronas by Mie's "
        "theory. The layer is a surface of its own in one medium: anything below it, such as the pane of a "
        "window, is another surface at a small distance. Coherent light passes undeflected or is reflected "
        "specularly; the rest is scattered into all directions or absorbed by the spheres.\n\nThe coherent "
        "part is modelled by single spheres in the mean field of all others. For spheres far above the "
        "wavelength it transmits too much light beyond the angle where cos theta = area_fraction/2. Spheres "
        "of one size have sharp resonances; those narrower than the wavelength nodes (up to 1024 over the sensor's "
        "range, 256 in dense or ordered layers) are not resolved. At a single wavelength of the visible range, water drops of 2, 10 and 30 um are "
        "right to 1.5, 0.5 and 0.9 % in the first rings, and to 5, 3 and 18 % of a ring's mean over all angles; "
        "a sensor with a narrower range has finer nodes. The largest sphere may have 2 pi n radius/lambda = "
        "5000. Tables take 1 to 20 MB.",
        "Yang, Kim, Pediredla & Jarosz, A wave-optics BSDF for correlated scatterers, 2025, section 6.2; "
        "Garcia-Valenzuela, Gutierrez-Reyes & Barrera, J. Opt. Soc. Am. A 29 (2012) 1161; Bohren & Huffman, "
        "Absorption and Scattering of Light by Small Particles, 1983, chapter 4",
        {{"radius", "length", "", "required", "radius of the (median) sphere, such as 5um"},
         {"area_fraction", "float", "", "required",
          "fraction of the plane that the spheres' projections cover, in (0, 0.7]; a close-packed lattice "
          "has 0.907"},
         {"size_spread", "float", "", "0",
          "standard deviation of ln(radius), log-normal, up to 0.7; intensities of all sizes are added, "
          "with the positions of equal spheres of the same covered fraction"},
         {"int_ior", "float or string", "", "1.333",
          "index of refraction of the spheres (water): a number, a dielectric or a metal"},
         {"k", "spectrum", "", "0",
          "extinction coefficient: imaginary part of the index of dielectric spheres"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction around the spheres, above and below the layer"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"correlation", "correlation", "", "hard discs",
          "spatial correlation of the positions; default: hard discs (Percus and Yevick)"}},
        {R"(<bsdf type="correlated_spheres">
    <string name="radius" value="3um"/>
    <float name="area_fraction" value="0.3"/>
    <string name="int_ior" value="water"/> <string name="ext_ior" value="air"/>
    <boolean name="dispersion" value="false"/>
</bsdf>)",
         R"(<bsdf type="correlated_spheres">
    <string name="radius" value="2um"/>
    <float name="area_fraction" value="0.2"/>
    <float name="size_spread" value="0.15"/>
    <float name="int_ior" value="1.5"/>
    <spectrum name="k" value="400:0.01, 700:0.001"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
