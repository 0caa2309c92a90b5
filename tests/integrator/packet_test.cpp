// SPDX-License-Identifier: Apache-2.0
// Rays in packets and paths in lock-step give the same bits as one by one.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/loading/load.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/scene/scene.h"

namespace aureole::testing {
namespace {

/// Triangles, spheres, glass, a mask of half opacity and two lamps.
LoadedScene mixed_scene(const std::string& integrator) {
  return load_scene_from_string(R"(<scene version="3.0.0">)" + integrator +
                                    R"(<sensor type="perspective"><sampler type="sobol"/>
            <transform name="to_world"><lookat origin="0, 1, 3.6" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
          <shape type="cube"><transform name="to_world"><scale value="4"/></transform><boolean name="flip_normals" value="true"/>
            <bsdf type="diffuse"><rgb name="reflectance" value=".7, .5, .3"/></bsdf></shape>
          <shape type="sphere"><point name="center" value="-1, 0, 0"/><bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf></shape>
          <shape type="sphere"><point name="center" value="1.2, .3, .5"/><bsdf type="plastic"/></shape>
          <shape type="rectangle"><transform name="to_world"><translate z="2"/></transform>
            <bsdf type="mask"><float name="opacity" value=".5"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf></shape>
          <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="3.5"/></transform><emitter type="area"/></shape>
          <emitter type="point"><point name="position" value="2, 2, 2"/></emitter></scene>)",
                                "packets.xml");
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// A group of every kind of shape and another within it, five times: moved, turned and stretched, mirrored,
/// flat and overlapping.
LoadedScene instanced_scene(const std::string& others) {
  const std::string file =
      (std::filesystem::temp_directory_path() / ("aureole-packets-" + std::to_string(::getpid()) + ".txt"))
          .string();
  std::ofstream(file) << "-1 -.8 0 .2\n-.4 -.6 .2 .3\n.3 -.9 .1 .25\n1 -.7 0 .2\n";
  const std::string name = R"(<string name="filename" value=")" + file + R"("/>)";
  auto scene = load_scene_from_string(
      R"(<scene version="3.0.0"><sensor type="perspective"/>
          <shape type="shapegroup" id="inner">
            <shape type="sphere"><point name="center" value=".2, .9, .1"/><float name="radius" value=".3"/></shape>
            <shape type="cube"><transform name="to_world"><scale value=".2"/><translate x="-.9" y=".6"/></transform></shape>
          </shape>
          <shape type="shapegroup" id="group">
            <shape type="cube"><transform name="to_world"><scale value=".35"/><rotate y="1" angle="30"/></transform></shape>
            <shape type="sphere"><point name="center" value=".8, 0, 0"/><float name="radius" value=".4"/></shape>
            <shape type="disk"><transform name="to_world"><scale value=".5"/><translate x="-.8" z=".3"/></transform></shape>
            <shape type="cylinder"><point name="p0" value="0, .2, .5"/><point name="p1" value=".5, .6, 1"/>
              <float name="radius" value=".2"/></shape>
            <shape type="linearcurve">)" +
          name + R"(</shape>
            <shape type="bsplinecurve">)" +
          name + R"(<transform name="to_world"><translate z="-.7"/></transform></shape>
            <shape type="instance"><ref id="inner"/>
              <transform name="to_world"><rotate x="1" angle="40"/><translate y=".1"/></transform></shape>
          </shape>
          <shape type="instance"><ref id="group"/><transform name="to_world"><translate x="-1.6"/></transform></shape>
          <shape type="instance"><ref id="group"/><transform name="to_world"><scale x=".6" y="1.5" z=".9"/>
            <rotate z="1" angle="35"/><rotate x="1" angle="-20"/><translate x="1.5" y=".6"/></transform></shape>
          <shape type="instance"><ref id="group"/><transform name="to_world"><scale x="-1" y="1" z="1.3"/>
            <rotate y="1" angle="25"/><translate y="-1.4" z=".5"/></transform></shape>
          <shape type="instance"><ref id="group"/><transform name="to_world"><scale x="1" y="1" z=".001"/>
            <translate y="1.7" z="-.5"/></transform></shape>
          <shape type="instance"><ref id="group"/><transform name="to_world"><rotate y="1" angle="10"/><translate x="-1.4" y=".1"/></transform></shape>
          )" +
          others + "</scene>",
      "instances.xml");
  std::filesystem::remove(file);
  return scene;
}

/// Leaves on the stack what code that reads more than it wrote will see: Embree may loop for ever then.
[[gnu::noinline]] void dirty_stack() {
  char garbage[1 << 17];
  std::memset(garbage, 0x5a, sizeof garbage);
  asm volatile("" : : "r"(garbage) : "memory");
}

