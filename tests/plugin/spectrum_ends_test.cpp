// SPDX-License-Identifier: Apache-2.0
// Spectra that end within the film's range: properties of matter keep the value at the end, with a note;
// emission, responses and filters are zero there.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

#include "aureole/asset/asset.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/loading/load.h"
#include "aureole/medium/medium.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"
#include "aureole/volume/volume.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

using testing::build;

bool takes_spectra(const ParameterDoc& row) {
  return row.type == "spectrum" || row.type == "texture" || row.type == "volume";
}
/// Light, and what responds to it.
bool is_zero_outside(const std::string& parameter) {
  return std::set<std::string>{"radiance", "irradiance", "intensity", "spectrum", "emission", "srf"}.count(
             parameter) > 0;
}
/// Pictures and grids that no spectrum can replace.
bool is_picture(const PluginInfo& p, const std::string& parameter) {
  return (p.name == "bumpmap" && parameter == "texture") || parameter == "normalmap" ||
         (p.name == "spot" && parameter == "texture") || (p.name == "sggx" && parameter == "S") ||
         (p.name == "classified" && (parameter == "value" || parameter == "mask"));
}

/// Builds an example with the parameter replaced by a spectrum from 500 to 510 nm; returns the notes about it,
/// or nothing if this example cannot have it.
std::optional<std::vector<std::string>> notes_with(const PluginInfo& p, const std::string& example,
                                                   const std::string& parameter, double value) {
  Diagnostics diagnostics;
  const auto context = testing::make_context(360, 830, &diagnostics);
  try {
    const Properties written = testing::read_properties(example, context, example_file);
    Properties properties(p.name, "", {}, context, &p);
    for (const auto& e : written.entries())
      if (e.name != parameter) properties.add(e.name, e.value, e.where);
    SpectrumLiteral literal;
    literal.kind = SpectrumLiteral::Kind::points;
    literal.nm = {500, 510}, literal.values = {value, value};
    properties.add(parameter, literal, {"here", 7, 3});
    make_element(p, properties);
  } catch (const std::exception&) {
    return {};
  }
  if (diagnostics.has_errors()) return {};
  std::vector<std::string> found;
  for (const std::string& note : diagnostics.notes())
    if (note.find("known from 500 to 510 nm") != std::string::npos) found.push_back(note);
  return found;
}

TEST(SpectrumEnds, EveryParameterOfEveryPluginIsMatterOrLight) {
  int matter = 0, light = 0;
  for (const PluginInfo& p : Registry::instance().all()) {
    // The spectra of a texture are what its user makes of them.
    if (p.name.starts_with("test_") || p.family == "texture" || p.family == "volume") continue;
    for (const ParameterDoc& row : p.doc.parameters) {
      if (!takes_spectra(row) || is_picture(p, row.name) || row.name == "(any name)") continue;
      std::optional<std::vector<std::string>> notes;
      for (const std::string& example : p.doc.examples)
        for (const double value : {0.5, 1.5})
          if (!notes) notes = notes_with(p, example, row.name, value);
      const std::string what = p.family + " " + p.name + ", " + row.name;
      if (!notes) {
        ADD_FAILURE() << what << ": no example can have a spectrum";
      } else if (is_zero_outside(row.name)) {
        ++light;
        EXPECT_TRUE(notes->empty()) << what << ": " << notes->front();
      } else {
        ++matter;
        ASSERT_EQ(notes->size(), 1u) << what;
        EXPECT_NE(notes->front().find("here:7:3: parameter \"" + row.name + "\""), std::string::npos)
            << notes->front();
        EXPECT_NE(notes->front().find("360 to 500 nm and 510 to 830 nm"), std::string::npos)
            << notes->front();
      }
    }
  }
  EXPECT_GT(matter, 80);
  EXPECT_GT(light, 8);
}

Wavelengths at_nm(double nm) { return Wavelengths::at(SpectralGrid(), float(nm)); }

