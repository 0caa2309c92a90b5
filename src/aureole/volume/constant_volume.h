// SPDX-License-Identifier: Apache-2.0
// `ConstantVolume`: a volume with one spectrum at all points.
#pragma once

#include <utility>

#include "aureole/volume/volume.h"

namespace aureole {

class ConstantVolume : public Volume {
public:
  /// `value` must not vary in space.
  ConstantVolume(const Properties& properties, TexturePtr value)
      : Volume(properties), value_(std::move(value)) {}

  Spectrum eval(const Vec3&, const Wavelengths& w) const final { return value_->eval({}, w); }
  float eval_scalar(const Vec3&) const final { return value_->eval_scalar({}); }
  bool is_constant() const final { return true; }
  float maximum() const final { return value_->maximum(); }
  float minimum() const final { return value_->minimum(); }
  void note_ends() const final { value_->note_ends(properties(), "value"); }
  Spectrum envelope(const Wavelengths& w) const final { return value_->eval({}, w); }

private:
  TexturePtr value_;
};

}  // namespace aureole
