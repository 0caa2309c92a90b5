// SPDX-License-Identifier: Apache-2.0
// The recursive weights of two-way paths against products of all densities, over random paths.
#include "aureole/transport/two_way.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "aureole/core/random.h"

namespace aureole::testing {
namespace {

using Numbers = std::array<double, kWavelengths>;

class Random {
public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  float number(float lower, float upper) {
    return lower + (upper - lower) * unit_float(std::uint32_t(mix_bits(state_ += 0x9e3779b97f4a7c15u) >> 32));
  }
  Spectrum spectrum(float lower, float upper) {
    return make_spectrum([&](int) { return number(lower, upper); });
  }

private:
  std::uint64_t state_;
};

/// A vertex of a path, with the densities of scattering by light (towards the sensor) and by the sensor's walk.
struct RandomVertex {
  bool in_medium, delta;
  Spectrum by_light, by_sensor;  ///< per solid angle, or the same mass
  Spectrum before, behind;       ///< `density_across` towards the emitter and towards the sensor
};
/// The stretch before a vertex.
struct RandomEdge {
  float distance2;
  Spectrum passed;  ///< the part of walks that arrive
};

struct RandomPath {
  std::vector<RandomVertex> vertices;  ///< the first is on the emitter, the last on the sensor
  std::vector<RandomEdge> edges;       ///< edges[i] ends at vertex i

  RandomPath(int edge_count, Random& random) {
    for (int i = 0; i <= edge_count; ++i) {
      RandomVertex v;
      const bool inner = i > 0 && i < edge_count;
      v.in_medium = inner && random.number(0, 1) < 0.3f;
      v.delta = inner && !v.in_medium && random.number(0, 1) < 0.3f;
      v.by_light = random.spectrum(0.1f, 3), v.by_sensor = v.delta ? v.by_light : random.spectrum(0.1f, 3);
      // Delta directions that depend on the wavelength.
      if (v.delta && random.number(0, 1) < 0.3f) {
        for (int j = 1; j < kWavelengths; ++j) v.by_light[j] = 0;
        v.by_sensor = v.by_light;
      }
      const float cosine = random.number(0.1f, 1), other = random.number(0.1f, 1);
      v.before = v.in_medium ? random.spectrum(0.1f, 2) : Spectrum(cosine);
      v.behind = v.in_medium ? random.spectrum(0.1f, 2) : Spectrum(other);
      vertices.push_back(v);
      edges.push_back({random.number(0.2f, 4), random.spectrum(0.05f, 1)});
    }
  }
  /// Makes the next wavelength the hero.
  void turn_wavelengths() {
    const auto turn = [](Spectrum& s) {
      const Spectrum before = s;
      s = make_spectrum([&](int j) { return before[(j + 1) % kWavelengths]; });
    };
    for (RandomVertex& v : vertices) turn(v.by_light), turn(v.by_sensor), turn(v.before), turn(v.behind);
    for (RandomEdge& e : edges) turn(e.passed);
  }
  int edge_count() const { return int(edges.size()) - 1; }

