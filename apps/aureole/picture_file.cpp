// SPDX-License-Identifier: Apache-2.0
#include "picture_file.h"

#include "messages.h"

namespace aureole {

Image read_picture(const std::string& file, ExrAttributes* attributes) {
  Image image = read_image(file, attributes);
  for (const std::string& note : image.notes) tell("note: {}: {}\n", file, note);
  return image;
}

std::filesystem::path default_output(const std::filesystem::path& scene, const std::string& extension) {
  return scene.filename().replace_extension(extension);
}

}  // namespace aureole