struct Answers {
  int met = 0, blocked = 0;
  std::array<int, 8> of_geometry{};  ///< of the index within a shape
};

/// Expects the bits of rays one by one from packets of every size.
void compare_packets(const RayTracer& tracer, Answers& answers, const auto& is_segment,
                     const auto& is_spline) {
  SeededRandom random(1);
  for (int k = 0; k < 3000; ++k) {
    const int n = 1 + k % RayPacket::kSize;
    Ray rays[RayPacket::kSize];
    for (int i = 0; i < n; ++i) {
      rays[i].o = square_to_uniform_sphere(random.next2()) * (3 * random.next());
      rays[i].d = square_to_uniform_sphere(random.next2());
      // As a camera's: from one point, in nearly one direction.
      if (k % 3 == 0 && i > 0) rays[i].o = rays[0].o, rays[i].d = normalize(rays[0].d + rays[i].d * .2f);
      // Along the axes: divisions by zero.
      if (k % 5 == 0) rays[i].d[i % 3] = 0;
      rays[i].t_max = k % 2 ? 2.f : kInfinity;
    }
    RayPacket packet;
    for (int i = 0; i < n; ++i) packet.set(i, rays[i]);
    for (const auto kind : {RayTracer::Rays::coherent, RayTracer::Rays::incoherent}) {
      RayTracer::Hit hits[RayPacket::kSize];
      bool blocked[RayPacket::kSize];
      if (k < 200) dirty_stack();
      tracer.intersect(packet, n, kind, hits);
      if (k < 200) dirty_stack();
      tracer.occluded(packet, n, blocked);
      for (int i = 0; i < n; ++i) {
        const RayTracer::Hit one = tracer.intersect(rays[i]);
        ASSERT_EQ(bool(one), bool(hits[i]));
        ASSERT_EQ(tracer.occluded(rays[i]), blocked[i]);
        answers.blocked += blocked[i];
        if (!one) continue;
        ++answers.met;
        ++answers.of_geometry.at(one.geometry);
        ASSERT_EQ(one.shape, hits[i].shape);
        ASSERT_EQ(one.geometry, hits[i].geometry);
        if (is_spline(one)) {
          // Embree turns a ray to a spline with reciprocal roots that differ by the width of the packet.
          ASSERT_EQ(one.primitive, hits[i].primitive);
          ASSERT_NEAR(one.t, hits[i].t, 1e-5f * (1 + one.t));
          ASSERT_NEAR(one.u, hits[i].u, 1e-4f);
          continue;
        }
        ASSERT_TRUE(same_bits(one.t, hits[i].t));
        // Two segments of a curve share a ball, where the first to be tested is met.
        if (one.primitive != hits[i].primitive && is_segment(one)) continue;
        ASSERT_EQ(one.primitive, hits[i].primitive);
        ASSERT_TRUE(same_bits(one.u, hits[i].u) && same_bits(one.v, hits[i].v));
      }
    }
  }
}

TEST(Packets, RayTracerAnswersAsOneByOne) {
  Answers answers;
  const auto no = [](const RayTracer::Hit&) { return false; };
  compare_packets(mixed_scene("").scene->tracer(), answers, no, no);
  EXPECT_GT(answers.met, 20000);
  EXPECT_GT(answers.blocked, 20000);
}

TEST(Packets, InstancesAnswerAsOneByOne) {
  // With nothing else in the scene, no other traversal cleans the stack.
  for (const char* others : {"", R"(
          <shape type="sphere"><point name="center" value="0, 0, -1.8"/><float name="radius" value=".5"/></shape>
          <shape type="cube"><transform name="to_world"><scale value=".3"/><translate z="2"/></transform></shape>
          <shape type="cube"><transform name="to_world"><scale value="4"/></transform><boolean name="flip_normals" value="true"/></shape>)"}) {
    Answers answers;
    compare_packets(
        instanced_scene(others).scene->tracer(), answers,
        [](const RayTracer::Hit& hit) { return hit.geometry == 4; },
        [](const RayTracer::Hit& hit) { return hit.geometry == 5; });
    EXPECT_GT(answers.met, 15000);
    EXPECT_GT(answers.blocked, 15000);
    for (int geometry = 1; geometry < 6; ++geometry)
      EXPECT_GT(answers.of_geometry[size_t(geometry)], 300) << geometry;
  }
}

class LockStep : public ::testing::TestWithParam<const char*> {};

/// The splats of one path of a batch.
std::vector<Splat> splats_of(int path, const std::vector<Splat>& splats) {
  std::vector<Splat> own;
  for (const Splat& s : splats)
    if (s.path == path) own.push_back(s);
  return own;
}

