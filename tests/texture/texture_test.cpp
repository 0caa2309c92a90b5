// SPDX-License-Identifier: Apache-2.0
#include "aureole/texture/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "aureole/core/image.h"
#include "aureole/spectrum/tables.h"
#include "aureole/spectrum/upsampling_fit.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;
using testing::make_context;
using testing::read_properties;

/// The value of a parameter as each role reads it, straight from a snippet.
class Probe final : public Object {
public:
  explicit Probe(const Properties& p)
      : Object(p), texture(get_texture(p, "t", 0.5, SpectrumRole(p.get_int("role", 0, Range{0, 3})))) {}
  TexturePtr texture;
};
TexturePtr read(SpectrumRole role, const std::string& parameter, double min_nm = 360, double max_nm = 830) {
  return Probe(read_properties("<probe type=\"probe\"><integer name=\"role\" value=\"" +
                                   std::to_string(int(role)) + "\"/>" + parameter + "</probe>",
                               make_context(min_nm, max_nm)))
      .texture;
}

double at(const Texture& t, double nm, Vec2 uv = {}, double min_nm = 360, double max_nm = 830) {
  SurfacePoint point;
  point.uv = uv;
  return t.eval(point, Wavelengths::at(SpectralGrid::over(min_nm, max_nm), float(nm)))[0];
}

double luminance(const SampledSpectrum& s) {
  const Observer& o = cie_1931_observer();
  double y = 0, white = 0;
  for (std::size_t i = 0; i < o.y.size(); ++i) {
    const double nm = o.start_nm + o.step_nm * double(i);
    y += o.y[i] * double(s.eval(Wavelengths::at(s.grid(), float(nm)))[0]);
    white += o.y[i];
  }
  return y / white;
}

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// D65's table has corners every 5 nm; its tabulation keeps the integral and rounds them by less than this.
constexpr double kKink = 2e-3;

constexpr auto kReflectance = SpectrumRole::reflectance, kUnbounded = SpectrumRole::unbounded,
               kEmission = SpectrumRole::emission;

TEST(TextureRoles, Numbers) {
  for (const double nm : {360., 555.5, 830.}) {
    EXPECT_FLOAT_EQ(float(at(*read(kReflectance, R"(<float name="t" value="0.3"/>)"), nm)), 0.3f);
    EXPECT_FLOAT_EQ(float(at(*read(kUnbounded, R"(<float name="t" value="7"/>)"), nm)), 7.f);
    EXPECT_FLOAT_EQ(float(at(*read(kEmission, R"(<spectrum name="t" value="7"/>)"), nm)), 7.f);
  }
  // A number is D65 for an emitter; so is the fallback.
  const double d65_560 = 100 * d65_whitepoint_normalization();
  EXPECT_NEAR(at(*read(kEmission, R"(<float name="t" value="2"/>)"), 560), 2 * d65_560, kKink);
  EXPECT_NEAR(at(*read(kEmission, R"(<integer name="t" value="2"/>)"), 560), 2 * d65_560, kKink);
  EXPECT_NEAR(at(*read(kEmission, ""), 560), 0.5 * d65_560, kKink);
  EXPECT_FLOAT_EQ(float(at(*read(kReflectance, ""), 560)), 0.5f);
}

TEST(TextureRoles, Colours) {
  const SigmoidSpectrum p = fit_srgb({0.8, 0.2, 0.1}), half = fit_srgb({0.5, 0.125, 0.0625});
  const TabulatedSpectrum d65 = *find_illuminant("D65");
  for (double nm = 365; nm < 830; nm += 17) {  // on nodes
    const float l = float(nm);
    EXPECT_NEAR(at(*read(kReflectance, R"(<rgb name="t" value="0.8, 0.2, 0.1"/>)"), nm), p.at(l), 1e-5);
    EXPECT_NEAR(at(*read(kUnbounded, R"(<rgb name="t" value="0.8, 0.2, 0.1"/>)"), nm), p.at(l), 1e-5);
    EXPECT_NEAR(at(*read(kUnbounded, R"(<rgb name="t" value="8, 2, 1"/>)"), nm), 16 * half.at(l), 1e-4);
    EXPECT_NEAR(at(*read(kUnbounded, R"(<rgb name="t" value="3, 3, 3"/>)"), nm), 3, 1e-5);
    const double emitted = d65.at(nm) * d65_whitepoint_normalization();
    EXPECT_NEAR(at(*read(kEmission, R"(<rgb name="t" value="8, 2, 1"/>)"), nm), 16 * half.at(l) * emitted,
                11 * kKink);
    EXPECT_NEAR(at(*read(kEmission, R"(<rgb name="t" value="2, 2, 2"/>)"), nm), 2 * emitted, 2 * kKink);
  }
}

