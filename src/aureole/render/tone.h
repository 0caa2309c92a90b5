// SPDX-License-Identifier: Apache-2.0
// Tone mapping of pictures with a high dynamic range.
#pragma once

#include <string>

#include "aureole/core/image.h"

namespace aureole {

/// Maps the luminance y times 2^exposure to asinh(compression y)/asinh(compression). White is y = 1, and
/// compression 0 leaves y unchanged. The hue is kept.
struct Tone {
  double exposure = 0;  ///< exposure [stops]
  double compression = 0;

  /// Parses "asinh", "asinh:100" or "asinh:100:-2": compression (default 50) and exposure. Throws Error.
  static Tone parse(const std::string& text);
};

/// Tone-maps linear sRGB (channels R, G, B, or one grey channel) and encodes it for display. Colours outside
/// the display's gamut lose saturation, not hue.
Image toned(const Image& picture, const Tone& tone);

}  // namespace aureole
