// SPDX-License-Identifier: Apache-2.0
// Transfer functions of number and gradient, masks, stored types, adaptive steps and splatting, one ray at a time.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "aureole/core/image.h"
#include "aureole/medium/classified/classified_medium.h"
#include "integrator/dvr_test_support.h"

namespace aureole::test {
namespace {

const std::string kMeasures = R"(<boolean name="measures" value="true"/>)";

/// The optical thickness along the ramp, whose numbers grow by 1 per unit of length, without its two ends.
double thickness_of_ramp(const VolumeFolder& folder, const std::string& parameters,
                         const std::string& integrator = "") {
  const auto content =
      volume_of(folder, "ramp", {64, 2, 2}, ramp(64), parameters + text("clip_box", "0.1 0 0 0.9 1 1"));
  return double(
      look(scene_of(dvr(kMeasures + number("step", 0.002) + integrator), content), kAlongX).measures[0]);
}

TEST(DvrPlane, BoxesAndTriangles) {
  const VolumeFolder folder;
  const auto thickness = [&](const std::string& parameters) { return thickness_of_ramp(folder, parameters); };
  const double ln2 = std::log(2.0);
  EXPECT_NEAR(thickness(text("boxes", "0.2 0.6 0.5 2 1 1 1 0.5")), 0.4 * ln2, 2e-3);
  EXPECT_NEAR(thickness(text("boxes", "0.2 0.6 0.5 2 1 1 1 0.5") + number("opacity_unit_length", 0.25)),
              1.6 * ln2, 8e-3);
  // The gradient is outside.
  EXPECT_EQ(thickness(text("boxes", "0.2 0.6 1.5 2 1 1 1 0.5")), 0);
  EXPECT_EQ(thickness(text("boxes", "0.2 0.6 0 0.5 1 1 1 0.5")), 0);
  // Extinctions of overlapping boxes add.
  EXPECT_NEAR(thickness(text("boxes", "0.2 0.6 0.5 2 1 1 1 0.5, 0.5 0.8 0 9 1 0 0 0.25")),
              0.4 * ln2 - 0.3 * std::log(0.75), 3e-3);
  // Half of the width at the gradient 1 is 0.2, and the middle 0.55. The opacity falls linearly to 0 at both sides: the
  // mean of -ln(1 - a s) over s from 0 to 1 is 1 + (1 - a) ln(1 - a) / a.
  const double a = 0.8, mean = 1 + (1 - a) * std::log(1 - a) / a;
  EXPECT_NEAR(thickness(text("triangles", "0.5 0 2 0.4 0.1 1 1 1 0.8")), 0.4 * mean, 1e-4);
  EXPECT_EQ(thickness(text("triangles", "0.5 1.2 2 0.4 0.1 1 1 1 0.8")), 0);
  EXPECT_EQ(thickness(text("triangles", "0.5 0 0.9 0.4 0.1 1 1 1 0.8")), 0);
  EXPECT_NEAR(
      thickness(text("triangles", "0.5 0 2 0.4 0.1 1 1 1 0.8") + text("boxes", "0.2 0.6 0.5 2 1 1 1 0.5")),
      0.4 * mean + 0.4 * ln2, 3e-3);
}

TEST(DvrPlane, ColoursMixByExtinction) {
  const VolumeFolder folder;
  // Two boxes of everything: the colour of a thick slab is the mean weighted by their extinctions, 3 to 1.
  const auto content = volume_of(folder, "ramp", {64, 2, 2}, ramp(64),
                                 text("boxes", fmt::format("-1 2 0 9 1 1 1 {} -1 2 0 9 0.2 0.2 0.2 {}",
                                                           1 - std::exp(-3.0), 1 - std::exp(-1.0))) +
                                     number("opacity_unit_length", 0.02));
  EXPECT_NEAR(look(scene_of(dvr(""), content), kAlongX).radiance, 0.8, 2e-3);
}

TEST(DvrPlane, Table) {
  const VolumeFolder folder;
  // Values 0 and 1 from left to right, gradients 0 and 2 from bottom to top; opaque at the top right alone.
  Image image;
  image.width = image.height = 2, image.channels = {"R", "G", "B", "A"};
  image.pixels = {1, 1, 1, 0, 1, 1, 1, 102 / 255.f, 1, 1, 1, 0, 1, 1, 1, 0};
  const auto file = folder.path() / "transfer.png";
  write_png(file, image);
  const std::string table =
      text("table", file.string()) + text("table_values", "0, 1") + text("table_gradients", "0, 2");
  // Half of the gradient's range; the mean of the values from 0.1 to 0.9 is a half.
  const double sigma = -std::log(1 - 0.4);
  EXPECT_NEAR(thickness_of_ramp(folder, table), sigma * 0.5 * 0.5 * 0.8, 1e-4);
  // The last row continues.
  EXPECT_NEAR(thickness_of_ramp(folder, text("table", file.string()) + text("table_values", "0, 1") +
                                            text("table_gradients", "0, 0.5")),
              sigma * 0.5 * 0.8, 1e-4);
}

TEST(DvrPlane, PathFindsTheSameLight) {
  const VolumeFolder folder;
  const std::string content = ball(folder, text("boxes", "0.3 0.9 1 9 1 1 1 0.9") +
                                               text("triangles", "0.5 0 4 0.3 0 0.5 0.5 0.5 0.95") +
                                               number("opacity_unit_length", 0.3));
  const double exact =
      look(scene_of(dvr(number("step", 2e-4) + number("termination", 0)), content), kOblique).radiance;
  EXPECT_GT(exact, 0.1);
  const auto scene = scene_of(R"(path">)", content);
  const auto [mean, error] = mean_radiance(scene, kOblique, 4096);
  EXPECT_LT(error, 0.02 * exact);
  EXPECT_NEAR(mean, exact, 4 * error);
  // The integral halves its steps without the mean of a function of one number.
  EXPECT_NEAR(look(scene_of(dvr(text("method", "emission_absorption")), content), kOblique).radiance, exact,
              5e-3 * exact);
}

TEST(DvrPlane, MethodsOfOneNumberRefuseIt) {
  const VolumeFolder folder;
  const std::string content = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("boxes", "0 2 0 9 1 1 1 0.5"));
  EXPECT_EQ(problem(dvr(""), content), "");
  EXPECT_EQ(problem(dvr(text("method", "emission_absorption")), content), "");
  EXPECT_EQ(problem(dvr(text("method", "splatting")), content), "");
  for (const char* method : {"mip", "average"})
    EXPECT_NE(problem(dvr(text("method", method)), content).find("the number alone"), std::string::npos);
  EXPECT_NE(problem(dvr(text("method", "isosurface") + text("isovalues", "0.5")), content)
                .find("\"boxes\" of the volume"),
            std::string::npos);
  EXPECT_NE(problem(dvr(text("classification", "preintegrated")), content).find("give \"post\""),
            std::string::npos);
}

TEST(DvrPlane, BadInputIsLocated) {
  const VolumeFolder folder;
  const auto medium = [&](const std::string& parameters) {
    return problem(dvr(""), volume_of(folder, "slab", {2, 2, 2}, kOnes, parameters));
  };
  const auto has = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_NE(message.find("dvr.xml:"), std::string::npos) << message;
  };
  has(medium(text("boxes", "0 1 0 1 1 1 1")), "found 7 numbers");
  has(medium(text("boxes", "")), "found 0 numbers");
  has(medium(text("boxes", "1 0 0 1 1 1 1 1")), "values must ascend, but 1 and 0");
  has(medium(text("boxes", "0 1 2 1 1 1 1 1")), "gradients are lengths and must ascend");
  has(medium(text("boxes", "0 1 -1 1 1 1 1 1")), "gradients are lengths");
  has(medium(text("boxes", "0 1 0 1 1 1 1 1.5")), "between 0 and 1, but 1.5");
  has(medium(text("boxes", "0 nan 0 1 1 1 1 1")), "nan");
  has(medium(text("triangles", "0 0 1 0 0 1 1 1 1")), "half of the width must be positive");
  has(medium(text("boxes", "0 1 0 1 1 1 1 1") + text("opacity", "0 1")), "contradicts");
  has(medium(text("boxes", "0 1 0 1 1 1 1 1") + text("color_map", "viridis")), "contradicts");
  has(medium(text("opacity", "0 1") + text("table_values", "0 1")), "\"table\", which is missing");
  has(medium(text("table", (folder.path() / "none.png").string())), "none.png");
  Image image;
  image.width = image.height = 2, image.channels = {"R", "G", "B"};
  image.pixels.assign(12, 0.5f);
  const auto file = folder.path() / "rgb.png";
  write_png(file, image);
  const std::string table = text("table", file.string());
  has(medium(table), "table_values");
  has(medium(table + text("table_values", "1 0")), "two ascending numbers");
  has(medium(table + text("table_values", "0 1") + text("table_gradients", "-1 1")), "negative");
  has(medium(table + text("table_values", "0 1") + text("table_gradients", "0 1")), "and A, the opacity");
}

