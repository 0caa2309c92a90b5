// SPDX-License-Identifier: Apache-2.0
// Media that vary in space or direction, in instances of a group of shapes: against closed forms, and against
// the same shapes and volumes placed without instances.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "aureole/loading/document.h"
#include "aureole/loading/load.h"
#include "aureole/medium/medium.h"
#include "harness/rendered.h"
#include "medium/scene_text.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

using aureole::test::error_thrown_by;
using aureole::test::grid_over_cube;
using aureole::test::make_vol;
using aureole::test::VolumeFolder;
using aureole::test::write_bytes;

std::string to_world(const std::string& steps) {
  return "<transform name=\"to_world\">" + steps + "</transform>";
}
std::string instance(const std::string& group, const std::string& steps) {
  return "<shape type=\"instance\"><ref id=\"" + group + "\"/>" + to_world(steps) + "</shape>";
}
std::string group(const std::string& id, const std::string& shapes) {
  return "<shape type=\"shapegroup\" id=\"" + id + "\">" + shapes + "</shape>";
}

class InstancedMedia : public ::testing::Test {
protected:
  /// A grid over [-1, 1]^3, which `steps` then move, as the parameter `name`.
  std::string grid(const std::string& name, const std::array<int, 3>& size, const std::vector<float>& values,
                   const std::string& steps = "", int channels = 1) {
    const auto file = write_bytes(folder_.path() / (name + std::to_string(++files_) + ".vol"),
                                  make_vol(size, channels, values).bytes());
    return grid_over_cube(file, name,
                          test::choice("filter_type", "nearest") +
                              (channels == 6 ? "<boolean name=\"raw\" value=\"true\"/>" : ""),
                          steps);
  }
  static std::string heterogeneous(const std::string& content, const std::string& name = "interior") {
    return "<medium type=\"heterogeneous\" name=\"" + name + "\">" + content + "</medium>";
  }
  static std::string cube(const std::string& content, const std::string& steps = "") {
    return "<shape type=\"cube\">" + kNull + to_world(steps) + content + "</shape>";
  }
  /// The mean over parallel rays through the square of side 0.5 around (x, y), along -z from above.
  static Picture looking_down(double x, double y, const std::string& content, int samples = 256) {
    const std::string at = number(x) + ", " + number(y) + ", ";
    return render(
        path() +
        "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale x=\"0.25\" y=\"0.25\"/><lookat "
        "origin=\"" +
        at + "20\" target=\"" + at + "0\" up=\"0, 1, 0\"/></transform>" + film(4, samples) + "</sensor>" +
        content + kSky);
  }

  VolumeFolder folder_;
  int files_ = 0;
};

const std::string kBlack = "<float name=\"albedo\" value=\"0\"/>";

TEST_F(InstancedMedia, TransmittanceIsThatOfTheInstance) {
  const std::string ones = grid("sigma_t", {2, 2, 2}, std::vector<float>(8, 1));
  const std::string scene =
      group("fog", cube(heterogeneous(ones + kBlack))) + instance("fog", "<translate x=\"10\"/>") +
      instance("fog", "<rotate z=\"1\" angle=\"30\"/><scale value=\"2\"/><translate x=\"-10\"/>") +
      instance("fog", "<scale x=\"-1\" z=\"0.25\"/><translate y=\"10\"/>");
  // Coefficients are per length of the scene, so that the optical thickness grows with the instance.
  expect_mean(looking_down(10, 0, scene), std::exp(-2.0));
  expect_mean(looking_down(-10, 0, scene), std::exp(-4.0), 0.04);
  expect_mean(looking_down(0, 10, scene), std::exp(-0.5));
  // A homogeneous medium does the same.
  const std::string same =
      group("fog", cube(medium(1, 0))) + instance("fog", "<scale value=\"2\"/><translate x=\"-10\"/>");
  expect_mean(looking_down(-10, 0, same), std::exp(-4.0), 0.04);
  // Where the group itself lies there is nothing.
  expect_mean(looking_down(0, 0, scene), 1);
}

