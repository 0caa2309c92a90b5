// SPDX-License-Identifier: Apache-2.0
// hdrfilm: its measurements of known spectra, its pixel formats, and its errors.
#include "aureole/film/film.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/plugin/registry.h"
#include "aureole/spectrum/tables.h"
#include "tests/harness/properties_builder.h"

namespace aureole::testing {
namespace {

/// Builds a film from values without a file.
class FilmBuilder {
public:
  explicit FilmBuilder(double min_nm = 360, double max_nm = 830)
      : info_(Registry::instance().find("film", "hdrfilm")),
        properties_("hdrfilm", "", {"scene.xml", 7, 3}, make_context(min_nm, max_nm), info_) {}
  FilmBuilder& set(const std::string& name, Properties::Value value) {
    properties_.add(name, std::move(value), {"scene.xml", ++line_, 5});
    return *this;
  }
  FilmBuilder& size(std::int64_t width, std::int64_t height) {
    return set("width", width).set("height", height);
  }
  std::shared_ptr<Film> build() const { return std::dynamic_pointer_cast<Film>(info_->create(properties_)); }
  std::string error() const {
    try {
      build();
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }

private:
  const PluginInfo* info_;
  Properties properties_;
  int line_ = 10;
};

using std::string_literals::operator""s;

/// The measured numbers of a spectral radiance, by the sum over many equidistant wavelengths.
std::vector<double> measure(const Film& film, double (*radiance)(double)) {
  const SpectralGrid grid = film.properties().context().grid;
  const int rounds = 4 * 470;
  std::vector<double> sum(std::size_t(film.measured_channels()));
  for (int k = 0; k < rounds; ++k) {
    const Spectrum nm = make_spectrum([&](int i) {
      return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (k + (i + 0.5) / kWavelengths) / rounds);
    });
    const Wavelengths w = Wavelengths::at(grid, nm, float(1 / (grid.max_nm - grid.min_nm)));
    const Spectrum estimate =
        make_spectrum([&](int i) { return float(radiance(double(nm[i]))); }) / w.pdf * (1.f / kWavelengths);
    float out[8];
    film.measure(estimate, w, out);
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += double(out[c]) / rounds;
  }
  return sum;
}

double d65_luminance_one(double nm) {
  static const TabulatedSpectrum d65 = *find_illuminant("D65");
  static const double scale = cie_y_integral() / cie_tristimulus(d65)[1];
  return scale * d65.at(nm);
}

TEST(HdrFilm, FlatSpectrumOfRadianceOneHasLuminanceOne) {
  const auto film = FilmBuilder().set("pixel_format", "xyz"s).build();
  ASSERT_EQ(film->measured_channels(), 3);
  const auto m = measure(*film, [](double) { return 1.0; });
  EXPECT_NEAR(m[1], 1, 1e-4);
  // The chromaticity of illuminant E.
  EXPECT_NEAR(m[0], 1, 1e-3);
  EXPECT_NEAR(m[2], 1, 1e-3);
  float xyz[3];
  film->develop(m.data(), 1, xyz);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(xyz[c], float(m[std::size_t(c)]));
}

TEST(HdrFilm, D65IsWhite) {
  const auto film = FilmBuilder().build();
  const auto m = measure(*film, d65_luminance_one);
  EXPECT_NEAR(m[1], 1, 1e-4);
  EXPECT_NEAR(m[0], 0.95047, 1e-3);
  EXPECT_NEAR(m[2], 1.08883, 1e-3);
  float rgb[3], preview[3];
  film->develop(m.data(), 1, rgb);
  film->develop_rgb(m.data(), preview);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(rgb[c], 1, 2e-3);
    EXPECT_EQ(rgb[c], preview[c]);
  }
}

TEST(HdrFilm, MatchesTheObserverOnAnyRange) {
  // A box from 500 to 600 nm, seen by films whose grids have other steps.
  const auto box = [](double nm) { return nm >= 500 && nm < 600 ? 1.0 : 0.0; };
  const Observer& o = cie_1931_observer();
  double expected[3] = {};
  for (std::size_t i = 0; i < o.y.size(); ++i) {
    const double nm = o.start_nm + o.step_nm * double(i);
    const double weight = (nm > 500 && nm < 600 ? 1 : nm == 500 || nm == 600 ? 0.5 : 0) / cie_y_integral();
    expected[0] += weight * o.x[i], expected[1] += weight * o.y[i], expected[2] += weight * o.z[i];
  }
  for (const auto& [low, high] :
       {std::pair{360.0, 830.0}, {450.5, 2000.0}, {499.0, 601.0}, {100.0, 10000.0}}) {
    const auto m = measure(*FilmBuilder(low, high).build(), box);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(m[c], expected[c], 4e-3) << low << "-" << high;
  }
}

TEST(HdrFilm, NarrowBandsOfVisibleLightAreSeen) {
  const Observer& o = cie_1931_observer();
  const double y = o.y[std::size_t((450 - o.start_nm) / o.step_nm)];
  const auto m = measure(*FilmBuilder(449, 451).build(), [](double) { return 1.0; });
  EXPECT_NEAR(m[1] * cie_y_integral(), 2 * y, 0.02 * y);
  EXPECT_THROW(FilmBuilder(900, 1000).build(), Error);
}

TEST(HdrFilm, UniformResponseIsTheMean) {
  const auto film = FilmBuilder(8000, 14000).set("response", "uniform"s).build();
  ASSERT_EQ(film->measured_channels(), 1);
  EXPECT_NEAR(measure(*film, [](double) { return 3.0; })[0], 3, 1e-4);
  EXPECT_NEAR(measure(*film, [](double nm) { return nm < 10000 ? 6.0 : 0.0; })[0], 2, 1e-2);
  EXPECT_EQ(film->channel_names(), std::vector<std::string>{"Y"});
  EXPECT_NEAR(film->response().integral(), 1, 1e-6);
  const double m = 0.25;
  float out[2] = {}, rgb[3];
  film->develop(&m, 0.5, out);
  film->develop_rgb(&m, rgb);
  EXPECT_EQ(out[0], 0.25f);
  EXPECT_EQ(rgb[2], 0.25f);
  const auto alpha =
      FilmBuilder(8000, 14000).set("response", "uniform"s).set("pixel_format", "luminance_alpha"s).build();
  EXPECT_EQ(alpha->channel_names(), (std::vector<std::string>{"Y", "A"}));
  alpha->develop(&m, 0.5, out);
  EXPECT_EQ(out[1], 0.5f);
}

TEST(HdrFilm, ResponseIsPositiveWhereAnyChannelIs) {
  const auto film = FilmBuilder().build();
  const SampledSpectrum r = film->response();
  const Observer& o = cie_1931_observer();
  for (int i = 1; i < 470; ++i)
    EXPECT_NEAR(r.nodes()[std::size_t(i)] * cie_y_integral(),
                o.x[std::size_t(i)] + o.y[std::size_t(i)] + o.z[std::size_t(i)], 3e-2)
        << i;
}

TEST(HdrFilm, PixelFormats) {
  struct Format {
    const char* name;
    std::vector<std::string> channels;
  };
  const double m[3] = {0.3, 0.4, 0.2};
  // sRGB primaries and white from their chromaticities: rows of the inverse of the matrix of IEC 61966-2-1.
  const double rgb[3] = {3.2404542 * 0.3 - 1.5371385 * 0.4 - 0.4985314 * 0.2,
                         -0.9692660 * 0.3 + 1.8760108 * 0.4 + 0.0415560 * 0.2,
                         0.0556434 * 0.3 - 0.2040259 * 0.4 + 1.0572252 * 0.2};
  for (const Format& f : {Format{"rgb", {"R", "G", "B"}},
                          {"rgba", {"R", "G", "B", "A"}},
                          {"xyz", {"X", "Y", "Z"}},
                          {"xyza", {"X", "Y", "Z", "A"}},
                          {"luminance", {"Y"}},
                          {"luminance_alpha", {"Y", "A"}}}) {
    const auto film = FilmBuilder().set("pixel_format", std::string(f.name)).build();
    ASSERT_EQ(film->channel_names(), f.channels);
    float out[5] = {-1, -1, -1, -1, -1};
    film->develop(m, 0.7, out);
    for (std::size_t c = 0; c < f.channels.size(); ++c) {
      const std::string& n = f.channels[c];
      const double expected = n == "A"   ? 0.7
                              : n == "X" ? 0.3
                              : n == "Y" ? 0.4
                              : n == "Z" ? 0.2
                                         : rgb[n == "R"   ? 0
                                               : n == "G" ? 1
                                                          : 2];
      EXPECT_NEAR(out[c], expected, 1e-5) << f.name << " " << n;
    }
    EXPECT_EQ(out[f.channels.size()], -1) << "writes too much";
  }
}

TEST(HdrFilm, SrgbPrimariesComeBack) {
  // XYZ of the red, green and blue of sRGB by their chromaticities (x, y) and luminances.
  const double chromaticity[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}},
               luminance[3] = {0.2126, 0.7152, 0.0722};
  const auto film = FilmBuilder().build();
  for (int k = 0; k < 3; ++k) {
    const double x = chromaticity[k][0], y = chromaticity[k][1];
    const double m[3] = {x / y * luminance[k], luminance[k], (1 - x - y) / y * luminance[k]};
    float out[3];
    film->develop(m, 1, out);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(out[c], c == k ? 1 : 0, 1e-3);
  }
}