/// A mask of the unit cube with these labels along x.
std::string mask_of(const VolumeFolder& folder, const std::vector<float>& labels,
                    const std::string& parameters = "") {
  const auto file =
      write_bytes(folder.path() / "mask.vol", make_vol({int(labels.size()), 1, 1}, 1, labels).bytes());
  std::string grid = grid_xml(file, parameters);
  return grid.insert(grid.find(' '), R"( name="mask")");
}

TEST(DvrMask, EachClassHasItsFunction) {
  const VolumeFolder folder;
  const auto seen = [&](const std::vector<float>& labels, const std::string& parameters,
                        const std::string& integrator = "") {
    const auto content = volume_of(folder, "slab", {8, 8, 8}, std::vector<float>(512, 1),
                                   mask_of(folder, labels) + parameters);
    return look(scene_of(dvr(kMeasures + number("step", 0.003) + integrator), content), kAlongX);
  };
  const double a = -std::log(0.5), b = -std::log(0.8);
  EXPECT_NEAR(seen({1, 2}, text("opacity", "1: 0 0.5; 2: 0 0.2")).measures[0], 0.5 * (a + b), 1e-3);
  // Nearest voxel: a third of the way each. Labels without a function are transparent.
  EXPECT_NEAR(seen({1, 7, 2}, text("opacity", "1: 0 0.5; 2: 0 0.2")).measures[0], (a + b) / 3, 1e-3);
  // One part for all others, intervals of labels, and a parameter that all share.
  EXPECT_NEAR(seen({0, 5, 9, 300}, text("opacity", "4-6: 0 0.5; 0 0.2; 9, 300-400: 0 0")).measures[0],
              0.25 * (a + b), 2e-3);
  // A class with extinction does not take the opacity of the others; classes of other kinds.
  EXPECT_NEAR(seen({1, 2, 3, 4}, text("opacity", "0 0.5") + text("extinction", "2: 0 4") +
                                     text("boxes", "3: 0 2 0 1 1 1 1 0.2") + text("preset", "4: generic"))
                  .measures[0],
              0.25 * (a + 4 + b - std::log(1 - 0.9)), 0.3);
  EXPECT_NEAR(seen({1, 2, 3}, text("opacity", "0 0.5") + text("extinction", "2: 0 4") +
                                  text("boxes", "3: 0 2 0 1 1 1 1 0.2"))
                  .measures[0],
              (a + 4 + b) / 3, 0.01);
  // Colours of one class alone.
  const Seen colour = seen({1, 2}, text("opacity", "0 0.5") + text("colors", "2: 0 0.5 0.5 0.5; 0 1 1 1") +
                                       number("opacity_unit_length", 0.5));
  EXPECT_NEAR(colour.radiance, 0.5 + 0.5 * 0.25, 1e-3);
}

