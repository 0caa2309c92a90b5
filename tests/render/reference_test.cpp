// SPDX-License-Identifier: Apache-2.0
// aureole against stored pictures of Mitsuba 3 in spectral mode (tests/references): mean and variance from
// independently scrambled renders, a z-value per pixel and channel.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/render/statistics.h"
#include "harness/effort.h"
#include "harness/paths.h"

namespace aureole::test {
namespace {

const std::filesystem::path kReferences = source_dir() / "tests/references";

struct Reference {
  std::string name, scene;
  std::vector<std::pair<std::string, std::string>> defines;
};

void PrintTo(const Reference& r, std::ostream* out) { *out << r.name; }

std::vector<Reference> references() {
  std::vector<Reference> list;
  std::ifstream in(kReferences / "references.json");
  if (!in) return list;
  for (const auto& entry : nlohmann::json::parse(in)) {
    Reference r{entry.at("name"), entry.at("scene"), {}};
    for (const std::string o : entry.at("overrides")) {
      const size_t equals = o.find('=');
      r.defines.emplace_back(o.substr(0, equals), o.substr(equals + 1));
    }
    list.push_back(r);
  }
  return list;
}

/// Mean standard deviation over mean.
double relative_noise(const Image& image) {
  double mean = 0, deviation = 0;
  for (const char* name : {"R", "G", "B"})
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        mean += image.at(x, y, size_t(image.channel(name)));
        deviation += std::sqrt(image.at(x, y, size_t(image.channel(std::string("variance.") + name))));
      }
  return deviation / mean;
}

class MitsubaReference : public ::testing::TestWithParam<Reference> {};

TEST_P(MitsubaReference, AgreesWithinNoise) {
  std::filesystem::path scene = GetParam().scene;
  if (GetParam().scene.starts_with("shared:")) {
    const char* shared = std::getenv("AUREOLE_SHARED");
    const std::filesystem::path folder = shared ? shared : source_dir() / ".." / "shared";
    scene = folder / GetParam().scene.substr(7);
    if (!std::filesystem::exists(scene))
      GTEST_SKIP() << "the scene " << scene
                   << " is not here: set AUREOLE_SHARED to the folder of the example scenes";
  } else {
    scene = source_dir() / scene;
  }
  LoadOptions load;
  load.defines = GetParam().defines;
  load.sampler = "sobol";
  const auto loaded = load_scene(scene, load);
  const Image reference = read_image(kReferences / (GetParam().name + ".exr"));

  // Mitsuba 3.9.1 divides by an integral of ybar of 106.7503 nm, where the CIE's table has 106.857 nm:
  // spectra given in absolute numbers are .1 % brighter there, its upsampled colours err by a few 1e-4 (its
  // table's interpolation), and some pixels have less noise than that.
  constexpr double kMitsubaTables = 1e-3;
  // 32 replicates make the variance's own error small. Few samples do for most scenes; where the noise is
  // above 1 to 2 % of the mean a pixel's mean is not yet normally distributed (rare bright samples), and more are
  // taken. A handful of values has no statistics of its own: they are computed until their noise is below
  // what the tables explain.
  const bool few = loaded.scene->film().crop_width() * loaded.scene->film().crop_height() < 16;
  const double noise_limit = few ? 5e-4 : effort(0.02, 0.01);
  const std::int64_t most_samples = few ? 16384 : 256;
  const double reference_noise = relative_noise(reference);
  RenderOptions options;
  options.replicates = kSanitized ? 2 : 32;
  const std::atomic<bool> go{false};
  RenderState state;
  for (options.end = 16; *options.end <= most_samples; *options.end *= 2) {
    RenderJob job(loaded, options);
    if (options.end > 16) job.resume(state);
    job.run(go);
    state = job.state();
    if (kSanitized) break;
    // A picture of few samples may have little noise and yet rare bright ones: what does not agree gets more,
    // which makes a real difference clearer. Where the reference has more noise than that, so may the picture.
    if (relative_noise(state.picture()) <
            std::max(noise_limit, few ? 0 : effort(2.0, 0.1) * reference_noise) &&
        compare_images(state.picture(), reference, kMitsubaTables).z->passes)
      break;
  }
  EXPECT_EQ(state.invalid_samples, 0u);
  if (kSanitized) return;
  const Comparison c = compare_images(state.picture(), reference, kMitsubaTables);
  ASSERT_TRUE(c.z);
  RecordProperty("mean_z2", std::to_string(c.z->mean_square));
  std::printf(
      "%-28s %lld samples, noise %.2f %% (reference %.2f %%), mean of z^2 %.3f, outside %.3f %%, mean %+.2f "
      "standard errors (%+.3f %%)\n",
      GetParam().name.c_str(), static_cast<long long>(state.end), 100 * relative_noise(state.picture()),
      100 * reference_noise, c.z->mean_square, 100 * c.z->outside, c.z->mean_difference,
      100 * c.z->mean_relative);
  EXPECT_TRUE(c.z->passes) << "mean of z^2 " << c.z->mean_square << ", outside " << 100 * c.z->outside
                           << " %, image mean " << c.z->mean_difference << " standard errors, "
                           << 100 * c.z->mean_relative << " %";
  if (!c.z->passes) {
    const auto folder = aureole_binary().parent_path().parent_path() / "failed-references";
    std::filesystem::create_directories(folder);
    write_pictures(state, folder / (GetParam().name + ".exr"));
    write_z_map(c, folder / (GetParam().name + "-z.png"));
    Image shown = reference;
    for (float& v : shown.pixels) v = srgb_encode(std::clamp(v, 0.f, 1.f));
    Image rgb{reference.width, reference.height, {"R", "G", "B"}, {}, true};
    for (int y = 0; y < rgb.height; ++y)
      for (int x = 0; x < rgb.width; ++x)
        for (const char* n : {"R", "G", "B"}) rgb.pixels.push_back(shown.at(x, y, size_t(shown.channel(n))));
    write_png(folder / (GetParam().name + "-reference.png"), rgb);
    ADD_FAILURE() << "pictures and z-map in " << folder;
  }
}

INSTANTIATE_TEST_SUITE_P(All, MitsubaReference, ::testing::ValuesIn(references()), [](const auto& info) {
  std::string name = info.param.name;
  for (char& ch : name)
    if (!std::isalnum(static_cast<unsigned char>(ch))) ch = '_';
  return name;
});
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MitsubaReference);

}  // namespace
}  // namespace aureole::test
