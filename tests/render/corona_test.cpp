// SPDX-License-Identifier: Apache-2.0
// The rendered corona of a small lamp, through camera, pane, light sampling and film, against direct
// quadrature of
//     L(v) = (1 - R) integral over the lamp of L_lamp (1/lambda^2) J(2 pi/lambda |(w - v)_xy|) cos dw
// by optics:: alone (Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers", 2025,
// equation 14).
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/layer/scatterer_layer.h"
#include "aureole/render/job.h"
#include "harness/effort.h"

namespace aureole {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 5e-6, kAreaFraction = 0.5, kPane = 0.5, kLamp = 12, kLampRadius = 0.02,
                 kRadiance = 1000;
constexpr double kMinNm = 560, kMaxNm = 620, kIndex = 1.5, kFov = 14;
constexpr int kSize = 56;

std::string scene(const std::string& sampling, double tilt) {
  const auto number = [](double v) { return std::to_string(v); };
  return R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective"><float name="fov" value=")" +
         number(kFov) + R"("/>
    <transform name="to_world"><lookat origin="0, 0, 0" target="0, 0, -1" up="0, 1, 0"/></transform>
    <sampler type="sobol"><integer name="sample_count" value="256"/></sampler>
    <film type="hdrfilm"><integer name="width" value=")" +
         number(kSize).substr(0, 2) + R"("/><integer name="height" value=")" + number(kSize).substr(0, 2) +
         R"("/>
      <float name="wavelength_min" value=")" +
         number(kMinNm) + R"("/><float name="wavelength_max" value=")" + number(kMaxNm) + R"("/>
      <string name="response" value="uniform"/><string name="component_format" value="float32"/>
      <rfilter type="box"/></film></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate y="1" angle=")" +
         number(tilt) + R"("/><translate z=")" + number(-kPane) + R"("/></transform>
    <bsdf type="correlated_scatterers"><string name="radius" value="5um"/><float name="area_fraction" value="0.5"/>
      <string name="substrate" value="thindielectric"/><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>
      <string name="sampling" value=")" +
         sampling + R"("/></bsdf></shape>
  <shape type="sphere"><point name="center" x="0" y="0" z=")" +
         number(-kLamp) + R"("/><float name="radius" value=")" + number(kLampRadius) + R"("/>
    <emitter type="area"><spectrum name="radiance" value="1000"/></emitter></shape>
</scene>)";
}

struct Vector {
  double x, y, z;
  Vector operator+(const Vector& b) const { return {x + b.x, y + b.y, z + b.z}; }
  Vector operator-(const Vector& b) const { return {x - b.x, y - b.y, z - b.z}; }
  Vector operator*(double s) const { return {x * s, y * s, z * s}; }
  double dot(const Vector& b) const { return x * b.x + y * b.y + z * b.z; }
  double length() const { return std::sqrt(dot(*this)); }
};

/// The intensity of the layer as a table over q, linear between points so dense that it errs by 3e-8 of J(0).
class IntensityTable {
public:
  IntensityTable() : layer_(kRadius, kRadius, kAreaFraction) {
    for (int i = 0; i <= kPoints + 1; ++i) values_.push_back(layer_.intensity(i * kStep));
  }
  double normalisation() const { return layer_.normalisation(); }
  double operator()(double q) const {
    const double at = q / kStep;
    const auto i = std::size_t(at);
    return i < kPoints ? values_[i] + (at - double(i)) * (values_[i + 1] - values_[i]) : layer_.intensity(q);
  }

private:
  static constexpr int kPoints = 40000;
  static constexpr double kStep = 5e-4 / kRadius;
  optics::ScattererLayer layer_;
  std::vector<double> values_;
};

