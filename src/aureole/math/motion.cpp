// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/motion.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"

namespace aureole {

namespace {

/// Sets the unit quaternion (w, x, y, z) of a rotation matrix. The largest component is found by a square root, the
/// others by division by it, so that none loses digits (Shepperd 1978, "Quaternion from rotation matrix").
void quaternion_of(const Transform::Matrix& m, double q[4]) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  const double squares[4] = {1 + trace, 1 + 2 * m[0][0] - trace, 1 + 2 * m[1][1] - trace,
                             1 + 2 * m[2][2] - trace};
  const int largest = int(std::max_element(squares, squares + 4) - squares);
  const double root = std::sqrt(squares[largest]), scale = 0.5 / root;
  if (largest == 0) {
    q[0] = 0.5 * root;
    for (int i = 0; i < 3; ++i)
      q[i + 1] = (m[(i + 2) % 3][(i + 1) % 3] - m[(i + 1) % 3][(i + 2) % 3]) * scale;
    return;
  }
  const int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
  q[0] = (m[k][j] - m[j][k]) * scale;
  q[1 + i] = 0.5 * root;
  q[1 + j] = (m[j][i] + m[i][j]) * scale;
  q[1 + k] = (m[k][i] + m[i][k]) * scale;
}

/// The rotation matrix of a unit quaternion (w, x, y, z).
Transform rotation_of(const double q[4]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  Transform::Matrix m = Transform().matrix();
  m[0] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 0};
  m[1] = {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 0};
  m[2] = {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), 0};
  return Transform(m);
}

/// Spherical linear interpolation of unit quaternions (Shoemake 1985, "Animating rotation with quaternion curves") along
/// the shorter of both arcs.
void turn(const double a[4], const double b[4], double f, double out[4]) {
  double cosine = 0;
  for (int i = 0; i < 4; ++i) cosine += a[i] * b[i];
  const double sign = cosine < 0 ? -1 : 1, angle = std::acos(std::min(1.0, std::abs(cosine)));
  double of_a = 1 - f, of_b = f;
  if (angle > 1e-6) {
    of_a = std::sin((1 - f) * angle) / std::sin(angle);
    of_b = std::sin(f * angle) / std::sin(angle);
  }
  double norm = 0;
  for (int i = 0; i < 4; ++i) out[i] = of_a * a[i] + sign * of_b * b[i], norm += out[i] * out[i];
  norm = 1 / std::sqrt(norm);
  for (int i = 0; i < 4; ++i) out[i] *= norm;
}

}  // namespace

Motion::Motion(const Transform& at_rest) : frames_{{0, at_rest}} {}

Motion::Motion(std::vector<KeyFrame> frames) : frames_(std::move(frames)) {
  if (frames_.empty()) throw Error("an animation needs at least one key frame");
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!std::isfinite(frames_[i].time)) throw Error("the time of a key frame must be a finite number");
    if (i > 0 && !(frames_[i].time > frames_[i - 1].time))
      throw Error("the times of key frames must increase");
    if (frames_[i].transform.is_singular())
      throw Error("the transform of a key frame is singular (it cannot be inverted)");
  }
  const auto same = [&](const KeyFrame& f) { return f.transform == frames_.front().transform; };
  if (std::all_of(frames_.begin(), frames_.end(), same)) frames_.resize(1);
  if (frames_.size() == 1) return;
  for (const KeyFrame& frame : frames_) {
    Parts p{};
    const Transform orthogonal = frame.transform.orthogonal_part();
    p.mirror = orthogonal.determinant3() < 0 ? -1 : 1;
    Transform::Matrix rotation = orthogonal.matrix();
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) rotation[i][k] *= p.mirror;
    quaternion_of(rotation, p.rotation);
    // The stretch is the orthogonal part's transpose times the matrix.
    const Transform::Matrix& m = frame.transform.matrix();
    for (std::size_t i = 0; i < 3; ++i) {
      p.translation[i] = m[i][3];
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t j = 0; j < 3; ++j) p.stretch[i][k] += orthogonal.matrix()[j][i] * m[j][k];
    }
    if (!parts_.empty() && parts_.back().mirror != p.mirror)
      throw Error("one key frame mirrors and the next does not: there is no motion between them");
    parts_.push_back(p);
  }
}

bool Motion::is_rigid() const {
  const Transform back = first().inverse();
  for (const KeyFrame& frame : frames_) {
    const Transform::Matrix m = (frame.transform * back).matrix();
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k <= i; ++k) {
        const double product = m[0][i] * m[0][k] + m[1][i] * m[1][k] + m[2][i] * m[2][k];
        if (std::abs(product - (i == k ? 1 : 0)) > 1e-3) return false;
      }
  }
  return true;
}

Transform Motion::at(double time) const {
  if (!is_moving() || time <= frames_.front().time) return frames_.front().transform;
  if (!(time < frames_.back().time)) return frames_.back().transform;
  const auto later = std::upper_bound(frames_.begin(), frames_.end(), time,
                                      [](double t, const KeyFrame& f) { return t < f.time; });
  const std::size_t k = std::size_t(later - frames_.begin());
  const double f = (time - frames_[k - 1].time) / (frames_[k].time - frames_[k - 1].time);
  const Parts &a = parts_[k - 1], &b = parts_[k];
  double q[4];
  turn(a.rotation, b.rotation, f, q);
  const Transform rotation = rotation_of(q);
  Transform::Matrix m = Transform().matrix();
  for (std::size_t i = 0; i < 3; ++i) {
    m[i][3] = a.translation[i] + (b.translation[i] - a.translation[i]) * f;
    for (std::size_t k3 = 0; k3 < 3; ++k3) {
      double sum = 0;
      for (std::size_t j = 0; j < 3; ++j)
        sum += rotation.matrix()[i][j] * (a.stretch[j][k3] + (b.stretch[j][k3] - a.stretch[j][k3]) * f);
      m[i][k3] = a.mirror * sum;
    }
  }
  return Transform(m);
}

}  // namespace aureole
