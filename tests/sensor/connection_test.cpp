// SPDX-License-Identifier: Apache-2.0
// Sensor::sample_direct is the adjoint of Sensor::sample_ray: light that leaves a small patch falls on the
// film where the sensor's rays that hit the patch start, with the weight of these rays.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/asset/asset.h"
#include "aureole/math/significance.h"
#include "aureole/sensor/placed_sensor.h"
#include "tests/harness/properties_builder.h"

namespace aureole::testing {
namespace {

struct Case {
  std::string name, xml;
  Vec3 center, u, v;  ///< the patch center + [-1, 1] u + [-1, 1] v
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

const std::string kFilm = R"(<film type="hdrfilm"><integer name="width" value="60"/>
  <integer name="height" value="40"/>)";
const std::string kLook = R"(<transform name="to_world"><lookat origin="1, -4, 2" target="0, 0, 0.3"
  up="0.1, 0, 1"/></transform>)";
const Vec3 kCenter{0.2f, 0.1f, 0.3f}, kU{0.5f, 0.1f, 0.1f}, kV{-0.1f, 0.3f, 0.4f};

std::vector<Case> cases() {
  const std::string lens = R"(<float name="fov" value="40"/><float name="aperture_radius" value="0.5"/>)";
  return {
      {"perspective", "<sensor type='perspective'>" + kLook + kFilm + "</film></sensor>", kCenter, kU, kV},
      {"perspective_crop",
       "<sensor type='perspective'><float name='fov' value='25'/>" + kLook + kFilm +
           R"(<integer name="crop_offset_x" value="20"/><integer name="crop_width" value="17"/>
           <boolean name="sample_border" value="true"/></film>
           <float name="principal_point_offset_x" value="0.1"/></sensor>)",
       kCenter, kU, kV},
      {"perspective_clip",
       "<sensor type='perspective'>" + kLook + kFilm +
           "</film><float name='near_clip' value='4.2'/><float name='far_clip' value='4.6'/></sensor>",
       kCenter, kU, kV * 3.f},
      {"spherical", "<sensor type='spherical'>" + kLook + kFilm + "</film></sensor>", kCenter, kU * 3.f,
       kV * 3.f},
      {"spherical_crop",
       "<sensor type='spherical'>" + kLook + kFilm +
           R"(<integer name="crop_offset_y" value="10"/><integer name="crop_height" value="10"/></film></sensor>)",
       kCenter, kU, kV * 3.f},
      {"thinlens_near",
       "<sensor type='thinlens'>" + lens + "<float name='focus_distance' value='2'/>" + kLook + kFilm +
           "</film></sensor>",
       kCenter, kU, kV},
      {"thinlens_far",
       "<sensor type='thinlens'>" + lens + "<float name='focus_distance' value='9'/>" + kLook + kFilm +
           "</film></sensor>",
       kCenter, kU, kV},
      {"orthographic",
       R"(<sensor type="orthographic"><float name="near_clip" value="3.9"/>
       <transform name="to_world"><scale x="1.5" y="0.8" z="1.1"/><rotate z="1" angle="20"/>
       <lookat origin="1, -4, 2" target="0, 0, 0.3" up="0, 0, 1"/></transform>)" +
           kFilm + "</film></sensor>",
       kCenter, kU, kV},
      {"distant", R"(<sensor type="distant"><vector name="direction" x="0.3" y="0.5" z="-1"/></sensor>)",
       kCenter, kU, kV},
      {"distant_offset",
       R"(<sensor type="distant"><vector name="direction" x="0.3" y="0.5" z="-1"/>
       <boolean name="flip_directions" value="true"/><float name="ray_offset" value="0.1"/></sensor>)",
       kCenter, kU, kV},
      {"irradiance_rectangle",
       R"(<shape type="rectangle"><transform name="to_world"><scale x="2"/><rotate x="1" angle="10"/>
       <translate z="-1"/></transform><sensor type="irradiancemeter"/></shape>)",
       kCenter, kU, kV},
      {"irradiance_sphere",
       R"(<shape type="sphere"><float name="radius" value="0.7"/><point name="center" x="1" y="-1" z="0"/>
       <sensor type="irradiancemeter"/></shape>)",
       kCenter, kU, kV},
      {"powermap",
       R"(<sensor type="powermap"><transform name="to_world"><scale x="2" y="1.2"/>
       <rotate x="1" angle="10"/><translate z="-1"/></transform>)" +
           kFilm + "</film></sensor>",
       kCenter, kU, kV},
      {"powermap_irradiance",
       R"(<sensor type="powermap"><string name="measure" value="irradiance"/><transform name="to_world">
       <scale x="2" y="1.2"/><rotate x="1" angle="10"/><translate z="-1"/></transform>)" +
           kFilm + R"(<integer name="crop_offset_x" value="20"/><integer name="crop_width" value="17"/></film>
           </sensor>)",
       kCenter, kU, kV},
      {"powermap_sphere",
       R"(<shape type="sphere"><float name="radius" value="0.7"/><point name="center" x="1"
       y="-1" z="0"/><sensor type="powermap">)" +
           kFilm + "</film></sensor></shape>",
       kCenter, kU, kV},
      {"batch",
       "<sensor type='batch'>" + kFilm + "</film><sensor type='perspective'>" + kLook +
           "</sensor><sensor type='thinlens'>" + lens + "<float name='focus_distance' value='2'/>" + kLook +
           "</sensor><sensor type='orthographic'>" + kLook + "</sensor></sensor>",
       kCenter, kU, kV}};
}

