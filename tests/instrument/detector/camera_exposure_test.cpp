// SPDX-License-Identifier: Apache-2.0
// Electrons of spectral pictures in closed form, raw pictures as files, and aureole expose as a user meets it.
#include "aureole/instrument/detector/camera_exposure.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "aureole/core/error.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

/// A picture of 100 intervals from 500 to 600 nm of the radiance 1 W/(m^2 sr nm) everywhere.
SpectralPicture flat_picture(int width, int height, bool is_irradiance = false) {
  SpectralPicture p{width, height, is_irradiance, {}, {}, {}};
  for (int i = 0; i < 100; ++i) p.lower_nm.push_back(500 + i), p.upper_nm.push_back(501 + i);
  p.values.assign(std::size_t(width * height * 100), 1.f);
  return p;
}
/// Filters of three bells; an invented sensor.
std::vector<EfficiencyCurve> bells() {
  std::vector<EfficiencyCurve> curves(3);
  const double centers[] = {600, 535, 455}, widths[] = {42, 45, 38};
  for (std::size_t c = 0; c < 3; ++c)
    for (double nm = 380; nm <= 720; nm += 5) {
      curves[c].nm.push_back(nm);
      curves[c].values.push_back(0.5 * std::exp(-0.5 * std::pow((nm - centers[c]) / widths[c], 2)));
    }
  return curves;
}

TEST(CameraExposure, ElectronsOfAFlatSpectrum) {
  CameraModel c;
  c.pixel_pitch_um = 5, c.fill_factor = 0.8, c.f_number = 4, c.transmission = 0.9;
  c.efficiency = {EfficiencyCurve::constant(0.6)};
  // The integral of lambda/(h c) from 500 to 600 nm is (600^2 - 500^2)/2 nm^2 over h c.
  const double photons = 0.5 * (360000 - 250000) * 1e-9 / (6.62607015e-34 * 299792458);
  const double expected = photons * 0.6 * 0.9 * 25e-12 * 0.8 * M_PI / 64 * 1e-6;
  for (const double e : mean_electrons(flat_picture(3, 2), c, 1e-6))
    EXPECT_NEAR(e, expected, 1e-5 * expected);
  c.aperture = optics::ApertureLaw::thin;
  EXPECT_NEAR(mean_electrons(flat_picture(1, 1), c, 1e-6)[0], expected * 64 / 65, 1e-5 * expected);
  // The irradiance on the film needs no aperture.
  EXPECT_NEAR(mean_electrons(flat_picture(1, 1, true), c, 1e-6)[0], expected * 64 / M_PI,
              1e-5 * expected * 64 / M_PI);
}

TEST(CameraExposure, FiltersAndMosaicsDivideTheLight) {
  CameraModel c;
  c.mosaic = optics::ColorMosaic::named("rggb");
  EfficiencyCurve red{{550, 551}, {0.5, 0.5}}, green{{500, 600}, {0.5, 0.5}}, blue{{400, 450}, {0.5, 0.5}};
  c.efficiency = {red, green, blue};
  const std::vector<double> e = mean_electrons(flat_picture(2, 2), c, 1e-6);
  EXPECT_GT(e[0], 0);
  // Red sees one of the 100 nm that green sees, at the mean energy of a photon nearly.
  EXPECT_NEAR(e[0] / e[1], 0.01, 1e-4);
  EXPECT_EQ(e[1], e[2]);
  EXPECT_EQ(e[3], 0);
}

