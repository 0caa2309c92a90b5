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

/// The file with `parts` wavelengths for each interval of wavelengths, and values on the straight lines between: the same
/// spectra at more wavelengths.
RglFile with_more_wavelengths(const RglFile& file, std::size_t parts) {
  RglFile more = file;
  const std::size_t area = file.luminance.width * file.luminance.height, n = file.nm.size();
  more.nm.clear(), more.spectra.clear();
  for (std::size_t i = 0; i + 1 < n; ++i)
    for (std::size_t k = 0; k < parts; ++k)
      more.nm.push_back(std::lerp(file.nm[i], file.nm[i + 1], float(k) / float(parts)));
  more.nm.push_back(file.nm.back());
  for (std::size_t slice = 0; slice < file.phi_i.size() * file.theta_i.size(); ++slice)
    for (std::size_t m = 0; m < more.nm.size(); ++m)
      for (std::size_t at = 0; at < area; ++at) {
        const std::size_t i = std::min(m / parts, n - 2);
        const float* const below = file.spectra.data() + (slice * n + i) * area + at;
        more.spectra.push_back(std::lerp(below[0], below[area], float(m - i * parts) / float(parts)));
      }
  return more;
}

TEST(Measured, SpectraOfManyWavelengthsAreMitsubasInHalfPrecision) {
  // 49 to 151 wavelengths are stored in half precision (11 bits) in an order of their own; 121 times as many exceed the bits of
  // one mask.
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const Spectrum nm = make_spectrum([](int i) {
    const float of_reference[] = {412.5f, 500.f, 587.3f, 731.f};
    return of_reference[i % 4];
  });
  const Wavelengths w = Wavelengths::at(grid, nm);
  for (const std::size_t parts : {12u, 37u, 121u}) {
    double worst = 0, sum = 0;
    int count = 0;
    for (const ReferenceLine& l : reference_lines()) {
      RglNotes notes;
      const RglFile file = read_rgl_file(measured_data(l.file + ".bsdf"), notes);
      if (file.nm.empty()) continue;
      const RglTable table(with_more_wavelengths(file, parts), grid);
      const BsdfEval both = table.eval_pdf(l.wi, l.wo, w);
      const Spectrum value = table.value(l.wi, l.wo, w);
      for (int i = 0; i < kWavelengths; ++i) {
        const double error = double(value[i]) / l.value[i % 4] - 1;
        worst = std::max(worst, std::abs(error)), sum += error, ++count;
        EXPECT_EQ(both.value[i], value[i]);
      }
    }
    ASSERT_GT(count, 0);
    EXPECT_LT(worst, 4e-4 + 2e-4) << parts;           // rounding of one number, and Mitsuba's own
    EXPECT_LT(std::abs(sum / count), 5e-5) << parts;  // rounding has no bias
  }
}

TEST(Measured, TablesOfManyWavelengthsHoldOutsideTheVisible) {
  RglNotes notes;
  const RglFile file = read_rgl_file(measured_data("isotropic_spectral.bsdf"), notes);
  const SpectralGrid grid = SpectralGrid::over(900, 1000);
  const RglTable table(with_more_wavelengths(file, 200), grid), few(file, grid);
  const Wavelengths w = Wavelengths::at(grid, make_spectrum([](int i) { return 901 + 12 * float(i); }));
  const Spectrum a = table.value({0.3f, 0.1f, 0.9f}, {0, 0.3f, 0.9f}, w),
                 b = few.value({0.3f, 0.1f, 0.9f}, {0, 0.3f, 0.9f}, w);
  for (int i = 0; i < kWavelengths; ++i) EXPECT_NEAR(a[i] / b[i], 1, 6e-4);
}

TEST(Measured, SmallAndLargeNumbersKeepTheirPrecision) {
  // Spectra over eight decades, in units from 1e-12 to 1e12: a node's value at its own wavelength.
  RglNotes notes;
  const RglFile file = read_rgl_file(measured_data("isotropic_spectral.bsdf"), notes);
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  RglFile flat = with_more_wavelengths(file, 20);
  for (const float unit : {1e-12f, 1.f, 1e12f}) {
    const std::size_t area = flat.luminance.width * flat.luminance.height, channels = flat.nm.size();
    for (std::size_t i = 0; i < flat.spectra.size(); ++i)
      flat.spectra[i] = unit * std::pow(10.f, -8 * float(i / area % channels) / float(channels - 1));
    flat.is_relative = false;
    const RglTable table(flat, grid);
    for (std::size_t c = 0; c + 1 < channels && flat.nm[c] <= 830; ++c) {
      if (flat.nm[c] < 360) continue;
      const Wavelengths w = Wavelengths::at(grid, Spectrum(flat.nm[c]));
      const double expected = double(unit) * std::pow(10.0, -8 * double(c) / double(channels - 1));
      EXPECT_NEAR(double(table.value({0.3f, 0.1f, 0.9f}, {0, 0.3f, 0.9f}, w)[0]) / expected, 1, 1e-3)
          << unit << " " << c;
    }
  }
}

TEST(Measured, NegativeValuesAreInterpolatedBeforeTheyCountAsZero) {
  // Real files have negative values. Nodes of 1 and -0.5 alternate along u: between them a value is positive up to two thirds of
  // the way, as in RGL's own program; nodes of 1 and 0 would give more.
  RglNotes notes;
  for (const char* name : {"isotropic_rgb.bsdf", "isotropic_spectral.bsdf"})
    for (const std::size_t parts : {1u, 20u}) {
      RglFile file = read_rgl_file(measured_data(name), notes);
      if (parts > 1 && file.nm.empty()) continue;
      if (parts > 1) file = with_more_wavelengths(file, parts);
      file.is_relative = false;
      RglFile shifted = file;
      const std::size_t width = file.luminance.width;
      for (std::size_t i = 0; i < file.spectra.size(); ++i) {
        file.spectra[i] = (i % width) % 2 == 0 ? 1.f : -0.5f;
        shifted.spectra[i] = file.spectra[i] + 0.5f;  // never negative
      }
      const SpectralGrid grid = SpectralGrid::over(360, 830);
      const RglTable table(file, grid), above(shifted, grid);
      const Wavelengths w = Wavelengths::at(grid, make_spectrum([](int i) { return 400 + 40 * float(i); }));
      int zeros = 0, others = 0;
      for (std::uint64_t k = 0; k < 200; ++k) {
        const auto u = [&](std::uint64_t n) { return unit_float(std::uint32_t(mix_bits(4 * k + n))); };
        const Vec3 wi = square_to_cosine_hemisphere({u(0), u(1)}),
                   wo = square_to_cosine_hemisphere({u(2), u(3)});
        const Spectrum a = table.value(wi, wo, w), b = above.value(wi, wo, w);
        for (int i = 0; i < kWavelengths; ++i) {
          // Three primaries add up to one but for 1e-3.
          EXPECT_NEAR(a[i], std::max(b[i] - 0.5f, 0.f), 2e-3) << name;
          ++(a[i] > 0 ? others : zeros);
        }
      }
      EXPECT_GT(zeros, 100);
      EXPECT_GT(others, 100);
    }
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