/// Radiance seen along (px, py, -1), mean over the wavelength range, through a pane turned by `tilt` about y.
double predicted(double px, double py, double tilt, const IntensityTable& layer) {
  const Vector n{std::sin(tilt), 0, std::cos(tilt)}, pane{0, 0, -kPane}, lamp{0, 0, -kLamp};
  Vector v{px, py, -1};
  v = v * (1 / v.length());
  const Vector p = v * (pane.dot(n) / v.dot(n));
  const double distance2 = (lamp - p).dot(lamp - p), c = std::abs(v.dot(n));
  double sum = 0;
  const int rings = 3, spokes = 8, wavelengths = 20;
  for (int r = 0; r < rings; ++r)
    for (int m = 0; m < spokes; ++m) {
      // Equal areas of the disc as which the sphere is seen from the pane, whose solid angle they share.
      const double tangent = kLampRadius * std::sqrt((r + 0.5) / rings), f = 2 * kPi * (m + 0.5) / spokes;
      Vector w = lamp + Vector{tangent * std::cos(f), tangent * std::sin(f), 0} - p;
      w = w * (1 / w.length());
      const Vector change = w - v, across = change - n * change.dot(n);
      const double q = across.length(), cos_w = std::abs(w.dot(n));
      const double reflectance = std::sqrt(optics::thin_slab_reflectance(c, 1, kIndex) *
                                           optics::thin_slab_reflectance(cos_w, 1, kIndex));
      for (int l = 0; l < wavelengths; ++l) {
        const double lambda = (kMinNm + (kMaxNm - kMinNm) * (l + 0.5) / wavelengths) * 1e-9;
        sum += layer(2 * kPi / lambda * q) / (lambda * lambda) * cos_w * (1 - reflectance);
      }
    }
  const double solid_angle = 2 * kPi * (1 - std::sqrt(1 - kLampRadius * kLampRadius / distance2));
  return layer.normalisation() * kRadiance * solid_angle * sum / (rings * spokes * wavelengths);
}

void check(const std::string& sampling, double degrees_of_tilt = 0) {
  const double tilt = degrees_of_tilt * kPi / 180;
  RenderOptions options;
  options.end = test::effort(128, 256);
  RenderJob job(load_scene_from_string(scene(sampling, degrees_of_tilt), "corona.xml"), options);
  const std::atomic<bool> stop{false};
  ASSERT_EQ(job.run(stop), RenderJob::Outcome::finished);
  const Image image = job.state().picture();
  static const IntensityTable layer;
  const double scale = 2 * std::tan(kFov * kPi / 360) / kSize;

  // Means over rings, each pixel against the mean of the prediction over its area.
  constexpr int kRings = 12;
  const double first = 0.6, width = 0.5;  // degrees
  double measured[kRings] = {}, expected[kRings] = {};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double px = (x + 0.5 - kSize / 2.0) * scale, py = (y + 0.5 - kSize / 2.0) * scale;
      const double degrees = std::atan(std::hypot(px, py)) * 180 / kPi;
      const int ring = int((degrees - first) / width);
      if (degrees < first || ring >= kRings) continue;
      measured[ring] += image.at(x, y, 0);
      constexpr int kSub = 3;
      for (int j = 0; j < kSub; ++j)
        for (int i = 0; i < kSub; ++i)
          expected[ring] += predicted(px + ((i + 0.5) / kSub - 0.5) * scale,
                                      py + ((j + 0.5) / kSub - 0.5) * scale, tilt, layer) /
                            (kSub * kSub);
    }
  double peak = 0;
  for (double e : expected) peak = std::max(peak, e);
  for (int r = 0; r < kRings; ++r) {
    std::printf("%s, tilt %.0f, %.2f deg: %.5g, expected %.5g (%+.2f %%)\n", sampling.c_str(),
                degrees_of_tilt, first + width * (r + 0.5), measured[r], expected[r],
                100 * (measured[r] / expected[r] - 1));
    // Dark rings are as good as the bright ones around them allow.
    EXPECT_NEAR(measured[r], expected[r], 0.01 * expected[r] + 5e-4 * peak)
        << first + width * (r + 0.5) << " degrees";
  }
}

TEST(Corona, RenderedRingsAreThoseOfTheFormula) { check("product"); }
TEST(Corona, TiltedBy30) { check("product", 30); }
TEST(Corona, TiltedBy60) { check("product", 60); }
TEST(Corona, SamplingByFactorsGivesTheSamePicture) { check("factor_mis"); }
TEST(Corona, SamplingByTableGivesTheSamePicture) { check("table"); }
TEST(Corona, SamplingByCosineGivesTheSamePicture) { check("cosine", 30); }

}  // namespace
}  // namespace aureole
