// SPDX-License-Identifier: Apache-2.0
// Power maps in scenes whose answers are known, and against each other by paths from the sensor and from the light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/render/job.h"
#include "aureole/render/statistics.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/shape/mesh/uv_index.h"
#include "harness/properties_builder.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

using testing::build_object;

std::string film(int width, int height) {
  return "<film type='hdrfilm'><integer name='width' value='" + std::to_string(width) +
         "'/><integer name='height' value='" + std::to_string(height) +
         "'/><string name='pixel_format' value='luminance'/><string name='response' value='uniform'/>"
         "<string name='component_format' value='float32'/></film>";
}
std::string map(const std::string& to_world, const std::string& measure, int width = 6, int height = 4) {
  return "<sensor type='powermap'><transform name='to_world'>" + to_world +
         "</transform><string name='measure' value='" + measure + "'/>" + film(width, height) + "</sensor>";
}
LoadedScene scene(const std::string& integrator, const std::string& content) {
  return load_scene_from_string("<scene version='3.0.0'>" + integrator + content + "</scene>", "map.xml", {});
}
Image picture(const std::string& integrator, const std::string& content, std::int64_t samples,
              int replicates = 1) {
  RenderOptions options;
  options.end = samples, options.replicates = replicates;
  options.seed = integrator.size();  // both find some light by the same samples
  RenderJob job(scene("<integrator type='" + integrator + "'/>", content), options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state().picture();
}
std::string error(const std::string& content) {
  try {
    scene("<integrator type='path'/>", content);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

constexpr const char* kLamp =
    "<emitter type='point'><point name='position' x='0.4' y='-0.3' z='2'/>"
    "<spectrum name='intensity' value='3'/></emitter>";
constexpr const char* kWide = "<scale x='3' y='2'/>";

/// The mean over a cell of the map kWide of f(x, y), by the midpoint rule.
template <class F>
double mean_of_cell(int column, int row, const F& f) {
  constexpr int kSteps = 40;
  double sum = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i)
      sum += f(-3 + (column + (i + 0.5) / kSteps), 2 - (row + (j + 0.5) / kSteps));
  return sum / (kSteps * kSteps);
}

TEST(PowerMap, APointSendsItsPowerOverASphere) {
  for (const std::string measure : {"fluence", "irradiance"})
    for (const char* integrator : {"path", "ptracer", "bdpt", "direct"}) {
      const Image map_image = picture(integrator, map(kWide, measure) + kLamp, 256);
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 6; ++x) {
          const double expected = mean_of_cell(x, y, [&](double a, double b) {
            const double r2 = (a - 0.4) * (a - 0.4) + (b + 0.3) * (b + 0.3) + 4;
            return 3 / r2 * (measure == "irradiance" ? 2 / std::sqrt(r2) : 1);
          });
          EXPECT_NEAR(map_image.at(x, y, 0), expected, 0.01 * expected)
              << measure << " " << integrator << " " << x << " " << y;
        }
    }
}

/// Irradiance of a horizontal point from a horizontal square of side 2 `half` at the height h above the point, of radiance 1:
/// pi times the view factor, a sum over its corners.
double irradiance_of_square(double x, double y, double h, double half) {
  const auto corner = [&](double a, double b) {
    const double p = std::hypot(a, h), q = std::hypot(b, h);
    return 0.5 * (a / p * std::atan(b / p) + b / q * std::atan(a / q));
  };
  return corner(half - x, half - y) + corner(half + x, half - y) + corner(half - x, half + y) +
         corner(half + x, half + y);
}

// Lights with a shape, small and near, are found by light sampling at the receivers and by their rays, weighted against each
// other: rays alone find the small one with one of 2,000 samples and less.
TEST(PowerMap, FindsLightsWithAShapeByLightSampling) {
  for (const auto& [half, height] : {std::pair(0.02, 1.0), {1.5, 0.25}}) {
    const std::string lamp = "<shape type='rectangle'><transform name='to_world'><scale value='" +
                             std::to_string(half) + "'/><rotate x='1' angle='180'/><translate x='0.5' z='" +
                             std::to_string(height) +
                             "'/></transform><emitter type='area'><spectrum name='radiance' value='2'/>"
                             "</emitter></shape>";
    for (const char* integrator : {"path", "ptracer", "bdpt", "direct"}) {
      const Image map_image = picture(integrator, map(kWide, "irradiance") + lamp, 512, 8);
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 6; ++x) {
          const double expected = mean_of_cell(
              x, y, [&](double a, double b) { return 2 * irradiance_of_square(a - 0.5, b, height, half); });
          EXPECT_NEAR(map_image.at(x, y, 0), expected, 0.04 * expected + 1e-3)
              << half << " " << integrator << " " << x << " " << y;
        }
    }
  }
}