MediumCoefficients of_medium(const Medium& m, double nm) {
  MediumCoefficients c;
  m.eval({}, {0, 0, 1}, at_nm(nm), c);
  return c;
}

TEST(SpectrumEnds, ABlackSolutionIsBlackAtAllWavelengths) {
  // Lambert and Beer: an absorbance of 3 per cm is ln(1000) per cm.
  for (const std::string given : {R"(<spectrum name="absorbance_1cm" value="400:3, 700:3"/>)",
                                  R"(<spectrum name="molar_absorptivity" value="400:1000, 700:1000"/>
                                     <float name="concentration" value="0.003"/>)"}) {
    const auto ink = build<Medium>(R"(<medium type="solution"><string name="solvent" value="vacuum"/>
      <ingredient type="dye">)" + given +
                                   "</ingredient></medium>");
    for (const double nm : {360.0, 399.0, 550.0, 701.0, 830.0})
      EXPECT_NEAR(of_medium(*ink, nm).sigma_t[0], 100 * std::log(1000.0), 0.01) << nm;
  }
}

TEST(SpectrumEnds, AMetalOfAFileKeepsItsLastIndexWithANote) {
  const TemporaryFolder folder;
  folder.write("eta.spd", "400 1.2\n590 0.4\n");
  folder.write("k.spd", "360 2\n590 3\n");
  const LoadedScene scene = load_scene(folder.write("scene.xml", R"(<scene version="3.0.0">
<sensor type="perspective"/>
<shape type="sphere"><bsdf type="conductor">
  <spectrum name="eta" filename="eta.spd"/>
  <spectrum name="k" filename="k.spd"/></bsdf></shape><emitter type="constant"/></scene>)"));
  const auto noted = [&](const std::string& text) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& note) { return note.find(text) != std::string::npos; });
  };
  const std::string all = fmt::format("{}", fmt::join(scene.notes, "\n"));
  EXPECT_TRUE(noted("scene.xml:4:3: parameter \"eta\": ") && noted("known from 400 to 590 nm")) << all;
  EXPECT_TRUE(noted("scene.xml:5:3: parameter \"k\": ") && noted("known from 360 to 590 nm")) << all;
  const SurfacePoint point;
  for (const double nm : {600.0, 700.0, 830.0}) {
    const Wavelengths w = at_nm(nm);
    const auto sample = scene.scene->parts().surfaces.at(0).bsdf->sample({0, 0, 1}, 0.5f, {0.5f, 0.5f},
                                                                         BsdfContext{w, point});
    ASSERT_TRUE(sample);
    const std::complex<double> index(0.4, 3);
    EXPECT_NEAR(sample->value[0], std::norm((index - 1.0) / (index + 1.0)), 1e-4) << nm;
  }
}

TEST(SpectrumEnds, AMetalReflectsAsAtTheEndOfItsData) {
  const auto metal = build<Bsdf>(R"(<bsdf type="conductor"><spectrum name="eta" value="400:1.2, 590:0.4"/>
    <spectrum name="k" value="400:2, 590:3"/></bsdf>)");
  const SurfacePoint point;
  for (const auto& [nm, index] : {std::pair{380.0, std::complex<double>(1.2, 2)},
                                  {650.0, std::complex<double>(0.4, 3)},
                                  {830.0, std::complex<double>(0.4, 3)}}) {
    const Wavelengths w = at_nm(nm);
    const BsdfContext context{w, point};
    const auto sample = metal->sample({0, 0, 1}, 0.5f, {0.5f, 0.5f}, context);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->value[0], std::norm((index - 1.0) / (index + 1.0)), 1e-4) << nm;
  }
}

