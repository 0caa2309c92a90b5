// SPDX-License-Identifier: Apache-2.0
// Light selection: probabilities are those of its choices, add up, and are never zero where a light
// contributes.
#include "aureole/scene/light_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "aureole/loading/load.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/scene/scene.h"

namespace aureole::testing {
namespace {

std::string vec(const std::string& name, const Vec3& v) {
  return "<point name=\"" + name + "\" x=\"" + std::to_string(v.x) + "\" y=\"" + std::to_string(v.y) +
         "\" z=\"" + std::to_string(v.z) + "\"/>";
}

Vec3 in_box(SeededRandom& random, float half) {
  const float x = random.next(), y = random.next();
  return Vec3{2 * x - 1, 2 * y - 1, 2 * random.next() - 1} * half;
}

/// Random lights: rectangles, small spheres, cubes and points.
std::string random_lights(SeededRandom& random, int count, float half) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    const Vec3 c = in_box(random, half), axis = square_to_uniform_sphere(random.next2());
    const float size = 0.05f + 0.3f * random.next() * random.next(),
                power = 0.1f + 10 * random.next() * random.next();
    if (k % 4 == 3) {
      text += "<emitter type=\"point\">" + vec("position", c) + "<float name=\"intensity\" value=\"" +
              std::to_string(power) + "\"/></emitter>";
      continue;
    }
    const char* shapes[] = {"rectangle", "sphere", "cube"};
    text += std::string("<shape type=\"") + shapes[k % 4] +
            "\"><transform name=\"to_world\"><scale value=\"" + std::to_string(size) + "\"/><rotate x=\"" +
            std::to_string(axis.x) + "\" y=\"" + std::to_string(axis.y) + "\" z=\"" + std::to_string(axis.z) +
            "\" angle=\"" + std::to_string(360 * random.next()) + "\"/><translate x=\"" +
            std::to_string(c.x) + "\" y=\"" + std::to_string(c.y) + "\" z=\"" + std::to_string(c.z) +
            "\"/></transform><emitter type=\"area\"><float name=\"radiance\" value=\"" +
            std::to_string(power) + "\"/></emitter></shape>";
  }
  return text;
}

std::shared_ptr<const Scene> scene_with(const std::string& lights) {
  return load_scene_from_string(
             "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor "
             "type=\"perspective\"><film type=\"hdrfilm\"/></sensor>" +
                 lights + "</scene>",
             "lights.xml")
      .scene;
}

double total_probability(const Scene& s, const Vec3& p, const Vec3& n) {
  double sum = 0;
  for (const Light& e : s.emitters())
    for (std::size_t part = 0; part < e.part_count(); ++part)
      sum += double(s.lights().probability(p, n, e, part));
  return sum;
}

TEST(LightSampler, ProbabilitiesAddUp) {
  SeededRandom random(1);
  for (const char* infinite : {"", "<emitter type=\"constant\"/>"})
    for (int lights : {1, 2, 7, 40}) {
      const auto scene = scene_with(random_lights(random, lights, 3) + infinite);
      for (int k = 0; k < 300; ++k) {
        const Vec3 p = in_box(random, k % 2 ? 3.f : 20.f);
        const Vec3 n = k % 3 ? square_to_uniform_sphere(random.next2()) : Vec3{};
        const double total = total_probability(*scene, p, n);
        // The probabilities sum to less than 1 where `choose` returns nothing: in a node neither child of
        // which can reach the point.
        int nothing = 0;
        constexpr int n_choices = 2000;
        for (int i = 0; i < n_choices; ++i)
          nothing += !scene->lights().choose(p, n, (float(i) + 0.5f) / n_choices);
        EXPECT_NEAR(total + double(nothing) / n_choices, 1, 0.006) << lights;
        EXPECT_LT(total, 1 + 1e-5);
      }
    }
}

