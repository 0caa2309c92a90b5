// SPDX-License-Identifier: Apache-2.0
// Media in films that are hardly thicker than the offsets of rays from surfaces: their optical thickness counts from surface to surface.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

constexpr double kThickness = 20e-6, kOpticalThickness = 1.612;  // of a film that is 2 m wide
const double kExtinction = kOpticalThickness / kThickness;

/// A film across z, turned about x by `angle` degrees.
std::string film_shape(const std::string& content, double angle = 0) {
  return "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"1\" y=\"1\" z=\"" +
         number(kThickness / 2) + "\"/><rotate x=\"1\" angle=\"" + number(angle) + "\"/></transform>" +
         kNull + content + "</shape>";
}

/// Parallel rays through the middle of the film.
std::string beam(int samples) {
  return "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale x=\"0.2\" y=\"0.2\"/>"
         "<lookat origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>" +
         film(2, samples) + "</sensor>";
}

TEST(ThinFilm, TransmitsByItsWholeThickness) {
  for (const double angle : {0.0, 60.0}) {
    const double expected = std::exp(-kOpticalThickness / std::cos(angle * std::numbers::pi / 180));
    const std::string scene = beam(2048) + film_shape(medium(kExtinction, 0), angle) + kSky;
    expect_mean(render(path() + scene), expected, 0.02);
    // By transmittance, without noise.
    const Picture direct = render("<integrator type=\"direct\"/>" + scene);
    EXPECT_NEAR(direct.all, expected, 0.002 * expected) << angle;
  }
}

TEST(ThinFilm, ConnectionsPassItsWholeThickness) {
  // A floor far below the film, irradiated through it.
  const std::string
      floor =
          "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"0.3\"/><translate z=\"-3\"/></transform>"
          "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"1\"/></bsdf></shape>",
      sun =
          "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"0\" z=\"-1\"/>"
          "<spectrum name=\"irradiance\" value=\"1\"/></emitter>",
      sensor =
          "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale x=\"0.2\" y=\"0.2\"/>"
          "<lookat origin=\"0, 0, -1\" target=\"0, 0, -3\" up=\"0, 1, 0\"/></transform>" +
          film(1, 256) + "</sensor>",
      lamp =
          "<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"0\" z=\"40\"/>"
          "<spectrum name=\"intensity\" value=\"1000\"/></emitter>";
  for (const std::string& light : {sun, lamp}) {
    const double open = render(path() + sensor + floor + light).all,
                 covered = render(path() + sensor + floor + light + film_shape(medium(kExtinction, 0))).all;
    EXPECT_NEAR(covered / open, std::exp(-kOpticalThickness), 0.002 * std::exp(-kOpticalThickness));
  }
}

TEST(ThinFilm, ScattersByItsWholeThickness) {
  // A film is a slab: scaled to the thickness of its width, it has the same albedo under a uniform sky.
  const std::string thick =
      "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"1e5\" y=\"1e5\" z=\"1\"/></transform>" +
      kNull + medium(0.25 * kOpticalThickness, 0.25 * kOpticalThickness) + "</shape>";
  const Picture film = render(path() + beam(1024) + film_shape(medium(0.5 * kExtinction, 0.5 * kExtinction)) +
                              kSky),
                slab = render(path() + beam(1024) + thick + kSky);
  EXPECT_NEAR(film.all, slab.all, 4 * std::hypot(film.all_error, slab.all_error));
  EXPECT_LT(film.all_error, 0.01 * film.all);
}

}  // namespace
}  // namespace aureole::testing
