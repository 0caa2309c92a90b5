// SPDX-License-Identifier: Apache-2.0
// Colour profiles (ICC) of image files, by Little CMS. Used only by image.cpp and the codecs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

/// Returns the ICC profile (version 2) of sRGB: of values that are encoded for display, or of linear ones.
const std::vector<unsigned char>& srgb_profile(bool linear);

/// Returns the profile of three primaries and a white point, each a chromaticity x, y, whose encoded values v stand for
/// v^gamma. Throws Error if they span no colours.
std::vector<unsigned char> profile_of_primaries(const std::array<double, 8>& red_green_blue_white,
                                                double gamma);

/// Converts the colours of an image (channels R, G, B or Y) from an ICC profile to sRGB, relative to white, and returns
/// a note of it; empty if the profile is sRGB's. Values stay encoded where the image is. Colours outside sRGB have values
/// below 0 or above 1. A profile that is damaged or for other channels leaves the image as it is, which the note says.
std::string convert_from_profile(Image& image, std::span<const unsigned char> profile);

}  // namespace aureole
