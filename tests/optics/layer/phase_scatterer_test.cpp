// SPDX-License-Identifier: Apache-2.0
// Transparent caps and discs against limits in closed form, a wave that is summed over a plane of caps, and rays that
// are refracted one by one.
#include "aureole/optics/layer/phase_scatterer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "aureole/optics/arrangement/hard_discs.h"
#include "aureole/optics/arrangement/simulated_structure_factor.h"
#include "harness/effort.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
constexpr double kPiD = std::numbers::pi;

PhaseProfile cap(double degrees, double index = 1.333) { return {degrees * kPiD / 180, index}; }

/// The circle's transform over its area, as a series.
double airy(double u) { return u < 1e-9 ? 1 : 2 * std::cyl_bessel_j(1, u) / u; }

TEST(PhaseScatterer, DiscsRetard) {
  const PhaseScatterer disc({}, {}, 60, 30);
  EXPECT_NEAR(disc.transmittance(), 1, 1e-12);
  for (double u = 0; u < 60; u += 0.37)
    for (double psi = 0; psi < 30; psi += 1.3) {
      const double d = kPiD * airy(u);
      EXPECT_NEAR(disc.intensity(float(u), float(psi), 1).coherent,
                  std::norm(std::polar(1.0, psi) - 1.0) * d * d, 4e-3 * kPiD * kPiD)
          << u << " " << psi;
      // Opaque discs let nothing pass.
      EXPECT_NEAR(disc.intensity(float(u), float(psi), 0).coherent, d * d, 1e-3 * kPiD * kPiD);
      EXPECT_EQ(disc.intensity(float(u), float(psi), 0).uncorrelated, 0);
    }
  // |1 + Fr (t - 1)|^2 remains in the wave.
  for (double psi = 0; psi < 30; psi += 0.7)
    EXPECT_NEAR(disc.undiffracted(float(psi), 0.8f, 0.4f),
                std::norm(1.0 + 0.4 * (0.8 * std::polar(1.0, psi) - 1.0)), 2e-3);
}

TEST(PhaseScatterer, ThinCapsVanish) {
  const PhaseScatterer scatterer(cap(30), {}, 20, 10);
  // Amplitudes at the rim are below 1, so that F does not vanish entirely: t is 0.997 there.
  for (double u = 0; u < 20; u += 0.5) EXPECT_LT(scatterer.intensity(float(u), 0, 1).coherent, 1e-5) << u;
  EXPECT_NEAR(scatterer.undiffracted(0, 1, 0.5f), 1, 1e-3);
  EXPECT_NEAR(scatterer.transmittance(), 1, 2e-3);
}

TEST(PhaseScatterer, IsTheIntegralOverTheCap) {
  // The integral over squares of the plane, with the height of a sphere at each: no Bessel functions, no radius.
  const double angle = 60 * kPiD / 180, index = 1.333;
  const PhaseScatterer scatterer({angle, index}, {}, 30, 30);
  const int n = 900;
  const double radius = 1 / std::sin(angle), top = radius * (1 - std::cos(angle)),
               flat = 4 * index / std::pow(1 + index, 2);
  for (const double u : {0.0, 2.1, 6.4, 15.3})
    for (const double psi : {0.8, 5.2, 18.1}) {
      Complex refracted = 0;
      double passed = 0;
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const double px = 2 * (x + 0.5) / n - 1, py = 2 * (y + 0.5) / n - 1, r2 = px * px + py * py;
          if (r2 >= 1) continue;
          const double height = (std::sqrt(radius * radius - r2) - radius * std::cos(angle)) / top;
          const double sine = std::sqrt(r2) / radius, cosine = std::sqrt(1 - sine * sine);
          if (index * sine >= 1) continue;
          const double out = std::sqrt(1 - index * index * sine * sine);
          // Fresnel's transmittances for both polarisations.
          const double s = 4 * index * cosine * out / std::pow(index * cosine + out, 2),
                       p = 4 * index * cosine * out / std::pow(cosine + index * out, 2),
                       t = 0.5 * (s + p) / flat;
          refracted += std::polar(std::sqrt(t), psi * height - u * px), passed += t;
        }
      refracted *= 4.0 / n / n, passed *= 4.0 / n / n;
      const Complex f = refracted - kPiD * airy(u);
      EXPECT_NEAR(scatterer.intensity(float(u), float(psi), 1).coherent, std::norm(f), 6e-3 * kPiD * kPiD)
          << u << " " << psi;
      EXPECT_NEAR(scatterer.transmittance() * kPiD, passed, 2e-3 * kPiD);
    }
}

