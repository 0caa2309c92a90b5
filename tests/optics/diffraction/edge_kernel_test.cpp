// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "aureole/optics/diffraction/edge_power.h"
#include "aureole/optics/diffraction/gaussian_beam.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

SpaceVector unit(double x, double y, double z) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}
double dot(SpaceVector a, SpaceVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

TEST(DirectionMap, KeepsAreasAndInverts) {
  const SpaceVector along = unit(0.3, -0.5, 0.8);
  const double k = 5;
  const DirectionMap map(along, k);
  for (PlanePoint q : {PlanePoint{0.1, 0.2}, {-3, 2}, {1, -8}, {7, 6.9}}) {
    const SpaceVector d = *map.direction(q);
    EXPECT_NEAR(dot(d, d), 1, 1e-14);
    EXPECT_NEAR(std::hypot(q.x, q.y), 2 * k * std::sin(0.5 * std::acos(dot(d, along))), 1e-12);
    const PlanePoint back = map.wave_vector(d);
    EXPECT_NEAR(back.x, q.x, 1e-12);
    EXPECT_NEAR(back.y, q.y, 1e-12);
    // The area of a small parallelogram.
    const double h = 1e-5;
    const SpaceVector right = *map.direction({q.x + h, q.y}), up = *map.direction({q.x, q.y + h});
    const SpaceVector e{right.x - d.x, right.y - d.y, right.z - d.z}, f{up.x - d.x, up.y - d.y, up.z - d.z};
    const double area = std::sqrt(dot(e, e) * dot(f, f) - dot(e, f) * dot(e, f));
    EXPECT_NEAR(area / (h * h), 1 / (k * k), 1e-4 / (k * k));
  }
  EXPECT_FALSE(map.direction({6, 8.1}));
}

/// A bent, closed chain of edges in space about the origin, seen by a beam in the plane of two directions.
struct Chain {
  std::vector<SpaceVector> points{
      {-0.8, -0.3, 0.2}, {0.9, -0.5, -0.4}, {0.5, 0.7, 0.1}, {-0.1, 0.2, 0.3}, {-0.6, 0.9, -0.2}};

  /// Edges and their true lengths.
  std::pair<std::vector<DiffractingEdge>, std::vector<double>> lit(const ScatteringPlane& plane,
                                                                   SpaceVector centre,
                                                                   const GaussianBeam& beam) const {
    std::pair<std::vector<DiffractingEdge>, std::vector<double>> result;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SpaceVector a = points[i], b = points[(i + 1) % points.size()];
      const PlanePoint p = plane.project({a.x - centre.x, a.y - centre.y, a.z - centre.z}),
                       q = plane.project({b.x - centre.x, b.y - centre.y, b.z - centre.z});
      DiffractingEdge pieces[64];
      const std::size_t count = beam.light(p, q, 20, 0.3, pieces);
      const SpaceVector e{b.x - a.x, b.y - a.y, b.z - a.z};
      for (std::size_t j = 0; j < count; ++j) {
        result.first.push_back(pieces[j]);
        result.second.push_back(std::sqrt(dot(e, e)) / double(count));
      }
    }
    return result;
  }
};

TEST(EdgeKernel, IsTheSameWhenLightRunsBackwards) {
  const Chain chain;
  const GaussianBeam beam(0.5);
  const double k = 40;
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    const SpaceVector d_i = unit(normal(random), normal(random), normal(random));
    const SpaceVector d_o =
        unit(d_i.x + 0.2 * normal(random), d_i.y + 0.2 * normal(random), d_i.z + 0.2 * normal(random));
    const SpaceVector centre{0.2, 0.1, -0.1};
    double intensity[2], share[2];
    for (int way = 0; way < 2; ++way) {
      const ScatteringPlane plane =
          way == 0 ? ScatteringPlane(d_i, d_o, k)
                   : ScatteringPlane({-d_o.x, -d_o.y, -d_o.z}, {-d_i.x, -d_i.y, -d_i.z}, k);
      // The phase in space is that in the plane: nothing is left along the light.
      const SpaceVector v{0.3, -2, 1};
      EXPECT_NEAR(plane.q().x * plane.project(v).x,
                  k * ((d_o.x - d_i.x) * v.x + (d_o.y - d_i.y) * v.y + (d_o.z - d_i.z) * v.z), 1e-11);
      const auto [edges, lengths] = chain.lit(plane, centre, beam);
      std::vector<double> squares(edges.size());
      const EdgeWaves waves = edge_waves(edges, plane.q(), squares);
      intensity[way] = diffracted_intensity(waves, plane.q(), k, beam.zeroth_order());
      share[way] = squares[3] / waves.squares / lengths[3];
      double all = 0;
      for (std::size_t i = 0; i < edges.size(); ++i)
        all += squares[i] / (waves.squares * lengths[i]) * lengths[i];
      EXPECT_NEAR(all, 1, 1e-12);
    }
    EXPECT_NEAR(intensity[1] / intensity[0], 1, 1e-9);
    EXPECT_NEAR(share[1] / share[0], 1, 1e-9);
  }
}

