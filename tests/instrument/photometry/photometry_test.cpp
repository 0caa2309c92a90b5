// SPDX-License-Identifier: Apache-2.0
// The goniophotometer and the evaluation of photometric pictures, in scenes of closed form.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <fstream>

#include "aureole/instrument/photometry/goniometry.h"
#include "aureole/instrument/photometry/photometric_picture.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/sensor/placed_sensor.h"
#include "harness/paths.h"
#include "loading/load_text.h"
#include "loading/test_plugins.h"

namespace aureole::test {
namespace {

LoadedScene scene(const std::string& content, const std::string& integrator = "ptracer",
                  const std::filesystem::path& file = "light.xml") {
  return load_scene_from_string(
      "<scene version='3.0.0'><integrator type='" + integrator + "'/>" + content + "</scene>", file, {});
}
Image render(const LoadedScene& loaded, std::int64_t samples) {
  RenderOptions options;
  options.end = samples;
  RenderJob job(loaded, options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state().picture();
}
/// A mean over replicates with its standard error.
struct MeanOfRuns {
  double mean = 0, error = 0;
};
/// Runs with seeds of their own, and the mean of a number of each.
class LuminaireRuns {
public:
  LuminaireRuns(const LoadedScene& loaded, std::int64_t samples, const GoniometryOptions& how) {
    constexpr int kReplicates = 8;
    for (int k = 0; k < kReplicates; ++k) {
      RenderOptions options;
      options.end = samples, options.seed = std::uint64_t(200 + k);
      RenderJob job(loaded, options);
      job.run(std::atomic<bool>(false));
      EXPECT_EQ(job.state().invalid_samples, 0u);
      runs_.push_back(measured_luminaire(job.state().picture(), how));
    }
  }
  template <class F>
  MeanOfRuns mean(const F& f) const {
    double sum = 0, squares = 0;
    for (const Luminaire& l : runs_) sum += f(l), squares += f(l) * f(l);
    const double n = double(runs_.size()), mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
  }
  const Luminaire& first() const { return runs_.front(); }
  MeanOfRuns intensity(double c, double gamma) const {
    return mean([&](const Luminaire& l) { return l.distribution.at(c, gamma); });
  }
  MeanOfRuns flux() const {
    return mean([](const Luminaire& l) { return l.distribution.flux(); });
  }

private:
  std::vector<Luminaire> runs_;
};
/// Within three standard errors, which are less than `most` of the value.
void expect_mean(const MeanOfRuns& m, double expected, double most, const std::string& what) {
  EXPECT_LT(m.error, most * expected) << what;
  EXPECT_NEAR(m.mean, expected, 3 * m.error + 2e-4 * expected) << what;
}
/// A goniophotometer with +z for the direction of both angles zero.
std::string goniophotometer(int width, int height) {
  return "<sensor type='goniophotometer'><film type='hdrfilm'><integer name='width' value='" +
         std::to_string(width) + "'/><integer name='height' value='" + std::to_string(height) +
         "'/><string name='quantity' value='luminous_intensity'/></film></sensor>";
}

TEST(Goniophotometry, ALambertianDiscAndItsFlux) {
  // 1000 cd/m^2 from a disc of radius 0.5: I = 785.4 cos(gamma), and pi times that for its flux.
  const std::string disc =
      "<shape type='disk'><transform name='to_world'><scale value='0.5'/></transform><emitter type='area'>"
      "<string name='amount' value='1000 cd/m^2'/></emitter></shape>";
  const double peak = 1000 * M_PI / 4;
  for (const char* integrator : {"ptracer", "path"}) {
    const LuminaireRuns runs(scene(goniophotometer(8, 37) + disc, integrator), 2048,
                             {.symmetry = GoniometryOptions::Symmetry::rotational});
    // "path" finds the disc by rays from a circle about the scene, and at 0 degrees by those of 8 half-planes.
    for (const double gamma : {0.0, 30.0, 60.0, 80.0})
      expect_mean(runs.intensity(0, gamma), peak * std::cos(gamma * M_PI / 180), 0.003,
                  integrator + std::to_string(gamma));
    EXPECT_EQ(runs.intensity(0, 95).mean, 0);
    // The flux of intensities that are linear over 5 degrees: by trapezoids of the exact ones, with exact weights.
    double flux = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double gamma = 90 * (i + 0.5) / kSteps, low = 5 * std::floor(gamma / 5), t = (gamma - low) / 5;
      const auto cosine = [](double degrees) { return std::max(0.0, std::cos(degrees * M_PI / 180)); };
      flux += 2 * M_PI * peak * ((1 - t) * cosine(low) + t * cosine(low + 5)) * std::sin(gamma * M_PI / 180) *
              (M_PI / 2 / kSteps);
    }
    EXPECT_NEAR(flux, M_PI * peak, 1.5e-3 * M_PI * peak);
    expect_mean(runs.flux(), flux, 0.003, integrator);
    const MeanOfRuns beam = runs.mean([](const Luminaire& l) { return luminaire_figures(l).beam[0]; });
    EXPECT_LT(beam.error, 0.003 * 120) << integrator;
    // Twice the angle at which linear intensities fall to half: 60 degrees is one of the table.
    EXPECT_NEAR(beam.mean, 120, 3 * beam.error + 0.1) << integrator;
    const MeanOfRuns upward = runs.mean([](const Luminaire& l) {
      const LuminaireFigures f = luminaire_figures(l);
      return f.flux - f.downward_flux;
    });
    EXPECT_NEAR(upward.mean, 0, 1e-9);
  }
}

TEST(Goniophotometry, AFileComesBackThroughAScene) {
  // The twin batten over its angles, from which a scene, measurements and files of both formats are made.
  const std::filesystem::path file = example_file("batten.ldt");
  const Luminaire given = read_luminaire(file);
  const std::string lamp =
      "<emitter type='photometric'><string name='filename' value='" + file.string() + "'/></emitter>";
  const LuminaireRuns runs(scene(goniophotometer(24, 37) + lamp), 64, {});
  expect_mean(runs.flux(), given.distribution.flux(), 0.003, "flux");
  // The batten is seen from 1000 radii of the scene: directions to its parts differ by up to 0.001 rad, within which the
  // intensities between the file's angles change linearly; parts on both sides cancel but for a tenth of that.
  const auto change_nearby = [&](int i, int j) {
    constexpr double kStep = 0.001 * 180 / M_PI;
    double change = 0;
    for (const double dc : {-kStep, 0.0, kStep})
      for (const double dg : {-kStep, 0.0, kStep}) {
        const double gamma = 5 * j + dg, sine = std::max(std::sin(5 * j * M_PI / 180), 0.01);
        const double near =
            given.distribution.intensity(given.distribution.direction(15 * i + dc / sine, gamma));
        change = std::max(
            change,
            std::abs(near - given.distribution.intensity(given.distribution.direction(15 * i, 5 * j))));
      }
    return change;
  };
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 37; ++j) {
      const auto d = given.distribution.direction(15 * i, 5 * j);
      const double cd = given.distribution.intensity(d);
      const MeanOfRuns m = runs.mean([&](const Luminaire& l) { return l.distribution.intensity(d); });
      const double change = change_nearby(i, j);
      EXPECT_LT(m.error, 0.003 * cd + 0.01 * change) << i << " " << j;
      EXPECT_LT(change, 2e-3 * given.distribution.maximum()) << i << " " << j;
      EXPECT_NEAR(m.mean, cd, 3 * m.error + 0.1 * change + 1e-5 * cd) << i << " " << j;
    }
  // The files hold what was measured, to their six digits.
  const Luminaire& measured = runs.first();
  EXPECT_TRUE(measured.is_absolute);
  for (const std::string& text : {ies_text(measured), eulumdat_text(measured)}) {
    const Luminaire back = parse_luminaire(text, "back");
    for (int i = 0; i < 24; ++i)
      for (int j = 0; j < 37; ++j) {
        const auto d = given.distribution.direction(15 * i, 5 * j);
        const double cd = measured.distribution.intensity(d);
        EXPECT_NEAR(back.distribution.intensity(d), cd, 1e-5 * cd) << i << " " << j;
      }
  }
}

TEST(Goniophotometry, WidthsOfBeams) {
  // Half of the intensity at 40 degrees in the half-planes 0 and 180, and at 30 50/70 degrees in the others; a hemisphere that ends.
  const auto beam = [](const std::string& numbers) {
    const LuminaireFigures f =
        luminaire_figures(parse_luminaire("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 " + numbers, "beam.ies"));
    return std::array{f.beam[0], f.beam[1]};
  };
  const auto two = beam("4 2 1 2 0 0 0 1 1 1 0 30 50 90 0 90 100 75 25 0 100 30 10 0");
  EXPECT_NEAR(two[0], 80, 1e-5);
  EXPECT_NEAR(two[1], 2 * 30 * 50 / 70.0, 1e-5);
  EXPECT_NEAR(beam("2 1 1 2 0 0 0 1 1 1 0 90 0 100 100")[0], 180, 1e-5);
}

TEST(Goniophotometry, LightFromAMirrorIsFound) {
  // A point of 100 cd before a large mirror: 200 cd away from it, and nothing behind. No connection finds the image.
  const std::string content =
      goniophotometer(4, 91) +
      "<emitter type='point'><string name='amount' value='100 cd'/><point name='position' x='0' y='0' z='0.01'/></emitter>"
      "<shape type='rectangle'><bsdf type='twosided'><bsdf type='conductor'><string name='material' value='none'/></bsdf></bsdf></shape>";
  const LuminaireRuns runs(scene(content), 2048, {.symmetry = GoniometryOptions::Symmetry::rotational});
  for (const double gamma : {20.0, 40.0, 60.0})
    expect_mean(runs.intensity(0, gamma), 200, 0.01, std::to_string(gamma));
  EXPECT_EQ(runs.intensity(0, 120).mean, 0);
  // The mirror fills all but 0.6 degrees of the lower hemisphere.
  const MeanOfRuns flux = runs.flux();
  EXPECT_LT(flux.error, 0.003 * flux.mean);
  EXPECT_NEAR(flux.mean, 400 * M_PI, 3 * flux.error + 0.005 * 400 * M_PI);
}

TEST(Goniophotometry, SymmetriesAverageWhatIsAlike) {
  Image picture{.width = 4, .height = 3, .channels = {"Y"}, .pixels = {5, 7, 9, 11, 1, 2, 3, 6, 0, 0, 0, 0}};
  using Symmetry = GoniometryOptions::Symmetry;
  const auto at = [&](Symmetry symmetry, double c) {
    return measured_luminaire(picture, {.symmetry = symmetry}).distribution.at(c, 90);
  };
  EXPECT_EQ(measured_luminaire(picture, {}).distribution.at(45, 0), 8);  // one direction
  EXPECT_EQ(at(Symmetry::none, 270), 6);
  EXPECT_EQ(at(Symmetry::about_c0, 270), 4);
  EXPECT_EQ(at(Symmetry::about_c90, 0), 2);
  EXPECT_EQ(at(Symmetry::about_c90, 270), 6);
  EXPECT_EQ(at(Symmetry::quadrants, 90), 4);
  EXPECT_EQ(at(Symmetry::rotational, 77), 3);
  EXPECT_NEAR(measured_luminaire(picture, {.flux = 500}).distribution.flux(), 500, 1e-9);
  Image dark = picture;
  for (float& v : dark.pixels) v = 0;
  EXPECT_THROW(measured_luminaire(dark, {}), Error);
}

TEST(Photometry, GlareOfADiscInItsSurround) {
  // A disc of 10000 cd/m^2, radius 0.1 at 2 m along the line of sight and 1 m above, in a surround of 50 cd/m^2.
  const std::string camera =
      "<sensor type='perspective'><float name='fov' value='90'/><transform name='to_world'><lookat origin='0, 0, 0' target='2, 0, 0' up='0, 0, 1'/>"
      "</transform><film type='hdrfilm'><integer name='width' value='512'/><integer name='height' value='512'/>"
      "<string name='quantity' value='luminance'/><rfilter type='box'/></film></sensor>";
  const std::string disc =
      "<shape type='disk'><transform name='to_world'><scale value='0.1'/><rotate y='1' angle='-90'/><translate x='2' z='1'/></transform>"
      "<emitter type='area'><string name='amount' value='10000 cd/m^2'/></emitter></shape>"
      "<emitter type='constant'><string name='amount' value='50 cd/m^2'/></emitter>";
  const LoadedScene loaded = scene(camera + disc, "direct");
  const Image picture = render(loaded, 64);
  const Film& film = loaded.scene->film();
  const PhotometricMap map =
      photometric_map(picture, channels_attribute(film.channel_names(), film.channel_meanings()), "picture");
  EXPECT_EQ(map.unit, "cd/m^2");
  const PictureGlare glare = picture_glare(map, loaded.scene->sensor(), {0, 0, 1}, 5000);
  ASSERT_EQ(glare.sources.size(), 1u);
  // Its normal is at the angle of the source to the line of sight: omega = area cos/r^2.
  const double r2 = 5, omega = M_PI * 0.01 * (2 / std::sqrt(r2)) / r2;
  const double p = optics::position_index(std::atan(0.5), 0);
  EXPECT_NEAR(glare.sources[0].source.solid_angle, omega, 0.05 * omega);
  EXPECT_NEAR(glare.sources[0].source.position, p, 0.02);
  EXPECT_NEAR(glare.background, 50, 0.5);
  EXPECT_NEAR(glare.rating, 8 * std::log10(0.25 / 50 * 1e8 * omega / (p * p)), 0.3);
  EXPECT_EQ(glare.outside, 0u);
  // A pyramid of 90 degrees has a sixth of the sphere.
  EXPECT_NEAR(glare.solid_angle, 4 * M_PI / 6, 0.002);
  EXPECT_THROW(picture_glare(map, loaded.scene->sensor(), {1, 0, 0}, 1000), Error);
  // A crop keeps the directions of its pixels: the same source in the same surround.
  std::string cropped = camera;
  const std::string size = "<integer name='height' value='512'/>";
  cropped.insert(cropped.find(size) + size.size(),
                 "<integer name='crop_offset_x' value='150'/><integer name='crop_offset_y' value='60'/>"
                 "<integer name='crop_width' value='200'/><integer name='crop_height' value='150'/>");
  const LoadedScene part = scene(cropped + disc, "direct");
  const PhotometricMap of_part = photometric_map(
      render(part, 64), channels_attribute(film.channel_names(), film.channel_meanings()), "picture");
  ASSERT_EQ(of_part.width, 200);
  // Few pixels of the disc's rim are near this threshold, which noise would change.
  const PictureGlare glare_of_part = picture_glare(of_part, part.scene->sensor(), {0, 0, 1}, 300),
                     of_whole = picture_glare(map, loaded.scene->sensor(), {0, 0, 1}, 300);
  ASSERT_EQ(glare_of_part.sources.size(), 1u);
  EXPECT_NEAR(glare_of_part.sources[0].source.position, of_whole.sources[0].source.position, 1e-3);
  EXPECT_NEAR(glare_of_part.sources[0].source.solid_angle, of_whole.sources[0].source.solid_angle,
              0.02 * omega);
  EXPECT_NEAR(glare_of_part.rating, of_whole.rating, 0.05);
  EXPECT_NEAR(glare_of_part.sources[0].x, of_whole.sources[0].x - 150, 0.1);
  EXPECT_THROW(picture_glare(of_part, loaded.scene->sensor(), {0, 0, 1}, 5000), Error);
}

TEST(Photometry, StatisticsAndScales) {
  PhotometricMap map{4, 2, {100, 200, 300, 400, 500, 600, 700, NAN}, "illuminance", "lx"};
  const MapStatistics s = map_statistics(map, {0, 0, 4, 2});
  EXPECT_EQ(s.count, 7u);
  EXPECT_EQ(s.mean, 400);
  EXPECT_EQ(s.median, 400);
  EXPECT_EQ(s.uniformity(), 0.25);
  EXPECT_NEAR(s.diversity(), 1 / 7.0, 1e-12);
  EXPECT_EQ(map_statistics(map, {1, 0, 2, 1}).mean, 250);
  EXPECT_THROW(map_statistics(map, {1, 0, 4, 1}), Error);
  // Cells of areas 1, 3, 0 and 2: means and medians by them; a cell without area is none.
  PhotometricMap uneven{2, 2, {10, 20, 1000, 40}, "illuminance", "lx", {1, 3, 0, 2}};
  const MapStatistics by_area = map_statistics(uneven, {0, 0, 2, 2});
  EXPECT_EQ(by_area.count, 3u);
  EXPECT_NEAR(by_area.mean, (10 + 60 + 80) / 6.0, 1e-12);
  EXPECT_EQ(by_area.median, 20);
  EXPECT_EQ(by_area.max, 40);
  EXPECT_NEAR(by_area.sum, 70, 1e-12);
  EXPECT_THROW(map_statistics(map, {3, 1, 1, 1}), Error);
  const ColorScale linear = map_scale(map, {}, 1000, false, {300, 500});
  EXPECT_EQ(linear.low, 0);
  EXPECT_EQ(linear.high, 1000);
  EXPECT_EQ(linear.contours, (std::vector<double>{300, 500}));
  EXPECT_EQ(linear.title, "illuminance, lx");
  const ColorScale decades = map_scale(map, 10, 1000, true, {});
  EXPECT_TRUE(decades.is_logarithmic);
  EXPECT_EQ(decades.high, 1000);
  const std::vector<double> labels = scale_labels(decades);
  ASSERT_EQ(labels.size(), 7u);
  for (std::size_t i = 0; i < labels.size(); ++i)
    EXPECT_NEAR(labels[i], (std::vector<double>{10, 20, 50, 100, 200, 500, 1000})[i], 1e-9);
  EXPECT_THROW(map_scale(map, 10, 5, false, {}), Error);
  EXPECT_THROW(photometric_map({.width = 1, .height = 1, .channels = {"R", "G", "B"}, .pixels = {1, 1, 1}},
                               "R: linear sRGB", "x"),
               Error);
}

TEST(Photometry, OpenGroundUnderSkyAndSun) {
  const std::string ball = "<shape type='sphere'/>";
  const std::string camera = "<sensor type='radiancemeter'/>";
  const auto open = [&](const std::string& emitters, const Vec3& up) {
    return open_illuminance(*scene(camera + ball + emitters).scene, up);
  };
  const std::string sky =
      "<emitter type='ciesky'><string name='amount' value='12 klx'/><transform name='to_world'><rotate x='1' angle='-90'/></transform></emitter>";
  EXPECT_NEAR(open(sky, {0, 1, 0}), 12000, 12);
  const std::string sun =
      "<emitter type='directional'><vector name='direction' x='0' y='-3' z='-4'/><string name='amount' value='50 klx'/></emitter>";
  EXPECT_NEAR(open(sun, {0, 1, 0}), 30000, 30);
  EXPECT_NEAR(open(sky + sun, {0, 1, 0}), 42000, 42);
  EXPECT_EQ(open("", {0, 1, 0}), 0);
}

/// A receiver in the open, which faces +y, and rays that find the sun in the lights.
TEST(Photometry, OpenGroundUnderASmallSunIsThatOfATracedReceiver) {
  const TemporaryFolder folder;
  // A sun of 2 x 2 texels, 0.7 degrees, which fixed directions of a hemisphere would miss or count too much.
  Image map{1024, 512, {"R", "G", "B"}, std::vector<float>(3 * 1024 * 512, 1.f), false};
  for (const auto& [x, y] : {std::pair(300, 100), {301, 100}, {300, 101}, {301, 101}})
    for (int c = 0; c < 3; ++c) map.pixels[std::size_t(3 * (y * 1024 + x) + c)] = 20000;
  write_pfm(folder.path / "sun.pfm", map);
  const std::string receiver =
      "<scene version='3.0.0'><integrator type='path'/><sensor type='powermap'><string name='measure' value='irradiance'/>"
      "<transform name='to_world'><rotate x='1' angle='-90'/></transform><film type='hdrfilm'><integer name='width' value='1'/>"
      "<integer name='height' value='1'/><string name='quantity' value='illuminance'/><rfilter type='box'/></film>"
      "<sampler type='sobol'><integer name='sample_count' value='131072'/></sampler></sensor>"
      "<shape type='sphere'><point name='center' x='0' y='-30' z='0'/><bsdf type='diffuse'><float name='reflectance' value='0'/></bsdf></shape>";
  for (const std::string emitter :
       {"<emitter type='envmap'><string name='filename' value='sun.pfm'/></emitter>",
        "<emitter type='sunsky'/>"}) {
    folder.write("open.xml", receiver + emitter + "</scene>");
    const LoadedScene loaded = load_scene(folder.path / "open.xml");
    RenderJob job(loaded, {});
    job.run(std::atomic<bool>(false));
    const Image picture = job.state().picture();
    const double traced = double(picture.at(0, 0, std::size_t(picture.channel("Y"))));
    EXPECT_NEAR(open_illuminance(*loaded.scene, {0, 1, 0}), traced, 3e-3 * traced) << emitter;
  }
}

}  // namespace
}  // namespace aureole::test
