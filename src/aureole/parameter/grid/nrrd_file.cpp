// SPDX-License-Identifier: Apache-2.0
// NRRD (teem.sourceforge.net/nrrd/format.html): a header of text, the numbers behind it or in other files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>

#include "aureole/parameter/grid/grid_reader.h"

namespace aureole::grid_reader {

namespace {

constexpr std::size_t kLongestHeader = 1 << 22;

struct Field {
  std::string value;
  int line = 0;
};

/// Fields of the header, by the name that the format's definition lists first.
struct NrrdHeader {
  std::map<std::string, Field, std::less<>> fields;
  std::vector<Field> listed;  ///< names of files after "data file: LIST"
  std::size_t end = 0;        ///< position of the first byte after the header
};

const std::map<std::string, std::string, std::less<>> kOtherNames = {
    {"datafile", "data file"},      {"centers", "centerings"},   {"lineskip", "line skip"},
    {"byteskip", "byte skip"},      {"blocksize", "block size"}, {"axismins", "axis mins"},
    {"axismaxs", "axis maxs"},      {"oldmin", "old min"},       {"oldmax", "old max"},
    {"sampleunits", "sample units"}};

const std::vector<std::string> kFields = {"dimension",
                                          "type",
                                          "sizes",
                                          "encoding",
                                          "endian",
                                          "data file",
                                          "line skip",
                                          "byte skip",
                                          "space",
                                          "space dimension",
                                          "space directions",
                                          "space origin",
                                          "space units",
                                          "spacings",
                                          "axis mins",
                                          "axis maxs",
                                          "kinds",
                                          "centerings",
                                          "units",
                                          "labels",
                                          "thicknesses",
                                          "content",
                                          "old min",
                                          "old max",
                                          "block size",
                                          "sample units",
                                          "measurement frame",
                                          "number",
                                          "min",
                                          "max"};

NrrdHeader header_of(std::string_view text) {
  NrrdHeader header;
  std::size_t at = 0;
  bool in_list = false;
  for (int line_number = 1; at < text.size(); ++line_number) {
    if (at > kLongestHeader) throw Error("has a header of more than 4 MiB");
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = std::min(end + 1, text.size());
    if (line.ends_with('\r')) line.remove_suffix(1);
    header.end = at;
    if (line.empty()) break;
    const SourceLocation where{{}, line_number, 0};
    if (line_number == 1) {
      if (line.size() != 8 || line < "NRRD0001" || line > "NRRD0005")
        throw Error(where,
                    fmt::format("has \"{}\" where NRRD0001 to NRRD0005 is expected", line.substr(0, 20)));
      continue;
    }
    if (in_list) {
      if (header.listed.size() >= kMaxFiles) throw Error(where, "lists too many files");
      header.listed.push_back({std::string(line), line_number});
      continue;
    }
    if (line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == line.npos)
      throw Error(where,
                  fmt::format("has \"{}\" where \"field: value\" is expected, such as \"dimension: 3\"",
                              line.substr(0, 40)));
    if (line.substr(colon, 2) == ":=") continue;  // skips keys of the user
    std::string name = lowered(trimmed(line.substr(0, colon)));
    if (const auto other = kOtherNames.find(name); other != kOtherNames.end()) name = other->second;
    if (std::find(kFields.begin(), kFields.end(), name) == kFields.end())
      throw Error(where, fmt::format("has the unknown field \"{}\"", name) + did_you_mean(name, kFields));
    const std::string value(trimmed(line.substr(colon + 1)));
    if (!header.fields.emplace(name, Field{value, line_number}).second)
      throw Error(where, fmt::format("has the field \"{}\" twice", name));
    in_list = name == "data file" && (value == "LIST" || value.starts_with("LIST "));
  }
  return header;
}

/// The reader of one file. Functions that read fields locate their errors at the lines of the fields.
class Nrrd {
public:
  Nrrd(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options)
      : file_(file),
        bytes_(bytes),
        options_(options),
        header_(header_of({reinterpret_cast<const char*>(bytes.bytes.data()), bytes.size()})) {}

