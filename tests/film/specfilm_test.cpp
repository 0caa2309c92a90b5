// SPDX-License-Identifier: Apache-2.0
// specfilm: measurements of known spectra by bins and named responses, names and preview, ranges of a scene,
// errors, and a render of a hundred bins.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/film/film.h"
#include "aureole/film/spectral_bins.h"
#include "aureole/math/significance.h"
#include "aureole/render/output.h"
#include "aureole/render/statistics.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"
#include "tests/harness/properties_builder.h"
#include "tests/loading/load_text.h"
#include "tests/render/small_scene.h"

namespace aureole::testing {
namespace {

using test::TemporaryFolder;

std::shared_ptr<Film> film(const std::string& content, double min_nm = 360, double max_nm = 830) {
  return build<Film>("<film type='specfilm'>" + content + "</film>", make_context(min_nm, max_nm));
}
std::string error(const std::string& content, double min_nm = 360, double max_nm = 830) {
  try {
    film(content, min_nm, max_nm);
    return "";
  } catch (const Error& e) {
    return e.message();
  }
}

/// The measured numbers of a spectral radiance, by the sum over many equidistant wavelengths.
template <class Radiance>
std::vector<double> measure(const Film& film, const Radiance& radiance) {
  const SpectralGrid grid = film.properties().context().grid;
  constexpr int kRounds = 8 * 470;
  std::vector<double> sum(std::size_t(film.measured_channels()));
  std::vector<float> out(sum.size());
  for (int k = 0; k < kRounds; ++k) {
    const Spectrum nm = make_spectrum([&](int i) {
      return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (k + (i + 0.5) / kWavelengths) / kRounds);
    });
    const Wavelengths w = Wavelengths::at(grid, nm, float(1 / (grid.max_nm - grid.min_nm)));
    const Spectrum estimate =
        make_spectrum([&](int i) { return float(radiance(double(nm[i]))); }) / w.pdf * (1.f / kWavelengths);
    film.measure(estimate, w, out.data());
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += double(out[c]) / kRounds;
  }
  return sum;
}

TEST(SpectralBins, FindWhatHoldsAWavelength) {
  SeededRandom random(9);
  for (const int count : {1, 2, 7, 100, 4000}) {
    std::vector<double> edges{400};
    // From equal to very unequal widths.
    for (int i = 0; i < count; ++i)
      edges.push_back(edges.back() * (1 + 2e-5) + 5 * std::pow(random.next(), 8));
    for (const SpectralBins& bins :
         {SpectralBins(edges), SpectralBins::equal(edges.front(), edges.back(), count)}) {
      ASSERT_EQ(bins.count(), count);
      for (int i = 0; i < 20000; ++i) {
        const float nm = float(edges.front() + (edges.back() - edges.front()) * random.next());
        const int bin = bins.find(nm);
        ASSERT_GE(bin, 0);
        ASSERT_LT(bin, count);
        ASSERT_GE(nm, float(bins.lower(bin)));
        ASSERT_LE(nm, float(bins.upper(bin)));
      }
      for (int i = 0; i < count; ++i) EXPECT_EQ(bins.find(float(bins.lower(i))), i);
      EXPECT_EQ(bins.find(float(edges.back())), count - 1);
      EXPECT_EQ(bins.find(399.9f), -1);
      EXPECT_EQ(bins.find(float(edges.back()) + 1), -1);
    }
  }
}

TEST(SpectralBins, NamesTellThemApart) {
  EXPECT_EQ(SpectralBins({400, 500, 620.5}).channel_names(),
            (std::vector<std::string>{"S0.450,00nm", "S0.560,25nm"}));
  const auto fine = SpectralBins::equal(500, 501, 150).channel_names();
  EXPECT_EQ(std::set(fine.begin(), fine.end()).size(), 150u);
  EXPECT_EQ(fine.front(), "S0.500,003nm");
}

TEST(SpecFilm, BinsHoldTheMeanRadiance) {
  const auto square = [](double nm) { return nm * nm * 1e-4; };
  const auto equal = film("<integer name='bins' value='47'/>");
  const auto m = measure(*equal, square);
  ASSERT_EQ(m.size(), 47u);
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double a = 360 + 10.0 * double(i), b = a + 10;
    EXPECT_NEAR(m[i], (b * b * b - a * a * a) / 30 * 1e-4, 1e-3) << i;
  }
  const auto uneven = film("<string name='bin_edges' value='400, 410 500nm, 0.8um'/>");
  const double edges[] = {400, 410, 500, 800};
  const auto n = measure(*uneven, square);
  ASSERT_EQ(n.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(n[i], (std::pow(edges[i + 1], 3) - std::pow(edges[i], 3)) / 3e4 / (edges[i + 1] - edges[i]),
                2e-2)
        << i;
  // Each bin gets the same share of samples.
  const auto shares = uneven->response();
  for (const auto& [nm, width] : {std::pair{405, 10.0}, {450, 90.0}, {700, 300.0}})
    EXPECT_NEAR(shares.nodes()[std::size_t(nm - 360)], 1 / width, 1e-6);
  EXPECT_EQ(shares.nodes()[0], 0);
}

TEST(SpecFilm, ResponsesAreIntegrated) {
  // As Mitsuba: the integral over nm, not divided by that of the response.
  const auto f =
      film(R"(<spectrum name="band" value="500:0, 550:2, 600:0"/><spectrum name="flat" value="0.5"/>
    <spectrum name="object" type="regular"><float name="wavelength_min" value="400"/>
    <float name="wavelength_max" value="500"/><string name="values" value="1, 1"/></spectrum>)");
  EXPECT_EQ(f->channel_names(), (std::vector<std::string>{"band", "flat", "object"}));
  const auto m = measure(*f, [](double nm) { return nm / 100; });
  ASSERT_EQ(m.size(), 3u);
  EXPECT_NEAR(m[0], 5.5 * 100, 0.05);
  EXPECT_NEAR(m[1], 0.5 * (8.3 * 8.3 - 3.6 * 3.6) / 2 * 100, 0.05);
  EXPECT_NEAR(m[2], (5. * 5 - 4 * 4) / 2 * 100, 2) << "a step is rounded within a cell";
  float out[3];
  f->develop(m.data(), 1, out);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(out[c], float(m[c]));
}

double d65_luminance_one(double nm) {
  static const TabulatedSpectrum d65 = *find_illuminant("D65");
  static const double scale = cie_y_integral() / cie_tristimulus(d65)[1];
  return scale * d65.at(nm);
}

TEST(SpecFilm, PreviewHasTheColour) {
  float rgb[3];
  for (const char* content : {"<integer name='bins' value='235'/>", "<integer name='bins' value='47'/>"}) {
    const auto f = film(content);
    f->develop_rgb(measure(*f, d65_luminance_one).data(), rgb);
    for (const float v : rgb) EXPECT_NEAR(v, 1, 0.02) << content;
  }
  // A mixture of the responses has the colour that it has on an hdrfilm.
  const auto bands = film(
      "<spectrum name='b' value='400:0, 450:1, 500:0'/><spectrum name='g' value='470:0, 540:1, 600:0'/>"
      "<spectrum name='r' value='560:0, 620:1, 700:0'/>");
  const auto tent = [](double nm, double a, double b, double c) {
    return std::max(0.0, std::min((nm - a) / (b - a), (c - nm) / (c - b)));
  };
  const auto mixture = [&](double nm) {
    return 0.9 * tent(nm, 400, 450, 500) + 0.5 * tent(nm, 470, 540, 600) + 0.7 * tent(nm, 560, 620, 700);
  };
  const auto colour = build<Film>("<film type='hdrfilm'/>");
  float expected[3];
  colour->develop_rgb(measure(*colour, mixture).data(), expected);
  bands->develop_rgb(measure(*bands, mixture).data(), rgb);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], expected[c], 0.01);
  // Stored as well, before the bins.
  const auto stored = film("<integer name='bins' value='10'/>");
  const auto names = stored->channel_names();
  ASSERT_EQ(names.size(), 13u);
  EXPECT_EQ(names[0], "R");
  EXPECT_EQ(names[3], "S0.383,50nm");
  const auto m = measure(*stored, d65_luminance_one);
  float out[13];
  stored->develop(m.data(), 1, out);
  stored->develop_rgb(m.data(), rgb);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(out[c], rgb[c]);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(out[3 + i], float(m[i]));
  EXPECT_EQ(film("<integer name='bins' value='10'/><boolean name='preview' value='false'/>")
                ->channel_names()
                .size(),
            10u);
  // Where nothing is visible, the mean.
  for (const char* content :
       {"<integer name='bins' value='8'/>", "<spectrum name='a' value='1000:1, 2000:1'/>"}) {
    const auto infrared = film(content, 1000, 2000);
    infrared->develop_rgb(measure(*infrared, [](double) { return 3.0; }).data(), rgb);
    for (const float v : rgb) EXPECT_NEAR(v, 3, 1e-3) << content;
  }
}