TEST(LightSampler, ChoicesHaveTheirProbability) {
  SeededRandom random(2);
  const auto scene =
      scene_with(random_lights(random, 12, 2) + "<emitter type=\"constant\"/><emitter type=\"constant\"/>");
  for (int k = 0; k < 40; ++k) {
    const Vec3 p = in_box(random, 3);
    const Vec3 n = k % 3 ? square_to_uniform_sphere(random.next2()) : Vec3{};
    std::map<std::pair<const Light*, std::size_t>, int> count;
    constexpr int samples = 20000;
    for (int i = 0; i < samples; ++i) {
      const auto c = scene->lights().choose(p, n, (float(i) + 0.5f) / samples);
      if (!c) continue;
      const float again = scene->lights().probability(p, n, *c->light, c->part);
      ASSERT_NEAR(c->probability, again, 1e-5f * again);
      ++count[{c->light, c->part}];
    }
    for (const Light& e : scene->emitters())
      for (std::size_t part = 0; part < e.part_count(); ++part)
        // Equidistant numbers: each choice is an interval, its count is exact to one.
        EXPECT_NEAR(count[std::pair(&e, part)], samples * double(scene->lights().probability(p, n, e, part)),
                    2);
  }
}

TEST(LightSampler, NeverZeroWhereALightContributes) {
  SeededRandom random(3);
  int contributions = 0;
  for (int scenes = 0; scenes < 6; ++scenes) {
    const auto scene = scene_with(random_lights(random, 3 + 10 * scenes, 2));
    const Wavelengths w = Wavelengths::at(scene->wavelengths().grid(), 550.f);
    for (int k = 0; k < 1500; ++k) {
      Vec3 p = in_box(random, 2.5f);
      const Vec3 n = square_to_uniform_sphere(random.next2());
      // Also points that lie on lights.
      if (k % 5 == 0)
        if (const auto hit = scene->intersect({p, n, kInfinity})) p = hit->p;
      for (const Light& e : scene->emitters())
        for (std::size_t part = 0; part < e.part_count(); ++part) {
          const auto s = e.sample_direct(p, part, random.next2(), w);
          if (!s || is_black(s->radiance)) continue;
          ++contributions;
          EXPECT_GT(scene->lights().probability(p, {}, e, part), 0) << "scene " << scenes;
          if (std::abs(dot(n, s->wo)) > 1e-4f) {
            ASSERT_GT(scene->lights().probability(p, n, e, part), 0) << "scene " << scenes;
          }
        }
    }
  }
  EXPECT_GT(contributions, 100000);
}

TEST(LightSampler, ManyLightsAreCheapAndFollowTheLight) {
  SeededRandom random(4);
  const auto scene = scene_with(random_lights(random, 1000, 10));
  EXPECT_GT(scene->lights().leaf_count(), 1000u);
  // Second moments of the unoccluded light at a point: of this choice and of one among all alike.
  const Wavelengths w = Wavelengths::at(scene->wavelengths().grid(), 550.f);
  double log_gain = 0;
  constexpr int points = 100;
  for (int k = 0; k < points; ++k) {
    const Vec3 p = in_box(random, 10), n = square_to_uniform_sphere(random.next2());
    double tree = 0, alike = 0;
    for (const Light& e : scene->emitters())
      for (std::size_t part = 0; part < e.part_count(); ++part) {
        const auto s = e.sample_direct(p, part, {0.5f, 0.5f}, w);
        if (!s) continue;
        const double x = double(s->radiance[0]) * std::max(0.f, dot(s->wo, n)) / double(s->pdf);
        if (x == 0) continue;
        tree += x * x / double(scene->lights().probability(p, n, e, part));
        alike += x * x * double(scene->lights().leaf_count());
      }
    log_gain += std::log(alike / tree) / points;
  }
  EXPECT_GT(std::exp(log_gain), 5) << "the choice does not follow the light";
  RecordProperty("gain_percent", int(100 * std::exp(log_gain)));
  // Many calls; a search through all lights would make this test last seconds.
  double sum = 0;
  for (int k = 0; k < 200000; ++k)
    if (const auto c = scene->lights().choose(in_box(random, 10), {0, 0, 1}, random.next()))
      sum += c->probability;
  EXPECT_GT(sum, 0);
}