  ScalarGrid read() {
    ScalarGrid grid;
    grid.format = "NRRD";
    grid.has_transform = true;
    grid.type = type();
    const std::vector<std::int64_t> sizes = at("sizes", [](auto& v) { return integers_of(v); });
    const auto dimension = at("dimension", [](auto& v) { return integer_of(v); });
    if (dimension != std::int64_t(sizes.size()) || dimension < 1 || dimension > 16)
      throw error("sizes", fmt::format("has {} sizes and the dimension {}; three axes of space are expected",
                                       sizes.size(), dimension));
    const std::uint64_t count = at("sizes", [&](auto&) { return count_of(sizes, grid.type); });
    roles(sizes);
    if (bytes_of(grid.type) > 1) {
      const Encoding e = encoding();
      if (e != Encoding::text) {
        const std::string order = at("endian", [](auto& v) { return lowered(v); });
        if (order != "little" && order != "big")
          throw error("endian", "has the endian \"" + order + "\"; little and big are known");
        grid.is_swapped = order == "big";
      }
    }
    read_numbers(grid, sizes, count);
    std::vector<GridAxis> axes;
    for (std::size_t i = 0; i < sizes.size(); ++i) axes.push_back({sizes[i], roles_[i]});
    arrange(grid, axes, options_);
    set_place(grid);
    for (const char* name : {"old min", "old max", "measurement frame"})
      if (header_.fields.contains(name))
        grid.notes.push_back(fmt::format("has the field \"{}\", which is not used", name));
    return grid;
  }

private:
  Error error(std::string_view field, const std::string& message) const {
    const auto found = header_.fields.find(field);
    return Error({{}, found == header_.fields.end() ? 0 : found->second.line, 0}, message);
  }
  bool has(std::string_view field) const { return header_.fields.contains(field); }
  /// Returns read(value) of a required field.
  template <class Read>
  std::invoke_result_t<const Read&, const std::string&> at(const char* field, const Read& read) const {
    const auto found = header_.fields.find(field);
    if (found == header_.fields.end())
      throw Error(fmt::format("has no field \"{}\", which is required here", field));
    try {
      return read(found->second.value);
    } catch (const Error& problem) {
      throw at_line(problem, found->second.line);
    }
  }

  ScalarType type() const {
    static const std::map<std::string, ScalarType, std::less<>> kNames = {
        {"signed char", ScalarType::int8},
        {"int8", ScalarType::int8},
        {"int8_t", ScalarType::int8},
        {"uchar", ScalarType::uint8},
        {"unsigned char", ScalarType::uint8},
        {"uint8", ScalarType::uint8},
        {"uint8_t", ScalarType::uint8},
        {"short", ScalarType::int16},
        {"short int", ScalarType::int16},
        {"signed short", ScalarType::int16},
        {"signed short int", ScalarType::int16},
        {"int16", ScalarType::int16},
        {"int16_t", ScalarType::int16},
        {"ushort", ScalarType::uint16},
        {"unsigned short", ScalarType::uint16},
        {"unsigned short int", ScalarType::uint16},
        {"uint16", ScalarType::uint16},
        {"uint16_t", ScalarType::uint16},
        {"int", ScalarType::int32},
        {"signed int", ScalarType::int32},
        {"int32", ScalarType::int32},
        {"int32_t", ScalarType::int32},
        {"uint", ScalarType::uint32},
        {"unsigned int", ScalarType::uint32},
        {"uint32", ScalarType::uint32},
        {"uint32_t", ScalarType::uint32},
        {"longlong", ScalarType::int64},
        {"long long", ScalarType::int64},
        {"long long int", ScalarType::int64},
        {"signed long long", ScalarType::int64},
        {"signed long long int", ScalarType::int64},
        {"int64", ScalarType::int64},
        {"int64_t", ScalarType::int64},
        {"ulonglong", ScalarType::uint64},
        {"unsigned long long", ScalarType::uint64},
        {"unsigned long long int", ScalarType::uint64},
        {"uint64", ScalarType::uint64},
        {"uint64_t", ScalarType::uint64},
        {"float", ScalarType::float32},
        {"double", ScalarType::float64}};
    return at("type", [](const std::string& v) {
      const auto found = kNames.find(lowered(v));
      if (found == kNames.end())
        throw Error("has numbers of the type \"" + v.substr(0, 40) +
                    "\"; int8 to uint64, float and double are known");
      return found->second;
    });
  }

  Encoding encoding() const {
    return at("encoding", [](const std::string& v) {
      const std::string e = lowered(v);
      if (e == "raw") return Encoding::raw;
      if (e == "txt" || e == "text" || e == "ascii") return Encoding::text;
      if (e == "hex") return Encoding::hex;
      if (e == "gz" || e == "gzip") return Encoding::gzip;
      if (e == "bz2" || e == "bzip2") return Encoding::bzip2;
      throw Error("has the encoding \"" + v.substr(0, 40) + "\"; raw, gzip, bzip2, ascii and hex are known");
    });
  }