TEST(SpectrumEnds, OtherUnitsThanNmAreErrorsThatNameThem) {
  const auto said = [](const std::string& xml) {
    Diagnostics diagnostics;
    std::string text;
    try {
      build<Texture>("<texture type=\"checkerboard\">" + xml + "</texture>",
                     testing::make_context(360, 830, &diagnostics));
    } catch (const Error& e) {
      text = e.what();
    }
    return text;
  };
  EXPECT_NE(
      said(R"(<spectrum name="color0" value="0.4:0.1, 0.5:0.5, 0.7:0.5"/>)")
          .find(
              "the wavelengths 0.4 to 0.7 are taken for nm, but the film has 360 to 830 nm; if they are in um"),
      std::string::npos);
  EXPECT_NE(said(R"(<spectrum name="color0" value="4000:0.1, 7000:0.5"/>)").find("in angstrom"),
            std::string::npos);
  EXPECT_NE(said(R"(<spectrum name="color0" type="irregular"><string name="wavelengths" value="0.4, 0.7"/>
    <string name="values" value="1, 1"/></spectrum>)")
                .find("in um"),
            std::string::npos);
  EXPECT_EQ(said(R"(<spectrum name="color0" value="1000:0.1, 1100:0.5"/>)"), "");

  // Light without a point in the film's range is black, and noted.
  Diagnostics diagnostics;
  build<Emitter>(R"(<emitter type="constant"><spectrum name="radiance" value="900:1, 1000:1"/></emitter>)",
                 testing::make_context(360, 830, &diagnostics));
  ASSERT_EQ(diagnostics.notes().size(), 1u);
  EXPECT_NE(diagnostics.notes()[0].find("none of the spectrum's points lies within"), std::string::npos);
}

TEST(SpectrumEnds, CoefficientsOfPaintsAndMedia) {
  const auto paint = build<Medium>(R"(<medium type="kubelka_munk"><spectrum name="k" value="450:8, 600:2"/>
    <spectrum name="s" value="450:3, 600:6"/></medium>)");
  EXPECT_NEAR(of_medium(*paint, 800).sigma_t[0] - of_medium(*paint, 800).sigma_s[0], 1, 1e-5);  // K/2
  EXPECT_NEAR(of_medium(*paint, 380).sigma_s[0], 4, 1e-5);                                      // 4/3 S
  for (const std::string given : {R"(<spectrum name="sigma_a" value="450:8, 600:2"/>)",
                                  R"(<volume type="constvolume" name="sigma_a">
                                       <spectrum name="value" value="450:8, 600:2"/></volume>)"}) {
    Diagnostics diagnostics;
    const auto fog = build<Medium>("<medium type=\"homogeneous\">" + given +
                                       R"(<spectrum name="emission" value="450:8, 600:2"/></medium>)",
                                   testing::make_context(360, 830, &diagnostics));
    EXPECT_NEAR(of_medium(*fog, 380).sigma_t[0], 8, 1e-5);
    EXPECT_NEAR(of_medium(*fog, 700).sigma_t[0], 2, 1e-5);
    EXPECT_EQ(of_medium(*fog, 380).emission[0], 0);
    EXPECT_EQ(of_medium(*fog, 700).emission[0], 0);
    ASSERT_EQ(diagnostics.notes().size(), 1u);
    EXPECT_NE(diagnostics.notes()[0].find("known from 450 to 600 nm"), std::string::npos);
  }
}

class Reader final : public Object {
public:
  Reader(const Properties& p, SpectrumRole role) : Object(p), texture(get_texture(p, "t", 0.5, role)) {}
  TexturePtr texture;
};