TEST(PhaseScatterer, LayersAreSumsOfWaves) {
  // Caps of many sizes on discs in equilibrium: the wave behind the plane is summed over all of them, each with the
  // integral over its own radius, and averaged over arrangements.
  const double fa = 0.35, psi = 7.3, spread = 0.12;
  const SizeDistribution sizes = SizeDistribution::log_normal(spread);
  const PhaseScatterer layer(cap(50), sizes, 16, 12);
  HardDiscSimulation simulation(600, fa, 81);
  simulation.advance(simulation.equilibration_sweeps());
  const double angle = 50 * kPiD / 180, radius = 1 / std::sin(angle), top = radius * (1 - std::cos(angle));
  const auto amplitude = [&](double size, double u) {  // by the midpoint rule over the radius
    Complex sum = 0;
    const int n = 800;
    for (int i = 0; i < n; ++i) {
      const double r = (i + 0.5) / n,
                   height = (std::sqrt(radius * radius - r * r) - radius * std::cos(angle)) / top;
      const double sine = r / radius, cosine = std::sqrt(1 - sine * sine);
      double t = 0;  // beyond the critical angle
      if (1.333 * sine < 1) {
        const double out = std::sqrt(1 - 1.333 * 1.333 * sine * sine);
        const double s = 4 * 1.333 * cosine * out / std::pow(1.333 * cosine + out, 2),
                     p = 4 * 1.333 * cosine * out / std::pow(cosine + 1.333 * out, 2);
        t = std::sqrt(0.5 * (s + p) / (4 * 1.333 / std::pow(2.333, 2)));
      }
      sum += (std::polar(t, psi * size * height) - 1.0) * std::cyl_bessel_j(0, u * size * r) *
             (2 * kPiD * r / n);
    }
    return size * size * sum;
  };
  const SimulatedStructureFactor structure(fa);
  std::mt19937 random(5);
  double worst = 0, largest = 0;
  for (const double target : {0.6, 1.5, 2.6, 3.4, 4.6, 6.3, 8.1}) {
    std::vector<Complex> amplitudes;
    for (const auto& node : sizes.nodes()) amplitudes.push_back(amplitude(node.size, target));
    double mean = 0, predicted = 0;
    int count = 0;
    const auto i = layer.intensity(float(target), float(psi), 1);
    Complex mean_amplitude = 0;
    double squares = 0;
    for (std::size_t k = 0; k < amplitudes.size(); ++k)
      mean_amplitude += sizes.nodes()[k].weight * amplitudes[k],
          squares += sizes.nodes()[k].weight * std::norm(amplitudes[k]);
    EXPECT_NEAR(double(i.coherent), std::norm(mean_amplitude), 0.01 * squares) << target;
    EXPECT_NEAR(double(i.uncorrelated), squares - std::norm(mean_amplitude), 0.01 * squares) << target;
    const int snapshots = test::effort(40, 160);
    for (int s = 0; s < snapshots; ++s) {
      simulation.advance(simulation.decorrelation_sweeps());
      const HardDiscs& discs = simulation.state();
      std::vector<std::size_t> label(discs.x.size());
      for (auto& l : label) {
        double xi = std::uniform_real_distribution<double>()(random);
        while (l + 1 < sizes.nodes().size() && xi >= sizes.nodes()[l].weight) xi -= sizes.nodes()[l++].weight;
      }
      for (int direction = 0; direction < 24; ++direction) {
        const double turn = kPiD * (direction + 0.4) / 24;
        const double qx = 2 * kPiD / discs.box_x *
                          std::round(target * std::cos(turn) * discs.box_x / 2 / kPiD),
                     qy = 2 * kPiD / discs.box_y *
                          std::round(target * std::sin(turn) * discs.box_y / 2 / kPiD);
        Complex wave = 0;
        for (std::size_t k = 0; k < discs.x.size(); ++k)
          wave += amplitudes[label[k]] * std::polar(1.0, -(qx * discs.x[k] + qy * discs.y[k]));
        mean += std::norm(wave) / double(discs.x.size()), ++count;
        predicted += double(i.uncorrelated) + double(i.coherent) * structure.eval(std::hypot(qx, qy));
      }
    }
    mean /= count, predicted /= count;
    std::printf("u %.1f: sum over caps %.4f, model %.4f (%+.1f %%)\n", target, mean, predicted,
                100 * (predicted / mean - 1));
    largest = std::max(largest, mean), worst = std::max(worst, std::abs(predicted - mean) / mean);
  }
  EXPECT_LT(worst, test::effort(0.1, 0.06));
}