TEST(CameraExposure, AMatrixOfColoursKeepsWhite) {
  const ColorCalibration k = calibrate_colors(bells());
  ASSERT_EQ(k.delta_e.size(), 24u);
  EXPECT_LT(k.mean_delta_e, 3);
  // White (1, 1, 1) is D65's: X 0.9505, Y 1, Z 1.0891.
  EXPECT_NEAR(k.to_xyz[0] + k.to_xyz[1] + k.to_xyz[2], 0.9505, 2e-3);
  EXPECT_NEAR(k.to_xyz[3] + k.to_xyz[4] + k.to_xyz[5], 1, 1e-9);
  EXPECT_NEAR(k.to_xyz[6] + k.to_xyz[7] + k.to_xyz[8], 1.0891, 3e-3);
  // The matrix of the file takes that white to the sensor's colours of white.
  double seen[3] = {};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t i = 0; i < 3; ++i)
      seen[r] += k.from_xyz[3 * r + i] * (k.to_xyz[3 * i] + k.to_xyz[3 * i + 1] + k.to_xyz[3 * i + 2]);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_NEAR(seen[r] / seen[1], k.white[r] / k.white[1], 1e-9);
  // A camera whose curves are the eye's is exact: Luther's condition. (Efficiencies times wavelength, as electrons count.)
  std::vector<EfficiencyCurve> eye(3);
  const auto bell = [](double x, double mean, double below, double above) {
    const double s = x < mean ? below : above;
    return std::exp(-0.5 * std::pow((x - mean) / s, 2));
  };
  for (double nm = 380; nm <= 780; nm += 1) {
    // Wyman, Sloan & Shirley 2013, "Simple analytic approximations to the CIE XYZ color matching functions".
    const double x = 1.056 * bell(nm, 599.8, 37.9, 31.0) + 0.362 * bell(nm, 442, 16, 26.7) -
                     0.065 * bell(nm, 501.1, 20.4, 26.2),
                 y = 0.821 * bell(nm, 568.8, 46.9, 40.5) + 0.286 * bell(nm, 530.9, 16.3, 31.1),
                 z = 1.217 * bell(nm, 437, 11.8, 36) + 0.681 * bell(nm, 459, 26, 13.8);
    const double values[] = {x, y, z};
    for (std::size_t c = 0; c < 3; ++c)
      eye[c].nm.push_back(nm), eye[c].values.push_back(std::max(0.0, 200 * values[c] / nm));
  }
  EXPECT_LT(calibrate_colors(eye).mean_delta_e, 0.2);
  EXPECT_THROW(calibrate_colors(std::vector<EfficiencyCurve>(3, EfficiencyCurve::constant(0.5))), Error);
}

class ExposeCommand : public ::testing::Test {
protected:
  ExposeCommand() {
    folder.write("grey.xml", scene("<float name='shutter_close' value='0.001'/>"));
    std::string table = "nm, red, green, blue\n";
    const auto curves = bells();
    for (std::size_t i = 0; i < curves[0].nm.size(); ++i)
      table += std::to_string(curves[0].nm[i]) + ", " + std::to_string(curves[0].values[i]) + ", " +
               std::to_string(curves[1].values[i]) + ", " + std::to_string(curves[2].values[i]) + "\n";
    folder.write("filters.csv", table);
    folder.write("camera.json",
                 R"({"name": "test", "mosaic": "rggb", "efficiency": "filters.csv", "full_well": 8000,
      "read_noise": 2.5, "gain": 0.4, "black_level": 128, "bits": 12, "pixel_pitch_um": 3, "f_number": 4, "aperture": "thin",
      "dark_current": 1, "dsnu": 1, "prnu": 0.01, "fill_factor": 0.9, "transmission": 0.9})");
  }
  static std::string scene(const std::string& sensor,
                           const std::string& film = "<integer name='bins' value='40'/>") {
    return "<scene version='3.0.0'><default name='width' value='48'/><default name='height' value='36'/>"
           "<integrator type='path'/><sensor type='perspective'>" +
           sensor +
           "<film type='specfilm'><integer name='width' value='$width'/><integer name='height' value='$height'/>"
           "<float name='wavelength_min' value='380'/><float name='wavelength_max' value='780'/><rfilter type='box'/>" +
           film +
           "</film><sampler type='sobol'><integer name='sample_count' value='64'/></sampler></sensor><emitter type='constant'>"
           "<spectrum name='radiance' type='d65'/><string name='amount' value='2000 cd/m^2'/></emitter></scene>";
  }
  int run(const std::vector<std::string>& arguments) {
    const ProgramEnd end = run_program(folder.path, arguments);
    output = end.output;
    return end.exit_code;
  }
  void refused(const std::vector<std::string>& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << output;
    EXPECT_NE(output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << output;
    for (const char* name : {"x.dng", "x.tif"}) EXPECT_FALSE(fs::exists(folder.path / name)) << name;
  }
  TemporaryFolder folder;
  std::string output;
};

