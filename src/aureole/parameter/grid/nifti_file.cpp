// SPDX-License-Identifier: Apache-2.0
// NIfTI-1 and NIfTI-2 (nifti.nimh.nih.gov): a binary header, the numbers behind it or in a file .img beside it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/core/letter_case.h"
#include "aureole/parameter/grid/grid_reader.h"

namespace aureole::grid_reader {

namespace {

/// Fields of the header at their offsets in bytes, in the file's byte order.
class NiftiHeader {
public:
  NiftiHeader(std::span<const std::byte> bytes, bool is_swapped, bool is_second)
      : bytes_(bytes), is_swapped_(is_swapped), is_second_(is_second) {}

  template <class T>
  T at(std::size_t offset) const {
    std::byte copy[sizeof(T)];
    std::memcpy(copy, bytes_.data() + offset, sizeof(T));
    if (is_swapped_) std::reverse(copy, copy + sizeof(T));
    T value;
    std::memcpy(&value, copy, sizeof value);
    return value;
  }
  /// Reads a number that is float in version 1 and double in version 2.
  double real(std::size_t first, std::size_t second, std::size_t i = 0) const {
    return is_second_ ? at<double>(second + 8 * i) : double(at<float>(first + 4 * i));
  }
  std::int64_t dim(std::size_t i) const {
    return is_second_ ? at<std::int64_t>(16 + 8 * i) : at<std::int16_t>(40 + 2 * i);
  }
  int code(std::size_t first, std::size_t second) const {
    return is_second_ ? at<std::int32_t>(second) : at<std::int16_t>(first);
  }
  double pixdim(std::size_t i) const { return real(76, 104, i); }
  int datatype() const { return at<std::int16_t>(is_second_ ? 12 : 70); }
  std::int64_t offset() const { return is_second_ ? at<std::int64_t>(168) : std::int64_t(first_offset()); }
  double slope() const { return real(112, 176); }
  double intercept() const { return real(116, 184); }
  int units() const { return is_second_ ? at<std::int32_t>(500) : int(at<std::uint8_t>(123)); }
  int qform() const { return code(252, 344); }
  int sform() const { return code(254, 348); }
  // components b, c, d of the quaternion, then the offsets
  double quaternion(std::size_t i) const { return real(256, 352, i); }
  double srow(std::size_t row, std::size_t i) const { return real(280, 400, 4 * row + i); }
  std::string_view magic() const {
    return {reinterpret_cast<const char*>(bytes_.data()) + (is_second_ ? 4 : 344), 4};
  }

private:
  double first_offset() const {
    const double v = double(at<float>(108));
    return v >= 0 && v < 1e15 ? v : -1;
  }
  std::span<const std::byte> bytes_;
  bool is_swapped_, is_second_;
};

/// Returns the type and the numbers per voxel for a NIfTI code.
std::pair<ScalarType, int> nifti_type_of(int code) {
  switch (code) {
    case 2:
      return {ScalarType::uint8, 1};
    case 4:
      return {ScalarType::int16, 1};
    case 8:
      return {ScalarType::int32, 1};
    case 16:
      return {ScalarType::float32, 1};
    case 64:
      return {ScalarType::float64, 1};
    case 128:
      return {ScalarType::uint8, 3};  // RGB
    case 256:
      return {ScalarType::int8, 1};
    case 512:
      return {ScalarType::uint16, 1};
    case 768:
      return {ScalarType::uint32, 1};
    case 1024:
      return {ScalarType::int64, 1};
    case 1280:
      return {ScalarType::uint64, 1};
    case 2304:
      return {ScalarType::uint8, 4};  // code of RGBA
    default:
      throw Error(
          fmt::format("has numbers of the type {}; 2 (uint8), 4 (int16), 8 (int32), 16 (float32), 64 "
                      "(float64), 128 (RGB), 256 (int8), 512 (uint16), 768 (uint32), 1024 (int64), "
                      "1280 (uint64) and 2304 (RGBA) are known",
                      code));
  }
}

using Columns = std::array<std::array<double, 3>, 3>;

/// Columns of the transform of the header's quaternion, method 2 of nifti1.h.
Columns quaternion_columns(const NiftiHeader& h, const std::array<double, 3>& step) {
  double b = h.quaternion(0), c = h.quaternion(1), d = h.quaternion(2);
  const double sum = b * b + c * c + d * d;
  if (!(sum <= 1 + 1e-5))
    throw Error(fmt::format("has the quaternion ({}, {}, {}), whose squares add to more than 1", b, c, d));
  double a = 0;
  if (sum > 1 - 1e-7) {
    const double s = 1 / std::sqrt(sum);
    b *= s, c *= s, d *= s;
  } else
    a = std::sqrt(1 - sum);
  const double flip = h.pixdim(0) < 0 ? -1 : 1;
  const double r[3][3] = {{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
                          {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
                          {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
  Columns columns;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) columns[k][i] = r[i][k] * step[k] * (k == 2 ? flip : 1);
  return columns;
}

void set_place(ScalarGrid& grid, const NiftiHeader& h, const ScalarGridOptions& options) {
  Columns columns{};
  std::array<double, 3> origin{0, 0, 0}, step{};
  for (std::size_t k = 0; k < 3; ++k) step[k] = std::abs(h.pixdim(k + 1));
  if (h.sform() > 0) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) columns[k][i] = h.srow(i, k);
      origin[i] = h.srow(i, 3);
    }
  } else if (h.qform() > 0) {
    columns = quaternion_columns(h, step);
    for (std::size_t i = 0; i < 3; ++i) origin[i] = h.quaternion(3 + i);
  } else {
    for (std::size_t k = 0; k < 3; ++k) columns[k][k] = step[k];
    grid.notes.push_back(
        "states no orientation (sform_code and qform_code are 0): its axes are taken as x, y, z "
        "and its first voxel as the origin");
  }
  grid.spacing_is_stated = true;
  const int unit = h.units() & 7;
  if (unit > 3)
    throw Error(
        fmt::format("has the unit of length {}; 0 (unknown), 1 (m), 2 (mm) and 3 (um) are known", unit));
  if (unit > 0) grid.unit_is_stated = true, grid.unit_m = std::array{1., 1e-3, 1e-6}[std::size_t(unit - 1)];
  place(grid, columns, origin, "RAS", options);
}

/// Returns the file that contains the numbers of a separate header file.
Path image_beside(const Path& file) {
  Path base = file;
  const bool is_packed = lower_extension(base) == ".gz";
  if (is_packed) base.replace_extension();
  if (lower_extension(base) != ".hdr")
    throw Error("is a header whose numbers lie in a file .img, but its own name does not end in .hdr");
  for (const bool packed : {is_packed, !is_packed})
    for (const char* extension : {".img", ".IMG"}) {
      Path image = base;
      image.replace_extension(extension);
      if (packed) image += extension[1] == 'i' ? ".gz" : ".GZ";
      std::error_code ignored;
      if (std::filesystem::exists(image, ignored)) return image;
    }
  return base.replace_extension(".img");
}

bool is_packed(const SharedBytes& bytes) {
  return bytes.size() >= 2 && bytes.bytes[0] == std::byte(0x1f) && bytes.bytes[1] == std::byte(0x8b);
}

}  // namespace

ScalarGrid read_nifti(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options) {
  const SharedBytes start = is_packed(bytes) ? inflate_bytes(bytes, 540) : bytes;
  if (start.size() < 348) throw Error("is too short for a header of NIfTI, which has 348 bytes");
  bool is_swapped = false;
  std::int32_t length = 0;
  for (const bool swapped : {false, true}) {
    length = NiftiHeader(start.bytes, swapped, false).at<std::int32_t>(0);
    is_swapped = swapped;
    if (length == 348 || length == 540) break;
  }
  if (length != 348 && length != 540)
    throw Error("is compressed by gzip and holds no NIfTI, the one format of volumes that is read so");
  const bool is_second = length == 540;
  if (is_second && start.size() < 540)
    throw Error("is too short for a header of NIfTI-2, which has 540 bytes");
  const NiftiHeader h(start.bytes, is_swapped, is_second);
  const std::string_view magic = h.magic();
  const char digit = is_second ? '2' : '1';
  const bool is_single = magic[0] == 'n' && magic[1] == '+' && magic[2] == digit;
  const bool is_pair = magic[0] == 'n' && magic[1] == 'i' && magic[2] == digit;
  if (!is_single && !is_pair)
    throw Error(
        "has a header of 348 bytes without the mark \"n+1\" or \"ni1\": ANALYZE 7.5, which states no "
        "orientation, is not supported");
  ScalarGrid grid;
  grid.format = is_second ? "NIfTI-2" : "NIfTI-1";
  grid.has_transform = true;
  grid.is_swapped = is_swapped;
  const auto [type, channels] = nifti_type_of(h.datatype());
  grid.type = type;
  const std::int64_t dimensions = h.dim(0);
  if (dimensions < 3 || dimensions > 7)
    throw Error(
        fmt::format("has {} dimensions; a volume has 3, or 4 and 5 with frames and components", dimensions));
  std::vector<GridAxis> axes;
  if (channels > 1) axes.push_back({channels, 'c'});
  for (std::size_t i = 1; i <= std::size_t(dimensions); ++i) {
    const std::int64_t n = h.dim(i);
    if (i > 3 && n == 1) continue;
    if (i > 5 || (i == 5 && channels > 1))
      throw Error(fmt::format("has {} entries along its dimension {}, which is not supported", n, i));
    axes.push_back({n, "xyztc"[i - 1]});
  }
  std::vector<std::int64_t> sizes;
  for (const GridAxis& a : axes) sizes.push_back(a.size);
  const std::uint64_t count = count_of(sizes, type);
  if (channels == 1) {
    const double slope = h.slope(), intercept = h.intercept();
    if (std::isfinite(slope) && slope != 0) {
      if (!std::isfinite(intercept))
        throw Error(fmt::format("has scl_inter {}; a finite number is expected", intercept));
      grid.slope = slope, grid.intercept = intercept;
    }
  }
  if (h.offset() < 0) throw Error("has a vox_offset that is no position in the file");
  SharedBytes data = bytes;
  if (is_pair) {
    const Path image = image_beside(file);
    try {
      data = map_file(image);
    } catch (const Error& problem) {
      throw at_line(problem, 0);
    }
    grid.further_files.push_back(image);
  } else if (h.offset() < length)
    throw Error(
        fmt::format("has the vox_offset {}, which lies in the header of {} bytes", h.offset(), length));
  grid.numbers = decode(data, is_packed(data) ? Encoding::gzip : Encoding::raw, h.offset(), count, type);
  arrange(grid, axes, options);
  set_place(grid, h, options);
  return grid;
}

}  // namespace aureole::grid_reader