bool same_bits(const Spectrum& a, const Spectrum& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST_P(LockStep, PathsAsOneByOne) {
  const LoadedScene loaded = mixed_scene(GetParam());
  const auto& scene = loaded.scene;
  const Integrator& integrator = *loaded.integrator;
  const Sampler& sampler = scene->sensor().sampler();
  const size_t channels = integrator.aov_names().size();
  int lit = 0;
  for (std::uint64_t pixel = 0; pixel < 400; ++pixel) {
    const size_t n = 1 + pixel % 40;  // up to three packets of rays
    std::vector<Path> paths(n);
    std::vector<float> together(n * channels), alone(channels);
    for (size_t i = 0; i < n; ++i) {
      Path& p = paths[i];
      p.samples = SampleStream(sampler, pixel * 0x9e3779b97f4a7c15u, std::uint32_t(i));
      p.wavelengths = scene->wavelengths().sample(p.samples.get1(2));
      p.ray =
          scene->sensor()
              .sample_ray({768.f * float(pixel) / 400 + 40 * p.samples.get1(0), 576 * p.samples.get1(1)}, {})
              .ray;
      p.samples.set_first(SampleStream::camera_dimensions(false));
      p.aovs = together.data() + i * channels;
    }
    const std::vector<Path> copies = paths;
    std::vector<Splat> splats;
    integrator.trace(*scene, paths, splats, {});
    for (size_t i = 0; i < n; ++i) {
      Path one = copies[i];
      one.aovs = alone.data();
      std::vector<Splat> expected;
      int lines = 0;
      const PathLog log = [&](const PathEvent&) { ++lines; };
      integrator.trace(*scene, std::span(&one, 1), expected, BatchLog(log, 0));
      ASSERT_TRUE(same_bits(one.result.estimate, paths[i].result.estimate)) << "pixel " << pixel;
      ASSERT_EQ(one.result.alpha, paths[i].result.alpha);
      for (size_t c = 0; c < channels; ++c) ASSERT_TRUE(same_bits(alone[c], together[i * channels + c]));
      const std::vector<Splat> own = splats_of(int(i), splats);
      ASSERT_EQ(own.size(), expected.size());
      for (size_t k = 0; k < own.size(); ++k) {
        ASSERT_TRUE(same_bits(own[k].estimate, expected[k].estimate));
        ASSERT_TRUE(same_bits(own[k].film.x, expected[k].film.x) &&
                    same_bits(own[k].film.y, expected[k].film.y));
      }
      lit += !is_black(one.result.estimate) || !own.empty();
    }
  }
  // Glass in front shows no direct light, and is passed by no connection with the sensor.
  EXPECT_GT(lit, integrator.leaves() == Integrator::Leaves::film ? 300 : 400);
}

/// A sphere of glowing fog, and one of skin, before the integrators that can follow light there.
#define FOG                                                                                         \
  "<shape type='sphere'><point name='center' value='0, .5, 1.5'/><float name='radius' value='.6'/>" \
  "<bsdf type='null'/><medium name='interior' type='homogeneous'><float name='sigma_t' value='2'/>" \
  "<float name='albedo' value='.6'/><spectrum name='emission' value='.2'/></medium></shape>"
#define SKIN                                                                                      \
  "<shape type='sphere'><point name='center' value='0, -1, 1'/><float name='radius' value='.5'/>" \
  "<bssrdf type='dipole'><float name='sigma_t' value='9'/><float name='albedo' value='.9'/></bssrdf></shape>"

INSTANTIATE_TEST_SUITE_P(Media, LockStep,
                         ::testing::Values(FOG SKIN "<integrator type='path'/>",
                                           FOG SKIN "<integrator type='ptracer'/>",
                                           FOG "<integrator type='direct'/>",
                                           FOG "<integrator type='bdpt'/>"));
INSTANTIATE_TEST_SUITE_P(
    Depths, LockStep,
    ::testing::Values(R"(<integrator type="path"/>)",
                      R"(<integrator type="path"><integer name="max_depth" value="4"/></integrator>)",
                      R"(<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>)",
                      R"(<integrator type="direct"/>)", R"(<integrator type="ptracer"/>)",
                      R"(<integrator type="bdpt"/>)", R"(<integrator type="depth"/>)",
                      R"(<integrator type="moment"><integrator type="aov">
                           <string name="aovs" value="p:position, a:albedo"/>
                           <integrator type="direct"><integer name="shading_samples" value="2"/></integrator>
                         </integrator></integrator>)"),
    [](const auto& info) { return "Integrator" + std::to_string(info.index); });

}  // namespace
}  // namespace aureole::testing