TEST_F(ExposeCommand, WritesRawPicturesThatLibrawOpens) {
  int opened = 0;
  for (const char* mosaic : {"rggb", "bggr", "grbg", "gbrg", "xtrans", "mono"}) {
    std::vector<std::string> arguments{"expose", "grey.xml", "-o",          "x.dng",    "-o",
                                       "x.tif",  "--camera", "camera.json", "--mosaic", mosaic};
    if (std::string(mosaic) == "mono") arguments.insert(arguments.end(), {"--efficiency", "0.5"});
    // LibRaw develops X-Trans pictures of at least 512 x 512 pixels.
    const bool is_xtrans = std::string(mosaic) == "xtrans";
    const int width = is_xtrans ? 528 : 48, height = is_xtrans ? 516 : 36;
    if (is_xtrans) arguments.insert(arguments.end(), {"-D", "width=528", "-D", "height=516", "--spp", "4"});
    ASSERT_EQ(run(arguments), 0) << output;
    EXPECT_NE(output.find("signal to noise"), std::string::npos) << output;
    const Image tiff = read_image(folder.path / "x.tif");
    ASSERT_EQ(tiff.width, width);
    ASSERT_EQ(tiff.height, height);
    std::ofstream values(folder.path / "values.u16", std::ios::binary);
    int bright = 0;
    for (const float v : tiff.pixels) {
      const auto number = std::uint16_t(std::lround(v * 65535));
      bright += number > 200;
      values.write(reinterpret_cast<const char*>(&number), 2);
    }
    values.close();
    EXPECT_GT(bright, 1000);
    // The white level: the full well of 8000 e at 0.4 DN/e above 128.
    const std::string judge = (source_dir() / "tests/instrument/detector/judge_raw.py").string();
    const char* python = std::getenv("AUREOLE_JUDGE_PYTHON");
    const std::string command = std::string(python ? python : "python3") + " " + judge + " " +
                                (folder.path / "x.dng").string() + " " +
                                (folder.path / "values.u16").string() + " " + mosaic + " 128 3328";
    const int status = std::system(command.c_str());
    if (WEXITSTATUS(status) == 77) continue;
    EXPECT_EQ(status, 0) << command;
    ++opened;
  }
  if (opened == 0) GTEST_SKIP() << "rawpy is not installed (AUREOLE_JUDGE_PYTHON names a Python that has it)";
  EXPECT_EQ(opened, 6);
}

TEST_F(ExposeCommand, FramesDifferAndTheirNumbersRepeatThem) {
  ASSERT_EQ(run({"expose", "grey.xml", "-o", "x.tif", "--efficiency", "0.5", "--frames", "3", "--electrons",
                 "e.exr", "--full-well", "100000", "--gain", "0.05"}),
            0)
      << output;
  const auto pixels = [&](const char* name) { return read_image(folder.path / name).pixels; };
  EXPECT_NE(pixels("x_0001.tif"), pixels("x_0002.tif"));
  ASSERT_EQ(run({"expose", "grey.xml", "-o", "y.tif", "--efficiency", "0.5", "--frame", "2", "--full-well",
                 "100000", "--gain", "0.05"}),
            0)
      << output;
  EXPECT_EQ(pixels("y.tif"), pixels("x_0002.tif"));
  // The mean of the electrons in the scene: 2000 cd/m^2 of D65 for 1 ms.
  const Image e = read_image(folder.path / "e.exr");
  double sum = 0;
  for (const float v : e.pixels) sum += double(v) / double(e.pixels.size());
  double signal = 0;
  for (const float v : pixels("y.tif")) signal += double(v) * 65535 / double(e.pixels.size());
  EXPECT_NEAR(signal, 64 + 0.05 * sum, 0.01 * signal);
  // 683 lm/W of D65 have 0.0146 W in 380 to 720 nm per lumen at some 4.1 10^15 photons a lumen: about this many electrons.
  const double rough = 2000 * M_PI / (4 * 2.8 * 2.8) * 1e-3 * 16e-12 * 1.2e16 * 0.5;
  EXPECT_NEAR(sum, rough, 0.3 * rough);
}