TEST(PhaseScatterer, LargeCapsRefractRays) {
  // Far above the wavelength, the power beyond an angle is that of rays, refracted by Snell's law one by one, for
  // light along the axis from the flat side. Steeper slopes are too near to the critical angle: there rays from
  // an eighth of the radius interfere.
  const double angle = 60 * kPiD / 180, index = 1.333, phase = 400;  // k a
  const PhaseProfile profile{angle, index};
  const double height = profile.cap_height();
  const PhaseScatterer scatterer(profile, {}, phase, phase * height * 0.7);
  const double flat = 1 - std::pow((index - 1) / (index + 1), 2);
  double all = 0;
  std::vector<double> rays;
  const std::vector<double> sines{0.05, 0.1, 0.15, 0.2, 0.25};
  for (const double limit : sines) {
    double sum = 0;
    const int n = 20000;
    all = 0;
    for (int i = 0; i < n; ++i) {
      const double r = (i + 0.5) / n, sine = r * std::sin(angle), cosine = std::sqrt(1 - sine * sine);
      if (index * sine >= 1) continue;
      const double out = std::sqrt(1 - index * index * sine * sine),
                   bend = std::asin(index * sine) - std::asin(sine);
      const double s = 4 * index * cosine * out / std::pow(index * cosine + out, 2),
                   p = 4 * index * cosine * out / std::pow(cosine + index * out, 2);
      const double power = 0.5 * (s + p) / flat * 2 * r / n;
      all += power;
      if (std::sin(bend) > limit && std::sin(bend) < 0.3) sum += power;
    }
    rays.push_back(sum);
  }
  EXPECT_NEAR(scatterer.transmittance(), all, 1e-3);
  for (std::size_t k = 0; k < sines.size(); ++k) {
    double sum = 0;
    const int n = 40000;
    for (int i = 0; i < n; ++i) {
      const double p = sines[k] + (0.3 - sines[k]) * (i + 0.5) / n, c = std::sqrt(1 - p * p),
                   difference = index - c, factor = 1 - p * p / (c * difference);
      if (factor <= 0) continue;
      const auto at = scatterer.at(float(phase * p), float(phase * height * difference));
      sum += factor * double(at.squared) * p * (0.3 - sines[k]) / n;
    }
    sum *= phase * phase / (2 * kPiD) / kPiD;
    std::printf("beyond sin %.2f: waves %.4f, rays %.4f\n", sines[k], sum, rays[k]);
    EXPECT_NEAR(sum, rays[k], 0.02 * all + 0.02 * rays[k]) << sines[k];
  }
}

TEST(PhaseScatterer, Errors) {
  EXPECT_THROW(PhaseScatterer(cap(91), {}, 10, 10), std::domain_error);
  EXPECT_THROW(PhaseScatterer(cap(-1), {}, 10, 10), std::domain_error);
  EXPECT_THROW(PhaseScatterer(cap(40, 0.9), {}, 10, 10), std::domain_error);
  EXPECT_THROW(PhaseScatterer(cap(40), {}, 1e4, 1e4), std::domain_error);
  EXPECT_THROW(PhaseScatterer(cap(40), {}, NAN, 10), std::domain_error);
  EXPECT_THROW(PhaseScatterer(cap(40), {}, 10, 0), std::domain_error);
  EXPECT_THROW(PhaseScatterer({}, {}, 10, 1e5), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
