// SPDX-License-Identifier: Apache-2.0
// Laws that light in media obeys whatever the method: the balance of a source, exchange of lamp and detector,
// wavelengths by themselves and in company, and shapes that overlap around camera and lamp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "harness/effort.h"
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
  // A point of intensity 1 in the centre of a ball. What leaves falls on a sphere around: directly, exp(-sigma_t),
  // and by scattering. What is absorbed is the integral of sigma_a times the
  // fluence: by the theorem of reciprocity the mean radiance that arrives at the point where the ball shines with
  // an emission of sigma_a and the point does not.
  constexpr double kMeter = 1.05;  // radius of the sphere
  for (const auto& [sigma_a, sigma_s, g] :
       {std::array{0.7, 0.0, 0.0}, {0.4, 1.5, 0.5}, {0.1, 1.5, -0.3}, {0.8, 1.0, 0.6}}) {
    const Picture out = render(
        path() +
        sphere(0, 0, 0, kMeter, "<boolean name=\"flip_normals\" value=\"true\"/>" + kBlack + meter(4096)) +
        ball(kNull, medium(sigma_a, sigma_s, g)) + "<emitter type=\"point\"/>");
    const Picture in = render(path() + "<sensor type=\"radiancemeter\">" + film(1, 512) + "</sensor>" +
                              ball(kNull, medium(sigma_a, sigma_s, g, sigma_a)));
    // E 4 pi R^2 over the power 4 pi.
    const double leaves = out.all * kMeter * kMeter, absorbed = in.all;
    const double error = std::hypot(out.all_error * kMeter * kMeter, in.all_error);
    EXPECT_NEAR(leaves + absorbed, 1, 4.5 * error + 2e-4) << sigma_a << ", " << sigma_s;
    EXPECT_LT(error, 0.02);  // places next to the point are bright and rare
  }
}

TEST(MediaLaws, LampAndDetectorCanBeExchanged) {
  // Two black spheres, A outside and B within a rough body of index n with a medium in it. In equilibrium
  // radiance is as n^2, so that what A sends to B at radiance 1 is n^2 times what B sends to A.
  const double n = 1.5;
  const std::string glass = "<bsdf type=\"roughdielectric\">" + parameter("alpha", 0.3) +
                            parameter("ext_ior", 1) + parameter("int_ior", n) + "</bsdf>";
  const auto flux = [&](bool to_b) {
    const std::string lamp = "<emitter type=\"area\"/>", detector = meter(test::effort(6144, 16384));
    const Picture p =
        render(path() + ball(glass, medium(0.2, 1.1, 0.4)) +
               sphere(0.2, 0.1, -0.3, 0.3, kBlack + (to_b ? detector : lamp)) +
               sphere(1.2, 0.4, 1.1, 0.5, kBlack + (to_b ? lamp : detector)) + sphere(-1.5, 0.3, 0, 0.6, ""));
    const double area = to_b ? 0.09 : 0.25;
    return std::pair{p.all * area, p.all_error * area};
  };
  const auto [to_b, b_error] = flux(true);
  const auto [to_a, a_error] = flux(false);
  const double error = std::hypot(b_error, n * n * a_error);
  EXPECT_NEAR(to_b, n * n * to_a, 4.5 * error);
  EXPECT_LT(error, 0.03 * to_b);
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
  // Three balls within each other, all of them full, of which that of the highest priority counts; and the same
  // as shells, which say what is on either side of them. Paths begin in the right one wherever camera and lamp
  // are.
  const auto rough = [](double outside, double inside) {
    return "<bsdf type=\"roughdielectric\">" + parameter("alpha", 0.5) + parameter("ext_ior", outside) +
           parameter("int_ior", inside) + "</bsdf>";
  };
  const std::array<std::string, 3> media{medium(0.4, 0.8, 0.2), medium(0.1, 1.5), medium(0.6, 0.4, 0.6)};
  const std::array<double, 4> index{1, 1.2, 1.6, 1.3};
  const auto balls = [&](bool by_priority) {
    std::string all;
    for (std::size_t i = 0; i < 3; ++i) {
      std::string content = media[i];
      if (by_priority) {
        content += "<integer name=\"priority\" value=\"" + std::to_string(2 * i + 1) + "\"/>" +
                   rough(1, index[i + 1]);
      } else {
        content += rough(index[i], index[i + 1]);
        if (i > 0) {
          std::string outside = media[i - 1];
          content += outside.replace(outside.find("interior"), 8, "exterior");
        }
      }
      all += sphere(0, 0, 0, 1.2 - 0.4 * double(i), content);
    }
    return all +
           "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"3\"/><translate "
           "z=\"-1.3\"/></transform></shape>";
  };
  const std::array<const char*, 4> places{"1.3, -0.9, 0.8", "-0.9, 0.3, 0.2", "0.2, -0.55, 0.1",
                                          "0.1, 0.2, 0.1"};
  for (std::size_t eye = 0; eye < places.size(); ++eye)
    for (std::size_t step = 1; step <= 3; step += 2) {
      const std::size_t lamp = (eye + step) % places.size();
      const std::string ends =
          "<emitter type=\"point\"><point name=\"position\" value=\"" + std::string(places[lamp]) +
          "\"/></emitter>" +
          camera("origin=\"" + std::string(places[eye]) + "\" target=\"0, 0.1, -0.3\" up=\"0, 1, 0.3\"", 50,
                 2, 64);
      for (const char* integrator : {"path", "ptracer"}) {
        const std::string method = "<integrator type=\"" + std::string(integrator) + "\"/>";
        const Picture a = render(method + balls(true) + ends), b = render(method + balls(false) + ends);
        EXPECT_NEAR(a.all, b.all, 4.5 * std::hypot(a.all_error, b.all_error))
            << integrator << ", camera at place " << eye << ", lamp at " << lamp;
        EXPECT_GT(a.all, 0);
      }
    }
}

}  // namespace
}  // namespace aureole::testing
