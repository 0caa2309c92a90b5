// SPDX-License-Identifier: Apache-2.0
// `ConstantVolume`: a volume with one spectrum at all points.
#pragma once

#include <optional>
#include <utility>

#include "aureole/volume/volume.h"

namespace aureole {

class ConstantVolume : public Volume {
public:
  /// `value` must not vary in space. With `to_box` the volume has a box: a medium with this extinction is
  /// empty outside of the box, although the volume keeps its value there.
  ConstantVolume(const Properties& properties, TexturePtr value, std::optional<Transform> to_box = {})
      : Volume(properties), value_(std::move(value)), to_box_(std::move(to_box)) {}

  Spectrum eval(const Vec3&, const Wavelengths& w) const final { return value_->eval({}, w); }
  float eval_scalar(const Vec3&) const final { return value_->eval_scalar({}); }
  bool is_constant() const final { return !to_box_; }
  std::optional<Transform> to_box() const final { return to_box_; }
  float maximum() const final { return value_->maximum(); }
  float minimum() const final { return value_->minimum(); }
  void note_ends() const final { value_->note_ends(properties(), "value"); }
  Spectrum envelope(const Wavelengths& w) const final { return value_->eval({}, w); }

private:
  TexturePtr value_;
  std::optional<Transform> to_box_;
};

}  // namespace aureole
