// SPDX-License-Identifier: Apache-2.0
// Rays in packets and paths in lock-step give the same bits as one by one.
#include <gtest/gtest.h>

#include <cstring>

#include "aureole/integrator/integrator.h"
#include "aureole/math/warp.h"
#include "aureole/scene/scene.h"
#include "harness/statistics.h"

namespace aureole::testing {
namespace {

/// Triangles, spheres, glass, a mask of half opacity and two lamps.
std::shared_ptr<const Scene> mixed_scene(const std::string& integrator) {
  return std::make_shared<const Scene>(
      load_scene_from_string(R"(<scene version="3.0.0">)" + integrator +
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
                             "packets.xml"));
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(Packets, RayTracerAnswersAsOneByOne) {
  const auto scene = mixed_scene("");
  TestRandom random(1);
  int met = 0, blocked_count = 0;
  for (int k = 0; k < 3000; ++k) {
    const int n = 1 + k % RayTracer::kPacket;
    Ray rays[RayTracer::kPacket];
    for (int i = 0; i < n; ++i) {
      rays[i].o = square_to_uniform_sphere(random.next2()) * (3 * random.next());
      rays[i].d = square_to_uniform_sphere(random.next2());
      rays[i].t_max = k % 2 ? 2.f : kInfinity;
    }
    for (const auto kind : {RayTracer::Rays::coherent, RayTracer::Rays::incoherent}) {
      RayTracer::Hit hits[RayTracer::kPacket];
      bool blocked[RayTracer::kPacket];
      scene->tracer().intersect(rays, n, kind, hits);
      scene->tracer().occluded(rays, n, kind, blocked);
      for (int i = 0; i < n; ++i) {
        const RayTracer::Hit one = scene->tracer().intersect(rays[i]);
        ASSERT_EQ(bool(one), bool(hits[i]));
        ASSERT_EQ(scene->tracer().occluded(rays[i]), blocked[i]);
        blocked_count += blocked[i];
        if (!one) continue;
        ++met;
        ASSERT_EQ(one.shape, hits[i].shape);
        ASSERT_EQ(one.primitive, hits[i].primitive);
        ASSERT_TRUE(same_bits(one.t, hits[i].t) && same_bits(one.u, hits[i].u) &&
                    same_bits(one.v, hits[i].v));
      }
    }
  }
  EXPECT_GT(met, 20000);
  EXPECT_GT(blocked_count, 20000);
}

class LockStep : public ::testing::TestWithParam<const char*> {};

TEST_P(LockStep, PathsAsOneByOne) {
  const auto scene = mixed_scene(GetParam());
  const auto& integrator = dynamic_cast<const RadianceIntegrator&>(*scene->integrator_object());
  const Sampler& sampler = scene->sensor().sampler();
  int lit = 0;
  for (std::uint64_t pixel = 0; pixel < 400; ++pixel) {
    const size_t n = 1 + pixel % RadianceIntegrator::kTogether;
    std::vector<CameraPath> paths(n);
    for (size_t i = 0; i < n; ++i) {
      CameraPath& p = paths[i];
      p.samples = SampleStream(sampler, pixel * 0x9e3779b97f4a7c15u, std::uint32_t(i));
      p.wavelengths = scene->wavelengths().sample(p.samples.get1(2));
      p.ray =
          scene->sensor()
              .sample_ray({768.f * float(pixel) / 400 + 40 * p.samples.get1(0), 576 * p.samples.get1(1)}, {})
              .ray;
      p.samples.set_first(SampleStream::camera_dimensions(false));
    }
    std::vector<CameraPath> copies = paths;
    integrator.radiance_of(*scene, paths);
    for (size_t i = 0; i < n; ++i) {
      const RadianceEstimate one =
          integrator.radiance(*scene, copies[i].ray, copies[i].wavelengths, copies[i].samples, {}, nullptr);
      for (int j = 0; j < kWavelengths; ++j)
        ASSERT_TRUE(same_bits(one.estimate[j], paths[i].result.estimate[j])) << "pixel " << pixel;
      ASSERT_EQ(one.alpha, paths[i].result.alpha);
      lit += !is_black(one.estimate);
    }
  }
  EXPECT_GT(lit, 400);  // glass in front shows no direct light
}

INSTANTIATE_TEST_SUITE_P(
    Depths, LockStep,
    ::testing::Values(R"(<integrator type="path"/>)",
                      R"(<integrator type="path"><integer name="max_depth" value="4"/></integrator>)",
                      R"(<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>)",
                      R"(<integrator type="direct"/>)"),
    [](const auto& info) { return "Integrator" + std::to_string(info.index); });

}  // namespace
}  // namespace aureole::testing
