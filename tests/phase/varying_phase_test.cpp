// SPDX-License-Identifier: Apache-2.0
// Phase functions whose parameters vary in space.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "aureole/instrument/check/phase_check.h"
#include "harness/properties_builder.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

const SpectralGrid kGrid = SpectralGrid::over(360, 830);
const Wavelengths kWaves = Wavelengths::at(kGrid, 550);

std::string grid(const std::string& name, const std::filesystem::path& file) {
  return "<volume name=\"" + name + R"(" type="gridvolume"><string name="filename" value=")" + file.string() +
         R"("/><boolean name="raw" value="true"/></volume>)";
}
std::string matrix_text(const std::array<float, 6>& s) {
  std::string text;
  for (const float v : s) text += std::to_string(v) + " ";
  return text;
}

// Two samples along x, whose centres are at 1/4 and 3/4 of the box [0, 1]^3.
TEST(VaryingPhase, FlakesTurnFromPlaceToPlace) {
  const test::VolumeFolder folder;
  const std::array<float, 6> first{0.5f, 0.9f, 0.2f, 0.1f, -0.15f, 0.05f}, second{1, 0.04f, 1, 0, 0, 0};
  std::vector<float> values(first.begin(), first.end());
  values.insert(values.end(), second.begin(), second.end());
  const auto file = test::write_bytes(folder.path() / "s.vol", test::make_vol({2, 1, 1}, 6, values).bytes());
  const auto phase = build<PhaseFunction>("<phase type=\"sggx\">" + grid("S", file) + "</phase>");
  EXPECT_FALSE(phase->is_isotropic_medium());

  const Vec3 wi = normalize(Vec3{0.3f, 0.2f, -0.9f}), wo = normalize(Vec3{-0.1f, 0.9f, 0.4f});
  for (const float x : {0.25f, 0.4f, 0.75f}) {
    const float t = (x - 0.25f) / 0.5f;
    std::array<float, 6> s;
    for (std::size_t k = 0; k < 6; ++k) s[k] = first[k] + t * (second[k] - first[k]);
    const auto there = build<PhaseFunction>(R"(<phase type="sggx"><string name="S" value=")" +
                                            matrix_text(s) + "\"/></phase>");
    const Vec3 p{x, 0.5f, 0.5f};
    EXPECT_NEAR(phase->projected_area(wi, p), there->projected_area(wi, {}), 1e-5);
    EXPECT_NEAR(phase->eval_pdf(wi, wo, {kWaves, p}).value[0], there->eval_pdf(wi, wo, {kWaves, {}}).value[0],
                1e-5);
    EXPECT_GE(phase->largest_projected_area(), phase->projected_area({0, 1, 0}, p));
  }
  CheckOptions options;
  options.samples = 20000;
  EXPECT_EQ(check_phase(*phase, options, {0.4f, 0.5f, 0.5f}).problems(), std::vector<std::string>{});
}

TEST(VaryingPhase, MatricesThatAreNoneCountAsSpheres) {
  const test::VolumeFolder folder;
  const auto file = test::write_bytes(
      folder.path() / "s.vol", test::make_vol({2, 1, 1}, 6, {0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 0, 0}).bytes());
  const auto phase = build<PhaseFunction>("<phase type=\"sggx\">" + grid("S", file) + "</phase>");
  for (const float x : {0.1f, 0.9f}) {
    const PhaseEval e = phase->eval_pdf({0, 0, 1}, {1, 0, 0}, {kWaves, {x, 0.5f, 0.5f}});
    EXPECT_NEAR(e.value[0], 1 / (4 * M_PI), 1e-6);
    EXPECT_NEAR(phase->projected_area({0, 1, 0}, {x, 0.5f, 0.5f}), 1, 1e-6);
  }
}

TEST(VaryingPhase, BlendsByAVolume) {
  const test::VolumeFolder folder;
  const auto file =
      test::write_bytes(folder.path() / "w.vol", test::make_vol({2, 1, 1}, 1, {0.2f, 0.8f}).bytes());
  const auto phase = build<PhaseFunction>("<phase type=\"blendphase\">" + grid("weight", file) +
                                          R"(<phase type="isotropic"/><phase type="rayleigh"/></phase>)");
  const double isotropic = 1 / (4 * M_PI), forward = 3 / (8 * M_PI);
  for (const float x : {0.25f, 0.5f, 0.75f}) {
    const double w = 0.2 + 0.6 * (double(x) - 0.25) / 0.5;
    EXPECT_NEAR(phase->eval_pdf({0, 0, -1}, {0, 0, 1}, {kWaves, {x, 0.5f, 0.5f}}).value[0],
                (1 - w) * isotropic + w * forward, 1e-6);
  }
}

TEST(VaryingPhase, RefusesVolumesOfOtherChannels) {
  const test::VolumeFolder folder;
  const auto file =
      test::write_bytes(folder.path() / "w.vol", test::make_vol({2, 1, 1}, 1, {0.2f, 1.8f}).bytes());
  EXPECT_THROW(build<PhaseFunction>("<phase type=\"sggx\">" + grid("S", file) + "</phase>"), Error);
  EXPECT_THROW(build<PhaseFunction>("<phase type=\"blendphase\">" + grid("weight", file) +
                                    R"(<phase type="isotropic"/><phase type="rayleigh"/></phase>)"),
               Error);
}

}  // namespace
}  // namespace aureole::testing
