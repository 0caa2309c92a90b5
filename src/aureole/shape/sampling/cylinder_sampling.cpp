// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/sampling/cylinder_sampling.h"

#include <algorithm>

namespace aureole {

namespace {

/// Distance in radii up to which a point counts as on the surface, to within rounding. From such a point an
/// inward cylinder is sampled as from inside.
constexpr double kOnSurface = 1e-5;

}  // namespace

RoundView::RoundView(const Double3& reference, double radius, double length, bool inward)
    : o_(reference),
      radius_(radius),
      length_(length),
      from_axis_(std::sqrt(reference.x * reference.x + reference.y * reference.y)),
      inward_(inward) {
  if (from_axis_ > radius * (inward ? 1 + kOnSurface : 1.0))
    half_range_ = std::asin(radius / from_axis_);
  else if (inward)
    half_range_ = kPiD;
}

void RoundView::ends(double distance, double& lower, double& upper) const {
  const double below = -o_.z, above = length_ - o_.z;
  lower = below / std::sqrt(distance * distance + below * below);
  upper = above / std::sqrt(distance * distance + above * above);
}

bool RoundView::sample(Vec2 u, Double3& p) const {
  const double angle = half_range_ * (2 * double(u.x) - 1), sine = std::sin(angle), cosine = std::cos(angle);
  // Across the axis, a ray from the reference point meets the circle at the distances middle - half and
  // middle + half. The smaller one is computed from their product, without cancellation.
  const double middle = from_axis_ * cosine,
               half = std::sqrt(std::max(0.0, (radius_ - from_axis_ * sine) * (radius_ + from_axis_ * sine)));
  const double product = (from_axis_ - radius_) * (from_axis_ + radius_);
  const double distance = inward_ ? middle + half : product / (middle + half);
  if (!(distance > kOnSurface * radius_)) return false;
  double lower, upper;
  ends(distance, lower, upper);
  const double s = lower + double(u.y) * (upper - lower);
  const double z = distance * s / std::sqrt((1 - s) * (1 + s));
  // The direction is towards the axis, or any direction for a reference point on the axis.
  const double x = from_axis_ > 0 ? -o_.x / from_axis_ : 1, y = from_axis_ > 0 ? -o_.y / from_axis_ : 0;
  p = {o_.x + distance * (x * cosine - y * sine), o_.y + distance * (x * sine + y * cosine),
       std::clamp(o_.z + z, 0.0, length_)};
  return true;
}

double RoundView::pdf(const Double3& p) const {
  const double x = p.x - o_.x, y = p.y - o_.y, distance = std::sqrt(x * x + y * y);
  if (empty() || !(distance > kOnSurface * radius_)) return 0;
  double lower, upper;
  ends(distance, lower, upper);
  const double pdf = 1 / (2 * half_range_ * (upper - lower));
  return std::isfinite(float(pdf)) ? pdf : 0;
}

AffineView::AffineView(const Double3& o, bool inward) {
  // Half the range of azimuths: from outside, the front is visible where cos(phi - phi0) > 1 / r.
  const double r = std::sqrt(o.x * o.x + o.y * o.y), facing = r > 1 ? std::acos(1 / r) : 0;
  middle_ = std::atan2(o.y, o.x) + (inward ? kPiD : 0);
  half_range_ = inward ? kPiD - facing : facing;
}

Double3 AffineView::sample(Vec2 u) const {
  const double phi = middle_ + half_range_ * (2 * double(u.x) - 1);
  return {std::cos(phi), std::sin(phi), u.y};
}

}  // namespace aureole
