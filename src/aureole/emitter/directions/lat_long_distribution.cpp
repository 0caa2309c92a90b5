// SPDX-License-Identifier: Apache-2.0
#include "aureole/emitter/directions/lat_long_distribution.h"

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "aureole/math/warp.h"

namespace aureole {

namespace {

/// A cell's mass against the clamped cosine is estimated as mass (m + sqrt(m^2 + kSpread s^2)) / 2, where m
/// and s^2 are the mean and variance of the cosine. For kSpread = 1 this is the least upper bound for these
/// moments (Scarf 1958, "A min-max solution of an inventory problem"). With 3/4 it is exact for cosines that
/// are uniform about the horizon, and never below 3/4 of the true value, so that no cell is undersampled
/// much.
constexpr double kSpread = 0.75;
/// Variance that is added to keep the sum positive in every direction; larger than the rounding error.
constexpr double kMinVariance = 1e-6;

/// The first and the last level split a cell into two rows of four columns; the second one splits it into two
/// columns of four rows.
constexpr int kLevels = 3;

/// The child that contains a block on each level, and the node of that child.
struct Path {
  int child[kLevels];
  std::size_t node[kLevels];
  std::size_t block;
};
Path path_to(int column, int row) {
  Path p;
  p.child[0] = (row >> 3) * 4 + (column >> 3);
  p.child[1] = ((column >> 2) & 1) * 4 + ((row >> 1) & 3);
  p.child[2] = (row & 1) * 4 + (column & 3);
  p.node[0] = 0;
  p.node[1] = std::size_t(1 + p.child[0]);
  p.node[2] = std::size_t(1 + 8 + p.child[0] * 8 + p.child[1]);
  p.block = std::size_t((p.child[0] * 8 + p.child[1]) * 8 + p.child[2]);
  return p;
}

/// Fills the CDF of n values, of which at least one is positive. Positive values too small for float are
/// raised, so that each keeps a positive probability.
template <class Weight>
void accumulate(int n, float* cdf, Weight&& weight) {
  double sum = 0, total = 0, below = 0;
  for (int i = 0; i < n; ++i) sum += weight(i);
  const auto raised = [&](int i) { return weight(i) > 0 ? std::max(double(weight(i)), 0x1p-21 * sum) : 0.0; };
  for (int i = 0; i < n; ++i) total += raised(i);
  for (int i = 0; i < n; ++i) {
    below += raised(i);
    cdf[i] = std::min(float(below / total), 1.f);
  }
  // Rounding must not give trailing cells of weight 0 a probability: the CDF reaches exactly 1 at the last
  // cell with a positive weight.
  for (int i = n - 1; i >= 0; --i) {
    cdf[i] = 1;
    if (weight(i) > 0) break;
  }
}

using Octet = float __attribute__((vector_size(32)));
const float* values(const Octet& a) { return reinterpret_cast<const float*>(&a); }

/// Exclusive prefix sums of each half of four.
Octet sums_before(Octet e) {
  const auto shifted = []<int bytes>(Octet v) {
    return Octet(_mm256_castsi256_ps(_mm256_slli_si256(_mm256_castps_si256(__m256(v)), bytes)));
  };
  e = shifted.operator()<4>(e);
  e += shifted.operator()<4>(e);
  return e + shifted.operator()<8>(e);
}

/// Returns the index of the first CDF entry above u. Rescales u to [0, 1) within that entry and multiplies
/// `pdf` by its density.
int invert(const float* cdf, int n, float& u, float& pdf) {
  int i = 0, left = n;
  while (left > 4 * 8) {
    const int half = left / 2;
    i += half & -int(cdf[i + half - 1] <= u);  // branch-free, because the outcome is unpredictable
    left -= half;
  }
  // Counts the remaining entries, eight at once; entries after the last are above any u.
  const Octet target = u - Octet{};
  const float* from = cdf + i;
  for (int k = 0; k < left; k += 8) {
    Octet c;
    std::memcpy(&c, from + k, sizeof c);
    const unsigned low = unsigned(_mm256_movemask_ps(__m256(Octet(c <= target))));
    i += std::popcount(low & ((1u << std::min(8, left - 1 - k)) - 1));
  }
  const float below = i > 0 ? cdf[i - 1] : 0.f, share = cdf[i] - below;
  pdf *= share * float(n);
  u = std::min((u - below) / share, kOneMinusEpsilon);
  return i;
}

float density(const float* cdf, int n, int i) { return (cdf[i] - (i > 0 ? cdf[i - 1] : 0.f)) * float(n); }

/// Means of sine, cosine, sine^2 and sine x cosine over [a, b].
struct Trigonometric {
  double s, c, ss, sc;
  Trigonometric(double a, double b)
      : s((std::cos(a) - std::cos(b)) / (b - a)),
        c((std::sin(b) - std::sin(a)) / (b - a)),
        ss(0.5 - (std::sin(2 * b) - std::sin(2 * a)) / (4 * (b - a))),
        sc((std::sin(b) * std::sin(b) - std::sin(a) * std::sin(a)) / (2 * (b - a))) {}
};

}  // namespace

/// A receiver's normal and the products of its components, for quadratic forms.
struct LatLongDistribution::Receiver {
  Vec3 n;
  float products[kCovariances];
  bool all_sides;

