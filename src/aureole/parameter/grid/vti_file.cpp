// SPDX-License-Identifier: Apache-2.0
// ImageData of VTK in XML (.vti; docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html): values at the points
// or in the cells of a grid with origin, spacing and directions.
#include <fmt/format.h>
#include <lz4.h>
#include <lzma.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <pugixml.hpp>

#include "aureole/core/memory.h"
#include "aureole/parameter/grid/grid_reader.h"

namespace aureole::grid_reader {

namespace {

/// Decompresses a block to at most `size` bytes.
using Unpack = SharedBytes(const SharedBytes& block, std::uint64_t size);

SharedBytes lz4_block(const SharedBytes& block, std::uint64_t size) {
  // Bound of the decompressed size: a byte of a block represents 255 bytes at most, so that a small file
  // allocates little memory.
  if (size > 255 * std::uint64_t(block.size()) || size > LZ4_MAX_INPUT_SIZE)
    throw Error("has a compressed block that is too short for its size");
  std::vector<std::byte> out{std::size_t(size)};
  const int found = LZ4_decompress_safe(reinterpret_cast<const char*>(block.bytes.data()),
                                        reinterpret_cast<char*>(out.data()), int(block.size()), int(size));
  if (found < 0) throw Error("holds damaged data compressed by LZ4");
  out.resize(std::size_t(found));
  return shared(std::move(out));
}

SharedBytes lzma_block(const SharedBytes& block, std::uint64_t size) {
  require_content(double(size), double(block.size()), 1100);
  std::vector<std::byte> out{std::size_t(size)};
  std::uint64_t memory = std::uint64_t(256) << 20;  // memory limit of the decompressor, for its dictionary
  std::size_t read = 0, written = 0;
  const lzma_ret status = lzma_stream_buffer_decode(
      &memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(block.bytes.data()), &read, block.size(),
      reinterpret_cast<std::uint8_t*>(out.data()), &written, out.size());
  if (status != LZMA_OK) throw Error("holds damaged data compressed by LZMA");
  out.resize(written);
  return shared(std::move(out));
}

class Vti {
public:
  Vti(const SharedBytes& bytes, const ScalarGridOptions& options) : bytes_(bytes), options_(options) {
    parse();
  }

  ScalarGrid read() {
    ScalarGrid grid;
    grid.format = ".vti";
    grid.has_transform = true;
    const pugi::xml_node root = document_.child("VTKFile");
    if (std::string_view(root.attribute("type").value()) != "ImageData")
      throw at(root, fmt::format("holds \"{}\" of VTK; \"ImageData\" is supported",
                                 root.attribute("type").value()));
    const std::string order = root.attribute("byte_order").value();
    if (order != "LittleEndian" && order != "BigEndian" && !order.empty())
      throw at(root,
               "has the byte_order \"" + order.substr(0, 40) + "\"; LittleEndian and BigEndian are known");
    grid.is_swapped = is_swapped_ = order == "BigEndian";
    const std::string header = root.attribute("header_type").value();
    if (header != "UInt32" && header != "UInt64" && !header.empty())
      throw at(root, "has the header_type \"" + header.substr(0, 40) + "\"; UInt32 and UInt64 are known");
    header_bytes_ = header == "UInt64" ? 8 : 4;
    const std::string compressor = root.attribute("compressor").value();
    if (!compressor.empty()) {
      static const std::map<std::string, Unpack*, std::less<>> kCompressors = {
          {"vtkZLibDataCompressor", inflate_bytes},
          {"vtkLZ4DataCompressor", lz4_block},
          {"vtkLZMADataCompressor", lzma_block}};
      const auto found = kCompressors.find(compressor);
      if (found == kCompressors.end())
        throw at(root,
                 "is compressed by \"" + compressor.substr(0, 40) +
                     "\"; vtkZLibDataCompressor, vtkLZ4DataCompressor and vtkLZMADataCompressor are known");
      unpack_ = found->second;
    }
    const pugi::xml_node image = root.child("ImageData"), piece = image.child("Piece");
    if (!piece) throw at(image ? image : root, "has no Piece with values");
    if (piece.next_sibling("Piece")) throw at(image, "has several pieces; one is supported");
    const std::vector<std::int64_t> extent = integers(piece, "Extent", 6);
    if (image.attribute("WholeExtent") && integers(image, "WholeExtent", 6) != extent)
      throw at(piece, "has a piece that is not the whole; one of the whole extent is supported");
    bool is_cell = false;
    const pugi::xml_node array = chosen_array(piece, is_cell);
    if (const auto names = names_of_arrays(piece); options_.array.empty() && names.size() > 1)
      grid.notes.push_back(
          fmt::format("has the arrays {}, of which \"{}\" is read; \"array\" chooses another",
                      listed_names(names), array.attribute("Name").value()));
    grid.type = type_of(array);
    const std::int64_t channels = array.attribute("NumberOfComponents").as_llong(1);
    if (channels < 1 || channels > 64)
      throw at(array, fmt::format("has {} components; 1 to 64 are possible", channels));
    std::vector<GridAxis> axes = {{channels, 'c'}};
    std::vector<std::int64_t> sizes = {channels};
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::abs(extent[2 * k]) > kFarthest || std::abs(extent[2 * k + 1]) > kFarthest)
        throw at(piece, "has an extent beyond all grids");
      const std::int64_t n = extent[2 * k + 1] - extent[2 * k] + (is_cell ? 0 : 1);
      axes.push_back({n, "xyz"[k]});
      sizes.push_back(n);
    }
    std::uint64_t count = 0;
    located(piece, [&] { count = count_of(sizes, grid.type); });
    located(array, [&] { grid.numbers = numbers(array, count, grid); });
    arrange(grid, axes, options_);
    set_place(grid, image, extent, is_cell);
    return grid;
  }

private:
  static constexpr std::int64_t kFarthest = std::int64_t(1) << 31;