/// Values of Mitsuba 3.9.1 (scalar_spectral) at 450, 500, 550 and 600 nm.
TEST(TextureRoles, MitsubasValues) {
  constexpr double kNm[] = {450, 500, 550, 600};
  constexpr double kSrgb[] = {0.118648, 0.130012, 0.221418, 0.553788};
  constexpr double kD65[] = {1.181930, 1.104615, 1.050997, 0.909177};
  constexpr double kD65Red[] = {1.400561, 1.602471, 2.397806, 4.477560};
  constexpr double kBlackbody[] = {10801.0625, 12107.1689, 12712.9990, 12762.3702};
  const auto blackbody =
      build<Texture>(R"(<spectrum type="blackbody"><float name="temperature" value="5000"/></spectrum>)");
  const auto d65 = build<Texture>(R"(<spectrum type="d65"/>)");
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(at(*read(kReflectance, R"(<rgb name="t" value="0.8, 0.2, 0.1"/>)"), kNm[i]), kSrgb[i], 2e-3);
    EXPECT_NEAR(at(*read(kEmission, R"(<float name="t" value="1"/>)"), kNm[i]), kD65[i], kKink);
    EXPECT_NEAR(at(*d65, kNm[i]), kD65[i], kKink);
    EXPECT_NEAR(at(*read(kEmission, R"(<rgb name="t" value="8, 2, 1"/>)"), kNm[i]), kD65Red[i], 1e-2);
    EXPECT_NEAR(at(*blackbody, kNm[i]) / kBlackbody[i], 1, 1e-5);
  }
}

TEST(TextureRoles, Points) {
  const auto t = read(kReflectance, R"(<spectrum name="t" value="400:0.2, 500:0.6, 700:0.4"/>)");
  EXPECT_NEAR(at(*t, 450), 0.4, 1e-6);
  EXPECT_NEAR(at(*t, 600), 0.5, 1e-6);
  // A property of matter keeps the values at the ends of its data, light has none outside them.
  EXPECT_NEAR(at(*t, 380), 0.2, 1e-6);
  EXPECT_NEAR(at(*t, 750), 0.4, 1e-6);
  const auto light = read(kEmission, R"(<spectrum name="t" value="400:0.2, 500:0.6, 700:0.4"/>)");
  EXPECT_NEAR(at(*light, 450), 0.4, 1e-6);
  EXPECT_EQ(at(*light, 380), 0);
  EXPECT_EQ(at(*light, 750), 0);
}