// A sky with a bright spot beside even light, and a receiver of each measure: the means of both techniques agree, so that the sum
// of the weights is 1.
TEST(PowerMap, WeightsOfRaysAndLightSamplingSumToOne) {
  const std::string lights =
      "<emitter type='constant'><spectrum name='radiance' value='0.5'/></emitter>"
      "<shape type='sphere'><point name='center' x='0.5' y='0.3' z='1.5'/><float name='radius' value='0.5'/>"
      "<emitter type='area'><spectrum name='radiance' value='4'/></emitter></shape>";
  for (const std::string measure : {"fluence", "irradiance", "cylindrical", "semicylindrical"}) {
    const Image by_sum = picture("path", map(kWide, measure) + lights, 256, 16);
    // Rays alone: lights with the weight 0 are never sampled.
    std::string unsampled = lights;
    for (std::size_t at = 0; (at = unsampled.find("</emitter>", at)) != std::string::npos; at += 60)
      unsampled.insert(at, "<float name='sampling_weight' value='0'/>");
    const Image by_rays = picture("path", map(kWide, measure) + unsampled, 256, 16);
    const Comparison c = compare_images(by_sum, by_rays);
    ASSERT_TRUE(c.z);
    EXPECT_LT(c.z->mean_square, 2.5) << measure;
    EXPECT_LT(std::abs(c.z->mean_difference), 4) << measure;
    EXPECT_NEAR(c.mean_a, c.mean_b, 0.01 * c.mean_b) << measure;
  }
}

TEST(PowerMap, IrradianceIsThatOfOneSide) {
  const Image from_below =
      picture("path", map(std::string(kWide) + "<rotate x='1' angle='180'/>", "irradiance") + kLamp, 4);
  for (const float v : from_below.pixels) EXPECT_EQ(v, 0);
  // Of everything around, half the fluence's directions and a quarter of its value.
  const std::string sky = "<emitter type='constant'><spectrum name='radiance' value='2'/></emitter>";
  const Image all = picture("path", map(kWide, "fluence") + sky, 16);
  const Image side = picture("ptracer", map(kWide, "irradiance") + sky, 1024);
  for (int i = 0; i < 24; ++i) {
    EXPECT_NEAR(all.pixels[size_t(i)], 8 * M_PI, 1e-4);
    EXPECT_NEAR(side.pixels[size_t(i)], 2 * M_PI, 1e-4);
  }
}

TEST(PowerMap, ShadowsFallOnIt) {
  const std::string screen =
      "<shape type='rectangle'><transform name='to_world'><scale x='9' y='9'/><translate x='9.5' z='1'/>"
      "</transform><bsdf type='diffuse'><float name='reflectance' value='0'/></bsdf></shape>";
  for (const char* integrator : {"path", "ptracer", "bdpt"}) {
    const Image seen = picture(integrator, map(kWide, "fluence") + kLamp + screen, 64);
    // The shadow of the screen's edge x = 0.5 lies at x = 0.6.
    for (int y = 0; y < 4; ++y) {
      EXPECT_GT(seen.at(2, y, 0), 0.3) << integrator;
      EXPECT_EQ(seen.at(4, y, 0), 0) << integrator;
    }
  }
}

