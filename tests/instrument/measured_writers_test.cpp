// SPDX-License-Identifier: Apache-2.0
// Materials written as measured files and read back.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/bsdf/measured/rgl_table.h"
#include "aureole/instrument/measured/rgl_writer.h"
#include "aureole/instrument/measured/scattering_probe.h"
#include "aureole/instrument/measured/table_writers.h"
#include "aureole/instrument/measured/tensor_tree_writer.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

const SpectralGrid kGrid = SpectralGrid::over(360, 830);

ScatteringProbe probe_of(const std::string& xml, std::vector<double> nm = {450, 550, 650},
                         bool reciprocal = false) {
  return {build<Bsdf>(xml), kGrid, std::move(nm), reciprocal};
}

std::string write_temporary(const std::string& name, const std::string& content) {
  const std::string path = ::testing::TempDir() + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

/// The light by which `copy` deviates from the material, as a fraction of all that is reflected at one wavelength: the
/// integral of |f_copy - f| cos over that of f cos, by the material's own samples.
double deviation(const Bsdf& material, const Bsdf& copy, double degrees) {
  const Setting s;
  const Vec3 wi = direction(degrees * kDegree, 0.8);
  double sum = 0, all = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec2 u{float(std::fmod(0.7548776662466927 * k, 1.0)),
                 float(std::fmod(0.5698402909980532 * k, 1.0))};
    const auto sample = material.sample(wi, float(std::fmod(0.381966 * k, 1.0)), u, s.context());
    if (!sample || !(sample->wo.z > 0)) continue;
    const double expected = double(sample->value[3]), pdf = double(sample->pdf[3]);
    sum += std::abs(double(copy.eval(wi, sample->wo, s.context())[3]) - expected) / pdf,
        all += expected / pdf;
  }
  return sum / all;
}

// Without a metal's Fresnel term the spectra are G alone: the estimate of D must be right.
TEST(MeasuredWriters, GgxIsReadBackWithinTwoPercent) {
  const std::string xml = R"(<bsdf type="roughconductor"><string name="material" value="none"/>
      <string name="distribution" value="ggx"/><float name="alpha" value="0.1"/></bsdf>)";
  RglWriterSettings settings;
  settings.angles = 24;
  const RglFile file = make_rgl_file(probe_of(xml), settings);
  // D of GGX at its maximum, 1 / (pi alpha^2), and at 10 degrees.
  EXPECT_NEAR(file.ndf.values[0], 31.83, 0.02 * 31.83);
  const auto copy = build<Bsdf>("<bsdf type=\"measured\"><string name=\"filename\" value=\"" +
                                write_temporary("ggx.bsdf", rgl_file_content(file)) + "\"/></bsdf>");
  const auto material = build<Bsdf>(xml);
  for (const double degrees : {0.0, 7.0, 20.0, 33.0, 45.0, 52.0, 60.0, 70.0, 75.0})
    EXPECT_LT(deviation(*material, *copy, degrees), 0.02) << degrees;
}

TEST(MeasuredWriters, AnisotropicMaterialsAreReadBack) {
  const std::string xml = R"(<bsdf type="roughconductor"><string name="material" value="Cu"/>
      <string name="distribution" value="ggx"/><float name="alpha_u" value="0.25"/><float name="alpha_v" value="0.5"/></bsdf>)";
  RglWriterSettings settings;
  settings.azimuths = 25, settings.angles = 12, settings.resolution = 16, settings.normals = 64;
  const ScatteringProbe probe = probe_of(xml);
  EXPECT_FALSE(examine(probe).is_isotropic);
  const auto copy = build<Bsdf>(
      "<bsdf type=\"measured\"><string name=\"filename\" value=\"" +
      write_temporary("aniso.bsdf", rgl_file_content(make_rgl_file(probe, settings))) + "\"/></bsdf>");
  const auto material = build<Bsdf>(xml);
  for (const double degrees : {5.0, 30.0, 50.0, 65.0})
    EXPECT_LT(deviation(*material, *copy, degrees), 0.03) << degrees;
}

