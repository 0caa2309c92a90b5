// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/direction_bins.h"

#include <algorithm>
#include <cmath>

namespace aureole {

namespace {

constexpr double kNodes[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                              0.8611363115940526};
constexpr double kWeights[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                0.3478548451374538};

}  // namespace

// Faces +x, -x, +y, -y, +z, -z. On the side faces, b is z, so that the horizon coincides with edges of bins.
Vec3 DirectionBins::direction(int face, double a, double b) {
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

int DirectionBins::locate(const Vec3& d, double& a, double& b) {
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  if (x >= y && x >= z) return a = d.y / x, b = d.z / x, d.x < 0 ? 1 : 0;
  if (y >= z) return a = d.x / y, b = d.z / y, d.y < 0 ? 3 : 2;
  return a = d.x / z, b = d.y / z, d.z < 0 ? 5 : 4;
}

DirectionBins::DirectionBins(const Function& f, const Options& options)
    : DirectionBins(
          [&](std::span<const Vec3> directions, std::span<Value> values) {
            for (std::size_t i = 0; i < directions.size(); ++i) values[i] = f(directions[i]);
          },
          options) {}

// The quadtree is divided level by level, so that the function is evaluated for many directions at once.
DirectionBins::DirectionBins(const ArrayFunction& f, const Options& options) : nodes_(6) {
  std::vector<Pending> level;
  for (int face = 0; face < 6; ++face) level.push_back({face, {face, -1, -1, 2}, {}, {}});
  for (const Vec3& d : options.pilot) {
    double a, b;
    level[locate(d, a, b)].pilot.push_back(d);
  }
  {
    std::vector<Cell> faces;
    for (const Pending& p : level) faces.push_back(p.cell);
    const std::vector<Integral> integrals = integrate(f, faces);
    for (int face = 0; face < 6; ++face) level[face].integral = integrals[face];
  }

  std::vector<Bin> found;
  std::vector<Cell> quarters;
  for (int depth = 0; !level.empty(); ++depth) {
    quarters.clear();
    for (const Pending& p : level)
      for (int k = 0; k < 4; ++k) {
        const double half = 0.5 * p.cell.size;
        quarters.push_back({p.cell.face, p.cell.a + (k & 1) * half, p.cell.b + (k >> 1) * half, half});
      }
    const std::vector<Integral> integrals = integrate(f, quarters);

    std::vector<Pending> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      Pending& p = level[i];
      Integral better;
      for (int k = 0; k < 4; ++k) {
        better.mass += integrals[4 * i + k].mass;
        for (int j = 0; j < kWavelengths; ++j) better.other[j] += integrals[4 * i + k].other[j];
      }
      double error = std::abs(better.mass - p.integral.mass);
      for (int j = 0; j < kWavelengths; ++j)
        error = std::max(error, std::abs(better.other[j] - p.integral.other[j]));

      const double half = 0.5 * p.cell.size;
      const Vec3 center = direction(p.cell.face, p.cell.a + half, p.cell.b + half);
      const auto focused = [&](const Vec3& d) {
        return half > options.focus_angle && length(d - center) < 2 * p.cell.size;
      };
      const bool divide =
          depth < options.least_depth ||
          (depth < options.greatest_depth && nodes_.size() < options.most_bins &&
           (error > options.tolerance || better.mass > options.largest_mass ||
            double(p.pilot.size()) > options.largest_mass * double(options.pilot.size()) + 8 ||
            std::any_of(options.focus.begin(), options.focus.end(), focused)));
      if (!divide) {
        nodes_[p.node].bin = int(found.size());
        found.push_back({center, better.mass, better.other, p.cell.size});
        continue;
      }
      const int first = int(nodes_.size());
      nodes_[p.node].first_child = first;
      nodes_.resize(nodes_.size() + 4);
      const std::size_t child = next.size();
      for (int k = 0; k < 4; ++k) next.push_back({first + k, quarters[4 * i + k], integrals[4 * i + k], {}});
      for (const Vec3& d : p.pilot) {
        double a, b;
        locate(d, a, b);
        next[child + (a >= p.cell.a + half ? 1 : 0) + (b >= p.cell.b + half ? 2 : 0)].pilot.push_back(d);
      }
      p.pilot = {};
    }
    level = std::move(next);
  }
  bins_.reserve(found.size());
  for (int face = 0; face < 6; ++face) number_bins(face, found);
}

void DirectionBins::number_bins(int node, const std::vector<Bin>& found) {
  Node& n = nodes_[node];
  if (n.bin >= 0) {
    bins_.push_back(found[n.bin]);
    n.bin = int(bins_.size()) - 1;
    return;
  }
  for (int k = 0; k < 4; ++k) number_bins(n.first_child + k, found);
}

std::vector<DirectionBins::Integral> DirectionBins::integrate(const ArrayFunction& f,
                                                              std::span<const Cell> cells) {
  constexpr std::size_t kCellsAtOnce = 1024;
  std::vector<Integral> sums;
  sums.reserve(cells.size());
  std::vector<Vec3> directions;
  std::vector<Value> values;
  for (std::size_t begin = 0; begin < cells.size(); begin += kCellsAtOnce) {
    const auto some = cells.subspan(begin, std::min(kCellsAtOnce, cells.size() - begin));
    directions.clear();
    for (const Cell& c : some)
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          directions.push_back(
              direction(c.face, c.a + 0.5 * c.size * (1 + kNodes[i]), c.b + 0.5 * c.size * (1 + kNodes[j])));
    values.assign(directions.size(), {});
    f(directions, values);
    const Value* v = values.data();
    for (const Cell& c : some) {
      Integral& sum = sums.emplace_back();
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j, ++v) {
          const double a = c.a + 0.5 * c.size * (1 + kNodes[i]), b = c.b + 0.5 * c.size * (1 + kNodes[j]);
          const double square = 1 + a * a + b * b;
          const double w = kWeights[i] * kWeights[j] * 0.25 * c.size * c.size / (square * std::sqrt(square));
          sum.mass += w * v->density;
          for (int k = 0; k < kWavelengths; ++k) sum.other[k] += w * double(v->other[k]);
        }
    }
  }
  return sums;
}

std::size_t DirectionBins::find(const Vec3& d) const {
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

std::vector<double> DirectionBins::masses() const {
  std::vector<double> masses;
  masses.reserve(bins_.size());
  for (const Bin& bin : bins_) masses.push_back(bin.mass);
  return masses;
}

double DirectionBins::mass() const {
  double sum = 0;
  for (const Bin& bin : bins_) sum += bin.mass;
  return sum;
}

std::array<double, kWavelengths> DirectionBins::other() const {
  std::array<double, kWavelengths> sum{};
  for (const Bin& bin : bins_)
    for (int k = 0; k < kWavelengths; ++k) sum[k] += bin.other[k];
  return sum;
}

}  // namespace aureole
