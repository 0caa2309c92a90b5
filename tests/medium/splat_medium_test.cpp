// SPDX-License-Identifier: Apache-2.0
// Gaussian splats as a medium, against quadrature and closed forms.
#include "aureole/medium/splats/splat_medium.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "aureole/loading/load.h"
#include "aureole/render/plan.h"
#include "harness/properties_builder.h"
#include "harness/rendered.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

std::vector<PlainSplat> overlapping(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<PlainSplat> splats;
  for (int i = 0; i < count; ++i) {
    PlainSplat s;
    for (double& x : s.position) x = 0.6 * normal(random);
    for (double& x : s.scale) x = 0.1 * std::exp(0.6 * normal(random));
    for (double& x : s.rotation) x = normal(random);
    s.opacity = 0.05 + 0.9 * unit(random);
    splats.push_back(s);
  }
  return splats;
}

std::shared_ptr<const SplatMedium> medium_of(const std::filesystem::path& file,
                                             const std::string& parameters = "") {
  return testing::build<SplatMedium>(R"(<medium type="splats"><string name="filename" value="s.ply"/>
      <string name="file_axes" value="RUB"/>)" +
                                         parameters + "</medium>",
                                     testing::make_context(), [&](const std::string&) { return file; });
}

/// Extinction at a point by its definition: all splats, with the inverse of the rotation as its transpose.
double extinction_at(const std::vector<PlainSplat>& splats, const std::array<double, 3>& p,
                     bool along_mean = false) {
  double sum = 0;
  for (const PlainSplat& s : splats) {
    auto [w, x, y, z] = s.rotation;
    const double l = std::sqrt(w * w + x * x + y * y + z * z);
    w /= l, x /= l, y /= l, z /= l;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    double d2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      double v = 0;
      for (std::size_t i = 0; i < 3; ++i) v += r[i][k] * (p[i] - s.position[i]);
      d2 += v * v / (s.scale[k] * s.scale[k]);
    }
    if (d2 > 9) continue;
    const double along = along_mean ? std::cbrt(s.scale[0] * s.scale[1] * s.scale[2])
                                    : std::min({s.scale[0], s.scale[1], s.scale[2]});
    sum += -std::log(1 - s.opacity) / (along * std::sqrt(2 * M_PI) * std::erf(3 / std::sqrt(2.))) *
           std::exp(-0.5 * d2);
  }
  return sum;
}

TEST(SplatMedium, ExtinctionIsTheSumOfGaussians) {
  const SplatFolder folder;
  const auto splats = overlapping(80, 4);
  const auto file = folder.write("s.ply", make_ply(splats));
  // Bounds hold also where the transform makes axes of splats oblique.
  const auto sheared = medium_of(
      file,
      R"(<transform name="to_world"><rotate x="1" y="1" angle="40"/><scale x="0.3" y="1" z="2"/></transform>)");
  std::mt19937 places(16);
  std::normal_distribution<float> spread(0, 0.8f);
  for (int i = 0; i < 4000; ++i) {
    const Vec3 p{spread(places), spread(places), spread(places)};
    EXPECT_LE(sheared->field().at(p).extinction, sheared->majorants().bound_at(p) * 1.00001f);
  }
  for (const bool along_mean : {false, true}) {
    const auto medium = medium_of(file, along_mean ? R"(<string name="opacity_along" value="mean"/>)" : "");
    const Majorants majorants = medium->majorants();
    std::mt19937 random(6);
    std::normal_distribution<float> normal(0, 0.6f);
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 p{normal(random), normal(random), normal(random)};
      const double expected = extinction_at(splats, {double(p.x), double(p.y), double(p.z)}, along_mean);
      const float found = medium->field().at(p).extinction;
      inside += expected > 0;
      EXPECT_NEAR(found, expected, 0.002 * expected + 0.05)
          << i;  // a splat may end within the rounding of a point
      EXPECT_LE(double(found), double(majorants.bound_at(p)) * 1.00001);
    }
    EXPECT_GT(inside, 1500);
  }
}

