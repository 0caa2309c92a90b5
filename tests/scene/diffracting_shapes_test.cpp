// SPDX-License-Identifier: Apache-2.0
// Which shapes of a scene diffract, and the edges of round ones: their far field against Airy's pattern.
#include "aureole/scene/edge/diffracting_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <set>

#include "aureole/core/keyed_random.h"
#include "aureole/loading/load.h"
#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "harness/paths.h"
#include "harness/rendered.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

using std::numbers::pi;

std::string scene_of(const std::string& shapes, const std::string& width = "25 wavelengths",
                     const std::string& diffraction = "true") {
  return R"(<scene version="3.0.0"><integrator type="path"><boolean name="diffraction" value=")" +
         diffraction +
         R"("/>
<string name="diffraction_model" value="beams"/><string name="beam_width" value=")" +
         width + R"("/></integrator>
<sensor type="perspective"><film type="hdrfilm"><float name="wavelength_min" value="549"/><float name="wavelength_max" value="551"/>
<string name="response" value="uniform"/></film></sensor>
<emitter type="point"><point name="position" x="0" y="0" z="9"/><spectrum name="intensity" value="1"/></emitter>)" +
         shapes + "</scene>";
}
LoadedScene load(const std::string& text) { return load_scene_from_string(text, "edges.xml"); }

std::string marked(const std::string& parameters, double x) {
  return R"(<shape type="rectangle"><transform name="to_world"><scale value="0.01"/><translate x=")" +
         std::to_string(x) + R"("/></transform><bsdf type="twosided"><bsdf type="freespacediffraction">)" +
         parameters + "<bsdf type=\"diffuse\"/></bsdf></bsdf></shape>";
}

TEST(DiffractingShapes, AreThoseThatSaySoWhereSomeDo) {
  const std::string plain = R"(<shape type="cube"/>)";
  const auto count = [&](const std::string& shapes) {
    return load(scene_of(shapes)).scene->diffraction()->edges().index().edges().size();
  };
  EXPECT_EQ(count(plain), 12u);
  EXPECT_EQ(count(plain + marked("", 3)), 4u);
  EXPECT_EQ(
      count(plain + marked("", 3) + marked("", 5) + marked(R"(<boolean name="enabled" value="false"/>)", 7)),
      8u);
  EXPECT_EQ(count(plain + marked(R"(<boolean name="enabled" value="false"/>)", 3)), 0u);
  EXPECT_EQ(count(plain + marked(R"(<float name="scale" value="0"/>)", 3)), 0u);
  const std::string instanced =
      R"(<shape type="shapegroup" id="g">)" + marked("", 0) +
      R"(</shape><shape type="instance"><ref id="g"/></shape><shape type="instance"><ref id="g"/>
<transform name="to_world"><translate x="7"/></transform></shape>)";
  EXPECT_EQ(count(plain + instanced), 8u);

  const auto notes_of = [](const std::string& text) {
    std::string all;
    for (const std::string& note : load(text).notes) all += note + "\n";
    return all;
  };
  EXPECT_NE(notes_of(scene_of(marked("", 3), "25", "false")).find("do not diffract light here"),
            std::string::npos);
  EXPECT_EQ(notes_of(scene_of(marked("", 3))).find("do not diffract"), std::string::npos);
}

