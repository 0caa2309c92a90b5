// SPDX-License-Identifier: Apache-2.0
// MetaImage (.mha, .mhd; itk.org/Wiki/ITK/MetaIO/Documentation): lines "Key = Value", the numbers behind them or in
// other files. Orientation as in ITK: the values of TransformMatrix are the directions of the axes, one after the
// other, and coordinates are LPS.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <type_traits>

#include "aureole/parameter/grid/grid_reader.h"

namespace aureole::grid_reader {

namespace {

struct MetaField {
  std::string value;
  int line = 0;
};

struct MetaHeader {
  std::map<std::string, MetaField, std::less<>> fields;
  std::vector<MetaField> listed;  ///< lines that follow ElementDataFile = LIST
  std::size_t end = 0;
};

/// Replaces older names of a key by the current one.
std::string key_of(std::string_view key) {
  static const std::map<std::string, std::string, std::less<>> kOld = {
      {"Position", "Offset"},
      {"Origin", "Offset"},
      {"Rotation", "TransformMatrix"},
      {"Orientation", "TransformMatrix"},
      {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}};
  const auto found = kOld.find(key);
  return found == kOld.end() ? std::string(key) : found->second;
}

MetaHeader meta_header_of(std::string_view text) {
  MetaHeader header;
  std::size_t at = 0;
  bool in_list = false;
  for (int number = 1; at < text.size(); ++number) {
    if (at > (std::size_t(1) << 22)) throw Error("has a header of more than 4 MiB");
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(text.substr(at, end - at));
    at = header.end = std::min(end + 1, text.size());
    if (line.empty()) continue;
    const SourceLocation where{{}, number, 0};
    if (in_list) {
      if (header.listed.size() >= kMaxFiles) throw Error(where, "lists too many files");
      header.listed.push_back({std::string(line), number});
      continue;
    }
    const std::size_t equals = line.find_first_of("=:");
    if (equals == line.npos)
      throw Error(where, fmt::format("has \"{}\" where \"Key = Value\" is expected, such as \"NDims = 3\"",
                                     line.substr(0, 40)));
    const std::string key = key_of(trimmed(line.substr(0, equals)));
    const std::string value(trimmed(line.substr(equals + 1)));
    if (!header.fields.emplace(key, MetaField{value, number}).second)
      throw Error(where, "has the key \"" + key.substr(0, 40) + "\" twice");
    if (key == "ElementDataFile") {
      in_list = value == "LIST" || value.starts_with("LIST ");
      if (!in_list) break;
    }
  }
  return header;
}

class MetaImage {
public:
  MetaImage(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options)
      : file_(file),
        bytes_(bytes),
        options_(options),
        header_(meta_header_of({reinterpret_cast<const char*>(bytes.bytes.data()), bytes.size()})) {}

  ScalarGrid read() {
    ScalarGrid grid;
    grid.format = "MetaImage";
    grid.has_transform = true;
    if (has("ObjectType") && header_.fields.at("ObjectType").value != "Image")
      throw Error({{}, header_.fields.at("ObjectType").line, 0},
                  "holds an object of the type \"" + header_.fields.at("ObjectType").value.substr(0, 40) +
                      "\"; \"Image\" is supported");
    const auto n = at("NDims", [](auto& v) { return integer_of(v); });
    if (n < 3 || n > 4)
      throw Error({{}, header_.fields.at("NDims").line, 0},
                  fmt::format("has {} dimensions; a volume has 3, or 4 with frames", n));
    dimensions_ = std::size_t(n);
    grid.type = at("ElementType", [](auto& v) { return type(v); });
    std::vector<GridAxis> axes;
    if (has("ElementNumberOfChannels")) {
      const auto channels = at("ElementNumberOfChannels", [](auto& v) {
        const std::int64_t c = integer_of(v);
        if (c < 1 || c > 64) throw Error(fmt::format("has {} channels; 1 to 64 are possible", c));
        return c;
      });
      if (channels > 1) axes.push_back({channels, 'c'});
    }
    const auto sizes = at("DimSize", [&](auto& v) {
      const std::vector<std::int64_t> all = integers_of(v);
      if (all.size() != dimensions_)
        throw Error(fmt::format("has {} sizes for {} dimensions", all.size(), dimensions_));
      return all;
    });
    for (std::size_t i = 0; i < dimensions_; ++i) axes.push_back({sizes[i], "xyzt"[i]});
    const std::uint64_t count = at("DimSize", [&](auto&) {
      std::vector<std::int64_t> all;
      for (const GridAxis& a : axes) all.push_back(a.size);
      return count_of(all, grid.type);
    });
    grid.is_swapped = is_true("ElementByteOrderMSB");
    if (has("ElementToIntensityFunctionSlope"))
      grid.slope = at("ElementToIntensityFunctionSlope", [](auto& v) { return number_of(v); });
    if (has("ElementToIntensityFunctionOffset"))
      grid.intercept = at("ElementToIntensityFunctionOffset", [](auto& v) { return number_of(v); });
    read_numbers(grid, sizes, count);
    arrange(grid, axes, options_);
    set_place(grid);
    note_unused(grid);
    return grid;
  }

private:
  bool has(std::string_view key) const { return header_.fields.contains(key); }
  template <class Read>
  std::invoke_result_t<const Read&, const std::string&> at(const char* key, const Read& read) const {
    const auto found = header_.fields.find(key);
    if (found == header_.fields.end())
      throw Error(fmt::format("has no key \"{}\", which is required here", key));
    try {
      return read(found->second.value);
    } catch (const Error& problem) {
      throw at_line(problem, found->second.line);
    }
  }
  bool is_true(const char* key) const {
    if (!has(key)) return false;
    return at(key, [](const std::string& v) {
      const std::string s = lowered(v);
      if (s == "true" || s == "t" || s == "1" || s == "yes") return true;
      if (s == "false" || s == "f" || s == "0" || s == "no") return false;
      throw Error("has \"" + v.substr(0, 40) + "\" where True or False is expected");
    });
  }