TEST(TextureRoles, WrongInputIsLocated) {
  const auto error = [](SpectrumRole role, const std::string& parameter) {
    return message_of([&] { read(role, parameter); });
  };
  EXPECT_NE(error(kReflectance, R"(<float name="t" value="1.2"/>)").find("[0, 1], got 1.2"),
            std::string::npos);
  EXPECT_NE(error(kReflectance, R"(<rgb name="t" value="0.2, 1.5, 0"/>)").find("[0, 1]"), std::string::npos);
  EXPECT_NE(error(kReflectance, R"(<spectrum name="t" value="400:0, 500:2"/>)").find("[0, 1]"),
            std::string::npos);
  EXPECT_NE(error(kEmission, R"(<rgb name="t" value="-0.1, 0, 0"/>)").find("negative"), std::string::npos);
  EXPECT_NE(error(kUnbounded, R"(<float name="t" value="-1"/>)").find("negative"), std::string::npos);
  EXPECT_NE(error(kUnbounded, R"(<rgb name="t" value="0.6, 1e308, 0.5"/>)").find("too large"),
            std::string::npos);
  EXPECT_NE(
      error(kUnbounded, R"(<spectrum type="uniform" name="t"><float name="value" value="1e300"/></spectrum>)")
          .find("too large"),
      std::string::npos);
  EXPECT_NE(error(kReflectance, R"(<spectrum name="t" value="400:0.5"/>)").find("at least two"),
            std::string::npos);
  EXPECT_NE(error(kReflectance, R"(<string name="t" value="red"/>)").find("expected a number"),
            std::string::npos);
  EXPECT_NE(error(kReflectance, R"(<spectrum type="d65" name="t"/>)").find("goes up to 1.1"),
            std::string::npos);
  // Every message starts with the place: "snippet:1:column".
  EXPECT_EQ(error(kReflectance, R"(<float name="t" value="1.2"/>)").rfind("snippet:1:", 0), 0u);
  EXPECT_EQ(error(kEmission, R"(<float name="t" value="1.2"/>)"), "");
}

TEST(Spectra, D65AndIlluminantsHaveTheLuminanceOfFlatOne) {
  EXPECT_NEAR(luminance(build<Texture>(R"(<spectrum type="d65"/>)")->average()), 1, 1e-5);
  EXPECT_NEAR(
      luminance(build<Texture>(R"(<spectrum type="uniform"><float name="value" value="1"/></spectrum>)")
                    ->average()),
      1, 1e-6);
  for (const std::string& name : illuminant_names()) {
    const auto t = build<Texture>("<spectrum type=\"illuminant\"><string name=\"name\" value=\"" + name +
                                  "\"/><float name=\"scale\" value=\"3\"/></spectrum>");
    EXPECT_NEAR(luminance(t->average()), 3, 3e-3) << name;
  }
  EXPECT_NE(message_of([] {
              build<Texture>(R"(<spectrum type="illuminant"><string name="name" value="FL99"/></spectrum>)");
            }).find("unknown illuminant"),
            std::string::npos);
}

TEST(Spectra, NarrowLinesKeepTheirIntegral) {
  // A line 0.02 nm wide, between nodes of the grid: area 100 x 0.01.
  const auto t = build<Texture>(R"(<spectrum type="irregular">
      <string name="wavelengths" value="500, 589.29, 589.30, 589.31, 700"/>
      <string name="values" value="0, 0, 100, 0, 0"/></spectrum>)");
  EXPECT_NEAR(t->average().integral(), 1, 1e-4);
  const auto r = build<Texture>(R"(<spectrum type="regular">
      <string name="values" value="0.1 0.3,0.2"/><float name="wavelength_min" value="400"/>
      <float name="wavelength_max" value="700"/></spectrum>)");
  EXPECT_NEAR(r->average().integral(), 150 * 0.2 + 150 * 0.25, 1e-3);
  EXPECT_NEAR(at(*r, 475), 0.2, 1e-6);
}

TEST(Spectra, BlackbodyObeysWien) {
  // The peak of L_lambda lies at b/T; above 300 K and in a wide range.
  const auto context = make_context(300, 4000);
  const auto t = build<Texture>(
      R"(<spectrum type="blackbody"><float name="temperature" value="2900"/></spectrum>)", context);
  const auto nodes = t->average();
  std::size_t peak = 0;
  for (std::size_t i = 0; i < nodes.nodes().size(); ++i)
    if (nodes.nodes()[i] > nodes.nodes()[peak]) peak = i;
  EXPECT_NEAR(context->grid.node(int(peak)), 2.897771955e6 / 2900, 2 * context->grid.step());
  const auto cut = build<Texture>(R"(<spectrum type="blackbody"><float name="temperature" value="2900"/>
      <float name="wavelength_min" value="500"/><float name="wavelength_max" value="600"/></spectrum>)");
  EXPECT_EQ(at(*cut, 490), 0);
  EXPECT_GT(at(*cut, 550), 0);
  EXPECT_EQ(at(*cut, 610), 0);
}

