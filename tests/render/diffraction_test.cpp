// SPDX-License-Identifier: Apache-2.0
// Light around edges in pictures: the shadow of a half plane against Fresnel's integrals, which share no code with the
// renderer; the same light however the edge is cut; paths from the sensor against paths from the lamps.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "aureole/core/keyed_random.h"
#include "aureole/optics/faddeeva.h"
#include "aureole/render/output.h"
#include "aureole/render/plan.h"
#include "aureole/render/statistics.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "harness/rendered.h"
#include "loading/load_text.h"

namespace aureole::testing {
namespace {

using std::numbers::pi;

using test::kSanitized;

/// A black sheet that covers x < 0 at z = 0, in `pieces` along its edge, between a lamp at z = 1 m and a white screen at z = -1 m.
/// The film shows 8 mm about `middle`, by default x from -9.5 to -1.5 mm: Fresnel's numbers from -12.8 to -2.
std::string half_plane(int pieces, const std::string& width, int samples,
                       const char* middle_of_film = "-0.0055") {
  std::string sheet;
  for (int i = 0; i < pieces; ++i) {
    const double half = 5.0 / pieces, middle = -5 + half * (2 * i + 1);
    sheet += R"(<shape type="rectangle"><transform name="to_world"><scale x="5" y=")" + std::to_string(half) +
             R"("/><translate x="-5" y=")" + std::to_string(middle) +
             R"("/></transform><bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)";
  }
  return R"(<integrator type="path"><integer name="max_depth" value="3"/><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="beams"/><string name="beam_width" value=")" +
         width + R"("/></integrator>
  <sensor type="orthographic"><transform name="to_world"><scale x="0.004" y="0.004"/>
    <lookat origin=")" +
         middle_of_film + ", 0.3, -0.5\" target=\"" + middle_of_film +
         R"(, 0.3, -1" up="0, 1, 0"/></transform>
    <film type="specfilm"><integer name="width" value="8"/><integer name="height" value="2"/><rfilter type="box"/>
      <float name="wavelength_min" value="549"/><float name="wavelength_max" value="551"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="independent"><integer name="sample_count" value=")" +
         std::to_string(samples) + R"("/></sampler></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="-1"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>
  <emitter type="point"><point name="position" x="0" y="0.3" z="1"/><spectrum name="intensity" value="1"/></emitter>)" +
         sheet;
}

TEST(RenderedEdge, ShadowOfAHalfPlaneIsFresnels) {
  const Picture p = render(half_plane(1, "fresnel 0.5m", kSanitized ? 4 : 512));
  ASSERT_EQ(p.width, 8);
  if (kSanitized) return;
  for (int column = 0; column < 8; ++column) {
    // Intensities over a pixel of 1 mm, by the mean of knife edges there.
    double expected = 0;
    for (int i = 0; i < 50; ++i) {
      const double x = -1e-3 * (1.5 + 7 - column + (i + 0.5) / 50);
      expected += optics::knife_edge_intensity(0.5 * x * std::sqrt(4 / 550e-9)) / 50 * 0.25 / pi;
    }
    double mean = 0, error = 0;
    for (int row = 0; row < p.height; ++row) {
      mean += p.mean[std::size_t(row * 8 + column)] / p.height;
      error += std::pow(p.error[std::size_t(row * 8 + column)] / p.height, 2);
    }
    error = std::sqrt(error);
    std::printf("x %5.1f mm: %+.3f dB +- %.3f\n", -8.0 + column - 1.0, 10 * std::log10(mean / expected),
                10 / std::log(10.0) * error / mean);
    EXPECT_LT(error, 0.03 * mean);
    // .1 dB: Keller's coefficient against the integral, from v = -2 on.
    EXPECT_NEAR(10 * std::log10(mean / expected), 0, 0.1 + 10 / std::log(10.0) * 4 * error / mean);
  }
}

