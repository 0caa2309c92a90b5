// SPDX-License-Identifier: Apache-2.0
// Surfaces that light crosses on a straight line: panes, masks and layers of scatterers. Next-event estimation passes them, and the
// integrator's `count_crossings` says whether crossing them counts for `max_depth`.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

constexpr double kReflectance = 0.5, kTilt = 40;  // degrees

/// Transmittance of a pane of that index with all reflections within it, from Fresnel's amplitudes.
double pane_transmittance(double n, double degrees) {
  const double ci = std::cos(degrees * std::numbers::pi / 180), ct = std::sqrt(1 - (1 - ci * ci) / (n * n));
  const double s = (ci - n * ct) / (ci + n * ct), p = (n * ci - ct) / (n * ci + ct),
               r = 0.5 * (s * s + p * p);
  return (1 - r) / (1 + r);
}

/// A floor below a sheet, seen from between them, in the light of a sun above.
std::string scene(const std::string& bsdf) {
  const double sine = std::sin(kTilt * std::numbers::pi / 180),
               cosine = std::cos(kTilt * std::numbers::pi / 180);
  return camera("origin=\"0, 0, 0.5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 40, 2, 512) +
         "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"0.5\"/></transform><bsdf type=\"diffuse\">"
         "<spectrum name=\"reflectance\" value=\"" +
         number(kReflectance) +
         "\"/></bsdf></shape>"
         "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"1.2\"/><translate z=\"0.6\"/></transform>" +
         bsdf +
         "</shape>"
         "<emitter type=\"directional\"><vector name=\"direction\" x=\"" +
         number(sine) + "\" y=\"0\" z=\"" + number(-cosine) +
         "\"/><spectrum name=\"irradiance\" value=\"1\"/></emitter>";
}
std::string method(const std::string& type, int max_depth, const std::string& more) {
  return "<integrator type=\"" + type + "\"><integer name=\"max_depth\" value=\"" +
         std::to_string(max_depth) + "\"/>" + more + "</integrator>";
}
const std::string kUncounted = "<boolean name=\"count_crossings\" value=\"false\"/>";

/// Radiance of the floor where the sheet lets that fraction pass.
double expected(double transmittance) {
  return kReflectance / std::numbers::pi * std::cos(kTilt * std::numbers::pi / 180) * transmittance;
}

TEST(ThinPane, LightSamplingPassesIt) {
  struct Case {
    std::string bsdf;
    double transmittance;
  };
  const double pane = pane_transmittance(1.5, kTilt);
  const std::string glass =
      "<bsdf type=\"thindielectric\"><float name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/>";
  for (const Case& c :
       {Case{glass + "</bsdf>", pane},
        Case{glass + "<spectrum name=\"specular_transmittance\" value=\"0.6\"/></bsdf>", 0.6 * pane},
        Case{"<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.3\"/>" + glass + "</bsdf></bsdf>",
             0.7 + 0.3 * pane},
        Case{"<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.25\"/>" + glass +
                 "</bsdf><bsdf type=\"diffuse\"/></bsdf>",
             0.75 * pane}})
    for (const char* type : {"path", "bdpt", "ptracer"}) {
      const Picture p = render(method(type, 2, kUncounted) + scene(c.bsdf));
      EXPECT_NEAR(p.all, expected(c.transmittance), 4.5 * p.all_error + 1e-4 * p.all) << type << c.bsdf;
      EXPECT_LT(p.all_error, 0.08 * p.all) << type << c.bsdf;
    }
}

TEST(ThinPane, CrossingsCountForTheLimitOfSegmentsWhereTheIntegratorSaysSo) {
  const std::string pane =
      "<bsdf type=\"thindielectric\"><float name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>";
  const double whole = expected(pane_transmittance(1.5, kTilt));
  for (const char* type : {"path", "bdpt", "ptracer"}) {
    EXPECT_EQ(render(method(type, 2, "") + scene(pane)).all, 0) << type;
    const Picture three = render(method(type, 3, "") + scene(pane));
    EXPECT_NEAR(three.all, whole, 4.5 * three.all_error + 1e-4 * whole) << type;
    // A null surface is none that counts.
    const Picture open = render(method(type, 2, "") + scene(kNull));
    EXPECT_NEAR(open.all, expected(1), 4.5 * open.all_error + 1e-4 * open.all) << type;
  }
  for (const char* type : {"volpath", "volpathmis"}) {
    EXPECT_NEAR(render(method(type, 2, "") + scene(pane)).all, whole, 1e-3 * whole) << type;
    EXPECT_EQ(render(method(type, 2, "<boolean name=\"count_crossings\" value=\"true\"/>") + scene(pane)).all,
              0)
        << type;
  }
}

TEST(ThinPane, CrossingsCountForLampsThatTheSensorSeesThroughIt) {
  const std::string seen =
      camera("origin=\"0, 0, -3\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 2, 64) +
      "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"5\"/></transform><bsdf "
      "type=\"thindielectric\"><float name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/></bsdf></shape>"
      "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"1\"/></emitter>";
  const double through = pane_transmittance(1.5, 0);
  for (const char* type : {"path", "bdpt", "ptracer"}) {
    // The sky that the pane reflects has a path of two segments, too.
    EXPECT_EQ(render(method(type, 1, "") + seen).all, 0) << type;
    const Picture two = render(method(type, 2, "") + seen);
    const double all = std::string(type) == "ptracer" ? through : 1;
    EXPECT_NEAR(two.all, all, 4.5 * two.all_error + 2e-3) << type;
    EXPECT_NEAR(render(method(type, 1, kUncounted) + seen).all, through, 2e-3) << type;
  }
}

TEST(ThinPane, UndeviatedLightOfScatterersIsSampled) {
  // Discs of area fraction f let (1 - f)^2 of the light pass undeviated: the square of the mean amplitude.
  const auto layer = [](const std::string& more) {
    return "<bsdf type=\"correlated_scatterers\"><string name=\"radius\" value=\"20um\"/><float name=\"area_fraction\" value=\"0.3\"/>"
           "<string name=\"scatterer\" value=\"discs\"/>" +
           more + "</bsdf>";
  };
  const double passed = 0.49;
  const std::string pane = layer(
      "<string name=\"substrate\" value=\"thindielectric\"/><float name=\"int_ior\" value=\"1.5\"/>"
      "<float name=\"ext_ior\" value=\"1\"/>");
  const Picture sheet = render(method("path", 2, kUncounted) + scene(layer(""))),
                glass = render(method("path", 2, kUncounted) + scene(pane));
  EXPECT_NEAR(sheet.all, expected(passed), 4.5 * sheet.all_error + 1e-3 * sheet.all);
  EXPECT_NEAR(glass.all, expected(passed * pane_transmittance(1.5, kTilt)),
              4.5 * glass.all_error + 1e-3 * glass.all);
}

}  // namespace
}  // namespace aureole::testing
