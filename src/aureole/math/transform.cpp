// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/transform.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aureole {

namespace {
using Vec3d = std::array<double, 3>;
Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3d normalized(const Vec3d& a) {
  const double l = std::hypot(a[0], a[1], a[2]);
  return {a[0] / l, a[1] / l, a[2] / l};
}
}  // namespace

Transform::Transform() : m_{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}} {}

Transform Transform::translate(double x, double y, double z) {
  return Transform({{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}});
}

Transform Transform::scale(double x, double y, double z) {
  return Transform({{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}, {0, 0, 0, 1}}});
}

Transform Transform::rotate(double x, double y, double z, double degrees) {
  const Vec3d a = normalized({x, y, z});
  const double angle = degrees * (M_PI / 180), c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  return Transform({{{c + a[0] * a[0] * k, a[0] * a[1] * k - a[2] * s, a[0] * a[2] * k + a[1] * s, 0},
                     {a[1] * a[0] * k + a[2] * s, c + a[1] * a[1] * k, a[1] * a[2] * k - a[0] * s, 0},
                     {a[2] * a[0] * k - a[1] * s, a[2] * a[1] * k + a[0] * s, c + a[2] * a[2] * k, 0},
                     {0, 0, 0, 1}}});
}

Transform Transform::look_at(const Vec3d& o, const Vec3d& target, const Vec3d& up) {
  const Vec3d d = normalized({target[0] - o[0], target[1] - o[1], target[2] - o[2]});
  const Vec3d left = normalized(cross(up, d));
  const Vec3d u = cross(d, left);
  return Transform({{{left[0], u[0], d[0], o[0]},
                     {left[1], u[1], d[1], o[1]},
                     {left[2], u[2], d[2], o[2]},
                     {0, 0, 0, 1}}});
}

Transform Transform::operator*(const Transform& b) const {
  Matrix r{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) r[i][j] += m_[i][k] * b.m_[k][j];
  return Transform(r);
}

double Transform::determinant3() const {
  return m_[0][0] * (m_[1][1] * m_[2][2] - m_[1][2] * m_[2][1]) -
         m_[0][1] * (m_[1][0] * m_[2][2] - m_[1][2] * m_[2][0]) +
         m_[0][2] * (m_[1][0] * m_[2][1] - m_[1][1] * m_[2][0]);
}

bool Transform::is_singular() const {
  double scale = 1;
  for (int i = 0; i < 3; ++i) {
    double row = 0;
    for (int j = 0; j < 4; ++j) {
      if (!std::isfinite(m_[i][j])) return true;
      if (j < 3) row += m_[i][j] * m_[i][j];
    }
    scale *= std::sqrt(row);
  }
  // Smallest determinant of an invertible matrix: products of tiny scales vanish, and their inverse has no
  // bound.
  constexpr double kLeast = 1e-290;
  return !(std::abs(determinant3()) > std::max(1e-12 * scale, kLeast));
}

bool Transform::stays_near() const {
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(m_[i][3]) <= kFarthestPlace)) return false;
  return true;
}

Transform Transform::inverse() const {
  Matrix a = m_, r = Transform().m_;
  for (int c = 0; c < 4; ++c) {
    int pivot = c;
    for (int i = c + 1; i < 4; ++i)
      if (std::abs(a[i][c]) > std::abs(a[pivot][c])) pivot = i;
    std::swap(a[c], a[pivot]), std::swap(r[c], r[pivot]);
    const double inverse_pivot = 1 / a[c][c];
    for (int j = 0; j < 4; ++j) a[c][j] *= inverse_pivot, r[c][j] *= inverse_pivot;
    for (int i = 0; i < 4; ++i) {
      if (i == c) continue;
      const double f = a[i][c];
      for (int j = 0; j < 4; ++j) a[i][j] -= f * a[c][j], r[i][j] -= f * r[c][j];
    }
  }
  return Transform(r);
}

Transform Transform::orthogonal_part() const {
  // Newton's iteration Q <- (s Q + (s Q)^-T)/2, which converges quadratically (Higham 1986, "Computing the
  // polar decomposition - with applications"). The factor s, which makes the determinant's size 1, speeds up
  // its first steps.
  Matrix q = m_;
  for (int i = 0; i < 3; ++i) q[i][3] = q[3][i] = 0;
  q[3][3] = 1;
  constexpr int kMaxSteps = 64;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double s = std::cbrt(1 / std::abs(Transform(q).determinant3()));
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) q[i][k] *= s;
    const Matrix inverse = Transform(q).inverse().m_;
    double change = 0;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const double next = 0.5 * (q[i][k] + inverse[k][i]);
        change = std::max(change, std::abs(next - q[i][k]));
        q[i][k] = next;
      }
    if (change < 1e-15) break;
  }
  return Transform(q);
}

Vec3 Transform::point(const Vec3& p) const {
  Vec3 r;
  for (int i = 0; i < 3; ++i) r[i] = float(m_[i][0] * p.x + m_[i][1] * p.y + m_[i][2] * p.z + m_[i][3]);
  return r;
}

Vec3 Transform::vector(const Vec3& v) const {
  Vec3 r;
  for (int i = 0; i < 3; ++i) r[i] = float(m_[i][0] * v.x + m_[i][1] * v.y + m_[i][2] * v.z);
  return r;
}

Vec3 Transform::normal(const Vec3& n) const {
  // Rows of the cofactor matrix are det * (M^-1)^T. The sign of det keeps normals on their side of mirrored
  // meshes.
  const auto& m = m_;
  const double sign = determinant3() < 0 ? -1 : 1;
  Vec3 r;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    double sum = 0;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      sum += (m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1]) * n[j];
    }
    r[i] = float(sign * sum);
  }
  return r;
}

Vec2 Transform::point2(const Vec2& p) const {
  return {float(m_[0][0] * p.x + m_[0][1] * p.y + m_[0][3]),
          float(m_[1][0] * p.x + m_[1][1] * p.y + m_[1][3])};
}

}  // namespace aureole