TEST(MeasuredWriters, KlemsFilesHoldMirrorsAndEvenScattering) {
  KlemsWriterSettings settings;
  settings.basis = "LBNL/Klems Quarter";
  const auto sheet_of = [&](const std::string& xml) {
    const std::string path = write_temporary("written.xml", klems_file_content(probe_of(xml), settings));
    WindowNotes notes;
    return read_klems_sheet(*read_window_file(path), notes);
  };
  // A white sheet that transmits: f = reflectance / pi for all pairs of patches, to the side opposite to the light.
  const KlemsSheet cloth =
      sheet_of(R"(<bsdf type="difftrans"><float name="transmittance" value="0.6"/></bsdf>)");
  for (const std::size_t side : {std::size_t(0), std::size_t(1)})
    for (const float f : cloth.transmission[side].values)
      EXPECT_NEAR(f, 0.6 / kPiDouble, 0.04 * 0.6 / kPiDouble);
  // A pane: light stays in its patch, and the mirror image is turned by 180 degrees.
  const KlemsSheet pane = sheet_of(
      R"(<bsdf type="thindielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)");
  const KlemsMatrix& t = pane.transmission[0];
  for (std::size_t i = 0; i < t.incident.count(); ++i)
    for (std::size_t o = 0; o < t.outgoing.count(); ++o) {
      const double power = double(t.mean(i, o)) * t.outgoing.projected_solid_angle(o);
      if (i == o) {
        EXPECT_GT(power, 0.3) << i;
      } else {
        EXPECT_EQ(power, 0) << i << " " << o;
      }
    }
  // Normal incidence: 2 R / (1 + R) with R = 0.04 is reflected.
  EXPECT_NEAR(double(pane.reflection[0].mean(0, 0)) * t.outgoing.projected_solid_angle(0), 0.0769, 0.002);
}

/// Reads the written tree of a material as the BSDF `tensor_tree`.
std::shared_ptr<const Bsdf> tree_of(const std::string& xml, const TensorTreeSettings& settings,
                                    std::string* text = nullptr) {
  const std::string content = tensor_tree_file_content(probe_of(xml), settings);
  if (text) *text = content;
  return build<Bsdf>("<bsdf type=\"tensor_tree\"><string name=\"filename\" value=\"" +
                     write_temporary("tree.xml", content) + "\"/></bsdf>");
}

TEST(MeasuredWriters, TensorTreesHoldLobesAndAreSmallWhereNothingChanges) {
  const std::string glossy = R"(<bsdf type="roughconductor"><string name="material" value="none"/>
      <string name="distribution" value="ggx"/><float name="alpha" value="0.3"/></bsdf>)";
  TensorTreeSettings settings;
  std::string text;
  const auto copy = tree_of(glossy, settings, &text);
  const auto material = build<Bsdf>(glossy);
  for (const double degrees : {5.0, 30.0, 55.0})
    EXPECT_LT(deviation(*material, *copy, degrees), 0.1) << degrees;
  // With a larger tolerance more cells are merged.
  std::string coarse;
  settings.tolerance = 0.5;
  tree_of(glossy, settings, &coarse);
  EXPECT_LT(std::count(coarse.begin(), coarse.end(), '{'),
            0.7 * double(std::count(text.begin(), text.end(), '{')));
  // Even scattering is one cell for each side, and its energy is right.
  std::string even;
  const auto white =
      tree_of(R"(<bsdf type="diffuse"><float name="reflectance" value="0.6"/></bsdf>)", {}, &even);
  EXPECT_LT(std::count(even.begin(), even.end(), '{'), 60);
  const Setting s;
  EXPECT_NEAR(double(white->eval(direction(0.5, 1), direction(0.7, 3), s.context())[0]),
              0.6 / M_PI * std::cos(0.7), 0.01);
}

