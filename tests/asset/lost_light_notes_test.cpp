// SPDX-License-Identifier: Apache-2.0
// Notes about rough interfaces around matter that scatters, whose microfacets lose light, and the scene's
// default of `energy_preserving`.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <regex>

#include "aureole/bsdf/bsdf.h"
#include "aureole/loading/document.h"
#include "aureole/loading/load.h"
#include "aureole/math/warp.h"
#include "loading/pixels.h"
#include "medium/scene_text.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

using aureole::test::error_thrown_by;
using aureole::test::pixels_of;

std::string rough(double alpha, const std::string& more = "", const std::string& kind = "ggx") {
  return "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"" + kind + "\"/>" +
         parameter("alpha", alpha) + parameter("int_ior", 1.4) + parameter("ext_ior", 1) + more + "</bsdf>";
}
std::string keeps(bool value) {
  return std::string("<boolean name=\"energy_preserving\" value=\"") + (value ? "true" : "false") + "\"/>";
}
const std::string kFilm = camera("origin=\"0, -4, 0\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 40, 6, 4);

LoadedScene load(const std::string& content) {
  return load_scene_from_string("<scene version=\"3.0.0\">\n" + kFilm + kSky + "\n" + content + "</scene>",
                                "lost.xml");
}
/// The notes about lost light.
std::vector<std::string> notes_of(const std::string& content) {
  std::vector<std::string> found;
  for (const std::string& note : load(content).notes)
    if (note.find("scatter light once") != std::string::npos) found.push_back(note);
  return found;
}

/// The fraction of diffuse light that a BSDF loses, from samples of its own: no table, no quadrature.
double lost(const Bsdf& bsdf, bool from_within) {
  std::mt19937 random(7);
  const auto u = [&] { return std::uniform_real_distribution<float>(0, 0.99999994f)(random); };
  const Wavelengths w = Wavelengths::at({}, 550);
  const SurfacePoint anywhere;
  constexpr int kSamples = 400000;
  double kept = 0;
  for (int i = 0; i < kSamples; ++i) {
    const float a = u(), b = u(), c = u(), d = u(), e = u();
    Vec3 wi = square_to_cosine_hemisphere({a, b});
    if (from_within) wi.z = -wi.z;
    // In importance mode energy is followed, which does not change with the index.
    const auto s = bsdf.sample(wi, c, {d, e}, {w, anywhere, TransportMode::importance});
    if (s) kept += double(s->value[0] / s->pdf[0]);
  }
  return 1 - kept / kSamples;
}
double stated(const std::string& note) {
  std::smatch found;
  return std::regex_search(note, found, std::regex("up to ([0-9.]+) %")) ? std::stod(found[1]) / 100 : -1;
}

TEST(LostLight, IsStatedWhereItIsTrapped) {
  for (const auto& [bsdf, medium_text, entering] :
       {std::tuple{rough(0.4), medium(0.05, 0.95), false},
        {rough(0.6, "", "beckmann"), medium(0, 2), false},
        {std::string("<bsdf type=\"principled\">") + parameter("spec_trans", 1) +
             parameter("roughness", 0.7) + parameter("eta", 1.4) + parameter("base_color", 1) + "</bsdf>",
         medium(0, 2), false},
        {std::string(), "<bssrdf type=\"dipole\">" + rough(0.4) + parameter("sigma_s", 1) + "</bssrdf>",
         true}}) {
    const std::string content = ball(bsdf, medium_text);
    const auto notes = notes_of(content);
    ASSERT_EQ(notes.size(), 1u) << content;
    EXPECT_TRUE(notes[0].starts_with("lost.xml:3:")) << notes[0];
    const LoadedScene scene = load(content);
    const Primitive& part = scene.scene->parts().surfaces.at(0);
    const double expected = lost(*part.bsdf, !entering);
    EXPECT_NEAR(stated(notes[0]), expected, 0.0015) << notes[0];
    EXPECT_GT(expected, 0.01);
  }
}

TEST(LostLight, IsNotStatedWhereThereIsNone) {
  const std::string milk = medium(0.05, 0.95);
  EXPECT_EQ(notes_of(ball(rough(0.4, keeps(true)), milk)).size(), 0u) << "kept";
  EXPECT_EQ(notes_of(ball(rough(0.4, keeps(false)), milk)).size(), 0u) << "chosen";
  EXPECT_EQ(notes_of(keeps(true) + ball(rough(0.4), milk)).size(), 0u) << "kept by the scene";
  EXPECT_EQ(notes_of(keeps(false) + ball(rough(0.4), milk)).size(), 0u) << "chosen by the scene";
  EXPECT_EQ(notes_of(ball(rough(0.4), medium(1, 0))).size(), 0u) << "nothing scatters";
  EXPECT_EQ(notes_of(ball(rough(0.4), "")).size(), 0u) << "no medium";
  EXPECT_EQ(notes_of(ball(rough(0.02), milk)).size(), 0u) << "nearly smooth";
  EXPECT_EQ(notes_of(ball("<bsdf type=\"dielectric\"/>", milk)).size(), 0u);
  EXPECT_EQ(notes_of(ball("<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.8\"/></bsdf>", milk))
                .size(),
            0u)
      << "no light comes in";
}

TEST(LostLight, IsFoundInNestedBsdfs) {
  const std::string milk = medium(0.05, 0.95);
  const double alone = stated(notes_of(ball(rough(0.4), milk)).at(0));
  for (const std::string& nested :
       {"<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.9\"/>" + rough(0.4) + "</bsdf>",
        "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.5\"/><bsdf type=\"null\"/>" + rough(0.4) +
            "</bsdf>",
        "<bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/>" + rough(0.4) + "</bsdf>",
        "<bsdf type=\"freespacediffraction\">" + rough(0.4) + "</bsdf>"}) {
    const auto notes = notes_of(ball(nested, milk));
    ASSERT_EQ(notes.size(), 1u) << nested;
    EXPECT_EQ(stated(notes[0]), alone) << nested;
  }
  // A body in a scattering medium loses the light that comes from outside.
  const auto around = notes_of(ball(rough(0.4), "<medium type=\"homogeneous\" name=\"exterior\"/>"));
  ASSERT_EQ(around.size(), 1u);
  EXPECT_LT(stated(around[0]), alone);
}

TEST(LostLight, TheSceneHasADefault) {
  const std::string milk = medium(0.05, 0.95);
  const auto pixels = [&](const std::string& content) { return pixels_of(load(content)); };
  const std::string metal =
      "<shape type=\"cube\"><transform name=\"to_world\"><translate x=\"1.5\"/></transform><bsdf "
      "type=\"roughconductor\"><float name=\"alpha\" value=\"0.7\"/>";
  const std::string bodies = ball(rough(0.5), milk) + metal + "</bsdf></shape>";
  const auto kept = pixels(keeps(true) + bodies);
  EXPECT_EQ(kept, pixels(ball(rough(0.5, keeps(true)), milk) + metal + keeps(true) + "</bsdf></shape>"));
  EXPECT_NE(kept, pixels(bodies));
  EXPECT_EQ(pixels(keeps(false) + bodies), pixels(bodies));
  EXPECT_NE(load(keeps(true) + bodies).hash, load(bodies).hash);
  const auto error = [](const std::string& content) { return error_thrown_by([&] { load(content); }); };
  EXPECT_NE(error(keeps(true) + keeps(true)).find("given twice"), std::string::npos);
  const std::string no_boolean = error("<float name=\"energy_preserving\" value=\"1\"/>");
  EXPECT_NE(no_boolean.find("is true or false"), std::string::npos) << no_boolean;
  EXPECT_TRUE(no_boolean.starts_with("lost.xml:3:")) << no_boolean;
  // An edit of the default makes the BSDFs anew.
  SceneDocument d("<scene version=\"3.0.0\">" + keeps(false) + kFilm + kSky + bodies + "</scene>",
                  "edited.xml");
  const auto before = pixels_of(d.loaded());
  d.edit({{"energy_preserving", "<boolean value='true'/>"}});
  EXPECT_EQ(pixels_of(d.loaded()), kept);
  EXPECT_NE(before, kept);
}

}  // namespace
}  // namespace aureole::testing
