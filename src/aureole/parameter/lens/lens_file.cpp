// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/lens/lens_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/pigment/text_table.h"

namespace aureole {

namespace {

constexpr std::uint64_t kMaxLensBytes = std::uint64_t(1) << 22;
constexpr std::size_t kMostSurfaces = 200;
constexpr std::size_t kMostAspheric = 9;  // r^4 to r^20

struct LensWord {
  std::string_view text;
  int column = 0;
};

/// The words of a line, without a comment that `comment` begins (0: none).
std::vector<LensWord> lens_words_of(std::string_view line, char comment) {
  std::vector<LensWord> words;
  if (comment) line = line.substr(0, line.find(comment));
  constexpr std::string_view kBlanks = " \t\r,;";
  for (std::size_t at = line.find_first_not_of(kBlanks); at != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back({line.substr(at, end - at), int(at) + 1});
    at = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

/// Reads the lines of a file and makes located errors.
class LensLines {
public:
  LensLines(const std::string& text, std::filesystem::path file) : text_(text), file_(std::move(file)) {}

  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    line = std::string_view(text_).substr(at_, end - at_);
    at_ = end + 1, ++number_;
    return true;
  }
  [[nodiscard]] Error fault(int column, const std::string& message) const {
    return Error({file_.string(), number_, column}, message);
  }
  [[nodiscard]] Error fault_of_file(const std::string& message) const {
    return Error({file_.string(), 0, 0}, message);
  }
  double number(const LensWord& word, std::string_view text, const char* what) const {
    const auto value = pigment::finite_number(text);
    constexpr double kLargest = 1e9;
    if (!value || std::abs(*value) > kLargest)
      throw fault(word.column, fmt::format("expected {}, got \"{}\"", what, text));
    return *value;
  }
  double number(const LensWord& word, const char* what) const { return number(word, word.text, what); }

private:
  const std::string& text_;
  std::filesystem::path file_;
  std::size_t at_ = 0;
  int number_ = 0;
};

LensGlass glass_of(const LensLines& lines, const LensWord& word) {
  const std::string_view text = word.text;
  if (const std::size_t slash = text.find('/'); slash != text.npos) {
    const double nd = lines.number(word, text.substr(0, slash), "nd/Vd, such as 1.62/60.3");
    const double vd = lines.number(word, text.substr(slash + 1), "nd/Vd, such as 1.62/60.3");
    try {
      return LensGlass::of_abbe_number(nd, vd);
    } catch (const Error& e) {
      throw lines.fault(word.column, e.message());
    }
  }
  if (const auto index = pigment::finite_number(text)) {
    if (!(*index >= 1 && *index <= 10))
      throw lines.fault(word.column,
                        fmt::format("an index of refraction lies between 1 and 10, got {}", text));
    return LensGlass::of_index(*index);
  }
  if (auto glass = LensGlass::named(text)) return *glass;
  throw lines.fault(word.column,
                    fmt::format("unknown glass \"{}\"{}. An index, or nd/Vd, describes any glass", text,
                                did_you_mean(lower_case(text), refractive_index_names())));
}

double curvature_of(const LensLines& lines, const LensWord& word) {
  const std::string text = lower_case(word.text);
  if (text == "inf" || text == "infinity" || text == "plane" || text == "flat" || text == "-inf") return 0;
  const double radius = lines.number(word, "a radius of curvature in mm, \"plane\" or \"stop\"");
  return radius == 0 ? 0 : 1 / radius;
}

void read_coating(const LensLines& lines, const LensWord& word, std::string_view value,
                  optics::LensSurface& s) {
  if (value == "none") return void(s.coating_index = 0);
  if (value == "ideal") return void(s.coating_index = 1);
  const std::size_t at = value.find('@');
  const auto glass_index = [&](std::string_view text, double nm) {
    if (const auto n = pigment::finite_number(text)) return *n;
    if (const auto glass = LensGlass::named(text)) return glass->index(nm);
    throw lines.fault(
        word.column, fmt::format("coat= takes none, ideal, or index@nm such as 1.38@550, got \"{}\"", value));
  };
  s.coating_nm = at == value.npos ? 550 : lines.number(word, value.substr(at + 1), "a wavelength in nm");
  s.coating_index = glass_index(value.substr(0, at), s.coating_nm);
  if (!(s.coating_nm >= 100 && s.coating_nm <= 1e5))
    throw lines.fault(word.column, "the wavelength of a coating is in nm, from 100 to 100000");
  if (!(s.coating_index > 1 && s.coating_index < 5))
    throw lines.fault(word.column, "the index of a coating lies between 1 and 5");
}

void read_option(const LensLines& lines, const LensWord& word, optics::LensSurface& s) {
  const std::string text = lower_case(word.text);
  if (text == "stop") return void(s.is_stop = true);
  const std::size_t equals = text.find('=');
  const std::string key = text.substr(0, equals);
  const std::string_view value =
      equals == text.npos ? std::string_view() : std::string_view(text).substr(equals + 1);
  if (key == "k") {
    s.conic = lines.number(word, value, "a conic constant");
  } else if (key == "coat") {
    read_coating(lines, word, value, s);
  } else if (key.size() >= 2 && key[0] == 'a' && key.size() <= 3) {
    const auto order = pigment::finite_number(std::string_view(key).substr(1));
    if (!order || *order < 4 || *order > 20 || std::fmod(*order, 2) != 0)
      throw lines.fault(word.column, "aspheric coefficients are a4=, a6=, ... to a20=");
    const std::size_t index = std::size_t(*order / 2) - 2;
    if (s.even.size() <= index) s.even.resize(index + 1);
    s.even[index] = lines.number(word, value, "an aspheric coefficient");
  } else {
    throw lines.fault(word.column,
                      fmt::format("unknown \"{}\"; there are: k=, a4= to a20=, coat= and stop", word.text));
  }
}

LensPrescription read_lens_table(const std::string& text, const std::filesystem::path& file) {
  LensPrescription lens;
  LensLines lines(text, file);
  std::string_view line;
  while (lines.next(line)) {
    const std::vector<LensWord> words = lens_words_of(line, '#');
    if (words.empty()) continue;
    const std::string first = lower_case(words[0].text);
    if (first == "name") {
      if (words.size() > 1) {
        lens.name = std::string(line.substr(std::size_t(words[1].column) - 1));
        while (!lens.name.empty() && (lens.name.back() == '\r' || lens.name.back() == ' '))
          lens.name.pop_back();
      }
      continue;
    }
    if (words.size() < 4)
      throw lines.fault(
          words[0].column,
          fmt::format("a surface needs radius, thickness, glass and diameter; this line has {} of them",
                      words.size()));
    if (lens.surfaces.size() >= kMostSurfaces)
      throw lines.fault(1, fmt::format("more than {} surfaces", kMostSurfaces));
    optics::LensSurface s;
    const auto index = pigment::finite_number(words[2].text);
    s.is_stop = first == "stop" || (index && *index == 0);
    s.curvature = first == "stop" ? 0 : curvature_of(lines, words[0]);
    s.thickness = lines.number(words[1], "a thickness in mm");
    const bool is_air = s.is_stop && ((index && *index == 0) || words[2].text == "-");
    lens.glasses.push_back(is_air ? LensGlass::air() : glass_of(lines, words[2]));
    const double diameter = lines.number(words[3], "a diameter in mm");
    if (!(diameter > 0)) throw lines.fault(words[3].column, "a diameter must be positive");
    s.semi_diameter = 0.5 * diameter;
    for (std::size_t i = 4; i < words.size(); ++i) read_option(lines, words[i], s);
    if (!optics::LensSystem::sag(s, s.semi_diameter))
      throw lines.fault(words[3].column,
                        "the surface ends before this diameter: its radius of curvature is too small for it");
    lens.surfaces.push_back(std::move(s));
  }
  if (lens.surfaces.empty()) throw lines.fault_of_file("has no surface of a lens");
  return lens;
}

LensPrescription read_zmx(const std::string& text, const std::filesystem::path& file) {
  LensPrescription lens;
  LensLines lines(text, file);
  std::string_view line;
  double unit = 1;
  std::set<std::string> unused;
  bool in_surface = false;
  const std::set<std::string> kOfNoEffect{
      "VERS", "MODE", "NOTE", "COMM", "WAVM", "WAVL", "WWGT", "PWAV", "FTYP", "XFLN", "YFLN", "FWGN", "VDXN",
      "VDYN", "VCXN", "VCYN", "VANN", "GCAT", "RAIM", "PUSH", "SDMA", "ROPD", "PICB", "XFLD", "YFLD", "FWGT",
      "ENPD", "FNUM", "GFAC", "SLAB", "HIDE", "MIRR", "POPS", "FLAP", "VDSZ", "ENVD", "PRIM", "EFFL"};
  while (lines.next(line)) {
    const std::vector<LensWord> words = lens_words_of(line, 0);
    if (words.empty()) continue;
    const std::string key(words[0].text);
    const auto need = [&](std::size_t count) {
      if (words.size() < count + 1)
        throw lines.fault(words[0].column,
                          fmt::format("{} needs {} value{}", key, count, count == 1 ? "" : "s"));
    };
    if (key == "NAME") {
      for (std::size_t i = 1; i < words.size(); ++i)
        lens.name += (i > 1 ? " " : "") + std::string(words[i].text);
      continue;
    }
    if (key == "UNIT") {
      need(1);
      const std::string name = lower_case(words[1].text);
      if (name != "mm" && name != "cm" && name != "in" && name != "inch" && name != "meter")
        throw lines.fault(words[1].column,
                          fmt::format("unknown unit \"{}\"; there are: MM, CM, IN, METER", words[1].text));
      unit = name == "mm" ? 1 : name == "cm" ? 10 : name == "meter" ? 1000 : 25.4;
      continue;
    }
    if (key == "SURF") {
      if (lens.surfaces.size() >= kMostSurfaces + 2)
        throw lines.fault(1, fmt::format("more than {} surfaces", kMostSurfaces));
      lens.surfaces.emplace_back(), lens.glasses.push_back(LensGlass::air());
      in_surface = true;
      continue;
    }
    if (!in_surface) {
      unused.insert(key);
      continue;
    }
    optics::LensSurface& s = lens.surfaces.back();
    if (key == "TYPE") {
      need(1);
      if (words[1].text != "STANDARD" && words[1].text != "EVENASPH")
        throw lines.fault(words[1].column,
                          fmt::format("a surface of the type {} is not understood; there are: STANDARD, "
                                      "EVENASPH",
                                      words[1].text));
    } else if (key == "CURV") {
      need(1);
      s.curvature = lines.number(words[1], "a curvature") / unit;
    } else if (key == "CONI") {
      need(1);
      s.conic = lines.number(words[1], "a conic constant");
    } else if (key == "DISZ") {
      need(1);
      const std::string value = lower_case(words[1].text);
      if (value != "infinity")
        s.thickness = lines.number(words[1], "a thickness or INFINITY") * unit;
      else if (lens.surfaces.size() > 1)
        throw lines.fault(words[1].column, "only the object may be at infinity");
    } else if (key == "DIAM") {
      need(1);
      s.semi_diameter = lines.number(words[1], "half a diameter") * unit;
    } else if (key == "STOP") {
      s.is_stop = true;
    } else if (key == "GLAS") {
      need(1);
      if (words[1].text == "MIRROR")
        throw lines.fault(words[1].column, "a mirror: only lenses that refract are understood");
      if (auto glass = LensGlass::named(words[1].text)) {
        lens.glasses.back() = *glass;
      } else {
        need(5);
        const double nd = lines.number(words[4], "the index of a glass at the d line");
        const double vd = lines.number(words[5], "the Abbe number of a glass");
        try {
          lens.glasses.back() = LensGlass::of_abbe_number(nd, vd);
        } catch (const Error& e) {
          throw lines.fault(words[4].column, e.message());
        }
        lens.notes.push_back(
            fmt::format("the glass {} is unknown: it has the index {:g} and the Abbe number {:g} of the file",
                        words[1].text, nd, vd));
      }
    } else if (key == "PARM") {
      need(2);
      const double order = lines.number(words[1], "the number of a parameter"),
                   value = lines.number(words[2], "a number");
      if (value == 0) continue;
      if (order < 2 || order > double(kMostAspheric) + 1 || order != std::floor(order))
        throw lines.fault(words[1].column,
                          "of the parameters of a surface the coefficients of r^4 to r^20 are understood, "
                          "PARM 2 to 10");
      const std::size_t index = std::size_t(order) - 2;
      if (s.even.size() <= index) s.even.resize(index + 1);
      s.even[index] = value / std::pow(unit, 2 * order - 1);
    } else {
      unused.insert(key);
    }
  }
  if (lens.surfaces.size() < 3) throw lines.fault_of_file("has no surface between object and image");
  lens.surfaces.erase(lens.surfaces.begin()), lens.glasses.erase(lens.glasses.begin());
  lens.surfaces.pop_back(), lens.glasses.pop_back();
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i)
    if (!(lens.surfaces[i].semi_diameter > 0))
      throw lines.fault_of_file(fmt::format("surface {} has no diameter (DIAM)", i + 1));
  for (const std::string& known : kOfNoEffect) unused.erase(known);
  if (!unused.empty())
    lens.notes.push_back(fmt::format("lines of these kinds were not used: {}", fmt::join(unused, ", ")));
  return lens;
}

}  // namespace

LensGlass LensGlass::of_index(double index) { return LensGlass(fmt::format("{:g}", index), index); }

LensGlass LensGlass::of_abbe_number(double nd, double abbe_number) {
  if (!(nd > 1 && nd < 10))
    throw Error(fmt::format("the index of a glass lies between 1 and 10, got {:g}", nd));
  if (!(abbe_number > 5 && abbe_number < 200))
    throw Error(fmt::format("an Abbe number lies between 5 and 200, got {:g}", abbe_number));
  constexpr double kD = 587.5618, kF = 486.1327, kC = 656.2725;  // nm, ISO 7944
  const double b = (nd - 1) / abbe_number / (1 / (kF * kF) - 1 / (kC * kC));
  return LensGlass(fmt::format("{:g}/{:g}", nd, abbe_number), nd - b / (kD * kD), b);
}

std::optional<LensGlass> LensGlass::named(std::string_view name) {
  const std::string lower = lower_case(name);
  if (lower == "air" || lower == "vacuum") return air();
  auto index = find_refractive_index(lower);
  // A material that absorbs, such as a metal, makes no lens.
  if (!index || index->at(550).imag() > 1e-3) return {};
  LensGlass glass(lower, 1);
  glass.table_ = std::move(index);
  return glass;
}

double LensGlass::index(double nm) const { return table_ ? table_->at(nm).real() : a_ + b_ / (nm * nm); }

double LensGlass::max_nm() const {
  return table_ ? table_->max_nm() : std::numeric_limits<double>::infinity();
}

std::vector<double> LensPrescription::indices(double nm) const {
  std::vector<double> n;
  for (const LensGlass& glass : glasses) n.push_back(glass.index(nm));
  return n;
}

bool LensPrescription::is_dispersive() const {
  return std::any_of(glasses.begin(), glasses.end(), [](const LensGlass& g) { return g.is_dispersive(); });
}

LensPrescription parse_lens(std::string text, const std::filesystem::path& file) {
  std::vector<std::string> notes;
  const std::string utf8 = pigment::utf8_text(std::move(text), &notes);
  const bool is_zmx = utf8.starts_with("SURF ") || utf8.find("\nSURF ") != utf8.npos;
  LensPrescription lens = is_zmx ? read_zmx(utf8, file) : read_lens_table(utf8, file);
  lens.file = file;
  lens.notes.insert(lens.notes.begin(), notes.begin(), notes.end());
  for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i)
    if (lens.surfaces[i].thickness < 0)
      lens.notes.push_back(fmt::format("{}: the vertex of surface {} lies {:g} mm before that of surface {}",
                                       file.string(), i + 2, -lens.surfaces[i].thickness, i + 1));
  try {
    optics::LensSystem(lens.surfaces).paraxial(lens.indices(587.56));
  } catch (const std::domain_error& e) {
    throw Error({file.string(), 0, 0}, e.what());
  }
  return lens;
}

LensPrescription read_lens(const std::filesystem::path& file) {
  return parse_lens(read_text_file(file, kMaxLensBytes), file);
}

}  // namespace aureole