  /// Returns the directions of the axes: a vector, or nothing for an axis that is not spatial.
  std::vector<std::optional<std::array<double, 3>>> directions(std::size_t count) const {
    std::vector<std::optional<std::array<double, 3>>> all;
    at("space directions", [&](const std::string& text) {
      for (std::size_t i = 0; i < text.size();) {
        if (text[i] == ' ' || text[i] == '\t') {
          ++i;
        } else if (text[i] == '(') {
          const std::size_t end = text.find(')', i);
          all.emplace_back(vector(std::string_view(text).substr(i, end == text.npos ? end : end + 1 - i)));
          i = end == text.npos ? text.size() : end + 1;
        } else {
          const std::size_t end = std::min(text.find_first_of(" \t(", i), text.size());
          if (lowered(text.substr(i, end - i)) != "none")
            throw Error("has \"" + text.substr(i, std::min<std::size_t>(end - i, 40)) +
                        "\" where a direction or \"none\" is expected, such as (0.5,0,0)");
          all.emplace_back();
          i = end;
        }
      }
      return 0;
    });
    if (all.size() != count)
      throw error("space directions", fmt::format("has {} directions for {} axes", all.size(), count));
    return all;
  }
  static std::array<double, 3> vector(std::string_view text) {
    std::string inner(trimmed(text));
    if (!inner.starts_with('(') || !inner.ends_with(')'))
      throw Error("has \"" + inner.substr(0, 40) + "\" where a vector is expected, such as (0.5,0,0)");
    inner = inner.substr(1, inner.size() - 2);
    if (std::count(inner.begin(), inner.end(), ',') != 2)
      throw Error("has \"" + inner.substr(0, 60) + "\" where three numbers with commas are expected");
    std::replace(inner.begin(), inner.end(), ',', ' ');
    const std::vector<double> v = numbers_of(inner, 3);
    return {v[0], v[1], v[2]};
  }

  /// Determines the role of each axis: 'x', 'y' or 'z' in space, 'c' for channels or 't' for time.
  void roles(const std::vector<std::int64_t>& sizes) {
    const std::size_t n = sizes.size();
    std::vector<std::string> kinds(n, "???");
    if (has("kinds")) {
      kinds = at("kinds", [](auto& v) { return words_of(lowered(v)); });
      if (kinds.size() != n) throw error("kinds", fmt::format("has {} kinds for {} axes", kinds.size(), n));
    }
    std::vector<bool> is_space(n);
    const auto is_unknown = [&](std::size_t i) { return kinds[i] == "???" || kinds[i] == "none"; };
    if (has("space directions")) {
      const auto all = directions(n);
      for (std::size_t i = 0; i < n; ++i) is_space[i] = all[i].has_value();
    } else {
      for (std::size_t i = 0; i < n; ++i)
        is_space[i] = kinds[i] == "domain" || kinds[i] == "space" || (n == 3 && is_unknown(i));
    }
    if (std::count(is_space.begin(), is_space.end(), true) != 3)
      throw error(
          has("space directions") ? "space directions"
          : has("kinds")          ? "kinds"
                                  : "sizes",
          "has not exactly three axes of space; \"space directions\" with \"none\" for the others, or "
          "\"kinds\" with \"domain\", say which they are");
    char next = 'x';
    for (std::size_t i = 0; i < n; ++i) {
      if (is_space[i]) {
        roles_ += next++;
        continue;
      }
      const bool is_frames = kinds[i] == "list" || kinds[i] == "time" || (is_unknown(i) && i > 0);
      const char role = is_frames ? 't' : 'c';
      if (roles_.find(role) != roles_.npos)
        throw error("sizes", "has more than one axis of channels or more than one of frames");
      roles_ += role;
    }
  }

