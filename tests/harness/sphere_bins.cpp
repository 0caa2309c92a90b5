// SPDX-License-Identifier: Apache-2.0
#include "harness/sphere_bins.h"

#include <algorithm>
#include <cmath>

namespace aureole::testing {

namespace {

constexpr double kNodes[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                              0.8611363115940526};
constexpr double kWeights[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                0.3478548451374538};

}  // namespace

// Faces +x, -x, +y, -y, +z, -z. On the side faces b is z, so that the horizon falls on edges of bins.
Vec3 SphereBins::direction(int face, double a, double b) {
  const double s = face % 2 ? -1 : 1;
  const double n = 1 / std::sqrt(1 + a * a + b * b);
  const auto v = [&](double x, double y, double z) { return Vec3{float(x * n), float(y * n), float(z * n)}; };
  switch (face / 2) {
    case 0:
      return v(s, a, b);
    case 1:
      return v(a, s, b);
    default:
      return v(a, b, s);
  }
}

int SphereBins::locate(const Vec3& d, double& a, double& b) {
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  if (x >= y && x >= z) return a = d.y / x, b = d.z / x, d.x < 0 ? 1 : 0;
  if (y >= z) return a = d.x / y, b = d.z / y, d.y < 0 ? 3 : 2;
  return a = d.x / z, b = d.y / z, d.z < 0 ? 5 : 4;
}

SphereBins::SphereBins(const Function& f, const Options& options) : f_(&f), options_(&options), nodes_(6) {
  std::array<std::vector<Vec3>, 6> pilots;
  for (const Vec3& d : options.pilot) {
    double a, b;
    pilots[locate(d, a, b)].push_back(d);
  }
  for (int face = 0; face < 6; ++face) {
    const Cell cell{face, -1, -1, 2};
    refine(face, cell, integrate(cell), 0, std::move(pilots[face]));
  }
}

SphereBins::Integral SphereBins::integrate(const Cell& c) const {
  Integral sum;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double a = c.a + 0.5 * c.size * (1 + kNodes[i]), b = c.b + 0.5 * c.size * (1 + kNodes[j]);
      const double w = kWeights[i] * kWeights[j] * 0.25 * c.size * c.size * std::pow(1 + a * a + b * b, -1.5);
      const Value v = (*f_)(direction(c.face, a, b));
      sum.mass += w * v.density;
      for (int k = 0; k < kWavelengths; ++k) sum.other[k] += w * double(v.other[k]);
    }
  return sum;
}

void SphereBins::refine(int node, const Cell& cell, const Integral& integral, int depth,
                        std::vector<Vec3> pilot) {
  const double half = 0.5 * cell.size;
  std::array<Cell, 4> quarters;
  std::array<Integral, 4> integrals;
  Integral better;
  for (int k = 0; k < 4; ++k) {
    quarters[k] = {cell.face, cell.a + (k & 1) * half, cell.b + (k >> 1) * half, half};
    integrals[k] = integrate(quarters[k]);
    better.mass += integrals[k].mass;
    for (int j = 0; j < kWavelengths; ++j) better.other[j] += integrals[k].other[j];
  }
  double error = std::abs(better.mass - integral.mass);
  for (int j = 0; j < kWavelengths; ++j)
    error = std::max(error, std::abs(better.other[j] - integral.other[j]));

  const Vec3 center = direction(cell.face, cell.a + half, cell.b + half);
  const auto focused = [&](const Vec3& f) {
    return half > options_->focus_angle && length(f - center) < 2 * cell.size;
  };
  const bool divide = depth < options_->least_depth ||
                      (depth < options_->greatest_depth &&
                       (error > options_->tolerance || better.mass > options_->largest_mass ||
                        double(pilot.size()) > options_->largest_mass * double(options_->pilot.size()) + 8 ||
                        std::any_of(options_->focus.begin(), options_->focus.end(), focused)));
  if (!divide) {
    nodes_[node].bin = int(bins_.size());
    bins_.push_back({center, better.mass, better.other, cell.size});
    return;
  }
  const int first = int(nodes_.size());
  nodes_[node].first_child = first;
  nodes_.resize(nodes_.size() + 4);
  std::array<std::vector<Vec3>, 4> parts;
  for (const Vec3& d : pilot) {
    double a, b;
    locate(d, a, b);
    parts[(a >= cell.a + half ? 1 : 0) + (b >= cell.b + half ? 2 : 0)].push_back(d);
  }
  pilot = {};
  for (int k = 0; k < 4; ++k) refine(first + k, quarters[k], integrals[k], depth + 1, std::move(parts[k]));
}

std::size_t SphereBins::find(const Vec3& d) const {
  double a, b;
  int node = locate(d, a, b);
  double a0 = -1, b0 = -1, half = 1;
  while (nodes_[node].bin < 0) {
    const int i = a >= a0 + half, j = b >= b0 + half;
    a0 += i * half, b0 += j * half, half *= 0.5;
    node = nodes_[node].first_child + i + 2 * j;
  }
  return std::size_t(nodes_[node].bin);
}

double SphereBins::mass() const {
  double sum = 0;
  for (const Bin& bin : bins_) sum += bin.mass;
  return sum;
}

std::array<double, kWavelengths> SphereBins::other() const {
  std::array<double, kWavelengths> sum{};
  for (const Bin& bin : bins_)
    for (int k = 0; k < kWavelengths; ++k) sum[k] += bin.other[k];
  return sum;
}

}  // namespace aureole::testing
