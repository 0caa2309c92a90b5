// SPDX-License-Identifier: Apache-2.0
// The measurement equation over time: light that flickers, cameras and shapes that move, rolling shutters, and
// quantities over time, in scenes whose answers are known in closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "aureole/render/job.h"
#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

LoadedScene timed_scene(const std::string& content, const std::string& integrator = "path") {
  return load_scene_from_string(
      "<scene version='3.0.0'><integrator type='" + integrator + "'/>" + content + "</scene>", "time.xml",
      {});
}
Image picture_of(const std::string& content, std::int64_t samples, std::uint64_t seed = 1,
                 const std::string& integrator = "path") {
  RenderOptions options;
  options.end = samples, options.seed = seed;
  RenderJob job(timed_scene(content, integrator), options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state().picture();
}
double mean_of(const Image& picture) {
  double sum = 0;
  for (const float v : picture.pixels) sum += double(v);
  return sum / double(picture.pixels.size());
}
/// Within three standard errors, which are less than 0.3 %.
void expect_time_mean(const std::string& content, double expected, std::int64_t samples = 1024,
                      const std::string& integrator = "path") {
  constexpr int kReplicates = 16;
  double sum = 0, squares = 0;
  for (int k = 0; k < kReplicates; ++k) {
    const double mean = mean_of(picture_of(content, samples, std::uint64_t(50 + k), integrator));
    sum += mean, squares += mean * mean;
  }
  const double mean = sum / kReplicates,
               error = std::sqrt(std::max(0.0, squares / kReplicates - mean * mean) / (kReplicates - 1));
  EXPECT_LT(error, 0.003 * expected) << content;
  EXPECT_NEAR(mean, expected, 3 * error + 2e-5 * expected) << content;
}
std::string problem_with(const std::string& content, const std::string& integrator = "path") {
  try {
    RenderJob job(timed_scene(content, integrator), {});
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

std::string film(const std::string& quantity, int width = 1, int height = 1) {
  return "<film type='hdrfilm'><integer name='width' value='" + std::to_string(width) +
         "'/><integer name='height' value='" + std::to_string(height) + "'/><string name='quantity' value='" +
         quantity + "'/><rfilter type='box'/></film>";
}
std::string shutter(double open, double close, const std::string& more = "") {
  return "<float name='shutter_open' value='" + std::to_string(open) +
         "'/><float name='shutter_close' value='" + std::to_string(close) + "'/>" + more;
}
std::string receiver(const std::string& times, const std::string& quantity = "illuminance") {
  return "<sensor type='powermap'><string name='measure' value='irradiance'/><transform name='to_world'>"
         "<scale value='0.001'/></transform>" +
         times + film(quantity) + "</sensor>";
}
const std::string kFar = "<shape type='sphere'><point name='center' x='0' y='0' z='-50'/></shape>";
/// 800 cd at 2 m: 200 lx.
std::string lamp(const std::string& modulation) {
  return kFar +
         "<emitter type='point'><point name='position' x='0' y='0' z='2'/><string name='amount' value='800 cd'/>" +
         modulation + "</emitter>";
}
std::string wave(const std::string& form, double frequency, const std::string& more = "") {
  return "<modulation type='wave'><string name='waveform' value='" + form +
         "'/><float name='frequency' value='" + std::to_string(frequency) + "'/>" + more + "</modulation>";
}
const std::string kPeak = "<string name='reference' value='peak'/>";

TEST(Exposure, WavesOverWholePeriods) {
  // The means of the waves over a period, of a lamp that is stated by its peak.
  const std::pair<const char*, double> forms[] = {
      {"sine", 0.5}, {"rectified", 2 / M_PI}, {"square", 0.5}, {"triangle", 0.5}, {"sawtooth", 0.5}};
  for (const auto& [form, mean] : forms) {
    expect_time_mean(receiver(shutter(0, 0.03)) + lamp(wave(form, 100, kPeak)), 200 * mean);
    // By its mean, which is the default, a lamp of any form is as bright as one that does not flicker.
    expect_time_mean(receiver(shutter(0, 0.03)) + lamp(wave(form, 100)), 200);
  }
}

TEST(Exposure, PartsOfAWave) {
  // 2 ms of a sine of 100 Hz from its minimum: 1/2 - sin(0.4 pi)/(0.8 pi).
  expect_time_mean(receiver(shutter(0, 0.002)) + lamp(wave("sine", 100, kPeak)),
                   200 * (0.5 - std::sin(0.4 * M_PI) / (0.8 * M_PI)));
  // An instant, and the phase.
  expect_time_mean(receiver(shutter(0.005, 0.005)) + lamp(wave("sine", 100, kPeak)), 200, 16);
  expect_time_mean(receiver(shutter(0.0025, 0.0025)) + lamp(wave("sine", 100, kPeak)), 100, 16);
  expect_time_mean(
      receiver(shutter(0, 0)) + lamp(wave("sawtooth", 100, kPeak + "<float name='phase' value='0.25'/>")),
      150, 16);
  // Pulses of a tenth of the period, of which the exposure has the first half; modulated by 80 %.
  expect_time_mean(
      receiver(shutter(0, 0.005)) +
          lamp(wave("square", 100,
                    kPeak + "<float name='duty' value='0.1'/><float name='depth' value='0.8'/>")),
      200 * (0.2 + 0.8 * 0.2));
}

TEST(Exposure, TablesOfTimes) {
  const std::string flash =
      "<modulation type='timetable'><string name='times' value='0, 0.001, 0.003'/><string name='values' value='0, 2, 0'/>";
  expect_time_mean(receiver(shutter(0, 0.003)) + lamp(flash + kPeak + "</modulation>"), 100);
  expect_time_mean(receiver(shutter(-0.003, 0.003)) + lamp(flash + "</modulation>"), 100);
  expect_time_mean(
      receiver(shutter(0, 0.006)) + lamp(flash + "<boolean name='repeat' value='true'/></modulation>"), 200);
  // The last value holds.
  expect_time_mean(
      receiver(shutter(5, 6)) + lamp("<modulation type='timetable'><string name='times' value='0, 0.001'/>"
                                     "<string name='values' value='1, 3'/>" +
                                     kPeak + "</modulation>"),
      200, 16);
}

TEST(Exposure, QuantitiesOverTime) {
  expect_time_mean(receiver(shutter(0, 0.25), "luminous_exposure") + lamp(""), 50, 64);
  expect_time_mean(receiver(shutter(0, 0.005), "luminous_exposure") + lamp(wave("square", 100, kPeak)), 1);
  const std::string watts =
      kFar +
      "<emitter type='point'><point name='position' x='0' y='0' z='2'/><string name='amount' value='100 W/sr'/>";
  expect_time_mean(receiver(shutter(1, 3), "radiant_exposure") + watts + "</emitter>", 50, 64);
  // 4.59773 umol of photons a joule at 550 nm.
  expect_time_mean(receiver(shutter(1, 3), "photon_exposure") + watts +
                       "<spectrum name='intensity' value='549:0, 550:1, 551:0'/></emitter>",
                   50 * 4.59773, 256);
  const std::string camera =
      "<sensor type='perspective'>" + shutter(0, 0.02) + film("time_integrated_luminance") + "</sensor>";
  expect_time_mean(camera + "<emitter type='constant'><string name='amount' value='500 cd/m^2'/></emitter>",
                   10, 64);
}

TEST(Exposure, EmittersOfAllKindsFlicker) {
  // Each is seen at a quarter of its peak at this instant of a sine; by light sampling, by hits and by light paths.
  const std::string dim = wave("sine", 1, kPeak + "<float name='phase' value='0.1666666667'/>");
  const std::string at_once = shutter(0, 0);
  expect_time_mean(receiver(at_once) + "<emitter type='constant'><string name='amount' value='1000 lx'/>" +
                       dim + "</emitter>",
                   250, 256);
  const std::string disc =
      "<shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate z='2'/></transform>"
      "<emitter type='area'><string name='amount' value='1000 cd/m^2'/>" +
      dim + "</emitter></shape>";
  expect_time_mean(receiver(at_once) + disc, 628.3185 / 4, 16384);
}

TEST(Exposure, APointThatMoves) {
  // From straight above at 1 m to 3 m: the mean of 900/z^2 over z is 900 (1/1 - 1/3)/2.
  const std::string moving =
      kFar +
      "<emitter type='point'><string name='amount' value='900 cd'/><animation name='to_world'>"
      "<transform time='0'><translate z='1'/></transform><transform time='2'><translate z='3'/></transform>"
      "</animation></emitter>";
  expect_time_mean(receiver(shutter(0, 2)) + moving, 300);
  expect_time_mean(receiver(shutter(2, 2)) + moving, 100, 16);
}

TEST(Exposure, ACameraThatMovesSweepsOverAnEdge) {
  // A camera of parallel rays moves over the edge of a luminous half-plane: the exposed fraction is linear.
  const auto camera = [](const std::string& integrator_free) {
    return "<sensor type='orthographic'><animation name='to_world'>"
           "<transform time='0'><scale x='0.001' y='0.001'/><translate x='-1' z='5'/></transform>"
           "<transform time='1'><scale x='0.001' y='0.001'/><translate x='3' z='5'/></transform></animation>" +
           integrator_free + film("luminance") + "</sensor>";
  };
  const std::string half_plane =
      "<shape type='rectangle'><transform name='to_world'><scale x='50' y='50'/><rotate x='1' angle='180'/>"
      "<translate x='50' z='8'/></transform><emitter type='area'><string name='amount' value='100 cd/m^2'/></emitter></shape>";
  expect_time_mean(camera(shutter(0, 1)) + half_plane, 75);
  expect_time_mean(camera(shutter(0, 0.5)) + half_plane, 50);
  // After the last key frame it stands still.
  expect_time_mean(camera(shutter(0, 2)) + half_plane, 87.5);
}

TEST(Exposure, LightPathsSeeAMovingCameraAsItsOwnPathsDo) {
  const std::string scene =
      "<sensor type='perspective'><float name='fov' value='30'/><animation name='to_world'>"
      "<transform time='0'><lookat origin='-1, 0.5, -4' target='0, 0, 0' up='0, 1, 0'/></transform>"
      "<transform time='1'><lookat origin='2, 0.2, -4' target='0.2, 0, 0' up='0, 1, 0'/></transform></animation>" +
      shutter(0, 1) + film("luminance") +
      "</sensor><shape type='sphere'/>"
      "<emitter type='point'><point name='position' x='3' y='4' z='-4'/><string name='amount' value='100 cd'/>" +
      wave("sine", 1) + "</emitter>";
  const auto reading = [&](const char* integrator) {
    double sum = 0, squares = 0;
    for (int k = 0; k < 16; ++k) {
      const double m = mean_of(picture_of(scene, 65536, std::uint64_t(k), integrator));
      sum += m, squares += m * m;
    }
    const double mean = sum / 16;
    return std::pair(mean, std::sqrt(std::max(0.0, squares / 16 - mean * mean) / 15));
  };
  const auto path = reading("path"), light = reading("ptracer"), both = reading("bdpt");
  EXPECT_LT(path.second, 0.003 * path.first);
  EXPECT_LT(light.second, 0.03 * path.first);
  EXPECT_NEAR(light.first, path.first, 3.5 * std::hypot(light.second, path.second));
  EXPECT_NEAR(both.first, path.first, 3.5 * std::hypot(both.second, path.second));
}

/// A square of that half-width that turns about the z axis, or moves, before a luminous background.
std::string moving_square(const std::string& frames) {
  return "<shape type='shapegroup' id='group'><shape type='rectangle'><transform name='to_world'>"
         "<rotate x='1' angle='180'/></transform><bsdf type='diffuse'/></shape></shape>"
         "<shape type='instance'><ref id='group'/><animation name='to_world'>" +
         frames +
         "</animation></shape><emitter type='constant'><string name='amount' value='100 cd/m^2'/></emitter>";
}
std::string narrow_camera(double x, const std::string& times) {
  return "<sensor type='orthographic'><transform name='to_world'><scale x='0.001' y='0.001'/><translate x='" +
         std::to_string(x) + "' z='-5'/></transform>" + times + film("luminance") + "</sensor>";
}

TEST(Exposure, AShapeThatMovesCoversTheBackground) {
  // The square is 2 wide and moves by 4: it covers the middle of its path for half of the time.
  const std::string frames =
      "<transform time='0'><translate x='-2'/></transform><transform time='1'><translate x='2'/></transform>";
  const auto seen = [&](double x, const std::string& times) {
    return narrow_camera(x, times) + moving_square(frames);
  };
  // The square of reflectance 1/2 reflects half of the sky's luminance.
  expect_time_mean(seen(0, shutter(0, 1)), 100 * (0.5 + 0.5 * 0.5));
  expect_time_mean(seen(0, shutter(0, 0.25)), 100, 64);
  expect_time_mean(seen(0, shutter(0.4, 0.6)), 50, 64);
  expect_time_mean(seen(1.5, shutter(0, 1)), 100 * (1 - 0.5 * 0.375));
}

TEST(Exposure, AShapeThatTurns) {
  // A square of half-width 1 that turns by a right angle: at the radius r between 1 and sqrt(2) it covers a point on
  // the x axis while the angle to the nearest corner is less than pi/4 - acos(1/r).
  const std::string frames =
      "<transform time='0'/><transform time='1'><rotate z='1' angle='90'/></transform>";
  const double r = 1.2, covered = 1 - 4 / M_PI * std::acos(1 / r);
  expect_time_mean(narrow_camera(r, shutter(0, 1)) + moving_square(frames), 100 * (1 - 0.5 * covered), 4096);
}

TEST(Exposure, MovingShapesCastMovingShadows) {
  // The point lamp above the receiver is occluded by the square while that passes between them.
  const std::string frames =
      "<transform time='0'><translate x='-2' z='1'/></transform>"
      "<transform time='1'><translate x='2' z='1'/></transform>";
  const std::string square =
      "<shape type='shapegroup' id='group'><shape type='rectangle'/></shape><shape type='instance'><ref id='group'/>"
      "<animation name='to_world'>" +
      frames + "</animation></shape>";
  const std::string black =
      "<shape type='shapegroup' id='group'><shape type='rectangle'><bsdf type='diffuse'><float name='reflectance' "
      "value='0'/></bsdf></shape></shape><shape type='instance'><ref id='group'/><animation name='to_world'>" +
      frames + "</animation></shape>";
  expect_time_mean(receiver(shutter(0, 1)) + lamp("") + black, 100);
  expect_time_mean(receiver(shutter(0, 0.2)) + lamp("") + black, 200, 64);
  EXPECT_EQ(problem_with(receiver(shutter(0, 1)) + lamp("") + square), "");
}

TEST(Exposure, RollingShutterReadsRowByRow) {
  // Under a sawtooth of the readout's length each row sees another phase: row y of 8 at y/7 of the period.
  const auto camera = [](const std::string& direction) {
    return "<sensor type='perspective'>" +
           shutter(0, 0,
                   "<float name='readout_time' value='0.0875'/><string name='readout_direction' value='" +
                       direction + "'/>") +
           film("luminance", 2, 8) + "</sensor>";
  };
  const std::string sky = "<emitter type='constant'><string name='amount' value='100 cd/m^2'/>" +
                          wave("sawtooth", 10, kPeak) + "</emitter>";
  for (const bool up : {false, true}) {
    const Image p = picture_of(camera(up ? "up" : "down") + sky, 64);
    for (int y = 0; y < 8; ++y) {
      const double expected = 100 * (1 - 0.0125 * (up ? 7 - y : y) / 0.1);
      EXPECT_NEAR(double(p.pixels[std::size_t(2 * y)]), expected, 0.1) << y;
    }
  }
  EXPECT_NE(problem_with(camera("down") + sky + kFar, "ptracer").find("readout_time"), std::string::npos);
}

TEST(Exposure, AStaticSceneHasTheSamePictureWithAShutter) {
  const auto scene = [](const std::string& times) {
    return "<sensor type='perspective'>" + times + film("luminance", 8, 8) +
           "</sensor><shape type='sphere'><point name='center' x='0' y='0' z='4'/></shape><emitter type='constant'/>";
  };
  EXPECT_EQ(picture_of(scene(""), 4).pixels, picture_of(scene(shutter(0, 1)), 4).pixels);
}

TEST(Exposure, MistakesAreNamed) {
  const auto has = [](const std::string& content, const std::string& words,
                      const std::string& integrator = "path") {
    const std::string message = problem_with(content, integrator);
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_NE(message.find("time.xml:"), std::string::npos) << message;
  };
  has(receiver(shutter(1, 0.5)) + lamp(""), "must not be before shutter_open");
  has(receiver("", "luminous_exposure") + lamp(""), "integral over the exposure");
  has(receiver(shutter(0, 1)) + lamp(wave("sine", 0)), "frequency");
  has(receiver(shutter(0, 1)) + lamp(wave("sine", 5) + wave("sine", 6)), "one modulation");
  has(receiver(shutter(0, 1)) + lamp(wave("saw", 5)), "sawtooth");
  const auto table = [](const std::string& times, const std::string& values) {
    return receiver(shutter(0, 1)) +
           lamp("<modulation type='timetable'><string name='times' value='" + times +
                "'/><string name='values' value='" + values + "'/></modulation>");
  };
  has(table("0", "1"), "at least two");
  has(table("0, 1", "1"), "one value for each");
  has(table("0, 1", "1, -1"), "negative");
  has(table("1, 0", "1, 1"), "must not decrease");
  has(table("0, 1", "0, 0"), "never shine");
  const auto camera = [](const std::string& animation) {
    return "<sensor type='perspective'><animation name='to_world'>" + animation + "</animation></sensor>" +
           kFar + "<emitter type='constant'/>";
  };
  has(camera(""), "at least one");
  has(camera("<transform time='1'/><transform time='0'><translate x='1'/></transform>"), "must increase");
  has(camera("<transform/>"), "time");
  has(camera("<transform time='soon'/>"), "time");
  has(camera("<translate x='1'/>"), "<animation> can't contain <translate>");
  has(camera("<transform time='0'/><transform time='1'><scale value='2'/></transform>"),
      "must not be scaled");
  has("<sensor type='perspective'/><shape type='sphere'><animation name='to_world'><transform time='0'/>"
      "<transform time='1'><translate x='1'/></transform></animation></shape><emitter type='constant'/>",
      "cannot move");
}

std::string moving(const std::string& first, const std::string& last) {
  return "<animation name='to_world'><transform time='0'>" + first + "</transform><transform time='1'>" +
         last + "</transform></animation>";
}
/// A disc of 1000 cd/m^2 and radius 1 that faces the receiver, in an instance.
std::string disc_lamp(const std::string& place) {
  return "<shape type='shapegroup' id='lamp'><shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/></transform>"
         "<emitter type='area'><string name='amount' value='1000 cd/m^2'/></emitter></shape></shape>"
         "<shape type='instance'><ref id='lamp'/>" +
         place + "</shape>";
}

TEST(Exposure, ShapesThatShineInInstances) {
  // E = pi L r^2/(r^2 + h^2), at rest, and in the mean over heights from 2 to 3: pi L (atan 3 - atan 2).
  const std::string rest = disc_lamp("<transform name='to_world'><translate z='2'/></transform>"),
                    rising = disc_lamp(moving("<translate z='2'/>", "<translate z='3'/>"));
  for (const char* integrator : {"path", "bdpt"}) {
    expect_time_mean(receiver("") + kFar + rest, 200 * M_PI, 256, integrator);
    expect_time_mean(receiver(shutter(0, 1)) + kFar + rising, 1000 * M_PI * (std::atan(3.0) - std::atan(2.0)),
                     1024, integrator);
  }
  // Light paths: on a receiver that is large enough for them.
  const auto wide = [](const std::string& times) {
    return "<sensor type='powermap'><string name='measure' value='irradiance'/><transform name='to_world'><scale value='0.5'/>"
           "</transform>" +
           times + film("illuminance") + "</sensor>";
  };
  const double by_paths = mean_of(picture_of(wide(shutter(0, 1)) + kFar + rising, 65536, 3, "path")),
               by_light = mean_of(picture_of(wide(shutter(0, 1)) + kFar + rising, 65536, 3, "ptracer"));
  EXPECT_NEAR(by_light, by_paths, 0.01 * by_paths);
  // Two instances are two lamps: beside each other, from above and from a wall.
  expect_time_mean(
      receiver("") + kFar + rest +
          "<shape type='instance'><ref id='lamp'/><transform name='to_world'><translate x='5' z='2'/></transform></shape>",
      200 * M_PI +
          mean_of(picture_of(
              receiver("") + kFar +
                  "<shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate x='5' z='2'/></transform>"
                  "<emitter type='area'><string name='amount' value='1000 cd/m^2'/></emitter></shape>",
              65536)),
      1024);
}

TEST(Exposure, LampsThatMove) {
  // 100 cd at the height of 2, from x = -1 to 1: the mean of 2 I (4 + x^2)^(-3/2) is I/(2 sqrt(5)).
  const std::string from = "<translate x='-1' z='2'/>", to = "<translate x='1' z='2'/>";
  // A spot whose beam is as wide as the half-space points down all the time.
  const std::string down = "<rotate x='1' angle='180'/>";
  for (const char* integrator : {"path", "bdpt"})
    expect_time_mean(
        receiver(shutter(0, 1)) + kFar +
            "<emitter type='spot'><float name='cutoff_angle' value='80'/><float name='beam_width' value='80'/>"
            "<string name='amount' value='100 cd'/>" +
            moving(down + from, down + to) + "</emitter>",
        100 / (2 * std::sqrt(5.0)), 1024, integrator);
  // A spot that turns: its beam of 10 degrees passes the receiver while the axis is within 10 of 90 degrees of its turn.
  expect_time_mean(
      receiver(shutter(0, 1)) + kFar +
          "<emitter type='spot'><float name='cutoff_angle' value='10'/><float name='beam_width' value='10'/>"
          "<string name='amount' value='100 cd'/>" +
          moving("<rotate x='1' angle='135'/><translate z='2'/>",
                 "<rotate x='1' angle='225'/><translate z='2'/>") +
          "</emitter>",
      25.0 * 20 / 90, 4096);
  EXPECT_NE(problem_with(receiver(shutter(0, 1)) + kFar + "<emitter type='spot'>" +
                         moving("", "<scale value='2'/>") + "</emitter>")
                .find("must not be scaled or sheared while it moves"),
            std::string::npos);
  EXPECT_NE(problem_with(receiver(shutter(0, 1)) + kFar +
                         disc_lamp("<transform name='to_world'><scale value='2'/></transform>"))
                .find("may be turned and moved, but not scaled"),
            std::string::npos);
  EXPECT_NE(problem_with(receiver(shutter(0, 1)) + kFar + "<emitter type='directional'>" +
                         moving("", "<rotate x='1' angle='20'/>") + "</emitter>")
                .find("to_world"),
            std::string::npos);
}

TEST(Exposure, ShortPulsesAreFound) {
  // A pulse of 5 us in an exposure of 0.1 s: even times find it in one of 20000 paths.
  const std::string pulse =
      "<modulation type='timetable'><string name='times' value='0, 0.02, 0.02, 0.020005, 0.020005, 0.1'/>"
      "<string name='values' value='0, 0, 1, 1, 0, 0'/>" +
      kPeak + "</modulation>";
  expect_time_mean(receiver(shutter(0, 0.1)) + lamp(pulse), 200 * 5e-5, 256);
  // Pulses of 1 % of each period, and a rolling shutter, whose rows see other pulses.
  const std::string pulses =
      wave("square", 100, kPeak + "<float name='duty' value='0.01'/><float name='phase' value='0.3'/>");
  expect_time_mean(receiver(shutter(0, 0.1)) + lamp(pulses), 2, 256);
  // A steady lamp beside it keeps its light: two lux each. Paths choose the lamp that emits at their time.
  expect_time_mean(
      receiver(shutter(0, 0.1)) + lamp(pulses) +
          "<emitter type='point'><point name='position' x='0' y='0' z='1'/><string name='amount' value='2 cd'/></emitter>",
      4, 256);
  for (const char* integrator : {"bdpt"})
    expect_time_mean(receiver(shutter(0, 0.1)) + lamp(pulses), 2, 1024, integrator);
}

// A pulsed and a steady ball of equal power over a white floor. Rays of the BSDF find them as often as light sampling does, so that MIS weights
// are right only if all of its densities are those at the time of the path. A ball of the angular radius alpha gives pi L sin^2(alpha)
// cos(theta).
TEST(Exposure, BallsThatFlashBesideSteadyOnes) {
  const auto ball = [](double x, const std::string& modulation) {
    return "<shape type='sphere'><point name='center' x='" + std::to_string(x) +
           "' y='0' z='2'/><bsdf type='diffuse'><float name='reflectance' value='0'/></bsdf>"
           "<emitter type='area'><string name='amount' value='1000 cd/m^2'/>" +
           modulation + "</emitter></shape>";
  };
  const std::string scene =
      "<sensor type='perspective'><float name='fov' value='0.5'/><transform name='to_world'>"
      "<lookat origin='0, 0, 6' target='0, 0, 0' up='0, 1, 0'/></transform>" +
      shutter(0, 0.1) + film("luminance") +
      "</sensor><shape type='rectangle'><transform name='to_world'><scale value='0.2'/></transform>"
      "<bsdf type='diffuse'><float name='reflectance' value='1'/></bsdf></shape>" +
      ball(-2, wave("square", 100, "<float name='duty' value='0.1'/>")) + ball(2, "");
  const double of_both = 2 * 1000 * (1.0 / 8) * std::sqrt(0.5);
  for (const char* integrator : {"path", "direct", "bdpt"})
    expect_time_mean(scene, of_both, 4096, integrator);
}

// Light by the edge of a sheet in whose shadow the floor lies, from two lamps at one place: as much as from steady ones where one of them
// has ten times its mean power in a tenth of the time. Edges choose among the lamps by their powers at the time of the path.
TEST(Exposure, EdgesChooseLampsThatEmit) {
  const auto scene = [](const std::string& modulations) {
    return "<sensor type='orthographic'><transform name='to_world'><scale x='0.004' y='0.004'/>"
           "<lookat origin='-0.0055, 0.3, -0.5' target='-0.0055, 0.3, -1' up='0, 1, 0'/></transform>" +
           shutter(0, 1) +
           "<film type='specfilm'><integer name='width' value='1'/><integer name='height' value='1'/><rfilter type='box'/>"
           "<float name='wavelength_min' value='549'/><float name='wavelength_max' value='551'/><integer name='bins' value='1'/>"
           "<boolean name='preview' value='false'/></film></sensor>"
           "<shape type='rectangle'><transform name='to_world'><scale value='9'/><translate z='-1'/></transform>"
           "<bsdf type='diffuse'><spectrum name='reflectance' value='1'/></bsdf></shape>"
           "<shape type='rectangle'><transform name='to_world'><scale value='5'/><translate x='-5'/></transform>"
           "<bsdf type='diffuse'><spectrum name='reflectance' value='0'/></bsdf></shape>" +
           modulations;
  };
  const auto lamp_at_time = [](const std::string& modulation) {
    return "<emitter type='point'><point name='position' x='0' y='0.3' z='1'/><spectrum name='intensity' value='1'/>" +
           modulation + "</emitter>";
  };
  const auto runs = [&](const std::string& lamps) {
    constexpr int kReplicates = 16;
    double sum = 0, squares = 0;
    for (int k = 0; k < kReplicates; ++k) {
      RenderOptions options;
      options.end = 2048, options.seed = std::uint64_t(90 + k);
      RenderJob job(
          load_scene_from_string(
              "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='3'/>"
              "<boolean name='diffraction' value='true'/><string name='diffraction_model' value='beams'/>"
              "<string name='beam_width' value='fresnel 0.5m'/></integrator>" +
                  scene(lamps) + "</scene>",
              "edge.xml", {}),
          options);
      job.run(std::atomic<bool>(false));
      const double mean = mean_of(job.state().picture());
      sum += mean, squares += mean * mean;
    }
    const double mean = sum / kReplicates;
    return std::array{mean,
                      std::sqrt(std::max(0.0, squares / kReplicates - mean * mean) / (kReplicates - 1))};
  };
  // Pulses of a tenth of the time and steady light, of equal mean power.
  const auto [steady, steady_error] = runs(lamp_at_time("") + lamp_at_time(""));
  const auto [pulsed, pulsed_error] =
      runs(lamp_at_time("") + lamp_at_time(wave("square", 2, "<float name='duty' value='0.1'/>")));
  EXPECT_GT(steady, 0);
  EXPECT_LT(steady_error, 0.005 * steady);
  EXPECT_LT(pulsed_error, 0.005 * pulsed);
  EXPECT_NEAR(pulsed, steady, 3 * std::hypot(pulsed_error, steady_error));
}

}  // namespace
}  // namespace aureole::test
