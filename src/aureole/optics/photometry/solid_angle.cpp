// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/photometry/solid_angle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "aureole/optics/gauss_legendre.h"

namespace aureole::optics {

namespace {

Point3 combined(const Point3& a, double s, const Point3& b, double t) {
  return {a[0] * s + b[0] * t, a[1] * s + b[1] * t, a[2] * s + b[2] * t};
}
double inner(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point3 outer(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double norm(const Point3& a) { return std::hypot(a[0], a[1], a[2]); }
/// Tests each coordinate, too: std::hypot of three numbers may be finite although one of them is not a number.
bool is_finite(const Point3& a) {
  return std::all_of(a.begin(), a.end(), [](double x) { return std::isfinite(x); }) && std::isfinite(norm(a));
}

/// The unit vector along v; zero for zero. Throws std::domain_error for a vector with a coordinate that is not finite.
Point3 unit(const Point3& v, const char* name) {
  if (!is_finite(v)) throw std::domain_error(std::string(name) + " must be finite");
  const double l = norm(v);
  if (!(l > 0)) return {};
  return {v[0] / l, v[1] / l, v[2] / l};
}

void require_point(const Point3& p) {
  if (!is_finite(p)) throw std::domain_error("points must be finite");
}

/// Lambert's term of a side from a to b: half the angle that it subtends, times the component along n of the normal of its
/// plane with the observer.
double side_term(const Point3& a, const Point3& b, const Point3& n) {
  const Point3 across = outer(a, b);
  const double area = norm(across);
  if (!(area > 0)) return 0;
  return 0.5 * std::atan2(area, inner(a, b)) * inner(across, n) / area;
}

/// The part of a polygon with n p >= 0 (I. E. Sutherland & G. W. Hodgman 1974).
std::vector<Point3> clipped(std::span<const Point3> corners, const Point3& n) {
  std::vector<Point3> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double ha = inner(a, n), hb = inner(b, n);
    if (ha >= 0) kept.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0))
      kept.push_back(combined(a, hb / (hb - ha), b, -ha / (hb - ha)));
  }
  return kept;
}

}  // namespace

SolidAngles sphere_solid_angle(const Point3& center, double radius, const Point3& normal) {
  require_point(center);
  if (!(radius > 0 && std::isfinite(radius))) throw std::domain_error("the radius must be positive");
  const Point3 n = unit(normal, "the normal");
  const double distance = norm(center);
  if (distance <= radius) return {4 * M_PI, norm(n) > 0 ? M_PI : 0};
  const double ratio = radius / distance, sine2 = ratio * ratio;
  // 1 - cos without cancellation
  SolidAngles result{2 * M_PI * sine2 / (1 + std::sqrt(1 - sine2)), 0};
  if (!(norm(n) > 0)) return result;
  const double c = std::clamp(inner(center, n) / distance, -1.0, 1.0), s = std::sqrt(1 - c * c);
  if (c >= ratio) {  // all of it is above the plane
    result.projected = M_PI * sine2 * c;
  } else if (c > -ratio) {
    const double cotangent = std::sqrt(1 / sine2 - 1), y = std::clamp(-cotangent * c / s, -1.0, 1.0),
                 root = s * std::sqrt(1 - y * y);
    result.projected = sine2 * (c * std::acos(y) - cotangent * root) + std::atan2(root, cotangent);
  }
  return result;
}

SolidAngles polygon_solid_angle(std::span<const Point3> corners, const Point3& normal) {
  if (corners.size() < 3) throw std::domain_error("a polygon has at least three corners");
  for (const Point3& p : corners) require_point(p);
  const Point3 n = unit(normal, "the normal");
  double sum = 0;
  const Point3& a = corners[0];
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Point3 &b = corners[i], &c = corners[i + 1];
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double volume = inner(a, outer(b, c)),
                 below = la * lb * lc + inner(a, b) * lc + inner(a, c) * lb + inner(b, c) * la;
    sum += 2 * std::atan2(volume, below);
  }
  SolidAngles result{std::abs(sum), 0};
  if (!(norm(n) > 0)) return result;
  const std::vector<Point3> above = clipped(corners, n);
  double projected = 0;
  for (std::size_t i = 0; i < above.size(); ++i)
    projected += side_term(above[i], above[(i + 1) % above.size()], n);
  result.projected = std::abs(projected);
  return result;
}

