// SPDX-License-Identifier: Apache-2.0
// Isosurfaces of a trilinear field along a ray. Within a cell between eight voxel centres the field is a cubic of the
// distance, whose roots are found one by one between its extrema (Marmitt, Kleer, Wald & Friedrich 2004, "Fast and
// accurate ray-voxel intersection techniques for iso-surface ray tracing").
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "aureole/medium/classified/classified_medium.h"

namespace aureole {

struct CellRoot {
  float t;                                   ///< distance along the ray
  float value;                               ///< value of the isosurface
  const ClassifiedMedium* medium = nullptr;  ///< medium that holds the field
};

/// Calls visit(root) for each root of f(s) = value, 0 <= s < 1, in ascending order; f is the cubic with these values at
/// s = 0, 1/3, 2/3, 1.
template <class Visit>
void visit_cubic_roots(const double f[4], double value, Visit&& visit) {
  const double c0 = f[0] - value, c1 = 0.5 * (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]),
               c2 = 4.5 * (2 * f[0] - 5 * f[1] + 4 * f[2] - f[3]),
               c3 = 4.5 * (-f[0] + 3 * f[1] - 3 * f[2] + f[3]);
  const auto at = [&](double s) { return ((c3 * s + c2) * s + c1) * s + c0; };
  double ends[4] = {0};  // ends of monotone intervals
  int count = 1;
  const double a = 3 * c3, b = 2 * c2, discriminant = b * b - 4 * a * c1;
  if (discriminant > 0) {
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    double e0 = a != 0 ? q / a : 2, e1 = q != 0 ? c1 / q : 2;
    if (e0 > e1) std::swap(e0, e1);
    for (const double e : {e0, e1})
      if (e > 0 && e < 1) ends[count++] = e;
  }
  ends[count] = 1;
  // A root is a change from below the value to not below it, so that a segment that is constant at the value
  // is one root. At the ends of the cell the stored values themselves decide, which the neighbouring cell
  // shares.
  const auto is_below = [&](int end) {
    return end == 0 ? f[0] < value : end == count ? f[3] < value : at(ends[end]) < 0;
  };
  for (int i = 0; i < count; ++i) {
    if (is_below(i) == is_below(i + 1)) continue;
    double low = ends[i], high = ends[i + 1];
    const bool low_is_below = is_below(i);
    for (int k = 0; k < 60 && high - low > 1e-12; ++k) {
      // Regula falsi where it makes progress, bisection every other time.
      const double fl = at(low), fh = at(high);
      double middle = k % 2 ? 0.5 * (low + high) : low - fl * (high - low) / (fh - fl);
      if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
      ((at(middle) < 0) == low_is_below ? low : high) = middle;
    }
    visit(0.5 * (low + high));
  }
}

/// Calls visit(root) for the points between the distances `begin` and `end` of a ray where a field has one of the values,
/// cell by cell and in ascending order within each cell, until it returns false. Beyond the outermost voxel centres the
/// field is constant along that axis.
template <class Visit>
void find_isosurfaces(const ScalarField& field, const Ray& ray, float begin, float end,
                      const std::vector<float>& values, Visit&& visit) {
  const Vec3 o = field.index_of(ray.o), d = field.index_vector(ray.d);
  double t = begin;
  std::vector<CellRoot> roots;
  double last_number = double(field.value(ray.o + ray.d * begin));
  while (t < end) {
    // The cell that holds the ray just behind t, or the border of constant values.
    double next = end;
    const double probe = t + 1e-6 * std::max(1.0, std::abs(t)) * 0.01;
    for (int k = 0; k < 3; ++k) {
      if (d[k] == 0) continue;
      const double last = double(field.size()[std::size_t(k)] - 1), i = double(o[k]) + probe * double(d[k]);
      const double plane = d[k] > 0 ? std::max(0.0, std::floor(i) + 1) : std::min(last, std::ceil(i) - 1);
      if (d[k] > 0 ? plane > last : plane < 0) continue;  // the plane lies beyond the outermost voxel centres
      const double crossing = (plane - double(o[k])) / double(d[k]);
      if (crossing > probe) next = std::min(next, crossing);
    }
    next = std::min(std::max(next, probe), double(end));
    double f[4];
    f[0] = last_number;
    for (int k = 1; k < 4; ++k) f[k] = double(field.value(ray.o + ray.d * float(t + (next - t) * k / 3)));
    last_number = f[3];
    // Bounds of the cubic from its four equidistant samples: Lagrange's weights add up to less than 2 in
    // magnitude between the outermost samples.
    const auto [low, high] = std::minmax({f[0], f[1], f[2], f[3]});
    const double margin = 3 * (high - low);
    roots.clear();
    for (const float value : values)
      if (double(value) >= low - margin && double(value) <= high + margin)
        visit_cubic_roots(f, double(value), [&](double s) {
          roots.push_back({float(t + s * (next - t)), value});
        });
    std::sort(roots.begin(), roots.end(), [](const CellRoot& a, const CellRoot& b) { return a.t < b.t; });
    for (const CellRoot& root : roots)
      if (!visit(root)) return;
    t = next;
  }
}

}  // namespace aureole
