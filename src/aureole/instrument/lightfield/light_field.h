// SPDX-License-Identifier: Apache-2.0
// Light fields by two planes: new views and refocused pictures by resampling.
#pragma once

#include <string>

#include "aureole/core/image.h"
#include "aureole/film/film.h"
#include "aureole/parameter/lightfield/light_field_axes.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// The views of a sensor `lightfield` in one picture.
struct LightField {
  LightFieldAxes axes;
  Image mosaic;  ///< linear channels
};

/// A picture with the axes that its header states. Throws Error as `parse_light_field_axes`.
LightField light_field_of(Image picture, const std::string& axes, const std::string& name);

/// The axes of a sensor `lightfield` with that film. Throws Error located at another sensor, or at a film with a crop, which
/// does not hold all views.
LightFieldAxes light_field_axes(const Properties& sensor, const Film& film);

/// The picture of a camera with a round synthetic aperture of that diameter about (x, y) of the plane (s, t), in focus at
/// the distance `focus`: the mean over the views in the aperture, bilinear in (u, v) (Ng 2005, "Fourier slice photography",
/// equation 8). `diameter` 0: the view nearest to (x, y) of the four around, by bilinear interpolation between them, each
/// resampled for objects at the distance `focus` (Levoy & Hanrahan 1996, section 4). Parts outside of a view's window do not
/// count. Throws Error where no view lies in the aperture.
Image light_field_picture(const LightField& field, double x, double y, double diameter, double focus);

}  // namespace aureole
