// SPDX-License-Identifier: Apache-2.0
// Visibility: neither the surface from which a connection starts nor the light's own occludes it, and
// occluders are never missed.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "aureole/loading/load.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/connection.h"

namespace aureole::testing {
namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", v);
  return text;
}
std::string translate(const Vec3& v) {
  return "<translate x=\"" + number(v.x) + "\" y=\"" + number(v.y) + "\" z=\"" + number(v.z) + "\"/>";
}
std::string rotate(const Vec3& axis, double degrees) {
  return "<rotate x=\"" + number(axis.x) + "\" y=\"" + number(axis.y) + "\" z=\"" + number(axis.z) +
         "\" angle=\"" + number(degrees) + "\"/>";
}
std::string shape(const std::string& type, const std::string& transform, const std::string& content = "") {
  return "<shape type=\"" + type + "\"><transform name=\"to_world\">" + transform + "</transform>" + content +
         "</shape>";
}
const std::string kLight = "<emitter type=\"area\"/>";

std::shared_ptr<const Scene> scene_with(const std::string& content) {
  return load_scene_from_string(
             "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor "
             "type=\"perspective\"><film type=\"hdrfilm\"/></sensor>" +
                 content + "</scene>",
             "connect.xml")
      .scene;
}

/// The fraction of light that passes from a surface point to a light.
Spectrum passed(const Scene& scene, const SurfacePoint& from, const DirectSample& to, const Wavelengths& w) {
  TestSegment c;
  if (to.infinite)
    c.set(RayOrigin::of(from).spawn(to.wo));
  else
    c.set(RayOrigin::of(from), to.wo, RayOrigin::of(to));
  c.passage = 1.f;
  return is_visible(scene, c, w) ? c.passage : 0.f;
}

struct Found {
  int connections = 0, blocked = 0, grazing = 0, within_rounding = 0;
};

/// Connects random points of shape `receiver`, found by rays from `around`, to random points of all emitters;
/// counts what is blocked though nothing lies between.
Found connect_all(const Scene& scene, SeededRandom& random, std::size_t receiver, const Vec3& around,
                  float distance, int n) {
  Found found;
  const Wavelengths w = Wavelengths::at(scene.wavelengths().grid(), 550.f);
  for (int k = 0; k < n; ++k) {
    const Vec3 o = around + square_to_uniform_sphere(random.next2()) * distance;
    const Vec3 aim =
        around + (Vec3{random.next(), random.next(), random.next()} - Vec3{0.5f, 0.5f, 0.5f}) * 2.f;
    const auto point = scene.intersect({o, normalize(aim - o), kInfinity});
    if (!point || point->shape != scene.parts().surfaces[receiver].shape.get()) continue;
    for (const Light& e : scene.emitters())
      for (std::size_t part = 0; part < e.part_count(); ++part) {
        const auto s = e.sample_direct(point->p, part, random.next2(), w);
        if (!s) continue;
        // Convex bodies block what leaves through their inside: those connections count as true occlusion.
        if (dot(s->wo, point->ng) <= 0) continue;
        ++found.connections;
        found.grazing +=
            std::abs(dot(s->wo, point->ng)) < 1e-3f || (!s->infinite && std::abs(dot(s->wo, s->ng)) < 1e-3f);
        const bool blocked = is_black(passed(scene, *point, *s, w));
        // An end that lies nearer to the other's plane than the coordinates' rounding allows to know may be
        // on its other side: at 1e4 that is at angles of a thousandth.
        const Vec3 magnitude = abs(point->p);
        const float known = 2e-6f * (magnitude.x + magnitude.y + magnitude.z);
        const float above = dot(s->wo, point->ng) * length(s->p - point->p);
        const float before = -dot(s->wo, s->ng) * length(s->p - point->p);
        if (s->infinite || s->delta || (above > known && before > known))
          found.blocked += blocked;
        else
          found.within_rounding += blocked;
      }
  }
  return found;
}