  void read_numbers(ScalarGrid& grid, const std::vector<std::int64_t>& sizes, std::uint64_t count) {
    const Encoding e = encoding();
    const auto skip = [&](const char* field) {
      return has(field) ? at(field, [](auto& v) { return integer_of(v); }) : std::int64_t(0);
    };
    const std::int64_t lines = skip("line skip"), byte_skip = skip("byte skip");
    if (lines < 0) throw error("line skip", "has a line skip below 0");
    std::vector<std::string> names;
    std::size_t sub_dimension = sizes.size() - 1;  // number of dimensions of one file of several
    if (has("data file"))
      at("data file", [&](const std::string& v) {
        const std::vector<std::string> words = words_of(v);
        if (words.empty()) throw Error("names no data file");
        if (words[0] == "LIST") {
          if (words.size() > 2)
            throw Error("has \"" + v.substr(0, 40) + "\" where LIST or LIST 2 is expected");
          if (words.size() == 2) sub_dimension = sub(words[1], sizes.size());
          for (const Field& f : header_.listed) names.push_back(f.value);
          if (names.empty()) throw Error("lists no files behind LIST");
        } else if (words.size() >= 4 && words[0].find('%') != std::string::npos) {
          names =
              names_of_pattern(words[0], integer_of(words[1]), integer_of(words[2]), integer_of(words[3]));
          if (words.size() > 4) sub_dimension = sub(words[4], sizes.size());
        } else
          names = {v};
        return 0;
      });
    if (names.empty()) {
      const SharedBytes numbers = after_lines(bytes_.from(header_.end), lines);
      grid.numbers = decode(numbers, e, byte_skip, count, grid.type);
      note_surplus(grid, numbers, e, byte_skip, count);
      return;
    }
    std::uint64_t each = count;
    if (names.size() > 1) {
      // Each file is a slice of the first axes; together they fill the grid.
      each = 1;
      for (std::size_t i = 0; i < sub_dimension; ++i) each *= std::uint64_t(sizes[i]);
      if (each * names.size() != count) {
        if (sub_dimension != sizes.size() || count % names.size() != 0)
          throw error("data file", fmt::format("has {} files of {} numbers each for a grid of {}",
                                               names.size(), each, count));
        each = count / names.size();  // each file is a slab along the last axis
      }
    }
    std::vector<SharedBytes> pieces;
    for (const std::string& name : names) {
      const Path data = file_.parent_path() / name;
      at("data file", [&](auto&) {
        const SharedBytes source = map_file(data);
        try {
          const SharedBytes numbers = after_lines(source, lines);
          pieces.push_back(decode(numbers, e, byte_skip, each, grid.type));
          if (pieces.size() == 1) note_surplus(grid, numbers, e, byte_skip, each);
        } catch (const Error& problem) {
          throw Error("names \"" + name + "\", which " + problem.message());
        }
        return 0;
      });
      grid.further_files.push_back(data);
    }
    grid.numbers = joined(std::move(pieces));
  }
  static std::size_t sub(const std::string& word, std::size_t dimension) {
    const std::int64_t n = integer_of(word);
    if (n < 1 || n > std::int64_t(dimension))
      throw Error(fmt::format("has files of {} axes; 1 to {} are possible", n, dimension));
    return std::size_t(n);
  }
  static SharedBytes after_lines(const SharedBytes& source, std::int64_t lines) {
    std::size_t at = 0;
    const std::string_view text(reinterpret_cast<const char*>(source.bytes.data()), source.size());
    for (std::int64_t i = 0; i < lines; ++i) {
      const std::size_t end = text.find('\n', at);
      if (end == text.npos)
        throw Error(fmt::format("is truncated: {} lines are to be skipped, but it has {}", lines, i));
      at = end + 1;
    }
    return source.from(at);
  }

  /// Returns the letters of the directions of the axes of space, such as "RAS"; empty where the file names
  /// none.
  std::string space() const {
    if (!has("space")) return "";
    return at("space", [](const std::string& v) {
      std::string s = lowered(v);
      for (const char* suffix : {"-time", "t"})
        if (s.ends_with(suffix) && s.size() > 3 && s.find("scanner") == s.npos && s != "right" &&
            s != "left") {
          const std::string shorter = s.substr(0, s.size() - std::string_view(suffix).size());
          if (shorter.ends_with("superior") || shorter.size() == 3) s = shorter;
        }
      if (s == "ras" || s == "right-anterior-superior") return std::string("RAS");
      if (s == "las" || s == "left-anterior-superior") return std::string("LAS");
      if (s == "lps" || s == "left-posterior-superior") return std::string("LPS");
      for (const char* other : {"scanner-xyz", "3d-right-handed", "3d-left-handed"})
        if (s == other) return std::string();
      throw Error("has the space \"" + v.substr(0, 60) +
                  "\"; left-posterior-superior (LPS), right-anterior-superior (RAS), left-anterior-superior "
                  "(LAS), scanner-xyz, 3D-right-handed and 3D-left-handed are known");
    });
  }

  /// Reads a field with a number for each axis and returns the numbers of the three spatial axes.
  std::array<double, 3> per_axis(const char* field) const {
    const std::vector<double> all = at(field, [&](auto& v) { return numbers_of(v, roles_.size()); });
    std::array<double, 3> found{};
    for (std::size_t i = 0, k = 0; i < roles_.size(); ++i)
      if (is_space(i)) found[k++] = all[i];
    return found;
  }
  bool is_space(std::size_t axis) const { return roles_[axis] >= 'x' && roles_[axis] <= 'z'; }

