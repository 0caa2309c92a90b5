// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/splats/splat_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/parallel.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

using SplatMatrix = std::array<std::array<double, 3>, 3>;

/// The matrix of a unit quaternion w, x, y, z.
SplatMatrix matrix_of(const std::array<float, 4>& q) {
  const double w = double(q[0]), x = double(q[1]), y = double(q[2]), z = double(q[3]);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

/// Whether a transform keeps right angles: rotations, reflections and equal scales.
bool keeps_angles(const Transform& t) {
  const auto& m = t.matrix();
  double squares[3][3] = {};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) squares[i][j] += m[k][i] * m[k][j];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::abs(squares[i][j] - (i == j ? squares[0][0] : 0)) > 1e-6 * squares[0][0]) return false;
  return true;
}

/// Largest opacity of a splat: opacities closer to 1 would need an infinite extinction.
constexpr double kMaxSplatOpacity = 0.9999;
/// Smallest ratio of a splat's thickness to its longest scale; thinner splats are thickened, since their
/// extinction would be infinite.
constexpr double kThinnest = 0.01;

}  // namespace

SplatField::SplatField(const SplatCloud& cloud, const Transform& to_world, const Options& options)
    : options_(options) {
  splats_.reserve(cloud.size());
  boxes_.reserve(cloud.size());
  const auto& m = to_world.matrix();
  const double cutoff = double(options.cutoff);
  const bool is_rigid = keeps_angles(to_world);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double opacity = std::min(double(cloud.opacities[i]), kMaxSplatOpacity);
    if (!(opacity > 0)) continue;
    const Vec3 s = cloud.scales[i];
    const double longest = double(max_component(s));
    if (!(longest > 0)) {
      ++without_extent_;
      continue;
    }
    bool is_thin = false;
    // Columns are the axes of the ellipsoid in the world: A = M R diag(s).
    const SplatMatrix r = matrix_of(cloud.rotations[i]);
    SplatMatrix a{};
    double lengths[3];
    for (int axis = 0; axis < 3; ++axis) {
      double scale = double(s[axis]);
      if (scale < kThinnest * longest) is_thin = true, scale = kThinnest * longest;
      double squares = 0;
      for (std::size_t row = 0; row < 3; ++row) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += m[row][k] * r[k][std::size_t(axis)];
        a[row][std::size_t(axis)] = sum * scale;
        squares += a[row][std::size_t(axis)] * a[row][std::size_t(axis)];
      }
      lengths[axis] = std::sqrt(squares);
    }
    thickened_ += is_thin;
    Transform::Matrix rows{};
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) rows[row][k] = a[row][k];
    }
    rows[3][3] = 1;
    const auto inverse = Transform(rows).inverse().matrix();
    Splat splat;
    splat.center = to_world.point(cloud.positions[i]);
    for (std::size_t row = 0; row < 3; ++row)
      splat.whiten[row] = {float(inverse[row][0]), float(inverse[row][1]), float(inverse[row][2])};
    const double along = options.along == OpacityAlong::shortest
                             ? std::min({lengths[0], lengths[1], lengths[2]})
                             : std::cbrt(lengths[0] * lengths[1] * lengths[2]);
    // The optical thickness through the centre: peak s sqrt(2 pi) erf(cutoff / sqrt 2).
    splat.peak = float(double(options.extinction_scale) * -std::log1p(-opacity) /
                       (along * std::sqrt(2 * kPiD) * std::erf(cutoff / std::sqrt(2.))));
    const float* h = cloud.harmonics_of(i);
    float rgb[3];
    for (int k = 0; k < 3; ++k) {
      rgb[k] = std::max(0.f, 0.5f + kHarmonic0 * h[k]);
      if (cloud.hints.colors == SplatHints::Colors::srgb) rgb[k] = srgb_decode(rgb[k]);
    }
    splat.color = ColorWeights::of_linear_rgb(rgb[0], rgb[1], rgb[2]);
    Vec3 half;
    for (int row = 0; row < 3; ++row) {
      const auto& x = a[std::size_t(row)];
      half[row] = float(cutoff * std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) * (1 + 1e-6));
    }
    Bounds3 box;
    box.extend(splat.center - half), box.extend(splat.center + half);
    if (!std::isfinite(splat.peak) || !is_finite(box.diagonal())) {
      ++without_extent_;
      continue;
    }
    bounds_.extend(box);
    splats_.push_back(splat), boxes_.push_back(box);
    // The largest singular value of a matrix is at most the root of the sum of all squares.
    longest_.push_back(float(
        is_rigid ? std::max({lengths[0], lengths[1], lengths[2]})
                 : std::sqrt(lengths[0] * lengths[0] + lengths[1] * lengths[1] + lengths[2] * lengths[2])));
  }
  if (splats_.empty()) throw Error("has no splat with an opacity and an extent");
  make_cells();
}

