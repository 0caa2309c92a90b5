// SPDX-License-Identifier: Apache-2.0
// Case conversion of ASCII letters, for comparing words regardless of case: keywords of files, names of materials, extensions.
#pragma once

#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>

namespace aureole {

inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = char(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}
inline std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

/// The extension of a file's name in lower case, ".exr" of "picture.EXR"; empty where the name has none.
inline std::string lower_extension(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

/// Whether two words differ at most in the case of their letters.
inline bool equal_without_case(std::string_view a, std::string_view b) {
  return lower_case(a) == lower_case(b);
}

}  // namespace aureole
