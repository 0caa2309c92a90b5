// SPDX-License-Identifier: Apache-2.0
// Values that miss a limit by rounding are moved to it, with a note; so are single pixels that are not finite.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/image.h"
#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/upsampled_color.h"
#include "aureole/spectrum/value_limit.h"
#include "aureole/texture/constant_texture.h"
#include "harness/properties_builder.h"
#include "shape/shape_test_support.h"

namespace aureole::test {
namespace {

using testing::build;
using testing::make_context;

struct Built {
  std::string notes, error;
};
template <class T>
Built built(const std::string& xml) {
  Built r;
  Diagnostics diagnostics;
  try {
    build<T>(xml, make_context(360, 830, &diagnostics));
  } catch (const Error& e) {
    r.error = e.what();
  }
  for (const std::string& note : diagnostics.notes()) r.notes += note + "\n";
  return r;
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(LimitNoise, NumbersAndColours) {
  const auto diffuse = [](const std::string& value) {
    return built<Bsdf>("<bsdf type=\"diffuse\">" + value + "</bsdf>");
  };
  for (const auto& [value, note] :
       {std::pair{R"(<float name="reflectance" value="1.0000001"/>)", "1.0000001 counts as 1"},
        {R"(<float name="reflectance" value="-1e-9"/>)", "-1e-09 counts as 0"},
        {R"(<rgb name="reflectance" value="1.0000001, -1e-9, 0.5"/>)", "2 values that miss a limit"},
        {R"(<spectrum name="reflectance" value="300:0.5, 500:1.0000001, 900:0.5"/>)",
         "1.0000001 counts as 1"}}) {
    const Built b = diffuse(value);
    EXPECT_EQ(b.error, "") << value;
    EXPECT_TRUE(has(b.notes, note)) << b.notes;
    EXPECT_TRUE(has(b.notes, "reflectance")) << b.notes;
  }
  // Larger differences are errors that show them.
  EXPECT_TRUE(has(diffuse(R"(<float name="reflectance" value="1.00001"/>)").error, "got 1.00001"));
  EXPECT_TRUE(has(diffuse(R"(<float name="reflectance" value="-0.00001"/>)").error, "got -1e-05"));
}

TEST(LimitNoise, SpectraDoNotJumpAtOne) {
  const Spectrum nm(700.f);
  const Spectrum one = UpsampledColor::of_rgb(1, 0.2f, 0.1f).eval(nm);
  EXPECT_NEAR(UpsampledColor::of_rgb(1.0000001f, 0.2f, 0.1f).eval(nm)[0], one[0], 1e-4);
  const double exact[3] = {1, 0.2, 0.1}, noisy[3] = {1.0000001, 0.2, 0.1};
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  EXPECT_NEAR(spectrum_of_rgb(grid, noisy, false).maximum(), spectrum_of_rgb(grid, exact, false).maximum(),
              1e-4);
}

class LimitNoiseFiles : public FileTest {
protected:
  /// Notes and errors of a texture or an environment map of this picture.
  template <class T>
  Built of_picture(const std::string& element, const Image& image) const {
    write_exr(folder_ / "a.exr", image, ExrPixel::float32, {});
    const std::string tag = element.substr(0, element.find(' '));
    return built<T>("<" + element + "><string name=\"filename\" value=\"" + (folder_ / "a.exr").string() +
                    "\"/></" + tag + ">");
  }
};

TEST_F(LimitNoiseFiles, PixelsOfMaps) {
  Image image{20, 10, {"R", "G", "B"}, std::vector<float>(600, 0.25f)};
  image.at(3, 2, 1) = NAN;
  image.at(4, 2, 0) = INFINITY;
  image.at(5, 5, 2) = -1e-9f;
  for (const Built& b : {of_picture<Texture>("texture type=\"bitmap\"", image),
                         of_picture<Emitter>("emitter type=\"envmap\"", image)}) {
    EXPECT_EQ(b.error, "");
    EXPECT_TRUE(has(b.notes, "2 of 200 pixels are NaN or infinite, the first at column 3, row 2")) << b.notes;
    EXPECT_TRUE(has(b.notes, "-1e-09 counts as 0") || has(b.notes, "-9.9999997e-10 counts as 0")) << b.notes;
  }
  for (int x = 0; x < 20; ++x) image.at(x, 0, 0) = NAN;
  EXPECT_TRUE(has(of_picture<Texture>("texture type=\"bitmap\"", image).error, "22 of 200 pixels are NaN"));
  Image negative{2, 3, {"Y"}, {0.5f, -0.1f, 0.5f, 0.5f, 0.5f, 0.5f}};
  EXPECT_TRUE(has(of_picture<Texture>("texture type=\"bitmap\"", negative).notes,
                  "1 negative values of the picture, the first at column 1, row 0, count as 0"));
  negative.at(0, 1, 0) = -0.25f;  // more than a tenth of all light
  EXPECT_TRUE(has(of_picture<Texture>("texture type=\"bitmap\"", negative).error, "column 1, row 0 is -0.1"));
  EXPECT_TRUE(has(of_picture<Emitter>("emitter type=\"envmap\"", negative).notes,
                  "2 negative values of the picture, the first at column 1, row 0, count as 0"));
}

/// Numbers of plug-ins have the tolerance, too.
class Probe final : public Object {
public:
  explicit Probe(const Properties& p) : Object(p), value(p.get_float("x", 0.5, Range::unit())) {}
  double value;
};

TEST(LimitNoise, ParametersThatAreNumbers) {
  Diagnostics diagnostics;
  const auto probe = [&](const std::string& x) {
    return Probe(testing::read_properties(
                     "<probe type=\"probe\"><float name=\"x\" value=\"" + x + "\"/></probe>",
                     make_context(360, 830, &diagnostics)))
        .value;
  };
  EXPECT_EQ(probe("1.0000001"), 1);
  EXPECT_EQ(probe("-1e-9"), 0);
  ASSERT_EQ(diagnostics.notes().size(), 2u);
  EXPECT_TRUE(has(diagnostics.notes()[0], "1.0000001 counts as 1"));
  try {
    probe("1.00001");
    FAIL();
  } catch (const Error& e) {
    EXPECT_TRUE(has(e.what(), "must be in [0, 1], got 1.00001"));
  }
}

TEST(LimitNoise, ToleranceIsAPartOfTheLargestValue) {
  NoiseClamp clamp(0, 1e30, 1e-3);
  EXPECT_EQ(clamp(-5e-10), 0);
  EXPECT_EQ(clamp(-1e-45f), 0);
  EXPECT_EQ(clamp(-2e-9), -2e-9);
  EXPECT_EQ(clamp.note(), "2 values that miss a limit by rounding are moved to it; the first is -5e-10");
}

}  // namespace
}  // namespace aureole::test
