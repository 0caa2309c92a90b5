// SPDX-License-Identifier: Apache-2.0
// Edges beside the legs of paths between planar mirrors and through panes: the diffraction model "segments" against
// Fresnel's integrals at the distances of the unfolded path, and against scenes that are unfolded.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "aureole/optics/faddeeva.h"
#include "harness/effort.h"
#include "harness/rendered.h"

namespace aureole::testing {
namespace {

using Amplitude = std::complex<double>;
constexpr double kGreen = 550e-9;
const char* const kAbsorbs =
    R"(<bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)";
const char* const kReflects =
    R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>)";

/// A rectangle of the given half sizes, turned about the y axis and placed at y = 0.
std::string turned(double half_x, double half_y, double angle, double x, double z, const std::string& bsdf) {
  return fmt::format(
             R"(<shape type="rectangle"><transform name="to_world"><scale x="{}" y="{}"/><rotate y="1" angle="{}"/>
    <translate x="{}" z="{}"/></transform>)",
             half_x, half_y, angle, x, z) +
         bsdf;
}
/// A mirror at the origin that turns light along x upwards, along z.
std::string lower_mirror(double half = 0.4) { return turned(half, half, -45, 0, 0, kReflects); }

/// A camera without extent at x = -before that looks along x, by way of mirrors, at a light; the mean over its picture is
/// |u/u0|^2. Its field of view has the given half width at the distance 1.
struct Periscope {
  double before;
  std::string shapes;
  int samples = 1;
  double half = 5e-6;
  int columns = 1;
  std::string integrator = "path";
  double rise = 0;  ///< of the direction in which it looks, per distance along x
  std::string polarisation = "none";

  Picture picture() const {
    return render(fmt::format(
                      R"(<integrator type="{}"><boolean name="diffraction" value="true"/>
    <string name="diffraction_polarisation" value="{}"/></integrator>
  <sensor type="perspective"><float name="fov" value="{}"/><float name="near_clip" value="1e-4"/>
    <transform name="to_world"><lookat origin="-{}, 0, 0" target="0, 0, {}" up="0, 1, 0"/></transform>
    <film type="specfilm"><integer name="width" value="{}"/><integer name="height" value="1"/><rfilter type="box"/>
      <float name="wavelength_min" value="549.9"/><float name="wavelength_max" value="550.1"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>)",
                      integrator, polarisation, 2 * std::atan(half) * 180 / M_PI, before, rise * before,
                      columns, test::kSanitized ? 1 : samples) +
                  shapes);
  }
  double loss(const std::string& obstacles, double* error = nullptr) const {
    Periscope with = *this;
    with.shapes += obstacles;
    const Picture p = with.picture();
    if (error) *error = 10 / std::log(10.0) * p.error[0] / p.mean[0];
    return -10 * std::log10(p.mean[0]);
  }
};
/// A light of radiance 1 that faces down, at the height z.
std::string ceiling(double z) {
  return turned(0.5, 0.5, 180, 0, z,
                R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)");
}
/// A half plane below the height h at x, across light along x that runs at the height z.
std::string across_x(double x, double h, double z = 0) {
  return turned((h + 0.3) / 2, 1, 90, x, z + (h - 0.3) / 2, kAbsorbs);
}
/// A half plane up to x = h at the height z, across light along z.
std::string across_z(double z, double h) { return turned((h + 0.3) / 2, 1, 0, (h - 0.3) / 2, z, kAbsorbs); }
/// The distance on a sheet that is 1 in v, for distances before and behind it.
double unit_of_v(double r1, double r2) { return std::sqrt(kGreen * r1 * r2 / (2 * (r1 + r2))); }

struct Loss {
  double v, loss;
};
/// Losses of ITU-R P.526 at Fresnel's v in the shadow.
constexpr Loss kLosses[] = {{0, 6.02},  {1, 13.86},  {2, 19.09}, {5, 26.94},
                            {8, 31.02}, {-1, -1.00}, {-2, 0.74}};