TEST_F(ExposeCommand, APictureIsExposedAsItsSceneIs) {
  ASSERT_EQ(run({"render", "grey.xml", "-o", "p.exr"}), 0) << output;
  ASSERT_EQ(run({"expose", "p.exr", "-o", "x.tif", "--exposure", "0.001", "--efficiency", "0.5"}), 0)
      << output;
  ASSERT_EQ(run({"expose", "grey.xml", "-o", "y.tif", "--efficiency", "0.5"}), 0) << output;
  const auto a = read_image(folder.path / "x.tif").pixels, b = read_image(folder.path / "y.tif").pixels;
  ASSERT_EQ(a.size(), b.size());
  // The picture is stored in half precision.
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference += double(a[i] - b[i]), sum += double(a[i]);
  EXPECT_LT(std::abs(difference), 2e-3 * sum);
}

TEST_F(ExposeCommand, MistakesAreNamed) {
  const auto with = [](std::vector<std::string> more) {
    std::vector<std::string> all{"expose", "grey.xml", "-o", "x.dng"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  refused(with({"--exposure", "0"}), "--exposure 0: must be positive");
  refused(with({"--exposure", "-1"}), "must be positive");
  refused(with({"--bits", "17"}), "1 to 16 bits");
  refused(with({"--gain", "0"}), "gain must be positive");
  refused(with({"--full-well", "0"}), "full well");
  refused(with({"--efficiency", "1.5"}), "between 0 and 1");
  refused(with({"--efficiency", "none.csv"}), "none.csv");
  refused(with({"--mosaic", "rgbw"}), "xtrans");
  refused(with({"--mosaic", "rggb"}), "table of the efficiency of red, green and blue");
  refused(with({"--f-number", "0.3"}), "sine condition");
  refused(with({"--transmission", "0"}), "transmission");
  refused({"expose", "grey.xml", "-o", "x.png"}, ".dng, .tif");
  folder.write("still.xml", scene(""));
  refused({"expose", "still.xml", "-o", "x.dng"}, "--exposure: is needed");
  folder.write("rgb.xml",
               "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/></scene>");
  refused({"expose", "rgb.xml", "-o", "x.dng", "--exposure", "1"}, "no spectral channels");
  folder.write("bad.json", "{\"full_wel\": 3}");
  refused(with({"--camera", "bad.json"}), "did you mean \"full_well\"");
  folder.write("bad.json", "{\"full_well\": \"much\"}");
  refused(with({"--camera", "bad.json"}), "must be a number");
  folder.write("bad.json", "{\"bits\": ");
  refused(with({"--camera", "bad.json"}), "no JSON");
  folder.write("bad.csv", "400, 0.5\n450, x\n");
  refused(with({"--efficiency", "bad.csv"}), "bad.csv:2:6");
  folder.write("bad.csv", "400, 0.5\n450, 1.5\n");
  refused(with({"--efficiency", "bad.csv"}), "between 0 and 1");
  folder.write("bad.csv", "400, 0.5\n300, 0.5\n");
  refused(with({"--efficiency", "bad.csv"}), "increase");
  folder.write("ir.csv", "900, 0.5\n1000, 0.5\n");
  refused(with({"--efficiency", "ir.csv"}), "blind");
}

}  // namespace
}  // namespace aureole::test