  /// Parses the text. Numbers that are appended in raw form are not XML and are left out.
  void parse() {
    const std::string_view all(reinterpret_cast<const char*>(bytes_.bytes.data()), bytes_.size());
    const std::size_t tag = all.find("<AppendedData");
    std::string_view text = all;
    if (tag != all.npos) {
      const std::size_t close = all.find('>', tag), mark = all.find('_', close == all.npos ? tag : close);
      if (close == all.npos || mark == all.npos)
        throw Error("has AppendedData without the \"_\" before its numbers");
      appended_ = bytes_.from(mark + 1);
      has_appended_ = true;
      const std::string_view opening = all.substr(tag, close - tag);
      is_appended_base64_ = opening.find("base64") != opening.npos;
      if (!is_appended_base64_ && opening.find("raw") == opening.npos)
        throw Error(line_of(tag), "has AppendedData with an unknown encoding; raw and base64 are known");
      text = all.substr(0, tag);
    }
    // The parser reports the missing end tags of the cut text, although it has read all elements.
    const pugi::xml_parse_result result =
        document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    const bool is_cut = has_appended_ && result.status == pugi::status_end_element_mismatch;
    if (!result && !is_cut)
      throw Error(line_of(std::size_t(result.offset)),
                  std::string("is no well-formed XML: ") + result.description());
    if (!document_.child("VTKFile")) throw Error("has no element VTKFile");
  }
  SourceLocation line_of(std::size_t offset) const {
    const char* const text = reinterpret_cast<const char*>(bytes_.bytes.data());
    return {{}, 1 + int(std::count(text, text + std::min(offset, bytes_.size()), '\n')), 0};
  }
  Error at(pugi::xml_node node, const std::string& message) const {
    return Error(line_of(node ? std::size_t(std::max<std::ptrdiff_t>(node.offset_debug(), 0)) : 0), message);
  }
  template <class F>
  void located(pugi::xml_node node, const F& f) const {
    try {
      f();
    } catch (const Error& problem) {
      if (problem.where().line > 0) throw;
      throw at(node, problem.message());
    }
  }
  std::vector<std::int64_t> integers(pugi::xml_node node, const char* name, std::size_t count) const {
    std::vector<std::int64_t> found;
    located(node, [&] { found = integers_of(node.attribute(name).value()); });
    if (found.size() != count)
      throw at(node, fmt::format("has {} numbers in its {}; {} are expected", found.size(), name, count));
    return found;
  }