  explicit Receiver(const Vec3& facing)
      : n(facing),
        products{n.x * n.x, n.y * n.y, n.z * n.z, 2 * n.x * n.y, 2 * n.y * n.z, 2 * n.x * n.z},
        all_sides(facing == Vec3{}) {}

  /// Estimated masses of the eight children, times a common factor.
  Octet estimates(const Node& node) const {
    if (all_sides) return node.mass;
    const Octet m = node.mean[0] * n.x + node.mean[1] * n.y + node.mean[2] * n.z;
    const Octet a = node.covariance[0] * products[0] + node.covariance[1] * products[1],
                b = node.covariance[2] * products[2] + node.covariance[3] * products[3],
                c = node.covariance[4] * products[4] + node.covariance[5] * products[5];
    const Octet zero{}, s = a + b + c, square = m * m + s;
    Octet root;
    for (int i = 0; i < 8; ++i) root[i] = std::sqrt(square[i]);
    // Computes m + root, without cancellation if m < 0.
    const Octet above = root + (m < zero ? -m : m);
    return node.mass * (m < zero ? s / above : above);
  }
};

Vec2 LatLongDistribution::sample(const Vec3& facing, Vec2 u, float* pdf) const {
  const Receiver receiver(facing);
  int column = 0, row = 0;
  float p = 1;
  // Chooses a child of a node, by table rather than by unpredictable branches. u < 1 keeps x below the sums,
  // so that no child of mass 0 is chosen.
  const auto choose = [&](const Node& node, float& major, float& minor, int& of_major, int& of_minor) {
    const Octet estimates = receiver.estimates(node), before = sums_before(estimates);
    const float *e = values(estimates), *begin = values(before);
    const float half0 = begin[3] + e[3], half1 = begin[7] + e[7], total = half0 + half1;
    const float x = major * total;
    const int second = x >= half0, first_child = 4 * second;
    const float half = second ? half1 : half0;
    major = std::min((x - (second ? half0 : 0.f)) / half, kOneMinusEpsilon);
    const float y = minor * half;
    begin += first_child;
    const int k = int(y >= begin[1]) + int(y >= begin[2]) + int(y >= begin[3]), child = first_child + k;
    minor = std::min((y - begin[k]) / e[child], kOneMinusEpsilon);
    p *= e[child] / total;
    of_major = 2 * of_major + second, of_minor = 4 * of_minor + k;
    return std::size_t(child);
  };
  const std::size_t a = choose(nodes_[0], u.y, u.x, row, column),
                    b = choose(nodes_[1 + a], u.x, u.y, column, row),
                    c = choose(nodes_[9 + 8 * a + b], u.y, u.x, row, column);
  const float* cdf = &cdf_[(64 * a + 8 * b + c) * std::size_t(block_height_ * (1 + block_width_))];
  const int y = invert(cdf, block_height_, u.y, p);
  const int x = invert(cdf + block_height_ + y * block_width_, block_width_, u.x, p);
  *pdf = p * (kBlockColumns * kBlockRows);
  const float within_x = (float(x) + u.x) / float(block_width_),
              within_y = (float(y) + u.y) / float(block_height_);
  return {std::min((float(column) + within_x) * (1.f / kBlockColumns), kOneMinusEpsilon),
          std::min((float(row) + within_y) * (1.f / kBlockRows), kOneMinusEpsilon)};
}

float LatLongDistribution::pdf(const Vec3& facing, Vec2 uv) const {
  // NaN becomes 0.
  const float x = std::min(std::max(0.f, uv.x), kOneMinusEpsilon) * kBlockColumns,
              y = std::min(std::max(0.f, uv.y), kOneMinusEpsilon) * kBlockRows;
  const int column = int(x), row = int(y);
  const Path path = path_to(column, row);
  const Receiver receiver(facing);
  float p = 1;
  for (int level = 0; level < kLevels; ++level) {
    const Octet estimates = receiver.estimates(nodes_[path.node[level]]);
    const float* e = values(estimates);
    const float part = e[path.child[level]];
    if (!(part > 0)) return 0;
    p *= part / (((e[0] + e[1]) + (e[2] + e[3])) + ((e[4] + e[5]) + (e[6] + e[7])));
  }
  const int i = std::min(int((x - float(column)) * float(block_width_)), block_width_ - 1),
            j = std::min(int((y - float(row)) * float(block_height_)), block_height_ - 1);
  const float* cdf = &cdf_[path.block * std::size_t(block_height_ * (1 + block_width_))];
  return p * (kBlockColumns * kBlockRows) * density(cdf, block_height_, j) *
         density(cdf + block_height_ + j * block_width_, block_width_, i);
}

/// Sums over a region of the map: of the weights, and of weights times directions and their products.
struct LatLongDistribution::Moments {
  double mass = 0, d[3] = {}, dd[kCovariances] = {};