void SplatField::make_cells() {
  // The grid has some 32 cubic cells for each splat: splats of surfaces are thin, and bounds of large cells
  // would be far above the extinction. Fewer where splats are so large that cells would list too many of
  // them.
  const Vec3 size = max(bounds_.diagonal(), Vec3{1, 1, 1} * (1e-6f * max_component(bounds_.diagonal())));
  double wanted = std::clamp(32. * double(splats_.size()), 4096., double(1 << 24));
  constexpr double kMaxEntries = double(1 << 27);
  const auto range = [&](const Bounds3& box, int axis, int& from, int& to) {
    const float scale = per_length_[axis];
    const auto index = [&](float x) {
      return std::clamp(int(std::floor((x - bounds_.lower[axis]) * scale)), 0, cells_[std::size_t(axis)] - 1);
    };
    from = index(box.lower[axis]), to = index(box.upper[axis]);
  };
  for (;;) {
    const double edge = std::cbrt(double(size.x) * double(size.y) * double(size.z) / wanted);
    for (int axis = 0; axis < 3; ++axis) {
      cells_[std::size_t(axis)] = int(std::clamp(std::ceil(double(size[axis]) / edge), 1., 1024.));
      per_length_[axis] = float(cells_[std::size_t(axis)]) / size[axis];
    }
    double entries = 0;
    for (const Bounds3& box : boxes_) {
      double n = 1;
      for (int axis = 0; axis < 3; ++axis) {
        int from, to;
        range(box, axis, from, to);
        n *= double(to - from + 1);
      }
      entries += n;
    }
    if (entries <= kMaxEntries || wanted <= 64) break;
    wanted /= 8;
  }
  const std::size_t nx = std::size_t(cells_[0]), ny = std::size_t(cells_[1]), nz = std::size_t(cells_[2]);
  first_.assign(nx * ny * nz + 1, 0);
  const auto for_cells = [&](std::size_t i, const auto& visit) {
    int from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) range(boxes_[i], axis, from[axis], to[axis]);
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x)
          visit((std::size_t(z) * ny + std::size_t(y)) * nx + std::size_t(x));
  };
  for (std::size_t i = 0; i < splats_.size(); ++i)
    for_cells(i, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  entries_.resize(std::size_t(first_.back()));
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < splats_.size(); ++i)
    for_cells(i, [&](std::size_t cell) { entries_[std::size_t(next[cell]++)] = std::uint32_t(i); });
  std::vector<Bounds3>().swap(boxes_);

  std::vector<float> bounds(first_.size() - 1);
  const Vec3 edge{1 / per_length_.x, 1 / per_length_.y, 1 / per_length_.z};
  for_ranges(
      bounds.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          Bounds3 box;
          box.lower = bounds_.lower + edge * Vec3{float(k % nx), float(k / nx % ny), float(k / nx / ny)};
          box.upper = box.lower + edge;
          double sum = 0;
          for (std::uint64_t e = first_[k]; e < first_[k + 1]; ++e) {
            const Splat& s = splats_[entries_[std::size_t(e)]];
            // The Gaussian falls at least as fast as the sphere of its longest scale. A margin covers the rounding of
            // points to the next cell.
            Bounds3 center;
            center.extend(s.center);
            const double d = std::max(0., std::sqrt(double(squared_distance(box, center))) * 0.999 /
                                                  double(longest_[entries_[std::size_t(e)]]) -
                                              1e-3);
            sum += double(s.peak) * std::exp(-0.5 * d * d);
          }
          bounds[k] = float(sum * (1 + 1e-5));
        }
      },
      256);
  const Transform to_box =
      Transform::scale(double(per_length_.x) / double(nx), double(per_length_.y) / double(ny),
                       double(per_length_.z) / double(nz)) *
      Transform::translate(-double(bounds_.lower.x), -double(bounds_.lower.y), -double(bounds_.lower.z));
  grid_.emplace(to_box, cells_, std::move(bounds));
  std::vector<float>().swap(longest_);
}

std::size_t SplatField::cell_of(const Vec3& p) const {
  std::size_t cell = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const float x = (p[axis] - bounds_.lower[axis]) * per_length_[axis];
    if (!(x >= 0 && x <= float(cells_[std::size_t(axis)]))) return first_.size();
    cell = cell * std::size_t(cells_[std::size_t(axis)]) +
           std::size_t(std::min(int(x), cells_[std::size_t(axis)] - 1));
  }
  return cell;
}

SplatField::Sample SplatField::at(const Vec3& p) const {
  Sample sample;
  const std::size_t cell = cell_of(p);
  if (cell + 1 >= first_.size()) return sample;
  const float limit = options_.cutoff * options_.cutoff;
  for (std::uint64_t e = first_[cell]; e < first_[cell + 1]; ++e) {
    const Splat& s = splats_[entries_[std::size_t(e)]];
    const float d2 = length_squared(s.whitened(p - s.center));
    if (!(d2 <= limit)) continue;
    const float extinction = s.peak * std::exp(-0.5f * d2);
    sample.extinction += extinction;
    sample.color.white += extinction * s.color.white, sample.color.red += extinction * s.color.red;
    sample.color.green += extinction * s.color.green, sample.color.blue += extinction * s.color.blue;
  }
  return sample;
}

double SplatField::optical_thickness(const Ray& ray, float t_max) const {
  double sum = 0;
  MajorantGrid::Walk walk(*grid_, ray, t_max);
  MajorantGrid::Piece piece;
  while (walk.next(piece)) {
    const std::size_t cell = cell_of(ray.o + ray.d * (0.5f * (piece.begin + piece.end)));
    if (cell + 1 >= first_.size()) continue;
    for (std::uint64_t e = first_[cell]; e < first_[cell + 1]; ++e) {
      const Splat& s = splats_[entries_[std::size_t(e)]];
      const Vec3 a = s.whitened(ray.o - s.center), b = s.whitened(ray.d);
      const double bb = double(dot(b, b)), middle = -double(dot(a, b)) / bb;
      const Vec3 nearest = a + b * float(middle);
      const double d2 = double(length_squared(nearest)),
                   left = double(options_.cutoff) * double(options_.cutoff) - d2;
      if (!(left > 0)) continue;
      const double half = std::sqrt(left / bb), from = std::max(double(piece.begin), middle - half),
                   to = std::min(double(piece.end), middle + half);
      if (!(to > from)) continue;
      const double root = std::sqrt(bb / 2);
      sum += double(s.peak) * std::exp(-0.5 * d2) * std::sqrt(kPiD / (2 * bb)) *
             (std::erf(root * (to - middle)) - std::erf(root * (from - middle)));
    }
  }
  return sum;
}

}  // namespace aureole
