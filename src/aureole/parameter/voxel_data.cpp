// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/voxel_data.h"

#include <fmt/format.h>
#include <immintrin.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "aureole/core/input_file.h"

namespace aureole {

namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

/// Upper bound of a size, far beyond any grid that fits into memory; products of three such sizes do not
/// overflow.
constexpr std::int64_t kLongest = 1 << 20;

struct Header {
  char magic[3];
  std::uint8_t version;
  std::int32_t encoding, size[3], channels;
  float box[6];
};
static_assert(sizeof(Header) == 48);

std::string printable(const char* letters, int count) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += letters[i] >= 32 && letters[i] < 127 ? std::string(1, letters[i])
                                                 : fmt::format("\\x{:02x}", std::uint8_t(letters[i]));
  return text;
}

std::size_t bytes_per_number(int encoding) {
  switch (encoding) {
    case 1:
      return 4;
    case 2:
      return 2;
    case 3:
      return 1;
    case 4:
      throw Error("has encoding 4 (directions in two bytes), which is not supported");
    default:
      throw Error(
          fmt::format("has encoding {}; 1 (float32), 2 (float16) and 3 (bytes) are supported", encoding));
  }
}

void check(const Header& h) {
  if (std::memcmp(h.magic, "VOL", 3) != 0)
    throw Error(
        fmt::format("is no .vol file: it begins with \"{}\" and not with \"VOL\"", printable(h.magic, 3)));
  if (h.version != 3) throw Error(fmt::format("has version {} of the format; 3 is supported", h.version));
  for (const std::int32_t n : h.size)
    if (n < 1 || n > kLongest)
      throw Error(fmt::format("has {} x {} x {} voxels; each size lies in [1, {}]", h.size[0], h.size[1],
                              h.size[2], kLongest));
  if (h.channels < 1 || h.channels > 64)
    throw Error(fmt::format("has {} numbers in a voxel; 1 to 64 are possible", h.channels));
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(h.box[i]) || !std::isfinite(h.box[3 + i]))
      throw Error("has a bounding box that is not finite");
    if (!(h.box[i] < h.box[3 + i]))
      throw Error(fmt::format("has an inverted or empty bounding box: along {} from {} to {}", "xyz"[i],
                              h.box[i], h.box[3 + i]));
  }
}

}  // namespace

VoxelData read_vol(const std::filesystem::path& file) {
  InputFile in(file);
  const std::uint64_t file_bytes = in.size();
  Header h;
  if (file_bytes < sizeof h)
    throw Error(
        fmt::format("is too short for a .vol file: {} bytes, the header alone has {}", file_bytes, sizeof h));
  in.read(&h, sizeof h);
  check(h);
  VoxelData data;
  for (std::size_t i = 0; i < 3; ++i)
    data.size[i] = h.size[i], data.lower[i] = double(h.box[i]), data.upper[i] = double(h.box[3 + i]);
  data.channels = h.channels;
  // The count is compared with the size of the file before memory is allocated, since a damaged header may
  // state any number.
  const std::uint64_t count = std::uint64_t(h.size[0]) * std::uint64_t(h.size[1]) * std::uint64_t(h.size[2]);
  const std::uint64_t bytes_per_voxel = bytes_per_number(h.encoding) * std::uint64_t(h.channels);
  const std::uint64_t present = file_bytes - sizeof h;
  if (count > present / bytes_per_voxel)
    throw Error(fmt::format(
        "is truncated: {} x {} x {} voxels of {} bytes need {} bytes, but {} follow the "
        "header",
        h.size[0], h.size[1], h.size[2], bytes_per_voxel, double(count) * double(bytes_per_voxel), present));
  const std::size_t numbers = std::size_t(count) * std::size_t(h.channels);
  data.values.resize(numbers);
  if (h.encoding == 1) {
    in.read(data.values.data(), numbers * 4);
  } else if (h.encoding == 2) {
    std::vector<std::uint16_t> halves(numbers);
    in.read(halves.data(), numbers * 2);
    for (std::size_t i = 0; i < numbers; ++i) data.values[i] = _cvtsh_ss(halves[i]);
  } else {
    std::vector<std::uint8_t> bytes(numbers);
    in.read(bytes.data(), numbers);
    for (std::size_t i = 0; i < numbers; ++i) data.values[i] = float(bytes[i]) * (1.f / 255);
  }
  return data;
}

VoxelData voxels_of_array(const Array& array) {
  const std::vector<std::size_t>& shape = array.shape();
  std::string text;
  for (const std::size_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  bool fits = (shape.size() == 3 || shape.size() == 4) && !array.values().empty();
  for (const std::size_t n : shape) fits &= n >= 1 && n <= std::size_t(kLongest);
  if (!fits)
    throw Error("expected depth x height x width numbers, or several for each voxel, got " +
                (text.empty() ? "one number" : text));
  VoxelData data;
  data.size = {int(shape[2]), int(shape[1]), int(shape[0])};
  data.channels = shape.size() == 4 ? int(shape[3]) : 1;
  data.values.assign(array.values().begin(), array.values().end());
  return data;
}

void check_finite(const VoxelData& data) {
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    if (std::isfinite(data.values[i])) continue;
    const std::size_t voxel = i / std::size_t(data.channels), nx = std::size_t(data.size[0]),
                      ny = std::size_t(data.size[1]);
    throw Error(fmt::format("holds {} at x = {}, y = {}, z = {}; the numbers must be finite", data.values[i],
                            voxel % nx, voxel / nx % ny, voxel / nx / ny));
  }
}

VoxelData read_voxels(const Properties& p, const char* array) {
  const auto given = p.get_object<Array>(array);
  if (given && p.has("filename")) throw p.error(array, std::string("give either filename or ") + array);
  std::string file;
  try {
    if (!given) file = p.get_file("filename").string();
    VoxelData data = given ? voxels_of_array(*given) : read_vol(file);
    check_finite(data);
    return data;
  } catch (const Error& problem) {
    if (!given && file.empty()) throw;  // get_file has located the error already
    throw p.error(voxels_parameter(p, array),
                  given ? problem.message() : "\"" + file + "\" " + problem.message());
  }
}

}  // namespace aureole