// The distances of the unfolded path count, for an edge before the mirror and for one behind it, also just beside the mirror.
TEST(MirrorDiffraction, KnifeEdgesBesideBothLegs) {
  const Periscope periscope{1, lower_mirror() + ceiling(1), 2048};
  for (const double off : {0.5, 0.02})
    for (const bool is_before : {true, false}) {
      const double r1 = is_before ? 1 - off : 1 + off, unit = unit_of_v(r1, 2 - r1);
      double worst = 0;
      for (const auto& [v, loss] : kLosses) {
        double error;
        const double measured =
            periscope.loss(is_before ? across_x(-off, v * unit) : across_z(off, v * unit), &error);
        if (test::kSanitized) continue;
        worst = std::max(worst, std::abs(measured - loss));
        EXPECT_LT(error, 0.05) << v;
        EXPECT_NEAR(measured, loss, 0.1) << off << " " << is_before << " " << v;
      }
      std::printf("edge %g m %s a mirror: largest error %.3f dB\n", off, is_before ? "before" : "behind",
                  worst);
    }
}

TEST(MirrorDiffraction, KnifeEdgesBetweenTwoMirrors) {
  const std::string upper = turned(0.4, 0.4, 135, 0, 1, kReflects);
  const std::string light = turned(
      0.5, 0.5, -90, 1, 1, R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)");
  const Periscope periscope{1, lower_mirror() + upper + light, 2048};
  for (const int leg : {0, 1, 2}) {
    const double r1 = leg + 0.5, unit = unit_of_v(r1, 3 - r1);
    double worst = 0;
    for (const auto& [v, loss] : kLosses) {
      const double h = v * unit;
      const double measured = periscope.loss(leg == 0   ? across_x(-0.5, h)
                                             : leg == 1 ? across_z(0.5, h)
                                                        : across_x(0.5, h, 1));
      if (test::kSanitized) continue;
      worst = std::max(worst, std::abs(measured - loss));
      EXPECT_NEAR(measured, loss, 0.1) << leg << " " << v;
    }
    std::printf("edge on leg %d of three: largest error %.3f dB\n", leg + 1, worst);
  }
}

// Seven reflections between two mirrors exceed what one chain holds: its factor is kept when the next one begins.
TEST(MirrorDiffraction, ManyReflections) {
  // The path falls and rises by 0.2 in 1, between the heights -0.05 and 0.05, and ends 3.5 m from the camera.
  const double slope = std::hypot(1.0, 0.2);
  const std::string floor = turned(3, 1, 0, 1.5, -0.05, kReflects),
                    roof = turned(3, 1, 180, 1.5, 0.05, kReflects);
  const std::string light =
      turned(0.5, 0.5, -90, 2.5, 0,
             R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)");
  const Periscope periscope{1, floor + roof + light, 2048, 5e-6, 1, "path", -0.2};
  EXPECT_NEAR(periscope.loss(""), 0, 0.05);
  for (const auto& [v, loss] : kLosses) {
    // The sheet stands on the floor, 0.1 m from the camera, where the path is 0.02 m below the camera.
    const double h = -0.02 + v * unit_of_v(0.1 * slope, 2.9 * slope) * slope;
    const double measured = periscope.loss(turned((h + 0.05) / 2, 1, 90, -0.9, (h - 0.05) / 2, kAbsorbs));
    if (test::kSanitized) continue;
    EXPECT_NEAR(measured, loss, 0.15) << v;
  }
}

// The direction of the sampled lobe counts, not the kind of the surface: glass, and a coating on a black base.
TEST(MirrorDiffraction, SurfacesThatReflectPartOfTheLight) {
  for (const char* bsdf :
       {R"(<bsdf type="dielectric"/></shape>)",
        R"(<bsdf type="plastic"><spectrum name="diffuse_reflectance" value="0"/></bsdf></shape>)"}) {
    const Periscope periscope{1, turned(0.4, 0.4, -45, 0, 0, bsdf) + ceiling(1), 16384};
    const double free = periscope.loss("");
    for (const auto& [v, loss] : {Loss{-1, -1.00}, Loss{-2, 0.74}})
      for (const bool is_before : {true, false}) {
        const double h = v * unit_of_v(is_before ? 0.9 : 1.1, is_before ? 1.1 : 0.9);
        const double measured = periscope.loss(is_before ? across_x(-0.1, h) : across_z(0.1, h)) - free;
        if (test::kSanitized) continue;
        EXPECT_NEAR(measured, loss, 0.15) << bsdf << " " << v;
      }
  }
}

