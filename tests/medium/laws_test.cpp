// SPDX-License-Identifier: Apache-2.0
// Laws that light in media obeys whatever the method: the balance of a source, exchange of lamp and detector,
// wavelengths by themselves and in company, and shapes that overlap around camera and lamp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

std::string sphere(double x, double y, double z, double radius, const std::string& content) {
  return "<shape type=\"sphere\"><point name=\"center\" x=\"" + number(x) + "\" y=\"" + number(y) +
         "\" z=\"" + number(z) + "\"/>" + parameter("radius", radius) + content + "</shape>";
}
const std::string kBlack = "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0\"/></bsdf>";
std::string meter(int samples) {
  return "<sensor type=\"irradiancemeter\">" + film(1, samples) + "</sensor>";
}

TEST(MediaLaws, WhatAPointSendsIsAbsorbedOrLeaves) {
  // A point of intensity 1 in the centre of a ball. What leaves falls on a sphere around. What is absorbed is
  // the integral of sigma_a times the fluence: by the theorem of reciprocity 4 pi times the mean radiance that
  // arrives at the point where the ball shines with an emission of sigma_a and the point does not.
  for (const auto& [sigma_a, sigma_s, g] :
       {std::array{0.7, 0.0, 0.0}, {0.4, 1.5, 0.5}, {0.1, 4.0, -0.3}, {2.0, 3.0, 0.8}}) {
    const Picture out =
        render(path() +
               sphere(0, 0, 0, 3, "<boolean name=\"flip_normals\" value=\"true\"/>" + kBlack + meter(16384)) +
               ball(kNull, medium(sigma_a, sigma_s, g)) + "<emitter type=\"point\"/>");
    const Picture in =
        render(path() + camera("origin=\"0, 0, 0\" target=\"1, 0.2, 0.1\" up=\"0, 0, 1\"", 60, 4, 64) +
               ball(kNull, medium(sigma_a, sigma_s, g, sigma_a)));
    // E 4 pi R^2 over the power 4 pi.
    const double leaves = out.all * 9, absorbed = in.all;
    const double error = std::hypot(out.all_error * 9, in.all_error);
    EXPECT_NEAR(leaves + absorbed, 1, 4.5 * error + 2e-4) << sigma_a << ", " << sigma_s;
    EXPECT_LT(error, 0.01);
    if (sigma_s == 0) {
      EXPECT_NEAR(leaves, std::exp(-sigma_a), 4.5 * out.all_error * 9 + 2e-4);
    }
  }
}

TEST(MediaLaws, LampAndDetectorCanBeExchanged) {
  // Two black spheres, A outside and B within a rough body of index n with a medium in it. In equilibrium
  // radiance is as n^2, so that what A sends to B at radiance 1 is n^2 times what B sends to A.
  const double n = 1.5;
  const std::string glass = "<bsdf type=\"roughdielectric\">" + parameter("alpha", 0.3) +
                            parameter("ext_ior", 1) + parameter("int_ior", n) + "</bsdf>";
  const auto flux_to_b = [&](bool forward, const std::string& integrator) {
    const std::string lamp = "<emitter type=\"area\"/>", detector = meter(integrator == "path" ? 4096 : 8192);
    const Picture p = render(
        "<integrator type=\"" + integrator + "\"/>" + ball(glass, medium(0.2, 1.1, 0.4)) +
        sphere(0.2, 0.1, -0.3, 0.3, kBlack + (forward ? detector : lamp)) +
        sphere(1.2, 0.4, 1.1, 0.5, kBlack + (forward ? lamp : detector)) + sphere(-1.5, 0.3, 0, 0.6, ""));
    const double area = forward ? 0.09 : 0.25;
    return std::pair{p.all * area, p.all_error * area};
  };
  for (const char* integrator : {"path", "ptracer"}) {
    const auto [to_b, b_error] = flux_to_b(true, integrator);
    const auto [to_a, a_error] = flux_to_b(false, integrator);
    const double error = std::hypot(b_error, n * n * a_error);
    EXPECT_NEAR(to_b, n * n * to_a, 4.5 * error) << integrator;
    EXPECT_LT(error, 0.03 * to_b) << integrator;
  }
}