  static ScalarType type(const std::string& v) {
    static const std::map<std::string, ScalarType, std::less<>> kNames = {
        {"MET_CHAR", ScalarType::int8},       {"MET_UCHAR", ScalarType::uint8},
        {"MET_SHORT", ScalarType::int16},     {"MET_USHORT", ScalarType::uint16},
        {"MET_INT", ScalarType::int32},       {"MET_UINT", ScalarType::uint32},
        {"MET_LONG", ScalarType::int32},      {"MET_ULONG", ScalarType::uint32},
        {"MET_LONG_LONG", ScalarType::int64}, {"MET_ULONG_LONG", ScalarType::uint64},
        {"MET_FLOAT", ScalarType::float32},   {"MET_DOUBLE", ScalarType::float64}};
    const auto found = kNames.find(v);
    if (found == kNames.end())
      throw Error("has numbers of the type \"" + v.substr(0, 40) +
                  "\"; MET_CHAR to MET_ULONG_LONG, MET_FLOAT and MET_DOUBLE are known");
    return found->second;
  }

  void read_numbers(ScalarGrid& grid, const std::vector<std::int64_t>& sizes, std::uint64_t count) {
    const bool is_binary = !has("BinaryData") || is_true("BinaryData");
    const bool is_packed = is_true("CompressedData");
    if (is_packed && !is_binary)
      throw Error({{}, header_.fields.at("CompressedData").line, 0},
                  "has compressed text, which is not supported");
    const Encoding e = is_packed ? Encoding::gzip : is_binary ? Encoding::raw : Encoding::text;
    const std::int64_t skip = has("HeaderSize") ? at("HeaderSize", [](auto& v) { return integer_of(v); }) : 0;
    const auto file_of_all = at("ElementDataFile", [](auto& v) { return v; });
    if (lowered(file_of_all) == "local") {
      if (skip > 0)
        throw Error({{}, header_.fields.at("HeaderSize").line, 0},
                    "has a HeaderSize, but its numbers are local and follow its own header");
      grid.numbers = decode(bytes_.from(header_.end), e, 0, count, grid.type);
      note_surplus(grid, bytes_.from(header_.end), e, 0, count);
      return;
    }
    std::vector<std::string> names;
    std::size_t sub = dimensions_ - 1;  // number of dimensions of one file of several
    at("ElementDataFile", [&](const std::string& v) {
      const std::vector<std::string> words = words_of(v);
      if (words.empty()) throw Error("names no file");
      if (words[0] == "LIST") {
        if (words.size() > 1) {
          std::string number = words[1];
          if (number.ends_with('D')) number.pop_back();
          const std::int64_t d = integer_of(number);
          if (d < 1 || d > std::int64_t(dimensions_))
            throw Error(fmt::format("has files of {} dimensions; 1 to {} are possible", d, dimensions_));
          sub = std::size_t(d);
        }
        for (const MetaField& f : header_.listed) names.push_back(f.value);
        if (names.empty()) throw Error("lists no files behind LIST");
      } else if (words[0].find('%') != std::string::npos) {
        if (words.size() < 3 || words.size() > 4)
          throw Error("has the pattern \"" + v.substr(0, 60) +
                      "\"; first and last number are expected behind it, as in slice%03d.raw 1 20 1");
        names = names_of_pattern(words[0], integer_of(words[1]), integer_of(words[2]),
                                 words.size() > 3 ? integer_of(words[3]) : 1);
      } else
        names = {v};
      return 0;
    });
    std::uint64_t each = count;
    if (names.size() > 1 || !header_.listed.empty()) {
      for (std::size_t i = sub; i < dimensions_; ++i) each /= std::uint64_t(sizes[i]);
      if (each * names.size() != count)
        throw Error(
            {{}, header_.fields.at("ElementDataFile").line, 0},
            fmt::format("has {} files of {} numbers each for a grid of {}", names.size(), each, count));
    }
    std::vector<SharedBytes> pieces;
    for (const std::string& name : names) {
      const Path data = file_.parent_path() / name;
      at("ElementDataFile", [&](auto&) {
        const SharedBytes source = map_file(data);
        try {
          pieces.push_back(decode(source, e, skip, each, grid.type));
          if (pieces.size() == 1) note_surplus(grid, source, e, skip, each);
        } catch (const Error& problem) {
          throw Error("names \"" + name + "\", which " + problem.message());
        }
        return 0;
      });
      grid.further_files.push_back(data);
    }
    grid.numbers = joined(std::move(pieces));
  }