// With the default width of beams, from three widths of their spectrum on: light turns by x/(1 m), and 3/(2 k sigma) of 25 wavelengths is
// 9.5 mrad. The film shows x from -17.6 to -9.6 mm.
TEST(RenderedEdge, ShadowOfAHalfPlaneInNarrowBeams) {
  const Picture p = render(half_plane(1, "25 wavelengths", kSanitized ? 4 : 2048, "-0.0136"));
  if (kSanitized) return;
  for (int column = 0; column < 8; ++column) {
    const double nearest = 9.6 + 7 - column;  // mm
    double expected = 0;
    for (int i = 0; i < 50; ++i) {
      const double x = -1e-3 * (nearest + (i + 0.5) / 50);
      expected += optics::knife_edge_intensity(0.5 * x * std::sqrt(4 / 550e-9)) / 50 * 0.25 / pi;
    }
    double mean = 0, error = 0;
    for (int row = 0; row < p.height; ++row) {
      mean += p.mean[std::size_t(row * 8 + column)] / p.height;
      error = std::hypot(error, p.error[std::size_t(row * 8 + column)] / p.height);
    }
    const double difference = 10 * std::log10(mean / expected), noise = 10 / std::log(10.0) * error / mean;
    std::printf("from %.1f widths on: %+.3f dB +- %.3f\n", nearest / 3.183, difference, noise);
    EXPECT_LT(noise, 0.1);
    EXPECT_NEAR(difference, 0, 0.1 + 3 * noise);
  }
}

// Beside the shadow light has no fringes. Over 8 mm, Fresnel's numbers from 0 to 10.8, no light is lost or won but what goes into the shadow
// or comes from beyond.
TEST(RenderedEdge, LightBesideTheShadowOfAHalfPlane) {
  for (const char* width : {"fresnel 0.5m", "fresnel 0.05m"}) {
    const Picture p = render(half_plane(1, width, kSanitized ? 4 : 2048, "0.004"));
    if (kSanitized) continue;
    double all = 0, all_expected = 0;
    for (int column = 0; column < 8; ++column) {
      double expected = 0;
      for (int i = 0; i < 200; ++i) {
        const double x = 1e-3 * (column + (i + 0.5) / 200);
        expected += optics::knife_edge_intensity(0.5 * x * std::sqrt(4 / 550e-9)) / 200 * 0.25 / pi;
      }
      double mean = 0;
      for (int row = 0; row < p.height; ++row) mean += p.mean[std::size_t(row * 8 + column)] / p.height;
      const double difference = 10 * std::log10(mean / expected);
      std::printf("x %5.1f mm: %+.3f dB\n", 0.5 + column, difference);
      EXPECT_NEAR(difference, 0, column == 0 ? 0.6 : column == 1 ? 0.35 : 0.1) << width << " " << column;
      all += mean, all_expected += expected;
    }
    std::printf("%s: of all light %.4f +- %.4f\n", width, all / all_expected, p.all_error / p.all);
    EXPECT_NEAR(all / all_expected, 1, 0.025);
  }
}

TEST(RenderedEdge, ItsLightDoesNotDependOnHowItIsCut) {
  const auto light = [](int pieces) {
    return render(half_plane(pieces, "25 wavelengths", kSanitized ? 4 : 256));
  };
  const Picture whole = light(1);
  for (const int pieces : {7, 1000}) {
    const Picture cut = light(pieces);
    if (kSanitized) continue;
    const double error = std::hypot(whole.all_error, cut.all_error);
    EXPECT_NEAR(cut.all, whole.all, 4 * error) << pieces;
    EXPECT_LT(error, 0.035 * whole.all);
  }
}

// The first millimetre beside the shadow, whose light passes the edge within a beam of .52 mm.
TEST(RenderedEdge, WhatItTakesDoesNotDependOnHowItIsCut) {
  const auto light = [](int pieces) {
    const Picture p = render(half_plane(pieces, "fresnel 0.5m", kSanitized ? 4 : 1024, "0.004"));
    return std::pair{0.5 * (p.mean[0] + p.mean[8]), 0.5 * std::hypot(p.error[0], p.error[8])};
  };
  const auto [whole, whole_error] = light(1);
  // Without the sheet it would be 1/4 over pi.
  if (!kSanitized) {
    EXPECT_LT(whole, 0.95 * 0.25 / pi);
  }
  for (const int pieces : {7, 1000}) {
    const auto [cut, cut_error] = light(pieces);
    if (kSanitized) continue;
    const double error = std::hypot(whole_error, cut_error);
    std::printf("%d pieces: %.5f +- %.1g, one %.5f +- %.1g\n", pieces, cut, cut_error, whole, whole_error);
    EXPECT_NEAR(cut, whole, 4 * error) << pieces;
    EXPECT_LT(error, 0.035 * whole);
  }
}