TEST(SpecFilm, Errors) {
  const auto says = [](const std::string& message, const std::string& what) {
    EXPECT_NE(message.find(what), std::string::npos) << "\"" << message << "\" does not say " << what;
  };
  const std::string band = "<spectrum name='a' value='500:0, 600:1'/>";
  says(error(""), "needs responses");
  says(error(band + "<integer name='bins' value='3'/>"), "either bins or named");
  says(error("<integer name='bins' value='3'/><string name='bin_edges' value='400, 500'/>"),
       "either \"bins\"");
  says(error("<integer name='bins' value='0'/>"), "bins");
  says(error("<string name='bin_edges' value='400'/>"), "at least two");
  says(error("<string name='bin_edges' value='400, 390, 410'/>"), "increasing");
  says(error("<string name='bin_edges' value='400, 400.001'/>"), "apart");
  says(error("<string name='bin_edges' value='400, red'/>"), "red");
  says(error("<string name='bin_edges' value='300, 400'/>"), "beyond the film's range of 360");
  says(error("<spectrum name='a' value='500:1, 900:1'/>"), "beyond the film's range");
  says(error("<spectrum name='a' value='500:0, 600:0'/>"), "zero over the whole range");
  says(error("<spectrum name='a' value='500:1, 600:-1'/>"), "negative");
  says(error("<rgb name='a' value='1, 0, 0'/>"), "not a colour");
  says(error("<spectrum value='500:1, 600:1'/>"), "needs a name");
  says(error("<spectrum name='A' value='500:1, 600:1'/>"), "alpha");
  says(error("<texture name='a' type='checkerboard'/>"), "not a picture");
  says(error(band + "<string name='file_format' value='pfm'/>"), "openexr");
  try {
    build<Film>("<film type='specfilm'>" + band + "<float name='widht' value='3'/></film>");
    FAIL();
  } catch (const Error& e) {
    says(e.what(), "width");
  }
  try {
    build_object("<sensor type='perspective'><spectrum name='srf' value='1'/><film type='specfilm'>" + band +
                 "</film></sensor>");
    FAIL();
  } catch (const Error& e) {
    says(e.what(), "srf");
  }
}