// A lamp before a mirror and its image behind it; a small ball for rays of the sensor, which meet no point.
TEST(PowerMap, AMirrorShowsTheLampOnceMore) {
  const std::string mirror =
      "<shape type='rectangle'><transform name='to_world'><scale value='100'/><translate z='-1'/></transform>"
      "<bsdf type='conductor'/></shape>";
  const auto both = [](double a, double b) {
    const double across = (a - 0.4) * (a - 0.4) + (b + 0.3) * (b + 0.3);
    return 3 / (across + 4) + 3 / (across + 16);
  };
  const Image by_light = picture("ptracer", map(kWide, "fluence") + mirror + kLamp, 20000);
  const std::string ball =
      "<shape type='sphere'><point name='center' x='0.4' y='-0.3' z='2'/><float name='radius' value='0.3'/>"
      "<emitter type='area'><spectrum name='radiance' value='" +
      std::to_string(3 / (M_PI * 0.09)) + "'/></emitter></shape>";
  const Image by_rays = picture("path", map(kWide, "fluence") + mirror + ball, 40000);
  double sum = 0, sum_by_rays = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x) {
      const double expected = mean_of_cell(x, y, both);
      EXPECT_NEAR(by_light.at(x, y, 0), expected, 0.02 * expected) << x << " " << y;
      sum += expected, sum_by_rays += by_rays.at(x, y, 0);
    }
  EXPECT_NEAR(sum_by_rays, sum, 0.04 * sum);  // some 5000 rays hit the ball
  // The edges of a path are counted: mirrored light has two.
  const auto limited = [&](int depth) {
    RenderOptions options;
    options.end = 64;
    RenderJob job(scene("<integrator type='ptracer'><integer name='max_depth' value='" +
                            std::to_string(depth) + "'/></integrator>",
                        map(kWide, "fluence") + mirror + kLamp),
                  options);
    job.run(std::atomic<bool>(false));
    return job.state().picture().at(2, 1, 0);
  };
  const double direct = mean_of_cell(
      2, 1, [](double a, double b) { return 3 / ((a - 0.4) * (a - 0.4) + (b + 0.3) * (b + 0.3) + 4); });
  EXPECT_NEAR(limited(1), direct, 0.02 * direct);
  EXPECT_GT(limited(2), 1.1 * direct);
}

TEST(PowerMap, EachMapOfABatchSeesTheMirror) {
  const std::string mirror =
      "<shape type='rectangle'><transform name='to_world'><scale value='100'/><translate z='-1'/></transform>"
      "<bsdf type='conductor'/></shape>";
  // One map two times: all mirrored light passes both.
  const auto one = [](const char* id) {
    return "<sensor type='powermap' id='" + std::string(id) +
           "'><transform name='to_world'><scale x='3' y='2'/></transform></sensor>";
  };
  const Image both = picture(
      "ptracer", "<sensor type='batch'>" + one("a") + one("b") + film(12, 4) + "</sensor>" + mirror + kLamp,
      4000);
  double left = 0, right = 0, expected = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x) {
      left += both.at(x, y, 0), right += both.at(x + 6, y, 0);
      expected += mean_of_cell(x, y, [](double a, double b) {
        const double across = (a - 0.4) * (a - 0.4) + (b + 0.3) * (b + 0.3);
        return 3 / (across + 4) + 3 / (across + 16);
      });
    }
  EXPECT_NEAR(left, expected, 0.02 * expected);
  EXPECT_NEAR(right, expected, 0.02 * expected);
}

