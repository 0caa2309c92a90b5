// SPDX-License-Identifier: Apache-2.0
// Power maps in the units of radio, against closed forms; materials at radio frequencies in scenes.
#include "aureole/instrument/radio/power_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "aureole/core/error.h"
#include "aureole/render/job.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

const std::string kSensor =
    "<sensor type='powermap'><transform name='to_world'><scale x='3' y='2'/></transform><film type='hdrfilm'>"
    "<integer name='width' value='6'/><integer name='height' value='4'/><string name='response' value='uniform'/>"
    "<string name='component_format' value='float32'/><string name='wavelength_min' value='28.1GHz'/>"
    "<string name='wavelength_max' value='27.9GHz'/></film></sensor>";
const std::string kLamp =
    "<emitter type='point'><point name='position' x='0.4' y='-0.3' z='2'/>"
    "<spectrum name='intensity' value='3'/></emitter>";

std::string floor_of(const std::string& material) {
  return "<shape type='rectangle'><transform name='to_world'><scale value='100'/><translate z='-1'/></transform>"
         "<bsdf type='conductor'><string name='material' value='" +
         material + "'/></bsdf></shape>";
}
LoadedScene scene(const std::string& content) {
  return load_scene_from_string("<scene version='3.0.0'><integrator type='ptracer'/>" + content + "</scene>",
                                "radio.xml", {});
}
std::vector<PowerMap> maps(const std::string& content, std::optional<double> power, std::int64_t samples,
                           int replicates = 1, int free_samples = 16) {
  const LoadedScene loaded = scene(content);
  RenderOptions options;
  options.end = samples, options.replicates = replicates;
  RenderJob job(loaded, options);
  job.run(std::atomic<bool>(false));
  return power_maps(*loaded.scene, job.state().picture(), power, free_samples);
}
std::string error(const std::string& content) {
  try {
    scene(content);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(PowerMapOfRadio, IsFriisFormulaInFreeSpace) {
  const auto m = maps(kSensor + kLamp, 0.5, 64);
  ASSERT_EQ(m.size(), 1u);
  EXPECT_NEAR(m[0].wavelength_m, 0.01070687, 1e-6);
  EXPECT_EQ(m[0].power_w, 0.5);
  for (const double db : m[0].relative_db()) EXPECT_NEAR(db, 0, 0.02);
  // The cell from (0, 0) to (1, -1).
  double inverse = 0;
  for (int k = 0; k < 900; ++k)
    inverse +=
        1 / (std::pow((k % 30 + 0.5) / 30 - 0.4, 2) + std::pow((k / 30 + 0.5) / 30 - 0.3, 2) + 4) / 900;
  const double density = 0.5 / (4 * M_PI) * inverse;
  EXPECT_NEAR(m[0].density[2 * 6 + 3], density, 0.005 * density);
  EXPECT_NEAR(m[0].received_dbm()[2 * 6 + 3],
              10 * std::log10(0.5 * 1e3 * std::pow(0.01070687 / (4 * M_PI), 2) * inverse), 0.02);
  // The scene's own power: 4 pi times the intensity, over the band.
  const double band_nm = 299792458.0 * (1 / 27.9 - 1 / 28.1);
  EXPECT_NEAR(maps(kSensor + kLamp, {}, 16)[0].power_w, 12 * M_PI * band_nm, 1e-3 * 12 * M_PI * band_nm);
}

// Concrete at 28 GHz, whose permittivity the Recommendation gives as 5.24 + i sigma/(omega epsilon_0), sigma =
// .0462 28^.7822 S/m; reflectance of the floor by Fresnel's equations, the image source behind it.
TEST(PowerMapOfRadio, ConcreteReflectsAsFresnelSays) {
  const auto m = maps(kSensor + floor_of("itu_concrete") + kLamp, 1.0, 4096, 4);
  const std::complex<double> eps(5.24, 0.0462 * std::pow(28, 0.7822) / (2 * M_PI * 28e9 * 8.8541878128e-12));
  const double step = 1.0 / 20;
  double expected = 0;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) {
      const double x = (i + 0.5) * step - 0.4, y = -(j + 0.5) * step + 0.3, across = x * x + y * y;
      const double cosine = 4 / std::sqrt(across + 16);
      const std::complex<double> root = std::sqrt(eps - (1 - cosine * cosine));
      const double r = 0.5 * (std::norm((cosine - root) / (cosine + root)) +
                              std::norm((eps * cosine - root) / (eps * cosine + root)));
      expected += (1 / (across + 4) + r / (across + 16)) / (4 * M_PI) * step * step;
    }
  const std::size_t cell = 2 * 6 + 3;
  ASSERT_EQ(m[0].error.size(), 24u);
  EXPECT_LT(m[0].error_db()[cell], 0.05);
  EXPECT_NEAR(10 * std::log10(m[0].density[cell] / expected), 0, 0.05);
}

TEST(PowerMapOfRadio, MaterialsHaveLimits) {
  EXPECT_EQ(error(kSensor + floor_of("itu_metal") + kLamp), "");
  EXPECT_NE(error(kSensor + floor_of("itu_very_dry_ground") + kLamp).find("1 to 10 GHz"), std::string::npos);
  EXPECT_NE(error(kSensor + floor_of("itu_concret") + kLamp).find("did you mean \"itu_concrete\""),
            std::string::npos);
  EXPECT_NE(error("<sensor type='perspective'/>" + floor_of("itu_brick")).find("1 to 40 GHz"),
            std::string::npos);
  // A pane refracts by the real part of its index; metal is no dielectric.
  const auto pane = [](const std::string& name) {
    return "<shape type='rectangle'><bsdf type='thindielectric'><string name='int_ior' value='" + name +
           "'/></bsdf></shape>";
  };
  const LoadedScene glass = scene(kSensor + kLamp + pane("itu_glass"));
  ASSERT_FALSE(glass.notes.empty());
  EXPECT_NE(glass.notes[0].find("only the real part"), std::string::npos);
  EXPECT_NE(error(kSensor + kLamp + pane("itu_metal")).find("too strongly"), std::string::npos);
}

TEST(PowerMapOfRadio, ANumberIsDaylightAndDarkThere) {
  const LoadedScene dark =
      scene(kSensor + "<emitter type='point'><float name='intensity' value='3'/></emitter>");
  EXPECT_NE(dark.notes[0].find("<spectrum name=\"intensity\" value=\"3\"/>"), std::string::npos);
}

// Light that free space has not: from a lamp behind the map, by a floor before it.
TEST(PowerMapOfRadio, WithoutAFreeSpaceThereIsNoRatio) {
  PowerMap map;
  map.density = {1, 0, 1}, map.free = {0.1, 0, 0}, map.wavelength_m = 0.01;
  const std::vector<double> db = map.relative_db();
  EXPECT_NEAR(db[0], 10, 1e-9);
  EXPECT_EQ(db[1], -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(db[2]));
  EXPECT_TRUE(std::isfinite(map.received_dbm()[2]));
  EXPECT_EQ(DecibelScale::of(db, "").max_db, 10);
}

// One of the lamps is a thousand times brighter: a choice between them would be noise.
TEST(PowerMapOfRadio, FreeSpaceOfSeveralLampsHasNoNoise) {
  const std::string dim =
      "<emitter type='point'><point name='position' x='-2.5' y='1.5' z='0.3'/>"
      "<spectrum name='intensity' value='0.003'/></emitter>";
  const std::string sky = "<emitter type='constant'><spectrum name='radiance' value='0.1'/></emitter>";
  for (const double db : maps(kSensor + kLamp + dim, {}, 256)[0].relative_db()) EXPECT_NEAR(db, 0, 0.05);
  // With one that has a size, its part is a sample's.
  double sum = 0;
  for (const double db : maps(kSensor + kLamp + dim + sky, {}, 1024, 1, 1024)[0].relative_db()) {
    EXPECT_NEAR(db, 0, 1);
    sum += db / 24;
  }
  EXPECT_NEAR(sum, 0, 0.15);
}

TEST(PowerMapOfRadio, EndsOfTheColoursStayApart) {
  DecibelScale scale{-60, 0, 10, ""};
  scale.set_ends(20, {});
  EXPECT_EQ(scale.max_db, 30);
  scale = {-60, 0, 10, ""}, scale.set_ends({}, -80);
  EXPECT_EQ(scale.min_db, -90);
  scale = {-60, 0, 10, ""}, scale.set_ends(-5000, {});
  EXPECT_EQ(scale.max_db, -4000);
  scale = {-60, 0, 10, ""}, scale.set_ends(-3, 0);
  EXPECT_EQ(scale.min_db, -3);
  EXPECT_EQ(scale.contour_db, 2);
  const std::vector<double> values{0};
  for (const auto& [min, max] : {std::array{0.0, 0.0}, {0, 1e300}, {1e300, 1e300}, {std::nan(""), 1}})
    EXPECT_THROW(decibel_picture(values, 1, 1, {min, max, 10, ""}), Error) << min << " " << max;
}

TEST(PowerMapOfRadio, PowersHaveUnits) {
  EXPECT_EQ(parse_power_w("2"), 2);
  EXPECT_EQ(parse_power_w("2W"), 2);
  EXPECT_NEAR(parse_power_w("500 mW"), 0.5, 1e-12);
  EXPECT_NEAR(parse_power_w("33dBm"), 1.9952623, 1e-6);
  EXPECT_NEAR(parse_power_w("-30dBm"), 1e-6, 1e-15);
  for (const char* wrong : {"", "0", "-1W", "two", "1V"}) EXPECT_THROW(parse_power_w(wrong), Error) << wrong;
}

TEST(PowerMapOfRadio, ThePictureHasABarAndContours) {
  std::vector<double> values;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) values.push_back(-x);
  values[0] = -std::numeric_limits<double>::infinity();
  const DecibelScale scale = DecibelScale::of(values, "power");
  EXPECT_EQ(scale.max_db, 0);
  EXPECT_EQ(scale.min_db, -40);
  const Image picture = decibel_picture(values, 40, 30, scale);
  EXPECT_GT(picture.width, 40 * 16);
  // White where the value is a multiple of 10 dB, between the centres of columns 10 and 11.
  const auto brightness = [&](int x, int y) {
    return picture.at(x, y, 0) + picture.at(x, y, 1) + picture.at(x, y, 2);
  };
  const int row = 26 + 16 * 15;
  EXPECT_GT(brightness(10 * 16 + 8, row), 2.2f);
  EXPECT_LT(brightness(15 * 16 + 8, row), 2.2f);
  EXPECT_NEAR(picture.at(3, 26 + 3, 0), 60 / 255.0, 0.01) << "without power";
}

}  // namespace
}  // namespace aureole::test
