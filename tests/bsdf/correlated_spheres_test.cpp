// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <ctime>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/spheres/sphere_tables.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/layer/coherent_layer.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::BsdfCase;
using testing::BsdfCases;

std::string spheres(const std::string& radius, double area_fraction, double index,
                    const std::string& more = "") {
  return R"(<bsdf type="correlated_spheres"><string name="radius" value=")" + radius +
         R"("/><float name="area_fraction" value=")" + std::to_string(area_fraction) +
         R"("/><float name="int_ior" value=")" + std::to_string(index) +
         R"("/><float name="ext_ior" value="1"/>)" + more + "</bsdf>";
}

// Lobes are as narrow as wavelength over radius around the way straight on.
std::function<void(BsdfCase&)> spheres_case(double angle, bool lossless) {
  return [=](BsdfCase& c) {
    c.lossless = lossless;
    c.focus = [](const Vec3& wi) { return std::vector<Vec3>{-wi}; };
    c.focus_angle = angle;
  };
}
BsdfCase harness_case(const char* name, const std::string& xml, double angle, bool lossless) {
  BsdfCase c;
  c.name = name, c.xml = xml;
  spheres_case(angle, lossless)(c);
  return c;
}
const BsdfCases kSpheres("correlated_spheres",
                         [](BsdfCase& c) { spheres_case(0.01, c.name == "correlated_spheres_example_1")(c); },
                         {harness_case("correlated_spheres_dense", spheres("5um", 0.7, 1.33), 0.006, true),
                          harness_case("correlated_spheres_large", spheres("60um", 0.5, 1.5), 0.001, true),
                          harness_case("correlated_spheres_tiny", spheres("80nm", 0.3, 2.4), 0.1, true),
                          harness_case("correlated_spheres_bubbles", spheres("1um", 0.4, 0.75), 0.02, true),
                          harness_case("correlated_spheres_gold", R"(<bsdf type="correlated_spheres">
         <string name="radius" value="300nm"/><float name="area_fraction" value="0.3"/>
         <string name="int_ior" value="Au"/></bsdf>)",
                                       0.05, false),
                          harness_case("correlated_spheres_ordered",
                                       spheres("2um", 0.5, 1.33, R"(<correlation type="lattice">
         <float name="domain" value="3"/><float name="jitter" value="0.1"/>
         <boolean name="random_orientation" value="true"/></correlation>)"),
                                       0.02, true)});

constexpr double kPiD = std::numbers::pi;

/// The wavelength [nm] of a sensor so narrow that nodes of wavelength do not matter.
constexpr double kNm = 550;
std::shared_ptr<Bsdf> at_550(const std::string& xml) {
  return testing::build<Bsdf>(xml, testing::make_context(kNm - 0.01, kNm + 0.01));
}
struct Setting {
  Wavelengths wavelengths = Wavelengths::at(SpectralGrid::over(kNm - 0.01, kNm + 0.01), float(kNm));
  SurfacePoint point;
  BsdfContext context(TransportMode mode = TransportMode::radiance) const {
    return {wavelengths, point, mode, 0};
  }
};
using testing::direction;

/// (|S1|^2 + |S2|^2)/2 S'(q) written out anew.
double formula(const Vec3& wi, const Vec3& wo, double radius_nm, std::complex<double> m, double area_fraction,
               double n = 1) {
  const double x = 2 * kPiD * n * radius_nm / kNm;
  static std::pair<double, std::complex<double>> last;
  static std::unique_ptr<optics::Mie> sphere;
  if (!sphere || last != std::pair(x, m)) sphere = std::make_unique<optics::Mie>(x, m), last = {x, m};
  const double mu = -(double(wi.x) * wo.x + double(wi.y) * wo.y + double(wi.z) * wo.z);
  const optics::MieAmplitudes s = sphere->amplitudes(std::clamp(mu, -1.0, 1.0));
  const double u = x * std::hypot(double(wi.x) + wo.x, double(wi.y) + wo.y);
  return (std::norm(s.s1) + std::norm(s.s2)) / 2 * optics::hard_disc_structure_factor(u, area_fraction);
}