TEST(SplatMedium, ThicknessIsTheIntegralOfTheExtinction) {
  const SplatFolder folder;
  const auto splats = overlapping(60, 9);
  const auto medium = medium_of(folder.write("s.ply", make_ply(splats)));
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  double most = 0;
  for (int i = 0; i < 40; ++i) {
    const std::array<double, 3> o{normal(random), normal(random), normal(random)};
    std::array<double, 3> d{normal(random), normal(random), normal(random)};
    const double l = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]),
                 t_max = 0.5 + 2 * std::abs(normal(random));
    for (double& x : d) x /= l;
    // The midpoint rule with 20,000 steps; its error is that of the cut at three standard deviations.
    constexpr int kSteps = 20000;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double t = t_max * (k + 0.5) / kSteps;
      sum += extinction_at(splats, {o[0] + d[0] * t, o[1] + d[1] * t, o[2] + d[2] * t}) * t_max / kSteps;
    }
    const Ray ray{{float(o[0]), float(o[1]), float(o[2])}, {float(d[0]), float(d[1]), float(d[2])}};
    EXPECT_NEAR(medium->field().optical_thickness(ray, float(t_max)), sum, 2e-4 * (1 + sum)) << i;
    most = std::max(most, sum);
  }
  EXPECT_GT(most, 1);
}

TEST(SplatMedium, DistancesInvertTheThickness) {
  const SplatFolder folder;
  const auto medium = medium_of(folder.write("s.ply", make_ply(overlapping(60, 9))));
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  int reached = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{{normal(random), normal(random), normal(random)},
                  normalize(Vec3{normal(random), normal(random), normal(random)})};
    const double whole = medium->optical_thickness(ray, 3), wanted = 1.3 * whole * unit(random);
    const float t = medium->distance_of_thickness(ray, 3, wanted);
    if (wanted >= whole) {
      EXPECT_EQ(t, kInfinity);
      continue;
    }
    EXPECT_NEAR(medium->optical_thickness(ray, t), wanted, 1e-5 * (1 + wanted)) << i;
    ++reached;
  }
  EXPECT_GT(reached, 60);
}

TEST(SplatMedium, ScatteredLightIsThatOfACellOfVoxels) {
  // One wide splat of albedo 0.8 lights as its Gaussian sampled at the voxels of a grid does, which null collisions follow.
  const SplatFolder folder;
  PlainSplat s;
  s.scale = {0.5, 0.5, 0.5}, s.opacity = 0.85;
  const double encoded = 1.055 * std::pow(0.8, 1 / 2.4) - 0.055;
  s.color = {encoded, encoded, encoded};
  const auto file = folder.write("s.ply", make_ply({s}));
  constexpr int kSide = 96;
  std::string voxels(kSide * kSide * kSide * 4, 0);
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const auto at = [&](int k) { return 3.2 * (k + 0.5) / kSide - 1.6; };
    const float density =
        float(extinction_at({s}, {at(i % kSide), at(i / kSide % kSide), at(i / kSide / kSide)}));
    std::memcpy(&voxels[std::size_t(4 * i)], &density, 4);
  }
  std::string vol = std::string("VOL\3", 4);
  const auto add = [&](auto v) { vol.append(reinterpret_cast<const char*>(&v), sizeof v); };
  add(std::int32_t(1)), add(std::int32_t(kSide)), add(std::int32_t(kSide)), add(std::int32_t(kSide)),
      add(std::int32_t(1));
  for (int k = 0; k < 6; ++k) add(k < 3 ? -1.6f : 1.6f);
  const auto grid = folder.write("g.vol", vol + voxels);
  const auto lit = [&](const std::string& medium, const std::string& integrator, const std::string& light) {
    return testing::render(
        R"(<integrator type=")" + integrator +
        R"("/><sensor type="radiancemeter"><vector name="origin" x="0.2" y="-0.1" z="-4"/><vector name="direction" x="0" y="0" z="1"/>
      <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
      <sampler type="sobol"><integer name="sample_count" value="4096"/></sampler></sensor>)" +
        light +
        R"(<shape type="cube"><transform name="to_world"><scale value="1.6"/></transform><bsdf type="null"/>)" +
        medium + "</shape>");
  };
  const std::string splats = R"(<medium type="splats" name="interior"><string name="filename" value=")" +
                             file.string() + R"("/><string name="file_axes" value="RUB"/></medium>)",
                    field = R"(<medium type="heterogeneous" name="interior"><float name="albedo" value="0.8"/>
      <volume type="gridvolume" name="sigma_t"><string name="filename" value=")" +
                            grid.string() + R"("/><transform name="to_world"><scale value="3.2"/>
      <translate x="-1.6" y="-1.6" z="-1.6"/></transform></volume></medium>)";
  const std::string lights[] = {
      R"(<emitter type="point"><point name="position" x="1" y="2" z="-1.5"/><float name="intensity" value="9"/></emitter>)",
      R"(<emitter type="constant"><float name="radiance" value="1"/></emitter>)",
      R"(<shape type="sphere"><point name="center" x="0.5" y="0.6" z="0.4"/><float name="radius" value="0.15"/>
       <bsdf type="diffuse"/><emitter type="area"><float name="radiance" value="20"/></emitter></shape>)"};
  for (const std::string& light : lights) {
    const auto expected = lit(field, "path", light), found = lit(splats, "path", light);
    EXPECT_GT(expected.all, 0.05);
    EXPECT_NEAR(found.all, expected.all,
                4.5 * std::hypot(found.all_error, expected.all_error) + 0.003 * expected.all)
        << light;
    const auto two_way = lit(splats, "bdpt", light);
    if (light.find("constant") == std::string::npos) {
      EXPECT_NEAR(two_way.all, expected.all,
                  4.5 * std::hypot(two_way.all_error, expected.all_error) + 0.003 * expected.all)
          << light;
    }
  }
}

