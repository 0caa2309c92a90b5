// SPDX-License-Identifier: Apache-2.0
// The walks of `path`, `ptracer` and `bdpt` agree on light whose maps do not commute
// (harness/matrix_light.h): each composes them in the order in which light passes. With the product of two
// maps swapped they must not agree.
#include "harness/matrix_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/integrator/bdpt/light_walk.h"
#include "aureole/integrator/bdpt/sensor_walk.h"
#include "aureole/integrator/path/path_walk.h"
#include "aureole/integrator/ptracer/particle_walk.h"
#include "aureole/loading/load.h"
#include "aureole/sampler/sampler.h"

namespace aureole::testing {
namespace {

constexpr int kSize = 4, kBatches = 2500;

struct Mean {
  double value = 0, error = 0;
};
double difference(const Mean& a, const Mean& b) { return (a.value - b.value) / std::hypot(a.error, b.error); }

std::shared_ptr<const Scene> room(const std::string& content) {
  const auto wall = [](const char* to_world, const char* bsdf) {
    return std::string("<shape type='rectangle'><transform name='to_world'>") + to_world + "</transform>" +
           bsdf + "</shape>";
  };
  const char *grey = "<bsdf type='diffuse'><spectrum name='reflectance' value='360:0.8, 830:0.6'/></bsdf>",
             *rough = "<bsdf type='roughconductor'><float name='alpha' value='0.4'/></bsdf>";
  return load_scene_from_string(
             "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><float name='fov' value='50'/>"
             "<transform name='to_world'><lookat origin='0.1, 0.1, 0.9' target='0, 0, -1' up='0, 1, 0'/></transform>"
             "<film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/>"
             "<rfilter type='box'/></film></sensor>" +
                 wall("<translate z='-1'/>", grey) +
                 wall("<rotate x='1' angle='-90'/><translate y='-1'/>", rough) +
                 wall("<rotate x='1' angle='90'/><translate y='1'/>", grey) +
                 wall("<rotate y='1' angle='90'/><translate x='-1'/>", grey) +
                 wall("<rotate y='1' angle='-90'/><translate x='1'/>", rough) +
                 wall("<rotate x='1' angle='90'/><scale value='0.4'/><translate y='0.9'/>",
                      "<emitter type='area'><spectrum name='radiance' value='5'/></emitter>") +
                 content + "</scene>",
             "room.xml")
      .scene;
}

/// The mean of a walk's estimates per pixel and wavelength, over batches of paths; trace(in, splats) follows
/// a batch.
template <class Trace>
Mean mean_of(const Scene& scene, std::uint64_t seed, const Trace& trace) {
  PathLimits limits = PathLimits::direct(false);
  limits.max_depth = 4;
  const Sampler& sampler = scene.sensor().sampler();
  double sum = 0, squares = 0;
  for (int batch = 0; batch < kBatches; ++batch) {
    std::array<Path, kBatch> paths;
    for (int i = 0; i < kBatch; ++i) {
      Path& p = paths[size_t(i)];
      p.samples = SampleStream(sampler, mix_bits(seed * 0x9e3779b97f4a7c15u + std::uint64_t(batch)),
                               std::uint32_t(i));
      p.wavelengths = scene.wavelengths().sample(p.samples.get1(2));
      p.film = {kSize * p.samples.get1(0), kSize * p.samples.get1(1)};
      p.ray = scene.sensor().sample_ray(p.film, {}).ray;
      p.samples.set_first(SampleStream::camera_dimensions(false));
      p.result = {};
    }
    std::vector<Splat> splats;
    const Arena::Frame frame;
    trace(WalkInput{scene, limits, paths, BatchLog(), frame.arena()}, splats);
    double all = 0;
    for (const Path& p : paths) all += double(mean(p.result.estimate)) / kBatch;
    for (const Splat& s : splats) all += double(mean(s.estimate)) / kBatch / (kSize * kSize);
    sum += all, squares += all * all;
  }
  const double value = sum / kBatches;
  return {value, std::sqrt(std::max(0.0, squares / kBatches - value * value) / (kBatches - 1))};
}

template <class L>
Mean by_path(const Scene& scene) {
  return mean_of(scene, 1, [](const WalkInput& in, std::vector<Splat>&) {
    PathWalk<Space::any, L> walk(in);
    follow_from_start(in, walk);
  });
}
/// Without light that the sensor sees directly.
template <class L>
Mean by_light(const Scene& scene) {
  return mean_of(scene, 2, [](const WalkInput& in, std::vector<Splat>& splats) {
    ParticleWalk<L> walk(in, splats);
    follow_from_start(in, walk);
  });
}
template <class L>
Mean by_both(const Scene& scene) {
  const bdpt::Techniques techniques{-1, -1};
  return mean_of(scene, 3, [&](const WalkInput& in, std::vector<Splat>& splats) {
    bdpt::LightWalk<L> light(in, techniques, splats);
    follow_from_start(in, light);
    bdpt::SensorWalk<L> sensor(in, techniques, &light);
    follow_from_start(in, sensor);
  });
}

class MatrixLightWalks : public ::testing::TestWithParam<const char*> {};

TEST_P(MatrixLightWalks, AgreeUnlessProductsAreSwapped) {
  const auto scene = room(GetParam());
  // The lamp faces downwards, above the picture: the sensor does not see it directly.
  const Mean path = by_path<MatrixLight>(*scene), light = by_light<MatrixLight>(*scene),
             both = by_both<MatrixLight>(*scene);
  EXPECT_LT(path.error, 0.02 * path.value);
  EXPECT_LT(std::abs(difference(path, light)), 4) << path.value << " and " << light.value;
  EXPECT_LT(std::abs(difference(path, both)), 4) << path.value << " and " << both.value;
  EXPECT_LT(std::abs(difference(light, both)), 4) << light.value << " and " << both.value;
  const Mean swapped = by_path<SwappedLight>(*scene);
  EXPECT_GT(std::abs(difference(swapped, light)), 6) << swapped.value << " and " << light.value;
  const Mean plain = by_path<Unpolarised>(*scene), plain_light = by_light<Unpolarised>(*scene);
  EXPECT_LT(std::abs(difference(plain, plain_light)), 4) << plain.value << " and " << plain_light.value;
  EXPECT_GT(std::abs(difference(plain, path)), 6);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, MatrixLightWalks,
    ::testing::Values("",
                      "<shape type='cube'><transform name='to_world'><scale value='0.85'/></transform>"
                      "<bsdf type='null'/><medium name='interior' type='homogeneous'>"
                      "<spectrum name='sigma_t' value='360:0.3, 830:0.6'/><float name='albedo' value='0.9'/>"
                      "<phase type='hg'><float name='g' value='0.4'/></phase></medium></shape>"));

}  // namespace
}  // namespace aureole::testing