TEST(DiffractingShapes, StateOneWidthAndAFactor) {
  const auto scene = [&](const std::string& parameters) {
    return load(scene_of(marked(parameters, 0))).scene;
  };
  const auto plain = scene(""), twice = scene(R"(<float name="scale" value="2"/>)"),
             narrow = scene(R"(<float name="sigma" value="10"/>)");
  const auto beams_of = [](const Scene& s) {
    return s.diffraction()->edges().beams(Wavelengths::at(s.parts().context->grid, 550.f));
  };
  EXPECT_NEAR(beams_of(*narrow).widest / beams_of(*plain).widest, 0.4, 1e-6);
  const auto kernel = [&](const Scene& s, double at) {
    const EdgeLine line(s.diffraction()->edges().index().edges()[0]);
    const EdgePoint x{&s.diffraction()->edges().index().edges()[0], at, line.at(at), {}, 1};
    const Vec3 d{0, 0, -1}, across = cross(line.direction.to_float(), d);
    return s.diffraction()->edges().kernel(x, d, normalize(d + 0.05f * across), beams_of(s), {})[0];
  };
  for (const double at : {0.01, 1e-5}) {  // far from corners and beside one
    EXPECT_GT(std::abs(kernel(*plain, at)), 0);
    EXPECT_NEAR(kernel(*twice, at), 2 * kernel(*plain, at), 1e-4 * std::abs(kernel(*plain, at)));
  }
  const auto error_of = [](const std::string& text) {
    try {
      load(text);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string ten = R"(<float name="sigma" value="10"/>)", nine = R"(<float name="sigma" value="9"/>)";
  EXPECT_NE(error_of(scene_of(marked(ten, 0) + marked(nine, 3))).find("one number for a scene"),
            std::string::npos);
  EXPECT_NE(error_of(scene_of(marked(ten, 0), "3mm")).find("beam_width"), std::string::npos);
  EXPECT_EQ(error_of(scene_of(marked(ten, 0), "10 wavelengths")), "");
  EXPECT_NE(error_of(scene_of(marked(R"(<float name="sigma" value="0"/>)", 0))).find("sigma"),
            std::string::npos);
  // Its place in the file.
  EXPECT_NE(error_of(scene_of(marked(ten, 0), "3mm")).find("edges.xml:"), std::string::npos);
}

TEST(DiffractingShapes, BadScenesAreErrorsOrRemarks) {
  const std::string tiny = R"(<string name="length_unit" value="nm"/><shape type="rectangle"/>)";
  try {
    load(scene_of(tiny));
    ADD_FAILURE() << "a scene of 3 nm was loaded for 550 nm";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("edges.xml:2"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("longer than the scene"), std::string::npos) << e.what();
  }
  // 900 wires within a beam.
  std::string wires;
  for (int i = 0; i < 900; ++i)
    wires +=
        R"(<shape type="rectangle"><transform name="to_world"><scale x="1e-7" y="0.01"/><translate x=")" +
        std::to_string(1e-6 * i) + R"("/></transform></shape>)";
  const auto notes_of = [](const std::string& shapes) {
    std::string notes;
    // The camera stands in the plane of the shapes, nearer than its near clip plane.
    for (const std::string& note : load(scene_of(shapes, "1mm")).notes)
      if (note.find("every shape lies before near_clip") == std::string::npos) notes += note + "\n";
    return notes;
  };
  EXPECT_NE(notes_of(wires).find("a beam of light holds up to"), std::string::npos) << notes_of(wires);

  const auto sheet = [](const std::string& to_world) {
    return R"(<shape type="rectangle"><transform name="to_world"><scale value="0.01"/>)" + to_world +
           "</transform></shape>";
  };
  // Two sheets through each other, and beside each other with a gap of a tenth of a micrometre and of a millimetre.
  const std::string crossing = sheet("") + sheet(R"(<rotate x="1" y="0.3" angle="70"/>)");
  EXPECT_NE(notes_of(crossing).find("edges: 4 of 4 faces cut through others"), std::string::npos)
      << notes_of(crossing);
  const std::string narrow = notes_of(sheet("") + sheet(R"(<translate x="0.0200001"/>)")),
                    wide = notes_of(sheet("") + sheet(R"(<translate x="0.021"/>)"));
  EXPECT_NE(narrow.find("through so narrow a slit"), std::string::npos) << narrow;
  EXPECT_EQ(wide, "");
}

/// The part of the light on a disc of radius r that its edges send by q, per solid angle: (A/lambda)^2 (2 J1(q r)/(q r))^2.
double airy(double r, double theta, double lambda) {
  const double x = 2 * pi / lambda * 2 * std::sin(0.5 * theta) * r, area = pi * r * r;
  return std::pow(area / lambda * 2 * std::cyl_bessel_j(1, x) / x, 2);
}

