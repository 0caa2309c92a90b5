// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/grid/scalar_grid.h"

#include <fmt/format.h>
#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <type_traits>

#include "aureole/core/letter_case.h"
#include "aureole/core/parallel.h"
#include "aureole/parameter/grid/grid_reader.h"
#include "aureole/parameter/voxel_data.h"

namespace aureole {

namespace {

struct TypeRow {
  std::size_t bytes;
  const char* name;
};
constexpr TypeRow kTypes[] = {{1, "int8"},    {1, "uint8"},   {2, "int16"},  {2, "uint16"},
                              {4, "int32"},   {4, "uint32"},  {8, "int64"},  {8, "uint64"},
                              {2, "float16"}, {4, "float32"}, {8, "float64"}};

template <class T>
T loaded(const std::byte* at, bool is_swapped) {
  std::byte bytes[sizeof(T)];
  if (is_swapped)
    std::reverse_copy(at, at + sizeof(T), bytes);
  else
    std::memcpy(bytes, at, sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

bool is_floating(ScalarType type) { return type >= ScalarType::float16; }

/// Calls visit(x, y, z, channel, row of values) for all rows along x, in parallel.
template <class Visit>
void for_each_row(const ScalarGrid& grid, const Visit& visit) {
  const std::size_t ny = std::size_t(grid.size[1]), nc = std::size_t(grid.channels);
  for_ranges(
      std::size_t(grid.size[2]) * ny * nc,
      [&](std::size_t begin, std::size_t end) {
        std::vector<float> row(std::size_t(grid.size[0]));
        for (std::size_t i = begin; i < end; ++i) {
          const int c = int(i % nc), y = int(i / nc % ny), z = int(i / nc / ny);
          grid.read_row(0, y, z, c, row);
          visit(y, z, c, row);
        }
      },
      64);
}

std::string printable(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    const int c = int(b);
    text += c >= 32 && c < 127 ? std::string(1, char(c)) : fmt::format("\\x{:02x}", c);
  }
  return text;
}

using Reader = ScalarGrid (*)(const std::filesystem::path&, const SharedBytes&, const ScalarGridOptions&);

ScalarGrid read_vol_grid(const std::filesystem::path& file, const SharedBytes&,
                         const ScalarGridOptions& options) {
  ScalarGrid grid = grid_of_voxels(std::make_shared<const VoxelData>(read_vol(file)));
  grid.format = ".vol";
  grid.has_transform = grid.spacing_is_stated = true;
  if (options.unit_m) grid.unit_m = *options.unit_m;
  return grid;
}

/// Returns the reader of the format that the first bytes indicate, or null.
Reader reader_of(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  using namespace grid_reader;
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()),
                               std::min<std::size_t>(bytes.size(), 4096));
  if (start.starts_with("NRRD")) return read_nrrd;
  if (start.starts_with("VOL") || lower_extension(file) == ".vol") return read_vol_grid;
  if (start.starts_with("\x93NUMPY")) return read_npy;
  if (start.starts_with(std::string_view("II*\0", 4)) || start.starts_with(std::string_view("MM\0*", 4)) ||
      start.starts_with(std::string_view("II+\0", 4)) || start.starts_with(std::string_view("MM\0+", 4)))
    return read_tiff_stack;
  if (start.starts_with("\x1f\x8b")) return read_nifti;
  if (start.size() >= 4)
    for (const bool is_swapped : {false, true}) {
      const auto header = loaded<std::int32_t>(bytes.data(), is_swapped);
      if (header == 348 || header == 540) return read_nifti;
    }
  if (start.find("<VTKFile") != start.npos) return read_vti;
  if (start.find('\0') == start.npos || lower_extension(file) == ".mha")
    for (const char* key : {"ObjectType", "NDims", "DimSize"})
      if (const auto at = start.find(key); at != start.npos && (at == 0 || start[at - 1] == '\n'))
        return read_meta_image;
  return nullptr;
}

/// Says of a known format that is not read how to convert it; null for others.
const char* advice_on_other_format(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.size() > 132 && text.substr(128, 4) == "DICM")
    return "is DICOM, which is not read: convert the series to NRRD or NIfTI, as dcm2niix, 3D Slicer and ITK-SNAP do";
  if (text.starts_with("# vtk DataFile"))
    return "is a legacy file of VTK, which is not read: save its grid as .vti";
  if (text.starts_with("PK\x03\x04"))
    return "is a ZIP archive, such as numpy's .npz, which is not read: save the array by numpy.save as .npy";
  if (text.starts_with("\x89HDF") || text.starts_with("CDF"))
    return "is HDF5 or NetCDF, which is not read: save its array by numpy.save as .npy, or as NRRD";
  return nullptr;
}

}  // namespace

