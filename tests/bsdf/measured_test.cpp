// SPDX-License-Identifier: Apache-2.0
// The BSDF `measured` against Mitsuba's on synthetic files of all kinds (tests/bsdf/data/measured/make_synthetic.py), and
// damaged files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/bsdf/measured/rgl_table.h"
#include "aureole/bsdf/measured/tensor_file.h"
#include "aureole/core/random.h"
#include "aureole/math/warp.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/rgb_primaries.h"
#include "aureole/spectrum/tables.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/paths.h"

namespace aureole::testing {
namespace {

std::filesystem::path measured_data(const std::string& name) {
  return test::source_dir() / "tests/bsdf/data/measured" / name;
}

std::shared_ptr<Bsdf> measured_bsdf(const std::string& file, const std::string& more = "") {
  return build<Bsdf>("<bsdf type=\"measured\"><string name=\"filename\" value=\"" +
                     measured_data(file).string() + "\"/>" + more + "</bsdf>");
}

struct ReferenceLine {
  std::string file;
  Vec3 wi, wo;
  double pdf, value[4];
};
std::vector<ReferenceLine> reference_lines() {
  std::ifstream in(measured_data("reference.txt"));
  std::vector<ReferenceLine> lines;
  ReferenceLine l;
  while (in >> l.file >> l.wi.x >> l.wi.y >> l.wi.z >> l.wo.x >> l.wo.y >> l.wo.z >> l.pdf >> l.value[0] >>
         l.value[1] >> l.value[2] >> l.value[3])
    lines.push_back(l);
  return lines;
}

TEST(Measured, ValuesAndDensitiesAreMitsubas) {
  const std::vector<ReferenceLine> lines = reference_lines();
  ASSERT_EQ(lines.size(), 200u);
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const Spectrum nm = make_spectrum([](int i) {
    const float of_reference[] = {412.5f, 500.f, 587.3f, 731.f};
    return of_reference[i % 4];
  });
  const Wavelengths w = Wavelengths::at(grid, nm);
  const SurfacePoint point;
  double worst_value = 0, worst_pdf = 0;
  for (const ReferenceLine& l : lines) {
    RglNotes notes;
    const RglFile file = read_rgl_file(measured_data(l.file + ".bsdf"), notes);
    const RglTable table(file, grid);
    const auto bsdf = measured_bsdf(l.file + ".bsdf");
    const BsdfEval e = bsdf->eval_pdf(l.wi, l.wo, {w, point});
    worst_pdf = std::max(worst_pdf, std::abs(double(e.pdf[0]) / l.pdf - 1));
    if (file.nm.empty()) {
      const std::array<float, 3> rgb = table.rgb(l.wi, l.wo);
      for (std::size_t c = 0; c < 3; ++c)
        worst_value = std::max(worst_value, std::abs(double(rgb[c]) / l.value[c] - 1));
    } else {
      for (int i = 0; i < 4; ++i)
        worst_value = std::max(worst_value, std::abs(double(e.value[i]) / l.value[i] - 1));
    }
  }
  EXPECT_LT(worst_value, 2e-4);
  EXPECT_LT(worst_pdf, 2e-4);
}

TEST(Measured, WarpsAreInvertedAndIntegrateToOne) {
  std::vector<float> values(2 * 5 * 4);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float((i * 7) % 11) / 11;
  const BilinearWarp warp(5, 4, 2, values);
  const SliceNodes nodes{{0}, {0, 1}};
  const SliceBlend blend = nodes.at(0, 0.3f);
  double integral = 0;
  constexpr int kSteps = 400;
  for (int y = 0; y < kSteps; ++y)
    for (int x = 0; x < kSteps; ++x)
      integral += double(warp.pdf({(float(x) + 0.5f) / kSteps, (float(y) + 0.5f) / kSteps}, blend)) /
                  (kSteps * kSteps);
  EXPECT_NEAR(integral, 1, 1e-5);
  for (int i = 0; i < 100; ++i) {
    const Vec2 u{float((i * 37) % 101) / 101, float((i * 53) % 103) / 103};
    const BilinearWarp::Point p = warp.sample(u, blend), back = warp.invert(p.p, blend);
    EXPECT_NEAR(back.p.x, u.x, 1e-4) << i;
    EXPECT_NEAR(back.p.y, u.y, 1e-4) << i;
    EXPECT_NEAR(p.pdf, warp.pdf(p.p, blend), 1e-4);
    EXPECT_NEAR(back.pdf, p.pdf, 1e-4);
  }
}

TEST(Measured, LightTravelsEitherWay) {
  const auto view = measured_bsdf("anisotropic_spectral.bsdf"),
             light = measured_bsdf("anisotropic_spectral.bsdf", R"(<string name="incident" value="light"/>)");
  const Vec3 a = direction(0.4, 2), b = direction(1.1, -0.7);
  const Setting radiance, importance(TransportMode::importance);
  const double forward = brdf(*view, a, b, radiance);
  EXPECT_NEAR(brdf(*light, b, a, radiance), forward, 1e-5 * forward);
  EXPECT_NEAR(brdf(*view, b, a, importance), forward, 1e-5 * forward);
  EXPECT_NEAR(brdf(*light, a, b, importance), forward, 1e-5 * forward);
  EXPECT_GT(std::abs(brdf(*view, b, a, radiance) - forward), 1e-3 * forward);
}

std::string damaged(const std::function<void(std::string&)>& damage) {
  std::ifstream in(measured_data("isotropic_spectral.bsdf"), std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  damage(bytes);
  const std::string path = ::testing::TempDir() + "damaged.bsdf";
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    RglNotes notes;
    read_rgl_file(path, notes);
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), path);
    return e.message();
  }
  return "no error";
}