TEST(Connect, NothingBlocksItself) {
  SeededRandom random(1);
  int connections = 0, grazing = 0, within_rounding = 0;
  for (const float offset : {0.f, 1.f, 100.f, 1e4f})
    for (const char* receiver : {"rectangle", "sphere", "cube"})
      for (const char* light : {"rectangle", "sphere", "cube"})
        for (int turned = 0; turned < 2; ++turned) {
          // The receiver at the offset, untilted first: its planes are coordinate planes through zero or the
          // offset itself.
          const Vec3 at{offset, -offset, offset * 0.7f};
          const std::string tilt = turned ? rotate({1, 2, 3}, 40) : "";
          const std::string light_tilt = turned ? rotate({3, 1, -2}, 130) : rotate({1, 0, 0}, 180);
          const auto scene = scene_with(
              shape(receiver, tilt + translate(at)) +
              shape(light, "<scale value=\"0.5\"/>" + light_tilt + translate(at + Vec3{0.3f, 0.4f, 2.5f}),
                    kLight));
          const Found f = connect_all(*scene, random, 0, at, 6, 4000);
          EXPECT_EQ(f.blocked, 0) << f.connections << " connections from a " << receiver << " to a " << light
                                  << " at offset " << offset << (turned ? ", turned" : "");
          connections += f.connections, grazing += f.grazing, within_rounding += f.within_rounding;
        }
  EXPECT_GT(connections, 100000);
  EXPECT_LT(within_rounding, connections / 5000);
  RecordProperty("within_rounding", within_rounding);
  RecordProperty("connections", connections);
  RecordProperty("grazing", grazing);
}

TEST(Connect, GrazingLights) {
  SeededRandom random(2);
  int connections = 0, grazing = 0;
  for (const float offset : {0.f, 7.3f, 1e4f}) {
    const Vec3 at{offset, offset, offset};
    // A light that stands upright on the floor: seen at all angles down to none from either side.
    for (const char* light : {"rectangle", "cube", "sphere"}) {
      // Gaps of a few roundings of the coordinates, of which there are 1e-3 at 1e4, are no gaps.
      const float lift = std::string(light) == "rectangle" ? 1.f : 1.001f + 1e-5f * offset;
      const auto scene =
          scene_with(shape("rectangle", "<scale value=\"30\"/>" + translate(at)) +
                     shape(light, rotate({0, 1, 0}, 90) + translate(at + Vec3{1.5f, 0, lift}), kLight));
      const Found f = connect_all(*scene, random, 0, at, 3, 8000);
      // The floor hides everything below it; the rectangle's lower edge lies in the floor.
      EXPECT_EQ(f.blocked, 0) << light << " at " << offset << " of " << f.connections;
      connections += f.connections, grazing += f.grazing;
    }
    // A flat floor far into the distance.
    const auto scene = scene_with(
        shape("rectangle", "<scale value=\"500\"/>" + translate(at)) +
        shape("rectangle", rotate({1, 0, 0}, 180) + translate(at + Vec3{0, 0, 0.01f + 2e-5f * offset}),
              kLight));
    const Wavelengths w = Wavelengths::at(scene->wavelengths().grid(), 550.f);
    int blocked = 0;
    for (int k = 0; k < 20000; ++k) {
      const float a = 6.2831853f * random.next(), r = 2 + 300 * random.next() * random.next();
      const Vec3 above = at + Vec3{r * std::cos(a), r * std::sin(a), 1};
      const auto point = scene->intersect({above, {0, 0, -1}, kInfinity});
      ASSERT_TRUE(point);
      const auto s = scene->emitters()[0].sample_direct(point->p, 0, random.next2(), w);
      if (!s || dot(s->wo, point->ng) <= 0) continue;
      ++connections, ++grazing;
      blocked += is_black(passed(*scene, *point, *s, w));
    }
    EXPECT_EQ(blocked, 0) << "far floor at " << offset;
  }
  EXPECT_GT(connections, 50000);
  EXPECT_GT(grazing, 1000);
}

TEST(Connect, EnvironmentAndPointLights) {
  SeededRandom random(3);
  int connections = 0;
  for (const float offset : {0.f, 1e4f})
    for (const char* receiver : {"rectangle", "sphere", "cube"}) {
      const Vec3 at{offset, -offset, offset};
      const auto scene = scene_with(shape(receiver, rotate({1, 2, 3}, offset > 0 ? 35 : 0) + translate(at)) +
                                    "<emitter type=\"constant\"/>" +
                                    "<emitter type=\"point\"><transform name=\"to_world\">" +
                                    translate(at + Vec3{0.2f, -0.3f, 4}) + "</transform></emitter>");
      const Found f = connect_all(*scene, random, 0, at, 5, 6000);
      EXPECT_EQ(f.blocked, 0) << receiver << " at " << offset << " of " << f.connections;
      connections += f.connections;
    }
  EXPECT_GT(connections, 15000);
}

