// SPDX-License-Identifier: Apache-2.0
// Portable float maps: "PF" (RGB) or "Pf" (grey), width, height, a scale whose sign encodes the byte order
// (negative: little-endian), then 32-bit floats, the bottom row first.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"
#include "aureole/core/parallel.h"

namespace aureole::codec {

namespace {

static_assert(std::endian::native == std::endian::little);

/// Words of a header, separated by white space; a single white-space character ends the last word.
class Words {
public:
  explicit Words(Bytes bytes) : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}
  std::string_view next() {
    constexpr std::string_view spaces = " \t\r\n";
    const std::size_t begin = text_.find_first_not_of(spaces, position_);
    const std::size_t end = begin == text_.npos ? text_.npos : text_.find_first_of(spaces, begin);
    if (end == text_.npos) throw Error("the file is truncated");
    position_ = end;
    return text_.substr(begin, end - begin);
  }
  template <class T>
  T number() {
    const std::string_view word = next();
    T value{};
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (problem != std::errc() || end != word.data() + word.size())
      throw Error("damaged PFM: \"" + std::string(word.substr(0, 40)) + "\" is not a number");
    return value;
  }
  std::size_t end() const { return position_ + 1; }

private:
  std::string_view text_;
  std::size_t position_ = 0;
};

}  // namespace

Image read_pfm(Bytes bytes, std::size_t max_pixels) {
  Words words(bytes);
  const int channels = words.next() == "PF" ? 3 : 1;
  const auto width = words.number<long long>(), height = words.number<long long>();
  const double scale = words.number<double>();
  if (scale == 0 || !std::isfinite(scale)) throw Error("damaged PFM: its scale is not a number other than 0");
  check_size(width, height, channels, max_pixels, bytes.size(), 1);
  const std::size_t row = std::size_t(width) * std::size_t(channels);
  const Bytes pixels = bytes.subspan(words.end());
  if (pixels.size() < row * std::size_t(height) * sizeof(float)) throw Error("the file is truncated");
  Image image;
  image.width = int(width), image.height = int(height);
  image.channels = channel_names(channels);
  image.format = "PFM, 32-bit float";
  image.pixels.resize(row * std::size_t(height));
  const float factor = float(std::abs(scale));
  for_rows(image.width, image.height, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      float* line = image.pixels.data() + y * row;
      std::memcpy(line, pixels.data() + (std::size_t(height) - 1 - y) * row * sizeof(float),
                  row * sizeof(float));
      if (scale > 0)
        for (std::size_t i = 0; i < row; ++i)
          line[i] = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(line[i])));
      if (factor != 1)
        for (std::size_t i = 0; i < row; ++i) line[i] *= factor;
    }
  });
  return image;
}

std::vector<char> encode_pfm(const Image& image) {
  const std::string header = (image.channels.size() == 3 ? "PF\n" : "Pf\n") + std::to_string(image.width) +
                             " " + std::to_string(image.height) + "\n-1.0\n";
  std::vector<char> bytes(header.begin(), header.end());
  const std::size_t row = std::size_t(image.width) * image.channels.size();
  for (int y = image.height; y-- > 0;) {
    const char* first = reinterpret_cast<const char*>(image.pixels.data() + std::size_t(y) * row);
    bytes.insert(bytes.end(), first, first + row * sizeof(float));
  }
  return bytes;
}

}  // namespace aureole::codec