/// Random lights of which each third is steady, one pulses and one swings as a sine, and a sky, during an exposure.
std::shared_ptr<const Scene> modulated_scene(bool has_sky) {
  SeededRandom random{17};
  std::string text;
  for (int k = 0; k < 12; ++k) {
    const char* modulations[] = {
        "",
        "<modulation type=\"wave\"><string name=\"waveform\" value=\"square\"/><float name=\"frequency\" value=\"1\"/><float name=\"duty\" value=\"0.1\"/></modulation>",
        "<modulation type=\"wave\"><float name=\"frequency\" value=\"1\"/></modulation>"};
    const std::string place = std::to_string(2 + std::abs(in_box(random, 3).x));
    const std::string light = modulations[k % 3] + std::string("</emitter>");
    const Vec3 c = in_box(random, 5);
    text +=
        k % 2
            ? "<emitter type=\"point\">" + vec("position", c) + "<float name=\"intensity\" value=\"" + place +
                  "\"/>" + light
            : "<shape type=\"sphere\">" + vec("center", c) +
                  "<float name=\"radius\" value=\"0.2\"/><emitter type=\"area\"><float name=\"radiance\" value=\"" +
                  place + "\"/>" + light + "</shape>";
  }
  if (has_sky)
    text +=
        "<emitter type=\"constant\"><modulation type=\"wave\"><float name=\"frequency\" value=\"1\"/></modulation></emitter>";
  return load_scene_from_string(
             "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\">"
             "<float name=\"shutter_close\" value=\"1\"/><film type=\"hdrfilm\"/></sensor>" +
                 text + "</scene>",
             "lights.xml")
      .scene;
}

TEST(LightSampler, ChoicesFollowTheTime) {
  for (const bool has_sky : {false, true}) {
    const auto scene = modulated_scene(has_sky);
    const LightSampler& lights = scene->lights();
    SeededRandom random{3};
    for (const float time : {0.05f, 0.3f, 0.5f, 0.75f}) {
      const Vec3 p = in_box(random, 6), n = square_to_uniform_sphere(random.next2());
      std::map<std::pair<const Light*, std::size_t>, int> count, by_power;
      const int samples = 1 << 16;
      int none = 0;
      for (int i = 0; i < samples; ++i) {
        const float u = (float(i) + 0.5f) / samples;
        if (const auto c = lights.choose(p, n, u, time)) {
          EXPECT_NEAR(c->probability, lights.probability(p, n, *c->light, c->part, time),
                      1e-4f * c->probability);
          ++count[{c->light, c->part}];
        } else
          ++none;
        const auto c = lights.choose_by_power({u, 0.5f}, time);
        ASSERT_TRUE(c);
        EXPECT_NEAR(c->probability, lights.probability_by_power(*c->light, c->part, time),
                    1e-5f * c->probability);
        ++by_power[{c->light, c->part}];
      }
      double sum = 0, sum_by_power = 0;
      for (const Light& e : scene->emitters())
        for (std::size_t part = 0; part < e.part_count(); ++part) {
          const double here = double(lights.probability(p, n, e, part, time)),
                       power = double(lights.probability_by_power(e, part, time));
          EXPECT_NEAR(count[std::pair(&e, part)], samples * here, 40);
          EXPECT_NEAR(by_power[std::pair(&e, part)], samples * power, 40);
          sum += here, sum_by_power += power;
          // A light that is off is never chosen, and one that emits can be.
          const Modulation* modulation = e.emitter->modulation();
          const bool is_on = !modulation || modulation->at(double(time)) > 0;
          EXPECT_EQ(power > 0, is_on);
          EXPECT_TRUE(here == 0 || is_on);
          if (lights.probability(p, n, e, part) > 0 && is_on) {
            EXPECT_GT(here, 0);
          }
        }
      EXPECT_NEAR(sum + double(none) / samples, 1, 1e-4);
      EXPECT_NEAR(sum_by_power, 1, 1e-5);
    }
    // At the pulse, the pulsed lights have ten times the weight that they have in the mean over time.
    double pulsed = 0, steady = 0, pulsed_mean = 0, steady_mean = 0;
    for (const Light& e : scene->emitters()) {
      const Modulation* modulation = e.emitter->modulation();
      const bool is_pulsed = modulation && modulation->at(0.3) == 0;
      if (modulation && !is_pulsed) continue;
      (is_pulsed ? pulsed : steady) += double(lights.probability_by_power(e, 0, 0.05f));
      (is_pulsed ? pulsed_mean : steady_mean) += double(lights.probability_by_power(e, 0));
    }
    EXPECT_NEAR(pulsed / steady, 10 * pulsed_mean / steady_mean, 0.01 * pulsed / steady);
  }
}

