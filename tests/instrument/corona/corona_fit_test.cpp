// SPDX-License-Identifier: Apache-2.0
// Radius and area fraction come back from coronas that were computed by direct sums over wavelengths, and
// from a rendered picture.
#include "aureole/instrument/corona/corona_fit.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <random>

#include "aureole/core/error.h"
#include "aureole/loading/load.h"
#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/aperture/round_aperture.h"
#include "aureole/optics/arrangement/simulated_structure_factor.h"
#include "aureole/optics/layer/scatterer_layer.h"
#include "aureole/optics/layer/scatterer_mixture.h"
#include "aureole/render/job.h"
#include "harness/effort.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

constexpr double kDegree = M_PI / 180;

/// A picture of a corona on an uneven ground, seen through a camera with its own white balance. `intensity` is a
/// function of q [rad/m].
Image corona_picture(const std::function<double(double)>& intensity, const std::string& lamp, double noise,
                     double pixel_deg = 0.04, double amplitude = 1) {
  const LampSpectrum spectrum = lamp_spectrum(lamp);
  constexpr int kTable = 600;
  constexpr double kLargest = 0.12;
  std::vector<std::array<double, 3>> table;
  double most = 0;
  for (int i = 0; i <= kTable; ++i) {
    table.push_back(corona_colour(spectrum, [&](double k) { return intensity(k * kLargest * i / kTable); }));
    most = std::max(most, table.back()[1]);
  }
  Image image;
  image.width = 240, image.height = 200, image.channels = {"R", "G", "B"};
  const PinholeCamera camera{std::tan(pixel_deg * kDegree), 120, 100};
  const Direction to = camera.direction(110, 90);
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Direction v = camera.direction(x + 0.5, y + 0.5);
      const double s = std::hypot(v.x - to.x, v.y - to.y), at = std::min(s / kLargest, 0.999) * kTable;
      const size_t k = size_t(at);
      for (size_t c = 0; c < 3; ++c) {
        const double balance[3] = {1.3, 1, 0.8};
        const double light = table[k][c] + (at - double(k)) * (table[k + 1][c] - table[k][c]);
        image.pixels.push_back(float(amplitude * balance[c] * light / most + 0.2 + 0.1 * s +
                                     noise * normal(random) +
                                     (std::hypot(x + 0.5 - 110, y + 0.5 - 90) < 2 ? 50 : 0)));
      }
    }
  return image;
}

/// Equal circles on the positions of the theory of hard discs.
Image corona_picture(double radius, double fraction, const std::string& lamp, double noise,
                     double pixel_deg = 0.04, double amplitude = 1) {
  const optics::ScattererLayer layer(radius, radius, fraction);
  return corona_picture([&](double q) { return layer.intensity(q); }, lamp, noise, pixel_deg, amplitude);
}

CoronaFit fit(const Image& image, const std::string& lamp, double pixel_deg = 0.04,
              CoronaModel::Positions positions = CoronaModel::Positions::percus_yevick,
              CoronaSizes sizes = CoronaSizes::one) {
  const PinholeCamera camera{std::tan(pixel_deg * kDegree), 0.5 * image.width, 0.5 * image.height};
  const auto spot = brightest_spot(image);
  const ScatteredProfile p = scattered_profile(image, camera, camera.direction(spot[0], spot[1]), {}, {},
                                               6 * camera.tangent_per_pixel, INFINITY);
  CoronaModel model(lamp_spectrum(lamp), p.s.back(), 0, positions);
  return fit_corona(p, model, sizes);
}

/// An 8-bit photograph of a picture, with its largest values clipped, and decoded again.
Image photograph(Image image, float exposure) {
  for (float& v : image.pixels)
    v = srgb_decode(std::round(255 * srgb_encode(std::clamp(v * exposure, 0.f, 1.f))) / 255);
  return image;
}
constexpr double kClip = 0.98;  // linear; of 252 in 255

TEST(PictureParts, RangesOfAzimuthsGoThroughZero) {
  struct Range {
    double from, to, inside, outside;
  };
  for (const auto& [from, to, inside, outside] : {Range{300, 60, 10, 180},
                                                  {-60, 60, 350, 180},
                                                  {350, -350, 0, 180},
                                                  {200, -300, 210, 100},
                                                  {300, -60, 30, -1}})
    for (const double turn : {-360., 0., 360.}) {
      const PictureParts parts = picture_parts({from, to}, {});
      EXPECT_TRUE(parts.has_azimuth(inside + turn)) << from << " " << to;
      if (outside >= 0) EXPECT_FALSE(parts.has_azimuth(outside + turn)) << from << " " << to;
    }
  EXPECT_THROW(picture_parts({60, 60}, {}), Error);
}

