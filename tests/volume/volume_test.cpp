// SPDX-License-Identifier: Apache-2.0
// Volumes as parameters of other objects: roles, and what each excludes.
#include "aureole/volume/volume.h"

#include <gtest/gtest.h>

#include "aureole/spectrum/observer.h"
#include "volume/volume_test_support.h"

namespace aureole::test {
namespace {

VolumePtr read(SpectrumRole role, const std::string& parameter) {
  return get_optional_volume(testing::read_properties("<probe type=\"probe\">" + parameter + "</probe>"), "v",
                             role);
}
std::string named(std::string xml) { return xml.insert(xml.find(' '), " name=\"v\""); }

Wavelengths wavelengths() {
  return Wavelengths::at(SpectralGrid::over(360, 830),
                         make_spectrum([&](int i) { return 380 + 55 * float(i); }));
}

TEST(Volume, AConstantVolumeIsItsValue) {
  const Wavelengths w = wavelengths();
  for (const SpectrumRole role : {SpectrumRole::reflectance, SpectrumRole::unbounded, SpectrumRole::emission})
    for (const char* value : {R"(<float name="%" value="0.7"/>)", R"(<rgb name="%" value="0.7, 0.2, 0.4"/>)",
                              R"(<spectrum name="%" value="400:0.1, 600:0.7, 700:0.3"/>)"}) {
      std::string direct = value, nested = value;
      direct.replace(direct.find('%'), 1, "v");
      nested.replace(nested.find('%'), 1, "value");
      const VolumePtr a = read(role, direct);
      const VolumePtr b = read(role, "<volume name=\"v\" type=\"constvolume\">" + nested + "</volume>");
      for (int i = 0; i < kWavelengths; ++i) EXPECT_EQ(a->eval({}, w)[i], b->eval({}, w)[i]) << nested;
      EXPECT_EQ(a->eval_scalar({1, 2, 3}), b->eval_scalar({}));
      EXPECT_TRUE(b->is_constant());
      EXPECT_EQ(a->maximum(), b->maximum());
    }
}

TEST(Volume, ThePlaceOfAConstantVolumeBoundsExtinctionAlone) {
  const std::string placed =
      "<volume name=\"v\" type=\"constvolume\"><float name=\"value\" value=\"0.7\"/><transform "
      "name=\"to_world\"><scale value=\"2\"/></transform></volume>";
  const VolumePtr extinction = read(SpectrumRole::unbounded, placed);
  ASSERT_TRUE(extinction->to_box());
  EXPECT_FALSE(extinction->is_constant());
  EXPECT_EQ(extinction->to_box()->point({2, 1, 0}).x, 1);
  const VolumePtr albedo = read(SpectrumRole::reflectance, placed);
  EXPECT_FALSE(albedo->to_box());
  EXPECT_TRUE(albedo->is_constant());
}

// As numbers of a scene file do (docs/conventions.md).
TEST(Volume, AGridOfEmissionMultipliesD65) {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "e.vol", make_vol({2, 1, 1}, 1, {1, 3}).bytes());
  const VolumePtr volume = read(SpectrumRole::emission, named(grid_xml(file)));
  const VolumePtr plain = read(SpectrumRole::unbounded, named(grid_xml(file)));
  const Wavelengths w = wavelengths();
  const SampledSpectrum d65 = d65_spectrum(SpectralGrid::over(360, 830), 1);
  const Vec3 p{.5f, .5f, .5f};
  for (int i = 0; i < kWavelengths; ++i) {
    EXPECT_FLOAT_EQ(volume->eval(p, w)[i], 2 * d65.eval(w)[i]);
    EXPECT_EQ(plain->eval(p, w)[i], 2);
  }
  EXPECT_FLOAT_EQ(volume->maximum(), 3 * d65.maximum());
}

TEST(Volume, RolesExcludeValues) {
  VolumeFolder folder;
  const auto write = [&](int channels, const std::vector<float>& values) {
    return named(
        grid_xml(write_bytes(folder.path() / "v.vol", make_vol({1, 1, 1}, channels, values).bytes())));
  };
  const auto error = [&](SpectrumRole role, const std::string& xml) {
    return error_thrown_by([&] { read(role, xml); });
  };
  EXPECT_EQ(error(SpectrumRole::unbounded, write(1, {1.5f})), "");
  EXPECT_NE(error(SpectrumRole::reflectance, write(1, {1.5f})).find("goes up to 1.5"), std::string::npos);
  EXPECT_NE(error(SpectrumRole::unbounded, write(1, {-1.5f})).find("goes down to -1.5"), std::string::npos);
  EXPECT_EQ(error(SpectrumRole::reflectance, write(3, {1, .9f, 0})), "");
  EXPECT_NE(error(SpectrumRole::unbounded, write(6, {1, 1, 1, 1, 1, 1})).find("6 numbers"),
            std::string::npos);
  EXPECT_NE(error(SpectrumRole::unbounded, R"(<texture name="v" type="checkerboard"/>)").find("varies"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::test
