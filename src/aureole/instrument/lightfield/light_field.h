// SPDX-License-Identifier: Apache-2.0
// Light fields by two planes: new views and refocused pictures by resampling.
#pragma once

#include <array>
#include <map>
#include <string>

#include "aureole/core/image.h"

namespace aureole {

/// The views of a sensor `lightfield` in one picture, from the top left. Positions are those of a picture: x to the right,
/// y down, from the middle.
struct LightField {
  Image mosaic;  ///< linear channels
  int views_x = 1, views_y = 1;
  double aperture_width = 0, aperture_height = 0;  ///< of the plane (s, t)
  double plane_distance = 1, field_width = 1;      ///< of the window in the plane (u, v)

  int width() const { return mosaic.width / views_x; }
  int height() const { return mosaic.height / views_y; }
  /// The middle of a view in the plane (s, t).
  std::array<double, 2> position(int view_x, int view_y) const;
};

/// The axes of a light field for the header of its EXR ("aureole:lightfield"), and back. The second throws Error, which
/// `name` begins, where the text is none or does not fit the picture.
std::string light_field_axes(const LightField& field);
LightField light_field_of(Image picture, const std::string& axes, const std::string& name);

/// The picture of a camera with a round synthetic aperture of that diameter about (x, y) of the plane (s, t), in focus at
/// the distance `focus`: the mean over the views in the aperture, bilinear in (u, v) (Ng 2005, "Fourier slice photography",
/// equation 8). `diameter` 0: the view nearest to (x, y) of the four around, by bilinear interpolation between them, each
/// resampled for objects at the distance `focus` (Levoy & Hanrahan 1996, section 4). Parts outside of a view's window do not
/// count. Throws Error where no view lies in the aperture.
Image light_field_picture(const LightField& field, double x, double y, double diameter, double focus);

}  // namespace aureole