TEST_F(InstancedMedia, HalfFilledGridsTurnWithTheirInstances) {
  // Extinction 1 where x > 0 in the group.
  const std::string half = grid("sigma_t", {2, 1, 1}, {0, 1});
  const std::string scene = group("half", cube(heterogeneous(half + kBlack))) +
                            instance("half", "<rotate z=\"1\" angle=\"90\"/><translate x=\"10\"/>") +
                            instance("half", "<rotate z=\"1\" angle=\"180\"/><translate x=\"-10\"/>") +
                            instance("half", "<rotate y=\"1\" angle=\"90\"/><translate y=\"10\"/>");
  for (const double side : {-0.5, 0.5}) {
    const double there = std::exp(-2.0);
    expect_mean(looking_down(10, side, scene), side > 0 ? there : 1);  // x became y
    expect_mean(looking_down(10 + side, 0.5, scene), there);
    expect_mean(looking_down(-10 + side, 0, scene), side < 0 ? there : 1);  // x became -x
    expect_mean(looking_down(side, 10, scene), std::exp(-1.0));             // x became -z
  }
}

/// A grid with a value of its own in each of 2 x 2 x 2 voxels.
const std::vector<float> kEight = {0.1f, 1.4f, 0, 0.5f, 0.9f, 0, 2.1f, 0.3f};
constexpr const char* kTurned =
    "<scale value=\"0.8\"/><rotate x=\"1\" y=\"2\" z=\"0.5\" angle=\"70\"/><translate x=\"0.3\" z=\"0.2\"/>";

