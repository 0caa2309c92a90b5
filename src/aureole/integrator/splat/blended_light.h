// SPDX-License-Identifier: Apache-2.0
// Light of colours that were blended along a ray, and the parameter of the colour behind them.
#pragma once

#include <optional>

#include "aureole/core/image.h"
#include "aureole/math/vec.h"
#include "aureole/medium/classified/transfer_function.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// Reads red, green and blue of the parameter "background", none of them negative. Throws a located Error.
inline std::optional<Vec3> read_background(const Properties& p) {
  if (!p.has("background")) return {};
  const std::vector<double> rgb = get_number_list(p, "background");
  if (rgb.size() != 3)
    throw p.error("background", "expected three numbers, red, green and blue, such as \"1, 1, 1\"");
  if (!(rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0)) throw p.error("background", "must not be negative");
  return Vec3{float(rgb[0]), float(rgb[1]), float(rgb[2])};
}

/// Returns the radiance of a blended colour in units of D65, as that of an <rgb> emitter. Encoded colours (sRGB) are decoded:
/// with a background after it was blended behind them, else after the division by their opacity.
inline Spectrum blended_light(const float color[3], float transmittance,
                              const std::optional<Vec3>& background, bool is_encoded, const Spectrum& nm,
                              const Spectrum& d65) {
  float rgb[3];
  const float opacity = 1 - transmittance;
  for (int k = 0; k < 3; ++k) {
    rgb[k] = color[k];
    if (background) {
      rgb[k] += transmittance * (*background)[k];
      if (is_encoded) rgb[k] = srgb_decode(rgb[k]);
    } else if (is_encoded && opacity > 0) {
      rgb[k] = opacity * srgb_decode(rgb[k] / opacity);
    }
  }
  return ColorBasis(nm).eval(ColorWeights::of_linear_rgb(rgb[0], rgb[1], rgb[2])) * d65;
}

}  // namespace aureole