TEST(SpecFilm, BinsOfFrequenciesBeginAtEitherEnd) {
  const auto radio =
      film("<string name='bin_edges' value='26GHz, 27GHz, 29GHz'/><boolean name='preview' value='false'/>",
           1.03e7, 1.16e7);
  const auto names = radio->channel_names();
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[0], "S0.10720547,67nm");  // the middle of c/29 GHz and c/27 GHz
  const std::vector<double> means = measure(*radio, [](double nm) { return nm < 1.11e7 ? 3.0 : 5.0; });
  EXPECT_NEAR(means[0], 3, 0.05);
  EXPECT_NEAR(means[1], 5, 0.05);
}

TEST(SpecFilm, OtherErrorsDoNotMakeItsNamesUnknown) {
  const auto errors = test::errors_of_file(
      "<scene version='3.0.0'>\n<sensor type='perspective'><film type='specfilm'>\n<spectrum name='a' "
      "value='700:1, 400:2, 500:1'/><float name='b' value='1'/></film></sensor></scene>");
  ASSERT_EQ(errors.size(), 2u) << ::testing::PrintToString(errors);
  EXPECT_NE(errors[0].find("must increase"), std::string::npos) << errors[0];
  EXPECT_NE(errors[1].find("unknown parameter \"b\""), std::string::npos) << errors[1];
}

