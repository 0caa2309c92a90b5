// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/core/random.h"
#include "aureole/emitter/light.h"
#include "aureole/loading/load.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

using Colour = std::array<double, 3>;

/// A sky of 8 x 5 texels of one colour, with a sun of one texel.
struct SunnySky {
  static constexpr int kWidth = 8, kHeight = 5;
  Colour sky, sun{1000, 1000, 1000};
  int sun_x = 3, sun_y = 2;

  const Colour& texel(int x, int y) const { return (x + kWidth) % kWidth == sun_x && y == sun_y ? sun : sky; }
  /// Interpolates the colours of the four texels around a point of the map.
  Colour at(double u, double v) const {
    const double x = u * kWidth - 0.5, y = v * (kHeight - 1);
    const int x0 = int(std::floor(x)), y0 = std::min(int(y), kHeight - 2);
    const double fx = x - x0, fy = y - y0;
    Colour c;
    for (std::size_t k = 0; k < 3; ++k)
      c[k] = (1 - fy) * ((1 - fx) * texel(x0, y0)[k] + fx * texel(x0 + 1, y0)[k]) +
             fy * ((1 - fx) * texel(x0, y0 + 1)[k] + fx * texel(x0 + 1, y0 + 1)[k]);
    return c;
  }
  std::shared_ptr<Emitter> emitter() const {
    Image image{kWidth, kHeight, {"R", "G", "B"}, {}, false};
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (const double c : texel(x, y)) image.pixels.push_back(float(c));
    const auto file = std::filesystem::temp_directory_path() /
                      ("aureole_envmap_" +
                       std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".exr");
    write_exr(file, image, ExrPixel::float32, {});
    return testing::build<Emitter>("<emitter type=\"envmap\"><string name=\"filename\" value=\"" +
                                   file.string() + "\"/></emitter>");
  }
};

Vec3 direction(double u, double v) {
  const double sine = std::sin(M_PI * v);
  return {float(std::sin(2 * M_PI * u) * sine), float(std::cos(M_PI * v)),
          float(-std::cos(2 * M_PI * u) * sine)};
}

/// The linear sRGB colour of a spectrum, `eval(wavelengths)`, by the observer's 1 nm table.
template <class Eval>
Colour colour_of(const Eval& eval) {
  const Observer& observer = cie_1931_observer();
  double xyz[3] = {};
  for (std::size_t first = 0; first < observer.y.size(); first += kWavelengths) {
    const Spectrum nm =
        make_spectrum([&](int i) { return float(observer.start_nm + double(first) + double(i)); });
    const Spectrum value = eval(Wavelengths::at({}, nm));
    for (std::size_t i = 0; i < kWavelengths && first + i < observer.y.size(); ++i) {
      const double l = double(value[int(i)]) / cie_y_integral();
      xyz[0] += l * observer.x[first + i], xyz[1] += l * observer.y[first + i];
      xyz[2] += l * observer.z[first + i];
    }
  }
  float rgb[3];
  xyz_to_srgb(xyz, rgb);
  return {rgb[0], rgb[1], rgb[2]};
}

constexpr std::array<double, 3> kLuminance{0.2126, 0.7152, 0.0722};
double luminance(const Colour& c) {
  return kLuminance[0] * c[0] + kLuminance[1] * c[1] + kLuminance[2] * c[2];
}

TEST(Envmap, ColoursBetweenTexelsAreInterpolated) {
  const Colour skies[] = {{0.1, 0.2, 0.8}, {0, 0, 0}, {30, 2, 0.5}};
  const Colour suns[] = {{1000, 1000, 1000}, {1000, 600, 100}};
  for (const Colour& sky : skies)
    for (const Colour& sun : suns) {
      const SunnySky map{sky, sun};
      const auto emitter = map.emitter();
      // Positions in units of texels from the sun, along rows, columns and diagonals.
      for (const auto& [dx, dy] : {std::pair{0.0, 0.0},
                                   {0.5, 0.0},
                                   {-0.5, 0.0},
                                   {0.9, 0.0},
                                   {0.0, 0.5},
                                   {0.0, -0.75},
                                   {0.5, 0.5},
                                   {-0.25, 0.8},
                                   {2.4, 0.3}}) {
        const double u = (map.sun_x + dx + 0.5) / SunnySky::kWidth,
                     v = (map.sun_y + dy) / (SunnySky::kHeight - 1);
        const Colour expected = map.at(u, v);
        const Colour is =
            colour_of([&](const Wavelengths& w) { return emitter->eval_escaped(direction(u, v), w); });
        const double largest = std::max({expected[0], expected[1], expected[2]});
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_NEAR(is[k], expected[k], 4e-3 * largest) << dx << ", " << dy << ": component " << k;
      }
    }
}