std::size_t bytes_of(ScalarType type) { return kTypes[std::size_t(type)].bytes; }
const char* name_of(ScalarType type) { return kTypes[std::size_t(type)].name; }

float ScalarGrid::value(int x, int y, int z, int channel) const {
  if (is_swapped || slope != 1 || intercept != 0 || type == ScalarType::float16) {
    float v;
    read_row(x, y, z, channel, {&v, 1});
    return v;
  }
  const std::int64_t number = x * strides[0] + y * strides[1] + z * strides[2] + channel * strides[3];
  float v = 0;
  grid_reader::with_type(type, [&](auto example) {
    using T = decltype(example);
    v = float(loaded<T>(numbers.bytes.data() + number * std::int64_t(sizeof(T)), false));
  });
  return v;
}

void ScalarGrid::read_row(int x, int y, int z, int channel, std::span<float> out) const {
  const std::ptrdiff_t bytes = std::ptrdiff_t(bytes_of(type));
  const std::byte* const at = numbers.bytes.data() + bytes * (x * strides[0] + y * strides[1] +
                                                              z * strides[2] + channel * strides[3]);
  const bool is_scaled = slope != 1 || intercept != 0;
  if (type == ScalarType::float16) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float v =
          _cvtsh_ss(loaded<std::uint16_t>(at + std::ptrdiff_t(i) * bytes * strides[0], is_swapped));
      out[i] = is_scaled ? float(slope * double(v) + intercept) : v;
    }
    return;
  }
  grid_reader::with_type(type, [&](auto example) {
    using T = decltype(example);
    const auto convert = [&](std::ptrdiff_t step, auto swaps, auto scales) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        const T stored = loaded<T>(at + std::ptrdiff_t(i) * step, swaps);
        out[i] = scales ? float(slope * double(stored) + intercept) : float(stored);
      }
    };
    // The usual case is a loop of its own, so that it is vectorised.
    if (!is_swapped && !is_scaled && strides[0] == 1)
      convert(sizeof(T), std::false_type(), std::false_type());
    else if (is_scaled)
      convert(bytes * strides[0], is_swapped, std::true_type());
    else
      convert(bytes * strides[0], is_swapped, std::false_type());
  });
}

