// SPDX-License-Identifier: Apache-2.0
// Named colour maps, and named transfer functions for kinds of volumes.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aureole {

/// Colours at equal distances, encoded as sRGB.
struct ColorMap {
  const char* name;
  std::span<const std::array<float, 3>> colors;
};
/// Returns the map of that name, or null.
const ColorMap* find_color_map(std::string_view name);
std::vector<std::string> color_map_names();

/// A transfer function with a name: values and colours encoded as sRGB, and values and opacities of a layer of 1 mm, or
/// of the unit of length of the scene.
struct TransferPreset {
  const char* name;
  bool is_of_millimetres;
  std::span<const std::array<double, 4>> colors;
  std::span<const std::array<double, 2>> opacities;
};
/// Returns the preset of that name, or null.
const TransferPreset* find_transfer_preset(std::string_view name);
std::vector<std::string> transfer_preset_names();

}  // namespace aureole