TEST(CorrelatedSpheres, ValueIsTheFormula) {
  // Over the formula the value is a function of the two angles from the normal: the same for all azimuths and
  // on both sides.
  const Setting s;
  for (const double radius : {1000.0, 3000.0, 5000.0}) {
    const auto bsdf = at_550(spheres(std::to_string(radius) + "nm", 0.3, 1.33));
    for (const double theta_i : {0.0, 0.7, 1.3})
      for (const double theta_o : {0.05, 0.69, 0.72, 1.2}) {
        const Vec3 wi = direction(theta_i, 0.4);
        double largest = 0, first = 0, largest_value = 0;
        std::vector<std::pair<double, double>> pairs;
        for (int i = 0; i < 200; ++i) {
          const double phi = 0.4 + kPiD * (1 + 0.02 * i + 1e-4 * i * i);
          Vec3 wo = direction(theta_o, phi);
          if (i % 2 == 0) wo.z = -wo.z;
          const double value = double(bsdf->eval(wi, wo, s.context())[0]) / std::abs(double(wo.z));
          pairs.emplace_back(value, formula(wi, wo, radius, 1.33, 0.3));
          if (pairs.back().second > largest) largest = pairs.back().second, largest_value = value;
        }
        first = largest_value / largest;
        ASSERT_GT(first, 0);
        for (const auto& [value, expected] : pairs)
          EXPECT_NEAR(value / first, expected, 0.02 * expected + 2e-3 * largest)
              << radius << " " << theta_i << " " << theta_o;
      }
  }
}

TEST(CorrelatedSpheres, BetweenNodesOfWavelength) {
  // Forward lobes over the whole visible range, off the nodes.
  const auto bsdf = testing::build<Bsdf>(spheres("5um", 0.3, 1.33));
  const SpectralGrid grid;
  const SurfacePoint point;
  const Wavelengths w = Wavelengths::at(grid, float(kNm));
  const BsdfContext context{w, point, TransportMode::radiance, 0};
  const Vec3 wi = direction(0, 0);
  const double scale = double(bsdf->eval(wi, direction(kPiD - 0.02, 0), context)[0]) /
                       formula(wi, direction(kPiD - 0.02, 0), 5000, 1.33, 0.3);
  for (double theta = 0; theta < 0.3; theta += 0.003) {
    const Vec3 wo = direction(kPiD - theta, 0);
    const double expected = formula(wi, wo, 5000, 1.33, 0.3);
    EXPECT_NEAR(double(bsdf->eval(wi, wo, context)[0]) / -wo.z / scale, expected,
                0.04 * expected + 1e-3 * formula(wi, direction(kPiD - 0.02, 0), 5000, 1.33, 0.3))
        << theta;
  }
}

/// Tables of the visible range at wavelengths between their nodes, against tables of a range so narrow that
/// interpolation does not matter: the root mean square of relative errors over angles.
TEST(CorrelatedSpheres, ErrorBetweenNodesOfWavelength) {
  class Random final : public optics::StructureFactor {
    double eval(double) const override { return 1; }
  };
  struct Case {
    double radius_nm, rings, all;
  };
  for (const Case& c : {Case{2000, 0.02, 0.06}, {10000, 0.01, 0.04}, {30000, 0.01, 0.2}}) {
    SphereLayer layer;
    layer.radius_nm = c.radius_nm, layer.area_fraction = 0.1;
    layer.structure = std::make_shared<Random>();
    layer.medium = [](double) { return 1.0; };
    layer.relative_index = [](double) { return std::complex<double>(1.333); };
    const auto begin = std::clock();
    const SphereTables tables(layer, SpectralGrid{});
    const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform;
    double rings = 0, all = 0;
    constexpr int kWavelengthsTried = 6, kRings = 40;
    for (int k = 0; k < kWavelengthsTried; ++k) {
      const float nm = 420 + 280 * uniform(random);
      const SphereTables exact(layer, SpectralGrid::over(nm - 0.01f, nm + 0.01f));
      const double ring = kPiD * double(nm) / (2 * kPiD * c.radius_nm);  // width of a ring
      // Four rings in front, and as many that are spread over all angles. Errors are relative to the mean of a
      // ring, since dark rings have little light.
      for (int r = 0; r < 4 + kRings; ++r) {
        const double begin = r < 4 ? r * ring : std::min(kPiD - ring, (r - 3.5) * kPiD / kRings);
        double sum = 0, squares = 0, points = 0;
        for (double theta = begin; theta < begin + ring; theta += ring / 16) {
          if (std::abs(std::cos(theta)) < 0.05) continue;
          const Vec3 wi = direction(0, 0), wo = direction(kPiD - theta, 0);
          const double a = double(tables.eval(wi, wo, nm).value[0]),
                       b = double(exact.eval(wi, wo, nm).value[0]);
          sum += b, squares += (a - b) * (a - b), ++points;
        }
        if (points == 0) continue;
        (r < 4 ? rings : all) += squares * points / (sum * sum) / (kWavelengthsTried * (r < 4 ? 4 : kRings));
      }
    }
    rings = std::sqrt(rings), all = std::sqrt(all);
    std::printf(
        "%2.0f um: %d nodes, %.1f MB, %.2f s of CPU; error %.2f %% in the first rings, %.1f %% in all\n",
        c.radius_nm / 1000, tables.wavelength_nodes(), double(tables.bytes()) / 1e6, seconds, 100 * rings,
        100 * all);
    EXPECT_LT(rings, c.rings) << c.radius_nm;
    EXPECT_LT(all, c.all) << c.radius_nm;
  }
}

