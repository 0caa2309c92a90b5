// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/optics/mie.h"
#include "aureole/optics/sphere_layer.h"
#include "aureole/optics/structure_factor.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::BsdfCase;
using testing::BsdfCases;

std::string spheres(const std::string& radius, double area_fraction, double index,
                    const std::string& more = "") {
  return R"(<bsdf type="correlated_spheres"><string name="radius" value=")" + radius +
         R"("/><float name="area_fraction" value=")" + std::to_string(area_fraction) +
         R"("/><float name="int_ior" value=")" + std::to_string(index) +
         R"("/><float name="ext_ior" value="1"/>)" + more + "</bsdf>";
}

// Lobes are as narrow as wavelength over radius around the way straight on.
std::function<void(BsdfCase&)> spheres_case(double angle, bool lossless) {
  return [=](BsdfCase& c) {
    c.lossless = lossless;
    c.focus = [](const Vec3& wi) { return std::vector<Vec3>{-wi}; };
    c.focus_angle = angle;
  };
}
BsdfCase harness_case(const char* name, const std::string& xml, double angle, bool lossless) {
  BsdfCase c;
  c.name = name, c.xml = xml;
  spheres_case(angle, lossless)(c);
  return c;
}
const BsdfCases kSpheres("correlated_spheres",
                         [](BsdfCase& c) { spheres_case(0.01, c.name == "correlated_spheres_example_1")(c); },
                         {harness_case("correlated_spheres_dense", spheres("5um", 0.7, 1.33), 0.006, true),
                          harness_case("correlated_spheres_large", spheres("60um", 0.5, 1.5), 0.001, true),
                          harness_case("correlated_spheres_tiny", spheres("80nm", 0.3, 2.4), 0.1, true),
                          harness_case("correlated_spheres_bubbles", spheres("1um", 0.4, 0.75), 0.02, true),
                          harness_case("correlated_spheres_gold", R"(<bsdf type="correlated_spheres">
         <string name="radius" value="300nm"/><float name="area_fraction" value="0.3"/>
         <string name="int_ior" value="Au"/></bsdf>)",
                                       0.05, false)});

}  // namespace
}  // namespace aureole
