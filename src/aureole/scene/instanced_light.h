// SPDX-License-Identifier: Apache-2.0
// A shape that emits, in an instance of its group.
#pragma once

#include "aureole/emitter/light_motion.h"
#include "aureole/shape/instance.h"

namespace aureole {

/// The shape is written in the coordinates of its group. The map is the one by which the ray tracer places the instance.
class InstancedLight final : public LightMotion {
public:
  explicit InstancedLight(const Instance& instance) : instance_(instance) {}
  bool is_moving() const override { return instance_.is_moving(); }
  Transform at(float time) const override { return instance_.to_world_at(time); }

private:
  const Instance& instance_;
};

}  // namespace aureole