  static std::vector<std::string> names_of_arrays(pugi::xml_node piece) {
    std::vector<std::string> names;
    for (const char* part : {"PointData", "CellData"})
      for (const pugi::xml_node a : piece.child(part).children("DataArray"))
        names.emplace_back(a.attribute("Name").value());
    return names;
  }
  /// Returns names in quotes, at most eight of them.
  static std::string listed_names(const std::vector<std::string>& names) {
    constexpr std::size_t kMaxShown = 8;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMaxShown); ++i)
      text += (i ? ", \"" : "\"") + names[i].substr(0, 40) + "\"";
    if (names.size() > kMaxShown) text += fmt::format(" and {} more", names.size() - kMaxShown);
    return text;
  }

  /// Returns the array of that name; without a name the active scalars, else the first array, of points before cells.
  pugi::xml_node chosen_array(pugi::xml_node piece, bool& is_cell) const {
    std::vector<std::string> names;
    for (const char* part : {"PointData", "CellData"})
      for (const pugi::xml_node a : piece.child(part).children("DataArray")) {
        names.emplace_back(a.attribute("Name").value());
        if (!options_.array.empty() && names.back() == options_.array) {
          is_cell = part[0] == 'C';
          return a;
        }
      }
    if (!options_.array.empty())
      throw at(piece, "has no array \"" + options_.array + "\"" + did_you_mean_or_all(options_.array, names));
    for (const bool is_active : {true, false})
      for (const char* part : {"PointData", "CellData"}) {
        const pugi::xml_node data = piece.child(part);
        const std::string_view active = data.attribute("Scalars").value();
        for (const pugi::xml_node a : data.children("DataArray")) {
          if (is_active && (active.empty() || active != a.attribute("Name").value())) continue;
          is_cell = part[0] == 'C';
          return a;
        }
      }
    throw at(piece, "has no array of values at its points or in its cells");
  }

  ScalarType type_of(pugi::xml_node array) const {
    static const std::map<std::string, ScalarType, std::less<>> kNames = {
        {"Int8", ScalarType::int8},      {"UInt8", ScalarType::uint8},   {"Int16", ScalarType::int16},
        {"UInt16", ScalarType::uint16},  {"Int32", ScalarType::int32},   {"UInt32", ScalarType::uint32},
        {"Int64", ScalarType::int64},    {"UInt64", ScalarType::uint64}, {"Float32", ScalarType::float32},
        {"Float64", ScalarType::float64}};
    const auto found = kNames.find(array.attribute("type").value());
    if (found == kNames.end())
      throw at(array,
               fmt::format("has numbers of the type \"{}\"; Int8 to UInt64, Float32 and Float64 are known",
                           std::string(array.attribute("type").value()).substr(0, 40)));
    return found->second;
  }

  SharedBytes numbers(pugi::xml_node array, std::uint64_t count, ScalarGrid& grid) const {
    const std::string_view format = array.attribute("format").value();
    const std::string_view text = array.child_value();
    const SharedBytes inside{std::as_bytes(std::span(text.data(), text.size())), nullptr};
    if (format == "ascii") {
      grid.is_swapped = false;
      return decode(inside, Encoding::text, 0, count, grid.type);
    }
    if (format == "binary") return unpacked(inside, true, count, grid.type);
    if (format != "appended")
      throw Error(
          fmt::format("has the format \"{}\"; ascii, binary and appended are known", format.substr(0, 40)));
    if (!has_appended_) throw Error("is appended, but the file has no AppendedData");
    const std::int64_t offset = integer_of(array.attribute("offset").value());
    if (offset < 0 || std::uint64_t(offset) > appended_.size())
      throw Error(fmt::format(
          "is truncated: its numbers begin {} bytes behind the \"_\", which is beyond the end", offset));
    return unpacked(appended_.from(std::size_t(offset)), is_appended_base64_, count, grid.type);
  }

  std::uint64_t header_number(std::span<const std::byte> from) const {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < header_bytes_; ++i) {
      const std::size_t place = is_swapped_ ? header_bytes_ - 1 - i : i;
      number |= std::uint64_t(from[place]) << (8 * i);
    }
    return number;
  }

  /// Returns the base64 characters that encode `bytes` bytes, without blanks and characters behind them.
  static std::string characters(std::string_view text, std::uint64_t bytes, std::size_t& at) {
    const std::uint64_t wanted = (bytes + 2) / 3 * 4;
    std::string found;
    for (; at < text.size() && found.size() < wanted; ++at) {
      const char c = text[at];
      if (c == '<') break;
      if (c != ' ' && c != '\n' && c != '\r' && c != '\t') found += c;
    }
    return found;
  }

  /// Reads numbers that follow their header, which is their size in bytes or the sizes of compressed blocks.
  SharedBytes unpacked(const SharedBytes& source, bool is_base64, std::uint64_t count,
                       ScalarType type) const {
    const std::uint64_t needed = count * bytes_of(type);
    const std::string_view text(reinterpret_cast<const char*>(source.bytes.data()), source.size());
    if (!unpack_) {
      SharedBytes all = source;
      if (is_base64) {
        if (needed > source.size()) throw_truncated(needed, source.size() / 4 * 3);
        std::size_t at = 0;
        all = shared(base64_bytes(characters(text, header_bytes_ + needed, at)));
      }
      if (all.size() < header_bytes_) throw_truncated(needed, 0);
      const std::uint64_t stated = header_number(all.bytes);
      if (stated != needed)
        throw Error(fmt::format("has {} bytes of numbers where its extent, type and components need {}",
                                stated, needed));
      return decode(all, Encoding::raw, std::int64_t(header_bytes_), count, type);
    }
    // The header: number of blocks, their size, size of the last block where it is smaller, compressed sizes.
    std::size_t at = 0;
    std::uint64_t blocks = 0;
    const auto header = [&](std::uint64_t numbers) {
      const std::uint64_t size = numbers * header_bytes_;
      if (!is_base64) {
        if (size > source.size()) throw_truncated(size, source.size());
        return std::vector<std::byte>(source.bytes.begin(), source.bytes.begin() + std::ptrdiff_t(size));
      }
      at = 0;
      std::vector<std::byte> bytes = base64_bytes(characters(text, size, at));
      if (bytes.size() < size) throw_truncated(size, bytes.size());
      return bytes;
    };
    blocks = header_number(header(1));
    if (blocks > source.size() / header_bytes_) throw_truncated(blocks * header_bytes_, source.size());
    const std::vector<std::byte> sizes = header(3 + blocks);
    const auto number = [&](std::uint64_t i) {
      return header_number(std::span(sizes).subspan(std::size_t(i) * header_bytes_));
    };
    const std::uint64_t block_size = number(1), last = number(2);
    std::uint64_t packed = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      if (number(3 + i) > source.size()) throw_truncated(number(3 + i), source.size());
      packed += number(3 + i);
    }
    SharedBytes data;
    if (is_base64) {
      const std::uint64_t characters_left = text.size() - at;
      if (packed > characters_left) throw_truncated(packed, characters_left / 4 * 3);
      data = shared(base64_bytes(characters(text, packed, at)));
    } else
      data = source.from(sizes.size());
    if (packed > data.size()) throw_truncated(packed, data.size());
    std::vector<std::byte> out;
    std::size_t begin = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t size = i + 1 == blocks && last > 0 ? last : block_size;
      if (size > needed - out.size())
        throw Error(
            fmt::format("has more numbers in its compressed blocks than the {} bytes of its extent", needed));
      const std::size_t here = std::size_t(number(3 + i));
      const SharedBytes block = unpack_({data.bytes.subspan(begin, here), data.owner}, size);
      if (block.size() < size) throw_truncated(size, block.size());
      out.insert(out.end(), block.bytes.begin(), block.bytes.end());
      begin += here;
    }
    if (out.size() < needed) throw_truncated(needed, out.size());
    return shared(std::move(out));
  }
  [[noreturn]] static void throw_truncated(std::uint64_t wanted, std::uint64_t found) {
    throw Error(fmt::format("is truncated: {} bytes are expected, but there are {}", wanted, found));
  }

  void set_place(ScalarGrid& grid, pugi::xml_node image, const std::vector<std::int64_t>& extent,
                 bool is_cell) const {
    const auto numbers = [&](const char* name, std::vector<double> fallback) {
      if (!image.attribute(name)) return fallback;
      std::vector<double> found;
      located(image, [&] { found = numbers_of(image.attribute(name).value(), fallback.size()); });
      return found;
    };
    const std::vector<double> step = numbers("Spacing", {1, 1, 1}), corner = numbers("Origin", {0, 0, 0});
    const std::vector<double> direction = numbers("Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1});
    std::array<std::array<double, 3>, 3> columns;
    std::array<double, 3> origin;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(step[k] > 0))
        throw at(image,
                 fmt::format("has the spacing {} along its axis {}; a positive, finite distance is expected, "
                             "such as 0.5",
                             step[k], "xyz"[k]));
      for (std::size_t i = 0; i < 3; ++i) columns[k][i] = direction[3 * i + k] * step[k];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = corner[i];
      for (std::size_t k = 0; k < 3; ++k)
        origin[i] += columns[k][i] * (double(extent[2 * k]) + (is_cell ? 0.5 : 0));
    }
    grid.spacing_is_stated = true;
    located(image, [&] { place(grid, columns, origin, "", options_); });
  }

  const SharedBytes& bytes_;
  const ScalarGridOptions& options_;
  pugi::xml_document document_;
  SharedBytes appended_;
  bool has_appended_ = false, is_appended_base64_ = false, is_swapped_ = false;
  Unpack* unpack_ = nullptr;  ///< decompressor of the numbers; null: they are not compressed
  std::size_t header_bytes_ = 4;
};

}  // namespace

ScalarGrid read_vti(const Path&, const SharedBytes& bytes, const ScalarGridOptions& options) {
  return Vti(bytes, options).read();
}

}  // namespace aureole::grid_reader