/// The integral of K over all edges that are outlines.
double far_field(const SceneEdges& edges, const Vec3& d_i, const Vec3& d_o, const SceneEdges::Beams& beams) {
  double sum = 0;
  for (const MeshEdge& edge : edges.index().edges()) {
    if (!edge.is_outline(normalize(d_i + d_o))) continue;
    const EdgeLine line(edge);
    for (const double at : {0.2113248654, 0.7886751346}) {
      EdgePoint x{&edge, at * line.length, line.at(at * line.length), {}, 1};
      sum += 0.5 * line.length * edges.kernel(x, d_i, d_o, beams, {})[0];
    }
  }
  return sum;
}

/// Discs of 18 edges, of radius 20 um, at heights z [m], in beams of `sigma` micrometres.
std::shared_ptr<const Scene> discs(std::initializer_list<double> heights, int sigma) {
  const test::TemporaryFolder folder;
  std::string shapes;
  for (const double z : heights) {
    const auto file = folder.path / (std::to_string(shapes.size()) + ".obj");
    std::ofstream obj(file);
    obj << "v 0 0 0\n";
    for (int i = 0; i < 18; ++i)
      obj << "v " << 20e-6 * std::cos(pi * i / 9) << " " << 20e-6 * std::sin(pi * i / 9) << " 0\n";
    for (int i = 0; i < 18; ++i) obj << "f 1 " << i + 2 << " " << (i + 1) % 18 + 2 << "\n";
    obj.close();
    shapes += "<shape type=\"obj\"><string name=\"filename\" value=\"" + file.string() +
              "\"/><transform name=\"to_world\"><translate z=\"" + std::to_string(z) +
              "\"/></transform></shape>";
  }
  return load(scene_of(shapes, std::to_string(sigma) + "um")).scene;
}

// The power that a cluster diffracts is that of its pairs of edges, summed over them and in the mean over drawn numbers.
TEST(EdgeClusters, SendWhatPairsOfEdgesDo) {
  const auto scene = discs({0}, 15);
  const SceneEdges& edges = scene->diffraction()->edges();
  ASSERT_EQ(edges.clusters().size(), 1u);
  const auto beams = edges.beams(Wavelengths::at(scene->parts().context->grid, 550.f));
  const double k = beams.k[0], sigma = beams.sigma[0];
  for (const double theta : {0.01, 0.03, 0.1}) {
    const Vec3 d_i = normalize(Vec3{0.3f, 0.1f, -1}), d_o = normalize(d_i + float(theta) * Vec3{0.2f, 1, 0});
    const auto in_space = [](const Vec3& v) { return optics::SpaceVector{v.x, v.y, v.z}; };
    const optics::ScatteringPlane plane(in_space(d_i), in_space(d_o), k);
    std::vector<optics::ProjectedEdge> projected;
    for (const MeshEdge& e : edges.index().edges())
      projected.push_back(
          {plane.project(in_space(e.a)), plane.project(in_space(e.b)), length(Double3(e.b) - Double3(e.a))});
    double expected = 0;
    for (std::size_t i = 0; i < projected.size(); ++i)
      for (int n = 0; n < 40; ++n)
        expected += projected[i].length / 40 *
                    optics::mean_edge_kernel(projected, i, (n + 0.5) / 40, plane.q(), k, sigma);
    KeyedRandom random(8);
    double sum = 0, squares = 0;
    const int draws = 4000;
    for (int n = 0; n < draws; ++n) {
      const Vec2 u{random.next(), random.next()};
      double all = 0;
      for (const MeshEdge& e : edges.index().edges())
        all += EdgeLine(e).length * edges.kernel(edges.place_on(e, 0.3), d_i, d_o, beams, u)[0];
      sum += all / draws, squares += all * all / draws;
    }
    const double error = std::sqrt((squares - sum * sum) / draws);
    EXPECT_NEAR(sum, expected, 4 * error) << theta;
    EXPECT_LT(error, 0.05 * expected) << theta;
  }
}

