// SPDX-License-Identifier: Apache-2.0
// Colour profiles (ICC) of image files, by Little CMS. Used only by image.cpp and the codecs.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

/// Chromaticities x, y of red, green, blue and white.
using Primaries = std::array<double, 8>;
/// Primaries and white point of sRGB (IEC 61966-2-1).
inline constexpr Primaries kSrgbPrimaries = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};

/// Returns the ICC profile (version 2) of sRGB: of values that are encoded for display, or of linear ones.
const std::vector<unsigned char>& srgb_profile(bool linear);

/// Returns the profile of primaries and a white point whose encoded values v stand for v^gamma. Throws Error if they span no colours.
std::vector<unsigned char> profile_of_primaries(const Primaries& primaries, double gamma);

/// Converts the colours of an image (channels R, G, B or Y) from an ICC profile to sRGB, relative to white, and returns
/// a note of it; empty if the profile is sRGB's. Values stay encoded where the image is. Colours outside sRGB have values
/// below 0 or above 1. A profile that is damaged or for other channels leaves the image as it is, which the note says.
std::string convert_from_profile(Image& image, std::span<const unsigned char> profile);

}  // namespace aureole