TEST(Envmap, PowerAndSamplesAreThoseOfTheInterpolatedColours) {
  // The sun near the equator, beside a pole, and at a pole, where only half of a row's hat lies on the map.
  for (const int sun_y : {2, 1, 0}) {
    const SunnySky map{{0.1, 0.2, 0.8}, {1000, 900, 700}, 3, sun_y};
    const auto emitter = map.emitter();
    Light light;
    light.emitter = emitter.get(), light.scene_radius = 2;
    // The integral of the colours over the sphere, by the midpoint rule.
    double integral = 0;
    constexpr int kColumns = 256, kRows = 1024;
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        const double v = (y + 0.5) / kRows;
        integral += luminance(map.at((x + 0.5) / kColumns, v)) * std::sin(M_PI * v);
      }
    integral *= 2 * M_PI * M_PI / (kColumns * kRows);

    const SampledSpectrum power = light.power_spectrum();
    const double expected = integral * M_PI * light.scene_radius * light.scene_radius;
    EXPECT_NEAR(luminance(colour_of([&](const Wavelengths& w) { return power.eval(w); })), expected,
                5e-3 * expected)
        << sun_y;

    // The estimate of light sampling, the mean of radiance over pdf of stratified samples, is the integral
    // of the radiance at all wavelengths.
    const Wavelengths w = Wavelengths::at({}, make_spectrum([](int i) { return 400.f + 40.f * float(i); }));
    std::array<double, kWavelengths> mean{}, whole{};
    constexpr int kLattice = 512;
    for (int j = 0; j < kLattice; ++j) {
      Spectrum sampled = 0.f, integrated = 0.f;  // of one row: long sums of floats would lose digits
      for (int i = 0; i < kLattice; ++i) {
        const std::uint64_t n = std::uint64_t(j) * kLattice + std::uint64_t(i);
        const auto jitter = [](std::uint64_t key) { return unit_float(std::uint32_t(mix_bits(key))); };
        const Vec2 u{(float(i) + jitter(2 * n)) / kLattice, (float(j) + jitter(2 * n + 1)) / kLattice};
        if (const auto s = light.sample_direct({}, 0, u, w)) {
          sampled += s->radiance * (1 / s->pdf);
          if (i % 16 == 0 && j % 16 == 0) {
            EXPECT_NEAR(emitter->pdf_direct_escaped({}, {}, s->wo), s->pdf, 2e-3f * s->pdf);
          }
        }
        integrated += emitter->eval_escaped(direction(double(u.x), double(u.y)), w) *
                      (2 * kPi * kPi * std::sin(kPi * u.y));
      }
      for (std::size_t i = 0; i < kWavelengths; ++i)
        mean[i] += double(sampled[int(i)]), whole[i] += double(integrated[int(i)]);
    }
    for (std::size_t i = 0; i < kWavelengths; ++i) EXPECT_NEAR(mean[i], whole[i], 5e-3 * whole[i]) << sun_y;
  }
}

std::shared_ptr<Emitter> sky(const std::string& to_world) {
  const auto file = test::source_dir() / "tests/references/scenes/textures/sky_grey.exr";
  return testing::build<Emitter>("<emitter type=\"envmap\"><string name=\"filename\" value=\"" +
                                 file.string() + "\"/><transform name=\"to_world\">" + to_world +
                                 "</transform></emitter>");
}

TEST(Envmap, RefusesTransformsThatTurnNothing) {
  for (const char* bad : {R"(<scale x="1e-45"/>)", R"(<scale x="1e300" y="1e300" z="1e300"/>)",
                          R"(<rotate z="1" angle="30"/><scale x="2"/>)"})
    EXPECT_THROW(sky(bad), Error) << bad;
  EXPECT_TRUE(sky(R"(<rotate z="1" angle="30"/>)"));
}

TEST(Envmap, LooksNowhereElse) {
  const auto emitter = sky("");
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const Wavelengths w = Wavelengths::at({}, Spectrum(500.f));
  for (const Vec3& d : {Vec3{nan, nan, nan}, Vec3{0, nan, 1}, Vec3{infinity, 0, 0}, Vec3{0, 0, 0}}) {
    (void)emitter->eval_escaped(d, w);  // must not read outside of the picture
    (void)emitter->pdf_direct_escaped({}, {}, d);
    (void)emitter->pdf_direct_escaped({}, {0, 0, 1}, d);
  }
}

TEST(EnvironmentMap, ACubeMapIsALocatedError) {
  const test::TemporaryFolder folder;
  Imf::Header header(4, 24);
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  const std::vector<float> pixels(4 * 24, 1.f);
  Imf::FrameBuffer frame;
  for (const char* name : {"R", "G", "B"}) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    frame.insert(name, Imf::Slice(Imf::FLOAT, (char*)pixels.data(), 4, 16));
  }
  {
    Imf::OutputFile file((folder.path / "cube.exr").c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(24);
  }
  try {
    load_scene(folder.write("scene.xml", R"(<scene version="3.0.0"><sensor type="perspective"/>
<emitter type="envmap">
  <string name="filename" value="cube.exr"/></emitter></scene>)"));
    ADD_FAILURE() << "a cube map was read as latitude by longitude";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("scene.xml:3:3: parameter \"filename\""), std::string::npos)
        << e.what();
    EXPECT_NE(std::string(e.what()).find("is a cube map"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace aureole