// Edges farther behind one another than three sigma do not interfere: two discs send the light of each.
TEST(EdgeClusters, AreFlat) {
  const auto one = discs({0}, 15), two = discs({0, 75e-6}, 15);
  EXPECT_EQ(two->diffraction()->edges().clusters().size(), 0u);
  const Vec3 d_i{0, 0, -1}, d_o = normalize(Vec3{0.02f, 0.01f, -1});
  const auto sent = [&](const Scene& scene) {
    const SceneEdges& edges = scene.diffraction()->edges();
    const auto beams = edges.beams(Wavelengths::at(scene.parts().context->grid, 550.f));
    KeyedRandom random(2);
    double sum = 0;
    for (int n = 0; n < 6000; ++n) {
      const Vec2 u{random.next(), random.next()};
      for (const MeshEdge& e : edges.index().edges())
        sum += EdgeLine(e).length * edges.kernel(edges.place_on(e, random.next()), d_i, d_o, beams, u)[0];
    }
    return sum;
  };
  EXPECT_NEAR(sent(*two) / sent(*one), 2, 0.1);
}

class RoundEdges : public ::testing::TestWithParam<const char*> {};

// In a beam that is wide against it a round shape sends what a disc of its outline does.
TEST_P(RoundEdges, HaveAirysPattern) {
  const double r = 20e-6, lambda = 550e-9;
  const bool is_disk = std::string(GetParam()) == "disk";
  const auto scene =
      load(scene_of(std::string("<shape type=\"") + GetParam() +
                        R"("><transform name="to_world"><scale value="20e-6"/></transform></shape>)",
                    "400um"))
          .scene;
  const SceneEdges& edges = scene->diffraction()->edges();
  const auto beams = edges.beams(Wavelengths::at(scene->parts().context->grid, 550.f));
  // sigma_xi of 400 um is .1 mrad; the rings of 20 um are 17 mrad apart.
  for (const double theta : {0.005, 0.012, 0.025, 0.052}) {
    const Vec3 middle = is_disk ? Vec3{0, 0, -1} : normalize(Vec3{0.3f, -0.5f, -0.7f});
    const Vec3 across = normalize(cross(middle, Vec3{0.2f, 1, 0}));
    const Vec3 d_i = normalize(middle * float(std::cos(theta / 2)) - across * float(std::sin(theta / 2))),
               d_o = normalize(middle * float(std::cos(theta / 2)) + across * float(std::sin(theta / 2)));
    const double expected = airy(r, theta, lambda);
    EXPECT_NEAR(far_field(edges, d_i, d_o, beams) / expected, 1, 0.03) << theta;
  }
}
INSTANTIATE_TEST_SUITE_P(All, RoundEdges, ::testing::Values("disk", "sphere"),
                         [](const auto& info) { return std::string(info.param); });