  void set_place(ScalarGrid& grid) const {
    std::array<std::array<double, 3>, 3> columns{};
    std::array<double, 3> origin{0, 0, 0};
    read_unit(grid);
    if (has("space directions")) {
      std::size_t k = 0;
      for (const auto& direction : directions(roles_.size()))
        if (direction) columns[k++] = *direction;
      // The origin is the centre of the first sample, whatever the centering.
      if (has("space origin")) origin = at("space origin", [](auto& v) { return vector(v); });
      grid.spacing_is_stated = true;
      located("space directions", grid, columns, origin);
      return;
    }
    std::array<bool, 3> is_node{};
    if (has("centerings")) {
      const std::vector<std::string> all = at("centerings", [](auto& v) { return words_of(lowered(v)); });
      if (all.size() != roles_.size())
        throw error("centerings", fmt::format("has {} centerings for {} axes", all.size(), roles_.size()));
      for (std::size_t i = 0, k = 0; i < all.size(); ++i) {
        if (all[i] != "cell" && all[i] != "node" && all[i] != "none" && all[i] != "???")
          throw error("centerings",
                      "has the centering \"" + all[i].substr(0, 40) + "\"; cell and node are known");
        if (is_space(i)) is_node[k++] = all[i] == "node";
      }
    }
    const char* stated = nullptr;
    std::array<double, 3> step{1, 1, 1};
    const std::array<double, 3> nothing{NAN, NAN, NAN};
    const std::array<double, 3> low = has("axis mins") ? per_axis("axis mins") : nothing;
    const std::array<double, 3> high = has("axis maxs") ? per_axis("axis maxs") : nothing;
    if (has("spacings")) {
      step = per_axis("spacings");
      stated = "spacings";
    } else if (has("axis mins") && has("axis maxs")) {
      stated = "axis maxs";
      for (std::size_t k = 0; k < 3; ++k) {
        const int intervals = grid.size[k] - (is_node[k] ? 1 : 0);
        step[k] = (high[k] - low[k]) / intervals;
      }
    }
    if (!stated) {
      if (has("space origin"))
        throw error("space origin", "has a \"space origin\" without \"space directions\"");
      place_by_options(grid, options_);
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      columns[k][k] = step[k];
      if (!std::isnan(low[k])) origin[k] = low[k] + (is_node[k] ? 0 : step[k] / 2);
    }
    if (has("space origin")) origin = at("space origin", [](auto& v) { return vector(v); });
    grid.spacing_is_stated = true;
    located(stated, grid, columns, origin);
  }
  void located(const char* field, ScalarGrid& grid, const std::array<std::array<double, 3>, 3>& columns,
               const std::array<double, 3>& origin) const {
    const std::string letters = space();
    at(field, [&](auto&) {
      place(grid, columns, origin, letters, options_);
      return 0;
    });
  }

  void read_unit(ScalarGrid& grid) const {
    const char* const field = has("space units") ? "space units" : has("units") ? "units" : nullptr;
    if (!field || options_.unit_m) return;
    at(field, [&](const std::string& text) {
      // Reads words in quotation marks.
      std::vector<std::string> units;
      for (std::size_t i = text.find('"'); i != text.npos; i = text.find('"', i)) {
        const std::size_t end = text.find('"', i + 1);
        if (end == text.npos) throw Error("has a unit without its second quotation mark");
        units.push_back(text.substr(i + 1, end - i - 1));
        i = end + 1;
      }
      // a number for each axis, including axes that are not spatial
      if (field == std::string_view("units")) {
        if (units.size() != roles_.size())
          throw Error(fmt::format("has {} units for {} axes", units.size(), roles_.size()));
        std::vector<std::string> kept;
        for (std::size_t i = 0; i < units.size(); ++i)
          if (is_space(i)) kept.push_back(units[i]);
        units = kept;
      }
      std::optional<double> unit_m;
      for (const std::string& unit : units) {
        if (unit.empty()) continue;
        const std::optional<double> m = metres_of_unit(unit);
        if (!m)
          throw Error("has the unit \"" + unit.substr(0, 40) +
                      "\", which is unknown; \"file_unit\" states another, such as mm");
        if (unit_m && *unit_m != *m)
          throw Error("has different units along its axes, which is not supported");
        unit_m = m;
      }
      if (unit_m) grid.unit_m = *unit_m, grid.unit_is_stated = true;
      return 0;
    });
  }

  const Path& file_;
  const SharedBytes& bytes_;
  const ScalarGridOptions& options_;
  NrrdHeader header_;
  std::string roles_;  ///< roles of the axes
};

}  // namespace

ScalarGrid read_nrrd(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options) {
  return Nrrd(file, bytes, options).read();
}

}  // namespace aureole::grid_reader
