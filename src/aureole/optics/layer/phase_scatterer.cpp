// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/phase_scatterer.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/bessel.h"
#include "aureole/optics/constants.h"
#include "aureole/optics/gauss_legendre.h"
#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {
namespace {

/// Points along the radius with the weights of the integral over the unit disc, the amplitude t included.
struct Points {
  std::vector<double> radius, height, weight;
  double power = 0;  ///< integral of t^2 over the disc
};

Points points(const PhaseProfile& profile, int count) {
  Points p;
  const bool flat = profile.contact_angle == 0;
  // Points of a cap are uniform in the angle of the slope, up to the critical angle, beyond which no light is
  // transmitted.
  const double sine = flat ? 1 : std::sin(profile.contact_angle),
               last =
                   flat ? 0.5 * kPi : std::min(profile.contact_angle, std::asin(1 / profile.relative_index));
  const double flat_reflectance = fresnel_reflectance(1, profile.relative_index, 1);
  const Quadrature q = gauss_legendre(count, 0, last);
  for (int i = 0; i < count; ++i) {
    const double angle = q.x[std::size_t(i)], r = std::sin(angle) / sine;
    double amplitude = 1, height = 1;
    if (!flat) {
      height = (std::cos(angle) - std::cos(profile.contact_angle)) / (1 - std::cos(profile.contact_angle));
      amplitude = std::sqrt((1 - fresnel_reflectance(std::cos(angle), profile.relative_index, 1)) /
                            (1 - flat_reflectance));
    }
    p.radius.push_back(r), p.height.push_back(height);
    p.weight.push_back(amplitude * 2 * kPi * r * std::cos(angle) / sine * q.weight[std::size_t(i)]);
    p.power += amplitude * p.weight.back();
  }
  return p;
}

}  // namespace

PhaseScatterer::Cubic::Cubic(float position, int nodes) {
  const float x = std::clamp(position, 0.f, float(nodes - 1));
  first = std::clamp(int(x) - 1, 0, nodes - 4);
  const float t = x - float(first + 1), a = t + 1, b = t - 1, c = t - 2;
  weights = {-t * b * c / 6, a * b * c / 2, -a * t * c / 2, a * t * b / 6};
}

double PhaseProfile::cap_height() const { return std::tan(0.5 * contact_angle); }

