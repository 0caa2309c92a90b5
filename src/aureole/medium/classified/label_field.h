// SPDX-License-Identifier: Apache-2.0
// `LabelField`: a segmentation mask, whole numbers on a grid of its own that say to which class a point belongs. Labels are
// not interpolated.
#pragma once

#include <bitset>
#include <cstdint>
#include <functional>
#include <vector>

#include "aureole/medium/classified/scalar_field.h"

namespace aureole {

class Properties;

class LabelField {
public:
  static constexpr int kMaxLabel = 65535;
  static constexpr std::size_t kMaxClasses = 256;
  using Classes = std::bitset<kMaxClasses>;

  /// Reads the volume of the parameter `name`, whose numbers must be whole and lie in [0, kMaxLabel]. `class_of` has the
  /// class of each label. Throws located Errors.
  LabelField(const Properties& properties, const char* name, std::vector<std::uint8_t> class_of);

  /// The class of the voxel that holds a point in world space; outside of the mask the class of the label 0.
  std::uint8_t class_at(const Vec3& p) const {
    const Vec3 i = field_.index_of(p);
    int at[3];
    for (int k = 0; k < 3; ++k) {
      const float c = i[k] + 0.5f;
      const int n = field_.size()[std::size_t(k)];
      if (!(c >= 0 && c <= float(n))) return class_of_[0];
      at[k] = c < float(n) ? int(c) : n - 1;
    }
    return class_of_[std::size_t(field_.voxel(at[0], at[1], at[2]))];
  }
  /// The classes in the part of the box [0, 1]^3 of `to_box` between two corners.
  Classes classes_in(const Transform& from_box, const Vec3& lower, const Vec3& upper) const;
  /// Number of voxels with each label.
  const std::vector<std::size_t>& counts() const { return counts_; }

private:
  ScalarField field_;
  std::vector<std::uint8_t> class_of_;
  std::vector<std::size_t> counts_;
};

}  // namespace aureole
