// SPDX-License-Identifier: Apache-2.0
// `paint` against the double-precision library, whose own tests have independent references, and against
// integrals.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/image.h"
#include "aureole/math/warp.h"
#include "aureole/parameter/palette_file.h"
#include "aureole/pigment/saunderson.h"
#include "aureole/pigment/streams_mixture.h"
#include "harness/bsdf_harness.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "loading/load_text.h"

namespace aureole::testing {
namespace {

BsdfCase paint_case(std::string name, const std::string& xml, bool lossless) {
  BsdfCase c;
  c.name = std::move(name), c.xml = xml, c.black_below = true, c.lossless = lossless;
  return c;
}

// The white of two_paints absorbs nothing: over a perfect reflector, or opaque, no light is lost.
const BsdfCases kPaint(
    "paint", [](BsdfCase& c) { c.black_below = true, c.may_fail = c.xml.find("alpha") != std::string::npos; },
    {paint_case("paint_white_opaque", R"(<bsdf type="paint"><string name="palette" value="two_paints.csv"/>
                <string name="recipe" value="white"/></bsdf>)",
                true),
     paint_case("paint_white_over_white",
                R"(<bsdf type="paint"><string name="palette" value="two_paints.csv"/>
                <string name="recipe" value="white"/><string name="thickness" value="5um"/>
                <float name="substrate" value="1"/></bsdf>)",
                true),
     paint_case("paint_bare",
                R"(<bsdf type="paint"><string name="recipe" value="red"/><float name="int_ior" value="1"/>
                <float name="ext_ior" value="1"/></bsdf>)",
                false),
     paint_case("paint_black_gloss", R"(<bsdf type="paint"><string name="recipe" value="black"/></bsdf>)",
                false)});

std::shared_ptr<const Bsdf> paint(const std::string& body) {
  return build<Bsdf>("<bsdf type=\"paint\">" + body + "</bsdf>", make_context(), test::example_file);
}

/// Fraction of diffuse light that leaves, by a product rule over both cosines and the azimuth.
Spectrum diffuse_albedo(const Bsdf& bsdf, const Wavelengths& w) {
  SurfacePoint point;
  const BsdfContext ctx{w, point};
  constexpr int kCosines = 96, kAzimuths = 4;
  Spectrum sum;
  for (int i = 0; i < kCosines; ++i) {
    const float mu_i = std::sqrt((i + 0.5f) / kCosines);  // the cosine-weighted measure
    const Vec3 wi{std::sqrt(1 - mu_i * mu_i), 0, mu_i};
    for (int j = 0; j < kCosines; ++j)
      for (int a = 0; a < kAzimuths; ++a) {
        const float mu_o = std::sqrt((j + 0.5f) / kCosines), phi = 2 * kPi * (a + 0.5f) / kAzimuths,
                    sine = std::sqrt(1 - mu_o * mu_o);
        sum += bsdf.eval(wi, {sine * std::cos(phi), sine * std::sin(phi), mu_o}, ctx) *
               (kPi / (mu_o * kCosines * kCosines * kAzimuths));
      }
  }
  return sum;
}

TEST(PaintBsdf, ReflectsAsTheLibrarySays) {
  const pigment::Palette palette = read_palette_file(test::example_file("two_paints.csv").string());
  const double nm[] = {400, 500, 600, 700};
  const std::vector<double> fractions = recipe_fractions(palette, "blue: 1 + white: 5", false, "recipe");
  const std::vector<double> substrate{0.3};
  for (const char* thickness : {"", "1um", "8um", "60um"}) {
    const double metres = *thickness ? std::stod(thickness) * 1e-6 : std::numeric_limits<double>::infinity();
    const auto expected = pigment::paint_reflectance(
        pigment::mix(palette, fractions), metres, substrate,
        pigment::smooth_surface(1.49, pigment::Geometry::diffuse_diffuse, pigment::Specular::excluded));
    const std::string layer = *thickness ? "<string name=\"thickness\" value=\"" + std::string(thickness) +
                                               "\"/><float name=\"substrate\" value=\"0.3\"/>"
                                         : "";
    const auto bsdf = paint(
        "<string name=\"palette\" value=\"two_paints.csv\"/><string name=\"recipe\" value=\"blue: 1 + white: 5\"/>" +
        layer);
    Spectrum at;
    for (int i = 0; i < kWavelengths; ++i) at[i] = float(nm[i % 4]);
    const Spectrum albedo = diffuse_albedo(*bsdf, Wavelengths::at(make_context()->grid, at));
    // The quadrature misses .1 % where the interface's reflectance rises towards grazing.
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(double(albedo[i]) / expected[std::size_t(i)], 1, 1.5e-3) << thickness << " " << nm[i];
  }
}