// All light that an evenly lit straight edge sends to the angle theta, per length and radian: centres across the edge, directions along it.
// The amplitude changes along the edge, and S2.9 drops its gradient: with q = (k theta, q_y) the wave has the factor k theta/q^2 where
// the exact one is 1/(k theta). Keller's coefficient is what remains for theta >> sigma_xi = 1/(2 k sigma), to 2 (sigma_xi/theta)^2.
TEST(EdgeKernel, OfAStraightEdgeTendsToKellersCoefficient) {
  const double lambda = 1, k = 2 * M_PI / lambda, sigma = 25 * lambda, sigma_xi = 1 / (2 * k * sigma);
  const GaussianBeam beam(sigma);
  for (double reach : {3.0, 4.0, 5.0})
    for (double theta : {3 * sigma_xi, 6 * sigma_xi, 15 * sigma_xi, 0.2}) {
      const double qx = k * theta;
      double sum = 0, expected = 0, mean = 0;
      const double step_c = sigma / 2, step_q = 0.1 / sigma;
      const ProjectedEdge line{{0, -30 * sigma}, {0, 30 * sigma}, 60 * sigma};
      const double keller = lambda / (4 * M_PI * M_PI * theta * theta);
      for (double qy = -5 / sigma; qy < 5 / sigma; qy += step_q) {
        // Directions along the edge are those of the beam's own spectrum.
        const double ratio = qy / qx;
        expected += keller * std::exp(-2 * sigma * sigma * qy * qy) * std::sqrt(2 / M_PI) * sigma * step_q /
                    std::pow(1 + ratio * ratio, 2) * -std::expm1(-2 * sigma * sigma * (qx * qx + qy * qy));
        mean += mean_edge_kernel(std::span(&line, 1), 0, 0.5, {qx, qy}, k, sigma) * step_q / k;
        for (double c = -6 * sigma; c < 6 * sigma; c += step_c) {
          DiffractingEdge pieces[64];
          const std::size_t count = beam.light({-c, -9 * sigma}, {-c, 9 * sigma}, reach, 0.25, pieces);
          double squares[64];
          const EdgeWaves waves = edge_waves(std::span(pieces, count), {qx, qy}, std::span(squares, count));
          sum += diffracted_intensity(waves, {qx, qy}, k, beam.zeroth_order()) * step_c * step_q / k;
        }
      }
      std::printf(
          "edges within %g sigma, theta = %4.1f sigma_xi: K/(lambda/(4 pi^2 theta^2)) = %.3f, by the mean over all centres %.4f\n",
          reach, theta / sigma_xi, sum / keller, mean / keller);
      EXPECT_NEAR(sum / expected, 1, reach < 4 ? 0.05 : 0.01);
      EXPECT_NEAR(mean / expected, 1, 1e-6);
      EXPECT_NEAR(mean / keller, 1, 2.5 * std::pow(sigma_xi / theta, 2));
    }
}