/// The part of the light from wi that becomes diffuse, by quadrature in rings about the way straight on.
double diffuse_energy(const Bsdf& bsdf, const Vec3& wi, const Setting& s, double x) {
  const Frame frame = Frame::from_normal(-wi);
  double sum = 0;
  const double split = std::min(40 / x, 1.0);
  for (const auto& [begin, end, rings] :
       {std::tuple(0.0, split, 2400), std::tuple(split, 2.0, std::max(3600, int(36 * x)))}) {
    const double width = (end - begin) / rings;
    for (int i = 0; i < rings; ++i) {
      const double v = begin + (i + 0.5) * width, cosine = 1 - v * v / 2, sine = v * std::sqrt(1 - v * v / 4);
      const int around = test::effort(48, 96);
      double ring = 0;
      for (int k = 0; k < around; ++k) {
        const double phi = 2 * kPiD * (k + 0.5 * (i % 2)) / around;
        const Vec3 wo =
            frame.to_world({float(sine * std::cos(phi)), float(sine * std::sin(phi)), float(cosine)});
        ring += double(bsdf.eval(wi, wo, s.context())[0]);
      }
      sum += ring * 2 * kPiD / around * v * width;
    }
  }
  return sum;
}

/// The energies of the delta lobes: reflected, transmitted.
std::pair<double, double> delta_energies(const Bsdf& bsdf, const Vec3& wi, const Setting& s) {
  double reflected = 0, transmitted = 0;
  if (const auto x = bsdf.sample(wi, 0, {0.3f, 0.3f}, s.context()); x && x->is_delta()) {
    if (has(x->lobe, Lobe::null)) return {0, double(x->value[0])};  // nothing is reflected
    EXPECT_EQ(x->wo, reflect(wi));
    reflected = double(x->value[0]);
  }
  if (const auto x = bsdf.sample(wi, 0x1.fffffep-1f, {0.3f, 0.3f}, s.context()); x && x->is_delta()) {
    EXPECT_EQ(x->wo, -wi);
    EXPECT_TRUE(has(x->lobe, Lobe::null));
    transmitted = double(x->value[0]);
  }
  return {reflected, transmitted};
}

TEST(CorrelatedSpheres, EnergyBetweenNodesOfWavelength) {
  // Over the visible range h is computed at every 32nd node of these.
  Setting s;
  double worst = 0;
  for (const double radius : {2000.0, 5000.0}) {
    const auto bsdf = testing::build<Bsdf>(spheres(std::to_string(radius) + "nm", 0.3, 1.33));
    for (const float nm : {431.3f, 552.7f, 671.9f}) {
      s.wavelengths = Wavelengths::at(SpectralGrid{}, nm);
      for (const double degrees : {0.0, 50.0, 75.0}) {
        const Vec3 wi = direction(degrees * kPiD / 180, 1.1);
        const auto [reflected, transmitted] = delta_energies(*bsdf, wi, s);
        const double diffuse = diffuse_energy(*bsdf, wi, s, 2 * kPiD * radius / double(nm));
        worst = std::max(worst, std::abs(diffuse + reflected + transmitted - 1));
      }
    }
  }
  std::printf("largest error of the energy between nodes: %.1e\n", worst);
  EXPECT_LT(worst, 1.5e-3);
}

