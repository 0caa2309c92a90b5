// SPDX-License-Identifier: Apache-2.0
// Case conversion for comparing words regardless of case: keywords of files, names of materials.
#pragma once

#include <cctype>
#include <string>

namespace aureole::pigment {

inline std::string lower_case(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}
inline std::string upper_case(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace aureole::pigment