TEST(DvrMask, SkippingKeepsThePicture) {
  const VolumeFolder folder;
  const std::string content = ball(
      folder,
      mask_of(folder, {1, 0, 3, 2, 2, 0, 1},
              R"(<transform name="to_world"><rotate z="1" angle="20"/><translate x="0.1"/></transform>)") +
          text("opacity", "1: 0.2 0, 0.5 0.99; 2: 0 0.9; 3: 0.8 0, 0.8 0.5") + text("color_map", "viridis") +
          number("opacity_unit_length", 0.2));
  for (float y = 0.1f; y < 1; y += 0.1f) {
    const Ray ray{{-0.5f, y, -1}, {0.6f, 0, 0.8f}};
    const Seen skipped = look(scene_of(dvr(""), content), ray),
               all = look(scene_of(dvr(R"(<boolean name="skip_empty" value="false"/>)"), content), ray);
    EXPECT_EQ(skipped.radiance, all.radiance) << y;
    EXPECT_EQ(skipped.alpha, all.alpha) << y;
  }
}

TEST(DvrMask, NotesAndErrors) {
  const VolumeFolder folder;
  const auto content = [&](const std::vector<float>& labels, const std::string& parameters) {
    return volume_of(folder, "slab", {2, 2, 2}, kOnes, mask_of(folder, labels) + parameters);
  };
  const auto notes = [&](const std::vector<float>& labels, const std::string& parameters) {
    std::string all;
    for (const std::string& note : scene_of(dvr(""), content(labels, parameters)).notes) all += note + "\n";
    return all;
  };
  EXPECT_NE(notes({1, 7, 7, 8}, text("opacity", "1: 0 0.5; 3: 0 0.2"))
                .find("labels without a function are transparent: 7 (2 voxels), 8 (1 voxel)"),
            std::string::npos);
  EXPECT_NE(notes({1, 7}, text("opacity", "1: 0 0.5; 3: 0 0.2; 0 0"))
                .find("no voxel has the labels of these functions: 3"),
            std::string::npos);
  EXPECT_NE(notes({1, 7}, text("opacity", "0 0.5")).find("no parameter names a label"), std::string::npos);
  const auto fails = [&](const std::vector<float>& labels, const std::string& parameters,
                         const std::string& part) {
    const std::string message = problem(dvr(""), content(labels, parameters));
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_NE(message.find("dvr.xml:"), std::string::npos) << message;
  };
  const std::string good = text("opacity", "1: 0 0.5");
  fails({1, 1.5f}, good, "holds 1.5 at x = 1, y = 0, z = 0");
  fails({1, -1}, good, "whole numbers from 0 to 65535");
  fails({1, 70000}, good, "70000");
  fails({1, 2}, text("opacity", "1: 0 0.5; 1: 0 0"), "the label 1 stands twice");
  fails({1, 2}, text("opacity", "1-3: 0 0.5; 2: 0 0"), "the label 2 stands twice");
  fails({1, 2}, text("opacity", "0 0.5; 0 0"), "two parts");
  fails({1, 2}, text("opacity", "x: 0 0.5"), "\"x\" is no label");
  fails({1, 2}, text("opacity", "3-1: 0 0.5"), "do not ascend");
  fails({1, 2}, text("opacity", "2: 1 0.5, 0 0"), "must ascend, but 0 follows 1 (of label 2)");
  fails({1, 2}, text("colors", "2: 0 1 1 1"), "is missing: give each label a function");
  const std::string unmasked =
      problem(dvr(""), volume_of(folder, "slab", {2, 2, 2}, kOnes, text("opacity", "1: 0 0.5")));
  EXPECT_NE(unmasked.find("need a <volume name=\"mask\">"), std::string::npos) << unmasked;
  EXPECT_NE(problem(dvr(text("method", "average")), content({1, 2}, good)).find("without a mask"),
            std::string::npos);
}

