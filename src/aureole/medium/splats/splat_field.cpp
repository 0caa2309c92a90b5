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
    : cloud_(cloud), turn_(to_world.orthogonal_part().inverse()), options_(options) {
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
    splat.index = std::uint32_t(i);
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
  cells_ = SplatCells(boxes_);
  std::vector<Bounds3>().swap(boxes_);
  std::vector<float> bounds(cells_.count());
  for_ranges(
      bounds.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const Bounds3 box = cells_.box(k);
          double sum = 0;
          for (const std::uint32_t index : cells_.entries(k)) {
            const Splat& s = splats_[index];
            // The Gaussian falls at least as fast as the sphere of its longest scale. A margin covers the rounding of
            // points to the next cell.
            Bounds3 center;
            center.extend(s.center);
            const double d = std::max(
                0.,
                std::sqrt(double(squared_distance(box, center))) * 0.999 / double(longest_[index]) - 1e-3);
            sum += double(s.peak) * std::exp(-0.5 * d * d);
          }
          bounds[k] = float(sum * (1 + 1e-5));
        }
      },
      256);
  grid_.emplace(cells_.to_box(), cells_.size(), std::move(bounds));
  std::vector<float>().swap(longest_);
}

template <class ColorOf>
SplatField::Sample SplatField::sum_at(const Vec3& p, const ColorOf& color_of) const {
  Sample sample;
  const std::size_t cell = cells_.cell_of(p);
  if (cell >= cells_.count()) return sample;
  const float limit = options_.cutoff * options_.cutoff;
  for (const std::uint32_t index : cells_.entries(cell)) {
    const Splat& s = splats_[index];
    const float d2 = length_squared(s.whitened(p - s.center));
    if (!(d2 <= limit)) continue;
    const float extinction = s.peak * std::exp(-0.5f * d2);
    const ColorWeights color = color_of(s);
    sample.extinction += extinction;
    sample.color.white += extinction * color.white, sample.color.red += extinction * color.red;
    sample.color.green += extinction * color.green, sample.color.blue += extinction * color.blue;
  }
  return sample;
}

SplatField::Sample SplatField::at(const Vec3& p) const {
  return sum_at(p, [](const Splat& s) { return s.color; });
}

SplatField::Sample SplatField::seen_along(const Vec3& p, const Vec3& d) const {
  float functions[16];
  eval_harmonics(cloud_.degree, normalize(turn_.vector(d)), functions);
  return sum_at(p, [&](const Splat& s) {
    const Vec3 c = harmonic_color(cloud_.harmonics_of(s.index), functions, cloud_.coefficients());
    float rgb[3];
    for (int k = 0; k < 3; ++k) {
      rgb[k] = std::max(0.f, c[k]);
      if (cloud_.hints.colors == SplatHints::Colors::srgb) rgb[k] = srgb_decode(rgb[k]);
    }
    return ColorWeights::of_linear_rgb(rgb[0], rgb[1], rgb[2]);
  });
}

double SplatField::SplatOnRay::up_to(double t) const {
  return t > from ? scale * (std::erf(root * (std::min(t, to) - middle)) - low) : 0;
}

template <class Visit>
void SplatField::for_splats(const Ray& ray, const MajorantGrid::Piece& piece, const Visit& visit) const {
  const std::size_t cell = cells_.cell_of(ray.o + ray.d * (0.5f * (piece.begin + piece.end)));
  if (cell >= cells_.count()) return;
  for (const std::uint32_t index : cells_.entries(cell)) {
    const Splat& s = splats_[index];
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
    visit(SplatOnRay{double(s.peak) * std::exp(-0.5 * d2) * std::sqrt(kPiD / (2 * bb)), root, middle, from,
                     to, std::erf(root * (from - middle))});
  }
}

double SplatField::optical_thickness(const Ray& ray, float t_max) const {
  double sum = 0;
  MajorantGrid::Walk walk(*grid_, ray, t_max);
  MajorantGrid::Piece piece;
  while (walk.next(piece)) for_splats(ray, piece, [&](const SplatOnRay& s) { sum += s.up_to(s.to); });
  return sum;
}

float SplatField::distance_of_thickness(const Ray& ray, float t_max, double wanted) const {
  double sum = 0;
  MajorantGrid::Walk walk(*grid_, ray, t_max);
  MajorantGrid::Piece piece;
  while (walk.next(piece)) {
    double within = 0;
    for_splats(ray, piece, [&](const SplatOnRay& s) { within += s.up_to(s.to); });
    if (!(sum + within > wanted)) {
      sum += within;
      continue;
    }
    // Bisection: the thickness does not fall along the ray.
    double low = double(piece.begin), high = double(piece.end);
    for (int i = 0; i < 60 && high - low > 1e-8 * high; ++i) {
      const double middle = 0.5 * (low + high);
      double up_to = sum;
      for_splats(ray, piece, [&](const SplatOnRay& s) { up_to += s.up_to(middle); });
      (up_to < wanted ? low : high) = middle;
    }
    return float(0.5 * (low + high));
  }
  return kInfinity;
}

}  // namespace aureole