// No connection finds a beam, which the map counts where it passes, also at the first edge of its path.
TEST(PowerMap, ABeamOfParallelLightIsCounted) {
  const std::string beam =
      "<shape type='rectangle'><transform name='to_world'><scale x='5' y='5'/><rotate x='1' angle='180'/>"
      "<translate z='2'/></transform><emitter type='directionalarea'><spectrum name='radiance' value='3'/>"
      "</emitter></shape>";
  const auto mean_by = [&](const std::string& parameters, const std::string& more = "") {
    RenderOptions options;
    options.end = 2000;
    RenderJob job(scene("<integrator type='ptracer'>" + parameters + "</integrator>",
                        map(kWide, "fluence") + beam + more),
                  options);
    job.run(std::atomic<bool>(false));
    double sum = 0;
    for (int i = 0; i < 24; ++i) sum += job.state().picture().at(i % 6, i / 6, 0) / 24;
    return sum;
  };
  const std::string limit = "<integer name='max_depth' value='1'/>";
  EXPECT_NEAR(mean_by(""), 3, 0.1);
  EXPECT_NEAR(mean_by(limit), 3, 0.1);
  EXPECT_EQ(mean_by("<boolean name='hide_emitters' value='true'/>"), 0);
  EXPECT_EQ(mean_by("<integer name='max_depth' value='0'/>"), 0);
  // Light from infinity arrives at the receivers by connections, once.
  EXPECT_NEAR(mean_by(limit,
                      "<emitter type='directional'><vector name='direction' x='0' y='0' z='1'/>"
                      "<spectrum name='irradiance' value='2'/></emitter>"),
              5, 0.2);
}

/// All that light does on its way: a diffuse floor, a mirror, rough metal, a lamp with a size.
const std::string kRoom =
    "<shape type='rectangle'><transform name='to_world'><scale value='4'/></transform><bsdf type='diffuse'>"
    "<spectrum name='reflectance' value='0.7'/></bsdf></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='0.8'/><rotate y='1' angle='30'/>"
    "<translate x='-1.5' z='0.5'/></transform><bsdf type='conductor'/></shape>"
    "<shape type='cube'><transform name='to_world'><scale value='0.4'/><rotate z='1' angle='30'/><translate x='1.5' "
    "y='1' z='0.4'/></transform><bsdf type='roughconductor'><float name='alpha' value='0.4'/></bsdf></shape>"
    "<shape type='sphere'><point name='center' x='0.4' y='-0.6' z='2.2'/><float name='radius' value='0.4'/>"
    "<emitter type='area'><spectrum name='radiance' value='5'/></emitter></shape>";

TEST(PowerMap, IsTheSameByPathsOfLight) {
  for (const std::string measure : {"fluence", "irradiance"}) {
    const std::string content =
        map(std::string(kWide) + "<rotate x='1' angle='175'/><translate z='1.3'/>", measure) + kRoom;
    const Image reference = picture("path", content, 256, 32);
    for (const char* integrator : {"ptracer", "bdpt"}) {
      const Image other = picture(integrator, content, 256, 32);
      const Comparison c = compare_images(other, reference);
      ASSERT_TRUE(c.z);
      EXPECT_LT(c.z->mean_square, 2.5) << integrator << " " << measure;  // of 24 cells, some correlated
      EXPECT_LT(std::abs(c.z->mean_difference), 4) << integrator << " " << measure;
      EXPECT_NEAR(c.mean_a, c.mean_b, 0.015 * c.mean_b) << integrator << " " << measure;
    }
  }
}

