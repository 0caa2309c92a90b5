// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/field_of_view.h"

#include <cmath>

#include "aureole/core/units.h"
#include "aureole/plugin/properties.h"

namespace aureole {

namespace {

double focal_length_mm(const Properties& p) {
  std::string text = p.get_string("focal_length", "50mm");
  if (text.ends_with("mm")) text.resize(text.size() - 2);
  double mm = 0;
  try {
    mm = parse_number(text);
  } catch (const Error&) {
  }
  if (!(mm > 0)) throw p.error("focal_length", "expected a length such as \"50mm\"");
  return mm;
}

}  // namespace

FieldOfView::FieldOfView(const Properties& p)
    : axis_(p.get_choice("fov_axis", "x", {"x", "y", "diagonal", "smaller", "larger"})),
      // Both parameters are always read, so that both are checked and count as read.
      focal_length_mm_(focal_length_mm(p)),
      degrees_(p.get_float("fov", -1, {1e-4, 179.9999})) {
  if (p.has("fov") && p.has("focal_length"))
    throw p.error("focal_length", "give either \"fov\" or \"focal_length\"");
}

double FieldOfView::tangent_of_half_width(double aspect) const {
  const double of_diagonal = 1 / std::sqrt(1 + 1 / (aspect * aspect));
  if (degrees_ < 0) return std::hypot(36.0, 24.0) / (2 * focal_length_mm_) * of_diagonal;
  const double t = std::tan(0.5 * degrees_ * M_PI / 180);
  if (axis_ == "y" || (axis_ == "smaller" && aspect > 1) || (axis_ == "larger" && aspect < 1))
    return t * aspect;
  return axis_ == "diagonal" ? t * of_diagonal : t;
}

}  // namespace aureole