TEST(RoundEdges, LieOnTheirShapesOrOutside) {
  const auto scene = load(scene_of(R"(
<shape type="sphere"><point name="center" x="3" y="0" z="0"/><float name="radius" value="0.002"/></shape>
<shape type="cylinder"><point name="p0" x="0" y="0" z="0"/><point name="p1" x="0" y="0" z="0.05"/><float name="radius" value="0.001"/></shape>
<shape type="sphere"><float name="radius" value="9"/><boolean name="flip_normals" value="true"/></shape>
<shape type="sphere"><point name="center" x="0" y="5" z="0"/><emitter type="area"/></shape>)"))
                         .scene;
  std::set<std::uint32_t> sets;
  double rims = 0, folds = 0, outline = 0;
  const Vec3 d = normalize(Vec3{1, 2, 0.5f});
  for (const MeshEdge& e : scene->diffraction()->edges().index().edges()) {
    sets.insert(e.face0.set);
    const Vec3 center{3, 0, 0}, middle = 0.5f * (e.a + e.b);
    if (e.face0.set == 0) {
      EXPECT_GT(length(middle - center), 0.002f * (1 - 1e-6f) - 3e-7f);  // rounding at x = 3
      EXPECT_LT(length(e.a - center), 0.002f * 1.001f);
      if (e.is_outline(d)) outline += length(cross(e.b - e.a, d));
      continue;
    }
    EXPECT_GT(std::hypot(middle.x, middle.y), 0.001f * (1 - 1e-5f));
    EXPECT_LT(std::hypot(e.a.x, e.a.y), 0.00101f);
    if (e.is_boundary)
      rims += length(e.b - e.a);
    else if (e.is_outline(d))
      folds += length(e.b - e.a);
  }
  EXPECT_EQ(sets, (std::set<std::uint32_t>{0, 1}));  // neither the room nor the lamp
  EXPECT_NEAR(outline, 2 * pi * 0.002, 2 * pi * 0.002 * 0.002);
  EXPECT_NEAR(rims, 2 * 2 * pi * 0.001, 4 * pi * 0.001 * 0.002);
  EXPECT_NEAR(folds, 2 * 0.05, 1e-5);
}

// A rim that is small against the screen behind it: its many edges are told from the screen's four, so that none is left out.
TEST(RoundEdges, AllOfASmallRimIsChosen) {
  const auto scene = load(scene_of(R"(
<shape type="disk"><transform name="to_world"><scale value="0.002"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="-1"/></transform></shape>)",
                                   "fresnel 0.5m"))
                         .scene;
  const SceneEdges& edges = scene->diffraction()->edges();
  const auto beams = edges.beams(Wavelengths::at(scene->parts().context->grid, 550.f));
  ASSERT_GT(edges.index().edges().size(), 300u);
  KeyedRandom random(3);
  const int n = 20000;
  double sums[2] = {}, squares[2] = {};  // of the halves of the rim
  for (int i = 0; i < n; ++i) {
    const float u[4] = {random.next(), random.next(), random.next(), random.next()};
    const PathEnd a{{0.0004f, 0, -1}}, b{{0, 0, 1}};
    const auto between = edges.choose_between(a, b, beams, u);
    if (!between) continue;
    const EdgePoint x = edges.place_between(*between, a, b, beams, u + 2);
    if (EdgeLine(*x.edge).length > 1) continue;
    const int half = x.x.y > 0;
    sums[half] += 1 / double(x.pdf) / n, squares[half] += 1 / double(x.pdf) / x.pdf / n;
  }
  for (const int half : {0, 1}) {
    const double error = std::sqrt((squares[half] - sums[half] * sums[half]) / n);
    EXPECT_NEAR(sums[half], pi * 0.002, 4 * error) << half;
    EXPECT_LT(error, 0.02 * pi * 0.002) << half;
  }
}

// 4 km from the origin single precision has steps of .24 to .49 mm, the angles of diffraction are mrad.
TEST(EdgePaths, DirectionsToEdgesAreExactFarFromTheOrigin) {
  const MeshEdge edge{{4000, 3000, 7}, {4001, 3000.5f, 7}, {0, 0, 1}, {}, {}, {}, true, false};
  const Vec3 place{4000.25f, 3000, 8};
  double rounded = 0;
  for (int i = 1; i < 20; ++i) {
    const double t = i / 20.7;
    const EdgePoint x{&edge, t, Double3{4000 + t, 3000 + 0.5 * t, 7}, {}, 1};
    const double dx = t - 0.25, dy = 0.5 * t, dz = -1, r = std::sqrt(dx * dx + dy * dy + dz * dz);
    const Vec3 d = x.direction_from(place);
    EXPECT_NEAR(d.x, dx / r, 1e-7);
    EXPECT_NEAR(d.y, dy / r, 1e-7);
    EXPECT_NEAR(d.z, dz / r, 1e-7);
    rounded = std::max(rounded, std::abs(normalize(x.on_edge() - place).x - dx / r));
  }
  EXPECT_GT(rounded, 2e-5);
}

TEST(EdgePaths, LeaveAnEdgeForOtherOnes) {
  const auto scene = load(scene_of(marked("", 0) + marked("", 0.03))).scene;
  const SceneEdges& edges = scene->diffraction()->edges();
  const MeshEdge& own = edges.index().edges()[1];
  KeyedRandom random(4);
  double length_of_others = 0;
  const int n = 40000;
  for (int i = 0; i < n; ++i) {
    const float u[3] = {random.next(), random.next(), random.next()};
    const auto x = edges.choose_from({0.5f * (own.a + own.b)}, u, &own);
    if (!x) continue;
    ASSERT_NE(x->edge, &own);
    length_of_others += 1 / double(x->pdf) / n;
  }
  EXPECT_NEAR(length_of_others, 7 * 0.02, 0.03 * 0.14);
}

}  // namespace
}  // namespace aureole
