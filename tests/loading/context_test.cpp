// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <stdexcept>

#include "aureole/loading/load.h"
#include "loading/test_plugins.h"

namespace aureole {
namespace {

using test::error_of;
using test::errors_of_file;
using test::load_text;

TEST(Context, LengthUnitAndWavelengths) {
  EXPECT_EQ(load_text("").parts.context->length_unit_m, 1);
  EXPECT_EQ(load_text("").parts.context->grid, SpectralGrid());
  EXPECT_DOUBLE_EQ(load_text("<string name='length_unit' value='mm'/>").parts.context->length_unit_m, 1e-3);
  EXPECT_DOUBLE_EQ(load_text("<string name='length_unit' value='2.5mm'/>").parts.context->length_unit_m,
                   2.5e-3);
  EXPECT_NE(error_of("<string name='length_unit' value='ells'/>").find("unknown unit"), std::string::npos);
  EXPECT_NE(error_of("<float name='length_unit' value='1'/>").find("needs a unit"), std::string::npos);

  const auto film = [](const std::string& parameters) {
    return test::kHead +
           "<integrator type='test_integrator'/><sensor type='test_sensor'><film type='test_film'>" +
           parameters + "</film></sensor></scene>";
  };
  const auto grid = load_parts("test.xml",
                               film("<string name='wavelength_min' value='20GHz'/>"
                                    "<string name='wavelength_max' value='3cm'/>"),
                               {})
                        .parts.context->grid;
  EXPECT_NEAR(grid.min_nm, 299792458.0 / 20e9 * 1e9, 1e-3);
  EXPECT_NEAR(grid.max_nm, 3e7, 1e-3);
  EXPECT_NE(
      errors_of_file(film("<float name='wavelength_min' value='900'/>")).at(0).find("must be less than"),
      std::string::npos);
  EXPECT_EQ(errors_of_file(film("<string name='wavelength_min' value='3 ells'/>")).size(), 1u);
}

TEST(Overrides, SamplerAndIntegrator) {
  const std::string text =
      test::kHead +
      "<integrator type='test_integrator'><integer name='seed' value='1'/><integer name='foreign' "
      "value='1'/></integrator>"
      "<sensor type='test_sensor'><sampler type='test_sampler'><integer name='sample_count' value='8'/>"
      "<integer name='seed' value='7'/><boolean name='jitter' value='true'/></sampler></sensor></scene>";
  LoadOptions options;
  options.sampler = "test_sampler2", options.integrator = "test_integrator2";
  LoadedParts s = load_parts("test.xml", text, options);
  EXPECT_EQ(s.integrator->properties().type(), "test_integrator2");
  const auto sampler = [&] { return test::children_of_sensor(s).at(0); };
  EXPECT_EQ(sampler()->properties().type(), "test_sampler2");
  EXPECT_EQ(sampler()->properties().get_int("sample_count", 0), 8);
  EXPECT_EQ(sampler()->properties().get_int("seed", 0), 7);
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_NE(s.notes[0].find("\"foreign\" is ignored"), std::string::npos);

  options.sample_count = 99;
  s = load_parts("test.xml", text, options);
  EXPECT_EQ(sampler()->properties().get_int("sample_count", 0), 99);

  options.sampler = "test_samplre";
  EXPECT_EQ(errors_of_file(text, options).back().substr(0, 41), "--sampler test_samplre: unknown sampler; ");
}

TEST(Hash, FollowsContentOnly) {
  const auto hash = [](const std::string& content) { return load_text(content).hash; };
  const std::string a = "<bsdf type='test_bsdf'><vector name='direction' value='1,2,3'/></bsdf>";
  EXPECT_EQ(hash(a),
            hash("<!-- c -->\n<bsdf  type='test_bsdf'> <vector value='1, 2  3' name='direction'/></bsdf>"));
  EXPECT_NE(hash(a), hash("<bsdf type='test_bsdf'><vector name='direction' value='1,2,4'/></bsdf>"));
  const auto sampler = [&](const std::string& parameters) {
    return hash("<sampler type='test_sampler'>" + parameters + "</sampler>");
  };
  EXPECT_EQ(sampler(""), sampler("<integer name='sample_count' value='3'/><integer name='seed' value='3'/>"));

  const test::TemporaryFolder folder;
  const std::string file = folder.write("a.txt", "one").string();
  const std::string with_file =
      "<bsdf type='test_bsdf'><string name='filename' value='" + file + "'/></bsdf>";
  const auto before = hash(with_file);
  folder.write("a.txt", "two");
  EXPECT_NE(before, hash(with_file));
}

TEST(Emitters, TopLevelOnes) {
  const LoadedParts s = load_text(
      "<emitter type='test_emitter' id='e'/><ref id='e'/>"
      "<texture type='test_texture'><emitter type='test_emitter'/></texture>");
  EXPECT_EQ(s.parts.emitters.size(), 1u);
}

TEST(Context, OutlivesLoadingAndTakesNoNotesAfterwards) {
  const LoadedParts s = load_text("<bsdf type='test_bsdf' id='a'/>");
  // Nobody would see it: the notes of the file have been shown.
  EXPECT_THROW(s.parts.sensor->properties().note("x", "a note after loading"), std::logic_error);
  EXPECT_TRUE(s.file.is_absolute());
}

}  // namespace
}  // namespace aureole