/// A raw NRRD file of numbers of a type over the unit cube.
template <class T>
std::filesystem::path write_nrrd(const VolumeFolder& folder, const std::string& type,
                                 const std::vector<T>& values, const std::array<int, 3>& size,
                                 bool is_swapped = false) {
  std::string bytes = fmt::format(
      "NRRD0004\ntype: {}\ndimension: 3\nsizes: {} {} {}\nspace dimension: 3\nspace directions: ({},0,0) (0,{},0) (0,0,{})\n"
      "space origin: ({},{},{})\nspace units: \"m\" \"m\" \"m\"\nendian: {}\nencoding: raw\n\n",
      type, size[0], size[1], size[2], 1. / size[0], 1. / size[1], 1. / size[2], 0.5 / size[0], 0.5 / size[1],
      0.5 / size[2], is_swapped ? "big" : "little");
  for (const T v : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &v, sizeof v);
    if (is_swapped) std::reverse(raw, raw + sizeof v);
    bytes.append(raw, sizeof v);
  }
  return write_bytes(folder.path() / "typed.nrrd", bytes);
}

template <class T>
void check_type(const std::string& name, ScalarType expected, bool is_swapped, bool is_mapped) {
  const VolumeFolder folder;
  const std::array<int, 3> size{7, 6, 9};
  std::vector<T> values;
  for (int i = 0; i < 7 * 6 * 9; ++i) values.push_back(T(i * 37 % 101));
  std::string grid = grid_xml(write_nrrd(folder, name, values, size, is_swapped));
  grid.insert(grid.find(' '), R"( name="value")");
  const auto scene = scene_of(
      dvr(""), R"(<shape type="cube"><bsdf type="null"/><medium type="classified" name="interior">)" + grid +
                   text("extinction", "0 0, 100 5") + "</medium></shape>");
  const auto* medium = dynamic_cast<const ClassifiedMedium*>(scene.scene->media()[0]);
  ASSERT_NE(medium, nullptr);
  const ScalarField& field = medium->field();
  EXPECT_EQ(field.type(), expected) << name;
  EXPECT_EQ(field.own_bytes() == 0, is_mapped) << name;
  EXPECT_EQ(field.minimum(), float(*std::min_element(values.begin(), values.end())));
  EXPECT_EQ(field.maximum(), float(*std::max_element(values.begin(), values.end())));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 2000; ++n) {
    const double p[3] = {unit(random), unit(random), unit(random)};
    double expected_value = 0;  // the sum over eight voxels
    int base[3];
    double t[3];
    for (int k = 0; k < 3; ++k) {
      const double c = std::clamp(p[k] * size[std::size_t(k)] - 0.5, 0.0, size[std::size_t(k)] - 1.0);
      base[k] = std::min(int(c), size[std::size_t(k)] - 2), t[k] = c - base[k];
    }
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      int at[3];
      for (int k = 0; k < 3; ++k) {
        const int up = corner >> k & 1;
        weight *= up ? t[k] : 1 - t[k];
        at[k] = base[k] + up;
      }
      expected_value += weight * double(values[std::size_t((at[2] * size[1] + at[1]) * size[0] + at[0])]);
    }
    const Vec3 point{float(p[0]), float(p[1]), float(p[2])};
    ASSERT_NEAR(double(field.value(point)), expected_value, 3e-4) << name;
    ASSERT_LE(medium->classify(point, field.value(point)).extinction,
              medium->majorants().bound_at(point) * (1 + 1e-5f));
  }
}