/// A text file that a shape reads, removed at the end.
class TriangleFile {
public:
  TriangleFile() {
    path_ =
        std::filesystem::temp_directory_path() / ("aureole-connect-" + std::to_string(::getpid()) + ".obj");
    std::ofstream(path_) << "v -1 -0.7 0\nv 1.1 -0.6 0\nv 0.2 1.3 0\nf 1 2 3\n";
  }
  ~TriangleFile() { std::filesystem::remove(path_); }
  std::string shape(const std::string& transform, const std::string& content = "") const {
    return "<shape type=\"obj\"><string name=\"filename\" value=\"" + path_.string() +
           "\"/><transform name=\"to_world\">" + transform + "</transform>" + content + "</shape>";
  }

private:
  std::filesystem::path path_;
};

TEST(Connect, RandomTriangles) {
  SeededRandom random(6);
  const TriangleFile triangle;
  int connections = 0, within_rounding = 0;
  for (int k = 0; k < 120; ++k) {
    const float offset = k % 4 == 0 ? 0.f : std::pow(10.f, 4 * random.next());
    const Vec3 at = square_to_uniform_sphere(random.next2()) * offset;
    const auto turn = [&] { return rotate(square_to_uniform_sphere(random.next2()), 360 * random.next()); };
    const Vec3 apart = square_to_uniform_sphere(random.next2()) * 3.f;
    const auto scene = scene_with(triangle.shape(turn() + translate(at)) +
                                  triangle.shape(turn() + translate(at + apart), kLight));
    const Found f = connect_all(*scene, random, 0, at, 4, 3000);
    EXPECT_EQ(f.blocked, 0) << "at offset " << offset << " of " << f.connections;
    connections += f.connections, within_rounding += f.within_rounding;
  }
  EXPECT_GT(connections, 20000);
  EXPECT_LT(within_rounding, connections / 2000);
  RecordProperty("connections", connections);
  RecordProperty("within_rounding", within_rounding);
}

TEST(Connect, OccludersAreFound) {
  SeededRandom random(4);
  int tests = 0;
  for (const float offset : {0.f, 100.f, 1e4f})
    for (const char* occluder : {"rectangle", "sphere", "cube"}) {
      const Vec3 at{offset, offset, -offset};
      const auto scene = scene_with(
          shape("rectangle", translate(at)) +
          shape("rectangle",
                "<scale value=\"0.5\"/>" + rotate({1, 0, 0}, 180) + translate(at + Vec3{0, 0, 2}), kLight) +
          // Large enough to hide the light from all of the receiver.
          shape(occluder, "<scale value=\"" + std::string(occluder[0] == 's' ? "2" : "3") + "\"/>" +
                              (occluder[0] == 'r' ? translate(at + Vec3{0, 0, 1.9f})
                                                  : "<scale value=\"0.3\"/><scale value=\"1\"/>" +
                                                        translate(at + Vec3{0, 0, 1}))));
      const Wavelengths w = Wavelengths::at(scene->wavelengths().grid(), 550.f);
      for (int k = 0; k < 4000; ++k) {
        const Vec3 o = at + Vec3{1.2f * random.next() - 0.6f, 1.2f * random.next() - 0.6f, -1};
        auto point = scene->intersect({o, {0, 0, 1}, kInfinity});
        ASSERT_TRUE(point);
        ASSERT_EQ(point->shape, scene->parts().surfaces[0].shape.get());
        const auto s = scene->emitters()[0].sample_direct(point->p, 0, random.next2(), w);
        ASSERT_TRUE(s);
        // The reference: does the segment pass the body? A plane always; a ball of radius 0.6 where it comes
        // near enough, with a margin for the coordinates' rounding; a cube of half edge 0.9 always.
        if (occluder[0] == 's') {
          const Vec3 c = point->p - (at + Vec3{0, 0, 1});
          const float b = dot(c, s->wo), distance = std::sqrt(std::max(0.f, dot(c, c) - b * b));
          if (distance > 0.6f - 0.01f) continue;
        }
        ++tests;
        ASSERT_TRUE(is_black(passed(*scene, *point, *s, w))) << occluder << " at " << offset;
      }
    }
  EXPECT_GT(tests, 20000);
}

