// SPDX-License-Identifier: Apache-2.0
// The BSDFs `klems` and `tensor_tree` against Radiance's library (tests/bsdf/data/measured/make_windows.py), and damaged
// files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>

#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/bsdf/measured/scattering_tree.h"
#include "aureole/bsdf/measured/window_file.h"
#include "aureole/spectrum/observer.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/paths.h"

namespace aureole::testing {
namespace {

std::filesystem::path window_data(const std::string& name) {
  const auto here = test::source_dir() / "tests/bsdf/data/measured" / name;
  const char* shared = std::getenv("AUREOLE_SHARED");
  if (std::filesystem::exists(here) || !shared) return here;
  return std::filesystem::path(shared) / "data/bsdf_xml" / name;
}

std::string window_xml(const std::string& file, const std::string& more = "") {
  const std::string type = file.find("tree") != std::string::npos || file.find("T3") != std::string::npos
                               ? "tensor_tree"
                               : "klems";
  return "<bsdf type=\"" + type + "\"><string name=\"filename\" value=\"" + window_data(file).string() +
         "\"/>" + more + "</bsdf>";
}

TEST(Windows, ValuesAreRadiances) {
  std::ifstream in(window_data("window_reference.txt"));
  std::map<std::string, std::shared_ptr<Bsdf>> bsdfs;
  std::map<std::string, int> lines;
  std::string file;
  double ti, pi, to, po, expected;
  const Setting s;
  while (in >> file >> ti >> pi >> to >> po >> expected) {
    if (!std::filesystem::exists(window_data(file))) continue;  // real files, which are not in the repository
    auto& bsdf = bsdfs[file];
    if (!bsdf) bsdf = build<Bsdf>(window_xml(file));
    const Vec3 i = direction(ti * kDegree, pi * kDegree), o = direction(to * kDegree, po * kDegree);
    EXPECT_NEAR(brdf(*bsdf, i, o, s), expected, 1e-3 * expected + 1e-6)
        << file << " " << ti << " " << pi << " " << to << " " << po;
    ++lines[file];
  }
  for (const char* name : {"shade_klems.xml", "shade_tree3.xml", "shade_tree4.xml"})
    EXPECT_EQ(lines[name], 200) << name;
  if (std::getenv("AUREOLE_SHARED")) {
    for (const char* name : {"metalGrate.xml", "blindsT3.xml"}) EXPECT_EQ(lines[name], 200) << name;
  }
}

TEST(Windows, SidesAndDirectionsDiffer) {
  const auto bsdf = build<Bsdf>(window_xml("shade_klems.xml"));
  const Setting s;
  const Vec3 up = direction(0.7, 0.3), down{up.x, up.y, -up.z};
  EXPECT_GT(std::abs(brdf(*bsdf, up, up, s) - brdf(*bsdf, down, down, s)), 1e-3);
  EXPECT_GT(std::abs(brdf(*bsdf, up, down, s) - brdf(*bsdf, down, up, s)), 1e-3);
}

// The colours of CIE XYZ, seen by the observer under D65.
TEST(Windows, ColoursAreKept) {
  const auto file = read_window_file(window_data("shade_colour.xml"));
  WindowNotes notes;
  const KlemsSheet sheet = read_klems_sheet(*file, notes);
  EXPECT_TRUE(sheet.reflection[1].is_coloured);
  EXPECT_TRUE(sheet.reflection[0].empty());
  EXPECT_TRUE(notes.reversed_front);
  const auto bsdf = build<Bsdf>(window_xml("shade_colour.xml"));
  const Setting s;
  // Transmission from the front is that from the back with the directions exchanged.
  const Vec3 a = direction(0.5, 1.2), b = direction(kPiDouble - 0.9, 4);
  EXPECT_NEAR(brdf(*bsdf, a, b, s), brdf(*bsdf, b, a, s), 1e-5);
  EXPECT_GT(brdf(*bsdf, a, b, s), 0.01);
}

// Colours against Radiance's library: the responses X, Y and Z to D65, each relative to that of a perfect diffuser, in which a
// neutral sheet has equal ones.
TEST(Windows, ColoursAreRadiances) {
  const auto bsdf = build<Bsdf>(window_xml("shade_colour.xml"));
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const auto observer = observer_xyz(grid);
  const SampledSpectrum d65 = d65_spectrum(grid, 1);
  std::ifstream in(window_data("window_colour_reference.txt"));
  double ti, pi, to, po, expected[3];
  int lines = 0;
  while (in >> ti >> pi >> to >> po >> expected[0] >> expected[1] >> expected[2]) {
    const Vec3 i = direction(ti * kDegree, pi * kDegree), o = direction(to * kDegree, po * kDegree);
    double response[3] = {}, white[3] = {};
    for (int k = 0; k < 8 * 59; k += 8) {
      const Wavelengths w =
          Wavelengths::at(grid, make_spectrum([&](int j) { return 360.5f + float(k + j) * 0.995f; }));
      const Spectrum f = bsdf->eval(i, o, {w, SurfacePoint{}}) * (1 / std::abs(o.z)), light = d65.eval(w);
      for (std::size_t c = 0; c < 3; ++c) {
        const Spectrum weight = observer[c].eval(w) * light;
        for (int j = 0; j < kWavelengths; ++j)
          response[c] += double(weight[j] * f[j]), white[c] += double(weight[j]);
      }
    }
    // Radiance keeps Y, and rounds chromaticities, which changes X and Z by up to 3.6 %. sRGB's primaries hold all colours of the file.
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(response[c] / white[c], expected[c], (c == 1 ? 2e-3 : 0.04) * expected[c])
          << ti << " " << to << " " << c;
    ++lines;
  }
  EXPECT_EQ(lines, 60);
}

// A colour without one of its parts, and colours of trees, are not passed over in silence.
TEST(Windows, UnusedPartsAreNoted) {
  const auto notes_of = [](const std::string& file, const std::string& from, const std::string& to) {
    std::ifstream in(window_data(file));
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::size_t at = text.rfind(from);
    if (at != std::string::npos) text.replace(at, from.size(), to);
    const std::string path = ::testing::TempDir() + "noted.xml";
    std::ofstream(path) << text;
    Diagnostics diagnostics;
    build<Bsdf>(std::string("<bsdf type=\"") +
                    (file.find("tree") != std::string::npos ? "tensor_tree" : "klems") +
                    "\"><string name=\"filename\" value=\"" + path + "\"/></bsdf>",
                make_context(360, 830, &diagnostics));
    std::string all;
    for (const std::string& note : diagnostics.notes()) all += note + "\n";
    return all;
  };
  EXPECT_EQ(notes_of("shade_colour.xml", "no such text", "").find("some have not all"), std::string::npos);
  EXPECT_NE(notes_of("shade_colour.xml", ">CIE-Z<", ">Solar<").find("some have not all"), std::string::npos);
  EXPECT_NE(notes_of("shade_colour.xml", ">CIE-Z<", ">Solar<").find("the range \"Solar\""),
            std::string::npos);
  EXPECT_NE(notes_of("shade_tree3.xml", ">Visible<", ">CIE-X<").find("of tensor trees are not used"),
            std::string::npos);
  EXPECT_NE(notes_of("shade_klems.xml", "no such text", "").find("used at all wavelengths"),
            std::string::npos);
}

std::string window_error(const std::string& file, const std::function<void(std::string&)>& damage) {
  std::ifstream in(window_data(file));
  std::string text{std::istreambuf_iterator<char>(in), {}};
  damage(text);
  const std::string path =
      ::testing::TempDir() + (file.find("tree") != std::string::npos ? "damaged_tree.xml" : "damaged.xml");
  std::ofstream(path) << text;
  try {
    WindowNotes notes;
    const auto read = read_window_file(path);
    read->is_tree() ? void(read_tensor_tree_sheet(*read, notes)) : void(read_klems_sheet(*read, notes));
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), path);
    return e.what();
  }
  return "no error";
}
std::function<void(std::string&)> replacing(const std::string& from, const std::string& to) {
  return [=](std::string& text) {
    const std::size_t at = text.find(from);
    if (at != std::string::npos) text.replace(at, from.size(), to);
  };
}