TEST(PowerMap, OnAShapeDividesItsTextureCoordinates) {
  // A sphere around a lamp that is not at its centre; a mesh and a disc before it.
  const double x = 0.2;
  const std::string lamp =
      "<emitter type='point'><point name='position' x='0.2' y='0' z='0'/><spectrum name='intensity' "
      "value='3'/></emitter>";
  const std::string on = "<bsdf type='null'/><sensor type='powermap'>" + film(8, 6) + "</sensor>";
  const Image ball =
      picture("path", "<shape type='sphere'><float name='radius' value='2'/>" + on + "</shape>" + lamp, 256);
  const Image by_light = picture(
      "ptracer", "<shape type='sphere'><float name='radius' value='2'/>" + on + "</shape>" + lamp, 256);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 8; ++column) {
      double expected = 0, area = 0;
      for (int k = 0; k < 400; ++k) {
        const double phi = 2 * M_PI * (column + (k % 20 + 0.5) / 20) / 8,
                     theta = M_PI * (row + (k / 20 + 0.5) / 20) / 6;
        expected += std::sin(theta) * 3 / (4 + x * x - 4 * x * std::sin(theta) * std::cos(phi));
        area += std::sin(theta);
      }
      expected /= area;
      EXPECT_NEAR(ball.at(column, row, 0), expected, 0.005 * expected) << column << " " << row;
      EXPECT_NEAR(by_light.at(column, row, 0), expected, 0.005 * expected) << column << " " << row;
    }
  const std::string places = "<translate x='0.3' z='-1.5'/>";
  const auto at = [&](const std::string& shape) {
    return picture("path",
                   "<shape type='" + shape + "'><transform name='to_world'>" + places + "</transform>" + on +
                       "</shape>" + lamp,
                   256);
  };
  const Image square = at("rectangle"), disc = at("disk"), tube = at("cylinder");
  const auto fluence = [&](double px, double py, double pz) {
    return 3 / ((px - x) * (px - x) + py * py + pz * pz);
  };
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 8; ++column) {
      const double u = (column + 0.5) / 8, v = (row + 0.5) / 6, phi = 2 * M_PI * v, around = 2 * M_PI * u;
      // Cells are small: their middle is within some percent.
      EXPECT_NEAR(square.at(column, row, 0), fluence(0.3 + 2 * u - 1, 2 * v - 1, -1.5), 0.02);
      EXPECT_NEAR(disc.at(column, row, 0), fluence(0.3 + u * std::cos(phi), u * std::sin(phi), -1.5), 0.02);
      EXPECT_NEAR(tube.at(column, row, 0), fluence(0.3 + std::cos(around), std::sin(around), -1.5 + v), 0.1);
    }
}

// Texture coordinates that repeat a picture a hundred times over many triangles: memory stays within bounds, and each place
// has the triangle that holds it.
TEST(PowerMap, TextureCoordinatesFindTheirTriangle) {
  SeededRandom random(5);
  std::vector<UvIndex::Triangle> repeated;
  for (int i = 0; i < 20000; ++i) repeated.push_back({Vec2{-50, -50}, {60, -50}, {5, 70}});
  EXPECT_EQ(UvIndex(repeated).find({0.3f, 0.4f})->triangle, 0u);
  std::vector<UvIndex::Triangle> lattice;
  constexpr int kSide = 30;
  for (int i = 0; i < kSide * kSide; ++i) {
    const float x = float(i % kSide) / kSide, y = float(i / kSide) / kSide, h = 1.f / kSide;
    lattice.push_back({Vec2{x, y}, {x + h, y}, {x, y + h}});
  }
  const UvIndex index(lattice);
  int found = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec2 uv = random.next2();
    const auto place = index.find(uv);
    const float x = uv.x * kSide - std::floor(uv.x * kSide), y = uv.y * kSide - std::floor(uv.y * kSide);
    if (std::abs(x + y - 1) < 1e-3f) continue;
    ASSERT_EQ(place.has_value(), x + y < 1);
    if (!place) continue;
    ++found;
    EXPECT_EQ(place->triangle, std::uint32_t(uv.y * kSide) * kSide + std::uint32_t(uv.x * kSide));
    EXPECT_NEAR(place->barycentric.x, x, 1e-3f);
    EXPECT_NEAR(place->barycentric.y, y, 1e-3f);
  }
  EXPECT_GT(found, 2000);
  EXPECT_FALSE(index.find({1.5f, 0.5f}));
}