/// The sensor of a snippet, which may be a shape with a sensor on it.
struct Made {
  std::shared_ptr<Object> root;
  PlacedSensor placed;
};
Made make(const std::string& xml) {
  Made m{build_object(xml), {}};
  const Vec3 center{0.1f, 0.2f, 0.3f};
  if (const auto* asset = dynamic_cast<const Asset*>(m.root.get()))
    m.placed = PlacedSensor::of(*asset->sensor(), asset->sensor_area(), center, 1.3f);
  else
    m.placed = PlacedSensor::of(dynamic_cast<const Sensor&>(*m.root), nullptr, center, 1.3f);
  return m;
}

struct Mean {
  double sum = 0, squares = 0;
  int n = 0;
  void add(double x) { sum += x, squares += x * x, ++n; }
  double value() const { return sum / n; }
  double error() const { return std::sqrt(std::max(squares / n - value() * value(), 0.0) / n); }
};

class Connection : public ::testing::TestWithParam<Case> {};

TEST_P(Connection, IsTheAdjointOfRays) {
  const auto& [name, xml, center, u, v] = GetParam();
  const Made made = make(xml);
  const PlacedSensor& sensor = made.placed;
  const Film& film = sensor.film();
  const FilmPart part = FilmPart::of(film, 0, 1);
  const Vec3 across = cross(u, v), n = normalize(across);
  SeededRandom random(17);
  constexpr int kSamples = 600000;

  // How much of the film sees the patch.
  Mean by_rays;
  const Vec2 size = part.upper - part.lower;
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 place = random.next2();
    const SensorRay s = sensor.sample_ray({part.lower.x + size.x * place.x, part.lower.y + size.y * place.y},
                                          sensor.uses_lens() ? random.next2() : Vec2{0.3f, 0.6f});
    ASSERT_NEAR(length(s.ray.d), 1, 1e-5);
    const float t = dot(center - s.ray.o, n) / dot(s.ray.d, n);
    const Vec3 at = s.ray.o + s.ray.d * t - center;
    const float area = dot(across, n), a = dot(cross(at, v), n) / area, b = dot(cross(u, at), n) / area;
    const bool hit = t > 0 && t < s.ray.t_max && std::abs(a) < 1 && std::abs(b) < 1;
    by_rays.add(hit ? double(s.weight) * size.x * size.y : 0);
  }
  // How much of the patch's light the film receives.
  Mean by_light;
  int seen = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 place = random.next2();
    const Vec3 at = center + u * (2 * place.x - 1) + v * (2 * place.y - 1);
    const auto c = sensor.sample_direct(at, random.next2());
    if (c) {
      ++seen;
      ASSERT_NEAR(length(c->wo), 1, 1e-5);
      ASSERT_TRUE(length(c->p - at) < 0.01f || dot(normalize(c->p - at), c->wo) > 1 - 1e-4f);
      ASSERT_TRUE(part.samples(c->film));
    }
    by_light.add(c ? double(c->importance) * std::abs(dot(n, c->wo)) * 4 * length(across) : 0);
  }
  const double error = std::hypot(by_rays.error(), by_light.error());
  EXPECT_GT(by_rays.value(), 20 * by_rays.error()) << "the patch is hardly seen";
  EXPECT_GT(seen, kSamples / 100);
  EXPECT_LT(error, 0.02 * by_rays.value());
  EXPECT_NEAR(by_light.value(), by_rays.value(), 4 * error);
}

