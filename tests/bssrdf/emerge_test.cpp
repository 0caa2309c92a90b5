// SPDX-License-Identifier: Apache-2.0
// Exits of translucent bodies: their density, and pictures of bodies whose light is known.
#include "aureole/transport/emerge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "aureole/loading/load.h"
#include "aureole/math/significance.h"
#include "harness/rendered.h"

namespace aureole::testing {
namespace {

std::string number(double v) { return std::to_string(v); }
std::string parameter(const std::string& name, double v) {
  return "<float name=\"" + name + "\" value=\"" + number(v) + "\"/>";
}
/// Mean free paths that differ between wavelengths by a factor of 20.
const std::string kChromatic =
    "<bssrdf type=\"normalized_diffusion\"><spectrum name=\"reflectance\" value=\"360:0.3, 830:0.9\"/>"
    "<spectrum name=\"mean_free_path\" value=\"360:0.02, 830:0.4\"/></bssrdf>";
const std::string kDipole =
    "<bssrdf type=\"dipole\"><float name=\"sigma_t\" value=\"4\"/><float name=\"albedo\" "
    "value=\"0.95\"/><float name=\"int_ior\" value=\"1.3\"/></bssrdf>";

LoadedScene scene_of(const std::string& shape) {
  return load_scene_from_string(
      "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>" + shape + "</scene>", "emerge.xml");
}

Wavelengths wavelengths(int hero) {
  return Wavelengths::at(SpectralGrid{}, make_spectrum([&](int i) {
                           return 370.f + 450.f * float((i + hero) % kWavelengths) / float(kWavelengths);
                         }));
}

/// The entry where a ray along -z hits the scene.
SurfacePoint entry_of(const Scene& scene) {
  return *scene.intersect({{0.01f, 0.02f, 10}, {0, 0, -1}, kInfinity});
}

/// The part of the light that leaves, per wavelength, by exits drawn from every hero in turn and combined as
/// a path combines them; the standard error of its mean over batches.
struct Leaving {
  double light[kWavelengths] = {}, error[kWavelengths] = {};
};
Leaving leaving(const Scene& scene, int samples) {
  constexpr int kBatches = 16;
  const SurfacePoint entry = entry_of(scene);
  Leaving all;
  SeededRandom random(11);
  for (int b = 0; b < kBatches; ++b) {
    double batch[kWavelengths] = {};
    for (int i = 0; i < samples; ++i)
      for (int hero = 0; hero < kWavelengths; ++hero) {
        const float axis = random.next();
        const Vec2 place = random.next2();
        const EmergenceRandom numbers{axis, place, std::uint32_t(random.next() * 4e9f)};
        Emergence e;
        if (!emerge(scene, entry, wavelengths(hero), numbers, 1.f, 1.f, e)) continue;
        const Spectrum part = e.value * (1 / (mean(e.pdf) * e.chosen));
        for (int k = 0; k < kWavelengths; ++k)
          batch[(k + hero) % kWavelengths] += double(part[k]) / samples / kWavelengths;
      }
    for (int k = 0; k < kWavelengths; ++k)
      all.light[k] += batch[k] / kBatches, all.error[k] += batch[k] * batch[k] / kBatches;
  }
  for (int k = 0; k < kWavelengths; ++k)
    all.error[k] = std::sqrt(std::max(0.0, all.error[k] - all.light[k] * all.light[k]) / (kBatches - 1));
  return all;
}

/// The integral of P over distances up to `end` by steps of ln r. Of a sphere of radius R the surface within
/// a chord c of a point is pi c^2, as of a plane: there all exits lie within 2 R.
double expected(const Bssrdf& model, const SurfacePoint& entry, int wavelength, double end) {
  const Wavelengths w = wavelengths(wavelength);
  constexpr int kSteps = 4000;
  const double first = std::log(end * 1e-8), step = (std::log(end) - first) / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = std::exp(first + (i + 0.5) * step);
    sum += double(model.eval_pdf(float(r), {w, entry}).value[0]) * 2 * std::numbers::pi * r * r * step;
  }
  return sum;
}

void expect_leaving(const std::string& shape, double end) {
  const LoadedScene loaded = scene_of(shape);
  const Scene& scene = *loaded.scene;
  const SurfacePoint entry = entry_of(scene);
  const Leaving found = leaving(scene, 400);
  for (int k = 0; k < kWavelengths; ++k) {
    const double truth = expected(*entry.surface->exit->bssrdf, entry, k, end);
    EXPECT_NEAR(found.light[k], truth, 4.5 * found.error[k] + 1e-3 * truth) << "wavelength " << k;
    EXPECT_LT(found.error[k], 0.02);
  }
}

TEST(Emerge, AllLightOfAPlaneIsFound) {
  for (const std::string& model : {kChromatic, kDipole})
    expect_leaving(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"1000\"/></transform>" + model +
            "</shape>",
        1000);
}

TEST(Emerge, AllLightOfASphereIsFound) {
  for (const std::string& model : {kChromatic, kDipole})
    expect_leaving("<shape type=\"sphere\"><float name=\"radius\" value=\"0.4\"/>" + model + "</shape>", 0.8);
}

/// Other shapes on the way, and other placements of the same group, are not left through.
TEST(Emerge, LeavesTheShapeThatItEntered) {
  const std::string ball =
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"><float name=\"radius\" "
      "value=\"0.4\"/>" +
      kDipole + "</shape></shape>";
  const auto placed = [](double z) {
    return "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate z=\"" +
           number(z) + "\"/></transform></shape>";
  };
  expect_leaving(
      ball + placed(0) + placed(-0.5) +
          "<shape type=\"rectangle\"><transform name=\"to_world\"><translate z=\"0.1\"/></transform></shape>",
      0.8);
}

std::string sensor(int samples, const std::string& more = "") {
  return "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale value=\"0.5\"/><lookat "
         "origin=\"0, 0, 5\" "
         "target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform><sampler type=\"sobol\"><integer "
         "name=\"sample_count\" "
         "value=\"" +
         std::to_string(samples) +
         "\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" value=\"4\"/><integer name=\"height\" "
         "value=\"4\"/><rfilter type=\"box\"/></film></sensor>" +
         more;
}

/// By reciprocity the radiance that leaves a half-space along its normal under a uniform sky is the
/// reflectance of light along the normal: of isotropic scattering and normalised diffusion that of transport
/// (medium/slab_test.cpp has the same numbers of full transport).
TEST(Subsurface, HalfSpaceUnderASkyReflectsAsTransportSays) {
  struct Row {
    double albedo, index, reflectance;
  };
  for (const Row& row : {Row{.9, 1, .414947}, Row{.99, 1, .752721}, Row{.9, 1.5, .259919}}) {
    const Picture p = render("<integrator type=\"path\"/>" + sensor(16) + "<emitter type=\"constant\">" +
                             parameter("radiance", 1) +
                             "</emitter><shape type=\"rectangle\"><transform name=\"to_world\"><scale "
                             "value=\"1000\"/></transform><bssrdf "
                             "type=\"normalized_diffusion\">" +
                             parameter("sigma_t", 20) + parameter("albedo", row.albedo) +
                             parameter("int_ior", row.index) + parameter("ext_ior", 1) + "</bssrdf></shape>");
    EXPECT_NEAR(p.all, row.reflectance, 4.5 * p.all_error + 5e-4);
    EXPECT_LT(p.all_error, 0.01);
  }
}

/// A mean free path about or below the rounding of positions: the body is a diffuse surface, as bright as any other.
TEST(Subsurface, VeryDenseBodiesAreAsBright) {
  for (const double extinction : {1e5, 1e6, 1e7, 1e12}) {
    const Picture p = render(
        "<integrator type=\"path\"/>" + sensor(16) + "<emitter type=\"constant\">" +
        parameter("radiance", 1) +
        "</emitter><shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"1000\"/><rotate x=\"1\" "
        "y=\"0.2\" angle=\"8\"/></transform><bssrdf type=\"normalized_diffusion\">" +
        parameter("sigma_t", extinction) + parameter("albedo", .9) + parameter("int_ior", 1) +
        parameter("ext_ior", 1) + "</bssrdf></shape>");
    EXPECT_NEAR(p.all, .414947, 4.5 * p.all_error + 5e-3) << extinction;
  }
}

/// The profile itself: a thin beam lights a half-space, and a sensor above sees P(r) times what the boundary
/// lets in and, along the normal, out.
TEST(Subsurface, PictureOfABeamIsTheProfile) {
  constexpr int kPixels = 16;
  constexpr double kHalf = 4, kDistance = 50, kCone = 0.05;  // a spot of radius .04
  for (const double index : {1.0, 1.5}) {
    const std::string model = "<bssrdf type=\"normalized_diffusion\">" + parameter("sigma_t", 1) +
                              parameter("albedo", 0.95) + parameter("int_ior", index) +
                              parameter("ext_ior", 1) + "</bssrdf>";
    const Picture p = render(
        "<integrator type=\"ptracer\"/><sensor type=\"orthographic\"><transform name=\"to_world\"><scale "
        "value=\"" +
        number(kHalf) +
        "\"/><lookat origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform><sampler "
        "type=\"sobol\"><integer "
        "name=\"sample_count\" value=\"64\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" "
        "value=\"16\"/>"
        "<integer name=\"height\" value=\"16\"/><rfilter type=\"box\"/></film></sensor><emitter "
        "type=\"spot\">" +
        parameter("intensity", 1) + parameter("cutoff_angle", kCone) +
        parameter("beam_width", kCone * 0.9999) + "<transform name=\"to_world\"><lookat origin=\"0, 0, " +
        number(kDistance) +
        "\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform></emitter><shape type=\"rectangle\"><transform "
        "name=\"to_world\"><scale value=\"1000\"/></transform>" +
        model + "</shape>");
    const LoadedScene plane = scene_of("<shape type=\"rectangle\">" + model + "</shape>");
    const Bssrdf& bssrdf = *plane.scene->intersect({{0, 0, 1}, {0, 0, -1}, kInfinity})->surface->exit->bssrdf;
    const Wavelengths w = wavelengths(0);
    const SurfacePoint anywhere;
    // Closed forms of the power of the beam and of the boundary along its normal.
    const double power = 2 * std::numbers::pi * (1 - std::cos(kCone * std::numbers::pi / 180));
    const double r = (index - 1) / (index + 1), let_in = 1 - r * r;
    const double diffuse_let_in = index == 1 ? 1 : 1 - 0.0918;
    double seen = 0, all = 0;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) {
        const auto place = [&](int pixel, int part) {
          return (pixel + (part + 0.5) / 8) / kPixels * 2 * kHalf - kHalf;
        };
        double profile = 0, nearest = 1e9;
        for (int part = 0; part < 64; ++part) {
          const double distance = std::hypot(place(x, part % 8), place(y, part / 8));
          profile += double(bssrdf.eval_pdf(float(distance), {w, anywhere}).value[0]) / 64;
          nearest = std::min(nearest, distance);
        }
        if (nearest < 0.3) continue;  // the beam has a width
        const double expected = power * let_in * let_in / diffuse_let_in * profile / std::numbers::pi;
        const std::size_t i = std::size_t(y * kPixels + x);
        EXPECT_NEAR(p.mean[i], expected, 6 * p.error[i] + 0.01 * expected) << x << ", " << y;
        seen += p.mean[i], all += expected;
      }
    EXPECT_NEAR(seen / all, 1, 0.01);
    EXPECT_LT(p.all_error, 0.01 * p.all);
  }
}

