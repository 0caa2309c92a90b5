// SPDX-License-Identifier: Apache-2.0
// The plug-ins: the shapes that their parameters make, and the parameters that they refuse.
#include "aureole/aperture/aperture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>

#include "aureole/core/image.h"
#include "aureole/optics/aperture/round_aperture.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "loading/load_text.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole {
namespace {

using optics::ApertureShape;
using optics::PlanePoint;
using optics::Ring;

std::string text(const std::string& name, const std::string& value) {
  return "<string name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string number(const std::string& name, const std::string& value) {
  return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string aperture(const std::string& type, const std::string& content) {
  return "<aperture type=\"" + type + "\">" + content + "</aperture>";
}

std::shared_ptr<Aperture> build(const std::string& type, const std::string& content) {
  return testing::build<Aperture>(aperture(type, content));
}

/// The error, which must have a place.
std::string error(const std::string& type, const std::string& content) {
  try {
    build(type, content);
  } catch (const Error& e) {
    // The test's reader collects those of unused parameters into one text.
    EXPECT_TRUE(!e.where().file.empty() || e.message().starts_with("snippet:")) << e.what();
    return e.message();
  }
  return "no error";
}

class TemporaryFile {
public:
  TemporaryFile(const std::string& name, const std::string& content) : path_(unique(name)) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  TemporaryFile(const std::string& name, const Image& image) : path_(unique(name)) {
    write_exr(path_, image, ExrPixel::float32, {});
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  std::string parameter() const { return text("filename", path_.string()); }

private:
  static std::filesystem::path unique(const std::string& name) {
    return std::filesystem::path(::testing::TempDir()) /
           (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
            std::to_string(getpid()) + "_" + name);
  }
  std::filesystem::path path_;
};

/// Largest difference of two transforms over the area, about lengths of `size`.
double difference(const ApertureShape& a, const std::function<std::complex<double>(double, double)>& f,
                  double size) {
  double worst = 0;
  for (double u : {0.0, 0.4, 1.5, 4.0, 9.0, 20.0})
    for (double phi : {0.0, 0.4, 1.1, 2.0, 4.0}) {
      const double x = u / size * std::cos(phi), y = u / size * std::sin(phi);
      worst = std::max(worst, std::abs(a.transform(x, y) - f(x, y)) / a.area());
    }
  return worst;
}

double difference(const ApertureShape& a, const std::vector<Ring>& rings, double size) {
  return difference(
      a, [&](double x, double y) { return optics::testing::scanline_transform(rings, x, y); }, size);
}

double difference(const ApertureShape& a, const ApertureShape& b, double size) {
  return difference(
      a, [&](double x, double y) { return b.transform(x, y); }, size);
}

TEST(Apertures, ShapesInMetres) {
  const auto circle = build("circle", text("radius", "5um"))->shape();
  EXPECT_TRUE(circle->is_circular());
  EXPECT_LT(difference(*circle, optics::EllipseAperture(5e-6, 5e-6), 5e-6), 1e-15);
  const auto ellipse = build("ellipse", text("radius_x", "5um") + text("radius_y", "2um"))->shape();
  EXPECT_LT(difference(*ellipse, optics::EllipseAperture(5e-6, 2e-6), 5e-6), 1e-15);
  const auto annulus = build("annulus", text("radius", "5um") + text("inner_radius", "4um"))->shape();
  EXPECT_LT(difference(*annulus, optics::AnnulusAperture(5e-6, 4e-6), 5e-6), 1e-14);
  EXPECT_TRUE(annulus->is_circular());
  const auto ngon = build("ngon", "<integer name=\"sides\" value=\"5\"/>" + text("radius", "3um"))->shape();
  EXPECT_LT(difference(*ngon, {optics::testing::regular_ring(5, 3e-6, M_PI / 2)}, 3e-6), 1e-10);
  const auto hexagon = build("ngon", text("radius", "3um"))->shape();
  EXPECT_LT(difference(*hexagon, {optics::testing::regular_ring(6, 3e-6, M_PI / 2)}, 3e-6), 1e-10);
  const auto rectangle = build("rectangle", text("width", "8um") + text("height", "4um"))->shape();
  const auto product = [](double x, double y) {
    return optics::testing::interval_transform(-4e-6, 4e-6, x) *
           optics::testing::interval_transform(-2e-6, 2e-6, y);
  };
  EXPECT_LT(difference(*rectangle, product, 5e-6), 1e-12);
  // A star of five points whose inner corners lie where its edges, drawn on, form a pentagram.
  const double golden = (3 - std::sqrt(5)) / 2;
  const auto star =
      build("star", text("radius", "3um") + number("inner_ratio", std::to_string(golden)))->shape();
  const Ring outer = optics::testing::regular_ring(5, 3e-6, M_PI / 2),
             inner = optics::testing::regular_ring(5, 3e-6 * golden, M_PI / 2 + M_PI / 5);
  Ring ring;
  for (int i = 0; i < 5; ++i) ring.push_back(outer[i]), ring.push_back(inner[i]);
  EXPECT_LT(difference(*star, {ring}, 3e-6), 1e-5);
  const auto many = build("star", text("radius", "3um") + "<integer name=\"points\" value=\"9\"/>")->shape();
  EXPECT_NEAR(many->area(), 9 * 0.5 * 9e-12 * std::sin(M_PI / 9), 1e-20);
}

TEST(Apertures, SharedParameters) {
  const auto a = build("circle", text("radius", "5um") + number("fraction", "0.25") +
                                     number("rotation", "90") + number("size_spread", "0.1") +
                                     "<boolean name=\"random_rotation\" value=\"true\"/>");
  EXPECT_EQ(a->fraction(), 0.25);
  EXPECT_NEAR(a->rotation(), M_PI / 2, 1e-15);
  EXPECT_TRUE(a->is_randomly_rotated());
  EXPECT_GT(a->sizes().nodes().size(), 10u);
  const auto plain = build("circle", text("radius", "5um"));
  EXPECT_EQ(plain->fraction(), 1);
  EXPECT_TRUE(plain->sizes().is_single());
  const auto measured = build(
      "circle", text("radius", "5um") + text("size_histogram", test::example_file("sizes.csv").string()));
  EXPECT_EQ(measured->sizes().nodes().size(), 5u);
}

TEST(Apertures, SceneFilesSayWhereHistogramsAre) {
  const std::string scene =
      "<bsdf type=\"diffuse\">" + aperture("circle", text("size_histogram", "nowhere.csv")) + "</bsdf>";
  const std::vector<std::string> errors = test::errors_of(scene);
  EXPECT_TRUE(std::any_of(errors.begin(), errors.end(), [](const std::string& e) {
    return e.find("no such file: \"nowhere.csv\" (looked in ") != std::string::npos;
  }));
}

TEST(Apertures, InlinePolygons) {
  const std::vector<Ring> rings = {{{0, 0}, {4e-6, 0}, {4e-6, 3e-6}, {0, 3e-6}},
                                   {{1e-6, 1e-6}, {2e-6, 1e-6}, {1e-6, 2e-6}}};
  const std::string vertices = text("vertices", "0,0 4,0 4,3 0,3;\n 1,1 1,2 2,1; ") + text("unit", "1um");
  const std::string in_place = "<boolean name=\"centroid\" value=\"false\"/>";
  EXPECT_LT(difference(*build("polygon", vertices + in_place)->shape(), rings, 3e-6), 1e-10);
  // Shifted: the same modulus, and the centroid is where the first moments vanish.
  const auto centred = build("polygon", vertices)->shape();
  EXPECT_NEAR(centred->area(), 11.5e-12, 1e-24);
  for (double phi : {0.0, 1.0, 2.0}) {
    const auto f = centred->transform(10 * std::cos(phi), 10 * std::sin(phi));
    EXPECT_NEAR(f.imag() / f.real(), 0, 1e-13);
  }
  EXPECT_GT(std::abs(build("polygon", vertices + in_place)->shape()->transform(10, 0).imag()),
            1e-5 * 11.5e-12);
}

const char* const kSvgHead = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 16 10\">";

std::shared_ptr<const ApertureShape> from_svg(const std::string& content, const std::string& more = "") {
  const TemporaryFile file("shape.svg", kSvgHead + content + "</svg>");
  return build("polygon", file.parameter() + text("width", "8um") + more)->shape();
}

TEST(SvgApertures, WaysToWriteOneShape) {
  // A house, y downwards, 8 wide.
  const std::vector<Ring> rings = {{{-4, -3}, {4, -3}, {4, 2}, {0, 5}, {-4, 2}}};
  const auto region = optics::PolygonRegion::even_odd(rings);
  std::vector<Ring> expected = region.placed(region.centroid(), 1e-6).rings();
  for (
      const char* svg : {
          R"X(<polygon points="0 8 8 8 8 3 4 0 0 3"/>)X",
          R"X(<polyline points="0,8 8,8, 8,3 4,0 0,3 0,8"/>)X",
          R"X(<path d="M0 8H8V3L4 0 0 3Z"/>)X",
          R"X(<path d="m0,8 8,0 0-5-4-3-4,3z"/>)X",
          R"X(<path d="M 0 8 h 8 v -5 l -4 -3 l -4 3"/>)X",
          R"X(<path d="M0 16h16v-10l-8-6-8 6z" transform="scale(0.5)"/>)X",
          R"X(<g transform="translate(3,4)"><g><path d="M-8 0V-8h5l3 4-3 4z" transform="rotate(-90)"/></g></g>)X",
          R"X(<path d="M0 8H8V3L4 0 0 3Z" transform="matrix(2 0 0 2 1 1) rotate(0 5 6) skewX(0)"/>)X",
          R"X(<rect y="3" width="8px" height="5"/><polygon points="0,3 8,3 4,0"/>)X",
          R"X(<defs><circle r="50"/></defs><rect width="99" height="99" display="none"/>
              <path d="M.0.8e1h8v-5L4 0 0 3"/><circle r="0"/><path d="M90 90"/>)X",
          R"X(<path d="M0 8C3 8 5 8 8 8L8 7S8 5 8 3Q6 1.5 4 0L3 .75T0 3z"/>)X",
          R"X(<rect y="3mm" width="8mm" height="0.5cm"/><polygon points="0,3 8,3 4,0" transform="scale(3.779527559055118)"/>)X",
          R"X(<rect y="30%" width="50%" height="50%"/><polygon points="0,3 8,3 4,0"/>)X",
          R"X(<defs><path id="house" d="M0 8H8V3L4 0 0 3Z"/></defs><use href="#house"/>)X",
          R"X(<symbol id="house"><path d="M0 4H4V1.5L2 0 0 1.5Z" transform="scale(2)"/></symbol>
              <g transform="translate(9 9)"><use xlink:href="#house" x="3" y="-2"/></g>)X",
          R"X(<defs><g id="a"><use href="#b" transform="scale(3)"/></g><path id="b" d="M0 8H8V3L4 0 0 3Z"/></defs><use href="#a"/>)X",
      }) {
    SCOPED_TRACE(svg);
    EXPECT_LT(difference(*from_svg(svg), expected, 4e-6), 1e-10);
  }
}

TEST(SvgApertures, CurvesAreFlattenedToTheTolerance) {
  const optics::EllipseAperture circle(4e-6, 4e-6), ellipse(4e-6, 2e-6);
  // A polygon in a circle, off by at most 1e-4 of the diameter; on average 2/3 of that.
  const double off = 4e-4;
  EXPECT_LT(difference(*from_svg(R"X(<circle cx="3" cy="-7" r="5"/>)X"), circle, 4e-6), off);
  EXPECT_GT(difference(*from_svg(R"X(<circle cx="3" cy="-7" r="5"/>)X"), circle, 4e-6), 1e-6);
  EXPECT_LT(difference(*from_svg(R"X(<ellipse cx="3" rx="6" ry="3"/>)X"), ellipse, 4e-6), off);
  for (const char* arcs :
       {R"X(<path d="M0 0A5 5 0 0 1 10 0 5 5 0 0 1 0 0"/>)X",
        R"X(<path d="M0 0a5,5,0,01,10,0a5,5,0,01-10,0z"/>)X",
        R"X(<path d="M0 0A5 5 0 0 0 5 5 5 5 45 1 0 0 0z"/>)X",
        R"X(<path d="M0 0a1 1 0 1 1 10 0 2 2 0 0 1-10 0z"/>)X",  // radii too small
        R"X(<rect width="6" height="6" rx="3"/>)X", R"X(<rect width="6" height="6" ry="9"/>)X"})
    EXPECT_LT(difference(*from_svg(arcs), circle, 4e-6), off) << arcs;
  EXPECT_LT(difference(*from_svg(R"X(<path d="M-6 0A6 3 0 1 0 6 0 3 6 90 0 0-6 0"/>)X"), ellipse, 4e-6), off);
  // Rounded corners, checked by the area.
  EXPECT_NEAR(from_svg(R"X(<rect width="8" height="4" rx="1"/>)X")->area(), (32 - 4 + M_PI) * 1e-12, 1e-14);
  // Segments of parabolas and a cubic, whose areas are known: 2/3 of the triangle's, 3/5 for the cubic.
  EXPECT_NEAR(from_svg(R"X(<path d="M0 0Q4 6 8 0z"/>)X")->area(), 2.0 / 3 * 24e-12, 1e-14);
  EXPECT_NEAR(from_svg(R"X(<path d="M0 0Q2 6 4 0T8 0L8-9 0-9z"/>)X")->area(), 72e-12, 3e-14);
  EXPECT_NEAR(from_svg(R"X(<path d="M0 0C0 4 8 4 8 0z"/>)X")->area(), 0.6 * 32e-12, 1e-14);
  EXPECT_NEAR(from_svg(R"X(<path d="M0 0C0 2 4 2 4 0S8-2 8 0V9H0z"/>)X")->area(), 72e-12, 3e-14);
}

TEST(SvgApertures, YPointsUpAndTheOriginIsTheFiles) {
  const std::string in_place = "<boolean name=\"centroid\" value=\"false\"/>";
  const auto shape = from_svg(R"X(<polygon points="1,2 9,2 1,6"/>)X", in_place);
  EXPECT_LT(difference(*shape, {{{1e-6, -2e-6}, {9e-6, -2e-6}, {1e-6, -6e-6}}}, 4e-6), 1e-10);
}

TEST(SvgApertures, EvenOddOverAllShapes) {
  const auto shape = from_svg(R"X(<rect width="8" height="8"/><g><circle cx="4" cy="4" r="2"/></g>)X");
  EXPECT_NEAR(shape->area(), (64 - 4 * M_PI) * 1e-12, 2e-14);
}

TEST(SvgApertures, Errors) {
  const auto message = [](const std::string& svg) {
    const TemporaryFile file("shape.svg", svg);
    return error("polygon", file.parameter() + text("width", "8um"));
  };
  const auto shape_message = [&](const std::string& content) {
    return message(kSvgHead + content + "</svg>");
  };
  const auto expect = [](const std::string& got, const std::string& part) {
    EXPECT_NE(got.find(part), std::string::npos) << got;
    EXPECT_NE(got.find("\"filename\""), std::string::npos) << got;
  };
  expect(message("<svg><g></svg>"), "is not XML: ");
  expect(message(""), "is not XML: ");
  expect(message("<html/>"), "is not an SVG file");
  expect(shape_message(""), "has no path, polygon, rect, circle or ellipse with an inside");
  expect(shape_message("<path d=\"M0 0L1 1\"/>"), "has no path, polygon, rect");
  expect(shape_message("<path id=\"leaf\" d=\"M0 0L1 x\"/>"), "<path> \"leaf\" at byte ");
  expect(shape_message("<path d=\"M0 0L1 x\"/>"), "expected a number at character 8 of \"M0 0L1 x\"");
  expect(shape_message("<path d=\"L1 1\"/>"), "path data must begin with M");
  expect(shape_message("<path d=\"M0 0K1 1\"/>"), "expected one of M L H V C S Q T A Z at character 5");
  expect(shape_message("<path d=\"M0 0A1 1 0 2 0 3 3\"/>"), "expected 0 or 1 at character");
  expect(shape_message("<path d=\"M0 0 1e10 0\"/>"), "a number is out of range");
  expect(shape_message("<path d=\"M0 0Lnan inf\"/>"), "expected a number");
  expect(shape_message("<polygon points=\"0,0 1,1 2\"/>"), "expected a number");
  expect(shape_message("<polygon points=\"0,0 1,1 2,z\"/>"), "expected a number");
  expect(shape_message("<rect width=\"-1\" height=\"2\"/>"), "width must not be negative");
  expect(shape_message("<circle r=\"2em\"/>"), "expected px, mm, cm, in, pt, pc, Q, % or no unit");
  expect(message("<svg><circle r=\"5%\"/></svg>"), "a percentage needs the viewBox");
  expect(shape_message("<use href=\"#a\"/>"), "no element has the id \"a\"");
  expect(shape_message("<use href=\"other.svg#a\"/>"), "names no element of this file");
  expect(shape_message("<g id=\"a\"><use href=\"#a\"/></g>"), "nested more than 64 deep");
  std::string bomb = "<defs><g id=\"a0\"/>";
  for (int i = 1; i < 40; ++i) {
    const std::string use = "<use href=\"#a" + std::to_string(i - 1) + "\"/>";
    bomb += "<g id=\"a" + std::to_string(i) + "\">" + use + use + "</g>";
  }
  expect(shape_message(bomb + "</defs><use href=\"#a18\"/>"), "more than 100000 elements are drawn");
  expect(shape_message("<text>a</text>"), "is not supported: convert it to a path");
  expect(shape_message("<g transform=\"turn(3)\"/>"), "\"turn\" with 1 numbers is not a transform");
  expect(shape_message("<g transform=\"scale 3\"/>"), "expected a transform such as scale(2)");
  expect(shape_message("<g transform=\"rotate(3\"/>"), "expected )");
  expect(shape_message("<g transform=\"scale(1e9)scale(1e9)\"/>"), "the transform is out of range");
  expect(shape_message("<path d=\"M0 0 2 2 2 0 0 2\"/>"),
         "the polygon ring 1 touches or crosses itself: edge 1");
  std::string deep, many = "<path d=\"M0 0", curves;
  for (int i = 0; i < 100; ++i) deep += "<g>";
  for (int i = 0; i < 100; ++i) deep += "</g>";
  for (int i = 0; i < 10002; ++i) many += " " + std::to_string(i) + " 1";
  for (int i = 0; i < 2000; ++i) curves += "<circle r=\"" + std::to_string(i + 1) + "\"/>";
  expect(shape_message(deep), "groups and uses are nested more than 64 deep");
  expect(shape_message(many + "\"/>"), "more than 10000 lines and curves");
  expect(shape_message(curves), "more than 10000");
}

TEST(Apertures, Errors) {
  EXPECT_EQ(error("circle", ""), "\"circle\": needs the parameter \"radius\", a length such as \"5um\"");
  for (const char* type : {"circle", "ngon", "star", "annulus"}) {
    const auto radius = [&](const char* value) {
      return error(type, text("radius", value) + text("inner_radius", "1um"));
    };
    EXPECT_NE(radius("0um").find("must be > 0"), std::string::npos) << radius("0um");
    EXPECT_NE(radius("-3um").find("must be > 0"), std::string::npos);
    EXPECT_NE(radius("3").find("has no unit"), std::string::npos);
    EXPECT_NE(radius("nan").find("is not a number"), std::string::npos);
    EXPECT_NE(radius("2km").find("must be between 1nm and 1m"), std::string::npos);
    EXPECT_NE(radius("1e-300m").find("must be between 1nm and 1m"), std::string::npos);
    EXPECT_NE(error(type, number("radius", "3")).find("needs a unit"), std::string::npos);
  }
  for (const char* missing : {"radius_x", "radius_y"}) {
    const std::string other = missing == std::string("radius_x") ? "radius_y" : "radius_x";
    EXPECT_NE(error("ellipse", text(other, "1um")).find("needs the parameter \"" + std::string(missing)),
              std::string::npos);
  }
  for (const char* inner : {"5um", "6um", "4.9999999um"})
    EXPECT_NE(error("annulus", text("radius", "5um") + text("inner_radius", inner))
                  .find("must be smaller than \"radius\""),
              std::string::npos);
  for (const char* sides : {"2", "1001", "-5"}) {
    EXPECT_NE(error("ngon", text("radius", "5um") + number("sides", sides)).find("must be in [3, 1000]"),
              std::string::npos);
    EXPECT_NE(error("star", text("radius", "5um") + number("points", sides)).find("must be in [3, 1000]"),
              std::string::npos);
  }
  EXPECT_NE(error("star", text("radius", "5um") + number("inner_ratio", "0")).find("must be in [0.001, 1]"),
            std::string::npos);
  EXPECT_NE(error("rectangle", text("width", "5um")).find("needs the parameter \"height\""),
            std::string::npos);
  EXPECT_NE(error("rectangle", text("width", "2nm") + text("height", "1m")).find("factor of a million"),
            std::string::npos);
}

TEST(Apertures, PolygonErrors) {
  const auto message = [](const std::string& vertices) {
    return error("polygon", text("vertices", vertices) + text("unit", "1um"));
  };
  const auto expect = [](const std::string& got, const std::string& part) {
    EXPECT_NE(got.find(part), std::string::npos) << got;
  };
  expect(message("0,0 2,2 2,0 0,2"),
         "parameter \"vertices\" of \"polygon\": the polygon ring 1 touches or crosses itself: edge 1 from "
         "(0, 0) to (2, 2) meets edge 3 from (2, 0) to (0, 2)");
  expect(message(""), "the polygon has no vertices");
  expect(message("0,0 1,1"), "ring 1 has fewer than 3 different vertices");
  expect(message("0,0 1,0 2"), "\"2\" is not a vertex: write x,y");
  expect(message("0,0 1,0 2,x"), "\"x\" is not a number");
  expect(message("0,0 1,0 2,inf"), "is not a number");
  expect(message("0,0 1,0 2,1e200"), "is not a number below 1e100");
  expect(message("0,0 1,0 1,1 0,1; 0,0 1,0 1,1 0,1"), "has no area");
  expect(message("0,0 1e7,0 1e7,1e7"), "it must be between 1nm and 1m");
  expect(error("polygon", text("vertices", "0,0 1,0 1,1")), "needs the parameter \"unit\"");
  expect(error("polygon", ""), "give either \"vertices\" or \"filename\"");
  const TemporaryFile file("shape.svg", std::string(kSvgHead) + "<circle r=\"2\"/></svg>");
  expect(error("polygon", file.parameter() + text("vertices", "0,0 1,0 1,1")), "give either");
  expect(error("polygon", file.parameter()), "needs the parameter \"width\"");
  expect(error("polygon", file.parameter() + text("width", "1um") + text("unit", "1um")),
         "\"unit\" has no effect here");
  expect(error("polygon", text("filename", "nowhere.svg") + text("width", "1um")), "no such file");
}

Image picture(int width, int height, const std::vector<std::string>& channels, float value) {
  Image image;
  image.width = width, image.height = height, image.channels = channels;
  image.pixels.assign(std::size_t(width) * height * channels.size(), value);
  return image;
}

TEST(Apertures, Masks) {
  // The left 3 of 4 columns of the upper of two rows.
  Image image = picture(4, 2, {"Y"}, 0);
  for (int x = 0; x < 3; ++x) image.at(x, 0, 0) = 1;
  const TemporaryFile file("mask.exr", image);
  const std::string common = file.parameter() + text("width", "8um"),
                    in_place = "<boolean name=\"centroid\" value=\"false\"/>",
                    invert = "<boolean name=\"invert\" value=\"true\"/>";
  const auto shape = build("mask", common + in_place)->shape();
  EXPECT_LT(difference(*shape, {{{-4e-6, 0}, {2e-6, 0}, {2e-6, 2e-6}, {-4e-6, 2e-6}}}, 4e-6), 1e-4);
  EXPECT_NEAR(shape->area(), 12e-12, 1e-20);
  EXPECT_NEAR(shape->bounding_radius(), std::hypot(4e-6, 2e-6), 1e-12);
  EXPECT_LT(difference(*build("mask", common)->shape(),
                       {{{-3e-6, -1e-6}, {3e-6, -1e-6}, {3e-6, 1e-6}, {-3e-6, 1e-6}}}, 4e-6),
            1e-4);
  EXPECT_LT(
      difference(*build("mask", common + invert + in_place)->shape(),
                 {{{-4e-6, -2e-6}, {4e-6, -2e-6}, {4e-6, 2e-6}, {2e-6, 2e-6}, {2e-6, 0}, {-4e-6, 0}}}, 4e-6),
      1e-4);
  const TemporaryFile grey("grey.exr", picture(2, 2, {"R", "G", "B", "A"}, 0.5f));
  const auto quarter = build("mask", grey.parameter() + text("width", "2um"))->shape();
  EXPECT_NEAR(quarter->area(), 1e-12, 1e-18);
  EXPECT_NEAR(quarter->squared_area(), 0.25e-12, 1e-18);
}

TEST(Apertures, MaskErrors) {
  const auto message = [](const Image& image) {
    const TemporaryFile file("mask.exr", image);
    return error("mask", file.parameter() + text("width", "8um"));
  };
  EXPECT_EQ(message(picture(4, 2, {"Y"}, 0)),
            "parameter \"filename\" of \"mask\": no pixel of the mask is open");
  EXPECT_NE(message(picture(4, 2, {"Y"}, 2)).find("the pixel at column 0, row 0 is 2.000000, not in [0, 1]"),
            std::string::npos);
  EXPECT_NE(message(picture(4, 2, {"Y"}, NAN)).find("not in [0, 1]"), std::string::npos);
  EXPECT_NE(message(picture(4, 2, {"U", "V"}, 1)).find("needs the channels R, G, B or Y"), std::string::npos);
  const TemporaryFile broken("mask.png", "no picture");
  EXPECT_NE(error("mask", broken.parameter() + text("width", "8um")).find("parameter \"filename\""),
            std::string::npos);
  const TemporaryFile good("mask.exr", picture(4, 2, {"Y"}, 1));
  EXPECT_NE(error("mask", good.parameter()).find("needs the parameter \"width\""), std::string::npos);
  EXPECT_NE(error("mask", text("width", "8um")).find("\"mask\""), std::string::npos);
}

}  // namespace
}  // namespace aureole
