// SPDX-License-Identifier: Apache-2.0
// Runs the harness over every registered BSDF, and checks that the harness sees the errors it is there for.
#include "harness/bsdf_harness.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <sstream>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/random.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/spectrum/refractive_index.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

std::function<float(float)> constant(double n) {
  return [n](float) { return float(n); };
}
std::function<float(float)> material(const char* name, bool dispersion = true) {
  return [index = *find_refractive_index(name, dispersion)](float nm) { return float(index.at(nm).real()); };
}
BsdfCase make_case(std::string name, std::string xml, const std::function<void(BsdfCase&)>& adapt = {}) {
  BsdfCase c;
  c.name = std::move(name);
  c.xml = std::move(xml);
  if (adapt) adapt(c);
  return c;
}
void one_sided(BsdfCase& c) { c.black_below = true; }
void lossless_one_sided(BsdfCase& c) { c.black_below = c.lossless = true; }

const BsdfCases kDiffuse("diffuse", one_sided,
                         {make_case("diffuse_white",
                                    R"(<bsdf type="diffuse"><float name="reflectance" value="1"/></bsdf>)",
                                    lossless_one_sided)});

const BsdfCases kTwoSided(
    "twosided", {},
    {make_case(
        "twosided_plastic",
        R"(<bsdf type="twosided"><bsdf type="plastic"><float name="diffuse_reflectance" value="1"/></bsdf></bsdf>)",
        [](BsdfCase& c) { c.lossless = true; })});

const BsdfCases kFreeSpaceDiffraction("freespacediffraction", one_sided, {});
const BsdfCases kConductor("conductor", one_sided,
                           {make_case("conductor_mirror", R"(<bsdf type="conductor"/>)", lossless_one_sided),
                            make_case("conductor_cu",
                                      R"(<bsdf type="conductor"><string name="material" value="Cu"/></bsdf>)",
                                      one_sided)});

const BsdfCases kDielectric(
    "dielectric",
    [](BsdfCase& c) {
      c.n_above = material("air");
      c.lossless = c.name != "dielectric_example_2";
      if (c.name == "dielectric_example_1") c.n_below = material("water");
      if (c.name == "dielectric_example_2") c.n_below = constant(1.5);
      if (c.name == "dielectric_example_3") c.n_below = material("bk7", false);
    },
    {make_case("dielectric_default", R"(<bsdf type="dielectric"/>)",
               [](BsdfCase& c) {
                 c.lossless = true;
                 c.n_above = material("air");
                 c.n_below = constant(1.5046);
               }),
     make_case(
         "dielectric_diamond_in_sf11",
         R"(<bsdf type="dielectric"><string name="int_ior" value="diamond"/><string name="ext_ior" value="sf11"/></bsdf>)",
         [](BsdfCase& c) {
           c.lossless = true;
           c.n_above = material("sf11");
           c.n_below = material("diamond");
         }),
     make_case(
         "dielectric_bubble",
         R"(<bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1.33"/></bsdf>)",
         [](BsdfCase& c) {
           c.lossless = true;
           c.n_above = constant(1.33);
           c.n_below = constant(1);
         }),
     make_case(
         "dielectric_matched",
         R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1.5"/></bsdf>)",
         [](BsdfCase& c) {
           c.lossless = true;
           c.n_above = c.n_below = constant(1.5);
         })});

const BsdfCases kThinDielectric("thindielectric", {},
                                {make_case("thindielectric_default", R"(<bsdf type="thindielectric"/>)",
                                           [](BsdfCase& c) { c.lossless = true; }),
                                 make_case("thindielectric_bubble",
                                           R"(<bsdf type="thindielectric"><float name="int_ior" value="1"/>
               <string name="ext_ior" value="water"/></bsdf>)",
                                           [](BsdfCase& c) { c.lossless = true; })});

const BsdfCases kSlab(
    "slab", {},
    {make_case(
         "slab_soap",
         R"(<bsdf type="slab"><string name="int_ior" value="water"/><string name="thickness" value="400nm"/></bsdf>)",
         [](BsdfCase& c) { c.lossless = true; }),
     make_case(
         "slab_gold_leaf",
         R"(<bsdf type="slab"><string name="int_ior" value="Au"/><string name="thickness" value="80nm"/></bsdf>)"),
     make_case(
         "slab_opaque",
         R"(<bsdf type="slab"><string name="int_ior" value="Au"/><string name="thickness" value="1mm"/></bsdf>)")});