// At a straight edge: over the directions along it Keller's coefficient, over the sphere its power, by quadrature about the light that
// arrives.
TEST(EdgeKernel, OfAStraightEdgeIsKellersFromThreeWidthsOn) {
  const double sigma[4] = {1, 1, 1, 1};
  for (const double wavelengths : {5.0, 25.0}) {
    const double kn = 2 * M_PI * wavelengths, k[4] = {kn, kn, kn, kn}, width = 1 / (2 * kn);
    double result[4];
    for (const double theta : {3.05, 4.0, 6.0, 15.0}) {
      double sum = 0;
      const double step = 0.02 * width;
      for (double along = -10 * width; along < 10 * width; along += step) {
        straight_edge_kernels(theta * width, along, 1, k, sigma, result);
        sum += result[0] * step;
      }
      const double keller = 2 * M_PI / kn / (4 * M_PI * M_PI * theta * theta * width * width);
      EXPECT_NEAR(sum / keller, 1, 0.01) << theta;
    }
    for (const double tilt : {0.0, 0.8}) {
      // The edge along x, light in the plane of x and z.
      const SpaceVector d{std::sin(tilt), 0, std::cos(tilt)};
      double expected = 0;
      const int rings = 600;
      const double first = std::log(1e-3 / kn), last = std::log(2);
      for (int r = 0; r < rings; ++r) {
        const double v = std::exp(first + (r + 0.5) * (last - first) / rings);
        const double cosine = 1 - 0.5 * v * v, sine = v * std::sqrt(1 - 0.25 * v * v);
        const int steps = 200 + int(60 * kn * v);
        double mean = 0;
        for (int n = 0; n < steps; ++n) {
          const double phi = 2 * M_PI * (n + 0.5) / steps, x = sine * std::cos(phi), y = sine * std::sin(phi);
          const SpaceVector out{x * d.z + cosine * d.x, y, cosine * d.z - x * d.x};
          const ScatteringPlane plane(d, out, kn);
          const PlanePoint e = plane.project({1, 0, 0});
          const double shown = std::hypot(e.x, e.y);
          if (!(shown > 1e-9)) continue;
          // q lies along the first axis of the plane.
          straight_edge_kernels(v * std::abs(e.y) / shown, v * std::abs(e.x) / shown, shown, k, sigma,
                                result);
          mean += result[0] / steps;
        }
        expected += 2 * M_PI * v * v * (last - first) / rings * mean;
      }
      EXPECT_NEAR(straight_edge_power(std::sin(tilt), kn, 1), expected, 0.004 * expected)
          << wavelengths << " " << tilt;
    }
  }
}

// The correction of K near corners and other edges: its integral over directions, and its weight in cases that are known.
TEST(EdgeKernel, CorrectionsOfStraightEdgesHaveTheirPower) {
  const double kn = 200, k[4] = {kn, kn, kn, kn}, sigma[4] = {1, 1, 1, 1}, ones[4] = {1, 1, 1, 1};
  double sum = 0, result[4];
  const int steps = 400;
  const double first = std::log(1e-4), last = std::log(60.0);
  for (int i = 0; i < steps; ++i) {
    const double q = std::exp(first + (i + 0.5) * (last - first) / steps), step = q * (last - first) / steps;
    for (double along = -4; along < 4; along += 0.01) {
      std::fill(result, result + 4, 0.0);
      add_straight_edge_corrections(q / kn, along / kn, 1, ones, k, sigma, result);
      sum += 2 * result[0] * step * 0.01 / (kn * kn);  // on both sides
    }
  }
  EXPECT_NEAR(sum, straight_edge_power_correction(0, 1), 1e-4);
  EXPECT_NEAR(straight_edge_power_correction(0.6, 2), 1.6 * straight_edge_power_correction(0, 1), 1e-12);
  // To what the mean kernel has it adds what the kernel of endless edges has more.
  const ProjectedEdge line{{-100, 0}, {100, 0}, 200};
  const double across = 4 / kn, along = 0.5 / kn, turn = std::hypot(across, along);
  const PlanePoint u{along / turn, across / turn};  // the turn along the first axis
  const ProjectedEdge turned{{-100 * u.x, 100 * u.y}, {100 * u.x, -100 * u.y}, line.length};
  result[0] = mean_edge_kernel(std::span(&turned, 1), 0, 0.5, {kn * turn, 0}, kn, 1);
  std::fill(result + 1, result + 4, result[0]);
  add_straight_edge_corrections(across, along, 1, ones, k, sigma, result);
  double straight[4];
  straight_edge_kernels(across, along, 1, k, sigma, straight);
  EXPECT_NEAR(result[0], straight[0], 1e-6 * straight[0]);
}