// A path by way of the edge crosses a pane before the screen: that counts for the limit of segments.
TEST(RenderedEdge, PanesCountForTheLimitOfSegments) {
  const auto light = [](const char* integrator, int depth, bool has_pane, const std::string& more = "") {
    std::string scene = half_plane(1, "0.2mm", kSanitized ? 2 : 64);
    const auto put = [&](const std::string& from, const std::string& to) {
      scene.replace(scene.find(from), from.size(), to);
    };
    put("integrator type=\"path\"", "integrator type=\"" + std::string(integrator) + "\"");
    put("<integer name=\"max_depth\" value=\"3\"/>",
        "<integer name=\"max_depth\" value=\"" + std::to_string(depth) + "\"/>" + more);
    return render(
        scene + (has_pane
                     ? "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"9\"/>"
                       "<translate z=\"-0.3\"/></transform><bsdf type=\"thindielectric\"><float "
                       "name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/></bsdf></shape>"
                     : ""));
  };
  const double through = 1 - 2 * 0.04 / 1.04;  // of a pane of 1.5, straight on
  for (const char* integrator : {"path", "bdpt"}) {
    const Picture open = light(integrator, 3, false);
    // The lamp sends next to nothing there straight on.
    EXPECT_LT(light(integrator, 3, true).all, 1e-6 * open.all) << integrator;
    for (const Picture& behind :
         {light(integrator, 4, true),
          light(integrator, 3, true, "<boolean name=\"count_crossings\" value=\"false\"/>")}) {
      if (kSanitized) continue;
      EXPECT_NEAR(behind.all, through * open.all, 4.5 * std::hypot(behind.all_error, open.all_error))
          << integrator;
      EXPECT_LT(behind.all_error, 0.1 * behind.all) << integrator;
    }
  }
}

// A square of 2 mm off the axis in the shadow of a disc or ball of 2 mm radius between a lamp and a screen. The light there is that of
// tests/render/references/disc_shadow.py, .01731 of what it is without an obstacle.
TEST(RenderedEdge, ShadowsOfADiscAndABallAreRound) {
  const auto light = [](const char* shape, int samples) {
    return render(
        R"(<integrator type="path"><integer name="max_depth" value="3"/><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="beams"/><string name="beam_width" value="0.2mm"/></integrator>
  <sensor type="orthographic"><transform name="to_world"><scale x="0.001" y="0.001"/>
    <lookat origin="0.0012, 0.0012, -0.5" target="0.0012, 0.0012, -1" up="0, 1, 0"/></transform>
    <film type="specfilm"><integer name="width" value="4"/><integer name="height" value="4"/><rfilter type="box"/>
      <float name="wavelength_min" value="549"/><float name="wavelength_max" value="551"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="independent"><integer name="sample_count" value=")" +
        std::to_string(samples) + R"("/></sampler></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="-1"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>
  <emitter type="point"><point name="position" x="0" y="0" z="1"/><spectrum name="intensity" value="1"/></emitter>
  <shape type=")" +
        shape +
        R"("><transform name="to_world"><scale value="0.002"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)");
  };
  constexpr double kExpected = 0.01731 * 0.25 / pi;
  for (const auto& [shape, samples] : {std::pair{"disk", 32}, std::pair{"sphere", 64}}) {
    const Picture p = light(shape, kSanitized ? 1 : samples);
    if (kSanitized) continue;
    std::printf("%s: %.4f +- %.4f of the light\n", shape, p.all / kExpected, p.all_error / kExpected);
    // 3 %: beams are not short against the first zone of Fresnel, whose curvature K leaves out.
    EXPECT_NEAR(p.all, kExpected, 0.03 * kExpected + 4 * p.all_error) << shape;
    EXPECT_LT(p.all_error, 0.05 * kExpected) << shape;
  }
}