TEST(Spectra, WrongInput) {
  const auto error = [](const std::string& xml) { return message_of([&] { build<Texture>(xml); }); };
  EXPECT_NE(error(R"(<spectrum type="irregular"><string name="wavelengths" value="400, 500"/>
                  <string name="values" value="1, 2, 3"/></spectrum>)")
                .find("2 wavelengths but 3 values"),
            std::string::npos);
  EXPECT_NE(error(R"(<spectrum type="irregular"><string name="wavelengths" value="500, 400, 450"/>
                  <string name="values" value="1, 2, 3"/></spectrum>)")
                .find("must increase"),
            std::string::npos);
  EXPECT_NE(error(R"(<spectrum type="regular"><string name="values" value="1, x"/>
                  <float name="wavelength_min" value="400"/><float name="wavelength_max" value="700"/></spectrum>)"),
            "");
  EXPECT_NE(error(R"(<spectrum type="srgb"><rgb name="color" value="2, 0, 0"/></spectrum>)").find("[0, 1]"),
            std::string::npos);
  EXPECT_NE(error(R"(<spectrum type="srgb"/>)").find("color"), std::string::npos);
}

TEST(Checkerboard, AsMitsuba) {
  const auto t = build<Texture>(R"(<texture type="checkerboard"/>)");
  EXPECT_FLOAT_EQ(float(at(*t, 500, {0.25f, 0.25f})), 0.4f);
  EXPECT_FLOAT_EQ(float(at(*t, 500, {0.75f, 0.25f})), 0.2f);
  EXPECT_FLOAT_EQ(float(at(*t, 500, {0.5f, 0.5f})), 0.4f);
  EXPECT_FLOAT_EQ(float(at(*t, 500, {0.500001f, 0.3f})), 0.2f);
  EXPECT_FLOAT_EQ(float(at(*t, 500, {-0.25f, 0.25f})), 0.2f);
  EXPECT_NEAR(t->average().average(), 0.3, 1e-6);
  EXPECT_FLOAT_EQ(t->maximum(), 0.4f);
  EXPECT_FLOAT_EQ(t->minimum(), 0.2f);
  // to_uv acts on the coordinates: (0.2, 0.1) becomes (0.6, 0.2) by the scale and (0.9, 0.2) by the shift.
  const auto s = build<Texture>(R"(<texture type="checkerboard"><transform name="to_uv"><scale x="3" y="2"/>
      <translate x="0.3"/></transform></texture>)");
  EXPECT_FLOAT_EQ(float(at(*s, 500, {0.2f, 0.1f})), 0.2f);
  EXPECT_FLOAT_EQ(float(at(*s, 500, {0.3f, 0.1f})), 0.4f);
}

TEST(D65, MultipliesANestedTexture) {
  const auto t = build<Texture>(
      R"(<texture type="d65"><float name="scale" value="2"/><texture type="checkerboard"/></texture>)");
  const auto d65 = build<Texture>(R"(<spectrum type="d65"/>)");
  EXPECT_NEAR(at(*t, 500, {0.25f, 0.25f}), 0.8 * at(*d65, 500), 1e-6);
  EXPECT_NEAR(at(*t, 500, {0.75f, 0.25f}), 0.4 * at(*d65, 500), 1e-6);
  EXPECT_NEAR(luminance(t->average()), 0.6, 1e-4);
  EXPECT_FALSE(t->is_constant());
}