// An anisotropic metal: the tree of rank 4 turns with the material.
TEST(MeasuredWriters, TensorTreesOfRankFourKnowAzimuths) {
  const std::string brushed = R"(<bsdf type="roughconductor"><string name="material" value="none"/>
      <float name="alpha_u" value="0.25"/><float name="alpha_v" value="0.6"/></bsdf>)";
  TensorTreeSettings settings;
  settings.is_isotropic = false, settings.levels = 5, settings.samples = 1024;
  std::string text;
  const auto copy = tree_of(brushed, settings, &text);
  EXPECT_NE(text.find("TensorTree4"), std::string::npos);
  EXPECT_LT(deviation(*build<Bsdf>(brushed), *copy, 30), 0.1);
  // Light from the side of y is scattered wider along y than light from x along x.
  const Setting s;
  const auto f = [&](double azimuth) {
    return double(copy->eval(direction(0.1, azimuth), direction(0.6, azimuth), s.context())[0]);
  };
  EXPECT_GT(f(M_PI / 2), 2 * f(0));
}

TEST(MeasuredWriters, TensorTreesHoldTransmissionAndTheSidesOfASheet) {
  const std::string sheet = R"(<bsdf type="difftrans"><float name="transmittance" value="0.5"/></bsdf>)";
  const auto copy = tree_of(sheet, {});
  const Setting s;
  const auto material = build<Bsdf>(sheet);
  for (const double side : {1.0, -1.0}) {
    Vec3 wi = direction(0.4, 2), wo = direction(0.3, 0.5);
    wi.z *= float(side), wo.z *= float(-side);
    EXPECT_NEAR(double(copy->eval(wi, wo, s.context())[0]), double(material->eval(wi, wo, s.context())[0]),
                0.01);
  }
  TensorTreeSettings too_large;
  too_large.levels = 12;
  EXPECT_THROW(tensor_tree_file_content(probe_of(sheet), too_large), Error);
}

TEST(MeasuredWriters, TablesOfDirectionsAreReadBack) {
  const std::string xml =
      R"(<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.3"/></bsdf>)";
  DirectionTableSettings settings;
  for (int i = 0; i <= 17; ++i) settings.incident.push_back(5 * i);
  for (int i = 0; i <= 29; ++i) settings.outgoing.push_back(3 * i);
  for (int i = 0; i < 36; ++i) settings.azimuths.push_back(10 * i);
  const auto copy = build<Bsdf>(
      "<bsdf type=\"tabulated\"><string name=\"filename\" value=\"" +
      write_temporary("gold.csv", direction_table_content(probe_of(xml, {440, 530, 650}), settings)) +
      "\"/></bsdf>");
  const auto material = build<Bsdf>(xml);
  for (const double degrees : {3.0, 22.0, 41.0, 60.0})
    EXPECT_LT(deviation(*material, *copy, degrees), 0.06) << degrees;
}

TEST(MeasuredWriters, ZemaxFilesCountFromTheMirrorDirection) {
  const std::string xml =
      R"(<bsdf type="phong"><float name="exponent" value="200"/><float name="diffuse_reflectance" value="0"/>
      <float name="specular_reflectance" value="0.5"/></bsdf>)";
  const ZemaxSettings settings{{0, 40}, {0, 90, 180}, {0, 2, 4, 6, 8, 10, 14, 20}};
  const std::string text = zemax_file_content(probe_of(xml), settings);
  EXPECT_NE(text.find("AngleOfIncidence  2\n0\t40\n"), std::string::npos);
  std::istringstream in(text.substr(text.find("DataBegin")));
  std::string word;
  double tis = 0;
  for (int angle = 0; angle < 2; ++angle) {
    if (angle == 0) in >> word;
    in >> word >> tis;
    EXPECT_EQ(word, "TIS");
    // Phong's lobe is about the mirror direction and loses what lies beside it.
    EXPECT_GT(tis, 0.3);
    EXPECT_LT(tis, 0.55);
    double first = 0;
    for (int azimuth = 0; azimuth < 3; ++azimuth)
      for (std::size_t r = 0; r < 8; ++r) {
        double value = 0;
        in >> value;
        if (r == 0) first = azimuth == 0 ? value : first;
        // (n + 2) / (2 pi) cos^n of the angle from the mirror direction, times the cosine that f does not have.
        EXPECT_NEAR(value / first, std::pow(std::cos(settings.radial[r] * kDegree), 200), 0.02) << r;
      }
  }
  EXPECT_NE(text.find("DataEnd"), std::string::npos);
}