TEST(SplatMedium, OneSplatHasItsOpacityThroughItsCentre) {
  const SplatFolder folder;
  PlainSplat s;
  s.scale = {0.4, 0.2, 0.1}, s.opacity = 0.7;
  const auto file = folder.write("s.ply", make_ply({s}));
  const auto opacity = [&](const Vec3& d, const std::string& parameters = "") {
    return -std::expm1(-medium_of(file, parameters)->field().optical_thickness({d * -5.f, d}, 10));
  };
  EXPECT_NEAR(opacity({0, 0, 1}), 0.7, 1e-5);
  EXPECT_NEAR(opacity({1, 0, 0}), 1 - std::pow(0.3, 4), 1e-5);
  const std::string mean = R"(<string name="opacity_along" value="mean"/>)";
  EXPECT_NEAR(opacity({0, 1, 0}, mean), 0.7, 1e-5);
  EXPECT_NEAR(opacity({0, 1, 0}, mean + R"(<float name="extinction_scale" value="2"/>)"), 1 - 0.3 * 0.3,
              1e-5);
  // Turned and doubled, it is as opaque.
  EXPECT_NEAR(
      opacity({0, 1, 0},
              R"(<transform name="to_world"><rotate x="1" angle="90"/><scale value="2"/></transform>)"),
      0.7, 1e-5);
}

/// A scene with a white environment, seen along z through splats that absorb.
std::string seen_through(const std::filesystem::path& file, const std::string& integrator) {
  return R"(<integrator type=")" + integrator +
         R"("/><sensor type="radiancemeter"><vector name="origin" x="0.05" y="-0.02" z="-4"/><vector name="direction" x="0" y="0" z="1"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="2048"/></sampler></sensor>
    <emitter type="constant"><float name="radiance" value="1"/></emitter>
    <shape type="cube"><transform name="to_world"><scale value="3"/></transform><bsdf type="null"/>
    <medium type="splats" name="interior"><string name="filename" value=")" +
         file.string() + R"("/><string name="file_axes" value="RUB"/></medium></shape>)";
}

TEST(SplatMedium, PathsPassByTheClosedForm) {
  const SplatFolder folder;
  auto splats = overlapping(30, 12);
  for (auto& s : splats) s.opacity *= 0.4, s.color = {0, 0, 0};  // black: light is absorbed
  const auto file = folder.write("s.ply", make_ply(splats));
  const auto medium = medium_of(file);
  const double expected = std::exp(-medium->field().optical_thickness({{0.05f, -0.02f, -4}, {0, 0, 1}}, 8));
  EXPECT_GT(expected, 0.1);
  EXPECT_LT(expected, 0.9);
  testing::expect_mean(testing::render(seen_through(file, "path")), expected, 0.005);
}