TEST(SpecFilm, SetsTheRangeOfTheScene) {
  const TemporaryFolder folder;
  folder.write("band.spd", "# nm value\n1200 0\n1300 1\n1400 0\n");
  const auto range = [&](const std::string& film) {
    const auto file =
        folder.write("s.xml",
                     "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><film "
                     "type='specfilm'>" +
                         film + "</film></sensor><emitter type='constant'/></scene>");
    const auto scene = load_scene(file).scene;
    const SpectralGrid& g = scene->wavelengths().grid();
    return std::pair{g.min_nm, g.max_nm};
  };
  const std::string regular =
      "<spectrum name='c' type='regular'><float name='wavelength_min' value='900'/><float "
      "name='wavelength_max' value='950'/><string name='values' value='1, 1'/></spectrum>";
  const std::string irregular =
      "<spectrum name='d' type='irregular'><string name='wavelengths' value='100, 120, 130'/><string "
      "name='values' value='0, 1, 1'/></spectrum>";
  using P = std::pair<double, double>;
  EXPECT_EQ(range("<spectrum name='a' value='500:0, 600:1'/>"), P(500, 600));
  EXPECT_EQ(range("<spectrum name='a' value='500:0, 600:1'/><spectrum name='b' filename='band.spd'/>"),
            P(500, 1400));
  EXPECT_EQ(range(regular), P(900, 950));
  EXPECT_EQ(range(regular + "<rfilter type='box'/>"), P(900, 950)) << "a filter has no wavelengths";
  EXPECT_EQ(range(regular + irregular), P(100, 950));
  EXPECT_EQ(range("<spectrum name='a' value='1'/>"), P(360, 830));
  EXPECT_EQ(range("<integer name='bins' value='4'/>"), P(360, 830));
  EXPECT_EQ(range("<string name='bin_edges' value='0.3um, 400, 410'/>"), P(300, 410));
  EXPECT_EQ(range("<string name='bin_edges' value='400, 410'/><float name='wavelength_max' value='500'/>"),
            P(400, 500));
}

LoadedScene scene_with_film(const std::string& film) {
  std::string text = test::small_scene_text(24, 16);
  const auto begin = text.find("<film "), end = text.find("</film>");
  text.replace(begin, end + 7 - begin,
               film +
                   "<integer name='width' value='24'/><integer name='height' value='16'/><string "
                   "name='component_format' value='float32'/></film>");
  return load_scene_from_string(text, "bins.xml");
}
Image render(const std::string& film, std::uint64_t seed, RenderState* state = nullptr) {
  RenderOptions options;
  options.end = 32, options.replicates = 32, options.seed = seed;
  RenderJob job(scene_with_film(film), options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  if (state) *state = job.state();
  return job.state().picture();
}

TEST(SpecFilm, AHundredBinsAddUpToTheColour) {
  RenderState state;
  const Image bins = render("<film type='specfilm'><integer name='bins' value='100'/>", 1, &state);
  ASSERT_EQ(bins.channels.size(), 2 * 103u);
  const Image rgb = render("<film type='hdrfilm'>", 2);
  // Bins of 4.7 nm are fine enough for this scene's spectra: the difference is within 2e-3.
  const Comparison c = compare_images(bins, rgb, 2e-3);
  ASSERT_TRUE(c.z);
  EXPECT_EQ(c.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_TRUE(c.z->passes) << c.z->mean_square << " " << c.z->outside << " " << c.z->mean_relative;
  // And as many responses as bins are the same measurement times the bins' width.
  const Image bands = render(
      "<film type='specfilm'><float name='wavelength_min' value='360'/><float name='wavelength_max' "
      "value='830'/><spectrum name='S0.595,00nm' value='548:0, 548.001:0.0106383, 641.999:0.0106383, "
      "642:0'/>",
      3);
  const Image five = render("<film type='specfilm'><integer name='bins' value='5'/>", 4);
  const Comparison d = compare_images(bands, five, 2e-3);
  ASSERT_TRUE(d.z);
  EXPECT_EQ(d.channels, std::vector<std::string>{"S0.595,00nm"});
  EXPECT_TRUE(d.z->passes) << d.z->mean_square << " " << d.z->outside << " " << d.z->mean_relative;

  // The file's metadata.
  const TemporaryFolder folder;
  write_pictures(state, folder.path / "bins.exr");
  ExrAttributes attributes;
  const Image read = read_image(folder.path / "bins.exr", &attributes);
  EXPECT_EQ(read.channels.size(), 206u);
  EXPECT_GE(read.channel("S0.592,65nm"), 0);
  EXPECT_EQ(attributes.strings["spectralLayoutVersion"], "1.0");
  EXPECT_EQ(attributes.strings["emissiveUnits"], "W.m^-2.sr^-1");
}

}  // namespace
}  // namespace aureole::testing