TEST(CorrelatedSpheres, EnergyAtAllAngles) {
  const Setting s;
  const struct {
    double radius_nm, area_fraction, n, k;
  } layers[] = {{100, 0.3, 1.5, 0},  {1000, 0.3, 1.33, 0},    {1000, 0.7, 1.33, 0}, {5000, 0.1, 1.33, 0},
                {5000, 0.5, 1.5, 0}, {3000, 0.3, 1.33, 0.02}, {800, 0.4, 0.75, 0},  {20000, 0.3, 1.33, 0}};
  for (const auto& l : layers) {
    const auto bsdf = at_550(spheres(std::to_string(l.radius_nm) + "nm", l.area_fraction, l.n,
                                     R"(<spectrum name="k" value=")" + std::to_string(l.k) + R"("/>)"));
    const optics::Mie sphere(2 * kPiD * l.radius_nm / kNm, {l.n, l.k});
    for (const double degrees : {0.0, 20.0, 45.0, 61.0, 75.0, 84.0, 88.0, 140.0}) {
      if (!test::is_thorough() && (degrees == 20 || degrees == 61 || degrees == 84)) continue;
      const Vec3 wi = direction(degrees * kPiD / 180, 1.1);
      const optics::CoherentLayer c = optics::coherent_layer(std::abs(double(wi.z)), l.area_fraction, sphere);
      const double diffuse = diffuse_energy(*bsdf, wi, s, sphere.size());
      EXPECT_NEAR(diffuse, c.loss() * sphere.albedo(), 2e-3)
          << l.radius_nm << " " << l.area_fraction << " " << degrees;
      // Shares are interpolated between 73 cosines.
      const auto [reflected, transmitted] = delta_energies(*bsdf, wi, s);
      EXPECT_NEAR(reflected, c.reflectance(), 2e-3) << l.radius_nm << " " << degrees;
      EXPECT_NEAR(transmitted, c.transmittance(), 2e-3) << l.radius_nm << " " << degrees;
      if (l.k == 0) {
        // The tolerance is that of the points by which h is balanced; the peaks of dense layers are sharp.
        EXPECT_NEAR(diffuse + reflected + transmitted, 1, l.area_fraction > 0.6 ? 1.5e-3 : 1e-3)
            << l.radius_nm << " " << l.area_fraction << " " << degrees;
      }
      if (l.k > 0 && degrees == 0) {
        EXPECT_LT(diffuse + reflected + transmitted, 0.8);
      }
    }
  }
}

TEST(CorrelatedSpheres, IsReciprocal) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  const auto bsdf = testing::build<Bsdf>(spheres("2um", 0.5, 1.33));
  const Wavelengths w =
      Wavelengths::at(SpectralGrid{}, make_spectrum([](int i) { return 380.f + 47.f * float(i); }));
  const SurfacePoint point;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 wi = direction(std::acos(2 * uniform(random) - 1), 2 * kPiD * uniform(random));
    Vec3 wo = direction(std::acos(2 * uniform(random) - 1), 2 * kPiD * uniform(random));
    if (i % 2) wo = normalize(wo * 0.1f - wi);
    for (const auto mode : {TransportMode::radiance, TransportMode::importance}) {
      const BsdfContext context{w, point, mode, 0};
      const Spectrum a = bsdf->eval(wi, wo, context), b = bsdf->eval(wo, wi, context);
      for (int j = 0; j < kWavelengths; ++j) {
        const double f = double(a[j]) / std::abs(double(wo.z)), g = double(b[j]) / std::abs(double(wi.z));
        EXPECT_NEAR(f, g, 1e-5 * f);
      }
    }
  }
}