TEST(MediaLaws, AWavelengthByItselfIsTheSameInCompany) {
  // The middle of three bands of a film from 400 to 700 nm, and a film of that band alone.
  const auto scene = [](const std::string& film) {
    return path() + "<sensor type=\"perspective\">" + parameter("fov", 30) +
           "<transform name=\"to_world\"><lookat origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, "
           "0\"/></transform><sampler type=\"sobol\"><integer name=\"sample_count\" value=\"512\"/></sampler>" +
           film +
           "<integer name=\"width\" value=\"2\"/><integer name=\"height\" value=\"2\"/><rfilter "
           "type=\"box\"/></film></sensor>" +
           ball(kNull,
                "<medium type=\"homogeneous\" name=\"interior\"><spectrum name=\"sigma_t\" value=\"400:40, "
                "545:2, 555:2, 700:0.05\"/><spectrum name=\"albedo\" value=\"400:0.2, 700:0.9\"/></medium>") +
           sphere(0.8, 0.9, 1.6, 0.2,
                  "<emitter type=\"area\"><spectrum name=\"radiance\" value=\"30\"/></emitter>") +
           "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"1\"/></emitter>";
  };
  const Picture alone =
      render(scene("<film type=\"specfilm\"><string name=\"bin_edges\" value=\"545, 555\"/>"));
  const Picture among =
      render(scene("<film type=\"specfilm\"><string name=\"bin_edges\" value=\"400, 545, 555, 700\"/>"));
  const double error = std::hypot(alone.all_error, among.all_error);
  EXPECT_NEAR(alone.all, among.all, 4.5 * error);
  EXPECT_LT(error, 0.02 * alone.all);
}

TEST(MediaLaws, CameraAndLampInAnyOfSeveralOverlappingShapes) {
  // Three balls that overlap: whichever of their parts camera and lamp are in, paths from the camera and paths
  // from the lamp agree, and so does the medium that a look says they begin in.
  const std::string rough = "<bsdf type=\"roughdielectric\">" + parameter("alpha", 0.5);
  const auto shape = [&](double x, int priority, const std::string& bsdf, const std::string& content) {
    return sphere(x, 0, 0, 1,
                  "<integer name=\"priority\" value=\"" + std::to_string(priority) + "\"/>" + bsdf + content);
  };
  const std::string scene =
      shape(-0.7, 1, kNull, medium(0.4, 0.8, 0.2)) +
      shape(0, 3, rough + parameter("int_ior", 1.3) + "</bsdf>", medium(0.1, 1.5)) +
      shape(0.7, 2, rough + parameter("int_ior", 1.6) + "</bsdf>", medium(0.6, 0.4, 0.6)) +
      "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"3\"/><translate "
      "z=\"-1.2\"/></transform></shape>";
  // In the first alone; in all three; in the first two; in the third alone; outside.
  const std::array<std::array<double, 3>, 5> places{
      {{-1.4, 0.1, 0.1}, {0.05, 0.1, 0.3}, {-0.6, 0.2, 0.3}, {1.4, 0.1, 0.1}, {0.2, -1.8, 0.6}}};
  for (std::size_t eye = 0; eye < places.size(); ++eye) {
    const std::size_t lamp = (eye + 2) % places.size();
    const auto at = [](const std::array<double, 3>& p) {
      return number(p[0]) + ", " + number(p[1]) + ", " + number(p[2]);
    };
    const std::string all =
        scene + "<emitter type=\"point\"><point name=\"position\" value=\"" + at(places[lamp]) +
        "\"/></emitter>" +
        camera("origin=\"" + at(places[eye]) + "\" target=\"0, 0.1, -0.3\" up=\"0, 1, 0.3\"", 50, 2, 256);
    const Picture a = render(path() + all), b = render("<integrator type=\"ptracer\"/>" + all);
    const double error = std::hypot(a.all_error, b.all_error);
    EXPECT_NEAR(a.all, b.all, 4.5 * error) << "camera at place " << eye;
    EXPECT_LT(error, 0.06 * a.all) << "camera at place " << eye;
  }
}

}  // namespace
}  // namespace aureole::testing
