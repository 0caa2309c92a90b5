// SPDX-License-Identifier: Apache-2.0
// The parameters `fov`, `fov_axis` and `focal_length` of cameras and projectors.
#pragma once

#include <string>

namespace aureole {

class Properties;

class FieldOfView {
public:
  /// Reads `fov` along `fov_axis`, or `focal_length` (50mm if neither is given), which refers to the diagonal
  /// of 35 mm film.
  explicit FieldOfView(const Properties& properties);

  /// Returns tan(half the horizontal field of view) of a picture whose width is `aspect` times its height.
  double tangent_of_half_width(double aspect) const;

private:
  std::string axis_;
  double focal_length_mm_;
  double degrees_;  ///< field of view; negative if the focal length is used
};

}  // namespace aureole