// Twenty lamps of modulations of their own, of which the brightest come last in the file: choices follow the fifteen with most power.
TEST(LightSampler, TheStrongestModulationsAreFollowed) {
  std::string text;
  for (int k = 1; k <= 20; ++k)
    text +=
        "<emitter type=\"point\">" + vec("position", {float(k % 5), float(k / 5), 0}) +
        "<float name=\"intensity\" value=\"" + std::to_string(k) +
        "\"/><modulation type=\"wave\"><string name=\"waveform\" value=\"square\"/><float name=\"frequency\" value=\"1\"/>"
        "<float name=\"duty\" value=\"0.5\"/></modulation></emitter>";
  const auto scene = load_scene_from_string(
                         "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\">"
                         "<float name=\"shutter_close\" value=\"1\"/><film type=\"hdrfilm\"/></sensor>" +
                             text + "</scene>",
                         "lights.xml")
                         .scene;
  ASSERT_EQ(scene->emitters().size(), 20u);
  const float off = 0.75f;
  std::size_t followed = 0;
  for (const Light& light : scene->emitters()) {
    const double intensity = double(light.index) + 1;
    const float power = scene->lights().probability_by_power(light, 0, off);
    const float here = scene->lights().probability({2, 2, 3}, {0, 0, -1}, light, 0, off);
    EXPECT_EQ(power > 0, intensity <= 5) << intensity;
    EXPECT_EQ(here > 0, intensity <= 5) << intensity;
    followed += power == 0;
  }
  EXPECT_EQ(followed, 15u);
}

// A segment finds the pivots of lights that emit at its time.
TEST(LightSampler, PivotsOfSegmentsFollowTheTime) {
  const auto square = [](const char* phase) {
    return "<modulation type=\"wave\"><string name=\"waveform\" value=\"square\"/><float name=\"frequency\" value=\"1\"/>"
           "<float name=\"duty\" value=\"0.5\"/><float name=\"phase\" value=\"" +
           std::string(phase) + "\"/></modulation></emitter>";
  };
  const auto lamp = [](float x) {
    return "<emitter type=\"point\">" + vec("position", {x, 1, 0}) +
           "<float name=\"intensity\" value=\"1\"/>";
  };
  const auto scene =
      load_scene_from_string(
          "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\">"
          "<float name=\"shutter_close\" value=\"1\"/><film type=\"hdrfilm\"/></sensor>" +
              lamp(-1) + square("0") + lamp(1) + square("0.5") + lamp(3) + "</emitter></scene>",
          "lights.xml")
          .scene;
  const Ray ray{{-4, 0, 0}, {1, 0, 0}, kInfinity};
  for (const float time : {0.25f, 0.75f}) {
    std::map<float, int> count;
    constexpr int kSamples = 3000;
    for (int i = 0; i < kSamples; ++i) {
      const EmissionBounds* chosen = scene->lights().choose_along(ray, 8, (float(i) + 0.5f) / kSamples, time);
      ASSERT_NE(chosen, nullptr);
      ++count[std::round(chosen->box.center().x)];
    }
    // One lamp is off; the other has twice its mean power beside the steady one, whose part of the segment subtends some less.
    EXPECT_EQ(count.count(time < 0.5f ? 1.f : -1.f), 0u) << time;
    EXPECT_GT(count[time < 0.5f ? -1.f : 1.f], kSamples / 2) << time;
    EXPECT_GT(count[3.f], kSamples / 5) << time;
  }
}

TEST(LightSampler, ChoiceByPowerHasItsProbability) {
  SeededRandom random(6);
  const auto scene =
      scene_with(random_lights(random, 12, 2) +
                 "<emitter type=\"constant\"><float name=\"radiance\" value=\"0.01\"/></emitter>"
                 "<emitter type=\"point\"><float name=\"intensity\" value=\"0\"/></emitter>");
  std::map<std::pair<const Light*, std::size_t>, std::pair<int, float>> found;
  constexpr int samples = 100000;
  for (int i = 0; i < samples; ++i) {
    const auto c = scene->lights().choose_by_power({(float(i) + 0.5f) / samples, 0.5f});
    ASSERT_TRUE(c);
    auto& [count, probability] = found[{c->light, c->part}];
    ++count, probability = c->probability;
  }
  double total = 0;
  for (const auto& [part, f] : found) {
    EXPECT_NEAR(double(f.first) / samples, f.second, 2.0 / samples);
    EXPECT_EQ(f.second, scene->lights().probability_by_power(*part.first, part.second));
    total += f.second;
  }
  EXPECT_NEAR(total, 1, 1e-5);
  std::size_t parts = 0;
  for (const Light& e : scene->emitters()) parts += e.part_count();
  EXPECT_EQ(found.size(), parts - 1) << "all but the one without power";
  EXPECT_TRUE(scene->lights().choose_by_power({0x1.fffffep-1f, 0x1.fffffep-1f}));
  EXPECT_FALSE(scene_with("")->lights().choose_by_power({0.5f, 0.5f}));
}

