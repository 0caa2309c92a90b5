// SPDX-License-Identifier: Apache-2.0
// Media behind rough interfaces: all integrators keep the light, where the answer is known from its balance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

std::string rough(double alpha, double n, bool energy_preserving = true) {
  return "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"ggx\"/>" +
         parameter("alpha", alpha) + parameter("ext_ior", 1) + parameter("int_ior", n) +
         "<boolean name=\"energy_preserving\" value=\"" + (energy_preserving ? "true" : "false") +
         "\"/></bsdf>";
}
std::string by(const std::string& integrator) { return "<integrator type=\"" + integrator + "\"/>"; }
std::string towards_ball(int samples) {
  return camera("origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 20, 2, samples);
}

TEST(RoughBoundary, TwoWayPathsKeepTheFurnace) {
  for (const auto& [alpha, n] : {std::pair{0.1, 1.33}, {0.4, 1.5}, {0.8, 1.33}})
    expect_mean(render(by("bdpt") + towards_ball(96) + ball(rough(alpha, n), medium(0, 1.5, 0.6)) + kSky), 1,
                0.03);
}

TEST(RoughBoundary, WhatSingleScatteringByFacetsLosesIsTheSame) {
  // Facets that scatter once lose a third of the furnace's light at this roughness, by any integrator.
  const std::string scene = ball(rough(0.4, 1.5, false), medium(0, 1.5, 0.6)) + kSky;
  const Picture a = render(path() + towards_ball(256) + scene),
                b = render(by("bdpt") + towards_ball(64) + scene);
  const double error = std::hypot(a.all_error, b.all_error);
  EXPECT_NEAR(a.all, b.all, 4.5 * error);
  EXPECT_LT(error, 0.03);
  EXPECT_LT(a.all, 0.8);
}

TEST(RoughBoundary, AllThatALampSendsLeavesTheBall) {
  // From any side a ball with a lamp of intensity 1 in its centre has the intensity 1 where nothing absorbs, whatever
  // scatters in it: a mean radiance of 1/4 over a square of area 4. `path` finds a point in a medium by chance of
  // scattering near it, without a variance, so its lamp has a size.
  const std::string milk = ball(rough(0.4, 1.5), medium(0, 2, 0.6));
  for (const auto& [integrator, samples] : {std::pair{"ptracer", 128}, {"bdpt", 20}})
    expect_mean(render(by(integrator) + parallel(8, samples) + milk + "<emitter type=\"point\"/>"), 0.25,
                0.03);
  const double radius = 0.3;
  const std::string lamp =
      "<shape type=\"sphere\">" + parameter("radius", radius) + kNull + "<emitter type=\"area\">" +
      parameter("radiance", 1 / (std::numbers::pi * radius * radius)) + "</emitter></shape>";
  expect_mean(render(path() + parallel(8, 64) + milk + lamp), 0.25, 0.03);
}

}  // namespace
}  // namespace aureole::testing