std::array<float, 2> ScalarGrid::range() const {
  std::array<float, 2> all{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  std::mutex mutex;
  for_each_row(*this, [&](int, int, int, const std::vector<float>& row) {
    // Values are converted eight at a time, as a vector.
    constexpr std::size_t kLanes = 8;
    float low[kLanes], high[kLanes];
    std::fill_n(low, kLanes, std::numeric_limits<float>::infinity());
    std::fill_n(high, kLanes, -std::numeric_limits<float>::infinity());
    const auto add = [&](std::size_t lane, float v) {
      low[lane] = v < low[lane] ? v : low[lane];
      high[lane] = v > high[lane] ? v : high[lane];
    };
    std::size_t i = 0;
    for (; i + kLanes <= row.size(); i += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) add(lane, row[i + lane]);
    for (; i < row.size(); ++i) add(0, row[i]);
    const std::lock_guard lock(mutex);
    all = {std::min(all[0], *std::min_element(low, low + kLanes)),
           std::max(all[1], *std::max_element(high, high + kLanes))};
  });
  return all;
}

void ScalarGrid::check_finite() const {
  if (!is_floating(type) && std::abs(slope) < 1e15 && std::abs(intercept) < 1e30) return;
  std::mutex mutex;
  // index (z, y, x, channel) of the first value in the order of the file
  std::array<int, 4> first{size[2], 0, 0, 0};
  float bad = 0;
  for_each_row(*this, [&](int y, int z, int c, const std::vector<float>& row) {
    for (std::size_t x = 0; x < row.size(); ++x) {
      if (std::isfinite(row[x])) continue;
      const std::lock_guard lock(mutex);
      const std::array<int, 4> here{z, y, int(x), c};
      if (here < first) first = here, bad = row[x];
      break;
    }
  });
  if (first[0] < size[2])
    throw Error(fmt::format("holds {} at x = {}, y = {}, z = {}; the numbers must be finite", bad, first[2],
                            first[1], first[0]));
}

std::array<double, 3> ScalarGrid::spacing() const {
  const Transform::Matrix& m = index_to_ras.matrix();
  std::array<double, 3> d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = std::hypot(m[0][i], m[1][i], m[2][i]);
  return d;
}

Transform ScalarGrid::index_to_world(double length_unit_m) const {
  const double s = unit_m / length_unit_m;
  return Transform::scale(s, s, s) * index_to_ras;
}

ScalarGrid grid_of_voxels(const std::shared_ptr<const VoxelData>& data) {
  ScalarGrid grid;
  grid.size = data->size, grid.channels = data->channels;
  grid.numbers = {std::as_bytes(std::span(data->values)), data};
  const std::int64_t nc = data->channels, nx = nc * grid.size[0], ny = nx * grid.size[1];
  grid.strides = {nc, nx, ny, 1};
  std::array<double, 3> step;
  for (std::size_t i = 0; i < 3; ++i) step[i] = (data->upper[i] - data->lower[i]) / grid.size[i];
  grid.index_to_ras = Transform::translate(data->lower[0], data->lower[1], data->lower[2]) *
                      Transform::scale(step[0], step[1], step[2]) * Transform::translate(.5, .5, .5);
  return grid;
}

bool is_scalar_grid_file(const std::filesystem::path& file) {
  const SharedBytes bytes = map_file(file);
  const Reader reader = reader_of(file, bytes.bytes);
  return reader && reader != grid_reader::read_tiff_stack;
}

ScalarGrid read_scalar_grid(const std::filesystem::path& file, const ScalarGridOptions& options) {
  return read_mapped(file, [&](const SharedBytes& bytes) {
    const Reader reader = reader_of(file, bytes.bytes);
    if (!reader) {
      const auto start = bytes.bytes.first(std::min<std::size_t>(bytes.size(), 4));
      const std::string_view letters(reinterpret_cast<const char*>(start.data()), start.size());
      if (letters == " BDV" || letters == "Nano")
        throw Error("is a file of OpenVDB or NanoVDB: the volume \"vdbvolume\" reads it");
      if (bytes.size() == 0) throw Error("is empty");
      if (const char* const advice = advice_on_other_format(bytes.bytes)) throw Error(advice);
      throw Error(
          fmt::format("begins with \"{}\", as no format of volumes does that is known here: NRRD, "
                      "MetaImage (.mha, .mhd), NIfTI, .vti, .npy, TIFF and .vol",
                      printable(start)));
    }
    if (options.is_series && reader != grid_reader::read_tiff_stack)
      throw Error("is no TIFF; only slices in TIFF are read as a series");
    ScalarGrid grid = reader(file, bytes, options);
    if ((options.spacing || options.origin) && grid.spacing_is_stated)
      throw Error(
          "states the distance of its voxels itself; \"spacing\" and \"origin\" are for files that do "
          "not, such as TIFF and .npy");
    if (!options.array.empty() && grid.format != ".vti")
      throw Error("has one array; \"array\" chooses one of those of a .vti file");
    return grid;
  });
}

}  // namespace aureole
