// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/values.h"

#include <gtest/gtest.h>

#include "loading/test_plugins.h"

namespace aureole {
namespace {

using test::bsdf;
using test::problem;

TEST(Values, ReadEveryType) {
  const auto b = bsdf(
      "<boolean name='flag' value='TRUE'/><integer name='count' value=' 3 '/><float name='amount' "
      "value='2e-1'/>"
      "<string name='text' value=' a, b '/><vector name='direction' value='1, 2 3'/>"
      "<string name='thickness' value='5um'/>");
  EXPECT_EQ(b->amount, 0.2);
  EXPECT_EQ(b->direction, (Vec3{1, 2, 3}));
  EXPECT_DOUBLE_EQ(b->length, 5e-6);
  EXPECT_EQ(bsdf("<point name='direction' value='4'/>")->direction, (Vec3{4, 4, 4}));
  EXPECT_EQ(bsdf("<point name='direction' x='1' y='2' z='3'/>")->direction, (Vec3{1, 2, 3}));
}

TEST(Values, Spectra) {
  EXPECT_EQ(bsdf("<spectrum name='reflectance' value='0.5'/>")->spectrum.value, 0.5);
  const auto points = bsdf("<spectrum name='reflectance' value='400:1, 0.5um:2 600nm:3'/>")->spectrum;
  EXPECT_EQ(points.kind, SpectrumLiteral::Kind::points);
  ASSERT_EQ(points.nm.size(), 3u);
  EXPECT_NEAR(points.nm[1], 500, 1e-9);
  EXPECT_EQ(bsdf("<rgb name='reflectance' value='.1 .2 .3'/>")->spectrum.rgb[2], .3);
  EXPECT_EQ(bsdf("<rgb name='reflectance' value='.1'/>")->spectrum.rgb[2], .1);
  EXPECT_NEAR(bsdf("<rgb name='reflectance' value='#18455c'/>")->spectrum.rgb[0], .0091, 5e-5);

  const test::TemporaryFolder folder;
  const auto file = folder.write("a.spd", "# comment\n400 1\n\n500, 2 # more\n");
  EXPECT_EQ(bsdf("<spectrum name='reflectance' filename='" + file.string() + "'/>")->spectrum.values,
            (std::vector<double>{1, 2}));
  const auto bad = folder.write("b.spd", "200 0\n400 1\n300 2\n");
  EXPECT_EQ(problem("<spectrum name='reflectance' filename='" + bad.string() + "'/>"),
            "parameter \"reflectance\": " + bad.string() +
                ":3: wavelengths must increase or decrease all the way, but 300 nm follows 400 nm");

  // Frequencies, whose order is the other one.
  const SpectrumLiteral carrier =
      bsdf("<spectrum name='reflectance' value='26GHz:1, 28GHz:2, 1cm:3'/>")->spectrum;
  EXPECT_EQ(carrier.values, (std::vector<double>{3, 2, 1}));
  EXPECT_NEAR(carrier.nm[1], 299792458e9 / 28e9, 1e-3);
  EXPECT_NEAR(carrier.nm[0], 1e7, 1e-6);
}

TEST(Values, TransformStepsMultiplyFromTheLeft) {
  const auto of = [](const std::string& steps) {
    return bsdf("<transform name='to_world'>" + steps + "</transform>")->to_world;
  };
  EXPECT_EQ(of("<translate x='1'/><scale value='2'/>"),
            Transform::scale(2, 2, 2) * Transform::translate(1, 0, 0));
  EXPECT_EQ(of("<scale y='3'/>"), Transform::scale(1, 3, 1));
  EXPECT_EQ(of("<rotate value='0,0,2' angle='90'/>"), Transform::rotate(0, 0, 1, 90));
  EXPECT_EQ(of("<matrix value='1 2 3 4 5 6 7 8 10'/>").matrix()[2][2], 10);
  EXPECT_EQ(of("<matrix value='1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1'/>"), Transform::translate(5, 0, 0));
  EXPECT_EQ(of("<lookat origin='0,0,0' target='0,0,1' up='0,1,0'/>"), Transform());
  EXPECT_FALSE(of("<lookat origin='-.99, 1, 0' target='5, 1, 0'/>").is_singular());
  EXPECT_FALSE(of("<lookat origin='0,0,0' target='0,0,-1'/>").is_singular());
}

TEST(Values, BadTextIsQuoted) {
  EXPECT_EQ(problem("<float name='amount' value='abc'/>"), "parameter \"amount\": \"abc\" is not a number");
  EXPECT_EQ(problem("<float name='amount' value='nan'/>"), "parameter \"amount\": \"nan\" is not a number");
  EXPECT_EQ(problem("<float name='amount' value='5um'/>"),
            "parameter \"amount\": \"5um\" is not a number; a value with a unit is written "
            "<string name=\"amount\" value=\"5um\"/>");
  EXPECT_EQ(problem("<integer name='count' value='2.5'/>"), "parameter \"count\": \"2.5\" is not an integer");
  EXPECT_EQ(problem("<boolean name='flag' value='yes'/>"),
            "parameter \"flag\": \"yes\" is not a boolean: write \"true\" or \"false\"");
  EXPECT_EQ(problem("<vector name='direction' value='1 2'/>"), "\"1 2\" must have 1 or 3 numbers");
  EXPECT_EQ(problem("<vector name='direction' x='1' y='2'/>"), "<vector> needs the attribute \"z\"");
  EXPECT_EQ(problem("<rgb name='reflectance' value='1 2'/>"),
            "parameter \"reflectance\": \"1 2\" must have 1 or 3 numbers");
  EXPECT_EQ(problem("<rgb name='reflectance' value='#12345g'/>"),
            "parameter \"reflectance\": \"#12345g\" is not a colour of the form #rrggbb");
  EXPECT_EQ(
      problem("<spectrum name='reflectance' value='500:1 400:2 450:3'/>"),
      "parameter \"reflectance\": wavelengths must increase or decrease all the way, but 450 nm follows 400 nm");
  EXPECT_EQ(problem("<spectrum name='reflectance' value='500:1 6'/>"),
            "parameter \"reflectance\": \"6\" is not a \"wavelength:value\" pair");
  EXPECT_EQ(problem("<spectrum name='reflectance'/>"),
            "<spectrum> needs either \"value\", \"filename\" or \"type\"");
  EXPECT_EQ(problem("<float name='amount' valeu='1' value='1'/>"),
            "unexpected attribute \"valeu\" of <float>; did you mean \"value\"?");
}

TEST(Values, SpectrumFilesOfSpreadsheets) {
  const test::TemporaryFolder folder;
  const auto of = [&](const std::string& content, const std::string& more = "") {
    const auto file = folder.write("a.csv", content);
    return bsdf("<spectrum name='reflectance' filename='" + file.string() + "'" + more + "/>")->spectrum;
  };
  const std::vector<double> nm{400, 700}, values{0.25, 0.5};
  for (const char* text :
       {"\xEF\xBB\xBF"
        "400 0.25\n700 0.5\n",
        "\"Wavelength\",\"Reflectance\"\n\"400\",\"0.25\"\n700,0.5", "lambda;R\r\n400;0.25\r\n700;0.5\r\n",
        "# of a file\nWavelength (nm)\tvalue\n400\t.25\n700\t.5\n", "wavelength [um] n\n0.4 0.25\n0.7 0.5\n",
        "Wavelength/Angstrom, R\n4000, 0.25\n7000, 0.5\n"}) {
    const SpectrumLiteral s = of(text);
    ASSERT_EQ(s.nm.size(), 2u) << text;
    EXPECT_NEAR(s.nm[0], 400, 1e-9) << text;
    EXPECT_NEAR(s.nm[1], 700, 1e-9) << text;
    EXPECT_EQ(s.values, values) << text;
  }
  EXPECT_NEAR(of("0.4 0.25\n0.7 0.5\n", " unit='um'").nm[1], 700, 1e-9);
  EXPECT_NEAR(of("0.4um 0.25\n700nm 0.5\n").nm[0], 400, 1e-9);
  EXPECT_NEAR(
      bsdf("<spectrum name='reflectance' unit='angstrom' value='4000:0.25, 7000:0.5'/>")->spectrum.nm[0], 400,
      1e-9);
  EXPECT_TRUE(of("0.4 0.25\n0.7 0.5\n", " unit='um'").unit_is_stated);
  EXPECT_TRUE(of("wavelength (nm)\n400 0.25\n700 0.5\n").unit_is_stated);
  EXPECT_FALSE(of("400 0.25\n700 0.5\n").unit_is_stated);
  const auto bad = folder.write("bad.csv", "wavenumber (cm^-1), R\n14000, 0.5\n20000, 0.5\n");
  EXPECT_NE(problem("<spectrum name='reflectance' filename='" + bad.string() + "'/>")
                .find("bad.csv:1: the header line names wavenumber"),
            std::string::npos);
  EXPECT_NE(problem("<spectrum name='reflectance' unit='inch' value='400:1, 700:1'/>")
                .find("unknown unit \"inch\""),
            std::string::npos);
}

TEST(Values, BadTransforms) {
  const auto step = [](const std::string& s) {
    return problem("<transform name='to_world'>" + s + "</transform>");
  };
  EXPECT_EQ(step("<scale x='0'/>"), "<scale> is singular: it can't be inverted");
  EXPECT_EQ(step("<matrix value='1 2 3 2 4 6 0 0 1'/>"), "<matrix> is singular: it can't be inverted");
  EXPECT_EQ(step("<matrix value='1 2'/>"), "<matrix> needs 9 or 16 numbers, got 2");
  EXPECT_EQ(step("<rotate angle='5'/>"), "<rotate>: the axis is zero");
  EXPECT_EQ(step("<rotate x='1'/>"), "<rotate> needs the attribute \"angle\"");
  EXPECT_EQ(step("<lookat origin='1,1,1' target='1,1,1' up='0,1,0'/>"),
            "<lookat>: origin and target are the same point");
  EXPECT_EQ(step("<lookat origin='0,0,0' target='0,5,0' up='0,1,0'/>"),
            "<lookat>: up is parallel to the direction from origin to target");
  EXPECT_EQ(step("<translate x='a'/>"), "<translate>: \"a\" is not a number");
  EXPECT_EQ(step("<rotat x='1' angle='3'/>"), "<transform> can't contain <rotat>; did you mean \"rotate\"?");
}

}  // namespace
}  // namespace aureole