TEST(DvrStorage, NumbersStayInTheirTypeAndFile) {
  check_type<std::uint8_t>("uint8", ScalarType::uint8, false, true);
  check_type<std::int8_t>("int8", ScalarType::int8, false, true);
  check_type<std::int16_t>("int16", ScalarType::int16, false, true);
  check_type<std::uint16_t>("uint16", ScalarType::uint16, false, true);
  check_type<float>("float", ScalarType::float32, false, true);
  // The other order of bytes is copied in its type, other types as float32.
  check_type<std::uint16_t>("uint16", ScalarType::uint16, true, false);
  check_type<std::int16_t>("int16", ScalarType::int16, true, false);
  check_type<float>("float", ScalarType::float32, true, false);
  check_type<std::int32_t>("int32", ScalarType::float32, false, false);
  check_type<double>("double", ScalarType::float32, false, false);
  check_type<std::uint64_t>("uint64", ScalarType::float32, true, false);
}

TEST(DvrStorage, OneVolumeForBothKindsOfMedia) {
  const VolumeFolder folder;
  // The bricks of other media are made from a volume whose numbers a classified medium uses as they are stored.
  const auto file = write_nrrd<std::uint8_t>(folder, "uint8", std::vector<std::uint8_t>(64, 3), {4, 4, 4});
  for (const bool classified_first : {true, false}) {
    const std::string id = R"(<volume type="gridvolume" id="shared"><string name="filename" value=")" +
                           file.string() + R"("/></volume>)";
    const std::string ref = R"(<ref id="shared" name=")";
    const std::string classified =
        R"(<shape type="cube"><transform name="to_world"><translate x="1" y="1" z="1"/><scale value="0.51"/><translate x="-0.01" y="-0.01" z="-0.01"/></transform><bsdf type="null"/>
           <medium type="classified" name="interior">)" +
        ref + R"(value"/>)" + text("extinction", "3 2") + "</medium></shape>";
    const std::string other =
        R"(<shape type="cube"><transform name="to_world"><translate x="5"/></transform><bsdf type="null"/>
           <medium type="heterogeneous" name="interior">)" +
        ref + R"(sigma_t"/></medium></shape>)";
    const auto scene =
        scene_of(R"(path">)", id + (classified_first ? classified + other : other + classified));
    double sum = 0;
    constexpr int kCount = 4096;
    for (int i = 0; i < kCount; ++i) sum += look(scene, kAlongZ, i).radiance / kCount;
    EXPECT_NEAR(sum, 1 - std::exp(-2.0), 0.03);
  }
}

