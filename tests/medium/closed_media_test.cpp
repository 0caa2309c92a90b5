// SPDX-License-Identifier: Apache-2.0
// Media that no connection can reach or leave: which these are. Pictures of them, with lights inside, outside and
// around, are compared in the other tests of this folder.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "aureole/loading/load.h"
#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

const std::string kGlass = "<bsdf type=\"dielectric\"/>", kRough = "<bsdf type=\"roughdielectric\"/>";
const std::string kMilk = "<medium type=\"homogeneous\" name=\"interior\" id=\"milk\"/>";

class Loaded {
public:
  explicit Loaded(const std::string& content)
      : scene_(load_scene_from_string(
                   "<scene version=\"3.0.0\">" +
                       camera("origin=\"0, -4, 0\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 30, 2, 4) + content +
                       "</scene>",
                   "closed.xml")
                   .scene) {}
  const Scene& scene() const { return *scene_; }
  /// The medium within the first shape that has one.
  const Medium& medium() const {
    for (const Primitive& part : scene_->parts().surfaces)
      if (part.media.inside) return *part.media.inside;
    throw std::logic_error("no medium");
  }
  /// The normal of the first surface before the camera.
  Vec3 front() const { return scene_->intersect({{0, -4, 0}, {0, 1, 0}, kInfinity})->ng; }
  bool lights_reach() const { return scene_->lights_reach(medium()); }

private:
  std::shared_ptr<const Scene> scene_;
};

std::string lamp(const char* x) {
  return std::string("<emitter type=\"point\"><point name=\"position\" x=\"") + x +
         "\" y=\"0\" z=\"0\"/></emitter>";
}

TEST(ClosedMedia, NothingConnectsThroughGlass) {
  for (const std::string& boundary : {kGlass, kRough, std::string("<bsdf type=\"diffuse\"/>")}) {
    const Loaded milk(ball(boundary, kMilk) + kSky + lamp("2") +
                      "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"3\"/><emitter "
                      "type=\"area\"/></shape>");
    EXPECT_FALSE(milk.lights_reach()) << boundary;
    EXPECT_FALSE(milk.scene().may_see(milk.medium(), {0, -4, 0}));
    EXPECT_TRUE(milk.scene().may_see(milk.medium(), {0, 0.5f, 0}));
  }
  // A bubble of vacuum: the medium is all that lies around the sphere.
  const auto bubble = [](const std::string& turned, const std::string& boundary) {
    return "<shape type=\"sphere\">" + turned + boundary + kMilk + "</shape>";
  };
  const std::string flipped = "<boolean name=\"flip_normals\" value=\"true\"/>",
                    mirrored = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
  EXPECT_FALSE(Loaded(bubble("", kRough) + lamp("3")).lights_reach());
  EXPECT_TRUE(Loaded(bubble(flipped, kRough) + lamp("3")).lights_reach());
  const Loaded turned(bubble(mirrored, kRough) + lamp("3"));
  EXPECT_EQ(turned.lights_reach(), dot(turned.front(), {0, -1, 0}) < 0);
  // Two bodies of one liquid: each may be where the other is.
  const std::string second =
      "<shape type=\"cube\"><transform name=\"to_world\"><translate x=\"5\"/></transform>" + kGlass +
      "<ref name=\"interior\" id=\"milk\"/></shape>";
  EXPECT_FALSE(Loaded(ball(kGlass, kMilk) + second + lamp("-3")).lights_reach());
  EXPECT_TRUE(Loaded(ball(kGlass, kMilk) + second + lamp("3")).lights_reach());
}

TEST(ClosedMedia, WhereLightComesIn) {
  EXPECT_TRUE(Loaded(ball(kNull, kMilk) + kSky).lights_reach()) << "a boundary that is none";
  EXPECT_TRUE(Loaded(ball("<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.5\"/><bsdf "
                          "type=\"dielectric\"/></bsdf>",
                          kMilk) +
                     kSky)
                  .lights_reach())
      << "holes";
  EXPECT_TRUE(Loaded(ball(kGlass, kMilk) + lamp("0.5")).lights_reach()) << "a lamp inside";
  EXPECT_TRUE(Loaded(ball(kGlass, kMilk + "<emitter type=\"area\"/>") + kSky).lights_reach()) << "it shines";
  EXPECT_TRUE(Loaded("<shape type=\"disk\">" + kGlass + kMilk + "</shape>" + kSky).lights_reach())
      << "not closed";
  EXPECT_TRUE(Loaded(ball(kGlass, kMilk) +
                     "<shape type=\"sphere\"><float name=\"radius\" value=\"9\"/><bsdf type=\"null\"/><ref "
                     "name=\"exterior\" id=\"milk\"/></shape>" +
                     kSky)
                  .lights_reach())
      << "outside of another shape, too";
  EXPECT_TRUE(Loaded(ball(kGlass, kMilk) + kSky +
                     "<emitter type=\"spot\"><ref id=\"milk\"/><transform name=\"to_world\"><translate "
                     "z=\"4\"/></transform></emitter>")
                  .lights_reach())
      << "a lamp that says that it is in it";
}

TEST(ClosedMedia, OverlapsByPriority) {
  const auto milk = [](const std::string& boundary) {
    return "<shape type=\"sphere\"><integer name=\"priority\" value=\"1\"/>" + kGlass + kMilk +
           "</shape><shape type=\"sphere\"><integer name=\"priority\" value=\"2\"/><point name=\"center\" x=\"1\" "
           "y=\"0\" z=\"0\"/>" +
           boundary + "</shape>" + kSky;
  };
  EXPECT_FALSE(Loaded(milk(kGlass)).lights_reach());
  // Where this one is, the surface of the milk is not there.
  EXPECT_TRUE(Loaded(milk(kNull)).lights_reach());
}

/// `path` ends rays in these media behind the next event, `bdpt` does not. The extinction depends on the direction.
TEST(ClosedMedia, RaysThatEndBehindTheNextEventBringTheSame) {
  const std::string scene =
      camera("origin=\"0, -4, 1\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 30, 3, 64) +
      "<shape type=\"sphere\"><bsdf type=\"roughdielectric\"><float name=\"alpha\" value=\"0.4\"/></bsdf><medium "
      "type=\"homogeneous\" name=\"interior\"><rgb name=\"sigma_t\" value=\"3, 9, 27\"/><float name=\"albedo\" "
      "value=\"0.95\"/><phase type=\"sggx\"><string name=\"S\" value=\"1, 0.02, 0.02, 0, 0, "
      "0\"/></phase></medium></shape>" +
      kSky;
  const Picture a = render(path() + scene), b = render("<integrator type=\"bdpt\"/>" + scene);
  const double error = std::hypot(a.all_error, b.all_error);
  EXPECT_NEAR(a.all, b.all, 4.5 * error);
  EXPECT_LT(error, 0.015 * a.all);
}

}  // namespace
}  // namespace aureole::testing
