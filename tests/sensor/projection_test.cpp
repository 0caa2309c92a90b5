// SPDX-License-Identifier: Apache-2.0
// Cameras against closed forms: fields of view, the circle of confusion, parallel projection; the errors.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/math/significance.h"
#include "aureole/sensor/placed_sensor.h"
#include "tests/harness/properties_builder.h"

namespace aureole::testing {
namespace {

std::string film(int width, int height, const std::string& rest = "") {
  return "<film type='hdrfilm'><integer name='width' value='" + std::to_string(width) +
         "'/><integer name='height' value='" + std::to_string(height) + "'/>" + rest + "</film>";
}
/// A sensor in a scene of radius one around the origin.
struct Placed : PlacedSensor {
  std::shared_ptr<const Sensor> kept;
};
std::shared_ptr<const Placed> sensor(const std::string& type, const std::string& rest) {
  const std::shared_ptr<const Sensor> made =
      build<Sensor>("<sensor type='" + type + "'>" + rest + "</sensor>");
  return std::make_shared<const Placed>(Placed{PlacedSensor::of(*made, nullptr, {}, 1), made});
}
std::string error(const std::string& type, const std::string& rest) {
  try {
    sensor(type, rest);
    return "";
  } catch (const Error& e) {
    return e.message();
  }
}
std::string number(const char* name, double v) {
  return std::string("<float name='") + name + "' value='" + std::to_string(v) + "'/>";
}

/// Angle in degrees between the rays of two places on the film.
double angle(const PlacedSensor& s, Vec2 a, Vec2 b) {
  const Vec3 d = s.sample_ray(a, {0.5f, 0.5f}).ray.d, e = s.sample_ray(b, {0.5f, 0.5f}).ray.d;
  return 2 * std::atan2(double(length(d - e)), double(length(d + e))) * 180 / M_PI;
}

TEST(Projection, FieldsOfView) {
  for (const char* type : {"perspective", "thinlens"}) {
    const std::string lens =
        type[0] == 't' ? "<float name='aperture_radius' value='0'/><float name='focus_distance' value='3'/>"
                       : "";
    const auto with = [&](const char* axis, int w, int h) {
      return sensor(type,
                    lens + number("fov", 50) + "<string name='fov_axis' value='" + axis + "'/>" + film(w, h));
    };
    const auto across = [](const PlacedSensor& s, int w, int h) {
      return angle(s, {0, float(h) / 2}, {float(w), float(h) / 2});
    };
    const auto along = [](const PlacedSensor& s, int w, int h) {
      return angle(s, {float(w) / 2, 0}, {float(w) / 2, float(h)});
    };
    const auto diagonal = [](const PlacedSensor& s, int w, int h) {
      return angle(s, {0, 0}, {float(w), float(h)});
    };
    EXPECT_NEAR(across(*with("x", 80, 20), 80, 20), 50, 1e-3);
    EXPECT_NEAR(along(*with("y", 80, 20), 80, 20), 50, 1e-3);
    EXPECT_NEAR(diagonal(*with("diagonal", 80, 20), 80, 20), 50, 1e-3);
    EXPECT_NEAR(along(*with("smaller", 80, 20), 80, 20), 50, 1e-3);
    EXPECT_NEAR(across(*with("smaller", 20, 80), 20, 80), 50, 1e-3);
    EXPECT_NEAR(across(*with("larger", 80, 20), 80, 20), 50, 1e-3);
    EXPECT_NEAR(along(*with("larger", 20, 80), 20, 80), 50, 1e-3);
    // The diagonal of 36 mm x 24 mm behind 50 mm and 35 mm.
    const double full = 2 * std::atan(std::hypot(36, 24) / 100) * 180 / M_PI;
    EXPECT_NEAR(diagonal(*sensor(type, lens + film(30, 20)), 30, 20), full, 1e-3);
    const auto wide = sensor(type, lens + "<string name='focal_length' value='35mm'/>" + film(10, 10));
    EXPECT_NEAR(diagonal(*wide, 10, 10), 2 * std::atan(std::hypot(36, 24) / 70) * 180 / M_PI, 1e-3);
  }
}

TEST(Projection, OrientationAndClipPlanes) {
  const auto s = sensor("perspective",
                        number("fov", 90) + number("near_clip", 2) + number("far_clip", 5) + film(100, 100));
  // Left in the picture is +x, above is +y.
  const Ray left = s->sample_ray({0, 50}, {}).ray, top = s->sample_ray({50, 0}, {}).ray;
  EXPECT_NEAR(left.d.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(left.d.z, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(top.d.y, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(left.o.z, 2, 1e-5);
  EXPECT_NEAR((left.o + left.d * left.t_max).z, 5, 1e-5);
  // The principal point goes to the left and up by fractions of the film.
  const auto shifted =
      sensor("perspective", number("fov", 90) + film(100, 50) + number("principal_point_offset_x", 0.1) +
                                number("principal_point_offset_y", 0.2));
  const Vec3 axis = shifted->sample_ray({40, 15}, {}).ray.d;
  EXPECT_NEAR(axis.z, 1, 1e-6);
  EXPECT_FALSE(s->uses_lens());
}

TEST(ThinLens, CircleOfConfusion) {
  constexpr double kRadius = 0.1, kFocus = 4;
  constexpr int kWidth = 200, kHeight = 100;
  const auto s = sensor("thinlens", number("aperture_radius", kRadius) + number("focus_distance", kFocus) +
                                        number("fov", 30) + film(kWidth, kHeight));
  ASSERT_TRUE(s->uses_lens());
  const double pixels_per_tangent = kWidth / (2 * std::tan(15 * M_PI / 180));
  SeededRandom random(3);
  for (const double z : {1.0, 2.0, 3.9, 4.0, 8.0, 1000.0}) {
    const Vec3 p{float(0.02 * z), float(-0.01 * z), float(z)};
    const double radius = kRadius * std::abs(1 / z - 1 / kFocus) * pixels_per_tangent;
    const double x = kWidth / 2. - 0.02 * pixels_per_tangent, y = kHeight / 2. + 0.01 * pixels_per_tangent;
    double largest = 0, second_moment = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const auto c = s->sample_direct(p, random.next2());
      ASSERT_TRUE(c);
      const double r = std::hypot(c->film.x - x, c->film.y - y);
      largest = std::max(largest, r), second_moment += r * r / n;
    }
    EXPECT_LE(largest, radius + 1e-3) << z;
    EXPECT_GE(largest, 0.995 * radius - 1e-3) << z;
    // A disc, evenly filled: the mean of r^2 is half its square.
    EXPECT_NEAR(second_moment, radius * radius / 2, 0.02 * radius * radius + 1e-5) << z;
  }
}

TEST(ThinLens, WithoutApertureIsThePinhole) {
  const std::string common = number("fov", 50) + film(40, 30);
  const auto pinhole = sensor("perspective", common);
  const auto closed = sensor("thinlens", common + number("aperture_radius", 0));
  for (const Vec2 at : {Vec2{0, 0}, Vec2{11.3f, 7.9f}, Vec2{40, 30}}) {
    const Ray a = pinhole->sample_ray(at, {}).ray, b = closed->sample_ray(at, {0.9f, 0.2f}).ray;
    EXPECT_EQ(a.o, b.o);
    EXPECT_EQ(a.d, b.d);
  }
  EXPECT_FALSE(closed->uses_lens());
}

TEST(ThinLens, RaysOfAPointMeetInTheFocalPlane) {
  const auto s = sensor("thinlens", number("aperture_radius", 0.5) + number("focus_distance", 6) +
                                        "<transform name='to_world'><rotate y='1' angle='30'/><translate "
                                        "x='1' y='2' z='3'/></transform>" +
                                        number("near_clip", 0.5) + film(40, 30));
  SeededRandom random(5);
  for (const Vec2 at : {Vec2{3, 4}, Vec2{20, 15}, Vec2{39, 1}}) {
    const Vec3 axis{0.5f, 0, std::sqrt(0.75f)}, origin{1, 2, 3};
    Vec3 first;
    for (int i = 0; i < 50; ++i) {
      const Ray r = s->sample_ray(at, random.next2()).ray;
      EXPECT_NEAR(dot(r.o - origin, axis), 0.5, 1e-5) << "starts on the near plane";
      const Vec3 p = r.o + r.d * ((6 - dot(r.o - origin, axis)) / dot(r.d, axis));
      if (i == 0) first = p;
      EXPECT_LT(length(p - first), 2e-5);
    }
  }
}

TEST(Orthographic, IsTheSquareScaled) {
  const auto s = sensor("orthographic",
                        "<transform name='to_world'><scale x='3' y='2' z='5'/><translate "
                        "x='1'/></transform>" +
                            number("near_clip", 0.5) + number("far_clip", 8) + film(80, 40));
  // The width is 2, the height follows the film's aspect; +x is left, +y up.
  const Ray corner = s->sample_ray({0, 0}, {}).ray, other = s->sample_ray({80, 40}, {}).ray;
  EXPECT_NEAR(corner.o.x, 1 + 3, 1e-5);
  EXPECT_NEAR(corner.o.y, 0.5 * 2, 1e-5);
  EXPECT_NEAR(other.o.x, 1 - 3, 1e-5);
  EXPECT_NEAR(other.o.y, -0.5 * 2, 1e-5);
  // As Mitsuba: the near plane in camera space, then (far - near) of the scene's units.
  EXPECT_NEAR(corner.o.z, 5 * 0.5, 1e-5);
  EXPECT_NEAR(corner.t_max, 7.5, 1e-5);
  EXPECT_EQ(corner.d, (Vec3{0, 0, 1}));
  EXPECT_EQ(other.d, (Vec3{0, 0, 1}));
  const auto c = s->sample_direct({1, 0, 5}, {});
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->film.x, 40, 1e-4);
  EXPECT_NEAR(c->film.y, 20, 1e-4);
  EXPECT_NEAR(c->importance, 80. * 40 / (6 * 2), 1e-2);
  EXPECT_FALSE(s->sample_direct({1, 0, 2.4f}, {})) << "before the near plane";
  EXPECT_FALSE(s->sample_direct({1, 0, 10.1f}, {})) << "behind the far plane";
}

TEST(Cameras, RefuseWhatMakesNoSense) {
  EXPECT_NE(error("thinlens", "").find("aperture_radius"), std::string::npos);
  EXPECT_NE(error("thinlens", number("aperture_radius", -1)).find("aperture_radius"), std::string::npos);
  EXPECT_NE(error("thinlens", number("aperture_radius", 1) + number("focus_distance", 0)).find("focus"),
            std::string::npos);
  for (const char* type : {"perspective", "thinlens"}) {
    const std::string lens = type[0] == 't' ? number("aperture_radius", 0.1) : "";
    EXPECT_NE(error(type, lens + number("fov", 180)).find("fov"), std::string::npos);
    EXPECT_NE(error(type, lens + number("near_clip", 3) + number("far_clip", 2)).find("far_clip"),
              std::string::npos);
    EXPECT_NE(
        error(type, lens + number("fov", 20) + "<string name='focal_length' value='20mm'/>").find("either"),
        std::string::npos);
    EXPECT_NE(error(type, lens + "<string name='focal_length' value='wide'/>").find("50mm"),
              std::string::npos);
    EXPECT_NE(error(type, lens + "<transform name='to_world'><scale value='2'/></transform>")
                  .find("must not scale"),
              std::string::npos);
  }
  EXPECT_NE(error("orthographic", number("near_clip", 0)).find("near_clip"), std::string::npos);
  EXPECT_NE(error("perspective", "<texture name='srf' type='checkerboard'/>").find("not a picture"),
            std::string::npos);
  EXPECT_NE(error("perspective", "<spectrum name='srf' value='900:1, 950:1'/>").find("sees nothing"),
            std::string::npos);
}

TEST(Cameras, SensorResponseMultipliesTheFilms) {
  const std::string luminance = film(1, 1, "<string name='pixel_format' value='luminance'/>");
  const auto all = sensor("perspective", luminance);
  const auto half = sensor("perspective", luminance + number("srf", 0.5));
  const auto band = sensor("perspective", luminance + "<spectrum name='srf' value='500:1, 600:1'/>");
  for (const float nm : {450.f, 550.f, 650.f}) {
    const Wavelengths w = Wavelengths::at(all->film().properties().context().grid, nm);
    float a[3], b[3], c[3];
    all->film().measure(1.f, w, a);
    half->film().measure(1.f, w, b);
    band->film().measure(1.f, w, c);
    EXPECT_NEAR(b[1], a[1] / 2, 1e-6 * a[1]);
    EXPECT_NEAR(c[1], nm == 550 ? a[1] : 0, 1e-5 * a[1]) << nm;
  }
  EXPECT_NEAR(half->film().response().integral(), all->film().response().integral() / 2, 1e-4);
}

}  // namespace
}  // namespace aureole::testing
