// SPDX-License-Identifier: Apache-2.0
// Sensor::eval is the inverse of Sensor::sample_ray: it finds the place on the film of a ray, and its
// densities integrate to one over all rays that are seen.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/asset/asset.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/sensor/placed_sensor.h"
#include "tests/harness/properties_builder.h"

namespace aureole::testing {
namespace {

const std::string kFilm = R"(<film type="hdrfilm"><integer name="width" value="60"/>
  <integer name="height" value="40"/><integer name="crop_offset_x" value="20"/>
  <integer name="crop_width" value="30"/></film>)";
const std::string kLook = R"(<transform name="to_world"><lookat origin="1, -4, 2" target="0, 0, 0.3"
  up="0.1, 0, 1"/></transform>)";
const std::string kLens = R"(<float name="fov" value="70"/><float name="aperture_radius" value="0.5"/>
  <float name="focus_distance" value="3"/>)";

struct Case {
  std::string name, xml;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

const Case kCases[] = {
    {"perspective",
     "<sensor type='perspective'><float name='fov' value='80'/>" + kLook + kFilm + "</sensor>"},
    {"thinlens", "<sensor type='thinlens'>" + kLens + kLook + kFilm + "</sensor>"},
    {"orthographic",
     R"(<sensor type="orthographic"><transform name="to_world"><scale x="1.5" y="0.8" z="1.1"/>
       <lookat origin="1, -4, 2" target="0, 0, 0.3" up="0, 0, 1"/></transform>)" +
         kFilm + "</sensor>"},
    {"batch",
     "<sensor type='batch'>" + kFilm + "<sensor type='perspective'>" + kLook +
         "</sensor><sensor type='thinlens'>" + kLens +
         R"(<transform name="to_world"><lookat origin="9, 0, 0" target="0, 0, 0" up="0, 0, 1"/></transform>)" +
         "</sensor></sensor>"}};

class InverseOfSensor : public ::testing::TestWithParam<Case> {};

TEST_P(InverseOfSensor, FindsThePlaceOnTheFilm) {
  const auto object = build_object(GetParam().xml);
  const PlacedSensor sensor =
      PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {0.1f, 0.2f, 0.3f}, 1.3f);
  SeededRandom random(3);
  const Vec2 lower = sensor.part.lower, size = sensor.part.upper - lower;
  for (int i = 0; i < 10000; ++i) {
    const Vec2 u = random.next2(),
               film{lower.x + size.x * (0.001f + 0.998f * u.x), lower.y + size.y * (0.001f + 0.998f * u.y)};
    const SensorRay s = sensor.sample_ray(film, random.next2());
    const auto found = sensor.eval(s.ray.o + s.ray.d * random.next(), s.ray.d);
    ASSERT_TRUE(found) << film.x << " " << film.y;
    EXPECT_NEAR(found->film.x, film.x, 2e-3);
    EXPECT_NEAR(found->film.y, film.y, 2e-3);
    EXPECT_EQ(found->weight, s.weight);
    EXPECT_GT(found->pdf_position, 0);
    EXPECT_GT(found->pdf_direction, 0);
  }
}