TEST(PaintBsdf, SubstratesBlendsAndFactors) {
  SurfacePoint point;
  const Wavelengths w = Wavelengths::at(make_context()->grid, Spectrum(550.f));
  const BsdfContext ctx{w, point};
  const Vec3 wi = normalize(Vec3{0.3f, 0, 1}), wo = normalize(Vec3{-0.1f, 0.4f, 1});
  const auto value = [&](const std::string& body) {
    return paint("<string name=\"palette\" value=\"two_paints.csv\"/>" + body)->eval(wi, wo, ctx)[0];
  };
  const std::string white = "<string name=\"recipe\" value=\"white\"/>",
                    thin = "<string name=\"thickness\" value=\"4um\"/>";
  // A nested BSDF and a reflectance are the same substrate.
  EXPECT_NEAR(
      value(white + thin + "<float name=\"substrate\" value=\"0.6\"/>"),
      value(white + thin + "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0.6\"/></bsdf>"),
      1e-6);
  // Half as thick; nothing at all; a blend is the mixture of both recipes.
  EXPECT_NEAR(value(white + "<string name=\"thickness\" value=\"2um\"/>"),
              value(white + thin + "<float name=\"thickness_factor\" value=\"0.5\"/>"), 1e-6);
  EXPECT_NEAR(value(white + thin + "<float name=\"thickness_factor\" value=\"0\"/>"), 0, 1e-6);
  EXPECT_NEAR(
      value(white + "<string name=\"second_recipe\" value=\"blue\"/><float name=\"blend\" value=\"0.25\"/>"),
      value("<string name=\"recipe\" value=\"blue: 1 + white: 3\"/>"), 1e-6);
}

/// Amounts and thickness of pictures: each pixel is the paint of its own numbers.
TEST(PaintBsdf, AmountsAndThicknessMayBePictures) {
  test::TemporaryFolder folder;
  const float amounts[] = {0, 0.25f, 0.6f, 1}, factors[] = {0, 0.5f, 1, 2.5f};
  const auto picture = [&](const char* name, const float(&values)[4]) {
    Image image;
    image.width = image.height = 2, image.channels = {"Y"};
    image.pixels.assign(values, values + 4);
    const auto file = folder.path / (std::string(name) + ".exr");
    write_exr(file, image, ExrPixel::float32, {});
    return "<texture name=\"" + std::string(name) + "\" type=\"bitmap\"><string name=\"filename\" value=\"" +
           file.string() +
           "\"/><string name=\"filter_type\" value=\"nearest\"/><boolean name=\"raw\" value=\"true\"/></texture>";
  };
  const auto number = [](const char* name, float value) {
    return "<float name=\"" + std::string(name) + "\" value=\"" + std::to_string(value) + "\"/>";
  };
  const std::string fixed =
      "<string name=\"palette\" value=\"two_paints.csv\"/><string name=\"recipe\" value=\"white\"/><string "
      "name=\"second_recipe\" value=\"blue\"/><string name=\"thickness\" value=\"4um\"/><float name=\"substrate\" "
      "value=\"0.7\"/>";
  const auto pictures = [&](const std::string& body) {
    return build<Bsdf>("<bsdf type=\"paint\">" + fixed + body + "</bsdf>", make_context(),
                       [&](const std::string& name) -> std::filesystem::path {
                         return name == "two_paints.csv" ? std::filesystem::path(test::example_file(name))
                                                         : std::filesystem::path(name);
                       });
  };
  const auto both = pictures(picture("blend", amounts) + picture("thickness_factor", factors));
  const Wavelengths w = Wavelengths::at(make_context()->grid, Spectrum(550.f));
  const Vec3 wi = normalize(Vec3{0.3f, 0, 1}), wo = normalize(Vec3{-0.1f, 0.4f, 1});
  float seen[4];
  for (int i = 0; i < 4; ++i) {
    SurfacePoint point;
    // The first row of a picture is that of v = 0.
    point.uv = {i % 2 ? 0.75f : 0.25f, i / 2 ? 0.75f : 0.25f};
    seen[i] = both->eval(wi, wo, {w, point})[0];
    const float alone = paint(fixed + number("blend", amounts[i]) + number("thickness_factor", factors[i]))
                            ->eval(wi, wo, {w, point})[0];
    EXPECT_NEAR(seen[i], alone, 1e-5f * alone) << i;
    for (int j = 0; j < i; ++j) EXPECT_GT(std::abs(seen[i] - seen[j]), 1e-3f) << i << " " << j;
  }
}

