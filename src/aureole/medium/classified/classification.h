// SPDX-License-Identifier: Apache-2.0
// `Classification`: extinction and colour at the points of a volume, by one transfer function or by one for each class of a
// segmentation mask.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/medium/classified/label_field.h"
#include "aureole/medium/classified/scalar_field.h"
#include "aureole/medium/classified/transfer_function.h"
#include "aureole/medium/classified/transfer_plane.h"

namespace aureole {

class Classification {
public:
  using Sample = TransferFunction::Sample;

  /// Reads the transfer functions and the mask. `field` must outlive this object. Throws located Errors.
  Classification(const Properties& properties, const ScalarField& field);
  static std::vector<ParameterDoc> rows();

  /// Extinction and colour at a point where the volume has the value `value`.
  Sample at(const Vec3& p, float value) const {
    const Class* c = class_at(p);
    if (!c) return {};
    if (c->plane) return at_plane(*c, p, value);
    Sample s = c->function->at(value);
    if (c->gradient_factor && s.extinction > 0) weigh(*c, p, s);
    return s;
  }
  /// Mean extinction and colour of a short segment with the midpoint `p` and the volume's values `from` and
  /// `to` at its ends. A function of value and gradient is evaluated at the midpoint.
  Sample mean(const Vec3& p, float from, float to) const {
    const Class* c = class_at(p);
    if (!c) return {};
    if (c->plane) return at_plane(*c, p, 0.5f * (from + to));
    Sample s = c->function->mean(from, to);
    if (c->gradient_factor && s.extinction > 0) weigh(*c, p, s);
    return s;
  }
  /// The transfer function if there is one that depends on the value alone, for loops along a ray; else null.
  const TransferFunction* only_function() const {
    return !labels_ && classes_[0].function && !classes_[0].gradient_factor ? &*classes_[0].function
                                                                            : nullptr;
  }
  /// Extinction and colour of an isosurface of the value `value` at a point, without the gradient. There must
  /// be no function of value and gradient.
  Sample surface(const Vec3& p, float value) const {
    const Class* c = class_at(p);
    return c ? c->function->at(value) : Sample{};
  }

  /// Name of the parameter that states a function of value and gradient; null if there is none.
  const char* plane_parameter() const { return plane_parameter_; }
  /// The parameter that states the opacities.
  const char* parameter() const { return parameter_; }
  bool has_mask() const { return labels_.has_value(); }
  /// Upper bound of the extinction over all classes where the value lies between `low` and `high`.
  float max_extinction(float low, float high) const;
  /// Upper bounds of the extinction in equal cells of the field's box, x fastest.
  std::vector<float> bounds(const std::array<int, 3>& cells) const;

private:
  /// The transfer function of a class, of the value alone or of the value and its gradient.
  struct Class {
    std::optional<TransferFunction> function;
    /// transfer function whose extinction is a factor of opacity or extinction
    std::optional<TransferFunction> gradient_factor;
    std::optional<TransferPlane> plane;
    bool gives_extinction = false;

    float max_extinction(float low, float high) const {
      return plane ? plane->max_extinction(low, high) : function->max_extinction(low, high);
    }
  };
  static constexpr std::uint8_t kTransparent = LabelField::kMaxClasses - 1;

  const Class* class_at(const Vec3& p) const {
    if (!labels_) return classes_.data();
    const std::uint8_t i = labels_->class_at(p);
    return i == kTransparent ? nullptr : &classes_[i];
  }
  static Class read_class(const Properties& p);
  void read_classes(const Properties& p);
  Sample at_plane(const Class& c, const Vec3& p, float value) const;
  void weigh(const Class& c, const Vec3& p, Sample& s) const;

  const ScalarField& field_;
  float unit_;  ///< thickness of the layer whose opacity is given
  const char* parameter_ = "opacity";
  const char* plane_parameter_ = nullptr;
  std::vector<Class> classes_;
  std::optional<LabelField> labels_;
};

}  // namespace aureole
