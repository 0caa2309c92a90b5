// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/sampling/disc_sampling.h"

#include <algorithm>

#include "aureole/math/warp.h"

namespace aureole {

namespace {

/// Squared diameter over squared distance below which uniform area sampling is nearly as good.
constexpr double kFar = 0.1;
/// Limits of the solid angle [sr], and of the distance from the plane in radii, below which the cone loses
/// its precision.
constexpr double kSmallArea = 1e-6, kInPlane = 1e-6;

}  // namespace

DiscView DiscView::by_area(const Double3& reference, const Double3& center, const Double3& n) {
  DiscView view;
  if (dot(reference - center, n) > 0) view.technique_ = Technique::area;
  return view;
}

DiscView DiscView::of(const Double3& reference, const Double3& center, const Double3& n, double radius) {
  DiscView view = by_area(reference, center, n);
  const Double3 from_center = reference - center;
  const double h = dot(from_center, n);
  if (!(h > kInPlane * radius) || 4 * radius * radius < kFar * dot(from_center, from_center)) return view;

  // Coordinates (outward, down) in the plane of symmetry through the reference point.
  const Double3 foot = from_center - n * h;
  const double l = length(foot);
  Double3 outward, across;
  make_basis(n, outward, across);
  if (l > 1e-9 * radius) outward = foot * (1 / l);
  const double near = std::hypot(radius - l, h), far = std::hypot(radius + l, h);
  const double near_x = (radius - l) / near, near_y = h / near, far_x = -(radius + l) / far, far_y = h / far;
  const double sum = std::hypot(near_x + far_x, near_y + far_y);
  // The axis bisects the directions to the two extreme points of the rim.
  const double axis_x = (near_x + far_x) / sum, axis_y = (near_y + far_y) / sum;
  const double cos_x = sum / 2, sin_x = std::hypot(near_x - far_x, near_y - far_y) / 2;
  // Chord perpendicular to the plane of symmetry, through the point where the cone's axis intersects the
  // disc.
  const double off_center = l + h * axis_x / axis_y, distance = h / axis_y;
  const double half_chord2 = (radius - off_center) * (radius + off_center);
  if (!(half_chord2 > 0)) return view;
  const double cos_y = distance / std::sqrt(distance * distance + half_chord2);

  view.a_ = sin_x * std::sqrt(2 / (1 + cos_x));
  view.b_ = std::sqrt(2 * half_chord2 / (distance * distance + half_chord2) / (1 + cos_y));
  if (kPiD * view.a_ * view.b_ < kSmallArea) return view;
  view.technique_ = Technique::solid_angle;
  view.reference_ = reference, view.normal_ = n, view.height_ = h;
  view.x_ = outward * axis_y + n * axis_x;
  view.y_ = cross(n, outward);
  view.z_ = outward * axis_x - n * axis_y;
  view.cot2_x_ = cos_x * cos_x / (sin_x * sin_x);
  view.cot2_y_ = distance * distance / half_chord2;
  return view;
}

DiscView::Rim DiscView::rim(double cos_phi, double sin_phi) const {
  const double c2 = cos_phi * cos_phi, s2 = sin_phi * sin_phi;
  // The value q is 1 / tan^2 of the polar angle; 1 - cos follows without cancellation.
  const double q = c2 * cot2_x_ + s2 * cot2_y_;
  const double cosine = std::sqrt(q / (1 + q));
  const double one_minus_cos = 1 / ((1 + q) * (1 + cosine));
  // Density of the azimuth: r^2 / (2 pi a b), with the radius r of the projected ellipse.
  const double azimuth = a_ * b_ / (2 * kPiD * (c2 * b_ * b_ + s2 * a_ * a_));
  return {one_minus_cos, azimuth / one_minus_cos};
}

Double3 DiscView::sample(Vec2 u) const {
  const DiscPoint at = square_to_disc_concentric(u);
  const double r = at.radius;
  double c = r > 0 ? a_ * (at.p.x / r) : 1, s = r > 0 ? b_ * (at.p.y / r) : 0;
  const double l = std::hypot(c, s);
  c /= l, s /= l;
  const double one_minus_cos = r * r * rim(c, s).one_minus_cos;
  const double sine = std::sqrt(one_minus_cos * (2 - one_minus_cos));
  const Double3 d = x_ * (sine * c) + y_ * (sine * s) + z_ * (1 - one_minus_cos);
  return reference_ + d * (-height_ / dot(d, normal_));
}

double DiscView::pdf(const Double3& d) const {
  const double x = dot(d, x_), y = dot(d, y_), l = std::hypot(x, y);
  return l > 0 ? rim(x / l, y / l).pdf : rim(1, 0).pdf;
}

}  // namespace aureole