TEST(PowerMap, RaysAndTheirInverseAgree) {
  const auto object = build_object(
      "<sensor type='powermap'><string name='measure' value='irradiance'/><transform name='to_world'>"
      "<scale x='3' y='2'/><rotate x='1' angle='40'/><translate x='1' y='2' z='3'/></transform>"
      "<film type='hdrfilm'><integer name='width' value='60'/><integer name='height' value='40'/>"
      "<integer name='crop_offset_x' value='20'/><integer name='crop_width' value='30'/></film></sensor>");
  const PlacedSensor sensor = PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {}, 1);
  const Vec2 lower = sensor.part.lower, size = sensor.part.upper - lower;
  SeededRandom random(3);
  double directions = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const Vec2 u = random.next2(), at{lower.x + size.x * u.x, lower.y + size.y * u.y};
    const SensorRay ray = sensor.sample_ray(at, random.next2());
    const float distance = 0.1f + random.next();
    const auto seen = sensor.eval(ray.ray.o + ray.ray.d * distance, ray.ray.d);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->film.x, at.x, 2e-3);
    EXPECT_NEAR(seen->film.y, at.y, 2e-3);
    EXPECT_EQ(seen->weight, ray.weight);
    EXPECT_NEAR(seen->pdf_across * distance * distance, seen->pdf_direction, 2e-3 * seen->pdf_direction);
    // The crop is half of 24 square metres.
    EXPECT_NEAR(seen->pdf_position, 1 / 12.0, 1e-5);
    // All directions from one place.
    const Vec3 d = square_to_uniform_sphere(random.next2());
    if (const auto other = sensor.eval(ray.ray.o + d, d))
      directions += other->pdf_direction * 4 * M_PI / kRays;
    // Light on its way back passes the same place with its power over the cell's area.
    int passed = 0;
    const auto pass = [&](const SensorCrossing& crossing) {
      ++passed;
      EXPECT_NEAR(crossing.film.x, at.x, 2e-3);
      EXPECT_NEAR(crossing.importance, 100, 0.01);
    };
    sensor.for_crossings({ray.ray.o + ray.ray.d * distance, -ray.ray.d, kInfinity}, pass);
    EXPECT_EQ(passed, 1);
    sensor.for_crossings({ray.ray.o + ray.ray.d * distance, ray.ray.d, kInfinity}, pass);
    EXPECT_EQ(passed, 1);
  }
  EXPECT_NEAR(directions, 1, 0.03);
}

TEST(PowerMap, Errors) {
  EXPECT_NE(error("<sensor type='powermap'><transform name='to_world'><scale x='0'/></transform></sensor>"),
            "");
  EXPECT_NE(
      error("<sensor type='powermap'><string name='measure' value='power'/></sensor>").find("irradiance"),
      std::string::npos);
  EXPECT_NE(error("<shape type='rectangle'><sensor type='powermap'><transform name='to_world'><scale "
                  "value='2'/></transform></sensor></shape>")
                .find("leave \"to_world\" out"),
            std::string::npos);
  EXPECT_NE(error("<shape type='linearcurve'><string name='filename' value='no.txt'/><sensor "
                  "type='powermap'/></shape>"),
            "");
  const auto wide =
      scene("<integrator type='path'/>",
            "<sensor type='powermap'><film type='hdrfilm'><rfilter type='gaussian'/></film></sensor>" +
                std::string(kLamp));
  ASSERT_EQ(wide.notes.size(), 1u);
  EXPECT_NE(wide.notes[0].find("over its neighbours"), std::string::npos);
}