TEST(LightSampler, OneLightIsCertain) {
  const auto scene =
      scene_with("<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/></emitter>");
  const auto c = scene->lights().choose({0, 0, 0}, {0, 0, 1}, 0.7f);
  ASSERT_TRUE(c);
  EXPECT_EQ(c->probability, 1);
  EXPECT_EQ(c->light, &scene->emitters()[0]);
}

TEST(LightSampler, EmptyAndDark) {
  const auto none = scene_with("");
  EXPECT_TRUE(none->lights().empty());
  EXPECT_FALSE(none->lights().choose({}, {}, 0.5f));
  const auto dark = scene_with("<emitter type=\"point\"><float name=\"intensity\" value=\"0\"/></emitter>");
  EXPECT_TRUE(dark->lights().empty());
  EXPECT_EQ(dark->lights().probability({1, 0, 0}, {}, dark->emitters()[0], 0), 0);
}

TEST(LightSampler, InfiniteLightsShareWithTheTree) {
  SeededRandom random(5);
  const auto scene =
      scene_with(random_lights(random, 8, 2) + "<emitter type=\"constant\"/><emitter type=\"constant\"/>");
  const auto& infinite = scene->infinite_emitters();
  ASSERT_EQ(infinite.size(), 2u);
  for (int k = 0; k < 100; ++k) {
    const Vec3 p = in_box(random, 5);
    const float a = scene->lights().probability(p, {}, *infinite[0], 0),
                b = scene->lights().probability(p, {}, *infinite[1], 0);
    EXPECT_EQ(a, b);
    EXPECT_GT(a, 0.1f);
    EXPECT_LT(a + b, 0.9f);
  }
  const auto only = scene_with("<emitter type=\"constant\"/>");
  EXPECT_EQ(only->lights().probability({}, {}, only->emitters()[0], 0), 1);
  EXPECT_EQ(only->lights().choose({}, {}, 0x1.fffffep-1f)->light, &only->emitters()[0]);
}

std::string look(const Vec3& from, const Vec3& to) {
  const auto list = [](const Vec3& v) {
    return std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z);
  };
  return "<transform name=\"to_world\"><lookat origin=\"" + list(from) + "\" target=\"" + list(to) +
         "\" up=\"0.1, 0.2, 1\"/></transform>";
}

TEST(LightSampler, SpotsAndProjectorsAreNeverLost) {
  SeededRandom random(5);
  int contributions = 0, dark = 0;
  for (int scenes = 0; scenes < 8; ++scenes) {
    std::string text;
    for (int k = 0; k < 5 + 6 * scenes; ++k) {
      const Vec3 at = in_box(random, 2);
      const std::string place = look(at, at + square_to_uniform_sphere(random.next2()));
      const float angle = 179.5f * random.next() * (k % 3 ? 1.f : random.next() * random.next()) + 0.05f;
      text += k % 2 ? "<emitter type=\"projector\">" + place + "<float name=\"fov\" value=\"" +
                          std::to_string(angle) + "\"/></emitter>"
                    : "<emitter type=\"spot\">" + place + "<float name=\"cutoff_angle\" value=\"" +
                          std::to_string(angle) + "\"/><float name=\"beam_width\" value=\"" +
                          std::to_string(angle * random.next()) + "\"/></emitter>";
    }
    const auto scene = scene_with(text);
    const Wavelengths w = Wavelengths::at(scene->wavelengths().grid(), 550.f);
    for (const Light& e : scene->emitters())
      for (int k = 0; k < 4000; ++k) {
        // Half the points lie along rays that the light sends, also those of narrow cones.
        Vec3 p = in_box(random, 2.5f);
        if (k % 2) {
          const Vec2 a = random.next2(), b = random.next2();
          const auto r = e.sample_ray(0, a, b, w);
          if (!r) continue;
          p = r->p + r->d * (5 * random.next());
        }
        const auto s = e.sample_direct(p, 0, {}, w);
        if (!s || is_black(s->radiance)) {
          ++dark;
          continue;
        }
        ++contributions;
        const Vec3 n = square_to_uniform_sphere(random.next2());
        ASSERT_GT(scene->lights().probability(p, {}, e, 0), 0);
        if (std::abs(dot(n, s->wo)) > 1e-4f) {
          ASSERT_GT(scene->lights().probability(p, n, e, 0), 0);
        }
      }
  }
  EXPECT_GT(contributions, 300000);
  EXPECT_GT(dark, 100000);
}