// The measure of all rays through a plane that are seen, times their density.
TEST_P(InverseOfSensor, DensitiesIntegrateToOne) {
  const auto object = build_object(GetParam().xml);
  const PlacedSensor sensor =
      PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {0.1f, 0.2f, 0.3f}, 1.3f);
  SeededRandom random(4);
  // Rays are drawn with these two densities, of the sensor that is asked, mixed over its members.
  std::vector<const PlacedSensor*> members;
  for (const PlacedSensor& m : sensor.members) members.push_back(&m);
  if (members.empty()) members.push_back(&sensor);
  double sum = 0, squares = 0;
  // Members see a small part of the cone that directions are drawn from.
  const int n = sensor.members.empty() ? 400000 : 1600000;
  for (const PlacedSensor* member : members) {
    const bool parallel = GetParam().name == "orthographic";
    const SensorRay middle = member->sample_ray({0.5f * (member->part.lower.x + member->part.upper.x),
                                                 0.5f * (member->part.lower.y + member->part.upper.y)},
                                                {0.5f, 0.5f});
    const SensorRay corner = member->sample_ray(member->part.lower, {0.5f, 0.5f});
    // The rays of one point of the aperture meet there.
    const Vec3 apart = corner.ray.o - middle.ray.o;
    const float cosine = dot(middle.ray.d, corner.ray.d);
    const Vec3 aperture =
        middle.ray.o + middle.ray.d * ((dot(apart, middle.ray.d) - cosine * dot(apart, corner.ray.d)) /
                                       (1 - cosine * cosine));
    for (int k = 0; k < n; ++k) {
      Vec3 p = middle.ray.o, d = middle.ray.d;
      double measure = 1;
      if (parallel) {
        // Points of a square across the rays.
        const Frame frame = Frame::from_normal(d);
        const Vec2 u = random.next2();
        const float side = 4 * length(corner.ray.o - middle.ray.o);
        p = p + frame.to_world({(u.x - 0.5f) * side, (u.y - 0.5f) * side, 0});
        measure = double(side) * double(side);
      } else {
        // One point of the aperture, all directions ahead.
        p = aperture;
        d = Frame::from_normal(d).to_world(square_to_uniform_cone(random.next2(), 0.9f));
        measure = 2 * M_PI * 0.9;
      }
      const auto found = sensor.eval(p, d);
      double x = 0;
      if (found) x = measure * double(parallel ? found->pdf_position : found->pdf_direction);
      sum += x / n, squares += x * x / n / n;
    }
  }
  // Each member's directions integrate to one.
  EXPECT_NEAR(sum, double(members.size()), 4.5 * std::sqrt(squares));
  EXPECT_LT(4.5 * std::sqrt(squares), 0.03);
}

// The area that neighbouring rays of one point of the aperture enclose.
TEST_P(InverseOfSensor, DensityAcrossIsThatOfNeighbouringRays) {
  const auto object = build_object(GetParam().xml);
  const PlacedSensor sensor =
      PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {0.1f, 0.2f, 0.3f}, 1.3f);
  SeededRandom random(5);
  const Vec2 lower = sensor.part.lower, size = sensor.part.upper - lower;
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec2 u = random.next2(), lens = random.next2(),
               film{lower.x + size.x * (0.01f + 0.95f * u.x), lower.y + size.y * (0.01f + 0.95f * u.y)};
    const PlacedSensor* member = &sensor;
    for (const PlacedSensor& m : sensor.members)
      if (m.part.samples({film.x - 1, film.y - 1}) && m.part.samples({film.x + 1, film.y + 1})) member = &m;
    if (member == &sensor && !sensor.members.empty()) continue;  // between two of them
    const SensorRay ray = sensor.sample_ray(film, lens);
    const Vec3 p = ray.ray.o + ray.ray.d * random.next();
    const auto aside = [&](Vec2 step) {
      const Ray r = sensor.sample_ray({film.x + step.x, film.y + step.y}, lens).ray;
      return r.o + r.d * (dot(p - r.o, ray.ray.d) / dot(r.d, ray.ray.d)) - p;
    };
    const Vec3 dx = (aside({0.5f, 0}) - aside({-0.5f, 0})), dy = (aside({0, 0.5f}) - aside({0, -0.5f}));
    const auto found = sensor.eval(p, ray.ray.d);
    ASSERT_TRUE(found);
    const double density = 1 / (double(length(cross(dx, dy))) * double(member->part.sample_area()));
    // Another member of the batch, whose rays are parallel, sees the place, too.
    if (std::abs(found->film.x - film.x) + std::abs(found->film.y - film.y) > 0.1f) continue;
    ++compared;
    EXPECT_NEAR(found->pdf_across, density, 0.01 * density) << film.x << " " << film.y;
  }
  EXPECT_GT(compared, 100);
}