TEST(PowerMap, CellsOfAShapeAreMeansOverTheirAreas) {
  const auto placed = [](const std::string& shape, int width, int height) {
    return scene(
        "<integrator type='path'/>",
        "<shape " + shape +
            "<sensor type='powermap'><string name='measure' value='irradiance'/><film type='hdrfilm'>"
            "<string name='quantity' value='illuminance'/><integer name='width' value='" +
            std::to_string(width) + "'/><integer name='height' value='" + std::to_string(height) +
            "'/></film></sensor></shape><emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>"
            "<string name='amount' value='1000 lx'/></emitter>");
  };
  // Areas add up to those of the shapes: of a sphere, an elliptic disc, a cylinder and a mesh.
  const auto areas = [&](const std::string& shape, int width, int height) {
    const LoadedScene s = placed(shape, width, height);
    EXPECT_TRUE(s.notes.empty()) << s.notes.front();
    return *s.scene->sensor().cell_areas;
  };
  const auto sum = [](const std::vector<float>& v) { return std::accumulate(v.begin(), v.end(), 0.0); };
  EXPECT_NEAR(sum(areas("type='sphere'><float name='radius' value='0.5'/>", 8, 6)), M_PI, 1e-3);
  EXPECT_NEAR(sum(areas("type='disk'><transform name='to_world'><scale x='2' y='3'/></transform>", 8, 6)),
              6 * M_PI, 1e-3);
  EXPECT_NEAR(sum(areas("type='cylinder'>", 8, 6)), 2 * M_PI, 1e-3);
  // A trapezoid of 2.5 by two triangles over the square of texture coordinates.
  const TemporaryFolder folder;
  folder.write(
      "a.obj",
      "v 0 0 0\nv 1 0 0\nv 4 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  const std::vector<float> stretched =
      areas("type='obj'><string name='filename' value='" + (folder.path / "a.obj").string() + "'/>", 2, 2);
  EXPECT_NEAR(sum(stretched), 2.5, 1e-3);
  EXPECT_NEAR(*std::max_element(stretched.begin(), stretched.end()), 1,
              1e-5);  // a quarter of 4: in the triangle of 2
  EXPECT_NEAR(*std::min_element(stretched.begin(), stretched.end()), 0.25, 1e-5);  // and in that of 0.5
  // Rows of a sphere between the angles a and b from its pole: 2 pi r^2 (cos a - cos b)/8 each.
  const std::vector<float> rows = areas("type='sphere'>", 8, 6);
  for (int row = 0; row < 6; ++row) {
    const double a = row * M_PI / 6, b = a + M_PI / 6;
    EXPECT_NEAR(rows[std::size_t(8 * row)], 2 * M_PI * (std::cos(a) - std::cos(b)) / 8, 1e-4) << row;
  }
  // Light along the axis: cos(theta) in the upper half, whose mean over the area between a and b is (cos a + cos b)/2. Over the
  // texture coordinates it would be (sin b - sin a)/(b - a), 2.3 % more.
  constexpr int kReplicates = 16;
  std::vector<double> means(6), squares(6);
  for (int k = 0; k < kReplicates; ++k) {
    RenderOptions options;
    options.end = 256, options.seed = std::uint64_t(k + 1);
    RenderJob job(placed("type='sphere'>", 8, 6), options);
    job.run(std::atomic<bool>(false));
    const Image picture = job.state().picture();
    for (std::size_t row = 0; row < 6; ++row) {
      double mean = 0;
      for (std::size_t i = 0; i < 8; ++i) mean += double(picture.pixels[8 * row + i]) / 8;
      means[row] += mean / 1000 / kReplicates, squares[row] += mean * mean / 1e6 / kReplicates;
    }
  }
  for (std::size_t row = 0; row < 3; ++row) {
    const double expected = (std::cos(double(row) * M_PI / 6) + std::cos(double(row + 1) * M_PI / 6)) / 2;
    const double error = std::sqrt(std::max(0.0, squares[row] - means[row] * means[row]) / (kReplicates - 1));
    EXPECT_LT(error, 0.003 * means[row]) << row;
    EXPECT_NEAR(means[row], expected, 3 * error + 2e-4 * expected) << row;
  }
  for (std::size_t row = 3; row < 6; ++row) EXPECT_EQ(means[row], 0) << row;
}

TEST(PowerMap, CellsOfEvenShapesKeepTheirValues) {
  // On a rectangle and a cylinder all weights are 1: a uniform sky gives all cells its irradiance without noise of weights.
  for (const char* shape : {"rectangle", "cylinder"}) {
    const LoadedScene s = scene("<integrator type='path'/>", "<shape type='" + std::string(shape) +
                                                                 "'><sensor type='powermap'>" + film(4, 3) +
                                                                 "</sensor></shape>" + std::string(kLamp));
    for (const Vec2 at : {Vec2{0.3f, 0.4f}, Vec2{2.9f, 1.1f}, Vec2{3.6f, 2.7f}})
      EXPECT_EQ(s.scene->sensor().receiver(at)->weight, 1) << shape;
    EXPECT_TRUE(s.notes.empty());
  }
}

}  // namespace
}  // namespace aureole::test