SolidAngles disc_solid_angle(const Point3& center, const Point3& axis, double radius, const Point3& normal) {
  require_point(center);
  if (!(radius > 0 && std::isfinite(radius))) throw std::domain_error("the radius must be positive");
  const Point3 up = unit(axis, "the axis"), n = unit(normal, "the normal");
  if (!(norm(up) > 0)) throw std::domain_error("the axis must not be zero");
  // The observer's height above the disc, and distance from its axis.
  const double height = std::abs(inner(center, up));
  const Point3 across = combined(center, 1, up, -inner(center, up));
  const double off = norm(across);
  SolidAngles result;
  if (height > 1e-12 * (radius + off)) {
    const double longest = std::hypot(height, radius + off),
                 k = std::min(std::sqrt(4 * radius * off) / longest, 1 - 1e-15);
    const double first = std::comp_ellint_1(k), scale = 2 * height / longest;
    const double sum = radius + off, gap = radius - off;
    // Pi(alpha^2, k) with alpha^2 = 4 a r/(a + r)^2 < 1, times (r - a)/(r + a); the limit at r = a is -pi/2 within the disc's
    // edge and pi/2 beyond, which continues both branches.
    double third = 0;
    if (std::abs(gap) > 1e-9 * sum) {
      const double alpha2 = 4 * radius * off / (sum * sum);
      third = -gap / sum * std::comp_ellint_3(k, alpha2);
      result.solid = (gap > 0 ? 2 * M_PI : 0) - scale * first + scale * third;
    } else {
      result.solid = M_PI - scale * first;
    }
  } else if (off < radius) {
    result.solid = 2 * M_PI;
  }
  result.solid = std::clamp(result.solid, 0.0, 2 * M_PI);
  if (!(norm(n) > 0)) return result;
  // Boundary center + radius (cos t e + sin t f), of which the part with n p >= 0 counts: one arc and the chord between its
  // ends.
  const Point3 seed = std::abs(up[0]) < 0.6 ? Point3{1, 0, 0} : Point3{0, 1, 0};
  const Point3 e = unit(outer(seed, up), "the axis"), f = outer(up, e);
  const auto point = [&](double t) {
    return combined(center, 1, combined(e, std::cos(t), f, std::sin(t)), radius);
  };
  const double a = inner(center, n), amplitude = radius * std::hypot(inner(e, n), inner(f, n)),
               phase = std::atan2(inner(f, n), inner(e, n));
  if (a <= -amplitude) return result;
  const double half = a >= amplitude ? M_PI : std::acos(-a / amplitude);
  const double from = phase - half, to = phase + half;
  // Panels by the distance of the boundary: the integrand is p x dp/dt over |p|^2, and short distances need short panels.
  const double nearest = std::hypot(height, std::abs(radius - off)) / radius;
  if (!(nearest > 0)) throw std::domain_error("the observer lies on the edge of the disc");
  const int panels = int(std::clamp(std::ceil(2 * half / std::min(0.5, nearest)), 4.0, 100000.0));
  double projected = 0;
  for (int i = 0; i < panels; ++i) {
    const Quadrature rule =
        gauss_legendre(16, from + (to - from) * i / panels, from + (to - from) * (i + 1) / panels);
    for (std::size_t q = 0; q < rule.x.size(); ++q) {
      const double t = rule.x[q];
      const Point3 p = point(t), slope = combined(f, radius * std::cos(t), e, -radius * std::sin(t));
      projected += 0.5 * rule.weight[q] * inner(outer(p, slope), n) / inner(p, p);
    }
  }
  if (half < M_PI) projected += side_term(point(to), point(from), n);
  result.projected = std::abs(projected);
  return result;
}

}  // namespace aureole::optics