TEST(PictureParts, AzimuthsPassThroughZero) {
  const PictureParts ahead = picture_parts({300, 60}, {}), same = picture_parts({-60, 60}, {});
  for (const PictureParts* p : {&ahead, &same}) {
    for (const double a : {300.5, 330.0, 359.9, 0.0, 30.0, 59.5}) EXPECT_TRUE(p->has_azimuth(a)) << a;
    for (const double a : {60.5, 90.0, 180.0, 299.5}) EXPECT_FALSE(p->has_azimuth(a)) << a;
  }
  const PictureParts all = picture_parts({0, 360}, {}), half = picture_parts({90, 270}, {50, 50, 10});
  for (double a = 0; a < 360; a += 7.3) EXPECT_TRUE(all.has_azimuth(a)) << a;
  EXPECT_TRUE(half.has_azimuth(180));
  EXPECT_FALSE(half.has_azimuth(0));
  EXPECT_TRUE(half.is_masked(50, 59));
  EXPECT_FALSE(half.is_masked(50, 61));
  EXPECT_THROW(picture_parts({60, 60}, {}), Error);
  EXPECT_THROW(picture_parts({0, 400}, {}), Error);
  EXPECT_THROW(picture_parts({0}, {}), Error);
  EXPECT_THROW(picture_parts({0, 360}, {10, 10, -5}), Error);
  EXPECT_THROW(picture_parts({0, 360}, {10, 10, 0}), Error);
  EXPECT_THROW(picture_parts({0, 360}, {10, 10}), Error);
  EXPECT_THROW(picture_parts({0, 360}, {10, NAN, 5}), Error);
}

TEST(CoronaFit, ComesBack) {
  struct {
    double radius, fraction;
    const char* lamp;
    double noise;
  } cases[] = {{5e-6, 0.5, "LED-B3", 0.02}, {5e-6, 0.2, "LED-B3", 0.02}, {8e-6, 0.4, "D65", 0.02},
               {8e-6, 0.55, "589nm", 0.05}, {12e-6, 0.3, "A", 0.02},     {6e-6, 0.5, "D65", 0.2}};
  for (const auto& c : cases) {
    if (!test::is_thorough() && (c.fraction == 0.2 || c.fraction == 0.3)) continue;
    const CoronaFit f = fit(corona_picture(c.radius, c.fraction, c.lamp, c.noise), c.lamp);
    std::printf("%-7s noise %.2f: radius %.1f -> %.3f +- %.3f um (%+.2f %%), Fa %.2f -> %.3f +- %.3f\n",
                c.lamp, c.noise, c.radius * 1e6, f.radius * 1e6, f.radius_error * 1e6,
                100 * (f.radius / c.radius - 1), c.fraction, f.area_fraction, f.area_fraction_error);
    EXPECT_NEAR(f.radius, c.radius, 0.03 * c.radius);
    EXPECT_NEAR(f.area_fraction, c.fraction, 0.05);
    EXPECT_NEAR(f.radius, c.radius, 4 * f.radius_error + 1e-3 * c.radius);
    EXPECT_NEAR(f.area_fraction, c.fraction, 4 * f.area_fraction_error + 5e-3);
    EXPECT_LT(f.radius_error, 0.05 * c.radius);
  }
}

TEST(CoronaFit, ErrorsAreThoseOfRepeatedPictures) {
  // The standard error against the scatter of pictures with other noise.
  double sum = 0, square = 0, stated = 0;
  const int kCount = test::effort(4, 10);
  const Image clean = corona_picture(5e-6, 0.5, "LED-B3", 0);
  for (int i = 0; i < kCount; ++i) {
    Image image = clean;
    std::mt19937 random(50 + unsigned(i));
    std::normal_distribution<float> normal;
    for (float& v : image.pixels) v += 0.15f * normal(random);
    const CoronaFit f = fit(image, "LED-B3");
    sum += f.radius, square += f.radius * f.radius, stated += f.radius_error / kCount;
  }
  const double scatter = std::sqrt((square - sum * sum / kCount) / (kCount - 1));
  std::printf("standard error of the radius: stated %.4f um, scatter %.4f um\n", stated * 1e6, scatter * 1e6);
  EXPECT_GT(stated, 0.5 * scatter);
  EXPECT_LT(stated, 3 * scatter);
}