TEST(Measured, DamagedFilesAreLocatedErrors) {
  EXPECT_NE(damaged([](std::string& b) { b.resize(6000); }).find("truncated"), std::string::npos);
  EXPECT_NE(damaged([](std::string& b) { b.resize(40); }).find("truncated"), std::string::npos);
  EXPECT_NE(damaged([](std::string& b) { b.clear(); }).find("not a tensor file"), std::string::npos);
  EXPECT_NE(damaged([](std::string& b) { b[0] = 'T'; }).find("not a tensor file"), std::string::npos);
  EXPECT_NE(damaged([](std::string& b) { b[12] = 7; }).find("version 7.0"), std::string::npos);
  EXPECT_NE(damaged([](std::string& b) { b[17] = '\x7f'; }).find("at most 256"), std::string::npos);
  const auto rename = [](const char* field) { return [field](std::string& b) { b[b.find(field)] = 'X'; }; };
  EXPECT_NE(damaged(rename("vndf")).find("no field \"vndf\""), std::string::npos);
  // A shape of 2^63 numbers must not overflow.
  EXPECT_NE(damaged([](std::string& b) {
              const std::size_t at = b.find("theta_i") + 7 + 2 + 1 + 8;
              std::memset(&b[at], 0xff, 8);
            }).find("more numbers than the file has bytes"),
            std::string::npos);
  // NaN in the spectra, which are the last field.
  EXPECT_NE(damaged([](std::string& b) { std::memset(&b[b.size() - 40], 0xff, 4); }).find("not finite"),
            std::string::npos);
}

TEST(Measured, EveryCutOfAFileIsAnError) {
  std::ifstream in(measured_data("isotropic_rgb.bsdf"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string path = ::testing::TempDir() + "cut.bsdf";
  RglNotes notes;
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 50) {
    std::ofstream(path, std::ios::binary) << bytes.substr(0, length);
    EXPECT_THROW(read_rgl_file(path, notes), Error) << length;
  }
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_NO_THROW(read_rgl_file(path, notes));
}

TEST(Measured, WritingIsTheInverseOfReading) {
  for (const char* name : {"anisotropic_spectral.bsdf", "isotropic_rgb.bsdf"}) {
    RglNotes notes;
    const RglFile a = read_rgl_file(measured_data(name), notes);
    const std::string path = ::testing::TempDir() + "again.bsdf";
    std::ofstream(path, std::ios::binary) << rgl_file_content(a);
    const RglFile b = read_rgl_file(path, notes);
    EXPECT_EQ(a.description, b.description);
    EXPECT_EQ(a.phi_i, b.phi_i);
    EXPECT_EQ(a.theta_i, b.theta_i);
    EXPECT_EQ(a.nm, b.nm);
    EXPECT_EQ(a.ndf.values, b.ndf.values);
    EXPECT_EQ(a.sigma.values, b.sigma.values);
    EXPECT_EQ(a.vndf.values, b.vndf.values);
    EXPECT_EQ(a.luminance.values, b.luminance.values);
    EXPECT_EQ(a.spectra, b.spectra);
    EXPECT_EQ(a.is_relative, b.is_relative);
  }
}

// The primaries add up to one, and under D65 their colours are those of sRGB.
TEST(Measured, PrimariesHaveTheirColours) {
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const std::array<SampledSpectrum, 3> primaries = rgb_primaries(grid);
  const auto d65 = find_illuminant("D65");
  const SampledSpectrum light = SampledSpectrum::from_points(grid, d65->wavelengths_nm, d65->values);
  const auto observer = observer_xyz(grid);
  const double white = overlap(light, observer[1]);
  constexpr double kPrimaryY[3] = {0.2126, 0.7152, 0.0722}, kPrimaryX[3] = {0.64, 0.3, 0.15},
                   kPrimaryYy[3] = {0.33, 0.6, 0.06};
  for (std::size_t c = 0; c < 3; ++c) {
    const SampledSpectrum seen = product(light, primaries[c]);
    const double x = overlap(seen, observer[0]), y = overlap(seen, observer[1]),
                 z = overlap(seen, observer[2]);
    EXPECT_NEAR(y / white, kPrimaryY[c], 3e-4);
    EXPECT_NEAR(x / (x + y + z), kPrimaryX[c], 3e-4);
    EXPECT_NEAR(y / (x + y + z), kPrimaryYy[c], 3e-4);
  }
  for (std::size_t i = 0; i < primaries[0].nodes().size(); ++i)
    EXPECT_NEAR(primaries[0].nodes()[i] + primaries[1].nodes()[i] + primaries[2].nodes()[i], 1, 1e-5);
}

void measured_case(BsdfCase& c) {
  c.black_below = c.may_fail = true;
  c.mode = TransportMode::radiance;
  c.not_reciprocal = "tables of a finite resolution are reciprocal within some percent";
  if (c.name == "measured_example_2") {
    c.gains_energy = "its few angles of incidence are too far apart near 90 degrees";
    c.largest_energy = 1.2;
  }
}
/// Random tables.
BsdfCase synthetic_case(const std::string& name) {
  BsdfCase c;
  c.name = "measured_" + name;
  c.xml = "<bsdf type=\"measured\"><string name=\"filename\" value=\"" + name + ".bsdf\"/></bsdf>";
  measured_case(c);
  return c;
}
const BsdfCases kMeasured("measured", measured_case,
                          {synthetic_case("anisotropic_spectral"), synthetic_case("anisotropic_rgb"),
                           synthetic_case("full_circle")});

}  // namespace
}  // namespace aureole::testing