/// The transform of a polygon by its edges: the integral of exp(-i q.x) over it.
std::complex<double> polygon_transform(const std::vector<std::array<double, 2>>& v, double qx, double qy) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto &a = v[i], &b = v[(i + 1) % v.size()];
    const double ex = b[0] - a[0], ey = b[1] - a[1], half = 0.5 * (qx * ex + qy * ey);
    const double sinc = std::abs(half) > 1e-9 ? std::sin(half) / half : 1;
    sum += (qx * ey - qy * ex) * sinc * std::polar(1.0, -0.5 * (qx * (a[0] + b[0]) + qy * (a[1] + b[1])));
  }
  return sum * std::complex<double>(0, 1) / (qx * qx + qy * qy);
}

// A hole like a star, 2 mm wide, 30 m from a lamp and from a screen: beams are as wide as it, so that the light is made of
// the waves of all its edges.
TEST(RenderedEdge, FarFieldOfAStarIsFraunhofers) {
  constexpr double kDistance = 3e4, kHalf = 75, kWavelength = 550e-6;  // mm
  constexpr int kPixels = 10;
  const Picture p = render(
      R"(<string name="length_unit" value="mm"/><integrator type="path"><integer name="max_depth" value="3"/>
      <boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="fresnel 15m"/></integrator>
    <sensor type="orthographic"><transform name="to_world"><scale x="75" y="75"/>
      <lookat origin="0, 0, -29990" target="0, 0, -30000" up="0, 1, 0"/></transform>
      <film type="specfilm"><integer name="width" value="10"/><integer name="height" value="10"/><rfilter type="box"/>
        <float name="wavelength_min" value="549.5"/><float name="wavelength_max" value="550.5"/>
        <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
      <sampler type="independent"><integer name="sample_count" value=")" +
      std::string(kSanitized ? "2" : "160") + R"("/></sampler></sensor>
    <shape type="obj"><string name="filename" value=")" +
      (test::source_dir() / "scenes/diffraction/star.obj").string() + R"("/>
      <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><scale value="2000"/><translate z="-30000"/></transform>
      <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>
    <emitter type="point"><point name="position" x="0" y="0" z="30000"/><spectrum name="intensity" value="1e12"/></emitter>)");
  if (kSanitized) return;
  std::vector<std::array<double, 2>> star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? 1 : 0.42, a = pi / 2 + pi * i / 5;
    star.push_back({r * std::cos(a), r * std::sin(a)});
  }
  double squares = 0, middle = 0, middle_expected = 0, middle_error = 0;
  int compared = 0;
  for (int row = 0; row < kPixels; ++row)
    for (int column = 0; column < kPixels; ++column) {
      constexpr int kSub = 40;
      double expected = 0, nearest = 1e9;
      for (int i = 0; i < kSub * kSub; ++i) {
        const double x = ((column + (i % kSub + 0.5) / kSub) * 2 / kPixels - 1) * kHalf,
                     y = (1 - (row + (i / kSub + 0.5) / kSub) * 2 / kPixels) * kHalf,
                     k = 2 * pi / kWavelength;
        nearest = std::min(nearest, std::hypot(x, y));
        expected += std::norm(polygon_transform(star, k * x / kDistance, k * y / kDistance)) / (kSub * kSub);
      }
      expected *= 1e12 / (kDistance * kDistance) / std::pow(kWavelength * kDistance, 2) / pi;
      const std::size_t at = std::size_t(row * kPixels + column);
      // Places in the middle have the light straight on besides, which the far field has not yet spread out.
      if (nearest < 0.15 * kHalf) {
        middle += p.mean[at], middle_expected += expected,
            middle_error = std::hypot(middle_error, p.error[at]);
        continue;
      }
      EXPECT_NEAR(p.mean[at], expected, 6 * p.error[at] + 0.15 * expected) << column << ", " << row;
      EXPECT_LT(p.error[at], 0.5 * expected) << column << ", " << row;
      squares += std::pow(p.mean[at] / expected - 1, 2), ++compared;
    }
  std::printf("star: %d places, rms difference %.3f of the intensity\n", compared,
              std::sqrt(squares / compared));
  std::printf("star: middle %.4g +- %.2g, expected %.4g\n", middle, middle_error, middle_expected);
  EXPECT_NEAR(middle, middle_expected, 4 * middle_error);
  EXPECT_LT(middle_error, 0.2 * middle_expected);
  EXPECT_GT(compared, 80);
}

