// SPDX-License-Identifier: Apache-2.0
// `Motion`: a transform that changes over time, by key frames.
#pragma once

#include <vector>

#include "aureole/math/transform.h"

namespace aureole {

/// A transform at a time.
struct KeyFrame {
  double time = 0;  ///< [s]
  Transform transform;
};

/// An affine transform over time. Between two key frames the translation and the stretch are linear in time, and the
/// rotation turns evenly about one axis, by less than half a turn (Shoemake & Duff 1992, "Matrix animation and polar
/// decomposition"). Before the first key frame and after the last one the transform stays that of the nearer one.
class Motion {
public:
  Motion() : Motion(Transform()) {}
  explicit Motion(const Transform& at_rest);
  /// Requires at least one key frame, in order of time. Throws Error for equal or decreasing times, for a singular
  /// transform, and where one of two neighbours mirrors and the other does not.
  explicit Motion(std::vector<KeyFrame> frames);

  /// Whether the transform changes at all.
  bool is_moving() const { return frames_.size() > 1; }
  const std::vector<KeyFrame>& frames() const { return frames_; }
  /// The transform of the first key frame.
  const Transform& first() const { return frames_.front().transform; }
  /// Whether all key frames differ by rotations and translations only, so that lengths and angles stay.
  bool is_rigid() const;
  /// The transform at a time [s].
  Transform at(double time) const;

private:
  /// A transform as translation x rotation x stretch.
  struct Parts {
    double rotation[4];    ///< unit quaternion, w first
    double mirror = 1;     ///< -1: the rotation is followed by a reflection at the origin
    double stretch[3][3];  ///< symmetric
    double translation[3];
  };

  std::vector<KeyFrame> frames_;
  std::vector<Parts> parts_;  ///< of the key frames; empty for a transform at rest
};

}  // namespace aureole