// A pane between the edge and the mirror, or between the edge and the light without a mirror, changes nothing.
TEST(MirrorDiffraction, PanesDoNotEndSegments) {
  const std::string pane = turned(0.2, 0.2, 90, -0.2, 0, R"(<bsdf type="thindielectric"/></shape>)");
  const std::string light = turned(
      0.5, 0.5, -90, 1, 0, R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)");
  for (const bool has_mirror : {true, false}) {
    const Periscope periscope{1, pane + (has_mirror ? lower_mirror() + ceiling(1) : light), 2048};
    const double free = periscope.loss("");
    double worst = 0;
    for (const auto& [v, loss] : kLosses) {
      const double measured = periscope.loss(across_x(-0.25, v * unit_of_v(0.75, 1.25))) - free;
      if (test::kSanitized) continue;
      worst = std::max(worst, std::abs(measured - loss));
      EXPECT_NEAR(measured, loss, 0.1) << has_mirror << " " << v;
    }
    std::printf("edge before a pane, %s a mirror: largest error %.3f dB\n", has_mirror ? "with" : "without",
                worst);
  }
}

// A sheet that light crosses straight, but that is no null surface, ends a segment: edges count with the distance up to
// it.
TEST(MirrorDiffraction, SheetsThatAreNoNullSurfacesEndSegments) {
  const std::string light = turned(
      0.5, 0.5, -90, 1, 0, R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)");
  const std::string sheet = turned(
      0.2, 0.2, 90, 0, 0,
      R"(<bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/></bsdf></shape>)");
  const Periscope periscope{1, sheet + light, 2048};
  const double free = periscope.loss("");
  for (const auto& [v, loss] : kLosses) {
    const double measured = periscope.loss(across_x(-0.5, v * unit_of_v(0.5, 0.5))) - free;
    if (!test::kSanitized) EXPECT_NEAR(measured, loss, 0.1) << v;
  }
}

TEST(MirrorDiffraction, SlitsBeforeAndBehindAMirror) {
  const double width = 0.4e-3, half = 2e-3;
  constexpr int kColumns = 32;
  const auto amplitude = [](double a, double b) {
    return Amplitude(0.5, -0.5) * (optics::fresnel_integral(b) - optics::fresnel_integral(a));
  };
  for (const bool is_before : {true, false}) {
    const auto plate = [&](double a, double b) {
      return is_before ? turned((b - a) / 2, 1, 90, -0.25, (a + b) / 2, kAbsorbs)
                       : turned((b - a) / 2, 1, 0, (a + b) / 2, 0.25, kAbsorbs);
    };
    const double r1 = is_before ? 0.75 : 1.25, unit = unit_of_v(r1, 2 - r1);
    const Picture p =
        Periscope{1, lower_mirror() + ceiling(1) + plate(-0.2, -width / 2) + plate(width / 2, 0.2), 512, half,
                  kColumns}
            .picture();
    if (test::kSanitized) continue;
    double worst = 0;
    for (int i = 0; i < kColumns; ++i) {
      double expected = 0;
      constexpr int kSub = 16;
      for (int k = 0; k < kSub; ++k) {
        const double on_sheet = r1 * half * (2 * (i + (k + 0.5) / kSub) / kColumns - 1);
        expected +=
            std::norm(amplitude((-width / 2 - on_sheet) / unit, (width / 2 - on_sheet) / unit)) / kSub;
      }
      EXPECT_LT(std::abs(p.mean[std::size_t(i)] - expected), 4.5 * p.error[std::size_t(i)] + 0.02 * expected)
          << is_before << " " << i;
      worst = std::max(worst, std::abs(p.mean[std::size_t(i)] - expected));
    }
    std::printf("slit %s a mirror: largest error of a cell %.4f of the light\n",
                is_before ? "before" : "behind", worst);
  }
}

/// The field behind half planes below h1, 1.5 - s from a point, and below h2, 2 s behind it, at a point 1.5 - s behind that: the
/// field of the first one in the plane of the second, integrated.
Amplitude behind_both(double h1, double h2, double s) {
  const double r = 1.5 - s, between = 2 * s, to_second = r + between;
  const double per_second = std::sqrt(2 / kGreen * (1 / to_second + 1 / r));
  const double per_first = std::sqrt(2 / kGreen * (1 / r + 1 / between));
  constexpr int kSteps = 20000;
  constexpr double kReach = 80;
  Amplitude sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double q = (i + 0.5) / kSteps, t = h2 * per_second + q * kReach;
    const double fades = std::max(0.0, q - 0.5) / 0.16;
    const double height = t / per_second * r / to_second - h1;
    sum += std::polar(kReach / kSteps * std::exp(-std::pow(fades, 4)), M_PI / 2 * t * t) *
           optics::knife_edge_field(height * per_first);
  }
  return Amplitude(0.5, -0.5) * sum;
}