class RenderedEdges : public ::testing::TestWithParam<const char*> {};

TEST_P(RenderedEdges, AreTheSameFromBothEnds) {
  const auto file =
      test::source_dir() / "tests/render/scenes" / (std::string("diffraction-") + GetParam() + ".xml");
  const auto luminance = [&](const char* integrator, const char* diffraction) {
    LoadOptions load;
    load.defines = {{"integrator", integrator}, {"diffraction", diffraction}};
    RenderOptions options;
    options.replicates = kSanitized ? 2 : 40;
    if (kSanitized) options.end = 2;
    options.seed = integrator[1] == 'a' ? 1 : 2;
    return render(load_scene(file, load), options);
  };
  const Picture a = luminance("path", "true"), b = luminance("ptracer", "true"),
                off = luminance("path", "false");
  if (kSanitized) return;
  const double error = std::hypot(a.all_error, b.all_error);
  std::printf("%s: path %.6g +- %.2g, ptracer %.6g +- %.2g, without diffraction %.6g\n", GetParam(), a.all,
              a.all_error, b.all, b.all_error, off.all);
  EXPECT_NEAR(a.all, b.all, 4 * error);
  EXPECT_LT(error, 0.03 * a.all);
  EXPECT_GT(largest_difference(a, off), 5);  // there is diffracted light to compare
}

INSTANTIATE_TEST_SUITE_P(All, RenderedEdges, ::testing::Values("sheet", "block"),
                         [](const auto& info) { return std::string(info.param); });

/// A square sheet of half side 1 and a block beside it, in a scene with 1 um as its unit of length.
std::shared_ptr<const Scene> sheet_and_block() {
  return load_scene_from_string(
             R"(<scene version="3.0.0"><string name="length_unit" value="1um"/>
               <integrator type="path"><boolean name="diffraction" value="true"/>
                 <string name="diffraction_model" value="beams"/><string name="beam_width" value="4 wavelengths"/></integrator>
               <sensor type="perspective"><film type="hdrfilm"/></sensor>
               <shape type="rectangle"><transform name="to_world"><scale value="100"/></transform></shape>
               <shape type="cube"><transform name="to_world"><scale value="30"/><translate x="200" z="10"/></transform></shape>
               <shape type="rectangle"><bsdf type="null"/></shape>
               <emitter type="point"/></scene>)",
             "edges.xml")
      .scene;
}

Wavelengths some_wavelengths(const Scene& scene) {
  return Wavelengths::at(scene.parts().context->grid,
                         make_spectrum([](int i) { return 420 + 35.f * float(i); }));
}

TEST(SceneEdges, BelongToSurfacesThatStopLight) {
  const auto scene = sheet_and_block();
  ASSERT_TRUE(scene->diffraction());
  EXPECT_EQ(scene->diffraction()->edges().index().edges().size(), 4u + 12u);
  EXPECT_FALSE(
      load_scene_from_string(
          "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\"/></scene>",
          "none.xml")
          .scene->diffraction());
}