TEST(SplatMedium, ShadowsOnASurface) {
  // A point light above a plane, and an absorbing splat between: the irradiance is the free one times the transmittance.
  const SplatFolder folder;
  PlainSplat s;
  s.position = {0, 1, 0}, s.scale = {0.3, 0.05, 0.3}, s.opacity = 0.6, s.color = {0, 0, 0};
  const auto file = folder.write("s.ply", make_ply({s}));
  const auto light = [&](const char* x, bool shadowed) {
    return testing::render(fmt::format(
        R"(<integrator type="path"/><emitter type="point"><point name="position" x="0" y="2" z="0"/>
      <float name="intensity" value="4"/></emitter>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf></shape>
    <sensor type="radiancemeter"><point name="origin" x="{}" y="0.3" z="1"/><vector name="direction" x="0" y="-0.3" z="-1"/>
      <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
      <sampler type="sobol"><integer name="sample_count" value="2048"/></sampler></sensor>{})",
        x,
        shadowed ? R"(<shape type="cube"><transform name="to_world"><scale x="2" y="0.3" z="2"/>
      <translate y="1"/></transform><bsdf type="null"/><medium type="splats" name="interior"><string name="filename" value=")" +
                       file.string() + R"("/><string name="file_axes" value="RUB"/></medium></shape>)"
                 : std::string()));
  };
  const double free = light("0", false).all;
  const auto medium = medium_of(file);
  testing::expect_mean(light("0", true), 0.4 * free, 0.01);
  const Vec3 to{0.3f, 0, 0}, from{0, 2, 0}, d = normalize(to - from);
  const double passed = std::exp(-medium->field().optical_thickness({from, d}, length(to - from)));
  EXPECT_GT(passed, 0.41);
  testing::expect_mean(light("0.3", true), passed * light("0.3", false).all, 0.01);
}

TEST(SplatMedium, EmissionOfAThickCloudIsItsColour) {
  const SplatFolder folder;
  PlainSplat s;
  s.scale = {1, 1, 1}, s.opacity = 0.5, s.color = {0.8, 0.8, 0.8};
  const auto file = folder.write("s.ply", make_ply({s}));
  std::string scene = seen_through(file, "path");
  scene.replace(scene.find(R"(<float name="radiance" value="1"/>)"), 34,
                R"(<float name="radiance" value="0"/>)");
  scene.replace(
      scene.find("</medium>"), 9,
      R"(<string name="color_is" value="emission"/><float name="extinction_scale" value="20"/></medium>)");
  const double linear = std::pow((0.8 + 0.055) / 1.055, 2.4);  // encoded as sRGB
  testing::expect_mean(testing::render(scene), linear, 0.01);
}

TEST(SplatMedium, EmissionByDirection) {
  // A thick cloud whose colour is 0.5 + 0.3 d_z / sqrt(3) times the harmonic's factor: bright from one side, dark from the other.
  const SplatFolder folder;
  PlainSplat s;
  s.scale = {1, 1, 1}, s.opacity = 0.5, s.color = {0.5, 0.5, 0.5};
  s.rest = {{0, 0, 0}, {0.5, 0.5, 0.5}, {0, 0, 0}};
  const auto file = folder.write("s.ply", make_ply({s}));
  const auto seen = [&](const char* z, const char* dz) {
    std::string scene = seen_through(file, "path");
    scene.replace(scene.find(R"(<float name="radiance" value="1"/>)"), 34,
                  R"(<float name="radiance" value="0"/>)");
    scene.replace(
        scene.find("</medium>"), 9,
        R"(<string name="color_is" value="emission"/><float name="extinction_scale" value="20"/></medium>)");
    scene.replace(scene.find("z=\"-4\""), 6, std::string("z=\"") + z + "\"");
    scene.replace(scene.find("z=\"1\""), 5, std::string("z=\"") + dz + "\"");
    return testing::render(scene);
  };
  const auto linear = [](double c) { return std::pow((c + 0.055) / 1.055, 2.4); };
  const double factor = std::sqrt(3 / (4 * M_PI));  // of Y_10 = factor z
  testing::expect_mean(seen("-4", "1"), linear(0.5 + 0.5 * factor), 0.01);
  testing::expect_mean(seen("4", "-1"), linear(0.5 - 0.5 * factor), 0.01);
}

TEST(SplatMedium, FlatAndPointSplatsAreNoted) {
  const SplatFolder folder;
  std::string bytes;
  for (int i = 0; i < 3; ++i) {
    const float row[6] = {float(i), 0, 0, 0.5f, i == 1 ? 0.f : 0.5f, 0.5f};
    bytes.append(reinterpret_cast<const char*>(row), 24);
    bytes.append("\xFF\x80\x80\x80\xFF\x80\x80\x80", 8);
  }
  const float none[3] = {0, 0, 0};
  std::memcpy(&bytes[32 * 2 + 12], none, 12);
  const auto file = folder.write("s.splat", bytes);
  const auto medium = testing::build<SplatMedium>(
      R"(<medium type="splats"><string name="filename" value="s.splat"/></medium>)", testing::make_context(),
      [&](const std::string&) { return file; });
  EXPECT_EQ(medium->field().thickened(), 1u);
  EXPECT_EQ(medium->field().without_extent(), 1u);
  EXPECT_EQ(medium->field().splats().size(), 2u);
}

}  // namespace
}  // namespace aureole::test