  /// Of vertex i, found by light or by the sensor's walk; the ends have the densities 1.
  double by_light(int i, int j) const {
    const RandomEdge& e = edges[size_t(i)];
    return i == 0 ? 1
                  : double(vertices[size_t(i - 1)].by_light[j]) * vertices[size_t(i)].before[j] *
                        e.passed[j] / e.distance2;
  }
  double by_sensor(int i, int j) const {
    if (i == edge_count()) return 1;
    const RandomEdge& e = edges[size_t(i + 1)];
    return double(vertices[size_t(i + 1)].by_sensor[j]) * vertices[size_t(i)].behind[j] * e.passed[j] /
           e.distance2;
  }
  /// The density of the technique with s vertices from the emitter and at least one from the sensor.
  Numbers density(int s) const {
    Numbers all;
    for (int j = 0; j < kWavelengths; ++j) {
      double product = 1;
      for (int i = 0; i <= edge_count(); ++i) product *= i < s ? by_light(i, j) : by_sensor(i, j);
      const bool connects = s == 0 || !(vertices[size_t(s - 1)].delta || vertices[size_t(s)].delta);
      all[size_t(j)] = connects ? product : 0;
    }
    return all;
  }
};

/// Walks along the path's vertices: from `first` on, in steps of 1 or -1, to `last`, and arrives there.
template <PathStart kStart>
TwoWayDensity<kStart> walked(const RandomPath& path, int first, int last, bool meets_first) {
  const bool light = kStart == PathStart::emitter;
  const int step = light ? 1 : -1;
  TwoWayDensity<kStart> d;
  for (int i = first; i != last; i += step) {
    const RandomVertex &from = path.vertices[size_t(i)], &to = path.vertices[size_t(i + step)];
    const RandomEdge& e = path.edges[size_t(light ? i + 1 : i)];
    const Spectrum forward = light ? from.by_light : from.by_sensor,
                   reverse = light ? from.by_sensor : from.by_light,
                   across_from = light ? from.behind : from.before, across_to = light ? to.before : to.behind;
    Scatter s;
    s.value = Weight(1.f), s.pdf = forward, s.delta = from.delta;
    if (i == first) {
      d.extend(Weight(1.f), forward, false);
      d.earlier = meets_first ? across_from * (1 / forward[0]) : Spectrum(0.f);
    } else {
      d.scatter(s, reverse, across_from);
    }
    const float hero = e.passed[0] * (to.in_medium ? across_to[0] : 1.f);
    Passage p;
    p.flight = e.passed * (to.in_medium ? across_to : Spectrum(1.f)) * (1 / hero);
    p.connection = 1 / hero;
    p.value = p.flight;
    d.pass(p);
    d.arrive(to.in_medium, across_to, e.distance2);
  }
  return d;
}

/// The weight of the technique with s vertices from the emitter and the hero at index 0, from the recursion.
double weight(const RandomPath& path, int s) {
  const int n = path.edge_count();
  if (s == 0) {
    // The sensor's walk meets the emitter.
    const auto sensor = walked<PathStart::sensor>(path, n, 0, false);
    const Spectrum others = sensor.r_l + path.vertices[0].by_light * sensor.earlier;
    return 1 / double(sum(sensor.r_u + others));
  }
  const auto light = walked<PathStart::emitter>(path, 0, s - 1, true);
  const auto sensor = walked<PathStart::sensor>(path, n, s, false);
  const RandomVertex &y = path.vertices[size_t(s - 1)], &z = path.vertices[size_t(s)];
  const RandomEdge& e = path.edges[size_t(s)];
  const Spectrum passed = e.passed * (1 / e.distance2);
  // The ends have no vertex before them.
  const Spectrum light_others = s == 1 ? Spectrum(1.f) : light.others(y.by_sensor),
                 sensor_others = s == n ? Spectrum(0.f) : sensor.others(z.by_light);
  const Spectrum others = sensor.r_u * z.by_sensor * y.behind * passed * light_others +
                          light.r_u * y.by_light * z.before * passed * sensor_others;
  return 1 / double(sum(light.r_u * sensor.r_u + others));
}

TEST(TwoWayWeights, AreTheBalanceHeuristicOverTechniquesAndWavelengths) {
  Random random(5);
  int compared = 0, complete = 0;
  for (int k = 0; k < 1000; ++k) {
    RandomPath path(2 + k % 6, random);
    const int n = path.edge_count();
    std::vector<Numbers> density;
    double all = 0;
    for (int s = 0; s <= n; ++s)
      for (const double x : density.emplace_back(path.density(s))) all += x;
    if (!(all > 0)) continue;
    double sum_of_weights = 0;
    for (int hero = 0; hero < kWavelengths; ++hero) {
      for (int s = 0; s <= n; ++s) {
        const double own = density[size_t(s)][size_t(hero)];
        if (!(own > 0)) continue;
        const double w = weight(path, s);
        EXPECT_NEAR(w, own / all, 2e-4 * w) << "path " << k << ", s = " << s << " of " << n;
        sum_of_weights += w, ++compared;
      }
      path.turn_wavelengths();
    }
    EXPECT_NEAR(sum_of_weights, 1, 2e-4) << "path " << k;
    ++complete;
  }
  EXPECT_GT(complete, 900);
  EXPECT_GT(compared, 10000);
}

}  // namespace
}  // namespace aureole::testing