// A table whose values depend on the direction of light is reported, and made reciprocal only when asked.
TEST(MeasuredWriters, ReciprocityIsReportedAndRepairedOnDemand) {
  const std::string csv = "theta_i,theta_o,phi_o,f\n" + [] {
    std::string rows;
    for (const int theta_i : {0, 40, 80})
      for (int theta_o = 0; theta_o <= 80; theta_o += 20)
        for (int phi = 0; phi < 360; phi += 60)
          rows += std::to_string(theta_i) + "," + std::to_string(theta_o) + "," + std::to_string(phi) + "," +
                  std::to_string(0.1 + 0.001 * theta_o) + "\n";
    return rows;
  }();
  const std::string xml = "<bsdf type=\"tabulated\"><string name=\"filename\" value=\"" +
                          write_temporary("lopsided.csv", csv) + "\"/></bsdf>";
  const ScatteringReport report = examine(probe_of(xml));
  EXPECT_GT(report.mean_asymmetry, 0.03);
  EXPECT_TRUE(report.is_isotropic);
  const ScatteringReport repaired = examine(probe_of(xml, {550}, true));
  EXPECT_LT(repaired.mean_asymmetry, 1e-4);
}

// Trees of rank 4 and Klems matrices of a reciprocal surface, and of one that is made so, are reciprocal themselves.
TEST(MeasuredWriters, SheetsAreReciprocalOnDemand) {
  const std::string brushed = R"(<bsdf type="roughconductor"><string name="material" value="none"/>
      <float name="alpha_u" value="0.25"/><float name="alpha_v" value="0.6"/></bsdf>)";
  const Setting s;
  // The differences of f(i, o) and f(o, i) over their sums, on average: directions on the edge of two cells belong to either.
  const auto asymmetry = [&](const Bsdf& sheet) {
    double differences = 0, sums = 0;
    for (int k = 0; k < 200; ++k) {
      const Vec3 a = direction(0.1 + 0.005 * k, 0.3 + 0.7 * k), b = direction(1.2 - 0.005 * k, 1.9 * k + 0.2);
      const double there = double(sheet.eval(a, b, s.context())[0]) / double(b.z),
                   back = double(sheet.eval(b, a, s.context())[0]) / double(a.z);
      differences += std::abs(there - back), sums += there + back;
    }
    return differences / sums;
  };
  TensorTreeSettings settings;
  settings.is_isotropic = false, settings.levels = 3, settings.samples = 256;
  const double before = asymmetry(*tree_of(brushed, settings));
  settings.is_reciprocal = true;
  EXPECT_LT(asymmetry(*tree_of(brushed, settings)), 1e-3);
  EXPECT_GT(before, 3e-3);
  // A table whose values depend on the outgoing direction alone.
  std::string csv = "theta_i,theta_o,phi_o,f\n";
  for (const int theta_i : {0, 40, 80})
    for (int theta_o = 0; theta_o <= 80; theta_o += 20)
      for (int phi = 0; phi < 360; phi += 60)
        csv += std::to_string(theta_i) + "," + std::to_string(theta_o) + "," + std::to_string(phi) + "," +
               std::to_string(0.1 + 0.001 * theta_o) + "\n";
  const std::string table = "<bsdf type=\"tabulated\"><string name=\"filename\" value=\"" +
                            write_temporary("one_sided.csv", csv) + "\"/></bsdf>";
  const auto klems_of = [&](bool makes_reciprocal) {
    KlemsWriterSettings quarter;
    quarter.basis = "LBNL/Klems Quarter", quarter.samples = 64;
    const std::string text = klems_file_content(probe_of(table, {550}, makes_reciprocal), quarter);
    return build<Bsdf>("<bsdf type=\"klems\"><string name=\"filename\" value=\"" +
                       write_temporary("one_sided.xml", text) + "\"/></bsdf>");
  };
  EXPECT_GT(asymmetry(*klems_of(false)), 0.02);
  EXPECT_LT(asymmetry(*klems_of(true)), 1e-3);
}

}  // namespace
}  // namespace aureole::testing