TEST(CoronaFit, DiscsInEquilibrium) {
  // The structure factor of a simulation with other random numbers than those of the table that is fitted.
  optics::HardDiscEnsemble ensemble;
  ensemble.seed = 991, ensemble.snapshots = test::effort(1200, 4800);
  const optics::SimulatedStructureFactor simulated(0.5, ensemble);
  const Image image = corona_picture(
      [&](double q) { return std::pow(optics::circle_transform(q * 8e-6), 2) * simulated.eval(q * 8e-6); },
      "D65", 0.02);
  const CoronaFit f = fit(image, "D65", 0.04, CoronaModel::Positions::equilibrium),
                  theory = fit(image, "D65", 0.04, CoronaModel::Positions::percus_yevick);
  std::printf(
      "discs in equilibrium: radius %.3f +- %.3f um, Fa %.4f +- %.4f; by theory %.3f +- %.3f, %.4f +- %.4f\n",
      f.radius * 1e6, f.radius_error * 1e6, f.area_fraction, f.area_fraction_error, theory.radius * 1e6,
      theory.radius_error * 1e6, theory.area_fraction, theory.area_fraction_error);
  EXPECT_NEAR(f.radius, 8e-6, 0.0015 * 8e-6);
  EXPECT_NEAR(f.area_fraction, 0.5, 0.003);
  EXPECT_LT(f.residual, 0.01);
  EXPECT_GT(theory.radius, 8.02e-6);  // what the theory alone would give
}

TEST(CoronaFit, SeveralSizes) {
  using namespace optics;
  const auto picture = [](std::vector<Scatterer> scatterers, double largest, double fraction) {
    ScattererMixture mixture(std::move(scatterers), largest);
    mixture.correlate_sizes(fraction, [](const HardDiscMixture& m) {
      return std::make_shared<const PartialStructureFactors>(m, 64.0);
    });
    return corona_picture([&](double q) { return mixture.eval(q * largest, 0).uncorrelated; }, "D65", 0.02);
  };
  constexpr auto kTheory = CoronaModel::Positions::percus_yevick;
  {
    // Two sizes, which were read as one of 4.4 um.
    const double second = 0.4, number = second / (5.0 * 5), first = (1 - second) / (8.0 * 8);
    const Image image = picture({{std::make_shared<EllipseAperture>(8e-6, 8e-6), first / (first + number)},
                                 {std::make_shared<EllipseAperture>(5e-6, 5e-6), number / (first + number)}},
                                8e-6, 0.45);
    const CoronaFit one = fit(image, "D65", 0.04, kTheory);
    EXPECT_GT(one.residual, kGoodResidual) << one.radius;
    const CoronaFit f = fit(image, "D65", 0.04, kTheory, CoronaSizes::two);
    std::printf(
        "two sizes: %.3f +- %.3f and %.3f +- %.3f um, share %.3f +- %.3f, Fa %.3f, RMS %.2f %% (one: %.1f %%)\n",
        f.radius * 1e6, f.radius_error * 1e6, f.second_radius * 1e6, f.second_radius_error * 1e6,
        f.second_share, f.second_share_error, f.area_fraction, 100 * f.residual, 100 * one.residual);
    EXPECT_NEAR(f.radius, 8e-6, 0.01 * 8e-6);
    EXPECT_NEAR(f.second_radius, 5e-6, 0.02 * 5e-6);
    EXPECT_NEAR(f.second_share, second, 0.03);
    EXPECT_NEAR(f.area_fraction, 0.45, 0.02);
    EXPECT_LT(f.residual, 0.01);
  }
  const double spread = 0.15;
  const SizeDistribution sizes = SizeDistribution::log_normal(spread);
  const Image image = picture({{std::make_shared<EllipseAperture>(6e-6, 6e-6), 1, 0, false, sizes}},
                              6e-6 * sizes.largest(), 0.4);
  const CoronaFit one = fit(image, "D65", 0.04, kTheory),
                  f = fit(image, "D65", 0.04, kTheory, CoronaSizes::spread);
  std::printf("spread: %.3f +- %.3f um, spread %.3f +- %.3f, Fa %.3f, RMS %.2f %% (one: %.3f um, %.1f %%)\n",
              f.radius * 1e6, f.radius_error * 1e6, f.spread, f.spread_error, f.area_fraction,
              100 * f.residual, one.radius * 1e6, 100 * one.residual);
  EXPECT_NEAR(f.radius, 6e-6, 0.02 * 6e-6);
  EXPECT_NEAR(f.spread, spread, 0.01);
  EXPECT_NEAR(f.area_fraction, 0.4, 0.03);
  EXPECT_LT(f.residual, 0.01);
  if (!test::is_thorough()) return;
  // A spread that is not there is found to be small.
  const CoronaFit none =
      fit(corona_picture(6e-6, 0.4, "D65", 0.02), "D65", 0.04, kTheory, CoronaSizes::spread);
  EXPECT_LT(none.spread, 0.02);
  EXPECT_NEAR(none.radius, 6e-6, 0.01 * 6e-6);
}