/// The light of a ray along x through numbers that are linear between voxels, by many steps in double precision: the
/// extinction is `sigma` and the colour `grey` of the number.
template <class Sigma, class Grey>
double integral_along_x(const std::vector<double>& numbers, const Sigma& sigma, const Grey& grey) {
  constexpr int kSteps = 400000;
  const int n = int(numbers.size());
  double light = 0, thickness = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double i = std::clamp((k + 0.5) / kSteps * n - 0.5, 0.0, n - 1.0);
    const int cell = std::min(int(i), n - 2);
    const double s = numbers[std::size_t(cell)] +
                     (i - cell) * (numbers[std::size_t(cell) + 1] - numbers[std::size_t(cell)]);
    const double step = sigma(s) / kSteps;
    light += grey(s) * std::exp(-thickness) * -std::expm1(-step);
    thickness += step;
  }
  return light;
}

TEST(DvrSteps, AdaptiveStepsOfAConstantColour) {
  const VolumeFolder folder;
  // The light is 1 - exp(-thickness), and the thickness of an extinction in proportion to the numbers is that of
  // trapezoids between the voxels.
  std::vector<float> values;
  double sum = 0;
  constexpr int n = 64;
  for (int i = 0; i < 4 * n; ++i) {
    const double x = (i % n + 0.5) / n, v = std::exp(-2000 * (x - 0.52) * (x - 0.52));
    values.push_back(float(v));
    if (i < n) sum += v / n;
  }
  const auto content = volume_of(folder, "bump", {n, 2, 2}, values, text("extinction", "0 0, 1 30"));
  const double exact = 1 - std::exp(-30 * sum);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const Seen seen =
        look(scene_of(dvr(kMeasures + text("steps", "adaptive") + number("tolerance", tolerance)), content),
             kAlongX);
    EXPECT_NEAR(seen.radiance, exact, tolerance) << tolerance;
    EXPECT_NEAR(seen.alpha, exact, tolerance) << tolerance;
  }
}

TEST(DvrSteps, AdaptiveStepsBeatFixedOnesOfEqualCost) {
  const VolumeFolder folder;
  constexpr int n = 256, kPositions = 12;
  // Mean squares over positions of thin layers in a dim surrounding.
  struct Errors {
    double adaptive = 0, post = 0, preintegrated = 0, lookups = 0;
  };
  Errors last;
  for (const double tolerance : {3e-2, 3e-3, 3e-4}) {
    Errors errors;
    for (int position = 0; position < kPositions; ++position) {
      std::vector<float> values;
      std::vector<double> numbers;
      for (int i = 0; i < 4 * n; ++i) {
        const double x = i % n - 0.37 * position;
        const auto is_in = [&](double from, double to) {
          return std::clamp(std::min(x - from, to - x), 0.0, 1.0);
        };
        values.push_back(float(0.02 + 0.98 * std::max({is_in(40, 44), is_in(130, 136), is_in(211, 214.5)})));
        if (i < n) numbers.push_back(double(values.back()));
      }
      const auto content =
          volume_of(folder, "layers", {n, 2, 2}, values,
                    text("extinction", "0 0, 1 60") + text("colors", "0 1 1 1, 1 0.3 0.3 0.3"));
      const double exact = integral_along_x(
          numbers, [](double s) { return 60 * s; }, [](double s) { return 1 - 0.7 * s; });
      const auto see = [&](const std::string& parameters) {
        return look(scene_of(dvr(kMeasures + number("termination", 0) + parameters), content), kAlongX);
      };
      const auto square = [&](const Seen& seen) {
        return (seen.radiance - exact) * (seen.radiance - exact) / kPositions;
      };
      const Seen adaptive = see(text("steps", "adaptive") + number("tolerance", tolerance));
      const double lookups = double(adaptive.measures[3]);
      EXPECT_LT(std::abs(adaptive.radiance - exact), tolerance) << position;
      errors.lookups += lookups / kPositions, errors.adaptive += square(adaptive);
      // Fixed steps with as many lookups.
      const Seen post = see(number("step", 1 / lookups)),
                 pre = see(number("step", 1 / (lookups - 1)) + text("classification", "preintegrated"));
      EXPECT_NEAR(double(post.measures[3]), lookups, 2);
      EXPECT_NEAR(double(pre.measures[3]), lookups, 2);
      errors.post += square(post), errors.preintegrated += square(pre);
    }
    EXPECT_GT(errors.lookups, last.lookups);
    EXPECT_LT(errors.adaptive, 0.25 * errors.post) << tolerance << " " << errors.lookups;
    EXPECT_LT(errors.adaptive, 0.25 * errors.preintegrated) << tolerance << " " << errors.lookups;
    last = errors;
  }
}