TEST(HdrFilm, DefaultsAndCrop) {
  const auto film = FilmBuilder().build();
  EXPECT_EQ(film->width(), 768);
  EXPECT_EQ(film->height(), 576);
  EXPECT_EQ(film->crop_width(), 768);
  EXPECT_FALSE(film->sample_border());
  EXPECT_EQ(film->pixel_type(), ExrPixel::half);
  EXPECT_EQ(film->filter().properties().type(), "gaussian");
  const auto crop = FilmBuilder()
                        .size(100, 50)
                        .set("crop_offset_x", std::int64_t(20))
                        .set("crop_height", std::int64_t(7))
                        .set("component_format", "float32"s)
                        .set("sample_border", true)
                        .set("", ObjectPtr(testing::build<Filter>("<rfilter type=\"box\"/>")))
                        .build();
  EXPECT_EQ(crop->crop_x(), 20);
  EXPECT_EQ(crop->crop_y(), 0);
  EXPECT_EQ(crop->crop_width(), 80) << "what is right of the offset";
  EXPECT_EQ(crop->crop_height(), 7);
  EXPECT_TRUE(crop->sample_border());
  EXPECT_EQ(crop->pixel_type(), ExrPixel::float32);
  EXPECT_EQ(crop->filter().radius(), 0.5f);
}

