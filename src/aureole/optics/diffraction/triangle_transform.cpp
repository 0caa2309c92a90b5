// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/triangle_transform.h"

#include <algorithm>
#include <cmath>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

/// Returns the divided difference of exp(-i t) over `count` <= 4 phases within kClose of one another. About
/// their middle m it is the sum over k of (-i)^(n+k)/(n+k)! h_k exp(-i m), with n = count - 1 and the
/// complete homogeneous symmetric polynomials h_k of the differences to m.
constexpr double kClose = 1.5;
Complex close_difference(const double* t, int count) {
  constexpr int kTerms = 16;  // the remaining terms are below 1e-17
  const double middle = 0.5 * (t[0] + t[count - 1]);
  double h[kTerms] = {1};
  for (int j = 0; j < count; ++j)
    for (int k = 1; k < kTerms; ++k) h[k] += (t[j] - middle) * h[k - 1];
  double factorial = 1, part[2] = {0, 0};
  for (int k = 2; k < count; ++k) factorial *= k;
  for (int k = 0; k < kTerms; ++k) {
    const int order = count - 1 + k;
    if (k > 0) factorial *= order;
    part[order & 1] += ((order & 2) ? -h[k] : h[k]) / factorial;
  }
  return Complex(part[0], -part[1]) * std::polar(1.0, -middle);
}

/// Returns the divided difference for any phases in ascending order. It divides by the widest gap, so that
/// errors do not grow.
Complex difference(const double* t, int count) {
  if (count == 1) return std::polar(1.0, -t[0]);
  const double spread = t[count - 1] - t[0];
  if (spread <= kClose) return close_difference(t, count);
  return (difference(t + 1, count - 1) - difference(t, count - 1)) / spread;
}

double signed_area(const LinearTriangle& t) {
  const auto& [a, b, c] = t.corner;
  return 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

}  // namespace

double LinearTriangle::area() const { return std::abs(signed_area(*this)); }

std::complex<double> transform(const LinearTriangle& triangle, PlanePoint q) {
  // The integral over barycentric coordinates g of g_j exp(-i sum g t) is the divided difference, at the
  // three phases and t_j once more, of the third antiderivative of exp(-i t), which is -i exp(-i t).
  double phase[3];
  for (int j = 0; j < 3; ++j) phase[j] = q.x * triangle.corner[j].x + q.y * triangle.corner[j].y;
  Complex sum = 0;
  for (int j = 0; j < 3; ++j) {
    if (triangle.value[j] == Complex(0)) continue;
    double t[4] = {phase[0], phase[1], phase[2], phase[j]};
    std::sort(t, t + 4);
    sum += triangle.value[j] * difference(t, 4);
  }
  return Complex(0, -2 * triangle.area()) * sum;
}

std::complex<double> transform(std::span<const LinearTriangle> triangles, PlanePoint q) {
  Complex sum = 0;
  for (const LinearTriangle& t : triangles) sum += transform(t, q);
  return sum;
}

double power(const LinearTriangle& triangle) {
  const auto& [a, b, c] = triangle.value;
  const double pairs = std::norm(a) + std::norm(b) + std::norm(c) + (a * std::conj(b)).real() +
                       (a * std::conj(c)).real() + (b * std::conj(c)).real();
  return triangle.area() / 6 * pairs;
}

double power(std::span<const LinearTriangle> triangles) {
  double sum = 0;
  for (const LinearTriangle& t : triangles) sum += power(t);
  return sum;
}

AmplitudeMoments amplitude_moments(std::span<const LinearTriangle> triangles) {
  // Over a triangle of area S the integral of g_j is S/3, that of g_j g_k is S/12, or S/6 for j = k, and that
  // of g_j g_k g_l is S/60 times the product of the factorials of the exponents.
  AmplitudeMoments m{};
  for (const LinearTriangle& t : triangles) {
    const double area = t.area();
    for (int j = 0; j < 3; ++j) {
      const Complex v = t.value[j];
      m.total += v * (area / 3);
      for (int k = 0; k < 3; ++k) {
        const double pair = area / (j == k ? 6 : 12);
        m.x += v * (pair * t.corner[k].x);
        m.y += v * (pair * t.corner[k].y);
        for (int l = 0; l < 3; ++l) {
          const int equal = (j == k) + (k == l) + (j == l);
          const double triple = area / 60 * (equal == 3 ? 6 : equal == 1 ? 2 : 1);
          m.xx += v * (triple * t.corner[k].x * t.corner[l].x);
          m.xy += v * (triple * t.corner[k].x * t.corner[l].y);
          m.yy += v * (triple * t.corner[k].y * t.corner[l].y);
        }
      }
    }
  }
  return m;
}

}  // namespace aureole::optics