TEST(SpectrumEnds, TheUseOfATextureDecides) {
  const std::string
      points = R"(<string name="wavelengths" value="450, 600"/><string name="values" value="0.2, 0.4"/>)",
      regular = R"(<float name="wavelength_min" value="450"/><float name="wavelength_max" value="600"/>
                                 <string name="values" value="0.2, 0.4"/>)";
  for (const std::string& xml :
       {std::string(R"(<spectrum name="t" value="450:0.2, 600:0.4"/>)"),
        "<spectrum type=\"irregular\" name=\"t\">" + points + "</spectrum>",
        "<spectrum type=\"regular\" name=\"t\">" + regular + "</spectrum>",
        "<texture type=\"checkerboard\" name=\"t\"><spectrum type=\"irregular\" name=\"color0\">" + points +
            R"(</spectrum><spectrum name="color1" value="450:0.2, 600:0.4"/></texture>)",
        std::string(R"(<texture type="volume" name="t"><volume type="constvolume" name="volume">
          <spectrum name="value" value="450:0.2, 600:0.4"/></volume></texture>)")})
    for (const auto role : {SpectrumRole::reflectance, SpectrumRole::unbounded, SpectrumRole::emission,
                            SpectrumRole::response}) {
      Diagnostics diagnostics;
      const Reader reader(testing::read_properties("<probe type=\"probe\">" + xml + "</probe>",
                                                   testing::make_context(360, 830, &diagnostics)),
                          role);
      const bool is_matter = role == SpectrumRole::reflectance || role == SpectrumRole::unbounded;
      const auto at = [&](double nm) { return reader.texture->eval({}, at_nm(nm))[0]; };
      EXPECT_NEAR(at(400), is_matter ? 0.2 : 0, 1e-6) << xml;
      EXPECT_NEAR(at(525), 0.3, 1e-6) << xml;
      EXPECT_NEAR(at(700), is_matter ? 0.4 : 0, 1e-6) << xml;
      EXPECT_EQ(diagnostics.notes().empty(), !is_matter) << xml;
    }
  // Data over the whole range need no note.
  Diagnostics diagnostics;
  const Reader covered(
      testing::read_properties(R"(<probe type="probe"><spectrum name="t" value="360:0.2, 830:0.4"/></probe>)",
                               testing::make_context(360, 830, &diagnostics)),
      SpectrumRole::reflectance);
  EXPECT_TRUE(diagnostics.notes().empty());
}

TEST(SpectrumEnds, ALightSeenThroughAFilterIsZeroOutside) {
  const auto light = build<Texture>(R"(<spectrum type="d65"><texture type="checkerboard">
    <spectrum name="color0" value="450:1, 600:1"/><spectrum name="color1" value="450:1, 600:1"/></texture></spectrum>)");
  EXPECT_EQ(light->eval({}, at_nm(400))[0], 0);
  EXPECT_GT(light->eval({}, at_nm(500))[0], 0.5);
}

TEST(SpectrumEnds, TablesOfMaterialsAreNoted) {
  const auto notes_of = [](const std::string& xml, double min_nm, double max_nm) {
    Diagnostics diagnostics;
    testing::build_object(xml, testing::make_context(min_nm, max_nm, &diagnostics), example_file);
    std::string all;
    for (const std::string& note : diagnostics.notes()) all += note + "\n";
    return all;
  };
  const auto expect = [](const std::string& notes, const std::string& part) {
    EXPECT_NE(notes.find(part), std::string::npos) << notes << "lacks: " << part;
  };
  const std::string paint = R"(<bsdf type="paint"><string name="recipe" value="red: 1"/></bsdf>)";
  expect(notes_of(paint, 360, 830), "K and S of the palette");
  EXPECT_EQ(notes_of(paint, 450, 650), "");
  expect(notes_of(R"(<medium type="kubelka_munk"><string name="recipe" value="red: 1"/>
                     <float name="scale" value="100"/></medium>)",
                  360, 830),
         "K and S of the palette");
  expect(notes_of(R"(<medium type="solution"/>)", 360, 830),
         "known from 380 to 800 nm; at the other wavelengths of the film, 360 to 380 nm and 800 to 830 nm");
  EXPECT_EQ(notes_of(R"(<medium type="solution"/>)", 400, 700), "");
  expect(
      notes_of(R"(<medium type="suspension"><string name="recipe" value="milk"/></medium>)", 360, 370),
      "the index of milk fat is known from 375 to 775 nm; at the other wavelengths of the film, 360 to 370 nm");
  expect(notes_of(R"(<medium type="suspension"><string name="recipe" value="smoke"/></medium>)", 360, 370),
         "the index of soot is known from 400 to 860 nm");
}

}  // namespace
}  // namespace aureole::test
