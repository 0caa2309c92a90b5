// SPDX-License-Identifier: Apache-2.0
// Integrators against closed forms and against each other, through the public interface of a job. Errors are
// standard errors over independently scrambled replicates.
#include <gtest/gtest.h>

#include <cmath>

#include "harness/rendered.h"

namespace aureole::testing {
namespace {

std::string sensor(const std::string& lookat, double fov, int size, int samples,
                   const std::string& film = "") {
  return "<sensor type=\"perspective\"><float name=\"fov\" value=\"" + std::to_string(fov) +
         "\"/><transform name=\"to_world\"><lookat " + lookat +
         "/></transform><sampler type=\"sobol\"><integer name=\"sample_count\" value=\"" +
         std::to_string(samples) + "\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" value=\"" +
         std::to_string(size) + "\"/><integer name=\"height\" value=\"" + std::to_string(size) +
         "\"/><rfilter type=\"box\"/>" + film + "</film></sensor>";
}
std::string path(int max_depth = -1, int rr_depth = 5) {
  return "<integrator type=\"path\"><integer name=\"max_depth\" value=\"" + std::to_string(max_depth) +
         "\"/><integer name=\"rr_depth\" value=\"" + std::to_string(rr_depth) + "\"/></integrator>";
}
std::string diffuse(double reflectance) {
  return "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"" + std::to_string(reflectance) +
         "\"/></bsdf>";
}

class Furnace : public ::testing::TestWithParam<const char*> {};

TEST_P(Furnace, WhiteBodiesVanish) {
  const std::string white = std::string("<shape type=\"") + GetParam() + "\">" + diffuse(1) + "</shape>" +
                            "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"1.6\" z=\"0\"/><float "
                            "name=\"radius\" value=\"0.5\"/>" +
                            diffuse(1) + "</shape>";
  const Picture p =
      render(path() + sensor("origin=\"1, 2, 5\" target=\"0, 0.5, 0\" up=\"0, 1, 0\"", 40, 8, 64) + white +
             "<emitter type=\"constant\"/>");
  expect_mean(p, 1);
  expect_pixels(p, 1);
}
INSTANTIATE_TEST_SUITE_P(Bodies, Furnace, ::testing::Values("sphere", "cube"),
                         [](const auto& info) { return std::string(info.param); });

std::string closed(const std::string& shape, double reflectance) {
  return "<shape type=\"" + shape + "\"><boolean name=\"flip_normals\" value=\"true\"/>" +
         diffuse(reflectance) + "<emitter type=\"area\"/></shape>";
}
const std::string kInside = "origin=\"0.2, 0.1, 0.3\" target=\"1, 0.3, 0\" up=\"0, 1, 0\"";

class ClosedRoom : public ::testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(ClosedRoom, RadianceIsTheGeometricSeries) {
  const auto [shape, reflectance] = GetParam();
  const Picture p = render(path() + sensor(kInside, 70, 4, 128) + closed(shape, reflectance));
  expect_mean(p, 1 / (1 - reflectance));
  expect_pixels(p, 1 / (1 - reflectance));
}

TEST_P(ClosedRoom, DepthCutsTheSeries) {
  const auto [shape, reflectance] = GetParam();
  double expected = 0, term = 1;
  for (int depth = 0; depth < 5; ++depth) {
    const Picture p = render(path(depth) + sensor(kInside, 70, 4, 32) + closed(shape, reflectance));
    if (depth == 0) {
      EXPECT_EQ(p.all, 0);
    } else {
      expect_mean(p, expected += term);
      term *= reflectance;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Rooms, ClosedRoom,
                         ::testing::Values(std::pair("sphere", 0.5), std::pair("sphere", 0.8),
                                           std::pair("sphere", 0.99), std::pair("cube", 0.5),
                                           std::pair("cube", 0.7)),
                         [](const auto& info) {
                           return info.param.first + std::to_string(int(100 * info.param.second));
                         });

std::string stage() {
  return R"(<shape type="rectangle"><transform name="to_world"><scale value="4"/></transform>)" +
         diffuse(0.6) + R"(</shape>
<shape type="sphere"><point name="center" x="0.5" y="0" z="0.8"/><float name="radius" value="0.5"/><bsdf type="plastic"/></shape>
<shape type="cube"><transform name="to_world"><scale value="0.4"/><translate x="-0.8" z="0.5"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="180"/><translate z="3"/></transform>
  <emitter type="area"><rgb name="radiance" value="6, 5, 3"/></emitter></shape>
<emitter type="point"><point name="position" x="-2" y="-2" z="3"/><rgb name="intensity" value="2, 3, 5"/></emitter>
<emitter type="constant"><rgb name="radiance" value="0.1, 0.2, 0.4"/></emitter>)";
}
const std::string kStageView = "origin=\"1, -4, 3\" target=\"0, 0, 0.4\" up=\"0, 0, 1\"";

TEST(DirectIntegrator, IsThePathTracerCutAtTwo) {
  const Picture a = render(path(2) + sensor(kStageView, 45, 12, 64) + stage());
  for (const char* parameters :
       {"", R"(<integer name="emitter_samples" value="3"/><integer name="bsdf_samples" value="1"/>)",
        R"(<integer name="emitter_samples" value="1"/><integer name="bsdf_samples" value="4"/>)"}) {
    const Picture b = render(std::string("<integrator type=\"direct\">") + parameters + "</integrator>" +
                             sensor(kStageView, 45, 12, 32) + stage());
    EXPECT_NEAR(a.all, b.all, 4.5 * std::hypot(a.all_error, b.all_error)) << parameters;
    EXPECT_LT(b.all_error, 0.01 * b.all);
    double z2 = 0;
    int outside = 0, lit = 0;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
      const double sigma = std::hypot(a.error[i], b.error[i]);
      if (!(sigma > 1e-7)) continue;
      const double z = (a.mean[i] - b.mean[i]) / sigma;
      z2 += z * z, ++lit, outside += std::abs(z) > 5;
    }
    ASSERT_GT(lit, 100);
    // Student's t with about 30 degrees of freedom has a variance of 30 / 28.
    EXPECT_NEAR(z2 / lit, 30.0 / 28, 4.5 * std::sqrt(2.3 / lit)) << parameters;
    EXPECT_EQ(outside, 0);
  }
}

TEST(DirectIntegrator, LightSamplesAloneFindTheirLights) {
  // Without the delta lobes of plastic: light samples alone and BSDF samples alone are unbiased where both
  // reach everything.
  const std::string scene =
      R"(<shape type="rectangle"><transform name="to_world"><scale value="4"/></transform></shape>
<shape type="sphere"><point name="center" x="0" y="0" z="2"/><float name="radius" value="0.8"/>
  <emitter type="area"><rgb name="radiance" value="6, 5, 3"/></emitter></shape>
<emitter type="constant"><rgb name="radiance" value="0.1, 0.2, 0.4"/></emitter>)";
  Picture p[2];
  for (int k = 0; k < 2; ++k)
    p[k] = render(std::string("<integrator type=\"direct\"><integer name=\"emitter_samples\" value=\"") +
                  (k ? "0" : "4") + "\"/><integer name=\"bsdf_samples\" value=\"" + (k ? "4" : "0") +
                  "\"/></integrator>" + sensor(kStageView, 45, 8, 64) + scene);
  EXPECT_NEAR(p[0].all, p[1].all, 4.5 * std::hypot(p[0].all_error, p[1].all_error));
  EXPECT_LT(std::hypot(p[0].all_error, p[1].all_error), 0.01 * p[0].all);
}

TEST(PathIntegrator, PointLightOnAPlane) {
  for (const auto& [x, height] : {std::pair{0.0, 2.0}, {1.5, 2.0}, {5.0, 1.0}}) {
    const std::string scene =
        R"(<shape type="rectangle"><transform name="to_world"><scale value="10"/></transform>)" +
        diffuse(0.5) + "</shape><emitter type=\"point\"><point name=\"position\" x=\"" + std::to_string(x) +
        "\" y=\"0\" z=\"" + std::to_string(height) + "\"/><float name=\"intensity\" value=\"10\"/></emitter>";
    const Picture p =
        render(path() + sensor("origin=\"0, 3, 3\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 0.05, 2, 256) + scene);
    const double d2 = x * x + height * height;
    expect_mean(p, 0.5 / M_PI * 10 * height / std::pow(d2, 1.5), 1e-3);
  }
}

TEST(PathIntegrator, SphereLightOverAPlane) {
  // Irradiance below a sphere of radius r at distance d: pi L r^2 / d^2.
  const Picture p = render(
      path() + sensor("origin=\"0, 3, 1\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 0.05, 2, 256) +
      R"(<shape type="rectangle"><transform name="to_world"><scale value="10"/></transform>)" + diffuse(0.5) +
      R"(</shape><shape type="sphere"><point name="center" x="0" y="0" z="3"/><float name="radius" value="1"/><emitter type="area"/></shape>)");
  // Light that the plane reflects to the black lamp is absorbed: only direct light remains.
  expect_mean(p, 0.5 / 9, 2e-3);
}

TEST(PathIntegrator, GlassInAFurnaceIsInvisible) {
  for (const char* ior :
       {R"(<float name="int_ior" value="1.5"/>)", R"(<string name="int_ior" value="sf11"/>)"})
    for (const char* shape : {"cube", "sphere"}) {
      const Picture p =
          render(path() + sensor("origin=\"1, 2, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 30, 6, 64) +
                 "<shape type=\"" + shape + "\"><bsdf type=\"dielectric\">" + ior +
                 "</bsdf></shape><emitter type=\"constant\"/>");
      expect_mean(p, 1);
      expect_pixels(p, 1);
    }
}

/// A prism of dense flint (a ball seen off its centre) before a bright strip; the mean radiance of a band of
/// wavelengths.
Picture prism(double min_nm, double max_nm, int samples) {
  return render(
      path(8) +
      sensor("origin=\"0, 0, 6\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 22, 10, samples,
             "<string name=\"response\" value=\"uniform\"/><float name=\"wavelength_min\" value=\"" +
                 std::to_string(min_nm) + "\"/><float name=\"wavelength_max\" value=\"" +
                 std::to_string(max_nm) + "\"/>") +
      R"(<shape type="sphere"><bsdf type="dielectric"><string name="int_ior" value="sf11"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale x="0.15" y="3"/><translate x="0.8" z="-3"/></transform>
  <emitter type="area"><spectrum name="radiance" value="400:1, 550:3, 700:2"/></emitter></shape>)");
}

TEST(PathIntegrator, DispersionIsUnbiasedAgainstNarrowBands) {
  const Picture wide = prism(400, 700, 512);
  constexpr int kBands = 6;
  std::vector<Picture> narrow;
  for (int b = 0; b < kBands; ++b) narrow.push_back(prism(400 + 50 * b, 450 + 50 * b, 128));
  double z2 = 0, all = 0, all_variance = wide.all_error * wide.all_error;
  int lit = 0, moved = 0;
  for (const Picture& p : narrow)
    all += p.all / kBands, all_variance += p.all_error * p.all_error / (kBands * kBands);
  EXPECT_NEAR(wide.all, all, 4.5 * std::sqrt(all_variance) + 1e-3 * all);
  EXPECT_LT(std::sqrt(all_variance), 0.02 * all);
  for (std::size_t i = 0; i < wide.mean.size(); ++i) {
    double mean = 0, variance = wide.error[i] * wide.error[i];
    for (const Picture& p : narrow)
      mean += p.mean[i] / kBands, variance += p.error[i] * p.error[i] / (kBands * kBands);
    if (!(wide.mean[i] > 0.02)) continue;
    const double z = (wide.mean[i] - mean) / std::sqrt(variance);
    EXPECT_LT(std::abs(z), 6) << "pixel " << i << ": " << wide.mean[i] << " and " << mean;
    z2 += z * z, ++lit;
    // Dispersion: red and blue, each relative to its emission, must give different pictures.
    const double blue = narrow[0].mean[i] / 1.333, red = narrow[5].mean[i] / 2.1667;
    const double sigma = std::hypot(narrow[0].error[i] / 1.333, narrow[5].error[i] / 2.1667);
    moved += std::abs(blue - red) > 6 * sigma + 0.02;
  }
  ASSERT_GT(lit, 20);
  EXPECT_NEAR(z2 / lit, 15.0 / 13, 4.5 * std::sqrt(2.6 / lit));
  EXPECT_GT(moved, 3) << "colours fall to the same places";
  RecordProperty("z2", std::to_string(z2 / lit));
  RecordProperty("moved", moved);
  RecordProperty("lit", lit);
}

TEST(PathIntegrator, EndsInAClosedRoomWithoutLossesOrRoulette) {
  const std::string room = "<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"true\"/>";
  const std::string view = sensor("origin=\"0.3, 0, 0\" target=\"1, 0, 0\" up=\"0, 0, 1\"", 40, 2, 4);
  EXPECT_EQ(render(path(-1, 1000000000) + view + room + diffuse(1) + "</shape>").all, 0);
}

}  // namespace
}  // namespace aureole::testing