const BsdfCases kPlastic(
    "plastic", one_sided,
    {make_case("plastic_default", R"(<bsdf type="plastic"/>)", one_sided),
     make_case("plastic_white",
               R"(<bsdf type="plastic"><float name="diffuse_reflectance" value="1"/></bsdf>)",
               lossless_one_sided),
     make_case("plastic_white_dispersive",
               R"(<bsdf type="plastic"><float name="diffuse_reflectance" value="1"/>
               <string name="int_ior" value="sf11"/><boolean name="nonlinear" value="true"/></bsdf>)",
               lossless_one_sided),
     make_case("plastic_black",
               R"(<bsdf type="plastic"><float name="diffuse_reflectance" value="0"/></bsdf>)", one_sided),
     make_case("plastic_dull", R"(<bsdf type="plastic"><float name="specular_reflectance" value="0"/>
               <spectrum name="diffuse_reflectance" value="400:0, 700:0.9"/></bsdf>)",
               one_sided)});

// Diffracted light without a real direction is lost. Lobes are as narrow as wavelength over radius, around
// both specular directions; extra sets cover both kinds of scatterers, the substrates and large radii.
std::function<void(BsdfCase&)> scatterers(double angle, const std::function<void(BsdfCase&)>& more = {}) {
  return [=](BsdfCase& c) {
    c.may_fail = true;
    c.focus = [](const Vec3& wi) { return std::vector<Vec3>{reflect(wi), -wi}; };
    c.focus_angle = angle;
    if (more) more(c);
  };
}
std::string scatterer_xml(const std::string& parameters) {
  return "<bsdf type=\"correlated_scatterers\">" + parameters + "</bsdf>";
}
const BsdfCases kScatterers(
    "correlated_scatterers", scatterers(0.01),
    {make_case("correlated_scatterers_open", scatterer_xml(R"(<string name="radius" value="5um"/>
               <float name="area_fraction" value="0.5"/>)"),
               scatterers(0.01)),
     make_case("correlated_scatterers_glass", scatterer_xml(R"(<string name="radius" value="5um"/>
               <float name="area_fraction" value="0.3"/><string name="substrate" value="dielectric"/>
               <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>)"),
               scatterers(0.01, [](BsdfCase& c) { c.n_below = constant(1.5); })),
     make_case("correlated_scatterers_large", scatterer_xml(R"(<string name="radius" value="50um"/>
               <string name="scatterer" value="discs"/><float name="area_fraction" value="0.6"/>)"),
               scatterers(0.002)),
     make_case("correlated_scatterers_tiny", scatterer_xml(R"(<string name="radius" value="400nm"/>
               <float name="area_fraction" value="0.2"/>)"),
               scatterers(0.05)),
     make_case("correlated_scatterers_square_on_glass", scatterer_xml(R"(<aperture type="rectangle">
               <string name="width" value="4um"/><string name="height" value="3um"/><float name="rotation" value="20"/></aperture>
               <float name="area_fraction" value="0.6"/><string name="substrate" value="dielectric"/>
               <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>)"),
               scatterers(0.03, [](BsdfCase& c) { c.n_below = constant(1.5); })),
     make_case("correlated_scatterers_mixture_of_sizes", scatterer_xml(R"(<aperture type="circle">
               <string name="radius" value="2um"/><float name="fraction" value="0.4"/><float name="size_spread" value="0.15"/></aperture>
               <aperture type="star"><string name="radius" value="2um"/><float name="fraction" value="0.6"/>
               <boolean name="random_rotation" value="true"/></aperture>
               <float name="area_fraction" value="0.5"/><string name="substrate" value="thindielectric"/>)"),
               scatterers(0.03)),
     make_case("correlated_scatterers_polydisperse", scatterer_xml(R"(<aperture type="circle">
               <string name="radius" value="2um"/><float name="size_spread" value="0.2"/></aperture>
               <string name="sizes" value="polydisperse"/><string name="scatterer" value="discs"/>
               <float name="area_fraction" value="0.5"/>)"),
               scatterers(0.03)),
     make_case("correlated_scatterers_cloth", scatterer_xml(R"(<aperture type="rectangle">
               <string name="width" value="3um"/><string name="height" value="2um"/></aperture>
               <float name="area_fraction" value="0.5"/><correlation type="lattice"><string name="lattice" value="square"/>
               <float name="domain" value="3"/><float name="jitter" value="0.1"/></correlation>
               <bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)"),
               scatterers(0.05)),
     make_case("correlated_scatterers_poisson", scatterer_xml(R"(<string name="radius" value="3um"/>
               <float name="area_fraction" value="0.3"/><correlation type="poisson"/>)"),
               scatterers(0.02)),
     make_case("correlated_scatterers_stretched", scatterer_xml(R"(<string name="radius" value="2um"/>
               <float name="area_fraction" value="0.5"/><correlation type="percus_yevick"><float name="stretch" value="2"/>
               <float name="stretch_direction" value="25"/></correlation>)"),
               scatterers(0.03)),
     make_case("correlated_scatterers_table", scatterer_xml(R"(<string name="radius" value="2um"/>
               <float name="area_fraction" value="0.5"/><string name="sampling" value="table"/>)"),
               scatterers(0.03)),
     make_case("correlated_scatterers_cosine", scatterer_xml(R"(<string name="radius" value="1um"/>
               <float name="area_fraction" value="0.5"/><string name="sampling" value="cosine"/>
               <string name="substrate" value="thindielectric"/>)"),
               scatterers(0.1))});

