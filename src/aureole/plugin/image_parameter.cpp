// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/image_parameter.h"

#include "aureole/plugin/array.h"
#include "aureole/plugin/properties.h"

namespace aureole {

namespace {

std::string shape_text(const Array& array) {
  std::string text;
  for (const std::size_t n : array.shape()) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text.empty() ? "one number" : text;
}

Image image_of(const Properties& p, const Array& array, std::size_t max_pixels) {
  const std::vector<std::size_t>& shape = array.shape();
  const std::size_t channels = shape.size() == 3 ? shape[2] : 1;
  if ((shape.size() != 2 && shape.size() != 3) || (channels != 1 && channels != 3 && channels != 4) ||
      array.values().empty())
    throw p.error("data",
                  "expected height x width numbers, or 1, 3 or 4 for each pixel, got " + shape_text(array));
  constexpr std::size_t kLongest = 1 << 24;
  if (shape[0] > kLongest || shape[1] > kLongest || shape[0] * shape[1] > max_pixels)
    throw p.error("data", "too many pixels: " + shape_text(array));
  Image image;
  image.height = int(shape[0]), image.width = int(shape[1]);
  image.channels = channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  if (channels == 4) image.channels.push_back("A");
  image.pixels.assign(array.values().begin(), array.values().end());
  return image;
}

}  // namespace

ImageParameter read_image_parameter(const Properties& p, std::size_t max_pixels) {
  const auto data = p.get_object<Array>("data");
  if (data && p.has("filename")) throw p.error("data", "give either filename or data");
  if (data) return {image_of(p, *data, max_pixels), "data"};
  const std::filesystem::path file = p.get_file("filename");
  try {
    return {read_image(file, nullptr, max_pixels), "filename"};
  } catch (const Error& problem) {
    throw p.error("filename", problem.what());
  }
}

ParameterDoc image_file_doc(const std::string& meaning) {
  return {"filename", "file", "", "required, or data", meaning};
}

ParameterDoc image_data_doc() {
  return {"data", "array", "", "none",
          "instead of filename, from Python: an array of linear values, height x width [x 1, 3 or 4]"};
}

}  // namespace aureole