TEST(DvrSteps, AdaptiveStepsEndWhereTheVolumeDoes) {
  const VolumeFolder folder;
  for (const double step : {0.3, 0.07, 5.0}) {
    const auto content = volume_of(folder, "slab", {2, 2, 2}, kOnes,
                                   text("extinction", "0 2") + text("clip_box", "0 0 0.1 1 1 0.83"));
    const Seen seen =
        look(scene_of(dvr(kMeasures + text("steps", "adaptive") + number("step", step)), content), kAlongZ);
    EXPECT_NEAR(seen.measures[0], 2 * 0.73, 1e-5) << step;
    EXPECT_NEAR(
        look(scene_of(dvr(text("method", "xray") + text("steps", "adaptive")), content), kAlongZ).radiance,
        std::exp(-2 * 0.73), 1e-5);
  }
  // Overlapping volumes add.
  const std::string two = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 2")) +
                          volume_of(folder, "slab", {2, 2, 2}, kOnes,
                                    text("extinction", "0 1") + text("clip_box", "0 0 0.25 1 1 0.75"));
  EXPECT_NEAR(look(scene_of(dvr(kMeasures + text("steps", "adaptive")), two), kAlongZ).measures[0], 2.5,
              1e-5);
}

TEST(DvrSteps, StepsByOpacity) {
  const VolumeFolder folder;
  // A slab of one number is exact with any steps.
  for (const double opacity : {0.5, 0.05, 0.002}) {
    const auto slab = volume_of(folder, "slab", {32, 32, 32}, std::vector<float>(32 * 32 * 32, 1),
                                text("extinction", "0 2") + text("clip_box", "0 0 0.1 1 1 0.83"));
    const Seen seen =
        look(scene_of(dvr(kMeasures + text("steps", "by_opacity") + number("step_opacity", opacity)), slab),
             kAlongZ);
    EXPECT_NEAR(seen.measures[0], 2 * 0.73, 1e-5) << opacity;
    // Steps of 2 T h = opacity, from half a voxel to four, and the ends of blocks of four voxels.
    EXPECT_LE(seen.measures[3], 1 + 0.73 * 64);
    EXPECT_GE(seen.measures[3], 0.73 * 8);
  }
  // The error falls with the opacity, and is smaller than that of fixed steps with as many lookups.
  const std::string content = ball(
      folder, text("extinction", "0.02 0, 0.5 1, 0.85 60") + text("colors", "0 0.1 0.1 0.1, 1 1 1 1"), 64);
  double sums[3] = {0, 0, 0}, fixed_sum = 0, lookups[3] = {0, 0, 0};
  const double opacities[] = {0.2, 0.02, 0.002};
  constexpr int kRays = 16;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray{{0.4f + 0.013f * float(i), 0.37f + 0.011f * float(i), -1}, {0, 0, 1}};
    const double exact =
        look(scene_of(dvr(number("step", 1e-4) + number("termination", 0)), content), ray).radiance;
    for (int k = 0; k < 3; ++k) {
      const Seen seen = look(scene_of(dvr(kMeasures + text("steps", "by_opacity") + number("step", 1e-3) +
                                          number("termination", 0) + number("step_opacity", opacities[k])),
                                      content),
                             ray);
      sums[k] += std::pow(seen.radiance - exact, 2), lookups[k] += double(seen.measures[3]);
      if (k != 1) continue;
      const Seen fixed = look(
          scene_of(dvr(kMeasures + number("step", 1 / double(seen.measures[3])) + number("termination", 0)),
                   content),
          ray);
      EXPECT_LE(fixed.measures[3], seen.measures[3] + 1);
      fixed_sum += std::pow(fixed.radiance - exact, 2);
    }
  }
  EXPECT_LT(sums[1], sums[0]);
  EXPECT_LE(sums[2], sums[1]);
  EXPECT_GT(lookups[1], lookups[0]);
  EXPECT_LT(sums[1], fixed_sum);
  EXPECT_LT(std::sqrt(sums[1] / kRays), 2e-3);
}