TEST(SensorInverse, OfADistantOneIsTheCrossSectionOfTheScene) {
  const auto object =
      build_object("<sensor type='distant'><vector name='direction' value='0, 1, 0'/></sensor>");
  const PlacedSensor sensor =
      PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {0.1f, 0.2f, 0.3f}, 1.3f);
  const auto found = sensor.eval({1, 7, 0.3f}, {0, 1, 0});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->pdf_across, 1 / (M_PI * 1.3 * 1.3), 1e-5);
  EXPECT_EQ(found->pdf_position, found->pdf_across);
  EXPECT_EQ(found->pdf_direction, 1);
  EXPECT_FALSE(sensor.eval({1, 7, 1.6f}, {0, 1, 0})) << "beside the scene";
}

TEST(SensorInverse, ApertureAndMembersShareTheirDensity) {
  const auto object = build_object(kCases[1].xml);
  const PlacedSensor lens =
      PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {0.1f, 0.2f, 0.3f}, 1.3f);
  const SensorRay s = lens.sample_ray({30, 20}, {0.2f, 0.6f});
  EXPECT_NEAR(lens.eval(s.ray.o, s.ray.d)->pdf_position, 1 / (M_PI * 0.25), 1e-5);
  const auto batch = build_object(kCases[3].xml);
  const PlacedSensor both =
      PlacedSensor::of(dynamic_cast<const Sensor&>(*batch), nullptr, {0.1f, 0.2f, 0.3f}, 1.3f);
  // The crop, from 20 to 50 of 60 columns, has 10 of the first sensor and 20 of the second.
  const SensorRay first = both.sample_ray({25, 20}, {0.2f, 0.6f}),
                  second = both.sample_ray({40, 20}, {0.2f, 0.6f});
  EXPECT_NEAR(both.eval(first.ray.o, first.ray.d)->pdf_position, 1 / 3.0, 1e-5);
  EXPECT_NEAR(both.eval(second.ray.o, second.ray.d)->pdf_position, 2 / (3 * M_PI * 0.25), 1e-5);
}

// Meters on shapes. Which point a ray begins at is the place on the film, which `eval` is told.
class InverseOfMeter : public ::testing::TestWithParam<Case> {};

const std::string kMeter = "<sensor type='irradiancemeter'/></shape>";
const Case kMeters[] = {
    {"rectangle", R"(<shape type="rectangle"><transform name="to_world"><scale x="2" y="0.7"/>
       <rotate x="1" y="2" angle="50"/><translate x="1" y="-2" z="0.5"/></transform>)" +
                      kMeter},
    {"sphere", R"(<shape type="sphere"><float name="radius" value="0.7"/><point name="center" x="1" y="-1"
       z="0"/>)" + kMeter},
    {"flat_cylinder", R"(<shape type="cylinder"><transform name="to_world"><scale x="0.2" y="1.5" z="0.8"/>
       <rotate y="1" angle="20"/></transform>)" +
                          kMeter},
    {"cube", R"(<shape type="cube"><transform name="to_world"><scale x="0.3" y="1.5" z="0.8"/></transform>)" +
                 kMeter}};

struct PlacedMeter {
  explicit PlacedMeter(const std::string& xml)
      : object(build_object(xml)), asset(dynamic_cast<const Asset&>(*object)) {
    sensor = PlacedSensor::of(*asset.sensor(), asset.sensor_area(), {}, 3);
  }
  std::shared_ptr<Object> object;
  const Asset& asset;
  PlacedSensor sensor;
};