TEST(EdgeKernel, WeightsOfStraightEdgesAreTheirPartOfTheLight) {
  const double sigma[4] = {0.5, 1, 2, 4};
  double weights[4];
  const auto weigh = [&](double before, double after, std::initializer_list<ProjectedEdge> others) {
    straight_edge_weights({0, 0}, before, after, {others.begin(), others.size()}, sigma, weights);
  };
  weigh(100, 100, {});
  for (const double w : weights) EXPECT_NEAR(w, 1, 1e-6);
  weigh(100, 0, {});
  for (const double w : weights) EXPECT_NEAR(w, 0.5, 1e-6);
  weigh(1.3, 0.4, {});
  for (int i = 0; i < 4; ++i) {
    const double scale = std::sqrt(8.0) * sigma[i];
    EXPECT_NEAR(weights[i], 0.5 * (std::erf(1.3 / scale) + std::erf(0.4 / scale)), 0.007) << i;
  }
  // The other side of a wire and of a slit, and far away.
  for (const double side : {1.0, -1.0}) {
    weigh(100, 100, {{{100 * side, 1e-6}, {-100 * side, 1e-6}, 200}});
    for (const double w : weights) EXPECT_NEAR(w, 0, 1e-9);
    weigh(100, 100, {{{100 * side, 2}, {-100 * side, 2}, 200}});
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(weights[i], 1 - std::exp(-0.5 / (sigma[i] * sigma[i])), 1e-4);
  }
  weigh(100, 100, {{{100, 30}, {-100, 30}, 200}});
  for (const double w : weights) EXPECT_NEAR(w, 1, 1e-3);
  // A corner of about 90 degrees: smooth in its angle.
  double before[4];
  for (const double lean : {-1e-6, 1e-6}) {
    weigh(1, 100, {{{-1, 0}, {-1 + 50 * lean, 50}, 50}});
    if (lean < 0) std::copy(weights, weights + 4, before);
  }
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(weights[i], before[i], 1e-5);
}

// Over the sphere by rings about the light that arrives, each direction with edges projected along the mean of both.
TEST(EdgeKernel, PowersAreItsIntegralOverDirections) {
  // In sigma: the middle and near the end of an edge, near others, beside a narrow gap.
  struct Case {
    const char* name;
    Ring ring;
    std::size_t index;
    double at;
  };
  const Ring wire{{0, 0}, {9, 0}, {9, 0.1}, {0, 0.1}};
  for (const Case& c : {Case{"square", testing::regular_ring(4, 6, 0.2), 0, 0.5},
                        {"corner of a square", testing::regular_ring(4, 6, 0.2), 1, 0.02},
                        {"triangle", testing::regular_ring(3, 0.7, 0.5), 2, 0.3},
                        {"wire", wire, 0, 0.5},
                        {"wire", wire, 1, 0.7}}) {
    const PlanePoint from = c.ring[c.index], to = c.ring[(c.index + 1) % c.ring.size()];
    const PlanePoint at{from.x + c.at * (to.x - from.x), from.y + c.at * (to.y - from.y)};
    const auto projected = [&](const ScatteringPlane& plane) {
      std::vector<ProjectedEdge> edges;
      for (std::size_t i = 0; i < c.ring.size(); ++i) {
        const PlanePoint a = c.ring[i], b = c.ring[(i + 1) % c.ring.size()];
        edges.push_back({plane.project({a.x - at.x, a.y - at.y, 0}),
                         plane.project({b.x - at.x, b.y - at.y, 0}), std::hypot(b.x - a.x, b.y - a.y)});
      }
      return edges;
    };
    for (const double tilt : {0.0, 0.8})
      for (const double wavelengths : {5.0, 25.0}) {
        const double s = std::sin(tilt), z = std::cos(tilt);
        const SpaceVector d{s, 0, z};
        // Beams in proportion to the wavelength, as for rendering.
        std::vector<double> k, sigma, result(8);
        for (int i = 0; i < 8; ++i)
          sigma.push_back(1 - 0.05 * i), k.push_back(2 * M_PI * wavelengths / sigma.back());
        const auto direction = [&](double v, double phi) {
          // v is the length of the difference of both directions: v dv dphi is the solid angle.
          const double cosine = 1 - 0.5 * v * v, sine = v * std::sqrt(1 - 0.25 * v * v),
                       x = sine * std::cos(phi), y = sine * std::sin(phi);
          return SpaceVector{x * z + cosine * s, y, cosine * z - x * s};
        };
        mean_edge_powers(projected(ScatteringPlane(d, d, 1)), c.index, c.at, k, sigma, result);
        const int i = 5, rings = 300;
        double expected = 0;
        const double first = std::log(1e-3 / k[i]), last = std::log(2);
        for (int r = 0; r < rings; ++r) {
          const double v = std::exp(first + (r + 0.5) * (last - first) / rings);
          const int steps = 100 + int(12 * k[i] * v);  // lobes of long edges are narrow
          double mean = 0;
          for (int n = 0; n < steps; ++n) {
            const ScatteringPlane plane(d, direction(v, 2 * M_PI * (n + 0.5) / steps), k[i]);
            mean += mean_edge_kernel(projected(plane), c.index, c.at, plane.q(), k[i], sigma[i]) / steps;
          }
          expected += 2 * M_PI * v * v * (last - first) / rings * mean;
        }
        std::printf(
            "%-18s at %4.2f, tilt %.1f, sigma of %2.0f wavelengths: S = %.5f, by quadrature %.5f, %+.2f %%\n",
            c.name, c.at, tilt, wavelengths, result[i], expected, 100 * (result[i] / expected - 1));
        // Gaps of a wavelength and less send light beyond directions of which only the edge's own part is left out.
        EXPECT_NEAR(result[i], expected,
                    c.ring[1].x == wire[1].x || wavelengths < 10 ? 0.03 / wavelengths : 0.002 * expected);
      }
  }
}