/// Light that is followed from the lamp and from the sensor makes the same picture.
TEST(Subsurface, LightTracingAgrees) {
  const auto picture = [](const std::string& integrator, const std::string& boundary) {
    return render(
        "<integrator type=\"" + integrator + "\"/>" + sensor(integrator == "path" ? 64 : 512) +
        "<emitter type=\"spot\">" + parameter("intensity", 10) + parameter("cutoff_angle", 12) +
        "<transform name=\"to_world\"><lookat origin=\"2, 1, 3\" target=\"0.1, 0, 0.2\" up=\"0, 1, "
        "0\"/></transform></emitter><shape type=\"sphere\"><float name=\"radius\" value=\"0.4\"/><bssrdf "
        "type=\"normalized_diffusion\">" +
        parameter("sigma_t", 10) + parameter("albedo", 0.98) + boundary + "</bssrdf></shape>");
  };
  for (const std::string& boundary :
       {parameter("int_ior", 1.5), "<bsdf type=\"roughdielectric\">" + parameter("int_ior", 1.5) +
                                       parameter("alpha", 0.4) + "</bsdf>"}) {
    const Picture from_sensor = picture("path", boundary), from_lamp = picture("ptracer", boundary);
    ASSERT_GT(from_sensor.all, 0);
    for (std::size_t i = 0; i < from_sensor.mean.size(); ++i)
      EXPECT_NEAR(from_sensor.mean[i], from_lamp.mean[i],
                  6 * std::hypot(from_sensor.error[i], from_lamp.error[i]) + 1e-3 * from_sensor.all)
          << "pixel " << i;
    EXPECT_LT(from_sensor.all_error / from_sensor.all, 0.02);
  }
}