// Densities are those of neighbouring rays: the area of the surface and the solid angle that they enclose.
TEST_P(InverseOfMeter, DensitiesAreThoseOfNeighbouringRays) {
  const PlacedMeter meter(GetParam().xml);
  const PlacedSensor& sensor = meter.sensor;
  SeededRandom random(6);
  constexpr float kStep = 1e-3f;
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2 u = random.next2(), lens = random.next2();
    const Vec2 film{0.01f + 0.98f * u.x, 0.01f + 0.98f * u.y},
        at{0.01f + 0.98f * lens.x, 0.01f + 0.98f * lens.y};
    const SensorRay s = sensor.sample_ray(film, at);
    const Vec3 p = s.ray.o + s.ray.d * (0.5f + random.next());
    const auto found = sensor.eval(p, s.ray.d, film);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->film.x, film.x);
    EXPECT_EQ(found->film.y, film.y);
    EXPECT_EQ(found->weight, s.weight);
    EXPECT_FALSE(sensor.eval(p, s.ray.d)) << "the place is not known";
    EXPECT_FALSE(sensor.eval(s.ray.o - s.ray.d, s.ray.d, film)) << "behind the surface";
    bool is_smooth = true;
    const auto derivative = [&](Vec2 on_film, Vec2 on_lens, Vec3 (*get)(const SensorRay&)) {
      const auto beside = [&](float step) {
        return get(sensor.sample_ray({film.x + step * on_film.x, film.y + step * on_film.y},
                                     {at.x + step * on_lens.x, at.y + step * on_lens.y}));
      };
      const Vec3 ahead = beside(kStep) - get(s), behind = get(s) - beside(-kStep);
      is_smooth &= length(ahead - behind) < 0.01f * length(ahead + behind);
      return (ahead + behind) * (0.5f / kStep);
    };
    const auto origin = [](const SensorRay& r) { return r.ray.o; };
    const auto direction = [](const SensorRay& r) { return r.ray.d; };
    const double place =
        1 / double(length(cross(derivative({1, 0}, {}, origin), derivative({0, 1}, {}, origin))));
    const double angle =
        1 / double(length(cross(derivative({}, {1, 0}, direction), derivative({}, {0, 1}, direction))));
    // Rays of two faces or of two parts of a square are no neighbours.
    if (!is_smooth) continue;
    ++compared;
    EXPECT_NEAR(found->pdf_position, place, 0.02 * place);
    EXPECT_NEAR(found->pdf_direction, angle, 0.02 * angle);
    const double distance = length(p - s.ray.o);
    EXPECT_NEAR(found->pdf_across, angle / (distance * distance), 0.02 * angle / (distance * distance));
  }
  EXPECT_GT(compared, 1000);
}

// A connection finds the place on the film from which the sensor's own ray begins.
TEST_P(InverseOfMeter, ConnectionsSayWhichPlaceTheyLeadTo) {
  const PlacedMeter meter(GetParam().xml);
  const PlacedSensor& sensor = meter.sensor;
  SeededRandom random(7);
  int connected = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 from = square_to_uniform_sphere(random.next2()) * 3.f;
    const auto c = sensor.sample_direct(from, random.next2());
    if (!c) continue;
    ++connected;
    ASSERT_TRUE(sensor.part.samples(c->film));
    const SensorRay ray = sensor.sample_ray(c->film, random.next2());
    EXPECT_LT(length(ray.ray.o - c->p), 1e-5f);
    EXPECT_TRUE(sensor.eval(from, -c->wo, c->film));
  }
  EXPECT_GT(connected, 300);
}

INSTANTIATE_TEST_SUITE_P(Sensors, InverseOfMeter, ::testing::ValuesIn(kMeters),
                         [](const auto& info) { return info.param.name; });

// Both members see the ray, with other places in mind.
TEST(SensorInverse, OfABatchIsThatOfTheSensorThatSees) {
  const std::string look = R"(<sensor type="orthographic"><transform name="to_world"><lookat origin="0, 0, 5"
    target="0, 0, 0" up="0, 1, 0"/></transform></sensor>)";
  const auto object = build_object("<sensor type='batch'>" + kFilm + look + look + "</sensor>");
  const PlacedSensor both = PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {}, 2);
  for (const Vec2 film : {Vec2{25, 20}, Vec2{45, 20}}) {
    const Ray ray = both.sample_ray(film, {}).ray;
    const auto found = both.eval(ray.o + ray.d, ray.d, film);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->film.x, film.x, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, InverseOfSensor, ::testing::ValuesIn(kCases),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace aureole::testing