// An edge on each side of the mirror: both act together, as edges one behind the other do. The product of both would be up to
// 3 dB off.
TEST(MirrorDiffraction, EdgesOnBothSidesOfAMirror) {
  const Periscope periscope{1.5, lower_mirror() + ceiling(1.5), 2048};
  for (const double s : {0.5, 0.05})
    for (const auto& [h1, h2] :
         {std::pair(0.3e-3, 0.3e-3), {0.3e-3, -0.2e-3}, {-0.2e-3, 0.3e-3}, {-0.3e-3, -0.3e-3}}) {
      const double measured = periscope.loss(across_x(-s, h1) + across_z(s, h2));
      if (test::kSanitized) continue;
      const double expected = -10 * std::log10(std::norm(behind_both(h1, h2, s)));
      std::printf("edges %g m before and behind a mirror: %.2f dB, expected %.2f\n", s, measured, expected);
      EXPECT_NEAR(measured, expected, 0.2) << s << " " << h1 << " " << h2;
    }
}

// Behind a mirror left and right are exchanged: wedges of metal with a polarisation, and three edges one behind the other, act as
// those of the unfolded scene.
TEST(MirrorDiffraction, WedgesAndRowsAreThoseOfTheUnfoldedScene) {
  const auto block = [](double x0, double x1, double z0, double z1) {
    return fmt::format(
               R"(<shape type="cube"><transform name="to_world"><scale x="{}" z="{}"/><translate x="{}" z="{}"/></transform>)",
               (x1 - x0) / 2, (z1 - z0) / 2, (x0 + x1) / 2, (z0 + z1) / 2) +
           kReflects;
  };
  const double h = unit_of_v(1.4, 0.6), low = 1e-4;
  const struct {
    const char* polarisation;
    std::string mirrored, unfolded;
  } kCases[] = {
      {"none", block(-0.3, h, 0.4, 0.5), block(0.4, 0.5, -0.3, h)},
      {"soft", block(-0.3, 2 * h, 0.4, 0.5), block(0.4, 0.5, -0.3, 2 * h)},
      {"hard", block(-0.3, 2 * h, 0.4, 0.5), block(0.4, 0.5, -0.3, 2 * h)},
      {"none", across_x(-0.6, low) + across_z(0.2, low) + across_z(0.4, low / 2),
       across_x(-0.6, low) + across_x(0.2, low) + across_x(0.4, low / 2)},
  };
  const std::string light = turned(
      0.5, 0.5, -90, 1, 0, R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)");
  for (const auto& [polarisation, mirrored, unfolded] : kCases) {
    Periscope periscope{1, lower_mirror() + ceiling(1), 4096};
    periscope.polarisation = polarisation;
    const double measured = periscope.loss(mirrored);
    periscope.shapes = light;
    const double expected = periscope.loss(unfolded);
    if (test::kSanitized) continue;
    std::printf("%s: %.2f dB by way of a mirror, %.2f dB unfolded\n", polarisation, measured, expected);
    EXPECT_NEAR(measured, expected, 0.25) << polarisation;
  }
}

TEST(MirrorDiffraction, LightOfTheSky) {
  const Periscope periscope{
      1, lower_mirror() + R"(<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>)",
      2048};
  for (const bool is_before : {true, false}) {
    double worst = 0;
    for (const auto& [v, loss] : kLosses) {
      const double r1 = is_before ? 0.5 : 1.5, h = v * std::sqrt(kGreen * r1 / 2);
      const double measured = periscope.loss(is_before ? across_x(-0.5, h) : across_z(0.5, h));
      if (test::kSanitized) continue;
      worst = std::max(worst, std::abs(measured - loss));
      EXPECT_NEAR(measured, loss, 0.1) << is_before << " " << v;
    }
    std::printf("sky, edge %s a mirror: largest error %.3f dB\n", is_before ? "before" : "behind", worst);
  }
}