std::string text(double v) {
  std::ostringstream s;
  s << v;
  return s.str();
}

const std::vector<BsdfCase>& cases() {
  static const std::vector<BsdfCase> all = all_bsdf_cases();
  return all;
}

class Harness : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Harness, Passes) {
  HarnessOptions options;
  options.family_size = cases().size();
  options.dump_folder = ::testing::TempDir();
  if (test::kSanitized)
    options.most_samples = 20000;  // sanitizers look at the code; statistics are judged in other builds
  const HarnessResult result = check_case(cases()[GetParam()], options);
  for (const std::string& failure : result.failures) ADD_FAILURE() << failure;
  const CheckResult& f = result.check;
  RecordProperty("smallest_p", text(f.smallest_p));
  RecordProperty("statistical_tests", std::to_string(f.statistical_tests));
  RecordProperty("largest_energy", text(f.largest_energy));
  RecordProperty("largest_mass_error", text(f.largest_mass_error));
}

INSTANTIATE_TEST_SUITE_P(Bsdf, Harness, ::testing::Range(std::size_t(0), cases().size()),
                         [](const auto& info) { return cases()[info.param].name; });

// A harness that never fails would pass every test above: each of these breaks one rule.
enum class Fault {
  none,
  density,
  value,
  mass,
  energy,
  adjoint,
  reciprocity,
  hero,
  shape,
  delta_hero,
  grazing,
  missed_part,
  noise
};

class Faulty final : public Bsdf {
public:
  explicit Faulty(const Properties& p)
      : Bsdf(p), fault_(Fault(p.get_int("fault", 0))), delta_(p.get_float("delta", 0.25, Range::unit())) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    Spectrum pdf = float(1 - delta_) * cosine_hemisphere_pdf(wo.z);
    Spectrum value = 0.5f * cosine_hemisphere_pdf(wo.z);
    if (fault_ == Fault::density) pdf *= 1.05f;
    if (fault_ == Fault::shape) pdf *= 1 + 0.08f * (wo.x > 0.3f ? 1.f : -1.f) * wo.y;
    if (fault_ == Fault::energy) value *= 2;
    if (fault_ == Fault::adjoint) value *= ctx.mode == TransportMode::radiance ? 1.02f : 1.f;
    // By the cosine at which the light arrives.
    if (fault_ == Fault::reciprocity) value *= ctx.mode == TransportMode::radiance ? wo.z : wi.z;
    if (fault_ == Fault::hero) value[0] *= 1.01f;
    if (fault_ == Fault::grazing && wo.z < 1e-6f) pdf = std::nanf("");
    if (fault_ == Fault::missed_part) pdf *= wo.x > 0 ? 0.f : 2.f;
    if (fault_ == Fault::noise)
      pdf *= unit_float(std::uint32_t(mix_bits(std::bit_cast<std::uint32_t>(wo.x))));
    return {value, pdf};
  }
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    if (u1 < float(delta_)) {
      BsdfSample s{reflect(wi), 0.25f, float(delta_), Lobe::delta | Lobe::reflect};
      if (fault_ == Fault::mass) s.pdf = 1.f;
      if (fault_ == Fault::delta_hero) s.pdf[1] = 0;
      return s;
    }
    Vec3 wo = square_to_cosine_hemisphere(u2);
    // A sampler with a correct density that never samples one half of the directions, where the BSDF is not
    // zero.
    if (fault_ == Fault::missed_part) wo.x = -std::abs(wo.x);
    BsdfEval e = eval_pdf(wi, wo, ctx);
    if (fault_ == Fault::value) e.value *= 1.05f;
    return BsdfSample{wo, e.value, e.pdf, Lobe::diffuse | Lobe::reflect};
  }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::delta | Lobe::reflect; }