TEST(CorrelatedSpheres, ForwardLobesOfDiscsAndSpheres) {
  // Figure 6 of the source: light along the normal, 550 nm, area fraction .3, here droplets of water (1.33).
  // Opaque discs of the same radius diffract alike where the sphere is large. The light that a clear
  // sphere lets through interferes with the light that it diffracts, so that it agrees with a disc only at
  // larger sizes than an absorbing sphere does.
  const Setting s;
  std::printf("largest difference of the normalised lobes for q a < 3, in %% of the peak\n");
  std::printf("%8s %8s %12s %12s %12s\n", "a [um]", "k a", "1.33 + .05i", "n = 1.33", "n = 1.5");
  for (const double radius : {1.0, 2.0, 5.0, 5.4, 10.0, 20.0, 40.0}) {
    const double x = 2 * kPiD * radius * 1000 / kNm;
    double differences[3];
    for (int kind = 0; kind < 3; ++kind) {
      const double n = kind < 2 ? 1.33 : 1.5;
      const auto sphere = at_550(spheres(std::to_string(radius) + "um", 0.3, n,
                                         kind == 0 ? R"(<float name="k" value="0.05"/>)" : ""));
      const auto disc = at_550(R"(<bsdf type="correlated_scatterers"><string name="scatterer" value="discs"/>
          <string name="radius" value=")" +
                               std::to_string(radius) + R"(um"/><float name="area_fraction" value="0.3"/>
          <float name="ext_ior" value="1"/></bsdf>)");
      std::vector<double> a, b;
      for (double u = 0; u < 3; u += 0.02) {
        const Vec3 wi = direction(0, 0), wo = direction(kPiD - std::asin(u / x), 0.3);
        a.push_back(double(sphere->eval(wi, wo, s.context())[0]) / std::abs(double(wo.z)));
        b.push_back(double(disc->eval(wi, wo, s.context())[0]) / std::abs(double(wo.z)));
      }
      const double peak_a = *std::max_element(a.begin(), a.end()),
                   peak_b = *std::max_element(b.begin(), b.end());
      double& most = differences[kind];
      most = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(a[i] / peak_a - b[i] / peak_b));
    }
    std::printf("%8.1f %8.1f %12.2f %12.2f %12.2f\n", radius, x, 100 * differences[0], 100 * differences[1],
                100 * differences[2]);
    // An opaque sphere's edge is not sharp: its rays that just pass shift the lobe by x^(-2/3).
    if (x > 60) {
      EXPECT_LT(differences[0], x > 80 ? 0.05 : 0.062) << radius;
    }
    if (x > 100) {
      EXPECT_LT(differences[1], 0.05) << radius;
      EXPECT_LT(differences[2], 0.08) << radius;
    }
    if (radius == 1) {
      EXPECT_GT(differences[1], 0.05);
    }
  }
}

TEST(CorrelatedSpheres, SpreadOfSizesAddsIntensities) {
  const Setting s;
  const double sigma = 0.2, radius = 2000, fraction = 0.3;
  const auto bsdf = at_550(spheres("2um", fraction, 1.33, R"(<float name="size_spread" value="0.2"/>)"));
  const auto sizes = optics::SizeDistribution::log_normal(sigma);
  const double k = 2 * kPiD / kNm, rms = radius * std::sqrt(sizes.moment(2));
  const auto expected = [&](double theta) {
    double sum = 0;
    for (const auto& n : sizes.nodes())
      sum += n.weight * optics::Mie(k * radius * n.size, 1.33).amplitudes(std::cos(theta)).intensity();
    return sum * optics::hard_disc_structure_factor(k * rms * std::sin(theta), fraction);
  };
  const Vec3 wi = direction(0, 0);
  const auto value = [&](double theta) {
    return double(bsdf->eval(wi, direction(kPiD - theta, 2), s.context())[0]) / std::cos(theta);
  };
  // h changes little over these angles.
  for (double theta = 0; theta < 0.2; theta += 0.004)
    EXPECT_NEAR(value(theta) / value(0.05), expected(theta) / expected(0.05),
                0.03 * expected(theta) / expected(0.05))
        << theta;
  // The coherent part: means of the amplitudes and of x^2.
  optics::LayerSpheres spheres{0, 0};
  optics::MieAmplitudes back;
  for (const auto& n : sizes.nodes()) {
    const optics::Mie sphere(k * radius * n.size, 1.33);
    spheres.size_squared += n.weight * sphere.size() * sphere.size();
    spheres.forward += n.weight * sphere.forward();
    const auto a = sphere.amplitudes(-1);
    back.s1 += n.weight * a.s1, back.s2 += n.weight * a.s2;
  }
  const auto c = optics::coherent_layer(1, fraction, spheres, back);
  EXPECT_NEAR(delta_energies(*bsdf, wi, s).second, c.transmittance(), 1e-5);
  EXPECT_NEAR(diffuse_energy(*bsdf, wi, s, k * rms), c.loss(), 2e-3);
}