TEST(DvrSteps, BadInput) {
  const VolumeFolder folder;
  const std::string content = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("opacity", "0 0.5"));
  const auto fails = [&](const std::string& parameters, const std::string& part) {
    const std::string message = problem(dvr(text("steps", "adaptive") + parameters), content);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  EXPECT_EQ(problem(dvr(text("steps", "adaptive")), content), "");
  fails(text("order", "back_to_front"), "from front to back");
  fails(text("form", "premultiplied"), "opacity_weighted");
  fails(text("alpha", "taylor"), "exponential");
  fails(text("classification", "post"), "preintegrated");
  fails(text("method", "mip"), "composite and xray");
  fails(R"(<boolean name="jitter" value="true"/>)", "no effect on adaptive steps");
  EXPECT_NE(problem(dvr(number("step_opacity", 0.01)), content).find("by_opacity"), std::string::npos);
  EXPECT_NE(
      problem(dvr(text("steps", "by_opacity")), content + content).find("takes the numbers of one volume"),
      std::string::npos);
  EXPECT_NE(problem(dvr(number("tolerance", 0.01)), content).find("adaptive steps"), std::string::npos);
}

/// The largest difference of splatting from the integral over some rays through the ball of n^3 voxels, relative to the
/// light.
double splatting_error(int n, const std::string& parameters) {
  const VolumeFolder folder;
  const std::string content =
      ball(folder, text("extinction", "0 0, 1 6") + text("colors", "0 0.2 0.2 0.2, 1 1 1 1"), n);
  const auto splat = scene_of(dvr(text("method", "splatting") + parameters), content),
             cast = scene_of(dvr(text("method", "emission_absorption") + number("tolerance", 1e-4)), content);
  double worst = 0;
  for (const Ray& ray :
       {kOblique, Ray{{0.4f, 0.55f, -1}, {0, 0, 1}}, Ray{{0.62f, 0.3f, 2}, {-0.19f, 0.2f, -0.9611972f}}}) {
    const double exact = look(cast, ray).radiance;
    worst = std::max(worst, std::abs(look(splat, ray).radiance - exact) / exact);
  }
  return worst;
}

TEST(DvrSplatting, ConvergesToRayCasting) {
  for (const char* sheets : {"axis", "image"}) {
    double last = 0;
    for (const int n : {16, 32, 64}) {
      const double error = splatting_error(n, text("sheets", sheets) + number("termination", 0));
      // The kernel blurs by its variance, and sheets have the thickness of a voxel: second order.
      if (last != 0) {
        EXPECT_GT(last / error, 3) << sheets << " " << n;
      }
      last = error;
    }
    EXPECT_LT(last, 4e-3) << sheets;
  }
}

TEST(DvrSplatting, AddsUpToTheOpticalThickness) {
  // In the middle of a wide slab the footprints add up to the extinction, for any direction.
  const VolumeFolder folder;
  constexpr int n = 24;
  const auto content =
      volume_of(folder, "slab", {n, n, n}, std::vector<float>(n * n * n, 1), text("extinction", "0 2"));
  for (const char* sheets : {"axis", "image"})
    for (const float slope : {0.f, 0.1f, 0.3f})
      for (const double width : {0.6, 0.8}) {
        const Vec3 d = normalize(Vec3{slope, -0.5f * slope, 1});
        const Seen seen = look(scene_of(dvr(kMeasures + text("method", "splatting") + text("sheets", sheets) +
                                            number("kernel_width", width) + number("termination", 0)),
                                        content),
                               {Vec3{0.5f, 0.5f, 0.5f} - d * 2, d});
        // Half of the outermost voxels' kernels lies outside: all of each counts. The sum of a narrow kernel over the
        // voxels varies by 2 exp(-2 (pi width)^2) along each of two axes.
        const double ripple = 4 * std::exp(-2 * std::pow(3.14159265 * width, 2));
        EXPECT_NEAR(double(seen.measures[0] * d.z), 2, 2 * (ripple + 5e-4)) << sheets << slope;
      }
}

}  // namespace
}  // namespace aureole::test