// The density of places is that of the samples: means of f/p over samples are integrals over all edges.
TEST(SceneEdges, PlacesHaveTheirDensity) {
  const auto scene = sheet_and_block();
  const SceneEdges& edges = scene->diffraction()->edges();
  const auto beams = edges.beams(some_wavelengths(*scene));
  const PathEnd a{{300, -80, -400}}, lamps[] = {{{-50, 20, 500}}, {normalize(Vec3{0.1f, 0.2f, 1}), true}};
  KeyedRandom random(1);
  const auto next = [&] { return random.next(); };
  // Half of the places are chosen as if lamps shone on parts of the edges.
  std::vector<float> parts(edges.index().edges().size());
  for (float& part : parts) part = 0.03f + 0.97f * next();
  const std::vector<float> lit = edges.tree().of_nodes(parts);
  const auto lit_or_not = [&](int i) { return i % 2 ? lit.data() : nullptr; };
  double length_from = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const float u[3] = {next(), next(), next()};
    if (const auto x = edges.choose_from(a, u, nullptr, lit_or_not(i))) length_from += 1 / double(x->pdf) / n;
  }
  EXPECT_NEAR(length_from, 4 * 200 + 12 * 60, 0.02 * 1520);
  for (const PathEnd& lamp : lamps) {
    // The diffracted light itself, by the density and by even places on all edges.
    double sum = 0, even = 0, squares = 0, even_squares = 0;
    const auto light = [&](const EdgePoint& x) {
      const Vec3 to_a = a.p - x.on_edge(), to_b = lamp.is_infinite ? lamp.p : normalize(lamp.p - x.on_edge());
      return double(mean(edges.kernel(x, -to_b, normalize(to_a), beams, {}))) / length_squared(to_a);
    };
    for (int i = 0; i < n; ++i) {
      const float u[4] = {next(), next(), next(), next()};
      if (const auto between = edges.choose_between(a, lamp, beams, u, lit_or_not(i))) {
        const EdgePoint x = edges.place_between(*between, a, lamp, beams, u + 2);
        const double f = light(x) / x.pdf;
        sum += f / n, squares += f * f / n;
      }
      const auto& all = edges.index().edges();
      const MeshEdge& edge = all[std::min(std::size_t(next() * float(all.size())), all.size() - 1)];
      const EdgeLine line(edge);
      EdgePoint y{&edge, next() * line.length, {}, {}, 1};
      y.x = line.at(y.at);
      const double f = light(y) * line.length * double(all.size());
      even += f / n, even_squares += f * f / n;
    }
    const double error = std::sqrt((squares - sum * sum) / n),
                 even_error = std::sqrt((even_squares - even * even) / n);
    EXPECT_NEAR(sum, even, 4 * std::hypot(error, even_error));
    EXPECT_LT(even_error, 0.15 * even);
    EXPECT_LT(error, 0.02 * sum);
  }
}

// One of two blocks lies in the shadow of a screen: its edges have a small probability for that light, not zero.
TEST(SceneEdges, ThoseInShadowAreSeldomChosen) {
  const auto scene = load_scene_from_string(
                         R"(<scene version="3.0.0"><string name="length_unit" value="1um"/>
            <integrator type="path"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/></integrator>
            <sensor type="perspective"><film type="hdrfilm"/></sensor>
            <shape type="cube"><transform name="to_world"><scale value="30"/><translate x="200"/></transform></shape>
            <shape type="cube"><transform name="to_world"><scale value="30"/><translate x="-200"/></transform></shape>
            <shape type="disk"><transform name="to_world"><scale value="190"/><translate x="-100" z="500"/></transform>
              <bsdf type="diffuse"/></shape>
            <emitter type="point"><point name="position" x="0" y="0" z="1000"/></emitter></scene>)",
                         "shadow.xml")
                         .scene;
  const Light& lamp = scene->emitters().front();
  const LitEdges::Lamp* known = scene->diffraction()->lit_edges().from(lamp, 0);
  ASSERT_NE(known, nullptr);
  const float* lit = known->lit.data();
  KeyedRandom random(1);
  int chosen[2] = {};
  for (int i = 0; i < 20000; ++i) {
    const float u[3] = {random.next(), random.next(), random.next()};
    const auto x = scene->diffraction()->edges().choose_from({{0, 0, 1000}}, u, nullptr, lit);
    if (x && std::abs(x->p.x) > 150 && x->p.z < 100) ++chosen[x->p.x > 0];
  }
  EXPECT_GT(chosen[0], 30);
  EXPECT_GT(chosen[1], 5 * chosen[0]);
}