TEST(Connect, ThinGapsAreSeenThroughAndThinOccludersAreNot) {
  // A sheet a ten-thousandth before the light hides it; one just behind it, or just under the floor, does
  // not.
  SeededRandom random(5);
  for (const float z : {1.9999f, 2.0001f, -0.0001f, 0.0001f}) {
    const auto scene = scene_with(shape("rectangle", "") +
                                  shape("rectangle", rotate({1, 0, 0}, 180) + translate({0, 0, 2}), kLight) +
                                  shape("rectangle", "<scale value=\"50\"/>" + translate({0, 0, z})));
    const Wavelengths w = Wavelengths::at(scene->wavelengths().grid(), 550.f);
    const auto start = scene->intersect({{0.1f, 0.2f, z < 0.5f ? 0.00005f : 1.f}, {0, 0, -1}, kInfinity});
    ASSERT_TRUE(start);
    ASSERT_EQ(start->shape, scene->parts().surfaces[0].shape.get());
    for (int k = 0; k < 2000; ++k) {
      const auto s = scene->emitters()[0].sample_direct(start->p, 0, random.next2(), w);
      ASSERT_TRUE(s);
      ASSERT_EQ(is_black(passed(*scene, *start, *s, w)), z > 0 && z < 2) << z;
    }
  }
}

TEST(Visibility, ALightOnAPassableSurfaceEndsTheConnection) {
  // A point light at the pole of a sphere that half of the light passes, and connections from around it. That
  // they end is the test: once past the light, they went back and forth through the surface.
  const auto scene = load_scene_from_string(R"(<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective"><film type="hdrfilm"/></sensor>
<shape type="sphere"><point name="center" x="0" y="0" z="1"/>
  <bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="diffuse"/></bsdf></shape>
<emitter type="point"/>
</scene>)",
                                            "pole.xml")
                         .scene;
  const Wavelengths w = scene->wavelengths().sample(0.3f, 0.4f);
  int ended = 0;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      SurfacePoint from;
      from.p = {float(i) * 0.1f - 1.95f, float(j) * 0.1f - 1.95f, i % 2 ? 3.f : -1.f};
      from.ng = {0, 0, i % 2 ? -1.f : 1.f};
      const auto direct = scene->emitters().front().sample_direct(from.p, 0, {0.5f, 0.5f}, w);
      ASSERT_TRUE(direct.has_value());
      const Spectrum fraction = passed(*scene, from, *direct, w);
      // Once or twice through the sphere, or not at all where rounding puts the light before the surface.
      const float p = fraction[0];
      EXPECT_TRUE(p == 1 || p == 0.5f || p == 0.25f || p == 0.125f) << p;
      ++ended;
    }
  EXPECT_EQ(ended, 1600);
}

// Both endpoints lie on one null surface, beyond which rounding moves one or the other: the march must end.
TEST(Connections, WithinThePlaneOfAPassableSurfaceEnd) {
  const auto scene = scene_with(
      shape("rectangle", rotate({1, 2, 3}, 37) + translate({0.3f, -0.2f, 0.7f}),
            R"(<bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="diffuse"/></bsdf>)"));
  SeededRandom random(9);
  const Wavelengths w = scene->wavelengths().sample(0.3f);
  std::vector<SurfacePoint> points;
  while (points.size() < 200) {
    const Vec3 target{0.3f + random.next() - 0.5f, -0.2f + random.next() - 0.5f, 0.7f + random.next() - 0.5f};
    const Vec3 from{5, 4, 6};
    if (const auto p = scene->intersect(Ray{from, normalize(target - from), kInfinity})) points.push_back(*p);
  }
  int connections = 0;
  for (const SurfacePoint& a : points)
    for (const SurfacePoint& b : points) {
      const Vec3 to = b.p - a.p;
      if (!(length_squared(to) > 0)) continue;
      TestSegment c;
      c.set(RayOrigin::of(a), normalize(to), RayOrigin::of(b));
      c.passage = 1.f;
      is_visible(*scene, c, w);
      ++connections;
    }
  EXPECT_GT(connections, 30000);
}

}  // namespace
}  // namespace aureole::testing
