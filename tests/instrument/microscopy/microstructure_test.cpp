// SPDX-License-Identifier: Apache-2.0
// Pictures of discs whose places and sizes are known: the instrument has to find them.
#include "aureole/instrument/microscopy/microstructure.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/instrument/report/microstructure_report.h"
#include "aureole/optics/particle/size_distribution.h"
#include "harness/effort.h"
#include "instrument/microscopy/disc_pictures.h"

namespace aureole::test {
namespace {

constexpr double kPixel = 0.2e-6;

Microstructure analyse(const std::vector<Micrograph>& fields, const MicrostructureOptions& options = {}) {
  return analyse_microstructure(
      fields.size(), [&](size_t i) { return fields[i]; }, options, nullptr);
}

bool has_note(const Microstructure& m, const std::string& part) {
  return std::any_of(m.notes.begin(), m.notes.end(),
                     [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

struct Case {
  const char* name;
  double area_fraction, radius;
  int fields, size;
  PictureOptions picture;
};

PictureOptions with(bool bright, int levels, double noise = 0.04, double blur = 1, double shading = 0.3) {
  PictureOptions p;
  p.bright = bright, p.levels = levels, p.noise = noise, p.blur = blur, p.shading = shading;
  return p;
}

/// A field of a sample of its own, larger than the picture.
Micrograph field_of(const Case& c, unsigned number) {
  double side = 0;
  const double wanted = 1.3 * c.size * c.size * c.area_fraction / (M_PI * c.radius * c.radius);
  const auto discs = hard_discs(c.area_fraction, c.radius, side, std::max(int(wanted), 60), 11 + number, 150);
  PictureOptions p = c.picture;
  p.width = p.height = c.size, p.seed = 3 + number;
  return picture_of(discs, side, p);
}

const Case kCases[] = {
    {"thin_dark_8", 0.2, 9, 1, 900, with(false, 255)},
    {"thin_bright_16", 0.2, 9, 3, 500, with(true, 65535)},
    {"middle_dark_16", 0.4, 9, 1, 700, with(false, 65535)},
    {"middle_bright_8", 0.4, 8, 4, 350, with(true, 255)},
    {"dense_dark_8", 0.55, 9, 1, 700, with(false, 255)},
    {"dense_bright_16", 0.55, 9, 2, 500, with(true, 65535)},
    {"dense_blurred", 0.55, 12, 1, 800, with(false, 255, 0.04, 1.8)},
    {"small_discs", 0.4, 5, 1, 500, with(false, 255, 0.03, 0.8)},
    {"large_discs", 0.4, 24, 4, 700, with(false, 255)},
    {"noisy", 0.4, 9, 1, 700, with(false, 255, 0.2)},
    {"strong_shading", 0.4, 9, 1, 700, with(true, 65535, 0.04, 1, 0.7)},
};

class HardDiscs : public ::testing::TestWithParam<Case> {};

TEST_P(HardDiscs, AreFoundAgain) {
  const Case& c = GetParam();
  std::vector<Micrograph> fields;
  for (int f = 0; f < c.fields; ++f) fields.push_back(field_of(c, unsigned(f)));
  const Microstructure m = analyse(fields);
  const double radius = c.radius * kPixel, density = c.area_fraction / (M_PI * radius * radius);
  std::printf(
      "%-15s Fa %.4f [%.4f %.4f] Fr %.4f r %+.2f %% sd %.2f %% a %+.2f %% density %+.2f %% circularity "
      "%.3f\n",
      c.name, m.area_fraction.value, m.area_fraction.low, m.area_fraction.high, m.shape_fraction.value,
      100 * (m.mean_radius.value / radius - 1), 100 * m.deviation.value / m.mean_radius.value,
      100 * (m.correlation_radius.value / radius - 1), 100 * (m.density.value / density - 1), m.circularity);
  EXPECT_EQ(m.fields[0].bright, c.picture.bright);
  EXPECT_FALSE(has_note(m, "not those of hard discs") || has_note(m, "no distinct onset"));
  EXPECT_NEAR(m.area_fraction.value, c.area_fraction, 0.01);
  EXPECT_NEAR(m.shape_fraction.value, c.area_fraction, 0.01);
  EXPECT_NEAR(m.mean_radius.value, radius, 0.03 * radius);
  EXPECT_NEAR(m.correlation_radius.value, radius, 0.02 * radius);
  // The spread is that of noise alone.
  EXPECT_LT(m.deviation.value, 0.025 * radius);
  EXPECT_TRUE(m.round);
  EXPECT_NEAR(m.fields[0].blur, c.picture.blur, 0.2);
  EXPECT_LT(m.mean_radius.low, m.mean_radius.value);
  EXPECT_GT(m.area_fraction.high - m.area_fraction.low, 0.002);
  EXPECT_LT(m.area_fraction.high - m.area_fraction.low, 0.12);
}

INSTANTIATE_TEST_SUITE_P(Microstructure, HardDiscs, ::testing::ValuesIn(kCases),
                         [](const auto& i) { return i.param.name; });

TEST(Microstructure, IntervalsHoldTheTruth) {
  // 95 % of the intervals should; if they were independent, of 24 intervals of 8 samples at least 20 in 99.4 % of all cases, of 15 at least 12 as well.
  int held = 0;
  const unsigned samples = effort(5u, 8u);
  for (unsigned i = 0; i < samples; ++i) {
    const Case c{"", 0.4, 8, 1, 400, with(false, 255)};
    const Microstructure m = analyse({field_of(c, 40 + i)});
    const double density = 0.4 / (M_PI * std::pow(8 * kPixel, 2));
    held += m.shape_fraction.low <= 0.4 && 0.4 <= m.shape_fraction.high;
    held += m.area_fraction.low <= 0.4 && 0.4 <= m.area_fraction.high;
    held += m.density.low <= density && density <= m.density.high;
  }
  std::printf("%d of %u intervals hold the truth\n", held, 3 * samples);
  EXPECT_GE(held, effort(12, 20));
}

TEST(Microstructure, SpreadOfSizes) {
  double side = 0;
  auto discs = hard_discs(0.5, 12, side, 1400, 5, 150);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (Disc& d : discs) d.radius = 12 * std::min(0.7 * std::exp(0.15 * normal(random)), 1.0);
  PictureOptions p;
  p.width = p.height = 1000;
  const Microstructure m = analyse({picture_of(discs, side, p)});
  double mean = 0, square = 0, cover = 0;
  for (const Disc& d : discs)
    mean += d.radius, square += d.radius * d.radius, cover += M_PI * d.radius * d.radius;
  mean /= double(discs.size()), square /= double(discs.size());
  EXPECT_NEAR(m.mean_radius.value, mean * kPixel, 0.015 * mean * kPixel);
  EXPECT_NEAR(m.deviation.value, std::sqrt(square - mean * mean) * kPixel, 0.06 * mean * kPixel * 0.15 * 6);
  EXPECT_NEAR(m.shape_fraction.value, cover / (side * side), 0.015);
  EXPECT_TRUE(m.round);
  EXPECT_NEAR(m.correlation_radius.value, 12 * kPixel, 0.03 * 12 * kPixel);
  EXPECT_FALSE(has_note(m, "not those of hard discs") || has_note(m, "no distinct onset"));
  ASSERT_EQ(m.quantiles.size(), std::size(kQuantiles));
  for (size_t q = 1; q < m.quantiles.size(); ++q) EXPECT_GT(m.quantiles[q].value, m.quantiles[q - 1].value);

  // The table of sizes is one that apertures read.
  std::istringstream text(size_histogram(m));
  const auto sizes = optics::SizeDistribution::histogram(text);
  EXPECT_NEAR(sizes.moment(1), 1, 1e-3);
  EXPECT_NEAR(std::sqrt(sizes.moment(2) - 1), m.deviation.value / m.mean_radius.value, 0.01);
  const std::string scene = measured_material(m).scene;
  EXPECT_NE(scene.find("<aperture type=\"circle\">"), std::string::npos);
  EXPECT_NE(scene.find("size_histogram"), std::string::npos);
}

TEST(Microstructure, FitsThatAreBadAreNoted) {
  const char *positions = "positions are not those of hard discs", *onset = "no distinct onset";
  PictureOptions p;
  p.width = p.height = 900;
  // Discs in equilibrium fit.
  double side = 0;
  auto fluid = hard_discs(0.4, 9, side, 2200, 8, 150);
  const Microstructure good = analyse({picture_of(fluid, side, p)});
  EXPECT_FALSE(has_note(good, positions));
  EXPECT_FALSE(has_note(good, onset));
  // A hexagonal lattice that has not melted, and clusters: discs are left out in stripes.
  const auto lattice = hard_discs(0.4, 9, side, 2200, 8, 1);
  const Microstructure ordered = analyse({picture_of(lattice, side, p)});
  EXPECT_TRUE(has_note(ordered, positions));
  auto stripes = hard_discs(0.4, 9, side, 2200, 8, 150);
  std::erase_if(stripes, [](const Disc& d) { return std::fmod(d.x, 180) < 90; });
  EXPECT_TRUE(has_note(analyse({picture_of(stripes, side, p)}), positions));
  // Small discs whose distances have no sharp lower bound.
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 3);
  auto soft = fluid;
  for (Disc& d : soft) d.radius = 4, d.x += normal(random), d.y += normal(random);
  const Microstructure no_onset = analyse({picture_of(soft, side, p)});
  std::printf("height of the onset: %.3f, width %.3f; discs in equilibrium %.3f, %.3f\n",
              no_onset.onset_height, no_onset.onset_width, good.onset_height, good.onset_width);
  EXPECT_TRUE(has_note(no_onset, onset));
  // Two sizes are no log-normal distribution.
  for (size_t i = 0; i < fluid.size(); ++i) fluid[i].radius = i % 2 ? 9 : 4.5;
  MicrostructureOptions spheres;
  spheres.scatterer = ScattererKind::spheres, spheres.int_ior = "1.5";
  const Microstructure two = analyse({picture_of(fluid, side, p)}, spheres);
  EXPECT_TRUE(has_note(two, "sizes are not log-normal"));
  const std::string scene = measured_material(two).scene;
  EXPECT_NE(scene.find("Note: sizes are not log-normal"), std::string::npos);
  EXPECT_EQ(good.scatterer, ScattererKind::discs);
  EXPECT_EQ(good.choices.size(), 2u);
  EXPECT_TRUE(two.choices.size() == 1);  // the polarity
}

/// Large discs are cut by the frame more often than small ones: unweighted, their part comes out too small.
TEST(Microstructure, TheFrameDoesNotHideLargeParticles) {
  double small = 0, unweighted = 0;
  int fields = 0;
  std::vector<Micrograph> pictures;
  for (unsigned i = 0; i < 50; ++i) {
    double side = 0;
    auto discs = hard_discs(0.35, 26, side, 60, 70 + i, 100);
    for (size_t k = 0; k < discs.size(); ++k) discs[k].radius = k % 2 ? 25 : 6;
    PictureOptions p;
    p.width = p.height = 240, p.seed = i;
    pictures.push_back(picture_of(discs, side, p)), ++fields;
  }
  const Microstructure m = analyse(pictures);
  double whole = 0;
  for (size_t i = 0; i < m.particles.size(); ++i) {
    if (m.particles[i].cut) continue;
    whole += 1;
    if (m.particles[i].radius < 12) small += m.weights[i], unweighted += 1;
  }
  std::printf("part of small discs: %.3f weighted, %.3f counted (0.5 in truth)\n", small, unweighted / whole);
  EXPECT_NEAR(small, 0.5, 0.05);  // 2.5 standard deviations of so many discs
  EXPECT_GT(unweighted / whole, 0.56) << "the test does not test";
  const double density = 0.35 / (M_PI * std::pow(26 * kPixel, 2));
  EXPECT_NEAR(m.density.value, density, 0.06 * density);
}

TEST(Microstructure, PartsLeftOut) {
  const Case c{"", 0.4, 9, 1, 700, with(false, 255)};
  Micrograph m = field_of(c, 1);
  // A scratch of another brightness and a dark corner would be particles.
  m.seen.assign(m.grey.size(), 1);
  for (int y = 0; y < 700; ++y)
    for (int x = 0; x < 700; ++x)
      if (std::abs(x - y - 60) < 12 || (x > 560 && y < 150)) {
        const size_t i = size_t(y) * 700 + size_t(x);
        m.seen[i] = 0, m.grey[i] = x > 560 ? 0.f : 1.f;
      }
  const Microstructure r = analyse({m});
  EXPECT_NEAR(r.shape_fraction.value, 0.4, 0.012);
  EXPECT_NEAR(r.area_fraction.value, 0.4, 0.015);
  EXPECT_NEAR(r.mean_radius.value, 9 * kPixel, 0.02 * 9 * kPixel);
  // Particles that reach into them must be marked as cut.
  for (const Particle& p : r.particles)
    if (!p.cut) {
      EXPECT_GT(std::abs(p.x - p.y - 60), 12 + 0.7 * p.radius);
    }
}

struct ShapeCase {
  const char* name;
  std::function<bool(double, double)> inside;
  double aspect;
  int symmetry;
};

TEST(Microstructure, ShapesThatAreNotRound) {
  const double half = std::sqrt(M_PI) / 2;
  const ShapeCase cases[] = {
      {"ellipse", [](double x, double y) { return x * x / 2 + y * y * 2 < 1; }, 2, 2},
      {"square", [=](double x, double y) { return std::abs(x) < half && std::abs(y) < half; }, 1, 4},
      {"triangle",
       [](double x, double y) {
         const double r = std::sqrt(M_PI / (3 * std::sqrt(3)));  // of the inscribed circle
         return y > -r && y < 2 * r - std::sqrt(3) * std::abs(x);
       },
       1, 3}};
  for (const ShapeCase& c : cases) {
    double side = 0;
    auto discs = hard_discs(0.4, 16, side, 300, 9, 150);
    for (Disc& d : discs) d.radius = 10;
    PictureOptions p;
    p.width = p.height = 600, p.shape = c.inside;
    const Microstructure m = analyse({picture_of(discs, side, p)});
    std::printf("%s: circularity %.3f, aspect %.3f, symmetry %d\n", c.name, m.circularity, m.aspect,
                m.symmetry);
    EXPECT_FALSE(m.round) << c.name;
    EXPECT_NEAR(m.aspect, c.aspect, 0.06 * c.aspect) << c.name;
    EXPECT_EQ(m.symmetry, c.symmetry) << c.name;
    EXPECT_NEAR(m.mean_radius.value, 10 * kPixel, 0.03 * 10 * kPixel) << c.name;
    EXPECT_LT(m.alignment, 0.2) << c.name;
    // Both outlines have the area of the shape and wind counter-clockwise.
    for (const Outline* o : {&m.mean_outline, &m.typical_outline}) {
      double area = 0;
      for (size_t i = 0; i < o->size(); ++i) {
        const auto &a = (*o)[i], &b = (*o)[(i + 1) % o->size()];
        area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
      }
      EXPECT_NEAR(area, M_PI * std::pow(10 * kPixel, 2), 0.06 * M_PI * std::pow(10 * kPixel, 2)) << c.name;
    }
    EXPECT_NE(measured_material(m).scene.find("apertures.svg"), std::string::npos);
  }
}

TEST(Microstructure, HolesAndDirt) {
  const Case c{"", 0.3, 12, 1, 600, with(false, 255)};
  Micrograph m = field_of(c, 2);
  const Microstructure plain = analyse({m});
  // A bright spot in the middle of each droplet, as of a lens, and single hot pixels.
  for (const Particle& p : plain.particles)
    for (int y = std::max(int(p.y) - 5, 0); y < std::min(int(p.y) + 6, 600); ++y)
      for (int x = std::max(int(p.x) - 5, 0); x < std::min(int(p.x) + 6, 600); ++x)
        if (std::hypot(x + 0.5 - p.x, y + 0.5 - p.y) < 4) m.grey[size_t(y) * 600 + size_t(x)] = 0.7f;
  std::mt19937 random(1);
  for (int i = 0; i < 1500; ++i) m.grey[random() % m.grey.size()] = i % 2 ? 1.f : 0.f;
  MicrostructureOptions options;
  options.segmentation.fill_holes = true;
  const Microstructure filled = analyse({m}, options);
  EXPECT_NEAR(filled.mean_radius.value, 12 * kPixel, 0.03 * 12 * kPixel);
  EXPECT_NEAR(filled.shape_fraction.value, plain.shape_fraction.value, 0.015);
}

TEST(Microstructure, MorphologicalBackground) {
  const Case c{"", 0.4, 9, 1, 600, with(true, 65535, 0.02)};
  MicrostructureOptions options;
  options.segmentation.background = Background::morphology;
  options.segmentation.background_scale = 60;
  const Microstructure m = analyse({field_of(c, 3)}, options);
  EXPECT_NEAR(m.mean_radius.value, 9 * kPixel, 0.03 * 9 * kPixel);
  EXPECT_NEAR(m.area_fraction.value, 0.4, 0.02);
}

TEST(Microstructure, FewParticles) {
  const Case c{"", 0.2, 20, 1, 300, with(false, 255)};
  const Microstructure m = analyse({field_of(c, 4)});
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("particles are seen whole: the intervals are wide"), std::string::npos)
      << m.notes[0];
  EXPECT_NEAR(m.mean_radius.value, 20 * kPixel, 0.03 * 20 * kPixel);
  EXPECT_GT(m.area_fraction.high - m.area_fraction.low, 0.05);
}

TEST(Microstructure, NotesPicturesThatAreNotSharpEnough) {
  const Case sharp{"", 0.3, 9, 1, 400, with(false, 255)},
      blurred{"", 0.3, 9, 1, 400, with(false, 255, 0.04, 3)}, small{"", 0.3, 3, 1, 300, with(false, 255)};
  EXPECT_TRUE(analyse({field_of(sharp, 6)}).notes.empty());
  for (const Case& c : {blurred, small}) {
    const Microstructure m = analyse({field_of(c, 6)});
    ASSERT_FALSE(m.notes.empty());
    EXPECT_NE(m.notes[0].find("not sharp enough"), std::string::npos) << m.notes[0];
  }
}

TEST(Microstructure, GivenCorrelationRadius) {
  MicrostructureOptions options;
  options.correlation_radius_m = 2e-6;
  const Case c{"", 0.4, 9, 1, 500, with(false, 255)};
  const Microstructure m = analyse({field_of(c, 5)}, options);
  EXPECT_EQ(m.correlation_radius.value, 2e-6);
  EXPECT_NEAR(m.area_fraction.value, 0.4 * std::pow(2 / 1.8, 2), 0.02);
}

void expect_error(const std::vector<Micrograph>& fields, const std::string& text) {
  try {
    analyse(fields);
    FAIL() << "no error: " << text;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("picture"), std::string::npos) << "no place: " << e.what();
  }
}

TEST(Microstructure, NothingToSee) {
  PictureOptions p;
  p.width = p.height = 200;
  expect_error({picture_of({}, 1e4, p)}, "no contrast above its noise");
  p.noise = 0, p.shading = 0;
  expect_error({picture_of({}, 1e4, p)}, "one grey value only");
  p.noise = 0.03;
  expect_error({picture_of({{60, 70, 20, 0}, {140, 120, 20, 0}}, 1e4, p)}, "2 particles are seen whole");
  // Stripes are neither bright nor dark particles.
  Micrograph stripes = picture_of({}, 1e4, p);
  for (size_t i = 0; i < stripes.grey.size(); ++i) stripes.grey[i] = i % 200 / 20 % 2 ? 0.7f : 0.3f;
  expect_error({stripes}, "--polarity");
}

}  // namespace
}  // namespace aureole::test
