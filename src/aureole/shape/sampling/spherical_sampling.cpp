// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/sampling/spherical_sampling.h"

#include <algorithm>

#include "aureole/shape/geometry/double3.h"

namespace aureole {

namespace {

/// Smallest solid angle [sr] of the spherical constructions, which lose their precision for smaller (edge-on)
/// patches.
constexpr double kSmallSolidAngle = 3e-4;
/// Solid angle [sr], just below a hemisphere, from which the reference point counts as lying on the patch, to
/// within rounding.
constexpr double kHemisphere = 2 * kPiD - 1e-6;

/// Returns the angle between two vectors, accurate for all angles.
double angle_between(const Double3& a, const Double3& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace

double triangle_solid_angle(const Vec3& reference, const TriangleCorners& corners) {
  const Double3 o(reference), a = Double3(corners[0]) - o, b = Double3(corners[1]) - o,
                              c = Double3(corners[2]) - o;
  const double la = length(a), lb = length(b), lc = length(c);
  // Triple product a . (b x c) from differences, without cancellation for a small, distant triangle.
  const double determinant = dot(a, cross(b - a, c - a));
  const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(std::abs(determinant), denominator);
}

Vec2 sample_spherical_triangle(const Vec3& reference, const TriangleCorners& corners, double solid_angle,
                               Vec2 u) {
  const Double3 o(reference), to0 = Double3(corners[0]) - o;
  const Double3 e1 = Double3(corners[1]) - Double3(corners[0]),
                e2 = Double3(corners[2]) - Double3(corners[0]);
  const Double3 a = normalize(to0), b = normalize(to0 + e1), c = normalize(to0 + e2);

  // Angles in Arvo's notation: alpha is the angle at a, cos_c the cosine of side ab.
  const double alpha = angle_between(cross(a, b), cross(a, c));
  const double cos_alpha = std::cos(alpha), sin_alpha = std::sin(alpha), cos_c = dot(a, b);
  const double part = u.x * solid_angle;  // area of the sub-triangle that ends on side ac
  const double s = std::sin(part - alpha), t = std::cos(part - alpha);
  const double p = t - cos_alpha, q = s + sin_alpha * cos_c;
  const double denominator = (q * s + p * t) * sin_alpha;
  double cos_b = denominator != 0 ? ((q * t - p * s) * cos_alpha - q) / denominator : 1;
  cos_b = std::clamp(cos_b, dot(a, c), 1.0);
  const Double3 side = normalize(c - a * dot(a, c));
  const Double3 c_hat = a * cos_b + side * std::sqrt(std::max(0.0, 1 - cos_b * cos_b));

  // Direction along the arc from b to c_hat, by 1 - cos so that a small triangle stays accurate.
  const Double3 chord = c_hat - b;
  const double one_minus_z = u.y * 0.5 * dot(chord, chord);
  const Double3 across = c_hat - b * dot(b, c_hat);
  const double across_length = length(across);
  const double sin_z = std::sqrt(std::max(0.0, one_minus_z * (2 - one_minus_z)));
  const Double3 d = across_length > 0 ? b * (1 - one_minus_z) + across * (sin_z / across_length) : b;

  // Intersection of d with the plane: d k = to0 + b1 e1 + b2 e2 (Cramer's rule).
  const Double3 m = cross(d, e2);
  const double determinant = dot(e1, m);
  double b1 = -dot(to0, m) / determinant;
  double b2 = -dot(d, cross(to0, e1)) / determinant;
  if (!std::isfinite(b1) || !std::isfinite(b2)) return {1.f / 3, 1.f / 3};
  b1 = std::clamp(b1, 0.0, 1.0);
  b2 = std::clamp(b2, 0.0, 1 - b1);
  return {float(b1), float(b2)};
}

Vec2 sample_spherical_rectangle(const Vec3& reference, const Vec3& corner, const Vec3& along_x,
                                const Vec3& along_y, Vec2 u) {
  const Double3 ex(along_x), ey(along_y), from = Double3(corner) - Double3(reference);
  const double width = length(ex);
  const Double3 x = ex * (1 / width);
  const Double3 y_raw = ey - x * dot(ey, x);
  const double height = length(y_raw);
  const Double3 y = y_raw * (1 / height);
  const double z0 = -std::abs(dot(from, cross(x, y)));
  const double x0 = dot(from, x), y0 = dot(from, y), x1 = x0 + width, y1 = y0 + height;

  // The planes through the reference point and the edges y = y0, x = x1, y = y1, x = x0 have the normals (0,
  // z0, -y0), (-z0, 0, x1), (0, -z0, y1), (z0, 0, -x0) up to length. The cosines of the angles between
  // neighbours depend only on their z.
  const auto inverse_hypot = [](double p, double q) { return 1 / std::sqrt(p * p + q * q); };
  const double b0 = -y0 * inverse_hypot(z0, y0), b1 = y1 * inverse_hypot(z0, y1);
  const double c0 = -x0 * inverse_hypot(z0, x0), c1 = x1 * inverse_hypot(z0, x1);
  const auto inner = [](double m, double n) { return std::acos(std::clamp(-m * n, -1.0, 1.0)); };
  const double g0 = inner(b0, c1), g1 = inner(c1, b1), g2 = inner(b1, c0), g3 = inner(c0, b0);
  const double k = 2 * kPiD - g2 - g3, solid_angle = g0 + g1 - k;

  // Column of the sample: cosine of the angle that bounds the fraction u.x of the solid angle.
  const double phi = u.x * solid_angle + k;
  const double f = (std::cos(phi) * b0 - b1) / std::sin(phi);
  const double cu = std::clamp(std::copysign(1 / std::sqrt(f * f + b0 * b0), f), -1.0, 1.0);
  double xu = -(cu * z0) / std::sqrt(1 - cu * cu);
  if (!(xu >= x0)) xu = x0;
  if (xu > x1) xu = x1;
  // Row of the sample: the height of the point on the unit sphere is uniform.
  const double d2 = xu * xu + z0 * z0;
  const double h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
  const double h = h0 + u.y * (h1 - h0);
  const double yv = h * h < 1 - 1e-15 ? h * std::sqrt(d2 / (1 - h * h)) : y1;
  return {float(std::clamp((xu - x0) / width, 0.0, 1.0)), float(std::clamp((yv - y0) / height, 0.0, 1.0))};
}

PatchView PatchView::of(const Vec3& reference, const TriangleCorners& first, const TriangleCorners* second) {
  PatchView view;
  view.solid_angle[0] = triangle_solid_angle(reference, first);
  if (second) view.solid_angle[1] = triangle_solid_angle(reference, *second);
  const double total = view.total();
  if (!(total > 0)) return view;
  view.technique = total < kSmallSolidAngle || total > kHemisphere ? Technique::area : Technique::solid_angle;
  return view;
}

}  // namespace aureole