class BitmapTest : public ::testing::Test {
protected:
  /// Red, green / blue, grey, as in the values below.
  static Image colors() {
    Image image;
    image.width = image.height = 2;
    image.channels = {"R", "G", "B"};
    image.pixels = {1, 0.2f, 0.2f, 0.2f, 1, 0.2f, 0.2f, 0.2f, 1, 0.5f, 0.5f, 0.5f};
    return image;
  }
  std::filesystem::path write(const Image& image, const std::string& name) {
    const std::filesystem::path file =
        std::filesystem::path(::testing::TempDir()) / ("aureole_texture_" + name);
    if (file.extension() == ".png")
      write_png(file, image);
    else
      write_exr(file, image, ExrPixel::float32, {});
    return file;
  }
  TexturePtr load(const std::filesystem::path& file, const std::string& more = "") {
    return build<Texture>(
        "<texture type=\"bitmap\"><string name=\"filename\" value=\"x\"/>" + more + "</texture>",
        make_context(), [&](const std::string&) { return file; });
  }
};

/// Values of Mitsuba 3.9.1 (scalar_spectral) at 450, 500, 550 and 600 nm, for the picture above.
TEST_F(BitmapTest, FiltersAndWrapModesAsMitsuba) {
  struct Row {
    Vec2 uv;
    const char *filter, *wrap;
    double value[4];
  };
  constexpr double kRed[] = {0.19695, 0.12863, 0.21991, 0.73657},
                   kMean[] = {0.44191, 0.51805, 0.4523, 0.49622};
  const Row rows[] = {
      {{0.25f, 0.25f}, "nearest", "repeat", {kRed[0], kRed[1], kRed[2], kRed[3]}},
      {{0.25f, 0.25f}, "bilinear", "mirror", {kRed[0], kRed[1], kRed[2], kRed[3]}},
      {{0.75f, 0.25f}, "nearest", "clamp", {0.11598, 0.8849, 0.92882, 0.59137}},
      {{0.25f, 0.75f}, "bilinear", "repeat", {0.9547, 0.55869, 0.16048, 0.15694}},
      {{0.5f, 0.5f}, "nearest", "repeat", {0.5, 0.5, 0.5, 0.5}},
      {{0.5f, 0.5f}, "bilinear", "clamp", {kMean[0], kMean[1], kMean[2], kMean[3]}},
      {{0, 0}, "nearest", "repeat", {kRed[0], kRed[1], kRed[2], kRed[3]}},
      {{0, 0}, "bilinear", "repeat", {kMean[0], kMean[1], kMean[2], kMean[3]}},
      {{0, 0}, "bilinear", "clamp", {kRed[0], kRed[1], kRed[2], kRed[3]}},
      {{0, 0}, "bilinear", "mirror", {kRed[0], kRed[1], kRed[2], kRed[3]}},
      {{1.2f, -0.1f}, "nearest", "repeat", {0.9547, 0.55869, 0.16048, 0.15694}},
      {{1.2f, -0.1f}, "bilinear", "repeat", {0.69312, 0.44825, 0.22334, 0.35049}},
      {{1.2f, -0.1f}, "bilinear", "clamp", {0.11598, 0.8849, 0.92882, 0.59137}},
      {{1.2f, -0.1f}, "bilinear", "mirror", {0.11598, 0.8849, 0.92882, 0.59137}},
  };
  const auto file = write(colors(), "colors.exr");
  for (const Row& row : rows) {
    const auto t = load(file, std::string("<string name=\"filter_type\" value=\"") + row.filter +
                                  "\"/><string name=\"wrap_mode\" value=\"" + row.wrap + "\"/>");
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(at(*t, 450 + 50 * i, row.uv), row.value[i], 8e-3)
          << row.filter << " " << row.wrap << " at " << row.uv.x << ", " << row.uv.y;
  }
}