PhaseScatterer::PhaseScatterer(const PhaseProfile& profile, const SizeDistribution& sizes, double largest_u,
                               double largest_psi, const ParallelFor& parallel_for) {
  if (!(profile.contact_angle >= 0 && profile.contact_angle <= 0.5 * kPi + 1e-9))
    throw std::domain_error("a contact angle must be in (0, 90] degrees, got " +
                            std::to_string(profile.contact_angle * 180 / kPi));
  if (profile.contact_angle > 0 && !(profile.relative_index > 1 && profile.relative_index < 10))
    throw std::domain_error("the index of a cap over that outside it must be above 1 and below 10, got " +
                            std::to_string(profile.relative_index));
  const double rows = std::ceil(largest_u / kStepU) + 3, columns = std::ceil(largest_psi / kStepPsi) + 3;
  if (!(largest_u > 0 && largest_psi > 0)) throw std::domain_error("waves and phases must be positive");
  if (!(largest_psi <= kMaxPhase))
    throw std::domain_error("the scatterers retard light by up to " + std::to_string(largest_psi) +
                            " rad, more than " + std::to_string(int(kMaxPhase)));
  if (const double bytes = rows * columns * 16; !(bytes <= double(kMaxBytes)))
    throw std::domain_error("the table of the scatterers would take " +
                            std::to_string(std::lround(std::min(bytes / 1048576, 1e9))) + " MiB, more than " +
                            std::to_string(kMaxBytes >> 20));
  rows_ = int(rows), columns_ = int(columns);
  mean_square_ = sizes.moment(2);
  const double end_u = (rows_ - 1) * kStepU, end_psi = (columns_ - 1) * kStepPsi;

  transmittance_ = points(profile, 64).power / kPi;
  uniform_ = sizes.is_single();

  table_.assign(std::size_t(rows_) * std::size_t(columns_) * 4, 0.f);
  base_.assign(std::size_t(rows_) * 2, 0.f);
  std::vector<std::vector<double>> sums(static_cast<std::size_t>(rows_));
  for (auto& row : sums) row.assign(std::size_t(columns_) * 4 + 2, 0.0);
  for (const auto& [size, share] : sizes.nodes()) {
    // Gauss's rule is exact as soon as its points outnumber half of the largest phase by a few.
    const int count = 48 + int(0.6 * size * (end_u + end_psi));
    const Points p = points(profile, count);
    // exp(i psi h) at the nodes of psi, real and imaginary parts of all points in rows.
    std::vector<double> cosines(std::size_t(columns_) * std::size_t(count)), sines(cosines.size());
    for (int j = 0; j < columns_; ++j)
      for (int i = 0; i < count; ++i) {
        const double phase = size * j * kStepPsi * p.height[std::size_t(i)];
        cosines[std::size_t(j) * std::size_t(count) + std::size_t(i)] = std::cos(phase);
        sines[std::size_t(j) * std::size_t(count) + std::size_t(i)] = std::sin(phase);
      }
    parallel_for(
        std::size_t(rows_),
        [&](std::size_t begin, std::size_t end) {
          std::vector<double> ring(static_cast<std::size_t>(count));
          for (std::size_t row = begin; row < end; ++row) {
            const double u = size * double(row) * kStepU, square = size * size;
            for (int i = 0; i < count; ++i)
              ring[std::size_t(i)] = p.weight[std::size_t(i)] * bessel_j0(u * p.radius[std::size_t(i)]);
            const double d = square * kPi * circle_transform(u);
            double* out = sums[row].data();
            out[std::size_t(columns_) * 4] += share * d * d, out[std::size_t(columns_) * 4 + 1] += share * d;
            for (int j = 0; j < columns_; ++j) {
              const double *c = &cosines[std::size_t(j) * std::size_t(count)],
                           *s = &sines[std::size_t(j) * std::size_t(count)];
              double real = 0, imaginary = 0;
              for (int i = 0; i < count; ++i)
                real += ring[std::size_t(i)] * c[i], imaginary += ring[std::size_t(i)] * s[i];
              real *= square, imaginary *= square;
              double* cell = out + std::size_t(j) * 4;
              cell[0] += share * (real * real + imaginary * imaginary), cell[1] += share * real * d;
              cell[2] += share * real, cell[3] += share * imaginary;
            }
          }
        },
        1);
  }
  for (std::size_t row = 0; row < sums.size(); ++row) {
    for (std::size_t k = 0; k < std::size_t(columns_) * 4; ++k)
      table_[row * std::size_t(columns_) * 4 + k] = float(sums[row][k]);
    base_[2 * row] = float(sums[row][std::size_t(columns_) * 4]);
    base_[2 * row + 1] = float(sums[row][std::size_t(columns_) * 4 + 1]);
  }
}

PhaseScatterer::Means PhaseScatterer::at(float u, float psi) const {
  return means({u / float(kStepU), rows_}, psi);
}

PhaseScatterer::Means PhaseScatterer::means(const Cubic& u, float psi) const {
  const Cubic p(psi / float(kStepPsi), columns_);
  float sum[4] = {};
  for (int i = 0; i < 4; ++i) {
    const float* cell =
        &table_[(std::size_t(u.first + i) * std::size_t(columns_) + std::size_t(p.first)) * 4];
    float line[4] = {};
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) line[k] += p.weights[std::size_t(j)] * cell[4 * j + k];
    for (int k = 0; k < 4; ++k) sum[k] += u.weights[std::size_t(i)] * line[k];
  }
  return {sum[0], sum[1], sum[2], sum[3]};
}

PhaseScatterer::Intensity PhaseScatterer::intensity(float u, float psi, float amplitude) const {
  const Cubic along_u(u / float(kStepU), rows_);
  const Means m = means(along_u, psi);
  float square = 0, base = 0;
  for (int i = 0; i < 4; ++i)
    square += along_u.weights[std::size_t(i)] * base_[2 * std::size_t(along_u.first + i)],
        base += along_u.weights[std::size_t(i)] * base_[2 * std::size_t(along_u.first + i) + 1];
  const float real = amplitude * m.real - base, imaginary = amplitude * m.imaginary;
  const float coherent = real * real + imaginary * imaginary;
  if (uniform_) return {0, coherent};
  const float all = amplitude * amplitude * m.squared - 2 * amplitude * m.cross + square;
  return {std::max(all - coherent, 0.f), coherent};
}

float PhaseScatterer::undiffracted(float psi, float amplitude, float covered) const {
  const Means m = at(0, psi);
  const float density = covered / float(kPi * mean_square_);
  const float real = 1 - covered + density * amplitude * m.real,
              imaginary = density * amplitude * m.imaginary;
  return real * real + imaginary * imaginary;
}

}  // namespace aureole::optics