private:
  Fault fault_;
  double delta_;
};

/// A faulty BSDF for arrays alone.
class FaultyArray final : public Bsdf, public ArrayBsdf {
public:
  FaultyArray(const Properties& p) : Bsdf(p), one_(p) {}
  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override {
    throw Error("called for one direction");
  }
  std::optional<BsdfSample> sample(const Vec3&, float, Vec2, const BsdfContext&) const override {
    throw Error("called for one direction");
  }
  Lobe lobes() const override { return one_.lobes(); }
  void eval_pdf_all(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
                    std::span<BsdfEval> found) const override {
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = one_.eval_pdf(wi[i], wo[i], ctx);
  }
  void sample_all(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                  const BsdfContext& ctx, std::span<std::optional<BsdfSample>> found) const override {
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = one_.sample(wi[i], u1[i], u2[i], ctx);
  }

private:
  Faulty one_;
};

Properties faulty(Fault fault) {
  return read_properties("<bsdf type=\"faulty\"><integer name=\"fault\" value=\"" +
                         std::to_string(int(fault)) + "\"/></bsdf>");
}
CheckResult check(Fault fault) {
  BsdfCase c;
  c.name = "faulty";
  c.black_below = true;
  c.bsdf = std::make_shared<Faulty>(faulty(fault));
  HarnessOptions options;
  options.dump_folder = ::testing::TempDir();
  return check_case(c, options).check;
}

bool says(const CheckResult& result, CheckRule rule, const std::string& text) {
  for (const CheckFinding& f : result.findings)
    if (f.rule == rule && !f.passed && f.message.find(text) != std::string::npos) return true;
  return false;
}