TEST(PaintBsdf, WrongParametersAreLocated) {
  const auto says = [](const std::string& body, const std::string& part) {
    try {
      paint(body);
      ADD_FAILURE() << "no error: " << body;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  says("", "recipe");
  says("<string name=\"recipe\" value=\"magneta: 1 + white: 1\"/>", "did you mean \"magenta\"?");
  says("<string name=\"recipe\" value=\"white: 20%\"/>", "must sum to 100");
  says("<string name=\"recipe\" value=\"white\"/><boolean name=\"by_volume\" value=\"true\"/>",
       "needs the density");
  says("<string name=\"recipe\" value=\"white\"/><float name=\"thickness\" value=\"0\"/>", "thickness");
  says("<string name=\"recipe\" value=\"white\"/><float name=\"blend\" value=\"0.5\"/>", "second_recipe");
  says("<string name=\"recipe\" value=\"white\"/><string name=\"distribution\" value=\"ggx\"/>", "alpha");
  says("<string name=\"recipe\" value=\"white\"/><float name=\"int_ior\" value=\"0.9\"/>", "int_ior");
  says(
      "<string name=\"palette\" value=\"two_paints.csv\"/><string name=\"recipe\" value=\"white\"/><float name=\"thickness\" value=\"2\"/>",
      "unit");
}

TEST(PaintBsdf, NotesAPaletteByStreams) {
  const test::TemporaryFolder folder;
  const auto notes_of = [&](const std::string& theory, const std::string& more) {
    const std::string file = (folder.path / "palette.csv").string();
    std::ofstream(file) << "unit,film\n" << theory << "nm,a K,a S\n300,0.1,1\n900,0.1,1\n";
    Diagnostics diagnostics;
    build<Bsdf>("<bsdf type=\"paint\"><string name=\"palette\" value=\"" + file +
                    "\"/><string name=\"recipe\" value=\"a\"/>" + more + "</bsdf>",
                make_context(540, 560, &diagnostics));
    std::string text;
    for (const std::string& note : diagnostics.notes()) text += note;
    return text;
  };
  const std::string varying =
      "<string name=\"second_recipe\" value=\"a\"/><texture type=\"checkerboard\" name=\"blend\"/>";
  EXPECT_NE(notes_of("theory,streams\n", varying).find("K and S were fitted by streams; two fluxes"),
            std::string::npos);
  EXPECT_EQ(notes_of("theory,streams\n", "").find("streams"), std::string::npos);
  EXPECT_EQ(notes_of("theory,two fluxes\n", varying).find("streams"), std::string::npos);
}

/// A coat of a palette by streams reflects light at 8 degrees as streams predict it for an instrument that excludes gloss,
/// with a thickness over a substrate as well.
TEST(PaintBsdf, PaletteByStreamsReflectsAsStreamsPredict) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path / "palette.csv").string();
  std::ofstream(file) << "unit,film\ntheory,streams\nstreams index,1.5\nstreams g,0.6\nstreams geometry,d8\n"
                         "nm,a K,a S,b K,b S\n300,0.1,2,3,0.4\n900,0.1,2,3,0.4\n";
  const pigment::Palette palette = read_palette_file(file);
  const pigment::StreamsMixture streams(palette);
  const float mu_i = std::cos(8 * kPi / 180);
  const Vec3 wi{std::sqrt(1 - mu_i * mu_i), 0, mu_i};
  const std::vector<double> fractions{0.6, 0.4};
  for (const double thickness : {0.2, 1.0, 3.0, double(INFINITY)})
    for (const double substrate : {0.0, 0.8}) {
      const auto number = [](const std::string& name, double value) {
        return "<float name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>";
      };
      // The thickness is that of the parameter times a constant factor, the recipe a blend in constant amounts.
      std::string body =
          "<string name=\"palette\" value=\"" + file +
          "\"/><string name=\"recipe\" value=\"a\"/><string name=\"second_recipe\" value=\"b\"/>" +
          number("blend", 0.4) + number("int_ior", 1.5) + number("ext_ior", 1);
      if (!std::isinf(thickness))
        body += number("thickness", thickness / 2) + number("thickness_factor", 2) +
                number("substrate", substrate);
      const auto bsdf = build<Bsdf>("<bsdf type=\"paint\">" + body + "</bsdf>", make_context(540, 560));
      const Wavelengths w = Wavelengths::at(make_context(540, 560)->grid, Spectrum(550.f));
      SurfacePoint point;
      const BsdfContext ctx{w, point};
      constexpr int kCosines = 2000;
      double sum = 0;
      for (int j = 0; j < kCosines; ++j) {
        const float mu = (float(j) + 0.5f) / kCosines;
        sum += double(bsdf->eval(wi, {0, std::sqrt(1 - mu * mu), mu}, ctx)[0]) * 2 * double(kPi) / kCosines;
      }
      const double below[] = {substrate};
      EXPECT_NEAR(sum, streams.reflectance(fractions, thickness, below)[0], 5e-4)
          << thickness << " " << substrate;
    }
}

}  // namespace
}  // namespace aureole::testing
