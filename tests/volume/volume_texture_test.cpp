// SPDX-License-Identifier: Apache-2.0
// Textures that are a volume cut by a surface, and numbers that are no colour.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "aureole/texture/texture.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;
using testing::make_context;

SurfacePoint at(const Vec3& p) {
  SurfacePoint point;
  point.p = p;
  return point;
}

/// A .vol file of 2 x 1 x 1 voxels with the values 0.25 and 0.75.
std::filesystem::path ramp() {
  const auto file = std::filesystem::path(::testing::TempDir()) / "aureole_ramp.vol";
  std::ofstream out(file, std::ios::binary);
  out.write("VOL\3", 4);
  for (const std::int32_t n : {1, 2, 1, 1, 1}) out.write(reinterpret_cast<const char*>(&n), sizeof n);
  for (const float x : {0.f, 0.f, 0.f, 1.f, 1.f, 1.f, 0.25f, 0.75f})
    out.write(reinterpret_cast<const char*>(&x), sizeof x);
  return file;
}

std::shared_ptr<const Texture> volume_texture() {
  return build<Texture>(R"(<texture type="volume"><volume type="gridvolume" name="volume">
    <string name="filename" value="x"/><transform name="to_world"><scale value="2"/></transform></volume></texture>)",
                        make_context(), [](const std::string&) { return ramp(); });
}

TEST(VolumeTexture, IsTheVolumeAtThePointOfTheWorld) {
  const auto texture = volume_texture();
  const Wavelengths w = Wavelengths::at({}, make_spectrum([](int i) { return 400 + 40.f * float(i); }));
  // Voxels have their centres at x = 0.5 and 1.5 of the box [0, 2]^3; linear between, constant beyond.
  for (const auto& [x, value] :
       {std::pair{0.1f, 0.25f}, {0.5f, 0.25f}, {1.f, 0.5f}, {1.25f, 0.625f}, {1.9f, 0.75f}}) {
    EXPECT_NEAR(texture->eval_scalar(at({x, 0.3f, 1.7f})), value, 1e-6f) << x;
    EXPECT_NEAR(texture->eval(at({x, 0.3f, 1.7f}), w)[3], value, 1e-6f) << x;
  }
  EXPECT_FLOAT_EQ(texture->minimum(), 0.25f);
  EXPECT_FLOAT_EQ(texture->maximum(), 0.75f);
  EXPECT_NEAR(texture->average().average(), 0.5, 0.02);
}

TEST(VolumeTexture, NumbersOfAnEmissionMultiplyD65) {
  const auto emission = volume_texture()->in_role(SpectrumRole::emission);
  ASSERT_TRUE(emission);
  // D65 at 460 nm over that at 560 nm (CIE 15: 117.812 and 100).
  const auto value = [&](float nm) {
    return emission->eval(at({1, 1, 1}), Wavelengths::at({}, Spectrum(nm)))[0];
  };
  EXPECT_NEAR(value(460) / value(560), 1.17812, 2e-3);
}

TEST(RawConstant, HasItsNumbers) {
  const auto one = build<Texture>(R"(<texture type="rawconstant"><float name="value" value="-3"/></texture>)",
                                  make_context());
  EXPECT_EQ(one->eval_scalar({}), -3);
  EXPECT_FALSE(one->has_rgb());
  const auto three = build<Texture>(
      R"(<texture type="rawconstant"><vector name="value" value="1.5, 2, -3"/></texture>)", make_context());
  EXPECT_EQ(three->eval_rgb({}), (Vec3{1.5f, 2, -3}));
  EXPECT_NEAR(three->eval_scalar({}), 0.2126 * 1.5 + 0.7152 * 2 - 0.0722 * 3, 1e-6);
}

}  // namespace
}  // namespace aureole
