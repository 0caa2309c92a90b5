// SPDX-License-Identifier: Apache-2.0
// The place of a light over time: an emitter that key frames move, or an instance of a shape that emits.
#pragma once

#include "aureole/math/motion.h"

namespace aureole {

/// Maps the place in which an emitter is written to its place in the scene at a time: a rotation and a translation.
class LightMotion {
public:
  LightMotion() = default;
  virtual ~LightMotion() = default;
  LightMotion(const LightMotion&) = delete;
  LightMotion& operator=(const LightMotion&) = delete;

  virtual bool is_moving() const = 0;
  /// The map at a time [s].
  virtual Transform at(float time) const = 0;
};

/// An emitter without a shape, which is written for its first key frame.
class KeyFramedLight final : public LightMotion {
public:
  explicit KeyFramedLight(const Motion& motion) : motion_(motion), back_(motion.first().inverse()) {}
  bool is_moving() const override { return motion_.is_moving(); }
  Transform at(float time) const override { return motion_.at(double(time)) * back_; }

private:
  const Motion& motion_;
  Transform back_;
};

}  // namespace aureole