TEST(HarnessItself, AcceptsWhatIsRight) {
  const CheckResult r = check(Fault::none);
  EXPECT_EQ(r.problems(), std::vector<std::string>{});
  EXPECT_TRUE(r.passed());
  EXPECT_FALSE(r.findings.empty());
}
TEST(HarnessItself, SeesWrongDensity) {
  EXPECT_TRUE(says(check(Fault::density), CheckRule::density_integral, "add up to"));
}
TEST(HarnessItself, SeesWrongShape) {
  EXPECT_TRUE(says(check(Fault::shape), CheckRule::chi_square, "chi-square"));
}
TEST(HarnessItself, SeesWrongValue) {
  EXPECT_TRUE(says(check(Fault::value), CheckRule::sample, "is not eval_pdf's"));
}
TEST(HarnessItself, SeesWrongMass) {
  EXPECT_TRUE(says(check(Fault::mass), CheckRule::delta_lobes, "delta lobe of mass"));
}
TEST(HarnessItself, SeesEnergyGain) {
  EXPECT_TRUE(says(check(Fault::energy), CheckRule::energy, "gains energy"));
}
TEST(HarnessItself, SeesWrongMode) {
  EXPECT_TRUE(says(check(Fault::adjoint), CheckRule::modes, "importance mode"));
}
TEST(HarnessItself, SeesBrokenReciprocity) {
  EXPECT_TRUE(says(check(Fault::reciprocity), CheckRule::reciprocity, "not reciprocal"));
}
TEST(HarnessItself, SeesWrongHero) {
  EXPECT_TRUE(says(check(Fault::hero), CheckRule::wavelengths, "value of wavelength"));
}
TEST(HarnessItself, SeesWrongDeltaHero) {
  EXPECT_TRUE(says(check(Fault::delta_hero), CheckRule::wavelengths, "as hero"));
}
TEST(HarnessItself, SeesNotANumberAtGrazing) {
  const CheckResult r = check(Fault::grazing);
  EXPECT_TRUE(says(r, CheckRule::finite, "the density nan"));
  // The invalid values are on a set of measure zero: all other rules must pass.
  for (const CheckFinding& f : r.findings) EXPECT_TRUE(f.passed || f.rule == CheckRule::finite) << f.message;
}
TEST(HarnessItself, SeesAMissedPart) {
  EXPECT_TRUE(says(check(Fault::missed_part), CheckRule::sample_energy, "eval has"));
}
TEST(HarnessItself, GivesUpOnNoise) {
  CheckOptions options;
  options.samples = 1000;
  options.black_below = true;
  options.most_bins = 3000;
  const CheckResult r = check_bsdf(Faulty(faulty(Fault::noise)), options);
  EXPECT_FALSE(r.passed());
  for (const auto& h : r.histograms) EXPECT_LT(h.bins.size(), 4 * 3000u);
}
TEST(HarnessItself, CallsForArrays) {
  CheckOptions options;
  options.samples = 20000;
  options.black_below = true;
  const CheckResult one = check_bsdf(Faulty(faulty(Fault::none)), options);
  const CheckResult array = check_bsdf(FaultyArray(faulty(Fault::none)), options);
  EXPECT_EQ(array.problems(), one.problems());
  ASSERT_EQ(array.findings.size(), one.findings.size());
  for (std::size_t i = 0; i < one.findings.size(); ++i)
    EXPECT_EQ(array.findings[i].figure, one.findings[i].figure);
}
TEST(HarnessItself, MayBeBlackBelow) {
  CheckOptions options;
  options.samples = 20000;
  EXPECT_FALSE(check_bsdf(Faulty(faulty(Fault::none)), options).passed());
  options.may_be_black_below = true;
  const CheckResult r = check_bsdf(Faulty(faulty(Fault::none)), options);
  EXPECT_TRUE(r.passed());
  EXPECT_TRUE(r.black_below);
}
TEST(HarnessItself, ProgressGrowsAndMayThrow) {
  CheckOptions options;
  options.samples = 20000;
  options.black_below = true;
  double last = 0;
  std::size_t calls = 0;
  options.progress = [&](double part) {
    EXPECT_GE(part, last);
    last = part, ++calls;
  };
  check_bsdf(Faulty(faulty(Fault::none)), options);
  EXPECT_EQ(last, 1);
  EXPECT_GT(calls, 20u);
  options.progress = [](double part) {
    if (part > 0.1) throw std::runtime_error("enough");
  };
  EXPECT_THROW(check_bsdf(Faulty(faulty(Fault::none)), options), std::runtime_error);
}
TEST(HarnessItself, BoundsEnergiesBetween) {
  CheckOptions options;
  options.samples = 20000;
  options.black_below = true;
  options.energy_angles = {0, 40};
  const CheckResult r = check_bsdf(Faulty(faulty(Fault::energy)), options);
  std::size_t between = 0;
  for (const CheckFinding& f : r.findings)
    between +=
        f.rule == CheckRule::energy && std::abs(f.wi.z - std::cos(40 * kPi / 180)) < 1e-5f && !f.passed;
  EXPECT_EQ(between, 1u);
}
TEST(HarnessItself, RefusesWrongOptions) {
  CheckOptions options;
  options.min_nm = 300, options.max_nm = 830;
  EXPECT_THROW(check_bsdf(Faulty(faulty(Fault::none)), options), Error);
  options.min_nm = 360;
  options.samples = 10;
  EXPECT_THROW(check_bsdf(Faulty(faulty(Fault::none)), options), Error);
}

TEST(Statistics, KnownValues) {
  EXPECT_NEAR(chi_square_p_value(18.307, 10), 0.05, 1e-5);
  EXPECT_NEAR(normal_p_value(1.959964), 0.05, 1e-6);
  EXPECT_NEAR(sidak_level(0.05, 1), 0.05, 1e-12);
  EXPECT_NEAR(std::pow(1 - sidak_level(0.01, 300), 300), 0.99, 1e-12);
  // P(X <= 2) of ten throws with 1/2 is 56/1024.
  EXPECT_NEAR(binomial_p_value(2, 10, 0.5), 2 * 56.0 / 1024, 1e-12);
}

}  // namespace
}  // namespace aureole::testing