TEST_F(BitmapTest, TexelsAreUpsampledAsColours) {
  const auto t = load(write(colors(), "colors.exr"));
  const SigmoidSpectrum red = upsample_srgb(1, 0.2f, 0.2f);
  for (double nm = 360; nm < 830; nm += 23) EXPECT_NEAR(at(*t, nm, {0.25f, 0.25f}), red.at(float(nm)), 1e-5);
  EXPECT_LE(t->maximum(), 1);
  EXPECT_GE(t->minimum(), 0);
  // The mean of the four texels' spectra.
  const SampledSpectrum mean = t->average();
  for (double nm = 400; nm < 800; nm += 50) {
    double expected = 0;
    for (const Vec2 uv : {Vec2{0.25f, 0.25f}, Vec2{0.75f, 0.25f}, Vec2{0.25f, 0.75f}, Vec2{0.75f, 0.75f}})
      expected += 0.25 * at(*t, nm, uv);
    EXPECT_NEAR(mean.eval(Wavelengths::at(mean.grid(), float(nm)))[0], expected, 2e-3);
  }
}

TEST_F(BitmapTest, EncodedGreyAndRaw) {
  Image grey;
  grey.width = 2, grey.height = 1;
  grey.channels = {"Y"};
  grey.pixels = {51 / 255.f, 204 / 255.f};
  const auto file = write(grey, "grey.png");
  const auto t = load(file), raw = load(file, R"(<boolean name="raw" value="true"/>)");
  for (const double nm : {400., 600.}) {
    EXPECT_NEAR(at(*t, nm, {0.25f, 0.5f}), srgb_decode(0.2f), 1e-6);
    EXPECT_NEAR(at(*t, nm, {0.5f, 0.5f}), 0.5 * (srgb_decode(0.2f) + srgb_decode(0.8f)), 1e-6);
    EXPECT_NEAR(at(*raw, nm, {0.25f, 0.5f}), 0.2, 1e-6);
  }
  // Raw colours are a number: their luminance.
  const auto color = load(write(colors(), "colors.exr"), R"(<boolean name="raw" value="true"/>)");
  EXPECT_NEAR(at(*color, 500, {0.25f, 0.25f}), 0.212671 + 0.2 * (0.715160 + 0.072169), 1e-5);
}

TEST_F(BitmapTest, BrightTexelsScaleAndAreNoReflectance) {
  Image image = colors();
  for (float& p : image.pixels) p *= 10;
  const auto file = write(image, "bright.exr");
  const auto t = load(file);
  const SigmoidSpectrum red = upsample_unbounded(10, 2, 2);
  for (double nm = 360; nm < 830; nm += 23) EXPECT_NEAR(at(*t, nm, {0.25f, 0.25f}), red.at(float(nm)), 1e-4);
  EXPECT_GT(t->maximum(), 1);
  const std::string xml =
      R"(<probe type="probe"><texture type="bitmap" name="t"><string name="filename" value="x"/>
      </texture></probe>)";
  EXPECT_NE(message_of([&] {
              Probe(read_properties(xml, make_context(), [&](const std::string&) { return file; }));
            }).find("[0, 1]"),
            std::string::npos);
}

TEST_F(BitmapTest, AnyCoordinateIsInside) {
  const auto file = write(colors(), "colors.exr");
  for (const char* wrap : {"repeat", "mirror", "clamp"})
    for (const char* filter : {"bilinear", "nearest"}) {
      const auto t = load(file, std::string("<string name=\"filter_type\" value=\"") + filter +
                                    "\"/><string name=\"wrap_mode\" value=\"" + wrap + "\"/>");
      for (const float u : {-1e30f, -3.f, -1e-9f, 0.f, 0.999999f, 1.f, 7.3f, 1e30f, NAN, INFINITY})
        for (const float v : {-1e-9f, 1.f, NAN}) {
          const double x = at(*t, 500, {u, v});
          EXPECT_TRUE(x >= 0 && x <= 1) << wrap << " " << u << " " << v;
        }
    }
}

TEST_F(BitmapTest, WrongInput) {
  Image image = colors();
  image.pixels[4] = -1;
  const auto file = write(image, "negative.exr");
  EXPECT_NE(message_of([&] { load(file); }).find("column 1, row 0"), std::string::npos);
  EXPECT_NE(message_of([&] { load("/nowhere/picture.png"); }), "");
  EXPECT_NE(message_of([&] { load(file, R"(<string name="wrap_mode" value="mirrored"/>)"); }).find("mirror"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole
