// SPDX-License-Identifier: Apache-2.0
// Text files of OpenUSD (.usda) with prims ParticleField3DGaussianSplat (schema UsdVol of OpenUSD 26): linear scales,
// opacities in [0, 1], quaternions with the real part first, harmonics by splat. Lengths of the attributes follow the
// schema: what is too long is cut, what is too short is left out.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "aureole/core/parallel.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_reader.h"

namespace aureole::splat_reader {

namespace {

/// Numbers of an attribute.
struct UsdNumbers {
  bool is_there = false;
  std::vector<float> values;
};

/// The attributes of a prim of splats.
struct UsdSplats {
  std::string name;
  UsdNumbers positions, orientations, scales, opacities, harmonics;
  UsdNumbers positions_h, orientations_h, scales_h, opacities_h, harmonics_h;  ///< of half precision
  int degree = 3;
  std::string projection, sorting, visibility;
};

class UsdaReader {
public:
  UsdaReader(const SharedBytes& bytes, SplatCloud& cloud)
      : at_(reinterpret_cast<const char*>(bytes.bytes.data())),
        begin_(at_),
        end_(at_ + bytes.size()),
        cloud_(cloud) {}

  /// Reads the layer. The splats of all prims follow each other.
  std::vector<UsdSplats> read() {
    const std::string_view metadata = take_metadata();
    note_references(metadata, "the layer");
    if (const auto up = metadata.find("upAxis");
        up != metadata.npos && metadata.substr(up, 40).find("\"Z\"") != metadata.npos)
      cloud_.notes.push_back(
          "has its z axis up: its numbers are taken as they are, and to_world may turn them");
    for (;;) {
      skip_blanks();
      if (at_ == end_) break;
      read_statement(nullptr, 0);
    }
    return std::move(found_);
  }

private:
  Error fault(const std::string& message) const {
    const auto line = std::count(begin_, at_, '\n') + 1;
    return Error({{}, int(std::min<std::ptrdiff_t>(line, 1 << 30)), 0}, message);
  }
  static bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == ':' || c == '.' || c == '-' || c == '+' || static_cast<unsigned char>(c) >= 128;
  }
  void skip_blanks() {
    while (at_ < end_) {
      if (*at_ == '#')
        while (at_ < end_ && *at_ != '\n') ++at_;
      else if (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n' || *at_ == ';' || *at_ == ',')
        ++at_;
      else
        return;
    }
  }
  bool next_is(char c) {
    skip_blanks();
    return at_ < end_ && *at_ == c;
  }
  /// Takes a name, a type with its brackets, or a keyword.
  std::string_view take_word() {
    skip_blanks();
    const char* from = at_;
    while (at_ < end_ && is_word(*at_)) ++at_;
    if (at_ == from) throw fault(fmt::format("has \"{}\" where a name is expected", shown()));
    if (end_ - at_ >= 2 && at_[0] == '[' && at_[1] == ']') at_ += 2;
    return {from, std::size_t(at_ - from)};
  }
  std::string shown() const {
    return std::string(at_, std::size_t(std::min<std::ptrdiff_t>(end_ - at_, 20)));
  }
  /// Takes a string in quotes, of one line or of several. Returns its text.
  std::string_view take_string() {
    const char quote = *at_;
    const bool is_long = end_ - at_ >= 3 && at_[1] == quote && at_[2] == quote;
    at_ += is_long ? 3 : 1;
    const char* from = at_;
    while (at_ < end_) {
      if (*at_ == '\\' && end_ - at_ >= 2) {
        at_ += 2;
      } else if (*at_ == quote && (!is_long || (end_ - at_ >= 3 && at_[1] == quote && at_[2] == quote))) {
        const std::string_view text(from, std::size_t(at_ - from));
        at_ += is_long ? 3 : 1;
        return text;
      } else {
        ++at_;
      }
    }
    throw fault("ends within a string");
  }
  /// Passes over a value: a word, a string, or brackets with all that they hold. Returns its text.
  std::string_view take_value() {
    skip_blanks();
    const char* from = at_;
    std::size_t open = 0;
    do {
      skip_blanks();
      if (at_ == end_) throw fault("ends within a value");
      const char c = *at_;
      if (c == '"' || c == '\'') {
        take_string();
      } else if (c == '@' || c == '<') {
        const char close = c == '<' ? '>' : '@';
        do ++at_;
        while (at_ < end_ && *at_ != close && *at_ != '\n');
        if (at_ == end_ || *at_ != close) throw fault("ends within a path");
        ++at_;
      } else if (c == '(' || c == '[' || c == '{') {
        ++open, ++at_;
      } else if (c == ')' || c == ']' || c == '}') {
        if (open == 0) throw fault(fmt::format("has \"{}\" where a value is expected", shown()));
        --open, ++at_;
      } else if (is_word(c)) {
        while (at_ < end_ && is_word(*at_)) ++at_;
      } else {
        ++at_;
      }
    } while (open > 0);
    return {from, std::size_t(at_ - from)};
  }
  std::string_view take_metadata() { return next_is('(') ? take_value() : std::string_view(); }

  void note_references(std::string_view metadata, const std::string& of) {
    for (const char* name : {"subLayers", "references", "payload", "inherits", "variantSets"})
      if (metadata.find(name) != metadata.npos)
        cloud_.notes.push_back(fmt::format("has {} of {}, which have no effect", name, of));
  }

  /// Reads numbers in brackets, each alone or in tuples of `width`.
  void take_numbers(std::size_t width, UsdNumbers& out) {
    out.is_there = true, out.values.clear();
    if (!next_is('[')) {
      if (take_value() != "None") throw fault("has a value that is no array of numbers");
      out.is_there = false;
      return;
    }
    ++at_;
    for (;;) {
      skip_blanks();
      if (at_ == end_) throw fault("ends within an array");
      if (*at_ == ']') break;
      const bool is_tuple = *at_ == '(';
      if (is_tuple != (width > 1))
        throw fault(fmt::format("has \"{}\" where {} expected", shown(),
                                width > 1 ? fmt::format("a tuple of {} numbers is", width) : "a number is"));
      if (is_tuple) ++at_;
      for (std::size_t k = 0; k < width; ++k) {
        skip_blanks();
        float v = 0;
        const auto [stop, code] = std::from_chars(at_, end_, v);
        if (code == std::errc::invalid_argument)
          throw fault(fmt::format("has \"{}\" where a number is expected", shown()));
        // Numbers beyond the range of float are infinite or 0, and counted as those that are not finite.
        if (code == std::errc::result_out_of_range) {
          double wide = 0;
          std::from_chars(at_, end_, wide);
          v = float(wide);
        }
        at_ = stop;
        out.values.push_back(v);
      }
      if (is_tuple) {
        if (!next_is(')')) throw fault(fmt::format("has a tuple that should have {} numbers", width));
        ++at_;
      }
    }
    ++at_;
  }

  /// Reads a prim, a property or another statement. `splats` are those of the prim that holds it, or null.
  void read_statement(UsdSplats* splats, int depth) {
    std::string_view word = take_word();
    if (word == "def" || word == "over" || word == "class") return read_prim(word, depth);
    if (word == "variantSet") {
      take_value();
      if (next_is('=')) ++at_, take_value();
      return;
    }
    // Modifiers, type and name: the last word before "=", a parenthesis or the end of the line is the name.
    std::string_view name = word;
    bool is_uniform = false;
    for (;;) {
      is_uniform |= name == "uniform";
      while (at_ < end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
      if (at_ == end_ || !is_word(*at_)) break;
      name = take_word();
    }
    if (next_is('=')) {
      ++at_;
      read_value(name, splats);
    }
    take_metadata();
  }

  void read_value(std::string_view name, UsdSplats* splats) {
    if (name.starts_with("xformOp:")) {
      const std::string_view value = take_value();
      if (!is_identity(name, value))
        throw fault(
            fmt::format("places its splats by \"{}\", which is not read: flatten the layer, or place them by "
                        "to_world",
                        name.substr(0, 60)));
      return;
    }
    if (!splats) {
      take_value();
      return;
    }
    if (name.ends_with(".timeSamples"))
      throw fault(fmt::format("has \"{}\": splats that change with time are not read", name.substr(0, 60)));
    constexpr std::string_view kHarmonics = "radiance:sphericalHarmonicsCoefficients";
    struct Array {
      std::string_view name;
      std::size_t width;
      UsdNumbers *full, *half;
    };
    const Array arrays[] = {{"positions", 3, &splats->positions, &splats->positions_h},
                            {"orientations", 4, &splats->orientations, &splats->orientations_h},
                            {"scales", 3, &splats->scales, &splats->scales_h},
                            {"opacities", 1, &splats->opacities, &splats->opacities_h},
                            {kHarmonics, 3, &splats->harmonics, &splats->harmonics_h}};
    for (const Array& array : arrays) {
      if (name == array.name) return take_numbers(array.width, *array.full);
      if (name.size() == array.name.size() + 1 && name.starts_with(array.name) && name.back() == 'h')
        return take_numbers(array.width, *array.half);
    }
    const std::string_view value = take_value();
    const auto unquoted = [&] {
      return value.size() >= 2 && value.front() == '"' ? std::string(value.substr(1, value.size() - 2))
                                                       : std::string(value);
    };
    if (name == "radiance:sphericalHarmonicsDegree") {
      int degree = -1;
      std::from_chars(value.data(), value.data() + value.size(), degree);
      if (degree < 0 || degree > 8)
        throw fault(fmt::format("has harmonics of degree \"{}\"; 0 to 8 are possible", value.substr(0, 20)));
      splats->degree = degree;
    } else if (name == "projectionModeHint") {
      splats->projection = unquoted();
    } else if (name == "sortingModeHint") {
      splats->sorting = unquoted();
    } else if (name == "visibility") {
      splats->visibility = unquoted();
    }
  }

  /// Whether an operation of a transform changes nothing.
  static bool is_identity(std::string_view name, std::string_view value) {
    std::string text;
    for (const char c : value)
      if (c != ' ' && c != '\t' && c != '\n' && c != '\r') text += c;
    if (name.starts_with("xformOp:scale")) return text == "(1,1,1)";
    if (name.starts_with("xformOp:orient")) return text == "(1,0,0,0)";
    if (name.starts_with("xformOp:transform")) return text == "((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))";
    return text == "(0,0,0)" || text == "0";
  }

  void read_prim(std::string_view specifier, int depth) {
    constexpr int kMaxDepth = 64;
    if (depth > kMaxDepth) throw fault(fmt::format("has prims nested more than {} deep", kMaxDepth));
    skip_blanks();
    std::string_view type;
    if (at_ < end_ && *at_ != '"') type = take_word();
    skip_blanks();
    if (at_ == end_ || *at_ != '"') throw fault("has a prim without a name");
    UsdSplats splats;
    splats.name = take_string().substr(0, 60);
    note_references(take_metadata(), "\"" + splats.name + "\"");
    const bool is_splats = specifier == "def" && type == "ParticleField3DGaussianSplat";
    if (specifier == "def" && type.starts_with("ParticleField") && !is_splats)
      cloud_.notes.push_back(
          fmt::format("has the {} \"{}\", which is no ParticleField3DGaussianSplat: left out",
                      type.substr(0, 60), splats.name));
    if (!next_is('{'))
      throw fault(fmt::format("has \"{}\" where the content of a prim is expected", shown()));
    ++at_;
    while (!next_is('}')) {
      if (at_ == end_) throw fault(fmt::format("ends within the prim \"{}\"", splats.name));
      read_statement(is_splats ? &splats : nullptr, depth + 1);
    }
    ++at_;
    if (!is_splats) return;
    if (splats.visibility == "invisible")
      cloud_.notes.push_back(fmt::format("has the invisible splats \"{}\": left out", splats.name));
    else
      found_.push_back(std::move(splats));
  }

  const char* at_;
  const char *const begin_, *const end_;
  SplatCloud& cloud_;
  std::vector<UsdSplats> found_;
};

/// Sets hints that all prims of a file share.
void set_hints(const UsdSplats& s, bool is_first, SplatCloud& cloud) {
  SplatHints hints;
  if (s.projection == "tangential")
    hints.projection = SplatHints::Projection::tangential;
  else if (!s.projection.empty() && s.projection != "perspective")
    throw Error("has the projectionModeHint \"" + s.projection.substr(0, 40) +
                "\"; perspective and tangential are known");
  if (s.sorting == "cameraDistance" || s.sorting == "rayHitDistance")
    hints.sorting = SplatHints::Sorting::camera_distance;
  else if (!s.sorting.empty() && s.sorting != "zDepth")
    throw Error("has the sortingModeHint \"" + s.sorting.substr(0, 40) +
                "\"; zDepth, cameraDistance and rayHitDistance are known");
  if (s.sorting == "rayHitDistance")
    cloud.notes.push_back(
        "asks for an order by the distance of hits of rays: the distance of centres is taken");
  if (!is_first && !(hints == cloud.hints))
    throw Error("has splats of several prims that differ in their hints of sorting or projection");
  cloud.hints = hints;
}

}  // namespace

SplatCloud read_usda(const Path&, const SharedBytes& bytes, const SplatFileOptions&) {
  SplatCloud c;
  c.format = "OpenUSD, ParticleField3DGaussianSplat", c.axes = "RUB";
  std::vector<UsdSplats> all = UsdaReader(bytes, c).read();
  if (all.empty()) throw Error("has no prim of the type ParticleField3DGaussianSplat");
  std::size_t count = 0;
  int degree = 0;
  for (UsdSplats& s : all) {
    const auto prefer_full = [](UsdNumbers& full, UsdNumbers& half) {
      if (!full.is_there) full = std::move(half);
    };
    prefer_full(s.positions, s.positions_h), prefer_full(s.orientations, s.orientations_h);
    prefer_full(s.scales, s.scales_h), prefer_full(s.opacities, s.opacities_h);
    prefer_full(s.harmonics, s.harmonics_h);
    set_hints(s, &s == &all.front(), c);
    const std::size_t n = s.positions.values.size() / 3;
    const auto fit = [&](UsdNumbers& numbers, std::size_t width, const char* name) {
      if (!numbers.is_there) return;
      const std::size_t wanted = n * width;
      if (numbers.values.size() < wanted) {
        c.notes.push_back(
            fmt::format("has {} numbers of {} for {} splats, which is too few: left out, as the schema says",
                        numbers.values.size(), name, n));
        numbers = {};
      } else if (numbers.values.size() > wanted) {
        c.notes.push_back(
            fmt::format("has {} numbers of {} for {} splats: those that are too many are left out",
                        numbers.values.size(), name, n));
        numbers.values.resize(wanted);
      }
    };
    fit(s.orientations, 4, "orientations"), fit(s.scales, 3, "scales"), fit(s.opacities, 1, "opacities");
    fit(s.harmonics, 3 * std::size_t((s.degree + 1) * (s.degree + 1)), "harmonics");
    if (!s.harmonics.is_there) s.degree = 0;
    if (s.degree > kMaxHarmonicDegree)
      c.notes.push_back(fmt::format("has harmonics of degree {}; those above {} are left out", s.degree,
                                    kMaxHarmonicDegree));
    degree = std::max(degree, std::min(s.degree, kMaxHarmonicDegree));
    count += n;
  }
  if (count == 0) throw Error("has no splats: the prims have no positions");
  if (count > kMaxSplats) throw Error(fmt::format("has {} splats; {} are possible", count, kMaxSplats));
  c.resize(count, degree);
  std::size_t at = 0, uneven = 0;
  const std::size_t terms = c.coefficients();
  for (const UsdSplats& s : all) {
    const std::size_t n = s.positions.values.size() / 3,
                      stored_terms = std::size_t((s.degree + 1) * (s.degree + 1));
    for (std::size_t i = 0; i < n; ++i, ++at) {
      for (std::size_t k = 0; k < 3; ++k) {
        c.positions[at][int(k)] = s.positions.values[3 * i + k];
        c.scales[at][int(k)] = s.scales.is_there ? s.scales.values[3 * i + k] : 1;
      }
      for (std::size_t k = 0; k < 4; ++k)
        c.rotations[at][k] = s.orientations.is_there ? s.orientations.values[4 * i + k] : float(k == 0);
      double squares = 0;
      for (const float v : c.rotations[at]) squares += double(v) * double(v);
      uneven += std::abs(squares - 1) > 0.02;
      c.opacities[at] = s.opacities.is_there ? s.opacities.values[i] : 1;
      for (std::size_t term = 0; term < terms; ++term)
        for (std::size_t k = 0; k < 3; ++k)
          c.harmonics[3 * (terms * at + term) + k] =
              s.harmonics.is_there && term < stored_terms
                  ? s.harmonics.values[3 * (stored_terms * i + term) + k]
                  : 0;
    }
  }
  if (uneven > 0)
    c.notes.push_back(
        fmt::format("has {} splats whose rotation is no unit quaternion: they are normalised", uneven));
  return c;
}

}  // namespace aureole::splat_reader
