// SPDX-License-Identifier: Apache-2.0
// The axes of a light field by two planes, which the header of its EXR states.
#pragma once

#include <array>
#include <string>

namespace aureole {

/// The string attribute of an EXR header with the axes of a light field.
inline constexpr const char* kLightFieldAttribute = "aureole:lightfield";

/// A rectangle of the plane (s, t), divided into cells with a view each, before a window in the plane (u, v). The views are
/// the parts of one picture, from the top left. Positions are those of a picture: x to the right, y down, from the middle.
struct LightFieldAxes {
  int views_x = 1, views_y = 1;
  int width = 1, height = 1;                       ///< of a view [pixels]
  double aperture_width = 0, aperture_height = 0;  ///< of the rectangle
  double plane_distance = 1, field_width = 1;      ///< of the window

  double field_height() const { return field_width * height / width; }
  /// The middle of a view in the plane (s, t).
  std::array<double, 2> position(int view_x, int view_y) const {
    return {aperture_width * ((view_x + 0.5) / views_x - 0.5),
            aperture_height * ((view_y + 0.5) / views_y - 0.5)};
  }
  /// The text of the attribute.
  std::string text() const;
};

/// Reads the text of the attribute of a picture of that size. Throws Error, which `name` begins, where the text is none or
/// does not fit the picture.
LightFieldAxes parse_light_field_axes(const std::string& text, int picture_width, int picture_height,
                                      const std::string& name);

}  // namespace aureole