  void set_place(ScalarGrid& grid) const {
    std::array<std::array<double, 3>, 3> columns{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::array<double, 3> origin{0, 0, 0};
    const auto vector = [&](const char* key) {
      return at(key, [&](auto& v) { return numbers_of(v, dimensions_); });
    };
    if (has("TransformMatrix")) {
      const std::vector<double> m =
          at("TransformMatrix", [&](auto& v) { return numbers_of(v, dimensions_ * dimensions_); });
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i) columns[k][i] = m[k * dimensions_ + i];
    }
    // ElementSize is the extent of a voxel, which replaces the spacing in files without one.
    const char* const spacing = has("ElementSpacing") ? "ElementSpacing"
                                : has("ElementSize")  ? "ElementSize"
                                                      : nullptr;
    if (has("Offset")) {
      const std::vector<double> o = vector("Offset");
      std::copy_n(o.begin(), 3, origin.begin());
    }
    if (spacing) {
      const std::vector<double> step = vector(spacing);
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(step[k] > 0))
          throw Error(
              {{}, header_.fields.at(spacing).line, 0},
              fmt::format("has voxels at a distance of {} along its axis {}; a positive, finite distance "
                          "is expected, such as 0.5",
                          step[k], "xyz"[k]));
        for (double& c : columns[k]) c *= step[k];
      }
    } else if (has("TransformMatrix") || has("Offset")) {
      grid.notes.push_back("states no distance of its voxels, which is taken as 1 mm along each axis");
    } else {
      place_by_options(grid, options_);
      return;
    }
    if (has("DistanceUnits") && !options_.unit_m)
      at("DistanceUnits", [&](const std::string& v) {
        const std::optional<double> m = metres_of_unit(v);
        if (!m) throw Error("has the unit \"" + v.substr(0, 40) + "\", which is unknown; mm is usual");
        grid.unit_m = *m;
        return 0;
      });
    grid.unit_is_stated = grid.spacing_is_stated = true;  // stated, since the format's unit is the millimetre
    at(has("TransformMatrix") ? "TransformMatrix"
       : spacing              ? spacing
                              : "Offset",
       [&](auto&) {
         place(grid, columns, origin, "LPS", options_);
         return 0;
       });
  }

  void note_unused(ScalarGrid& grid) const {
    static const std::vector<std::string> kSilent = {
        "ObjectType", "NDims", "ElementType", "ElementNumberOfChannels", "DimSize", "ElementByteOrderMSB",
        "ElementToIntensityFunctionSlope", "ElementToIntensityFunctionOffset", "BinaryData", "CompressedData",
        "CompressedDataSize", "HeaderSize", "ElementDataFile", "TransformMatrix", "ElementSpacing",
        "ElementSize", "Offset", "DistanceUnits",
        // Keys of descriptions, which do not affect numbers or position.
        "Comment", "ObjectSubType", "TransformType", "Name", "ID", "ParentID", "Color", "Modality",
        "ElementMin", "ElementMax", "AcquisitionDate", "SequenceID", "AnatomicalOrientation"};
    std::string unused;
    for (const auto& [key, field] : header_.fields) {
      if (std::find(kSilent.begin(), kSilent.end(), key) != kSilent.end()) continue;
      if (key == "CenterOfRotation" && numbers_are_zero(field.value)) continue;
      unused += (unused.empty() ? "" : ", ") + key.substr(0, 40);
    }
    if (!unused.empty()) grid.notes.push_back("has keys that are not used: " + unused.substr(0, 400));
  }
  static bool numbers_are_zero(const std::string& text) {
    for (const std::string& word : words_of(text))
      if (number_of(word) != 0) return false;
    return true;
  }

  const Path& file_;
  const SharedBytes& bytes_;
  const ScalarGridOptions& options_;
  MetaHeader header_;
  std::size_t dimensions_ = 3;
};

}  // namespace

ScalarGrid read_meta_image(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options) {
  return MetaImage(file, bytes, options).read();
}

}  // namespace aureole::grid_reader