TEST(CoronaFit, OverexposedPictures) {
  // The first ring is clipped, alone or with all that it surrounds; the source is at (110, 90). The ground is
  // brighter on one side, other lamps are in the picture, or it ends within the ring.
  const Image clean = corona_picture(8e-6, 0.5, "D65", 0.02);
  const auto centre = [](const Image& image, const PictureParts& parts = {}) {
    return corona_centre(image, kClip, parts);
  };
  for (const float exposure : {1.3f, 2.f, 5.f}) {
    const auto at = centre(photograph(clean, exposure));
    std::printf("exposure %.1f: centre %.2f, %.2f\n", double(exposure), at[0], at[1]);
    EXPECT_NEAR(at[0], 110, 0.5);
    EXPECT_NEAR(at[1], 90, 0.5);
  }
  Image other = clean;
  for (int y = 150; y < 162; ++y)
    for (int x = 200; x < 212; ++x)
      for (size_t c = 0; c < 3; ++c) other.at(x, y, c) = 40;
  const auto beside = centre(photograph(other, 2));
  EXPECT_NEAR(beside[0], 110, 1);
  EXPECT_NEAR(beside[1], 90, 1);

  Image cut = clean;  // the left border at x = 90
  cut.width = 150, cut.pixels.clear();
  for (int y = 0; y < clean.height; ++y)
    for (int x = 90; x < clean.width; ++x)
      for (size_t c = 0; c < 3; ++c) cut.pixels.push_back(clean.at(x, y, c));
  const auto at_border = centre(photograph(cut, 2));
  std::printf("at the border: %.2f, %.2f\n", at_border[0], at_border[1]);
  EXPECT_NEAR(at_border[0], 20, 1);
  EXPECT_NEAR(at_border[1], 90, 1);

  const Image image = photograph(clean, 2);
  const PinholeCamera camera{std::tan(0.04 * kDegree), 0.5 * image.width, 0.5 * image.height};
  const auto at = centre(image);
  const ScatteredProfile p = scattered_profile(image, camera, camera.direction(at[0], at[1]), {}, {},
                                               6 * camera.tangent_per_pixel, kClip);
  CoronaModel model(lamp_spectrum("D65"), p.s.back(), 0, CoronaModel::Positions::percus_yevick);
  const CoronaFit f = fit_corona(p, model);
  std::printf("overexposed: radius %.3f +- %.3f um, RMS %.1f %%\n", f.radius * 1e6, f.radius_error * 1e6,
              100 * f.residual);
  EXPECT_NEAR(f.radius, 8e-6, 0.01 * 8e-6);
  EXPECT_LT(f.residual, kGoodResidual);
}

TEST(CoronaFit, NoRingIsAnError) {
  for (const double noise : {0.0, 0.05}) try {
      if (!test::is_thorough() && noise == 0) continue;
      fit(corona_picture(5e-6, 0.5, "D65", noise, 0.04, 0), "D65");
      FAIL() << noise;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("no ring is visible"), std::string::npos) << e.what();
    }
  // Glare that falls off smoothly is no corona either.
  Image glare = corona_picture(5e-6, 0.5, "D65", 0.01, 0.04, 0);
  for (int y = 0; y < glare.height; ++y)
    for (int x = 0; x < glare.width; ++x)
      for (size_t c = 0; c < 3; ++c)
        glare.at(x, y, c) += float(2 * std::exp(-std::hypot(x - 110, y - 90) / 60));
  EXPECT_THROW(fit(glare, "D65"), Error);
}

