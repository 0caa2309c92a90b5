// SPDX-License-Identifier: Apache-2.0
// Bodies that touch or cut each other, and surfaces that lie on each other: the picture depends on the matter, not on
// how many shapes describe it. References are the same matter as one block, and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "aureole/loading/load.h"
#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

const std::string kWater = "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"1.33\"/></bsdf>",
                  kGlass = "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"1.5\"/></bsdf>";

/// A wide block between two heights.
std::string block(double from, double to, const std::string& content, double half_width = 10) {
  return "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"" + number(half_width) + "\" y=\"" +
         number(half_width) + "\" z=\"" + number((to - from) / 2) + "\"/><translate z=\"" +
         number((from + to) / 2) + "\"/></transform>" + content + "</shape>";
}
std::string table(double height, double reflectance, double half_width) {
  return "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"" + number(half_width) +
         "\"/><translate z=\"" + number(height) + "\"/></transform><bsdf type=\"diffuse\">" +
         "<spectrum name=\"reflectance\" value=\"" + number(reflectance) + "\"/></bsdf></shape>";
}
std::string priority(int p) { return "<integer name=\"priority\" value=\"" + std::to_string(p) + "\"/>"; }

const std::string kScatterer = medium(0.5, 0.5);

/// Radiance along -z at the middle of the scene under a uniform sky of radiance 1.
Picture seen(const std::string& shapes, const std::string& integrator = "path", int samples = 2048) {
  return render("<integrator type=\"" + integrator + "\"/>" +
                camera("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 2, 2, samples) + shapes +
                kSky);
}
void expect_equal(const Picture& a, const Picture& b, const std::string& what) {
  EXPECT_NEAR(a.all, b.all, 4.5 * std::hypot(a.all_error, b.all_error)) << what;
  EXPECT_LT(std::hypot(a.all_error, b.all_error), 0.02 * b.all) << what;
}

TEST(TouchingMedia, AreOneBlockWhereTheyAreOfOneMatter) {
  for (const std::string& boundary : {kNull, kWater}) {
    const std::string matter = boundary + kScatterer;
    const auto two = [&](double end, double begin, const std::string& a, const std::string& b) {
      return block(-1, end, matter + a) + block(begin, 1, matter + b);
    };
    std::string sheets;
    for (int i = 0; i < 100; ++i) sheets += block(-1 + 0.02 * i, -1 + 0.02 * (i + 1), matter);
    const Picture one = seen(block(-1, 1, matter)), one_two_way = seen(block(-1, 1, matter), "bdpt", 512);
    expect_equal(one_two_way, one, "bdpt");
    expect_equal(seen(two(0, 0, "", "")), one, "touching");
    expect_equal(seen(two(0, 0, "", ""), "bdpt", 512), one, "touching, bdpt");
    expect_equal(seen(two(0, 0, priority(1), priority(2))), one, "priorities 1, 2");
    expect_equal(seen(two(0, 0, priority(2), priority(1))), one, "priorities 2, 1");
    expect_equal(seen(two(0, 1e-7, "", "")), one, "a gap smaller than the offset of rays");
    expect_equal(seen(two(0.3, -0.2, "", "")), one, "overlapping");
    expect_equal(seen(sheets, "path", 256), one, "100 sheets");
    const std::string group = "<shape type=\"shapegroup\" id=\"g\">" + block(-0.5, 0.5, matter) + "</shape>";
    const auto instance = [](double z) {
      return "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate z=\"" +
             number(z) + "\"/></transform></shape>";
    };
    expect_equal(seen(group + instance(-0.5) + instance(0.5)), one, "instances");
  }
}

TEST(TouchingMedia, BoundariesThatWrapGlassAreGlass) {
  const std::string flat =
      "<texture type=\"rawconstant\" name=\"normalmap\"><vector name=\"value\" value=\"0.5, 0.5, 1\"/></texture>";
  for (const std::string& boundary :
       {"<bsdf type=\"normalmap\">" + flat + kWater + "</bsdf>",
        "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.5\"/>" + kWater + kWater + "</bsdf>",
        std::string("<bsdf type=\"principled\"><float name=\"spec_trans\" value=\"1\"/><float name=\"eta\" "
                    "value=\"1.33\"/><float name=\"roughness\" value=\"0.2\"/></bsdf>")}) {
    const std::string matter = boundary + kScatterer;
    const Picture one = seen(block(-1, 1, matter)), two = seen(block(-1, 0, matter) + block(0, 1, matter));
    expect_equal(two, one, boundary);
  }
}

/// A cube of two materials, `top` and `rest`, as an OBJ file.
std::string cube_of_two_materials(const std::string& content) {
  const std::string file = ::testing::TempDir() + "aureole_two_materials.obj";
  std::ofstream(file)
      << "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
         "usemtl rest\nf 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
         "usemtl top\nf 5 6 7 8\n";
  return "<shape type=\"obj\"><string name=\"filename\" value=\"" + file +
         "\"/><boolean name=\"face_normals\" value=\"true\"/>" + content + "</shape>";
}

TEST(TouchingMedia, AFileOfSeveralMaterialsIsOneBody) {
  const std::string materials = "<bsdf type=\"null\" id=\"top\"/><bsdf type=\"null\" id=\"rest\"/>",
                    matter = medium(0.5, 0);
  for (const std::string& p : {std::string(), priority(1)}) {
    const std::string cube = cube_of_two_materials(matter + p),
                      group = "<shape type=\"shapegroup\" id=\"g\">" + cube +
                              "</shape><shape type=\"instance\"><ref id=\"g\"/></shape>";
    // Alone, and with another body that touches it above.
    for (const std::string& shape : {cube, group}) {
      EXPECT_NEAR(seen(materials + shape, "direct", 4).all, std::exp(-1.0), 1e-4) << p;
      EXPECT_NEAR(seen(materials + shape + block(1, 2, kNull + matter + p), "direct", 4).all, std::exp(-1.5),
                  1e-4)
          << p;
    }
  }
}

TEST(TouchingMedia, TransmittanceIsThatOfTheOtherWay) {
  // The third body lies within the first, and the second cuts both: the order of the scene alone would
  // contradict itself.
  const auto absorber = [](double sigma) { return kNull + medium(sigma, 0); };
  const std::string bodies =
      block(-2, 1, absorber(0.2), 4) + block(0, 2, absorber(0.5), 3) + block(-1, 0.5, absorber(1), 2);
  const auto along = [&](const char* way) {
    return render("<integrator type=\"direct\"/>" + camera(way, 1, 1, 4) + bodies + kSky).all;
  };
  const double down = along("origin=\"0.1, 0.2, 5\" target=\"0.1, 0.2, 0\" up=\"0, 1, 0\""),
               up = along("origin=\"0.1, 0.2, -5\" target=\"0.1, 0.2, 0\" up=\"0, 1, 0\"");
  EXPECT_NEAR(down, up, 1e-4 * up);
  // The second body stands before the third in the scene, which stands before the first, around it.
  EXPECT_NEAR(down, std::exp(-(2 * 0.5 + 1 * 1 + 1 * 0.2)), 1e-3 * up);
}

TEST(TouchingMedia, EqualPrioritiesAreDecidedByTheOrderOfTheScene) {
  const auto absorber = [](double sigma) { return kNull + medium(sigma, 0) + priority(5); };
  const auto along = [](const std::string& bodies, const char* way) {
    return render("<integrator type=\"direct\"/>" + camera(way, 1, 1, 4) + bodies + kSky).all;
  };
  const char *down = "origin=\"0.1, 0.2, 5\" target=\"0.1, 0.2, 0\" up=\"0, 1, 0\"",
             *up = "origin=\"0.1, 0.2, -5\" target=\"0.1, 0.2, 0\" up=\"0, 1, 0\"";
  const std::string across = block(0, 1, absorber(0.7)) + block(0.5, 2, absorber(0.3)),
                    within = block(-1, 1, absorber(0.3)) + block(-0.5, 0.5, absorber(0.9), 5);
  for (const char* way : {down, up}) {
    EXPECT_NEAR(along(across, way), std::exp(-1.0), 1e-3) << way;
    EXPECT_NEAR(along(within, way), std::exp(-0.3 - 0.9), 1e-3) << way;
  }
}

TEST(TouchingMedia, AnInterfaceOfTwoBodiesIsTheSameFromBothSides) {
  // A small lamp in the lower body, seen from within the upper one: blurred, whichever of them is the rough one.
  const std::string rough =
                        "<bsdf type=\"roughdielectric\"><float name=\"int_ior\" value=\"1.33\"/><float "
                        "name=\"alpha\" value=\"0.3\"/></bsdf>",
                    lamp =
                        "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"0.02\"/><translate "
                        "z=\"-0.9\"/></transform><emitter type=\"area\"><float name=\"radiance\" "
                        "value=\"1\"/></emitter></shape>",
                    within = "<integrator type=\"path\"/>" +
                             camera("origin=\"0, 0, 0.5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 0.2, 1, 4096);
  const double from_smooth = render(within + block(0, 1, kGlass) + block(-1, 0, rough) + lamp).all,
               from_rough = render(within + block(0, 1, rough) + block(-1, 0, kGlass) + lamp).all,
               sharp = render(within + block(0, 1, kGlass) + block(-1, 0, kWater) + lamp).all;
  EXPECT_LT(from_smooth, 0.5 * sharp);
  EXPECT_LT(from_rough, 0.5 * sharp);
  EXPECT_GT(std::min(from_smooth, from_rough), 0.01 * sharp);
}

TEST(TouchingMedia, AreCrossedByConnectionsAndLinesOfSight) {
  const auto absorber = [](double sigma) { return kNull + medium(sigma, 0); };
  const std::string two = block(0, 1, absorber(0.5)) + block(1, 2, absorber(1));
  const double expected = std::exp(-1.5);
  EXPECT_NEAR(seen(two, "direct", 4).all, expected, 1e-3 * expected);
  const std::string below = camera("origin=\"0, 0, -0.5\" target=\"0, 0, -1\" up=\"0, 1, 0\"", 2, 1, 16),
                    sun =
                        "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"0\" z=\"-1\"/>"
                        "<spectrum name=\"irradiance\" value=\"1\"/></emitter>",
                    within = camera("origin=\"0, 0, 0.25\" target=\"0, 0, 4\" up=\"0, 1, 0\"", 1, 1, 16);
  for (const char* integrator : {"path", "bdpt"}) {
    const std::string method = "<integrator type=\"" + std::string(integrator) + "\"/>";
    const double open = render(method + below + table(-1, 1, 1) + sun).all,
                 covered = render(method + below + table(-1, 1, 1) + sun + two).all;
    EXPECT_NEAR(covered / open, expected, 1e-3 * expected) << integrator;
  }
  // A path that begins within one of them, at the near plane of the camera.
  EXPECT_NEAR(render("<integrator type=\"direct\"/>" + within + two + kSky).all, std::exp(-0.5 * 0.74 - 1),
              2e-4);
}

/// Reflectance of a smooth interface for light from within the denser side, averaged over a Lambertian distribution; n > 1.
double internal_reflectance(double n) {
  double sum = 0;
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i) {
    const double sine2 = (i + 0.5) / kSteps, ci = std::sqrt(1 - sine2), st2 = n * n * sine2;
    if (st2 >= 1) {
      sum += 1;
      continue;
    }
    const double ct = std::sqrt(1 - st2), s = (n * ci - ct) / (n * ci + ct),
                 p = (ci - n * ct) / (ci + n * ct);
    sum += 0.5 * (s * s + p * p);
  }
  return sum / kSteps;
}

TEST(TouchingMedia, AnOpaqueSurfaceUnderABodyIsInOpticalContact) {
  // Saunderson's closed form of a diffuse substrate below a clear coat.
  const double r = 0.5, outer = 0.04, inner = internal_reflectance(1.5),
               expected = outer + (1 - outer) * r * (1 - inner) / (1 - r * inner);
  const std::string coat = block(0, 0.1, kGlass, 20);
  const std::string body =
      block(-1, 0, "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.5\"/></bsdf>", 20);
  for (const std::string& below : {table(0, r, 20), body})
    for (const std::string& shapes : {coat + below, below + coat}) {
      const Picture p = seen(shapes, "path", 4096);
      EXPECT_NEAR(p.all, expected, 4.5 * p.all_error + 2e-4);
      EXPECT_LT(p.all_error, 0.01 * expected);
    }
}

TEST(TouchingMedia, IndicesAreThoseAtTheWavelengthsOfTheSensor) {
  // In a narrow band spectra have fewer nodes than in the visible range; glass by name, in contact with itself.
  const std::string named =
      "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"bk7\"/></bsdf>" + kScatterer;
  const auto band = [](const std::string& shapes) {
    return render(
        "<integrator type=\"path\"/><sensor type=\"perspective\"><float name=\"fov\" value=\"2\"/>"
        "<transform name=\"to_world\"><lookat origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>"
        "<sampler type=\"sobol\"><integer name=\"sample_count\" value=\"1024\"/></sampler><film type=\"specfilm\">"
        "<integer name=\"width\" value=\"2\"/><integer name=\"height\" value=\"2\"/><integer name=\"bins\" value=\"1\"/>"
        "<float name=\"wavelength_min\" value=\"600\"/><float name=\"wavelength_max\" value=\"610\"/></film></sensor>" +
        shapes +
        "<emitter type=\"constant\"><spectrum name=\"radiance\" type=\"uniform\"><float name=\"value\" value=\"1\"/>"
        "</spectrum></emitter>");
  };
  const Picture one = band(block(-1, 1, named));
  EXPECT_GT(one.all, 0);
  expect_equal(band(block(-1, 0, named) + block(0, 1, named)), one, "touching");
  expect_equal(band(block(-1, 0.3, named) + block(-0.2, 1, named)), one, "overlapping");
}

TEST(TouchingMedia, BodiesOfDifferentIndicesHaveOneInterface) {
  // Glass on black water: reflections at the top and where they touch.
  const auto fresnel = [](double a, double b) { return std::pow((a - b) / (a + b), 2); };
  const double top = fresnel(1, 1.5), inner = fresnel(1.5, 1.33),
               expected = top + (1 - top) * (1 - top) * inner / (1 - top * inner);
  const std::string glass = block(0, 1, kGlass), water = block(-1, 0, kWater + medium(60, 0));
  for (const std::string& shapes :
       {glass + water, water + glass,
        block(0, 1, kGlass + priority(1)) + block(-1, 0, kWater + medium(60, 0) + priority(2)),
        block(0, 1, kGlass + priority(2)) + block(-1, 1e-3, kWater + medium(60, 0) + priority(1))}) {
    const Picture p = seen(shapes, "path", 1024);
    EXPECT_NEAR(p.all, expected, 4.5 * p.all_error + 1e-4);
    EXPECT_LT(p.all_error, 0.01 * expected);
  }
}

TEST(TouchingMedia, ABodyWithinAnotherMayReachItsSurface) {
  // Milk set into glass, flush with its lower side, which is black: as if it ended just above.
  const std::string
      water =
          "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"1.33\"/><float name=\"ext_ior\" value=\"1.5\"/></bsdf>",
      glass = block(-1, 1, kGlass, 20);
  const Picture flush = seen(glass + block(-1, 0, water + kScatterer, 15) + table(-1, 0, 30)),
                apart = seen(glass + block(-0.9999, 0, water + kScatterer, 15) + table(-0.9999, 0, 30));
  expect_equal(flush, apart, "flush");
}

std::vector<std::string> notes_of(const std::string& shapes) {
  return load_scene_from_string("<scene version=\"3.0.0\"><integrator type=\"path\"/>" +
                                    camera("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 2, 2, 4) +
                                    "\n" + shapes + kSky + "</scene>",
                                "touching.xml")
      .notes;
}
int count(const std::vector<std::string>& notes, const std::string& text) {
  return int(std::count_if(notes.begin(), notes.end(), [&](const std::string& note) {
    return note.starts_with("touching.xml:2:") && note.find(text) != std::string::npos;
  }));
}

TEST(TouchingMedia, WhatCannotBeDecidedIsNoted) {
  const std::string thin = kNull + medium(1, 0), dense = kNull + medium(2, 0);
  EXPECT_EQ(count(notes_of(block(-1, 0.5, thin) + block(0, 1, dense)), "fill the same space"), 1);
  EXPECT_EQ(count(notes_of(block(-1, 0.5, thin) + block(0, 1, dense + priority(1))), "fill the same space"),
            1);
  EXPECT_EQ(count(notes_of(block(-1, 0.5, thin + priority(2)) + block(0, 1, dense + priority(1))),
                  "fill the same space"),
            0);
  EXPECT_EQ(count(notes_of(block(-1, 0, thin) + block(0, 1, dense)), "fill the same space"), 0) << "touching";
  EXPECT_EQ(count(notes_of(block(-1, 1, thin) + block(-0.5, 0.5, dense, 5)), "fill the same space"), 0)
      << "within";
  EXPECT_EQ(count(notes_of(block(-1, 0.5, thin + priority(1)) + block(0, 1, dense + priority(1))),
                  "no different priorities"),
            1);
  // A body within another one that states air around it, unless priorities decide.
  const std::string states_medium = "states another medium around it", states_index = "states another index";
  EXPECT_EQ(count(notes_of(block(-1, 1, thin) + block(-0.5, 0.5, dense, 5)), states_medium), 1);
  EXPECT_EQ(count(notes_of(block(-1, 1, thin) + block(-0.5, 0.5, dense + priority(1), 5)), states_medium), 1);
  EXPECT_EQ(count(notes_of(block(-1, 1, thin + priority(1)) + block(-0.5, 0.5, dense + priority(2), 5)),
                  states_medium),
            0);
  std::string outside = medium(1, 0);
  outside.replace(outside.find("interior"), 8, "exterior");
  EXPECT_EQ(count(notes_of(block(-1, 1, thin) + block(-0.5, 0.5, dense + outside, 5)), states_medium), 0);
  const std::string in_glass =
      "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"1.33\"/><float "
      "name=\"ext_ior\" value=\"1.5\"/></bsdf>";
  EXPECT_EQ(count(notes_of(block(-1, 1, kGlass) + block(-0.5, 0.5, kWater, 5)), states_index), 1);
  EXPECT_EQ(count(notes_of(block(-1, 1, kGlass) + block(-0.5, 0.5, in_glass, 5)), states_index), 0);
  const std::string pane =
      "<shape type=\"rectangle\"><transform name=\"to_world\"><translate z=\"1\"/></transform><bsdf type=\"thindielectric\"/></shape>";
  EXPECT_EQ(count(notes_of(block(-1, 1, kGlass) + pane), "lies on"), 1);
}

}  // namespace
}  // namespace aureole::testing