  Moments& operator+=(const Moments& b) {
    mass += b.mass;
    for (int i = 0; i < 3; ++i) d[i] += b.d[i];
    for (int i = 0; i < kCovariances; ++i) dd[i] += b.dd[i];
    return *this;
  }

  void store(Node& node, int part, double total, const Frame& frame) const {
    if (!(mass > 0)) return;
    node.mass[part] = float(mass / total);
    const double mean[3] = {d[0] / mass, d[1] / mass, d[2] / mass};
    double local[3][3];
    constexpr int kIndex[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        local[i][j] = kSpread * (dd[kIndex[i][j]] / mass - mean[i] * mean[j]) + kMinVariance * (i == j);
    const Vec3 axes[3] = {frame.to_world({1, 0, 0}), frame.to_world({0, 1, 0}), frame.to_world({0, 0, 1})};
    for (int a = 0; a < 3; ++a) {
      double rotated = 0;
      for (int i = 0; i < 3; ++i) rotated += mean[i] * double(axes[i][a]);
      node.mean[a][part] = float(rotated);
      for (int b = a; b < 3; ++b) {
        double sum = 0;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) sum += local[i][j] * double(axes[i][a]) * double(axes[j][b]);
        node.covariance[kIndex[a][b]][part] = float(sum);
      }
    }
  }
};

LatLongDistribution::LatLongDistribution(std::span<const float> weights, int columns, int rows,
                                         const Frame& frame)
    : block_width_(columns / kBlockColumns), block_height_(rows / kBlockRows) {
  std::vector<float> uniform;
  if (!std::any_of(weights.begin(), weights.end(), [](float w) { return w > 0; })) {
    uniform.assign(weights.size(), 1.f);
    weights = uniform;
  }
  build_nodes(weights, frame);
  build_blocks(weights);
}

void LatLongDistribution::build_nodes(std::span<const float> weights, const Frame& frame) {
  const int columns = block_width_ * kBlockColumns, rows = block_height_ * kBlockRows;
  std::vector<Trigonometric> azimuth;
  for (int x = 0; x < columns; ++x)
    azimuth.emplace_back(2 * M_PI * x / columns, 2 * M_PI * (x + 1) / columns);
  // The children of all nodes: eight for each.
  std::vector<Moments> parts(8 * (1 + 8 + 64));
  for (int y = 0; y < rows; ++y) {
    const Trigonometric t(M_PI * y / rows, M_PI * (y + 1) / rows);
    for (int block = 0; block < kBlockColumns; ++block) {
      double mass = 0, s = 0, c = 0, ss = 0, sc = 0;
      for (int x = block * block_width_; x < (block + 1) * block_width_; ++x) {
        const Trigonometric& a = azimuth[std::size_t(x)];
        const double w = weights[std::size_t(y) * std::size_t(columns) + std::size_t(x)];
        mass += w, s += w * a.s, c += w * a.c, ss += w * a.ss, sc += w * a.sc;
      }
      // The direction is (sin t sin a, cos t, -sin t cos a).
      const Moments m{mass,
                      {t.s * s, t.c * mass, -t.s * c},
                      {t.ss * ss, (1 - t.ss) * mass, t.ss * (mass - ss), t.sc * s, -t.sc * c, -t.ss * sc}};
      const Path path = path_to(block, y / block_height_);
      for (int level = 0; level < kLevels; ++level)
        parts[8 * path.node[level] + std::size_t(path.child[level])] += m;
    }
  }
  double total = 0;
  for (int i = 0; i < 8; ++i) total += parts[std::size_t(i)].mass;
  nodes_.assign(parts.size() / 8, Node{});
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].store(nodes_[i / 8], int(i % 8), total, frame);
}

void LatLongDistribution::build_blocks(std::span<const float> weights) {
  const std::size_t columns = std::size_t(block_width_) * kBlockColumns;
  const std::size_t size = std::size_t(block_height_ * (1 + block_width_));
  // padding, since the last search reads beyond its entries
  cdf_.resize(size * kBlockColumns * kBlockRows + 8);
  std::vector<double> sums(std::size_t(block_height_), 0.0);
  for (int row = 0; row < kBlockRows; ++row)
    for (int column = 0; column < kBlockColumns; ++column) {
      float* cdf = &cdf_[path_to(column, row).block * size];
      const float* block =
          &weights[std::size_t(row * block_height_) * columns + std::size_t(column * block_width_)];
      for (int y = 0; y < block_height_; ++y) {
        const float* cells = block + std::size_t(y) * columns;
        sums[std::size_t(y)] = 0;
        for (int x = 0; x < block_width_; ++x) sums[std::size_t(y)] += cells[x];
        if (sums[std::size_t(y)] > 0)
          accumulate(block_width_, cdf + block_height_ + y * block_width_,
                     [&](int x) { return double(cells[x]); });
      }
      if (std::any_of(sums.begin(), sums.end(), [](double s) { return s > 0; }))
        accumulate(block_height_, cdf, [&](int y) { return sums[std::size_t(y)]; });
    }
}

}  // namespace aureole