/// Expects that a scene's medium and its response to light are the same with and without instances.
void expect_same(const std::string& instanced, const std::string& placed, const std::string& what,
                 double largest_error, int samples = 128) {
  const std::string before = camera("origin=\"0, -6, 2\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 24, 4, samples);
  const std::string lights =
      "<emitter type=\"directional\"><vector name=\"direction\" x=\"1\" y=\"1\" z=\"-1\"/></emitter>" + kSky;
  const Picture a = render(before + lights + instanced), b = render(before + lights + placed);
  const double error = std::hypot(a.all_error, b.all_error);
  EXPECT_NEAR(a.all, b.all, 4.5 * error + 1e-4 * a.all) << what;
  EXPECT_LT(error, largest_error * a.all) << what;
  for (std::size_t i = 0; i < a.mean.size(); ++i)
    EXPECT_NEAR(a.mean[i], b.mean[i], 6 * std::hypot(a.error[i], b.error[i]) + 1e-3 * a.all)
        << what << ", pixel " << i;
}

TEST_F(InstancedMedia, ScatterAndShineAsIfPlaced) {
  std::vector<float> glow(8, 0);
  glow[5] = 3, glow[2] = 1;
  const auto content = [&](const std::string& steps) {
    return heterogeneous(grid("sigma_t", {2, 2, 2}, kEight, steps) +
                         grid("emission", {2, 2, 2}, glow, steps) + parameter("albedo", 0.8) +
                         "<phase type=\"blendphase\">" + grid("weight", {1, 1, 2}, {0, 1}, steps) +
                         "<phase type=\"isotropic\"/><phase type=\"hg\"><float name=\"g\" "
                         "value=\"0.7\"/></phase></phase>");
  };
  for (const char* integrator : {"path", "ptracer", "bdpt"}) {
    const std::string by = "<integrator type=\"" + std::string(integrator) + "\"/>";
    expect_same(by + group("g", cube(content(""))) + instance("g", kTurned),
                by + cube(content(kTurned), kTurned), integrator, 0.02);
  }
}

TEST_F(InstancedMedia, EmissionThatVariesWithoutAGrid) {
  // A homogeneous extinction with an emission by volume: light sampling tabulates it in the box of the shape.
  std::vector<float> glow(8, 0);
  glow[5] = 3, glow[2] = 1;
  const auto content = [&](const std::string& steps) {
    return "<medium type=\"homogeneous\" name=\"interior\">" + parameter("sigma_t", 0.6) +
           parameter("albedo", 0.7) + grid("emission", {2, 2, 2}, glow, steps) + "</medium>";
  };
  expect_same(group("g", cube(content(""))) + instance("g", kTurned), cube(content(kTurned), kTurned),
              "emission", 0.02);
}

TEST_F(InstancedMedia, OrientedParticlesTurn) {
  // S = diag(1, 1, 0.04) turned by 30 degrees about x: fibres along z lean towards -y.
  const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6), thin = 0.04;
  const auto matrix = [](double xx, double yy, double zz, double yz) {
    return "<phase type=\"sggx\"><string name=\"S\" value=\"" + number(xx) + ", " + number(yy) + ", " +
           number(zz) + ", 0, 0, " + number(yz) + "\"/></phase>";
  };
  const auto content = [&](const std::string& phase) {
    return "<medium type=\"homogeneous\" name=\"interior\">" + parameter("sigma_t", 0.8) +
           parameter("albedo", 0.9) + phase + "</medium>";
  };
  const std::string turn = "<rotate x=\"1\" angle=\"30\"/>";
  const std::string placed =
      cube(content(matrix(1, c * c + thin * s * s, s * s + thin * c * c, (1 - thin) * s * c)), turn);
  for (const std::string integrator : {"path", "ptracer"}) {
    const std::string by = "<integrator type=\"" + integrator + "\"/>";
    expect_same(by + group("g", cube(content(matrix(1, 1, thin, 0)))) + instance("g", turn), by + placed,
                integrator, 0.02);
  }
  // A grid of matrices is looked up in the group and turned, too.
  const auto grids = grid("S", {1, 1, 1}, {1, 1, float(thin), 0, 0, 0}, "", 6);
  expect_same(group("g", cube(content("<phase type=\"sggx\">" + grids + "</phase>"))) + instance("g", turn),
              placed, "a grid of matrices", 0.02);
  // A stretched group does not deform its particles, which is said.
  const LoadedScene stretched = load_scene_from_string(
      "<scene version=\"3.0.0\">" + camera("origin=\"0, 0, 9\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 20, 2, 1) +
          group("g", cube(content(matrix(1, 1, thin, 0)))) + instance("g", "<scale x=\"2\"/>") + kSky +
          "</scene>",
      "stretched.xml");
  EXPECT_EQ(
      std::count_if(stretched.notes.begin(), stretched.notes.end(),
                    [](const std::string& n) { return n.find("keep their shape") != std::string::npos; }),
      1);
}

/// The scene of some objects before a camera, and its media along the x axis.
class Loaded {
public:
  explicit Loaded(const std::string& content)
      : loaded_(load_scene_from_string(
            "<scene version=\"3.0.0\">" +
                camera("origin=\"0, 0, 99\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 2, 1) + content + kSky +
                "</scene>",
            "placed.xml")) {}
  const Medium* medium_at(const Vec3& p) const { return loaded_.scene->medium_at({p, {0, 0, 1}, kInfinity}); }
  float extinction_at(const Vec3& p) const {
    const Medium* medium = medium_at(p);
    // Outside of the bounds there is nothing, whatever a volume has there.
    if (!medium || !(medium->majorants().bound_at(p) > 0)) return 0;
    MediumCoefficients at;
    medium->eval(p, {0, 0, 1}, Wavelengths::at(loaded_.scene->parts().context->grid, 550), at);
    EXPECT_LE(at.sigma_t[0], medium->majorants().bound_at(p) * medium->majorant({0, 0, 1}, {})[0]);
    return at.sigma_t[0];
  }
  int notes(const std::string& text) const {
    return int(std::count_if(loaded_.notes.begin(), loaded_.notes.end(),
                             [&](const std::string& n) { return n.find(text) != std::string::npos; }));
  }

private:
  LoadedScene loaded_;
};

TEST_F(InstancedMedia, WhichMediaMoveWithAGroup) {
  const std::string two = grid("sigma_t", {2, 1, 1}, {1, 2});
  const auto ball = [](const std::string& media) { return testing::ball(kNull, media); };
  // A medium between two shapes of a group is one medium, and so is one that a nested instance has around it.
  const std::string shell = group("core", ball("<ref name=\"exterior\" id=\"m\"/>")) +
                            group("shell", cube("<ref name=\"interior\" id=\"m\"/>", "<scale value=\"2\"/>") +
                                               instance("core", "<translate x=\"0.5\"/>"));
  const std::string m = "<medium type=\"heterogeneous\" id=\"m\">" + two + kBlack + "</medium>";
  const Loaded moved(m + shell + instance("shell", "<translate x=\"20\"/>"));
  EXPECT_NEAR(moved.extinction_at({20.9f, 1.5f, 0}), 0, 0) << "the grid ends at 1";
  EXPECT_NEAR(moved.extinction_at({19.6f, 0, 0.9f}), 1, 1e-6) << "between the ball and the cube";
  EXPECT_NEAR(moved.extinction_at({20.1f, 0.95f, 0.9f}), 2, 1e-6);
  EXPECT_EQ(moved.medium_at({20.1f, 0.95f, 0.9f}), moved.medium_at({19, 1.5f, 1.5f}));
  EXPECT_EQ(moved.medium_at({20.5f, 0, 0}), nullptr) << "in the ball";
  EXPECT_EQ(moved.notes("keeps its place"), 0);
  // A medium that only surrounds shapes of the group stays in the scene, and a note says so.
  const Loaded around(m + cube("<ref name=\"interior\" id=\"m\"/>", "<scale value=\"20\"/>") +
                      group("bubble", ball("<ref name=\"exterior\" id=\"m\"/>")) +
                      instance("bubble", "<translate x=\"0.5\"/>"));
  EXPECT_EQ(around.notes("keeps its place"), 1);
  EXPECT_EQ(around.medium_at({0.5f, 0, 0}), nullptr);
  EXPECT_EQ(around.medium_at({0.5f, 0, -1.5f}), around.medium_at({0.5f, 0, 1.5f}));
  EXPECT_NEAR(around.extinction_at({-0.6f, 0, 0.9f}), 1, 1e-6);
  // An instance that does not move its group shares the group's medium, and so do uniform media.
  const Loaded unmoved(m + group("g", cube("<ref name=\"interior\" id=\"m\"/>")) + instance("g", "") +
                       cube("<ref name=\"interior\" id=\"m\"/>", "<translate z=\"-5\"/>"));
  EXPECT_EQ(unmoved.medium_at({0, 0, 0}), unmoved.medium_at({0, 0, -5}));
  const Loaded uniform(group("g", cube(medium(1, 0))) + instance("g", "<translate x=\"5\"/>") +
                       instance("g", "<translate x=\"-5\"/>"));
  EXPECT_EQ(uniform.medium_at({5, 0, 0}), uniform.medium_at({-5, 0, 0}));
}

TEST_F(InstancedMedia, OneThatOnlyInstancesHaveIsNotStated) {
  const std::string m =
      "<medium type=\"heterogeneous\" id=\"m\">" + grid("sigma_t", {2, 1, 1}, {1, 2}) + "</medium>";
  const std::string scene =
      m + group("g", cube("<ref name=\"interior\" id=\"m\"/>")) + instance("g", "<translate x=\"5\"/>");
  const auto lamp = [](const std::string& content) {
    return "<emitter type=\"point\"><point name=\"position\" x=\"5\" y=\"0\" z=\"0\"/>" + content +
           "</emitter>";
  };
  const std::string error = error_thrown_by([&] { Loaded(scene + lamp("<ref id=\"m\"/>")); });
  EXPECT_NE(error.find("only instances place"), std::string::npos) << error;
  EXPECT_TRUE(error.starts_with("placed.xml:")) << error;
  EXPECT_EQ(error_thrown_by([&] { Loaded(scene + lamp("")); }), "");
  EXPECT_EQ(error_thrown_by([&] {
              Loaded(scene + lamp("<ref id=\"m\"/>") +
                     cube("<ref name=\"interior\" id=\"m\"/>", "<scale value=\"9\"/>"));
            }),
            "");
}

TEST_F(InstancedMedia, OverlappingInstancesOfNestedDielectrics) {
  // Two balls of one group, one unit apart: the light passes 3 of the medium along the line of their centres.
  const std::string scene = group("drop", "<shape type=\"sphere\"><integer name=\"priority\" value=\"1\"/>" +
                                              kNull + medium(1, 0) + "</shape>");
  const auto along_z = [&](const std::string& first, const std::string& second) {
    return render(
        path() +
        "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale value=\"0.001\"/><lookat "
        "origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>" +
        film(8, 256) + "</sensor>" + scene + first + second + kSky);
  };
  const std::string here = instance("drop", ""), there = instance("drop", "<translate z=\"1\"/>");
  expect_mean(along_z(here, there), std::exp(-3.0), 0.02);
  expect_mean(along_z(there, here), std::exp(-3.0), 0.02);
  // A camera in both of them leaves both.
  const Picture within =
      render(path() +
             "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale value=\"0.001\"/><lookat "
             "origin=\"0, 0, 0.5\" target=\"0, 0, -5\" up=\"0, 1, 0\"/></transform>" +
             film(8, 256) + "</sensor>" + scene + here + there + kSky);
  expect_mean(within, std::exp(-1.5));
}

TEST_F(InstancedMedia, EditsMoveThem) {
  const std::string text =
      "<scene version=\"3.0.0\">" + path() +
      camera("origin=\"10, 0, 20\" target=\"10, 0, 0\" up=\"0, 1, 0\"", 1, 2, 4) +
      "<medium type=\"heterogeneous\" id=\"m\">" + grid("sigma_t", {2, 1, 1}, {1, 2}) + kBlack + "</medium>" +
      group("g", "<shape type=\"cube\" id=\"box\">" + kNull + "<ref name=\"interior\" id=\"m\"/></shape>") +
      "<shape type=\"instance\" id=\"i\"><ref id=\"g\"/>" + to_world("<translate x=\"9.5\"/>") + "</shape>" +
      kSky + "</scene>";
  SceneDocument d(text, "edited.xml");
  const auto extinction = [&](float x) {
    const Scene& scene = *d.scene();
    const Medium* medium = scene.medium_at({{x, 0, 0}, {0, 0, 1}, kInfinity});
    if (!medium) return 0.f;
    MediumCoefficients at;
    medium->eval({x, 0, 0}, {0, 0, 1}, Wavelengths::at(scene.parts().context->grid, 550), at);
    return at.sigma_t[0];
  };
  EXPECT_NEAR(extinction(10), 2, 1e-6);
  const auto before = d.scene();
  const auto hash = d.loaded().hash;
  d.edit({{"i.to_world", "<transform><translate x='10.5'/></transform>"}});
  EXPECT_NEAR(extinction(10), 1, 1e-6);
  EXPECT_NE(d.loaded().hash, hash);
  d.edit({{"m.scale", "<float value='3'/>"}});
  EXPECT_NEAR(extinction(10), 3, 1e-6);
  d.edit({{"i.to_world", "<transform><rotate y='1' angle='180'/><translate x='10.5'/></transform>"}});
  EXPECT_NEAR(extinction(10), 6, 1e-6);
  // The scene of before is what it was.
  const Medium* old = before->medium_at({{10, 0, 0}, {0, 0, 1}, kInfinity});
  MediumCoefficients at;
  old->eval({10, 0, 0}, {0, 0, 1}, Wavelengths::at(before->parts().context->grid, 550), at);
  EXPECT_NEAR(at.sigma_t[0], 2, 1e-6);
}

TEST_F(InstancedMedia, SolidTexturesMoveWithTheirShapes) {
  // Reflectance 0.2 where x < 0 in the group, 0.8 elsewhere; the rectangle faces the camera.
  const auto surface = [&](const std::string& steps) {
    return "<shape type=\"rectangle\">" + to_world(steps) +
           "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"volume\">" +
           grid("volume", {2, 1, 1}, {0.2f, 0.8f}, steps) + "</texture></bsdf></shape>";
  };
  const std::string scene =
      group("g", surface("")) + instance("g", "<translate x=\"10\"/>") +
      instance("g", "<rotate z=\"1\" angle=\"90\"/><scale value=\"3\"/><translate x=\"-10\"/>");
  expect_mean(looking_down(9.5, 0, scene), 0.2);
  expect_mean(looking_down(10.5, 0, scene), 0.8);
  expect_mean(looking_down(-10, -2, scene), 0.2);
  expect_mean(looking_down(-8, 2, scene), 0.8);
  // Masks, too: a hole is where the group has it.
  const std::string masked =
      group(
          "g",
          "<shape type=\"rectangle\"><bsdf type=\"mask\"><texture name=\"opacity\" type=\"volume\">" +
              grid("volume", {2, 1, 1}, {0, 1}) +
              "</texture><bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0\"/></bsdf></bsdf></shape>") +
      instance("g", "<rotate z=\"1\" angle=\"180\"/><translate x=\"10\"/>");
  expect_mean(looking_down(10.5, 0, masked), 1);
  EXPECT_EQ(looking_down(9.5, 0, masked).all, 0);
}

TEST_F(InstancedMedia, ModelsOfUniformMediaRefuseVaryingPhaseFunctions) {
  const std::string phase =
      "<phase type=\"blendphase\">" + grid("weight", {2, 1, 1}, {0, 1}) +
      "<phase type=\"isotropic\"/><phase type=\"hg\"><float name=\"g\" value=\"0.7\"/></phase></phase>";
  const std::string m = "<medium type=\"homogeneous\">" + phase + "</medium>";
  for (const std::string& shape :
       {ball("<bsdf type=\"layered\"><string name=\"thickness\" value=\"1mm\"/>" + m + "</bsdf>", ""),
        ball("", "<bssrdf type=\"dipole\">" + m + "</bssrdf>"),
        ball(kNull, "<medium type=\"kubelka_munk\" name=\"interior\">" + parameter("k", 1) +
                        parameter("s", 1) + phase + "</medium>")}) {
    const std::string error = error_thrown_by([&] { Loaded scene(shape); });
    EXPECT_TRUE(error.find("same everywhere") != std::string::npos ||
                error.find("same medium everywhere") != std::string::npos)
        << error;
  }
}

}  // namespace
}  // namespace aureole::testing