TEST(LightSampler, ASpotCountsByItsIntensity) {
  // A spot and a point of one intensity, as far away as each other: a narrow cone has little power, but a
  // point inside it receives the same.
  const auto scene = scene_with(
      "<emitter type=\"point\"><point name=\"position\" x=\"-1\" y=\"0\" z=\"3\"/></emitter>"
      "<emitter type=\"spot\">" +
      look({1, 0, 3}, {0, 0, 0}) + "<float name=\"cutoff_angle\" value=\"5\"/></emitter>");
  const Light &point = scene->emitters()[0], &spot = scene->emitters()[1];
  const float a = scene->lights().probability({0, 0, 0}, {}, point, 0),
              b = scene->lights().probability({0, 0, 0}, {}, spot, 0);
  EXPECT_NEAR(a, 0.5f, 0.01f);
  EXPECT_NEAR(b, 0.5f, 0.01f);
  EXPECT_EQ(scene->lights().probability({0, 2, 0}, {}, point, 0), 1);
  EXPECT_EQ(scene->lights().probability({0, 2, 0}, {}, spot, 0), 0);
}

TEST(LightSampler, SamplingWeights) {
  const auto weighted = [](const std::string& type, const std::string& weight) {
    return "<emitter type=\"" + type + "\"><float name=\"sampling_weight\" value=\"" + weight +
           "\"/></emitter>";
  };
  const auto probability = [](const Scene& s, std::size_t e) {
    return s.lights().probability({1, 2, 3}, {0, 0, 1}, s.emitters()[e], 0);
  };
  // Emitters at infinity, deltas among them, by their weights; all others together count as one more.
  const auto scene = scene_with(weighted("directional", "3") + weighted("constant", "0.5") +
                                weighted("directional", "0.5") + weighted("point", "1") +
                                weighted("point", "3") + weighted("point", "0") + weighted("constant", "0"));
  const float expected[] = {0.6f, 0.1f, 0.1f, 0.05f, 0.15f, 0, 0};
  std::map<const Light*, int> count;
  for (int i = 0; i < 10000; ++i) {
    const auto c = scene->lights().choose({1, 2, 3}, {0, 0, 1}, (float(i) + 0.5f) / 10000);
    ASSERT_TRUE(c);
    ++count[c->light];
    ASSERT_FLOAT_EQ(c->probability, scene->lights().probability({1, 2, 3}, {0, 0, 1}, *c->light, 0));
  }
  for (std::size_t e = 0; e < 7; ++e) {
    EXPECT_NEAR(probability(*scene, e), expected[e], 1e-6f) << e;
    EXPECT_NEAR(count[&scene->emitters()[e]], 10000 * expected[e], 2) << e;
  }
  // Escaping rays see emitters whatever their weights, but not beams from infinity.
  EXPECT_EQ(scene->infinite_emitters().size(), 2u);

  // Without others, those at infinity share everything.
  const auto suns = scene_with(weighted("directional", "1") + weighted("directional", "3"));
  EXPECT_FLOAT_EQ(probability(*suns, 0), 0.25f);
  EXPECT_FLOAT_EQ(probability(*suns, 1), 0.75f);
  EXPECT_EQ(suns->lights().choose({}, {}, 0x1.fffffep-1f)->light, &suns->emitters()[1]);
  // Lights without connections take no share either.
  const auto beam = scene_with(weighted("constant", "1") +
                               "<shape type=\"rectangle\"><emitter type=\"directionalarea\"/></shape>");
  const Light& constant = beam->emitters()[1];
  EXPECT_EQ(beam->lights().probability({1, 2, 3}, {}, constant, 0), 1);
  for (const float u : {0.f, 0.5f, 0x1.fffffep-1f})
    EXPECT_EQ(beam->lights().choose({1, 2, 3}, {}, u)->light, &constant);
  const auto nothing = scene_with("<shape type=\"rectangle\"><emitter type=\"directionalarea\"/></shape>");
  EXPECT_FALSE(nothing->lights().choose({1, 2, 3}, {}, 0.5f));

  EXPECT_THROW(scene_with(weighted("point", "-1")), Error);
}

}  // namespace
}  // namespace aureole::testing