// Both kernels along all edges of a figure, against one another: centres summed on a grid, points along the edges by Simpson's rule.
TEST(EdgeKernel, TheMeanIsTheIntegralOverCentres) {
  const double sigma = 1, k = 60;
  const GaussianBeam beam(sigma);
  for (const Ring& ring : {testing::regular_ring(4, 1.5, 0.2), testing::regular_ring(3, 4, 0.5),
                           Ring{{0, 0}, {3, 0}, {3, 0.2}, {0, 0.2}}})
    for (PlanePoint q : {PlanePoint{0.7, 0.3}, {-2, 5}, {11, 4}}) {
      double drawn = 0;
      const double step = 0.4;
      for (double x = -9; x < 9; x += step)
        for (double y = -9; y < 9; y += step) {
          std::vector<DiffractingEdge> edges;
          for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanePoint a = ring[i], b = ring[(i + 1) % ring.size()];
            DiffractingEdge pieces[128];
            const std::size_t count = beam.light({a.x - x, a.y - y}, {b.x - x, b.y - y}, 8, 0.1, pieces);
            edges.insert(edges.end(), pieces, pieces + count);
          }
          std::vector<double> squares(edges.size());
          drawn +=
              diffracted_intensity(edge_waves(edges, q, squares), q, k, beam.zeroth_order()) * step * step;
        }
      std::vector<ProjectedEdge> edges;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanePoint a = ring[i], b = ring[(i + 1) % ring.size()];
        edges.push_back({a, b, std::hypot(b.x - a.x, b.y - a.y)});
      }
      double mean = 0;
      constexpr int kSteps = 400;
      for (std::size_t i = 0; i < edges.size(); ++i)
        for (int s = 0; s <= kSteps; ++s)
          mean += edges[i].length / kSteps / 3 *
                  (s == 0 || s == kSteps ? 1
                   : s % 2               ? 4
                                         : 2) *
                  mean_edge_kernel(edges, i, double(s) / kSteps, q, k, sigma);
      EXPECT_NEAR(mean / drawn, 1, 2e-3) << ring.size() << " " << q.x;
    }
}

// The kernel that pictures are made of, against the one by libcerf: figures of all sizes, from far inside a beam to far beyond it,
// places at and between corners, small and large turns, beams whose width follows the wavelength or not.
TEST(EdgeKernel, OfManyWavelengthsIsThatOfEach) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  double worst = 0, worst_q = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const double size = std::pow(10, 4 * uniform(random) - 2), width = std::pow(10, 1.5 * uniform(random));
    const double turn = std::pow(10, -4 + 4.3 * uniform(random));
    double k[12], sigma[12], result[12];
    for (int i = 0; i < 12; ++i) {
      const double lambda = 0.4 + 0.03 * i;
      k[i] = 2 * M_PI / lambda, sigma[i] = trial % 2 ? width * lambda : width * std::sqrt(lambda);
    }
    std::vector<ProjectedEdge> edges;
    PlanePoint last{size * uniform(random), size * uniform(random)};
    for (int i = 0; i < 5; ++i) {
      PlanePoint next{size * uniform(random), size * uniform(random)};
      if (i == 3) next = last, next.y += size;  // along the turn, and across it
      if (i == 4) next.y = last.y;
      edges.push_back({last, next, std::hypot(next.x - last.x, next.y - last.y) * (1 + uniform(random))});
      last = next;
    }
    const double at = trial % 5 == 0 ? 0 : trial % 5 == 1 ? 1 : uniform(random);
    mean_edge_kernels(edges, at, turn, k, sigma, result);
    for (int i = 0; i < 12; ++i) {
      const double expected = mean_edge_kernel(edges, 0, at, {k[i] * turn, 0}, k[i], sigma[i]);
      // In units of what a place on a straight edge across the turn sends at most.
      const double q2 = k[i] * k[i] * turn * turn, chi = std::exp(-2 * sigma[i] * sigma[i] * q2);
      const double error =
          std::abs(result[i] - expected) / (sigma[i] * (1 - chi) / (turn * turn) * std::sqrt(8.0));
      if (error > worst) worst = error, worst_q = std::sqrt(q2) * sigma[i];
    }
  }
  std::printf("largest difference of the two kernels: %.2g of a straight edge's (at q sigma = %.2g)\n", worst,
              worst_q);
  EXPECT_LT(worst, 3e-9);
}