TEST(SceneEdges, DirectionsHaveTheirDensityAndKIsReciprocal) {
  const auto scene = sheet_and_block();
  const SceneEdges& edges = scene->diffraction()->edges();
  const auto beams = edges.beams(some_wavelengths(*scene));
  const MeshEdge& edge = edges.index().edges()[0];
  const EdgeLine line(edge);
  for (const double at : {0.5, 0.02}) {
    EdgePoint x{&edge, at * line.length, {}, {}, 1};
    x.x = line.at(x.at);
    for (const Vec3& d_i : {normalize(Vec3{0.1f, 0.2f, -1}), normalize(Vec3{0.6f, 0.5f, -0.4f})}) {
      KeyedRandom random(7);
      double whole = 0, near = 0, sampled = 0;
      const auto is_near = [&](const Vec3& d) { return dot(d, d_i) > std::cos(0.05); };
      // Quadrature over the cosine with the edge and the azimuth about it.
      const Double3 e = line.direction;
      Double3 s, t;
      make_basis(e, s, t);
      const int cosines = 1200, azimuths = 900;
      for (int c = 0; c < cosines; ++c)
        for (int k = 0; k < azimuths; ++k) {
          const double z = -1 + (c + 0.5) * 2 / cosines, r = std::sqrt(1 - z * z),
                       phi = (k + 0.5) * 2 * pi / azimuths;
          const Vec3 d = (e * z + s * (r * std::cos(phi)) + t * (r * std::sin(phi))).to_float();
          const double p = edges.scatter_pdf(x, d_i, d, beams) * (2.0 / cosines) * (2 * pi / azimuths);
          whole += p;
          if (is_near(d)) near += p;
        }
      EXPECT_NEAR(whole, 1, 0.01);
      const int n = 20000;
      for (int i = 0; i < n; ++i) {
        const float u[4] = {random.next(), random.next(), random.next(), random.next()};
        const auto direction = edges.scatter(x, d_i, beams, u);
        if (!direction) continue;
        EXPECT_NEAR(length(direction->d), 1, 1e-5);
        if (is_near(direction->d)) sampled += 1.0 / n;
        const Spectrum there = edges.kernel(x, d_i, direction->d, beams, {}),
                       back = edges.kernel(x, -direction->d, -d_i, beams, {});
        if (i < 2000) {
          for (int k = 0; k < kWavelengths; ++k)
            EXPECT_NEAR(there[k], back[k], 1e-4 * std::abs(there[k]) + 1e-9f) << at;
        }
      }
      EXPECT_NEAR(sampled, near, 5 * std::sqrt(near / n) + 0.01);
      EXPECT_GT(near, 0.05);
    }
  }
}

/// K of a place on an edge in light along -z, over the directions along the edge, over Keller's coefficient, at all wavelengths.
Spectrum kernel_over_kellers(const SceneEdges& edges, const EdgePoint& x, double theta,
                             const SceneEdges::Beams& beams, const Wavelengths& w) {
  const Vec3 e = EdgeLine(*x.edge).direction.to_float(), d_i{0, 0, -1}, across = normalize(cross(e, d_i));
  Spectrum sum = 0.f;
  const double step = 0.05 * beams.angle;
  for (double s = -8.0 * beams.angle; s < 8.0 * beams.angle; s += step) {
    const Vec3 d = normalize(d_i * float(std::cos(theta)) + across * float(std::sin(theta)) + e * float(s));
    sum += edges.kernel(x, d_i, d, beams, {}) * float(step);
  }
  // 2 sin(theta/2) is the angle of the symmetric kernel.
  const double turn = 2 * std::sin(theta / 2);
  return sum * float(4 * pi * pi * turn * turn) / (w.nm * 1e-3f);
}