TEST(Windows, DamagedFilesAreLocatedErrors) {
  const auto klems = [](const std::string& from, const std::string& to) {
    return window_error("shade_klems.xml", replacing(from, to));
  };
  EXPECT_NE(klems("<WindowElement ", "<Element ").find("not XML"), std::string::npos);
  EXPECT_NE(klems(">Columns<", ">Diagonals<").find("damaged.xml:12:"), std::string::npos);
  EXPECT_NE(klems(">Columns<", ">Diagonals<").find("TensorTree4 are known"), std::string::npos);
  EXPECT_NE(klems("<UpperTheta>55", "<UpperTheta>155").find("it must begin at 20"), std::string::npos);
  EXPECT_NE(klems("<nPhis>4", "<nPhis>1e9").find("azimuths are expected"), std::string::npos);
  EXPECT_NE(klems("<ColumnAngleBasis>Eleven", "<ColumnAngleBasis>Twelve").find("unknown angle basis"),
            std::string::npos);
  EXPECT_NE(klems("<ScatteringData>\n0", "<ScatteringData>\nnan").find("is not a number"), std::string::npos);
  EXPECT_NE(klems("<ScatteringData>\n0", "<ScatteringData>\n1e999").find("is not a number"),
            std::string::npos);
  EXPECT_NE(klems("<ScatteringData>\n0", "<ScatteringData>\n0.1 0.2 0").find("more than the 11 x 11"),
            std::string::npos);
  EXPECT_NE(window_error("shade_klems.xml",
                         [](std::string& t) {
                           const std::size_t begin = t.find("<ScatteringData>") + 16;
                           t.erase(begin, t.find("</ScatteringData>") - begin - 20);
                         })
                .find("truncated"),
            std::string::npos);
  const auto tree = [](const std::string& from, const std::string& to) {
    return window_error("shade_tree4.xml", replacing(from, to));
  };
  const auto with_tree = [](const std::string& tree_text) {
    return window_error("shade_tree4.xml", [&](std::string& text) {
      const std::size_t begin = text.find("<ScatteringData>") + 16;
      text.replace(begin, text.find("</ScatteringData>") - begin, tree_text);
    });
  };
  EXPECT_EQ(with_tree("{ 0.1 }"), "no error");
  EXPECT_NE(with_tree("{ 0.1 0.2 0.3 }").find("3 values in braces"), std::string::npos);
  EXPECT_NE(with_tree("{ 0.1 } 0.2").find("text after the end"), std::string::npos);
  EXPECT_NE(with_tree("{ { 0.1 } 0.2 }").find("in place of"), std::string::npos);
  EXPECT_NE(with_tree("{ 0.1 x }").find("\"x }\" is not a number"), std::string::npos);
  EXPECT_NE(with_tree("{ 0.1").find("truncated"), std::string::npos);
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += '{';
  EXPECT_NE(tree("{\n", deep).find("more than 16 levels"), std::string::npos);
  EXPECT_NE(tree("LBNL/Shirley-Chiu", "LBNL/Klems Full").find("a tensor tree has"), std::string::npos);
}

// One deep branch beside large cells: every incident direction of the deep branch needs the cells of all outgoing ones.
TEST(Windows, ASmallTreeCannotFillTheMemory) {
  const std::string message = window_error("shade_tree4.xml", [](std::string& text) {
    const std::size_t begin = text.find("<ScatteringData>") + 16, end = text.find("</ScatteringData>");
    std::string tree = "{0.1}";
    for (int i = 0; i < 15; ++i) {
      std::string next = "{";
      for (int k = 0; k < 16; ++k) next += k % 5 == 0 && i > 11 ? tree : k == 0 ? tree : "{0.1}";
      tree = next + "}";
    }
    text.replace(begin, end - begin, tree);
  });
  EXPECT_TRUE(message == "no error" || message.find("cells of outgoing directions") != std::string::npos)
      << message;
}

void window_case(BsdfCase& c) {
  c.mode = TransportMode::radiance;
  c.not_reciprocal = "the numbers of the file are random";
  c.reciprocal = false;
  c.bin_tolerance = 1e-5;
  c.tolerance = 1e-2;
}
const BsdfCases kKlems("klems", window_case, {});
const BsdfCases kTensorTree("tensor_tree", window_case, {});

}  // namespace
}  // namespace aureole::testing