TEST(HdrFilm, ErrorsAreLocated) {
  const auto integer = [](std::int64_t v) { return Properties::Value(v); };
  const auto starts = [](const std::string& text, const std::string& start) {
    EXPECT_EQ(text.substr(0, start.size()), start) << text;
  };
  starts(FilmBuilder().set("width", integer(0)).error(), "scene.xml:11:5: ");
  starts(FilmBuilder().set("height", integer(-3)).error(), "scene.xml:11:5: ");
  starts(FilmBuilder().set("width", integer(1 << 21)).error(), "scene.xml:11:5: ");
  starts(FilmBuilder().size(10, 10).set("crop_offset_x", integer(10)).error(), "scene.xml:13:5: ");
  starts(FilmBuilder().size(10, 10).set("crop_width", integer(11)).error(), "scene.xml:13:5: ");
  starts(FilmBuilder().size(10, 10).set("crop_offset_y", integer(4)).set("crop_height", integer(7)).error(),
         "scene.xml:14:5: ");
  EXPECT_EQ(
      FilmBuilder().size(10, 10).set("crop_offset_y", integer(4)).set("crop_height", integer(6)).error(), "");
  starts(FilmBuilder().set("pixel_format", "cmyk"s).error(), "scene.xml:11:5: ");
  EXPECT_NE(FilmBuilder().set("pixel_format", "cmyk"s).error().find("luminance_alpha"), std::string::npos);
  starts(FilmBuilder().set("component_format", "float64"s).error(), "scene.xml:11:5: ");
  starts(FilmBuilder().set("file_format", "png"s).error(), "scene.xml:11:5: ");
  starts(FilmBuilder().set("width", "wide"s).error(), "scene.xml:11:5: ");
  const auto box = [] { return ObjectPtr(testing::build<Filter>("<rfilter type=\"box\"/>")); };
  starts(FilmBuilder().set("", box()).set("", box()).error(), "scene.xml:7:3: ");
  // The eye sees nothing at 10 micrometres.
  EXPECT_NE(FilmBuilder(8000, 12000).error().find("uniform"), std::string::npos);
  starts(FilmBuilder(8000, 12000).error(), "scene.xml:7:3: ");
  EXPECT_EQ(FilmBuilder(8000, 12000).set("response", "uniform"s).error(), "");
}

}  // namespace
}  // namespace aureole::testing