TEST_P(Connection, LeadsBackToThePlaceOnTheFilm) {
  const auto& [name, xml, center, u, v] = GetParam();
  if (name.starts_with("irradiance") || name.starts_with("powermap") || name == "batch")
    return;  // the place or the sensor is a choice
  const Made made = make(xml);
  const FilmPart part = FilmPart::of(made.placed.film(), 0, 1);
  SeededRandom random(4);
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2 place = random.next2(), lens = random.next2();
    const Vec2 at{part.lower.x + (part.upper.x - part.lower.x) * place.x,
                  part.lower.y + (part.upper.y - part.lower.y) * place.y};
    const Ray ray = made.placed.sample_ray(at, lens).ray;
    const float far = std::min(ray.t_max, 4.f);
    const Vec3 inside = ray.o + ray.d * (far * (0.01f + 0.98f * random.next()));
    const auto c = made.placed.sample_direct(inside, lens);
    if (!c) continue;  // within rounding of the film's edge
    ++found;
    EXPECT_NEAR(dot(c->wo, ray.d), -1, 1e-5);
    if (name.starts_with("distant")) continue;
    EXPECT_NEAR(c->film.x, at.x, 3e-3);
    EXPECT_NEAR(c->film.y, at.y, 3e-3);
    EXPECT_LT(length(c->p - ray.o), 1e-4) << "the segment must end where the ray starts";
  }
  EXPECT_GT(found, 1990);
}

INSTANTIATE_TEST_SUITE_P(Sensor, Connection, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

TEST(ConnectionToNothing, IsNotMade) {
  const char* const unconnected[] = {
      "<sensor type='radiancemeter'/>",
      "<sensor type='distant'><point name='target' x='0' y='0' z='0'/></sensor>",
      "<sensor type='distant'><shape name='target' type='sphere'/></sensor>"};
  for (const char* xml : unconnected)
    EXPECT_FALSE(make(xml).placed.sample_direct({0, 0, 0.5f}, {0.5f, 0.5f})) << xml;
  // Behind the camera, beside the picture, before and behind the clip planes; at the back of a meter.
  const Made camera = make("<sensor type='perspective'><float name='fov' value='60'/></sensor>");
  for (const Vec3& p : {Vec3{0, 0, -1}, Vec3{5, 0, 1}, Vec3{0, 0, 0.005f}, Vec3{0, 0, 2e4f}})
    EXPECT_FALSE(camera.placed.sample_direct(p, {})) << p.z;
  EXPECT_TRUE(camera.placed.sample_direct({0, 0, 1}, {}));
  const Made meter = make("<shape type='rectangle'><sensor type='irradiancemeter'/></shape>");
  EXPECT_FALSE(meter.placed.sample_direct({0, 0, -1}, {0.5f, 0.5f}));
  EXPECT_TRUE(meter.placed.sample_direct({0, 0, 1}, {0.5f, 0.5f}));
}

}  // namespace
}  // namespace aureole::testing