/// A lamp that only sampled directions find brings what one does that is connected with.
TEST(Subsurface, BothWaysToALampAgree) {
  const auto picture = [](const std::string& weight) {
    return render(
        "<integrator type=\"path\"/>" + sensor(256) +
        "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"12\"/><float name=\"radius\" "
        "value=\"3\"/><emitter type=\"area\"><float name=\"radiance\" value=\"1\"/>" +
        weight + "</emitter></shape><shape type=\"sphere\"><float name=\"radius\" value=\"0.4\"/>" +
        kChromatic + "</shape>");
  };
  const Picture both = picture(""), sampled = picture("<float name=\"sampling_weight\" value=\"0\"/>");
  EXPECT_NEAR(both.all, sampled.all, 4.5 * std::hypot(both.all_error, sampled.all_error));
  EXPECT_LT(both.all_error, 0.03 * both.all);
}

std::string errors_of(const std::string& shape) {
  try {
    scene_of(shape);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(Subsurface, BadInputIsRefused) {
  const auto bad = [](const std::string& content, const std::string& expected) {
    const std::string found = errors_of("<shape type=\"sphere\">" + content + "</shape>");
    EXPECT_NE(found.find(expected), std::string::npos) << content << "\n" << found;
  };
  const auto bssrdf = [](const std::string& content) {
    return "<bssrdf type=\"dipole\">" + content + "</bssrdf>";
  };
  const std::string good = parameter("sigma_a", 1) + parameter("sigma_s", 9);
  bad(bssrdf(""), "needs to know what the body is made of");
  bad(bssrdf(parameter("sigma_a", -1)), "sigma_a");
  bad(bssrdf("<float name=\"sigma_a\" value=\"nan\"/>"), "nan");
  bad(bssrdf(parameter("sigma_t", 1) + parameter("albedo", 1.5)), "albedo");
  bad(bssrdf(parameter("sigma_t", 0)), "neither absorbs nor scatters");
  bad(bssrdf(good + parameter("g", 1.5)), "g");
  bad(bssrdf(good + parameter("sigma_t", 1)), "give either");
  bad(bssrdf(parameter("reflectance", 0.5)), "belong together");
  bad(bssrdf(parameter("reflectance", 1.5) + parameter("mean_free_path", 1)), "reflectance");
  bad(bssrdf(parameter("reflectance", 0.5) + parameter("mean_free_path", 0)), "must be positive");
  bad(bssrdf(good + "<bsdf type=\"diffuse\"/>"), "must refract");
  bad(bssrdf(good + "<bsdf type=\"dielectric\"/>" + parameter("int_ior", 1.5)), "has its indices");
  bad(bssrdf(good + "<medium type=\"homogeneous\"/>"), "give either a medium");
  bad(bssrdf("<medium type=\"heterogeneous\"><volume type=\"constvolume\" name=\"sigma_t\"><float "
             "name=\"value\" "
             "value=\"1\"/></volume><phase type=\"sggx\"><string name=\"S\" "
             "value=\"0.1,0.1,1,0,0,0\"/></phase></medium>"),
      "scatters differently");
  bad(bssrdf(good) + "<bsdf type=\"diffuse\"/>", "nest this one in the bssrdf");
  bad(bssrdf(good) + "<medium type=\"homogeneous\" name=\"interior\"/>", "stands for what is inside");
  bad(bssrdf(good) + "<integer name=\"priority\" value=\"1\"/>", "overlap");
  bad(bssrdf(good) + bssrdf(good), "at most one");
}

TEST(Subsurface, OpenShapesAreRemarkedOn) {
  const LoadedScene loaded = scene_of("<shape type=\"rectangle\">" + kDipole + "</shape>");
  bool found = false;
  for (const std::string& note : loaded.notes) found |= note.find("without end") != std::string::npos;
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace aureole::testing