// Paths of `bdpt` end at obstacles: light in the shadow of an edge before or behind a mirror is left to the others.
TEST(MirrorDiffraction, BdptHasFringes) {
  Periscope periscope{1, lower_mirror() + ceiling(1), 1024};
  periscope.integrator = "bdpt";
  for (const bool is_before : {true, false})
    for (const auto& [v, loss] : {Loss{-1, -1.00}, Loss{-2, 0.74}}) {
      const double h = v * unit_of_v(is_before ? 0.8 : 1.2, is_before ? 1.2 : 0.8);
      const double measured = periscope.loss(is_before ? across_x(-0.2, h) : across_z(0.2, h));
      if (test::kSanitized) continue;
      EXPECT_NEAR(measured, loss, 0.1) << is_before << " " << v;
    }
}

// Light paths: a lamp without extent 10 m before a mirror, and a receiver or a white screen 10 m behind it, at a wavelength of
// 1 mm. Light on the receiver is counted where it passes, light on the screen by connections with a camera.
TEST(MirrorDiffraction, LampsWithoutExtentByWayOfMirrors) {
  constexpr double kMillimetre = 1e-3, kCell = 0.03;
  const std::string film = fmt::format(
      R"(<film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/>
      <string name="wavelength_min" value="0.9999mm"/><string name="wavelength_max" value="1.0001mm"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>)",
      test::kSanitized ? 1 : 8192);
  const std::string receiver = fmt::format(
      R"(<sensor type="powermap"><transform name="to_world"><scale value="{}"/><rotate x="1" angle="180"/><translate z="10"/></transform>)",
      kCell / 2);
  const std::string camera = fmt::format(
      R"(<sensor type="orthographic"><transform name="to_world"><scale value="{}"/>
    <lookat origin="0, 0, 9.9" target="0, 0, 10" up="0, 1, 0"/></transform>)",
      kCell / 2);
  const std::string screen = turned(
      1, 1, 180, 0, 10, R"(<bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>)");
  const auto power = [&](const std::string& integrator, bool has_screen, const std::string& obstacle,
                         double& error) {
    const Picture p = render(fmt::format(
                                 R"(<integrator type="{}"><boolean name="diffraction" value="true"/>
    <integer name="max_depth" value="3"/></integrator>
  <emitter type="spot"><spectrum name="intensity" value="1"/><float name="cutoff_angle" value="0.3"/><float name="beam_width" value="0.29"/>
    <transform name="to_world"><lookat origin="-10, 0, 0" target="0, 0, 0" up="0, 1, 0"/></transform></emitter>)",
                                 integrator) +
                             (has_screen ? camera : receiver) + film + (has_screen ? screen : "") +
                             turned(4, 4, -45, 0, 0, kReflects) + obstacle);
    error = p.error[0] / p.mean[0];
    return p.mean[0];
  };
  const struct {
    const char* integrator;
    bool has_screen;
    double v;
  } kCases[] = {
      {"ptracer", false, 1}, {"ptracer", false, -1.2}, {"ptracer", true, -1.2}, {"bdpt", true, -1.2}};
  for (const auto& [integrator, has_screen, v] : kCases) {
    double free_error;
    const double free = power(integrator, has_screen, "", free_error);
    for (const bool is_before : {true, false}) {
      // 1 m behind the lamp, or 1 m before the receiver.
      const double unit = std::sqrt(kMillimetre * 19 / 40), h = v * unit;
      const std::string sheet = is_before ? turned((h + 8) / 2, 40, 90, -9, (h - 8) / 2, kAbsorbs)
                                          : turned((h + 8) / 2, 40, 0, (h - 8) / 2, 9, kAbsorbs);
      double error;
      const double measured = power(integrator, has_screen, sheet, error) / free;
      if (test::kSanitized) continue;
      error = std::hypot(error, free_error);
      double expected = 0;
      constexpr int kSub = 32;
      for (int k = 0; k < kSub; ++k) {
        const double on_sheet = kCell * ((k + 0.5) / kSub - 0.5) * (is_before ? 0.05 : 0.95);
        expected += optics::knife_edge_intensity((on_sheet - h) / unit) / kSub;
      }
      std::printf("%s, %s, sheet %s a mirror, v = %g: %.4f +- %.4f, expected %.4f\n", integrator,
                  has_screen ? "screen" : "receiver", is_before ? "before" : "behind", v, measured,
                  error * measured, expected);
      EXPECT_LT(error, 0.05);
      EXPECT_LT(std::abs(measured / expected - 1), 4.5 * error + 0.015) << is_before << " " << v;
    }
  }
}

