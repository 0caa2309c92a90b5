// SPDX-License-Identifier: Apache-2.0
// Tone mapping of pictures with a large range of brightness.
#pragma once

#include <string>

#include "aureole/core/image.h"

namespace aureole {

/// asinh(compression y)/asinh(compression) of the luminance y times 2^exposure; white is y = 1, and compression 0
/// leaves y as it is. The hue is kept.
struct Tone {
  double exposure = 0;  ///< [stops]
  double compression = 0;

  /// "asinh", "asinh:100" or "asinh:100:-2": compression (50 without) and exposure. Throws Error.
  static Tone parse(const std::string& text);
};

/// Linear sRGB (channels R, G, B, or one grey channel) for display, encoded. Colours outside of the display's gamut
/// lose saturation, not hue.
Image toned(const Image& picture, const Tone& tone);

}  // namespace aureole