TEST(CorrelatedSpheres, SamplesHaveNearlyOneWeight) {
  // Variance of value/density over the square of its mean, for diffuse samples.
  const Setting s;
  for (const char* radius : {"1um", "10um"})
    for (const double fraction : {0.3, 0.6}) {
      const auto bsdf = at_550(spheres(radius, fraction, 1.33));
      for (const double degrees : {0.0, 60.0, 80.0}) {
        const Vec3 wi = direction(degrees * kPiD / 180, 2);
        double sum = 0, square = 0;
        int count = 0;
        for (int i = 0; i < 40000; ++i) {
          const auto fraction_of = [i](double step) {
            return std::min(float(std::fmod(i * step, 1.0)), 0.99999f);
          };
          const auto x =
              bsdf->sample(wi, 0.5f, {fraction_of(0.7548776662), fraction_of(0.5698402910)}, s.context());
          if (!x || x->is_delta()) continue;
          const double w = double(x->value[0]) / double(x->pdf[0]);
          sum += w, square += w * w, ++count;
        }
        if (count == 0) continue;
        const double variance = square * count / (sum * sum) - 1;
        EXPECT_LT(variance, degrees == 0     ? 0.05
                            : fraction < 0.5 ? 0.15
                                             : 0.3)
            << radius << " " << fraction << " " << degrees;
      }
    }
}

TEST(CorrelatedSpheres, TablesAreSmall) {
  for (const double radius : {100.0, 2000.0, 9000.0, 60000.0}) {
    if (!test::is_thorough() && (radius == 100 || radius == 9000)) continue;
    SphereLayer layer;
    layer.radius_nm = radius, layer.area_fraction = 0.3;
    class Random final : public optics::StructureFactor {
      double eval(double) const override { return 1; }
    };
    layer.structure = std::make_shared<Random>();
    layer.medium = [](double) { return 1.0; };
    layer.relative_index = [](double) { return std::complex<double>(1.33); };
    const SphereTables tables(layer, SpectralGrid{});
    EXPECT_LT(tables.bytes(), std::size_t(24) << 20) << radius;
  }
}

TEST(CorrelatedSpheres, WithoutContrastNothingHappens) {
  const Setting s;
  const auto bsdf = at_550(spheres("1um", 0.3, 1));
  const Vec3 wi = direction(0.5, 0);
  EXPECT_NEAR(delta_energies(*bsdf, wi, s).second, 1, 1e-6);
  EXPECT_LT(bsdf->eval(wi, -wi, s.context())[0], 1e-6);
}

TEST(CorrelatedSpheres, WrongInputIsNamed) {
  const auto fails_with = [](const std::string& parameters, const std::string& text) {
    testing::expect_error("correlated_spheres", parameters, text);
  };
  const std::string radius = R"(<string name="radius" value="2um"/>)",
                    fraction = R"(<float name="area_fraction" value="0.3"/>)";
  fails_with(fraction, "radius");
  fails_with(radius, "area_fraction");
  fails_with(R"(<float name="radius" value="2"/>)" + fraction, "unit");
  fails_with(radius + R"(<float name="area_fraction" value="0.75"/>)", "0.7");
  fails_with(radius + R"(<float name="area_fraction" value="0"/>)", "area_fraction");
  fails_with(R"(<string name="radius" value="2mm"/>)" + fraction, "too large for the wavelengths");
  fails_with(R"(<string name="radius" value="0.1nm"/>)" + fraction, "too small for the wavelengths");
  fails_with(R"(<string name="radius" value="1e300m"/>)" + fraction, "too large for the wavelengths");
  fails_with(radius + fraction + R"(<float name="size_spread" value="0.8"/>)", "0.7");
  fails_with(radius + fraction + R"(<string name="int_ior" value="watr"/>)", "water");
  fails_with(radius + fraction + R"(<string name="ext_ior" value="Au"/>)", "absorbs too strongly");
  fails_with(radius + fraction + R"(<float name="int_ior" value="30"/>)", "must not exceed 20");
  fails_with(radius + fraction + R"(<float name="int_ior" value="-1"/>)", "int_ior");
  fails_with(radius + fraction + R"(<spectrum name="k" value="-0.1"/>)", "k");
  fails_with(radius + fraction + R"(<string name="int_ior" value="Au"/><spectrum name="k" value="0.1"/>)",
             "its own absorption");
  fails_with(radius + fraction + R"(<texture name="k" type="checkerboard"/>)", "must not vary");
}

}  // namespace
}  // namespace aureole