TEST(EdgeKernel, HasOneLobeForAllEdges) {
  EXPECT_THROW(diffracted_intensity({}, {1, 0}, 1, ZerothOrder::of_edges()), std::logic_error);
  EXPECT_EQ(diffracted_intensity({2.0, 4.0}, {1, 0}, 2 * M_PI, ZerothOrder::kept()), 4.0);
  const ProjectedEdge edge{{0, 0}, {0, 1}, 1};
  EXPECT_EQ(mean_edge_kernel(std::span(&edge, 1), 0, 0.5, {0, 0}, 1, 1), 0);
}

// The fraction of the light on an obstacle that its edge diffracts at the distance y from it: the mean of D_c over centres about y. D_c of single beams
// whose centre lies outside is above 1, since their edges' waves without the gradient's term have more power than falls on the obstacle.
TEST(EdgeKernel, WhatIsLentStaysBelowWhatFalls) {
  const GaussianBeam beam(1);
  const double far = 30;
  struct Case {
    const char* name;
    Ring obstacle;
    PlanePoint at;
  };
  const double thin = 0.05;
  const Case cases[] = {
      {"half plane, at its edge", {{0, -far}, {far, -far}, {far, far}, {0, far}}, {0, 0}},
      {"half plane, 1 sigma inside", {{0, -far}, {far, -far}, {far, far}, {0, far}}, {1, 0}},
      {"half plane, 3 sigma inside", {{0, -far}, {far, -far}, {far, far}, {0, far}}, {3, 0}},
      {"corner of 90 degrees", {{0, 0}, {far, 0}, {far, far}, {0, far}}, {0, 0}},
      {"wire of sigma/20", {{-thin / 2, -far}, {thin / 2, -far}, {thin / 2, far}, {-thin / 2, far}}, {0, 0}},
      {"needle of 10 degrees",
       {{0, 0}, {far, -far * std::tan(M_PI / 36)}, {far, far * std::tan(M_PI / 36)}},
       {0, 0}}};
  for (const Case& c : cases) {
    double lent = 0, most = 0, total = 0;
    const double step = 0.5;
    for (double x = -4; x <= 4; x += step)
      for (double y = -4; y <= 4; y += step) {
        const PlanePoint centre{c.at.x + x, c.at.y + y};
        std::vector<DiffractingEdge> edges;
        Ring ring;
        for (std::size_t i = 0; i < c.obstacle.size(); ++i) {
          const PlanePoint a = c.obstacle[i], b = c.obstacle[(i + 1) % c.obstacle.size()];
          ring.push_back({a.x - centre.x, a.y - centre.y});
          DiffractingEdge pieces[64];
          const std::size_t count =
              beam.light({a.x - centre.x, a.y - centre.y}, {b.x - centre.x, b.y - centre.y}, 5, 0.5, pieces);
          edges.insert(edges.end(), pieces, pieces + count);
        }
        const double weight = beam.intensity({x, y}) * step * step;
        const double d =
            interfering_power(edges, beam.zeroth_order().sigma, 8) / std::max(beam.power(ring), 1e-13);
        lent += weight * d, total += weight;
        if (weight > 1e-3 * step * step) most = std::max(most, d);
      }
    lent /= total;
    std::printf("%-27s D(y) = %.3f; largest D_c of a beam within 3 sigma %.2f\n", c.name, lent, most);
    EXPECT_GT(lent, 0);
    EXPECT_LT(lent, 1) << c.name;
  }
}

}  // namespace
}  // namespace aureole::optics