// A lamp at infinity, at 3 GHz: with the mirror by `ptracer`, and unfolded by `path`.
TEST(MirrorDiffraction, LampsAtInfinityByWayOfMirrors) {
  const auto scene = [&](const std::string& integrator, int samples, const std::string& rest) {
    return render(
        fmt::format(R"(<integrator type="{}"><boolean name="diffraction" value="true"/></integrator>
  <emitter type="directional"><vector name="direction" x="1" y="0" z="0"/><spectrum name="irradiance" value="1"/></emitter>)",
                    integrator) +
        fmt::format(
            fmt::runtime(rest),
            fmt::format(
                R"(<film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
      <string name="wavelength_min" value="3.0001GHz"/><string name="wavelength_max" value="2.9999GHz"/><rfilter type="box"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>)",
                test::kSanitized ? 1 : samples)));
  };
  // A receiver of 2 x 4 m, its middle at the height of the border of the sheet.
  const std::string sheet = turned(2, 8, 90, -8, -2, kAbsorbs);
  const Picture mirrored = scene(
      "ptracer", 65536,
      R"(<sensor type="powermap"><transform name="to_world"><scale x="1" y="2"/><rotate x="1" angle="180"/><translate z="6"/></transform><string name="measure" value="irradiance"/>{})" +
          sheet + turned(6, 6, -45, 0, 0, kReflects));
  const Picture unfolded = scene(
      "path", 256,
      R"(<sensor type="powermap"><transform name="to_world"><scale x="1" y="2"/><rotate y="1" angle="-90"/><translate x="6"/></transform><string name="measure" value="irradiance"/>{})" +
          sheet);
  if (test::kSanitized) return;
  std::printf("from infinity: mirror %.4f +- %.4f, unfolded %.4f +- %.4f\n", mirrored.mean[0],
              mirrored.error[0], unfolded.mean[0], unfolded.error[0]);
  EXPECT_LT(mirrored.error[0], 0.03 * unfolded.mean[0]);
  EXPECT_LT(std::abs(mirrored.mean[0] - unfolded.mean[0]),
            4.5 * std::hypot(mirrored.error[0], unfolded.error[0]));
}

// A wall that stands on a mirror and its image are one obstacle, twice as high. What bounds the mirror, or touches it, is no edge.
TEST(MirrorDiffraction, WallsThatStandOnMirrors) {
  // At 3 GHz, transmitter and receiver 10 m apart, 1 m above a floor of metal: the path by way of the floor passes 0.3 m beside
  // the border of a wall half way.
  const auto radiance = [](const std::string& shapes, double camera_z, double up) {
    return render(fmt::format(
                      R"(<integrator type="path"><boolean name="diffraction" value="true"/></integrator>
  <sensor type="perspective"><float name="fov" value="0.01"/><float name="near_clip" value="1e-4"/>
    <transform name="to_world"><lookat origin="-5, 0, {}" target="0, 0, 0" up="0, 0, 1"/></transform>
    <film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/>
      <string name="wavelength_min" value="3.0001GHz"/><string name="wavelength_max" value="2.9999GHz"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate y="1" angle="-90"/><translate x="5" z="{}"/></transform>
    <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)",
                      camera_z, test::kSanitized ? 1 : 1024, up) +
                  shapes)
        .mean[0];
  };
  const auto wall = [](double x, double low, double high) {
    return fmt::format(
               R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="90"/><scale x="1" y="2" z="{}"/>
    <translate x="{}" y="2.3" z="{}"/></transform>)",
               (high - low) / 2, x, (low + high) / 2) +
           kAbsorbs;
  };
  const std::string floor =
      R"(<shape type="rectangle"><transform name="to_world"><scale x="60" y="60"/></transform>)" +
      std::string(kReflects);
  // The wall stands 2 m before the point of reflection, and is seen with its image from there to 4 m above and below the floor.
  const double mirrored = radiance(floor + wall(-2, 0, 4), 1, 3) / radiance(floor, 1, 3);
  const double unfolded = radiance(wall(-2, -4, 4), 1, -3) / radiance("", 1, -3);
  if (test::kSanitized) return;
  std::printf("wall on a mirror: %.4f, with its image as a wall: %.4f\n", mirrored, unfolded);
  EXPECT_NEAR(mirrored, unfolded, 0.02);
}

}  // namespace
}  // namespace aureole::testing