// Over the directions along a straight edge K is Keller's coefficient, from three widths of the beam's own spectrum on.
TEST(SceneEdges, KOfAStraightEdgeIsKellers) {
  const auto scene = sheet_and_block();
  const SceneEdges& edges = scene->diffraction()->edges();
  const Wavelengths w = some_wavelengths(*scene);
  const auto beams = edges.beams(w);
  const MeshEdge& edge = edges.index().edges()[0];
  const EdgeLine line(edge);
  EdgePoint x{&edge, 0.5 * line.length, {}, {}, 1};
  x.x = line.at(x.at);
  ASSERT_TRUE(beams.achromatic);
  for (const double theta :
       {3.05 * beams.angle, 4.0 * beams.angle, 6.0 * beams.angle, 15.0 * beams.angle, 0.3, 0.6}) {
    const Spectrum ratio = kernel_over_kellers(edges, x, theta, beams, w);
    for (int k = 0; k < kWavelengths; ++k)
      EXPECT_NEAR(ratio[k], 1, 0.01) << theta / double(beams.angle) << " widths";
  }
}

// K near a corner and beside a parallel edge: `mean_edge_kernel` alone is 16 % less at three widths, 5 % at six.
TEST(SceneEdges, KNearCornersAndParallelEdgesIsNearlyKellers) {
  const auto scene = load_scene_from_string(
                         R"(<scene version="3.0.0"><string name="length_unit" value="1um"/>
<integrator type="path"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="10um"/></integrator>
<sensor type="orthographic"><film type="hdrfilm"><float name="wavelength_min" value="549"/><float name="wavelength_max" value="551"/>
<string name="response" value="uniform"/></film></sensor>
<shape type="rectangle"><transform name="to_world"><scale x="100" y="25"/></transform></shape></scene>)",
                         "plate.xml")
                         .scene;
  const SceneEdges& edges = scene->diffraction()->edges();
  const Wavelengths w = Wavelengths::at(scene->parts().context->grid, 550.f);
  const auto beams = edges.beams(w);
  const double sigma = 10;
  for (const MeshEdge& edge : edges.index().edges()) {
    const EdgeLine line(edge);
    for (const double r : {1.0, 2.0, 4.0, 7.0}) {
      if (r * sigma > 0.5 * line.length) continue;
      EdgePoint x{&edge, r * sigma, {}, {}, 1};
      x.x = line.at(x.at);
      for (const double theta : {3.05, 4.0, 6.0, 15.0})
        // The parallel edges are 5 sigma apart: their waves' interference is 4 % of K.
        EXPECT_NEAR(kernel_over_kellers(edges, x, theta * double(beams.angle), beams, w)[0], 1,
                    r > 3   ? 0.05
                    : r > 1 ? 0.1
                            : 0.15)
            << "at " << r << " sigma of an edge of " << line.length / sigma << ", " << theta << " widths";
    }
  }
}

TEST(BeamWidth, IsReadWithItsUnit) {
  EXPECT_DOUBLE_EQ(BeamWidth::parse("25").at(1e-6), 25e-6);
  EXPECT_DOUBLE_EQ(BeamWidth::parse("10 wavelengths").at(1e-6), 10e-6);
  EXPECT_DOUBLE_EQ(BeamWidth::parse("3mm").at(1e-6), 3e-3);
  EXPECT_DOUBLE_EQ(BeamWidth::parse("fresnel 4m").at(1e-6), 2e-3);
  for (const char* bad :
       {"", "0", "-3", "0.1", "nan", "3 parsecs", "fresnel", "fresnel 3", "fresnel -2m", "wavelengths"})
    EXPECT_THROW(BeamWidth::parse(bad), Error) << bad;
  const std::string message =
      test::errors_of_file(
          "<scene version=\"3.0.0\">\n<integrator type=\"path\"><string name=\"diffraction_model\" value=\"beams\"/><string name=\"beam_width\" value=\"3 parsecs\"/></integrator>"
          "<sensor type=\"perspective\"/></scene>")
          .at(0);
  EXPECT_NE(message.find("beam_width"), std::string::npos) << message;
  EXPECT_NE(message.find(":2"), std::string::npos) << message;
}

}  // namespace
}  // namespace aureole::testing