TEST(CoronaFit, RingAnglesAlone) {
  const LampSpectrum lamp = lamp_spectrum("LED-B3");
  CoronaModel model(lamp, 0.2, 0);
  model.set({6e-6, 0.45});
  // Angles from the model's own curves, on a coarser grid.
  std::string text;
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](double deg) { return model.at(std::sin(deg * kDegree))[size_t(c)]; };
    int found = 0;
    for (double a = 0.5; a < 8 && found < 2; a += 0.005) {
      const bool maximum = at(a) > at(a - 0.005) && at(a) >= at(a + 0.005);
      const bool minimum = at(a) < at(a - 0.005) && at(a) <= at(a + 0.005);
      if ((found == 0 && maximum) || (found == 1 && minimum))
        text +=
            (text.empty() ? "" : ", ") + std::to_string(a) + (maximum ? "deg:max:" : "deg:min:") + "RGB"[c],
            ++found;
    }
  }
  const CoronaFit f = fit_ring_angles(parse_ring_angles(text), lamp, 0.03, -1);
  std::printf("%s: %.3f +- %.3f um, Fa %.3f +- %.3f\n", text.c_str(), f.radius * 1e6, f.radius_error * 1e6,
              f.area_fraction, f.area_fraction_error);
  EXPECT_NEAR(f.radius, 6e-6, 0.02 * 6e-6);
  EXPECT_NEAR(f.area_fraction, 0.45, 0.03);
  EXPECT_GT(f.radius_error, 1e-3 * f.radius);

  // One sodium ring: u = 2.565 at the maximum for discs in equilibrium at an area fraction of 0.5, from a
  // simulation with other random numbers (2.548 by theory; one wavelength alone: the factor
  // 1/lambda^2 does not move it).
  const double deg = std::asin(2.565 * 589e-9 / (2 * M_PI * 7e-6)) / kDegree;
  const CoronaFit one =
      fit_ring_angles(parse_ring_angles(std::to_string(deg)), lamp_spectrum("589nm"), 0.03, -1);
  EXPECT_NEAR(one.radius, 7e-6, 0.005 * 7e-6);
  EXPECT_TRUE(one.fraction_fixed);

  EXPECT_THROW(parse_ring_angles("2.7um"), Error);
  EXPECT_THROW(parse_ring_angles("2.7deg:top"), Error);
  EXPECT_THROW(parse_ring_angles(""), Error);
  EXPECT_THROW(parse_ring_angles("-1"), Error);
  EXPECT_THROW(lamp_spectrum("LED-B33"), Error);
  EXPECT_THROW(lamp_spectrum("12nm"), Error);
}

TEST(CoronaFit, RenderedPicture) {
  const std::string scene = R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective"><float name="fov" value="14"/>
    <transform name="to_world"><lookat origin="0, 0, 0" target="0, 0, -1" up="0, 1, 0"/></transform>
    <sampler type="sobol"><integer name="sample_count" value="128"/></sampler>
    <film type="hdrfilm"><integer name="width" value="140"/><integer name="height" value="140"/>
      <string name="component_format" value="float32"/><rfilter type="box"/></film></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="2"/><translate z="-0.5"/></transform>
    <bsdf type="correlated_scatterers"><string name="radius" value="6um"/><float name="area_fraction" value="0.45"/>
      <string name="substrate" value="thindielectric"/></bsdf></shape>
  <shape type="sphere"><point name="center" x="0" y="0" z="-12"/><float name="radius" value="0.015"/>
    <emitter type="area"><spectrum name="radiance" value="1000"/></emitter></shape></scene>)";
  RenderOptions options;
  options.end = effort(64, 128);
  RenderJob job(load_scene_from_string(scene, "corona.xml"), options);
  const std::atomic<bool> stop{false};
  ASSERT_EQ(job.run(stop), RenderJob::Outcome::finished);
  const Image image = job.state().picture();
  const PinholeCamera camera{2 * std::tan(7 * kDegree) / image.width, 70, 70};
  const auto spot = brightest_spot(image);
  PaneGeometry geometry;
  geometry.pane_m = 0.5, geometry.lamp_m = 12, geometry.slab_index = 1.5046;
  const ScatteredProfile p = scattered_profile(image, camera, camera.direction(spot[0], spot[1]), {},
                                               geometry, 5 * camera.tangent_per_pixel, INFINITY);
  CoronaModel model(lamp_spectrum("E"), p.s.back(), 0.015 / 12, CoronaModel::Positions::percus_yevick);
  const CoronaFit f = fit_corona(p, model);
  std::printf("rendered: radius %.3f +- %.3f um, Fa %.3f +- %.3f\n", f.radius * 1e6, f.radius_error * 1e6,
              f.area_fraction, f.area_fraction_error);
  EXPECT_NEAR(f.radius, 6e-6, 0.03 * 6e-6);
  EXPECT_NEAR(f.area_fraction, 0.45, 0.04);
}

}  // namespace
}  // namespace aureole::test
