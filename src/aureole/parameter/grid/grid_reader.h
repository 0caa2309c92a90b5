// SPDX-License-Identifier: Apache-2.0
// One function for each format of grids, and their common helpers. They throw Error, without a location or
// located at a line of the file; `read_scalar_grid` adds the file.
#pragma once

#include <functional>
#include <string_view>

#include "aureole/core/error.h"
#include "aureole/parameter/grid/scalar_grid.h"

namespace aureole::grid_reader {

using Path = std::filesystem::path;

ScalarGrid read_nrrd(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options);
ScalarGrid read_meta_image(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options);
/// Reads a NIfTI file. `bytes` may be compressed by gzip.
ScalarGrid read_nifti(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options);
ScalarGrid read_vti(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options);
ScalarGrid read_npy(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options);
ScalarGrid read_tiff_stack(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options);

/// The header of a file of numpy (.npy).
struct NpyHeader {
  ScalarType type = ScalarType::float32;
  bool is_swapped = false;          ///< stored with the most significant byte first
  bool is_fortran = false;          ///< the first axis is the fastest
  std::vector<std::int64_t> sizes;  ///< of the axes; none for a single number
  std::size_t start = 0;            ///< byte at which the numbers begin
};
/// Reads it. The sizes are as they are stated, whether or not the numbers are there.
NpyHeader read_npy_header(const SharedBytes& bytes);

/// How numbers are stored.
enum class Encoding { raw, text, hex, gzip, bzip2 };

/// Calls f with a number of the C++ type of `type`; of `std::uint16_t` with `is_half` for float16.
template <class F>
void with_type(ScalarType type, const F& f) {
  switch (type) {
    case ScalarType::int8:
      return f(std::int8_t());
    case ScalarType::uint8:
      return f(std::uint8_t());
    case ScalarType::int16:
      return f(std::int16_t());
    case ScalarType::uint16:
    case ScalarType::float16:
      return f(std::uint16_t());
    case ScalarType::int32:
      return f(std::int32_t());
    case ScalarType::uint32:
      return f(std::uint32_t());
    case ScalarType::int64:
      return f(std::int64_t());
    case ScalarType::uint64:
      return f(std::uint64_t());
    case ScalarType::float32:
      return f(float());
    case ScalarType::float64:
      return f(double());
  }
}

/// Returns the product of sizes. Throws Error if there is none, one is not in [1, 2^20], or the numbers need more
/// than 2^62 bytes.
std::uint64_t count_of(const std::vector<std::int64_t>& sizes, ScalarType type);

/// Decodes `count` numbers of `source`. The first `byte_skip` bytes are skipped, in compressed data after
/// decompression. In raw data -1 skips all bytes before the numbers, which then end the source. Raw numbers
/// are not copied. Throws Error if there are fewer.
SharedBytes decode(const SharedBytes& source, Encoding encoding, std::int64_t byte_skip, std::uint64_t count,
                   ScalarType type);
/// Adds a note to the grid if raw data have more bytes than the numbers that `decode` returns.
void note_surplus(ScalarGrid& grid, const SharedBytes& source, Encoding encoding, std::int64_t byte_skip,
                  std::uint64_t count);
/// Decompresses gzip or zlib to at most `wanted` bytes. Memory grows with what was found, not with what is wanted.
SharedBytes inflate_bytes(const SharedBytes& source, std::uint64_t wanted);
/// Decompresses deflated data without a header, as members of a zip archive have them, to exactly `wanted` bytes. Throws Error.
SharedBytes inflate_raw(const SharedBytes& source, std::uint64_t wanted);
/// Returns the bytes of base64 text up to its padding; blanks are passed over. Throws Error at another character.
std::vector<std::byte> base64_bytes(std::string_view text);
/// Wraps a vector of bytes as shared bytes.
SharedBytes shared(std::vector<std::byte> bytes);
/// Joins pieces that together form the numbers of a grid; a single piece is not copied.
SharedBytes joined(std::vector<SharedBytes> pieces);

/// Returns an Error at a line of the header. For a problem in another file, the message begins with the name
/// of that file.
Error at_line(const Error& problem, int line);

/// Parses text as one number; NaN and infinity are allowed. Throws Error.
double number_of(std::string_view text);
std::int64_t integer_of(std::string_view text);
/// Parses `count` blank-separated numbers. Throws Error also if there are more or fewer.
std::vector<double> numbers_of(std::string_view text, std::size_t count);
std::vector<std::int64_t> integers_of(std::string_view text);
std::vector<std::string> words_of(std::string_view text);
std::string_view trimmed(std::string_view text);
std::string lowered(std::string_view text);

/// Returns the metres of a unit's symbol or name ("mm", "millimeters", "micron"); nothing if it is unknown.
std::optional<double> metres_of_unit(std::string_view name);

/// Sets `grid.size`, channels, strides and the chosen frame from `grid.numbers`, which hold all frames. `axes` has
/// the size of each axis, the fastest first, and what it is: 'x', 'y', 'z', 'c' (channel) or 't' (frame, also of
/// several axes, of which the first is counted fastest). Returns nothing; throws Error if the frame is not there.
struct GridAxis {
  std::int64_t size;
  char role;
};
void arrange(ScalarGrid& grid, const std::vector<GridAxis>& axes, const ScalarGridOptions& options);

/// Sets `index_to_ras` from the columns (the step of each index in the file's space) and the centre of the first
/// voxel, both in a space whose coordinates increase in the directions `space` ("LPS"; empty: unknown).
void place(ScalarGrid& grid, const std::array<std::array<double, 3>, 3>& columns,
           const std::array<double, 3>& origin, const std::string& space, const ScalarGridOptions& options);
/// Places a grid whose file states no distance between voxels: by the options, or with the distance 1.
void place_by_options(ScalarGrid& grid, const ScalarGridOptions& options);

/// Returns the names of a printf-like pattern with one %d for first, first + step, ..., last.
std::vector<std::string> names_of_pattern(const std::string& pattern, std::int64_t first, std::int64_t last,
                                          std::int64_t step);
/// Returns the files of a series: those in the folder of `file` whose names differ from its name in the last
/// number only, in the order of that number. Throws Error if a number is missing between two others.
std::vector<Path> files_of_series(const Path& file);

/// Upper bound of the number of files of one grid.
inline constexpr std::size_t kMaxFiles = 1 << 16;

}  // namespace aureole::grid_reader
