// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/lightfield/light_field_axes.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "aureole/core/error.h"

namespace aureole {

std::string LightFieldAxes::text() const {
  return fmt::format(
      "s, t: {} x {} views over {:.9g} x {:.9g}; u, v: {} x {} pixels, width {:.9g} at the distance {:.9g}",
      views_x, views_y, aperture_width, aperture_height, width, height, field_width, plane_distance);
}

LightFieldAxes parse_light_field_axes(const std::string& text, int picture_width, int picture_height,
                                      const std::string& name) {
  LightFieldAxes f;
  if (std::sscanf(text.c_str(),
                  "s, t: %d x %d views over %lf x %lf; u, v: %d x %d pixels, width %lf at the distance %lf",
                  &f.views_x, &f.views_y, &f.aperture_width, &f.aperture_height, &f.width, &f.height,
                  &f.field_width, &f.plane_distance) != 8)
    throw Error(name + ": is no light field: its header lacks the axes that `aureole lightfield` writes");
  constexpr int kMostViews = 4096;
  const auto good = [](double v) { return v > 0 && std::isfinite(v); };
  if (f.views_x < 1 || f.views_y < 1 || f.views_x > kMostViews || f.views_y > kMostViews || f.width < 1 ||
      f.height < 1 || double(f.views_x) * f.width != picture_width ||
      double(f.views_y) * f.height != picture_height || !good(f.aperture_width) || !good(f.aperture_height) ||
      !good(f.field_width) || !good(f.plane_distance))
    throw Error(name + ": the axes of the light field in its header do not fit its " +
                std::to_string(picture_width) + " x " + std::to_string(picture_height) + " pixels");
  return f;
}

}  // namespace aureole
